"""Surfaces coloured by a stored field."""

from __future__ import annotations

from collections.abc import Container
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.output.pictures import COLORS, refuse_unknown_colors
from visviva.output.trajectory import Trajectory

STREAMED = "velocity", "temperature"
"""Fields that are drawn with streamlines."""
FIRST = ("damage", "concentration", "order", "von_mises", "temperature")
"""Fields that colour unless others are chosen, in this order."""


def first_field(fields: Container[str]) -> str:
    """The field that colours until another one is chosen; empty if there is none to choose."""
    return next((name for name in FIRST if name in fields), "")


@dataclass(frozen=True)
class Coloring:
    """A field with the range of values that the colours span, the same for a whole motion."""

    name: str
    low: float
    high: float
    title: str = ""
    colors: str = COLORS

    @property
    def ticks(self) -> NDArray[np.float64]:
        """Round values (n,) between the ends, these included where they are round."""
        from matplotlib.ticker import MaxNLocator

        values = np.array(MaxNLocator(nbins=7, steps=[1, 2, 2.5, 5, 10]).tick_values(self.low, self.high))
        reach = 1e-6 * (self.high - self.low)
        return values[(values >= self.low - reach) & (values <= self.high + reach)]

    @property
    def form(self) -> str:
        """Format of ticks: three digits, or as many as tell them apart; four where these spare an exponent.

        Examples
        --------
        >>> Coloring("temperature", 270, 320).form, Coloring("temperature", 293.15, 293.16).form
        ('%.3g', '%.6g')
        >>> Coloring("von_mises", 0, 1000).form
        '%.4g'
        """
        ticks, near = self.ticks, 0.01 * (self.high - self.low)
        exact = (n for n in range(3, 15) if all(abs(float(f"{v:.{n}g}") - v) <= near for v in ticks))
        digits = next(exact, 15)
        return f"%.{max(digits, 4) if 1000 <= np.abs(ticks).max() < 10000 else digits}g"

    @classmethod
    def of(
        cls,
        motion: Trajectory,
        name: str,
        limits: tuple[float, float] | None = None,
        colors: str = COLORS,
    ) -> Coloring:
        """A field of a motion.

        Parameters
        ----------
        motion
            What holds the field.
        name
            A scalar, or a vector (3,) whose length is shown.
        limits
            Values at the ends of the colour bar; if not given, round ones around those of the motion.
        colors
            A colour map of matplotlib.

        Raises
        ------
        InputError
            If there is no such field, it is a tensor, or the limits are not in order.
        """
        scalars = ", ".join(known for known, width in motion.fields.items() if width in (1, 3))
        if motion.fields.get(name, 1) not in (1, 3):
            raise InputError(
                f"{motion.path}: {name} has too many components to be shown; choose of {scalars}"
            )
        low, high = rounded(*_range(motion, name)) if limits is None else limits
        refuse_unknown_colors(colors)
        if not low <= high:
            raise InputError(f"{motion.path}: colours of {name} cannot span {low} to {high}")
        title = motion.labels.field(name, size_of=motion.fields[name] == 3)
        return cls(name, low, high if high > low else low + (abs(low) or 1.0) * 1e-9, title, colors)

    def values(self, motion: Trajectory, time: float) -> list[NDArray[np.float64] | None]:
        """Values (n,) on every surface at a time; None where a surface has none, or swims in what flows."""
        scalars = [_scalar(part) for part in motion.field_at(self.name, time)]
        streams = self.streams(motion, time)
        return [
            None if np.isnan(part).all() or (streams and k not in streams) else part
            for k, part in enumerate(scalars)
        ]

    def streams(self, motion: Trajectory, time: float) -> dict[int, NDArray[np.float64]]:
        """Velocities (n, 3), by the number of the surface, of what flows through a mesh that stands still."""
        if self.name not in STREAMED or "velocity" not in motion.fields or len(motion.times) < 2:
            return {}
        moved = motion.field("displacement", len(motion.times) - 1)
        velocities = enumerate(motion.field_at("velocity", time))
        return {k: v for k, v in velocities if not np.isnan(v).any() and not moved[k].any()}


def rounded(low: float, high: float) -> tuple[float, float]:
    """Round ends around a range.

    Examples
    --------
    >>> rounded(0.013, 87.3)
    (0.0, 100.0)
    """
    from matplotlib.ticker import MaxNLocator

    if not high > low:
        return low, high
    ticks = MaxNLocator(nbins=7, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high)
    return float(ticks[0]), float(ticks[-1])


def fluids_of(motion: Trajectory) -> frozenset[int]:
    """Numbers of the surfaces that something flows through, while their meshes stand still."""
    if (
        not {"velocity", "displacement"} <= set(motion.fields) or len(motion.times) < 2
    ):  # nothing has moved yet
        return frozenset()
    last = len(motion.times) - 1
    parts = zip(motion.field("displacement", last), motion.field("velocity", last), strict=True)
    return frozenset(
        k
        for k, (u, v) in enumerate(parts)
        if not np.isnan(v).any() and not np.nan_to_num(u).any() and v.any()
    )


def _scalar(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return values if values.ndim == 1 else np.asarray(np.linalg.norm(values, axis=1))


def _range(motion: Trajectory, name: str) -> tuple[float, float]:
    found = [_scalar(part) for step in motion.chosen_steps() for part in motion.field(name, step)]
    together = np.concatenate(found)
    together = together[np.isfinite(together)]
    if not len(together):
        return 0.0, 1.0
    low, high = float(together.min()), float(together.max())
    return (0.0 if abs(low) < 1e-9 * abs(high) else low), high  # a bar does not begin with what rounding left
