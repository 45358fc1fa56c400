"""The progress bar of a run."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva.results.audit import gauge_text

if TYPE_CHECKING:
    from visviva.results.ledger import Ledger
    from visviva.study.study import Study

Show = Callable[[NDArray[np.float64]], None]
INTERVAL = 0.1  # seconds between updates


@contextmanager
def progress_bar(study: Study, ledger: Ledger, wanted: bool = True) -> Iterator[Show]:
    """A bar with the time to go and the energy error beside it, on a terminal only.

    Gives a function to call with the ledger's row after each step.
    """
    if not wanted or not sys.stderr.isatty():
        yield lambda row: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (
        TextColumn("[bold]{task.description}"),
        BarColumn(),
        TextColumn("t = {task.completed:.4g} of {task.total:.4g} s"),
        TimeRemainingColumn(compact=True),
        TextColumn("energy error {task.fields[error]:.1e}{task.fields[gauges]}"),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(study.title or "run", total=study.until, error=0.0, gauges="")
        bar.update(task, completed=study.system.time)
        energies = slice(1, 3 + len(ledger.potentials))  # kinetic, potentials, total
        imbalance = ledger.names.index("imbalance")
        scale, shown = float(np.finfo(float).tiny), 0.0

        def show(row: NDArray[np.float64]) -> None:
            nonlocal scale, shown
            scale = max(scale, float(np.abs(row[energies]).max()))
            if time.perf_counter() - shown >= INTERVAL:
                shown = time.perf_counter()
                error, gauges = abs(row[imbalance]) / scale, gauge_text(study.system)
                bar.update(task, completed=row[0], error=error, gauges=gauges)

        yield show


@contextmanager
def counting_bar(title: str) -> Iterator[Callable[[int, int], None]]:
    """A bar for things that are counted; gives a function to call with how many are done and of how many."""
    if not sys.stderr.isatty():
        yield lambda done, total: None
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(title, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)
