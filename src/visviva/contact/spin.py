"""Torque with which faces rub as they spin: mortar friction sees the mean slip of a vertex' share of the area."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from visviva.contact.contact_surface import Surface

Array = NDArray[np.float64]

FLAT = float(np.cos(np.radians(1.0)))
"""Facets whose normals are closer than this are a face."""
POINTS = 64
"""Of the quadrature along each side of a face: fewer by facet the more of them there are."""


def least_torque(surface: Surface) -> float:
    r"""The least part, of all flat faces, of the torque of an even pressure that friction has at their vertices.

    About the middle c of the face that is :math:`\sum_A |\int N_A (x - c) dA| / \int |x - c| dA`; 1 without faces.
    """
    if surface.dimension == 2 or len(surface.facets) == 0:
        return 1.0
    return min((_torque(surface, face) for face in _faces(surface)), default=1.0)


def _faces(surface: Surface) -> list[NDArray[np.int64]]:
    """Facets of each flat part of a surface that shares vertices."""
    import scipy.sparse as sp

    facets = surface.facets
    facet, corner = np.nonzero(facets >= 0)
    shape = (len(facets), len(surface.places))
    touches = sp.coo_array((np.ones(len(facet)), (facet, facets[facet, corner])), shape=shape).tocsr()
    n, part = sp.csgraph.connected_components(touches @ touches.T, directed=False)
    faces = [np.flatnonzero(part == k) for k in range(n)]
    normals = surface.normals
    return [face for face in faces if (normals[face] @ normals[face[0]]).min() > FLAT]


def _torque(surface: Surface, face: NDArray[np.int64]) -> float:
    facets = surface.facets[face]
    vertex = np.where(facets >= 0, facets, facets[:, :1])  # triangles are squares with two corners in one
    corners = surface.places[vertex]
    knots, weights = np.polynomial.legendre.leggauss(max(2, round(POINTS / len(face) ** 0.5)))
    s, t = (a.ravel() for a in np.meshgrid((1 + knots) / 2, (1 + knots) / 2))
    N = np.stack([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t])
    along, across = np.stack([t - 1, 1 - t, t, -t]), np.stack([s - 1, -s, s, 1 - s])
    x = np.einsum("kp,fkc->fpc", N, corners)
    tangents = (np.einsum("kp,fkc->fpc", d, corners) for d in (along, across))
    area = np.linalg.norm(np.cross(*tangents), axis=2) * np.outer(weights, weights).ravel() / 4
    x -= np.einsum("fp,fpc->c", area, x) / area.sum()
    at_vertices = np.zeros((len(surface.places), 3))
    np.add.at(at_vertices, vertex, np.einsum("kp,fp,fpc->fkc", N, area, x))
    return float(np.linalg.norm(at_vertices, axis=1).sum() / (area * np.linalg.norm(x, axis=2)).sum())
