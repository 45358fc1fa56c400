"""Checks of surfaces before they touch; messages have component, place and cure."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.body.mesh_body import MeshBody
from visviva.body.rigid import RigidBody
from visviva.contact.bars import is_bar
from visviva.contact.contact_surface import mesh_bodies
from visviva.mesh.faces import Faces

if TYPE_CHECKING:
    from visviva.contact.contact import Contact
    from visviva.scheme.schemes import Scheme

Array = NDArray[np.float64]

SOFTEST, STIFFEST = 1e-4, 1e6
"""Penalties outside this range of the bodies' own stiffness are mistakes of unit."""
DEEP = 1e-6
"""Surfaces may overlap by this part of a facet, or of a shape that has none, at the start: rounding of meshes."""


def check_second(contact: Contact) -> None:
    """Refuse faces of a second body where there is none."""
    if contact.second is None and contact.second_faces != "all":
        raise InputError(
            f"{contact.label}: second_faces = {contact.second_faces!r} are those of second, which is not given: a "
            "surface touches itself with its first_faces alone, such as 'all'; or give second"
        )


def check_numbers(contact: Contact) -> None:
    """Refuse numbers that no contact has."""
    label = contact.label
    if not contact.friction >= 0:
        raise InputError(f"{label}: friction = {contact.friction:g} is negative; give a coefficient >= 0")
    if not contact.damping >= 0:
        raise InputError(f"{label}: damping = {contact.damping:g} is negative: it would add energy")
    if contact.damping > 0 and contact.enforcement != "penalty":
        raise InputError(f"{label}: damping needs enforcement='penalty', not {contact.enforcement!r}")
    for name in ("stiffness", "tangential_stiffness", "reach"):
        value = getattr(contact, name)
        if value is not None and not value > 0:
            raise InputError(f"{label}: {name} = {value:g} is not positive")


def check_multipliers(contact: Contact) -> None:
    """Refuse dual and condensed multipliers where there are none."""
    label, dual, condensed = contact.label, contact.multipliers == "dual", contact.condensed
    rubs = contact.friction > 0 and contact.tangential == "multipliers"
    if isinstance(contact.first, MeshBody) and (contact.enforcement == "multipliers" or rubs):
        cure = "take enforcement='penalty', with tangential='penalty' where it rubs, or it as second"
        contact.first.carriers.refuse_each_node(label, cure)
    if not (dual or condensed):
        return
    what = f"multipliers={contact.multipliers!r}" if dual else "condensed=True"
    if contact.enforcement == "penalty":
        raise InputError(f"{label}: {what} needs enforcement='multipliers', not 'penalty', which has none")
    if contact.friction > 0:
        raise InputError(
            f"{label}: {what} is for contact without friction, which has tractions beside pressures; leave out "
            f"friction = {contact.friction:g}, or take multipliers='standard' with condensed=False"
        )
    second = contact.second
    if condensed and second is None:
        raise InputError(
            f"{label}: condensed=True is for two surfaces, and here one touches itself; leave it out"
        )
    exact = second is not None and second.surface() is None and second.outline() is not None
    if dual and (not contact.is_mortar or exact):
        raise InputError(
            f"{label}: multipliers='dual' are those of mortar contact between surfaces; here vertices have one each: "
            "leave it out, they can be condensed as they are"
        )
    if condensed and not isinstance(contact.first, MeshBody):
        raise InputError(
            f"{label}: condensed=True needs nodes of a solid on the first surface, which {contact.first.label} has "
            "not; exchange first and second, or leave it out"
        )
    if condensed and not dual and contact.is_mortar and not exact:
        raise InputError(
            f"{label}: standard multipliers of mortar contact press on the nodes beside their own as well and cannot "
            "be condensed; give multipliers='dual'"
        )


