"""Write a page for every public name: signature, docstring, members, and the examples and guides that show it at work.

python docs/make_reference.py
"""

from __future__ import annotations

import inspect
import re
import tomllib
from collections.abc import Iterable
from functools import cache
from importlib import import_module
from pathlib import Path

from make_gallery import HERE, card, indented, write

from visviva.scene.gallery import example_names

REFERENCE = HERE / "reference"
LISTED = HERE / "reference.toml"
EXAMPLES = HERE.parent / "src" / "visviva" / "examples"
GUIDES = ("*.rst", "howto/*.rst", "theory/*.rst")
SHOWN = 3
"""Examples with their pictures on each page: those that need the fewest other names."""

PAGE = """\
{title}
{underline}
.. auto{kind}:: visviva.{name}
{members}
{work}
"""

WORK = """\
.. rubric:: At work

.. grid:: 1 2 3 3
   :gutter: 2

{cards}
"""

INDEX = """\
Reference
=========
Everything is imported from ``visviva``, ``import visviva as vv``; names with a module are found there.

{groups}

.. toctree::
   :hidden:

{pages}
"""

GROUP = """\
{title}
{underline}
{table}

.. toctree::
   :hidden:

{pages}
"""

TABLE = """\
.. list-table::
   :widths: 30 70

{rows}
"""


def make_reference() -> None:
    """Write all pages, those of their subjects, and the index."""
    REFERENCE.mkdir(exist_ok=True)
    groups = tomllib.loads(LISTED.read_text(encoding="utf-8"))
    made = {file(name): page(name, members) for names in groups.values() for name, members in names.items()}
    made |= {subject(title): group(title, names) for title, names in groups.items()}
    tables = [f":doc:`{title} <{subject(title)}>`\n\n{table(names)}" for title, names in groups.items()]
    made["index"] = INDEX.format(groups="\n".join(tables), pages=indented([subject(t) for t in groups]))
    for name, content in made.items():
        write(REFERENCE / f"{name}.rst", content)
    for old in REFERENCE.glob("*.rst"):
        if old.stem not in made:
            old.unlink()


def subject(title: str) -> str:
    """The page of a subject, a name that no class has in capitals."""
    return "subject_" + title.lower().replace(" ", "_")


def file(name: str) -> str:
    """The page of a name; functions may have that of a class but for capitals, which some systems do not tell apart."""
    return name if inspect.isclass(found(name)) else f"function_{name}"


def group(title: str, names: Iterable[str]) -> str:
    """The page of what belongs to a subject."""
    pages = indented([file(name) for name in names])
    return GROUP.format(title=title, underline="=" * len(title), table=table(names), pages=pages)


def table(names: Iterable[str]) -> str:
    """Names and what they are."""
    rows = "\n".join(
        f"   * - :doc:`{short(name)} <{file(name)}>`\n     - {first_line(name)}" for name in names
    )
    return TABLE.format(rows=rows)


def page(name: str, members: list[str]) -> str:
    """The page of a class or function."""
    shown = f"   :members: {', '.join(members)}\n" if members else ""
    return PAGE.format(
        title=short(name),
        underline="=" * len(short(name)),
        kind="class" if inspect.isclass(found(name)) else "function",
        name=name,
        members=shown.replace("members: *", "members:"),
        work=work(short(name)),
    )


def work(name: str) -> str:
    """Examples that use a name, as cards, and guides that mention it."""
    word = re.compile(rf"\b{name}\b")
    examples = [e for e in sorted(example_names(), key=lambda e: len(uses(e))) if name in uses(e)]
    cards = "\n".join(card(example, "../gallery/") for example in examples[:SHOWN])
    texts = [path for pattern in GUIDES for path in sorted(HERE.glob(pattern)) if word.search(text(path))]
    guides = [f":doc:`/{path.relative_to(HERE).with_suffix('')}`" for path in texts]
    told = f"In the text: {', '.join(guides)}.\n" if guides else ""
    return (WORK.format(cards=cards) if examples else "") + "\n" + told


@cache
def text(path: Path) -> str:
    """What a file holds."""
    return path.read_text(encoding="utf-8")


@cache
def uses(example: str) -> frozenset[str]:
    """The public names in the source of an example."""
    return frozenset(re.findall(r"\bvv\.(\w+)", text(EXAMPLES / f"{example}.py")))


def found(name: str) -> object:
    """The object of a name, which may have a module before it."""
    module, _, last = f"visviva.{name}".rpartition(".")
    return getattr(import_module(module), last)


def short(name: str) -> str:
    """A name without its module."""
    return name.rpartition(".")[2]


def first_line(name: str) -> str:
    """What a name is, by the first sentence of its docstring."""
    told = (inspect.getdoc(found(name)) or "").split("\n\n")[0].replace("\n", " ")
    return re.sub(r"(?<!`)`([^`]+)`(?!`)", r"``\1``", told)


if __name__ == "__main__":
    make_reference()
