"""Four-node enhanced elements in finite strains beside two published ones, on Cook's membrane.

    python tests/reference/enhanced.py [N ...]

Q1/E4 of Simo and Armero (1992) and its transposed variant Q1/ET4 of Glaser and Armero (1997), written here in NumPy
without any of the package's code: the deflection of the corner for N elements per side, and ours relative to both.
"""

from __future__ import annotations

import sys

import numpy as np
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.complex128]

COOK = ((0, 0), (48, 44), (48, 60), (0, 44))
SHEAR, POISSON, LOAD, STEPS = 0.4225, 0.3, 0.0625, 4
LAMBDA = 2 * SHEAR * POISSON / (1 - 2 * POISSON)
PARENT = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], dtype=float)
GAUSS = PARENT / np.sqrt(3)


def mesh(n: int) -> tuple[Array, NDArray[np.int64]]:
    """Nodes and cells of the membrane."""
    s = np.linspace(0, 1, n + 1)
    a, b = (c.ravel() for c in np.meshgrid(s, s))
    corners = np.array(COOK, dtype=float)
    shapes = np.array([(1 - a) * (1 - b), a * (1 - b), a * b, (1 - a) * b])
    first = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    return shapes.T @ corners, first[:, None] + np.array([0, 1, n + 2, n + 1])


class Membrane:
    """The equations of the membrane: of nodes (2 each), then of the modes of elements (4 each)."""

    def __init__(self, n: int, transposed: bool) -> None:
        self.X, self.cells = mesh(n)
        self.transposed = transposed
        self.right = np.flatnonzero(self.X[:, 0] > 48 - 1e-9)
        left = np.flatnonzero(self.X[:, 0] < 1e-9)
        unknowns = np.arange(2 * len(self.X) + 4 * len(self.cells))
        self.free = np.setdiff1d(unknowns, [2 * left, 2 * left + 1])
        self.external = np.zeros(len(unknowns))
        weights = np.full(len(self.right), 16.0 / n)
        weights[[0, -1]] /= 2
        self.external[2 * self.right + 1] = LOAD * weights

    def residual(self, d: Array, load: float) -> Array:
        """Derivatives of the energy at the unknowns, less the load."""
        m, r = 2 * len(self.X), np.zeros(len(d), dtype=d.dtype)
        x = self.X + d[:m].reshape(-1, 2)
        modes, corners, places = d[m:].reshape(-1, 2, 2), x[self.cells], self.X[self.cells]
        G0 = PARENT / 4
        J0 = np.einsum("eai,ak->eik", places, G0)
        B0 = G0 @ np.linalg.inv(J0) @ np.linalg.inv(J0).transpose(0, 2, 1)
        front = np.einsum("eai,eak->eik", corners, B0)  # F0 J0^-T, so that both are the same in small strains
        to_nodes, to_modes = np.zeros_like(corners), np.zeros_like(modes)
        for point in GAUSS:
            G = PARENT / 4 * (1 + PARENT[:, ::-1] * point[::-1])
            J = np.einsum("eai,ak->eik", places, G)
            j, ratio = np.linalg.det(J), (np.linalg.det(J0) / np.linalg.det(J))[:, None, None]
            B = G @ np.linalg.inv(J)
            scale = np.diag(point)  # of the columns of the modes, of their rows in the transposed element
            back = ratio * np.linalg.inv(J0)
            wilson = scale @ modes if self.transposed else modes @ scale
            F = np.einsum("eai,eak->eik", corners, B) + front @ wilson @ back
            inverse = np.linalg.inv(F).transpose(0, 2, 1)
            P = SHEAR * (F - inverse) + LAMBDA * np.log(determinant(F))[:, None, None] * inverse
            P = P * j[:, None, None]
            to_nodes += np.einsum("eik,eak->eai", P, B)
            of_modes = front.transpose(0, 2, 1) @ P @ back.transpose(0, 2, 1)
            to_modes += scale @ of_modes if self.transposed else of_modes @ scale
            of_front = P @ (wilson @ back).transpose(0, 2, 1)  # the front moves with the nodes
            to_nodes += np.einsum("eik,eak->eai", of_front, B0)
        np.add.at(r[:m].reshape(-1, 2), self.cells, to_nodes)
        r[m:] = to_modes.ravel()
        return r - load * self.external

    def deflection(self) -> float:
        """Of the upper corner on the right, by Newton's method with tangents of complex steps."""
        d = np.zeros(len(self.external))
        for load in np.arange(1, STEPS + 1) / STEPS:
            for _ in range(30):
                tangent = np.column_stack([self.column(d, k, load) for k in self.free])
                change = np.linalg.solve(tangent, self.residual(d, load)[self.free])
                d[self.free] -= change
                if np.abs(change).max() < 1e-10:
                    break
        return float(d[2 * (len(self.X) - 1) + 1])

    def column(self, d: Array, k: int, load: float) -> Array:
        moved = d.astype(complex)
        moved[k] += 1e-30j
        return self.residual(moved, load)[self.free].imag / 1e-30


def determinant(F: Array) -> Array:
    return F[:, 0, 0] * F[:, 1, 1] - F[:, 0, 1] * F[:, 1, 0]


def ours(n: int) -> float:
    """The same by the package."""
    solid = vv.Solid(
        mesh=vv.QuadrilateralMesh(corners=COOK, counts=(n, n)),
        material=vv.NeoHooke(shear=SHEAR, poisson=POISSON),
        formulation="enhanced",
    )
    clamp = vv.Fixed(solid=solid, nodes="x0")
    load = vv.Traction(solid=solid, faces="x1", traction=(0, LOAD, 0), times="t")
    system = vv.System([solid, clamp, load])
    vv.quasi_static(system, until=1.0, step=1 / STEPS)
    return float(system.value(solid.point((48, 60, 0)).position)[1]) - 60


def main() -> None:
    print("elements per side       ours      Q1/E4     Q1/ET4   ours/E4 - 1  ours/ET4 - 1")
    for n in map(int, sys.argv[1:] or ("2", "4", "8")):
        own, plain, transposed = ours(n), Membrane(n, False).deflection(), Membrane(n, True).deflection()
        print(
            f"{n:17} {own:10.6f} {plain:10.6f} {transposed:10.6f} {own / plain - 1:13.1e} "
            f"{100 * (own / transposed - 1):12.2f}%"
        )


if __name__ == "__main__":
    main()
