"""The interactive viewer of a stored motion."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from visviva.base.errors import InputError
from visviva.output import stage
from visviva.output.coloring import Coloring, fluids_of
from visviva.output.picture import trails_until
from visviva.output.standing import Standing
from visviva.output.trajectory import Trajectory
from visviva.output.view import INK, NO_STREAMS, Scene


def show(
    trajectory: str | Path, *, field: str = "", trails: Sequence[str] = (), colors: Sequence[str] = ()
) -> None:
    """Open a window with the motion and a slider for the time; returns when the window is closed.

    Parameters
    ----------
    trajectory
        A ``trajectory.vtkhdf``.
    field
        Quantity that colours the surfaces which have it.
    trails
        Names of the surfaces whose centres leave a trail.
    colors
        One per surface; a palette if not given.

    Raises
    ------
    InputError
        If there is no screen or no OpenGL, or PyVista is not installed.
    """
    if not has_screen():
        raise InputError("there is no screen to show the motion on; write a picture or a movie instead")
    if find_spec("pyvista") and not stage.can_render():  # VTK would end the process
        raise InputError(
            "a window needs OpenGL, which does not work here (Debian: apt install libegl1 libgl1-mesa-dri); a page "
            "in the browser needs none: visviva view without --window"
        )
    with Standing(trajectory) as motion:
        plotter = build_viewer(motion, trails, colors, off_screen=False, field=field)
        plotter.show(title=str(trajectory))


def build_viewer(
    motion: Trajectory, trails: Sequence[str], colors: Sequence[str], off_screen: bool, field: str = ""
) -> Any:
    """Set up the window with its slider."""
    try:
        import pyvista
    except ImportError as error:
        raise InputError("the viewer needs: pip install 'visviva[view]'") from error
    from visviva.output.stage_pyvista import PyVistaStage

    plotter: Any = pyvista.Plotter(off_screen=off_screen, window_size=[1280, 800], lighting="none")
    coloring = Coloring.of(motion, field) if field else None
    scene = Scene(
        motion.surfaces,
        motion.cloud(),
        tuple(colors),
        size=(1280, 800),
        coloring=coloring,
        fluids=fluids_of(motion),
    )
    stage = PyVistaStage(scene, plotter)
    paths = motion.centres(trails)

    def move(time: float) -> None:
        points = motion.points_at(time)
        values = coloring.values(motion, time) if coloring else ()
        streams = coloring.streams(motion, time) if coloring else NO_STREAMS
        stage.place(points, trails_until(motion, paths, time, points), motion.moment(time), values, streams)

    start, end = float(motion.times[0]), float(motion.times[-1])
    move(start)
    if end > start:
        plotter.add_slider_widget(
            callback=move,
            rng=(start, end),
            value=start,
            title=motion.labels.axis("time"),
            pointa=(0.25, 0.08),
            pointb=(0.75, 0.08),
            interaction_event="always",
            style="modern",
            color=INK,
        )
    return plotter


def has_screen() -> bool:
    """Whether windows can be opened."""
    if sys.platform != "linux":
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
