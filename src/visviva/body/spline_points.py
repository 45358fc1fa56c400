"""Quadrature points of elements of splines, whose functions differ from element to element."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva.body.mesh_points import FacePoints, Points

if TYPE_CHECKING:
    from visviva.body.mesh_body import MeshBody

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, kw_only=True)
class SplinePoints(Points):
    """Points of knot spans: `nodes` are numbers of control points, and `N` is of shape (m, q, k)."""

    def unknowns(self, solid: MeshBody) -> NDArray[np.int32]:
        return solid.carriers.unknowns(self.nodes)

    def of_vectors(self, shapes: Array) -> Array:
        return shapes


@dataclass(frozen=True, kw_only=True)
class SplineFacePoints(SplinePoints, FacePoints):
    """Points of faces on the sides of patches; `dN` is of shape (m, q, k, d - 1).

    Attributes
    ----------
    drawn : array of int, (m, a)
        Nodes of the faces in the mesh that is drawn.
    shapes : array, (q, a)
        Shape functions there.
    """

    drawn: Ints
    shapes: Array

    def spread(self, densities: Array, n_nodes: int) -> Array:
        """To the nodes that are drawn: control points of a part of a side stand beside it too."""
        total = np.zeros((n_nodes, densities.shape[2]))
        np.add.at(total, self.drawn, np.einsum("mq,qa,mqc->mac", self.size, self.shapes, densities))
        return total
