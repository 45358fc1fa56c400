"""Unknowns without rates follow from the others at the start: schemes that start from rates keep their order."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]

STRIP = vv.RectangleMesh(size=(8, 2), counts=(8, 2))
PHASES = {"free_energy": vv.DoubleWell(barrier=5.0, low=0.3, high=0.7), "gradient_energy": 2.0}
MEMORIES = [vv.BDF2(), vv.GeneralizedAlpha()]
FINE = 640


def waves(X: Array) -> Array:
    return 0.5 + 0.1 * np.cos(np.pi * X[:, 0] / 8) + 0.05 * np.cos(np.pi * X[:, 0] / 4)


def test_what_few_iterations_leave_is_found_by_factors_or_told_by_name(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Potentials in two iterations: what conjugate gradients left was taken for them."""
    ends = []
    for most in (1000, 2):
        monkeypatch.setattr("visviva.system.algebraic.MOST_LINEAR", most)
        system = separating()
        vv.simulate(system, until=0.1, step=0.1, scheme=vv.BDF2())
        ends.append(system.x.copy())
    assert ends[1] == pytest.approx(ends[0], rel=1e-9)
    monkeypatch.setattr("visviva.system.algebraic._factored", lambda K, b: np.full(len(b), np.nan))
    with pytest.raises(vv.RunError, match="2 iterations and factors do not find potential of CahnHilliard"):
        vv.simulate(separating(), until=0.1, step=0.1, scheme=vv.BDF2())


def separating() -> vv.System:
    return vv.System([vv.CahnHilliard(mesh=STRIP, mobility=5.0, concentration=waves, **PHASES)])


def keeping() -> vv.System:
    return vv.System([vv.AllenCahn(mesh=STRIP, mobility=0.5, conserved=True, order=waves, **PHASES)])


def swelling(**also: object) -> vv.System:
    alloy = vv.MixtureSolid(
        mesh=STRIP,
        material=vv.SaintVenantKirchhoff(young=10.0, poisson=0.3),
        eigenstrain=0.1,
        reference=0.5,
        mobility=5.0,
        concentration=waves,
        **PHASES,
        **also,
    )
    return vv.System([alloy, vv.Fixed(solid=alloy, nodes="x0")])


def contents(make: Callable[[], vv.System], scheme: vv.Scheme, n: int) -> Array:
    """At the end of a run of n steps."""
    system = make()
    vv.simulate(system, until=0.5, step=0.5 / n, scheme=scheme, every=n)
    return system.x[system.order == 1].copy()


@cache
def reference(make: Callable[[], vv.System]) -> Array:
    return contents(make, vv.EnergyMomentum(), FINE)


@pytest.mark.parametrize("make", [separating, keeping, swelling])
@pytest.mark.parametrize("scheme", MEMORIES, ids=str)
def test_order_from_the_first_step_on(scheme: vv.Scheme, make: Callable[[], vv.System]) -> None:
    coarse, fine = (np.abs(contents(make, scheme, n) - reference(make)).max() for n in (40, 80))
    assert abs(np.log2(coarse / fine) - scheme.order) < 0.2


@pytest.mark.parametrize("amplitude", [0.0, 1e-4])
def test_potentials_are_those_of_the_start(amplitude: float) -> None:
    """``f'`` of one concentration, and what a small wave adds: ``(f'' + K k^2) a cos k x``."""
    mesh, k = vv.RectangleMesh(size=(8, 2), counts=(80, 2)), np.pi / 8
    wave = lambda X: amplitude * np.cos(k * X[:, 0])  # noqa: E731
    body = vv.CahnHilliard(mesh=mesh, concentration=lambda X: 0.45 + wave(X), **PHASES)
    start = vv.simulate(vv.System([body]), until=1.0, step=1.0).states[0]
    bend = 5.0 * (12 * 0.05**2 - 0.16)  # of barrier ((c - 1/2)^2 - 0.04)^2
    expected = 4 * 5.0 * -0.05 * (0.05**2 - 0.04) + (bend + 2.0 * k**2) * wave(body.points)
    assert np.allclose(body.potentials(start), expected, rtol=1e-12, atol=1e-3 * amplitude)


@pytest.mark.parametrize("scheme", MEMORIES, ids=str)
def test_work_of_a_source_is_of_second_order(scheme: vv.Scheme) -> None:
    """Where concentration comes in evenly, its work is the change of the energy ``f(c)``."""
    errors = []
    for n in (10, 20):
        body = vv.CahnHilliard(mesh=STRIP, concentration=0.4, **PHASES)
        source = vv.ConcentrationSource(body=body, rate=0.1)
        ledger = vv.simulate(vv.System([body, source]), until=0.2, step=0.2 / n, scheme=scheme).ledger
        change = 16 * float(np.diff(body.free_energy.values(np.array([0.4, 0.42])))[0])
        errors.append(abs(ledger["work_source"][-1] - change))
    assert abs(np.log2(errors[0] / errors[1]) - 2) < 0.1


def test_alloys_without_mass_start_in_balance_and_stay_there() -> None:
    """A box of one concentration that nothing hinders is longer by its eigenstrain, and has no stress."""
    box = vv.MixtureSolid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)),
        material=vv.SaintVenantKirchhoff(young=10.0, poisson=0.3),
        concentration=0.6,
        eigenstrain=0.1,
        reference=0.5,
        **PHASES,
    )
    planes = [
        vv.Fixed(solid=box, nodes=side, directions=tuple(axis == side[0] for axis in "xyz"))
        for side in ("x0", "y0", "z0")
    ]
    result = vv.simulate(vv.System([box, *planes]), until=0.3, step=0.1)
    for x in result.states:
        assert np.allclose(box.displacements(x), 0.01 * box.grid.points, atol=1e-12)
    assert abs(result.ledger["total"][0] - 5.0 * (0.1**2 - 0.2**2) ** 2) < 1e-14
