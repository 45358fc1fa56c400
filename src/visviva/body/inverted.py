"""Solids whose cells may not turn inside out, though their energies would not tell."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.component.meshed import Meshed
from visviva.mesh.cells import CELLS
from visviva.mesh.mesh import Mesh
from visviva.mesh.quadrature import stiffness_rule

Array = NDArray[np.float64]
CHUNK = 4096
"""Cells that are looked at at a time."""


class Upright:
    """Of a limited `Solid` with terms of points, which know nothing of their cell; that of `Solid` looks at it."""

    grid: Mesh

    def invalid(self, x: Array) -> str:
        """A cell that is inside out at one of its quadrature points."""
        body: Any = self
        return inverted(body, body.positions(x), self._carrying(x)) or str(super().invalid(x))  # type: ignore[misc]

    def trouble(self, x: Array) -> str:
        return self.invalid(x) or str(super().trouble(x))  # type: ignore[misc]

    def _carrying(self, x: Array) -> NDArray[np.bool_]:
        """Which nodes (n,) belong to what still carries: cells of these alone are looked at."""
        return np.ones(self.grid.n_nodes, dtype=bool)


def inverted(body: Meshed, positions: Array, carrying: NDArray[np.bool_]) -> str:
    """The cell that is inside out most, of those whose nodes are all `carrying`; empty if there is none."""
    number = 0
    for cell, nodes in body.grid.cells.items():
        D = CELLS[cell].dN(stiffness_rule(cell).points)
        for first in range(0, len(nodes), CHUNK):
            some = nodes[first : first + CHUNK]
            F = np.einsum("qka,mki->mqia", D, positions[some][:, :, : D.shape[2]])
            least = np.where(carrying[some].all(axis=1), determinants(F).min(axis=1), np.inf)
            if not least[k := int(least.argmin())] > 0:
                place = ", ".join(f"{c:.4g}" for c in body.points[some[k]].mean(axis=0))
                return f"element {number + first + k} of {body.label} near ({place}) is inverted"
        number += len(nodes)
    return ""


def determinants(F: Array) -> Array:
    """Of matrices (..., d, d), d = 2 or 3."""
    if F.shape[-1] == 2:
        return np.asarray(F[..., 0, 0] * F[..., 1, 1] - F[..., 0, 1] * F[..., 1, 0])
    return np.asarray(np.einsum("...i,...i->...", F[..., 0], np.cross(F[..., 1], F[..., 2])))
