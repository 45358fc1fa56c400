"""Beams: their shapes, sections, frames, joints; what is refused."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from visviva.body.beam_line import BeamLine

Array = NDArray[np.float64]
ROD = vv.TubeSection(radius=0.1, young=1e4, poisson=0.25, density=2.0)
SOFT = vv.GivenSection(stiffness=(200, 180, 300, 5, 4, 3), mass=1.0, moments=(0.03, 0.02, 0.0))


def bar(count: int = 4, cell: str = "line2", length: float = 2.0, **options: Any) -> vv.Beam:
    mesh = vv.LineMesh(points=[(0, 0, 0), (length, 0, 0)], count=count, cell=cell)
    return vv.Beam(mesh=mesh, **{"section": ROD} | options)


SHEET = vv.HomogeneousSection(thickness=0.1, young=1e4, density=2.0)
POINTS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (2, 0, 0), (2, 1, 0)]
TURNED = vv.Mesh(POINTS, {"quad4": [(0, 1, 2, 3), (2, 7, 6, 1)]})
FOLDED = vv.Mesh(POINTS, {"quad4": [(0, 1, 2, 3), (1, 0, 4, 5)]})
TWISTED = vv.Mesh(POINTS[:4], {"quad4": [(0, 1, 3, 2)]})


def sheet(**options: Any) -> vv.Shell:
    flat = vv.RectangleMesh(size=(1, 1), counts=(2, 2))
    return vv.Shell(**{"mesh": flat, "section": SHEET} | options)


# --- sections -----------------------------------------------------------------------------------------------
def integrated(corners: Any, hole: Any = None) -> tuple[float, float, float]:
    """Area and integrals of a^2 and b^2 over a polygon with a hole, by Green's theorem."""

    def of(p: Array) -> Array:
        (a, b), (c, d) = p.T, np.roll(p, -1, axis=0).T
        w = a * d - c * b
        return np.array(
            [w.sum() / 2, (w * (a * a + a * c + c * c)).sum() / 12, (w * (b * b + b * d + d * d)).sum() / 12]
        )

    found = of(np.array(corners, dtype=float)) - (0.0 if hole is None else of(np.array(hole, dtype=float)))
    return tuple(found.tolist())


def rectangle(w: float, h: float) -> list[tuple[float, float]]:
    return [(-w / 2, -h / 2), (w / 2, -h / 2), (w / 2, h / 2), (-w / 2, h / 2)]


STEEL = {"young": 3.0, "poisson": 0.25, "density": 7.0}


@pytest.mark.parametrize(
    ("section", "hole"),
    [
        (vv.RectangleSection(width=0.3, height=0.8, **STEEL), None),
        (vv.BoxSection(width=0.3, height=0.8, thickness=0.05, **STEEL), rectangle(0.2, 0.7)),
        (vv.ISection(width=0.4, height=0.9, flange=0.1, web=0.06, **STEEL), None),
    ],
    ids=lambda value: type(value).__name__,
)
def test_areas_and_moments_are_those_of_the_contour(section: Any, hole: Any) -> None:
    area, aa, bb = integrated(section.contour(), hole)
    C, (mass, centre, moments) = section.stiffness_matrix(), section.inertia()
    assert C[2, 2] == pytest.approx(3.0 * area)
    assert (C[3, 3], C[4, 4]) == pytest.approx((3.0 * bb, 3.0 * aa))
    assert mass == pytest.approx(7.0 * area)
    np.testing.assert_allclose(moments, 7.0 * np.diag([aa, bb]), rtol=1e-12)
    np.testing.assert_array_equal(centre, 0.0)


def test_tube() -> None:
    C = vv.TubeSection(radius=0.5, thickness=0.1, young=3.0).stiffness_matrix()
    area, polar = np.pi * (0.25 - 0.16), np.pi / 2 * (0.5**4 - 0.4**4)
    np.testing.assert_allclose(C.diagonal()[2:], [3 * area, 1.5 * polar, 1.5 * polar, 1.5 * polar])


