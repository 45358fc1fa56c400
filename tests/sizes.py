"""How large the house is: files, functions and classes, as a table.

    PYTHONPATH=src:tests python tests/sizes.py

Lines of Python are those without docstrings. Functions of the core are measured by lizard, where that is installed
(`pip install lizard`).
"""

from __future__ import annotations

import ast
import importlib
import inspect
import pkgutil
import statistics
import sys
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

import visviva

PACKAGE = Path(visviva.__file__).parent
CORE = Path(__file__).parent.parent / "cpp"
Sized = list[tuple[int, str]]


def docstring_lines(tree: ast.AST) -> set[int]:
    """Numbers of the lines that docstrings take up."""
    found: set[int] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(node, False):
            found.update(range(node.body[0].lineno, (node.body[0].end_lineno or 0) + 1))
    return found


def python_files(folder: Path = PACKAGE) -> Sized:
    """Lines of each module."""
    texts = {p: p.read_text(encoding="utf-8") for p in folder.rglob("*.py")}
    return [
        (text.count("\n") - len(docstring_lines(ast.parse(text))), path.relative_to(folder).as_posix())
        for path, text in texts.items()
    ]


def python_functions(folder: Path = PACKAGE) -> Sized:
    """Lines of each function, those within it included."""
    found = []
    for path in folder.rglob("*.py"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        doc = docstring_lines(tree)
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef):
                lines = set(range(node.lineno, (node.end_lineno or 0) + 1))
                found.append((len(lines - doc), f"{path.relative_to(folder).as_posix()}: {node.name}"))
    return found


def core_files(folder: Path = CORE) -> Sized:
    """Lines of each file of the core, of its binding, tests and example."""
    return [
        (path.read_text(encoding="utf-8").count("\n"), path.relative_to(folder).as_posix())
        for path in folder.rglob("*.?pp")
    ]


def core_functions(folder: Path = CORE) -> Sized:
    """Lines of each function of the core; nothing without lizard."""
    try:
        lizard = importlib.import_module("lizard")
    except ImportError:
        return []
    files = [str(path) for path in folder.rglob("*.?pp")]
    return [
        (f.nloc, f"{Path(file.filename).relative_to(folder).as_posix()}: {f.name}")
        for file in map(lizard.analyze_file, files)
        for f in file.function_list
    ]


@cache
def class_bodies(module: str) -> dict[str, ast.ClassDef]:
    """Classes of a module by their qualified names."""
    found: dict[str, ast.ClassDef] = {}

    def walk(node: ast.AST, within: str) -> None:
        for child in ast.iter_child_nodes(node):
            name = f"{within}{getattr(child, 'name', '')}"
            if isinstance(child, ast.ClassDef):
                found[name] = child
                walk(child, f"{name}.")
            elif isinstance(child, ast.FunctionDef):
                walk(child, f"{name}.<locals>.")
            else:
                walk(child, within)

    walk(ast.parse(inspect.getsource(sys.modules[module])), "")
    return found


def assigned(cls: type) -> set[str]:
    """Attributes that the methods of a class set on ``self``."""
    body = class_bodies(cls.__module__).get(cls.__qualname__) if owns(cls) else None
    methods = [f for f in body.body if isinstance(f, ast.FunctionDef) and f.args.args] if body else []
    return {
        node.attr
        for method in methods
        for node in ast.walk(method)
        if isinstance(node, ast.Attribute)
        and isinstance(node.ctx, ast.Store)
        and isinstance(node.value, ast.Name)
        and node.value.id == method.args.args[0].arg
    }


def owns(cls: type) -> bool:
    """Whether the source of a class is the house's own."""
    return cls.__module__.startswith(("visviva.", "test_")) and not cls.__module__.startswith("visviva._core")


def stated(cls: type) -> set[str]:
    """Public names that stand in the body of a class: arguments, methods, attributes."""
    annotations = vars(cls).get("__annotations__", {})
    named = annotations if isinstance(annotations, dict) else {}
    return {name for name in {*vars(cls), *named} if not name.startswith("_")}


def defined(cls: type) -> set[str]:
    """Public names in the body of a class, and those that its methods set."""
    return stated(cls) | {name for name in assigned(cls) if not name.startswith("_")}


def whole(cls: type) -> set[str]:
    """All public names that a reader meets on an instance, those of bases among them."""
    return {name for name in dir(cls) if not name.startswith("_")}.union(*map(defined, cls.__mro__))


def added(cls: type) -> set[str]:
    """Those of them that no base of it has."""
    return defined(cls) - {name for base in cls.__mro__[1:] for name in defined(base)}


def classes() -> Iterator[type]:
    """All classes of the package."""
    for module in pkgutil.walk_packages(visviva.__path__, "visviva."):
        if not module.name.endswith(("__main__", "_core")):
            found = importlib.import_module(module.name)
            yield from (
                c for c in vars(found).values() if inspect.isclass(c) and c.__module__ == found.__name__
            )


def widths() -> Sized:
    """Public names that each class adds to those of its bases."""
    return [(len(added(c)), f"{c.__module__.removeprefix('visviva.')}.{c.__name__}") for c in classes()]


def row(what: str, sized: Iterable[tuple[int, str]], shown: int = 5) -> str:
    """Number, sum, median, nine tenths, most; and the largest."""
    largest = sorted(sized, reverse=True)
    if not largest:
        return f"{what:18s} not measured"
    numbers = [n for n, _ in largest]
    tenth = numbers[len(numbers) // 10]
    head = f"{what:18s}{len(numbers):6d}{sum(numbers):8d}{statistics.median(numbers):7g}{tenth:5d}{numbers[0]:5d}"
    return head + "   " + ", ".join(f"{name} {n}" for n, name in largest[:shown])


def main() -> None:
    """Print the table."""
    print(f"{'':18s}{'number':>6s}{'sum':>8s}{'median':>7s}{'9/10':>5s}{'most':>5s}   largest")
    print(row("Python files", python_files()))
    print(row("Python functions", python_functions()))
    print(row("core files", core_files()))
    print(row("core functions", core_functions()))
    print(row("class widths", widths(), 12))


if __name__ == "__main__":
    main()
