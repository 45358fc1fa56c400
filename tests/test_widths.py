"""How many public names classes add to what they derive from: those that a reader has to know at once."""

from __future__ import annotations

from typing import Any

import pytest
from sizes import added, assigned, stated, whole

import visviva as vv
from visviva.body.mesh_body import MeshBody
from visviva.model.model import Model

WHOLE = {vv.Solid: 96, vv.System: 60, Model: 43, vv.Contact: 68}
"""All public names of an instance, with those of bases: exactly, so that they only become fewer."""


def composed() -> list[Any]:
    """Solids of all formulations, which have what they get in a system."""
    mesh, rubber = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), vv.NeoHooke(young=1.0, poisson=0.3)
    kinds = ("displacement", "F-bar", "enhanced", "mixed")
    solids = [vv.Solid(mesh=mesh, material=rubber, formulation=kind) for kind in kinds]
    vv.System(list(solids))
    return solids


def test_solids_define_few_names() -> None:
    """Their arguments, what they do to those of a mesh body, and what they have on their own."""
    known = {name for base in vv.Solid.__mro__[1:] for name in stated(base)}
    instances = {*assigned(vv.Solid), *(name for solid in composed() for name in vars(solid))}
    own = {name for name in instances if not name.startswith("_")} - known
    assert len(stated(vv.Solid) | own) <= 25


@pytest.mark.parametrize("cls", [vv.Solid, MeshBody], ids=lambda cls: cls.__name__)
def test_classes_add_few_names(cls: type) -> None:
    assert len(added(cls)) <= 25


@pytest.mark.parametrize("cls", WHOLE, ids=lambda cls: cls.__name__)
def test_whole_classes_do_not_grow(cls: type) -> None:
    assert len(whole(cls)) == WHOLE[cls]
