"""Surfaces that are in contact twice, or tied and in contact, are refused; neighbours of them are not."""

from __future__ import annotations

from typing import Any

import pytest
from contact_parts import RUBBER

import visviva as vv
from visviva.component.component import Component


def stack() -> tuple[vv.Solid, vv.Solid]:
    lower = vv.Solid(
        mesh=vv.BoxMesh(size=(2, 1, 1), counts=(2, 1, 1)), material=RUBBER, density=1.0, name="lower"
    )
    above = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 1), origin=(0, 0, 1))
    return lower, vv.Solid(mesh=above, material=RUBBER, density=1.0, name="upper")


def pair(first: vv.Solid, second: Component | None, name: str, **options: Any) -> vv.Contact:
    options = {"enforcement": "penalty", "formulation": "node-to-segment"} | options
    return vv.Contact(first=first, second=second, name=name, **options)


TWICE = r"Contact 'two' holds surfaces of Solid 'upper' and .* apart that Contact 'one' does as well: .* other faces"


@pytest.mark.parametrize("exchanged", [False, True])
@pytest.mark.parametrize("faces", [("all", "all"), ("z0", "z1"), ("z0", "all")], ids=" ".join)
def test_a_pair_in_contact_twice(faces: tuple[str, str], exchanged: bool) -> None:
    lower, upper = stack()
    ends: dict[str, Any] = {"first_faces": faces[0], "second_faces": faces[1]}
    sides: Any = (lower, upper, "one") if exchanged else (upper, lower, "one")
    one = pair(*sides, **(dict(zip(ends, reversed(faces), strict=True)) if exchanged else ends))
    with pytest.raises(vv.InputError, match=TWICE):
        vv.System([lower, upper, one, pair(upper, lower, "two", **ends)])


def test_one_surface_in_contact_with_itself_and_with_a_plane_twice() -> None:
    _, upper = stack()
    plane = vv.Plane(at=(0, 0, 0))
    for other in (None, plane):
        with pytest.raises(vv.InputError, match=TWICE):
            vv.System([upper, plane, pair(upper, other, "one"), pair(upper, other, "two")])


def test_faces_side_by_side_touch_the_same_body() -> None:
    lower, upper = stack()
    contacts = [pair(upper, lower, face, first_faces=face, second_faces="z1") for face in ("z0", "x1", "y0")]
    vv.System([lower, upper, *contacts])


@pytest.mark.parametrize("tie_first", [False, True])
@pytest.mark.parametrize("exchanged", [False, True])
def test_what_is_tied_is_not_in_contact(tie_first: bool, exchanged: bool) -> None:
    lower, upper = stack()
    tie = vv.Tie(first=upper, first_faces="z0", second=lower, second_faces="z1", name="glue")
    contact = pair(*((lower, upper) if exchanged else (upper, lower)), "two")
    parts = [lower, upper, tie, contact] if tie_first else [lower, upper, contact, tie]
    with pytest.raises(
        vv.InputError, match=r"Contact 'two' .* that Tie 'glue' ties .*: give the contact other faces"
    ):
        vv.System(parts)


def test_faces_beside_a_tie_are_in_contact() -> None:
    lower, upper = stack()
    tie = vv.Tie(first=upper, first_faces="z0", second=lower, second_faces="z1")
    vv.System([lower, upper, tie, pair(upper, lower, "side", first_faces="x1", second_faces="z1")])
