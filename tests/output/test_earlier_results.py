"""Results read their ledger and states from the run's files, and only as long as these are the run's."""

from __future__ import annotations

import resource
from pathlib import Path

import numpy as np
import pytest

import visviva as vv
from visviva.base.errors import InputError
from visviva.examples import pendulum
from visviva.study.run import run


def swing(directory: Path, until: float = 0.05, angle: float = 1.0, **options: bool) -> vv.Result:
    """A short run into a directory."""
    return run(pendulum.study(until=until, step=0.01, angle=angle), directory, pictures=False, **options)


def test_a_result_whose_directory_was_overwritten_reads_nothing_of_the_other_run(tmp_path: Path) -> None:
    """Of the same size to the byte, so that counts of rows would not tell."""
    earlier = swing(tmp_path)
    figures = earlier.conservation()
    later = swing(tmp_path, angle=0.5, overwrite=True)
    with pytest.raises(
        InputError, match=r"ledger\.csv: holds the rows of another run.* directory of its own"
    ):
        earlier.ledger["kinetic"]
    with pytest.raises(
        InputError, match=r"states\.npy: holds the states of another run.* directory of its own"
    ):
        earlier.states[-1]
    assert earlier.conservation() == figures
    assert len(later.ledger["kinetic"]) == len(later.states) == 6


def test_a_result_shows_its_own_rows_when_the_run_was_resumed(tmp_path: Path) -> None:
    earlier = swing(tmp_path)
    table, states = earlier.ledger.table, np.array(earlier.states)
    later = swing(tmp_path, until=0.1, resume=True)
    np.testing.assert_array_equal(earlier.ledger.table, table)
    np.testing.assert_array_equal(np.array(earlier.states), states)
    assert len(later.ledger.table) == len(later.states) == 11


def test_a_result_outlives_a_change_of_the_working_directory(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = swing(Path("here"))
    (tmp_path / "there").mkdir()
    monkeypatch.chdir(tmp_path / "there")
    assert len(result.ledger.table) == len(np.array(result.states)) == 6


def test_a_result_without_its_files_says_so(tmp_path: Path) -> None:
    result = swing(tmp_path)
    for name in ("ledger.csv", "states.npy"):
        (tmp_path / name).unlink()
    with pytest.raises(InputError, match=r"ledger\.csv: cannot be read \(No such file"):
        result.ledger["time"]
    with pytest.raises(InputError, match=r"states\.npy: cannot be read \(No such file.*run it again"):
        result.states[0]


def test_results_hold_no_files_open(tmp_path: Path) -> None:
    """As many results as anybody likes, where a process may open a handful of files."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    with open("/dev/null") as null:
        least = null.fileno()
    resource.setrlimit(resource.RLIMIT_NOFILE, (least + 15, hard))
    try:
        results = [swing(tmp_path / str(k), until=0.02) for k in range(25)]
        assert all(len(np.array(result.states)) == 3 for result in results)
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
