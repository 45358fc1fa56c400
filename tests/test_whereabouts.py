"""Every module has a test file of its name, or a line in ``where.toml`` that says where it is tested."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

import visviva

TESTS = Path(__file__).parent
CORE = TESTS.parent / "cpp"
PACKAGE = Path(visviva.__file__).parent
WHERE: dict[str, dict[str, list[str]]] = tomllib.loads((TESTS / "where.toml").read_text(encoding="utf-8"))


def modules(package: Path) -> set[str]:
    """Modules that have something to test; examples are run by the gallery and by tests of what they show."""
    found = {p.relative_to(package).with_suffix("").as_posix() for p in package.rglob("*.py")}
    return {name for name in found if not name.endswith("__init__") and not name.startswith("examples/")}


def own(name: str) -> list[Path]:
    """Test files of a module's name."""
    return list(TESTS.rglob(f"test_{name.rpartition('/')[2]}.py"))


def untold(package: Path, told: dict[str, list[str]]) -> list[str]:
    """Modules that have neither a test file of their name nor a line."""
    return sorted(name for name in modules(package) - set(told) if not own(name))


def test_every_module_is_tested_somewhere() -> None:
    missing = untold(PACKAGE, WHERE["python"])
    assert not missing, f"name their tests in tests/where.toml: {missing}"


def core_files(core: Path) -> set[str]:
    """Headers and sources of the core without their ending."""
    return {p.relative_to(core).with_suffix("").as_posix() for p in core.rglob("*.?pp")}


def core_test(name: str) -> Path:
    """The test file of a file's room and name."""
    room, _, rest = name.partition("/")
    return CORE / "test" / f"{room}_{rest.rpartition('/')[2]}.cpp"


def test_every_file_of_the_core_is_tested_somewhere() -> None:
    """Each by its own name: what stands for a whole room hides that a new file of it has no test."""
    files = core_files(CORE / "visviva")
    assert len(files) > 180
    missing = sorted(f for f in files - set(WHERE["cpp"]) if not core_test(f).exists())
    assert not missing, f"name their tests in tests/where.toml: {missing}"
    assert sorted(set(WHERE["cpp"]) - files) == [], "lines of tests/where.toml about nothing"
    assert [f for f in WHERE["cpp"] if core_test(f).exists()] == [], "lines that are not needed"


def test_lines_are_about_modules_that_need_one() -> None:
    gone = set(WHERE["python"]) - modules(PACKAGE)
    needless = {name: own(name) for name in WHERE["python"] if own(name)}
    assert not gone
    assert not needless


@pytest.mark.parametrize(("language", "folder"), [("python", TESTS), ("cpp", TESTS.parent)])
def test_the_files_that_are_named_exist_and_test_something(language: str, folder: Path) -> None:
    for name, files in WHERE[language].items():
        assert files, name
        for file in files:
            text = (folder / file).read_text(encoding="utf-8")
            assert "def test_" in text or "TEST_CASE" in text, f"{name}: {file}"


def test_a_module_without_a_line_is_found(tmp_path: Path) -> None:
    (tmp_path / "body").mkdir()
    for name in ("body/shell.py", "body/coupling.py", "body/__init__.py", "examples/arch.py"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("")
    assert untold(tmp_path, {}) == ["body/shell"]
    assert untold(tmp_path, {"body/shell": ["test_mesh.py"]}) == []
