"""The core is built in rooms: what a room includes lies in itself or below it."""

from __future__ import annotations

import re
from pathlib import Path

CORE = Path(__file__).parent.parent / "cpp" / "visviva"
ROOMS = [
    "base",
    "linear",
    "linear/krylov",
    "linear/reduce",
    "rigid",
    "term",
    "material",
    "strain",
    "point",
    "solid",
    "contact",
    "flow",
    "system",
]


def includes(file: Path) -> list[str]:
    """What a file includes of this project."""
    return re.findall(r'^\s*#\s*include\s*"([^"]+)"', file.read_text(), re.MULTILINE)


def room_of(path: str) -> str:
    """The room of a header as it is included: visviva/ROOM/name.hpp."""
    top, _, rest = path.partition("/")
    assert top == "visviva", path
    return rest.rpartition("/")[0]


def test_includes_of_the_core_go_down() -> None:
    """In the order of rooms; krylov and reduce, which build upon linear solvers, count as rooms above them."""
    files = sorted(file for file in CORE.rglob("*") if file.suffix in {".hpp", ".cpp"})
    assert {file.parent.relative_to(CORE).as_posix() for file in files} == set(ROOMS)
    upwards = [
        f"{file.relative_to(CORE)} includes {header}"
        for file in files
        for header in includes(file)
        if ROOMS.index(room_of(header)) > ROOMS.index(file.parent.relative_to(CORE).as_posix())
    ]
    assert not upwards
