"""What files will take is told before the run, and is what they take."""

from __future__ import annotations

from pathlib import Path

import pytest

import visviva as vv
from visviva.output import RunDirectory
from visviva.study import forecast
from visviva.study.forecast import Forecast
from visviva.study.run import run


def study() -> vv.Study:
    mesh = vv.BoxMesh(size=(4, 1, 1), counts=(12, 6, 6))
    beam = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1e3, poisson=0.3), density=1.0, name="beam")
    system = vv.System([beam, vv.Fixed(solid=beam, nodes="x0"), vv.Gravity()])
    return vv.Study(system, until=0.2, step=0.01, title="beam")


def test_it_is_what_comes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(forecast, "LARGE", 1e3)
    texts: list[str] = []
    run(study(), tmp_path, pictures=False, tell=texts.append, every=2)
    files = RunDirectory.open(tmp_path)
    told = Forecast(**files.read_summary()["output"])
    assert texts == [str(told)]
    assert (told.frames, told.states, told.rows) == (11, 11, 11)
    assert files.trajectory.stat().st_size == pytest.approx(told.frames * told.frame, rel=0.15)
    assert files.states.stat().st_size == pytest.approx(told.states * told.state, rel=0.01)
    tables = files.ledger.stat().st_size + files.probes.stat().st_size
    assert tables < 2 * told.rows * told.row


def test_little_is_not_told(tmp_path: Path) -> None:
    texts: list[str] = []
    run(study(), tmp_path, pictures=False, tell=texts.append)
    assert not texts


def test_too_little_room_is_told() -> None:
    told = Forecast(10, 10, 10, 1e6, 1e6, 100.0, seconds=0.1, free=1e7)
    assert told.is_large
    assert "20 MB in all (10 MB are free, which is not enough)" in str(told)
    assert not Forecast(10, 10, 10, 1e6, 1e6, 100.0, seconds=0.1, free=1e12).is_large
    assert Forecast(10, 10, 10, 1e6, 1e6, 100.0, seconds=20.0, free=1e12).is_large


def test_fields_are_chosen(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from visviva.cli import main
    from visviva.output import Trajectory

    options = ["--set", "motion=static", "--no-pictures"]
    for given, stored in (("pressure, von_mises", {"pressure", "von_mises"}), ("", set())):
        out = tmp_path / f"run{len(stored)}"
        assert main(["run", "cantilever", *options, "--out", str(out), "--fields", given]) == 0
        with Trajectory(out / "trajectory.vtkhdf") as motion:
            assert set(motion.fields) - {"displacement", "velocity"} == stored
    capsys.readouterr()
    assert main(["run", "cantilever", *options, "--out", str(tmp_path / "c"), "--fields", "stres"]) == 2
    assert "there is no field 'stres'" in capsys.readouterr().err
