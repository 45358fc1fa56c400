"""Beams of plane systems against closed forms, own solutions of high accuracy, and beams in space."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

import visviva as vv

Array = NDArray[np.float64]
STRIP = vv.RectangleSection(width=1.0, height=0.1, young=1.2e6)
COUPLED = vv.GivenSection(
    stiffness=np.diag([3e3, 2e3, 5e3, 40.0, 60.0, 20.0])
    + np.array(
        [
            [0, 0, 0, 0, 0, 0],
            [0, 0, 200, 30, 0, 0],
            [0, 200, 0, -80, 0, 0],
            [0, 30, -80, 0, 0, 0],
            *[[0] * 6] * 2,
        ]
    ),
    mass=1.5,
    centre=(0.0, 0.05),
    moments=(0.02, 0.03, 0.0),
    damping=np.diag([0, 3.0, 4.0, 0.2, 0, 0]),
)


def straight(length: float, count: int, cell: str = "line2") -> vv.LineMesh:
    return vv.LineMesh(points=[(0, 0, 0), (length, 0, 0)], count=count, cell=cell)


def orders(errors: list[float]) -> Array:
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))


# --- statics ------------------------------------------------------------------------------------------------
def rolled(count: int, cell: str = "line2") -> tuple[vv.PlaneBeam, vv.System]:
    """A strip under the moment that closes it to a circle."""
    strip = vv.PlaneBeam(mesh=straight(12.0, count, cell), section=STRIP)
    moment = vv.Torque(on=strip.frame(12.0), torque=(0, 0, 2 * np.pi * 100 / 12), times="t")
    system = vv.System([strip, vv.Clamped(solid=strip, nodes="start"), moment])
    vv.quasi_static(system, until=1.0, step=0.05)
    return strip, system


@pytest.mark.parametrize("n", [14, 40])
def test_the_discrete_circle(n: int) -> None:
    """sin(turn) = M L_e / (E I) holds for twice the angle of an element of two nodes."""
    strip, system = rolled(n)
    d = strip.directors(system.x)[:, 1]
    turn = np.arctan2(np.cross(d[:-1], d[1:])[:, 2], (d[:-1] * d[1:]).sum(axis=1))
    np.testing.assert_allclose(np.sin(2 * turn), 2 * 2 * np.pi / 12 * 12.0 / n, rtol=1e-10)


@pytest.mark.parametrize(("cell", "order"), [("line2", 2), ("line3", 4), ("line4", 6)])
def test_pure_bending_closes_the_circle(cell: str, order: int) -> None:
    error = []
    for n in (8, 16) if order == 6 else (16, 32):
        strip, system = rolled(n, cell)
        error.append(float(np.linalg.norm(strip.positions(system.x)[strip.nodes("end")])))
    assert orders(error)[-1] > order - 0.3


def test_elastica_of_rigid_sections() -> None:
    """P L^2 / E I = 4: 0.3289412422 back and 0.6699641813 up, with shear and stretch held at zero."""
    error = []
    for n in (4, 8):
        beam = vv.PlaneBeam(
            mesh=straight(1.0, n, "line3"),
            section=vv.GivenSection(stiffness=(1, 1, 1, 1, 1, 1)),
            rigid=("shear", "stretch"),
        )
        pull = vv.Force(on=beam.point((1, 0, 0)), force=(0, 4, 0), times="t")
        system = vv.System([beam, vv.Clamped(solid=beam, nodes="start"), pull])
        vv.quasi_static(system, until=1.0, step=0.125)
        u = beam.displacements(system.x)[beam.nodes("end")][0]
        error.append(float(np.hypot(u[0] + 0.3289412422, u[1] - 0.6699641813)))
    assert orders(error)[-1] > 3.7
    assert error[1] < 1e-4
    assert np.abs(beam.strains(system.x)[..., :3]).max() < 1e-12


# --- Lee's frame --------------------------------------------------------------------------------------------
SIDE, ARM, BENDING = 120.0, 24.0, 1440.0


def lee_frame(count: int) -> tuple[vv.PlaneBeam, vv.System]:
    """A column and a beam of equal lengths on hinges, welded at a right angle, pushed down near the corner."""
    k = 5 * count
    s = np.linspace(0, SIDE, 2 * k + 1)
    points = [(0, y, 0) for y in s] + [(x, SIDE, 0) for x in s[1:]]
    mesh = vv.Mesh(points, {"line3": [(2 * i, 2 * i + 2, 2 * i + 1) for i in range(2 * k)]})
    section = vv.GivenSection(stiffness=(1, 1, 1, BENDING, BENDING, 1))
    frame = vv.PlaneBeam(mesh=mesh, section=section, kinks="rigid", rigid=("shear", "stretch"))
    hinges = vv.Fixed(solid=frame, nodes=[0, len(points) - 1])
    load = vv.Force(on=frame.point((ARM, SIDE, 0)), force=(0, -1, 0), times="t")
    return frame, vv.System([frame, hinges, load])


def elastica(unknowns: Array) -> tuple[Array, Array]:
    """Of the frame without shear and stretch: what of its far hinge and end moment fails, and the loaded place.

    Unknowns are the angle of the column and the reaction at the near hinge, and the load.
    """
    angle, h, v, load = unknowns

    def along(length: float, start: Array, pull: Array) -> Array:
        def slope(_: float, at: Array) -> list[float]:
            turn, bend = at[2:]
            c, s = np.cos(turn), np.sin(turn)
            return [c, s, bend / BENDING, -(c * pull[1] - s * pull[0])]

        return np.asarray(solve_ivp(slope, (0, length), start, rtol=1e-10, atol=1e-10).y[:, -1])

    pull = np.array([-h, -v])
    top = along(SIDE, np.array([0, 0, angle, 0.0]), pull)
    top[2] -= np.pi / 2
    place = along(ARM, top, pull)
    x, y, _, moment = along(SIDE - ARM, place, pull + np.array([0, load]))
    return np.array([(x - SIDE) / SIDE, (y - SIDE) / SIDE, moment / BENDING]), place[:2]


def exact_frame(place: Array, way: Array, guess: Array) -> Array:
    """Unknowns of the elastica whose loaded place is beside one (2,), across the way (2,) there."""

    def misses(u: Array) -> Array:
        ends, found = elastica(u)
        return np.append(ends, way @ (found - place))

    found, _, good, _ = fsolve(misses, guess, full_output=True)
    assert good == 1
    return np.asarray(found)


def test_lee_frame_snaps_along_its_elastica() -> None:
    """Through both limit loads, of which the lower one pulls: at each deflection the load of the exact frame."""
    frame, system = lee_frame(4)
    result = vv.arc_length(
        system, step=0.2, steps=120, stop=lambda at: at.value(frame.point((ARM, SIDE, 0)).position)[1] < 45
    )
    loads, states = np.array(result.times), result.states
    upper, lower = loads.argmax(), loads.argmin()
    assert upper < lower
    assert loads[lower] < 0 < loads[upper]
    places = np.array([frame.point((ARM, SIDE, 0)).position.value(x)[:2] for x in states])
    before, found = (np.array([np.pi / 2, 0.0, 0.8 * load, load]) for load in loads[:2])
    for k in range(1, lower + 2):
        way = (places[k] - places[k - 1]) / SIDE**2
        before, found = found, exact_frame(places[k], way, 2 * found - before)
        assert loads[k] == pytest.approx(found[3], abs=1e-3 * loads[upper])
        np.testing.assert_allclose(places[k], elastica(found)[1], atol=1e-3 * SIDE)


# --- dynamics -----------------------------------------------------------------------------------------------
def test_flying_spaghetti() -> None:
    """Simo & Vu-Quoc's beam: momentum 8 x 2.5, and the angular momentum, energy and places of the own solution."""
    section = vv.GivenSection(stiffness=(1e4, 1e4, 1e4, 500, 500, 500), mass=1.0, moments=(10, 10, 0))
    mesh = vv.LineMesh(points=[(6, 0, 0), (0, 8, 0)], count=24, cell="line3")
    beam = vv.PlaneBeam(mesh=mesh, section=section)
    tip, on = beam.frame(0.0), "step(2.5 - t)"
    loads = vv.Force(on=tip, force=(8, 0, 0), times=on), vv.Torque(on=tip, torque=(0, 0, -80), times=on)
    system = vv.System([beam, *loads])
    result = vv.simulate(system, until=5.0, step=0.01)
    ends = beam.positions(system.x)[[0, -1], :2]
    np.testing.assert_allclose(ends, [(5.62017, 4.76425), (15.40849, 4.26452)], atol=5e-3)
    assert result.ledger["momentum_x"][-1] == pytest.approx(20.0, rel=1e-12)
    assert result.ledger["angular_z"][-1] == pytest.approx(-189.274514, rel=2e-5)
    assert result.ledger["total"][-1] == pytest.approx(90.218, rel=5e-3)
    flight = vv.simulate(system, until=25.0, step=0.02).ledger
    for name in ("total", "momentum_x", "momentum_y", "angular_z"):
        values = flight[name]
        assert np.ptp(values) < 1e-10 * max(abs(flight["total"]).max(), abs(values).max()), name
    assert flight["defect_position"].max() < 1e-13