@pytest.mark.parametrize(("ratio", "factor"), [(1.0, 0.140577), (2.0, 0.228682), (10.0, 0.312325)])
def test_torsion_of_rectangles(ratio: float, factor: float) -> None:
    """Of long side times the cube of the short one (Timoshenko & Goodier, table of article 109)."""
    for sides in ((ratio, 1.0), (1.0, ratio)):
        section = vv.RectangleSection(width=sides[0], height=sides[1], young=2.0)
        assert section.stiffness_matrix()[5, 5] == pytest.approx(factor * ratio, rel=5e-6)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: vv.GivenSection(stiffness=(1, 1, 1, 1, 1)), "stiffness"),
        (lambda: vv.GivenSection(stiffness=(1, 1, 0, 1, 1, 1)), "not positive"),
        (lambda: vv.GivenSection(stiffness=np.diag([1.0, 1, 1, 1, 1, 1]) - 1.1 * np.eye(6, k=1)), "not symmetric"),
        (lambda: vv.GivenSection(stiffness=np.ones((6, 6))), "not positive"),
        (lambda: vv.GivenSection(stiffness=(1,) * 6, mass=1.0, moments=(1, 1, 2)), "no distribution"),
        (lambda: vv.RectangleSection(width=-1, height=1, young=1.0), "width"),
        (lambda: vv.TubeSection(radius=1, thickness=2, young=1.0), "more than the radius"),
        (lambda: vv.BoxSection(width=1, height=1, thickness=0.5, young=1.0), "leave nothing"),
        (lambda: vv.ISection(width=1, height=1, flange=0.1, web=2, young=1.0), "wider than its flanges"),
        (lambda: vv.LineMesh(points=[(0, 0, 0), (0, 0, 0)]), "points 0 and 1 are the same"),
        (lambda: vv.ArcMesh(radius=1, angle=7.0), "gives no arc"),
        (lambda: vv.ArcMesh(radius=1, angle=1, axis=(1, 0, 0)), "along axis"),
        (lambda: bar(first=(1, 0, 0)), "along the line at node 0"),
        (lambda: bar(section=(ROD, ROD)), "2 sections for 4 cells"),
        (lambda: vv.Beam(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), section=ROD), "needs lines"),
        (
            lambda: vv.Beam(mesh=vv.Mesh([(0, 0, 0), (0, 0, 0)], {"line2": [(0, 1)]}), section=ROD),
            "cell 0 of its mesh",
        ),
        (
            lambda: vv.Beam(mesh=vv.Mesh([(0, 0, 0), (1, 0, 0), (1, 1, 0)], {"line2": [(0, 1), (1, 2)]}), section=ROD),
            "kink or a branch at node 1",
        ),
        (lambda: bar().frame(2.1), "arc length 2.1 is not between 0 and 2"),
        (lambda: bar().line.place(np.array([2.5, 0, 0]), "Beam"), "lies 0.5 beyond its end"),
        (lambda: vv.LineLoad(beam=bar()), "neither force nor moment"),
        (lambda: vv.BodyForce(solid=bar(), force=(0, 0, 1)), "give a beam a vv.LineLoad"),
        (lambda: vv.SectionForce(solid=bar(), point=(1, 0, 0), normal=(1, 0, 0)), "vv.Resultants"),
        (lambda: sheet(mesh=vv.RectangleMesh(size=(1, 1), counts=(1, 1), cell="quad8")), "needs tri3, tri6"),
        (lambda: sheet(section=(SHEET, SHEET)), "2 sections for 4 cells"),
        (lambda: sheet(first=(0, 0, 1)), "first is across its surface"),
        (lambda: vv.Shell(mesh=TURNED, section=SHEET), "upper sides on different sides"),
        (lambda: vv.Shell(mesh=FOLDED, section=SHEET), "has a kink or a branch at node"),
        (lambda: vv.Shell(mesh=TWISTED, section=SHEET), "is folded or inverted"),
        (lambda: vv.Laminate(plies=()), "needs a ply"),
        (lambda: vv.Ply(thickness=1, young=1, across=10, poisson=0.4), "too large"),
        (
            lambda: vv.Clamped(
                solid=vv.Solid(
                    mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), material=vv.NeoHooke(young=1, poisson=0)
                ),
                nodes="x0",
            ),
            "no directors to hold",
        ),
    ],
)  # fmt: skip
def test_refused(make: Any, message: str) -> None:
    with pytest.raises(vv.InputError, match=message):
        make()


