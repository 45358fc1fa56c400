"""What the documentation shows is run: docstrings, pages, the script of the README."""

from __future__ import annotations

import doctest
import pkgutil
import runpy
import tomllib
from importlib import import_module
from pathlib import Path

import pytest

import visviva

ROOT = Path(__file__).resolve().parents[1]
PAGES = sorted(
    p for p in (ROOT / "docs").rglob("*.rst") if p.parent.name not in ("gallery", "reference", "_build")
)
MODULES = [m.name for m in pkgutil.walk_packages(visviva.__path__, "visviva.") if "__main__" not in m.name]
SCRIPT = ROOT / "examples" / "first.py"


@pytest.mark.parametrize("name", MODULES)
def test_docstrings(name: str) -> None:
    assert doctest.testmod(import_module(name)).failed == 0


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_pages(page: Path) -> None:
    assert doctest.testfile(str(page), module_relative=False).failed == 0


def test_script_of_the_readme(capsys: pytest.CaptureFixture[str]) -> None:
    runpy.run_path(str(SCRIPT))
    assert "energy balance closes to" in capsys.readouterr().out
    readme = ROOT / "README.md"
    if readme.exists():
        assert SCRIPT.read_text().split('"""')[2].strip() in readme.read_text()


def test_reference_has_every_public_name_once() -> None:
    """As a page of its own, under the name it is imported by or that of its module."""
    groups = tomllib.loads((ROOT / "docs" / "reference.toml").read_text())
    names = [name.split(".")[-1] for group in groups.values() for name in group]
    assert {name: names.count(name) for name in visviva.__all__ if names.count(name) != 1} == {}
