"""What code writes into: a function's own records, such as how often it was called, differ wherever it is called."""

from __future__ import annotations

import dis
from collections.abc import Iterator
from types import CodeType, FunctionType
from typing import Any

LOADS = ("LOAD_GLOBAL", "LOAD_NAME", "LOAD_DEREF")
MEMBERS = ("LOAD_ATTR", "LOAD_METHOD")
STORES = ("STORE_ATTR", "STORE_SUBSCR", "DELETE_ATTR", "DELETE_SUBSCR")
REBOUND = ("STORE_GLOBAL", "STORE_DEREF")
CHANGING = {name for kind in (list, dict, set, bytearray) for name in dir(kind)} - {
    name for kind in (tuple, frozenset, bytes) for name in dir(kind)
}
CHANGING -= {"keys", "values", "items", "get", "fromkeys"}
CHANGING |= {"appendleft", "popleft", "extendleft", "rotate"}
"""Methods by which containers change."""
MAKING = ("__new__", "__init__", "__post_init__", "__setstate__")


def written(code: CodeType) -> set[tuple[str, str]]:
    """Names that a function and those within it write into, with the first attribute on the way there, or "".

    Examples
    --------
    >>> calls, log = [0], []
    >>> def force(t):
    ...     calls[0] += 1
    ...     log.append(t)
    ...     return calls
    >>> sorted(name for name, _ in written(force.__code__))
    ['calls', 'log']
    """
    first = next(iter(code.co_varnames), None)  # the object of a method
    found = {pair for inner in code.co_consts if isinstance(inner, CodeType) for pair in written(inner)}
    ways: dict[Any, list[str]] = {}  # names and attributes that begin at a place of the source
    for step in dis.get_instructions(code):
        at = step.positions and (step.positions.lineno, step.positions.col_offset)
        if step.opname in REBOUND:
            found.add((step.argval, ""))
        if at is None or None in at:
            continue
        if step.opname in LOADS or (step.opname == "LOAD_FAST" and step.argval == first):
            ways[at] = [step.argval]
        elif at in ways:
            way = ways[at]
            if step.opname in STORES or (step.opname in MEMBERS and step.argval in CHANGING):
                more = [step.argval] if step.opname.endswith("_ATTR") and step.opname in STORES else []
                found.add((way[0], next(iter([*way[1:], *more]), "")))
            if step.opname in MEMBERS:
                way.append(step.argval)
    return found


def own_records(kind: type) -> set[str]:
    """Attributes that methods of a class write, other than those that make its objects.

    Examples
    --------
    >>> class Force:
    ...     def __init__(self):
    ...         self.size, self.calls = 2.0, 0
    ...     def __call__(self, t):
    ...         self.calls += 1
    ...         return self.size
    >>> own_records(Force)
    {'calls'}
    """
    return {
        attribute
        for method in methods(kind)
        for name, attribute in written(method.__code__)
        if attribute and name == next(iter(method.__code__.co_varnames), None)
    }


def methods(kind: type) -> Iterator[FunctionType]:
    """Those that are written in a class and its bases, other than those that make its objects."""
    for part in kind.__mro__:
        for name, value in vars(part).items():
            if isinstance(value, FunctionType) and name not in MAKING:
                yield value
