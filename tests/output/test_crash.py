"""What a killed process leaves is complete: trajectory, table, restart state."""

import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from output.scenes import SCENE, moved, read_by_vtk
from visviva.output import Trajectory, TrajectoryWriter, load_state, read_table

KILLED_WRITER = """
import sys, numpy as np
from visviva.output import Record, Surface, Table, TrajectoryWriter, save_state, vtkhdf
vtkhdf.ROOM_AT_FIRST = 0  # moves the file as often as possible
points = np.random.default_rng(0).normal(size=(40, 3))
surface = Surface("body", points, [[0, 1, 2], [3, 4, 5]])
writer = TrajectoryWriter(sys.argv[1] + "/t.vtkhdf", [surface])
table = Table(sys.argv[1] + "/l.csv", ["time", "energy", "third"])
step = 0
while True:
    writer.append(step / 64, [points + step])
    table.append([step / 64, step / 7, 1 / 3])
    if step % 10 == 0:
        save_state(sys.argv[1] + "/state.h5", [Record("q", 1, {"q": np.full(1000, step / 7)}, {"time": step / 64})])
    print(step, flush=True)
    step += 1
"""


@pytest.mark.parametrize("round_", range(4))
def test_killed_writer_leaves_every_completed_step(tmp_path, round_):
    wait = np.random.default_rng(round_).uniform(0.02, 0.5)
    with subprocess.Popen(
        [sys.executable, "-c", KILLED_WRITER, str(tmp_path)], stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "0\n"
        time.sleep(wait)
        process.send_signal(signal.SIGKILL)
        printed = process.stdout.read().split("\n")
    done = int(printed[-2]) + 1 if len(printed) > 1 else 1
    points = np.random.default_rng(0).normal(size=(40, 3))
    with Trajectory(tmp_path / "t.vtkhdf") as motion:
        assert len(motion.times) in (done, done + 1)
        assert motion.times.tolist() == [k / 64 for k in range(len(motion.times))]
        for k in {0, 15, 16, done // 2, done - 1} & set(range(done)):
            np.testing.assert_array_equal(motion.points(k)[0], points + k)
    columns = read_table(tmp_path / "l.csv")
    assert len(columns["time"]) in (done, done + 1)
    assert columns["energy"].tolist() == [k / 7 for k in range(len(columns["energy"]))]
    record = load_state(tmp_path / "state.h5")["q"]
    arrays, attributes = record.arrays, record.values
    assert (arrays["q"] == attributes["time"] * 64 / 7).all()
    if round_ == 0:
        _, grids = read_by_vtk(tmp_path / "t.vtkhdf")
        np.testing.assert_array_equal(grids[-1].points, points + (len(grids) - 1))
    with TrajectoryWriter.reopen(tmp_path / "t.vtkhdf", keep_until=attributes["time"]) as resumed:
        assert resumed.n_steps == attributes["time"] * 64 + 1


def test_every_write_may_be_the_last(tmp_path, monkeypatch):
    """Stops the process in thought after each single write to the disk and reads what is there."""
    path, n_seen = tmp_path / "t.vtkhdf", []
    monkeypatch.setattr("visviva.output.vtkhdf.ROOM_AT_FIRST", 0)
    n_done = 0
    real = os.pwrite

    def checked(descriptor, data, offset):
        written = real(descriptor, data, offset)
        if path.exists():
            with Trajectory(path) as motion:
                n_seen.append((n_done, len(motion.times)))
                np.testing.assert_array_equal(
                    motion.points(len(motion.times) - 1)[1], moved(motion.times[-1])[1]
                )
        return written

    monkeypatch.setattr(os, "pwrite", checked)
    with TrajectoryWriter(path, SCENE) as writer:
        for k in range(20):
            writer.append(0.1 * k, moved(0.1 * k))
            n_done += 1
    assert len(n_seen) > 60
    assert all(seen in (done, done + 1) for done, seen in n_seen)
