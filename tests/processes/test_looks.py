"""What looks at the whole tangent finds the same by two processes, see `looks.py`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from processes.launch import launched, missing

pytestmark = pytest.mark.skipif(bool(missing()), reason=f"needs {missing()}")
LOOKS = str(Path(__file__).parent / "looks.py")


def looks(n: int) -> dict[str, Any]:
    done = launched(n, LOOKS)
    assert done.returncode == 0, done.stderr[-2000:]
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def test_checks_modes_and_paths_are_those_of_one_process() -> None:
    one, two = looks(0), looks(2)
    assert one.keys() == two.keys()
    for name, found in one.items():
        near = 1e-10 if name == "arc length" else 1e-6
        for a, b in zip(found, two[name], strict=True):
            assert (b == pytest.approx(a, rel=near, abs=1e-9)) if isinstance(a, float) else b == a, name
