"""List what is verified against what: the first lines of the files in ``tests/verification``.

python docs/make_verification.py
"""

from __future__ import annotations

import ast
from pathlib import Path

from make_gallery import HERE, write

CASES = HERE / "verification_cases.txt"


def make_verification() -> None:
    """Write the list that ``verification.rst`` includes."""
    files = sorted((HERE.parent / "tests" / "verification").glob("test_*.py"))
    write(CASES, "\n".join(f"- ``{file.stem}``: {subject(file)}" for file in files) + "\n")


def subject(file: Path) -> str:
    """What a file of tests is about: the first sentence of its first line."""
    text = ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or ""
    return text.split("\n")[0].replace("`", "``").replace("*", r"\*")


if __name__ == "__main__":
    make_verification()