def check_bars(contact: Contact) -> None:
    """Refuse what round bars cannot do: they are touched all along, by points of their middle."""
    label, first, second = contact.label, contact.first, contact.second
    if second is not None and is_bar(second) and not is_bar(first):
        feelers = None if isinstance(first, MeshBody) else first.feelers()
        if feelers is None or feelers[1] == 0:
            raise InputError(
                f"{label}: the points of {second.label} touch {first.label}, not the other way: exchange first and "
                "second"
            )
    if not (is_bar(first) or is_bar(second)):
        return
    if contact.formulation == "mortar":
        raise InputError(
            f"{label}: formulation='mortar' is between surfaces, and a beam touches by points of its middle; leave it "
            "out"
        )
    if not (is_bar(second) or second is None):
        return
    if contact.enforcement != "penalty":
        raise InputError(
            f"{label}: beams are kept apart by enforcement='penalty', not {contact.enforcement!r}: where they cross "
            "there is no node for a multiplier"
        )


def check_restitution(contact: Contact) -> None:
    """Refuse a restitution that no impact can have, or where it is not for the contact to choose."""
    label, share = contact.label, contact.restitution
    if share is None:
        return
    if not 0 <= share <= 1:
        raise InputError(f"{label}: restitution = {share:g} is not a share of velocity from 0 to 1")
    if contact.enforcement != "multipliers":
        raise InputError(
            f"{label}: restitution = {share:g} needs enforcement='multipliers'; with a penalty give damping"
        )
    if contact.impact == "conserving":
        raise InputError(
            f"{label}: impact='conserving' is restitution 1, not {share:g}; leave one of them out"
        )
    if contact.initial == "press":
        raise InputError(
            f"{label}: restitution = {share:g} with initial='press', which pushes out what an impact leaves as well; "
            "move the bodies apart and leave out initial"
        )
    if isinstance(contact.first, MeshBody):
        raise InputError(
            f"{label}: restitution = {share:g} is for rigid bodies and points, and {contact.first.label} is a solid, "
            "whose waves take the energy of an impact; leave it out"
        )


def check_schemes(contact: Contact, scheme: Scheme) -> None:
    """Refuse schemes under which contact would not do what it promises."""
    label = contact.label
    if contact.damping > 0 and scheme.has_inertia and not scheme.discrete_gradient:
        raise InputError(
            f"{label}: damping = {contact.damping:g} needs the scheme EnergyMomentum(), not {scheme!r}"
        )
    if contact.enforcement == "multipliers" and scheme.has_inertia and scheme.needs_acceleration:
        raise InputError(
            f"{label}: {scheme!r} remembers accelerations, which an impact by multipliers makes wrong, and adds energy "
            "then; take EnergyMomentum() or BackwardEuler(), or enforcement='penalty'"
        )
    if contact.second is None and contact.enforcement == "multipliers" and scheme.has_inertia:
        raise InputError(
            f"{label}: {contact.first.label} touches itself by multipliers in statics alone; take "
            "enforcement='penalty' for steps of dynamics"
        )


def _check_folds(contact: Contact) -> None:
    """Refuse what is thin and would touch itself across a kink, where its sides cross from the start."""
    body, second_faces = contact.first, contact.first_faces
    if not isinstance(body, MeshBody):
        return
    if contact.second is not None:
        second_faces = contact.second_faces
    skins = body.skin(contact.first_faces), body.skin(second_faces)
    one, two = (np.intersect1d(skin.touched, skin.folds) for skin in skins)
    folds = np.intersect1d(one, two)
    if len(folds):
        raise InputError(
            f"{contact.label}: {body.label} would touch itself across its kink at node {folds[0]}, where its sides "
            "cross; give each smooth part a body of its own, of shells joined by vv.Tie and of beams by vv.Rigid, or "
            "parts that have no kink in common"
        )


