"""Four-bars: crank-rocker and N parallel loops (IFToMM A02): redundant constraints, singular positions."""

from __future__ import annotations

import numpy as np
import pytest
from reference import four_bar as reference

import visviva as vv
from verification.measure import conserved, errors, extrapolated, follow, orders
from visviva.examples import four_bar, n_four_bar


def test_crank_rocker() -> None:
    times = np.linspace(0.0, 5.0, 26)
    table = reference.crank_rocker(times)
    exact = np.column_stack([table[k] for k in ("ax", "ay", "bx", "by")])
    runs = [follow(four_bar.study(step=h), ["A", "B"], times) for h in (0.01, 0.005, 0.0025)]
    values = [v[:, [0, 1, 3, 4]] for v, _ in runs]
    e = errors(values, exact)
    assert orders(e) == pytest.approx([2.0, 2.0], abs=0.05)
    assert e[-1] < 2e-3
    assert np.abs(extrapolated(values) - exact).max() < 1e-6
    assert runs[0][1].ledger["total"][0] == pytest.approx(23.48832307490, rel=1e-11)


@pytest.mark.parametrize("step", [0.02, 0.01, 0.002])
def test_energy_of_the_crank_rocker_over_twenty_seconds(step: float) -> None:
    study = four_bar.study(step=step)
    result = vv.simulate(study.system, until=20.0, step=step, every=10**9)
    energy = result.ledger["total"]
    assert np.abs(energy - energy[0]).max() < 1e-9 * result.ledger.energy_scale
    conserved(result)


@pytest.mark.parametrize("loops", [1, 2, 4])
def test_parallel_loops_pass_their_singular_positions(loops: int) -> None:
    """Ten passages in 10 s; the branch is the parallelogram's throughout."""
    times = np.linspace(0.0, 10.0, 41)
    table = reference.parallel(times, loops)
    exact = np.column_stack([table["x"], table["y"]])
    values = []
    for h in (0.01, 0.005, 0.0025) if loops == 2 else (0.01, 0.005):
        names = ["B0", f"B{loops}"]
        v, result = follow(n_four_bar.study(loops=loops, step=h), names, times)
        assert np.abs(v[:, 3:] - v[:, :3] - [loops, 0.0, 0.0]).max() < 1e-7
        conserved(result)
        values.append(v[:, :2])
    e = errors(values, exact)
    assert orders(e) == pytest.approx(2.0, abs=0.1)
    assert e[1] < 1.5e-3
    if loops == 2:
        assert np.abs(extrapolated(values) - exact).max() < 1e-8


def test_constraints_beyond_need() -> None:
    """Three constraints per planar loop are redundant; half a turn passes one singular position."""
    study = n_four_bar.study(step=0.005)
    assert study.system.n_constraints - (study.system.n_coordinates - 1) == 6  # redundant ones
    v, _ = follow(study, ["B0"], [0.0, 0.97])
    exact = reference.parallel([0.0, 0.97])
    assert v[1, :2] == pytest.approx([exact["x"][1], exact["y"][1]], abs=1e-3)
