"""Separation in published settings: PFHub's T (benchmark 1c), the random start of Gomez et al. (2008)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv
from visviva.examples import spinodal

PFHUB = vv.DoubleWell(barrier=5.0, low=0.3, high=0.7)
BOXES = (((20, 100), (0, 0)), ((40, 20), (-40, 100)), ((20, 20), (0, 100)), ((40, 20), (20, 100)))
"""Sizes and corners of the stem, and of the left, the middle and the right of the bar."""


def tee_of_cells(size: float) -> vv.Mesh:
    parts = [
        vv.RectangleMesh(
            size=box, counts=(round(box[0] / size), round(box[1] / size)), origin=corner, cell="quad9"
        ).build()
        for box, corner in BOXES
    ]
    mesh = parts[0]
    for part in parts[1:]:
        mesh = mesh.merged(part, weld=1e-6)
    return vv.Mesh(mesh.points, mesh.cells)


def tee_of_splines(size: float) -> vv.SplinePatches:
    counts = [(round(box[0] / size), round(box[1] / size)) for box, _ in BOXES]
    patches = [
        vv.SplineBox(size=box, counts=n, degree=3, origin=corner).parts()[0]
        for n, (box, corner) in zip(counts, BOXES, strict=True)
    ]
    return vv.SplinePatches(patches=patches)


def test_pfhub_1c() -> None:
    """Energy and mean of the start, in closed form; later quadratic cells and joined cubic splines agree."""
    ends, until = [], 30.0
    for mesh in (tee_of_cells(2.0), tee_of_splines(2.0)):
        body = vv.CahnHilliard(
            mesh=mesh, free_energy=PFHUB, gradient_energy=2.0, mobility=5.0, concentration=spinodal.start
        )
        system = vv.System([body])
        assert sum(body.energies(system.x)) == pytest.approx(31.8836054488, rel=1e-5)
        mass = body.integral(system.x)
        assert mass / 4000 == pytest.approx(0.501987281279, rel=1e-7)
        result = vv.simulate(
            system, until=until, step=0.05, adaptive=vv.Adaptive(tolerance=3e-3, max_step=20.0)
        )
        assert np.all(np.diff(result.ledger["potential_stored"]) < 0)
        assert body.integral(system.x) == pytest.approx(mass, rel=1e-12)
        ends.append(sum(body.energies(system.x)))
    assert ends[0] == pytest.approx(ends[1], rel=5e-3)


@pytest.mark.parametrize("form", ["mixed", "direct"])
def test_random_start_of_gomez(form: Any) -> None:
    """Waves of ``k^2 = -f''/2`` grow most; the mass stays exactly, and the energy falls all the way."""
    alpha, theta, mean = 3000.0, 1.5, 0.63
    rng = np.random.default_rng(7)
    body = vv.CahnHilliard(
        mesh=vv.SplineBox(size=(1, 1), counts=(64, 64), degree=2),
        free_energy=vv.FloryHuggins(chi=2 * theta, scale=1.5 * alpha / theta),
        gradient_energy=1.0,
        mobility=vv.DegenerateMobility(scale=0.25),
        concentration=lambda X: mean + rng.uniform(-0.05, 0.05, len(X)),
        periodic=[("x0", "x1"), ("y0", "y1")],
        form=form,
    )
    curvature = float(body.free_energy.curvatures(np.array(mean)))
    wave = np.sqrt(-curvature / 2)
    rate = mean * (1 - mean) * curvature**2 / 4
    system = vv.System([body])
    mass = body.integral(system.x)
    early = vv.simulate(system, until=5 / rate, step=0.5 / rate)
    size = vv.DomainSize(body=body)(system)
    assert size == pytest.approx(2 * np.pi / wave, rel=0.1)
    assert np.all(np.diff(early.ledger["potential_stored"]) < 0)
    if form == "mixed":
        growth = vv.Adaptive(tolerance=5e-2, max_step=20 / rate)
        late = vv.simulate(system, until=20 / rate, step=0.5 / rate, adaptive=growth)
        assert np.all(np.diff(late.ledger["potential_stored"]) < 0)
        c = body.values(system.x)
        assert c.max() > 0.9
        assert c.min() < 0.15
    assert body.integral(system.x) == pytest.approx(mass, rel=1e-12)


def test_pfhub_1a_on_splines() -> None:
    """Pseudo-spectral energies, of ETD-RK4 with a tolerance of 1e-5 on 256 x 256 waves."""
    body = vv.CahnHilliard(
        mesh=vv.SplineBox(size=(200, 200), counts=(110, 110), degree=2),
        free_energy=PFHUB,
        gradient_energy=2.0,
        mobility=5.0,
        concentration=spinodal.start,
        periodic=[("x0", "x1"), ("y0", "y1")],
    )
    system = vv.System([body])
    rule = vv.Adaptive(tolerance=3e-2, max_step=1e4)
    for time, spectral in (
        (1, 318.8603859),
        (2, 318.5465585),
        (3, 318.0954309),
        (5, 316.4181572),
        (10, 297.9668415),
    ):
        vv.simulate(system, until=float(time), step=0.5, adaptive=rule)
        assert sum(body.energies(system.x)) == pytest.approx(spectral, rel=1.5e-3)