def check_sides(contact: Contact) -> None:
    """Refuse sides that cannot touch each other as they are given."""
    first, second = contact.first, contact.second
    sides = ((first, contact.first_faces, "first"), (second, contact.second_faces, "second"))
    for body, faces, side in sides:
        if body is None:
            continue
        if isinstance(body, MeshBody):
            check_skin(contact, body, faces)
        elif isinstance(body, RigidBody) and body.shape is None:
            raise InputError(f"{contact.label}: {body.label} has no surface; give it a shape")
        elif faces != "all" and not isinstance(body, RigidBody):
            raise InputError(
                f"{contact.label}: {body.label} touches with its whole shape; leave out {side}_faces = {faces!r}"
            )
    meshes = mesh_bodies(first, second)
    if len({body.axisymmetric for body in meshes}) > 1:
        raise InputError(f"{contact.label}: one of {meshes[0].label} and {meshes[1].label} is axisymmetric")
    if second is None or first is second:
        _check_folds(contact)
    if first is not second:
        return
    if not isinstance(first, MeshBody):
        raise InputError(f"{contact.label}: {first.label} cannot touch itself")
    one, two = first.skin(contact.first_faces), first.skin(contact.second_faces)
    shared = np.intersect1d(one.used, two.used)
    if len(shared):
        raise InputError(
            f"{contact.label}: both surfaces are of {first.label} and share node {one.nodes[shared[0]]}; give parts of "
            "it that lie apart, or leave out second and second_faces for self-contact: lips of a crack, which share "
            "their tip, touch each other with first_faces='all'"
        )


def check_skin(contact: Contact, body: MeshBody, faces: str | Faces) -> None:
    """Refuse faces that look inwards, and of beams and shells what only solids can do."""
    if type(body).skin is MeshBody.skin:
        check_faces(body, body.faces(faces), contact.label)
        return
    body.skin(faces)
    if contact.condensed or contact.initial == "resolve":
        what = "condensed=True" if contact.condensed else "initial='resolve'"
        raise InputError(
            f"{contact.label}: {what} is for nodes of solids, and {body.label} is touched beside its nodes; leave it "
            "out" + ("" if contact.condensed else " and move one of the bodies")
        )


def check_faces(body: MeshBody, faces: Faces, label: str) -> None:
    """Refuse faces that look into the cells they belong to."""
    for kind, points in zip(faces.cells, body.face_points(faces), strict=True):
        centres = body.points[points.nodes].mean(axis=1)
        inner = np.pad(body.grid.centres[faces.owners[kind]], ((0, 0), (0, 3 - body.dimension)))
        outwards = np.einsum("mc,mc->m", points.normal.mean(axis=1), centres - inner)
        if np.any(outwards < 0):
            place = ", ".join(f"{c:.4g}" for c in centres[np.argmin(outwards)])
            raise InputError(
                f"{label}: the face of {body.label} near ({place}) looks into the solid; reverse its nodes"
            )


def check_stiffness(label: str, given: float, own: float, right: float) -> None:
    """Refuse a penalty that has nothing to do with the bodies' `own` stiffness; `right` is one that does."""
    if not SOFTEST * own <= given <= STIFFEST * own:
        what = "bodies would pass through each other" if given < own else "it swamps the bodies' stiffness"
        raise InputError(
            f"{label}: stiffness = {given:.3g} of the penalty is {given / own:.1g} times that of a layer of elements: "
            f"{what}; about {right:.2g} is right, which is the default"
        )


def refuse_overlap(contact: Contact, places: Array) -> None:
    """Refuse surfaces that overlap: `places` (n, 3) in space are the vertices of the first one."""
    depth = -np.nan_to_num(contact.gaps)
    worst = int(np.argmax(depth))
    if depth[worst] > DEEP * contact.extent:
        place = ", ".join(f"{c:.4g}" for c in places[worst])
        other = "itself" if contact.second is None else contact.second.label
        raise InputError(
            f"{contact.label}: {contact.first.label} and {other} overlap by {depth[worst]:.3g} near "
            f"({place}) at the start; move one of them, or give initial='press' to start under the pressure that this "
            "overlap makes, or 'resolve' to move nodes apart"
        )