# --- lines --------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("cell", ["line2", "line3"])
def test_triads_are_orthonormal_along_the_line(cell: str) -> None:
    mesh = vv.ArcMesh(radius=2.0, angle=9.0, rise=3.0, count=40, cell=cell)
    line: BeamLine = vv.Beam(mesh=mesh, section=ROD).line
    products = line.triads @ line.triads.transpose(0, 2, 1)
    np.testing.assert_allclose(products, np.broadcast_to(np.eye(3), products.shape), atol=1e-14)
    assert np.linalg.det(line.triads).min() > 0
    np.testing.assert_array_equal(line.turns, np.broadcast_to(np.eye(3), line.turns.shape))
    along = 2.0 * np.array([-np.sin(4.5), np.cos(4.5), 0]) + np.array([0, 0, 3.0 / 9.0])
    middle = len(line.points) // 2
    np.testing.assert_allclose(line.triads[middle, 2], along / np.linalg.norm(along), atol=2e-3)
    assert line.lengths.sum() == pytest.approx(9.0 * np.hypot(2.0, 3.0 / 9.0), rel=3e-3)


def test_carried_directors_do_not_turn_about_the_line() -> None:
    """Along a circle d1 stays what it is across the plane, and in it turns with the tangent."""
    line = vv.Beam(mesh=vv.ArcMesh(radius=1.0, angle=3.0, count=12), section=ROD).line
    across = np.abs(line.triads[:, :2, 2]).max(axis=1)
    np.testing.assert_allclose(across, 1.0, atol=1e-12)


def test_arc_length_is_that_of_the_line_whatever_the_order_of_cells() -> None:
    points = [(0, 0, 0), (1, 0, 0), (3, 0, 0), (6, 0, 0)]
    beam = vv.Beam(mesh=vv.Mesh(points, {"line2": [(3, 2), (0, 1), (1, 2)]}), section=ROD)
    for s, x in ((0.0, 6.0), (1.0, 5.0), (3.5, 2.5), (6.0, 0.0)):
        np.testing.assert_allclose(beam.at(s), (x, 0, 0), atol=1e-12)


def test_points_and_frames_are_where_they_are_asked_for() -> None:
    """Anywhere along a curved beam, and beside it."""
    beam = vv.Beam(mesh=vv.ArcMesh(radius=1.0, angle=2.0, count=5, cell="line3"), section=SOFT)
    system = vv.System([beam])
    for s in (0.0, 0.37, 1.2, beam.line.lengths.sum()):
        X = beam.at(s)
        for offset in (np.zeros(3), 0.1 * beam.frame(s).axes[0], -0.2 * beam.frame(s).axes[1]):
            np.testing.assert_allclose(system.value(beam.point(X + offset).position), X + offset, atol=1e-12)
        for axis, director in zip(beam.frame(s).axes, beam.frame(s).directors, strict=True):
            np.testing.assert_allclose(system.value(director), axis, atol=1e-12)


# --- what it does -------------------------------------------------------------------------------------------
def test_mass_and_momenta_are_those_of_the_line() -> None:
    beam = bar(velocity=(0.0, 3.0, 0.0))
    system = vv.System([beam])
    assert beam.mass == pytest.approx(2.0 * ROD.inertia().mass)
    ledger = vv.simulate(system, until=0.1, step=0.1).ledger
    assert ledger["momentum_y"][0] == pytest.approx(3.0 * beam.mass)
    assert ledger["angular_z"][0] == pytest.approx(3.0 * beam.mass * 1.0)


