"""Scenes drawn by PyVista."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.output.coloring import Coloring
from visviva.output.glyphs import NO_GLYPHS, Glyphs
from visviva.output.parts import LIFT, SUN, parts_of, table
from visviva.output.parts_glyphs import GlyphParts
from visviva.output.view import INK, NO_STREAMS, Points, Scene, Streams, Trails, Values

FINE = 2  # pixels rendered per pixel and direction, faster here than VTK's own smoothing of edges


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
            if not (scene.is_flat or scene.transparent):
                self._ground()
            self._label = self._label_in_corner()
            self._trails: dict[int, Any] = {}
            self._parts = [
                part
                for k, surface in enumerate(scene.surfaces)
                for part in parts_of(self.plotter, scene, k, surface, self._fine)
            ]
            self._glyphs = GlyphParts(self.plotter, scene, self._fine)
            if scene.coloring is not None:
                self._color_bar(scene.coloring)

    def place(
        self,
        points: Points,
        trails: Trails,
        label: str,
        values: Values = (),
        streams: Streams = NO_STREAMS,
        glyphs: Glyphs = NO_GLYPHS,
    ) -> None:
        above = np.array(
            [0.0, 0.0, 3 * LIFT * self.scene.extent]
        )  # streamlines end at what swims in the flow
        for part in self._parts:
            swims = bool(streams) and self.scene.is_flat and part.surface not in streams
            part.move(points[part.surface] + above if swims else points[part.surface])
            if values:
                part.paint(values[part.surface])
            part.stream(streams.get(part.surface))
        self._draw_trails(trails)
        self._glyphs.show(glyphs)
        self._label.SetInput(label)
        self.plotter.renderer.ResetCameraClippingRange()

    def image(self) -> NDArray[np.uint8]:
        with _quiet():
            self.plotter.render()  # a screenshot alone would repeat the picture before
            see_through = self.scene.transparent
            fine: NDArray[np.uint8] = np.asarray(
                self.plotter.screenshot(return_img=True, transparent_background=see_through)
            )
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

        if not self.scene.transparent:
            self.plotter.set_background("#f3f6f9", top="#cfdbe6")
        self.plotter.enable_anti_aliasing("msaa", multi_samples=1 if self._fine > 1 else 4)
        eye, target, up = self.scene.fitted_camera(self.plotter.camera.view_angle)
        sight = np.subtract(eye, target) / np.linalg.norm(np.subtract(eye, target))
        aside = np.cross(sight, up)
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
        if self.scene.is_flat:  # what is flat has no depth to be drawn
            far = np.linalg.norm(np.subtract(camera.position, camera.focal_point))
            camera.parallel_projection = True
            camera.parallel_scale = float(far * np.tan(np.radians(camera.view_angle) / 2))

    def _label_in_corner(self) -> Any:
        size = max(8, round(self._fine * self.scene.size[1] / 62))
        return self.plotter.add_text(
            " ", position=(0.02, 0.93), viewport=True, font_size=size, color=INK, render=False
        )

    def _color_bar(self, coloring: Coloring) -> None:
        import pyvista
        from vtkmodules.vtkCommonCore import vtkDoubleArray

        mapper = pyvista.DataSetMapper()
        mapper.lookup_table = table(coloring)
        size = max(8, round(self._fine * self.scene.size[1] / 45))
        place = {"position_x": 0.9, "position_y": 0.16, "width": 0.035, "height": 0.6}
        look: dict[str, Any] = {"color": INK, "title_font_size": 1, "label_font_size": size}
        bar = self.plotter.add_scalar_bar(
            " ",
            mapper=mapper,
            n_labels=max(len(coloring.ticks), 2),
            fmt=coloring.form,
            vertical=True,
            **place,
            **look,
        )
        bar.SetUnconstrainedFontSize(True)
        ticks = vtkDoubleArray()
        for value in coloring.ticks:
            ticks.InsertNextValue(float(value))
        bar.SetUseCustomLabels(True)
        bar.SetCustomLabels(ticks)
        self._title(coloring.title, size)

    def _title(self, title: str, size: int) -> None:
        """The name of a field above its bar, in lines that fit beside the picture."""
        import textwrap

        lines = "\n".join(textwrap.wrap(title, 16))
        text = self.plotter.add_text(
            lines, position=(0.92, 0.79), viewport=True, font_size=size, color=INK, render=False
        )
        text.prop.justification_horizontal, text.prop.justification_vertical = "center", "bottom"
        text.prop.font_size = size

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
