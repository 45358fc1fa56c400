"""Moments of a motion as bytes for a page in the browser: positions and fields of what is drawn, 16 bits a number."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.output.page_shapes import shape_of
from visviva.output.trajectory import Trajectory

Array = NDArray[np.float64]
STEPS = 65534
"""Numbers are rounded to this part of the range of a moment; one more stands where there is none."""
SCALARS, VECTORS = 1, 3
"""Components of fields that colour; of vectors their lengths do."""


class Frames:
    """The moments of a motion, and what is the same in all of them.

    Parameters
    ----------
    motion : Trajectory
        A later reading of the same run may take its place.
    """

    def __init__(self, motion: Trajectory) -> None:
        self.motion = motion
        self.fields = [name for name, width in motion.fields.items() if width in (SCALARS, VECTORS)]
        self._ranges: dict[tuple[str, int], tuple[float, float]] = {}

    @cached_property
    def _shapes(self) -> list[Any]:
        return [shape_of(surface) for surface in self.motion.surfaces]

    @cached_property
    def _used(self) -> list[NDArray[np.int64]]:
        return [shape.used for shape in self._shapes]

    def layout(self) -> dict[str, Any]:
        """Arrays of what is drawn, over the points of all parts, and where in them each part stands."""
        arrays: dict[str, list[NDArray[np.int64]]] = {
            name: [] for name in ("corners", "triangles", "edges", "mesh", "dots")
        }
        counts = dict.fromkeys((*arrays, "points"), 0)
        parts = []
        for surface, shape, used in zip(self.motion.surfaces, self._shapes, self._used, strict=True):
            place = np.zeros(len(surface.points), dtype=np.int64)
            place[used] = counts["points"] + np.arange(len(used))
            new = {name: place[getattr(shape, name)] for name in ("corners", "edges", "mesh", "dots")}
            new["triangles"] = shape.triangles + counts["corners"]
            sizes = {name: len(array) for name, array in new.items()} | {"points": len(used)}
            parts.append({"name": surface.name} | {n: [counts[n], size] for n, size in sizes.items()})
            for name, array in new.items():
                arrays[name].append(array)
            counts = {name: counts[name] + sizes[name] for name in counts}
        return {"parts": parts, "points": counts["points"]} | {
            name: np.concatenate(found).astype("<u4") for name, found in arrays.items()
        }

    def positions(self, step: int) -> Array:
        """Points (n, 3) that are drawn."""
        return self._picked(self.motion.points(step))

    def values(self, field: str, step: int) -> Array:
        """A field (n,) at the points that are drawn, NaN where there is none."""
        values = self._picked(self.motion.field(field, step))
        return values if values.ndim == 1 else np.asarray(np.linalg.norm(values, axis=1))

    def frame(self, step: int) -> bytes:
        """A moment: positions and all fields."""
        arrays = [self.positions(step), *(self.values(name, step) for name in self.fields)]
        return b"".join(map(quantised, arrays))

    def range(self, field: str) -> tuple[float, float]:
        """The least and greatest value of a field in a hundred moments."""
        ends = np.array([self._range_at(field, step) for step in self.motion.chosen_steps()])
        if not np.isfinite(ends).any():
            return 0.0, 1.0
        low, high = float(np.nanmin(ends)), float(np.nanmax(ends))
        low = 0.0 if abs(low) < 1e-9 * abs(high) else low
        return low, high if high > low else low + (abs(low) or 1.0) * 1e-9

    def _range_at(self, field: str, step: int) -> tuple[float, float]:
        key = field, step
        if key not in self._ranges:
            values = self.values(field, step)
            known = values[np.isfinite(values)]
            self._ranges[key] = (known.min(), known.max()) if len(known) else (np.nan, np.nan)
        return self._ranges[key]

    def _picked(self, parts: list[Array]) -> Array:
        return np.concatenate([part[used] for part, used in zip(parts, self._used, strict=True)])


def quantised(values: Array) -> bytes:
    """Numbers of a moment: least and greatest of every component, then 16 bits each, in whole multiples of 8 bytes.

    Examples
    --------
    >>> restored(quantised(np.array([0.0, 0.5, np.nan, 1.0])), 1).round(4).tolist()
    [0.0, 0.5, nan, 1.0]
    """
    rows = values.reshape(len(values), -1)
    finite = np.isfinite(rows)
    low = np.min(rows, axis=0, where=finite, initial=np.inf)
    high = np.max(rows, axis=0, where=finite, initial=-np.inf)
    low, high = np.where(low <= high, [low, high], 0.0)
    scale = np.where(high > low, STEPS / np.where(high > low, high - low, 1.0), 0.0)
    whole = np.where(finite, np.rint((np.where(finite, rows, low) - low) * scale), STEPS + 1)
    body = whole.astype("<u2").T.tobytes()  # component by component, which packs better
    return np.stack([low, high]).astype("<f8").tobytes() + body + bytes(-len(body) % 8)


def restored(data: bytes, width: int) -> Array:
    """Numbers (n, width) of what `quantised` made, with some of what fills it up behind; (n,) of single ones."""
    low, high = np.frombuffer(data, "<f8", 2 * width).reshape(2, width)
    whole = np.frombuffer(data, "<u2", offset=16 * width)
    whole = whole[: len(whole) // width * width].reshape(width, -1).T
    values = np.where(whole > STEPS, np.nan, low + whole * ((high - low) / STEPS))
    return values[:, 0] if width == 1 else values
