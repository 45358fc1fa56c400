"""Angles of walls against Young's law, for free energies whose phases are alike and for others."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from visviva.phase.free_energy import FreeEnergy

KAPPA = 0.5
SKEWED = vv.PolynomialEnergy(coefficients=(0.0, 0.0, 0.2, -0.4, 3.2, -6.0, 3.0))
"""``c^2 (1 - c)^2 (0.2 + 3 c^2)``: wells of 0 and 1, of which one is a fifteenth as stiff as the other."""
Function = Callable[[NDArray[np.float64]], NDArray[np.float64]]
ENERGIES: dict[str, tuple[FreeEnergy, Function]] = {
    "double well": (vv.DoubleWell(barrier=1.0), lambda c: 0 * c + 1.0),
    "skewed": (SKEWED, lambda c: 0.2 + 3 * c**2),
    "function": (
        vv.UserFreeEnergy(function=lambda c: (c - c**2) ** 2 * np.sqrt(0.1 + 9 * c**4)),
        lambda c: np.sqrt(0.1 + 9 * c**4),
    ),
}


def energy_of_wall(energy: FreeEnergy, phase: float, angle: float) -> float:
    """Of a wall, and of the film at it, which takes what is the least from near to a phase."""
    mesh = vv.RectangleMesh(size=(10, 0.05), counts=(100, 1), cell="quad9")
    body = vv.AllenCahn(
        mesh=mesh,
        free_energy=energy,
        gradient_energy=KAPPA,
        order=lambda X: phase + (0.2 - 0.4 * phase) * np.exp(-X[:, 0]),
    )
    wall = vv.Wetting(body=body, faces="x0", angle=angle)
    system = vv.System([body, wall])
    for until, step in ((4.0, 0.2), (40.0, 2.0), (400.0, 20.0)):
        result = vv.simulate(system, until=until, step=step, scheme=vv.BackwardEuler())
    return float(result.ledger["potential_stored"][-1]) / 0.05


@pytest.mark.parametrize(
    ("name", "angle"),
    [
        *(
            (name, angle)
            for name in list(ENERGIES)[:2]
            for angle in (15.0, 30.0, 60.0, 90.0, 120.0, 150.0, 165.0)
        ),
        *(("function", angle) for angle in (15.0, 165.0)),
    ],
)
def test_walls_have_the_energies_of_their_angle(name: str, angle: float) -> None:
    """Young's ``cos(angle) = (wall with the low phase - wall with the high phase) / tension``.

    With ``3 s^2 - 2 s^3`` for all energies, films at the wall made 26 degrees of 15.
    """
    energy, factor = ENERGIES[name]
    c = np.linspace(0, 1, 20001)
    tension = np.trapezoid(np.sqrt(2 * KAPPA * factor(c)) * c * (1 - c), c)
    low, high = (energy_of_wall(energy, phase, angle) for phase in (0.0, 1.0))
    assert np.degrees(np.arccos((low - high) / tension)) == pytest.approx(angle, abs=0.1)


def test_walls_pull_at_nothing_beyond_the_phases() -> None:
    """There their energy is constant: in steps that pass the ends the ledger closes, and the tangent is right."""
    body = vv.AllenCahn(
        mesh=vv.RectangleMesh(size=(4, 0.5), counts=(16, 2)),
        free_energy=SKEWED,
        gradient_energy=KAPPA,
        order=lambda X: 0.5 + np.sin(3 * X[:, 0]),
    )
    system = vv.System([body, vv.Wetting(body=body, faces="y0", angle=20.0)])
    core, step, n = system.core, vv.EnergyMomentum().step(0.0, 0.3), len(system.order)
    core.dx[:n] = 0.7 * np.cos(5 * np.arange(n))  # from one side of an end to the other, at some nodes
    system.invalidate()
    trial, signals, K = np.array(core.dx), system.signals(step), system.tangent(step)[1].toarray()

    def residual(k: int, d: float) -> NDArray[np.float64]:
        core.dx[:] = trial
        core.dx[k] += d
        r = np.zeros(len(trial))
        core.assemble(step, signals, r, None)
        return r[:n]

    differences = np.stack([(residual(k, 1e-5) - residual(k, -1e-5)) / 2e-5 for k in range(n)], axis=1)
    assert np.abs(K - differences).max() < 1e-7 * np.abs(K).max()
    core.dx[:] = 0.0
    system.invalidate()
    result = vv.simulate(system, until=2.0, step=0.1)
    assert result.conservation()["energy"] < 1e-10


def test_angles_that_no_polynomial_makes_are_refused() -> None:
    body = vv.AllenCahn(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(40, 40)),
        free_energy=vv.UserFreeEnergy(
            function=lambda c: (c - c**2) ** 2 * (1 + 500 * np.exp(-((c - 0.5) ** 2) / 5e-4))
        ),
        gradient_energy=1.0,
        order="x",
    )
    with pytest.raises(
        vv.InputError, match=r"angle = 15 interfaces would meet the wall at 38 degrees, .* nearer to 90"
    ):
        vv.Wetting(body=body, faces="y0", angle=15.0)
    vv.Wetting(body=body, faces="y0", angle=80.0)
