"""Shape functions of beams: those of lines, with nodes of Gauss & Lobatto in cells of four."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from visviva.mesh.cells import CELLS, Cell
from visviva.mesh.mesh import Mesh

Array = NDArray[np.float64]


class LobattoLine(Cell):
    """The line of four nodes with those inside at the places of Gauss & Lobatto.

    What interpolation leaves out then vanishes in the mean over the integration points, so that beams gain two orders.
    """

    @cached_property
    def nodes(self) -> Array:
        return np.array([[-1.0], [1.0], [-(5**-0.5)], [5**-0.5]])

    @cached_property
    def coefficients(self) -> Array:
        return np.asarray(np.linalg.inv(self.nodes ** np.array(self.powers).T))


_LINE4 = CELLS["line4"]
_LOBATTO = LobattoLine(_LINE4.name, _LINE4.family, _LINE4.middles, _LINE4.powers, _LINE4.vtk, _LINE4.meshio)


def shape_of(kind: str) -> Cell:
    """The shape functions of beams of a cell type."""
    return _LOBATTO if kind == _LINE4.name else CELLS[kind]


def with_shapes_of_beams(grid: Mesh) -> Mesh:
    """The mesh with nodes inside cells of four where beams have them, on the same curves."""
    if _LINE4.name not in grid.cells:
        return grid
    cells, points = grid.cells[_LINE4.name], grid.points.copy()
    points[cells[:, 2:]] = np.einsum("ak,mkc->mac", _LINE4.N(_LOBATTO.nodes[2:]), points[cells])
    return replace(grid, points=points)
