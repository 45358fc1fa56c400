"""Components on meshes: what is drawn and stored of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.base.places import of_places
from visviva.component.component import Component
from visviva.component.momentum import NOWHERE, Axes
from visviva.component.values import VectorOrFunction
from visviva.mesh.cells import CELLS
from visviva.mesh.mesh import Mesh
from visviva.output.surface import Surface

Array = NDArray[np.float64]


def refuse_thickness(label: str, thickness: float, dimension: int, axisymmetric: bool = False) -> None:
    """Refuse a thickness that is not positive, and one of what has none, in space or of revolution.

    Raises
    ------
    InputError
    """
    if not thickness > 0:
        raise InputError(f"{label}: thickness = {thickness:g} is not positive")
    if (dimension == 3 or axisymmetric) and thickness != 1.0:
        whose = "plane meshes" if dimension == 3 else "what is not axisymmetric"
        raise InputError(f"{label}: thickness is for {whose}; leave it out")


class Meshed(Component):
    """A component that fills the cells of a mesh `grid`, with fields at its nodes."""

    grid: Mesh

    @property
    def outside_axes(self) -> Axes:
        return NOWHERE  # what acts on it does

    @property
    def dimension(self) -> int:
        """Components of its nodes' positions: 2 or 3."""
        return int(self.grid.points.shape[1])

    @property
    def points(self) -> Array:
        """Positions (n, 3) of the nodes, of a solid in the reference configuration."""
        return np.pad(self.grid.points, ((0, 0), (0, 3 - self.grid.points.shape[1])))

    @property
    def extent(self) -> float:
        """Size of the mesh, of a solid in the reference configuration."""
        return float(np.linalg.norm(np.ptp(self.grid.points, axis=0)))

    def sampled(self, velocity: VectorOrFunction) -> Array:
        """Velocities (n, 3) at the nodes, of a vector or a function of positions."""
        X = self.points
        if not callable(velocity):
            return np.tile(np.asarray(velocity, dtype=float), (len(X), 1))
        return of_places(self.label, "of velocities", velocity, X, X.shape)

    def positions(self, x: Array) -> Array:
        """Positions (n, 3) of the nodes at the unknowns `x` of the system."""
        raise NotImplementedError

    def velocities(self, x: Array, v: Array) -> Array:
        """Velocities (n, 3) of what is at the nodes, at the unknowns `x` and rates `v` of the system."""
        raise NotImplementedError

    def widths(self) -> Mapping[str, int]:
        """Its fields by name, with their numbers of components."""
        raise NotImplementedError

    def smoothed(self, names: Sequence[str], x: Array) -> dict[str, Array]:
        """Fields at the nodes, (n,) or (n, components) each."""
        raise NotImplementedError

    def nodal(self, name: str, x: Array) -> Array:
        """A field smoothed to the nodes, (n,) or (n, components), at the unknowns `x`.

        Parameters
        ----------
        name : str
            One of `widths`; of solids 'von_mises', 'pressure', 'cauchy' (six components 11, 22, 33, 12, 23, 31),
            'principal_stresses', 'second_piola', 'first_piola', 'green', 'stretches', 'J' or 'energy'.

        Examples
        --------
        >>> import visviva as vv
        >>> steel = vv.LinearElastic(young=2.0, poisson=0.0)
        >>> bar = vv.Solid(mesh=vv.BoxMesh(size=(4, 1, 1), counts=(4, 1, 1)), material=steel)
        >>> system = vv.System([bar])
        >>> stretched = system.x.copy()
        >>> stretched[bar.node_unknowns(range(bar.grid.n_nodes))] *= 1.1
        >>> float(bar.nodal("von_mises", stretched).round(12).max())
        0.2
        """
        if not isinstance(name, str):
            raise InputError(
                f"{self.label}.nodal: the name of the field comes first, then the unknowns: "
                "nodal('von_mises', system.x)"
            )
        return self.smoothed([name], x)[name]

    def _samples(self, name: str, x: Array) -> Array:
        """A field (m, components) where it is known best: at nodes, of strains and stresses at quadrature points."""
        values = self.nodal(name, x)
        return values.reshape(len(values), -1)

    # --- what is drawn of it: by default its cells ---------------------------------------------------------
    def drawn(self) -> Surface:
        """Cells that are drawn and stored, at their reference positions."""
        cells = self.grid.cells
        return Surface(str(self.name), self.points, list(cells.values()), [CELLS[name].vtk for name in cells])

    def drawn_positions(self, x: Array) -> Array:
        """Positions (n, 3) of what is drawn at the unknowns `x` of the system."""
        return self.positions(x)

    def drawn_velocities(self, x: Array, v: Array) -> Array:
        """Velocities (n, 3) of what is drawn at the unknowns `x` and rates `v` of the system."""
        return self.velocities(x, v)

    def drawn_fields(self, names: Sequence[str], x: Array) -> dict[str, Array]:
        """Fields at the points that are drawn, (n,) or (n, components) each."""
        return self.smoothed(names, x)
