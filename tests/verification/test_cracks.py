"""Cracks that run: through a notched plate to and fro and through its snap-back, beside contact, joints and heat."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from visviva.examples import branching, surfing

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))
import notched_plate
import three_point_bending

Array = NDArray[np.float64]

TOUGHNESS, LENGTH = 1e-6, 0.1


def plate_mesh(n: int = 20, half: float = 0.5) -> vv.Mesh:
    """A unit square with a notch from the left to its middle."""
    square = vv.RectangleMesh(size=(1, 2 * half), counts=(n, n), origin=(0, -half)).build()
    return square.opened(lambda X: (np.abs(X[:, 1]) < 1e-9) & (X[:, 0] < 0.5 - 1e-9), lambda X: X[:, 1] > 0)


def plate(**options: Any) -> vv.FracturingSolid:
    given: dict[str, Any] = {
        "mesh": plate_mesh(),
        "material": vv.SaintVenantKirchhoff(young=1.0, poisson=0.2),
        "toughness": TOUGHNESS,
        "length": LENGTH,
        **options,
    }
    return vv.FracturingSolid(**given)


def pulled(solid: vv.FracturingSolid, *more: vv.Component) -> vv.System:
    held = vv.Fixed(solid=solid, nodes="y0")
    return vv.System([solid, held, *more, vv.Prescribed(solid=solid, nodes="y1", motion=(0, "3e-3*t", None))])


@pytest.mark.parametrize("floor", [-0.5, 1e3, -1e6])
def test_to_and_fro_ends_where_it_does_wherever_heights_are_measured_from(floor: float) -> None:
    """The potential of the weight has any constant; gone to and fro by it, the crack stopped half way."""
    ends = []
    for low in (0.0, floor):
        mesh = vv.RectangleMesh(size=(1, 1), counts=(8, 8), origin=(0, low))
        solid = plate(mesh=mesh, length=0.25, density=1e-6)
        weight = vv.Gravity(acceleration=(0, -9.81, 0))
        system = pulled(solid, weight)
        vv.quasi_static(system, until=0.5, step=0.25, scheme=vv.AlternateMinimization())
        ends.append(solid.damages(system.x))
    assert ends[0].max() > 0.9
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-4)


def forces(
    solid: vv.FracturingSolid, scheme: vv.Static, step: float, steps: int
) -> tuple[Array, Array, Array]:
    """Times, forces and areas of the crack."""
    system, found = pulled(solid), []
    probe, area = vv.SupportForce(solid=solid, nodes="y1"), vv.CrackArea(solid=solid)
    for _ in vv.march(system, until=1.0, step=step, scheme=scheme):
        found.append((system.time, float(probe(system)[1]), area(system)))
        if len(found) == steps or found[-1][1] < 0.2 * max(f for _, f, _ in found):
            break
    return tuple(np.array(found).T)  # type: ignore[return-value]


@pytest.mark.parametrize("model", ["AT1", "AT2"])
def test_the_peak_stays_where_it_is_when_load_steps_are_halved(model: Any) -> None:
    """And both ways through: to and fro, which jumps, and along the path, which snaps back."""
    scheme = vv.AlternateMinimization(newton=4, unstable=True, energy_tolerance=1e-6)
    peaks = [forces(plate(model=model), scheme, h, 200)[1].max() for h in (0.02, 0.01)]
    assert peaks[0] == pytest.approx(peaks[1], rel=0.01)
    t, force, area = forces(plate(model=model), vv.CrackControl(growth=0.02, unstable=True), 0.02, 80)
    assert force.max() == pytest.approx(peaks[1], rel=0.01)
    if model == "AT1":
        assert (np.diff(t) < 0).any(), "no snap-back"
    assert (np.diff(area) > -1e-12).all()
    assert area[-1] > 0.3


def test_energy_that_a_crack_takes_is_what_the_load_has_done() -> None:
    """Along the path nothing is lost: the work of the load is elastic and crack energy, to second order in the step."""
    errors = []
    for growth in (0.04, 0.02):
        system = pulled(plate())
        scheme = vv.CrackControl(growth=growth, unstable=True)
        result = vv.arc_length(system, step=2 * growth, scheme=scheme, steps=round(0.9 / growth))
        errors.append(result.conservation()["energy"])
    assert errors[0] < 2e-3
    assert errors[1] < 0.4 * errors[0]


@pytest.mark.parametrize("model", ["AT1", "AT2"])
def test_toughness_with_what_the_cells_add(model: Any) -> None:
    """Gc (1 + 3h / 8l) and Gc (1 + h / 2l) within 2 %, by the crack's energy and by the work of the boundary."""
    study = surfing.study(model, length=0.05, until=0.42)
    surfing.check(vv.simulate(study.system, until=study.until, step=study.step, scheme=study.scheme))


