"""Write each tutorial as a notebook and run it in a kernel of Jupyter, whose outputs and pictures it and the page show.

    python docs/make_tutorials.py

Lines with ``>>>`` and blocks of Python are the cells, run in the order of the page, in the folder ``docs/tutorials``.
"""

from __future__ import annotations

import doctest
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from make_gallery import HERE, write

FOLDER = HERE / "tutorials"
BLOCK = re.compile(r"^\.\. code-block:: python\n\n((?:   .*\n|\n)+)", flags=re.MULTILINE)
DIRECTIVE = re.compile(r"^\.\. (?:image|grid)::.*\n(?:   .*\n)*|^:download:.*\n", flags=re.MULTILINE)
SPOKEN = (
    (re.compile(r"^(.+)\n=+$", flags=re.MULTILINE), r"# \1"),
    (re.compile(r"^(.+)\n-+$", flags=re.MULTILINE), r"## \1"),
    (re.compile(r":doc:`([^`<]*/)?([^`<]+)`"), r"*\2*"),
    (re.compile(r"``([^`]+)``"), r"`\1`"),
)
"""Marks of the pages and what they are in notebooks."""


def make_tutorials() -> None:
    """Notebooks and pictures of all tutorials."""
    FOLDER.mkdir(exist_ok=True)
    for page in sorted(HERE.glob("tutorial*.rst")):
        write(FOLDER / f"{page.stem}.ipynb", json.dumps(executed(page, FOLDER), indent=1) + "\n")


def executed(page: Path, folder: Path) -> dict[str, Any]:
    """A page as a notebook that has run in a kernel of its own, with a folder for its files.

    Raises
    ------
    nbclient.exceptions.CellExecutionError
        If a cell raises.
    """
    import nbformat
    from nbclient import NotebookClient

    made = nbformat.reads(json.dumps(notebook(page)), as_version=4)
    resources = {"metadata": {"path": str(folder)}}
    NotebookClient(made, timeout=300, kernel_name="python3", resources=resources).execute()
    return json.loads(nbformat.writes(made))


def notebook(page: Path) -> dict[str, Any]:
    """A page as a notebook, format 4.5."""
    made = [cell(f"cell-{k}", kind, source) for k, (kind, source) in enumerate(cells(page))]
    kernel = {"kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"}}
    return {"cells": made, "metadata": kernel, "nbformat": 4, "nbformat_minor": 5}


def cell(name: str, kind: str, source: str) -> dict[str, Any]:
    """A cell of a notebook; code has not run yet."""
    code = {"cell_type": "code", "execution_count": None, "outputs": []}
    own = code if kind == "code" else {"cell_type": "markdown"}
    return {"id": name, "metadata": {}, "source": source.splitlines(keepends=True), **own}


def cells(page: Path) -> Iterator[tuple[str, str]]:
    """Text and code of a page, one after the other."""
    code = ""
    for part in doctest.DocTestParser().parse(page.read_text(encoding="utf-8")):
        if isinstance(part, doctest.Example):
            code += part.source
        elif part.strip():
            if code:
                yield "code", code.rstrip()
            code = ""
            yield from prose(part)
    if code:
        yield "code", code.rstrip()


def prose(text: str) -> Iterator[tuple[str, str]]:
    """What stands between lines that are run: text, and blocks of code."""
    for k, part in enumerate(BLOCK.split(text)):
        if k % 2:
            yield (
                "code",
                "\n".join(line.removeprefix("   ") for line in part.strip("\n").split("\n")).rstrip(),
            )
            continue
        told = DIRECTIVE.sub("", part)
        for mark, instead in SPOKEN:
            told = mark.sub(instead, told)
        if told.strip():
            yield "text", told.strip()


if __name__ == "__main__":
    make_tutorials()
