"""What every renderer of a scene offers, and the choice of the renderer that works on this machine."""

from __future__ import annotations

import functools
import hashlib
import os
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from visviva.output.surface import Surface

Points = Sequence[NDArray[np.float64]]
Camera = tuple[Sequence[float], Sequence[float], Sequence[float]]

PALETTE = ("#4c78a8", "#f58518", "#54a24b", "#c9463d", "#72b7b2", "#b279a2", "#e0b93c", "#8c6d5a", "#7f8790")
INK = "#2b3440"
VIEW = (1.0, -1.7, 0.75)  # from where one looks by default, third axis up

PROBE = """
import pyvista
plotter = pyvista.Plotter(off_screen=True, window_size=(16, 16))
plotter.add_mesh(pyvista.Cube())
assert plotter.screenshot(return_img=True).shape == (16, 16, 3)
"""


@dataclass(frozen=True)
class Scene:
    """What is drawn and from where: surfaces, their colours, the box that holds the motion, camera, size.

    Parameters
    ----------
    surfaces
        One per component.
    low, high
        (3,) corners of a box around all positions to be shown, in m.
    colors
        One per surface, any notation of matplotlib; none for a default palette.
    camera
        Position, point looked at and up direction, (3,) each; none to look at the whole box.
    size
        Width and height in pixels, both even.
    """

    surfaces: tuple[Surface, ...]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    colors: tuple[str, ...] = ()
    camera: Camera | None = None
    size: tuple[int, int] = field(default=(1280, 720))

    def color(self, k: int) -> str:
        """Colour of the surface number `k`."""
        return self.colors[k] if self.colors else PALETTE[k % len(PALETTE)]

    @property
    def extent(self) -> float:
        """Diagonal of the box, never zero."""
        return float(np.linalg.norm(self.high - self.low)) or 1.0

    @property
    def ground(self) -> float:
        """Height of the ground, a little below everything."""
        return float(self.low[2]) - 0.005 * self.extent

    def grid(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Coordinates of the lines of the ground grid along the first and the second axis."""
        spacing = _round(self.extent / 12)
        reach = 0.35 * self.extent
        first, last = np.floor((self.low - reach) / spacing), np.ceil((self.high + reach) / spacing)
        return spacing * np.arange(first[0], last[0] + 1), spacing * np.arange(first[1], last[1] + 1)


class Stage(Protocol):
    """Draws a scene at given positions."""

    def place(self, points: Points, trails: Points, label: str) -> None:
        """Move the surfaces, draw the trails ((n, 3) positions passed so far) and write the label."""

    def image(self) -> NDArray[np.uint8]:
        """Render: (height, width, 3)."""

    def close(self) -> None:
        """Free what the renderer holds."""


def open_stage(scene: Scene) -> Stage:
    """Prepare a scene for off-screen pictures: with PyVista where that works, with matplotlib elsewhere."""
    if can_render():
        from visviva.output.stage_pyvista import PyVistaStage

        return PyVistaStage(scene)
    from visviva.output.stage_matplotlib import MatplotlibStage

    return MatplotlibStage(scene)


@functools.cache
def can_render() -> bool:
    """Whether PyVista is installed and renders here without a screen.

    Tried in another process, since VTK ends the process where there is no OpenGL. A success is
    remembered for the machine, the environment and the boot; a failure only for this process.
    """
    note = _note()
    if note.exists():
        return True
    probe = subprocess.run([sys.executable, "-c", PROBE], capture_output=True, timeout=120, check=False)
    if probe.returncode == 0:
        try:
            note.parent.mkdir(parents=True, exist_ok=True)
            note.touch()
        except OSError:
            pass  # a home that cannot be written only costs the next process a second
    return probe.returncode == 0


def _note() -> Path:
    """A file whose existence says that rendering works under these circumstances."""
    boot = Path("/proc/sys/kernel/random/boot_id")
    circumstances = [sys.prefix, sys.version, os.uname().nodename, boot.read_text() if boot.exists() else ""]
    circumstances += [os.environ.get(name, "") for name in ("DISPLAY", "VTK_DEFAULT_OPENGL_WINDOW")]
    key = hashlib.sha256("\n".join(circumstances).encode()).hexdigest()[:16]
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return cache / "visviva" / f"rendering-{key}"


def _round(length: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above `length`."""
    power = 10.0 ** np.floor(np.log10(length))
    return float(power * max(digit for digit in (1, 2, 5) if digit * power <= length * (1 + 1e-9)))
