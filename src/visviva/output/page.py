"""A run as one page for the browser that plays it offline: its motion, fields, energies and probes."""

from __future__ import annotations

import base64
import html
import json
import re
import tempfile
import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.output.coloring import first_field
from visviva.output.directory import RunDirectory
from visviva.output.labels import Labels
from visviva.output.manifest import claim
from visviva.output.page_frames import Frames
from visviva.output.pictures import COLORS, Camera
from visviva.output.plot import grouped
from visviva.output.safe_files import called, replacing, reporting
from visviva.output.tables import read_table
from visviva.output.trajectory import Trajectory
from visviva.output.view import INK, PALETTE, Scene

LARGEST = 20_000_000
"""Bytes of a page."""
ROWS = 800
"""Points of a curve at most."""
OPENING = 30.0
"""Degrees between the upper and lower edge of the view."""
HERE = Path(__file__).parent


@dataclass(frozen=True, repr=False)
class Page:
    """A page that notebooks show.

    Attributes
    ----------
    text : str
        As in a file.
    """

    text: str

    def __repr__(self) -> str:
        return f"Page({len(self.text) / 1e6:.1f} MB; save(file) keeps it, open() shows it)"

    def _repr_html_(self) -> str:
        inside = html.escape(self.text, quote=True)
        return f'<iframe srcdoc="{inside}" style="width: 100%; height: 620px; border: 0"></iframe>'

    def save(self, file: str | Path) -> Path:
        """Write the page; returns the file."""
        target = called(file, "pages", ".html", ".htm")
        with reporting(target), replacing(target) as temporary:
            temporary.write_text(self.text, encoding="utf-8")
        return target

    def open(self) -> None:
        """Show it in the browser."""
        import webbrowser

        with tempfile.NamedTemporaryFile("w", suffix=".html", delete=False, encoding="utf-8") as file:
            file.write(self.text)
        webbrowser.open(Path(file.name).as_uri())


def write_page(
    directory: str | Path,
    file: str | Path | None = None,
    *,
    largest: int = LARGEST,
    progress: Callable[[int, int], None] | None = None,
) -> Path:
    """Write a run as one self-contained page, ``motion.html`` in its directory if no file is given.

    Frames are thinned evenly, as far as that is needed, and numbers rounded to 16 bits. Nothing is fetched
    by the page: its script and data stand in it.

    Parameters
    ----------
    directory
        Of a run.
    file
        To write.
    largest
        Bytes it may have.
    progress
        Called with the number of frames done and of all.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        If there is no run or no motion in the directory, or one frame alone is larger.
    """
    files = RunDirectory.open(directory)
    target = called(files.page if file is None else file, "pages", ".html", ".htm")
    with Trajectory(files.trajectory) as motion:
        frames = Frames(motion)
        rest = about(frames, files)
        room = largest - len(compose(rest, []))
        steps, packed = fitting(frames, room, progress)
        rest["times"] = motion.times[steps].tolist()
        text = compose(rest, packed)
    if file is None:
        claim(files, target)
    return Page(text).save(target)


def fitting(
    frames: Frames, room: int, progress: Callable[[int, int], None] | None = None
) -> tuple[list[int], list[str]]:
    """As many frames as there is room for, evenly spread: their steps, and each packed."""
    n = len(frames.motion.times)
    steps = list(range(n))
    done: dict[int, str] = {}
    while True:
        for k, step in enumerate(steps):
            if step not in done:
                done[step] = packed(frames.frame(step))
            if progress is not None:
                progress(k + 1, len(steps))
            mean = sum(map(len, done.values())) / len(done) + 8
            if k >= min(10, len(steps) - 1) and mean * len(steps) > room:
                break
        size = sum(len(done[step]) + 8 for step in steps if step in done)
        if size <= room and all(step in done for step in steps):
            return steps, [done[step] for step in steps]
        if len(steps) == 1:
            raise InputError(
                f"{frames.motion.path}: one frame takes {size / 1e6:.1f} MB of the {room / 1e6:.1f} MB that are "
                "free in a page; allow more, or look at the run with visviva view"
            )
        fits = max(min(int(room / mean), len(steps) - 1), 1)
        steps = frames.motion.chosen_steps(fits) if fits > 1 else [n - 1]


def about(frames: Frames, files: RunDirectory) -> dict[str, Any]:
    """All that a page knows but the frames."""
    motion = frames.motion
    labels = files.read_labels() if files.labels.exists() else motion.labels
    layout = frames.layout()
    arrays = {name: coded(layout.pop(name)) for name in ("corners", "triangles", "edges", "mesh", "dots")}
    arrays["map"] = coded(color_map())
    for k, part in enumerate(layout["parts"]):
        part["color"] = PALETTE[k % len(PALETTE)]
    return {
        "title": labels.title or files.path.resolve().name,
        "clock": labels.axis("time"),
        "ink": INK,
        "palette": PALETTE,
        "first": first_field(frames.fields),
        **layout,
        "arrays": arrays,
        "opening": OPENING,
        **changing(frames, files, labels),
    }


