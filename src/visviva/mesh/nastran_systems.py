"""Coordinate systems of Nastran, in which places of nodes are given: rectangular, cylindrical, spherical."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from visviva.mesh.cells import Array
from visviva.mesh.nastran_cards import Card

Frame = tuple[str, Array, Array]
"""Kind (R, C or S), origin (3,) and axes (3, 3), one a row, in the basic system."""


def straight(kind: str, places: Array) -> Array:
    r"""Rectangular coordinates (n, 3) of places given in a kind of system; angles are in degrees.

    Cylindrical :math:`(r, \theta, z)`, spherical :math:`(r, \theta, \varphi)` with :math:`\theta` from the z axis.

    Examples
    --------
    >>> straight("C", np.array([[2.0, 90.0, 1.0]])).round(9) + 0.0
    array([[0., 2., 1.]])
    >>> straight("S", np.array([[2.0, 90.0, 180.0]])).round(9) + 0.0
    array([[-2.,  0.,  0.]])
    """
    if kind == "R":
        return places
    r, a, b = places[:, 0], np.radians(places[:, 1]), places[:, 2]
    if kind == "C":
        return np.column_stack([r * np.cos(a), r * np.sin(a), b])
    b = np.radians(b)
    return np.column_stack([r * np.sin(a) * np.cos(b), r * np.sin(a) * np.sin(b), r * np.cos(a)])


class Systems:
    """All systems of a file, by their numbers; they may refer to each other and to nodes in them."""

    def __init__(self, place_of: Callable[[int], Array]) -> None:
        self.place_of = place_of  # of a node, in the basic system
        self.cards: dict[int, Card] = {}
        self.frames: dict[int, Frame] = {0: ("R", np.zeros(3), np.eye(3))}
        self.open: list[int] = []

    def add(self, card: Card) -> None:
        """Entries CORD1R, CORD2R and so on; two of the first kind may stand in a line."""
        n = 4 if card.name[4] == "1" else 11
        parts = [card.fields[:n], card.fields[n : 2 * n] if n == 4 else []]
        for words in filter(any, parts):
            one = Card(card.where, card.name, words)
            number = one.whole(0)
            if number in self.cards or number <= 0:
                raise one.refused(
                    "has a number that is there twice" if number else "has no number of its own"
                )
            self.cards[number] = one

    def basic(self, number: int, places: Array) -> Array:
        """Places (n, 3) given in a system, in the basic one."""
        kind, origin, axes = self.frame(number)
        return origin + straight(kind, places) @ axes

    def frame(self, number: int) -> Frame:
        """A system, from three points: its origin, one on its z axis, one in its plane of x and z."""
        if number not in self.frames:
            card = self.cards[number]
            if number in self.open:
                raise card.refused("refers to itself")
            self.open.append(number)
            a, b, c = self._three(card)
            self.open.pop()
            z, x = b - a, c - a
            y = np.cross(z, x)
            if not np.linalg.norm(y) > 1e-12 * np.linalg.norm(z) * np.linalg.norm(x):
                raise card.refused("has its three points in a line")
            z, y = z / np.linalg.norm(z), y / np.linalg.norm(y)
            self.frames[number] = card.name[-1], a, np.array([np.cross(y, z), y, z])
        return self.frames[number]

    def _three(self, card: Card) -> Array:
        if card.name[4] == "1":
            return np.array([self.place_of(card.whole(k)) for k in (1, 2, 3)])
        places = np.array([card.real(k) for k in range(2, 11)]).reshape(3, 3)
        self.check(card, card.whole(1))
        return self.basic(card.whole(1), places)

    def check(self, card: Card, number: int) -> None:
        """Refuse an entry that refers to a system which is not there."""
        if number not in self.cards and number != 0:
            raise card.refused(f"is given in the coordinate system {number}, which is not there")
