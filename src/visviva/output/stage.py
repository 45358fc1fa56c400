"""Interface of the renderers of a scene, and the choice of one that works on this machine."""

from __future__ import annotations

import functools
import hashlib
import os
import platform
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from visviva.output.glyphs import NO_GLYPHS, Glyphs
from visviva.output.view import NO_STREAMS, Points, Scene, Streams, Trails, Values

PROBE = """
import pyvista
plotter = pyvista.Plotter(off_screen=True, window_size=(16, 16))
plotter.add_mesh(pyvista.Cube())
assert plotter.screenshot(return_img=True).shape == (16, 16, 3)
"""


class Stage(Protocol):
    """Draws a scene at given positions."""

    def place(
        self,
        points: Points,
        trails: Trails,
        label: str,
        values: Values = (),
        streams: Streams = NO_STREAMS,
        glyphs: Glyphs = NO_GLYPHS,
    ) -> None:
        """Move the surfaces, draw trails and glyphs and write the label; colour surfaces by values of the field."""

    def image(self) -> NDArray[np.uint8]:
        """Render: (height, width, 3)."""

    def close(self) -> None:
        """Free what the renderer holds."""


def open_stage(scene: Scene) -> Stage:
    """Prepare a scene for off-screen pictures: with PyVista where that works, with matplotlib elsewhere."""
    if can_render():
        with suppress(ImportError):  # one that was there when rendering was tried, and is not now
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
    circumstances = [sys.prefix, sys.version, platform.node(), boot.read_text() if boot.exists() else ""]
    circumstances += [os.environ.get(name, "") for name in ("DISPLAY", "VTK_DEFAULT_OPENGL_WINDOW")]
    key = hashlib.sha256("\n".join(circumstances).encode()).hexdigest()[:16]
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return cache / "visviva" / f"rendering-{key}"
