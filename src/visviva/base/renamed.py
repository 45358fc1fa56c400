"""Attributes that have another name now."""

from __future__ import annotations

from typing import NoReturn


class Renamed:
    """Stands where an attribute was, and says what it is called now.

    Examples
    --------
    >>> class System:
    ...     touch = Renamed("invalidate")
    >>> System().touch()
    Traceback (most recent call last):
        ...
    AttributeError: System.touch is System.invalidate now
    """

    def __init__(self, name: str) -> None:
        self.name = name

    def __set_name__(self, owner: type, old: str) -> None:
        self.owner, self.old = owner.__name__, old

    def __get__(self, instance: object, owner: type) -> NoReturn:
        raise AttributeError(f"{self.owner}.{self.old} is {self.owner}.{self.name} now")
