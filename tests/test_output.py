"""The output layer: files that survive kills and full disks, plots, pictures, movies."""

import errno
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from visviva.errors import InputError, RunError
from visviva.output import (
    RunDirectory,
    Surface,
    Table,
    Trajectory,
    TrajectoryWriter,
    files,
    load_state,
    read_table,
    save_state,
    stage,
)
from visviva.output.movie import movie
from visviva.output.picture import picture, snapshot
from visviva.output.plot import energy_plot
from visviva.output.viewer import show

BOX = Surface(
    "box ä",
    [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)],
    [[[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6]], [[0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]],
)
ROPE = Surface("rope", [[0, 0, 0], [0, 0, -2], [1, 0, -3]], [[0, 1], [1, 2]])
MARK = Surface("mark", [[0, 0, 1]], [[0]])
PENTAGON = Surface(
    "pentagon", [[np.cos(a), np.sin(a), 3] for a in 0.4 * np.pi * np.arange(5)], [[0, 1, 2, 3, 4]]
)
SCENE = (BOX, ROPE, MARK, PENTAGON)


def moved(t):
    """Current points of the scene at time t: turned, stretched and shifted."""
    c, s = np.cos(t), np.sin(t)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1 + 0.1 * t]])
    return [surface.points @ turn.T + [t / 3, 0, 0] for surface in SCENE]


def write(path, times, **options):
    with TrajectoryWriter(path, SCENE, **options) as writer:
        for t in times:
            writer.append(t, moved(t))


def read_by_vtk(path):
    """Times and grids of all steps, as VTK's own reader sees them."""
    pyvista = pytest.importorskip("pyvista")
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as pipeline
    from vtkmodules.vtkIOHDF import vtkHDFReader

    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(pipeline.TIME_STEPS())
    grids = []
    for step in range(reader.GetNumberOfSteps()):
        reader.SetStep(step)
        reader.Update()
        grids.append(pyvista.wrap(reader.GetOutputDataObject(0)).copy())
    return times, grids


# ---- trajectory -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("n_steps", [1, 2, 5, 40])
@pytest.mark.parametrize("expected", [0, 40, 1000])
def test_trajectory_is_exact_for_vtk_while_open_and_after_closing(tmp_path, n_steps, expected):
    path, times = tmp_path / "t.vtkhdf", 0.1 * np.arange(n_steps)
    writer = TrajectoryWriter(path, SCENE, n_steps=expected)
    for t in times:
        points = moved(t)
        together = np.concatenate(points)
        writer.append(
            t, points, {"velocity": 2 * together, "height": together[:, 2]}, {"stress": np.arange(12) + t}
        )
    for _ in ("open", "closed"):
        seen, grids = read_by_vtk(path)
        assert len(grids) == n_steps
        assert seen is None if n_steps == 1 else list(seen) == times.tolist()
        for t, grid in zip(times, grids, strict=True):
            together = np.concatenate(moved(t))
            np.testing.assert_array_equal(grid.points, together)
            np.testing.assert_array_equal(grid["velocity"], 2 * together)
            np.testing.assert_array_equal(grid["height"], together[:, 2])
            np.testing.assert_array_equal(grid["stress"], np.arange(12) + t)
            np.testing.assert_array_equal(grid["component"], 8 * [0] + 2 * [1] + [2, 3])
            np.testing.assert_array_equal(grid.celltypes, 4 * [9] + 4 * [5] + 2 * [3] + [1, 7])
            assert list(grid.field_data["component_names"]) == ["box \\xe4", "rope", "mark", "pentagon"]
        writer.close()


def test_trajectory_reads_back(tmp_path):
    write(tmp_path / "t.vtkhdf", [0.0, 1.0, 3.0])
    with Trajectory(tmp_path / "t.vtkhdf") as motion:
        assert motion.times.tolist() == [0.0, 1.0, 3.0]
        for ours, theirs in zip(SCENE, motion.surfaces, strict=True):
            assert ours.name == theirs.name
            np.testing.assert_array_equal(ours.points, theirs.points)
            for block, other in zip(ours.cells, theirs.cells, strict=True):
                np.testing.assert_array_equal(block, other)
        for now, then in zip(motion.points(2), moved(3.0), strict=True):
            np.testing.assert_array_equal(now, then)
        between = motion.points_at(2.5)
        np.testing.assert_allclose(between[1], 0.25 * moved(1.0)[1] + 0.75 * moved(3.0)[1], rtol=1e-15)
        np.testing.assert_array_equal(motion.points_at(9.0)[0], moved(3.0)[0])
        assert motion.centres(["rope"])[1].shape == (3, 3)


