"""Particles with misfit: elastic energies of ellipses (Eshelby), which decide their shapes.

Soft particles gain elastic energy by growing long, hard ones lose it: against the energy of their interface, round soft
particles give way to elongated ones beyond a size (Johnson & Cahn 1984).
"""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]
E, NU, ETA = 100.0, 0.3, 0.01
NORMALS = np.eye(3)


def eshelby(aspect: float, softness: float) -> float:
    """Elastic energy of an ellipse of unit area in an infinite plane, with the eigenstrain (eta, eta, 0).

    By the equivalent inclusion: ``Cp (S e - e*) = Cm (S e - e)``, energy ``- e* . Cp (S e - e*) / 2``.
    """
    a, b, q = aspect**0.5, aspect**-0.5, 1 / (2 * (1 - NU))
    s = a + b
    S = q * np.array(
        [
            [
                (b * b + 2 * a * b) / s**2 + (1 - 2 * NU) * b / s,
                b * b / s**2 - (1 - 2 * NU) * b / s,
                2 * NU * b / s,
            ],
            [
                a * a / s**2 - (1 - 2 * NU) * a / s,
                (a * a + 2 * a * b) / s**2 + (1 - 2 * NU) * a / s,
                2 * NU * a / s,
            ],
            [0.0, 0.0, 0.0],
        ]
    )
    lam, mu = E * NU / (1 + NU) / (1 - 2 * NU), E / 2 / (1 + NU)
    C = lam + 2 * mu * np.eye(3)
    misfit = np.array([ETA, ETA, 0.0])
    equivalent = np.linalg.solve(softness * C @ S - C @ (S - np.eye(3)), softness * C @ misfit)
    stress = softness * C @ (S @ equivalent - misfit)
    return float(-0.5 * stress @ misfit)


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
