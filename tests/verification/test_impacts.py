"""Bodies that collide against waves and over thousands of steps, and the order of contact that persists."""

from __future__ import annotations

import runpy
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from verification.measure import orders
from visviva.component.component import Component

Array = NDArray[np.float64]
Parts = list[Component]

KINDS: dict[str, dict[str, Any]] = {
    "dissipative": {},
    "conserving": {"impact": "conserving"},
}


# --- two bars -----------------------------------------------------------------------------------------------
def bars(lengths: tuple[float, float], speeds: tuple[float, float], n: int, **options: Any) -> Parts:
    """Two bars of E = 900, rho = 1 (c = 30) in a row, 0.1 apart, with `n` cells by length 10."""
    material = vv.LinearElastic(young=900.0, poisson=0.0)
    rods = [
        vv.Solid(
            mesh=vv.RectangleMesh(size=(length, 1), counts=(round(n * length / 10), 1), origin=(x, 0)),
            material=material,
            density=1.0,
            velocity=(v, 0, 0),
        )
        for length, x, v in zip(lengths, (-lengths[0] - 0.1, 0.0), speeds, strict=True)
    ]
    contact = vv.Contact(first=rods[0], second=rods[1], first_faces="x1", second_faces="x0", **options)
    guides = [vv.Fixed(solid=rod, nodes="all", directions=(0, 1, 0)) for rod in rods]
    return [*rods, contact, *guides]


def collide(parts: Parts, until: float, h: float) -> tuple[vv.Result, Array, Array, Array]:
    """Result, times, contact force in each step, and mean velocities (steps, 2) of both bars."""
    one, two, contact, *_ = parts
    assert isinstance(one, vv.Solid)
    assert isinstance(two, vv.Solid)
    assert isinstance(contact, vv.Contact)
    time, force, speed = [0.0], [], []

    def observe(s: vv.System) -> None:
        time.append(s.time)
        force.append(-vv.ContactForce(contact=contact)(s)[0])
        speed.append([b.nodal_mass @ b.velocities(s.x, s.v)[:, 0] / b.mass for b in (one, two)])

    result = vv.simulate(vv.System(parts), until=until, step=h, observe=observe)
    return result, np.array(time), np.array(force), np.array(speed)


@pytest.mark.parametrize("kind", KINDS)
def test_unlike_bars_exchange_momentum(kind: str) -> None:
    """A bar of length 10 at speed 10 hits one of length 20 at rest: the stress rho c v / 2 = 150 acts for 2 L / c.

    Then the first bar is at rest without stress; the other has all its momentum, moves with 5 and keeps half of
    the energy as a wave. After 0.01 of free flight they touch for 0.6667.
    """
    result, time, force, speed = collide(bars((10, 20), (10, 0), 40, **KINDS[kind]), 0.72, 0.004)
    total, plateau = result.ledger["total"], force[(time[1:] > 0.1) & (time[1:] < 0.6)]
    assert plateau.mean() == pytest.approx(150, rel=0.01)
    assert np.diff(time) @ force == pytest.approx(100, rel=0.01)
    assert speed[-1] == pytest.approx([0, 5], abs=0.1)
    result.assert_conserved("energy", "momentum_x", tolerance=1e-9)
    assert np.max(total - total[0]) < 1e-9 * total[0]
    if kind != "dissipative":
        assert np.abs(total - total[0]).max() < 1e-9 * total[0]


# --- thousands of steps -------------------------------------------------------------------------------------
def rattle(dimension: int, **options: Any) -> Parts:
    """A soft block that flies askew in a free box and bounces off its walls and corners; both tumble."""
    rubber = vv.NeoHooke(young=100.0, poisson=0.3)
    shape: Any = vv.BoxMesh if dimension == 3 else vv.RectangleMesh
    frame = shape(size=(3,) * dimension, counts=(3,) * dimension).build()
    (name,) = frame.cells
    centres = frame.points[frame.cells[name]].mean(axis=1)
    walls = frame.cells[name][np.any(np.abs(centres - 1.5) > 0.6, axis=1)]
    used, cells = np.unique(walls, return_inverse=True)
    box = vv.Solid(
        mesh=vv.Mesh(frame.points[used], {name: cells.reshape(walls.shape)}), material=rubber, density=1.0
    )
    small = (
        shape(size=(0.5,) * dimension, counts=(1,) * dimension).build().moved((1.22, 1.27, 1.31)[:dimension])
    )
    velocity = (1.1, 0.7, 0.4 * (dimension == 3))
    turning = (0.3 * (dimension == 3), 0, 0.8)
    block = vv.Solid(mesh=small, material=rubber, density=1.0, velocity=velocity, angular_velocity=turning)
    contact = vv.Contact(first=block, second=box, formulation="node-to-segment", **options)
    return [block, box, contact]


