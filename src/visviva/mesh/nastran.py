"""Bulk data of Nastran (.bdf, .nas, .fem): nodes in any coordinate system, elements, properties."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from visviva.base.errors import InputError
from visviva.mesh.cells import Array
from visviva.mesh.collect import Collection
from visviva.mesh.nastran_cards import Card, cards
from visviva.mesh.nastran_systems import Systems
from visviva.mesh.node_orders import HEX20

ENDINGS = (".bdf", ".fem", ".nas")
CURE = "write all nodes by GRID, all elements by CTETRA, CHEXA, CPENTA, CQUAD4, CQUAD8, CTRIA3, CTRIA6, CBAR or CROD"
TRIANGLES = ("CTRIA3", "CTRIAR", "CPLSTN3", "CPLSTS3", "CTRAX3", "CTRIAX")
QUADS = ("CQUAD4", "CQUADR", "CPLSTN4", "CPLSTS4", "CQUADX4", "CQUADX")
BARS = ("CBAR", "CBEAM", "CROD", "CTUBE", "CONROD")
KINDS: Mapping[str, Mapping[int, str]] = {
    **{name: {2: "line2"} for name in BARS},
    **{name: {3: "tri3"} for name in TRIANGLES},
    **{name: {4: "quad4"} for name in QUADS},
    **{name: {3: "tri3", 6: "tri6"} for name in ("CTRIA6", "CPLSTN6", "CPLSTS6")},
    **{name: {4: "quad4", 8: "quad8"} for name in ("CQUAD8", "CPLSTN8", "CPLSTS8")},
    "CQUAD": {4: "quad4", 8: "quad8", 9: "quad9"},
    "CTRIAX6": {6: "tri6"},
    "CTETRA": {4: "tet4", 10: "tet10"},
    "CPENTA": {6: "wedge6"},
    "CHEXA": {8: "hex8", 20: "hex20"},
}
"""Types of cells by the entries of elements and how many nodes are given."""
MOST = {"CPENTA": 15, "CTRIAX": 6, "CQUADX": 9}
"""Fields for nodes, where there are more than are read."""
ORDERS = {"CTRIAX6": (0, 2, 4, 1, 3, 5), "CHEXA": HEX20}
"""Which of the entry's nodes each node of a cell of second order is, where corners and middles are mixed."""
OFFSETS = {
    **dict.fromkeys(("CBAR", "CBEAM"), range(10, 16)),
    **dict.fromkeys(("CTRIA3", "CTRIAR"), range(6, 7)),
    **dict.fromkeys(("CQUAD4", "CQUADR"), range(7, 8)),
    "CTRIA6": range(9, 10),
    "CQUAD8": range(15, 16),
}
"""Fields that move an element off its nodes."""
NO_CELLS = (
    *("CELAS", "CDAMP", "CMASS", "CBUSH", "CGAP", "CVISC", "CONM", "CFAST", "CWELD", "CSEAM", "CONV", "CHBDY"),
    *("CBARAO", "CAERO", "CHACAB", "CHACBR", "CAABSF", "CYJOIN", "CYSYM", "CYAX", "CYSUP", "CSUPEXT", "CSSCHD", "CSET"),
    *("CREEP", "CONTACT", "CONTRLT", "CLOAD", "CRIPARM"),
)  # fmt: skip
"""Beginnings of entries that are no cells: springs, dampers, masses, welds, heat, loads and options."""
MOVING = ("SELOC", "SEMPLN", "SEBULK", "RINGAX", "POINTAX", "SECTAX", "=", "/")
"""Beginnings of other entries that make or move nodes or elements."""


