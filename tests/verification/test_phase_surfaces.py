"""Mixtures on closed surfaces, and the examples of phase fields."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv
from visviva.body.space import MeshSpace
from visviva.examples import coarsening, drop_on_wall, solder, sphere_pattern, spinodal

PFHUB = vv.DoubleWell(barrier=5.0, low=0.3, high=0.7)


def sphere(radius: float, count: int, start: Any, cell: str = "hex27") -> vv.CahnHilliard:
    mesh = vv.SphereMesh(radius=radius, counts=(count, 1), cell=cell).build().surface("outer")  # type: ignore[arg-type]
    return vv.CahnHilliard(
        mesh=mesh, free_energy=PFHUB, gradient_energy=2.0, mobility=5.0, concentration=start
    )


def test_growth_of_a_surface_harmonic() -> None:
    """``-M l (f'' + kappa l)`` with ``l = 2 (2 + 1) / R^2``."""
    R = 5.0
    body = sphere(R, 2, lambda X: 0.5 + 1e-6 * (3 * (X[:, 2] / R) ** 2 - 1))
    system = vv.System([body])
    assert sum(float(t.size.sum()) for t in body.space.cells()) == pytest.approx(4 * np.pi * R**2, rel=1e-3)
    vv.simulate(system, until=1.0, step=0.02)
    top = int(np.argmax(body.points[:, 2]))
    eigenvalue = 6 / R**2
    rate = -5 * eigenvalue * (-0.8 + 2 * eigenvalue)
    assert np.log((body.values(system.x)[top] - 0.5) / 2e-6) == pytest.approx(rate, rel=5e-3)


def test_start_of_pfhub_1d() -> None:
    """Bulk part of the energy and mean of benchmark 1d on the sphere of radius 100; the jump at the seam costs 2e-3."""
    ball = vv.SphereMesh(radius=100.0, counts=(16, 1), cell="hex27").build()
    space = MeshSpace(ball.surface("outer"))
    c = space.fitted(sphere_pattern.start(space.grid.points))
    tables = space.cells()
    assert sum((t.size * PFHUB.values(t.at(c))).sum() for t in tables) == pytest.approx(930.0401441, rel=2e-3)
    mean = sum((t.size * t.at(c)).sum() for t in tables) / (4e4 * np.pi)
    assert mean == pytest.approx(0.5120776089, rel=1e-4)


def test_start_of_pfhub_1b() -> None:
    """The energy of the start without flux, 319.0432756141."""
    body = vv.CahnHilliard(
        mesh=vv.RectangleMesh(size=(200, 200), counts=(50, 50), cell="quad9"),
        free_energy=PFHUB,
        gradient_energy=2.0,
        concentration=spinodal.start,
    )
    system = vv.System([body])
    assert sum(body.energies(system.x)) == pytest.approx(319.0432756141, rel=1e-5)
    assert body.integral(system.x) / 4e4 == pytest.approx(0.502522769025, rel=1e-6)


@pytest.mark.parametrize(
    ("example", "options"),
    [
        (spinodal, {"until": 1.0}),
        (coarsening, {"until": 1.0}),
        (solder, {}),
        (drop_on_wall, {}),
        (sphere_pattern, {"until": 1.0}),
    ],
    ids=lambda x: getattr(x, "__name__", "")[17:],
)
def test_examples(example: Any, options: dict[str, Any]) -> None:
    """Those that take long for a moment only: their checks of what has separated need the whole run."""
    study = example.study(**options)
    adaptive = None if "until" in options else study.adaptive
    result = vv.simulate(
        study.system, until=study.until, step=study.step, scheme=study.scheme, adaptive=adaptive
    )
    if "until" in options:
        assert np.all(np.diff(result.ledger["potential_stored"]) < 0)
        assert result.conservation()["energy"] < 1e-9
    else:
        example.check(result)