def test_trajectory_grows_without_losing_steps(tmp_path, monkeypatch):
    monkeypatch.setattr("visviva.output.vtkhdf.ROOM_AT_FIRST", 0)
    times = 0.01 * np.arange(150)
    write(tmp_path / "t.vtkhdf", times)
    with Trajectory(tmp_path / "t.vtkhdf") as motion:
        assert motion.times.tolist() == times.tolist()
        for k in (0, 15, 16, 17, 149):
            np.testing.assert_array_equal(np.concatenate(motion.points(k)), np.concatenate(moved(times[k])))


def test_closed_trajectory_keeps_no_reserved_room(tmp_path):
    path = tmp_path / "t.vtkhdf"
    writer = TrajectoryWriter(path, SCENE, n_steps=10**6)
    writer.append(0.0, moved(0.0))
    assert path.stat().st_size > 10**8
    writer.close()
    assert path.stat().st_size < 30_000


@pytest.mark.parametrize("closed", [True, False])
def test_trajectory_resumes_from_a_time(tmp_path, closed):
    path, times = tmp_path / "t.vtkhdf", 0.1 * np.arange(30)
    writer = TrajectoryWriter(path, SCENE)
    for t in times[:20]:
        writer.append(t, moved(t))
    if closed:
        writer.close()
    with TrajectoryWriter.reopen(path, keep_until=times[11]) as resumed:
        assert resumed.n_steps == 12
        with pytest.raises(InputError, match="does not follow"):
            resumed.append(times[11], moved(0.0))
        for t in times[12:]:
            resumed.append(t, moved(t))
    with Trajectory(path) as motion:
        assert motion.times.tolist() == times.tolist()
    assert len(read_by_vtk(path)[1]) == 30


