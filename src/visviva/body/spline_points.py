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
    """Points of knot spans: `nodes` are numbers of control points, and `N` is of shape (m, q, k).

    Attributes
    ----------
    anchors : array of int, (n_control,)
        The node of the mesh that is drawn which a control point stands for.
    """

    anchors: Ints

    def unknowns(self, solid: MeshBody) -> NDArray[np.int32]:
        return solid.carriers.unknowns(self.nodes)

    def of_vectors(self, shapes: Array) -> Array:
        return shapes

    def spread(self, densities: Array, n_nodes: int) -> Array:
        total = np.zeros((n_nodes, densities.shape[2]))
        np.add.at(total, self.anchors[self.nodes], self.forces(densities))
        return total


@dataclass(frozen=True, kw_only=True)
class SplineFacePoints(SplinePoints, FacePoints):
    """Points of faces on the sides of patches; `dN` is of shape (m, q, k, d - 1)."""
