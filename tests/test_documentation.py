"""What the documentation shows is run: docstrings, pages, the script of the README."""

from __future__ import annotations

import csv
import doctest
import json
import pkgutil
import re
import runpy
import tomllib
from importlib import import_module
from inspect import cleandoc, isclass, signature
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


def test_figures_of_the_page_on_verification_are_of_tests_that_there_are() -> None:
    """``python -m verified`` measures them anew."""
    folder = ROOT / "tests" / "verification"
    with (ROOT / "docs" / "campaign" / "verified.csv").open(newline="") as file:
        measured = {row["test"] for row in csv.DictReader(file)}
    there = {
        f"{path.name}::{name}"
        for path in folder.glob("test_*.py")
        for name in re.findall(r"^def (test_\w+)", path.read_text(), flags=re.MULTILINE)
    }
    assert measured - there == set()
    assert len(measured) > 0.6 * len(there), "the others ask for yes or no, or are new"


def test_tutorials_are_notebooks_with_pictures(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The first runs in a kernel of Jupyter as it stands, as all of them do for the pages."""
    monkeypatch.syspath_prepend(str(ROOT / "docs"))
    tutorials = import_module("make_tutorials")
    for page in sorted((ROOT / "docs").glob("tutorial*.rst")):
        made = json.loads(json.dumps(tutorials.notebook(page)))
        assert (made["nbformat"], made["cells"][0]["source"][0][:2]) == (4, "# ")
        code = ["".join(cell["source"]) for cell in made["cells"] if cell["cell_type"] == "code"]
        assert any("result.picture(" in cell for cell in code)
        assert all(compile(cell, page.name, "exec") for cell in code)
        told = "".join("".join(cell["source"]) for cell in made["cells"] if cell["cell_type"] == "markdown")
        assert not re.search("``|>>>|^\\.\\. |:doc:", told, flags=re.MULTILINE)
    ran = tutorials.executed(ROOT / "docs" / "tutorial.rst", tmp_path)
    shown = [output.get("data", {}) for cell in ran["cells"] for output in cell.get("outputs", ())]
    assert sum("image/png" in data for data in shown) == 2
    assert sorted(path.name for path in tmp_path.glob("*.png")) == ["pendulum.png", "pendulum_energy.png"]


MADE = {"Buckling", "Modes", "Result"}
"""What users get and do not make: attributes are documented."""
CLASSES = [name for name in visviva.__all__ if isclass(getattr(visviva, name))]


def documented(cls: type) -> set[str]:
    """Names in the sections on arguments of a class and those that it is derived from."""
    kind = "Attributes" if cls.__name__ in MADE else "Parameters"
    section = re.compile(rf"^{kind}\n-+\n(.*?)(?=\n\n\w[\w ]*\n---|\Z)", flags=re.MULTILINE | re.DOTALL)
    told = [
        found[1] for c in cls.__mro__ if (found := section.search(cleandoc(vars(c).get("__doc__") or "")))
    ]
    heads = [line.split(" : ")[0] for text in told for line in text.splitlines() if line[:1].strip()]
    return {name.strip(" *") for head in heads for name in head.split(",")}


@pytest.mark.parametrize("name", CLASSES)
def test_arguments_of_public_classes_are_documented(name: str) -> None:
    """By their names, in a section of its own or an inherited one."""
    cls = getattr(visviva, name)
    arguments = {argument for argument in signature(cls).parameters if not argument.startswith("_")}
    assert arguments - documented(cls) == set()
