"""Pictures of a system, without a screen."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visviva.base.errors import InputError
from visviva.output.coloring import Coloring
from visviva.output.safe_files import replacing, reporting
from visviva.output.stage import open_stage
from visviva.output.surface import Surface
from visviva.output.trajectory import Trajectory
from visviva.output.view import NO_STREAMS, Camera, Points, Scene, Streams, Trails, Values


def picture(
    surfaces: Sequence[Surface],
    png: str | Path,
    *,
    points: Sequence[ArrayLike] | None = None,
    trails: Mapping[int, ArrayLike] | None = None,
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
        Positions (n, 3) that a point has passed, by the number of the surface whose colour they take.
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
    paths = {k: np.asarray(trail, float) for k, trail in (trails or {}).items()}
    cloud = np.concatenate([*current, *paths.values()])
    _draw(Scene(tuple(surfaces), cloud, tuple(colors), camera, size), current, paths, label, Path(png))


def snapshot(
    trajectory: str | Path,
    png: str | Path,
    *,
    time: float | None = None,
    field: str = "",
    limits: tuple[float, float] | None = None,
    outline: bool = False,
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
    field
        Quantity that colours the surfaces which have it, with a colour bar; of a vector its length.
    limits
        Values at the ends of the colour bar; those of the whole motion if not given.
    outline
        Draw everything as it was at the start, too, as a shade.
    trails
        Names of the surfaces whose centres leave a trail.
    colors, camera, size
        As for `picture`.

    Raises
    ------
    InputError
        If there is no such field, it has too many components to be shown, or the time is not in the motion.
    """
    with Trajectory(trajectory) as motion:
        coloring = Coloring.of(motion, field, limits) if field else None
        shade = motion.points(0) if outline else None
        scene = Scene(motion.surfaces, motion.cloud(), tuple(colors), camera, size, coloring, shade)
        first, last = float(motion.times[0]), float(motion.times[-1])
        moment = last if time is None else time
        if not first - 1e-6 * (last - first) <= moment <= last + 1e-6 * (last - first):
            raise InputError(f"{trajectory}: has no time {moment:g}; it goes from {first:g} to {last:g}")
        points = motion.points_at(moment)
        passed = trails_until(motion, motion.centres(trails), moment, points)
        values = coloring.values(motion, moment) if coloring else ()
        streams = coloring.streams(motion, moment) if coloring else NO_STREAMS
        _draw(scene, points, passed, motion.moment(moment), Path(png), values, streams)


def trails_until(
    motion: Trajectory, paths: Mapping[int, NDArray[np.float64]], time: float, points: Points
) -> dict[int, NDArray[np.float64]]:
    """The parts of the paths passed before `time`, ending at the current points."""
    n_passed = int(np.searchsorted(motion.times, time, side="left"))
    return {k: np.vstack([path[:n_passed], points[k].mean(axis=0)]) for k, path in paths.items()}


def _draw(
    scene: Scene,
    points: Points,
    trails: Trails,
    label: str,
    png: Path,
    values: Values = (),
    streams: Streams = NO_STREAMS,
) -> None:
    import matplotlib.image

    stage = open_stage(scene)
    try:
        stage.place(points, trails, label, values, streams)
        image = stage.image()
    finally:
        stage.close()
    with reporting(png), replacing(png) as temporary:
        matplotlib.image.imsave(temporary, image, format="png")
