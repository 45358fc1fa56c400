"""Surfaces of shells for contact and ties: both sides and the rim, with points for each smooth part at kinks."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva.body.touching import Skin, both_sides, looks_up, reversed_order
from visviva.mesh.cells import CELLS
from visviva.mesh.faces import Faces, stacked

if TYPE_CHECKING:
    from visviva.body.shell import Shell

Ints = NDArray[np.int64]


def shell_skin(shell: Shell, chosen: str | Faces) -> Skin:
    """Both sides with the rim for 'all', 'upper', 'lower', or what is chosen of them; of edges their rim.

    Every director, those of the nodes first, has a point of the lower side and one of the upper side. At kinks and
    branches sides end: outside they leave a gap of the thickness, inside they cross.
    """
    import scipy.sparse as sp

    directors, every = shell.every_director, np.arange(shell.grid.n_nodes)
    owner = np.array([shell.node_of_turn(k) for k in range(len(directors))])
    whole = stacked(both_sides(*_turns(shell), len(owner)))
    if isinstance(chosen, str) and chosen == "all" and chosen not in shell.grid.face_sets:
        faces = whole
    else:
        faces = stacked(_sides(shell, shell.faces(chosen), len(owner)))
    position = sp.csr_array((np.ones(len(owner)), (np.arange(len(owner)), owner)))
    sides = [shell.heights[owner, side] for side in range(2)]
    weights = sp.block_array([[position, sp.diags_array(h)] for h in sides], format="csr")
    points = np.concatenate([shell.points[owner] + h[:, None] * directors for h in sides])

    def vectors() -> NDArray[np.int32]:
        return np.concatenate([shell.node_unknowns(every), shell.turn_unknowns(np.arange(len(owner)))])

    own = directors[: len(every)]
    return Skin(
        vectors,
        weights,
        points,
        np.tile(owner, 2),
        faces,
        whole,
        directors=own,
        mass=shell.density,
        folds=shell.more[0],
    )


def _turns(shell: Shell) -> tuple[dict[str, Ints], dict[str, Ints]]:
    """Directors of all cells at their nodes, and of the edges of the border, type by type."""
    border = shell.grid.boundary()
    edges = {kind: shell.turns_of_edges(nodes, border.owners[kind]) for kind, nodes in border.cells.items()}
    return {part.kind: part.turns for part in shell.parts}, edges


def _sides(shell: Shell, faces: Faces, n: int) -> tuple[Faces, Faces, Faces]:
    """Upper and lower sides of faces that run the same way as their cells or the other one, and rims of edges."""
    upper, lower, edges = {}, {}, {}
    for kind, nodes in faces.cells.items():
        turns = shell.turns_of_edges(nodes, faces.owners[kind])
        if CELLS[kind].dimension == 1:
            edges[kind] = turns
            continue
        up = looks_up(nodes, shell.cells_of(kind, faces.owners[kind]))
        upper[kind], lower[kind] = turns[up], turns[~up][:, reversed_order(kind)]
    return both_sides(upper, {}, n)[0], both_sides(lower, {}, n)[1], both_sides({}, edges, n)[2]
