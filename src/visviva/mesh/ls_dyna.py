"""Keyword files of LS-DYNA (.k, .key, .dyn): nodes, elements, parts, sets of nodes, segments and elements."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import islice, pairwise
from pathlib import Path

import numpy as np

from visviva.base.errors import InputError
from visviva.mesh.cells import Ints
from visviva.mesh.collect import Collection
from visviva.mesh.source_files import included

ENDINGS = (".k", ".key", ".dyn")
IGNORED = ("MASS", "DISCRETE", "INERTIA", "SEATBELT", "DIRECT", "TRIM")
"""Elements, by how their keywords go on, that are no cells."""
ELEMENTS = ("SET_SOLID", "SET_SHELL", "SET_BEAM", "SET_TSHELL")
SETS = ("SET_NODE", "SET_PART", *ELEMENTS)
WAYS = ("_LIST", "_COLUMN", "_GENERATE", "_GENERATE_INCREMENT")
"""How sets may be written."""
CURE = "write the deck with all nodes and elements of it in one file, by *NODE and *ELEMENT_SOLID, _SHELL or _BEAM"


@dataclass
class Card:
    """A keyword with its lines of data, and the width of its whole numbers (of others it is 16)."""

    keyword: str
    lines: list[str] = field(default_factory=list)
    width: int = 8

    def numbers(self, line: str, width: int = 0, most: int = 10) -> list[int]:
        """The first whole numbers of a line, by columns or by commas; none are zeros."""
        return [int(word) if word else 0 for word in split(line, [max(self.width, width)] * 10)[:most]]

    def first(self, line: str) -> int:
        """The whole number that a line begins with, whatever follows."""
        return self.numbers(line.split(",")[0] if "," in line else line[: max(self.width, 10)], 10)[0]


def split(line: str, widths: list[int]) -> list[str]:
    """Fields of a line, by columns or by commas.

    Examples
    --------
    >>> split("       1             0.5", [8, 16]), split("1, 0.5", [8, 16])
    (['1', '0.5'], ['1', '0.5'])
    """
    if "," in line:
        return [word.strip() for word in line.split(",")]
    ends = np.cumsum([0, *widths]).tolist()
    words = [line[a:b].strip() for a, b in pairwise(ends) if a < len(line)]
    while words and not words[-1]:
        words.pop()
    return words


def cards(path: Path, within: Path | None = None, depth: int = 0, width: int = 8) -> Iterator[Card]:
    """Keywords of a file in order, in capitals; included files are entered, with columns as wide as there."""
    now = Card("")
    with path.open(encoding="utf-8-sig", errors="replace") as file:
        for raw in file:
            line = raw.rstrip()
            if line.startswith("*"):
                yield from _entered(now, path, within, depth, width)
                keyword = line[1:].upper().strip()
                if keyword == "END":
                    return
                if keyword.startswith("KEYWORD"):
                    width = 20 if "LONG=Y" in keyword else 10 if "I10=Y" in keyword else 8
                own = {"+": 20, "-": 8, "%": 10}.get(keyword[-1:], width)
                now = Card(keyword.rstrip("+-%").strip(), [], own)
            elif (line or titled(now)) and not line.startswith("$"):
                now.lines.append(line)
    yield from _entered(now, path, within, depth, width)


def titled(card: Card) -> bool:
    """Whether the next line is a title, which may be blank."""
    of_parts = card.keyword == "PART" and len(card.lines) % 2 == 0
    return of_parts or (card.keyword.endswith("_TITLE") and not card.lines)


def _entered(card: Card, path: Path, within: Path | None, depth: int, width: int) -> Iterator[Card]:
    if not card.keyword and card.lines:
        raise InputError(f"{path.name}: {card.lines[0][:40]!r} stands before the first keyword")
    if card.keyword != "INCLUDE":
        yield card
        return
    for line in card.lines:
        file = included(path.parent / line.strip(), path, within, depth + 1)
        yield from cards(file, within, depth + 1, width)


class Reader:
    """Collects what the keywords say; sets may come before what is in them."""

    def __init__(self, within: Path | None = None) -> None:
        self.within = within
        self.node_of: dict[int, int] = {}
        self.points: list[list[float]] = []
        self.cells: dict[str, list[list[int]]] = {}  # numbers of nodes, by type
        self.elements: dict[str, list[tuple[str, int, int]]] = {}  # family, number and part of the same
        self.numbers: set[tuple[str, int]] = set()  # family and number of every element
        self.titles: dict[int, str] = {}
        self.sets: list[tuple[str, str, list[int]]] = []  # kind, name, members
        self.ranges: set[str] = set()  # names of sets that need not have all of their members
        self.segments: list[tuple[str, list[list[int]]]] = []

    def read(self, path: Path) -> Collection:
        """All of a file."""
        known: dict[str, Callable[[Card], None]] = {
            "NODE": self.node,
            "PART": self.part,
            "ELEMENT_SOLID": self.solid,
            "ELEMENT_SOLID (TEN NODES FORMAT)": self.solid,
            "ELEMENT_TSHELL": self.solid,
            "ELEMENT_SHELL": self.shell,
            "ELEMENT_SHELL_THICKNESS": self.shell,
            "ELEMENT_SHELL_BETA": self.shell,
            "ELEMENT_BEAM": self.beam,
        }
        for card in cards(path, self.within):
            read = known.get(card.keyword) or (self.set if card.keyword.startswith("SET_") else _ignored)
            try:
                read(card)
            except (IndexError, ValueError) as error:
                raise InputError(f"*{card.keyword}: {error}") from error
        return self.collection()

    def node(self, card: Card) -> None:
        """Nodes in space."""
        for line in card.lines:
            words = split(line, [card.width, *[max(16, card.width)] * 3])
            number = int(words[0])
            if number in self.node_of:
                raise InputError(f"node {number} is there twice")
            self.node_of[number] = len(self.points)
            self.points.append([float(word) if word else 0.0 for word in [*words[1:4], "", "", ""][:3]])

    def part(self, card: Card) -> None:
        """Titles of parts, which name their cells."""
        for title, line in zip(card.lines[::2], card.lines[1::2], strict=False):
            self.titles[card.first(line)] = title.strip()

    def solid(self, card: Card) -> None:
        """Elements of 8 nodes in a line with their number and part, or in one behind that, with 4 to 10.

        Gmsh writes nine of ten nodes beside number and part, and the last one in the next line.
        """
        lines = iter(card.lines)
        for line in lines:
            words = card.numbers(line, most=11)
            number, part, *nodes = words if len(words) > 2 else [*words, *card.numbers(next(lines, ""))]
            if sum(map(bool, nodes)) == 9:
                nodes = [*filter(None, nodes), *card.numbers(next(lines, ""))]
            self._add(card.keyword[8:].split(maxsplit=1)[0], number, part, *solid_cell(number, nodes))

    def shell(self, card: Card) -> None:
        """Elements of 3 or 4 corners, the last twice for 3, and as many middles; thicknesses stand in lines behind."""
        lines = iter(card.lines)
        for line in lines:
            number, part, *nodes = card.numbers(line)
            corners, middles = [n for n in nodes[:4] if n], [n for n in nodes[4:8] if n]
            if card.keyword != "ELEMENT_SHELL":
                list(islice(lines, 2 if middles else 1))
            if len(set(corners)) == 3 and not middles:
                self._add("SHELL", number, part, "tri3", list(dict.fromkeys(corners)))
            elif (
                corners[2:3] == corners[3:] and middles[2:3] == middles[3:] and len({*corners, *middles}) == 6
            ):
                self._add("SHELL", number, part, "tri6", [*corners[:3], *middles[:3]])
            elif len(set(corners)) == 4 and len(middles) in (0, 4):
                self._add("SHELL", number, part, "quad8" if middles else "quad4", [*corners, *middles])
            else:
                raise InputError(
                    f"element {number} has nodes {nodes}, neither 3 or 4 corners nor as many with middles"
                )

    def beam(self, card: Card) -> None:
        """Elements between two nodes."""
        for line in card.lines:
            number, part, *nodes = card.numbers(line)
            self._add("BEAM", number, part, "line2", nodes[:2])

    def _add(self, family: str, number: int, part: int, kind: str, nodes: list[int]) -> None:
        if (family, number) in self.numbers:
            raise InputError(f"element {number} is there twice")
        self.numbers.add((family, number))
        self.cells.setdefault(kind, []).append(nodes)
        self.elements.setdefault(kind, []).append((family, number, part))

    def set(self, card: Card) -> None:
        """Sets of nodes, parts, segments and elements, listed one by one or from the first to the last."""
        kind, lines = card.keyword, iter(card.lines)
        title = next(lines, "").strip() if kind.endswith("_TITLE") else ""
        number = card.first(next(lines, ""))
        kind = kind.removesuffix("_TITLE")
        if kind == "SET_SEGMENT":
            rows = [card.numbers(line, 10, most=4) for line in lines]  # attributes follow, real numbers
            self.segments.append((title or f"segments{number}", rows))
            return
        kind, way = next(((kind.removesuffix(w), w) for w in WAYS if kind.endswith(w)), (kind, ""))
        kind = kind.removesuffix("_LIST")
        if kind not in SETS:
            of = next((of for of in (*SETS, "SET_SEGMENT") if kind.startswith(f"{of}_")), "")
            if of:
                ways = "" if of == "SET_SEGMENT" else ", ".join(WAYS)
                raise InputError(
                    f"is not read: list its members by *{of}{ways}, or leave it out if nothing needs it"
                )
            return
        ranges, members = way.startswith("_GENERATE"), list(members_of(card, lines, way))
        what = {"SET_NODE": "nodes", "SET_PART": "parts"}.get(kind, "elements")
        known = title or f"{what}{number}"
        self.sets.append((kind, known, members))
        if ranges:
            self.ranges.add(known)

    def collection(self) -> Collection:
        """All of it."""
        types, blocks = list(self.cells), [self._nodes(rows) for rows in self.cells.values()]
        listed = [element for kind in types for element in self.elements[kind]]
        parts = np.array([part for _, _, part in listed], dtype=np.int64)
        groups = {self._name_of(part): np.flatnonzero(parts == part) for part in np.unique(parts).tolist()}
        entry = {(family, number): k for k, (family, number, _) in enumerate(listed)}
        node_sets: dict[str, Ints] = {}
        self._refuse_same(groups)
        for kind, name, members in self.sets:
            if kind == "SET_NODE":
                node_sets[name] = self._members(name, members, self.node_of)
            elif kind == "SET_PART":
                declared = {int(part): int(part) for part in [*self.titles, *parts]}  # some have no cells
                there = self._members(name, members, declared)
                groups[name] = np.flatnonzero(np.isin(parts, there))
            else:
                family = kind.removeprefix("SET_")
                groups[name] = self._members(
                    name, members, {n: k for (of, n), k in entry.items() if of == family}
                )
        n = len(listed)
        for name, rows in self.segments:
            for kind, some in by_corners(rows).items():
                types.append(kind)
                blocks.append(self._nodes(some))
                added = np.arange(n, n + len(some))
                groups[name] = np.concatenate([groups.get(name, added[:0]), added])
                n += len(some)
        if not self.points:
            raise InputError("there are no nodes in it")
        return Collection(np.array(self.points), types, blocks, groups, node_sets)

    def _refuse_same(self, parts: Mapping[str, Ints]) -> None:
        """Refuse names that two sets have, or a part and a set of what is made of cells."""
        nodes = [name for kind, name, _ in self.sets if kind == "SET_NODE"]
        others = [name for kind, name, _ in self.sets if kind != "SET_NODE"]
        for names in (nodes, [*parts, *others, *(name for name, _ in self.segments)]):
            if twice := next((name for name in names if names.count(name) > 1), ""):
                raise InputError(f"two sets or parts are called {twice!r}: give them titles of their own")

    def _name_of(self, part: int) -> str:
        title = self.titles.get(part, "")
        return title if title and list(self.titles.values()).count(title) == 1 else f"part{part}"

    def _members(self, name: str, members: list[int], rows: Mapping[int, int]) -> Ints:
        missing = [n for n in members if n not in rows]
        if missing and (name not in self.ranges or len(missing) == len(members)):
            raise InputError(f"set {name!r} has {missing[0]}, which is not there")
        return np.unique(np.array([rows[n] for n in members if n in rows], dtype=np.int64))

    def _nodes(self, rows: list[list[int]]) -> Ints:
        try:
            return np.array([[self.node_of[n] for n in row] for row in rows], dtype=np.int64)
        except KeyError as error:
            raise InputError(f"there is no node {error.args[0]} in it") from None


def _ignored(card: Card) -> None:
    """Pass over materials and controls, but refuse what makes or moves nodes or elements."""
    head, _, rest = card.keyword.partition("_")
    if head in ("NODE", "INCLUDE") or (head == "ELEMENT" and not rest.startswith(IGNORED)):
        raise InputError(f"*{card.keyword} is not read: {CURE}")


def members_of(card: Card, lines: Iterable[str], way: str) -> Iterator[int]:
    """Members of a set: first in their lines, by ranges, by ranges with increments in lines of their own, or all."""
    if way == "_COLUMN":
        yield from map(card.first, lines)
        return
    rows = [card.numbers(line, 10) for line in lines]
    if way == "_GENERATE_INCREMENT":
        for first, last, step in ([*row, 0, 0][:3] for row in rows):
            if step < 1:
                raise InputError(
                    f"a range goes on by {step} from {first} to {last}: give an increment from 1 on"
                )
            yield from range(first, last + 1, step)
        return
    listed = [n for row in rows for n in row if n]
    if way != "_GENERATE":
        yield from listed
        return
    for first, last in zip(listed[::2], listed[1::2], strict=True):
        yield from range(first, last + 1)


def by_corners(rows: list[list[int]]) -> Mapping[str, list[list[int]]]:
    """Segments of three and four corners; of three the last is there twice, or zero."""
    found: dict[str, list[list[int]]] = {}
    for row in rows:
        corners = list(dict.fromkeys(n for n in row if n))
        if len(corners) < 3:
            raise InputError(f"a segment has the nodes {row}")
        found.setdefault("tri3" if len(corners) == 3 else "quad4", []).append(corners)
    return found


def solid_cell(number: int, nodes: list[int]) -> tuple[str, list[int]]:
    """Type and nodes of a solid: bricks whose nodes coincide are wedges or tetrahedra.

    Examples
    --------
    >>> solid_cell(1, [1, 2, 3, 4, 4, 4, 4, 4]), solid_cell(2, [1, 2, 3, 4, 5, 5, 6, 6])
    (('tet4', [1, 2, 3, 4]), ('wedge6', [1, 5, 2, 4, 6, 3]))
    """
    given = [n for n in nodes if n]
    if len(given) == len(set(given)):
        kind = {4: "tet4", 8: "hex8", 10: "tet10"}.get(len(given))
        if kind:
            return kind, given
    if len(given) == 8:
        a, b, c, d, e, f, g, h = given
        if e == f == g == h == d:
            return "tet4", [a, b, c, d]
        if c == d and e == f == g == h and len({a, b, c, e}) == 4:
            return "tet4", [a, b, c, e]
        if e == f and g == h and len({a, b, c, d, e, g}) == 6:
            return "wedge6", [a, e, b, d, g, c]
        if c == d and g == h and len({a, b, c, e, f, g}) == 6:
            return "wedge6", [a, b, c, e, f, g]
    raise InputError(f"element {number} has nodes {given}, which is no tetrahedron, wedge or brick")