def test_spinning_about_its_axis() -> None:
    """With polar inertia, the sum of the section's moments."""
    beam = bar(angular_velocity=(5.0, 0, 0), section=SOFT)
    ledger = vv.simulate(vv.System([beam]), until=0.1, step=0.1).ledger
    assert ledger["angular_x"][0] == pytest.approx(5.0 * 2.0 * 0.05)
    assert ledger["kinetic"][0] == pytest.approx(0.5 * 25.0 * 2.0 * 0.05)


@pytest.mark.parametrize("cell", ["line2", "line3"])
def test_a_joint_between_nodes_is_one_at_a_node_for_fine_meshes(cell: str) -> None:
    """A body hung on a hinge in the middle of a cell, or where a node is."""
    ends = []
    for count in (19, 20):
        beam = bar(count, cell, section=SOFT)
        ground = vv.Ground()
        body = vv.RigidBody(shape=vv.Box(size=(0.2, 0.2, 0.2)), density=10.0, position=(1.0, 0, -0.2))
        hinge = vv.Revolute(a=beam, b=body, at=(1.0, 0, 0), axis=(1, 0, 0))
        held = [vv.Rigid(a=ground, b=beam, at=(x, 0, 0)) for x in (0, 2)]
        system = vv.System([ground, beam, body, hinge, *held, vv.Gravity()])
        vv.simulate(system, until=0.4, step=0.01)
        ends.append(system.value(body.point().position))
    np.testing.assert_allclose(ends[0], ends[1], atol=1.5e-3 if cell == "line2" else 2e-4)


def test_frame_indifference_and_path_independence() -> None:
    """Strains feel neither a rotation by any angle nor the way there; a bent state held twice is the same."""
    beam = vv.Beam(mesh=vv.ArcMesh(radius=1.0, angle=2.0, count=4, cell="line3"), section=SOFT)
    system = vv.System([beam])
    rng = np.random.default_rng(1)
    x = system.x + 0.1 * rng.standard_normal(len(system.x))
    rotation = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    rotation *= np.linalg.det(rotation)
    n = 12 * beam.grid.n_nodes
    turned = x.copy()
    turned[:n] = (x[:n].reshape(-1, 3) @ rotation.T).ravel()
    turned[:n].reshape(-1, 4, 3)[:, 0] += (3.0, -4.0, 5.0)
    np.testing.assert_allclose(beam.strains(turned), beam.strains(x), atol=1e-13)
    ends = []
    for path in ("t", "3*t - 2*t**2", "sin(13*pi/2*t)"):
        b = bar(6, section=SOFT)
        s = vv.System(
            [
                b,
                vv.Clamped(solid=b, nodes="start"),
                vv.Force(on=b.frame(2.0), force=(0, 1.5, 2.0), times=path),
            ]
        )
        vv.quasi_static(s, until=1.0, step=0.05)
        ends.append(s.x[: 12 * 7].copy())
    np.testing.assert_allclose(ends[1], ends[0], atol=1e-10)
    np.testing.assert_allclose(ends[2], ends[0], atol=1e-10)


def test_a_rigid_corner_is_that_of_two_beams_welded() -> None:
    """An L of one mesh against two beams with a rigid joint between."""
    corner = [(0, 0, 0), (0.5, 0, 0), (1, 0, 0), (1, 0.5, 0), (1, 1, 0)]
    cells = {"line2": [(0, 1), (1, 2), (2, 3), (3, 4)]}
    whole = vv.Beam(mesh=vv.Mesh(corner, cells), section=SOFT, first=(0, 0, 1), kinks="rigid")
    parts = [
        vv.Beam(mesh=vv.LineMesh(points=ends, count=2), section=SOFT, first=(0, 0, 1))
        for ends in ([(0, 0, 0), (1, 0, 0)], [(1, 0, 0), (1, 1, 0)])
    ]
    tips = []
    for beams in ([whole], parts):
        joint = [vv.Rigid(a=beams[0], b=beams[1], at=(1, 0, 0))] if len(beams) > 1 else []
        pull = vv.Force(on=beams[-1].point((1, 1, 0)), force=(0.3, 0.2, 1.0), times="t")
        clamp = vv.Clamped(solid=beams[0], nodes=[0])
        system = vv.System([*beams, *joint, pull, clamp])
        vv.quasi_static(system, until=1.0, step=0.25)
        tips.append(system.value(beams[-1].point((1, 1, 0)).position))
    np.testing.assert_allclose(tips[0], tips[1], atol=1e-9)