KILLED_WRITER = """
import sys, numpy as np
from visviva.output import Surface, Table, TrajectoryWriter, save_state, vtkhdf
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
        save_state(sys.argv[1] + "/state.h5", {"q": np.full(1000, step / 7)}, {"time": step / 64})
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
    arrays, attributes = load_state(tmp_path / "state.h5")
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


def test_trajectory_refuses_what_does_not_fit(tmp_path):
    path = tmp_path / "t.vtkhdf"
    with pytest.raises(InputError, match="different names"):
        TrajectoryWriter(path, [ROPE, ROPE])
    with TrajectoryWriter(path, [ROPE]) as writer:
        with pytest.raises(InputError, match="shapes of the surfaces"):
            writer.append(0.0, [np.zeros((2, 3))])
        with pytest.raises(InputError, match="needs 3 rows"):
            writer.append(0.0, [ROPE.points], {"v": np.zeros((5, 3))})
        writer.append(0.0, [ROPE.points], {"v": np.zeros((3, 3))})
        with pytest.raises(InputError, match="the first step held"):
            writer.append(0.1, [ROPE.points])
        with pytest.raises(InputError, match="does not follow"):
            writer.append(float("nan"), [ROPE.points], {"v": np.zeros((3, 3))})
    with pytest.raises(InputError, match="cannot be read"):
        Trajectory(tmp_path / "missing.vtkhdf")
    save_state(tmp_path / "state.h5", {}, {})
    with pytest.raises(InputError, match="no trajectory"):
        Trajectory(tmp_path / "state.h5")


@pytest.mark.parametrize(
    ("points", "cells", "message"),
    [
        ([[0, 0]], [[0]], "shape"),
        ([[0, 0, np.nan]], [[0]], "finite"),
        ([[0, 0, 0]], [[1]], "outside"),
        ([[0, 0, 0]], [[-1]], "outside"),
        ([[0, 0, 0]], [[0.5]], "integers"),
        ([[0, 0, 0]], [[[0]], [0]], "integers"),
    ],
)
def test_surface_refuses(points, cells, message):
    with pytest.raises(InputError, match=message):
        Surface("s", points, cells)


# ---- tables -----------------------------------------------------------------------------------------------


@settings(max_examples=50, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(rows=st.lists(st.lists(st.floats(), min_size=3, max_size=3), max_size=8))
def test_table_keeps_every_bit(tmp_path, rows):
    with Table(tmp_path / "a.csv", ["time", "b", "c"]) as table:
        for row in rows:
            table.append(row)
    columns = read_table(tmp_path / "a.csv")
    assert list(columns) == ["time", "b", "c"]
    found = np.column_stack(list(columns.values()))
    expected = np.array(rows, dtype=float).reshape(-1, 3)
    np.testing.assert_array_equal(found, expected)
    np.testing.assert_array_equal(np.signbit(found[~np.isnan(found)]), np.signbit(expected[~np.isnan(found)]))


def test_table_resumes_and_drops_a_torn_line(tmp_path):
    path = tmp_path / "a.csv"
    table = Table(path, ["time", "x"])
    for k in range(10):
        table.append([k / 10, k])
    with path.open("ab") as file:
        file.write(b"1.0,0.33")
    assert read_table(path)["x"].tolist() == list(range(10))
    with Table.reopen(path, ["time", "x"], keep_until=0.6) as resumed:
        resumed.append(np.array([0.7, -1.0]))
    assert read_table(path)["x"].tolist() == [0, 1, 2, 3, 4, 5, 6, -1]
    with Table.reopen(path, ["time", "x"], keep_until=-1.0):
        assert read_table(path)["x"].tolist() == []
    with pytest.raises(InputError, match="other columns"):
        Table.reopen(path, ["time", "y"], keep_until=1.0)


def test_table_refuses(tmp_path):
    for columns in ([], ["x"], ["time", "a,b"], ["time", "time"], ["time", ""]):
        with pytest.raises(InputError):
            Table(tmp_path / "a.csv", columns)
    with Table(tmp_path / "a.csv", ["time", "x"]) as table, pytest.raises(InputError, match="3 values for 2"):
        table.append([0.0, 1.0, 2.0])
    with pytest.raises(InputError, match="cannot be read"):
        read_table(tmp_path / "missing.csv")
    (tmp_path / "b.csv").write_text("time,x\n0,hello\n")
    with pytest.raises(InputError, match="not a table"):
        read_table(tmp_path / "b.csv")


# ---- restart state ----------------------------------------------------------------------------------------


def test_state_is_bit_faithful(tmp_path):
    rng = np.random.default_rng(3)
    arrays = {
        "q": rng.integers(0, 2**63, 1000).view(np.float64),  # any bit pattern, also NaNs with payload
        "history/lambda": rng.normal(size=(3, 4, 5)),
        "count": np.array(7, dtype=np.int32),
        "flags": np.array([True, False]),
        "empty": np.zeros((0, 3)),
    }
    attributes = {"time": 0.1 + 0.2, "step": 2**53 + 1, "scheme": "EnergyMomentum(h=0.01) ä", "done": True}
    save_state(tmp_path / "s.h5", arrays, attributes)
    found, found_attributes = load_state(tmp_path / "s.h5")
    assert found.keys() == arrays.keys()
    for name, array in arrays.items():
        assert found[name].dtype == array.dtype
        assert found[name].shape == array.shape
        assert found[name].tobytes() == array.tobytes()
    assert found_attributes == attributes


def test_state_of_others_is_refused(tmp_path):
    import h5py

    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["x"] = 1
    with pytest.raises(InputError, match="was not written by visviva"):
        load_state(tmp_path / "other.h5")
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file.attrs["format"] = "visviva state 99"
    with pytest.raises(InputError, match=r"visviva state 99.*visviva state 1"):
        load_state(tmp_path / "other.h5")
    (tmp_path / "text.h5").write_text("hello")
    for name in ("text.h5", "missing.h5"):
        with pytest.raises(InputError, match="not a readable state"):
            load_state(tmp_path / name)


def test_failed_save_keeps_the_older_state(tmp_path, monkeypatch):
    path = tmp_path / "s.h5"
    save_state(path, {"q": np.ones(3)}, {"time": 1.0})
    monkeypatch.setattr(os, "fsync", full_disk)
    with pytest.raises(RunError, match="No space left"):
        save_state(path, {"q": np.zeros(3)}, {"time": 2.0})
    assert load_state(path)[1] == {"time": 1.0}
    assert [file.name for file in tmp_path.iterdir()] == ["s.h5"]


# ---- full disk --------------------------------------------------------------------------------------------


def full_disk(*_):
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def disk_with_room_for(n_bytes, monkeypatch):
    """From now on `n_bytes` can be written, the last write only in part, as a real disk does it."""
    room, real = n_bytes, os.pwrite

    def limited(descriptor, data, offset):
        nonlocal room
        fitting = memoryview(data)[:room]
        if not len(fitting):
            full_disk()
        room -= len(fitting)
        return real(descriptor, fitting, offset)

    monkeypatch.setattr(os, "pwrite", limited)


def test_trajectory_on_a_full_disk_keeps_its_steps(tmp_path, monkeypatch):
    path = tmp_path / "t.vtkhdf"
    writer = TrajectoryWriter(path, SCENE)
    for k in range(3):
        writer.append(k / 2, moved(k / 2))
    disk_with_room_for(1000, monkeypatch)
    with pytest.raises(RunError, match=r"t\.vtkhdf: No space left on device; the run up to t = 1\.5 is kept"):
        [writer.append(k / 2, moved(k / 2)) for k in range(3, 100)]
    writer.close()
    with Trajectory(path) as motion:
        assert motion.times.tolist() == [0.0, 0.5, 1.0, 1.5]


def test_table_on_a_full_disk_keeps_its_rows(tmp_path, monkeypatch):
    table = Table(tmp_path / "l.csv", ["time", "x"])
    table.append([0.25, 1 / 3])
    disk_with_room_for(30, monkeypatch)
    with pytest.raises(RunError, match=r"l\.csv: No space left on device; the run up to t = 0\.5 is kept"):
        [table.append([k / 4, 1 / 3]) for k in range(2, 9)]
    assert (tmp_path / "l.csv").read_text() == "time,x\n0.25,0.3333333333333333\n0.5,0.3333333333333333\n"


@pytest.fixture
def small_disk(tmp_path):
    """A file system of 300 kB, where one may be mounted."""
    place = tmp_path / "small"
    place.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", "size=300k", "none", str(place)]
    try:
        mounted = subprocess.run(command, capture_output=True, check=False).returncode == 0
    except OSError:
        mounted = False
    if not mounted:
        pytest.skip("no permission to mount a small file system")
    yield place
    subprocess.run(["umount", "-l", str(place)], check=True)


def test_real_full_disk(small_disk):
    writer = TrajectoryWriter(small_disk / "t.vtkhdf", SCENE)
    table = Table(small_disk / "l.csv", ["time", "x"])
    save_state(small_disk / "s.h5", {"q": np.arange(1000.0)}, {"time": 0.0})
    step = 0

    def run_on():
        nonlocal step
        while True:
            writer.append(float(step), moved(step))
            table.append([step, 1 / 3])
            step += 1

    with pytest.raises(RunError, match="No space left on device"):
        run_on()
    with pytest.raises(RunError, match="No space left on device"):
        save_state(small_disk / "s.h5", {"q": np.zeros(50_000)}, {"time": 1.0})
    with pytest.raises(RunError, match="No space left on device"):
        TrajectoryWriter(small_disk / "new.vtkhdf", [Surface("big", np.zeros((20_000, 3)), [[0]])]).append(
            0.0, [np.zeros((20_000, 3))]
        )
    writer.close()
    with Trajectory(small_disk / "t.vtkhdf") as motion:
        assert len(motion.times) in (step, step + 1)
    assert len(read_table(small_disk / "l.csv")["time"]) == step
    assert load_state(small_disk / "s.h5")[1] == {"time": 0.0}
    assert not list(small_disk.glob(".*"))


# ---- run directory ----------------------------------------------------------------------------------------


def test_run_directory(tmp_path):
    run = RunDirectory.create(tmp_path / "deep" / "crane")
    assert run.trajectory == tmp_path / "deep" / "crane" / "trajectory.vtkhdf"
    assert [file.name for file in run.files] == [
        "trajectory.vtkhdf",
        "ledger.csv",
        "probes.csv",
        "summary.json",
        "state.h5",
        "energy.png",
        "picture.png",
        "movie.mp4",
    ]
    RunDirectory.create(run.path)  # still empty
    with pytest.raises(InputError, match="holds no run"):
        RunDirectory.open(run.path)
    (run.path / "notes.txt").write_text("mine")
    save_state(run.state, {}, {})
    assert RunDirectory.open(run.path) == run
    with pytest.raises(InputError, match=r"already holds a run \(state.h5\)"):
        RunDirectory.create(run.path)
    RunDirectory.create(run.path, overwrite=True)
    assert [file.name for file in run.path.iterdir()] == ["notes.txt"]


def test_run_directory_must_be_writable(tmp_path):
    (tmp_path / "file").write_text("")
    for path in (tmp_path / "file", tmp_path / "file" / "below", Path("/proc/visviva")):
        with pytest.raises(InputError, match="cannot be written"):
            RunDirectory.create(path)
    if os.geteuid():
        (tmp_path / "locked").mkdir(mode=0o555)
        with pytest.raises(InputError, match="cannot be written"):
            RunDirectory.create(tmp_path / "locked")


def test_summary_takes_numpy_and_is_strict_json(tmp_path):
    run = RunDirectory.create(tmp_path)
    run.write_summary(
        {
            "steps": np.int64(200),
            "error": np.float64(1 / 3),
            "momentum": np.array([1.0, np.nan]),
            "ok": np.bool_(True),
            "path": tmp_path,
            "nested": {1: (np.float32(0.5), None)},
        }
    )
    text = run.summary.read_text()
    assert json.loads(text, parse_constant=pytest.fail) == {
        "steps": 200,
        "error": 1 / 3,
        "momentum": [1.0, None],
        "ok": True,
        "path": str(tmp_path),
        "nested": {"1": [0.5, None]},
    }
    assert run.read_summary()["steps"] == 200


# ---- plots, pictures, movies ------------------------------------------------------------------------------


def read_image(path):
    from matplotlib.image import imread

    return imread(path)[..., :3]


def test_energy_plot_leaves_matplotlib_alone(tmp_path):
    import matplotlib as mpl

    with mpl.rc_context({"font.size": 33}):
        mpl.use("svg")
        t = np.linspace(0, 1, 50)
        ledger = {
            "time": t,
            "kinetic": t,
            "potential_gravity": -t,
            "total": 0 * t,
            "imbalance": 1e-15 * t,
        }
        probes = {"time": t, "angle": t, "other": -t}
        energy_plot(ledger, tmp_path / "a.png", probes=probes, units={"angle": "rad"}, title="crane")
        assert mpl.get_backend() == "svg"
        assert mpl.rcParams["font.size"] == 33
    energy_plot(ledger | {"imbalance": 0 * t}, tmp_path / "b.png")
    tall, short = read_image(tmp_path / "a.png"), read_image(tmp_path / "b.png")
    assert tall.shape[1] == short.shape[1] == 1700
    assert tall.shape[0] > short.shape[0] + 400  # two panels more
    assert 0.02 < (tall < 0.9).any(axis=2).mean() < 0.3  # lines on a white ground
    with pytest.raises(InputError, match="'heat'"):
        energy_plot(ledger, tmp_path / "c.png", energies=["heat"])


def test_energy_plot_reads_a_ledger_file(tmp_path):
    with Table(tmp_path / "l.csv", ["time", "kinetic", "total", "imbalance"]) as table:
        table.append([0.0, 1.0, 1.0, 0.0])
        table.append([0.1, 2.0, 1.0, float("nan")])
    energy_plot(tmp_path / "l.csv", tmp_path / "e.png")
    assert read_image(tmp_path / "e.png").shape[2] == 3


def drawers():
    return [True, False] if stage.can_render() else [False]


@pytest.mark.parametrize("with_pyvista", drawers())
def test_picture_shows_each_surface_and_follows_the_motion(tmp_path, monkeypatch, with_pyvista):
    monkeypatch.setattr(stage, "can_render", lambda: with_pyvista)
    path = tmp_path / "t.vtkhdf"
    write(path, [0.0, 1.0, 2.0])
    colors = ("#d02020", "#20a020", "#2020d0", "#d0a000")
    images = []
    for name, moment in (("a", 0.0), ("b", 2.0)):
        snapshot(path, tmp_path / f"{name}.png", time=moment, colors=colors, size=(320, 240), trails=["mark"])
        images.append(read_image(tmp_path / f"{name}.png"))
    first, second = images
    assert first.shape == (240, 320, 3)
    assert np.abs(first - second).max() > 0.3
    for color in colors:  # pixels of that hue, bright or in the shade
        hue = np.array([int(color[k : k + 2], 16) for k in (1, 3, 5)]) / 255
        strong = first.max(axis=2) - first.min(axis=2) > 0.25
        cosine = (first - first.min(axis=2, keepdims=True)) @ (hue - hue.min())
        cosine /= (
            np.linalg.norm(first - first.min(axis=2, keepdims=True), axis=2) * np.linalg.norm(hue - hue.min())
            + 1e-9
        )
        assert (strong & (cosine > 0.98)).sum() > 5, color
    with pytest.raises(InputError, match="no surface is called 'load'"):
        snapshot(path, tmp_path / "c.png", trails=["load"])


@pytest.mark.skipif(not stage.can_render(), reason="no OpenGL here")
def test_shading_turns_with_the_body(tmp_path):
    """A cube turned by a right angle looks as before, light included."""
    cube = Surface(
        "cube",
        np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]),
        [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]],
    )
    turn = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    picture([cube], tmp_path / "a.png", size=(200, 200))
    picture([cube], tmp_path / "b.png", points=[cube.points @ turn.T], size=(200, 200))
    difference = np.abs(read_image(tmp_path / "a.png") - read_image(tmp_path / "b.png")).max(axis=2)
    assert (difference > 0.02).mean() < 0.005  # but for pixels on the edges


def test_camera_sees_every_point():
    rng = np.random.default_rng(5)
    for scale in ([1, 1, 1], [20, 1, 1], [1, 1, 30], [1, 1e-9, 1]):
        cloud = rng.normal(size=(200, 3)) * scale + [100, 0, 0]
        scene = stage.Scene((MARK,), cloud, size=(1280, 720))
        eye, target, up = (np.array(vector) for vector in scene.fitted_camera(30.0))
        back = (eye - target) / np.linalg.norm(eye - target)
        right = np.cross(up, back) / np.linalg.norm(np.cross(up, back))
        seen = cloud - eye
        depth = -seen @ back
        assert depth.min() > 0
        half = np.tan(np.radians(15))
        sideways = np.abs(seen @ right) / depth / (half * 1280 / 720)
        upwards = np.abs(seen @ np.cross(back, right)) / depth / half
        assert max(sideways.max(), upwards.max()) < 1
        assert max(sideways.max(), upwards.max()) > 0.7  # and does not stand too far away


@pytest.mark.parametrize("with_pyvista", drawers())
def test_movie_has_the_right_frames(tmp_path, monkeypatch, with_pyvista):
    pillow = pytest.importorskip("PIL.Image")
    monkeypatch.setattr(stage, "can_render", lambda: with_pyvista)
    write(tmp_path / "t.vtkhdf", 0.1 * np.arange(11))
    seen = []
    movie(
        tmp_path / "t.vtkhdf",
        tmp_path / "m.gif",
        fps=10,
        speed=2.0,
        size=(160, 96),
        trails=["mark"],
        progress=lambda done, total: seen.append((done, total)),
    )
    assert seen == [(k, 6) for k in range(1, 7)]
    with pillow.open(tmp_path / "m.gif") as gif:
        assert (gif.n_frames, gif.size) == (6, (160, 96))


def test_mp4_movie(tmp_path, monkeypatch):
    ffmpeg = pytest.importorskip("imageio_ffmpeg")
    monkeypatch.setattr(stage, "can_render", lambda: False)
    write(tmp_path / "t.vtkhdf", [0.0, 1.0])
    movie(tmp_path / "t.vtkhdf", tmp_path / "m.mp4", fps=5, size=(160, 96))
    n_frames, seconds = ffmpeg.count_frames_and_secs(str(tmp_path / "m.mp4"))
    assert (n_frames, seconds) == (6, pytest.approx(1.2, abs=0.01))
    facts = next(ffmpeg.read_frames(str(tmp_path / "m.mp4")))
    assert (facts["size"], facts["codec"]) == ((160, 96), "h264")
    assert sorted(file.name for file in tmp_path.iterdir()) == ["m.mp4", "t.vtkhdf"]


def test_movie_refuses(tmp_path, monkeypatch):
    monkeypatch.setattr(stage, "can_render", lambda: False)
    write(tmp_path / "t.vtkhdf", [0.0, 1.0])
    for options in ({"fps": 0}, {"speed": -1.0}, {"size": (161, 96)}):
        with pytest.raises(InputError, match="a movie needs"):
            movie(tmp_path / "t.vtkhdf", tmp_path / "m.gif", **options)
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(InputError, match=r"pip install 'visviva\[view\]'"):
        movie(tmp_path / "t.vtkhdf", tmp_path / "m.mp4", size=(160, 96))


def test_viewer_needs_a_screen(tmp_path, monkeypatch):
    write(tmp_path / "t.vtkhdf", [0.0])
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    if sys.platform == "linux":
        with pytest.raises(InputError, match="no screen"):
            show(tmp_path / "t.vtkhdf")


@pytest.mark.skipif(not stage.can_render(), reason="no OpenGL here")
def test_viewer_follows_its_slider(tmp_path):
    from visviva.output.viewer import build_viewer

    write(tmp_path / "t.vtkhdf", [0.0, 1.0, 2.0])
    with Trajectory(tmp_path / "t.vtkhdf") as motion:
        plotter = build_viewer(motion, ["mark"], (), off_screen=True)
        plotter.render()
        before = np.array(plotter.screenshot(return_img=True))
        slider = plotter.iren.interactor and plotter.widgets.slider_widgets[0]
        slider.GetRepresentation().SetValue(2.0)
        slider.InvokeEvent("InteractionEvent")
        plotter.render()
        after = np.array(plotter.screenshot(return_img=True))
        plotter.close()
    scene_part = np.s_[100:600]
    assert np.abs(before[scene_part].astype(int) - after[scene_part]).max() > 80


def test_probe_of_rendering_survives_a_crash(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(stage, "PROBE", "import os; os.abort()")
    assert not stage.can_render.__wrapped__()
    assert not (tmp_path / "visviva").exists()
    monkeypatch.setattr(stage, "PROBE", "pass")
    assert stage.can_render.__wrapped__()
    monkeypatch.setattr(stage, "PROBE", "import os; os.abort()")
    assert stage.can_render.__wrapped__()  # remembered


def test_importing_output_is_cheap():
    code = (
        "import sys, numpy; from visviva import errors; import time; start = time.process_time();"
        "import visviva.output; took = time.process_time() - start;"
        "heavy = {'h5py', 'matplotlib', 'pyvista', 'imageio_ffmpeg', 'PIL'} & set(sys.modules);"
        "print(took, heavy)"
    )
    runs = [
        subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        for _ in range(3)
    ]
    assert all(run.stdout.split(maxsplit=1)[1].strip() == "set()" for run in runs)
    assert min(float(run.stdout.split()[0]) for run in runs) < 0.03  # the others had to share the machine


def test_replacing_is_all_or_nothing(tmp_path):
    target = tmp_path / "file"
    target.write_text("old")

    def fail_on_the_way():
        with files.replacing(target) as temporary:
            temporary.write_text("ha")
            assert target.read_text() == "old"
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail_on_the_way()
    assert target.read_text() == "old"
    assert os.listdir(tmp_path) == ["file"]
