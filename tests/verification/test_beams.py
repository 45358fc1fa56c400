"""Beams against closed forms and against solutions of high accuracy of the same equations."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from visviva.examples import flexible_crane, pinched_cylinder, satellite, wind_turbine
from visviva.examples import spaghetti as free_beam

Array = NDArray[np.float64]
DATA = Path(__file__).parents[1] / "data"


def table(name: str, **options: Any) -> Array:
    """A file of own solutions; its first line says what it holds."""
    return np.genfromtxt(DATA / f"{name}.csv", delimiter=",", comments="#", **options)


def clamped(mesh: Any, section: vv.CrossSection, *loads: Any, **options: Any) -> tuple[vv.Beam, vv.System]:
    """A beam clamped at its start; `loads` are made from the beam."""
    beam = vv.Beam(mesh=mesh, section=section, **options)
    return beam, vv.System([beam, vv.Clamped(solid=beam, nodes="start"), *(load(beam) for load in loads)])


def straight(length: float, count: int, cell: str = "line2") -> vv.LineMesh:
    return vv.LineMesh(points=[(0, 0, 0), (length, 0, 0)], count=count, cell=cell)


def at_rest(system: vv.System, step: float = 0.1, *, unstable: bool = False) -> None:
    vv.quasi_static(system, until=1.0, step=step, scheme=vv.Static(unstable=unstable))


def orders(errors: list[float]) -> Array:
    """Of convergence, from each halving of the mesh."""
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))


# --- statics ------------------------------------------------------------------------------------------------
@pytest.mark.parametrize(("cell", "order"), [("line2", 2), ("line3", 4)])
@pytest.mark.parametrize("alpha", [1.0, 4.0, 10.0])
def test_elastica(cell: str, order: int, alpha: float) -> None:
    """A dead force across the end; as stiff against shear and stretch as not to matter."""
    row = next(row for row in table("elastica_tip_force") if row[0] == alpha)
    section = vv.GivenSection(stiffness=(1e8, 1e8, 1e8, 1.0, 1.0, 1.0))
    error = []
    for n in (8, 16, 32) if order == 2 else (4, 8, 16):
        beam, system = clamped(
            straight(1.0, n, cell),
            section,
            lambda b: vv.Force(on=b.point((1, 0, 0)), force=(0, alpha, 0), times="t"),
        )
        at_rest(system, 0.125)
        u = beam.displacements(system.x)[-1]
        error.append(float(np.hypot(u[0] + row[2], u[1] - row[3])))
    assert orders(error)[-1] > order - 0.3
    assert error[-1] < (2e-3 if cell == "line2" else 3e-5)


@pytest.mark.parametrize("alpha", [4.0, 10.0])
def test_elastica_of_rigid_sections(alpha: float) -> None:
    """Four-node cells that neither shear nor stretch: of sixth order."""
    row = next(row for row in table("elastica_tip_force") if row[0] == alpha)
    section = vv.GivenSection(stiffness=(1, 1, 1, 1, 1, 1))
    error = []
    for n in (3, 6, 12):
        beam, system = clamped(
            straight(1.0, n, "line4"),
            section,
            lambda b: vv.Force(on=b.point((1, 0, 0)), force=(0, alpha, 0), times="t"),
            rigid=("shear", "stretch"),
        )
        at_rest(system, 0.125)
        u = beam.displacements(system.x)[-1]
        error.append(float(np.hypot(u[0] + row[2], u[1] - row[3])))
    assert orders(error)[-1] > 5.7
    assert error[-1] < 3e-7


@pytest.mark.parametrize("n", [14, 16, 40])
def test_pure_bending(n: int) -> None:
    """The discrete circle of two-node elements: sin(turn) = M L_e / (E I) holds for twice the angle of an element."""
    length, bending = 12.0, 100.0
    moment = 2 * np.pi * bending / length
    strip = vv.RectangleSection(width=1.0, height=0.1, young=1.2e6)
    beam, system = clamped(
        straight(length, n),
        strip,
        lambda b: vv.Torque(on=b.frame(length), torque=(0, -moment, 0), times="t"),
        first=(0, 1, 0),
    )
    at_rest(system, 0.05)
    d3 = beam.directors(system.x)[:, 2]
    turn = np.arctan2(-np.cross(d3[:-1], d3[1:])[:, 1], (d3[:-1] * d3[1:]).sum(axis=1))
    np.testing.assert_allclose(np.sin(2 * turn), 2 * moment * length / n / bending, rtol=1e-10)


def test_pure_bending_closes_the_circle() -> None:
    """Of second and fourth order in the elements' length."""
    length, bending = 12.0, 100.0
    strip = vv.RectangleSection(width=1.0, height=0.1, young=1.2e6)
    for cell, order in (("line2", 2), ("line3", 4)):
        error = []
        for n in (16, 32, 64):
            beam, system = clamped(
                straight(length, n, cell),
                strip,
                lambda b: vv.Torque(
                    on=b.frame(length), torque=(0, -1, 0), times=f"{2 * np.pi * bending / length} * t"
                ),
                first=(0, 1, 0),
            )
            at_rest(system, 0.05)
            error.append(float(np.linalg.norm(beam.positions(system.x)[-1])))
        assert orders(error)[-1] > order - 0.3


