"""Rotary crane (paper section 4.1) against the five-coordinate Lagrangian model."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from reference import crane as reference

import visviva as vv
from verification.measure import Array, errors, extrapolated, orders, resolved, sampled
from visviva.examples import crane
from visviva.study.study import measure


@cache
def run(step: float, winch: str = "free", null_space: bool | None = None) -> tuple[Array, vv.Result]:
    """Columns alpha, u, x, y, z (and theta where free) every 0.05 s, and the result; 2 s."""
    study = crane.study(step=step, winch=winch)
    system, p = resolved(study, vv.Newton(null_space=null_space))
    forms = [p["crane_angle"], p["trolley_position"]] + ([p["winch_angle"]] if winch == "free" else [])
    times = np.arange(0.0, 2.0001, 0.25 if winch == "locked" else 0.05 if step < 0.02 else 0.1)

    def look(s: vv.System) -> Array:
        return np.concatenate([[measure(s, f) for f in forms], measure(s, p["load"])])

    return sampled(system, look, times, step)


def exact(winch: str, step: float) -> Array:
    table = reference.free() if winch == "free" else reference.locked()
    names = ("alpha", "u", "theta", "x", "y", "z") if winch == "free" else ("alpha", "u", "x", "y", "z")
    stride = 2 if winch == "free" and step >= 0.02 else 1
    return np.column_stack([table[k] for k in names])[table["t"] < 2.0001][::stride]


def test_counts_of_the_paper() -> None:
    system = crane.study().system
    assert (system.n_coordinates, system.n_constraints) == (42, 37)
    locked = crane.study(winch="locked").system
    assert (locked.n_coordinates, locked.n_constraints) == (42, 38)


@pytest.mark.parametrize("step", [0.02, 0.01, 0.005])
def test_energy_and_vertical_momentum_at_every_step_size(step: float) -> None:
    _, result = run(step)
    energy, momentum = result.ledger["total"], result.ledger["angular_z"]
    assert np.abs(energy / energy[0] - 1.0).max() < 1e-9
    assert np.abs(momentum / momentum[0] - 1.0).max() < 1e-9
    result.assert_conserved("energy", "angular_z", "constraints", tolerance=1e-11)
    assert energy[0] == pytest.approx(reference.free()["energy"][0], rel=1e-12)
    assert momentum[0] == pytest.approx(reference.free()["momentum3"][0], rel=1e-12)


def test_trajectory_converges_with_order_two() -> None:
    """The winch makes 26 turns in 2 s, so its angle decides the error: 0.064 rad at a step of 0.00125."""
    values = [run(h)[0] for h in (0.005, 0.0025, 0.00125)]
    for column, last in ((0, 2e-5), (1, 1e-4), (2, 0.07), (3, 4e-4), (4, 5e-4), (5, 7e-3)):
        e = errors([v[:, column] for v in values], exact("free", 0.005)[:, column])
        assert orders(e) == pytest.approx([2.0, 2.0], abs=0.06)
        assert e[-1] < last


def test_extrapolated_trajectory_meets_the_reference() -> None:
    difference = np.abs(extrapolated([run(h)[0] for h in (0.005, 0.0025, 0.00125)]) - exact("free", 0.005))
    assert difference[:21].max() < 1e-6  # up to 1 s: winch angle 41 rad
    assert np.delete(difference, 2, axis=1)[:21].max() < 1e-7
    assert difference.max() < 1e-4


def test_locked_winch_against_its_table() -> None:
    values = [run(h, "locked")[0] for h in (0.01, 0.005, 0.0025)]
    e = errors(values, exact("locked", 0.01))
    assert orders(e) == pytest.approx([2.0, 2.0], abs=0.03)
    assert e[-1] < 1e-4
    assert np.abs(extrapolated(values) - exact("locked", 0.01)).max() < 1e-7
    run(0.01, "locked")[1].assert_conserved("energy", "angular_z", "constraints", tolerance=1e-10)


def test_both_linear_solvers_give_the_same_trajectory() -> None:
    a, b = (run(0.005, "free", null_space)[0] for null_space in (True, False))
    difference = np.abs(a - b)
    assert difference[:21].max() < 1e-10
    assert difference.max() < 1e-9