def test_resultants_balance_the_load() -> None:
    """Of a cantilever under a force across it and a moment about it: constant forces, linear moments."""
    beam = bar(8, section=ROD)
    tip = beam.frame(2.0)
    loads = vv.Force(on=tip, force=(0, 1e-4, 0)), vv.Torque(on=tip, torque=(2e-4, 0, 0))
    system = vv.System([beam, vv.Clamped(solid=beam, nodes="start"), *loads])
    vv.quasi_static(system, until=1.0, step=1.0)
    found, D = beam.resultants(system.x)[:, 0], beam.directors(system.x)[:-1]
    space = np.einsum("mi,mic->mc", found[:, :3], D), np.einsum("mi,mic->mc", found[:, 3:], D)
    s = 0.125 + 0.25 * np.arange(8)
    at_nodes = beam.smoothed(["section_moment"], system.x)["section_moment"]
    np.testing.assert_allclose(at_nodes[1:-1], (found[1:, 3:] + found[:-1, 3:]) / 2, rtol=1e-12)
    np.testing.assert_allclose(space[0], np.tile([0, 1e-4, 0], (8, 1)), atol=1e-8)
    np.testing.assert_allclose(space[1], np.stack([0 * s + 2e-4, 0 * s, 1e-4 * (2 - s)], axis=1), atol=1e-8)


def test_resultants_of_a_closed_ring_are_asked_for_by_places() -> None:
    """Pulled apart by P at both ends of a diameter: P / 2 and P R (1/2 - 1/pi) a quarter around, P R / pi under it."""
    a = 2 * np.pi * np.arange(64) / 64
    cells = np.stack([np.arange(64), np.roll(np.arange(64), -1)], axis=1)
    ring = vv.Beam(
        mesh=vv.Mesh(np.stack([np.cos(a), np.sin(a), 0 * a], axis=1), {"line2": cells}),
        section=vv.RectangleSection(width=0.01, height=0.01, young=1e9, poisson=0.3),
    )
    ends = [
        vv.Force(on=ring.frame(ring.points[k]), force=(sign * 1e-3, 0, 0), times="t")
        for k, sign in ((0, 1.0), (32, -1.0))
    ]
    held = [
        vv.Fixed(solid=ring, nodes="all", directions=(False, False, True)),
        vv.Fixed(solid=ring, nodes=[0, 32], directions=(False, True, False)),
        vv.Fixed(solid=ring, nodes=[16, 48], directions=(True, False, False)),
    ]
    system = vv.System([ring, *ends, *held])
    vv.quasi_static(system, until=1.0, step=1.0)
    aside = vv.Resultants(beam=ring, at=(0.0, 1.0, 0.0))(system)
    assert aside[2] == pytest.approx(0.5e-3, rel=5e-3)
    assert np.linalg.norm(aside[3:]) == pytest.approx(1e-3 * (0.5 - 1 / np.pi), rel=0.02)
    under = vv.Resultants(beam=ring, at=0.5 * (ring.points[0] + ring.points[1]))(system)
    assert np.linalg.norm(under[3:]) == pytest.approx(1e-3 * (1 / np.pi - 0.5 * np.sin(np.pi / 64)), rel=0.02)
    with pytest.raises(vv.InputError, match="say places by their positions"):
        vv.Resultants(beam=ring, at=0.5)