@pytest.mark.parametrize(
    ("force", "expected", "tolerance"),
    [
        (5e8 * 0.5**3, (-0.15097114424, 0.71056859785), 1e-6),
        (5e5 * 0.5**3, (-1.888491656e-7, 8.09903253977e-4), 1e-9),
    ],
)
def test_reissner(force: float, expected: tuple[float, float], tolerance: float) -> None:
    """A cantilever as flexible in shear as in bending. It would buckle sideways, which is not asked here."""
    section = vv.RectangleSection(width=0.1, height=0.5, young=2.07e11, poisson=0.3)
    beam, system = clamped(
        straight(2.0, 16, "line3"),
        section,
        lambda b: vv.Force(on=b.point((2, 0, 0)), force=(0, force, 0), times="t"),
        first=(0, 0, 1),
    )
    at_rest(system, unstable=True)
    np.testing.assert_allclose(beam.displacements(system.x)[-1, :2], expected, atol=tolerance)


@pytest.mark.parametrize(("cell", "order", "last"), [("line2", 2, 0.09), ("line3", 4, 4e-4)])
def test_bend_of_45_degrees(cell: str, order: int, last: float) -> None:
    """Bathe & Bolourchi's; an own solution with the torsion constant and the shear factor of all rows."""
    for kappa, torsion, force, *place in table("bend45_tip")[[4, 19]][:, :6]:
        section = vv.GivenSection(stiffness=(kappa * 5e6, kappa * 5e6, 1e7, 1e7 / 12, 1e7 / 12, torsion))
        error = []
        for n in (8, 16, 32):
            mesh = vv.ArcMesh(
                radius=100, angle=np.pi / 4, start=(0, -1, 0), centre=(0, 100, 0), count=n, cell=cell
            )
            beam, system = clamped(
                mesh,
                section,
                lambda b: vv.Force(on=b.point(b.points[-1]), force=(0, 0, force), times="t"),  # noqa: B023
            )
            at_rest(system, 0.125)
            error.append(float(np.linalg.norm(beam.positions(system.x)[-1] - place)))
        assert orders(error)[-1] > order - 0.3
        assert error[-1] < last


