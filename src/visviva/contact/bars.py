"""Round bars that touch others: points along their middle, their frames, and gaps between bars."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.body.mesh_body import MeshBody
from visviva.contact.contact_surface import NO_FACETS, Surface, forms_of, of_skin

if TYPE_CHECKING:
    from visviva.body.touching import Round

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
BESIDE = np.pi
"""Radii along a bar within which it does not touch itself: half a turn as sharp as it can be."""


def is_bar(component: Any) -> bool:
    """True if contact acts on points along its axis, as for beams."""
    return isinstance(component, MeshBody) and component.has_directions and component.dimension == 3


def bars_of(body: Any, fine: bool = True) -> tuple[Surface, float]:
    """The middle of a round bar as segments, which are facets of two corners, and its radius."""
    own = body.skin("all", fine)
    facets = np.pad(own.round.segments, ((0, 0), (0, 2)), constant_values=-1)
    return replace(of_skin(body, own), facets=facets), own.round.radius


def turning_of(body: Any, fine: bool, size: float) -> Surface:
    """Four vertices for each point of a round bar: itself, and the ends of its directors times `size`."""
    import scipy.sparse as sp

    own = body.skin("all", fine)
    p = len(own.points)
    ends = sp.kron(own.weights, np.ones((3, 1)), format="csr") + size * own.round.axes
    order = np.concatenate([np.arange(p)[:, None], p + np.arange(3 * p).reshape(p, 3)], axis=1).ravel()
    forms = forms_of(sp.vstack([own.weights, ends]).tocsr()[order], own.vectors())
    nowhere = np.zeros((len(forms), 3))
    return Surface(forms, True, nowhere, NO_FACETS, nowhere, 3)


NO_FRAMES = np.zeros(0, dtype=np.int32)


class Frames(NamedTuple):
    """First vertices of the frames that points turn with, of those of the other bar, and the points' radius."""

    turns: NDArray[np.int32] = NO_FRAMES
    opposite: NDArray[np.int32] = NO_FRAMES
    radius: float = 0.0


def bar_gaps(
    pair: _core.Skin, first: Surface, apart: float, reach: float, bodies: tuple[Any, Any], frames: Frames
) -> _core.Gaps:
    """Gaps between points of the first of two bodies, and bars whose middles they touch at a distance `apart`.

    The second is None where the first one touches itself.
    """
    points, other = bodies
    stretches = np.zeros(0, dtype=np.int32)
    if is_bar(points):
        stretches = points.skin("all", fine=True).round.segments.astype(np.int32).ravel()
    start, beside = np.zeros(len(first.forms) + 1, dtype=np.int32), np.zeros(0, dtype=np.int32)
    if other is None:
        start, beside = own_segments(points.skin("all", fine=True).round, len(first.forms))
    return _core.line_gaps(pair, first.areas, apart, reach, start, beside, stretches, *frames)


def own_segments(bar: Round, n: int) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Segments that points are too near to along the bar to touch them, point by point."""
    import scipy.sparse as sp

    a, b = bar.segments.T
    size = len(bar.areas)
    length = np.linalg.norm(np.diff(bar.places[bar.segments], axis=1)[:, 0], axis=1)
    graph = sp.coo_array((length, (a, b)), shape=(size, size)).tocsr()
    far = BESIDE * bar.radius + float(length.max())
    away = sp.csgraph.dijkstra(graph, directed=False, indices=np.arange(n), limit=far)
    near = np.isfinite(away[:, a]) | np.isfinite(away[:, b])
    start = np.concatenate([[0], np.cumsum(near.sum(axis=1))])
    return start.astype(np.int32), np.nonzero(near)[1].astype(np.int32)
