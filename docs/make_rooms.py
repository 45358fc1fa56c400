"""The picture of the rooms of the package, by floors: an import goes to a lower one."""

from __future__ import annotations

import re
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

HERE = Path(__file__).parent
PACKAGE = HERE.parent / "src" / "visviva"
WIDTH, HEIGHT = 1.35, 0.8
BOX = {"boxstyle": "round", "fc": "#e8eef4", "ec": "#5b7083"}


def uses() -> dict[str, set[str]]:
    """The rooms that each room imports from."""
    rooms = {p.name for p in PACKAGE.iterdir() if (p / "__init__.py").exists()} - {
        "examples"
    }  # users of the whole
    found: dict[str, set[str]] = {}
    for room in sorted(rooms):
        text = "\n".join(p.read_text(encoding="utf-8") for p in (PACKAGE / room).rglob("*.py"))
        found[room] = (set(re.findall(r"^\s*from visviva\.(\w+)", text, re.MULTILINE)) & rooms) - {room}
    return found


def floors(found: dict[str, set[str]]) -> list[list[str]]:
    """Rooms by the longest way down from them."""
    left, lower = dict(found), list[list[str]]()
    while left:
        floor = [room for room, below in left.items() if not below & left.keys()]
        lower.append(floor)
        left = {room: below for room, below in left.items() if room not in floor}
    return lower


def make_rooms() -> None:
    """Draw `rooms.svg`."""
    found = uses()
    lower = floors(found)
    at = {
        room: (WIDTH * (k - (len(floor) - 1) / 2), HEIGHT * level)
        for level, floor in enumerate(lower)
        for k, room in enumerate(floor)
    }
    figure, axes = plt.subplots(figsize=(6.5, 0.55 * len(lower) + 0.5))
    for room, below in found.items():
        for other in below:
            (x0, y0), (x1, y1) = at[room], at[other]
            axes.plot([x0, x1], [y0 - 0.2, y1 + 0.2], color="#9fb3c8", lw=0.5, alpha=0.6, zorder=0)
    for room, (x, y) in at.items():
        axes.text(x, y, room, ha="center", va="center", fontsize=8, bbox=BOX)
    wide = max(len(floor) for floor in lower) * WIDTH / 2
    axes.set(xlim=(-wide, wide), ylim=(-0.5, HEIGHT * len(lower) - 0.3))
    axes.axis("off")
    figure.savefig(HERE / "rooms.svg", bbox_inches="tight")
    plt.close(figure)


if __name__ == "__main__":
    make_rooms()
