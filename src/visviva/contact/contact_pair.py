"""Two sides of a contact: which surfaces they are, and the gap functions between them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.base.errors import InputError
from visviva.body.rigid import RigidBody
from visviva.component.point import Attachable
from visviva.contact.along import everywhere, order
from visviva.contact.bars import Frames, bar_gaps, bars_of, is_bar, turning_of
from visviva.contact.contact_surface import (
    Surface,
    joined,
    mesh_bodies,
    points_of,
    repeated,
    skin,
    surface_of,
)
from visviva.contact.creases import SMOOTH_RIGID, SMOOTH_SOLID, creased
from visviva.contact.obstacle import frame_surface
from visviva.mesh.faces import Faces

if TYPE_CHECKING:
    from visviva.body.shape import Outline
    from visviva.component.component import Component

FRAME = 4
"""Vertices of a frame."""
VALLEY = 8
"""Number of facets leaning together that may hold each vertex of a rigid body with few vertices."""
CORNER = 3
"""The same for bodies of many vertices: three leave no way down, with two a vertex pressed into a corner sinks."""
SHARED = 64
"""Gaps that few vertices share. Eight for each of 386 made steps 2.5 times as long, three 1.4 times."""
NOTHING_TURNS = np.zeros(0, dtype=np.int32)


@dataclass(frozen=True)
class GapFunctions:
    """The core's gap functions of a pair.

    Attributes
    ----------
    core : _core.Gaps
    size : float
        Largest diameter of a facet; 0 for points without facets.
    reach : float
        Facets farther apart than this are no candidates.
    opposite : Surface or None
        What the first surface faces: facets, or the frame of an exact shape; None where it touches itself.
    turns : array of int, (n,)
        Where balls and round bars rub: the first of four vertices that are the frame each point turns with.
    """

    core: _core.Gaps
    size: float
    reach: float
    opposite: Surface | None
    turns: NDArray[np.int32]


@dataclass(frozen=True)
class Pair:
    """Two bodies that may touch, and how their gaps are measured.

    Attributes
    ----------
    label : str
        The contact, for messages.
    first : Attachable
        Gaps belong to the vertices of its surface.
    second : Component or None
        None if the first surface touches itself.
    second_faces : str or Faces
    mortar, dual, rubs : bool
        Whether gaps are averaged over segments, multipliers dual, and friction acts.
    reach : float or None
        As the user gave it.
    fine : bool
        Whether round bars have points between their nodes, and what touches itself does so from both sides:
        multipliers at more points than nodes would be redundant.
    """

    label: str
    first: Attachable
    second: Component | None
    second_faces: str | Faces
    mortar: bool
    dual: bool
    rubs: bool
    reach: float | None
    fine: bool

    @property
    def is_rigid(self) -> bool:
        """Whether the first surface is that of a rigid body, or a point."""
        return not mesh_bodies(self.first)

    @property
    def outline(self) -> Outline | None:
        """The second one's exact shape, if that is what counts."""
        by_facets = self.mortar or self.second_faces != "all"
        if self.second is None or (by_facets and self.second.surface() is not None):
            return None
        outline: Outline | None = self.second.outline()
        return outline

    @property
    def copies(self) -> int:
        """So many vertices of the first surface stand for one, where facets may lean together over it."""
        by_facets = not self.mortar and self.outline is None and not is_bar(self.second)
        feelers = self.first.feelers() if self.is_rigid and by_facets and not self.fine else None
        return 1 if feelers is None else int(np.clip(SHARED // len(feelers[0]), CORNER, VALLEY))

    def first_surface(self, faces: str | Faces, splits: bool) -> tuple[Surface, float]:
        """The first surface, and the radius of balls about its points.

        Where it `splits`, it does so at sharp edges if that matters: forces without friction are the same.
        """
        if not self.mortar or self.outline is not None:
            surface, radius = points_of(self.first, faces, self.label, self.fine)
            return repeated(surface, self.copies), radius
        surface = surface_of(self.first, faces, self.label)
        if not splits or not (self.is_rigid or self.rubs):
            return surface, 0.0
        return creased(surface, SMOOTH_RIGID if self.is_rigid else SMOOTH_SOLID), 0.0

    def _turning(
        self, surface: Surface, radius: float, length: float, begin: int
    ) -> tuple[list[Surface], NDArray[np.int32]]:
        """Frames of balls that rub, which their points turn with, as vertices from number `begin` on.

        And the first vertex of the frame of each point.
        """
        n = len(surface.forms)
        if radius > 0 and self.rubs and isinstance(self.first, RigidBody):
            return [frame_surface([self.first.frame()], length)], np.full(n, begin, dtype=np.int32)
        if radius > 0 and self.rubs and is_bar(self.first):
            frames = turning_of(self.first, self.fine, length)
            return [frames], begin + FRAME * np.arange(n, dtype=np.int32)
        return [], NOTHING_TURNS

    def gap_functions(self, surface: Surface, radius: float, length: float) -> GapFunctions:
        """Gaps of the vertices of the first surface, balls of this radius about them, in a model of this length."""
        if self.outline is not None:
            return self._to_shape(self.outline, surface, radius, length)
        for bar in (self.second or self.first,):
            if is_bar(bar):
                return self._to_bar(bar, surface, radius, length)
        if self.second is None:
            return self._to_itself(surface)
        return self._to_facets(surface, radius, length)

    def _to_itself(self, surface: Surface) -> GapFunctions:
        reach, whole = self.reach or surface.size, skin(surface, None)
        starts, ends = everywhere(surface) if self.fine else order(surface)
        gaps = _core.self_contact(
            whole, surface.areas, surface.behind, reach, self.rubs, surface.places, starts, ends
        )
        return GapFunctions(gaps, surface.size, reach, None, NOTHING_TURNS)

    def _to_shape(self, outline: Outline, surface: Surface, radius: float, length: float) -> GapFunctions:
        core, frame = outline
        frames, turns = self._turning(surface, radius, length, len(surface.forms))
        opposite = joined(*frames, frame_surface([frame], length))
        pair, half = self._paired(surface, opposite), np.array(core.half)
        around = _around(surface)
        gaps = _core.obstacle(
            pair, surface.areas, radius, turns, core.kind, half, core.radius, length, around
        )
        return GapFunctions(gaps, surface.size, length, opposite, turns)

    def _to_bar(self, other: Component, surface: Surface, radius: float, length: float) -> GapFunctions:
        """Gaps of points beside round bars."""
        opposite, thick = bars_of(other)
        apart = radius + thick
        reach = self.reach or 2 * apart
        begin = len(surface.forms) + len(opposite.forms)
        turning, turns = self._turning(surface, radius, length, begin)
        frames = Frames(turns, radius=radius)
        if self.rubs:
            begin += sum(len(frame.forms) for frame in turning)
            frames = frames._replace(opposite=begin + FRAME * np.arange(len(opposite.forms), dtype=np.int32))
            turning = [*turning, turning_of(other, True, length)]
        pair, bodies = self._paired(surface, opposite, *turning), (self.first, self.second)
        gaps = bar_gaps(pair, surface, apart, reach, bodies, frames)
        return GapFunctions(gaps, min(surface.size or apart, apart), reach, opposite, turns)

    def _to_facets(self, surface: Surface, radius: float, length: float) -> GapFunctions:
        if not isinstance(self.second, Attachable):
            raise InputError(f"{self.label}: {self._opponent} has no surface")
        opposite = surface_of(self.second, self.second_faces, self.label)
        frames, turns = self._turning(surface, radius, length, len(surface.forms) + len(opposite.forms))
        self.check_finer(surface, float(np.linalg.norm(np.ptp(opposite.places, axis=0))))
        size = max(surface.size, opposite.size)
        reach = self.reach or size
        pair = self._paired(surface, opposite, *frames)
        if self.mortar:
            gaps = _core.mortar(pair, reach, surface.axisymmetric, self.dual)
        else:
            areas, behind, rubs, around = surface.areas, surface.behind, self.rubs, _around(surface)
            gaps = _core.node_to_segment(
                pair, areas, behind, radius, reach, rubs, turns, length, self.copies, around
            )
        return GapFunctions(gaps, size, reach, opposite, turns)

    def check_finer(self, surface: Surface, across: float) -> None:
        """Refuse a rigid first surface with a facet larger than all of the second one, which has this diagonal.

        By mortar the gap is a mean over all of that; otherwise there is no vertex where it touches.
        """
        if self.is_rigid and surface.size > across:
            raise InputError(
                f"{self.label}: {self.first.label} has facets of up to {surface.size:.3g}, larger than all of "
                f"{self._opponent}, which falls between its vertices; exchange first and second, or give "
                f"{self.first.label} finer facets, by a SurfaceMesh"
            )

    @property
    def _opponent(self) -> str:
        return self.second.label if self.second else ""

    def _paired(self, surface: Surface, opposite: Surface, *frames: Surface) -> _core.Skin:
        if surface.dimension != opposite.dimension and any(opposite.forms):
            raise InputError(
                f"{self.label}: {self.first.label} and {self._opponent} differ in dimension: what is plane touches "
                "what is plane, or shapes that are fixed in space (leave out their on, and move the plane body by "
                "Prescribed)"
            )
        if not any(form for part in (surface, opposite) for form in part.forms):
            raise InputError(f"{self.label}: neither {self.first.label} nor {self._opponent} can move")
        pair: _core.Skin = skin(surface, opposite, *frames)
        return pair


def _around(surface: Surface) -> NDArray[np.int32]:
    """Facets that its points stand for, in one row."""
    around = surface.around
    return np.zeros(0, dtype=np.int32) if around is None else around.astype(np.int32).ravel()
