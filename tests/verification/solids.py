"""What the verification tests of solids share: held and loaded solids, displacements of places."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import visviva as vv
from visviva.component.component import Component
from visviva.mesh.cells import CELLS

Array = NDArray[np.float64]

SPACE = ("tet4", "tet10", "hex8", "hex20", "hex27", "wedge6")
PLANE = ("tri3", "tri6", "quad4", "quad8", "quad9")
LINEAR = {
    "tet10": "tet4",
    "hex20": "hex8",
    "hex27": "hex8",
    "tri6": "tri3",
    "quad8": "quad4",
    "quad9": "quad4",
}
COOK = ((0.0, 0.0), (48.0, 44.0), (48.0, 60.0), (0.0, 44.0))


def static(components: Sequence[Component], step: float = 1.0, until: float = 1.0) -> vv.System:
    """A system loaded in steps until equilibrium at `until`."""
    system = vv.System(list(components))
    vv.quasi_static(system, until=until, step=step, every=10**9)
    return system


def displacement(system: vv.System, solid: vv.Solid, place: ArrayLike) -> Array:
    """Displacement of the node at a reference position."""
    X = np.zeros(3)
    X[: np.size(place)] = place
    node = int(np.argmin(np.linalg.norm(solid.points - X, axis=1)))
    assert np.linalg.norm(solid.points[node] - X) < 1e-9 * solid.extent
    return np.asarray(solid.displacements(system.x)[node])


def distorted(mesh: vv.Mesh, amount: float, seed: int = 3, boundary: bool = False) -> vv.Mesh:
    """The mesh with its inner nodes, or all, moved at random by up to `amount`."""
    rng = np.random.default_rng(seed)
    move = amount * rng.uniform(-1, 1, mesh.points.shape)
    if not boundary:
        move[mesh.boundary().nodes] = 0.0
    return vv.Mesh(mesh.points + move, mesh.cells, mesh.node_sets, mesh.face_sets, mesh.cell_sets)


def patch(cell: str, amount: float = 0.06, curved: float = 0.0) -> vv.Mesh:
    """Some distorted cells in the unit cube or square; edges straight, or middle nodes moved by up to `curved`."""
    linear = LINEAR.get(cell, cell)
    if CELLS[cell].dimension == 3:
        mesh = vv.BoxMesh(size=(1, 1, 1), counts=(3, 2, 2), cell=linear).build()
    else:
        mesh = vv.RectangleMesh(size=(1, 1), counts=(3, 3), cell=linear).build()
    mesh = distorted(mesh, amount)
    if cell != linear:
        mesh = mesh.quadratic(cell)
    return distorted(mesh, curved, seed=4) if curved else mesh


def homogeneous(solid: vv.Solid, gradient: ArrayLike, load: str = "t") -> vv.Prescribed:
    """All nodes of the boundary follow x = X + f (F - I) X with the time function f."""
    H = np.asarray(gradient, dtype=float) - np.eye(3)
    f = vv.TimeFunction(load)
    nodes = solid.grid.boundary().nodes
    return vv.Prescribed(solid=solid, nodes=nodes, motion=lambda t, X: f(t) * X @ H.T)


def total(solid: vv.Solid, values: Any) -> Array:
    """Integral over the reference volume of values (m, q, ...) at the points of one cell type."""
    return np.asarray(np.einsum("mq,mq...->...", solid.volumes[0], values))
