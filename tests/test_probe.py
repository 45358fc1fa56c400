"""Probes of solids against closed forms, equilibrium and the change of momentum."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]

SIZE = (2.0, 0.5, 0.4)
AREA = SIZE[1] * SIZE[2]
STEEL = vv.LinearElastic(young=200.0, poisson=0.0)


def bar(cell: str = "hex8", **options: Any) -> vv.Solid:
    given = {"material": STEEL} | options
    return vv.Solid(mesh=vv.BoxMesh(size=SIZE, counts=(4, 2, 2), cell=cell), **given)


def pulled(traction: Any, cell: str = "hex8", **options: Any) -> tuple[vv.System, vv.Solid]:
    """A bar in equilibrium, held at x = 0."""
    solid = bar(cell, **options)
    load = vv.Traction(solid=solid, faces="x1", traction=traction, times="t")
    system = vv.System([solid, vv.Fixed(solid=solid, nodes="x0"), load])
    vv.quasi_static(system, until=1.0, step=1.0)
    return system, solid


def test_components_of_fields_are_fields() -> None:
    system, solid = pulled((3.0, 0, 0))
    at = (1.0, 0.1, 0.1)
    whole = vv.FieldAt(solid=solid, field="cauchy", at=at)(system)
    for k, part in enumerate(("xx", "yy", "zz", "xy", "yz", "zx")):
        probe = vv.FieldAt(solid=solid, field=f"cauchy_{part}", at=at)
        assert probe(system) == whole[k]
        assert probe.quantity == "stress"
        assert probe.parts == ()
        assert vv.FieldAt(solid=solid, field=f"cauchy_{part[::-1]}", at=at)(system) == whole[k]
    greatest = vv.Extreme(solid=solid, field="cauchy_xx", which="max")(system)
    assert isinstance(greatest, float)
    assert greatest == pytest.approx(3.0, abs=1e-9)


def test_fields_that_are_not_there_are_refused_with_those_that_are() -> None:
    for field, known in (("stress", "It has J, .*von_mises"), ("xyz", "there are J, .*von_mises")):
        with pytest.raises(vv.InputError, match=rf"Solid.*: there is no field '{field}'.*{known}.*cauchy_xx"):
            vv.FieldAt(solid=bar(), field=field, at=(1.0, 0.1, 0.1))
    warm = vv.ThermalBody(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), capacity=1.0, conductivity=1.0)
    with pytest.raises(
        vv.InputError, match=r"ThermalBody.*: there is no field 'cauchy_xy'((?!cauchy_xx).)*$"
    ):
        vv.FieldAt(solid=warm, field="cauchy_xy", at=(0.5, 0.5, 0.5))


@pytest.mark.parametrize("cell", ["hex8", "hex20", "tet10", "wedge6"])
def test_uniaxial_bar(cell: str) -> None:
    """Stress t, strain t / E, force t A; everywhere and exactly, as it is linear."""
    system, solid = pulled((3.0, 0, 0), cell)
    assert vv.SupportForce(solid=solid, nodes="x0")(system) == pytest.approx([-3 * AREA, 0, 0], abs=1e-9)
    section = vv.SectionForce(solid=solid, point=(1.0, 0, 0), normal=(1, 0, 0))
    assert section(system) == pytest.approx([3 * AREA, 0, 0], abs=1e-9)
    end = vv.Displacement(of=solid, at=(2.0, 0.2, 0.1))
    assert end(system) == pytest.approx([2 * 3 / 200, 0, 0], abs=1e-9)
    assert vv.Displacement(of=solid, at=(1.2, 0.2, 0.1), direction=(1, 0, 0))(system) == pytest.approx(0.018)
    stress = vv.FieldAt(solid=solid, field="cauchy", at=(1.23, 0.17, 0.31))(system)
    assert stress == pytest.approx([3.0, 0, 0, 0, 0, 0], abs=1e-8)
    for which in ("max", "min"):
        assert vv.Extreme(solid=solid, field="von_mises", which=which)(system) == pytest.approx(3.0, rel=1e-8)


def test_console_with_a_force_across() -> None:
    """Shear force and moment of a console, by equilibrium of the part beyond the section."""
    system, solid = pulled((0, 0, -0.5))
    shear = -0.5 * AREA
    for x in (0.5, 1.0, 1.5):
        force = vv.SectionForce(solid=solid, point=(x, 0, 0), normal=(1, 0, 0))(system)
        assert force == pytest.approx([0, 0, shear], abs=1e-9)
        about = np.array([x, 0.25, 0.2])
        torque = vv.SectionTorque(solid=solid, point=(x, 0, 0), normal=(1, 0, 0), about=about)(system)
        faces = solid.nodes("x1")
        end = solid.positions(system.x)[faces]
        loads = loads_of(solid, shear)
        expected = np.cross(end - about, loads).sum(axis=0)
        assert torque == pytest.approx(expected, abs=1e-9)
        assert torque[1] == pytest.approx(-shear * (2 - x), rel=1e-9)
    held = vv.SupportTorque(solid=solid, nodes="x0", about=(0, 0.25, 0.2))(system)
    assert held[1] == pytest.approx(shear * 2.0, rel=1e-9)


def loads_of(solid: vv.Solid, total: float) -> Array:
    """Forces of a uniform traction on the nodes of x1: shares of corners, edges and the middle are 1 : 2 : 4."""
    X = solid.points[solid.nodes("x1")]
    share = np.where(np.isclose(X[:, 1], SIZE[1] / 2), 2.0, 1.0) * np.where(
        np.isclose(X[:, 2], SIZE[2] / 2), 2.0, 1.0
    )
    return np.outer(share / share.sum(), (0, 0, total))


@pytest.mark.parametrize(
    ("cell", "grading"), [("hex8", 1.5), ("wedge6", 1.5), ("hex20", 1.0), ("tet10", 1.0)]
)
def test_sections_of_a_hanging_block_carry_its_weight(cell: str, grading: float) -> None:
    """What acts in the volume counts for both sides of a section by their shares; on graded meshes as well."""
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 4), cell=cell).build()
    points = mesh.points.copy()
    points[:, 2] **= grading
    block = vv.Solid(
        mesh=vv.Mesh(points, mesh.cells, mesh.node_sets, mesh.face_sets),
        material=vv.SaintVenantKirchhoff(young=100.0, poisson=0.3),
        density=1.0,
    )
    system = vv.System([block, vv.Fixed(solid=block, nodes="z1"), vv.Gravity(acceleration=(0, 0, -2))])
    vv.quasi_static(system, until=1.0, step=1.0)
    for z in np.array([0.25, 0.5, 0.75]) ** grading:
        section = vv.SectionForce(solid=block, point=(0, 0, z), normal=(0, 0, 1))
        assert section(system) == pytest.approx([0, 0, 2 * z], abs=1e-9)


def test_oblique_planes_count_among_the_supports() -> None:
    block = vv.Solid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2)),
        material=vv.NeoHooke(young=100.0, poisson=0.3),
        density=1.0,
    )
    sides = (("x0", (1, 0, 0)), ("y0", (0, 1, 0)), ("z0", (0.6, 0, 0.8)))
    planes = [vv.SymmetryPlane(solid=block, nodes=side, normal=n) for side, n in sides]
    system = vv.System([block, *planes, vv.Gravity(acceleration=(0, 0, -10))])
    vv.quasi_static(system, until=1.0, step=1.0)
    assert vv.SupportForce(solid=block)(system) == pytest.approx([0, 0, 10], abs=1e-9)
    assert vv.SupportForce(solid=block, nodes="z0")(system)[2] == pytest.approx(10, abs=1e-9)


def test_support_force_of_some_nodes_adds_up() -> None:
    system, solid = pulled((0, 0, -0.5))
    nodes = solid.nodes("x0")
    parts = [vv.SupportForce(solid=solid, nodes=n)(system) for n in (nodes[:4], nodes[4:])]
    assert np.sum(parts, axis=0) == pytest.approx(vv.SupportForce(solid=solid)(system), abs=1e-12)
    assert np.abs(vv.SupportForce(solid=solid, nodes="x1")(system)).max() == 0


def test_support_force_is_the_change_of_momentum() -> None:
    """Of a bar that swings about one end: ``h f`` is the change of momentum in every step."""
    rubber = vv.NeoHooke(young=50.0, poisson=0.3)
    solid = bar(material=rubber, density=1.0, velocity=lambda X: X * (0, 0.3, 0) + X[:, [0]] * ((0, 0, 0.4),))
    system, h = vv.System([solid, vv.Fixed(solid=solid, nodes="x0")], vv.Newton(tolerance=1e-15)), 0.02
    before = None
    for _ in vv.march(system, until=10 * h, step=h):
        now = system.core.momentum.reshape(-1, 6).sum(axis=0)
        if before is not None:
            held = vv.SupportForce(solid=solid, nodes="x0")(system)
            assert np.abs(held).max() > 0.01
            assert h * held == pytest.approx(now[:3] - before[:3], abs=1e-11)
        before = now.copy()


def test_velocity_of_a_turning_body() -> None:
    solid = bar(density=1.0, velocity=(1, 2, 3), angular_velocity=(0.5, -1, 2))
    system = vv.System([solid])
    X = np.array([1.3, 0.1, 0.3])
    expected = np.array([1, 2, 3]) + np.cross((0.5, -1, 2), X - np.array(SIZE) / 2)
    assert vv.Velocity(of=solid, at=X)(system) == pytest.approx(expected, rel=1e-12)
    along = vv.Velocity(of=solid, at=X, direction=(0, 0, 1))(system)
    assert along == pytest.approx(expected[2], rel=1e-12)


@pytest.mark.parametrize("cell", ["hex20", "hex27"])
def test_field_of_a_linear_stress_is_exact_between_nodes(cell: str) -> None:
    """``u = a x^2 / 2`` along x gives the stress ``E a x``."""
    solid = bar(cell)
    system = vv.System([solid])
    x = solid.points.copy()
    x[:, 0] += 0.01 * x[:, 0] ** 2 / 2
    system.x[:] = x.ravel()
    for at in ((0.3, 0.1, 0.2), (1.77, 0.4, 0.05)):
        stress = vv.FieldAt(solid=solid, field="cauchy", at=at)(system)
        assert stress[0] == pytest.approx(200 * 0.01 * at[0], rel=1e-11)
    assert vv.Extreme(solid=solid, field="cauchy")(system)[0] < 200 * 0.01 * 2.0
    assert vv.Extreme(solid=solid, field="cauchy", which="min")(system)[0] > 0


@pytest.mark.parametrize("plane", ["strain", "axisymmetric"])
def test_plane_sections_and_supports(plane: Any) -> None:
    """A strip or a tube pulled along y: forces of the thickness, or of the circumference."""
    mesh = vv.RectangleMesh(size=(0.5, 2.0), counts=(2, 4)).build().moved((1.0, 0.0))
    solid = vv.Solid(mesh=mesh, material=STEEL, plane=plane, thickness=0.3 if plane == "strain" else 1.0)
    pull = vv.Traction(solid=solid, faces="y1", traction=(0, 2.0, 0), times="t")
    held = vv.Fixed(solid=solid, nodes="y0", directions=(False, True, False))
    side = vv.Fixed(solid=solid, nodes=[int(solid.nodes("y0")[0])], directions=(True, False, False))
    system = vv.System([solid, held, side, pull])
    vv.quasi_static(system, until=1.0, step=1.0)
    force = 2.0 * (0.5 * 0.3 if plane == "strain" else np.pi * (1.5**2 - 1.0))
    assert vv.SupportForce(solid=solid, nodes="y0")(system) == pytest.approx([0, -force, 0], abs=1e-8)
    section = vv.SectionForce(solid=solid, point=(0, 1.0, 0), normal=(0, 1, 0))
    assert section(system)[1] == pytest.approx(force, rel=1e-9)


@pytest.mark.parametrize("cell", ["quad4", "tri6", "quad9"])
def test_volume_of_a_revolution(cell: Any) -> None:
    """A tube from radius 1 to 1.5, 2 high, that widens by 10 % and shortens to a half."""
    mesh = vv.RectangleMesh(size=(0.5, 2.0), counts=(2, 4), cell=cell).build().moved((1.0, 0.0))
    tube = vv.Solid(mesh=mesh, material=STEEL, plane="axisymmetric")
    system = vv.System([tube])
    whole = np.pi * (1.5**2 - 1.0) * 2.0
    assert vv.Volume(solid=tube)(system) == pytest.approx(whole, rel=1e-13)
    system.x[:] = (tube.points[:, :2] * (1.1, 0.5)).ravel()
    assert vv.Volume(solid=tube)(system) == pytest.approx(1.1**2 * 0.5 * whole, rel=1e-13)


def test_bad_input() -> None:
    solid = bar()
    with pytest.raises(vv.InputError, match=r"von_mised.*von_mises"):
        vv.FieldAt(solid=solid, field="von_mised", at=(1, 0, 0))
    with pytest.raises(vv.InputError, match=r"stretchs.*stretches"):
        vv.Extreme(solid=solid, field="stretchs")
    with pytest.raises(vv.InputError, match=r"lies in none of its elements"):
        vv.FieldAt(solid=solid, at=(3, 0, 0))
    with pytest.raises(vv.InputError, match=r"all elements on one side"):
        vv.SectionForce(solid=solid, point=(5, 0, 0), normal=(1, 0, 0))
    with pytest.raises(vv.InputError, match=r"x00.*did you mean .x0"):
        vv.SupportForce(solid=solid, nodes="x00")


@pytest.mark.parametrize(
    "probe",
    [
        lambda b: vv.Position(of=b),
        lambda b: vv.Velocity(of=b),
        lambda b: vv.CentreOfMass(of=b),
        lambda b: vv.SquaredDistance(a=b.point(), b=b.point()),
    ],
)
def test_probes_of_another_system_are_refused(probe: Any) -> None:
    """Its unknowns have numbers that are those of others here."""
    a, b = vv.PointMass(mass=1.0, position=(4, 0, 0), name="a"), vv.PointMass(mass=1.0, name="b")
    here, _ = vv.System([a]), vv.System([b])
    with pytest.raises(vv.InputError, match="'b' is not in this system but in another"):
        probe(b)(here)
    with pytest.raises(vv.InputError, match="'b' is not in this system but in another"):
        vv.simulate(here, until=1.0, step=0.5, record=[probe(b)])
    with pytest.raises(vv.InputError, match="'b' is not in this system but in another"):
        vv.simulate(here, until=2.0, step=0.5).history(probe(b))


def test_fields_of_bodies_that_do_not_move() -> None:
    """Linear in place, as their cells hold it."""
    mesh = vv.RectangleMesh(size=(1, 1), counts=(4, 4))

    def field(X: Array) -> Array:
        return 0.3 + 0.1 * X[:, 0] - 0.2 * X[:, 1]

    mixed = vv.CahnHilliard(
        mesh=mesh, free_energy=vv.DoubleWell(barrier=1.0), gradient_energy=1.0, concentration=field
    )
    warm = vv.ThermalBody(mesh=mesh, conductivity=1.0, temperature=field)
    system = vv.System([mixed, warm])
    for body, name in ((mixed, "concentration"), (warm, "temperature")):
        found = vv.FieldAt(solid=body, field=name, at=(0.3, 0.6, 0))(system)
        assert found == pytest.approx(0.3 + 0.03 - 0.12, abs=1e-14)


def heated(kind: str, field: Callable[[Array], Array]) -> vv.Component:
    """A body on a unit square, or a beam along one, of which nodes have what the field says."""
    square, heat = vv.RectangleMesh(size=(1, 1), counts=(2, 2)), vv.Heat(conductivity=1.0, capacity=5.0)
    soft = vv.NeoHooke(young=1e3, poisson=0.3)
    if kind == "solid":
        return vv.ThermoelasticSolid(mesh=square, material=soft, density=1.0, heat=heat, temperature=field)
    if kind == "shell":
        section = vv.SolidSection(material=soft, thickness=0.1, density=1.0)
        return vv.ThermalShell(mesh=square, section=section, heat=heat, temperature=field)
    if kind == "beam":
        bar = vv.RectangleSection(width=0.1, height=0.1, young=1e3, density=1.0)
        line = vv.LineMesh(points=[(0, 0, 0), (1, 0, 0)], count=4)
        return vv.ThermalBeam(mesh=line, section=bar, heat=heat, temperature=field)
    if kind == "crack":
        stiff = vv.SaintVenantKirchhoff(young=1e3, poisson=0.3)
        return vv.FracturingSolid(mesh=square, material=stiff, toughness=1.0, length=1.0, damage=field)
    assert kind == "body"
    return vv.ThermalBody(mesh=square, conductivity=1.0, temperature=field)


@pytest.mark.parametrize("kind", ["solid", "shell", "beam", "crack", "body"])
def test_extremes_of_what_nodes_have_are_theirs(kind: str) -> None:
    """They were not found where stresses are asked for, or refused."""
    name, low, rise = ("damage", 0.1, 0.7) if kind == "crack" else ("temperature", 300.0, 50.0)
    body = heated(kind, lambda X: low + rise * X[:, 0])
    system = vv.System([body])
    found = [vv.Extreme(solid=body, field=name, which=which)(system) for which in ("min", "max")]
    weak = kind in ("solid", "shell", "beam")  # whose temperatures follow from entropies at the nodes
    assert found == pytest.approx([low, low + rise], rel=1e-3 if weak else 1e-12)


@pytest.mark.parametrize("cell", ["hex8", "wedge6", "tet4"])
@pytest.mark.parametrize("place", [0.26, 0.49, 1.0])
def test_section_along_a_held_face_bears_all_of_the_load(cell: str, place: float) -> None:
    """Nodes of the section that are held gave a part of the support's force to what is in front: 7.1 for 10."""
    box = vv.BoxMesh(size=(3, 1, 1), counts=(6, 2, 2), cell=cell)
    bar = vv.Solid(mesh=box, material=vv.SaintVenantKirchhoff(young=1e3, poisson=0.3))
    pull = vv.Traction(solid=bar, faces="x1", traction=(10.0, 0, 0), times="t")
    system = vv.System([bar, vv.Fixed(solid=bar, nodes="x0"), pull])
    vv.quasi_static(system, until=1.0, step=0.5)
    section = vv.SectionForce(solid=bar, point=(place, 0.5, 0.5), normal=(1, 0, 0))
    assert section(system) == pytest.approx([10, 0, 0], abs=1e-9)
