"""Pressures of contact leave the equations before these are solved, and nothing else changes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from contact_parts import RUBBER, bricks, contact_of, plates, pushed
from numpy.typing import NDArray
from point_contacts import on_shape

import visviva as vv
from visviva.component.component import Component

Array = NDArray[np.float64]

DUAL: dict[str, Any] = {"multipliers": "dual"}
VERTICES: dict[str, Any] = {"formulation": "node-to-segment"}


def pressed_arch(**options: Any) -> list[Component]:
    """A curved block of its own mesh on a clamped one in the plane, pushed down and aside."""
    lower = vv.RectangleMesh(size=(1.4, 0.5), counts=(9, 3), origin=(-0.2, -0.5)).build()
    upper = vv.RectangleMesh(size=(1, 0.4), counts=(8, 3)).build()
    X = upper.points.copy()
    X[:, 1] += 0.15 * (X[:, 0] - 0.5) ** 2
    arch = vv.Mesh(X, upper.cells, face_sets=upper.face_sets, node_sets=upper.node_sets)
    under, over = (vv.Solid(mesh=m, material=RUBBER) for m in (lower, arch))
    return [
        under,
        over,
        vv.Fixed(solid=under, nodes="y0"),
        vv.Prescribed(solid=over, nodes="y1", motion=("0.1 * t", "-0.06 * t", None)),
        vv.Contact(first=over, first_faces="y0", second=under, second_faces="y1", **options),
    ]


def static(components: list[Component] | vv.System) -> tuple[vv.System, vv.Result]:
    system = components if isinstance(components, vv.System) else vv.System(components)
    return system, vv.quasi_static(system, until=1.0, step=0.25)


def impact(components: list[Component]) -> tuple[vv.System, vv.Result]:
    system = vv.System(components)
    return system, vv.simulate(system, until=0.3, step=0.01)


CASES: dict[str, tuple[Callable[..., tuple[vv.System, vv.Result]], dict[str, Any]]] = {
    "blocks in statics": (lambda **o: static(pushed(4, **o)[0]), DUAL),
    "arch in statics": (lambda **o: static(pressed_arch(**o)), DUAL),
    "arch in statics, vertices": (lambda **o: static(pressed_arch(**o)), VERTICES),
    "bricks, dissipative": (lambda **o: impact(bricks(**o)), DUAL),
    "bricks, conserving": (lambda **o: impact(bricks(impact="conserving", **o)), DUAL),
    "plates, dissipative": (lambda **o: impact(plates(**o)), DUAL),
    "plates, conserving": (lambda **o: impact(plates(impact="conserving", **o)), DUAL),
    "quadratic plates": (lambda **o: impact(plates("quad8", impact="conserving", **o)), DUAL),
    "quadratic plates with a gap": (
        lambda **o: impact(plates("quad8", impact="conserving", gap=0.01, **o)),
        DUAL,
    ),
    "biquadratic plates, dissipative": (lambda **o: impact(plates("quad9", **o)), DUAL),
    "plates, vertices": (lambda **o: impact(plates(impact="conserving", **o)), VERTICES),
    "a brick on a sphere": (lambda **o: impact(on_shape("sphere", **o)), {}),
}


@pytest.mark.parametrize("name", CASES)
def test_condensed_pressures_change_nothing(name: str) -> None:
    """Positions, pressures and the number of Newton's iterations are those with pressures among the equations."""
    run, options = CASES[name]
    (kept, one), (condensed, two) = (run(condensed=c, **options) for c in (False, True))
    contact = contact_of(condensed.components)
    assert condensed.core.n_exchanged == len(contact.pressures)
    assert condensed.core.n_equations == kept.core.n_equations - condensed.core.n_exchanged
    assert "condensed" in condensed.linear_explanation
    assert "condensed" not in kept.linear_explanation
    m = kept.n_coordinates
    assert np.abs(kept.x[:m] - condensed.x[:m]).max() < 1e-11 * np.ptp(kept.x[:m])
    pressures = contact_of(kept.components).pressures
    assert np.abs(pressures - contact.pressures).max() < 1e-8 * max(1.0, np.abs(pressures).max())
    assert one.statistics.iterations == two.statistics.iterations