@pytest.mark.parametrize("scheme", [vv.AlternateMinimization(), vv.Static()], ids=str)
@pytest.mark.parametrize(("cell", "added"), [("quad4", 1 / 32), ("quad9", 0.0)])
@pytest.mark.parametrize("ratio", [8, 32])
def test_profile_of_a_crack_on_a_line_of_nodes(
    cell: str, added: float, ratio: int, scheme: vv.Static
) -> None:
    """AT1's (1 - x / 2l)^2 over cells of l / 8 and l / 32: Gc, and what its parabola takes in straight ones."""
    solid = plate(
        mesh=vv.RectangleMesh(size=(1, 0.2), counts=(10 * ratio, 2), cell=cell),
        damage=lambda X: 1.0 * (np.abs(X[:, 0] - 0.5) < 1e-9),
        model="AT1",
    )
    system = vv.System([solid, vv.Fixed(solid=solid, nodes="all")])
    vv.quasi_static(system, until=1.0, step=1.0, scheme=scheme)
    assert solid.crack_energy(system.x) / (0.2 * TOUGHNESS) == pytest.approx(1 + added / ratio**2, abs=1e-9)


def test_tip_area_and_energy_of_a_crack_that_is_there_from_the_start() -> None:
    """The profile exp(-|y| / l) of AT2 costs Gc per length, and where it ends the tip is."""
    mesh = vv.RectangleMesh(size=(1, 2), counts=(40, 200), origin=(0, -1)).build()
    crack = lambda X: np.where(X[:, 0] <= 0.5 + 1e-9, np.exp(-np.abs(X[:, 1]) / LENGTH), 0.0)  # noqa: E731
    solid = plate(mesh=mesh, damage=crack)
    system = vv.System([solid])
    end = LENGTH**2 / (2 * 0.025)  # of the gradient across the column of cells where damage ends at once
    assert vv.CrackArea(solid=solid)(system) == pytest.approx(0.5 + end, rel=0.02)
    assert vv.CrackEnergy(solid=solid)(system) == vv.CrackArea(solid=solid)(system) * TOUGHNESS
    whole = plate(mesh=mesh, damage=lambda X: np.exp(-np.abs(X[:, 1]) / LENGTH))
    assert vv.CrackArea(solid=whole)(vv.System([whole])) == pytest.approx(1.0, rel=2e-3)
    tip = vv.CrackTip(solid=solid, along=(1, 0, 0))(system)
    assert tip == pytest.approx((0.5 + 0.025 * 0.1, 0, 0), abs=1e-9)
    sound = plate()
    assert np.isnan(vv.CrackTip(solid=sound, along=(1, 0, 0))(vv.System([sound]))).all()


def test_a_mesh_that_is_cut_open_has_two_faces_there() -> None:
    mesh = plate_mesh(4)
    assert mesh.n_nodes == 27
    assert mesh.boundary().n_faces == 16 + 4
    assert mesh.volume == pytest.approx(1.0)
    with pytest.raises(vv.InputError, match="separates nothing"):
        mesh.opened(lambda X: X[:, 1] > 2, lambda X: X[:, 1] > 0)
    with pytest.raises(vv.InputError, match="separates nothing"):
        mesh.opened(lambda X: X[:, 0] < 0.1, lambda X: X[:, 1] > 2)


