"""Movies and the viewer."""

import sys

import numpy as np
import pytest

from output.scenes import drawers, write
from visviva.base.errors import InputError
from visviva.output import Trajectory, stage
from visviva.output.labels import Labels
from visviva.output.movie import movie
from visviva.output.viewer import show


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


@pytest.mark.parametrize(("clock", "frames"), [("time", 51), ("state", 6)])
def test_paths_are_shown_by_ten_states_a_second(tmp_path, monkeypatch, clock, frames):
    pytest.importorskip("PIL.Image")
    monkeypatch.setattr(stage, "can_render", lambda: False)
    write(tmp_path / "t.vtkhdf", np.arange(6.0), labels=Labels(clock=clock))
    seen = []
    movie(
        tmp_path / "t.vtkhdf",
        tmp_path / "m.gif",
        fps=10,
        size=(64, 48),
        progress=lambda done, total: seen.append(total),
    )
    assert seen == [frames] * frames


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


def test_viewer_needs_opengl(tmp_path, monkeypatch):
    """VTK ended the process with a fault of memory where there was a screen and no libEGL."""
    pytest.importorskip("pyvista")
    write(tmp_path / "t.vtkhdf", [0.0])
    monkeypatch.setenv("DISPLAY", ":77")
    monkeypatch.setattr(stage, "can_render", lambda: False)
    with pytest.raises(InputError, match=r"libegl1.*visviva view without --window"):
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
