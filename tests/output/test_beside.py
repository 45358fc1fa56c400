"""Output beside the computation: the same files, bounded memory, errors at the next step, nothing torn by a stop."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from interrupting import after_rows, run_until

import visviva as vv
from visviva.examples import pendulum
from visviva.output import RunDirectory, Trajectory, read_table
from visviva.output.beside import Beside
from visviva.output.vtkhdf import TrajectoryWriter
from visviva.study import recorder
from visviva.study.run import run


@pytest.fixture
def beside(monkeypatch: pytest.MonkeyPatch) -> None:
    """Small runs would write at once."""
    monkeypatch.setattr(recorder, "WORTH", 0.0)


def test_who_brings_more_waits() -> None:
    gate, taken = threading.Event(), list[int]()
    worker = Beside(most=2)
    worker.do(lambda: gate.wait() and None)
    bringing = threading.Thread(target=lambda: [worker.do(lambda k=k: taken.append(k)) for k in range(9)])
    bringing.start()
    bringing.join(0.2)
    assert bringing.is_alive()
    gate.set()
    bringing.join()
    worker.wait()
    assert taken == list(range(9))
    worker.close()
    worker.close()


def test_after_a_failure_nothing_is_done_and_all_calls_say_so() -> None:
    worker, taken = Beside(), list[int]()
    worker.do(lambda: (1 / 0) and None)
    worker._waiting.join()
    with pytest.raises(ZeroDivisionError):
        worker.do(lambda: taken.append(1))
    with pytest.raises(ZeroDivisionError):
        worker.wait()
    assert not taken
    worker.close()


def study() -> vv.Study:
    return pendulum.study(until=0.3, step=0.01)


def test_files_are_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, worth in (("at_once", 1e9), ("beside", 0.0)):
        monkeypatch.setattr(recorder, "WORTH", worth)
        run(study(), tmp_path / name, pictures=False)
    for file in ("ledger.csv", "probes.csv", "states.npy", "trajectory.vtkhdf"):
        one, other = ((tmp_path / name / file).read_bytes() for name in ("at_once", "beside"))
        assert one == other, file


def test_it_is_stopped_and_goes_on_to_the_bit(beside: None, tmp_path: Path) -> None:
    whole = run(study(), tmp_path / "whole", pictures=False)
    run_until(after_rows(12), study(), tmp_path / "split", signal.SIGTERM)
    assert len(read_table(tmp_path / "split" / "ledger.csv")["time"]) == 12
    split = run(study(), tmp_path / "split", pictures=False, resume=True)
    np.testing.assert_array_equal(split.system.x, whole.system.x)
    np.testing.assert_array_equal(split.ledger.table, whole.ledger.table)
    np.testing.assert_array_equal(np.array(split.states), np.array(whole.states))


def test_a_file_that_cannot_be_written_fails_the_next_step(
    beside: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    append = TrajectoryWriter.append

    def failing(writer: TrajectoryWriter, clock: float, *values: object) -> None:
        if clock > 0.1:
            raise vv.RunError("cannot write trajectory: no room")
        append(writer, clock, *values)  # type: ignore[arg-type]

    monkeypatch.setattr(TrajectoryWriter, "append", failing)
    system = study()
    with pytest.raises(vv.RunError, match=r"no room; the run can be resumed from t = 0\.0"):
        run(system, tmp_path, pictures=False, every=1)
    assert system.system.time < 0.2  # not at the end of the run
    monkeypatch.undo()
    again = run(study(), tmp_path, pictures=False, resume=True)
    whole = run(study(), tmp_path / "whole", pictures=False, every=1)
    np.testing.assert_array_equal(again.ledger.table, whole.ledger.table)


KILLED = """
import sys
from visviva.study import recorder
from visviva.study.run import run
from visviva.examples import pendulum
recorder.WORTH = 0.0
run(pendulum.study(until=100.0, step=0.001), sys.argv[1], pictures=False, every=1, save_every=0.05)
"""


def test_a_killed_run_leaves_readable_files(tmp_path: Path) -> None:
    command = [sys.executable, "-c", KILLED, str(tmp_path)]
    process = subprocess.Popen(command, env=os.environ)
    files = RunDirectory(tmp_path)
    try:
        for _ in range(600):
            time.sleep(0.05)
            if files.ledger.exists() and files.ledger.stat().st_size > 100_000:
                break
    finally:
        process.kill()
        process.wait()
    rows = len(read_table(files.ledger)["time"])
    assert rows > 100
    with Trajectory(files.trajectory) as motion:
        assert len(motion.times) > 50
        motion.points(len(motion.times) - 1)
    until = 0.001 * (rows + 20)
    resumed = run(pendulum.study(until=until, step=0.001), tmp_path, resume=True, pictures=False)
    assert resumed.system.time == pytest.approx(until, abs=1e-9)