def test_probes_of_a_clamped_beam() -> None:
    """Support and section carry the same, at rest and, of the support, with the inertia of what swings."""
    beam = bar(8, "line3")
    loads = vv.Force(on=beam.frame(2.0), force=(1e-4, 2e-4, 3e-4)), vv.LineLoad(beam=beam, force=(0, 0, 1e-4))
    system = vv.System([beam, vv.Clamped(solid=beam, nodes="start"), *loads])
    vv.quasi_static(system, until=1.0, step=1.0)
    np.testing.assert_allclose(
        vv.SupportForce(solid=beam, nodes="start")(system), (-1e-4, -2e-4, -5e-4), atol=1e-12
    )
    tip = beam.positions(system.x)[-1]
    arms = np.cross(tip, (1e-4, 2e-4, 3e-4)) + np.cross((1, 0, 0), (0, 0, 2e-4))
    torque = vv.SupportTorque(solid=beam, nodes="start")(system)
    np.testing.assert_allclose(torque, -arms, rtol=1e-3, atol=1e-7)
    found = vv.Resultants(beam=beam, at=0.0)(system)
    axes = beam.frame(0.0).axes
    np.testing.assert_allclose(found[:3], axes @ (1e-4, 2e-4, 5e-4), rtol=2e-2)
    np.testing.assert_allclose(found[3:], axes @ -torque, rtol=2e-2, atol=1e-7)


def test_an_element_that_would_turn_too_far_is_named() -> None:
    """Two-node cells carry no more than E I / (2 L): a full circle takes 13 of them."""
    strip = vv.RectangleSection(width=1.0, height=0.1, young=1.2e6)
    beam = vv.Beam(mesh=vv.LineMesh(points=[(0, 0, 0), (12, 0, 0)], count=10), section=strip, first=(0, 1, 0))
    turn = vv.Torque(on=beam.frame(12.0), torque=(0, -2 * np.pi * 100 / 12, 0), times="t")
    system = vv.System([beam, vv.Clamped(solid=beam, nodes="start"), turn])
    with pytest.raises(vv.RunError, match=r"turns by 4\d degrees from node to node"):
        vv.quasi_static(system, until=1.0, step=0.1)


def test_line_loads() -> None:
    """Dead ones against the closed form; following ones turn along with a beam that turns."""
    beam = bar(8, "line3")
    bending = ROD.stiffness_matrix()[3, 3]
    load = vv.LineLoad(beam=beam, force=(0, 1e-4, 0))
    system = vv.System([beam, vv.Clamped(solid=beam, nodes="start"), load])
    vv.quasi_static(system, until=1.0, step=1.0)
    shear = 1e-4 * 2.0**2 / 2 / ROD.stiffness_matrix()[0, 0]
    assert beam.displacements(system.x)[-1, 1] == pytest.approx(1e-4 * 2.0**4 / 8 / bending + shear, rel=1e-4)

    turning = bar(4, angular_velocity=(0, 0, 2.0), section=SOFT)
    wind = vv.LineLoad(beam=turning, force=(0.0, 0.0, 0.7), moment=(0, 0, 0.0), follower=True)
    result = vv.simulate(vv.System([turning, wind]), until=1.0, step=0.01)
    assert result.ledger["work_line load"][-1] != 0.0
    result.assert_conserved("energy")


def test_gravity_pulls_at_the_centre_of_mass() -> None:
    """A beam whose masses are off its line swings about the line: a compound pendulum."""
    section = vv.GivenSection(stiffness=(1e6,) * 6, mass=2.0, centre=(0.0, -0.3), moments=(0.002, 0.008, 0.0))
    beam = bar(2, section=section, first=(0, 1, 0))  # d2 is up
    ground = vv.Ground()
    hinge = vv.Revolute(a=ground, b=beam, at=(0, 0, 0), axis=(1, 0, 0))
    system = vv.System([ground, beam, hinge, vv.Gravity(acceleration=(0, 0, -9.81))])
    inertia = 0.01 + 2.0 * 0.09
    expected = np.sqrt(2.0 * 9.81 * 0.3 / inertia) / (2 * np.pi)
    vv.equilibrium(system)
    assert vv.modes(system, 1).frequencies[0] == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("along", [(1, 0, 0), (0, 1, 0), (0.6, 0.8, 0)])
