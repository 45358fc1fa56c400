"""Bodies that sink into each other where their gaps do not see it: steps in which they do fail."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.body.rigid import RigidBody
from visviva.body.shape import Cylinder
from visviva.body.solid import Solid
from visviva.component.point import Attachable
from visviva.contact.bars import bars_of, is_bar
from visviva.contact.contact_surface import Surface, mesh_bodies, of_vectors, skin, surface_of, where_of
from visviva.contact.hull import hull_of, touching
from visviva.contact.obstacle import Obstacle
from visviva.mesh.faces import Faces

if TYPE_CHECKING:
    from visviva.contact.contact import Contact

UNSEEN = 0.01
"""Part of the least width of both bodies by which edges may be in the other one deeper than twice what gaps see."""

FLEXIBLE = 40
"""How many times as deep solids are watched: vertices that slide over edges of theirs within a step sink that far."""
AVERAGED = 10
"""The same by mortar."""
COVERED = 0.01
"""Part of the area of a vertex that bodies which are not watched cover, by mortar, whose gaps need a tenth of it."""
THIN = 20
"""The same of lines along bars and shells, whose own widths do not count."""
THINNEST = 0.01
"""Part of a surface, such as facets at the tip of a cone, behind which a body may be thinner than its least width."""

Pairing = tuple[RigidBody, RigidBody | Obstacle]


class Side(NamedTuple):
    """What is watched of a body: its closed surface and which facets (m,) may touch, or lines along what is thin."""

    surface: Surface
    encloses: bool
    touches: NDArray[np.bool_]


def watched(contact: Contact) -> Pairing | None:
    """Both sides, if they are rigid and have edges, corners or faces that gaps of the first one do not see."""
    first, second = contact.first, contact.second
    if not isinstance(first, RigidBody) or first.shape is None:
        return None
    if len(first.shape.feelers[0]) == 1 and not contact.is_mortar:  # balls are exact
        return None
    if isinstance(second, RigidBody):
        return None if second.shape is None else (first, second)
    return (first, second) if isinstance(second, Obstacle) else None


def deforming(contact: Contact) -> tuple[Attachable, Attachable | Obstacle] | None:
    """Both sides, one of them deformable, if what touches may not see where they sink into each other.

    By vertices the second may pass between those of the first, by mortar edges and corners of what is rigid pass means
    over facets.
    """
    first, second = contact.first, contact.second
    bodies = mesh_bodies(first, second)
    if first is second or not bodies or not isinstance(second, Attachable | Obstacle):
        return None
    if _is_averaged(contact) and not all(map(_encloses, bodies)):
        return None
    if _is_averaged(contact) and len(bodies) > 1 and not _covers_little(contact, second):
        return None
    if isinstance(first, RigidBody) and first.shape is not None and len(first.shape.feelers[0]) == 1:
        return None  # balls are exact
    if is_bar(second) or (is_bar(first) and contact.enforcement == "penalty"):  # touch all along
        return None
    if _are_thin(contact):
        return (first, second) if hull_of(first) or hull_of(second) else None
    closed = [_encloses(body) for body in (first, second)]
    extends = all(
        is_closed or mesh_bodies(body) for body, is_closed in zip((first, second), closed, strict=True)
    )
    return (first, second) if any(closed) and extends else None


def _covers_little(contact: Contact, second: Attachable | Obstacle) -> bool:
    """Whether a body may stand on so little of a facet of the first one that no mortar gap is held there."""
    spans = np.sort(np.ptp(whole_surface(contact, second).places, axis=0)[: contact._surface.dimension])
    return bool(np.prod(spans[:-1]) < COVERED * contact._surface.areas.max())


def _are_thin(contact: Contact) -> bool:
    """Two bodies of which none is thicker than its section."""
    return len(mesh_bodies(contact.first, contact.second)) == 2 and not any(
        map(_encloses, (contact.first, contact.second))
    )


def _is_averaged(contact: Contact) -> bool:
    return contact.is_mortar and not isinstance(contact.second, Obstacle)  # which vertices touch


def _encloses(body: object) -> bool:
    return isinstance(body, Solid | Obstacle) or (isinstance(body, RigidBody) and body.shape is not None)


def sees_all(contact: Contact) -> bool:
    """Whether steps see whatever passes between vertices of solids: of what is closed in space, by all of its faces."""
    bodies = [body for body in (contact.first, contact.second) if isinstance(body, Solid | RigidBody)]
    in_space = all(body.grid.dimension == 3 for body in mesh_bodies(*bodies))
    return deforming(contact) is not None and len(bodies) == 2 and in_space and not _is_named(contact)


def _is_named(contact: Contact) -> bool:
    return (contact.first_faces, contact.second_faces) != ("all", "all")


def watch(contact: Contact, term: _core.ContactTerm) -> None:
    """Let steps fail in which the bodies of a contact sink into each other unseen."""
    pairing = watched(contact) or deforming(contact)
    if pairing is None:
        return
    first, second = pairing
    _, radius = first.feelers() or ((), 0.0)
    feels_all = contact._edges is not None and contact._edges.feels_all
    if not isinstance(second, Obstacle) and not contact.is_mortar and radius == 0 and not feels_all:
        own = surface_of(first, contact.first_faces, contact.label)
        other = surface_of(second, contact.second_faces, contact.label)
        contact._pair.check_finer(own, float(np.linalg.norm(np.ptp(other.places, axis=0))))
    sides = _side(contact, first, contact.first_faces), _side(contact, second, contact.second_faces)
    surfaces = [side.surface for side in sides]
    wholes = [
        side.surface if _encloses(body) else whole_surface(contact, body)  # hulls are thinner at kinks
        for side, body in zip(sides, pairing, strict=True)
        if side.encloses
    ]
    least = min(_width(whole, surfaces[0].dimension) for whole in wholes)
    closed = sides[0].encloses, sides[1].encloses
    touches = np.concatenate([side.touches for side in sides]).astype(np.int32)
    deep = _deep(contact, all(closed)) * least
    thin = _are_thin(contact)
    term.watch(skin(*surfaces, sees=thin), closed, touches, thin, deep, least, _cure(contact, pairing))


def _side(contact: Contact, body: Attachable | Obstacle, faces: str | Faces) -> Side:
    """Faces that are named are told apart of what deforms: what is pressed beside them is meant to be free."""
    hull = hull_of(body) if _are_thin(contact) else None
    if hull is not None:
        return Side(hull, True, touching(body, hull, faces))
    if not _encloses(body):
        lines = _lines(contact, body, faces)
        return Side(lines, False, np.ones(len(lines.facets), dtype=bool))
    whole = whole_surface(contact, body)
    if isinstance(body, Obstacle) or faces == "all" or not mesh_bodies(contact.first, contact.second):
        return Side(whole, True, np.ones(len(whole.facets), dtype=bool))
    named = {where_of(corners) for corners in surface_of(body, faces, contact.label)._corners()}
    return Side(whole, True, np.array([where_of(corners) in named for corners in whole._corners()]))


def _lines(contact: Contact, body: Any, faces: str | Faces) -> Surface:
    """Lines along what is thin: of bars their middle, of shells edges and diagonals of their facets."""
    if is_bar(body):
        return bars_of(body, fine=False)[0]
    surface = surface_of(body, faces, contact.label)
    ends = surface.facets[:, [(0, 1), (1, 2), (2, 3), (3, 0), (2, 0), (1, 3)]].reshape(-1, 2)
    lines = np.unique(np.sort(ends[(ends >= 0).all(axis=1)], axis=1), axis=0)
    return replace(surface, facets=np.pad(lines, ((0, 0), (0, 2)), constant_values=-1))


def _width(surface: Surface, dimension: int) -> float:
    if dimension == surface.dimension:
        return narrowest(surface)
    return float(np.ptp(surface.places[:, :dimension], axis=0).min())  # of shapes that plane bodies touch


def _deep(contact: Contact, are_closed: bool) -> float:
    """Part of the least width by which bodies may be in each other unseen."""
    bodies = mesh_bodies(contact.first, contact.second)
    if not are_closed:
        return UNSEEN * THIN
    if len(bodies) == 1 and _is_averaged(contact) and not _is_named(contact):
        return UNSEEN * AVERAGED
    return UNSEEN * (FLEXIBLE if bodies else 1)


def unseen(least: float, *bodies: Attachable | Obstacle) -> float:
    """How deep bodies of this least width may be in each other where no gap sees it."""
    return UNSEEN * least * (FLEXIBLE if mesh_bodies(*bodies) else 1)


def rubs_by_springs(contact: Contact) -> bool:
    """Whether multipliers press and a penalty rubs, which forgets its slip where a gap at the same place takes over."""
    return contact.friction > 0 and contact.enforcement == "multipliers" and contact.tangential == "penalty"


def narrowest(surface: Surface) -> float:
    """The least width of a body, however it lies: its thickness behind a facet, but for the thinnest hundredth."""
    thick, areas = surface.sights[:, 0], surface._facet_areas()
    order = np.argsort(thick, kind="stable")
    most = int(np.searchsorted(np.cumsum(areas[order]), THINNEST * areas.sum()))
    across = float(np.ptp(surface.places[:, : surface.dimension], axis=0).min())
    return min(float(thick[order[min(most, len(order) - 1)]]), across) if len(order) else across


def whole_surface(contact: Contact, body: Attachable | Obstacle) -> Surface:
    """The whole surface of a side, as facets."""
    if not isinstance(body, Obstacle):
        return surface_of(body, "all", contact.label)
    points, facets = body.shape.facets()
    _, frame = body.outline()
    places = []
    for X in points:
        place = frame.position
        for x, direction in zip(X, frame.directors, strict=True):
            place = place + float(x) * direction
        places.append(place)
    return of_vectors(places, facets, points)


def _cure(contact: Contact, pairing: tuple[Attachable, Attachable | Obstacle]) -> str:
    first, second = (body.label for body in pairing)
    if contact.is_mortar and len(mesh_bodies(*pairing)) > 1:
        return (
            f"{second} covers too little of facets of {first} for mortar gaps: exchange first and second, or give "
            f"{first} finer cells"
        )
    if contact.is_mortar and not (mesh_bodies(*pairing) and isinstance(pairing[1], Obstacle)):
        rigid = next(body.label for body in pairing if isinstance(body, RigidBody))
        bends = "".join(
            f", or with {body.label}, where that bends round it" for body in mesh_bodies(*pairing)
        )
        return (
            f"mortar gaps are means over facets, which edges and corners of {rigid} pass by where it lies tilted: take "
            f"formulation='node-to-segment', with {rigid} as first{bends}"
        )
    if mesh_bodies(*pairing):
        return f"vertices of {first} alone touch {second}: {finer(*pairing)}"
    if (contact.first_faces, contact.second_faces) != ("all", "all"):
        return (
            f"of faces that are named vertices of {first} alone touch {second}: leave out first_faces and "
            "second_faces, or exchange first and second where corners of that meet faces"
        )
    if rubs_by_springs(contact):
        return (
            f"by multipliers that rub by a penalty vertices of {first} alone touch {second}: leave out "
            "tangential='penalty'"
        )
    return (
        f"vertices of {first} touch {second}, and where both are convex and sharp by 30 degrees edges that cross and "
        "corners in faces: exchange first and second where what is round meets edges or corners, and take "
        f"formulation='mortar' where faces lie on each other beside these{_along(pairing)}"
    )


def _along(pairing: tuple[Attachable, Attachable | Obstacle]) -> str:
    """What helps where neither order does: cylinders have vertices on their rims alone."""
    lying = [body.label for body in pairing if isinstance(getattr(body, "shape", None), Cylinder)]
    return "".join(
        f"; where something lies across {label} between its rims no order sees it: give that the shape of a "
        "SurfaceMesh with close rings of vertices along it, of a body that is first"
        for label in lying[-1:]
    )


def finer(first: Attachable, second: Attachable | Obstacle) -> str:
    """What cures that only vertices of a first, deformable or rigid body touch."""
    if is_bar(first):
        return f"give {first.label} more cells, or take enforcement='penalty', which has points between its nodes"
    if isinstance(second, Obstacle):
        return f"give {first.label} finer cells"
    return (
        "exchange first and second, or take formulation='mortar' where faces lie on each other, or give "
        f"{first.label} finer cells"
    )


def remark(contact: Contact) -> list[str]:
    """What the check says of it."""
    pairing = watched(contact)
    if pairing is None:
        return []
    first, second = pairing
    edges = "" if rubs_by_springs(contact) else " and sharp edges"
    by_points = f"those of its vertices{edges}, by node-to-segment"
    how = "means over facets, by mortar" if contact.is_mortar else by_points
    return [
        f"{contact.label}: gaps of {first.label} are {how}; steps in which it and {second.label} sink into each other "
        f"unseen by these, by {UNSEEN:.0%} of their least width, fail"
    ]
