"""Movies of a stored motion, without a screen."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import suppress
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError, RunError
from visviva.output.coloring import Coloring, fluids_of
from visviva.output.glyphs import MotionGlyphs
from visviva.output.picture import trails_until
from visviva.output.pictures import COLORS, Camera, refuse_size
from visviva.output.safe_files import called, replacing, reporting
from visviva.output.stage import open_stage
from visviva.output.standing import Standing
from visviva.output.trajectory import Trajectory
from visviva.output.view import NO_STREAMS, Scene

Image = NDArray[np.uint8]
STATES = 10.0
"""States of a path that are shown in a second."""


def movie(
    trajectory: str | Path,
    file: str | Path,
    *,
    fps: int = 25,
    speed: float | None = None,
    field: str = "",
    limits: tuple[float, float] | None = None,
    outline: bool = False,
    trails: Sequence[str] = (),
    colors: Sequence[str] = (),
    camera: Camera | str | None = None,
    size: tuple[int, int] = (1280, 720),
    cmap: str = COLORS,
    deform: float = 1.0,
    vectors: str = "",
    diagram: str = "",
    progress: Callable[[int, int], None] | None = None,
) -> None:
    """Turn a stored motion into a movie.

    Parameters
    ----------
    trajectory
        A ``trajectory.vtkhdf``.
    file
        Movie to write: ``*.mp4`` (H.264), or ``*.gif`` which needs no encoder.
    fps
        Frames per second.
    speed
        Seconds of motion per second of movie, by default 1; of a path through limit points, whose clock counts states,
        states per second, by default 10.
    field, limits, outline
        As for `snapshot`.
    trails
        Names of the surfaces whose centres leave a trail.
    colors
        As for `picture`.
    camera, cmap, deform, vectors, diagram
        As for `snapshot`.
    size
        Width and height in pixels, both even.
    progress
        Called with the number of frames done and the number of all.

    Raises
    ------
    InputError
        If a parameter makes no movie, or the encoder for mp4 is not installed.
    RunError
        If the file cannot be written.
    """
    target = called(file, "movies", ".mp4", ".gif")
    if not fps > 0 or not (speed is None or speed > 0):
        raise InputError(f"a movie needs fps > 0 and speed > 0, got {fps} and {speed}")
    refuse_size(size)
    if size[0] % 2 or size[1] % 2:
        raise InputError(f"a movie needs an even width and height, got {size}")
    encode = _encode_gif if target.suffix.lower() == ".gif" else _encode_mp4
    with Standing(trajectory, deform) as motion:
        coloring = Coloring.of(motion, field, limits, cmap) if field else None
        shade = motion.points(0) if outline else None
        looking = (tuple(colors), motion.camera(camera), size, coloring, shade, fluids_of(motion))
        motion_glyphs = MotionGlyphs(motion, vectors, diagram)
        scene = Scene(motion.surfaces, motion_glyphs.cloud(), *looking)
        pace = speed or (STATES if motion.labels.clock == "state" else 1.0)
        times = _frame_times(motion.times, pace / fps)
        frames = _frames(motion, scene, times, trails, motion_glyphs, progress)
        try:
            with reporting(target), replacing(target) as temporary:
                encode(frames, temporary, fps, size)
        finally:
            frames.close()


def _frame_times(times: NDArray[np.float64], interval: float) -> NDArray[np.float64]:
    n_frames = int(np.floor((times[-1] - times[0]) / interval + 1e-9)) + 1
    frames: NDArray[np.float64] = np.minimum(times[0] + interval * np.arange(n_frames), times[-1])
    return frames


def _frames(
    motion: Trajectory,
    scene: Scene,
    times: NDArray[np.float64],
    trails: Sequence[str],
    motion_glyphs: MotionGlyphs,
    progress: Callable[[int, int], None] | None,
) -> Generator[Image]:
    paths = motion.centres(trails)
    stage = open_stage(scene)
    try:
        for k, time in enumerate(times.tolist()):
            points = motion.points_at(time)
            values = scene.coloring.values(motion, time) if scene.coloring else ()
            streams = scene.coloring.streams(motion, time) if scene.coloring else NO_STREAMS
            passed, label = (
                trails_until(motion, paths, time, points),
                motion.moment(time) + motion_glyphs.text,
            )
            stage.place(points, passed, label, values, streams, motion_glyphs.at(time))
            yield stage.image()
            if progress is not None:
                progress(k + 1, len(times))
    finally:
        stage.close()


def _encode_mp4(frames: Iterator[Image], path: Path, fps: int, size: tuple[int, int]) -> None:
    try:
        from imageio_ffmpeg import write_frames  # type: ignore[import-untyped, unused-ignore]
    except ImportError as error:
        raise InputError("an mp4 movie needs: pip install 'visviva[view]'; a *.gif does not") from error
    options = ["-f", "mp4", "-movflags", "+faststart", "-crf", "20", "-preset", "medium"]
    encoder = write_frames(
        str(path),
        size,
        fps=fps,
        codec="libx264",
        quality=None,
        output_params=options,
        ffmpeg_log_level="error",
    )
    encoder.send(None)
    try:
        for frame in frames:
            encoder.send(np.ascontiguousarray(frame))
        encoder.close()
    except OSError as error:
        with suppress(OSError):
            encoder.close()
        raise RunError(
            f"the movie could not be encoded ({str(error).splitlines()[0]}); is the disk full?"
        ) from error


def _encode_gif(frames: Iterator[Image], path: Path, fps: int, size: tuple[int, int]) -> None:
    from PIL import Image as pillow

    first, *others = (pillow.fromarray(frame).quantize(64) for frame in frames)
    first.save(path, format="GIF", save_all=True, append_images=others, duration=round(1000 / fps), loop=0)