def swinging(kind: Any, hold: Any) -> tuple[Any, vv.Result]:
    """A bent pendulum with two corners, of a damped section whose strains couple, under loads."""
    a = np.linspace(0, np.pi / 2, 7)
    points = [
        *np.column_stack([np.sin(a), np.cos(a), 0 * a]),
        (1, -0.5, 0),
        (1, -1, 0),
        (1.4, -1, 0),
        (1.8, -1, 0),
    ]
    mesh = vv.Mesh(points, {"line3": [(0, 2, 1), (2, 4, 3), (4, 6, 5), (6, 8, 7), (8, 10, 9)]})
    beam, ground = hold(kind, mesh), vv.Ground()
    parts = [
        ground,
        *beam,
        vv.Revolute(a=ground, b=beam[0], at=(0, 1, 0), axis=(0, 0, 1)),
        vv.Gravity(acceleration=(0, -9.81, 0)),
        vv.LineLoad(beam=beam[0], moment=(0.5, 0, 0), follower=True, times="sin(3*t)"),
        vv.LineLoad(beam=beam[0], force=(1.0, 2.0, 0), moment=(0, 0, 0.1)),
        vv.Force(on=beam[0].frame((1.8, -0.9, 0)), force=(1.0, 0, 0)),
        vv.FollowerTorque(on=beam[0].frame((1.8, -1, 0)), torque=(0.3, 0, 0)),
    ]
    system = vv.System(parts)
    return beam[0], vv.simulate(system, until=0.5, step=0.01)


