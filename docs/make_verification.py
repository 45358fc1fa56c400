"""Write the page of what is verified: cases from the tests, figures from ``docs/campaign/verified.csv``.

    python docs/make_verification.py

``python -m verified`` in ``tests`` measures the figures.
"""

from __future__ import annotations

import ast
import csv
import re
from collections import defaultdict
from pathlib import Path

from make_gallery import HERE, write

CASES = HERE / "verification_cases.rst"
TESTS = HERE.parent / "tests" / "verification"
FIGURES = HERE / "campaign" / "verified.csv"
PAGE = """\
What is verified against what
=============================
All cases of ``tests/verification``, by file. *Compared* is the text of the test, the figure is what it came to, and
the limit what it has to keep: an error below, an order above, a difference from what is expected relative to the
largest of that. Of cases with several cells, schemes or step sizes the one that comes nearest to its limit is shown,
and of tests that compare more the three nearest. Figures were measured by ``python -m verified`` in ``tests``, on
x86-64 with AVX2; they move with rounding. Tests without figures ask for yes or no, such as a refusal.

{tables}
"""
TABLE = """\
{title}
{underline}
{more}``tests/verification/{file}``

.. list-table::
   :header-rows: 1
   :widths: 40 42 9 9

   * - Case
     - Compared
     - Figure
     - Limit
{rows}
"""


def make_verification() -> None:
    """Write the page."""
    figures = defaultdict(list)
    with FIGURES.open(newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            figures[row["test"]].append((row["check"], row["figure"], row["limit"]))
    tables = [table(path, figures) for path in sorted(TESTS.glob("test_*.py"))]
    write(CASES, PAGE.format(tables="\n".join(tables)))


def table(path: Path, figures: dict[str, list[tuple[str, str, str]]]) -> str:
    """The cases of a file."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    told, _, more = (ast.get_docstring(tree) or path.stem).partition("\n")
    title = escaped(told.rstrip("."))
    tests = [
        node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name.startswith("test_")
    ]
    rows = [row for test in tests for row in case(test, figures.get(f"{path.name}::{test.name}", []))]
    return TABLE.format(
        title=title,
        underline="-" * len(title),
        more=escaped(" ".join(more.split())) + "\n\n" if more.strip() else "",
        file=path.name,
        rows="\n".join(rows),
    )


def case(test: ast.FunctionDef, checks: list[tuple[str, str, str]]) -> list[str]:
    """Rows of a test: what it is about, then what it compares."""
    name = test.name.removeprefix("test_").replace("_", " ")
    told = " ".join((ast.get_docstring(test) or "").split())
    rows = []
    for k, (check, figure, limit) in enumerate(checks or [("", "", "")]):
        what = f"**{name}** {escaped(told)}" if k == 0 else ""
        compared = f"``{check.replace('np.testing.', '')}``" if check else ""
        rows.append(f"   * - {what}\n     - {compared}\n     - {figure}\n     - {limit}")
    return rows


def escaped(text: str) -> str:
    """Text whose marks mean nothing but code."""
    parts = re.split(r"(``[^`]+``)", re.sub(r"(?<!`)`([^`]+)`(?!`)", r"``\1``", text))
    return "".join(part if part.startswith("``") else re.sub(r"([*|_\\])", r"\\\1", part) for part in parts)


if __name__ == "__main__":
    make_verification()
