"""Particles with misfit: elastic energies of ellipses (Eshelby), which decide their shapes, and the way there.

Soft particles gain elastic energy by growing long, hard ones lose it: against the energy of their interface, round soft
particles give way to elongated ones beyond a size (Johnson & Cahn 1984).
"""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from visviva.examples import misfit
from visviva.examples.misfit import ETA, NU, E, eshelby

Array = NDArray[np.float64]
NORMALS = np.eye(3)


def elastic_energy(aspect: float, softness: float, width: float) -> float:
    """Of a quarter of an ellipse of area pi, in a plate some 20 times as wide that is free around."""
    a, b = aspect**0.5, aspect**-0.5
    fine = np.linspace(0, 2.2, round(2.2 / (0.4 * width)) + 1)
    ticks = np.concatenate(
        [fine, 2.2 + np.cumsum(0.4 * width * 1.16 ** np.arange(1, 33 if width < 0.15 else 29))]
    )
    grid = vv.RectangleMesh(size=(1, 1), counts=(len(ticks) - 1,) * 2).build()
    place = np.rint(grid.points * (len(ticks) - 1)).astype(int)
    mesh = vv.Mesh(ticks[place], grid.cells, face_sets=grid.face_sets)

    def composition(X: Array) -> Array:
        x, y = X[:, 0] / a, X[:, 1] / b
        r = np.hypot(x, y) + 1e-12
        distance = (r - 1) * r / np.hypot(x / a, y / b).clip(1e-9)
        return np.asarray(0.5 - 0.5 * np.tanh(2 * distance / width))

    body = vv.MixtureSolid(
        mesh=mesh,
        material=vv.SaintVenantKirchhoff(young=E, poisson=NU),
        free_energy=vv.PolynomialEnergy(coefficients=(0.0, 0.0, 1.0)),  # without interfaces of its own
        gradient_energy=1e-6,
        mobility=1e-14,
        concentration=composition,
        eigenstrain=(ETA, ETA, 0.0),
        moduli=(softness - 1,),
    )
    planes = [
        vv.SymmetryPlane(solid=body, nodes=side, normal=NORMALS[k]) for k, side in enumerate(("x0", "y0"))
    ]
    system = vv.System([body, *planes])
    vv.simulate(system, until=1.0, step=1.0, scheme=vv.BackwardEuler())
    return body.elastic_energy(system.x)


@pytest.mark.parametrize("softness", [0.5, 2.0])
def test_shapes_of_particles(softness: float) -> None:
    """To sharp interfaces by extrapolation of two widths; areas of one size."""
    found = [2 * elastic_energy(a, softness, 0.1) - elastic_energy(a, softness, 0.2) for a in (1.0, 2.0, 3.0)]
    exact = [np.pi / 4 * eshelby(aspect, softness) for aspect in (1.0, 2.0, 3.0)]
    np.testing.assert_allclose(found, exact, rtol=2.5e-2)
    np.testing.assert_allclose(np.diff(found), np.diff(exact), rtol=0.1)
    assert np.all(np.diff(found) < 0) == (softness < 1)


@pytest.mark.parametrize("ratio", [0.9, 1.6])
def test_diffusion_makes_small_particles_round_and_large_ones_long(ratio: float) -> None:
    """From one aspect, on both sides of the critical radius of sharp ellipses; energy falls, amounts stay."""
    study = misfit.study(ratio=ratio, inner=3.2, until=1.5)
    result = vv.simulate(
        study.system, until=study.until, step=study.step, scheme=study.scheme, adaptive=study.adaptive
    )
    misfit.check(result)


def test_the_critical_radius_is_where_the_best_ellipse_parts_from_the_circle() -> None:
    """The second variation of one function, the least values of another."""
    aspects = [misfit.best_aspect(ratio, 0.5) for ratio in (0.97, 1.03, 1.06)]
    assert aspects[0] == pytest.approx(1.0, abs=1e-2)
    assert np.log(aspects[2]) / np.log(aspects[1]) == pytest.approx(2**0.5, rel=0.03)  # a pitchfork
