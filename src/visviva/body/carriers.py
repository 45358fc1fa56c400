"""Vectors that places of bodies on meshes are made of: their nodes, or the control points of splines."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.body.spline_periods import links
from visviva.mesh.periodic import differences

if TYPE_CHECKING:
    from visviva.body.mesh_body import MeshBody
    from visviva.body.on_splines import OnSplines

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


class Carriers:
    """The nodes of a body, which have unknowns of their own.

    Attributes
    ----------
    points : array (n, 3)
        In the reference configuration.
    mass : array (n,)
        Share of each in the mass.
    """

    def __init__(self, body: MeshBody) -> None:
        self._nodal = body

    @property
    def points(self) -> Array:
        return self._nodal.points

    @property
    def mass(self) -> Array:
        return self._nodal.nodal_mass

    def unknowns(self, numbers: Any) -> NDArray[np.int32]:
        """First unknown of each."""
        return self._nodal.node_unknowns(numbers)

    def vectors(self, values: Array) -> Array:
        """Values of all unknowns of the system as vectors (n, 3) of them: positions, rates, or forces on them."""
        first, d = self.unknowns(np.arange(len(self.points))), self._nodal.dimension
        return np.pad(values[first[:, None] + np.arange(d)], ((0, 0), (0, 3 - d)))

    def at_nodes(self, values: Array) -> Array:
        """Positions or rates (n_nodes, 3) of the nodes among the values of all unknowns of the system."""
        return self.vectors(values)

    def held(self, nodes: Ints) -> Ints:
        """Numbers (k,) of those by which nodes are held."""
        return nodes

    def places(self, nodes: Ints, places: Array) -> Array:
        """Places (k, 3) of these that bring nodes to places (n, 3)."""
        return places

    def links(self, leaders: Ints, pairs: Sequence[tuple[str, str]]) -> Any:
        """Differences (k, n) of them, a sparse matrix, that say how far periodic sides are apart.

        Parameters
        ----------
        leaders : array of int (n_nodes,)
            Of each node the one whose image it is.
        pairs : sequence of (str, str)
            The sides.

        Raises
        ------
        InputError
            If sides do not fit.
        """
        return differences(leaders, len(leaders))

    def refuse_each_node(self, label: str, cure: str) -> None:
        """Refuse, for what acts on every node by a multiplier, nodes that depend on each other.

        Raises
        ------
        InputError
        """


class ControlPoints(Carriers):
    """The control points of a solid on splines."""

    def __init__(self, body: OnSplines) -> None:
        super().__init__(body)
        self._body, self._space = body, body.splines

    @property
    def points(self) -> Array:
        control = self._space.control
        return np.pad(control, ((0, 0), (0, 3 - control.shape[1])))

    @property
    def mass(self) -> Array:
        return self._body.control_mass

    def unknowns(self, numbers: Any) -> NDArray[np.int32]:
        return np.asarray(
            self._body.motion.start + self._body.dimension * np.asarray(numbers), dtype=np.int32
        )

    def at_nodes(self, values: Array) -> Array:
        return np.asarray(self._space.samples @ self.vectors(values))

    def held(self, nodes: Ints) -> Ints:
        try:
            return self._space.held(nodes)
        except InputError as error:
            raise InputError(
                f"{self._body.label} stands on splines: {error}, or attach a point to it"
            ) from None

    def places(self, nodes: Ints, places: Array) -> Array:
        return self._space.fitted_on(nodes, places)

    def links(self, leaders: Ints, pairs: Sequence[tuple[str, str]]) -> Any:
        return links(self._space, pairs)

    def refuse_each_node(self, label: str, cure: str) -> None:
        raise InputError(
            f"{label}: the nodes of {self._body.label} depend on each other, as it stands on splines; {cure}"
        )
