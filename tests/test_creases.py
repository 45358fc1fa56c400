"""Sharp edges of surfaces, whose sides have vertices of their own."""

from __future__ import annotations

import numpy as np
import pytest

import visviva as vv
from visviva.contact.contact_surface import Surface
from visviva.contact.creases import SMOOTH_RIGID, creased

RUBBER = vv.NeoHooke(young=1e6, poisson=0.0)


def boundary(shape: vv.Box | vv.Cylinder, name: str = "all") -> Surface:
    points, facets = shape.facets()
    forms = [[(3 * v, 1.0)] for v in range(len(points))]
    chosen = facets if name == "all" else facets[shape.faces[name]]
    return Surface(forms, False, np.zeros_like(points), chosen, points, 3)


def test_a_box_has_four_vertices_on_each_side_and_a_round_shape_only_at_its_rims() -> None:
    cube = boundary(vv.Box(size=(1, 2, 3)))
    split = creased(cube, SMOOTH_RIGID)
    assert len(cube.forms) == 8
    assert len(split.forms) == 24
    assert split.source is not None
    assert (split.places == cube.places[split.source]).all()
    used = split.facets >= 0
    assert (split.source[split.facets[used]] == cube.facets[used]).all()
    assert split.areas.sum() == pytest.approx(22.0)
    can = boundary(vv.Cylinder(radius=1, length=2))
    assert len(creased(can, SMOOTH_RIGID).forms) == len(can.forms) + 64


def test_what_has_no_sharp_edge_stays_as_it_is() -> None:
    box = boundary(vv.Box(size=(1, 2, 3)), "z0")
    assert creased(box, SMOOTH_RIGID) is box


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("faces", ["all", "named"])
def test_elastic_block_is_braked_by_mu_g(dimension: int, faces: str) -> None:
    """With all of its boundary as with its lower side alone; it was 1.31 mu g, of the mean normals at its edges."""
    if dimension == 3:
        mesh, slab = (
            vv.BoxMesh(size=(0.2, 0.15, 0.1), counts=(2, 2, 1)),
            vv.BoxMesh(size=(1, 1, 0.1), counts=(1, 1, 1)),
        )
        upper, lower, sides = mesh.build(), slab.build().moved((-0.3, -0.4, -0.1)), ("z0", "z1")
    else:
        upper = vv.RectangleMesh(size=(0.2, 0.1), counts=(2, 1)).build()
        lower = vv.RectangleMesh(size=(1, 0.1), counts=(1, 1)).build().moved((-0.3, -0.1))
        sides = ("y0", "y1")
    block = vv.Solid(mesh=upper, material=RUBBER, density=1000.0, velocity=(1, 0, 0), stiffness_damping=1e-3)
    floor = vv.Solid(mesh=lower, material=RUBBER, density=1000.0)
    named = {} if faces == "all" else dict(zip(("first_faces", "second_faces"), sides, strict=True))
    contact = vv.Contact(first=block, second=floor, friction=0.3, **named)
    weight = vv.Gravity(acceleration=(0, 0, -10) if dimension == 3 else (0, -10, 0))
    system = vv.System([block, floor, vv.Fixed(solid=floor, nodes="all"), contact, weight])
    mass, before = 1000.0 * 0.2 * 0.1 * (0.15 if dimension == 3 else 1.0), 0.1
    result = vv.simulate(system, until=before, step=0.002)
    lost = result.ledger["momentum_x"][0] - result.ledger["momentum_x"][-1]
    assert lost == pytest.approx(0.3 * 10 * mass * before, rel=2e-3)
    assert contact.record(system.x).shape == (
        len(block.faces("all" if faces == "all" else sides[0]).nodes)
        + len(floor.faces("all" if faces == "all" else sides[1]).nodes),
        6,
    )
    assert np.isfinite(vv.ContactGap(contact=contact, at=(0, 0, 0))(system))
    assert vv.ContactPressure(contact=contact, at=(0.2, 0, 0))(system) > 0


def test_overlaps_are_resolved_with_sharp_edges_that_rub() -> None:
    upper = vv.BoxMesh(size=(0.2, 0.15, 0.1), counts=(2, 2, 1)).build().moved((0, 0, -0.001))
    lower = vv.BoxMesh(size=(1, 1, 0.1), counts=(1, 1, 1)).build().moved((-0.3, -0.4, -0.1))
    block = vv.Solid(mesh=upper, material=RUBBER, density=1000.0)
    floor = vv.Solid(mesh=lower, material=RUBBER, density=1000.0)
    contact = vv.Contact(first=block, second=floor, friction=0.3, initial="resolve")
    system = vv.System([block, floor, vv.Fixed(solid=floor, nodes="all"), contact])
    assert contact.moved == pytest.approx(0.001, rel=1e-6)
    vv.simulate(system, until=0.01, step=0.005)
