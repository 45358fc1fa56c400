"""Abaqus input files (.inp): nodes, elements, NSET, ELSET and SURFACE, read; see `write_abaqus` for the other way."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError, nearest
from visviva.mesh.cells import CELLS, Ints
from visviva.mesh.collect import Collection
from visviva.mesh.source_files import existing, refuse_outside
from visviva.mesh.write_abaqus import PLACES, PLANE, SOLID, WRITTEN

PATTERNS = (
    (re.compile(r"(?:C3D|DC3D)(\d+)"), SOLID),
    (re.compile(r"(?:CPS|CPE|CPEG|CAX|CGAX|DC2D|DCAX|M3D|SFM3D|R3D|S)(\d)"), PLANE),
    (re.compile(r"B[23]([123])"), {"1": "line2", "2": "line3", "3": "line2"}),
    (re.compile(r"T[23]D([23])"), {"2": "line2", "3": "line3"}),
)
MAX_DEPTH = 20  # of files that include each other


@dataclass
class Section:
    """A keyword with its parameters and lines of data."""

    keyword: str
    parameters: dict[str, str]
    lines: list[list[str]] = field(default_factory=list)


def sections(path: Path, within: Path | None = None, depth: int = 0) -> Iterator[Section]:
    """Keywords of a file in order, names and parameters in capitals; included files of a folder are entered."""
    if depth > MAX_DEPTH:
        raise InputError(f"{path} is included more than {MAX_DEPTH} deep: does it include itself?")
    now: Section | None = None
    continued = False
    with path.open(encoding="utf-8", errors="replace") as file:
        for raw in file:
            line = raw.strip()
            if not line or line.startswith("**"):
                continue
            if line.startswith("*") or continued:
                words = [word.strip() for word in line.lstrip("*").split(",")]
                if not continued:
                    if now is not None:
                        yield from _entered(now, path, within, depth)
                    now = Section(words.pop(0).upper(), {})
                assert now is not None
                pairs = [word.partition("=") for word in words if word]
                now.parameters |= {key.strip().upper(): value.strip().strip('"') for key, _, value in pairs}
                continued = line.endswith(",")
            elif now is not None:
                now.lines.append([word.strip() for word in line.split(",") if word.strip()])
    if now is not None:
        yield from _entered(now, path, within, depth)


def _entered(section: Section, path: Path, within: Path | None, depth: int) -> Iterator[Section]:
    if section.keyword != "INCLUDE":
        yield section
        return
    target = path.parent / section.parameters.get("INPUT", "")
    try:
        refuse_outside(existing(target), within)
    except InputError as error:
        raise InputError(f"{path} includes what does not exist or is outside: {error}") from None
    yield from sections(target, within, depth + 1)


class Reader:
    """Collects what the sections say."""

    def __init__(self, within: Path | None = None) -> None:
        self.within = within
        self.node_of: dict[int, int] = {}
        self.entry_of: dict[int, int] = {}
        self.points: list[list[float]] = []
        self.types: list[str] = []
        self.blocks: list[Ints] = []
        self.node_sets: dict[str, list[Ints]] = {}
        self.cell_sets: dict[str, list[Ints]] = {}
        self.sides: dict[str, list[tuple[Ints, int | None]]] = {}
        self.n_parts = self.n_instances = 0

    def read(self, path: Path) -> Collection:
        """All of a file."""
        known = {
            "NODE": self.node,
            "ELEMENT": self.element,
            "NSET": self.nset,
            "ELSET": self.elset,
            "SURFACE": self.surface,
            "PART": self.part,
            "INSTANCE": self.instance,
        }
        for section in sections(path, self.within):
            if section.keyword in known:
                try:
                    known[section.keyword](section)
                except (KeyError, IndexError, ValueError) as error:
                    raise InputError(f"*{section.keyword} {section.parameters}: {error}") from error
        if not self.points:
            raise InputError("there are no nodes in it")
        if len({len(point) for point in self.points}) > 1:
            raise InputError("some nodes have two coordinates, others three")
        return Collection(
            np.array(self.points),
            self.types,
            self.blocks,
            {name: np.concatenate(parts) for name, parts in self.cell_sets.items()},
            {name: np.unique(np.concatenate(parts)) for name, parts in self.node_sets.items()},
            self.sides,
        )

    def node(self, section: Section) -> None:
        """Nodes, in the plane or in space."""
        start = len(self.points)
        for row in section.lines:
            if int(row[0]) in self.node_of:
                raise InputError(f"node {row[0]} is there twice")
            self.node_of[int(row[0])] = len(self.points)
            self.points.append([float(word) for word in row[1:4]])
        if "NSET" in section.parameters:
            added = np.arange(start, len(self.points))
            self.node_sets.setdefault(section.parameters["NSET"], []).append(added)

    def element(self, section: Section) -> None:
        """Cells of one type."""
        name = cell_of(section.parameters.get("TYPE", ""))
        width = 1 + CELLS[name].n_nodes
        words = [int(word) for row in section.lines for word in row]
        if len(words) % width:
            raise InputError(
                f"elements of type {section.parameters['TYPE']} do not have {width - 1} nodes each"
            )
        rows = np.array(words, dtype=np.int64).reshape(-1, width)
        entries = np.arange(len(rows)) + sum(map(len, self.blocks))
        self.entry_of |= dict(zip(rows[:, 0].tolist(), entries.tolist(), strict=True))
        nodes = self.found(rows[:, 1:].ravel(), self.node_of, "node").reshape(-1, width - 1)
        self.types.append(name)
        self.blocks.append(nodes[:, PLACES[name]] if name in PLACES else nodes)
        if "ELSET" in section.parameters:
            self.cell_sets.setdefault(section.parameters["ELSET"], []).append(entries)

    def nset(self, section: Section) -> None:
        """A set of nodes, by numbers, by other sets, or by a set of elements."""
        found = self.members(section, self.node_of, self.node_sets, "node")
        if "ELSET" in section.parameters:
            entries = self.named(section.parameters["ELSET"], self.cell_sets, "ELSET")
            every = [nodes for block in self.blocks for nodes in block]
            found = np.unique(np.concatenate([every[k] for k in entries]))
        self.node_sets.setdefault(section.parameters["NSET"], []).append(found)

    def elset(self, section: Section) -> None:
        """A set of elements."""
        found = self.members(section, self.entry_of, self.cell_sets, "element")
        self.cell_sets.setdefault(section.parameters["ELSET"], []).append(found)

    def surface(self, section: Section) -> None:
        """A set of faces by elements and labels S1, S2, ..., or a set of nodes."""
        name = section.parameters["NAME"]
        if section.parameters.get("TYPE", "ELEMENT").upper() == "NODE":
            parts = [self.one(row[0], self.node_of, self.node_sets, "node") for row in section.lines]
            self.node_sets.setdefault(name, []).extend(parts)
            return
        for row in section.lines:
            entries = self.one(row[0], self.entry_of, self.cell_sets, "element")
            label = row[1].upper() if len(row) > 1 else None
            if label is not None and not re.fullmatch(r"S[1-6]", label):
                raise InputError(
                    f"surface {name!r} takes side {label}: only S1 to S6 of solid elements are known"
                )
            self.sides.setdefault(name, []).append((entries, int(label[1:]) - 1 if label else None))

    def part(self, section: Section) -> None:
        """Numbers would not be unique in several parts."""
        self.n_parts += 1
        if self.n_parts > 1:
            raise InputError("it has several parts: write it flat, without parts and assemblies")

    def instance(self, section: Section) -> None:
        """The part stands where its only instance is: moved, then turned about an axis through two points."""
        self.n_instances += 1
        if self.n_instances > 1:
            raise InputError("it has several instances: write it flat, without parts and assemblies")
        if section.lines and self.points:
            rows = [[float(word) for word in row] for row in section.lines]
            self.points = placed(np.array(self.points), rows).tolist()

    def members(
        self, section: Section, numbers: Mapping[int, int], sets: Mapping[str, list[Ints]], what: str
    ) -> Ints:
        """Members of a set: numbers, names of other sets, or first, last and step."""
        if "GENERATE" in section.parameters:
            ranges = [[int(word) for word in row] for row in section.lines]
            listed = [np.arange(r[0], r[1] + 1, r[2] if len(r) > 2 else 1) for r in ranges]
            return self.found(np.concatenate(listed), numbers, what)
        words = [word for row in section.lines for word in row]
        parts = [self.one(word, numbers, sets, what) for word in words]
        return np.concatenate([np.zeros(0, np.int64), *parts])

    def one(self, word: str, numbers: Mapping[int, int], sets: Mapping[str, list[Ints]], what: str) -> Ints:
        """Members that a number or the name of a set stands for."""
        word = word.rpartition(".")[2] if not word.isdigit() else word  # without the name of an instance
        if word.isdigit():
            return self.found(np.array([int(word)]), numbers, what)
        return self.named(word, sets, f"set of {what}s")

    def named(self, name: str, sets: Mapping[str, list[Ints]], what: str) -> Ints:
        """A set by its name; capitals do not matter."""
        for known, parts in sets.items():
            if known.upper() == name.upper():
                return np.concatenate(parts)
        raise InputError(f"there is no {what} {name!r} before its use{nearest(name, sets)}")

    def found(self, ids: Ints, numbers: Mapping[int, int], what: str) -> Ints:
        """Rows of numbered nodes or elements."""
        try:
            return np.array([numbers[k] for k in ids.tolist()], dtype=np.int64)
        except KeyError as error:
            raise InputError(f"there is no {what} {error.args[0]} before its use") from None


def placed(points: NDArray[np.float64], rows: list[list[float]]) -> NDArray[np.float64]:
    """Points of an instance: a row with its translation, and one with two points of an axis and degrees about it.

    Examples
    --------
    >>> turned = [[1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 90.0]]
    >>> placed(np.array([[1.0, 0.0, 0.0]]), turned).round(12).tolist()
    [[0.0, 2.0, 0.0]]
    """
    moved = np.zeros((len(points), 3))
    moved[:, : points.shape[1]] = points
    moved[:, : len(rows[0])] += rows[0]
    if len(rows) > 1:
        from scipy.spatial.transform import Rotation

        first, second, degrees = np.array(rows[1][:3]), np.array(rows[1][3:6]), rows[1][6]
        axis = (second - first) / np.linalg.norm(second - first)
        moved = first + Rotation.from_rotvec(np.radians(degrees) * axis).apply(moved - first)
    if points.shape[1] == 2 and np.abs(moved[:, 2]).max() > 1e-9 * np.ptp(moved):
        raise InputError("it turns a plane part out of its plane: write it with coordinates in space")
    return moved[:, : points.shape[1]]


def cell_of(element: str) -> str:
    """Cell type of an element type of Abaqus.

    Examples
    --------
    >>> [cell_of(name) for name in ("C3D10M", "C3D8R", "CPE4", "CAX8R", "S4R", "B32")]
    ['tet10', 'hex8', 'quad4', 'quad8', 'quad4', 'line3']
    """
    for pattern, cells in PATTERNS:
        match = pattern.match(element.upper())
        if match and match[1] in cells:
            return cells[match[1]]
    known = ", ".join(WRITTEN.values())
    raise InputError(f"elements of type {element!r} are unknown; known are {known} and their variants")
