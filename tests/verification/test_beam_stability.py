"""Stability of beams: critical loads of columns, strips, frames and arches; flutter under a follower force."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import visviva as vv

SLENDER = vv.GivenSection(stiffness=(1e7, 1e7, 1e7, 1, 1, 1), mass=1.0, moments=(1e-6, 1e-6, 0))
STRIP = vv.GivenSection(stiffness=(1e7, 1e7, 1e7, 1e4, 1, 0.5), mass=1.0, moments=(1e-6, 1e-6, 0))


def straight(n: int, cell: str = "line3", length: float = 1.0) -> vv.LineMesh:
    return vv.LineMesh(points=[(0, 0, 0), (length, 0, 0)], count=n, cell=cell)


def in_plane(beam: vv.Beam) -> vv.SymmetryPlane:
    return vv.SymmetryPlane(solid=beam, nodes="all", normal=(0, 0, 1))


def least(components: list[Any], steps: int = 1) -> float:
    """The least squared frequency about the loaded equilibrium."""
    system = vv.System(components)
    vv.quasi_static(system, until=1.0, step=1 / steps, scheme=vv.Static(unstable=True))
    return float(vv.modes(system, 1).squared[0])


def critical(squared: Callable[[float], float], a: float, b: float) -> float:
    """The load where the least squared frequency vanishes, by secants from two below."""
    fa, fb = squared(a), squared(b)
    for _ in range(10):
        a, b, fa = b, b - fb * (b - a) / (fb - fa), fb
        if abs(b - a) < 1e-8 * abs(b):
            break
        fb = squared(b)
    return b


# --- columns ------------------------------------------------------------------------------------------------
def column(ends: str, load: float, n: int) -> list[Any]:
    beam = vv.Beam(mesh=straight(n), section=SLENDER, first=(0, 0, 1))
    held: list[Any] = [in_plane(beam), vv.Force(on=beam.point((1, 0, 0)), force=(-load, 0, 0))]
    held.append((vv.Clamped if ends[0] == "c" else vv.Fixed)(solid=beam, nodes="start"))
    if ends[1] == "p":
        held.append(vv.Fixed(solid=beam, nodes="end", directions=(False, True, True)))
    if ends[1] == "c":
        ground = vv.Ground()
        held += [ground, vv.Prismatic(a=ground, b=beam, at=(1, 0, 0), axis=(1, 0, 0))]
    return [beam, *held]


@pytest.mark.parametrize(
    ("ends", "exact"), [("cf", np.pi**2 / 4), ("pp", np.pi**2), ("cp", 20.190728556), ("cc", 4 * np.pi**2)]
)
def test_euler_columns(ends: str, exact: float) -> None:
    """Of fourth order in the length of three-node cells."""
    error = [
        critical(lambda load: least(column(ends, load, n)), 0.7 * exact, 0.8 * exact) / exact - 1  # noqa: B023
        for n in (4, 8)
    ]
    assert 0 < error[1] < 3e-3
    assert np.log2(error[0] / error[1]) > 3.5


def test_a_shaft_under_a_semitangential_torque() -> None:
    """Clamped and free, too stiff in torsion to be turned by it: pi EI / L (Ziegler 1968)."""
    shaft = vv.GivenSection(stiffness=(1e7, 1e7, 1e7, 1, 1, 1e4), mass=1.0, moments=(1e-6, 1e-6, 0))

    def turned(load: float) -> list[Any]:
        beam = vv.Beam(mesh=straight(8), section=shaft)
        torque = vv.SemitangentialTorque(on=beam.frame(1.0), torque=(load, 0, 0), times="t")
        return [beam, vv.Clamped(solid=beam, nodes="start"), torque]

    assert critical(lambda load: least(turned(load)), 2.0, 2.5) == pytest.approx(np.pi, rel=2e-3)


def shafts_growth(torque: float) -> tuple[float, float]:
    """Rate by which a shaft on two ball joints leaves its axis under torques about fixed axes, and how far it gets."""
    section = vv.GivenSection(stiffness=(1e6, 1e6, 1e6, 1, 1, 1e3), mass=1.0, moments=(1e-4, 1e-4, 0))
    beam = vv.Beam(
        mesh=straight(8), section=section, velocity=lambda X: 1e-9 * np.sin(np.pi * X[:, :1]) * (0, 1, 0.3)
    )
    held = (
        vv.Fixed(solid=beam, nodes="start"),
        vv.Fixed(solid=beam, nodes="end", directions=(False, True, True)),
    )
    ends = [vv.Torque(on=beam.frame(s), torque=(t, 0, 0)) for s, t in ((0.0, -torque), (1.0, torque))]
    result = vv.simulate(vv.System([beam, *held, *ends]), until=5.0, step=0.01)
    away = np.linalg.norm(result.history(beam.point((0.5, 0, 0)).position)[300:, 1:], axis=1)
    return float(np.polyfit(result.times[300:], np.log(away), 1)[0]), float(away.max())


def test_greenhills_shaft() -> None:
    """From 2 pi EI / L on, where squared growth rates vanish."""
    torques = np.array([6.35, 6.45])
    growth = [shafts_growth(torque)[0] for torque in torques]
    rate, at_zero = np.polyfit(torques, np.square(growth), 1)
    assert -at_zero / rate == pytest.approx(2 * np.pi, rel=2e-3)
    assert shafts_growth(6.2)[1] < 1e-9


def becks_growth(load: float, n: int) -> tuple[float, float]:
    """Rate by which a disturbance grows under a force that turns along, and its angular frequency."""
    beam = vv.Beam(
        mesh=straight(n),
        section=SLENDER,
        first=(0, 0, 1),
        velocity=lambda X: 1e-9 * X[:, :1] ** 2 * (0, 1, 0),
    )
    push = vv.FollowerForce(on=beam.frame(1.0), force=(0, 0, -load))
    system = vv.System([beam, in_plane(beam), vv.Clamped(solid=beam, nodes="start"), push])
    step, period = 0.01, 57
    result = vv.simulate(system, until=9.0, step=step)
    w = np.array([beam.displacements(x)[-1, 1] for x in result.states])[300:]
    highest = np.array([abs(w[k : k + period]).max() for k in range(0, len(w) - period, period)])
    before = np.flatnonzero(np.diff(np.sign(w)))
    crossings = before + w[before] / (w[before] - w[before + 1])
    frequency = np.pi * (len(crossings) - 1) / ((crossings[-1] - crossings[0]) * step)
    return float(np.diff(np.log(highest))[-3:].mean() / (period * step)), frequency


def test_becks_column_flutters() -> None:
    """From P L^2 / EI = 20.0510 on, where squared growth rates vanish, with the frequency 11.0156."""
    loads = np.array([20.5, 21.0])
    growth, frequency = np.array([becks_growth(load, 8) for load in loads]).T
    (rate, at_zero), (slope, start) = np.polyfit(loads, growth**2, 1), np.polyfit(loads, frequency, 1)
    found = -at_zero / rate
    assert found == pytest.approx(20.05095361897376, rel=2e-3)
    assert slope * found + start == pytest.approx(11.01555764, rel=1e-3)
    assert abs(becks_growth(19.5, 8)[0]) < 0.05


# --- out of the plane ---------------------------------------------------------------------------------------
def test_a_cantilever_strip_tips_over() -> None:
    """Under a force at the centroid of its end: P L^2 = 4.01260 sqrt(EI GJ)."""

    def strip(load: float) -> list[Any]:
        beam = vv.Beam(mesh=straight(8), section=STRIP, first=(0, 1, 0))
        push = vv.Force(on=beam.point((1, 0, 0)), force=(0, 0, -load))
        return [beam, vv.Clamped(solid=beam, nodes="start"), push]

    exact = 4.012599343578901 * np.sqrt(0.5)
    assert critical(lambda load: least(strip(load)), 0.7 * exact, 0.8 * exact) == pytest.approx(
        exact, rel=2e-3
    )


def frame(load: float, n: int) -> list[Any]:
    """Two legs of 240, 30 high and 0.6 thick, with the torsion constant h t^3 / 3; a force in their plane."""
    section = vv.RectangleSection(
        width=0.6, height=30.0, young=71240.0, poisson=0.31, torsion_constant=30 * 0.6**3 / 3, density=1e-9
    )
    s = 240.0 * np.arange(2 * n + 1) / n
    points = np.stack([np.minimum(s, 240.0), -np.maximum(s - 240.0, 0.0), 0 * s], axis=1)
    middles = (points[1:] + points[:-1]) / 2
    first, m = np.arange(2 * n), 2 * n + 1
    mesh = vv.Mesh(
        np.concatenate([points, middles]), {"line3": np.stack([first, first + 1, first + m], axis=1)}
    )
    beam = vv.Beam(mesh=mesh, section=section, first=(0, 0, 1), kinks="rigid")
    push = vv.Force(on=beam.point((240, -240, 0)), force=(load, 0, 0), times="t")
    return [beam, vv.Clamped(solid=beam, nodes=[0]), push]


@pytest.mark.parametrize(("exact", "a", "b"), [(1.0875178, 0.9, 1.0), (-0.6804274, -0.55, -0.6)])
def test_an_l_frame_buckles_out_of_its_plane(exact: float, a: float, b: float) -> None:
    """Own solution of the exact rod; published 1.088 and -0.6804 (Argyris et al. 1979, Simo & Vu-Quoc 1986)."""
    error = [critical(lambda load: least(frame(load, n), 2), a, b) / exact - 1 for n in (2, 4)]  # noqa: B023
    assert error[1] == pytest.approx(0, abs=6e-5)
    assert np.log2(error[0] / error[1]) > 3.5


def lifted(n: int, step: float) -> tuple[vv.Result, vv.Beam]:
    """A thin cantilever that a crank and a link lift at its end, 0.1 mm off its plane (IFToMM benchmark)."""

    def section(*C: float, mass: float, moments: Any) -> vv.GivenSection:
        return vv.GivenSection(stiffness=C, mass=mass, moments=(*moments, 0))

    def rod(points: Any, count: int, section: vv.GivenSection, **options: Any) -> vv.Beam:
        return vv.Beam(mesh=vv.LineMesh(points=points, count=count, cell="line3"), section=section, **options)

    thin = section(
        23.4e6, 5.025e6, 73e6, 608.3, 60830, 877.2, mass=2.68, moments=(2.68e-2 / 12, 2.68e-4 / 12)
    )
    middle = section(10.81e6, 10.81e6, 33.02e6, 1189, 1189, 914.5, mass=1.212, moments=(4.36e-5,) * 2)
    thick = section(43.22e6, 43.22e6, 132.1e6, 19020, 19020, 14630, mass=4.85, moments=(6.98e-4,) * 2)
    end, knee, foot = (1, 1e-4, 0), (1, 1e-4, -0.25), (1, 1e-4, -0.3)
    beam = rod([(0, 0, 0), (1, 0, 0)], n, thin, first=(0, 0, 1))
    link, crank, ground = rod([knee, end], 2, middle), rod([foot, knee], 1, thick), vv.Ground()
    axle = vv.Revolute(a=ground, b=crank, at=foot, axis=(0, 1, 0), angle=True)
    joints = vv.Revolute(a=crank, b=link, at=knee, axis=(0, 1, 0)), vv.Spherical(a=link, b=beam, at=end)
    drive = vv.Motor(joint=axle, motion="pi*(1-cos(pi*t/0.4))/2")
    system = vv.System(
        [ground, beam, link, crank, vv.Clamped(solid=beam, nodes="start"), axle, *joints, drive]
    )
    return vv.simulate(system, until=0.24, step=step), beam


def test_a_lifted_strip_buckles_sideways() -> None:
    """Not before the static load of the strip (at 0.137 s); own curve converged in mesh and step, exact energy."""
    curves = []
    for n, step in ((4, 1e-3), (8, 5e-4)):
        result, beam = lifted(n, step)
        assert abs(result.ledger["imbalance"]).max() < 1e-11 * result.ledger.energy_scale
        curves.append(result.history(beam.point((0.5, 0, 0)).position)[:: round(1e-3 / step), 1])
    assert abs(curves[1][:137]).max() < 1e-4
    assert curves[1][-1] == pytest.approx(-0.0585, abs=1e-3)
    np.testing.assert_allclose(curves[0], curves[1], atol=3e-3)


# --- limit points -------------------------------------------------------------------------------------------
def test_a_deep_arch_snaps() -> None:
    """Clamped and hinged, of 215 degrees: P R^2 / EI = 8.97 at its crown (DaDeppo & Schmidt 1975)."""
    half = np.deg2rad(215) / 2
    start = np.pi / 2 + half
    mesh = vv.ArcMesh(
        radius=1.0, angle=-2 * half, start=(np.cos(start), np.sin(start), 0), count=16, cell="line4"
    )
    section = vv.GivenSection(stiffness=(1e6, 1e6, 1e6, 1, 1, 1))
    beam = vv.Beam(mesh=mesh, section=section, first=(0, 0, 1))
    push = vv.Force(on=beam.point((0, 1, 0)), force=(0, -1, 0), times="t")
    ends = vv.Clamped(solid=beam, nodes="start"), vv.Fixed(solid=beam, nodes="end")
    highest = [0.0]

    def falls(system: vv.System) -> bool:
        highest.append(max(highest[-1], system.time))
        return system.time < 0.99 * highest[-1]

    vv.arc_length(vv.System([beam, in_plane(beam), *ends, push]), step=2.0, stop=falls)
    assert highest[-1] == pytest.approx(8.97, abs=0.005)


@pytest.mark.parametrize(("length", "height"), [(1.0, 1e-3), (1e-3, 1e-5), (1e-6, 1e-8)])
def test_loads_that_follow_are_seen_beside_slender_and_small_beams(length: float, height: float) -> None:
    """Beck's column of steel at p = 21: flutter at 10.942 + 2.116i in any size; statics calls nothing unstable."""
    young, density = 210e9, 7850.0
    section = vv.RectangleSection(width=height, height=height, young=young, poisson=0.0, density=density)
    beam = vv.Beam(
        mesh=vv.LineMesh(points=[(0, 0, 0), (length, 0, 0)], count=8, cell="line3"), section=section
    )
    stiffness = young * height**4 / 12
    load = 21 * stiffness / length**2
    follower = vv.FollowerForce(on=beam.frame(length), force=(0, 0, -load), times="t")
    system = vv.System([beam, vv.Clamped(solid=beam, nodes="start"), follower])
    vv.quasi_static(system, until=1.0, step=0.25)
    modes = vv.modes(system, 4)
    unit = np.sqrt(stiffness / (density * height**2)) / length**2
    assert modes.flutters
    growing = modes.roots[modes.roots.real > 1e-6 * unit] / unit
    assert growing.imag == pytest.approx(np.full(len(growing), 10.942), rel=2e-3)
    assert growing.real == pytest.approx(np.full(len(growing), 2.116), rel=2e-2)
