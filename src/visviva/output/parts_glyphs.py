"""Glyphs in PyVista: meshes that are filled anew for every moment."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.output.glyphs import Glyphs
from visviva.output.parts import LIFT
from visviva.output.view import INK, NEGATIVE, POSITIVE, SHEET, Scene

Array = NDArray[np.float64]


class GlyphParts:
    """Arrows, lines and sheets of a plotter.

    Parameters
    ----------
    plotter
        Of PyVista.
    scene
        What else is drawn.
    fine
        Pixels per line.
    """

    def __init__(self, plotter: Any, scene: Scene, fine: int) -> None:
        self._plotter, self._scene, self._fine = plotter, scene, fine
        self._meshes: dict[str, Any] = {}

    def show(self, glyphs: Glyphs) -> None:
        """Draw these in the place of earlier ones."""
        width = self._fine * self._scene.size[1] / 300
        wide, plain = {"line_width": 2 * width, "lighting": False}, {"lighting": not self._scene.is_flat}
        self._put("arrows", arrows(self._lifted(glyphs.arrows)), color=INK, **plain)
        self._put("positive", lines(self._lifted(glyphs.positive)), color=POSITIVE, **wide)
        self._put("negative", lines(self._lifted(glyphs.negative)), color=NEGATIVE, **wide)
        self._put("sheets", sheets(self._lifted(glyphs.sheets)), color=SHEET, opacity=0.55, lighting=False)
        self._put(
            "outlines", lines(self._lifted(glyphs.outlines)), color=SHEET, line_width=width, lighting=False
        )

    def _lifted(self, points: Array) -> Array:
        """Towards the eye, so that the faces on which they lie do not swallow them."""
        return points + 2 * LIFT * (np.array(self._plotter.camera.position) - points)

    def _put(self, name: str, mesh: Any, **look: Any) -> None:
        if name in self._meshes:
            self._meshes[name].copy_from(mesh)
        elif mesh.n_points:
            self._meshes[name] = mesh
            self._plotter.add_mesh(mesh, render=False, **look)


def arrows(ends: Array) -> Any:
    """Arrows whose thickness goes with their length."""
    import pyvista

    vectors = ends[:, 1] - ends[:, 0]
    there = np.linalg.norm(vectors, axis=1) > 0
    if not there.any():
        return pyvista.PolyData()
    cloud = pyvista.PolyData(ends[there, 0])
    cloud["vectors"] = vectors[there]
    shape = pyvista.Arrow(
        tip_length=0.3, tip_radius=0.1, shaft_radius=0.035, tip_resolution=12, shaft_resolution=8
    )
    found = cloud.glyph(orient="vectors", scale="vectors", geom=shape)
    found.clear_data()
    return found


def lines(ends: Array) -> Any:
    """Lines between pairs of points."""
    import pyvista

    return pyvista.line_segments_from_points(ends.reshape(-1, 3)) if len(ends) else pyvista.PolyData()


def sheets(corners: Array) -> Any:
    """Faces of four corners."""
    import pyvista

    numbers = np.arange(4 * len(corners)).reshape(-1, 4)
    if not len(corners):
        return pyvista.PolyData()
    return pyvista.PolyData(corners.reshape(-1, 3), faces=np.insert(numbers, 0, 4, axis=1).ravel())
