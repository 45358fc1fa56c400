"""Manufactured solutions: orders of convergence in space of every cell type, at small and at large strains."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv
from verification.measure import orders
from verification.solids import LINEAR, PLANE, SPACE, Array, distorted, static
from visviva.mesh.cells import CELLS
from visviva.mesh.quadrature import stiffness_rule

LAM, MU = 2.0, 1.0
ROUGH = {"quad8": 0.0, "hex20": 0.0}
"""Cells that keep their shape; nodes of others are moved by a tenth of a cell, so that nothing is superconvergent.

Serendipity cells lose an order on meshes that do not become affine (Arnold, Boffi & Falk, Math. Comp. 71, 2002).
"""


class Manufactured:
    """x = X + a sin of a linear form, component by component; body force -div P of a neo-Hooke or Hooke material."""

    def __init__(self, d: int, size: float, small: bool) -> None:
        self.d, self.small = d, small
        self.a = size * np.array([1.0, -0.7, 0.5])[:d]
        self.k = np.array([[1.3, 0.6, -0.4], [-0.5, 1.1, 0.7], [0.3, -0.8, 1.2]])[:d, :d]
        self.phase = np.array([0.3, 0.9, 1.7])[:d]

    def displacement(self, X: Array) -> Array:
        u = np.zeros((len(X), 3))
        u[:, : self.d] = self.a * np.sin(X[:, : self.d] @ self.k.T + self.phase)
        return u

    def gradient(self, X: Array) -> Array:
        H = np.zeros((len(X), 3, 3))
        slope = self.a * np.cos(X[:, : self.d] @ self.k.T + self.phase)
        H[:, : self.d, : self.d] = slope[:, :, None] * self.k
        return H

    def stress(self, X: Array) -> Array:
        """First Piola-Kirchhoff stress."""
        H = self.gradient(X)
        if self.small:
            e = (H + H.transpose(0, 2, 1)) / 2
            return 2 * MU * e + LAM * np.trace(e, axis1=1, axis2=2)[:, None, None] * np.eye(3)
        F = np.eye(3) + H
        inverse = np.linalg.inv(F).transpose(0, 2, 1)
        return MU * (F - inverse) + LAM * np.log(np.linalg.det(F))[:, None, None] * inverse

    def force(self, t: float, X: Array) -> Array:
        """Body force -div P, by differences of sixth order, for the fraction t of the displacement at large strains."""
        kept, self.a = self.a, t * self.a
        h, f = 1e-2, np.zeros((len(X), 3))
        for j in range(self.d):
            for m, w in ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60)):
                move = np.zeros(3)
                move[j] = m * h
                f -= w / h * (self.stress(X + move) - self.stress(X - move))[:, :, j]
        self.a = kept
        return f


def error(cell: str, n: int, small: bool) -> tuple[float, float]:
    """Errors of displacement and its gradient in the mean square, boundary values given."""
    d, linear = CELLS[cell].dimension, LINEAR.get(cell, cell)
    if d == 3:
        mesh = vv.BoxMesh(size=(1, 1, 1), counts=(n, n, n), cell=linear).build()
    else:
        mesh = vv.RectangleMesh(size=(1, 1), counts=(n, n), cell=linear).build()
    mesh = distorted(mesh, ROUGH.get(cell, 0.1) / n)
    solution = Manufactured(d, 1e-3 if small else 0.15, small)
    material: Any = vv.LinearElastic if small else vv.NeoHooke
    solid = vv.Solid(
        mesh=mesh if cell == linear else mesh.quadratic(cell), material=material(lame_lambda=LAM, shear=MU)
    )

    def boundary(t: float, X: Array) -> Array:
        return t * solution.displacement(X)

    system = static(
        [
            solid,
            vv.Prescribed(solid=solid, nodes=solid.grid.boundary().nodes, motion=boundary),
            vv.BodyForce(solid=solid, force=solution.force),
        ],
        step=1.0 if small else 0.5,
    )
    return errors_in_the_mean(solid, system, solution)


def errors_in_the_mean(solid: vv.Solid, system: vv.System, solution: Manufactured) -> tuple[float, float]:
    """Integrals of squares over the quadrature of the masses and of the stresses."""
    u, total = solid.displacements(system.x), 0.0
    for p in solid.cell_points():
        found = np.einsum("qk,mkc->mqc", p.N, u[p.nodes])
        wrong = found - solution.displacement(p.X.reshape(-1, 3)).reshape(p.X.shape)
        total += float((p.size * (wrong**2).sum(axis=2)).sum())
    ((cell, nodes),) = solid.grid.cells.items()
    volume, F = solid.volumes[0], solid.fields(system.x).F
    N = CELLS[cell].N(stiffness_rule(cell).points)
    X = np.einsum("qk,mkc->mqc", N, solid.points[nodes])
    wrong = F - np.eye(3) - solution.gradient(X.reshape(-1, 3)).reshape(F.shape)
    return float(np.sqrt(total)), float(np.sqrt((volume * (wrong**2).sum(axis=(2, 3))).sum()))


@pytest.mark.parametrize("small", [True, False], ids=["small", "large"])
@pytest.mark.parametrize("cell", [*PLANE, *SPACE])
def test_order_of_convergence(cell: str, small: bool) -> None:
    """Displacements with order p + 1, their gradients with order p."""
    p = 2 if cell in LINEAR else 1
    counts = (8, 16) if cell in PLANE else (2, 4)
    by_mesh = np.array([error(cell, n, small) for n in counts])
    assert orders(by_mesh[:, 0])[0] == pytest.approx(p + 1, abs=0.1)
    assert orders(by_mesh[:, 1])[0] == pytest.approx(p, abs=0.1)
