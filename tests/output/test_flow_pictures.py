"""Pictures of flow: streamlines where a fluid moves, plain colours of what swims in it."""

import numpy as np
import pytest
from immersed_parts import carried

import visviva as vv
from output.scenes import drawers, read_image
from visviva.output import Trajectory, stage
from visviva.output.coloring import Coloring
from visviva.output.picture import snapshot
from visviva.output.streamlines import StreamFunction


@pytest.fixture(scope="module")
def swirl(tmp_path_factory):
    """A soft block in a vortex: surfaces of the fluid and of the block."""
    path = tmp_path_factory.mktemp("swirl") / "t.vtkhdf"
    vv.simulate(vv.System(carried("quad4", 12)), until=0.1, step=0.05).write(path, fields=("velocity",))
    return path


def test_only_the_fluid_streams(swirl):
    with Trajectory(swirl) as motion:
        coloring = Coloring.of(motion, "velocity")
        assert list(coloring.streams(motion, 0.1)) == [0]
        assert [part is None for part in coloring.values(motion, 0.1)] == [False, True]
        assert Coloring.of(motion, "displacement").streams(motion, 0.1) == {}


@pytest.mark.parametrize("with_pyvista", drawers())
def test_streamlines_are_white_lines_on_the_colours(swirl, tmp_path, monkeypatch, with_pyvista):
    monkeypatch.setattr(stage, "can_render", lambda: with_pyvista)
    white = {}
    for field in ("velocity", "displacement"):
        snapshot(swirl, tmp_path / "p.png", field=field, size=(480, 360), colors=("#202020", "#101010"))
        inside = read_image(tmp_path / "p.png")[120:240, 150:270]
        white[field] = float((inside.min(axis=2) > 0.75).mean())
    assert white["displacement"] == 0.0
    assert (white["velocity"] > 0.002) == with_pyvista


def test_stream_function_of_a_vortex() -> None:
    """Against the closed form, to second order in the cells; constant along the walls of a closed box."""

    def error(n: int) -> float:
        mesh = vv.RectangleMesh(size=(1, 1), counts=(n, n), cell="tri3").build()
        x, y = np.pi * mesh.points.T
        exact = np.sin(x) ** 2 * np.sin(y) ** 2 / np.pi
        velocities = np.stack([np.sin(x) ** 2 * np.sin(2 * y), -np.sin(2 * x) * np.sin(y) ** 2], axis=1)
        psi = StreamFunction(mesh.points, mesh.cells["tri3"])(velocities)
        return float(np.abs(psi - psi[0] - exact).max())

    assert error(16) < 0.05 / np.pi
    assert error(32) < 0.3 * error(16)
