"""Rooms of the package: imports go down between them, no modules import each other in circles, names stand once."""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Iterator
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

import visviva

ROOT = Path(visviva.__file__).parent
ROOMS = (
    "base",  # errors, arguments, functions of time
    "mesh",
    "output",
    "model",  # fields and terms
    "scheme",
    "component",  # what the user names, and points to attach to
    "linear",
    "material",
    "body",
    "joint",
    "load",
    "contact",
    "flow",
    "thermal",
    "phase",  # phase fields
    "system",
    "measure",
    "user",
    "results",
    "analysis",
    "study",
    "examples",
    "scene",
)
"""From the lowest floor to the highest."""
FLAT = {"", "__main__", "cli", "cli_options", "cli_shown"}

Import = tuple[str, str]
"""The module, and 'executed', 'late' or 'typing'."""


def modules() -> dict[str, Path]:
    found = {}
    for path in ROOT.rglob("*.py"):
        name = ".".join(path.relative_to(ROOT).with_suffix("").parts)
        found[name.removesuffix("__init__").removesuffix(".") if name != "__init__" else ""] = path
    return found


MODULES = modules()


def public() -> dict[str, str]:
    """The module of every name that the package exports."""
    lines = ast.parse((ROOT / "__init__.pyi").read_text()).body
    froms = [line for line in lines if isinstance(line, ast.ImportFrom) and line.level == 1]
    return {alias.asname or alias.name: line.module or alias.name for line in froms for alias in line.names}


PUBLIC = public()


def imports(node: ast.AST, when: str = "executed") -> Iterator[Import]:
    """Modules of the package that a tree of code imports, and when."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.ImportFrom | ast.Import):
            found = whole(child) if isinstance(child, ast.Import) else named(child)
            yield from ((name, when) for name in found)
        elif (name := of_package(child)) is not None:
            yield name, when
        elif isinstance(child, ast.If) and "TYPE_CHECKING" in ast.unparse(child.test):
            yield from imports(child, "typing")
        elif isinstance(child, ast.FunctionDef) and when == "executed":
            yield from imports(child, "late")
        else:
            yield from imports(child, when)


def named(line: ast.ImportFrom) -> Iterator[str]:
    """The modules that ``from ... import ...`` names, those of exported names among them."""
    assert line.level == 0
    package, _, below = (line.module or "").partition(".")
    if package != "visviva":
        return
    for alias in line.names:
        assert alias.name != "*", "a star hides what is imported"
        module = f"{below}.{alias.name}".removeprefix(".")
        name = module if module in MODULES else below or PUBLIC.get(alias.name, "")
        if name in MODULES and name:
            yield name


def whole(line: ast.Import) -> Iterator[str]:
    """The modules that ``import ...`` names; the package itself and its compiled part are none."""
    for alias in line.names:
        package, _, below = alias.name.partition(".")
        if package == "visviva" and below and below in MODULES:
            yield below


def of_package(node: ast.AST) -> str | None:
    """The module of an exported name that is read from the package, as in ``visviva.Solid`` and ``vv.Solid``."""
    if not isinstance(node, ast.Attribute) or not isinstance(node.value, ast.Name):
        return None
    return PUBLIC.get(node.attr) if node.value.id in ("visviva", "vv") else None


@cache
def arrows() -> list[tuple[str, str, str]]:
    """Which module imports which, and when."""
    return [(a, b, when) for a, path in MODULES.items() for b, when in imports(ast.parse(path.read_text()))]


def room(module: str) -> str:
    return "" if module in FLAT else module.partition(".")[0]


def test_every_module_is_in_a_room_and_few_are_flat() -> None:
    assert {room(m) for m in MODULES} <= {*ROOMS, ""}
    assert len(arrows()) > 500
    assert {m for m in MODULES if "." not in m and m not in ROOMS} == FLAT


def test_imports_go_down() -> None:
    """Executed ones, late ones and those for annotations."""
    floor = {name: k for k, name in enumerate((*ROOMS, ""))}
    up = [f"{a} -> {b} ({when})" for a, b, when in arrows() if floor[room(b)] > floor[room(a)]]
    assert up == []


def test_no_circles_at_run_time() -> None:
    graph: dict[str, set[str]] = {m: set() for m in MODULES}
    for a, b, when in arrows():
        if when != "typing" and a:
            graph[a].add(b)
    TopologicalSorter(graph).prepare()  # raises CycleError


def test_names_stand_once() -> None:
    """A newcomer who reads a file's name knows which; a room's namesake holds its main class."""
    files = Counter(m.rpartition(".")[2] for m in MODULES if "." in m)
    assert [name for name, times in files.items() if times > 1] == []


@pytest.mark.parametrize(
    ("code", "found"),
    [
        ("from visviva.system.system import System", [("system.system", "executed")]),
        ("def f():\n    from visviva.body import solid", [("body.solid", "late")]),
        ("if TYPE_CHECKING:\n    from visviva.body.solid import Solid", [("body.solid", "typing")]),
        ("from visviva import _core\nimport numpy", []),
        ("import visviva.system.system", [("system.system", "executed")]),
        ("def f():\n    import visviva.body.solid as s", [("body.solid", "late")]),
        ("from visviva import Solid, _core, body", [("body.solid", "executed"), ("body", "executed")]),
        ("import visviva\nvisviva.Solid, visviva.__version__", [("body.solid", "executed")]),
        ("def f():\n    return vv.System([])", [("system.system", "late")]),
    ],
)
def test_the_reader_of_imports(code: str, found: list[Import]) -> None:
    assert list(imports(ast.parse(code))) == found
