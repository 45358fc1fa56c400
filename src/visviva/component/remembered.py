"""Values that probes compute from a component once, and again after its arguments have changed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Generic, TypeVar

from visviva.component.component import EDITION

T = TypeVar("T")


class Remembered(Generic[T]):
    """Property that outlives no composition: it is kept as long as the component it is worked out of is the same."""

    def __init__(self, make: Callable[[Any], T], argument: str) -> None:
        self.make, self.argument = make, argument
        self.place = f"_kept_{make.__name__}"

    def __get__(self, thing: Any, kind: type | None = None) -> T:
        edition = vars(getattr(thing, self.argument))[EDITION]
        kept = vars(thing).get(self.place)
        if kept is None or kept[0] is not edition:
            vars(thing)[self.place] = kept = edition, self.make(thing)
        found: T = kept[1]
        return found


def remembered(argument: str) -> Callable[[Callable[[Any], T]], Remembered[T]]:
    """Make a property of what is worked out of the component that is an argument of this name."""
    return lambda make: Remembered(make, argument)
