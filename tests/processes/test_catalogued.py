"""Several processes step all of the catalogue as one does, see `catalogued.py`."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from processes.launch import launched, missing

pytestmark = pytest.mark.skipif(bool(missing()), reason=f"needs {missing()}")
CATALOGUED = str(Path(__file__).parent / "catalogued.py")


def test_entries_of_the_catalogue_are_those_of_one_process(tmp_path: Path) -> None:
    file = str(tmp_path / "reference.pkl")
    assert launched(0, CATALOGUED, "reference", file).returncode == 0
    done = launched(2, CATALOGUED, file)
    assert done.returncode == 0, done.stderr[-2000:]
    found = json.loads(done.stdout)
    assert found["served"] == found["entries"]
    for name, (state, ledger) in found["differences"].items():
        assert state < 1e-10, name
        assert ledger < 1e-11, name
