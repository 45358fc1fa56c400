"""What stands in several files of a release is the same in all of them; workflows do what they say."""

from __future__ import annotations

import os
import re
import subprocess
import tomllib
from pathlib import Path

import pytest
import yaml

import visviva

ROOT = Path(__file__).resolve().parents[1]
PATH = os.environ["PATH"]
WORKFLOWS = ROOT / ".github" / "workflows"
pytestmark = pytest.mark.skipif(not WORKFLOWS.exists(), reason="not in a checkout")


def project() -> dict:
    return tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]


def test_one_version() -> None:
    version = project()["version"]
    recipe = yaml.safe_load((ROOT / "packaging/conda/recipe.yaml").read_text())
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    docs = re.search('release = "(.*)"', (ROOT / "docs/conf.py").read_text())
    assert docs is not None
    assert {visviva.__version__, recipe["context"]["version"], citation["version"], docs[1]} == {version}


def test_the_recipe_runs_with_what_the_package_needs() -> None:
    recipe = yaml.safe_load((ROOT / "packaging/conda/recipe.yaml").read_text())
    known = {"PyYAML": "pyyaml", "matplotlib": "matplotlib-base"}
    wanted = {
        known.get(n, n) + " " + v for n, v in (re.split("(?=>=)", d) for d in project()["dependencies"])
    }
    assert set(recipe["requirements"]["run"]) - {"python"} == wanted


def test_placeholders_stand_in_one_place() -> None:
    files = [
        *ROOT.glob("*.md"),
        *ROOT.glob("*.cff"),
        *(ROOT / ".github").rglob("*.*"),
        *(ROOT / "packaging").rglob("*.*"),
    ]
    assert [str(f) for f in files if f.is_file() and "example.org" in f.read_text()] == []
    assert all("example.org" in url for url in project()["urls"].values()) or "example.org" not in str(
        project()
    )


def test_workflows_call_what_there_is() -> None:
    text = "".join(file.read_text() for file in WORKFLOWS.glob("*.yml"))
    for script in (".ci/run", "make docs"):
        assert script in text
    assert (ROOT / ".ci" / "run").exists()
    called = re.findall(r"uses: \./(\S+)", text)
    assert called
    assert all((ROOT / path).exists() for path in called)


def test_the_changelog_has_the_version_and_says_everything_once() -> None:
    lines = (ROOT / "CHANGELOG.md").read_text().splitlines()
    version = project()["version"]
    versions = [line.split()[1] for line in lines if line.startswith("## ")]
    assert versions[0] == version
    assert len(set(versions)) == len(versions)
    start = lines.index(next(line for line in lines if line.startswith("## ")))
    sections = [line for line in lines[start + 1 :] if re.match("## |### ", line)]
    assert sections[:4] == ["### Added", "### Changed", "### Fixed", "### Removed"]
    told = [line for line in lines if line.startswith("- ")]
    assert sorted({line for line in told if told.count(line) > 1}) == []
    assert len(lines) < 260, "one line for what a user notices"


def test_a_release_has_a_date() -> None:
    """That of the changelog, in the citation as well; before a release there is none."""
    head = next(line for line in (ROOT / "CHANGELOG.md").read_text().splitlines() if line.startswith("## "))
    told = re.fullmatch(r"## \S+ \((unreleased|\d{4}-\d\d-\d\d)\)", head)
    assert told is not None, "write (unreleased), or the date such as (2026-12-24)"
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text()).get("date-released")
    assert (str(cited) if cited else "unreleased") == told[1]


@pytest.mark.parametrize("forgotten", ["", "tag", "changelog", "citation"])
def test_nothing_is_released_without_version_and_date(tmp_path: Path, forgotten: str) -> None:
    version, day = project()["version"], "2031-02-03"
    for name in ("pyproject.toml", "CHANGELOG.md", "CITATION.cff"):
        (tmp_path / name).write_text((ROOT / name).read_text())
    lines = (ROOT / "CHANGELOG.md").read_text().splitlines()
    head = next(line for line in lines if line.startswith("## "))
    if forgotten != "changelog":
        lines[lines.index(head)] = f"## {version} ({day})"
    else:
        lines[lines.index(head)] = f"## {version} (unreleased)"
    (tmp_path / "CHANGELOG.md").write_text("\n".join(lines))
    with (tmp_path / "CITATION.cff").open("a") as citation:
        citation.write("" if forgotten == "citation" else f"date-released: {day}\n")
    steps = yaml.safe_load((WORKFLOWS / "release.yml").read_text())["jobs"]["version"]["steps"]
    tag = "v9.9.9" if forgotten == "tag" else f"v{version}"
    done = [
        subprocess.run(
            ["bash", "-e", "-c", step["run"]], cwd=tmp_path, env={"GITHUB_REF_NAME": tag, "PATH": PATH}
        )
        for step in steps
        if "run" in step
    ]
    assert all(process.returncode == 0 for process in done) == (not forgotten)


def test_links_of_the_readme_lead_somewhere_from_the_package_index() -> None:
    text = (ROOT / "README.md").read_text()
    hook = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["hatch"]["metadata"]["hooks"]
    relative = r"\]\((?!https?:|#)(\S+?)\)"
    assert all((ROOT / link).exists() for link in re.findall(relative, text))
    for rule in hook["fancy-pypi-readme"]["substitutions"]:
        text = re.sub(rule["pattern"], rule["replacement"], text)
    assert re.findall(relative, text) == []
    assert "raw/v$HFPR_VERSION/docs/pictures/crane.png" in text
    assert "blob/v$HFPR_VERSION/docs/index.rst" in text


def test_warnings_are_errors_for_developers_alone() -> None:
    """Another compiler has others: GCC 13 stopped installing from source where 12 and 14 say nothing."""
    assert "-Werror" not in (ROOT / "CMakeLists.txt").read_text()
    assert "CMAKE_COMPILE_WARNING_AS_ERROR" not in (ROOT / "pyproject.toml").read_text()
    for file in ("Makefile", ".ci/run"):
        assert "-DCMAKE_COMPILE_WARNING_AS_ERROR=ON" in (ROOT / file).read_text(), file
