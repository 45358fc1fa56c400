"""A motion as .pvd and .vtu: what PyVista's own reader finds in them."""

import numpy as np
import pytest

import visviva as vv
from visviva.cli import main
from visviva.output import RunDirectory, Trajectory

pyvista = pytest.importorskip("pyvista")


def test_series_of_files(tmp_path, capsys):
    rubber = vv.NeoHooke(young=2e4, poisson=0.3)
    bar = vv.Solid(
        name="bar & <co>", mesh=vv.BoxMesh(size=(2, 1, 1), counts=(2, 1, 1)), material=rubber, density=10
    )
    ball = vv.RigidBody(
        name="ball", shape=vv.Sphere(0.2), density=100, position=(1, 2, 0), velocity=(1, 0, 1)
    )
    system = vv.System([bar, ball, vv.Gravity(acceleration=(0, 0, -9.81)), vv.Fixed(solid=bar, nodes="x0")])
    vv.simulate(system, until=0.2, step=0.1).write(tmp_path / "run")
    assert main(["export", str(tmp_path / "run"), "--out", str(tmp_path / "all.pvd")]) == 0
    assert "all.pvd" in capsys.readouterr().out
    reader = pyvista.get_reader(tmp_path / "all.pvd")
    assert reader.time_values == pytest.approx([0.0, 0.1, 0.2])
    with Trajectory(RunDirectory(tmp_path / "run").trajectory) as motion:
        names = [surface.name for surface in motion.surfaces]
        k = names.index("bar & <co>")
        reader.set_active_time_value(reader.time_values[2])
        bars = [grid for grid in reader.read() if "cauchy" in grid.point_data]
        assert len(bars) == 1
        np.testing.assert_array_equal(bars[0].points, motion.points(2)[k])
        np.testing.assert_array_equal(bars[0]["cauchy"], motion.field("cauchy", 2)[k])
    array = bars[0].GetPointData().GetAbstractArray("cauchy")
    assert [array.GetComponentName(j) for j in range(6)] == ["xx", "yy", "zz", "xy", "yz", "zx"]
    stress = bar.nodal("cauchy", system.x)
    np.testing.assert_allclose(bars[0]["cauchy"], stress, atol=1e-12 * np.abs(stress).max())
    (tmp_path / "notes").mkdir()
    (tmp_path / "notes" / "mine.vtu").write_text("of a user")
    assert main(["export", str(tmp_path / "run"), "--out", str(tmp_path / "notes.pvd")]) != 0
    assert "holds 'mine.vtu'" in capsys.readouterr().err
    assert [file.name for file in (tmp_path / "notes").iterdir()] == ["mine.vtu"]
