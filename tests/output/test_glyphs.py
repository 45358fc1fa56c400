"""Arrows, crosses and diagrams: what they stand for, against closed forms, and that pictures show them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import visviva as vv
from output.scenes import drawers, read_image
from visviva.cli import app
from visviva.output import stage
from visviva.output.glyphs import MotionGlyphs, between
from visviva.output.picture import snapshot
from visviva.output.standing import Standing

INK = {
    "arrow": (43, 52, 64),
    "tension": (192, 57, 43),
    "compression": (31, 95, 168),
    "diagram": (230, 126, 34),
}


@pytest.fixture(scope="module")
def spinning(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A plate that turns about the vertical through its centre, at 3 rad/s; up is y."""
    plate = vv.RigidBody(
        name="plate", shape=vv.Box(size=(2.0, 0.1, 1.0)), density=1.0, angular_velocity=(0, 3.0, 0)
    )
    system = vv.System([plate, vv.Gravity(acceleration=(0, -1e-9, 0))], units="SI")
    path = tmp_path_factory.mktemp("spinning") / "run"
    vv.run(vv.Study(system, until=0.2, step=0.1), path, pictures=False)
    return path / "trajectory.vtkhdf"


@pytest.fixture(scope="module")
def pulled(tmp_path_factory: pytest.TempPathFactory) -> vv.Result:
    """A bar under 5 in tension along x and 2 in compression along y."""
    bar = vv.Solid(
        name="bar",
        mesh=vv.BoxMesh(size=(2, 1, 1), counts=(4, 2, 2)),
        material=vv.LinearElastic(young=1e6, poisson=0.3),
    )
    planes = zip("xyz", np.eye(3).tolist(), strict=True)
    held = [vv.SymmetryPlane(solid=bar, nodes=f"{axis}0", normal=tuple(e)) for axis, e in planes]
    loads = [
        vv.Traction(solid=bar, faces="x1", traction=(5.0, 0, 0)),
        vv.Traction(solid=bar, faces="y1", traction=(0, -2.0, 0)),
    ]
    return vv.quasi_static(vv.System([bar, *held, *loads], units="SI"), until=1.0, step=1.0)


@pytest.fixture(scope="module")
def cantilever() -> vv.Result:
    """Along x from 0 to 2, with 3 downwards at its end."""
    section = vv.TubeSection(radius=0.05, young=1e9, poisson=0.25, density=1.0)
    beam = vv.Beam(
        name="beam", mesh=vv.LineMesh(points=[(0, 0, 0), (2, 0, 0)], count=4, cell="line3"), section=section
    )
    tip = vv.Force(on=beam.point((2, 0, 0)), force=(0, 0, -3.0))
    system = vv.System([beam, vv.Clamped(solid=beam, nodes="start"), tip], units="SI")
    return vv.quasi_static(system, until=1.0, step=1.0)


def test_arrows_are_velocities_as_they_stand(spinning: Path) -> None:
    """w x r about the third axis, to which up was turned; the fastest corner has the longest arrow."""
    with Standing(spinning) as motion:
        motion_glyphs = MotionGlyphs(motion, "velocity", time=0.1)
        start, tip = motion_glyphs.at(0.1).arrows[:, 0], motion_glyphs.at(0.1).arrows[:, 1]
        longest = 3.0 * np.hypot(1.0, 0.5)
        assert motion_glyphs.text.strip() == f"longest arrow: velocity = {longest:.3g} m/s"
    spin = np.cross([0, 0, 3.0], start - start.mean(axis=0))
    scale = np.linalg.norm(tip - start, axis=1).max() / longest
    np.testing.assert_allclose(tip - start, scale * spin, atol=1e-6 * scale * longest)


def test_crosses_are_principal_stresses(pulled: vv.Result, tmp_path: Path) -> None:
    pulled.write(tmp_path / "t.vtkhdf")
    with Standing(tmp_path / "t.vtkhdf") as motion:
        motion_glyphs = MotionGlyphs(motion, "cauchy", time=1.0)
        glyphs, n = (
            motion_glyphs.at(1.0),
            len(motion.surfaces[0].points) - 3,
        )  # three nodes inside are not seen
        assert "longest line: Cauchy stress = 5 Pa" in motion_glyphs.text
    lengths = {sign: np.linalg.norm(np.diff(getattr(glyphs, sign), axis=1)[:, 0], axis=1) for sign in SIGNS}
    along_x = glyphs.positive[lengths["positive"] > 0.1 * lengths["positive"].max()]
    along_y = glyphs.negative[lengths["negative"] > 0.1 * lengths["positive"].max()]
    assert len(along_x) == len(along_y) == n
    assert np.abs(np.diff(along_x, axis=1)[..., 1:]).max() < 1e-9
    assert np.abs(np.diff(along_y, axis=1)[..., [0, 2]]).max() < 1e-9
    assert lengths["negative"].max() / lengths["positive"].max() == pytest.approx(2 / 5)


SIGNS = "positive", "negative"


def test_diagrams_stand_on_their_beams(cantilever: vv.Result, tmp_path: Path) -> None:
    """The moment 3 (2 - x), above the beam, where it is in tension; its area is a triangle's."""
    cantilever.write(tmp_path / "t.vtkhdf", fields=("diagram_bending_1", "diagram_bending_2"))
    with Standing(tmp_path / "t.vtkhdf") as motion:
        found = [MotionGlyphs(motion, diagram=f"bending_{k}", time=1.0) for k in (1, 2)]
        motion_glyphs = max(found, key=lambda one: len(one.at(1.0).ends[one.at(1.0).ends[:, 2] > 0.01]))
        sheets = motion_glyphs.at(1.0).sheets
        assert "= 6 N m" in motion_glyphs.text
    height = np.abs(sheets[:, 3] - sheets[:, 0]).max()
    across = np.cross(sheets[:, 2] - sheets[:, 0], sheets[:, 3] - sheets[:, 1]) / 2
    assert np.linalg.norm(across, axis=1).sum() == pytest.approx(height * 2.0 / 2, rel=1e-3)
    assert (sheets[:, 3, 2] >= sheets[:, 0, 2] - 1e-9).all()


