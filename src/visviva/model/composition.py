"""Composition of a system: by whom unknowns were numbered, so that forms and results know where they may be read."""

from __future__ import annotations

from bisect import bisect
from collections.abc import Sequence
from itertools import count
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from visviva.model.field import Field


class Composition:
    """One composition of a system: its components have numbered their unknowns.

    Forms hold the one that they were made in, as their numbers mean others elsewhere. Those of a system that was reset
    are alike if no unknown has another number or initial value.

    Attributes
    ----------
    number : int
        How many were settled before it: what one of several processes was refused alone does not count.
    is_settled : bool
        Whether all of them have.
    """

    _made = count()

    def __init__(self) -> None:
        self.number, self.is_settled = -1, False
        self._alike = object()
        self._names: tuple[tuple[int, str, str], ...] = ()
        self._values = 0

    def settle(self, fields: Sequence[Field], before: Composition | None) -> None:
        """Note the numbers of the unknowns of all fields, and whether they are those of the composition before."""
        self.number, self.is_settled = next(self._made), True
        self._names = tuple((f.start, f.component.label, f.name) for f in fields)
        self._values = hash(b"".join(f.values.tobytes() for f in fields))
        if before is not None and (self._names, self._values) == (before._names, before._values):
            self._alike = before._alike

    def is_alike(self, other: Composition) -> bool:
        """Whether unknowns have the same numbers in both."""
        return self._alike is other._alike

    def describe(self, unknown: int) -> tuple[str, str]:
        """Component and unknown of a number, in words."""
        k = bisect(self._names, unknown, key=lambda named: named[0]) - 1
        if k < 0:
            return "the system", "unknown"
        start, label, name = self._names[k]
        return label, f"{name}[{unknown - start}]"

    def __deepcopy__(self, memo: dict[int, Any]) -> Composition:
        """Itself: copies of forms have the same numbers."""
        return self
