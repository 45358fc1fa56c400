"""Refusal of bodies that fit between the vertices which alone touch them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.component.point import Attachable
from visviva.contact.bars import bars_of, is_bar
from visviva.contact.contact_surface import Surface, mesh_bodies, positions, surface_of
from visviva.contact.obstacle import Obstacle
from visviva.contact.sinking import finer, sees_all, whole_surface

if TYPE_CHECKING:
    from visviva.contact.contact import Contact

Array = NDArray[np.float64]

ALIKE = 0.5
"""Facets whose normals agree so far are of one side of a body."""
BORDER = 1e-9
"""Vertices so near to the border of a shadow, as part of its size, are in it."""


def refuse_narrow(contact: Contact, x: Array) -> None:
    """Refuse bodies that stand, at the unknowns `x`, over facets of a coarse first one and over none of its vertices.

    They would fall through it, as through a bar whose nodes alone touch. Where steps are watched for that it is left
    to these.
    """
    first, second = contact.first, contact.second
    if contact.is_mortar or first is second or not isinstance(second, Attachable | Obstacle):
        return
    if is_bar(first):
        _refuse_beside(contact, second, x)
        return
    if not mesh_bodies(first) or sees_all(contact):
        return
    own, other = surface_of(first, contact.first_faces, contact.label), whole_surface(contact, second)
    if not len(own.facets) or not len(other.facets):
        return
    places, corners = positions(other, x), positions(own, x)
    middle = 0.5 * (places.min(axis=0) + places.max(axis=0))
    ends, normals = _normals(own, corners)
    facet = _below(own, ends, normals, middle)
    if facet is None or _shades(own, corners, normals, facet, places):
        return
    _refuse(contact, second, middle)


def _refuse(contact: Contact, second: Attachable | Obstacle, middle: Array) -> None:
    first, near = contact.first, ", ".join(f"{c:.4g}" for c in middle)
    raise InputError(
        f"{contact.label}: {second.label} near ({near}) fits between the vertices of {first.label}, which alone touch "
        f"it, and would fall through; {finer(first, second)}"
    )


def _refuse_beside(contact: Contact, second: Attachable | Obstacle, x: Array) -> None:
    """Refuse bodies beside a stretch of a bar, along the shortest way to which none of its nodes is in their shadow."""
    if contact.enforcement == "penalty":  # has points between the nodes
        return
    (own, radius), other = bars_of(contact.first, fine=False), whole_surface(contact, second)
    if not len(other.facets):
        return
    corners, places = positions(own, x), positions(other, x)
    middle = 0.5 * (places.min(axis=0) + places.max(axis=0))
    starts, along = corners[own.facets[:, 0]], np.diff(corners[own.facets[:, :2]], axis=1)[:, 0]
    part = np.einsum("si,si->s", middle - starts, along) / np.einsum("si,si->s", along, along)
    away = middle - starts - np.clip(part, 0, 1)[:, None] * along
    nearest = int(np.argmin(np.linalg.norm(away, axis=1)))
    if not 0 <= part[nearest] <= 1 or not away[nearest].any():
        return
    across = np.linalg.svd(away[nearest, None])[2][1:].T
    if not _are_in(corners @ across, places @ across, radius):
        _refuse(contact, second, middle)


def _normals(own: Surface, corners: Array) -> tuple[Array, Array]:
    """Corners (m, 4, 3) of the facets, the first one again where there are fewer, and unit normals (m, 3)."""
    ends = corners[np.where(own.facets >= 0, own.facets, own.facets[:, :1])]
    if own.dimension == 3:
        normals = np.cross(ends[:, 2] - ends[:, 0], ends[:, 3] - ends[:, 1])
    else:
        along = ends[:, 1] - ends[:, 0]
        normals = np.column_stack([along[:, 1], -along[:, 0], 0 * along[:, 0]])
    return ends, normals / np.linalg.norm(normals, axis=1, keepdims=True)


def _below(own: Surface, ends: Array, normals: Array, place: Array) -> int | None:
    """The nearest facet that faces a place which is over it."""
    if own.dimension == 3:
        edges = np.roll(ends, -1, axis=1) - ends
        within = np.einsum("mki,mi->mk", np.cross(edges, place - ends), normals) >= 0
    else:
        along = ends[:, 1] - ends[:, 0]
        part = np.einsum("mi,mi->m", place - ends[:, 0], along)
        within = np.column_stack([part >= 0, part <= np.einsum("mi,mi->m", along, along)])
    height = np.einsum("mi,mi->m", place - ends.mean(axis=1), normals)
    height[~within.all(axis=1) | (height < 0)] = np.inf
    nearest = int(np.argmin(height))
    return nearest if np.isfinite(height[nearest]) else None


def _shades(own: Surface, corners: Array, normals: Array, facet: int, places: Array) -> bool:
    """Whether vertices of a side are in the shadow of what is at these places, along the normal of a facet there."""
    normal = normals[facet]
    alike = own.facets[normals @ normal > ALIKE]
    across = np.linalg.svd(normal[None])[2][1:].T
    if own.dimension == 2:
        across = np.array([[normal[1]], [-normal[0]], [0.0]])
    seen, shadow = corners[np.unique(alike[alike >= 0])] @ across, places @ across
    return _are_in(seen, shadow)


def _are_in(seen: Array, shadow: Array, radius: float = 0.0) -> bool:
    """Whether any of these places is in the hull of a shadow, or as near to it as this radius."""
    from scipy.spatial import ConvexHull

    low, high = shadow.min(axis=0), shadow.max(axis=0)
    border = radius + BORDER * float((high - low).max())
    inside = ((seen >= low - border) & (seen <= high + border)).all(axis=1)
    if shadow.shape[1] == 1 or not inside.any():
        return bool(inside.any())
    planes = ConvexHull(shadow, qhull_options="QJ").equations
    return bool(((seen @ planes[:, :-1].T + planes[:, -1]).max(axis=1) <= border).any())
