"""Pictures of a system, without a screen."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visviva.errors import InputError
from visviva.output.files import replacing, reporting
from visviva.output.stage import Camera, Points, Scene, open_stage
from visviva.output.surface import Surface
from visviva.output.trajectory import Trajectory


def picture(
    surfaces: Sequence[Surface],
    png: str | Path,
    *,
    points: Sequence[ArrayLike] | None = None,
    trails: Sequence[ArrayLike] = (),
    label: str = "",
    colors: Sequence[str] = (),
    camera: Camera | None = None,
    size: tuple[int, int] = (1600, 1000),
) -> None:
    """Draw surfaces into a PNG file.

    Parameters
    ----------
    surfaces
        What to draw.
    png
        File to write.
    points
        Current points of every surface, (n, 3) each, in m; the reference points if not given.
    trails
        Positions that marked points have passed, (n, 3) each.
    label
        Text in the corner.
    colors
        One per surface; a palette if not given.
    camera
        Position, point looked at, up direction; if not given the third axis is up and all is in view.
    size
        Width and height in pixels.

    Raises
    ------
    RunError
        If the file cannot be written.
    """
    current = [np.asarray(array, float) for array in points or [surface.points for surface in surfaces]]
    paths = [np.asarray(trail, float) for trail in trails]
    everything = np.concatenate([*current, *paths])
    low, high = everything.min(axis=0), everything.max(axis=0)
    scene = Scene(tuple(surfaces), low, high, tuple(colors), camera, size)
    _draw(scene, current, paths, label, Path(png))


def snapshot(
    trajectory: str | Path,
    png: str | Path,
    *,
    time: float | None = None,
    trails: Sequence[str] = (),
    colors: Sequence[str] = (),
    camera: Camera | None = None,
    size: tuple[int, int] = (1600, 1000),
) -> None:
    """Draw one moment of a stored motion into a PNG file.

    Parameters
    ----------
    trajectory
        A ``trajectory.vtkhdf``.
    png
        File to write.
    time
        In s; the end if not given.
    trails
        Names of the surfaces whose centres leave a trail.
    colors, camera, size
        As for `picture`.
    """
    with Trajectory(trajectory) as motion:
        low, high = motion.bounds()
        scene = Scene(motion.surfaces, low, high, tuple(colors), camera, size)
        moment = float(motion.times[-1]) if time is None else time
        passed = [path[motion.times <= moment] for path in centre_paths(motion, trails)]
        _draw(scene, motion.points_at(moment), passed, time_label(moment), Path(png))


def centre_paths(motion: Trajectory, names: Sequence[str]) -> list[NDArray[np.float64]]:
    """Positions (n_steps, 3) of the mean points of the named surfaces."""
    known = [surface.name for surface in motion.surfaces]
    for name in names:
        if name not in known:
            raise InputError(f"no surface is called {name!r}; there are {', '.join(known)}")
    steps = [motion.points(step) for step in range(len(motion.times))] if names else []
    return [np.array([points[known.index(name)].mean(axis=0) for points in steps]) for name in names]


def time_label(time: float) -> str:
    """How the time is written into a picture."""
    return f"t = {time:.2f} s"


def _draw(scene: Scene, points: Points, trails: Points, label: str, png: Path) -> None:
    import matplotlib.image

    stage = open_stage(scene)
    try:
        stage.place(points, trails, label)
        image = stage.image()
    finally:
        stage.close()
    with reporting(png), replacing(png) as temporary:
        matplotlib.image.imsave(temporary, image, format="png")
