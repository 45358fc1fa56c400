"""One, two, three and four processes step small systems as one does without PETSc, see `alike.py`."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from processes.launch import launched, missing

pytestmark = pytest.mark.skipif(bool(missing()), reason=f"needs {missing()}")
ALIKE = str(Path(__file__).parent / "alike.py")


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> str:
    file = str(tmp_path_factory.mktemp("alike") / "reference.pkl")
    done = launched(0, ALIKE, "reference", file)
    assert done.returncode == 0, done.stderr
    return file


@pytest.mark.parametrize("n", [1, 2, 3, 4])
def test_every_step_ends_where_that_of_one_process_does(n: int, reference: str) -> None:
    done = launched(n, ALIKE, reference)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found["processes"] == n
    assert len(found["cases"]) == 48
    for name, of in found["cases"].items():
        assert of["step"] < 1e-10, name  # of the step's increment
        assert of["run"] < 1e-10, name
        assert of["ledger"] < 1e-12, name
        assert of["looks"] < 1e-10, name
    for name in ("driven", "hinged"):
        assert found["cases"][name]["multipliers"] < 1e-6, name
