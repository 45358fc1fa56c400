"""Boxes that slide flush without friction, rigid or of bricks: what comes back over an edge is not tripped."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import visviva as vv


def faceted(size: tuple[float, ...]) -> vv.SurfaceMesh:
    """A box of triangles."""
    points, corners = vv.Box(size=size).facets()
    halves = [[int(c[i]) for i in half] for c in corners for half in ((0, 1, 2), (0, 2, 3))]
    return vv.SurfaceMesh(points=[tuple(float(x) for x in p) for p in points], triangles=halves)


def sliding(seed: int, order: int, facets: bool, stiffness: float) -> tuple[vv.System, vv.RigidBody, Any]:
    """A box thrown along another one that is held; sizes, places, turns and ways are by chance."""
    rng = np.random.default_rng(seed)
    lower = (rng.uniform(0.3, 1.0), rng.uniform(0.3, 1.0), 0.1)
    upper = (rng.uniform(0.1, 0.8), rng.uniform(0.1, 0.8), 0.1)
    way = rng.uniform(0, 2 * np.pi)
    place = rng.uniform(-0.8, 0.8, 2) * np.array(lower[:2]) / 2
    turn = rng.choice([0.0, rng.uniform(0, np.pi)])
    c, s, ground = np.cos(turn), np.sin(turn), vv.Ground()
    shape = faceted if facets else lambda size: vv.Box(size=size)
    below = vv.RigidBody(shape=shape(lower), density=1e3)
    velocity = 0.5 * np.array([np.cos(way), np.sin(way)])
    above = vv.RigidBody(
        shape=shape(upper),
        density=1e3,
        position=(*place, 0.1),
        rotation=[[c, -s, 0], [s, c, 0], [0, 0, 1]],
        velocity=(*velocity, 0),
    )
    first, second = (above, below)[::order]
    contact = vv.Contact(first=first, second=second, enforcement="penalty", stiffness=stiffness)
    held = vv.Rigid(a=ground, b=below, at=(0, 0, 0))
    return vv.System([ground, below, above, held, contact, vv.Gravity()]), above, velocity


CASES = [(1, 1), (4, 1), (7, 1), (9, 1), (14, 1), (0, -1), (2, -1), (8, -1)]


@pytest.mark.parametrize("facets", [False, True])
@pytest.mark.parametrize(("seed", "order"), CASES)
def test_boxes_that_slide_flush_keep_their_momentum(seed: int, order: int, facets: bool) -> None:
    """The penalty lets them sink, and corners that hang over an edge come back below the face: they were pushed out of
    the wall there, by up to all of the speed. What is left are tilts by the depth."""
    system, above, velocity = sliding(seed, order, facets, stiffness=1e7)
    result = vv.simulate(system, until=0.44, step=1e-3)
    assert vv.Velocity(of=above)(system)[:2] == pytest.approx(velocity, abs=1e-3 * 0.5)
    result.assert_conserved("energy", tolerance=1e-9)


def sliding_off(stiffness: float, faces: str = "all") -> tuple[vv.System, vv.RigidBody, float]:
    """A box that leaves the edge of another one with two of its corners, and the energy of their springs."""
    lower, upper = (
        vv.RigidBody(shape=vv.Box(size=size), density=1e3) for size in ((1, 1, 0.1), (0.4, 0.2, 0.1))
    )
    mass, k, ground = 8.0, stiffness, vv.Ground()
    depth = mass * 9.81 / 4 / k
    upper = vv.RigidBody(
        shape=vv.Box(size=(0.4, 0.2, 0.1)), density=1e3, position=(0.25, 0, 0.1 - depth), velocity=(0.5, 0, 0)
    )
    contact = vv.Contact(
        first=upper, second=lower, first_faces=faces, enforcement="penalty", stiffness=k, initial="press"
    )
    system = vv.System(
        [ground, lower, upper, vv.Rigid(a=ground, b=lower, at=(0, 0, 0)), contact, vv.Gravity()]
    )
    return system, upper, 2 * k * depth**2 / 2


def test_what_slides_off_loses_the_energy_of_its_springs_alone() -> None:
    """The contact books it, and it vanishes with the depth: 1/4 of m^2 g^2 / 2 k at each of two corners. Where edges
    go on with what these hold, nothing is lost."""
    system, upper, energy = sliding_off(stiffness=1e6, faces="z0")
    result = vv.simulate(system, until=0.11, step=1e-3)
    assert vv.Velocity(of=upper)(system)[0] == pytest.approx(0.5, rel=1e-4)
    assert result.ledger["work_contact"][-1] == pytest.approx(-energy, rel=1e-3)
    result.assert_conserved("energy", tolerance=1e-10)
    system, upper, _ = sliding_off(stiffness=1e6)
    result = vv.simulate(system, until=0.16, step=1e-3)
    assert vv.Velocity(of=upper)(system)[0] == pytest.approx(0.5, rel=1e-4)
    assert result.ledger["total"] == pytest.approx(result.ledger["total"][0], abs=1e-9 * energy)


@pytest.mark.parametrize("scheme", [vv.Midpoint(), vv.GeneralizedAlpha(), vv.BDF2(), vv.BackwardEuler()])
def test_every_scheme_books_what_slides_off(scheme: vv.Scheme) -> None:
    """Those that balance forces at the ends of steps, whose books go back along them, took off half of it."""
    system, _, energy = sliding_off(stiffness=1e6, faces="z0")
    result = vv.simulate(system, until=0.102, step=2.5e-4, scheme=scheme)
    work, imbalance = result.ledger["work_contact"], result.ledger["imbalance"]
    assert work[-1] == pytest.approx(-energy, rel=1e-3)
    leaves = np.argmin(np.diff(work))
    assert abs(np.diff(imbalance)[leaves]) < 0.1 * energy  # what the scheme dissipates in this step


def test_runs_go_on_with_the_energy_that_they_stopped_with() -> None:
    """Corners that have come back over an edge, so deep that they store nothing there, when the first run stops."""
    system, _, _ = sliding_off(stiffness=1e6)
    first = vv.simulate(system, until=0.13, step=1e-3)
    second = vv.simulate(system, until=0.16, step=1e-3)
    assert second.ledger["potential_contact"][0] == first.ledger["potential_contact"][-1]
    assert second.ledger["total"][0] == pytest.approx(first.ledger["total"][-1], rel=1e-14)
    second.assert_conserved("energy", tolerance=1e-10)


def sliding_solids(
    seed: tuple[int, int], enforcement: str, young: float, lower_first: bool = False
) -> tuple[vv.System, vv.Solid, Any]:
    """A block of bricks thrown along another one, which is held below. Nodes of it hang over and come back, and those
    above the lower block stay around its middle."""
    rng = np.random.default_rng(seed)
    size = (rng.uniform(0.2, 0.5), rng.uniform(0.2, 0.5), 0.1)
    way, turn = rng.uniform(0, 2 * np.pi), rng.choice([0.0, rng.uniform(0, np.pi)])
    place = (*rng.uniform(-0.35, 0.35, 2), 0.1)
    c, s = np.cos(turn), np.sin(turn)
    upper = vv.BoxMesh(size=size, counts=(3, 3, 1), origin=tuple(-x / 2 for x in size)).build()
    upper = replace(upper, points=upper.points @ [[c, s, 0], [-s, c, 0], [0, 0, 1]] + place)
    lower = vv.BoxMesh(size=(0.8, 0.6, 0.1), counts=(4, 4, 1), origin=(-0.4, -0.3, -0.05)).build()
    velocity = 0.5 * np.array([np.cos(way), np.sin(way), 0])
    material = vv.NeoHooke(young=young, poisson=0.3)
    below = vv.Solid(mesh=lower, material=material, density=1e3)
    above = vv.Solid(mesh=upper, material=material, density=1e3, velocity=velocity)
    first, second = (below, above) if lower_first else (above, below)
    contact = vv.Contact(first=first, second=second, formulation="node-to-segment", enforcement=enforcement)
    parts = [below, above, vv.Fixed(solid=below, nodes="z0"), contact, vv.Gravity()]
    return vv.System(parts), above, velocity


def mean_velocity(system: vv.System, solid: vv.Solid) -> Any:
    """Of the mass of equal bricks."""
    (bricks,) = solid.mesh.cells.values()
    nodes = solid.node_unknowns(bricks.ravel())[:, None] + np.arange(3)
    return system.v[nodes].mean(axis=0)


SOLIDS = {
    ("multipliers", 1e6): [(3, 1), (4, 4), (5, 19), (7, 9), (10, 0), (11, 3)],
    ("penalty", 1e7): [(0, 1), (1, 5), (2, 2), (3, 1), (5, 19), (6, 3)],
}


@pytest.mark.parametrize(
    ("enforcement", "young", "seed"), [(*how, seed) for how, seeds in SOLIDS.items() for seed in seeds]
)
def test_solids_that_slide_flush_keep_their_momentum(
    seed: tuple[int, int], enforcement: str, young: float
) -> None:
    """Nodes that hang over an edge sag, and came back past the wall below the face: the gap jumped there, and its force
    acted along the motion, or no step converged. What is left are tilts by the sag, which goes with 1 / E."""
    system, above, velocity = sliding_solids(seed, enforcement, young)
    worst = 0.0

    def observe(system: vv.System) -> None:
        nonlocal worst
        worst = max(worst, np.abs(mean_velocity(system, above) - velocity)[:2].max())

    result = vv.simulate(system, until=0.24, step=4e-3, observe=observe)
    assert worst < 1e4 / young * 0.5
    if enforcement == "penalty":
        result.assert_conserved("energy", tolerance=1e-9)


@pytest.mark.parametrize("enforcement", ["penalty", "multipliers"])
def test_solids_that_fall_between_nodes_of_the_first_are_refused(enforcement: str) -> None:
    """The lower block's nodes are 0.2 m apart: the upper one tipped over the last of them into it, by more than its
    thickness, and was stopped by that."""
    system, _, _ = sliding_solids((5, 19), enforcement, 1e7, lower_first=True)
    with pytest.raises(
        vv.StepFailure, match=r"sink into each other.*vertices of .* alone touch.*exchange first"
    ):
        vv.simulate(system, until=0.24, step=4e-3)
