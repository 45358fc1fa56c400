"""How many public names classes add to what they derive from: those that a reader has to know at once."""

from __future__ import annotations

from typing import Any

import pytest
from sizes import added, defined

import visviva as vv
from visviva.body.mesh_body import MeshBody


def composed() -> list[Any]:
    """Solids of all formulations, which have what they get in a system."""
    mesh, rubber = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), vv.NeoHooke(young=1.0, poisson=0.3)
    kinds = ("displacement", "F-bar", "enhanced", "mixed")
    solids = [vv.Solid(mesh=mesh, material=rubber, formulation=kind) for kind in kinds]
    vv.System(list(solids))
    return solids


def test_solids_define_few_names() -> None:
    """Their arguments, what they do to those of a mesh body, and what they have on their own."""
    known = {name for base in vv.Solid.__mro__[1:] for name in defined(base)}
    instances = {name for solid in composed() for name in vars(solid) if not name.startswith("_")}
    assert len(defined(vv.Solid) | (instances - known)) <= 25


@pytest.mark.parametrize("cls", [vv.Solid, MeshBody], ids=lambda cls: cls.__name__)
def test_classes_add_few_names(cls: type) -> None:
    assert len(added(cls)) <= 25
