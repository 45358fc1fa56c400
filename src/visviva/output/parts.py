"""Surfaces in PyVista: meshes that follow their points."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.output.coloring import Coloring
from visviva.output.skin import skin
from visviva.output.streamlines import StreamFunction
from visviva.output.surface import Surface
from visviva.output.view import INK, Scene

SHARP = 35.0  # degrees between neighbouring faces above which an edge is drawn as one
SUN = np.array([-0.35, 0.25, -1.0])  # direction in which shadows fall
LINES = 24  # streamlines
LIFT = 0.0012  # of the way to the eye
GLOSS: dict[str, Any] = {"ambient": 0.3, "diffuse": 0.8, "specular": 0.25, "specular_power": 25}


class Part:
    """A mesh that follows points of one surface, in an order of its own."""

    def __init__(self, surface: int, mesh: Any, ids: NDArray[np.int64]) -> None:
        self.surface, self._mesh, self._ids = surface, mesh, ids

    def move(self, points: NDArray[np.float64]) -> None:
        self._mesh.points = points[self._ids]

    def paint(self, values: NDArray[np.float64] | None) -> None:
        """Colour by values of a field, or plainly."""

    def stream(self, velocities: NDArray[np.float64] | None) -> None:
        """Draw streamlines, where there are velocities (n, 3)."""


class Skin(Part):
    """Faces, shaded smoothly between their sharp edges."""

    def __init__(self, surface: int, mesh: Any, ids: NDArray[np.int64], actor: Any) -> None:
        super().__init__(surface, mesh, ids)
        self._actor = actor

    def paint(self, values: NDArray[np.float64] | None) -> None:
        self._actor.mapper.scalar_visibility = values is not None
        self._actor.prop.lighting = values is None  # lit colours would not be those of the bar
        if values is not None:
            self._mesh.point_data["field"] = values[self._ids]
            self._mesh.set_active_scalars("field")

    def move(self, points: NDArray[np.float64]) -> None:
        super().move(points)
        self._mesh.clear_data()  # VTK keeps normals that are there already
        normals = {"cell_normals": False, "split_vertices": False, "consistent_normals": False}
        self._mesh.compute_normals(inplace=True, **normals)


class Edges(Part):
    """Lines on the faces, lifted towards the eye so that the faces do not swallow them."""

    def __init__(self, surface: int, mesh: Any, ids: NDArray[np.int64], camera: Any) -> None:
        super().__init__(surface, mesh, ids)
        self._camera = camera

    def move(self, points: NDArray[np.float64]) -> None:
        super().move(points + LIFT * (np.array(self._camera.position) - points))


class Streamlines(Part):
    """Streamlines of a plane fluid, in even density, before its faces."""

    def __init__(self, surface: int, mesh: Any, ids: NDArray[np.int64], lines: Any) -> None:
        super().__init__(surface, mesh, ids)
        self._lines = lines

    @cached_property
    def _function(self) -> StreamFunction:
        triangles = self._mesh.triangulate().regular_faces
        return StreamFunction(self._mesh.points[:, :2], triangles)

    def stream(self, velocities: NDArray[np.float64] | None) -> None:
        import pyvista

        if velocities is None or not np.any(velocities):
            self._lines.copy_from(pyvista.PolyData())
            return
        self._mesh["stream function"] = psi = self._function(velocities[self._ids])
        found = self._mesh.contour(self._function.levels(psi, LINES), scalars="stream function")
        self._lines.copy_from(
            pyvista.PolyData(found.points + np.array([0, 0, LIFT * self._mesh.length]), lines=found.lines)
        )


class Ball(Part):
    """A ball around a point."""

    def __init__(self, surface: int, mesh: Any, ids: NDArray[np.int64], offsets: NDArray[np.float64]) -> None:
        super().__init__(surface, mesh, ids)
        self._offsets = offsets

    def move(self, points: NDArray[np.float64]) -> None:
        self._mesh.points = points[self._ids] + self._offsets


class Shadow(Part):
    """A mesh flattened onto the ground along the light."""

    def __init__(self, surface: int, mesh: Any, ids: NDArray[np.int64], ground: float) -> None:
        super().__init__(surface, mesh, ids)
        self._ground = ground

    def move(self, points: NDArray[np.float64]) -> None:
        height = points[:, 2:] - self._ground
        super().move(points - height / SUN[2] * SUN)


def parts_of(plotter: Any, scene: Scene, k: int, surface: Surface, fine: int) -> Iterator[Part]:
    """Add what draws one surface: faces with their sharp edges, lines, single points, and the shadows."""
    import pyvista

    if k in scene.fluids and not scene.is_flat and scene.coloring is not None:
        yield from _opened(plotter, scene, k, surface, fine)
        return
    faces = skin(surface)
    lines = [block for block in surface.cells if block.shape[1] == 2]
    dots = [block for block in surface.cells if block.shape[1] == 1]
    if faces:
        outer, inverse = np.unique(np.concatenate([block.ravel() for block in faces]), return_inverse=True)
        ends = np.cumsum([block.size for block in faces])[:-1]
        parts = [p.reshape(b.shape) for p, b in zip(np.split(inverse, ends), faces, strict=True)]
        whole = pyvista.PolyData(surface.points[outer], faces=_packed(parts))
        whole["ids"] = outer
        yield from _solid(plotter, scene, k, whole, fine)
        if scene.outline is not None:
            _shade(plotter, whole, scene.outline[k][outer], fine)
        if scene.coloring is not None and not np.ptp(surface.points[:, 2]):
            lines_of = pyvista.PolyData(whole.points[:2], lines=[2, 0, 1])
            plotter.add_mesh(
                lines_of, color="white", line_width=fine, opacity=0.8, lighting=False, render=False
            )
            yield Streamlines(k, whole, outer, lines_of)
    if lines:
        mesh = pyvista.PolyData(surface.points, lines=_packed(lines))
        yield from _thread(plotter, scene, k, mesh)
    if dots:
        yield from _dots(plotter, scene, k, np.concatenate(dots).ravel())


def _solid(plotter: Any, scene: Scene, k: int, whole: Any, fine: int) -> Iterator[Part]:
    smooth = whole.compute_normals(
        cell_normals=False, split_vertices=True, feature_angle=SHARP, consistent_normals=False
    )
    ids = np.asarray(smooth["ids"])
    actor = plotter.add_mesh(smooth, color=scene.color(k), smooth_shading=True, render=False, **GLOSS)
    if scene.coloring is not None:
        actor.mapper.lookup_table = table(scene.coloring, scene.color(k))
        actor.mapper.SetUseLookupTableScalarRange(True)
        actor.mapper.SetInterpolateScalarsBeforeMapping(True)
    yield Skin(k, smooth, ids, actor)
    if not scene.is_flat:
        yield _shadow(plotter, scene, k, smooth, ids)
    edges = whole.extract_feature_edges(feature_angle=SHARP, boundary_edges=True, manifold_edges=False)
    if edges.n_points:
        ids = np.asarray(edges["ids"])
        edges.clear_data()
        plotter.add_mesh(edges, color=INK, line_width=fine, opacity=0.7, lighting=False, render=False)
        yield Edges(k, edges, ids, plotter.camera)


class Cut(Part):
    """A section through cells that stand still, coloured by the field inside."""

    def __init__(
        self, surface: int, grid: Any, section: Any, across: NDArray[np.float64], actor: Any
    ) -> None:
        super().__init__(surface, grid, np.arange(grid.n_points))
        self._section, self._across, self._actor = section, across, actor

    def move(self, points: NDArray[np.float64]) -> None:
        """Nothing: what flows through stands still."""

    def paint(self, values: NDArray[np.float64] | None) -> None:
        if values is not None:
            self._mesh.point_data["field"] = values
            self._section.copy_from(self._mesh.slice(normal=self._across, origin=self._mesh.center))
            self._section.set_active_scalars("field")


def _opened(plotter: Any, scene: Scene, k: int, surface: Surface, fine: int) -> Iterator[Part]:
    """A fluid in space: the edges of its box, glassy walls, and a section along it through its middle."""
    import pyvista

    assert scene.coloring is not None
    cells = [np.insert(block, 0, block.shape[1], axis=1).ravel() for block in surface.cells]
    kinds = [np.full(len(b), kind, np.uint8) for b, kind in zip(surface.cells, surface.types, strict=True)]
    grid = pyvista.UnstructuredGrid(np.concatenate(cells), np.concatenate(kinds), surface.points)
    size = np.ptp(surface.points, axis=0)
    across = np.eye(3)[1 if size[1] <= size[0] else 0]  # along the longer side of the floor
    grid.point_data["field"] = np.zeros(grid.n_points)
    section = grid.slice(normal=across, origin=grid.center)
    actor = plotter.add_mesh(section, scalars="field", lighting=False, show_scalar_bar=False, render=False)
    actor.mapper.lookup_table = table(scene.coloring, scene.color(k))
    actor.mapper.SetUseLookupTableScalarRange(True)
    walls = pyvista.PolyData(surface.points, faces=_packed(skin(surface)))
    edges = walls.extract_feature_edges(feature_angle=SHARP, boundary_edges=True, manifold_edges=False)
    plotter.add_mesh(walls, color=INK, opacity=0.05, lighting=False, render=False)
    if edges.n_points:
        plotter.add_mesh(edges, color=INK, line_width=fine, opacity=0.5, lighting=False, render=False)
    yield Cut(k, grid, section, across, actor)


def _shade(plotter: Any, whole: Any, points: NDArray[np.float64], fine: int) -> None:
    """The faces as they were, hardly to be seen, with their sharp edges."""
    ghost = whole.copy()
    ghost.points = points
    edges = ghost.extract_feature_edges(feature_angle=SHARP, boundary_edges=True, manifold_edges=False)
    ghost.clear_data()
    plotter.add_mesh(ghost, color=INK, opacity=0.07, lighting=False, render=False)
    if edges.n_points:
        edges.clear_data()
        plotter.add_mesh(edges, color=INK, line_width=fine, opacity=0.45, lighting=False, render=False)


def table(coloring: Coloring, plain: str = INK) -> Any:
    """Colours of a field, and a plain one where it has no value."""
    import pyvista

    return pyvista.LookupTable(coloring.colors, scalar_range=(coloring.low, coloring.high), nan_color=plain)


def _thread(plotter: Any, scene: Scene, k: int, mesh: Any) -> Iterator[Part]:
    """Lines as round tubes, made anew by VTK whenever the lines move."""
    from vtkmodules.vtkFiltersCore import vtkTubeFilter

    ids = np.arange(mesh.n_points)
    tube = vtkTubeFilter(radius=0.0025 * scene.extent, number_of_sides=12)
    tube.SetInputData(mesh)
    plotter.add_mesh(tube, color=scene.color(k), smooth_shading=True, render=False, **GLOSS)
    yield Part(k, mesh, ids)
    if not scene.is_flat:
        yield _shadow(plotter, scene, k, mesh, ids)


def _dots(plotter: Any, scene: Scene, k: int, ids: NDArray[np.int64]) -> Iterator[Part]:
    """Single points as small balls."""
    import pyvista

    ball = pyvista.Sphere(radius=0.008 * scene.extent, theta_resolution=24, phi_resolution=24)
    for point in ids:
        mesh = ball.copy()
        plotter.add_mesh(mesh, color=scene.color(k), smooth_shading=True, render=False, **GLOSS)
        yield Ball(k, mesh, np.full(mesh.n_points, point), np.array(ball.points))


def _shadow(plotter: Any, scene: Scene, k: int, mesh: Any, ids: NDArray[np.int64]) -> Shadow:
    flat = mesh.copy()
    flat.clear_data()
    plotter.add_mesh(flat, color="#d3dbe3", lighting=False, line_width=4, render=False)
    return Shadow(k, flat, ids, scene.ground - 0.002 * scene.extent)


def _packed(blocks: list[NDArray[np.int64]]) -> NDArray[np.int64]:
    """Cells in VTK's notation, each led by its number of points."""
    return np.concatenate([np.insert(block, 0, block.shape[1], axis=1).ravel() for block in blocks])