def test_half_of_a_symmetric_beam(along: Any) -> None:
    """Clamped at both ends, loaded in the middle: the plane of symmetry is across an axis or not."""
    n = np.array(along, dtype=float)
    load = -1e-4
    whole = vv.Beam(mesh=vv.LineMesh(points=[(0, 0, 0), 2 * n], count=8, cell="line3"), section=ROD)
    ends = [vv.Clamped(solid=whole, nodes=nodes) for nodes in ("start", "end")]
    full = vv.System([whole, *ends, vv.Force(on=whole.point(n), force=(0, 0, load))])
    half = vv.Beam(mesh=vv.LineMesh(points=[(0, 0, 0), n], count=4, cell="line3"), section=ROD)
    held = vv.Clamped(solid=half, nodes="start"), vv.SymmetryPlane(solid=half, nodes="end", normal=along)
    part = vv.System([half, *held, vv.Force(on=half.point(n), force=(0, 0, load / 2))])
    for system in (full, part):
        vv.quasi_static(system, until=1.0, step=1.0)
    middle = whole.displacements(full.x)[8]
    np.testing.assert_allclose(half.displacements(part.x)[-1], middle, rtol=1e-8, atol=1e-15)


def test_masses_off_the_line_have_their_centre() -> None:
    """Momentum, the probe of the centre of mass, and what an angular velocity turns about."""
    section = vv.GivenSection(
        stiffness=(200, 180, 300, 5, 4, 3), mass=2.0, centre=(0.1, -0.3), moments=(0.03, 0.02, 0)
    )
    beam = bar(4, section=section, first=(0, 1, 0), angular_velocity=(0, 1.0, 2.0))
    system = vv.System([beam])
    np.testing.assert_allclose(vv.CentreOfMass(of=[beam])(system), (1.0, 0.1, -0.3), atol=1e-12)
    ledger = vv.simulate(system, until=0.02, step=0.01).ledger
    for axis in "xyz":
        assert abs(ledger[f"momentum_{axis}"][0]) < 1e-12
    moving = vv.System([bar(4, section=section, velocity=(1.0, 0, 0))])
    assert vv.simulate(moving, until=0.02, step=0.01).ledger["momentum_x"][0] == pytest.approx(4.0)


def test_moments_have_no_potential_so_that_stability_is_not_told() -> None:
    """A cantilever that a torque rolls up far is at rest; where tangents are not symmetric nothing is counted."""
    section = vv.RectangleSection(width=0.02, height=0.01, young=2e11, poisson=0.3)
    beam = bar(8, "line3", length=1.0, section=section, first=(0, 1, 0))
    moment = 2 * np.pi * section.stiffness_matrix()[3, 3]
    turn = vv.Torque(on=beam.frame(1.0), torque=(0, 0.8 * moment, 0), times="t")
    result = vv.quasi_static(
        vv.System([beam, vv.Clamped(solid=beam, nodes="start"), turn]), until=1.0, step=0.1
    )
    assert "stability not checked" in result.audit()


def test_moments_about_fixed_axes_book_their_discrete_work() -> None:
    """M . sum d x (d1 - d0) / 2 over the directors of every step, computed from the states; nothing is left over."""
    beam = bar(4, velocity=(0.1, 0.2, 0.3), angular_velocity=(1.0, 0, 0), section=SOFT)
    moment = np.array([0.5, 1.0, 2.0])
    result = vv.simulate(
        vv.System([beam, vv.Torque(on=beam.frame(2.0), torque=moment)]), until=2.0, step=0.02
    )
    d = np.array([beam.directors(x)[-1] for x in result.states])
    middle, change = (d[1:] + d[:-1]) / 2, np.diff(d, axis=0)
    # forces t x d_i on the directors of the middle, which make up the moment there
    D = np.einsum("nic,nie->nce", middle, middle)
    tensor = np.trace(D, axis1=1, axis2=2)[:, None, None] * np.eye(3) - D
    t = np.linalg.solve(tensor, np.broadcast_to(moment, (len(D), 3))[..., None])[..., 0]
    work = np.einsum("nc,nic->n", t, np.cross(middle, change))
    np.testing.assert_allclose(result.ledger["work_torque"][1:], np.cumsum(work), rtol=1e-11)
    assert abs(result.ledger["imbalance"]).max() < 1e-12 * result.ledger.energy_scale


