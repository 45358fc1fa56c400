"""What is in the arguments of components, and in what these are made of."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from typing import Any, TypeVar

T = TypeVar("T")


def within(value: Any, kind: type[T], closed: tuple[type, ...] = ()) -> Iterator[T]:
    """What is of a kind in an argument, but for what is in others that are `closed`.

    Examples
    --------
    >>> list(within([("one", 2), (3j,)], complex))
    [3j]
    """
    if isinstance(value, kind):
        yield value
    elif isinstance(value, list | tuple):
        for item in value:
            if isinstance(item, float | int | str):
                return
            yield from within(item, kind, closed)
    elif isinstance(value, dict):
        yield from within(list(value.values()), kind, closed)
    elif is_dataclass(value) and not isinstance(
        value, (type, *closed)
    ):  # points, frames, measures, materials
        for f in fields(value):
            yield from within(getattr(value, f.name), kind, closed)
