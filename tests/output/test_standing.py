"""Pictures stand: up is against gravity, plane models fill their frame, fluids in space are open; options."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.image import imread

import visviva as vv
from output.scenes import drawers, read_image
from visviva.cli import main
from visviva.output import Trajectory, stage
from visviva.output.coloring import Coloring, fluids_of, rounded
from visviva.output.picture import snapshot
from visviva.output.standing import Standing, turn_to_up
from visviva.output.view import Scene


@pytest.fixture(scope="module")
def hanging(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A ball that hangs from another one, where y is up."""
    path = tmp_path_factory.mktemp("hanging") / "t.vtkhdf"
    a, b = vv.PointMass(mass=1.0, name="ball-1"), vv.PointMass(mass=1.0, position=(0, -2, 0), name="ball-2")
    rod = vv.Distance(a=a.point(), b=b.point())
    system = vv.System([a, b, rod, vv.Gravity(acceleration=(0, -9.81, 0))])
    vv.simulate(system, until=0.1, step=0.1).write(path)
    return path


@pytest.fixture(scope="module")
def duct(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A stream through a box, of nothing else."""
    path = tmp_path_factory.mktemp("duct") / "t.vtkhdf"
    mesh = vv.BoxMesh(size=(3, 1, 1), counts=(3, 3, 3), cell="hex27")
    water = vv.Fluid(mesh=mesh, density=1.0, viscosity=1.0, name="water", velocity=lambda X: shear(X))
    walls = vv.NoSlip(fluid=water, faces="z0")
    sides = [vv.FreeSlip(fluid=water, faces=side) for side in ("y0", "y1", "z1")]
    walls = [walls, *sides, vv.Outlet(fluid=water, faces="x0")]
    vv.simulate(vv.System([water, *walls, vv.Outlet(fluid=water, faces="x1")]), until=0.1, step=0.1).write(
        path
    )
    return path


def shear(X: Any) -> Any:
    return np.stack([X[:, 2], 0 * X[:, 2], 0 * X[:, 2]], axis=1)


def test_turns_are_rotations() -> None:
    rng = np.random.default_rng(1)
    for up in [*rng.normal(size=(20, 3)), np.array([0, 0, -1.0]), np.array([0, 0, 2.0])]:
        Q = turn_to_up(up)
        np.testing.assert_allclose(Q @ Q.T, np.eye(3), atol=1e-12)
        assert np.linalg.det(Q) == pytest.approx(1)
        np.testing.assert_allclose(Q @ up, [0, 0, np.linalg.norm(up)], atol=1e-12)


def test_up_is_against_gravity(hanging: Path) -> None:
    with Trajectory(hanging) as plain, Standing(hanging) as motion:
        assert plain.labels.up == [0.0, 1.0, 0.0]
        high, low = (points.mean(axis=0) for points in motion.points(1)[:2])
        np.testing.assert_allclose(high - low, [0, 0, 2], atol=1e-9)
        np.testing.assert_allclose(
            plain.points(1)[0].mean(axis=0)[2], 0, atol=1e-9
        )  # the file is as computed
        eye, _, up = motion.camera(((0, 0, 5), (0, 0, 0), (0, 1, 0)))  # type: ignore[misc]
        np.testing.assert_allclose(up, (0, 0, 1), atol=1e-12)
        np.testing.assert_allclose(eye, (0, -5, 0), atol=1e-12)


def test_like_bodies_in_like_colours(hanging: Path) -> None:
    with Standing(hanging) as motion:
        scene = Scene(motion.surfaces, motion.cloud())
    assert [s.name for s in motion.surfaces] == ["ball-1", "ball-2", "distance-1"]
    assert scene.color(0) == scene.color(1) != scene.color(2)


def test_plane_models_fill_their_frame_without_floor(tmp_path: Path) -> None:
    mesh = vv.RectangleMesh(size=(2, 1), counts=(2, 1))
    plate = vv.Solid(mesh=mesh, material=vv.LinearElastic(young=1.0, poisson=0.3), density=1.0, name="plate")
    vv.simulate(vv.System([plate]), until=0.1, step=0.1).write(tmp_path / "t.vtkhdf")
    with Standing(tmp_path / "t.vtkhdf") as motion:
        scene = Scene(motion.surfaces, motion.cloud(), size=(400, 200))
    assert scene.is_flat
    eye, target, _ = scene.fitted_camera(30.0)
    np.testing.assert_allclose(np.subtract(eye, target)[:2], 0, atol=1e-9)  # straight from above
    reach = np.linalg.norm(np.subtract(eye, target)) * np.tan(np.radians(15))
    assert 1.1 < 2 * reach / 1.0 < 1.3  # the plate is 1 high


@pytest.mark.parametrize("with_pyvista", drawers())
def test_pictures_have_options(
    hanging: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, with_pyvista: bool
) -> None:
    monkeypatch.setattr(stage, "can_render", lambda: with_pyvista)
    images = {}
    looks: dict[str, dict[str, Any]] = {
        "plain": {},
        "front": {"camera": "front"},
        "clear": {"transparent": True},
    }
    for name, look in looks.items():
        snapshot(hanging, tmp_path / f"{name}.png", size=(240, 160), **look)
        images[name] = imread(tmp_path / f"{name}.png")
    assert images["plain"].shape[:2] == (160, 240)
    assert np.abs(images["plain"] - images["front"]).max() > 0.1
    assert images["clear"].shape == (160, 240, 4)
    assert (images["clear"][..., 3] == 0).mean() > 0.3
    with pytest.raises(vv.InputError, match="no camera 'fornt'; did you mean 'front'"):
        snapshot(hanging, tmp_path / "p.png", camera="fornt")
    for blind in (((0, 0, 1), (0, 0, 1), (0, 1, 0)), ((0, 0, 1), (0, 0, 0), (0, 0, 2))):
        with pytest.raises(vv.InputError, match=r"camera = .* sees nothing"):
            snapshot(hanging, tmp_path / "p.png", camera=blind)
        with pytest.raises(vv.InputError, match=r"Pictures: camera = .* sees nothing"):
            vv.Pictures(camera=blind)
    with pytest.raises(vv.InputError, match="'max' goes with a field"):
        snapshot(hanging, tmp_path / "p.png", time="max")


def test_deformation_and_moment(tmp_path: Path) -> None:
    steel = vv.LinearElastic(young=1.0, poisson=0.0)
    bar = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), material=steel, density=1.0, name="bar")
    pull = vv.Prescribed(solid=bar, nodes="x1", motion=("0.1*sin(3.14159265*t)", None, None))
    system = vv.System([bar, pull, vv.Fixed(solid=bar, nodes="x0")])
    path = tmp_path / "t.vtkhdf"
    vv.simulate(system, until=1.0, step=0.1).write(path)
    with Standing(path, 3.0) as motion, Trajectory(path) as plain:
        moved = plain.points(3)[0] - plain.surfaces[0].points
        np.testing.assert_allclose(motion.points(3)[0] - plain.surfaces[0].points, 3 * moved, atol=1e-12)
    from visviva.output.picture import largest

    with Standing(path) as motion:
        assert largest(motion, Coloring.of(motion, "displacement")) == pytest.approx(0.5)
        with pytest.raises(vv.InputError, match="no colour map 'viridi'; did you mean 'viridis'"):
            Coloring.of(motion, "displacement", colors="viridi")
        assert Coloring.of(motion, "displacement").title == "displacement magnitude"


def test_round_ranges() -> None:
    assert rounded(0.0, 164.3) == (0.0, 175.0)
    assert rounded(-0.031, 0.02) == pytest.approx((-0.04, 0.02))
    assert rounded(2.0, 2.0) == (2.0, 2.0)


@pytest.mark.skipif(not stage.can_render(), reason="no OpenGL here")
def test_fluids_in_space_are_open(duct: Path, tmp_path: Path) -> None:
    """Inside of the box the section is seen in colours of the map, not those of its walls."""
    with Standing(duct) as motion:
        assert fluids_of(motion) == {0}
    snapshot(duct, tmp_path / "p.png", field="velocity", size=(480, 320), cmap="Reds", limits=(0, 1))
    image = read_image(tmp_path / "p.png")[:, :410]
    red = (image[..., 0] - image[..., 1:].max(axis=2) > 0.3).mean()
    assert 0.02 < red < 0.3


def test_options_on_the_command_line(
    hanging: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    system = vv.System([vv.PointMass(mass=1.0, velocity=(1, 0, 0), name="ball")])
    vv.simulate(system, until=0.1, step=0.1).write(tmp_path / "r")
    out = ["--out", str(tmp_path / "p.png")]
    given = ["--camera", "0,0,9,0,0,0,0,1,0", "--size", "200x100", "--transparent", "--time", "0.05"]
    assert main(["picture", str(tmp_path / "r"), *out, *given]) == 0
    assert imread(tmp_path / "p.png").shape == (100, 200, 4)
    capsys.readouterr()
    for option, text in (("--camera", "1,2"), ("--size", "big"), ("--range", "1")):
        assert main(["picture", str(tmp_path / "r"), *out, option, text]) == 2
        assert f"{option} '{text}'" in capsys.readouterr().err
