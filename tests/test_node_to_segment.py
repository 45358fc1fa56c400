"""Contact of vertices with facets: distances, sliding over edges, conservation, objectivity."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from catalogue.rigid import turned
from numpy.typing import NDArray
from point_contacts import RUBBER, blocks, wavy_track

import visviva as vv

Array = NDArray[np.float64]


def distance_to_line(x: Array, line: Array) -> Array:
    """Signed distances (n,) of points (n, 2) to a line through points (m, 2) from left to right, above positive."""
    a, e = line[:-1], np.diff(line, axis=0)
    along = np.clip(np.einsum("nmk,mk->nm", x[:, None] - a, e) / (e * e).sum(axis=1), 0, 1)
    away = np.linalg.norm(x[:, None] - a - along[:, :, None] * e, axis=2).min(axis=1)
    return np.sign(x[:, 1] - np.interp(x[:, 0], *line.T)) * away


@pytest.mark.parametrize("enforcement", ["multipliers", "penalty"])
def test_sliding_over_edges(enforcement: str) -> None:
    """On a track with convex and concave edges the gap is the distance to the track, contact is not lost and
    energy is exact, with the potential of the load."""
    parts = wavy_track(enforcement, flat=True)
    track, slider, *_, contact = parts
    top = track.faces("y1").nodes
    top = top[np.argsort(track.points[top, 0])]
    bottom = slider.faces("y0").nodes
    depths, forces = [], []

    def observe(system: vv.System) -> None:
        line, x = (
            system.x[s.node_unknowns(n)[:, None] + [0, 1]] for s, n in ((track, top), (slider, bottom))
        )
        expected = distance_to_line(x, line)
        assert np.abs(contact.gaps - expected).max() < 1e-12
        depths.append(-expected.min())
        forces.append(contact.pressures.sum())

    system = vv.System(parts, vv.Newton(tolerance=1e-13))
    result = vv.simulate(system, until=1.2, step=0.04, observe=observe)
    result.assert_conserved("energy", tolerance=1e-10)
    x = system.x[slider.node_unknowns(bottom)]
    assert (x > slider.points[bottom, 0] + 0.9).all()  # three facets farther
    assert max(depths) < 0.02
    assert np.mean(np.array(forces[3:]) > 0) > 0.85  # it lands in the third step and hardly leaves again


def test_blocks_collide_objectively() -> None:
    """The turned and shifted system moves turned and shifted."""
    R, shift = turned(7), np.array([0.4, -1.1, 0.7])
    ends, touched = [], False
    for parts in (blocks(), blocks(turn=R, shift=shift)):
        system = vv.System(parts, vv.Newton(tolerance=1e-14))
        for _ in vv.march(system, until=0.1, step=0.02):
            touched |= bool(parts[2].pressures.max() > 0)
        nodes = parts[0].node_unknowns(np.arange(parts[0].grid.n_nodes))
        ends.append(system.x[nodes[:, None] + np.arange(3)])
        assert touched
    assert np.abs(ends[0] @ R.T + shift - ends[1]).max() < 1e-12


def test_patch() -> None:
    """Two layers pressed together: the pressure of meshes that do not match is constant with mortar, to some
    percent with vertices; their force is that of the stress in the column."""
    spread, force = {}, {}
    for formulation in ("mortar", "node-to-segment"):
        lower = vv.RectangleMesh(size=(1.0, 1.0), counts=(3, 2)).build()
        upper = vv.RectangleMesh(size=(1.0, 1.0), counts=(4, 2), origin=(0.0, 1.0)).build()
        one, two = (vv.Solid(mesh=m, material=RUBBER, density=1.0) for m in (upper, lower))
        contact = vv.Contact(
            first=one, first_faces="y0", second=two, second_faces="y1", formulation=formulation
        )
        held = [
            vv.SymmetryPlane(solid=two, nodes="y0", normal=(0, 1, 0)),
            vv.SymmetryPlane(solid=one, nodes="x0", normal=(1, 0, 0)),
            vv.SymmetryPlane(solid=two, nodes="x0", normal=(1, 0, 0)),
            vv.Prescribed(solid=one, nodes="y1", motion=(None, "-0.1*t", None)),
        ]
        system = vv.System([one, two, contact, *held])
        vv.quasi_static(system, until=1.0, step=1.0)
        spread[formulation] = np.ptp(one.nodal("von_mises", system.x))
        force[formulation] = contact.pressures @ [0.125, 0.25, 0.25, 0.25, 0.125]
    assert spread["mortar"] < 1e-11
    assert 0.01 < spread["node-to-segment"] < 0.1 * force["mortar"]
    assert abs(force["node-to-segment"] / force["mortar"] - 1) < 0.03


def test_distance_beyond_a_border() -> None:
    """From the side of a body that is rounded off with half an edge beyond the border of its surface."""
    R, gaps, expected = 0.5, [], []
    beside = -0.37, 0.4  # below zero: above the face as far as this direction goes
    for x, height, aside in product((1.2, 2.0, 2.3, 2.7), (-0.9, -0.2, 0.2), beside):
        rho = np.hypot(max(x - 2, 0.0), max(aside, 0.0))
        if np.hypot(rho, height) > 1.2:
            continue  # too far to be seen
        body = vv.Solid(
            mesh=vv.BoxMesh(size=(2, 1, 1), counts=(2, 1, 1)).build(), material=RUBBER, density=1.0
        )
        particle = vv.PointMass(mass=1.0, position=(x, -aside, 1 + height))
        contact = vv.Contact(
            first=particle,
            second=body,
            second_faces="z1",
            formulation="node-to-segment",
            enforcement="penalty",
            initial="press",
        )
        vv.simulate(vv.System([particle, body, contact]), until=1e-7, step=1e-7)
        gaps.append(contact.gaps[0])
        expected.append(height if rho == 0 else rho - R if height < -R else np.hypot(rho, height + R) - R)
    assert min(expected) < -0.8
    np.testing.assert_allclose(gaps, expected, atol=1e-9)


@pytest.mark.parametrize("n", [2, 3, 4])
def test_ends_that_slide_off_each_other(n: int) -> None:
    """Bars pushed together and aside: vertices slide over the border, and what the supports do is all stored."""
    bars = []
    for x in (0, 2):
        mesh = vv.RectangleMesh(size=(2, 1), counts=(2 * n, n), origin=(x, 0)).build()
        bars.append(vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1000.0, poisson=0.3)))
    left, right = bars
    contact = vv.Contact(
        first=left, first_faces="x1", second=right, second_faces="x0", formulation="node-to-segment"
    )
    push = vv.Prescribed(solid=left, nodes="x0", motion=("0.1 * t", "0.05 * t", None))
    system = vv.System([left, right, contact, push, vv.Fixed(solid=right, nodes="x1")])
    beyond, forces = [], []
    for k in range(20):
        vv.quasi_static(system, until=(k + 1) / 20, step=1 / 20)
        tips = [
            bar.positions(system.x)[bar.faces(side).nodes, 1].max()
            for bar, side in ((left, "x1"), (right, "x0"))
        ]
        beyond.append(tips[0] - tips[1])
        forces.append(np.linalg.norm(vv.ContactForce(contact=contact)(system)))
    assert beyond[-1] > 0.02
    assert np.abs(np.diff(forces, 2)).max() < 0.02 * forces[-1]
    assert contact.pressures.min() > 0


def pressed(formulation: str, upper: int, lower: int, width: float, down: float) -> list[vv.Component]:
    """A block of so many facets a side pressed on another one; many of its vertices are above edges of facets."""
    counts = [(k, k, 2) for k in (lower, upper)]
    low = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=counts[0]), material=RUBBER, density=1.0)
    place = ((1 - width) / 2, (1 - width) / 2, 1)
    mesh = vv.BoxMesh(size=(width, width, 1), counts=counts[1], origin=place)
    high = vv.Solid(mesh=mesh, material=RUBBER, density=1.0)
    faces = {"first": high, "first_faces": "z0", "second": low, "second_faces": "z1"}
    contact = vv.Contact(**faces, formulation=formulation, name="press")
    push = vv.Prescribed(
        solid=high, nodes="z1", motion=(lambda t: 0.0 * t, lambda t: 0.0 * t, lambda t: -down * t)
    )
    return [low, high, contact, push, vv.Fixed(solid=low, nodes="z0")]


@pytest.mark.parametrize(
    ("upper", "lower", "width"), [(4, 3, 1.0), (5, 3, 1.0), (4, 3, 0.6), (3, 4, 0.6), (4, 4, 0.6)]
)
def test_statics_of_vertices_in_valleys_between_facets(upper: int, lower: int, width: float) -> None:
    """The facets' pressures push such a vertex to each other; mortar tells the force, to what the meshes allow."""
    forces = []
    for formulation in ("node-to-segment", "mortar"):
        parts = pressed(formulation, upper, lower, width, down=0.05)
        system = vv.System(parts)
        vv.quasi_static(system, until=1.0, step=0.1)
        assert system.stepper.rejected == 0
        assert isinstance(parts[2], vv.Contact)
        forces.append(parts[2].forces.sum(axis=0))
    node, mortar = forces
    assert node[2] == pytest.approx(mortar[2], rel=0.025)
    assert np.abs(node[:2]).max() < 5e-3 * node[2]  # the facets' slopes; by symmetry there is none


def test_vertices_that_go_to_and_fro_are_named() -> None:
    system = vv.System(pressed("node-to-segment", 3, 4, 0.6, down=0.3))
    cure = r"Contact 'press' still goes to and fro between facets at 2 vertices, such as near \(0.8.*'mortar'"
    with pytest.raises(vv.RunError, match=cure):
        vv.quasi_static(system, until=1.0, step=0.1)
    assert system.time > 0.3
