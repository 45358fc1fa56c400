"""Compressed trajectories: smaller, the same contents, and as good for all that reads and continues them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

import visviva as vv
from visviva.output import Trajectory, compressed
from visviva.output.compressed import compress
from visviva.study.run import run


def study(until: float) -> vv.Study:
    """A beam that swings: most fields of its start are smooth, so that there is something to compress."""
    mesh = vv.BoxMesh(size=(4, 1, 1), counts=(12, 4, 4))
    beam = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1e3, poisson=0.3), density=1.0, name="beam")
    system = vv.System([beam, vv.Fixed(solid=beam, nodes="x0"), vv.Gravity()])
    return vv.Study(system, until=until, step=0.01, title="beam")


def contents(path: Path) -> dict[str, Any]:
    """All values and attributes of a file."""
    found: dict[str, Any] = {}

    def take(name: str, item: Any) -> None:
        found.update({f"{name}@{key}": np.asarray(value).tolist() for key, value in item.attrs.items()})
        if isinstance(item, h5py.Dataset):
            found[name] = item[()]

    with h5py.File(path, "r") as file:
        file.visititems(take)
    return found


def test_contents_are_the_same_and_smaller(tmp_path: Path) -> None:
    run(study(0.1), tmp_path / "plain", pictures=False)
    run(study(0.1), tmp_path / "small", pictures=False, compress=True)
    plain, small = (tmp_path / name / "trajectory.vtkhdf" for name in ("plain", "small"))
    one, other = contents(plain), contents(small)
    assert one.keys() == other.keys()
    for name, values in one.items():
        np.testing.assert_array_equal(values, other[name], err_msg=name)
    assert small.stat().st_size < 0.8 * plain.stat().st_size
    with h5py.File(small, "r") as file:
        assert file["VTKHDF/PointData/von_mises"].compression == "gzip"
    with Trajectory(small) as motion:  # checksums are looked at
        assert len(motion.times) == 11
        assert motion.field("von_mises", 10)[0].max() > 0


def test_a_compressed_run_goes_on(tmp_path: Path) -> None:
    run(study(0.05), tmp_path / "split", pictures=False, compress=True)
    run(study(0.1), tmp_path / "split", pictures=False, resume=True)
    run(study(0.1), tmp_path / "whole", pictures=False)
    one, other = (contents(tmp_path / name / "trajectory.vtkhdf") for name in ("split", "whole"))
    for name, values in other.items():
        np.testing.assert_array_equal(values, one[name], err_msg=name)


def test_without_room_for_both_the_plain_one_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run(study(0.02), tmp_path, pictures=False)
    path = tmp_path / "trajectory.vtkhdf"
    before = path.read_bytes()
    usage = type("Usage", (), {"free": 10})
    monkeypatch.setattr(compressed.shutil, "disk_usage", lambda _: usage)
    with pytest.raises(vv.InputError, match="cannot be compressed, which takes up to"):
        compress(path)
    assert path.read_bytes() == before