def test_what_a_beam_in_space_does_in_its_plane() -> None:
    """With corners, couplings, damping, joints, and loads of all kinds."""

    def flat(kind: Any, mesh: vv.Mesh) -> list[Any]:
        return [vv.PlaneBeam(mesh=mesh, section=COUPLED, kinks="rigid")]

    def spatial(kind: Any, mesh: vv.Mesh) -> list[Any]:
        beam = vv.Beam(mesh=mesh, section=COUPLED, kinks="rigid", first=(0, 0, 1))
        return [beam, vv.SymmetryPlane(solid=beam, nodes="all", normal=(0, 0, 1))]

    (one, here), (other, there) = (swinging(None, hold) for hold in (flat, spatial))
    n = other.grid.n_nodes
    np.testing.assert_allclose(one.positions(here.system.x)[:n], other.positions(there.system.x), atol=1e-8)
    np.testing.assert_allclose(one.resultants(here.system.x), other.resultants(there.system.x), atol=1e-5)
    for name in ("total", "work_dissipated", "kinetic"):
        np.testing.assert_allclose(here.ledger[name], there.ledger[name], atol=1e-8, err_msg=name)


# --- with others --------------------------------------------------------------------------------------------
def test_a_bar_that_is_half_a_beam_and_half_a_plane_solid() -> None:
    """Joined by a coupling: the deflection of the cantilever."""
    young, height, force = 1e6, 0.1, 0.01
    solid = vv.Solid(
        mesh=vv.RectangleMesh(size=(1, height), counts=(20, 2), cell="quad9"),
        material=vv.SaintVenantKirchhoff(young=young, poisson=0.0),
        plane="stress",
    )
    section = vv.RectangleSection(width=1.0, height=height, young=young, poisson=0.0)
    beam = vv.PlaneBeam(
        mesh=vv.LineMesh(points=[(1, 0.05, 0), (2, 0.05, 0)], count=4, cell="line3"), section=section
    )
    end = vv.DistributedCoupling(solid=solid, faces="x1")
    weld = vv.Rigid(a=end, b=beam, at=(1, 0.05, 0))
    load = vv.Force(on=beam.point((2, 0.05, 0)), force=(0, -force, 0), times="t")
    system = vv.System([solid, beam, end, weld, vv.Fixed(solid=solid, nodes="x0"), load])
    vv.quasi_static(system, until=1.0, step=1.0)
    exact = -force * 8 / 3 / (young * height**3 / 12)
    assert beam.displacements(system.x)[beam.nodes("end"), 1] == pytest.approx(exact, rel=0.02)