@pytest.mark.parametrize("kind", ["conserving", "penalty"])
def test_thousands_of_steps_with_dozens_of_impacts(kind: str) -> None:
    """Energy and momenta stay at round-off, though the block hits the walls again and again."""
    options = {"impact": "conserving"} if kind == "conserving" else {"enforcement": "penalty"}
    parts, steps, h = rattle(2, **options), 4000, 0.01
    contact = parts[2]
    assert isinstance(contact, vv.Contact)
    touches: list[bool] = []
    system = vv.System(parts, vv.Newton(tolerance=1e-13))
    result = vv.simulate(
        system,
        until=steps * h,
        step=h,
        every=10**6,
        observe=lambda _: touches.append(bool(contact.pressures.max() > 0)),
    )
    impacts = int(np.sum(np.diff(np.array(touches, dtype=int)) > 0))
    momenta = ["momentum_x", "momentum_y", "angular_z"]
    total = result.ledger["total"]
    drift = float(np.abs(total - total[0]).max() / total[0])
    assert impacts > steps / 200
    assert drift < 1e-10
    result.assert_conserved("energy", *momenta, tolerance=1e-10)


@pytest.mark.parametrize("kind", ["conserving", "penalty", "dissipative"])
def test_balls_in_a_box_keep_energy_and_momenta(kind: str) -> None:
    """Three free bodies in space, mortar segments, 250 steps with a dozen impacts; `benchmarks/impacts.py` takes
    thousands. At t = 4.38 facets of the balls hardly lie above each other."""
    benchmark = runpy.run_path(str(Path(__file__).parents[2] / "benchmarks" / "impacts.py"))
    parts, contacts = benchmark["balls_in_a_box"](**benchmark["KINDS"][kind])
    touches: list[list[bool]] = []
    result = vv.simulate(
        vv.System(parts),
        until=5.0,
        step=0.02,
        observe=lambda _: touches.append([bool(c.pressures.max() > 0) for c in contacts]),
    )
    impacts = (np.diff(np.array(touches, dtype=int), axis=0) > 0).sum(axis=0)
    assert impacts.min() >= 1
    assert impacts.sum() >= 10
    momenta = [f"{what}_{axis}" for what in ("momentum", "angular") for axis in "xyz"]
    result.assert_conserved("energy", *momenta, tolerance=1e-11)
    total = result.ledger["total"]
    assert np.max(total - total[0]) < 1e-12 * total[0]
    assert np.diff(total).max() < 1e-12 * total[0]
    if kind == "dissipative":
        assert total[-1] < 0.9 * total[0]
    else:
        assert np.abs(total - total[0]).max() < 1e-12 * total[0]


# --- order in time ------------------------------------------------------------------------------------------
def persistent(dimension: int, **options: Any) -> Parts:
    """A block that a load, growing from nothing, presses onto a layer while it slides along it without friction."""
    rubber = vv.NeoHooke(young=100.0, poisson=0.3)
    shape: Any = vv.BoxMesh if dimension == 3 else vv.RectangleMesh
    below = shape(
        size=(3, 2, 1)[:dimension] if dimension == 3 else (3, 1), counts=(3,) + (2,) * (dimension - 1)
    )
    mesh = shape(size=(1,) * dimension, counts=(2,) * dimension).build()
    above = mesh.moved((0.4, 0.5, 1.0) if dimension == 3 else (0.4, 1.0))
    axis = "xyz"[dimension - 1]
    layer = vv.Solid(mesh=below, material=rubber, density=1.0)
    block = vv.Solid(mesh=above, material=rubber, density=1.0, velocity=(0.3, 0, 0))
    load = tuple(-20.0 * np.eye(3)[dimension - 1])
    return [
        block,
        layer,
        vv.Contact(first=block, second=layer, first_faces=f"{axis}0", second_faces=f"{axis}1", **options),
        vv.Fixed(solid=layer, nodes=f"{axis}0"),
        vv.BodyForce(solid=block, force=load, times="t**2*(3 - 2*t)"),
    ]


@pytest.mark.parametrize(
    "options", [{}, {"enforcement": "penalty", "stiffness": 2e3}], ids=["multipliers", "penalty"]
)
def test_persistent_mortar_contact_is_of_second_order(options: dict[str, Any]) -> None:
    """Positions at t = 0.8 against steps half as long each time."""
    ends = []
    for h in (0.04, 0.02, 0.01, 0.005):
        system = vv.System(persistent(2, **options), vv.Newton(tolerance=1e-12))
        vv.simulate(system, until=0.8, step=h)
        ends.append(system.x[system.order == 2].copy())
    change = [float(np.abs(b - a).max()) for a, b in pairwise(ends)]
    assert (orders(change) > 1.9).all()