@pytest.mark.parametrize(("build", "what"), [(bricks, "xyz"), (plates, "z")])
def test_nothing_is_lost_over_hundreds_of_steps(build: Callable[..., list[Component]], what: str) -> None:
    """Blocks that hit each other, part and turn: energy, linear and angular momentum."""
    parts = build(impact="conserving", condensed=True, **DUAL)
    result = vv.simulate(vv.System(parts), until=3.0, step=0.01)
    assert len(result.times) == 301
    angular = [f"angular_{axis}" for axis in what]
    result.assert_conserved("energy", "momentum_x", "momentum_y", *angular, tolerance=1e-10)


@pytest.mark.parametrize("condensed", [False, True])
@pytest.mark.parametrize(("build", "what"), [(bricks, "xyz"), (plates, "z")])
def test_dissipative_impacts_never_give_energy(
    build: Callable[..., list[Component]], what: str, condensed: bool
) -> None:
    """Blocks hit each other and part, with steps in which they slide: energy falls or stays in each, momenta stay."""
    parts = build(gap=0.05, condensed=condensed, **DUAL)
    contact, touches = contact_of(parts), []
    result = vv.simulate(
        vv.System(parts), until=3.0, step=0.01, observe=lambda _: touches.append(contact.pressures.max() > 0)
    )
    total = result.ledger["total"]
    assert 5 < sum(touches) < 290
    assert np.diff(total).max() < 1e-12 * total[0]
    assert 0.01 < 1 - total[-1] / total[0] < 0.5
    angular = [f"angular_{axis}" for axis in what]
    result.assert_conserved("energy", "momentum_x", "momentum_y", *angular, tolerance=1e-10)


def test_dual_multipliers_see_their_own_node_alone() -> None:
    """Where surfaces lie on each other, a pressure's force on the first one is on one node; standard ones spread."""
    for multipliers, alone in (("dual", True), ("standard", False)):
        system, over = pushed(3, multipliers=multipliers)
        contact = contact_of(system.components)
        vv.quasi_static(system, until=1e-9, step=1e-9)
        step = vv.Static().step(system.time, 1e-9)
        system.core.dx[:] = 0
        K = system.tangent(step)[1]
        number = np.searchsorted(system.free_unknowns, over.node_unknowns(over.faces("z0").nodes) + 2)
        pressures = np.searchsorted(system.free_unknowns, contact.pressure.unknowns)
        forces = K[number][:, pressures].toarray()
        touching = np.diag(forces) != 0
        assert touching.sum() > 8
        across = np.abs(forces - np.diag(np.diag(forces))).max() / np.abs(np.diag(forces)).max()
        assert (across < 1e-6) == alone


def test_a_node_that_two_contacts_press_on_keeps_one_pressure() -> None:
    """A block in a corner: nodes of its edge touch two walls; the second pressure stays among the equations."""
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2))
    results = []
    for condensed in (False, True):
        block = vv.Solid(mesh=mesh, material=RUBBER, density=1.0, velocity=(0.5, 0, -1.0))
        floor = vv.Plane(at=(0, 0, -0.005), normal=(0, 0, 1))
        wall = vv.Plane(at=(1.005, 0, 0), normal=(-1, 0, 0))
        contacts = [vv.Contact(first=block, second=s, condensed=condensed) for s in (floor, wall)]
        system = vv.System([block, floor, wall, *contacts])
        vv.simulate(system, until=0.1, step=0.01)
        results.append(system.x.copy())
        if condensed:
            n = len(contacts[0].pressures)
            assert system.core.n_exchanged == n
    assert np.abs(results[0] - results[1])[: 3 * block.grid.n_nodes].max() < 1e-11
