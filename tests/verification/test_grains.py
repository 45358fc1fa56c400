"""Several order parameters: grain boundaries and shrinking grains against closed forms."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]


def grains(mesh: Any, profiles: list[Any], m: float, kappa: float, mobility: float) -> list[vv.AllenCahn]:
    return [
        vv.AllenCahn(
            mesh=mesh,
            free_energy=vv.PolynomialEnergy(coefficients=(0.25 * m, 0.0, -0.5 * m, 0.0, 0.25 * m)),
            gradient_energy=kappa,
            mobility=mobility,
            order=profile,
            name=f"grain {k}",
        )
        for k, profile in enumerate(profiles)
    ]


def energy(bodies: list[vv.AllenCahn], m: float, x: Array) -> float:
    """Of all parts, by quadrature in Python; zero in a grain."""
    total = sum(sum(b.energies(x)) for b in bodies)
    for t in bodies[0].space.cells():
        a = [t.at(b.coefficients(b.phase, x)) ** 2 for b in bodies]
        pairs = sum(a[i] * a[j] for i in range(len(a)) for j in range(i))
        total += float((t.size * (1.5 * m * pairs - 0.25 * m * (len(a) - 1))).sum())
    return total


def test_energy_of_a_flat_boundary() -> None:
    """``sqrt(2 m kappa) / 3`` per area, profile ``(1 + tanh(sqrt(m / 2 kappa) x)) / 2`` (Moelans et al. 2008)."""
    m, kappa = 2.0, 0.25
    mesh = vv.RectangleMesh(size=(8, 0.1), counts=(80, 1), cell="quad9", origin=(-4, 0))
    start = [lambda X, sign=sign: 0.5 + 0.5 * sign * np.tanh(X[:, 0]) for sign in (1, -1)]
    bodies = grains(mesh, start, m, kappa, 1.0)
    system = vv.System([*bodies, vv.Exclusion(bodies=bodies, strength=1.5 * m)])
    vv.simulate(system, until=20.0, step=0.5)
    exact = 0.5 + 0.5 * np.tanh(np.sqrt(m / (2 * kappa)) * bodies[0].points[:, 0])
    assert np.abs(bodies[0].values(system.x) - exact).max() < 1e-3
    assert energy(bodies, m, system.x) / 0.1 == pytest.approx(np.sqrt(2 * m * kappa) / 3, rel=1e-3)


def test_round_grain_shrinks() -> None:
    """``R^2 = R0^2 - 2 M kappa t``, on a quarter; all energies together fall by what is dissipated."""
    width, R0, n, kappa, mobility = 0.03, 0.25, 36, 2.0, 0.5
    m = kappa / width**2

    def inside(X: Array) -> Array:
        return np.asarray(0.5 - 0.5 * np.tanh((np.hypot(X[:, 0], X[:, 1]) - R0) / (np.sqrt(2) * width)))

    mesh = vv.RectangleMesh(size=(0.4, 0.4), counts=(n, n))
    bodies = grains(mesh, [inside, lambda X: 1 - inside(X)], m, kappa, mobility)
    system = vv.System([*bodies, vv.Exclusion(bodies=bodies, strength=1.5 * m)])

    def square() -> float:
        return 4 / np.pi * bodies[0].integral(system.x)

    begin = square()
    result = vv.simulate(system, until=0.015, step=0.001)
    assert begin - square() == pytest.approx(2 * mobility * kappa * 0.015, rel=0.02)
    assert result.conservation()["energy"] < 1e-10
    stored = result.ledger["potential_stored"] + result.ledger["potential_exclusion"]
    assert np.all(np.diff(stored) < 0)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda a, b: vv.Exclusion(bodies=[a], strength=1.0), "two different order parameters"),
        (lambda a, b: vv.Exclusion(bodies=[a, a], strength=1.0), "two different order parameters"),
        (lambda a, b: vv.Exclusion(bodies=[a, b], strength=-1.0), "strength = -1 is not positive"),
        (lambda a, b: vv.Exclusion(bodies=[a, b], strength=1.0), "are not on the same mesh"),
    ],
)
def test_refusals(make: Any, words: str) -> None:
    a, b = (
        grains(vv.RectangleMesh(size=(1, 1), counts=(n, n)), [lambda X: 0 * X[:, 0]], 1.0, 1.0, 1.0)[0]
        for n in (4, 5)
    )
    with pytest.raises(vv.InputError, match=words):
        make(a, b)


def pair(count: int, strength: float, kappas: tuple[float, float] = (0.5, 0.5)) -> list[Any]:
    """Two grains and what keeps them apart, on a strip of cells of 8 / count, whose own interfaces are 2 wide."""
    mesh = vv.RectangleMesh(size=(8, 8 / count), counts=(count, 1), origin=(-4, 0))
    bodies = [
        vv.AllenCahn(
            mesh=mesh,
            free_energy=vv.PolynomialEnergy(coefficients=(0.0, 0.0, -0.5, 0.0, 0.25)),
            gradient_energy=kappa,
            order=lambda X, sign=sign: 0.5 + 0.5 * sign * np.tanh(X[:, 0]),
            name=f"grain {sign}",
        )
        for kappa, sign in zip(kappas, (1, -1), strict=True)
    ]
    return [*bodies, vv.Exclusion(bodies=bodies, strength=strength)]


@pytest.mark.parametrize(("strength", "kappas"), [(4.0, (0.5, 0.5)), (20.0, (0.5, 0.5)), (20.0, (0.5, 0.2))])
def test_boundaries_of_strong_exclusion_that_two_cells_do_not_resolve_are_refused(
    strength: float, kappas: tuple[float, float]
) -> None:
    """Their widths were those of each free energy alone: at 2.02 cells of that tensions were off by 2 to 12 %."""
    components = pair(160, strength, kappas)
    system = vv.System(components)
    vv.simulate(system, until=20.0, step=0.5)
    profiles = np.array([body.values(system.x) for body in components[:2]])
    profiles = profiles[:, np.argsort(components[0].points[:, 0], kind="stable")][:, ::2]
    slopes = np.abs(np.diff(profiles)).max(axis=1) / 0.05
    width = (np.ptp(profiles, axis=1) / slopes).min()
    pair(int(np.ceil(1.02 * 2 * 8 / width)), strength, kappas)
    with pytest.raises(
        vv.InputError, match=f"with strength = {strength:g} .* less than two cells"
    ) as refused:
        pair(int(np.floor(0.98 * 2 * 8 / width)), strength, kappas)
    assert float(str(refused.value).split(" wide")[0].split()[-1]) == pytest.approx(width, rel=0.02)


@pytest.mark.parametrize("strength", [0.4, 1.5])
def test_boundaries_that_two_cells_resolve_pass(strength: float) -> None:
    """Those of 1.5 are as wide as each one's own interface, and weaker ones are none."""
    pair(8, strength)


