"""Bricard's mechanism (IFToMM A04), tops, free bodies, screw."""

from __future__ import annotations

import numpy as np
import pytest
from reference import bricard as bricard_reference
from reference import free_body as free_reference
from reference import screw as screw_reference
from reference import tops

import visviva as vv
from verification.measure import conserved, errors, extrapolated, follow, orders, reaction_at
from visviva.examples import bricard, free_body, heavy_top, lagrange_top, screw


def test_bricard() -> None:
    table = bricard_reference.cached()
    exact = np.column_stack([table[f"P{k}{c}"] for k in "234" for c in "xyz"])
    runs = [follow(bricard.study(step=h), ["P2", "P3", "P4"], table["t"]) for h in (0.01, 0.005, 0.0025)]
    values = [v for v, _ in runs]
    e = errors(values, exact)
    assert orders(e) == pytest.approx([2.0, 2.0], abs=0.05)
    assert e[-1] < 1e-4
    assert np.abs(extrapolated(values) - exact).max() < 1e-10
    for _, result in runs:
        conserved(result)


def test_heavy_top() -> None:
    table = tops.heavy_top_cached()
    exact = np.column_stack([table[c] for c in "xyz"])
    runs = [follow(heavy_top.study(step=h), ["centre"], table["t"]) for h in (0.001, 0.0005, 0.00025)]
    values = [v for v, _ in runs]
    e = errors(values, exact)
    assert orders(e) == pytest.approx([2.0, 2.0], abs=0.05)
    assert e[-1] < 1e-4
    assert np.abs(extrapolated(values) - exact).max() < 1e-9
    assert runs[0][1].ledger["total"][0] == pytest.approx(5435.696790865547, rel=1e-13)
    assert runs[0][1].ledger["angular_z"][0] == pytest.approx(-70.3124296875, rel=1e-12)
    conserved(runs[0][1], "angular_z")


def test_steady_precession() -> None:
    times = np.linspace(0.0, 0.64, 17)
    exact = tops.steady(times)["x"]
    runs = [follow(lagrange_top.study(step=h), ["centre"], times) for h in (0.002, 0.001, 0.0005)]
    values = [v for v, _ in runs]
    e = errors(values, exact)
    assert orders(e) == pytest.approx([2.0, 2.0], abs=0.1)
    assert e[-1] < 2e-5
    assert np.abs(extrapolated(values) - exact).max() < 1e-8
    conserved(runs[0][1], "angular_z", tolerance=1e-11)


def test_steady_precession_force() -> None:
    """The tip carries weight and centripetal force, and no torque."""
    centre = tops.steady([0.04])["x"][0]
    exact = tops.CONE.mass * (np.array([0, 0, 9.81]) - tops.PRECESSION**2 * np.array([*centre[:2], 0]))
    worst = []
    for h in (0.001, 0.0005):
        study = lagrange_top.study(step=h)
        result = vv.simulate(study.system, until=0.05, step=h)
        (tip,) = (c for c in study.system.components if c.name == "tip")
        force, torque = reaction_at(result, tip, round(0.04 / h))
        assert torque == pytest.approx(np.zeros(3), abs=1e-12)
        worst.append(np.abs(force - exact).max())
    assert worst[1] < 4e-3
    assert worst[0] / worst[1] == pytest.approx(4.0, abs=0.5)


def test_cuspidal_motion() -> None:
    times = np.linspace(0.0, 0.72, 19)
    exact = tops.cuspidal(times)
    path = np.sin(exact["nutation"])[:, None] * np.column_stack(
        [np.sin(exact["precession"]), -np.cos(exact["precession"])]
    )
    place = np.column_stack([0.075 * path, exact["height"]])
    runs = [
        follow(lagrange_top.study(step=h, precession=0.0), ["centre"], times)
        for h in (0.001, 0.0005, 0.00025)
    ]
    values = [v for v, _ in runs]
    e = errors(values, place)
    assert orders(e) == pytest.approx([2.0, 2.0], abs=0.1)
    assert e[-1] < 1e-5
    assert np.abs(extrapolated(values) - place).max() < 1e-10


def test_free_body_with_elliptic_functions() -> None:
    times = np.linspace(0.0, 40.0, 21)
    exact = free_reference.attitude(times, [1, 2, 3], [0.1, 1, 0.1]).transpose(0, 2, 1).reshape(21, 9)
    runs = [follow(free_body.study(step=h), ["d1", "d2", "d3"], times) for h in (0.05, 0.025, 0.0125)]
    values = [v for v, _ in runs]
    e = errors(values, exact)
    assert orders(e) == pytest.approx([2.0, 2.0], abs=0.05)
    assert e[-1] < 1e-3
    assert np.abs(extrapolated(values) - exact).max() < 1e-7
    conserved(runs[0][1], "angular_x", "angular_y", "angular_z", tolerance=1e-10)


@pytest.mark.parametrize("disturbance", [1e-2, 1e-3])
def test_flip_interval(disturbance: float) -> None:
    """Time between sign changes of the spin about the middle axis, extrapolated from two steps."""
    found = []
    for h in (0.04, 0.02):
        study = free_body.study(disturbance=disturbance, step=h, until=60.0)
        result = vv.simulate(study.system, until=60.0, step=h)
        x, v = (
            np.array(result.states)[:, 3:12].reshape(-1, 3, 3),
            np.array(result.rates)[:, 3:12].reshape(-1, 3, 3),
        )
        spin = np.einsum("ki,ki->k", v[:, 2], x[:, 0])  # d3' . d1 = W2
        k = np.nonzero(spin[:-1] * spin[1:] < 0)[0]
        crossings = h * (k + spin[k] / (spin[k] - spin[k + 1]))
        found.append(np.diff(crossings)[0])
    exact = free_reference.flip_interval(disturbance)
    coarse, fine = abs(np.array(found) - exact)
    assert fine < 5e-3
    assert coarse / fine == pytest.approx(4.0, abs=0.3)
    assert found[1] + (found[1] - found[0]) / 3 == pytest.approx(exact, abs=2e-5)


def test_screw() -> None:
    times = np.linspace(0.0, 1.0, 11)
    exact = screw_reference.screw(times, rate=3.0)
    worst = []
    for h in (0.01, 0.005):
        v, result = follow(screw.study(rate=3.0, step=h), ["angle", "nut"], times)
        worst.append(np.abs(v[:, [0, 3]] - np.column_stack([exact["angle"], exact["z"]])).max())
        conserved(result, tolerance=1e-10)
    assert worst[1] < 1e-2
    assert worst[0] / worst[1] == pytest.approx(4.0, abs=0.2)


def test_screw_reaction() -> None:
    study = screw.study(step=0.002, until=0.5)
    result = vv.simulate(study.system, until=0.5, step=0.002)
    (thread,) = (c for c in study.system.components if c.name == "thread")
    exact = screw_reference.screw([0.2])
    force, torque = reaction_at(result, thread, 100)
    assert force == pytest.approx([0, 0, exact["force"][0]], abs=1e-4)
    assert torque == pytest.approx([0, 0, exact["torque"][0]], abs=1e-4)
