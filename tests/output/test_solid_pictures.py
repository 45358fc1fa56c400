"""Pictures and movies of solids coloured by a field."""

import numpy as np
import pytest
from matplotlib.colors import rgb_to_hsv

import visviva as vv
from output.scenes import drawers, read_image
from visviva.output import Trajectory, stage
from visviva.output.coloring import Coloring
from visviva.output.movie import movie
from visviva.output.picture import snapshot


@pytest.fixture(scope="module")
def bent(tmp_path_factory):
    """A bar that bends from rest, a ball beside it, and a spring between them."""
    rubber = vv.NeoHooke(young=1e3, poisson=0.3)
    mesh = vv.BoxMesh(size=(4, 1, 1), counts=(4, 2, 2))
    bar = vv.Solid(
        mesh=mesh, material=rubber, density=1.0, velocity=lambda X: X[:, :1] ** 2 * [[0, 0, -0.3]], name="bar"
    )
    ball = vv.RigidBody(shape=vv.Sphere(radius=0.4), density=1.0, position=(6, 0.5, 0.5), name="ball")
    spring = vv.Spring(a=bar.point_at((4, 0.5, 0.5)), b=ball, stiffness=10, name="spring")
    system = vv.System([bar, ball, spring, vv.Fixed(solid=bar, nodes="x0")])
    path = tmp_path_factory.mktemp("bent") / "t.vtkhdf"
    vv.simulate(system, until=0.5, step=0.05).write(path)
    return path


@pytest.mark.parametrize("with_pyvista", drawers())
def test_fields_color_what_has_them(bent, tmp_path, monkeypatch, with_pyvista):
    """Colours are where the stage puts them: all of the map's for the bar, the plain one for the ball."""
    monkeypatch.setattr(stage, "can_render", lambda: with_pyvista)
    plain = ("#ff00ff", "#ff00ff", "#000000")
    n_hues, pink = {}, {}
    for field in ("", "von_mises", "displacement"):
        png = tmp_path / f"{field or 'plain'}.png"
        ends = (0.0, 164.3) if field == "von_mises" else None
        snapshot(bent, png, field=field, colors=plain, size=(320, 240), outline=bool(field), limits=ends)
        image = read_image(png)[:, :270]  # without the colour bar
        magenta = image[..., [0, 2]].min(axis=2) - image[..., 1]
        pink[field] = (magenta > 0.35).sum()  # more than any colour of the map has
        vivid = image[image.max(axis=2) - image.min(axis=2) > 0.35]
        hue = rgb_to_hsv(vivid)[:, 0]
        n_hues[field] = len(np.unique((20 * hue).astype(int)))
    assert pink["von_mises"] < 0.6 * pink[""]  # the bar has changed its colour,
    assert pink["von_mises"] > 100  # the ball has not,
    assert pink["displacement"] < 0.05 * pink[""]  # but it has moved, too
    assert n_hues[""] <= 3 < 6 <= n_hues["von_mises"]


@pytest.mark.parametrize("with_pyvista", drawers())
def test_color_bar_and_outline_are_drawn(bent, tmp_path, monkeypatch, with_pyvista):
    monkeypatch.setattr(stage, "can_render", lambda: with_pyvista)
    for name, options in {
        "plain": {},
        "bar": {"field": "pressure", "limits": (1e6, 2e6)},
        "both": {"field": "pressure", "limits": (1e6, 2e6), "outline": True},
    }.items():
        snapshot(bent, tmp_path / f"{name}.png", size=(320, 240), **options)
    plain, bar, both = (read_image(tmp_path / f"{name}.png") for name in ("plain", "bar", "both"))
    column = bar[44:196, 289:294]
    yellow, violet = (np.abs(column - c).max(axis=2).min() for c in ((0.99, 0.91, 0.14), (0.27, 0.0, 0.33)))
    assert max(yellow, violet) < 0.1
    assert np.abs(plain[44:196, 289:294] - column).max() > 0.3
    assert (np.abs(both - bar).max(axis=2) > 0.02).sum() > 100


def test_range_of_colors_is_that_of_the_motion(bent):
    with Trajectory(bent) as motion:
        stored = [np.concatenate(motion.field("von_mises", k)) for k in range(len(motion.times))]
        coloring = Coloring.of(motion, "von_mises")
        most = np.nanmax(stored)
        assert coloring.low == 0.0
        assert most <= coloring.high < 1.2 * most  # round ends around it
        ticks = coloring.ticks
        assert (ticks[0], ticks[-1]) == (coloring.low, coloring.high)
        assert all(float(f"{tick:.3g}") == tick for tick in ticks)
        assert 0 <= np.nanmin(stored) < 1e-9
        pressures = [np.concatenate(motion.field("pressure", k)) for k in range(len(motion.times))]
        assert 1.2 * np.nanmin(pressures) < Coloring.of(motion, "pressure").low <= np.nanmin(pressures) < 0
        speed = Coloring.of(motion, "velocity").values(motion, 0.0)
        assert [v is not None for v in speed] == [True, True, True]
        assert speed[1].max() == pytest.approx(0.3 * 16, rel=1e-12)
        assert [v is not None for v in coloring.values(motion, 0.2)] == [False, True, False]
        with pytest.raises(vv.InputError, match="cauchy has too many components to be shown; choose of disp"):
            Coloring.of(motion, "cauchy")
        with pytest.raises(vv.InputError, match="no field is called 'heat'; there are cauchy"):
            Coloring.of(motion, "heat")
        with pytest.raises(vv.InputError, match="cannot span 2 to 1"):
            Coloring.of(motion, "pressure", (2, 1))


@pytest.mark.parametrize("with_pyvista", drawers())
def test_movie_of_a_field(bent, tmp_path, monkeypatch, with_pyvista):
    pillow = pytest.importorskip("PIL.Image")
    monkeypatch.setattr(stage, "can_render", lambda: with_pyvista)
    movie(bent, tmp_path / "m.gif", fps=10, size=(160, 96), field="von_mises", outline=True)
    with pillow.open(tmp_path / "m.gif") as gif:
        assert gif.n_frames == 6
        frames = []
        for k in (0, 5):
            gif.seek(k)
            frames.append(np.asarray(gif.convert("RGB")).astype(int))
    assert np.abs(frames[0] - frames[1]).max() > 60
