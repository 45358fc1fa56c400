"""Contact that slides far: ironing without jumps from facet to facet."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]


# --- ironing ------------------------------------------------------------------------------------------------
def shell(dimension: int, around: int, width: float = 5.2) -> vv.Mesh:
    """The lower half of a tube of radius 3 and thickness 0.2, its axis along y and through the origin."""
    if dimension == 3:
        unit = vv.BoxMesh(size=(1, 1, 1), counts=(around, 4, 1)).build()
        u, y, r = unit.points.T
    else:
        unit = vv.RectangleMesh(size=(1, 1), counts=(around, 1)).build()
        u, r = unit.points.T
    angle, radius = np.pi * (1 + u), 2.8 + 0.2 * (1 - r)
    places = [radius * np.cos(angle), radius * np.sin(angle)]
    points = np.column_stack(places if dimension == 2 else [places[0], width * (y - 0.5), places[1]])
    return vv.Mesh(points, unit.cells, face_sets=unit.face_sets)


def ironing(
    dimension: int, n: int, depth: float, slide: float, steps: int, aside: float = 0.0, **options: Any
) -> tuple[Array, Array]:
    """Places of the die and forces (2,) across and along its way while it slides on a slab (Puso & Laursen 2004).

    Slab of E = 1, nu = 0.3 with `n` cells by unit length, die of E = 1000, nu = 0.499, neo-Hooke; the plane case is
    longer, so that the force could be constant. In space the die may be off the middle, `aside` along y.
    """
    length, up = (9.0, 2) if dimension == 3 else (12.0, 1)
    size = (length, 4.0, 3.0) if dimension == 3 else (length, 3.0)
    counts = tuple(int(n * s) for s in size)
    shape: Any = vv.BoxMesh if dimension == 3 else vv.RectangleMesh
    slab_mesh = shape(size=size, counts=counts).build()
    start = np.array((2.5, 2.0 + aside, 6.0)) if dimension == 3 else np.array((4.0, 6.0))
    die_mesh = shell(dimension, int(8 * n)).moved(start)
    slab = vv.Solid(mesh=slab_mesh, material=vv.NeoHooke(young=1.0, poisson=0.3))
    die = vv.Solid(mesh=die_mesh, material=vv.NeoHooke(young=1000.0, poisson=0.499))
    axis = "xyz"[up]
    contact = vv.Contact(first=slab, first_faces=f"{axis}1", second=die, second_faces=f"{axis}0", **options)

    def motion(t: float, X: Array) -> Array:
        u = np.zeros((len(X), 3))
        u[:, up], u[:, 0] = -depth * min(t, 1.0), slide * max(t - 1.0, 0.0)
        return u

    rims = np.union1d(die.nodes("x0"), die.nodes("x1"))
    hold = vv.Prescribed(solid=die, nodes=rims, motion=motion)
    system = vv.System([slab, die, contact, vv.Fixed(solid=slab, nodes=f"{axis}0"), hold])
    vv.quasi_static(system, until=1.0, step=0.1)
    places, forces = [], []
    for k in range(steps):
        vv.quasi_static(system, until=1 + (k + 1) / steps, step=1 / steps)
        force = -vv.ContactForce(contact=contact)(system)
        places.append(slide * (k + 1) / steps), forces.append([force[up], force[0]])
    return np.array(places), np.array(forces)


def ripple(places: Array, forces: Array) -> tuple[float, float]:
    """What is left of the forces after a smooth curve: largest part of the mean normal force, across and along."""
    mean = np.abs(forces[:, 0]).mean()
    smooth = [np.polynomial.Polynomial.fit(places, f, 4)(places) for f in forces.T]
    across, along = (float(np.abs(f - s).max() / mean) for f, s in zip(forces.T, smooth, strict=True))
    return across, along


def test_ironing_has_no_jumps() -> None:
    """The die passes four facets: with mortar forces stay within 1.5 % of smooth curves; with vertices the force along
    the way, which should vanish, jumps by a tenfold."""
    ripples = {}
    for formulation in ("mortar", "node-to-segment"):
        places, forces = ironing(2, 2, 0.7, 2.0, 40, formulation=formulation)
        assert forces[:, 0].mean() > 0.9
        ripples[formulation] = ripple(places, forces)
    across, along = ripples["mortar"]
    assert across < 0.015
    assert along < 0.005
    assert along < 0.1 * ripples["node-to-segment"][1]


def test_ironing_in_space() -> None:
    """Puso & Laursen's die passes a facet and a half of a coarse slab: forces stay within 1.5 % of smooth curves, and
    none is left along the way."""
    places, forces = ironing(3, 1, 0.7, 1.5, 12)
    assert forces[:, 0].mean() > 3.0
    assert max(ripple(places, forces)) < 0.015
    assert abs(forces[:, 1].mean()) < 0.005 * forces[:, 0].mean()


def test_ironing_in_space_with_vertices() -> None:
    """The same with vertices, beside the middle, where a row of them would lie in the valley between two facets of the
    die: there the closest facet, and with it the direction of the force, changes from iteration to iteration."""
    kinds = ({"formulation": "node-to-segment", "aside": 0.13}, {"aside": 0.13})
    (places, forces), (_, smooth) = (ironing(3, 1, 0.7, 1.5, 12, **kind) for kind in kinds)
    assert max(ripple(places, forces)) < 0.15
    assert forces[:, 0].mean() == pytest.approx(smooth[:, 0].mean(), rel=0.1)
