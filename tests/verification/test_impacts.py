"""Bars that collide, against the solution of the wave equation."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from visviva.component import Component

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
        speed.append([b.nodal_mass @ b.velocities(s.v)[:, 0] / b.mass for b in (one, two)])

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
