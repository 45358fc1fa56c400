"""Content of a picture, and its camera."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from visviva.output.coloring import Coloring
from visviva.output.pictures import PRESETS, Camera
from visviva.output.surface import Surface

Points = Sequence[NDArray[np.float64]]
Trails = Mapping[int, NDArray[np.float64]]  # positions (n, 3) passed so far, by the number of the surface
Values = Sequence[
    NDArray[np.float64] | None
]  # of a field at the points of every surface; None for plain ones
Streams = Mapping[int, NDArray[np.float64]]  # velocities (n, 3) of fluids, by the number of the surface

NO_STREAMS: Streams = {}
PALETTE = ("#4c78a8", "#f58518", "#54a24b", "#c9463d", "#72b7b2", "#b279a2", "#e0b93c", "#8c6d5a", "#7f8790")
INK = "#2b3440"
POSITIVE, NEGATIVE, SHEET = "#c0392b", "#1f5fa8", "#e67e22"
"""Colours of principal values above and below zero, and of diagrams."""
MARGIN = 1.12  # of the view around what is shown
WIDE = 1.25  # the same of what is flat, which would lie under the label
VIEW = ((1.0, -1.7, 0.75), (0.0, 0.0, 1.0))  # from where one looks by default, and what is up
ABOVE = ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0))  # the same for what lies in the plane of the first two axes


@dataclass(frozen=True)
class Scene:
    """View of a run: surfaces, their colours, the box that holds the motion, camera, size.

    Parameters
    ----------
    surfaces
        One per component.
    cloud
        (n, 3) positions that shall be in view, in m.
    colors
        One per surface, any notation of matplotlib; none for a default palette.
    camera
        Position, point looked at and up direction, (3,) each, or one of `PRESETS`; none to look at the whole cloud.
    size
        Width and height in pixels.
    coloring
        Field by which surfaces are coloured, with its colour bar; none for plain colours.
    fluids
        Numbers of the surfaces that something flows through: in space they are cut open.
    transparent
        No background.
    outline
        Points of every surface at which it is drawn a second time as a shade; none for no shade.
    """

    surfaces: tuple[Surface, ...]
    cloud: NDArray[np.float64]
    colors: tuple[str, ...] = ()
    camera: Camera | str | None = None
    size: tuple[int, int] = (1280, 720)
    coloring: Coloring | None = None
    outline: Points | None = None
    fluids: frozenset[int] = frozenset()
    transparent: bool = False

    def color(self, k: int) -> str:
        """Colour of the surface number `k`; names that differ by a number alone share one."""
        return self.colors[k] if self.colors else PALETTE[self._kinds[k] % len(PALETTE)]

    @cached_property
    def _kinds(self) -> list[int]:
        """Numbers of the surfaces' names without the numbers behind them."""
        stems = [re.sub(r"[\s_.-]*\d+$", "", surface.name) or surface.name for surface in self.surfaces]
        known = {stem: k for k, stem in enumerate(dict.fromkeys(stems))}
        return [known[stem] for stem in stems]

    @property
    def is_flat(self) -> bool:
        """Whether all lies in the plane of the first two axes, and is seen from above, without a floor."""
        return bool(self.camera is None and self.high[2] - self.low[2] < 1e-3 * self.extent)

    @cached_property
    def low(self) -> NDArray[np.float64]:
        """(3,) lowest coordinates in view."""
        lowest: NDArray[np.float64] = self.cloud.min(axis=0)
        return lowest

    @cached_property
    def high(self) -> NDArray[np.float64]:
        """(3,) highest coordinates in view."""
        highest: NDArray[np.float64] = self.cloud.max(axis=0)
        return highest

    @property
    def room(self) -> float:
        """Share of the width that the scene may fill; a colour bar takes the rest, on the right."""
        return 1.0 if self.coloring is None else 0.88

    @property
    def extent(self) -> float:
        """Diagonal of the box around what is in view, never zero."""
        return float(np.linalg.norm(self.high - self.low)) or 1.0

    @property
    def view(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Direction from which one looks if no camera is given, and the direction that is up."""
        if isinstance(self.camera, str):
            return PRESETS[self.camera]
        return ABOVE if self.is_flat else VIEW

    @property
    def ground(self) -> float:
        """Height of the ground, a little below everything."""
        return float(self.low[2]) - 0.005 * self.extent

    def grid(self) -> NDArray[np.float64]:
        """Lines of the ground grid, (n, 2, 3) end points, each line cut into single meshes."""
        spacing = round_length(self.extent / 14)
        reach = self.reach
        middle = spacing * np.round((self.low + self.high)[:2] / 2 / spacing)
        ticks = spacing * np.arange(-np.floor(reach / spacing), np.floor(reach / spacing) + 1)
        across, along = np.meshgrid(ticks, ticks[:-1])
        starts = np.stack([across, along], axis=-1).reshape(-1, 2)
        lines = np.stack([starts, starts + np.array([0.0, spacing])], axis=1)
        both = np.concatenate([lines, lines[..., ::-1]]) + middle
        return np.concatenate([both, np.full((*both.shape[:2], 1), self.ground)], axis=-1)

    @property
    def reach(self) -> float:
        """Distance from the middle to which the ground is drawn."""
        return 0.95 * self.extent

    def fitted_camera(self, opening: float) -> Camera:
        """The camera, or the nearest one in the default direction that sees the whole cloud.

        Parameters
        ----------
        opening
            Angle between the upper and lower edge of the view, in degrees.
        """
        if self.camera is not None and not isinstance(self.camera, str):
            return self.camera
        direction, up = self.view
        back = np.array(direction) / np.linalg.norm(direction)
        right = np.cross(up, back)
        axes = np.array([right / np.linalg.norm(right), np.zeros(3), back])
        axes[1] = np.cross(back, axes[0])
        half = np.tan(np.radians(opening) / 2) / (WIDE if self.is_flat else MARGIN)
        aspect = self.size[0] / self.size[1]
        slopes = half * np.array([self.room * aspect, 1.0])
        middle = (self.low + self.high) / 2
        seen = (self.cloud - middle) @ axes.T
        # in view is |x - m| <= slope (d - z): the outermost points on both sides give m, the worse axis d
        upper = (seen[:, :2] / slopes + seen[:, 2:]).max(axis=0)
        lower = (-seen[:, :2] / slopes + seen[:, 2:]).max(axis=0)
        distance = max(float(((upper + lower) / 2).max()), 0.5 * self.extent)
        aside = (1 - self.room) * distance * np.tan(np.radians(opening) / 2) * aspect * axes[0]
        target = middle + (slopes * (upper - lower) / 2) @ axes[:2] + aside
        return tuple(target + distance * back), tuple(target), up


def round_length(length: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above `length`."""
    power = 10.0 ** np.floor(np.log10(length))
    return float(power * max(digit for digit in (1, 2, 5) if digit * power <= length * (1 + 1e-9)))
