"""Streamlines of plane flows as contours of their stream function."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array, diags_array
from scipy.sparse.linalg import splu

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

FINE = 8
WITHIN = (
    np.array([(a + 1 / 3, b + 1 / 3, FINE - a - b - 2 / 3) for a in range(FINE) for b in range(FINE - a)])
    / FINE
)
"""Barycentric coordinates (m, 3) of points that cover a triangle evenly: the middles of small ones like it."""


class StreamFunction:
    """Of velocities without divergence in the plane: constant along the streamlines.

    Parameters
    ----------
    points : (n, 2) array
    triangles : (m, 3) array
        That cover the fluid.

    Examples
    --------
    >>> import numpy as np
    >>> points = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    >>> psi = StreamFunction(points, np.array([(0, 1, 2), (0, 2, 3)]))(np.tile([2.0, 0.0], (4, 1)))
    >>> bool(abs(np.ptp(psi) - 2.0) < 1e-6)  # the flow through
    True
    """

    def __init__(self, points: Array, triangles: Ints) -> None:
        a, b, c = (points[triangles[:, k]] for k in range(3))
        edges = np.stack([c - b, a - c, b - a], axis=1)  # opposite to each corner
        twice = edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0]
        self._triangles, self._area, n = triangles, 0.5 * np.abs(twice), len(points)
        # gradients of the three hat functions (m, 3, 2): the edges turned by a right angle
        self._gradients = np.stack([-edges[..., 1], edges[..., 0]], axis=-1) / twice[:, None, None]
        blocks = np.einsum("mai,mbi,m->mab", self._gradients, self._gradients, self._area)
        rows, columns = np.repeat(triangles, 3, axis=1).ravel(), np.tile(triangles, 3).ravel()
        K = csc_array(coo_array((blocks.ravel(), (rows, columns)), shape=(n, n)))
        self._factors = splu(csc_array(K + diags_array(1e-10 * K.diagonal())))  # the level is free

    def __call__(self, velocities: Array) -> Array:
        """Values (n,) at the points of velocities (n, 2 or 3) there: of all functions that whose gradient is nearest
        to the velocities turned by a right angle."""
        v = velocities[self._triangles].mean(axis=1)
        turned = np.stack([-v[:, 1], v[:, 0]], axis=1)
        shares = np.einsum("mai,mi,m->ma", self._gradients, turned, self._area)
        right = np.bincount(self._triangles.ravel(), shares.ravel(), minlength=self._factors.shape[0])
        return np.asarray(self._factors.solve(right))

    def levels(self, psi: Array, n: int) -> Array:
        """At most `n` values (n,) between which the flow covers equal areas: lines in even density.

        Examples
        --------
        >>> import numpy as np
        >>> points = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
        >>> function = StreamFunction(points, np.array([(0, 1, 2), (0, 2, 3)]))
        >>> bool(np.allclose(function.levels(points[:, 1], 4), [0.125, 0.375, 0.625, 0.875], atol=0.02))
        True
        """
        values = psi[self._triangles] @ WITHIN.T
        order = np.argsort(values, axis=None)
        areas = np.repeat(self._area, len(WITHIN))[order]
        below = np.cumsum(areas) - areas / 2
        return np.unique(np.interp((np.arange(n) + 0.5) / n * areas.sum(), below, values.ravel()[order]))