def test_lips_of_a_cut_are_sets_of_faces() -> None:
    """Of two cuts with each cell turned to one side, in the plane and in space, with nodes on edges."""
    plane = plate_mesh(4)
    lower, upper = plane.faces("slit0"), plane.faces("slit1")
    assert lower.n_faces == upper.n_faces == 2
    assert lower.area(plane.points) == upper.area(plane.points) == pytest.approx(0.5)
    (tip,) = np.intersect1d(lower.nodes, upper.nodes)
    assert plane.points[tip] == pytest.approx([0.5, 0.0], abs=1e-9)
    sides = [plane.centres[np.concatenate([*lip.owners.values()]), 1] for lip in (lower, upper)]
    assert sides[0].max() < 0 < sides[1].min()
    block = vv.BoxMesh(size=(1, 1, 1), counts=(4, 4, 4), cell="hex20").build()
    for height in (0.25, 0.75):
        block = block.opened(
            lambda X, z=height: (np.abs(X[:, 2] - z) < 1e-9) & (X[:, 0] < 0.5 - 1e-9),
            lambda X, z=height: X[:, 2] > z,
        )
    named = replace(block, node_sets={**block.node_sets, "slit0": np.array([0])})
    with pytest.raises(vv.InputError, match="there is a set of nodes 'slit0': give that another name"):
        named.opened(lambda X: X[:, 0] < 0, lambda X: X[:, 1] > 0)
    assert block.faces("slit0").area(block.points) == pytest.approx(1.0)
    assert block.faces("slit1").facing(block.points, (0, 0, -1)).n_faces == block.faces("slit1").n_faces == 16


def test_pressure_on_the_lips_opens_a_crack() -> None:
    """As much as tractions far away do: what a closed plate carries evenly is added (superposition)."""
    mesh, opened = plate_mesh(8), []
    mouth = mesh.select_nodes(lambda X: (np.abs(X[:, 1]) < 1e-9) & (X[:, 0] < 1e-9))
    right = mesh.select_nodes(lambda X: X[:, 0] > 1 - 1e-9)
    for faces in (("slit0", "slit1"), ("y0", "y1")):
        solid = vv.Solid(mesh=mesh, material=vv.LinearElastic(young=1.0, poisson=0.2))
        sign = 1e-3 if faces[0] == "slit0" else -1e-3
        loads = [vv.Pressure(solid=solid, faces=name, pressure=sign, follower=False) for name in faces]
        held = [
            vv.Fixed(solid=solid, nodes=right, directions=(True, False, False)),
            vv.Fixed(solid=solid, nodes=right[:1]),
        ]
        system = vv.System([solid, *held, *loads])
        vv.quasi_static(system, until=1.0, step=1.0)
        opened.append(np.ptp(solid.positions(system.x)[mouth, 1]))
    assert opened[0] == pytest.approx(opened[1], rel=1e-9)
    assert opened[0] > 1e-3


def test_growth_of_crack_control_is_asked_for() -> None:
    for growth in (0.0, -1.0):
        with pytest.raises(
            vv.InputError, match=r"^vv\.CrackControl: growth = .* is not positive; give the area"
        ):
            vv.CrackControl(growth=growth)


def test_a_cracking_body_that_is_jointed() -> None:
    """A plate hung on a hinge by a coupling of its edge falls, with a weight, and cracks; energy and momenta close."""
    solid = plate(density=1e-3, model="AT1")
    face = vv.RigidCoupling(solid=solid, faces="y1")
    weight = vv.RigidCoupling(solid=solid, faces="y0")
    ground = vv.Ground()
    hinge = vv.Revolute(a=ground, b=face, at=(0.5, 0.5, 0), axis=(0, 0, 1))
    load = vv.Force(on=weight.point((0.5, -0.5, 0)), force=(3e-4, -2e-3, 0))
    system = vv.System([ground, solid, face, weight, hinge, load])
    result = vv.simulate(system, until=0.5, step=0.01)
    assert solid.damages(system.x).max() > 0.5
    assert result.conservation()["energy"] < 1e-10