@pytest.mark.parametrize(
    ("moment", "force", "expected"),
    [
        (7.853982, 1 / 16, (-0.9985083598, 3.7275610747, 0.1957513616)),
        (20 * np.pi, 5.0, (-9.589796647403, 0.0537709031062, -1.091729019308)),
    ],
)
def test_helix(moment: float, force: float, expected: tuple[float, float, float]) -> None:
    """A moment about a fixed axis winds the cantilever up, a force pulls it across (Ibrahimbegovic's)."""
    section = vv.GivenSection(stiffness=(1e4, 1e4, 1e4, 100, 100, 100))
    beam, system = clamped(
        straight(10.0, 32, "line3"),
        section,
        lambda b: vv.Torque(on=b.frame(10.0), torque=(0, 0, moment), times="t"),
        lambda b: vv.Force(on=b.frame(10.0), force=(0, 0, force), times="t"),
        first=(0, 1, 0),
    )
    at_rest(system, 0.05, unstable=True)
    np.testing.assert_allclose(beam.displacements(system.x)[-1], expected, atol=3e-4)


# --- vibrations ---------------------------------------------------------------------------------------------
TIMOSHENKO = {
    "cf": (82.89436269, 496.8145316, 1306.698073, 2370.308406),
    "ff": (513.4860561, 1335.675928, 2436.332636, 3717.532326),
}


@pytest.mark.parametrize("ends", ["cf", "ff"])
@pytest.mark.parametrize(("cell", "order"), [("line2", 2), ("line3", 4)])
def test_frequencies(ends: str, cell: str, order: int) -> None:
    """Of bending, each twice as the section is square; Timoshenko's with rotary inertia."""
    section = vv.RectangleSection(
        width=0.1, height=0.1, young=2.1e11, poisson=0.3, density=7850, shear_factors=(5 / 6, 5 / 6)
    )
    error = []
    for n in (10, 20, 40):
        beam = vv.Beam(mesh=straight(1.0, n, cell), section=section)
        held = [vv.Clamped(solid=beam, nodes="start")] if ends == "cf" else []
        found = vv.modes(vv.System([beam, *held]), 8 if ends == "cf" else 14).frequencies
        wanted = TIMOSHENKO[ends]
        error.append(max(abs(found[np.argmin(abs(found - f))] / f - 1) for f in wanted[:2]))
    assert orders(error)[-1] > order - 0.3


def test_frequencies_of_a_ring() -> None:
    """In its plane, w_n = n (n^2 - 1) / sqrt(n^2 + 1) sqrt(EI / (rho A R^4)), without shear and stretch."""
    section = vv.GivenSection(stiffness=(1e6, 1e6, 1e6, 1.0, 1.0, 1.0), mass=1.0)
    beam = vv.Beam(mesh=vv.ArcMesh(radius=1.0, angle=2 * np.pi, count=40, cell="line3"), section=section)
    found = 2 * np.pi * vv.modes(vv.System([beam]), 16).frequencies
    for n in (2, 3):
        expected = n * (n**2 - 1) / np.sqrt(n**2 + 1)
        assert min(abs(found / expected - 1)) < 2e-4


# --- dynamics -----------------------------------------------------------------------------------------------
@cache
def spaghetti(
    count: int, step: float, until: float, *, spatial: bool
) -> tuple[vv.Beam, vv.System, vv.Result]:
    """Simo & Vu-Quoc's free beam with E I = 500, pushed and turned at its lower end."""
    section = vv.GivenSection(stiffness=(1e4, 1e4, 1e4, 500, 500, 500), mass=1.0, moments=(10, 10, 0))
    mesh = vv.LineMesh(points=[(6, 0, 0), (0, 8, 0)], count=count, cell="line3")
    beam = vv.Beam(mesh=mesh, section=section, first=(0, 0, 1))
    tip = beam.frame(0.0)
    if spatial:
        hat = [[0.0, 0.0], [2.5, 200.0], [5.0, 0.0]]
        loads = (
            vv.Force(on=tip, force=(0.1, 0, 0), times=hat),
            vv.Torque(on=tip, torque=(0, -0.5, -1), times=hat),
        )
    else:
        on = "step(2.5 - t)"
        loads = vv.Force(on=tip, force=(8, 0, 0), times=on), vv.Torque(on=tip, torque=(0, 0, -80), times=on)
    system = vv.System([beam, *loads])
    return beam, system, vv.simulate(system, until=until, step=step)