def test_diagrams_that_change_their_sign_cross_the_beam() -> None:
    foot, other, arm = np.array([[0.0, 0, 0]]), np.array([[3.0, 0, 0]]), np.array([[0, 0, 2.0]])
    whole, first, second = between(foot, arm, other, -0.5 * arm)
    assert not len(whole)
    assert first[0].tolist() == [[0, 0, 0], [2, 0, 0], [2, 0, 0], [0, 0, 2]]
    assert second[0].tolist() == [[2, 0, 0], [3, 0, 0], [3, 0, -1], [2, 0, 0]]


def test_few_marks_of_many_points(tmp_path: Path) -> None:
    block = vv.Solid(
        mesh=vv.BoxMesh(size=(4, 1, 1), counts=(40, 10, 10)),
        material=vv.NeoHooke(young=1, poisson=0),
        density=1.0,
        velocity=(1, 0, 0),
    )
    vv.simulate(vv.System([block]), until=0.1, step=0.1).write(tmp_path / "t.vtkhdf", fields=())
    with Standing(tmp_path / "t.vtkhdf") as motion:
        arrows = MotionGlyphs(motion, "velocity").at(0.1).arrows
    assert 100 < len(arrows) <= 300
    assert (np.abs(arrows[:, 0, 1:] - 0.5).max(axis=1) > 0.49).sum() > 80  # on the faces, not inside


def test_bodies_of_the_same_shape_stand_apart(tmp_path: Path) -> None:
    """The length of arrows goes by distances in space, not in the bodies' own coordinates."""
    cubes = [
        vv.RigidBody(shape=vv.Box(size=(1, 1, 1)), density=1.0, position=(10.0 * k, 0, 0), velocity=(0, 0, 1))
        for k in range(2)
    ]
    vv.simulate(vv.System(cubes), until=0.1, step=0.1).write(tmp_path / "t.vtkhdf")
    with Standing(tmp_path / "t.vtkhdf") as motion:
        arrows = MotionGlyphs(motion, "velocity").at(0.1).arrows
    assert np.linalg.norm(arrows[:, 1] - arrows[:, 0], axis=1) == pytest.approx(
        0.1 * np.linalg.norm([11, 1, 1.1])
    )


def test_what_is_no_vector_is_refused(pulled: vv.Result, cantilever: vv.Result, tmp_path: Path) -> None:
    for wrong, said in {
        "vonmises": "there is no field",
        "von_mises": "neither a vector nor a symmetric tensor; there are cauchy",
        "principal_stresses": "neither a vector nor",
    }.items():
        with pytest.raises(vv.InputError, match=said):
            pulled.picture(vectors=wrong)
    cantilever.write(tmp_path / "t.vtkhdf", fields=("diagram_bending_1",))
    with pytest.raises(vv.InputError, match="no diagram 'bending1'; did you mean 'bending_1'"):
        snapshot(tmp_path / "t.vtkhdf", tmp_path / "p.png", diagram="bending1")
    cantilever.write(tmp_path / "none.vtkhdf", fields=())
    with pytest.raises(vv.InputError, match=r"names, fields=\['diagram_bending_1'"):
        snapshot(tmp_path / "none.vtkhdf", tmp_path / "p.png", diagram="bending_1")


def shows(png: Path, color: str) -> int:
    """Number of pixels near a colour."""
    return int((np.abs(255 * read_image(png) - INK[color]).max(axis=2) < 40).sum())


@pytest.mark.parametrize("with_pyvista", drawers())
def test_pictures_show_them(
    spinning: Path,
    pulled: vv.Result,
    cantilever: vv.Result,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    with_pyvista: bool,
) -> None:
    monkeypatch.setattr(stage, "can_render", lambda: with_pyvista)
    png, look = tmp_path / "p.png", {"size": (480, 320), "colors": ("#ffffff",)}
    for vectors, least in (("", 0), ("velocity", 60)):
        snapshot(spinning, png, vectors=vectors, **look)
        plain = plain if vectors else shows(png, "arrow")  # noqa: F821
        assert shows(png, "arrow") - plain >= least
    for field in ("", "cauchy"):
        pulled.picture(png, vectors=field, **look)
        assert [shows(png, color) > 20 for color in ("tension", "compression")] == 2 * [bool(field)]
    for diagram in ("", "bending_1", "bending_2"):
        cantilever.picture(png, diagram=diagram, **look)
        found = shows(png, "diagram")
        assert found > 50 or diagram != "bending_1"
        assert found == 0 or diagram


def test_movies_and_the_command_line(cantilever: vv.Result, tmp_path: Path) -> None:
    file = cantilever.movie(tmp_path / "m.gif", diagram="bending_1", size=(160, 96), fps=5)
    assert file.stat().st_size > 500
    cantilever.write(tmp_path / "run", fields=("diagram_bending_1",))
    look = ["--size", "640x400", "--diagram", "bending_1", "--vectors", "displacement"]
    app(["picture", str(tmp_path / "run"), *look], exit_on_error=False, result_action="return_value")
    assert shows(tmp_path / "run" / "picture.png", "diagram") > 20