def test_a_semitangential_torque_is_a_cosine_about_its_own_axis() -> None:
    """On a body that is turned by it: half of m w^2 is the work M sin(angle)."""
    body = vv.RigidBody(mass=1.0, inertia=(1, 1, 2))
    result = vv.simulate(
        vv.System([body, vv.SemitangentialTorque(on=body, torque=(0, 0, 4))]), until=1.0, step=0.005
    )
    d1 = np.array([x[3:6] for x in result.states])
    np.testing.assert_allclose(result.ledger["kinetic"], 4 * d1[:, 1], atol=1e-10)


@pytest.mark.parametrize("radius", [5e-3, 1e-4])
def test_frequencies_of_wires(radius: float) -> None:
    """Of a slender cantilever: 3.516 and 22.03, however fast sections turn beside that."""
    section = vv.TubeSection(radius=radius, young=2e11, poisson=0.3, density=7800.0)
    wire = bar(10, "line3", length=1.0, section=section)
    found = vv.modes(vv.System([wire, vv.Clamped(solid=wire, nodes="start")]), 4).angular
    unit = np.sqrt(section.stiffness_matrix()[3, 3] / section.inertia().mass)
    np.testing.assert_allclose(found / unit, (3.516, 3.516, 22.034, 22.034), rtol=2e-3)


def test_drawn_with_its_sections() -> None:
    beam = bar(2, section=vv.RectangleSection(width=0.2, height=0.4, young=1.0), first=(0, 1, 0))
    system = vv.System([beam])
    surface = beam.drawn()
    size = np.ptp(surface.points, axis=0)
    np.testing.assert_allclose(size, (2.0, 0.2, 0.4), atol=1e-14)
    np.testing.assert_allclose(beam.drawn_positions(system.x), surface.points, atol=1e-14)
    assert [block.shape for block in surface.cells] == [(8, 4), (2, 4)]


def test_two_beams_of_one_section_do_not_share_anything_that_changes() -> None:
    beam = bar()
    twin = copy.deepcopy(beam)
    a, b = vv.System([beam]), vv.System([twin])
    a.x[:] += 1.0
    assert np.all(beam.strains(b.x) == 0.0)


@pytest.mark.parametrize("turn", [0.0, 0.4])
def test_a_quarter_of_a_ring_is_held_by_two_planes(turn: float) -> None:
    """Pulled apart at two places: each moves by P R^3 / EI (pi / 8 - 1 / pi)."""
    section = vv.GivenSection(stiffness=(1e6, 1e6, 1e6, 1, 1, 1))
    # directors askew to a plane are not interpolated alike on both of its sides: that takes more cells
    mesh = vv.ArcMesh(radius=1.0, angle=np.pi / 2, count=32 if turn else 8, cell="line3")
    quarter = vv.Beam(mesh=mesh, section=section, first=(np.cos(turn), 0, np.sin(turn)) if turn else None)
    held = [
        vv.SymmetryPlane(solid=quarter, nodes="all", normal=(0, 0, 1)),
        vv.SymmetryPlane(solid=quarter, nodes="start", normal=(0, 1, 0)),
        vv.SymmetryPlane(solid=quarter, nodes="end", normal=(1, 0, 0)),
    ]
    pull = vv.Force(on=quarter.point((0, 1, 0)), force=(0, 5e-4, 0), times="t")
    system = vv.System([quarter, *held, pull])
    vv.quasi_static(system, until=1.0, step=1.0)
    end = quarter.displacements(system.x)[quarter.nodes("end")[0]]
    assert end[1] == pytest.approx(1e-3 * (np.pi / 8 - 1 / np.pi), rel=5e-3)
