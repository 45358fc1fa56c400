"""A body on a mesh that is no solid: springs between all nodes of each cell, and masses at the nodes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.body.mesh_body import MeshBody
from visviva.component.component import settings
from visviva.component.values import Number, Vector3, VectorOrFunction
from visviva.mesh.generate import MeshSource
from visviva.model.form import squared
from visviva.model.law import length
from visviva.model.model import Model

Array = NDArray[np.float64]


@dataclass(config=settings, eq=False, kw_only=True)
class Net(MeshBody):
    """Loads, supports, contact, couplings, probes and pictures serve it as they do solids."""

    mesh: MeshSource
    density: Number = 1.0
    modulus: Number = 100.0
    thickness: Number = 1.0
    velocity: VectorOrFunction = (0.0, 0.0, 0.0)
    angular_velocity: Vector3 = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        self.grid = self.mesh.build()
        ((_, self.cells),) = self.grid.cells.items()
        self.pairs = np.unique([pair for row in np.sort(self.cells) for pair in combinations(row, 2)], axis=0)

    @property
    def volumes(self) -> list[Array]:
        return [self.grid.volumes[:, None]]

    def lengths(self, x: Array) -> Array:
        return np.asarray(np.linalg.norm(x[self.pairs[:, 1]] - x[self.pairs[:, 0]], axis=1))

    def _masses_of_nodes(self) -> Array:
        share = np.repeat(self.density * self.grid.volumes / self.cells.shape[1], self.cells.shape[1])
        return np.bincount(self.cells.ravel(), share, self.grid.n_nodes)

    def declare(self, model: Model) -> None:
        start = self.initial_velocities()
        self.motion = model.field(self, "position", self.grid.points, start, scale=model.length, node=3)

    def contribute(self, model: Model) -> None:
        self.free = self.lengths(self.grid.points)
        nodes = [self.combination([k], [1.0]) for k in range(self.grid.n_nodes)]
        for (a, b), free in zip(self.pairs, self.free, strict=True):
            model.potential(self, "strain", squared(nodes[b] - nodes[a]), length(self.modulus, free))
        for first, mass in zip(self.node_unknowns(np.arange(len(nodes))), self.nodal_mass, strict=True):
            model.inertia(self, int(first), [[mass]], (True,))

    # --- what it shows -------------------------------------------------------------------------------------
    def widths(self) -> Mapping[str, int]:
        return {"mean_stretch": 1}

    def at_points(self, name: str, x: Array) -> Array:
        """Mean stretch of the springs of each cell."""
        stretch = np.zeros((self.grid.n_nodes,) * 2)
        stretch[tuple(self.pairs.T)] = self.lengths(self.positions(x)) / self.free
        per_cell = [[stretch[pair] for pair in combinations(row, 2)] for row in np.sort(self.cells)]
        return np.array(per_cell).mean(axis=1, keepdims=True)

    def smoothed(self, names: Sequence[str], x: Array) -> dict[str, Array]:
        values = np.repeat(self.at_points("mean_stretch", x)[:, 0], self.cells.shape[1])
        count = np.bincount(self.cells.ravel(), minlength=self.grid.n_nodes)
        return {name: np.bincount(self.cells.ravel(), values) / count for name in names}
