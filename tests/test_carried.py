"""What solids and rigid bodies have in common when a fluid carries them: balance, restart, and what is refused."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from immersed_parts import body, box, carried, flap, immersed, part, patch, thin

import visviva as vv
from visviva.base.errors import InputError, RunError
from visviva.flow.overlap import inside_body
from visviva.study.run import run as run_study

run = partial(run_study, progress=False, pictures=False)


@pytest.mark.parametrize("build", [*(partial(b, sealing=100.0) for b in (carried, body, flap)), thin])
def test_energy_balances_with_less_stabilisation_around(build: Any) -> None:
    result = vv.simulate(vv.System(build()), until=0.4, step=0.02)
    assert np.abs(result.ledger["imbalance"]).max() < 1e-12 * result.ledger["total"][0]
    assert np.abs(result.ledger["work_stabilisation"]).max() > 1e-6 * result.ledger["total"][0]


@pytest.mark.parametrize(("build", "n"), [(carried, 3), (body, 4)])
def test_energy_of_a_closed_cube_balances(build: Any, n: int) -> None:
    result = vv.simulate(vv.System(build("hex8", n)), until=0.1, step=0.02)
    assert np.abs(result.ledger["imbalance"]).max() < 1e-12 * result.ledger["total"][0]


@pytest.mark.parametrize("build", [carried, flap, thin, partial(carried, sealing=100.0)])
def test_resumed_bit_by_bit(build: Any, tmp_path: Path) -> None:
    def study(until: float) -> vv.Study:
        return vv.Study(vv.System(build()), until, 0.02)

    run(study(0.4), tmp_path / "whole")
    run(study(0.2), tmp_path / "split")
    run(study(0.4), tmp_path / "split", resume=True)
    ledgers = [(tmp_path / name / "ledger.csv").read_text() for name in ("whole", "split")]
    assert ledgers[0] == ledgers[1]


def twice(parts: list[Any], kind: type[Any]) -> vv.System:
    return vv.System([*parts, immersed(part(parts, kind), part(parts, vv.Fluid))])


def pillar() -> vv.Fluid:
    """A fluid around a square hole in the middle, narrower than marks and cells are apart."""
    whole = vv.RectangleMesh(size=(1, 1), counts=(10, 10)).build()
    away = np.abs(whole.points[whole.cells["quad4"]].mean(axis=1) - 0.45).max(axis=1) > 0.01
    mesh = vv.Mesh(whole.points, {"quad4": whole.cells["quad4"][away]}).without_orphans()
    return vv.Fluid(mesh=mesh, density=1.0, viscosity=0.1)


def over(allowed: bool, rigid: bool) -> vv.System:
    """A body over that hole."""
    fluid = pillar()
    soft: Any = {"material": vv.NeoHooke(young=1.0, poisson=0.3), "density": 1.0}
    patches = vv.RectangleMesh(size=(0.35, 0.35), counts=(3, 3), origin=(0.28, 0.28))
    solid = vv.Solid(mesh=patches, **soft)
    block = vv.RigidBody(shape=vv.Box(size=(0.36, 0.36, 1.0)), density=1.0, position=(0.45, 0.45, 0.0))
    more: Any = {"fluid": fluid, "over_walls": allowed}
    wet = vv.ImmersedBody(body=block, spacing=4.0, **more) if rigid else vv.Immersed(solid=solid, **more)
    return vv.System([fluid, vv.NoSlip(fluid=fluid, faces="all"), block if rigid else solid, wet])


def dry(kind: str, allowed: bool) -> vv.System:
    """A body in a fluid that does not know of it."""
    parts = carried() if kind == "solid" else body()
    parts[0].dry = allowed
    return vv.System([c for c in parts if not isinstance(c, vv.Immersed | vv.ImmersedBody)])


def stood(body: Callable[[float], Any], at: float, allowed: bool = False) -> vv.System:
    """A fluid with something at this height that it does not know of."""
    flat = body in (line_in_plane, warm_patch)
    if flat:
        mesh = vv.RectangleMesh(size=(1, 1), counts=(4, 4)).build()
    else:
        mesh = vv.BoxMesh(size=(1, 1, 1), counts=(4, 4, 4)).build()
    fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=0.1, dry=allowed)
    return vv.System([fluid, vv.NoSlip(fluid=fluid, faces="all"), body(at)])


ROD = vv.RectangleSection(width=1.0, height=0.02, young=1e4, density=2.0)


def line_in_plane(at: float) -> vv.Beam:
    return vv.Beam(mesh=vv.LineMesh(points=[(0, at, 0), (1, at, 0)], count=3), section=ROD, first=(0, 0, 1))


def line_in_space(at: float) -> vv.Beam:
    """Of one cell, both ends of which are on walls."""
    return vv.Beam(mesh=vv.LineMesh(points=[(0, 0.4, at), (1, 0.4, at)], count=1), section=ROD)


def sheet(at: float) -> vv.Shell:
    mesh = vv.RectangleMesh(size=(1, 1), counts=(2, 2)).build()
    mesh = vv.Mesh(np.pad(mesh.points, ((0, 0), (0, 1)), constant_values=at), mesh.cells)
    return vv.Shell(
        mesh=mesh, section=vv.HomogeneousSection(thickness=0.01, young=1.0, poisson=0.3, density=1.0)
    )


def warm_patch(at: float) -> vv.ThermalBody:
    """From there on upwards."""
    mesh = vv.RectangleMesh(size=(0.4, 0.4), counts=(2, 2), origin=(0.3, at))
    return vv.ThermalBody(mesh=mesh, conductivity=1.0)


def film(at: float) -> vv.CahnHilliard:
    """A mixture on a surface in space."""
    return vv.CahnHilliard(
        mesh=sheet(at).grid, free_energy=vv.DoubleWell(barrier=1.0), gradient_energy=1.0, concentration=0.5
    )


@pytest.mark.parametrize(
    ("body", "cure"),
    [
        (film, "leave its place out of the mesh"),
        (line_in_plane, "ImmersedThin"),
        (line_in_space, "ImmersedThin"),
        (sheet, "ImmersedThin"),
        (warm_patch, "leave its place out of the mesh"),
    ],
)
def test_thin_and_thermal_bodies_in_a_fluid_that_does_not_know_of_them(body: Any, cure: str) -> None:
    """Refused within, unless meant; along a wall, or beyond it, they are no matter."""
    with pytest.raises(InputError, match=rf"lies within Fluid.*{cure}.*allow it by Fluid\(dry=True\)"):
        stood(body, 0.4)
    stood(body, 0.4, allowed=True)
    stood(body, 1.0)
    stood(body, 1.1)


SOFT = vv.NeoHooke(young=1.0, poisson=0.3)


def bar(at: float) -> vv.Solid:
    """Of one cell, whose middle is in the hole of a fluid."""
    return vv.Solid(
        mesh=vv.RectangleMesh(size=(0.9, 0.1), counts=(1, 1), origin=(0.05, at)), material=SOFT, density=1.0
    )


def cover(at: float) -> vv.Solid:
    """One cell in which a whole fluid lies."""
    return vv.Solid(
        mesh=vv.RectangleMesh(size=(90, 80), counts=(1, 1), origin=(-7, -7 + at)), material=SOFT, density=1.0
    )


def crate(at: float) -> vv.RigidBody:
    """The same of a rigid body, whose surface is far away."""
    return vv.RigidBody(shape=vv.Box(size=(90, 80, 1)), density=1.0, position=(30, 30 + at, 0))


def beam_through(at: float) -> vv.Beam:
    """Of one cell, whose ends and middle are out of a fluid with a hole."""
    return vv.Beam(mesh=vv.LineMesh(points=[(-1, at, 0), (2, at, 0)], count=1), section=ROD, first=(0, 0, 1))


@pytest.mark.parametrize(("body", "clear"), [(bar, 1.0), (cover, 100.0), (crate, 100.0), (beam_through, 2.0)])
@pytest.mark.parametrize("cell", ["quad4", "tri6"])
def test_large_cells_around_and_across_a_fluid_are_seen(body: Any, clear: float, cell: str) -> None:
    """Where neither their middles nor their nodes lie in it."""
    whole = vv.RectangleMesh(size=(1, 1), counts=(10, 10), cell=cell).build()
    middles = whole.points[whole.cells[cell]].mean(axis=1)
    hole = np.all(np.abs(middles - 0.5) < [0.25, 0.2], axis=1)
    mesh = vv.Mesh(whole.points, {cell: whole.cells[cell][~hole]}).without_orphans()

    def system(at: float, **more: Any) -> vv.System:
        fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=0.1, **more)
        return vv.System([fluid, vv.NoSlip(fluid=fluid, faces="all"), body(at)])

    with pytest.raises(InputError, match=r"lies within Fluid.*allow it by Fluid\(dry=True\)"):
        system(0.43)
    system(0.43, dry=True)
    system(clear)


def test_what_is_wet_in_one_fluid_is_not_so_in_another() -> None:
    solid, one, other = patch(), box(), box()
    one.dry = True
    walls = [vv.NoSlip(fluid=fluid, faces="all") for fluid in (one, other)]
    with pytest.raises(InputError, match="Solid 'solid-1' lies within Fluid 'fluid-2'"):
        vv.System([solid, one, other, *walls, vv.Immersed(solid=solid, fluid=one)])


def massless(allowed: bool) -> vv.System:
    fluid, solid = box(), patch(density=0.0)
    wet = vv.Immersed(solid=solid, fluid=fluid, massless=allowed)
    return vv.System([fluid, vv.NoSlip(fluid=fluid, faces="all"), solid, wet])


MEANT: dict[str, Callable[[bool], Any]] = {
    "a solid that is not immersed": partial(dry, "solid"),
    "a rigid body that is not immersed": partial(dry, "body"),
    "a solid over a wall": partial(over, rigid=False),
    "a rigid body over a wall": partial(over, rigid=True),
    "a solid without density": massless,
}


@pytest.mark.parametrize("what", MEANT)
def test_what_is_hardly_meant_is_refused_but_can_be_asked_for(what: str) -> None:
    with pytest.raises(InputError, match=r"allow (it|that) by .*=True"):
        MEANT[what](False)
    MEANT[what](True)


def test_bodies_beside_a_fluid_are_no_matter() -> None:
    """A wall of solid cells along the mesh of the fluid shares its border and lies outside."""
    fluid = box()
    mesh = vv.RectangleMesh(size=(1.0, 0.2), counts=(6, 1), origin=(0.0, -0.2))
    wall = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1.0, poisson=0.3), density=1.0)
    block = vv.RigidBody(shape=vv.Box(size=(0.2, 0.2, 1.0)), density=1.0, position=(-0.1, 0.5, 0.0))
    vv.System([fluid, vv.NoSlip(fluid=fluid, faces="all"), wall, block])


def tube(inner: float, outer: float, **options: Any) -> vv.RigidBody:
    """A square tube of length 1 about (0.5, 0.5), closed by rings at its ends."""
    square = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    points = [(*(r * xy), z) for z in (-0.5, 0.5) for r in (inner, outer) for xy in square]
    quads = []
    for k in range(4):
        n = (k + 1) % 4
        quads += [(4 + k, 4 + n, 12 + n, 12 + k), (k, 8 + k, 8 + n, n)]  # outside, inside
        quads += [(8 + k, 12 + k, 12 + n, 8 + n), (k, n, 4 + n, 4 + k)]  # above, below
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    shape = vv.SurfaceMesh(points=points, triangles=triangles)
    return vv.RigidBody(**{"shape": shape, "density": 1.5, "position": (0.5, 0.5, 0.0), **options})


def test_a_casing_around_a_fluid_is_no_matter() -> None:
    """The inner side of a hollow body, drawn to its middle, was taken for the body."""
    fluid = box()
    vv.System([fluid, vv.NoSlip(fluid=fluid, faces="all"), tube(0.5, 0.6)])
    vv.System([fluid, vv.NoSlip(fluid=fluid, faces="all"), tube(0.51, 0.6)])


@pytest.mark.parametrize("outer", [0.26, 0.3, 0.45])
def test_a_hollow_body_that_is_not_immersed_is_refused(outer: float) -> None:
    """Where its wall alone is, not its cavity: with a fluid around it and none within."""
    whole = vv.RectangleMesh(size=(1, 1), counts=(8, 8)).build()
    away = np.abs(whole.points[whole.cells["quad4"]].mean(axis=1) - 0.5).max(axis=1) > 0.25
    mesh = vv.Mesh(whole.points, {"quad4": whole.cells["quad4"][away]}).without_orphans()
    fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=0.1)
    with pytest.raises(InputError, match=r"lies within Fluid.*allow it by Fluid\(dry=True\)"):
        vv.System([fluid, vv.NoSlip(fluid=fluid, faces="all"), tube(0.24, outer)])
    vv.System([fluid, vv.NoSlip(fluid=fluid, faces="all"), tube(0.2, 0.25)])  # within the hole


def test_an_immersed_body_in_the_cavity_of_another() -> None:
    """Neither is in the way of the other, and walls that a casing touches are not covered by it."""
    fluid, around = box(n=12), tube(0.25, 0.4)
    inner = vv.RigidBody(shape=vv.Box(size=(0.2, 0.2, 1.0)), density=1.5, position=(0.5, 0.5, 0.0))
    wet = [vv.ImmersedBody(body=b, fluid=fluid) for b in (around, inner)]
    vv.System([fluid, vv.NoSlip(fluid=fluid, faces="all"), around, inner, *wet])
    casing = tube(0.5, 0.7)
    assert len(inside_body(casing, *casing.shape.surface(), fluid.wall_places(casing.position[:2]))) == 0


BAD: dict[str, tuple[Callable[[], Any], str]] = {
    "damping beyond the end": (lambda: carried(damping=0.6), "damping = 0.6 is not a number from 0 to 0.5"),
    "negative damping": (lambda: body(damping=-1.0), "damping = -1.0 is not a number from 0 to 0.5"),
    "sealing below one": (lambda: carried(sealing=0.5), "sealing = 0.5 is not a number from 1"),
    "nothing to seal": (
        lambda: carried("quad9", sealing=10.0),
        "sealing = 10 is for stabilised elements; leave",
    ),
    "solid twice": (lambda: twice(carried(), vv.Solid), "immersed twice"),
    "rigid body twice": (lambda: twice(body(), vv.RigidBody), "immersed twice"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input(name: str) -> None:
    build, message = BAD[name]
    with pytest.raises(InputError, match=message):
        build()


@pytest.mark.parametrize(
    ("n", "name", "build", "last"),
    [
        (4, "Solid 'solid-1'", lambda: patch(density=1.0), 0.25),
        (6, "RigidBody 'rigidbody-1'", lambda: part(body(density=1.0), vv.RigidBody), 0.3),
    ],
)
def test_leaving_the_fluid_ends_the_run_with_body_place_and_time(
    n: int, name: str, build: Any, last: float
) -> None:
    fluid, floating = box("quad4", n, velocity=(1.0, 0.0, 0.0)), build()
    around = vv.VelocityBoundary(fluid=fluid, faces="all", velocity=(1.0, 0.0, 0.0))
    system = vv.System([fluid, around, floating, immersed(floating, fluid)])
    with pytest.raises(RunError, match=name + r" lies outside of Fluid 'fluid-1' at \(1.*from t = 0\.[12]"):
        vv.simulate(system, until=1.0, step=0.05)
    assert 0.1 < system.time < last
    if isinstance(floating, vv.Solid):
        assert floating.positions(system.x)[:, 0].max() < 1.0 + 1e-12