def test_flying_spaghetti_in_space() -> None:
    """Both ends on the way, of second order in the step; energy and momenta after the release are exact."""
    rows = table("flying_spaghetti_3d")
    error = []
    for step in (0.02, 0.01):
        beam, _, result = spaghetti(24, step, 5.0, spatial=True)
        places = np.array([beam.positions(x)[[0, -1]].ravel() for x in result.states])
        at = [round(t / step) for t in rows[:11, 0]]
        error.append(float(np.abs(places[at] - rows[:11][:, [9, 10, 11, 15, 16, 17]]).max()))
    assert error[1] < 4e-3
    assert error[0] / error[1] > 3.5
    assert result.ledger["total"][-1] == pytest.approx(724.43609, rel=5e-5)


def test_flying_spaghetti_is_free() -> None:
    """After the loads have gone energy, momentum and angular momentum stand still to round-off."""
    beam, system, _ = spaghetti(10, 0.02, 5.0, spatial=True)
    flight = vv.simulate(system, until=25.0, step=0.02)
    ledger = flight.ledger
    for name in ("total", *(f"{kind}_{axis}" for kind in ("momentum", "angular") for axis in "xyz")):
        values = ledger[name]
        assert np.ptp(values) < 1e-10 * max(abs(ledger["total"]).max(), abs(values).max()), name
    assert ledger["defect_position"].max() < 1e-13
    assert np.ptp(beam.positions(system.x)[:, 2]) > 1.0


def test_flying_spaghetti_in_the_plane() -> None:
    """Momentum 8 x 2.5, and the angular momentum and places of the own solution."""
    beam, system, result = spaghetti(24, 0.01, 5.0, spatial=False)
    ends = beam.positions(system.x)[[0, -1], :2]
    np.testing.assert_allclose(ends, [(5.62017, 4.76425), (15.40849, 4.26452)], atol=5e-3)
    assert result.ledger["momentum_x"][-1] == pytest.approx(20.0, rel=1e-12)
    assert result.ledger["angular_z"][-1] == pytest.approx(-189.274514, rel=2e-5)
    assert result.ledger["total"][-1] == pytest.approx(90.218, rel=5e-3)


def test_spin_up() -> None:
    """Kane's manoeuvre: the tip lags behind, then stands still but for the steady extension."""
    section = vv.GivenSection(
        stiffness=(1e7, 1e7, 2.8e7, 1.4e4, 1.4e4, 1e4), mass=1.2, moments=(6e-4, 6e-4, 0)
    )
    beam = vv.Beam(mesh=straight(10.0, 8, "line3"), section=section, first=(0, 0, 1))
    ground = vv.Ground()
    hinge = vv.Revolute(a=ground, b=beam, at=(0, 0, 0), axis=(0, 0, 1), angle=True)
    angle = "6/15*(t**2/2 + (15/(2*pi))**2*(cos(2*pi*t/15) - 1))"
    system = vv.System([ground, beam, hinge, vv.Motor(joint=hinge, motion=angle)])
    result = vv.simulate(system, until=15.0, step=0.0125)
    rows = table("spinup")
    t = np.array(result.times)
    psi = 6 / 15 * (t**2 / 2 + (15 / (2 * np.pi)) ** 2 * (np.cos(2 * np.pi * t / 15) - 1))
    tip = np.array([beam.positions(x)[-1] for x in result.states])
    across = -np.sin(psi) * tip[:, 0] + np.cos(psi) * tip[:, 1]
    along = np.cos(psi) * tip[:, 0] + np.sin(psi) * tip[:, 1] - 10.0
    assert across.min() == pytest.approx(-0.5738273, rel=2e-3)
    assert along.min() == pytest.approx(-0.0188229, rel=4e-3)
    found = np.interp(rows[:60, 0], t, across)
    np.testing.assert_allclose(found, rows[:60, 2], atol=2e-3)


