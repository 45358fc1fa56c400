"""Runs that are stopped as by Ctrl-C, at a moment that is known, without another study than that of the whole run."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import visviva as vv
from visviva.study.recorder import Recorder
from visviva.study.run import run


def run_until(
    due: Callable[[Recorder], bool],
    study: vv.Study,
    directory: Path,
    sent: int = signal.SIGINT,
    **options: Any,
) -> None:
    """Run until a row is written at which `due` says so, and send the process a signal then."""
    write_row, done = Recorder.write_row, []

    def writing(recorder: Recorder, row: Any) -> None:
        write_row(recorder, row)
        if due(recorder) and not done:
            done.append(True)
            os.kill(os.getpid(), sent)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Recorder, "write_row", writing)
        with pytest.raises(KeyboardInterrupt):
            run(study, directory, pictures=False, **options)


def at(time: float) -> Callable[[Recorder], bool]:
    """Whether a time has come."""
    return lambda recorder: recorder.study.system.time > time - 1e-9


def after_rows(n: int) -> Callable[[Recorder], bool]:
    """Whether so many rows are written."""
    return lambda recorder: recorder.rows >= n
