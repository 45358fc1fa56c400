"""Runs that stop before the time they were given is over, and go on to the bit."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import visviva as vv
from visviva.base import deadline
from visviva.base.deadline import Deadline, TimeLimit, seconds_of
from visviva.cli import main
from visviva.examples import pendulum
from visviva.study.recorder import Recorder
from visviva.study.run import run


class Clock:
    """A clock that goes on when it is told to."""

    now = 0.0

    def monotonic(self) -> float:
        return self.now


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made = Clock()
    monkeypatch.setattr(deadline, "time", made)
    return made


def test_two_of_the_longest_steps_have_to_fit_in(clock: Clock) -> None:
    end = Deadline(100.0)
    for now, saving, near in ((3.0, 0.0, False), (13.0, 0.0, False), (79.9, 0.0, False), (80.0, 0.0, True)):
        clock.now = now
        if now == 79.9:  # after many short steps
            end.last, end.longest = 79.8, 10.0
        assert end.is_near(saving) == near, now
    clock.now, end.last = 70.0, 69.0
    assert end.is_near(saving=5.1)


@pytest.mark.parametrize(
    ("text", "seconds"),
    [
        ("30:00", 1800),
        ("90:05", 5405),
        ("1:30:00", 5400),
        ("120:00:01", 432001),
        ("1-02:03:04", 93784),
        (" 0:01 ", 1),
    ],
)
def test_times_are_read_as_schedulers_write_them(text: str, seconds: float) -> None:
    """Two numbers are minutes and seconds to Slurm's --time, three hours, minutes and seconds."""
    assert seconds_of(text) == seconds


@pytest.mark.parametrize(
    "text", ["12:60:00", "11:60", "1:5", "1-30:00", "90", "1-2", "-1:00:00", "01:00:00.5", "1::00", ""]
)
def test_other_times_are_refused(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(ValueError, match="is no time such as 11:30:00"):
        seconds_of(text)
    assert main(["run", "pendulum", f"--time-limit={text}"]) == 2
    assert "--time-limit" in capsys.readouterr().err


@pytest.mark.parametrize("limit", [0.0, -1.0, float("nan")])
def test_no_time_is_refused(limit: float, tmp_path: Path) -> None:
    with pytest.raises(vv.InputError, match="time_limit"):
        run(pendulum.study(), tmp_path / "run", time_limit=limit)
    assert not (tmp_path / "run").exists()


def test_a_run_stops_in_time_and_goes_on_to_the_bit(clock: Clock, tmp_path: Path) -> None:
    """Steps of ten seconds and half a minute: it stops after the first, and each resumed run after another."""
    write_row = Recorder.write_row

    def slow(recorder: Recorder, row: Any) -> None:
        clock.now += 10.0
        write_row(recorder, row)

    def study() -> vv.Study:
        return pendulum.study(until=0.03, step=0.01)

    whole = run(study(), tmp_path / "whole", pictures=False)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Recorder, "write_row", slow)
        for k in (1, 2):
            limited: dict[str, Any] = {"time_limit": 25.0 + 10.0 * (k == 1), "resume": k > 1}
            with pytest.raises(TimeLimit, match=rf"nearly over at t = 0.0{k}; .*resumed from t = 0.0{k}"):
                run(study(), tmp_path / "split", pictures=False, **limited)
        split = run(study(), tmp_path / "split", pictures=False, resume=True, time_limit=100.0)
    np.testing.assert_array_equal(split.system.x, whole.system.x)
    np.testing.assert_array_equal(split.ledger.table, whole.ledger.table)


def test_the_command_line_ends_with_a_code_of_its_own(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The time counts from the start of the process, which is long ago: a step is taken all the same."""
    out = str(tmp_path / "run")
    time.sleep(0.01)
    assert main(["run", "pendulum", "--out", out, "--no-pictures", "--time-limit", "00:00:00"]) == 75
    assert "continue with --resume" in capsys.readouterr().err
    options = ["--out", out, "--no-pictures", "--until", "0.1", "--resume", "--time-limit", "1-00:00:00"]
    assert main(["run", "pendulum", *options]) == 0
