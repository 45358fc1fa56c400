"""What functions write themselves is left out where they are compared; what they read is not."""

from __future__ import annotations

from collections import Counter, deque
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

from visviva.base.told import Teller
from visviva.base.written import own_records, written

total = 0


def told(value: Any) -> str:
    return Teller({}).text(value)


def test_names_that_functions_write_into_are_found() -> None:
    calls, log, seen, by_kind, late, table, line = (
        [0],
        list[float](),
        dict[float, int](),
        Counter(),
        deque(),
        {1: 2},
        [3.0],
    )
    space = SimpleNamespace(inner=SimpleNamespace(n=0))

    def force(t: float) -> Any:
        global total
        total += 1
        calls[0] += 1
        seen[t] = table[1]
        by_kind["force"] += 1
        space.inner.n += 1
        own = [1.0]
        own[0] = line[0]
        own.append(table.get(1, 0))

        def within() -> None:
            log.append(t)
            late.appendleft(t)

        within()
        return [2 * x for x in line] + [line.index(3.0), *table.items(), *own]

    names = {name for name, _ in written(force.__code__)}
    assert names == {"total", "calls", "seen", "by_kind", "space", "log", "late"}


def test_counting_changes_nothing_and_other_values_do() -> None:
    calls, size = [0], [2.0]

    def force(t: float) -> float:
        calls[0] += 1
        return size[0] * t

    before = told(force)
    force(1.0)
    assert told(force) == before
    size[0] = 3.0
    assert told(force) != before


class Force:
    def __init__(self, size: float) -> None:
        self.size, self.calls, self.log = size, 0, list[float]()

    def __call__(self, t: float) -> float:
        self.calls += 1
        self.log.append(t)
        return self.size * t


def test_objects_that_count_are_told_by_what_they_were_made_of() -> None:
    assert own_records(Force) == {"calls", "log"}
    force = Force(2.0)
    before = told(force)
    force(1.0)
    assert told(force) == before != told(Force(3.0))


def test_variables_are_told_by_name() -> None:
    size, inner = 2.0, [1.0]

    def scaled(t: float) -> float:
        return inner[0] * t

    def force(t: float) -> float:
        return size * scaled(t)

    teller = Teller({})
    teller.text(force)
    assert teller.variables["size in function force"] == "2"
    assert teller.variables["inner in function scaled"] == "[1]"


def test_what_functions_use_of_own_modules_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a module of numbers beside the script, which may be another on another machine."""
    numbers, inner = ModuleType("numbers_of_mine"), ModuleType("numbers_of_mine.inner")
    numbers.K, numbers.inner, inner.G, inner.outer = 2.0, inner, 3.0, numbers  # type: ignore[attr-defined]
    monkeypatch.setitem(globals(), "given", numbers)

    def force(t: float) -> Any:
        return given.K * given.inner.G * t + given.inner.outer.K  # type: ignore[name-defined]  # noqa: F821

    teller = Teller({})
    before = teller.text(force)
    assert teller.variables["given.K in function force"] == "2"
    assert teller.variables["given.inner.G in function force"] == "3"
    inner.G = 4.0  # type: ignore[attr-defined]
    assert told(force) != before
    numbers.unused = 1.0  # type: ignore[attr-defined]
    after = told(force)
    numbers.unused = 2.0  # type: ignore[attr-defined]
    assert told(force) == after
