"""A plugin of pytest that says what the suite's minutes are spent on: processor time, not the clock's, by file.

    cd tests && python -m pytest -p minutes [-n 2] [--minutes FILE]

Child processes count with their test, and so do fixtures with the test that asked for them first. What is left over is
imports, the collection of tests, and pytest itself. ``--minutes FILE`` writes the table that the documentation shows.
"""

from __future__ import annotations

import resource
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

WIDTH = 44
SHOWN = 0.85  # share of the time that the table names file by file
seconds: Counter[str] = Counter()
cases: Counter[str] = Counter()
processes: list[float] = []


def processor_time() -> float:
    """Seconds that this process and its ended children have computed."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(u.ru_utime + u.ru_stime for u in used)


def timed(item: pytest.Item, phase: str) -> Iterator[None]:
    """Note the processor time of a phase of a test where its report is made."""
    start = processor_time()
    yield
    item.user_properties.append((f"seconds of {phase}", processor_time() - start))


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_setup(item: pytest.Item) -> Iterator[None]:
    yield from timed(item, "setup")


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Iterator[None]:
    yield from timed(item, "call")


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_teardown(item: pytest.Item) -> Iterator[None]:
    yield from timed(item, "teardown")


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Sum by file, where the reports of all workers arrive."""
    file = report.nodeid.split("::")[0].removeprefix("tests/")
    seconds[file] += dict(report.user_properties).get(f"seconds of {report.when}", 0.0)
    cases[file] += report.when == "call"


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--minutes", metavar="FILE", help="where to write what the minutes are spent on")


def pytest_sessionfinish(session: pytest.Session) -> None:
    """Of a worker, or of the only process."""
    if hasattr(session.config, "workeroutput"):
        session.config.workeroutput["seconds"] = processor_time()
    elif not session.config.pluginmanager.hasplugin("dsession"):
        processes.append(processor_time())


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: Any) -> None:
    """A worker has ended."""
    processes.append(node.workeroutput["seconds"])


def pytest_terminal_summary(terminalreporter: Any, config: pytest.Config) -> None:
    terminalreporter.write_line("\n" + table())
    if path := config.getoption("--minutes"):
        Path(path).write_text(table() + "\n", encoding="utf-8")


def table() -> str:
    """Files by their share, the small ones in one row."""
    rows, left, total = (
        [f"{'file':{WIDTH}s}{'cases':>7s}{'seconds':>9s}{'so far':>8s}"],
        Counter(seconds),
        0.0,
    )
    for file, share in seconds.most_common():
        if total > SHOWN * seconds.total():
            break
        total += left.pop(file)
        rows.append(f"{file:{WIDTH}s}{cases[file]:7d}{share:9.1f}{total:8.0f}")
    count = sum(cases[file] for file in left)
    rows.append(f"{f'{len(left)} more files':{WIDTH}s}{count:7d}{left.total():9.1f}{seconds.total():8.0f}")
    rest = f"collecting, importing, pytest ({len(processes)} processes)"
    rows.append(f"{rest:{WIDTH}s}{'':7s}{sum(processes) - seconds.total():9.1f}{sum(processes):8.0f}")
    return "\n".join(rows)
