"""Components on meshes: what is drawn and stored of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from visviva.component import Component
from visviva.mesh.mesh import Mesh

Array = NDArray[np.float64]


class Meshed(Component):
    """A component that fills the cells of a mesh `grid`, with fields at its nodes."""

    grid: Mesh

    @property
    def points(self) -> Array:
        """Positions (n, 3) of the nodes, of a solid in the reference configuration."""
        raise NotImplementedError

    def positions(self, x: Array) -> Array:
        """Positions (n, 3) of the nodes at the unknowns `x` of the system."""
        raise NotImplementedError

    def moving(self, x: Array, v: Array) -> Array:
        """Velocities (n, 3) of what is at the nodes, at the unknowns and rates of the system."""
        raise NotImplementedError

    def widths(self) -> Mapping[str, int]:
        """Its fields by name, with their numbers of components."""
        raise NotImplementedError

    def smoothed(self, names: Sequence[str], x: Array) -> dict[str, Array]:
        """Fields at the nodes, (n,) or (n, components) each."""
        raise NotImplementedError
