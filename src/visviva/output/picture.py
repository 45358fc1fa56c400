"""Pictures of a system, without a screen."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visviva.base.errors import InputError
from visviva.output.coloring import Coloring, fluids_of
from visviva.output.glyphs import NO_GLYPHS, Glyphs, MotionGlyphs
from visviva.output.pictures import COLORS, Camera, refuse_size
from visviva.output.safe_files import called, replacing, reporting
from visviva.output.stage import open_stage
from visviva.output.standing import Standing
from visviva.output.surface import Surface
from visviva.output.trajectory import Trajectory
from visviva.output.view import NO_STREAMS, Points, Scene, Streams, Trails, Values


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
    _draw(
        Scene(tuple(surfaces), cloud, tuple(colors), camera, size),
        current,
        paths,
        label,
        called(png, "pictures", ".png"),
    )


def snapshot(
    trajectory: str | Path,
    png: str | Path,
    *,
    time: float | Literal["max"] | None = None,
    field: str = "",
    limits: tuple[float, float] | None = None,
    outline: bool = False,
    trails: Sequence[str] = (),
    colors: Sequence[str] = (),
    camera: Camera | str | None = None,
    size: tuple[int, int] = (1600, 1000),
    cmap: str = COLORS,
    deform: float = 1.0,
    transparent: bool = False,
    vectors: str = "",
    diagram: str = "",
) -> None:
    """Draw one moment of a stored motion into a PNG file.

    Parameters
    ----------
    trajectory
        A ``trajectory.vtkhdf``.
    png
        File to write.
    time
        Time of the motion; the end if not given, ``max`` when the field is largest.
    field
        Quantity that colours the surfaces which have it, with a colour bar; of a vector its length.
    limits
        Values at the ends of the colour bar; round ones around those of the whole motion if not given.
    outline
        Draw everything as it was at the start, too, as a shade.
    trails
        Names of the surfaces whose centres leave a trail.
    colors, size
        As for `picture`.
    camera
        Position, point looked at and up direction in the coordinates of the model, or ``front``, ``back``, ``left``,
        ``right``, ``top``, ``bottom``, ``iso``; what is against gravity is up then.
    cmap
        Colour map of matplotlib.
    deform
        Factor of displacements, of what has some.
    transparent
        Without a background.
    vectors
        A field of vectors that is drawn as arrows, such as velocity or heat_flux, or of symmetric tensors, such as
        cauchy, drawn as lines along the principal directions: red in tension, blue in compression.
    diagram
        A force or moment in the sections of beams that is drawn along them: shear_1, shear_2, normal, bending_1,
        bending_2 or torsion; bending moments stand on the side in tension.

    Raises
    ------
    InputError
        If there is no such field, it has too many components to be shown, the time is not in the motion, or the file
        is no ``*.png``.
    """
    refuse_size(size)
    target = called(png, "pictures", ".png")
    with Standing(trajectory, deform) as motion:
        coloring = Coloring.of(motion, field, limits, cmap) if field else None
        moment = chosen_moment(motion, time, coloring)
        motion_glyphs = MotionGlyphs(motion, vectors, diagram, moment)
        scene = Scene(
            motion.surfaces,
            motion_glyphs.cloud(),
            tuple(colors),
            motion.camera(camera),
            size,
            coloring,
            motion.points(0) if outline else None,
            fluids_of(motion),
            transparent,
        )
        points = motion.points_at(moment)
        passed = trails_until(motion, motion.centres(trails), moment, points)
        values = coloring.values(motion, moment) if coloring else ()
        streams = coloring.streams(motion, moment) if coloring else NO_STREAMS
        label = motion.moment(moment) + motion_glyphs.text
        _draw(scene, points, passed, label, target, values, streams, motion_glyphs.at(moment))


def chosen_moment(motion: Trajectory, time: float | str | None, coloring: Coloring | None) -> float:
    """The time to draw: the end, one that is given, or that at which a field is largest."""
    first, last = float(motion.times[0]), float(motion.times[-1])
    if isinstance(time, str):
        if time != "max" or coloring is None:
            raise InputError(f"{motion.path}: time {time!r} is no number; 'max' goes with a field")
        return largest(motion, coloring)
    moment = last if time is None else time
    if not first - 1e-6 * (last - first) <= moment <= last + 1e-6 * (last - first):
        raise InputError(f"{motion.path}: has no time {moment:g}; it goes from {first:g} to {last:g}")
    return moment


def largest(motion: Trajectory, coloring: Coloring) -> float:
    """Time of the frame in which a field is largest."""
    times = [float(motion.times[step]) for step in motion.chosen_steps()]
    peaks = [
        max((float(np.nanmax(v)) for v in coloring.values(motion, t) if v is not None), default=-np.inf)
        for t in times
    ]
    return times[int(np.argmax(peaks))]


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
    glyphs: Glyphs = NO_GLYPHS,
) -> None:
    import matplotlib.image

    stage = open_stage(scene)
    try:
        stage.place(points, trails, label, values, streams, glyphs)
        image = stage.image()
    finally:
        stage.close()
    with reporting(png), replacing(png) as temporary:
        matplotlib.image.imsave(temporary, image, format="png")