def test_a_cracking_body_that_is_touched() -> None:
    """A brick that flies against a wall by its face cracks where it must, and what it rebounds with is in the books."""
    solid = plate(
        mesh=vv.RectangleMesh(size=(1, 0.5), counts=(16, 8)),
        density=1.0,
        split="spectral",
        velocity=(-0.02, 0.0, 0.0),
        toughness=2e-5,
    )
    wall = vv.Plane(at=(-0.005, 0, 0), normal=(1, 0, 0))
    touch = vv.Contact(first=solid, first_faces="x0", second=wall)
    system = vv.System([solid, wall, touch])
    result = vv.simulate(system, until=3.0, step=0.02)
    assert result.conservation()["energy"] < 1e-9
    assert solid.damages(system.x).max() > 0.2


def test_a_cracking_body_that_is_heated() -> None:
    """A plate held by its ends cools all over: the stress of the bar, then a crack; heat's work closes the balance."""
    rate = 0.02
    solid = plate(
        mesh=vv.RectangleMesh(size=(1, 0.5), counts=(10, 5)),
        material=vv.SaintVenantKirchhoff(young=1.0, poisson=0.0),
        model="AT1",
        density=1e-4,
        free_strain=lambda t, X: np.full(len(X), -rate * t),
    )
    ends = [vv.Fixed(solid=solid, nodes=n, directions=(True, False, False)) for n in ("x0", "x1")]
    system = vv.System([solid, *ends, vv.Fixed(solid=solid, nodes=[0])])
    first, last = vv.Static(unstable=True), vv.EnergyMomentum()
    strength = np.sqrt(3 * TOUGHNESS / (8 * LENGTH)) / np.sqrt(2)  # it is held across its plane, too
    begin = strength / rate
    vv.quasi_static(system, until=0.9 * begin, step=0.1 * begin, scheme=first)
    assert solid.damages(system.x).max() < 1e-9
    found = solid.fields(system.x).first_piola[..., 0, 0]
    assert found == pytest.approx(0.9 * strength, rel=5e-3)
    result = vv.simulate(system, until=1.5 * begin, step=0.01 * begin, scheme=last)
    assert solid.damages(system.x).max() > 0.1
    assert result.conservation()["energy"] < 1e-10
    (work,) = np.diff(result.ledger["work_prescribed motion"][[0, -1]])
    (gained,) = np.diff(result.ledger["total"][[0, -1]])
    assert work == pytest.approx(gained, rel=1e-9)


def test_a_crack_branches_when_and_as_fast_as_it_does_with_others() -> None:
    """Borden et al. (2012): at 34 to 46 us, slower than 0.6 of Rayleigh's waves; here on coarse cells."""
    study = branching.study(until=50e-6)
    branching.check(vv.simulate(study.system, until=study.until, step=study.step))


def test_plate_and_beam_are_as_stiff_as_in_published_curves_before_they_crack() -> None:
    """Slopes of the digitised curves of Miehe et al. (2010): which supports they had decides by a third."""
    shear, beam = notched_plate.model(0.01, True, "none"), three_point_bending.beam(0.025, 0.1, 0.25)
    for system, side, axis, share, slope in ((shear, "y1", 0, 1, 63.0), (beam, "stand", 1, 2, 0.965)):
        vv.quasi_static(system, until=1e-5, step=1e-5, scheme=vv.Static())
        force = np.asarray(vv.SupportForce(solid=system.components[0], nodes=side)(system))
        assert share * abs(force[axis]) / 1e-5 == pytest.approx(slope, rel=0.03)