def test_in_a_plane_fluid_it_moves_as_a_beam_in_space_does() -> None:
    """A flap in a box whose lid moves."""

    def tip(kind: Any, **options: Any) -> Array:
        fluid = vv.Fluid(mesh=vv.RectangleMesh(size=(2, 1), counts=(16, 8)), density=1.0, viscosity=0.1)
        section = vv.RectangleSection(width=1.0, height=0.02, young=1e5, density=10.0)
        flap = kind(mesh=vv.LineMesh(points=[(1, 0, 0), (1, 0.5, 0)], count=6), section=section, **options)
        walls = [vv.NoSlip(fluid=fluid, faces=faces) for faces in ("y0", "x0", "x1")]

        def drive(t: float, X: Array) -> Array:
            return np.outer(10 * t * X[:, 0] * (2 - X[:, 0]), (1, 0, 0))

        lid = vv.VelocityBoundary(fluid=fluid, faces="y1", velocity=drive)
        wet = vv.ImmersedThin(fluid=fluid, body=flap, displaced=0.02)
        system = vv.System([fluid, flap, wet, vv.Clamped(solid=flap, nodes="start"), *walls, lid])
        vv.simulate(system, until=0.1, step=0.02)
        return np.asarray(flap.displacements(system.x)[flap.nodes("end")][0])

    here, there = tip(vv.PlaneBeam), tip(vv.Beam, first=(0, 0, 1))
    assert np.linalg.norm(there) > 1e-3
    np.testing.assert_allclose(here, there, atol=1e-12)


def test_frequencies_and_buckling() -> None:
    """Timoshenko's cantilever of the table, and Euler's column."""
    section = vv.RectangleSection(
        width=0.1, height=0.1, young=2.1e11, poisson=0.3, density=7850, shear_factors=(5 / 6, 5 / 6)
    )
    beam = vv.PlaneBeam(mesh=straight(1.0, 16, "line3"), section=section)
    found = vv.modes(vv.System([beam, vv.Clamped(solid=beam, nodes="start")]), 2)
    np.testing.assert_allclose(found.frequencies[:2], [82.89436269, 496.8145316], rtol=1e-4)
    beam = vv.PlaneBeam(mesh=straight(1.0, 16, "line3"), section=section)
    press = vv.Force(on=beam.point((1, 0, 0)), force=(-1e6, 0, 0), times="t")
    factor = vv.buckling(vv.System([beam, vv.Clamped(solid=beam, nodes="start"), press]), 1).factors[0]
    euler = np.pi**2 / 4 * 2.1e11 * 0.1**4 / 12
    assert factor * 1e6 == pytest.approx(euler, rel=0.01)


# --- refused ------------------------------------------------------------------------------------------------
REFUSED = [
    (lambda: vv.PlaneBeam(mesh=straight(1.0, 2), section=STRIP, first=(0, 1, 0)), "leave out first"),
    (
        lambda: vv.PlaneBeam(mesh=vv.LineMesh(points=[(0, 0, 0), (1, 0, 1)], count=2), section=STRIP),
        "leaves the plane z = 0",
    ),
    (
        lambda: vv.PlaneBeam(
            mesh=straight(1.0, 2),
            section=vv.GivenSection(stiffness=np.eye(6) + 0.1 * (np.eye(6, k=2) + np.eye(6, k=-2))),
        ),
        "couples strains in the plane with others",
    ),
    (
        lambda: vv.PlaneBeam(mesh=straight(1.0, 2), section=STRIP).point((0.5, 0, 0.1)).position,
        "lies off its plane",
    ),
    (
        lambda: vv.System([vv.PlaneBeam(mesh=straight(1.0, 2), section=STRIP, velocity=(0, 0, 1))]),
        "out of its plane",
    ),
]


@pytest.mark.parametrize(("make", "message"), REFUSED)
def test_refused(make: Any, message: str) -> None:
    with pytest.raises(vv.InputError, match=message):
        make()
