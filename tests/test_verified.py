"""What the page on verification shows is replaced test by test."""

from pathlib import Path

import pytest
import verified


def test_rows_of_tests_that_passed_are_replaced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    table = tmp_path / "verified.csv"
    rows = ["a.py::left,x < 2,1,2", "a.py::run,x < 2,1,2", "a.py::broken,x < 2,1,2", "b.py::other,x < 2,1,2"]
    table.write_text("\n".join(["test,check,figure,limit", *rows]) + "\n")
    monkeypatch.setattr(verified, "failed", {"a.py::broken"})
    new = {"y < 4": ("y < 4", 3.0, 4.0, 0.75)}
    monkeypatch.setattr(verified, "nearest", {"a.py::run": new, "a.py::broken": new})
    verified.write(table)
    found = [",".join(row) for row in verified.read(table)]
    assert found == sorted([rows[0], "a.py::run,y < 4,3,4", rows[2], rows[3]])