def changing(frames: Frames, files: RunDirectory, labels: Labels) -> dict[str, Any]:
    """Present state of a run, for a page that follows it."""
    motion = frames.motion
    scene = Scene(motion.surfaces, motion.cloud(), size=(1000, 700))
    eye, target, up = centred(scene.fitted_camera(OPENING), scene.cloud)
    fields = [{"name": n, "label": motion.labels.field(n), "range": frames.range(n)} for n in frames.fields]
    return {
        "times": motion.times.tolist(),
        "camera": {"eye": eye, "target": target, "up": up, "extent": scene.extent},
        "fields": fields,
        "plots": plots(files, labels, motion),
    }


def centred(camera: Camera, cloud: NDArray[np.float64]) -> tuple[list[float], list[float], list[float]]:
    """A camera moved up or down until as much room is left above as below."""
    eye, target, up = (np.array(vector, dtype=float) for vector in camera)
    back = (eye - target) / np.linalg.norm(eye - target)
    right = np.cross(up, back)
    upward = np.cross(back, right / np.linalg.norm(right))
    for _ in range(5):
        heights = (cloud - eye) @ upward / ((eye - cloud) @ back)
        by = float(heights.max() + heights.min()) / 2 * np.linalg.norm(eye - target) * upward
        eye, target = eye + by, target + by
    return eye.tolist(), target.tolist(), up.tolist()


def plots(files: RunDirectory, labels: Labels, motion: Trajectory) -> list[dict[str, Any]]:
    """Curves to draw beside: energies, then every probe; ``places`` are where they are drawn, not always the times."""
    found = []
    frames = motion.times if labels.clock == "state" else None
    if files.ledger.exists():
        ledger = read_table(files.ledger)
        names = [n for n in ledger if n in ("kinetic", "total") or n.startswith("potential")]
        found.append(_plot(labels.axis("energy"), ledger, frames, {n: n.replace("_", " ") for n in names}))
    if files.probes.exists():
        probes = read_table(files.probes)
        for stem, columns in grouped(n for n in probes if n != "time").items():
            unit = labels.columns.get(columns[0], "")
            title = f"{stem} [{unit}]" if unit else stem
            found.append(
                _plot(title, probes, frames, {n: n.removeprefix(stem).lstrip("_") or stem for n in columns})
            )
    return found


def _plot(
    title: str,
    table: Mapping[str, NDArray[np.float64]],
    frames: NDArray[np.float64] | None,
    shown: Mapping[str, str],
) -> dict[str, Any]:
    """Curves of columns; with times of `frames` that count states, rows do so too, and load parameters are places."""
    rows = np.unique(np.linspace(0, max(len(table["time"]) - 1, 0), ROWS).round().astype(int))
    rows = rows[: len(table["time"])]
    curves = [{"name": name, "values": _plain(table[column][rows])} for column, name in shown.items()]
    places = table["time"]
    times = places if frames is None else _counted(len(places), frames)
    return {"title": title, "times": _plain(times[rows]), "places": _plain(places[rows]), "curves": curves}


def _counted(n: int, frames: NDArray[np.float64]) -> NDArray[np.float64]:
    """Numbers of the states of `n` rows: those of the frames, or of every so many states and the last one."""
    if len(frames) == n or not len(frames):
        return np.resize(frames, n)
    counted: NDArray[np.float64] = np.arange(n) * np.ceil(frames[-1] / max(n - 1, 1))
    return np.asarray(np.minimum(counted, frames[-1]))


def _plain(values: NDArray[np.float64]) -> list[float | None]:
    """Numbers that JSON knows, six digits of them."""
    return [float(f"{value:.6g}") if np.isfinite(value) else None for value in values]


def color_map() -> NDArray[np.uint8]:
    """Colours (256, 3) of fields."""
    from matplotlib import colormaps

    colors: NDArray[np.uint8] = colormaps[COLORS](np.arange(256), bytes=True)[:, :3]
    return colors


def packed(data: bytes) -> str:
    """Bytes squeezed and written as text."""
    return base64.b64encode(zlib.compress(data, 6)).decode()


def coded(array: NDArray[Any]) -> str:
    """An array's bytes, squeezed and written as text."""
    return packed(np.ascontiguousarray(array).tobytes())


def compose(rest: Mapping[str, Any], frames: list[str], token: str = "") -> str:
    """The text of a page; with a token it asks who serves it for its frames."""
    pieces = {
        "TITLE": html.escape(str(rest["title"])),
        "STYLE": (HERE / "page.css").read_text(encoding="utf-8"),
        "SCRIPT": "\n".join(
            (HERE / name).read_text(encoding="utf-8") for name in ("page_drawing.js", "page.js")
        ),
        "ABOUT": embedded({**rest, "token": token}),
        "FRAMES": "\n".join(frames),
    }
    text = (HERE / "page.html").read_text(encoding="utf-8")
    return re.sub("@([A-Z]+)@", lambda place: pieces[place[1]], text)  # in one go: pieces are not read again


def embedded(data: Mapping[str, Any]) -> str:
    """JSON that may stand in a page: nothing in it ends the script that holds it."""
    return json.dumps(data, allow_nan=False).replace("<", "\\u003c")
