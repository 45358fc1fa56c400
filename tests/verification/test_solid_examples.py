"""The examples of solids: small ones run with their checks, the torus against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

import visviva as vv
from visviva.examples import cantilever, flexible_slider_crank, torus


def run(study: vv.Study) -> vv.Result:
    return vv.simulate(study.system, until=study.until, step=study.step, scheme=study.scheme)


def test_torus_has_the_mass_and_energy_of_the_paper() -> None:
    """V = 2 pi^2 76 (24^2 - 19.5^2), m = 29366.02, T = m |v|^2 / 2; the mesh is short of it as its polygons are."""
    study = torus.study(spin=0.0, oval=0.0)
    system, (solid,) = study.system, study.system.components
    assert isinstance(solid, vv.Solid)
    assert system.n_coordinates == 36108
    assert solid.grid.n_cells == 8024
    polygons = np.sinc(2 / 118) * np.sinc(2 / 34)  # areas of inscribed polygons over those of circles
    assert solid.mass == pytest.approx(29366.0209350 * polygons, rel=1e-4)
    kinetic = solid.velocities(system.x, system.v) * solid.nodal_mass[:, None] ** 0.5
    assert np.sum(kinetic**2) / 2 == pytest.approx(20982021.958 * polygons, rel=1e-4)


def test_coarse_torus_conserves() -> None:
    result = run(torus.study(counts=(12, 6, 1), until=0.4))
    torus.check(result)
    assert np.ptp(result.ledger["kinetic"]) > 0.01 * result.ledger["kinetic"][0]  # it strains


@pytest.mark.parametrize(("motion", "force"), [("static", 2.0), ("static", 0.02), ("dynamic", 2.0)])
def test_cantilever(motion: str, force: float) -> None:
    study = cantilever.study(motion, force)  # type: ignore[arg-type]
    study.until = min(study.until, 2.0)
    cantilever.check(run(study))


def test_cantilever_swings_with_its_first_frequency() -> None:
    """The tip turns back after half a period of the clamped beam, 2 pi / (3.516 sqrt(E I / rho A) / L^2)."""
    study = cantilever.study(counts=(10, 1, 1), force=0.1, until=7.0)
    result = run(study)
    tip = -result.history(study.probes["tip"])[:, 2]  # type: ignore[arg-type]
    half = np.pi / (3.516 * np.sqrt(1e4 / 12) / 100)
    assert result.times[int(np.argmax(tip))] == pytest.approx(half, rel=0.03)
    assert tip.max() == pytest.approx(2 * 0.1 * 0.4, rel=0.05)  # twice the static deflection


def test_flexible_slider_crank_conserves_and_bends() -> None:
    study = flexible_slider_crank.study(until=0.5)
    bending = []
    system, probe = study.system, study.probes["bending"]
    for _ in range(200):
        system.step(study.step, study.scheme)
        bending.append(probe(system))  # type: ignore[operator]
    assert np.abs(bending).max() > 0.02
    flexible_slider_crank.check(run(flexible_slider_crank.study(until=0.5)))


def test_stiff_rod_moves_like_a_rigid_one() -> None:
    """Piston of a slider-crank by closed form from the angle of the crank."""
    study = flexible_slider_crank.study(young=1e11, until=0.3)
    result = run(study)
    angle, slider = (result.history(study.probes[name]) for name in ("crank_angle", "slider"))  # type: ignore[arg-type]
    rigid = 0.3 * np.cos(angle) + np.sqrt(1 - (0.3 * np.sin(angle)) ** 2)
    assert np.ptp(angle) > 2.5
    np.testing.assert_allclose(slider - slider[0], rigid - rigid[0], atol=2e-5)
