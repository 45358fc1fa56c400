"""The flying L: step by step against another program of the same scheme, and against the motion exact in time."""

from __future__ import annotations

import numpy as np
import pytest

import visviva as vv
from verification.flying import DATA, flying, observed, variant
from verification.measure import errors, orders, sampled
from verification.solids import Array

# Saint Venant-Kirchhoff, lambda = 3000, mu = 750, rho = 10, the scheme of Simo & Tarnow with the load of the middle of
# the step, by an independent program: energy, angular momentum and the nodes (0, 10, 3) and (6, 0, 0) at t.
GOLDEN = {
    0.05: {
        0.5: (107.6570764550, (814.46783023, 432.81533252, -560.03283176),
              (0.0446065, 10.0133330, 3.1224230), (5.8808811, -0.1055773, -0.1503248)),
        1.0: (330.0996476329, (1619.93656514, 869.22376538, -1119.46136530),
              (0.1360871, 9.9442482, 3.5183151), (5.5252035, -0.3810302, -0.5327013)),
        2.0: (330.0996476329, (1619.93656514, 869.22376538, -1119.46136530),
              (1.2085072, 9.9252369, 4.3143928), (4.9589913, 0.2270911, -1.7285750)),
        5.0: (330.0996476329, (1619.93656514, 869.22376538, -1119.46136530),
              (3.9042310, 7.9257833, 6.3910954), (2.2817029, 1.6570053, -3.7984542)),
        10.0: (330.0996476329, (1619.93656514, 869.22376538, -1119.46136530),
               (6.8321460, 2.9371553, 5.6983627), (-0.9767092, 6.4108639, -3.0863616)),
    },
    0.025: {
        1.0: (330.4657975340, (1620.02164751, 869.21428912, -1119.48340859),
              (0.1354706, 9.9443150, 3.5178679), (5.5266643, -0.3819422, -0.5320533)),
        10.0: (330.4657975340, (1620.02164751, 869.21428912, -1119.48340859),
               (6.8306155, 2.9251254, 5.6868309), (-0.9729148, 6.4298400, -3.0762453)),
    },
    0.0125: {
        1.0: (330.5576539292, (1620.04300814, 869.21186633, -1119.48891360),
              (0.1352824, 9.9442790, 3.5177252), (5.5270092, -0.3821096, -0.5317666)),
        2.0: (330.5576539292, (1620.04300814, 869.21186633, -1119.48891360),
              (1.2080804, 9.9270935, 4.3133707), (4.9570646, 0.2308544, -1.7298408)),
    },
}  # fmt: skip


@pytest.mark.parametrize("h", GOLDEN)
def test_digit_by_digit(h: float) -> None:
    system = flying(vv.SaintVenantKirchhoff(lame_lambda=3000.0, shear=750.0), 10.0, 1.0)
    seen, _ = sampled(system, observed, [0.0, *GOLDEN[h]], h)
    for row, (energy, momentum, one, two) in zip(seen[1:], GOLDEN[h].values(), strict=True):
        assert row[0] == pytest.approx(energy, abs=2e-8)
        np.testing.assert_allclose(row[1:4], momentum, atol=2e-7)
        np.testing.assert_allclose(row[4:10], (*one, *two), atol=1.5e-7)


def exact(which: str) -> tuple[Array, Array]:
    """Times, and energy, angular momentum and the nodes (3, 10, 0) and (6, 0, 3)."""
    table = np.loadtxt(DATA / f"flying_l_{which}.csv", delimiter=",")
    return table[:, 0], np.column_stack([table[:, 1] + table[:, 2], table[:, 6:15]])


@pytest.mark.parametrize(
    ("which", "until", "steps"), [("a", 3.0, (0.025, 0.0125, 0.00625)), ("b", 7.0, (0.05, 0.025, 0.0125))]
)
def test_second_order_towards_the_exact_motion(which: str, until: float, steps: tuple[float, ...]) -> None:
    times, rows = exact(which)
    wanted = times[times <= until]
    found = [sampled(variant(which), observed, [0.0, *wanted], h)[0][1:] for h in steps]
    columns = [0, 1, 2, 3, *range(10, 16)]
    for what in (slice(0, 1), slice(1, 4), slice(4, 10)):
        e = errors([f[:, columns][:, what] for f in found], rows[: len(wanted), what])
        assert np.all(np.abs(orders(e) - 2) < 0.1), e
    error = np.abs(found[-1][:, columns] - rows[: len(wanted)]).max(axis=0)
    assert np.all(error < 1.5e-4 * np.abs(rows).max(axis=0)), error


@pytest.mark.parametrize("which", ["a", "b"])
def test_after_the_load_everything_is_kept(which: str) -> None:
    """Coarse steps to t = 10; the loads on both faces add up to nothing."""
    system = variant(which)
    vv.simulate(system, until=1.0 if which == "a" else 5.0, step=0.05)
    kept = [observed(system)[:4]]
    result = vv.simulate(system, until=10.0, step=0.05, observe=lambda s: kept.append(observed(s)[:4]))
    assert np.abs(np.array(kept) - kept[0]).max() < 1e-11 * np.abs(kept[0]).max()
    assert max(np.abs(result.ledger[f"momentum_{c}"]).max() for c in "xyz") < 1e-10
    assert result.conservation()["energy"] < 1e-10