@pytest.mark.parametrize(
    ("temperature", "when"),
    [([[0, 1.0], [10, 0.8]], r"at t = 10,"), (lambda t: 1 - 0.02 * t, r"at t = \d")],
    ids=["table", "function"],
)
def test_boundaries_that_become_too_thin_are_refused(temperature: Any, when: str) -> None:
    """What cools, though the interface that each free energy has by itself stays wide enough."""
    alloy = vv.RegularSolution(temperature=temperature, excess=(3.0,), standard=(0.0, -1.0), gas_constant=1.0)
    mesh = vv.RectangleMesh(size=(7.3, 0.365), counts=(20, 1))
    starts = [lambda X, sign=sign: 0.5 + 0.4 * sign * np.tanh(X[:, 0] - 3.65) for sign in (1, -1)]
    bodies = [vv.AllenCahn(mesh=mesh, free_energy=alloy, gradient_energy=0.5, order=o) for o in starts]
    with pytest.raises(vv.InputError, match=f"wide {when}.* less than two cells"):
        vv.simulate(vv.System([*bodies, vv.Exclusion(bodies=bodies, strength=10.0)]), until=10.0, step=0.5)


@pytest.mark.parametrize(("distances", "told"), [(2.1, True), (2.6, False)])
def test_boundaries_of_few_cells_are_told(distances: float, told: bool) -> None:
    """Flat ones stand still along rows of cells under weak drives, see ``benchmarks/front_speed.py``."""
    *_, exclusion = pair(round(distances * 8 / 2), 1.5)  # two wide
    assert any("slow down, or stand still" in remark for remark in exclusion.remarks()) == told
