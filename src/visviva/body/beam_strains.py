"""Strains of beams at their quadrature points: of states, as forms of the unknowns, and as groups of physics."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.body.beam_line import BeamLine
from visviva.model.form import Strain, Vector, dot
from visviva.model.points import Group

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class BeamStrains:
    """Shear along d1 and d2, extension, curvatures about d1 and d2, twist, at one point less than a cell has nodes.

    Attributes
    ----------
    line : BeamLine
    """

    line: BeamLine

    @cached_property
    def places(self) -> Array:
        """Parameters (q,) of the points in their cells."""
        return np.asarray(np.polynomial.legendre.leggauss(self.line.cells.shape[1] - 1)[0])

    @cached_property
    def _shapes(self) -> tuple[Array, Array, Array]:
        w = np.polynomial.legendre.leggauss(len(self.places))[1]
        N, slope, speed = self.line.slopes(self.places[:, None])
        return N, slope, w * speed

    @property
    def N(self) -> Array:
        """Shape functions (q, k)."""
        return self._shapes[0]

    @property
    def slope(self) -> Array:
        """Their derivatives by length (m, q, k)."""
        return self._shapes[1]

    @property
    def length(self) -> Array:
        """Lengths that the points stand for (m, q)."""
        return self._shapes[2]

    @cached_property
    def reference(self) -> Array:
        """Of the line (m, q, 6)."""
        return self.of(self.line.points, self.line.triads)

    def of(self, phi: Array, d: Array) -> Array:
        """Strains (m, q, 6) of positions (n, 3) and directors (n, 3, 3) of the nodes, of the reference too."""
        nodes = self.line.cells
        own = np.einsum("mkij,mkjc->mkic", self.line.turns, d[nodes])
        tangent = np.einsum("mqk,mkc->mqc", self.slope, phi[nodes])
        D = np.einsum("qk,mkic->mqic", self.N, own)
        dD = np.einsum("mqk,mkic->mqic", self.slope, own)
        e = np.empty((*tangent.shape[:2], 6))
        e[..., :3] = np.einsum("mqic,mqc->mqi", D, tangent)
        e[..., 2] -= 0.5 * np.einsum("mqc,mqc->mq", D[:, :, 2], D[:, :, 2])
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            e[..., 3 + i] = 0.5 * (D[:, :, k] * dD[:, :, j] - D[:, :, j] * dD[:, :, k]).sum(axis=2)
        return e

    # --- in terms of unknowns -------------------------------------------------------------------------------
    def groups(self, cells: Ints, positions: Any, directors: Any) -> list[Group]:
        """Of some cells, whose nodes' positions (m, k) and directors (m, k, 3) begin at these unknowns.

        Those at kinks see directors that are combinations of their nodes' ones.
        """
        slope = self.slope[cells]
        both = np.stack([np.broadcast_to(self.N, slope.shape), slope], axis=3)
        turns = self.line.turns[cells]
        groups = [Group(positions, slope[..., None], None, True)]
        plain = bool(np.all(turns == np.eye(3)))
        for i in range(3):
            if plain:
                groups.append(Group(directors[..., i], both))
                continue
            weights = both[:, :, :, None, :] * turns[:, None, :, i, :, None]
            groups.append(Group(directors.reshape(len(cells), -1), weights.reshape(*slope.shape[:2], -1, 2)))
        return groups

    def forms(self, cell: int, q: int, positions: Any, directors: Any, chosen: Sequence[int]) -> list[Strain]:
        """Some strains at a point of a cell, whose nodes' positions (k,) and directors (k, 3) begin there."""
        turns, slope = self.line.turns[cell], self.slope[cell, q]
        tangent = Vector.at(positions.tolist(), slope)

        def director(i: int, shape: Array) -> Vector:
            return Vector.at(directors.ravel().tolist(), (shape[:, None] * turns[:, i]).ravel())

        found = []
        for s in chosen:
            if s < 3:
                e = dot(director(s, self.N[q]), tangent)
                if s == 2:
                    e = e - 0.5 * dot(director(s, self.N[q]), director(s, self.N[q]))
            else:
                j, k = (s - 2) % 3, (s - 1) % 3
                e = dot(director(k, self.N[q]), director(j, slope)) - dot(
                    director(j, self.N[q]), director(k, slope)
                )
                e = 0.5 * e
            found.append(e - float(self.reference[cell, q, s]))
        return found
