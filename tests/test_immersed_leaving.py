"""What is immersed leaves a fluid through openings if it may, and goes into no wall."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from immersed_parts import part
from numpy.typing import NDArray

import visviva as vv
from visviva.base.errors import RunError
from visviva.study.run import run

Array = NDArray[np.float64]

SPEED = 1.0


def stream(X: Array) -> Array:
    return np.asarray(np.full_like(X, SPEED) * [1.0, 0.0, 0.0])


def fan(X: Array) -> Array:
    """Faster above than below."""
    return np.asarray((1 + X[:, 1:2]) * [SPEED, 0.0, 0.0])


def outflow(
    kind: str,
    cell: str = "quad4",
    leaves: bool = True,
    velocity: Any = stream,
    density: float = 1.5,
    gravity: float = 0.0,
    **more: Any,
) -> tuple[vv.System, Any]:
    """A body in a stream between walls that move with it, before an outlet at x = 1."""
    mesh = vv.RectangleMesh(size=(1.0, 1.0), counts=(6, 6), cell=cell)
    fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=0.05, velocity=velocity)
    sides = [
        vv.VelocityBoundary(fluid=fluid, faces=f, velocity=lambda t, X: velocity(X))
        for f in ("x0", "y0", "y1")
    ]
    outlet = vv.Outlet(fluid=fluid, faces="x1", name="outlet")
    options: Any = {"fluid": fluid, "leaves": leaves, **more}
    if kind == "rigid":
        body: Any = vv.RigidBody(
            shape=vv.Box(size=(0.3, 0.2, 1.0)), density=density, position=(0.7, 0.52, 0.0)
        )
        wet: Any = vv.ImmersedBody(body=body, **options)
    else:
        block = vv.RectangleMesh(size=(0.3, 0.2), counts=(3, 2), origin=(0.55, 0.42))
        body = vv.Solid(mesh=block, material=vv.NeoHooke(young=20.0, poisson=0.3), density=density)
        wet = vv.Immersed(solid=body, **options)
    down = [vv.Gravity(acceleration=(gravity, 0.0, 0.0))] if gravity else []
    return vv.System([fluid, *sides, outlet, body, wet, *down]), body


def motion(body: Any, system: vv.System) -> tuple[Array, Array]:
    """Places and velocities (n, 3) of nodes, or of points around the middle of a rigid body."""
    if isinstance(body, vv.Solid):
        return body.positions(system.x), body.velocities(system.x, system.v)
    points = [body.place(X) for X in np.eye(3) - 1 / 3]
    found = [np.array([p.value(y) for p in points]) for y in (system.x, system.v)]
    return found[0], found[1]


@pytest.mark.parametrize("density", [0.5, 1.0, 3.0])
@pytest.mark.parametrize("kind", ["soft", "rigid"])
@pytest.mark.parametrize("cell", ["quad4", "quad9"])
def test_bodies_keep_their_velocity_outside(kind: str, cell: str, density: float) -> None:
    """Carried out by a uniform stream they go on with its velocity, of whatever density, and the balance stays closed
    while the fluid that they displaced goes out with them."""
    system, body = outflow(kind, cell, density=density)
    result = vv.simulate(system, until=1.0, step=0.05)
    places, velocities = motion(body, system)
    assert places[:, 0].min() > 1.2
    assert np.allclose(velocities, [SPEED, 0, 0], rtol=0, atol=1e-9)
    ledger = result.ledger
    assert np.abs(ledger["imbalance"]).max() < 1e-11 * ledger["total"][0]
    assert ledger["work_displaced"][-1] == pytest.approx(0.5 * 0.06 * SPEED**2, rel=1e-9)


@pytest.mark.parametrize("kind", ["soft", "rigid"])
def test_residuals_leave_alone_what_was_displaced(kind: str) -> None:
    """A trial state is that of no step: what a body displaces changes as a step is accepted."""
    system, _ = outflow(kind)
    vv.simulate(system, until=0.1, step=0.05)
    terms = [term for term, _ in system.model.terms if "share" in term.history]
    assert terms
    for term in terms:
        kept = term.history["share"].copy()
        term._share = lambda part=0.25 * kept: part
        system.residual(vv.EnergyMomentum().step(system.time, 0.05))
        np.testing.assert_array_equal(term.history["share"], kept)


@pytest.mark.parametrize("kind", ["soft", "rigid"])
def test_energy_balances_while_a_body_turns_and_bends_out(kind: str) -> None:
    system, _ = outflow(kind, velocity=fan, damping=0.05)
    result = vv.simulate(system, until=1.0, step=0.05)
    assert np.abs(result.ledger["imbalance"]).max() < 1e-11 * result.ledger["total"][0]
    assert np.abs(result.ledger["defect_position"]).max() < 1e-12


@pytest.mark.parametrize("kind", ["soft", "rigid"])
def test_bodies_fall_freely_outside(kind: str) -> None:
    """As heavy as the fluid they do not sink in it, and fall with gravity where it does not hold them."""
    system, body = outflow(kind, density=1.0, gravity=2.0)
    speeds = []
    for until in (0.1, 0.9, 1.2):
        ledger = vv.simulate(system, until=until, step=0.05).ledger
        assert np.abs(ledger["imbalance"]).max() < 1e-11 * ledger["total"][0]
        share = body.nodal_mass / body.mass if kind == "soft" else np.full(3, 1 / 3)
        speeds.append(share @ motion(body, system)[1][:, 0])
    assert motion(body, system)[0][:, 0].min() > 1.2
    assert speeds[0] == pytest.approx(SPEED, abs=1e-9)
    assert speeds[2] - speeds[1] == pytest.approx(2.0 * 0.3, abs=1e-6)


@pytest.mark.parametrize("kind", ["soft", "rigid"])
def test_resumed_outside_bit_by_bit(kind: str, tmp_path: Path) -> None:
    def study(until: float) -> vv.Study:
        return vv.Study(outflow(kind, velocity=fan)[0], until, 0.05)

    run(study(0.8), tmp_path / "whole", progress=False, pictures=False)
    for until in (0.25, 0.55, 0.8):  # while it leaves, and after that
        run(study(until), tmp_path / "split", resume=until > 0.25, progress=False, pictures=False)
    ledgers = [(tmp_path / name / "ledger.csv").read_text() for name in ("whole", "split")]
    assert ledgers[0] == ledgers[1]


@pytest.mark.parametrize(("kind", "name"), [("soft", "node 3 of Solid"), ("rigid", "mark .* of RigidBody")])
def test_without_the_switch_the_message_names_it(kind: str, name: str) -> None:
    system, body = outflow(kind, leaves=False)
    message = (
        rf"{name} '.*' lies outside of Fluid 'fluid-1' at \(1.*, beyond Outlet 'outlet'; leaves=True lets go"
    )
    with pytest.raises(RunError, match=message):
        vv.simulate(system, until=1.0, step=0.05)
    assert motion(body, system)[0][:, 0].max() < 1.0 + 1e-9 or kind == "rigid"
    assert 0.1 < system.time < 0.2


def driven(pull: float, *walls: vv.Plane, cell: str = "quad4", **more: Any) -> tuple[vv.System, vv.Solid]:
    """A heavy block that flies towards a square obstacle in the middle of a box, in contact with walls."""
    whole = vv.RectangleMesh(size=(1, 1), counts=(10, 10), cell=cell).build()
    away = np.abs(whole.points[whole.cells[cell]].mean(axis=1) - 0.5).max(axis=1) > 0.11
    mesh = vv.Mesh(whole.points, {cell: whole.cells[cell][away]}).without_orphans()
    fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=1e-3)
    block = vv.RectangleMesh(size=(0.1, 0.1), counts=(2, 2), origin=(0.15, 0.45))
    solid = vv.Solid(mesh=block, material=vv.NeoHooke(young=1e3, poisson=0.3), density=50.0, name="block")
    wall = vv.NoSlip(fluid=fluid, faces="all", name="wall")
    push = vv.Gravity(acceleration=(pull, 0.0, 0.0))
    touches = [vv.Contact(first=solid, first_faces="x1", second=w) for w in walls]
    wet = vv.Immersed(solid=solid, fluid=fluid, **more)
    return vv.System([fluid, wall, solid, wet, push, *walls, *touches]), solid


@pytest.mark.parametrize("leaves", [False, True])
def test_a_step_into_an_obstacle_is_halved(leaves: bool) -> None:
    """Fluid in between stops a block that steps of this length would take into the wall."""
    system, solid = driven(100.0, leaves=leaves)
    result = vv.simulate(system, until=0.3, step=0.05)
    assert result.statistics.rejected > 0
    inside = np.abs(solid.positions(system.x)[:, :2] - 0.5).max(axis=1) < 0.1 - 1e-9
    assert not inside.any()
    assert np.abs(result.ledger["imbalance"]).max() < 1e-10 * np.abs(result.ledger["total"]).max()


@pytest.mark.parametrize("cell", ["quad4", "tri3"])
def test_nothing_moves_through_walls_beside_their_edges(cell: str) -> None:
    """Where the fluid sticks it moves nothing, also next to the corners of an obstacle."""
    system, _ = driven(1.0, cell=cell)
    fluid = part(system.components, vv.Fluid)
    along = np.linspace(0.4, 0.6, 41)[:, None]
    rim = np.vstack(
        [
            np.hstack(pair)
            for side in (0.4, 0.6)
            for pair in ((0 * along + side, along), (along, 0 * along + side))
        ]
    )
    unknowns, weights = fluid.transfer.at(fluid.at(rim))
    free = ~fluid.flow.fixed[unknowns - fluid.flow.start]
    assert np.abs(np.where(free, weights, 0.0)).max() < 1e-12


# --- contact ------------------------------------------------------------------------------------------------
def falling(contact: bool, cell: str) -> tuple[float, vv.Result]:
    """How far apart the surfaces of two heavy discs end that fall on the floor one above the other, and the run."""
    mesh = vv.RectangleMesh(size=(1, 1), counts=(10, 10), cell=cell)
    fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=0.05)
    disc: Any = {"shape": vv.Cylinder(radius=0.1, length=1.0), "density": 3.0}
    discs = [vv.RigidBody(position=(0.5 + 0.01 * k, 0.12 + 0.201 * k, 0.0), **disc) for k in (0, 1)]
    wet = [vv.ImmersedBody(body=body, fluid=fluid) for body in discs]
    parts: list[Any] = [fluid, vv.NoSlip(fluid=fluid, faces="all"), *discs, *wet]
    if contact:
        parts.append(vv.Contact(first=discs[0], second=discs[1], stiffness=1e4))
    system = vv.System([*parts, vv.Gravity(acceleration=(0, -20.0, 0))], vv.Newton(tolerance=1e-9))
    step = 0.0025 if contact else 0.01  # an impact leaves an overlap of as much as the way of a step
    result = vv.simulate(system, until=0.3, step=step)
    a, b = (body.place(np.zeros(3)).value(system.x) for body in discs)
    return float(np.linalg.norm(a - b)) - 0.2, result


@pytest.mark.parametrize(("cell", "apart"), [("quad9", -0.015), ("quad4", -0.002)])
def test_contact_acts_where_surfaces_of_immersed_bodies_meet(cell: str, apart: float) -> None:
    """Within a cell the fluid moves the marks of both discs alike and does not keep these apart: contact does, but for
    the 0.0017 by which the facets of their surfaces lie within the circles."""
    (through, _), (touching, result) = falling(False, cell), falling(True, cell)
    assert through < apart
    assert -0.0025 < touching < 0
    assert np.abs(result.ledger["imbalance"]).max() < 1e-11


def test_contact_keeps_an_immersed_solid_off_a_wall() -> None:
    """A tenth of a cell before it, where nodes can still move."""
    wall = vv.Plane(at=(0.39, 0.0, 0.0), normal=(-1.0, 0.0, 0.0))
    system, solid = driven(100.0, wall)
    touch = part(system.components, vv.Contact)
    places, forces = [], []
    for _ in vv.march(system, until=0.3, step=0.05):
        places.append(solid.positions(system.x)[:, 0].max())
        forces.append(-float(vv.ContactForce(contact=touch)(system)[0]))
    assert max(places) == pytest.approx(0.39, abs=1e-9)
    assert 10 < max(forces) < 1e4  # it weighs 49


@pytest.mark.parametrize("contact", [False, True])
def test_a_film_within_a_cell_hardly_drains(contact: bool) -> None:
    """Between wide blocks pressed together: Reynolds' equation, ``dh/dt = -p h^3 / (mu L^2)``, lets half of it out."""
    mesh = vv.RectangleMesh(size=(1, 1), counts=(10, 10))
    fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=0.05)
    soft: Any = {"material": vv.NeoHooke(young=500.0, poisson=0.45), "density": 1.0}
    blocks = [
        vv.Solid(mesh=vv.RectangleMesh(size=(0.3, 0.2), counts=(6, 4), origin=(0.35, y)), **soft)
        for y in (0.285, 0.515)
    ]
    wet = [vv.Immersed(solid=s, fluid=fluid, damping=0.1) for s in blocks]
    press = [
        vv.Traction(solid=s, faces=side, traction=(0, p, 0))
        for s, side, p in zip(blocks, ("y0", "y1"), (20.0, -20.0), strict=True)
    ]
    parts: list[Any] = [fluid, vv.NoSlip(fluid=fluid, faces="all"), *blocks, *wet, *press]
    if contact:
        parts.append(vv.Contact(first=blocks[0], first_faces="y1", second=blocks[1], second_faces="y0"))
    system = vv.System(parts, vv.Newton(tolerance=1e-9))
    vv.simulate(system, until=0.4, step=0.01)
    top, bottom = (s.positions(system.x)[:, 1] for s in blocks)
    exact = (0.03**-2 + 2 * 20.0 / (0.05 * 0.3**2) * 0.4) ** -0.5
    assert exact < 0.5 * 0.03
    assert 0.96 * 0.03 < bottom.min() - top.max() < 0.97 * 0.03
