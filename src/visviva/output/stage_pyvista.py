"""Scenes drawn by PyVista."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.output.stage import INK, Points, Scene, Trails
from visviva.output.surface import Surface

SHARP = 35.0  # degrees between neighbouring faces above which an edge is drawn as one
SUN = np.array([-0.35, 0.25, -1.0])  # direction in which shadows fall
FINE = 2  # pixels rendered per pixel and direction, faster here than VTK's own smoothing of edges
LIFT = 0.0012  # of the way to the eye
GLOSS: dict[str, Any] = {"ambient": 0.3, "diffuse": 0.8, "specular": 0.25, "specular_power": 25}


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
        self._fine = FINE if plotter is None else 1
        window = [self._fine * side for side in scene.size]
        with _quiet():
            self.plotter: Any = plotter
            if plotter is None:
                self.plotter = pyvista.Plotter(off_screen=True, window_size=window, lighting="none")
            self._light()
            self._look()
            self._ground()
            self._label = self._label_in_corner()
            self._trails: dict[int, Any] = {}
            self._parts = [
                part
                for k, surface in enumerate(scene.surfaces)
                for part in _parts(self.plotter, scene, k, surface, self._fine)
            ]

    def place(self, points: Points, trails: Trails, label: str) -> None:
        for part in self._parts:
            part.move(points[part.surface])
        self._draw_trails(trails)
        self._label.SetInput(label)
        self.plotter.renderer.ResetCameraClippingRange()

    def image(self) -> NDArray[np.uint8]:
        with _quiet():
            self.plotter.render()  # a screenshot alone would repeat the picture before
            fine: NDArray[np.uint8] = np.asarray(self.plotter.screenshot(return_img=True))
        corners = [
            fine[row :: self._fine, column :: self._fine] for row, column in np.ndindex(2 * (self._fine,))
        ]
        total = corners[0].astype(np.uint16)
        for corner in corners[1:]:
            total += corner
        return (total // len(corners)).astype(np.uint8)

    def close(self) -> None:
        self.plotter.close()

    def _light(self) -> None:
        import pyvista

        self.plotter.set_background("#f3f6f9", top="#cfdbe6")
        self.plotter.enable_anti_aliasing("msaa", multi_samples=1 if self._fine > 1 else 4)
        eye, target, _ = self.scene.fitted_camera(self.plotter.camera.view_angle)
        sight = np.subtract(eye, target) / np.linalg.norm(np.subtract(eye, target))
        aside = np.cross(sight, [0.0, 0.0, 1.0])
        for towards, strength in ((-SUN, 0.65), (sight + 1.2 * aside, 0.4), (sight, 0.2)):
            light = pyvista.Light(position=tuple(towards), focal_point=(0, 0, 0), intensity=strength)
            self.plotter.add_light(light)

    def _ground(self) -> None:
        """Floor and grid lines that fade towards their rim."""
        import pyvista

        lines = pyvista.line_segments_from_points(self.scene.grid().reshape(-1, 3))
        self._fading(lines, "#a9b7c4", 1.0)
        depth = self.scene.ground - 0.004 * self.scene.extent
        middle = (*((self.scene.low + self.scene.high)[:2] / 2), depth)
        floor = pyvista.Disc(center=middle, inner=0.0, outer=self.scene.reach, r_res=16, c_res=48)
        self._fading(floor, "#ffffff", 0.7)

    def _fading(self, mesh: Any, color: str, strength: float) -> None:
        import pyvista

        middle = (self.scene.low + self.scene.high)[:2] / 2
        away = np.linalg.norm(mesh.points[:, :2] - middle, axis=1) / self.scene.reach
        alpha = strength * np.clip(1.0 - away, 0.0, 1.0) ** 0.8
        ink = np.tile(np.array(pyvista.Color(color).float_rgb), (mesh.n_points, 1))
        mesh["ink"] = (255 * np.column_stack([ink, alpha])).astype(np.uint8)
        self.plotter.add_mesh(
            mesh, scalars="ink", rgb=True, lighting=False, line_width=self._fine, render=False
        )

    def _look(self) -> None:
        camera = self.plotter.camera
        camera.position, camera.focal_point, camera.up = self.scene.fitted_camera(camera.view_angle)

    def _label_in_corner(self) -> Any:
        size = max(8, round(self._fine * self.scene.size[1] / 62))
        return self.plotter.add_text(
            " ", position=(0.02, 0.93), viewport=True, font_size=size, color=INK, render=False
        )

    def _draw_trails(self, trails: Trails) -> None:
        """Draw lines that fade backwards; new points for old actors, since VTK takes long over new ones."""
        width = self._fine * self.scene.size[1] / 260
        for k, trail in trails.items():
            line = self._faded_line(
                trail if len(trail) > 1 else np.repeat(trail, 2, axis=0), self.scene.color(k)
            )
            if k in self._trails:
                self._trails[k].copy_from(line)
                continue
            self._trails[k] = line
            self.plotter.add_mesh(
                line, scalars="ink", rgb=True, line_width=width, lighting=False, render=False
            )

    def _faded_line(self, trail: NDArray[np.float64], color: str) -> Any:
        import pyvista

        line = pyvista.lines_from_points(trail)
        ink = np.tile(np.array(pyvista.Color(color).float_rgb), (len(trail), 1))
        line["ink"] = (255 * np.column_stack([ink, np.linspace(0.1, 1.0, len(trail))])).astype(np.uint8)
        return line


class _Part:
    """A mesh that follows points of one surface, in an order of its own."""

    def __init__(self, surface: int, mesh: Any, ids: NDArray[np.int64]) -> None:
        self.surface, self._mesh, self._ids = surface, mesh, ids

    def move(self, points: NDArray[np.float64]) -> None:
        self._mesh.points = points[self._ids]


class _Skin(_Part):
    """Faces, shaded smoothly between their sharp edges."""

    def move(self, points: NDArray[np.float64]) -> None:
        super().move(points)
        self._mesh.clear_data()  # VTK keeps normals that are there already
        normals = {"cell_normals": False, "split_vertices": False, "consistent_normals": False}
        self._mesh.compute_normals(inplace=True, **normals)


class _Edges(_Part):
    """Lines on the faces, lifted towards the eye so that the faces do not swallow them."""

    def __init__(self, surface: int, mesh: Any, ids: NDArray[np.int64], camera: Any) -> None:
        super().__init__(surface, mesh, ids)
        self._camera = camera

    def move(self, points: NDArray[np.float64]) -> None:
        super().move(points + LIFT * (np.array(self._camera.position) - points))


class _Ball(_Part):
    """A ball around a point."""

    def __init__(self, surface: int, mesh: Any, ids: NDArray[np.int64], offsets: NDArray[np.float64]) -> None:
        super().__init__(surface, mesh, ids)
        self._offsets = offsets

    def move(self, points: NDArray[np.float64]) -> None:
        self._mesh.points = points[self._ids] + self._offsets


class _Shadow(_Part):
    """A mesh flattened onto the ground along the light."""

    def __init__(self, surface: int, mesh: Any, ids: NDArray[np.int64], ground: float) -> None:
        super().__init__(surface, mesh, ids)
        self._ground = ground

    def move(self, points: NDArray[np.float64]) -> None:
        height = points[:, 2:] - self._ground
        super().move(points - height / SUN[2] * SUN)


def _parts(plotter: Any, scene: Scene, k: int, surface: Surface, fine: int) -> Iterator[_Part]:
    """Add what draws one surface: faces with their sharp edges, lines, single points, and the shadows."""
    import pyvista

    faces = [block for block in surface.cells if block.shape[1] > 2]
    lines = [block for block in surface.cells if block.shape[1] == 2]
    dots = [block for block in surface.cells if block.shape[1] == 1]
    if faces:
        whole = pyvista.PolyData(surface.points, faces=_packed(faces))
        whole["ids"] = np.arange(len(surface.points))
        yield from _solid(plotter, scene, k, whole, fine)
    if lines:
        mesh = pyvista.PolyData(surface.points, lines=_packed(lines))
        yield from _thread(plotter, scene, k, mesh)
    if dots:
        yield from _dots(plotter, scene, k, np.concatenate(dots).ravel())


def _solid(plotter: Any, scene: Scene, k: int, whole: Any, fine: int) -> Iterator[_Part]:
    skin = whole.compute_normals(
        cell_normals=False, split_vertices=True, feature_angle=SHARP, consistent_normals=False
    )
    ids = np.asarray(skin["ids"])
    plotter.add_mesh(skin, color=scene.color(k), smooth_shading=True, render=False, **GLOSS)
    yield _Skin(k, skin, ids)
    yield _shadow(plotter, scene, k, skin, ids)
    edges = whole.extract_feature_edges(feature_angle=SHARP, boundary_edges=True, manifold_edges=False)
    if edges.n_points:
        ids = np.asarray(edges["ids"])
        edges.clear_data()
        plotter.add_mesh(edges, color=INK, line_width=fine, opacity=0.7, lighting=False, render=False)
        yield _Edges(k, edges, ids, plotter.camera)


def _thread(plotter: Any, scene: Scene, k: int, mesh: Any) -> Iterator[_Part]:
    """Lines as round tubes, made anew by VTK whenever the lines move."""
    from vtkmodules.vtkFiltersCore import vtkTubeFilter

    ids = np.arange(mesh.n_points)
    tube = vtkTubeFilter(radius=0.0025 * scene.extent, number_of_sides=12)
    tube.SetInputData(mesh)
    plotter.add_mesh(tube, color=scene.color(k), smooth_shading=True, render=False, **GLOSS)
    yield _Part(k, mesh, ids)
    yield _shadow(plotter, scene, k, mesh, ids)


def _dots(plotter: Any, scene: Scene, k: int, ids: NDArray[np.int64]) -> Iterator[_Part]:
    """Single points as small balls."""
    import pyvista

    ball = pyvista.Sphere(radius=0.008 * scene.extent, theta_resolution=24, phi_resolution=24)
    for point in ids:
        mesh = ball.copy()
        plotter.add_mesh(mesh, color=scene.color(k), smooth_shading=True, render=False, **GLOSS)
        yield _Ball(k, mesh, np.full(mesh.n_points, point), np.array(ball.points))


def _shadow(plotter: Any, scene: Scene, k: int, mesh: Any, ids: NDArray[np.int64]) -> _Shadow:
    flat = mesh.copy()
    flat.clear_data()
    plotter.add_mesh(flat, color="#d3dbe3", lighting=False, line_width=4, render=False)
    return _Shadow(k, flat, ids, scene.ground - 0.002 * scene.extent)


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
