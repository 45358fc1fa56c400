"""Plots and pictures."""

import numpy as np
import pytest

from output.scenes import MARK, drawers, read_image, write
from visviva.base.errors import InputError
from visviva.output import Surface, Table, stage
from visviva.output.labels import Labels
from visviva.output.picture import picture, snapshot
from visviva.output.plot import energy_plot, probes_plot
from visviva.output.view import Scene


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
        energy_plot(ledger, tmp_path / "a.png", title="crane")
        probes_plot(probes, tmp_path / "p.png", labels=Labels(columns={"angle": "rad"}))
        assert mpl.get_backend() == "svg"
        assert mpl.rcParams["font.size"] == 33
    energy_plot({name: c for name, c in ledger.items() if name != "imbalance"}, tmp_path / "b.png")
    tall, short = read_image(tmp_path / "a.png"), read_image(tmp_path / "b.png")
    assert tall.shape[1] == short.shape[1] == read_image(tmp_path / "p.png").shape[1] == 1700
    assert tall.shape[0] > short.shape[0] + 300  # a panel more
    assert 0.02 < (tall < 0.9).any(axis=2).mean() < 0.3  # lines on a white ground
    with pytest.raises(InputError, match="'heat'"):
        energy_plot(ledger, tmp_path / "c.png", energies=["heat"])


def test_energy_plot_reads_a_ledger_file(tmp_path):
    with Table(tmp_path / "l.csv", ["time", "kinetic", "total", "imbalance"]) as table:
        table.append([0.0, 1.0, 1.0, 0.0])
        table.append([0.1, 2.0, 1.0, float("nan")])
    energy_plot(tmp_path / "l.csv", tmp_path / "e.png")
    assert read_image(tmp_path / "e.png").shape[2] == 3


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
    for moment in (2.1, -0.1):
        with pytest.raises(InputError, match=f"has no time {moment}; it goes from 0 to 2"):
            snapshot(path, tmp_path / "d.png", time=moment)


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
    for scale in ([1, 1, 1], [20, 1, 1], [1, 1, 30], [1, 1e-9, 1], [1, 1, 0]):
        cloud = rng.normal(size=(200, 3)) * scale + [100, 0, 0]
        scene = Scene((MARK,), cloud, size=(1280, 720))
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
