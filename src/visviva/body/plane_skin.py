"""Surfaces of beams in the plane for contact: both sides of the line, half a height off it, and its free ends."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.body.section import GivenSection
from visviva.body.touching import Skin, as_faces
from visviva.mesh.faces import Faces, stacked

if TYPE_CHECKING:
    from visviva.body.beam_line import BeamLine
    from visviva.body.section import CrossSection

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
PIECES: dict[str, list[tuple[int, ...]]] = {
    "line2": [(0, 1)],
    "line3": [(0, 1, 2)],
    "line4": [(0, 2), (2, 3), (3, 1)],
}
"""Faces of each side of a cell: cubic ones are straight from node to node."""
BACK = {"line2": [1, 0], "line3": [1, 0, 2]}


def reach_of(section: CrossSection) -> Array:
    """Least and largest coordinate (2,) along d2 of a section.

    Raises
    ------
    InputError
        If it has no outline.
    """
    if isinstance(section, GivenSection) and section.outline is None and section.outside is None:
        raise InputError(f"{section.label}: nothing says where it is touched; give it an outline")
    across = section.contour()[:, 1]
    return np.array([across.min(), across.max()])


def plane_skin(
    line: BeamLine, reach: Array, joined: Ints, chosen: str, vectors: Callable[[], NDArray[np.int32]]
) -> Skin:
    """Points ``phi + h d2`` of the right side, then of the left one, and the faces between them that are chosen.

    Parameters
    ----------
    line : BeamLine
    reach : array, (m, 2)
        Of the sections of the cells, see `reach_of`; nodes have the mean of the cells that they belong to.
    joined : array of int, (k,)
        Nodes where pieces meet, which are no ends.
    chosen : {'all', 'left', 'right', 'ends'}
    vectors : callable
        First unknowns (2 n,) of positions and of directors d2 of all nodes.
    """
    import scipy.sparse as sp

    n, cells = len(line.points), line.cells
    count = np.bincount(cells.ravel(), minlength=n)
    heights = [np.bincount(cells.ravel(), np.repeat(h, cells.shape[1]), n) / count for h in reach.T]
    every = dict(
        zip(("right", "left", "ends"), _faces(line, np.setdiff1d(_ends(count, cells), joined)), strict=True)
    )
    whole = stacked(every.values())
    sides = [sp.hstack([sp.eye_array(n), sp.diags_array(h)]) for h in heights[::-1]]
    points = [line.points + h[:, None] * line.triads[:, 1] for h in heights[::-1]]
    weights, nodes = sp.vstack(sides).tocsr(), np.tile(np.arange(n), 2)
    faces = whole if chosen == "all" else every[chosen]
    return Skin(vectors, weights, np.concatenate(points), nodes, faces, whole, 2, folds=joined)


def _ends(count: Ints, cells: Ints) -> Ints:
    """Nodes of a single cell that are no inner ones."""
    outer = cells[:, :2].ravel()
    return np.asarray(outer[count[outer] == 1])


def _faces(line: BeamLine, ends: Ints) -> list[Faces]:
    """The right and left side, and free ends, with the outside to the right of each face."""
    n, cells, along = len(line.points), line.cells, line.triads[:, 2]
    runs = np.einsum("mc,mc->m", line.points[cells[:, 1]] - line.points[cells[:, 0]], along[cells[:, 0]]) > 0
    kind = "line2" if line.kind == "line4" else line.kind
    pieces = np.concatenate([cells[:, list(piece)] for piece in PIECES[line.kind]])
    runs = np.tile(runs, len(PIECES[line.kind]))
    right, left = pieces.copy(), pieces[:, BACK[kind]]
    right[~runs], left[~runs] = left[~runs], pieces[~runs]
    last = np.isin(ends, right[:, 1])
    caps = np.column_stack([np.where(last, ends, ends + n), np.where(last, ends + n, ends)])
    return [as_faces({kind: right}), as_faces({kind: left + n}), as_faces({"line2": caps})]
