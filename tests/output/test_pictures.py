"""Plots and pictures."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import visviva as vv
from output.scenes import MARK, drawers, read_image, write
from visviva.base.errors import InputError
from visviva.output import Surface, Table, stage
from visviva.output.labels import Labels
from visviva.output.picture import picture, snapshot
from visviva.output.plot import energy_plot, probes_plot
from visviva.output.trajectory import Trajectory
from visviva.output.view import Scene
from visviva.scene import read_scene, write_scene


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


def bent(**pictures: Any) -> vv.Study:
    """A beam that is bent by 3 at its end, 2 away from where it is held."""
    section = vv.TubeSection(radius=0.05, young=1e9, poisson=0.25, density=1.0)
    mesh = vv.LineMesh(points=[(0, 0, 0), (2, 0, 0)], count=4, cell="line3")
    beam = vv.Beam(name="beam", mesh=mesh, section=section)
    held = vv.Clamped(name="held", solid=beam, nodes="start")
    load = vv.Force(name="load", on=beam.point((2, 0, 0)), force=(0, 0, -3.0), times="t")
    options: dict[str, Any] = {"scheme": vv.Static(), "fields": (), "pictures": vv.Pictures(**pictures)}
    return vv.Study(vv.System([beam, held, load]), until=1.0, step=1.0, **options)


def test_a_run_stores_and_draws_what_its_pictures_show(tmp_path, monkeypatch):
    drawn = []
    monkeypatch.setattr("visviva.output.picture.snapshot", lambda *_, **given: drawn.append(given))
    study = bent(diagram="bending_1", vectors="section_force", camera="front", size=(320, 200))
    write_scene(study, tmp_path / "beam.yaml")
    again = read_scene(tmp_path / "beam.yaml")
    assert again.pictures == study.pictures
    vv.run(again, tmp_path / "run")
    assert {"diagram": "bending_1", "vectors": "section_force"}.items() <= drawn[0].items()
    assert (drawn[0]["camera"], drawn[0]["size"], drawn[0]["deform"]) == ("front", (320, 200), 1.0)
    with Trajectory(tmp_path / "run" / "trajectory.vtkhdf") as motion:
        moments = motion.field("diagram_bending_1", 1)[0]
        assert np.linalg.norm(moments, axis=1).max() == pytest.approx(3.0 * 2, rel=1e-3)  # force times arm


def test_scenes_name_moments_movies_and_pictures(tmp_path):
    (tmp_path / "drop.yaml").write_text(
        "system: {ball: {PointMass: {mass: 2.0}}}\nrun: {until: 1.0, step: 0.1}\nmoments: [0.2, 0.5]\nmovie: true\n"
        "pictures: {vectors: velocity, camera: [[9, 0, 1], [0, 0, 1], [0, 0, 1]], limits: [0, 2.5]}\n"
    )
    study = read_scene(tmp_path / "drop.yaml")
    assert (study.moments, study.movie) == ((0.2, 0.5), True)
    assert study.pictures.limits == (0, 2.5)
    write_scene(study, tmp_path / "copy.toml")
    copy = read_scene(tmp_path / "copy.toml")
    assert (copy.moments, copy.movie, copy.pictures) == (study.moments, study.movie, study.pictures)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"camera": "font"}, "camera 'font'; did you mean 'front'"),
        ({"limits": (2.0, 1.0)}, r"limits = \(2.0, 1.0\)"),
        ({"size": (321, 200)}, "size = .*even"),
        ({"size": (8, 8)}, "16 to"),
        ({"cmap": "viridi"}, "colour map 'viridi'"),
        ({"deform": "much"}, "deform"),
    ],
)
def test_pictures_that_nothing_draws_are_refused(given, message):
    with pytest.raises(InputError, match=message):
        vv.Pictures(**given)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"diagram": "bending"}, "'diagram_bending'; did you mean .diagram_bending_"),
        ({"vectors": "cauchy"}, "vectors 'cauchy' is nothing that this system has"),
        ({"field": "von_mises"}, "field 'von_mises' is nothing"),
        ({"vectors": "velocty"}, "velocty"),
    ],
)
def test_pictures_of_what_a_system_has_not_are_refused_before_the_first_step(given, message, tmp_path):
    study = bent(**given)
    with pytest.raises(InputError, match=message):
        vv.run(study, tmp_path / "run")
    assert study.system.time == 0.0


def test_runs_of_heat_hold_and_show_temperatures(tmp_path: Path) -> None:
    """Without being told: a picture of one colour tells nothing."""
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2))
    wall = vv.ThermalBody(mesh=mesh, conductivity=1.0, temperature=lambda X: 300 + 50 * X[:, 0])
    study = vv.Study(vv.System([wall]), until=0.02, step=0.01)
    assert study.stored[-1] == "temperature"
    vv.run(study, tmp_path / "wall", progress=False)
    with Trajectory(tmp_path / "wall" / "trajectory.vtkhdf") as motion:
        assert "temperature" in motion.fields
