"""The trajectory file: exact for VTK's own reader at any time, growing, resumed, refused."""

import numpy as np
import pytest

from output.scenes import ROPE, SCENE, moved, read_by_vtk, write
from visviva.base.errors import InputError
from visviva.output import Surface, Trajectory, TrajectoryWriter, save_state


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
    save_state(tmp_path / "state.h5", [])
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
