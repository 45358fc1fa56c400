"""Scenes drawn by PyVista."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.output.stage import INK, VIEW, Points, Scene
from visviva.output.surface import Surface

SHARP = 35.0  # degrees between neighbouring faces above which an edge is drawn as one
SUN = np.array([-0.35, 0.25, -1.0])  # direction in which shadows fall


class PyVistaStage:
    """A scene with shaded bodies, their shadows on a ground grid, trails and a label.

    Parameters
    ----------
    scene
        What to draw.
    plotter
        A plotter to draw into; none for an off-screen one of its own.
    """

    def __init__(self, scene: Scene, plotter: Any = None) -> None:
        import pyvista

        self.scene = scene
        with _quiet():
            own = pyvista.Plotter(off_screen=True, window_size=list(scene.size), lighting="none")
            self.plotter = own if plotter is None else plotter
            self._light()
            self._ground()
            self._parts = [
                part
                for k, surface in enumerate(scene.surfaces)
                for part in _parts(self.plotter, scene, k, surface)
            ]
            self._trails: list[Any] = []
            self._look()

    def place(self, points: Points, trails: Points, label: str) -> None:
        for part in self._parts:
            part.move(points[part.surface])
        self._draw_trails(trails)
        size = max(10, round(self.scene.size[1] / 45))
        self.plotter.add_text(label, "upper_left", font_size=size, color=INK, name="label", render=False)

    def image(self) -> NDArray[np.uint8]:
        with _quiet():
            picture: NDArray[np.uint8] = self.plotter.screenshot(return_img=True)
        return picture

    def close(self) -> None:
        self.plotter.close()

    def _light(self) -> None:
        import pyvista

        self.plotter.set_background("#fbfcfd", top="#d9e3ec")
        self.plotter.enable_anti_aliasing("ssaa" if self.scene.size[0] <= 1920 else "fxaa")
        for position, intensity in (
            ((-0.6, 1.2, 2.0), 0.75),
            ((2.0, 0.5, 1.0), 0.3),
            ((0.0, -1.0, 0.6), 0.15),
        ):
            self.plotter.add_light(
                pyvista.Light(
                    position=position, focal_point=(0, 0, 0), intensity=intensity, light_type="camera light"
                )
            )

    def _ground(self) -> None:
        import pyvista

        x, y = self.scene.grid()
        z = self.scene.ground
        ends = [((x[0], b, z), (x[-1], b, z)) for b in y] + [((a, y[0], z), (a, y[-1], z)) for a in x]
        lines = pyvista.line_segments_from_points(np.array(ends).reshape(-1, 3))
        self.plotter.add_mesh(lines, color="#b9c5d0", line_width=1, lighting=False, render=False)
        floor = pyvista.PolyData(
            np.array([(x[0], y[0], z), (x[-1], y[0], z), (x[-1], y[-1], z), (x[0], y[-1], z)])
            - (0, 0, 0.004 * self.scene.extent),
            faces=[4, 0, 1, 2, 3],
        )
        self.plotter.add_mesh(floor, color="#eef2f5", lighting=False, render=False)

    def _look(self) -> None:
        if self.scene.camera is not None:
            self.plotter.camera_position = [tuple(vector) for vector in self.scene.camera]
            return
        (x0, y0, z0), (x1, y1, z1) = self.scene.low, self.scene.high
        self.plotter.view_vector(VIEW, viewup=(0, 0, 1), bounds=(x0, x1, y0, y1, z0, z1), render=False)
        self.plotter.camera.zoom(1.25)
        self.plotter.renderer.ResetCameraClippingRange()

    def _draw_trails(self, trails: Points) -> None:
        import pyvista

        for k, trail in enumerate(trails):
            if len(trail) < 2:
                continue
            line = pyvista.lines_from_points(trail)
            fade = np.linspace(0.15, 1.0, len(trail))[:, None]
            ink = 255 * np.array(pyvista.Color(INK).float_rgb)
            line["ink"] = np.hstack([np.tile(ink, (len(trail), 1)), 255 * fade]).astype(np.uint8)
            self.plotter.add_mesh(
                line, scalars="ink", rgb=True, line_width=3, lighting=False, name=f"trail {k}", render=False
            )


class _Part:
    """A mesh whose points are those of a surface, in an order of its own."""

    def __init__(self, surface: int, mesh: Any, ids: NDArray[np.int64], shaded: bool) -> None:
        self.surface, self._mesh, self._ids, self._shaded = surface, mesh, ids, shaded

    def move(self, points: NDArray[np.float64]) -> None:
        self._mesh.points = points[self._ids]
        if self._shaded:
            self._mesh.compute_normals(
                cell_normals=False, split_vertices=False, consistent_normals=False, inplace=True
            )


class _Shadow(_Part):
    """A mesh flattened onto the ground along the light."""

    def __init__(self, part: _Part, mesh: Any, ground: float) -> None:
        super().__init__(part.surface, mesh, part._ids, shaded=False)
        self._ground = ground

    def move(self, points: NDArray[np.float64]) -> None:
        height = points[:, 2:] - self._ground
        super().move(points - height / SUN[2] * SUN)


def _parts(plotter: Any, scene: Scene, k: int, surface: Surface) -> Iterator[_Part]:
    """Add what draws one surface: faces with their sharp edges, lines, single points, and the shadows."""
    import pyvista

    faces = [block for block in surface.cells if block.shape[1] > 2]
    lines = [block for block in surface.cells if block.shape[1] == 2]
    dots = [block for block in surface.cells if block.shape[1] == 1]
    if faces:
        whole = pyvista.PolyData(surface.points, faces=_packed(faces))
        whole["ids"] = np.arange(len(surface.points))
        yield from _solid(plotter, scene, k, whole)
    if lines:
        mesh = pyvista.PolyData(surface.points, lines=_packed(lines))
        part = _Part(k, mesh, np.arange(len(surface.points)), shaded=False)
        width = scene.size[1] / 180
        plotter.add_mesh(
            mesh, color=scene.color(k), line_width=width, render_lines_as_tubes=True, render=False
        )
        yield part
        yield _shadow(plotter, scene, part, mesh, line_width=width)
    if dots:
        ids = np.concatenate(dots).ravel()
        mesh = pyvista.PolyData(surface.points[ids])
        size = scene.size[1] / 40
        plotter.add_mesh(
            mesh, color=scene.color(k), point_size=size, render_points_as_spheres=True, render=False
        )
        yield _Part(k, mesh, ids, shaded=False)


def _solid(plotter: Any, scene: Scene, k: int, whole: Any) -> Iterator[_Part]:
    skin = whole.compute_normals(
        cell_normals=False, split_vertices=True, feature_angle=SHARP, consistent_normals=False
    )
    part = _Part(k, skin, np.asarray(skin["ids"]), shaded=True)
    look = {"smooth_shading": True, "ambient": 0.25, "diffuse": 0.8, "specular": 0.25, "specular_power": 25}
    plotter.add_mesh(skin, color=scene.color(k), render=False, **look)
    yield part
    yield _shadow(plotter, scene, part, skin)
    edges = whole.extract_feature_edges(feature_angle=SHARP, boundary_edges=True, manifold_edges=False)
    if edges.n_points:
        ids = np.asarray(edges["ids"])
        edges.clear_data()
        plotter.add_mesh(edges, color=INK, line_width=1.2, opacity=0.6, lighting=False, render=False)
        yield _Part(k, edges, ids, shaded=False)


def _shadow(plotter: Any, scene: Scene, part: _Part, mesh: Any, line_width: float = 1.0) -> _Shadow:
    flat = mesh.copy()
    flat.clear_data()
    plotter.add_mesh(flat, color="#d3dbe3", lighting=False, line_width=line_width, render=False)
    return _Shadow(part, flat, scene.ground - 0.002 * scene.extent)


def _packed(blocks: list[NDArray[np.int64]]) -> NDArray[np.int64]:
    """Cells in VTK's notation, each led by its number of points."""
    return np.concatenate([np.insert(block, 0, block.shape[1], axis=1).ravel() for block in blocks])


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep VTK from telling on the terminal that there is no screen."""
    from vtkmodules.vtkCommonCore import vtkLogger

    before = vtkLogger.GetCurrentVerbosityCutoff()
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    try:
        yield
    finally:
        vtkLogger.SetStderrVerbosity(before)
