"""What contacts show in the trajectory file, as VTK's own reader sees it, and in pictures coloured by it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from contact_parts import bricks, contact_of, stacked
from rubbing import slope

import visviva as vv
from output.scenes import drawers, read_by_vtk, read_image
from visviva.output import Trajectory, stage
from visviva.output.movie import movie
from visviva.output.picture import snapshot
from visviva.results.drawing import Drawing
from visviva.study.run import run


@pytest.mark.parametrize(("dimension", "cell"), [(2, "quad4"), (3, "hex8"), (3, "tet4")])
def test_pressure_of_the_patch_in_the_file(tmp_path: Path, dimension: int, cell: str) -> None:
    """10 by area at rest, at all nodes of both surfaces that touch, whose meshes do not match; nothing elsewhere."""
    a, b, contact, parts = stacked(dimension, cell)
    result = vv.quasi_static(vv.System(parts), until=1.0, step=1.0)
    result.write(tmp_path / "t.vtkhdf")
    before, after = read_by_vtk(tmp_path / "t.vtkhdf")[1]
    axis = "xyz"[dimension - 1]
    touching = np.concatenate(
        [np.isin(np.arange(s.grid.n_nodes), s.nodes(axis + e)) for s, e in ((a, "0"), (b, "1"))]
    )
    present = 1.0039 if dimension == 2 else 1.003**2  # nu (1 + nu) p / E, twice nu p / E
    np.testing.assert_allclose(after["contact_pressure"], np.where(touching, 10.0 / present, 0.0), atol=1e-9)
    np.testing.assert_array_equal(after["contact_state"], np.where(touching, 1.0, 0.0))
    first = touching & (np.arange(len(touching)) < a.grid.n_nodes)
    assert np.abs(after["contact_gap"][first]).max() < 1e-12
    assert np.isnan(after["contact_gap"][~first]).all()
    assert np.abs(before["contact_pressure"]).max() == 0
    assert "contact_traction" not in after.point_data
    for at in (None, (0.4, 0.2, 1)):
        pressure = vv.ContactPressure(contact=contact, at=at)(result.system)
        assert pressure == pytest.approx(10.0 / present, rel=1e-10)
    assert vv.ContactGap(contact=contact)(result.system) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("dimension", [2, 3])
def test_traction_of_a_sliding_block_in_the_file(tmp_path: Path, dimension: int) -> None:
    """Uphill, and 0.3 times the pressure; the slope feels the opposite, in the sum of both."""
    parts = slope(dimension, speed=0.1, friction=0.3)
    block, base = (part for part in parts if isinstance(part, vv.Solid))
    result = vv.simulate(vv.System(parts), until=0.1, step=0.01)
    result.write(tmp_path / "t.vtkhdf")
    grid = read_by_vtk(tmp_path / "t.vtkhdf")[1][-1]
    pressure, traction = grid["contact_pressure"], grid["contact_traction"]
    low = block.nodes("yz"[dimension - 2] + "0")
    np.testing.assert_allclose(pressure[low], contact_of(parts).pressures, rtol=1e-14)
    np.testing.assert_allclose(traction[low, 0], -0.3 * pressure[low], rtol=1e-8)
    assert set(grid["contact_state"][low]) == {2.0}
    high = base.nodes("yz"[dimension - 2] + "1")
    areas = contact_of(parts).opposite.areas  # type: ignore[union-attr]
    total = areas @ traction[block.grid.n_nodes + high]
    np.testing.assert_allclose(total[0], 0.3 * areas @ pressure[block.grid.n_nodes + high], rtol=1e-8)
    with Trajectory(tmp_path / "t.vtkhdf") as motion:
        assert motion.fields["contact_traction"] == 3


def test_pressures_belong_to_their_steps(tmp_path: Path) -> None:
    """What is kept of every step, not the last one's; and the same from a run that was broken off."""

    def study(until: float) -> vv.Study:
        return vv.Study(vv.System(bricks()), until, 0.01, fields=("contact_pressure",))

    seen = []
    parts = bricks()
    result = vv.simulate(
        vv.System(parts),
        until=0.06,
        step=0.01,
        observe=lambda _: seen.append(contact_of(parts).pressures.max()),
    )
    result.write(tmp_path / "t.vtkhdf")
    first = parts[0]
    assert isinstance(first, vv.Solid)
    grids = read_by_vtk(tmp_path / "t.vtkhdf")[1]
    assert [grid["contact_pressure"][: first.grid.n_nodes].max() for grid in grids] == [0.0, *seen]
    assert max(seen) > 1
    assert len(set(seen)) > 3
    run(study(0.06), tmp_path / "whole", progress=False, pictures=False)
    run(study(0.02), tmp_path / "split", progress=False, pictures=False)
    resumed = run(study(0.06), tmp_path / "split", progress=False, pictures=False, resume=True)
    whole, split = (read_by_vtk(tmp_path / name / "trajectory.vtkhdf")[1] for name in ("whole", "split"))
    assert len(whole) == len(split)
    for one, other in zip(whole, split, strict=True):
        np.testing.assert_array_equal(one["contact_pressure"], other["contact_pressure"])
    assert len(resumed.records) == len(resumed.states)
    np.testing.assert_array_equal([r[0] for r in resumed.records], [r[0] for r in result.records])


@pytest.mark.parametrize("with_pyvista", drawers())
def test_pictures_and_movies_show_the_pressure(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, with_pyvista: bool
) -> None:
    pillow = pytest.importorskip("PIL.Image")
    monkeypatch.setattr(stage, "can_render", lambda: with_pyvista)
    parts = bricks()
    post = vv.RigidBody(shape=vv.Sphere(radius=0.5), density=1.0, position=(6, 2, 0))
    path = tmp_path / "t.vtkhdf"
    vv.simulate(vv.System([*parts, post]), until=0.04, step=0.01).write(path)
    plain = ("#ff00ff", "#ff00ff", "#ff00ff")
    pink = {}
    for field in ("", "contact_pressure", "contact_gap"):
        snapshot(path, tmp_path / "p.png", field=field, colors=plain, size=(320, 240))
        image = read_image(tmp_path / "p.png")[:, :270]
        pink[field] = int((image[..., [0, 2]].min(axis=2) - image[..., 1] > 0.2).sum())
    assert 20 < pink["contact_pressure"] < 0.3 * pink[""]  # the ball alone touches nothing
    assert pink["contact_gap"] > 0.3 * pink[""]  # most of the bricks has no gap
    movie(path, tmp_path / "m.gif", fps=100, size=(160, 96), field="contact_pressure")
    with pillow.open(tmp_path / "m.gif") as gif:
        assert gif.n_frames > 2


def test_fields_of_contact_need_a_contact() -> None:
    with pytest.raises(vv.InputError, match="there is no field 'contact_pressure'"):
        Drawing(vv.System(bricks()[:2]), fields=["contact_pressure"])
