"""Solids in free flight: what stays, over thousands of steps, and which schemes let it go."""

from __future__ import annotations

import numpy as np
import pytest

import visviva as vv
from verification.solids import Array

SPIN = (2.0, 3.0, -1.5)
STEP = 0.05
"""Coarse: the block's lowest frequencies have some eight steps a period, its highest two."""


def block() -> vv.System:
    """One element of soft rubber, tossed."""
    solid = vv.Solid(
        mesh=vv.BoxMesh(size=(2, 1, 0.6), counts=(1, 1, 1)),
        material=vv.NeoHooke(young=200.0, poisson=0.3),
        density=1.0,
        velocity=(0.1, 0.05, 0.2),
        angular_velocity=SPIN,
    )
    return vv.System([solid], vv.Newton(tolerance=1e-13))


def tossed(scheme: vv.Scheme, steps: int, step: float = STEP) -> vv.Result:
    return vv.simulate(block(), until=steps * step, step=step, scheme=scheme, every=10**9)


def swing(result: vv.Result) -> float:
    """Largest change of the total energy relative to its scale."""
    energy = result.ledger["total"]
    return float(np.abs(energy - energy[0]).max() / result.ledger.energy_scale)


def turning(result: vv.Result) -> float:
    """Largest relative change of angular momentum."""
    return max(result.conservation()[f"angular_{c}"] for c in "xyz")


def test_tossed_block_keeps_energy_and_momenta_for_ten_thousand_steps() -> None:
    result = tossed(vv.EnergyMomentum(), 10_000)
    figures = result.conservation()
    assert result.statistics.rejected == 0
    assert swing(result) < 1e-11
    assert max(figures[f"momentum_{c}"] for c in "xyz") < 1e-11
    assert turning(result) < 1e-11


def test_midpoint_rule_lets_the_energy_go() -> None:
    """Momenta stay; with twice the step the block turns inside out, while the energy-momentum scheme goes on."""
    result = tossed(vv.Midpoint(), 1000)
    assert swing(result) > 1e-2
    assert turning(result) < 1e-11
    with pytest.raises(vv.RunError, match="inverted"):
        tossed(vv.Midpoint(), 1000, 2 * STEP)  # when is chance: the motion is chaotic
    assert swing(tossed(vv.EnergyMomentum(), 1000, 2 * STEP)) < 1e-11


def test_trapezoidal_rule_lets_energy_and_angular_momentum_go() -> None:
    result = tossed(vv.GeneralizedAlpha(1.0), 1000)
    assert swing(result) > 1e-2
    assert turning(result) > 1e-3
    assert max(result.conservation()[f"momentum_{c}"] for c in "xyz") < 1e-11


def torus(**motion: object) -> vv.Solid:
    """The hollow torus of Hesch & Betsch on a coarse mesh: E = 2250, nu = 0.3, rho = 0.1."""
    mesh = vv.HollowTorusMesh(counts=(24, 8, 1))
    return vv.Solid(mesh=mesh, material=vv.NeoHooke(young=2250.0, poisson=0.3), density=0.1, **motion)


def test_thrown_torus_flies_as_it_is() -> None:
    """v = (30, 0, 23): x = X + v t, T = m |v|^2 / 2 with |v|^2 = 1429, no strain."""
    ring = torus(velocity=(30, 0, 23))
    result = vv.simulate(vv.System([ring]), until=1.0, step=0.1)
    np.testing.assert_allclose(
        ring.positions(result.states[-1]), ring.points + np.array([30, 0, 23]), atol=1e-10
    )
    assert result.ledger["kinetic"] == pytest.approx(0.5 * ring.mass * 1429, rel=1e-12)
    assert result.ledger["potential_strain"] == pytest.approx(0.0, abs=1e-12)


def test_mass_of_the_torus_converges_to_the_closed_form() -> None:
    """rho 2 pi^2 R (ro^2 - ri^2) = 29366; order 2 with straight edges, 4 with curved ones."""
    exact = 0.1 * 2 * np.pi**2 * 76 * (24**2 - 19.5**2)

    def error(cell: str, n: int) -> float:
        mesh = vv.HollowTorusMesh(counts=(4 * n, 2 * n, 1), cell=cell)
        solid = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1.0, poisson=0.3), density=0.1)
        return abs(solid.mass - exact)

    for cell, order in (("hex8", 2), ("hex27", 4)):
        assert np.log2(error(cell, 5) / error(cell, 10)) == pytest.approx(order, abs=0.1)


def breathing(X: Array) -> Array:
    """Thrown, turning, and its tube made oval."""
    return np.array([30.0, 0, 23]) + np.cross((0.1, 0.3, 0.2), X) + 0.3 * X * (1, -1, 0)


def test_deforming_torus_keeps_energy_and_momenta() -> None:
    ring = torus(velocity=breathing)
    system = vv.System([ring], vv.Newton(tolerance=1e-14))
    result = vv.simulate(system, until=3.0, step=0.1)
    assert np.ptp(result.ledger["potential_strain"]) > 0.05 * result.ledger["kinetic"][0]
    assert swing(result) < 1e-12
    assert max(v for k, v in result.conservation().items() if k.startswith(("momentum", "angular"))) < 1e-12