class Reader:
    """Collects what the entries say; they may stand in any order."""

    def __init__(self, within: Path | None = None) -> None:
        self.within = within
        self.nodes: dict[int, Card] = {}
        self.default: Card | None = None  # GRDSET
        self.systems = Systems(self._place)
        self.cells: dict[str, list[tuple[Card, list[int]]]] = {}  # and the numbers of their nodes
        self.elements: dict[int, Card] = {}

    def read(self, path: Path) -> Collection:
        """All of a file."""
        known: dict[str, Callable[[Card], None]] = {
            "GRID": self.node,
            "GRDSET": self.defaults,
            **{f"CORD{k}{kind}": self.systems.add for k in "12" for kind in "RCS"},
            **dict.fromkeys(KINDS, self.element),
        }
        for card in cards(path, self.within):
            known.get(card.name, _passed)(card)
        if not self.nodes:
            raise InputError("there are no nodes (GRID) in it")
        return self.collection()

    def node(self, card: Card) -> None:
        """A node."""
        number = card.whole(0)
        if number in self.nodes:
            raise card.refused(f"is there twice: {self.nodes[number].where} has the same number")
        self.nodes[number] = card

    def defaults(self, card: Card) -> None:
        """What blank fields of all nodes mean."""
        if self.default is not None:
            raise card.refused("is there twice")
        self.default = card

    def element(self, card: Card) -> None:
        """An element of nodes that stand behind its number and property."""
        number = card.whole(0)
        if number in self.elements:
            raise card.refused(f"is there twice: {self.elements[number].where} has the same number")
        self.elements[number] = card
        first = 1 if card.name == "CONROD" else 2
        kinds = KINDS[card.name]
        nodes = [card.whole(k) for k in range(first, first + MOST.get(card.name, max(kinds)))]
        given = [n for n in nodes if n]
        kind = kinds.get(len(given))
        if kind is None or nodes[: len(given)] != given or len(set(given)) != len(given):
            listed = " or ".join(map(str, kinds))
            raise card.refused(
                f"has the nodes {' '.join(map(str, given))}, not {listed} different ones: {CURE}"
            )
        if any(card.real(k) for k in OFFSETS.get(card.name, ())):
            raise card.refused(
                "is moved off its nodes by an offset, which is not read: put it where it belongs"
            )
        if card.name in ORDERS and len(given) == len(ORDERS[card.name]):
            given = [given[k] for k in ORDERS[card.name]]
        self.cells.setdefault(kind, []).append((card, given))

    def collection(self) -> Collection:
        """All of it; elements without a property are in no group."""
        row = {number: k for k, number in enumerate(self.nodes)}
        listed = [card for rows in self.cells.values() for card, _ in rows]
        tags = np.array([0 if card.name == "CONROD" else card.whole(1) for card in listed], dtype=np.int64)
        return Collection(
            self._places(),
            list(self.cells),
            [np.array([_numbered(*one, row) for one in rows], np.int64) for rows in self.cells.values()],
            {str(tag): np.flatnonzero(tags == tag) for tag in np.unique(tags[tags != 0]).tolist()},
        )

    def _system_of(self, card: Card) -> int:
        default = 0 if self.default is None else self.default.whole(1)
        number = card.whole(1, blank=default)
        self.systems.check(card, number)
        return number

    def _place(self, number: int) -> Array:
        if number not in self.nodes:
            raise InputError(f"a coordinate system is given by the node {number}, which is not there")
        card = self.nodes[number]
        (place,) = self.systems.basic(self._system_of(card), _given([card]))
        return np.asarray(place)

    def _places(self) -> Array:
        """Places (n, 3) of all nodes in the basic system."""
        listed = list(self.nodes.values())
        places, systems = _given(listed), np.array([self._system_of(card) for card in listed])
        for number in np.unique(systems).tolist():
            there = systems == number
            places[there] = self.systems.basic(number, places[there])
        return places


def _numbered(card: Card, nodes: list[int], row: Mapping[int, int]) -> list[int]:
    """Rows of the nodes of an element."""
    try:
        return [row[n] for n in nodes]
    except KeyError as error:
        raise card.refused(f"has the node {error.args[0]}, which is not there") from None


def _given(listed: list[Card]) -> Array:
    return np.array([[card.real(k) for k in (2, 3, 4)] for card in listed])


def _passed(card: Card) -> None:
    """Pass over materials, loads and constraints, but refuse what makes or moves nodes or elements."""
    is_cell = card.name.startswith("C") and not card.name.startswith(NO_CELLS)
    if is_cell or card.name.startswith(("GRID", *MOVING)):
        raise card.refused(f"is not read: {CURE}")
