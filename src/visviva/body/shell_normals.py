"""Directors of shells: mean normals at the nodes of a mesh, several where smooth parts meet in kinks and branches."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.mesh.cells import CELLS
from visviva.mesh.geometry import jacobians

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Mask = NDArray[np.bool_]
KINK = np.deg2rad(45.0)
"""Cells that meet at more than this do not make a smooth surface."""
FOLD = np.deg2rad(15.0)
"""Nor, probably, do those that meet at more than this, and at four times the angle to their other neighbours."""
ALIKE = np.cos(np.deg2rad(5.0))
"""Directors of a node within 5 degrees are one."""
SIZE = {3: 0.5, 4: 4.0}
"""Of the reference cell by its corners: what normals are weighed by besides their lengths."""


@dataclass(frozen=True, eq=False)
class Normals:
    """Of a mesh with cells of any types: corners are the nodes of all cells, one cell after the other.

    Attributes
    ----------
    points : array, (n, 3)
    cells : dict of array, (m, k)
    label : str
    """

    points: Array
    cells: dict[str, Ints]
    label: str

    @cached_property
    def starts(self) -> dict[str, int]:
        """Of each type: the first of its corners."""
        sizes = [nodes.size for nodes in self.cells.values()]
        return dict(zip(self.cells, np.cumsum([0, *sizes]).tolist(), strict=False))

    @cached_property
    def nodes(self) -> Ints:
        """Of the corners (c,)."""
        return np.concatenate([nodes.ravel() for nodes in self.cells.values()])

    @cached_property
    def weighed(self) -> Array:
        """Normals (c, 3) times areas."""
        found = []
        for kind, nodes in self.cells.items():
            cell = CELLS[kind]
            J = jacobians(self.points, nodes, cell.dN(cell.nodes))
            normals = np.cross(J[..., 0], J[..., 1]) * SIZE[cell.n_corners]
            self._refuse_folded(kind, normals)
            found.append(normals.reshape(-1, 3))
        return np.concatenate(found)

    def _refuse_folded(self, kind: str, normals: Array) -> None:
        size = np.linalg.norm(normals, axis=2)
        extent = np.linalg.norm(np.ptp(self.points, axis=0))
        cells = self.cells[kind]
        if not np.all(size > 1e-14 * extent**2):
            k = int(np.argmin(size.min(axis=1)))
            raise InputError(
                f"{self.label}: cell {k} of its mesh, nodes {cells[k].tolist()}, has no area at a corner"
            )
        least = np.einsum("mac,mbc->mab", normals, normals).min(axis=(1, 2))
        if not np.all(least > 0):
            k = int(np.argmin(least))
            raise InputError(
                f"{self.label}: cell {k} of its mesh, nodes {cells[k].tolist()}, is folded or inverted"
            )

    @cached_property
    def units(self) -> Array:
        return np.asarray(self.weighed / np.linalg.norm(self.weighed, axis=1, keepdims=True))

    # --- edges ---------------------------------------------------------------------------------------------
    @cached_property
    def _edges(self) -> tuple[Ints, Ints]:
        """Corners at the ends and in the middle, or -1, of the edges of all cells (e, 3); their cells (e,)."""
        corners, owners, first = [], [], 0
        for kind, nodes in self.cells.items():
            local = np.array([[*face.nodes, -1][:3] for face in CELLS[kind].faces])
            start = self.starts[kind] + nodes.shape[1] * np.arange(len(nodes))
            corners.append(np.where(local < 0, -1, start[:, None, None] + local).reshape(-1, 3))
            owners.append(np.repeat(first + np.arange(len(nodes)), len(local)))
            first += len(nodes)
        return np.concatenate(corners), np.concatenate(owners)

    @cached_property
    def pairs(self) -> Ints:
        """Edges (p, 2) of two cells that are one in space; of branches every two."""
        ends = np.sort(self.nodes[self._edges[0][:, :2]], axis=1)
        _, key = np.unique(ends, axis=0, return_inverse=True)
        order = np.argsort(key.ravel(), kind="stable")
        sets = np.split(order, np.flatnonzero(np.diff(key.ravel()[order])) + 1)
        two = [s for s in sets if len(s) > 1]
        return np.array(
            [(a, b) for s in two for i, a in enumerate(s) for b in s[i + 1 :]], dtype=np.int64
        ).reshape(-1, 2)

    @cached_property
    def _meeting(self) -> tuple[Mask, Ints, Ints]:
        """Of the pairs: whether both run the same way, and corners (p, 3) of either that lie on one another."""
        corners = self._edges[0]
        a, b = corners[self.pairs[:, 0]], corners[self.pairs[:, 1]]
        same = self.nodes[a[:, 0]] == self.nodes[b[:, 0]]
        b = np.where(same[:, None], b, b[:, [1, 0, 2]])
        middle = (a[:, 2:] >= 0) & (b[:, 2:] >= 0)
        return same, np.where(middle, a, a[:, [0, 1, 0]]), np.where(middle, b, b[:, [0, 1, 0]])

    @cached_property
    def _run(self) -> tuple[Mask, Array]:
        """Of the pairs: whether both run the same way, and the largest angle between their normals."""
        same, a, b = self._meeting
        cosine = np.einsum("pec,pec->pe", self.units[a], self.units[b]).min(axis=1)
        return same, np.asarray(np.arccos(np.clip(cosine, -1, 1)))

    @cached_property
    def _flat(self) -> Mask:
        """Cells (m,) of three nodes, whose angles to their neighbours tell little."""
        return np.repeat(
            [kind == "tri3" for kind in self.cells], [len(nodes) for nodes in self.cells.values()]
        )

    @cached_property
    def sharp(self) -> Mask:
        """Pairs (p,) that meet in a kink, or run the same way."""
        same, angle = self._run
        own = self._edges[1][self.pairs]
        others = np.zeros(own.max(initial=0) + 1)
        top = np.zeros_like(others)  # the largest angle at the edges of each cell, and the next one
        count = np.bincount(own.ravel(), minlength=len(others))
        for cell, value in zip(own.T.ravel(), np.tile(angle, 2), strict=True):
            if value > top[cell]:
                others[cell], top[cell] = top[cell], value
            else:
                others[cell] = max(others[cell], value)
        beside = others[own].max(axis=1)
        known = np.all((count[own] > 2) & ~self._flat[own], axis=1)
        return np.asarray(same | (angle > KINK) | (known & (angle > FOLD) & (angle > 4 * beside)))

    def refuse_turned(self, kinks: bool) -> None:
        """Refuse neighbours whose upper sides are on different sides of a smooth surface.

        Raises
        ------
        InputError
        """
        same, angle = self._run
        wrong = same & (angle > np.pi - KINK) if kinks else same
        if np.any(wrong):
            a, b = self.pairs[int(np.argmax(wrong))]
            corners, own = self._edges
            raise InputError(
                f"{self.label}: cells {own[a]} and {own[b]} at the edge of nodes "
                f"{self.nodes[corners[a, :2]].tolist()} have their upper sides on different sides; number their "
                "nodes the same way round"
            )

    # --- directors -----------------------------------------------------------------------------------------
    def smooth(self) -> Array:
        """One director (n, 3) for each node.

        Raises
        ------
        InputError
            Where the surface has a kink or a branch.
        """
        total = np.zeros_like(self.points)
        np.add.at(total, self.nodes, self.weighed)
        length = np.linalg.norm(total, axis=1)
        directors = total / np.maximum(length, 1e-300)[:, None]
        self._refuse_kinks(directors, self.nodes)
        directors[length == 0] = (0.0, 0.0, 1.0)  # of nodes without cells
        self._say_folds()
        return np.asarray(directors)

    def _say_folds(self) -> None:
        if np.any(self.sharp):
            a = self._edges[0][self.pairs[int(np.argmax(self.sharp)), 0], :2]
            warnings.warn(
                f"{self.label}: its surface seems to have a kink of {np.degrees(self._run[1][self.sharp].max()):.0f} "
                f"degrees at the edge of nodes {self.nodes[a].tolist()}, where a mean director stands; "
                "kinks='rigid' keeps one for either side",
                stacklevel=2,
            )

    def _refuse_kinks(self, directors: Array, of: Ints) -> None:
        between = (self.units * directors[of]).sum(axis=1)
        if not np.all(between > np.cos(KINK / 2)):
            k = int(self.nodes[np.argmin(between)])
            raise InputError(
                f"{self.label}: its surface has a kink or a branch at node {k}, {self.points[k].tolist()}; mesh a "
                "smooth surface finer, or let kinks='rigid' or 'hinged' join smooth parts there"
            )

    def several(self) -> tuple[Array, Ints, Ints]:
        """Directors (n + e, 3), which of them each corner has (c,), and the nodes (e,) of those behind the first n.

        Raises
        ------
        InputError
            Where the surface is not smooth away from kinks.
        """
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components

        _, a, b = (corners[~self.sharp] for corners in self._meeting)
        n = len(self.nodes)
        links = coo_array((np.ones(a.size), (a.ravel(), b.ravel())), shape=(n, n))
        part = connected_components(links, directed=False)[1]
        _, first, part = np.unique(part, return_index=True, return_inverse=True)
        mean = np.zeros((len(first), 3))
        np.add.at(mean, part, self.weighed)
        mean /= np.linalg.norm(mean, axis=1, keepdims=True)
        number, extra = self._numbered(mean, self.nodes[first])
        total = np.zeros((len(self.points) + len(extra), 3))
        np.add.at(total, number[part], self.weighed)
        length = np.linalg.norm(total, axis=1)
        directors = total / np.maximum(length, 1e-300)[:, None]
        directors[length == 0] = (0.0, 0.0, 1.0)
        self._refuse_kinks(directors, number[part])
        return directors, number[part], extra

    def _numbered(self, mean: Array, nodes: Ints) -> tuple[Ints, Ints]:
        """Numbers of the directors of the parts, and the nodes of those beyond one for each node."""
        number = np.empty(len(nodes), dtype=np.int64)
        extra: list[int] = []
        found: dict[int, list[int]] = {}
        for k, node in enumerate(nodes.tolist()):
            mine = found.setdefault(node, [])
            for other in mine:
                cosine = mean[k] @ mean[other]
                if cosine < -ALIKE:
                    raise InputError(
                        f"{self.label}: its parts have their upper sides on different sides at node {node}, "
                        f"{self.points[node].tolist()}; number the nodes of their cells the same way round"
                    )
                if cosine > ALIKE:
                    number[k] = number[other]
                    break
            else:
                number[k] = len(self.points) + len(extra) if mine else node
                extra += [node] if mine else []
                mine.append(k)
        return number, np.array(extra, dtype=np.int64)
