"""One part, instance or assembly of an Abaqus file: its node numbers, cells and sets."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError, nearest
from visviva.mesh.cells import Ints
from visviva.mesh.collect import Collection


@dataclass
class AbaqusPart:
    """Nodes, elements and sets of a part, of its instance, or of all instances together.

    Attributes
    ----------
    node_of, entry_of : dict of int
        Rows of nodes and of elements by their numbers in the file.
    points : list of (2,) or (3,) coordinates
    types, blocks : list of str, list of array of int (m, k)
        Cells by blocks of one type; entries of all blocks are counted through.
    node_sets, cell_sets : dict of str to list of array of int
        Rows and entries by name.
    sides : dict of str to list of (entries, number of the face or None)
    instances : dict of str to AbaqusPart
        Where their numbers and sets are in this assembly.
    """

    node_of: dict[int, int] = field(default_factory=dict)
    entry_of: dict[int, int] = field(default_factory=dict)
    points: list[list[float]] = field(default_factory=list)
    types: list[str] = field(default_factory=list)
    blocks: list[Ints] = field(default_factory=list)
    node_sets: dict[str, list[Ints]] = field(default_factory=dict)
    cell_sets: dict[str, list[Ints]] = field(default_factory=dict)
    sides: dict[str, list[tuple[Ints, int | None]]] = field(default_factory=dict)
    instances: dict[str, AbaqusPart] = field(default_factory=dict)

    @property
    def n_entries(self) -> int:
        """Number of elements."""
        return sum(map(len, self.blocks))

    def behind(self, n_nodes: int, n_entries: int) -> AbaqusPart:
        """The same with its nodes and elements counted on behind others; a copy, also for zeros."""
        return AbaqusPart(
            {number: row + n_nodes for number, row in self.node_of.items()},
            {number: entry + n_entries for number, entry in self.entry_of.items()},
            list(self.points),
            list(self.types),
            [rows + n_nodes for rows in self.blocks],
            {name: [rows + n_nodes for rows in parts] for name, parts in self.node_sets.items()},
            {name: [entries + n_entries for entries in parts] for name, parts in self.cell_sets.items()},
            {name: [(e + n_entries, face) for e, face in parts] for name, parts in self.sides.items()},
        )

    def add(self, name: str, instance: AbaqusPart) -> None:
        """Put an instance behind what is there already."""
        placed = instance.behind(len(self.points), self.n_entries)
        self.points += placed.points
        self.types += placed.types
        self.blocks += placed.blocks
        self.instances[name] = placed

    def coordinates(self) -> NDArray[np.float64]:
        """Points (n, 2) or (n, 3)."""
        if len({len(point) for point in self.points}) > 1:
            raise InputError("some nodes have two coordinates, others three")
        return np.array(self.points)

    def collection(self) -> Collection:
        """All of it: the sets of several instances are called ``INSTANCE.SET``, and the cells of each ``INSTANCE``."""
        if not self.points:
            raise InputError("there are no nodes in it")
        node_sets, cell_sets, sides = dict(self.node_sets), dict(self.cell_sets), dict(self.sides)
        alone = len(self.instances) == 1
        for name, part in self.instances.items():
            for sets, own in ((node_sets, part.node_sets), (cell_sets, part.cell_sets), (sides, part.sides)):
                taken = {k.upper() for k in sets}
                sets |= {f"{name}.{k}" if not alone or k.upper() in taken else k: v for k, v in own.items()}  # type: ignore
            if not alone:
                cell_sets.setdefault(name, []).append(np.array([*part.entry_of.values()], dtype=np.int64))
        return Collection(
            self.coordinates(),
            self.types,
            self.blocks,
            {name: np.unique(np.concatenate(parts)) for name, parts in cell_sets.items()},
            {name: np.unique(np.concatenate(parts)) for name, parts in node_sets.items()},
            sides,
        )

    def nodes(self, word: str, instance: str | None = None) -> Ints:
        """Rows of the node, or of the set of nodes, that a word stands for."""
        part, word = self._part_of(word, instance)
        if word.isdigit():
            return found(np.array([int(word)]), part.node_of, "node")
        return named(word, part.node_sets, "set of nodes")

    def entries(self, word: str, instance: str | None = None) -> Ints:
        """Entries of the element, or of the set of elements, that a word stands for."""
        part, word = self._part_of(word, instance)
        if word.isdigit():
            return found(np.array([int(word)]), part.entry_of, "element")
        return named(word, part.cell_sets, "set of elements")

    def instance(self, name: str | None) -> AbaqusPart:
        """An instance by its name; itself without one."""
        return self if name is None else self.instances[matching(name, self.instances, "instance")]

    def _part_of(self, word: str, instance: str | None) -> tuple[AbaqusPart, str]:
        """Where to look for what: in an instance that is given or leads the word (``INSTANCE.``)."""
        leading, dot, rest = word.rpartition(".")
        if instance is None and dot and leading.upper() in map(str.upper, self.instances):
            return self.instance(leading), rest
        return self.instance(instance), word


def found(ids: Ints, numbers: Mapping[int, int], what: str) -> Ints:
    """Rows of numbered nodes or elements."""
    try:
        return np.array([numbers[k] for k in ids.tolist()], dtype=np.int64)
    except KeyError as error:
        raise InputError(f"there is no {what} {error.args[0]} before its use") from None


def named(name: str, sets: Mapping[str, list[Ints]], what: str) -> Ints:
    """A set by its name."""
    return np.concatenate(sets[matching(name, sets, what)])


def matching(name: str, known: Iterable[str], what: str) -> str:
    """A name as it was first written; capitals do not matter."""
    names = list(known)
    for written in names:
        if written.upper() == name.upper():
            return written
    raise InputError(f"there is no {what} {name!r} before its use{nearest(name, names)}")
