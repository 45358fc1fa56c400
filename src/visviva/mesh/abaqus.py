"""Abaqus input files (.inp): nodes, elements, NSET, ELSET and SURFACE, read; see `write_abaqus` for the other way."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.mesh.abaqus_part import AbaqusPart, found, matching
from visviva.mesh.cells import CELLS, Ints
from visviva.mesh.collect import Collection
from visviva.mesh.source_files import included
from visviva.mesh.write_abaqus import PLACES, PLANE, SOLID, WRITTEN

PATTERNS = (
    (re.compile(r"(?:C3D|DC3D)(\d+)"), SOLID),
    (re.compile(r"(?:CPS|CPE|CPEG|CAX|CGAX|DC2D|DCAX|M3D|SFM3D|R3D|S)(\d)"), PLANE),
    (re.compile(r"B[23]([123])"), {"1": "line2", "2": "line3", "3": "line2"}),
    (re.compile(r"T[23]D([23])"), {"2": "line2", "3": "line3"}),
)
UNREAD = ("NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM", "IMPORT")
"""Keywords that make or move nodes and elements, without which a mesh would be another one."""


@dataclass
class Section:
    """A keyword with its parameters and lines of data."""

    keyword: str
    parameters: dict[str, str]
    lines: list[list[str]] = field(default_factory=list)
    quoted: set[str] = field(default_factory=set)

    def among(self, key: str, known: Iterable[str]) -> str:
        """The name that a parameter gives, as it was first written: capitals do not matter but within quotes."""
        name = self.parameters[key]
        if key in self.quoted:
            return name
        return next((written for written in known if written.upper() == name.upper()), name)

    @property
    def words(self) -> list[list[str]]:
        """The words of the lines, without empty ones."""
        return [[word for word in row if word] for row in self.lines]


def sections(path: Path, within: Path | None = None, depth: int = 0) -> Iterator[Section]:
    """Keywords of a file in order, names and parameters in capitals; included files of a folder are entered."""
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
                now.quoted |= {
                    key.strip().upper() for key, _, value in pairs if value.strip().startswith('"')
                }
                continued = line.endswith(",")
            elif now is not None:
                now.lines.append([word.strip() for word in line.split(",")])
    if now is not None:
        yield from _entered(now, path, within, depth)


def _entered(section: Section, path: Path, within: Path | None, depth: int) -> Iterator[Section]:
    if section.keyword != "INCLUDE":
        yield section
        return
    target = path.parent / section.parameters.get("INPUT", "")
    yield from sections(included(target, path, within, depth + 1), within, depth + 1)


class Reader:
    """Collects what the sections say."""

    def __init__(self, within: Path | None = None) -> None:
        self.within = within
        self.parts: dict[str, AbaqusPart] = {}
        self.assembly = AbaqusPart()
        self.now = self.assembly  # what the sections are about
        self.due: Section | None = None  # the instance that they are about, to be placed at its end

    def read(self, path: Path) -> Collection:
        """All of a file."""
        known: dict[str, Callable[[Section], None]] = {
            "NODE": self.node,
            "ELEMENT": self.element,
            "NSET": self.nset,
            "ELSET": self.elset,
            "SURFACE": self.surface,
            "PART": self.part,
            "INSTANCE": self.instance,
            **dict.fromkeys(("END PART", "END INSTANCE", "ASSEMBLY", "END ASSEMBLY"), self.end),
        }
        for section in sections(path, self.within):
            if section.keyword in UNREAD:
                raise InputError(
                    f"{path}: *{section.keyword} makes or moves nodes or elements and is not read: write the "
                    "file with all nodes and elements in Cartesian coordinates, as Abaqus/CAE does"
                )
            if section.keyword in known:
                try:
                    known[section.keyword](section)
                except (KeyError, IndexError, ValueError) as error:
                    raise InputError(f"*{section.keyword} {section.parameters}: {error}") from error
        self.end()
        return self.whole().collection()

    def whole(self) -> AbaqusPart:
        """The assembly, or the part of a file without one."""
        if self.assembly.instances or not self.parts:
            return self.assembly
        if len(self.parts) > 1 or self.assembly.points:
            listed = ", ".join(self.parts)
            raise InputError(f"no *INSTANCE says where the parts {listed} stand: write it with its assembly")
        return next(iter(self.parts.values()))

    def node(self, section: Section) -> None:
        """Nodes, in the plane or in space."""
        start = len(self.now.points)
        if section.parameters.get("SYSTEM", "R").upper() != "R":
            raise InputError("only Cartesian coordinates (SYSTEM=R) are read: write x, y, z")
        for row in section.lines:
            if int(row[0]) in self.now.node_of:
                raise InputError(f"node {row[0]} is there twice")
            self.now.node_of[int(row[0])] = len(self.now.points)
            self.now.points.append(reals(row[1 : len(row) - (row[-1] == "")][:3]))
        if "NSET" in section.parameters:
            added = np.arange(start, len(self.now.points))
            self.now.node_sets.setdefault(section.among("NSET", self.now.node_sets), []).append(added)

    def element(self, section: Section) -> None:
        """Cells of one type."""
        name = cell_of(section.parameters.get("TYPE", ""))
        width = 1 + CELLS[name].n_nodes
        words = [int(word) for row in section.words for word in row]
        if len(words) % width:
            raise InputError(
                f"elements of type {section.parameters['TYPE']} do not have {width - 1} nodes each"
            )
        rows = np.array(words, dtype=np.int64).reshape(-1, width)
        entries = np.arange(len(rows)) + self.now.n_entries
        self.now.entry_of |= dict(zip(rows[:, 0].tolist(), entries.tolist(), strict=True))
        nodes = found(rows[:, 1:].ravel(), self.now.node_of, "node").reshape(-1, width - 1)
        self.now.types.append(name)
        self.now.blocks.append(nodes[:, PLACES[name]] if name in PLACES else nodes)
        if "ELSET" in section.parameters:
            self.now.cell_sets.setdefault(section.among("ELSET", self.now.cell_sets), []).append(entries)

    def nset(self, section: Section) -> None:
        """A set of nodes, by numbers, by other sets, or by a set of elements."""
        among = section.parameters.get("INSTANCE")
        rows = members(section, self.now.instance(among).node_of, "node", lambda w: self.now.nodes(w, among))
        if "ELSET" in section.parameters:
            entries = self.now.entries(section.parameters["ELSET"], among)
            every = [nodes for block in self.now.blocks for nodes in block]
            rows = np.unique(np.concatenate([every[k] for k in entries]))
        self.now.node_sets.setdefault(section.among("NSET", self.now.node_sets), []).append(rows)

    def elset(self, section: Section) -> None:
        """A set of elements."""
        among = section.parameters.get("INSTANCE")
        numbers = self.now.instance(among).entry_of
        entries = members(section, numbers, "element", lambda w: self.now.entries(w, among))
        self.now.cell_sets.setdefault(section.among("ELSET", self.now.cell_sets), []).append(entries)

    def surface(self, section: Section) -> None:
        """A set of faces by elements and labels S1, S2, ..., or a set of nodes."""
        name = section.among("NAME", self.now.sides)
        if section.parameters.get("TYPE", "ELEMENT").upper() == "NODE":
            parts = [self.now.nodes(row[0]) for row in section.words]
            self.now.node_sets.setdefault(section.among("NAME", self.now.node_sets), []).extend(parts)
            return
        for row in section.words:
            entries = self.now.entries(row[0])
            label = row[1].upper() if len(row) > 1 else None
            if label is not None and not re.fullmatch(r"S[1-6]", label):
                raise InputError(
                    f"surface {name!r} takes side {label}: only S1 to S6 of solid elements are known"
                )
            self.now.sides.setdefault(name, []).append((entries, int(label[1:]) - 1 if label else None))

    def part(self, section: Section) -> None:
        """Begin a part: the lines that follow number and name things within it."""
        self.end()
        if section.among("NAME", self.parts) in self.parts:
            raise InputError("there is a part of this name already")
        self.now = self.parts[section.parameters["NAME"]] = AbaqusPart()

    def instance(self, section: Section) -> None:
        """A copy of a part; nodes and elements may follow that only the instance has."""
        self.end()
        part = self.parts[matching(section.parameters["PART"], self.parts, "part")]
        if section.among("NAME", self.assembly.instances) in self.assembly.instances:
            raise InputError("there is an instance of this name already")
        self.due, self.now = section, part.behind(0, 0)

    def end(self, _: Section | None = None) -> None:
        """A part ends, or an instance: that stands moved, then turned about an axis through two points."""
        if self.due is not None:
            if self.due.lines and self.now.points:
                rows = [reals(row) for row in self.due.lines]
                self.now.points = placed(self.now.coordinates(), rows).tolist()
            self.assembly.add(self.due.parameters["NAME"], self.now)
        self.due, self.now = None, self.assembly


def members(section: Section, numbers: Mapping[int, int], what: str, one: Callable[[str], Ints]) -> Ints:
    """Members of a set: numbers, names of other sets, or first, last and step."""
    if "GENERATE" in section.parameters:
        ranges = [[int(word) for word in row] for row in section.words]
        listed = [np.arange(r[0], r[1] + 1, r[2] if len(r) > 2 else 1) for r in ranges]
        return found(np.concatenate(listed), numbers, what)
    parts = [one(word) for row in section.words for word in row]
    return np.concatenate([np.zeros(0, np.int64), *parts])


def reals(words: list[str]) -> list[float]:
    """Numbers of a line of data, of which those that are left blank are zero.

    Examples
    --------
    >>> reals(["", "1.5D0", "2."])
    [0.0, 1.5, 2.0]
    """
    return [float(re.sub("[dD]", "e", word)) if word else 0.0 for word in words]


def placed(points: NDArray[np.float64], rows: list[list[float]]) -> NDArray[np.float64]:
    """Points of an instance: a row with its translation, and one with two points of an axis and degrees about it.

    Examples
    --------
    >>> turned = [[1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 90.0]]
    >>> placed(np.array([[1.0, 0.0, 0.0]]), turned).round(12).tolist()
    [[0.0, 2.0, 0.0]]
    """
    if len(rows[0]) > 4:  # the line of the translation is blank
        rows = [[], *rows]
    if len(rows) > 2 or len(rows[0]) > 4 or (len(rows) > 1 and len(rows[1]) < 7):
        raise InputError("an instance is placed by x, y, z and by x, y, z of two points and degrees")
    shift = [*rows[0], 0.0, 0.0, 0.0][:3]
    moved = np.zeros((len(points), 3))
    moved[:, : points.shape[1]] = points
    moved += shift
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