# --- against others, and there and back ---------------------------------------------------------------------
def test_a_beam_is_the_solid_of_the_same_bar() -> None:
    """A cantilever of 10 x 1 x 1 bent by a third of its length: quadratic bricks against three-node cells."""
    young, force = 1200.0, 0.8
    section = vv.RectangleSection(width=1.0, height=1.0, young=young)
    beam, system = clamped(
        straight(10.0, 8, "line3"),
        section,
        lambda b: vv.Force(on=b.point((10, 0, 0)), force=(0, 0, force), times="t"),
    )
    at_rest(system, 0.25)
    mesh = vv.BoxMesh(size=(10, 1, 1), counts=(10, 1, 1), cell="hex20", origin=(0, -0.5, -0.5))
    solid = vv.Solid(mesh=mesh, material=vv.SaintVenantKirchhoff(young=young, poisson=0.0))
    pull = vv.Traction(solid=solid, faces="x1", traction=(0, 0, force), times="t")
    bricks = vv.System([solid, vv.Fixed(solid=solid, nodes="x0"), pull])
    at_rest(bricks, 0.25)
    end = solid.displacements(bricks.x)[solid.nodes("x1")].mean(axis=0)
    found = beam.displacements(system.x)[-1]
    assert found[2] > 2.0
    np.testing.assert_allclose(found, end, atol=0.01 * found[2])


def test_a_ring_turned_inside_out_and_back() -> None:
    """Sections that turn by an angle a about the line take EI sin(a) / R^2 per length: inside out none.

    The path of a moment that turns along goes through both limit points.
    """
    section = vv.GivenSection(stiffness=(1e4, 1e4, 1e4, 1, 1, 1))
    beam = vv.Beam(mesh=vv.ArcMesh(radius=1.0, angle=2 * np.pi, count=12, cell="line3"), section=section)
    n = beam.grid.n_nodes
    where = {0: (True, True, True), n // 2: (False, True, True), n // 4: (False, False, True)}
    held = [vv.Fixed(solid=beam, nodes=[k], directions=kept) for k, kept in where.items()]
    twist = vv.LineLoad(beam=beam, moment=(0, 0, 1.0), follower=True, times="t")
    system = vv.System([beam, *held, twist])
    d = beam.directors(system.x)[0]
    angles = [0.0]

    def around(system: vv.System) -> bool:
        e = beam.directors(system.x)[0]
        new = np.arctan2(e[0] @ d[1], e[0] @ d[0])
        angles.append(angles[-1] + float((new - angles[-1] + np.pi) % (2 * np.pi) - np.pi))
        return angles[-1] > 2 * np.pi

    result = vv.arc_length(system, step=0.2, stop=around, steps=100)
    a = np.array(angles[1:])
    assert a[-1] > 2 * np.pi
    np.testing.assert_allclose(np.array(result.times)[-len(a) :], np.sin(a), atol=5e-3)


# --- examples -----------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("example", "options"),
    [
        (free_beam, {"until": 6.0}),
        (wind_turbine, {"count": 4, "until": 1.0}),
        (flexible_crane, {"count": 4, "until": 1.0}),
        (flexible_crane, {"count": 4, "until": 2.0, "step": 0.02, "servo": True}),
        (pinched_cylinder, {"count": 24, "share": 0.05, "step": 0.5}),
        (satellite, {"until": 2.0}),
    ],
    ids=lambda value: getattr(value, "__name__", "")[17:],
)
def test_examples(example: Any, options: dict[str, Any]) -> None:
    study = example.study(**options)
    example.check(vv.simulate(study.system, until=study.until, step=study.step, scheme=study.scheme))
