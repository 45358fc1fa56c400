"""Scenes drawn by matplotlib, for machines without OpenGL."""

from __future__ import annotations

import textwrap
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.output.glyphs import NO_GLYPHS, Glyphs
from visviva.output.skin import skin
from visviva.output.view import (
    INK,
    NEGATIVE,
    NO_STREAMS,
    POSITIVE,
    SHEET,
    Points,
    Scene,
    Streams,
    Trails,
    Values,
)

LIGHT = np.array([0.3, -0.5, 0.8]) / np.linalg.norm([0.3, -0.5, 0.8])
DOTS_PER_INCH = 100


class MatplotlibStage:
    """A scene with flatly shaded faces on a ground grid, trails and a label.

    Faces are sorted by depth as matplotlib does it, so parts that interlock may show in a wrong order.
    """

    def __init__(self, scene: Scene) -> None:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.colors import to_rgb
        from matplotlib.figure import Figure

        self.scene = scene
        self._figure = Figure(figsize=(scene.size[0] / DOTS_PER_INCH, scene.size[1] / DOTS_PER_INCH))
        self._canvas: Any = FigureCanvasAgg(self._figure)
        self._figure.set_dpi(DOTS_PER_INCH)
        self._figure.set_facecolor("none" if scene.transparent else "#f4f7fa")
        self._colors = [np.array(to_rgb(scene.color(k))) for k in range(len(scene.surfaces))]
        left, bottom, width, height = _square(scene.size)
        place = (left - (1 - scene.room) / 2, bottom, width, height)
        self._axes: Any = self._figure.add_axes(place, projection="3d", computed_zorder=False)
        self._skins = [skin(surface) for surface in scene.surfaces]
        self._set_up()
        if not scene.is_flat:
            self._ground()
        self._map = self._color_bar()
        if scene.outline is not None:
            self._shade(scene.outline)
        self._drawn: list[Any] = []

    def place(
        self,
        points: Points,
        trails: Trails,
        label: str,
        values: Values = (),
        streams: Streams = NO_STREAMS,
        glyphs: Glyphs = NO_GLYPHS,
    ) -> None:
        for artist in self._drawn:
            artist.remove()
        self._drawn = [
            *self._faces(points, values or (None,) * len(points)),
            *self._lines(points),
            *self._trails(trails),
            *self._glyphs(glyphs),
        ]
        self._drawn.append(self._figure.text(0.02, 0.94, label, color=INK, size=self.scene.size[1] / 50))

    def image(self) -> NDArray[np.uint8]:
        self._canvas.draw()
        drawn = np.asarray(self._canvas.buffer_rgba())
        return drawn.copy() if self.scene.transparent else drawn[..., :3].copy()

    def close(self) -> None:
        self._figure.clear()

    def _set_up(self) -> None:
        axes, scene = self._axes, self.scene
        size = np.maximum(scene.high - scene.low, 0.02 * scene.extent)
        middle = (scene.low + scene.high) / 2
        for limits, m, s in zip((axes.set_xlim, axes.set_ylim, axes.set_zlim), middle, size, strict=True):
            limits(m - s / 2, m + s / 2)
        axes.set_box_aspect(size, zoom=0.95 * scene.room)
        axes.set_axis_off()
        axes.patch.set_visible(False)
        given = scene.camera is not None and not isinstance(scene.camera, str)
        view = np.subtract(*scene.camera[:2]) if given else np.array(scene.view[0])  # type: ignore[index]
        axes.view_init(
            elev=np.degrees(np.arctan2(view[2], np.hypot(view[0], view[1]))),
            azim=np.degrees(np.arctan2(view[1], view[0])) if np.any(view[:2]) else -90.0,
        )

    def _ground(self) -> None:
        from mpl_toolkits.mplot3d.art3d import Line3DCollection  # type: ignore[import-untyped, unused-ignore]

        lines = self.scene.grid()
        middle = (self.scene.low + self.scene.high)[:2] / 2
        away = np.linalg.norm(lines.mean(axis=1)[:, :2] - middle, axis=1) / self.scene.reach
        near = lines[away < 0.7]
        grid = Line3DCollection(
            near, colors="#c3ced8", linewidths=0.8, alpha=1.0 - away[away < 0.7] / 0.7, zorder=0
        )
        self._axes.add_collection3d(grid, autolim=False)

    def _color_bar(self) -> Any:
        """The map from values to colours, beside the picture; None without a field."""
        coloring = self.scene.coloring
        if coloring is None:
            return None
        from matplotlib.cm import ScalarMappable
        from matplotlib.colors import Normalize

        mapping = ScalarMappable(Normalize(coloring.low, coloring.high), coloring.colors)
        size = self.scene.size[1] / 60
        place = self._figure.add_axes((0.9, 0.2, 0.02, 0.6))
        bar = self._figure.colorbar(mapping, cax=place, format=coloring.form, ticks=coloring.ticks)
        bar.ax.tick_params(labelsize=size, colors=INK)
        bar.ax.set_title("\n".join(textwrap.wrap(coloring.title, 16)), size=size, color=INK, pad=12)
        return mapping

    def _shade(self, points: Points) -> None:
        """Everything as it was, hardly to be seen."""
        from mpl_toolkits.mplot3d.art3d import Poly3DCollection

        parts = zip(self._skins, points, strict=True)
        faces = [corners for blocks, p in parts for block in blocks for corners in p[block]]
        if faces:
            look = {"facecolors": "none", "edgecolors": INK, "linewidths": 0.3, "alpha": 0.2}
            self._axes.add_collection3d(Poly3DCollection(faces, zorder=0, **look), autolim=False)

    def _faces(self, points: Points, values: Values) -> list[Any]:
        """All faces in one collection, so that they are sorted among each other."""
        from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped, unused-ignore]

        faces, colors = [], []
        for k, (blocks, current, value) in enumerate(zip(self._skins, points, values, strict=True)):
            for block in blocks:
                corners = current[block]
                faces += list(corners)
                plain = _shades(corners)[:, None] * self._colors[k]
                mean = np.full(len(block), np.nan) if value is None else value[block].mean(axis=1)
                known = np.isfinite(mean)
                plain[known] = self._map.to_rgba(mean[known])[:, :3] if known.any() else 0.0
                colors += list(plain)
        if not faces:
            return []
        collection = Poly3DCollection(
            faces, facecolors=np.clip(colors, 0, 1), edgecolors="none", antialiased=False
        )
        return [self._axes.add_collection3d(collection, autolim=False)]

    def _lines(self, points: Points) -> list[Any]:
        drawn = []
        for k, (surface, current) in enumerate(zip(self.scene.surfaces, points, strict=True)):
            for block in (block for block in surface.cells if block.shape[1] < 3):
                for corners in current[block]:
                    drawn += self._axes.plot(
                        *corners.T, color=self._colors[k], lw=2.5, marker="o", ms=4 / block.shape[1]
                    )
        return drawn

    def _glyphs(self, glyphs: Glyphs) -> list[Any]:
        from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

        drawn: list[Any] = []
        if len(glyphs.arrows):
            start, vector = glyphs.arrows[:, 0], np.diff(glyphs.arrows, axis=1)[:, 0]
            drawn.append(self._axes.quiver(*start.T, *vector.T, color=INK, lw=1.2, zorder=3))
        if len(glyphs.sheets):
            look = {"facecolors": SHEET, "edgecolors": "none", "alpha": 0.55, "zorder": 2}
            drawn.append(self._axes.add_collection3d(Poly3DCollection(glyphs.sheets, **look), autolim=False))
        for ends, color in (
            (glyphs.positive, POSITIVE),
            (glyphs.negative, NEGATIVE),
            (glyphs.outlines, SHEET),
        ):
            if len(ends):
                lines = Line3DCollection(ends, colors=color, linewidths=1.5, zorder=3)
                drawn.append(self._axes.add_collection3d(lines, autolim=False))
        return drawn

    def _trails(self, trails: Trails) -> list[Any]:
        return [
            line
            for k, trail in trails.items()
            for line in self._axes.plot(*trail.T, color=self._colors[k], lw=1.5, alpha=0.7, zorder=1)
        ]


def _square(size: tuple[int, int]) -> tuple[float, float, float, float]:
    """A square that covers the whole figure, since axes in space use the largest square in their room."""
    width, height = max(1.0, size[1] / size[0]), max(1.0, size[0] / size[1])
    return (1 - width) / 2, (1 - height) / 2, width, height


def _shades(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Brightness of plane faces (m, k, 3), 0.55 in the dark and 1.1 towards the light."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    shades: NDArray[np.float64] = 0.55 + 0.55 * np.clip(normals @ LIGHT, 0, 1)
    return shades
