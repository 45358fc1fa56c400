"""A plugin of pytest that writes down how well tests hold: what each compares, the figure, and the limit to keep.

    cd tests && PYTHONPATH=../src python -m verified [FILE or FILE::TEST ...]

runs ``tests/verification``, or what is named of it, and writes ``docs/campaign/verified.csv``, from which the page on
verification is made. Noted are errors below a limit and orders above one, `pytest.approx`, `Result.assert_conserved`
and `numpy.testing.assert_allclose`; differences are relative to the largest of what is expected, where that is not
zero. Of each comparison the case counts that comes nearest to its limit. Tests that fail or did not run keep theirs.
"""

from __future__ import annotations

import csv
import functools
import linecache
import re
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import visviva as vv

TARGET = Path(__file__).resolve().parents[1] / "docs" / "campaign" / "verified.csv"
NUMBER = r"(?:np\.\w+\()?(-?[\d.]+(?:e[-+]?\d+)?)\)?"
COMPARED = re.compile(rf"{NUMBER} (<|<=|>|>=) {NUMBER}(?:\n|$)")
LONGEST = 72
LOOSEST = 0.5
"""Errors below more than this are no errors but sizes of something."""
SHOWN = 3
"""Comparisons of each test, those that come nearest to their limits."""
Check = tuple[str, float, float, float]  # text, figure, limit, how much of it is used

noted: list[Check] = []
nearest: dict[str, dict[str, Check]] = {}
failed: set[str] = set()
_differences: list[tuple[float, float, float]] = []


def difference(actual: Any, expected: Any, tolerance: Any) -> tuple[float, float, float]:
    """Figure, limit and the part of it that is used, of the value that comes nearest to it."""
    off = np.abs(np.asarray(actual, dtype=complex) - expected)
    off, limits = np.broadcast_arrays(off, np.asarray(tolerance, dtype=float))
    used = np.where(off == 0, 0.0, off / np.maximum(limits, 1e-300))
    k = int(np.argmax(used))
    scale = float(np.abs(expected).max()) or 1.0
    return float(off.flat[k]) / scale, float(limits.flat[k]) / scale, float(used.flat[k])


def called() -> str:
    """The text of the call of an assertion in a test."""
    frame = sys._getframe(3)
    start, end, left, right = list(frame.f_code.co_positions())[frame.f_lasti // 2]
    lines = [linecache.getline(frame.f_code.co_filename, n) for n in range(start or 0, (end or 0) + 1)]
    lines[-1] = lines[-1].encode()[:right].decode()
    lines[0] = lines[0].encode()[left:].decode()
    return "".join(lines)


def watch(owner: Any, name: str, look: Callable[..., Any]) -> None:
    """Let `look` see the arguments of a function that has returned."""
    original = getattr(owner, name)

    @functools.wraps(original)
    def watched(*arguments: Any, **options: Any) -> Any:
        value = original(*arguments, **options)
        look(*arguments, **options)
        return value

    setattr(owner, name, watched)


def pytest_configure(config: pytest.Config) -> None:
    """Look at what compares."""

    def approx(approximate: Any, actual: Any) -> None:
        if isinstance(approximate.expected, (int, float)) and np.ndim(actual) == 0:
            _differences.append(difference(actual, approximate.expected, approximate.tolerance))

    def allclose(actual: Any, desired: Any, rtol: float = 1e-7, atol: float = 0.0, **_: Any) -> None:
        if np.size(desired):
            noted.append((called(), *difference(actual, desired, atol + rtol * np.abs(desired))))

    def conserved(result: vv.Result, *names: str, tolerance: float = 1e-9) -> None:
        found, names = result.conservation(), names or ("energy", "constraints")
        figure = max(abs(found[name]) for name in names)
        noted.append((f"{', '.join(names)} conserved", figure, tolerance, figure / tolerance))

    watch(type(pytest.approx(1.0)), "__eq__", approx)
    watch(np.testing, "assert_allclose", allclose)
    watch(vv.Result, "assert_conserved", conserved)


def pytest_assertion_pass(orig: str, expl: str) -> None:
    """An assertion that holds, with its text and its values."""
    if _differences:
        noted.append((orig, *max(_differences, key=lambda d: d[2])))
    elif found := COMPARED.match(expl):
        figure, limit, below = float(found[1]), float(found[3]), found[2][0] == "<"
        if below and 0 < limit <= LOOSEST:
            noted.append((orig, figure, limit, abs(figure) / limit))
        elif not below and "order" in orig + expl and figure:
            noted.append((orig, figure, limit, limit / figure))
    _differences.clear()


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Iterator[None]:
    noted.clear()
    _differences.clear()
    yield
    item.user_properties.append(("checks", list(noted)))


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Keep of every comparison of tests that pass the case that comes nearest to its limit."""
    test = re.sub(r"\[.*", "", report.nodeid.replace("tests/", "").removeprefix("verification/"))
    if report.failed:
        failed.add(test)
    if report.when != "call":
        return
    checks = nearest.setdefault(test, {})
    for text, *numbers in dict(report.user_properties).get("checks", []):
        told = " ".join(text.split())
        told = told if len(told) <= LONGEST else told[: LONGEST - 3] + "..."
        if told not in checks or numbers[2] > checks[told][3]:
            checks[told] = (told, *numbers)


def pytest_sessionfinish(session: pytest.Session) -> None:
    if not hasattr(session.config, "workeroutput"):
        write(TARGET)


def write(path: Path) -> None:
    """Replace the rows of the tests that have passed."""
    passed = {test: checks for test, checks in nearest.items() if test not in failed}
    rows = [row for row in read(path) if row[0] not in passed]
    for test, checks in passed.items():
        chosen = sorted(checks.values(), key=lambda check: -check[3])[:SHOWN]
        rows += [[test, told, f"{figure:.3g}", f"{limit:.3g}"] for told, figure, limit, _ in chosen]
    with path.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows([["test", "check", "figure", "limit"], *sorted(rows)])


def read(path: Path) -> list[list[str]]:
    """Rows that are there."""
    if not path.exists():
        return []
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.reader(file))[1:]


def main() -> int:
    """Run the verification tests under this plugin."""
    options = ["-p", "verified", "-o", "enable_assertion_pass_hook=true", "-p", "no:cacheprovider"]
    return int(pytest.main([*options, *(sys.argv[1:] or ["verification"])]))


if __name__ == "__main__":
    sys.pycache_prefix = str(
        TARGET.parents[2] / "build" / "verified"
    )  # asserts compiled to tell their values
    sys.exit(main())
