"""Surfaces that overlap at the start, moved apart without stress."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.base.errors import InputError
from visviva.body.mesh_body import MeshBody
from visviva.component.announcements import Holding
from visviva.contact.contact_surface import Surface, positions, vertices_of

if TYPE_CHECKING:
    import scipy.sparse as sp

    from visviva.component.component import Component
    from visviva.mesh.faces import Faces
    from visviva.model.model import Model

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

RESOLVED = 1e-9
"""Overlaps smaller than this part of a facet are none."""
ROUNDS = 20
"""The gaps are linearised this often at most."""


@dataclass(frozen=True)
class Side:
    """A surface, and the body with its nodes that move with it; None for what stays."""

    surface: Surface
    body: MeshBody | None
    nodes: Ints
    weights: sp.csr_array  # of the nodes in the vertices

    def inverse_mass(self, model: Model) -> Array:
        """1/mass (n, 3) of the nodes, or other vertices; 0 where they are held."""
        if self.body is None:
            return np.zeros_like(self.surface.constant)
        body, nodes = self.body, self.nodes
        weight = body.nodal_mass if body.density > 0 else np.ones(body.grid.n_nodes)
        mobility = np.tile(1 / weight[nodes][:, None], (1, 3))
        mobility[:, body.dimension :] = 0.0
        for holding in model.announced(body, Holding):
            directions = np.ones(3, dtype=bool) if holding.directions is None else holding.directions
            mobility[np.ix_(np.isin(nodes, holding.nodes), directions)] = 0.0
        return mobility

    def move(self, by: Array, model: Model) -> None:
        """Move the nodes in the reference configuration by (n, 3)."""
        if self.body is not None and np.any(by):
            self.body.move_reference(model, self.nodes, by)


def side_of(surface: Surface, body: Component | None, faces: str | Faces) -> Side:
    """A surface of a body, on these of its faces if it is one on a mesh."""
    import scipy.sparse as sp

    if isinstance(body, MeshBody):
        chosen = body.faces(faces)
        return Side(surface, body, chosen.nodes, vertices_of(chosen))
    return Side(surface, None, np.zeros(0, dtype=int), sp.eye_array(len(surface.forms), format="csr"))


def resolve(label: str, sides: Sequence[Side], model: Model, gaps: _core.Gaps, size: float) -> float:
    """Move nodes of solids until no gap is negative; returns the longest way of a node.

    It is the smallest move in the mean square, weighted by mass (without mass all nodes count the same), that opens
    the gaps: ``min D.M D`` with ``Phi(X + D) >= 0``, by a sequence of linearised gaps. Components that supports hold
    stay, and so do rigid bodies.

    Raises
    ------
    InputError
        If nodes would have to move farther than a facet's `size`, or gaps cannot be opened.
    """
    import scipy.sparse as sp

    x, _ = model.initial
    X = np.concatenate([positions(side.surface, x) for side in sides])
    mobility = np.concatenate([side.inverse_mass(model) for side in sides]).ravel()
    to_vertices = sp.block_diag([side.weights for side in sides], format="csr")
    by_nodes = sp.kron(to_vertices, sp.eye_array(3), format="csr")
    way, change = np.zeros_like(X), 0.0
    depth, G, gap = linearised(gaps, X)
    G = G @ by_nodes
    for _ in range(ROUNDS):
        if max(depth.max(initial=0.0), change) <= RESOLVED * size:
            break
        last, way = way, smallest(G, G @ way.ravel() - gap, mobility).reshape(X.shape)
        change = float(np.abs(way - last).max())
        depth, G, gap = linearised(gaps, X + to_vertices @ way)
        G = G @ by_nodes
    moved = float(np.linalg.norm(way, axis=1).max(initial=0.0))
    if depth.max(initial=0.0) > RESOLVED * size or moved > size:
        place = ", ".join(f"{c:.4g}" for c in X[int(np.argmax(depth))])
        raise InputError(
            f"{label}: the overlap near ({place}) cannot be resolved by moving nodes by less than a facet's "
            f"size, {size:.3g}; move one of the bodies, or free the nodes that supports hold there"
        )
    starts = np.cumsum([0, *(len(side.surface.forms) for side in sides)])
    for side, begin, end in zip(sides, starts, starts[1:], strict=False):
        side.move(way[begin:end], model)
    return moved


def linearised(gaps: _core.Gaps, X: Array) -> tuple[Array, sp.csr_array, Array]:
    """Depths (n,) of overlaps, gradients (n, 3 n_vertices) of the gaps, and the gaps, both weighted by area."""
    import scipy.sparse as sp

    gap, area, rows, vertices, gradient = gaps.linearised(np.ascontiguousarray(X).ravel())
    columns = 3 * vertices.astype(int)[:, None] + np.arange(3)
    entries = (gradient, (np.repeat(rows.astype(int), 3), columns.ravel()))
    depth = np.where(area > 0, -gap / np.where(area > 0, area, 1.0), 0.0)
    return depth, sp.csr_array(entries, shape=(len(gap), X.size)), gap


def smallest(G: sp.csr_array, least: Array, mobility: Array) -> Array:
    """The move (n,) with ``G d >= least`` for which the sum of d^2 / mobility is smallest, by an active set."""
    import scipy.sparse as sp
    from scipy.sparse.linalg import spsolve

    A = (G @ sp.diags_array(mobility) @ G.T).tocsr()
    A = A + sp.diags_array(np.where(A.diagonal() > 0, 1e-13 * A.diagonal().max(), 1.0))
    pushed, force = least > 0, np.zeros(len(least))
    for _ in range(50):
        chosen = np.flatnonzero(pushed)
        force[:] = 0.0
        if len(chosen):
            force[chosen] = spsolve(A[chosen][:, chosen].tocsc(), least[chosen])
        missing = least - A @ force
        wanted = np.where(pushed, force > 0, missing > 0)
        if np.array_equal(wanted, pushed):
            break
        pushed = wanted
    move: Array = mobility * (G.T @ force)
    return move
