"""A motion as named blocks of VTKHDF: what VTK's own reader and PyVista find in them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import visviva as vv
from output.scenes import read_by_vtk
from visviva.cli import main
from visviva.output import Trajectory
from visviva.output.named_blocks import write_blocks

pyvista = pytest.importorskip("pyvista")


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A solid that swings, and a rigid ball of another name, whose contact begins later."""
    rubber = vv.NeoHooke(young=2e4, poisson=0.3)
    mesh = vv.BoxMesh(size=(2, 1, 1), counts=(2, 1, 1))
    bar = vv.Solid(name="bar/ä 1", mesh=mesh, material=rubber, density=10)
    ball = vv.RigidBody(
        name="ball.2", shape=vv.Sphere(0.2), density=100, position=(1, 2, 0), velocity=(1, 0, 1)
    )
    system = vv.System([bar, ball, vv.Gravity(), vv.Fixed(solid=bar, nodes="x0")], units="SI")
    folder = tmp_path_factory.mktemp("blocks") / "run"
    vv.simulate(system, until=0.2, step=0.1).write(folder)
    return folder


def test_named_blocks(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["export", str(run), "--format", "blocks"]) == 0
    assert "blocks.vtkhdf" in capsys.readouterr().out
    times, grids = read_by_vtk(run / "blocks.vtkhdf")
    assert list(times) == pytest.approx([0.0, 0.1, 0.2])
    with Trajectory(run / "trajectory.vtkhdf") as motion:
        for step, blocks in enumerate(grids):
            assert blocks.keys() == ["ball.2", "bar\N{DIVISION SLASH}ä 1"]
            for k, surface in enumerate(motion.surfaces):
                np.testing.assert_array_equal(blocks[k].points, motion.points(step)[k])
                np.testing.assert_array_equal(blocks[k]["velocity"], motion.field("velocity", step)[k])
                assert blocks[k].n_cells == sum(map(len, surface.cells))
            np.testing.assert_array_equal(blocks[1]["von_mises"], motion.field("von_mises", step)[1])
            assert "von_mises" not in blocks[0].point_data
    assert grids[0][1].volume == pytest.approx(2.0)
    assert isinstance(pyvista.read(run / "blocks.vtkhdf"), pyvista.MultiBlock)


def test_fields_that_begin_later(tmp_path: Path, run: Path) -> None:
    """Before a component has values they are not numbers."""
    from visviva.output import Surface, TrajectoryWriter

    mark = Surface("mark", [[0, 0, 0], [1, 0, 0]], [[0, 1]])
    with TrajectoryWriter(tmp_path / "t.vtkhdf", [mark]) as writer:
        for t, gap in ((0.0, [np.nan, np.nan]), (1.0, [0.5, np.nan])):
            writer.append(t, [mark.points + t], {"gap": gap})
    _, grids = read_by_vtk(write_blocks(tmp_path / "t.vtkhdf", tmp_path / "b.vtkhdf"))
    np.testing.assert_array_equal([g[0]["gap"] for g in grids], [[np.nan, np.nan], [0.5, np.nan]])


def test_the_trajectory_is_not_overwritten(run: Path) -> None:
    file = run / "trajectory.vtkhdf"
    with pytest.raises(vv.InputError, match="is the trajectory itself"):
        write_blocks(file, file)
