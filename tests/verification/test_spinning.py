"""Vibrations of what spins, and flutter under forces that follow, against closed forms and a table."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import visviva as vv

DATA = Path(__file__).parents[1] / "data"
TINY = 1e-7
"""Rotary inertia of beams that have none."""


def beam(count: int, axis: Any, inertia: float = TINY, bending: float = 1.0, stiff: float = 1e7) -> vv.Beam:
    section = vv.GivenSection(
        stiffness=(stiff, stiff, stiff, bending, bending, 1e3), mass=1.0, moments=(inertia, inertia, 0.0)
    )
    mesh = vv.LineMesh(points=[(0, 0, 0), axis], count=count, cell="line3")
    return vv.Beam(mesh=mesh, section=section)


@pytest.mark.parametrize("eta", [0, 1, 4, 12])
def test_rotating_cantilever(eta: int) -> None:
    """Flap and lag (Wright et al. 1982), stretched by the centrifugal forces before."""
    rows = np.genfromtxt(DATA / "rotating_cantilever.csv", delimiter=",", comments="#")
    flap1, flap2, _, lag1 = rows[rows[:, 0] == eta][0, 1:]
    blade = beam(20, (1, 0, 0))
    frame = vv.RotatingFrame(angular_velocity=(0, 0, eta), times="t")
    system = vv.System([blade, vv.Clamped(solid=blade, nodes="start"), frame])
    if eta:
        vv.quasi_static(system, until=1.0, step=0.5)
    else:
        system.time = 1.0
    modes = vv.modes(system, 5)
    assert modes.stable
    shapes = np.abs(modes.shape(blade, "node").reshape(5, -1, 12)[:, -1, :3])
    flap = modes.angular[shapes[:, 2] > 2 * shapes[:, 1]]
    lag = modes.angular[shapes[:, 1] > 2 * shapes[:, 2]]
    if eta:
        np.testing.assert_allclose(flap[:2], [flap1, flap2], rtol=3e-4)
        assert lag[0] == pytest.approx(lag1, rel=3e-4)
    else:  # equal ones mix
        np.testing.assert_allclose(modes.angular[:4], np.repeat([flap1, flap2], 2), rtol=3e-4)


@pytest.mark.parametrize("speed", [0.0, 5.0])
def test_shaft_whirls_forward_and_backward(speed: float) -> None:
    """Rayleigh's shaft on bearings: (m + i k^2) w^2 - 2 i k^2 W w = E I k^4, and seen from the shaft w - W."""
    inertia = 0.02
    shaft, ground = beam(16, (0, 0, 1), inertia), vv.Ground()
    ends = [
        vv.Fixed(solid=shaft, nodes="start"),
        vv.Fixed(solid=shaft, nodes="end", directions=(True, True, False)),
        vv.PointOnPlane(
            a=ground.frame((0, 0, 0), axes=((1, 0, 0), (0, 0, 1), (0, -1, 0))), b=shaft.point((1, 0, 0))
        ),
    ]
    frame = vv.RotatingFrame(angular_velocity=(0, 0, speed))
    modes = vv.modes(vv.System([ground, shaft, *ends, frame]), 4)
    exact = []
    for k in (np.pi, 2 * np.pi):
        m, g = 1 + inertia * k**2, inertia * k**2 * speed
        root = np.sqrt(g**2 + m * k**4)
        exact += [(g + root) / m - speed, (root - g) / m + speed]
    np.testing.assert_allclose(np.sort(modes.angular), np.sort(np.abs(exact)), rtol=4e-4)


def test_roots_of_many_coordinates_are_those_of_few(monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    shaft = beam(6, (0, 0, 1), 0.02)
    frame = vv.RotatingFrame(angular_velocity=(0, 0, 2.0))
    system = vv.System([shaft, vv.Clamped(solid=shaft, nodes="start"), frame])
    few = vv.modes(system, 4)
    monkeypatch.setattr(sys.modules["visviva.analysis.whirl"], "SMALL", 0)
    np.testing.assert_allclose(vv.modes(system, 4).roots, few.roots, rtol=1e-7)  # stiffnesses differ by 1e10


def test_solid_spins_as_a_point_mass_does() -> None:
    """A stiff block on springs along and across, at rest on the axis: (w^2 - k + W^2)^2 = 4 W^2 w^2, or w^2 = k."""
    k, speed = 100.0, 3.0
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1), origin=(-0.5, -0.5, -0.5))
    material = vv.NeoHooke(young=1e7, poisson=0.2)
    block = vv.Solid(mesh=mesh, material=material, density=1.0)
    hold = vv.ElasticFoundation(solid=block, faces="z0", normal=1e6, tangential=k)
    top = vv.ElasticFoundation(solid=block, faces="z1", normal=1e6)
    system = vv.System([block, hold, top, vv.RotatingFrame(angular_velocity=(0, 0, speed))])
    vv.quasi_static(system, until=1.0, step=1.0)
    assert vv.modes(system, 3).angular == pytest.approx(
        [np.sqrt(k) + w for w in (-speed, 0, speed)], rel=1e-3
    )


def test_dynamics_in_the_frame_is_that_seen_from_it() -> None:
    """A free mass goes straight: in the frame its path curls, and energy with the centrifugal one stays."""
    ball = vv.PointMass(mass=2.0, position=(1, 0, 0), velocity=(0, -1.0, 0))  # at rest in space
    system = vv.System([ball, vv.RotatingFrame(angular_velocity=(0, 0, 1))])
    result = vv.simulate(system, until=1.0, step=0.005)
    np.testing.assert_allclose(system.x[:2], [np.cos(1.0), -np.sin(1.0)], atol=1e-5)
    assert result.ledger.imbalance() < 1e-12


# --- flutter ------------------------------------------------------------------------------------------------
def beck(load: float) -> vv.Modes:
    column = beam(16, (0, 0, 1), stiff=1e6)
    follower = vv.FollowerForce(on=column.frame(1.0), force=(0, 0, -load), times="t")
    system = vv.System([column, vv.Clamped(solid=column, nodes="start"), follower])
    vv.quasi_static(system, until=1.0, step=1.0, scheme=vv.Static(unstable=True))
    return vv.modes(system, 4)


def test_beck_column_flutters() -> None:
    """Two frequencies meet under 20.05095 EI / L^2, at 11.0156."""
    below, above = beck(20.05), beck(20.06)
    assert below.stable
    assert not above.stable
    assert above.flutters
    assert "flutters" in str(above)
    np.testing.assert_allclose(above.roots[0].imag, 11.01555764092287, rtol=1e-4)


@pytest.mark.parametrize(("torque", "stable"), [(0.995, True), (1.005, False)])
def test_greenhill_shaft_bends_out_under_a_torque(torque: float, stable: bool) -> None:
    """Ends that may turn, torques whose axis stays: 2 pi EI / L."""
    shaft, ground = beam(16, (0, 0, 1), stiff=1e6), vv.Ground()
    ends = [
        vv.Fixed(solid=shaft, nodes="start"),
        vv.Fixed(solid=shaft, nodes="end", directions=(True, True, False)),
        vv.PointOnPlane(
            a=ground.frame((0, 0, 0.5), axes=((1, 0, 0), (0, 0, 1), (0, -1, 0))), b=shaft.point((1, 0, 0.5))
        ),
    ]
    twist = [
        vv.Torque(on=shaft.frame(s), torque=(0, 0, sign * 2 * np.pi * torque), times="t")
        for s, sign in ((0.0, -1), (1.0, 1))
    ]
    system = vv.System([ground, shaft, *ends, *twist])
    vv.quasi_static(system, until=1.0, step=0.5, scheme=vv.Static(unstable=True))
    modes = vv.modes(system, 4)
    assert modes.stable == stable
    assert not modes.flutters


def test_what_is_refused() -> None:
    ball = vv.PointMass(mass=1.0)
    frame = vv.RotatingFrame(angular_velocity=(0, 0, 1), times="t")
    with pytest.raises(vv.InputError, match="changes with time"):
        vv.simulate(vv.System([ball, frame]), until=1.0, step=0.1)
    mesh, foam = vv.RectangleMesh(size=(1, 1), counts=(1, 1)), vv.NeoHooke(young=1, poisson=0.3)
    flat = vv.Solid(mesh=mesh, material=foam, density=1.0, plane="strain")
    with pytest.raises(vv.InputError, match="no positions in space"):
        vv.System([flat, vv.RotatingFrame(angular_velocity=(0, 0, 1))])


def test_two_frames_are_refused() -> None:
    ball = vv.PointMass(mass=1.0, position=(1, 0, 0))
    frames = [vv.RotatingFrame(angular_velocity=(0, 0, w)) for w in (3.0, -3.0)]
    with pytest.raises(vv.InputError, match="is another frame"):
        vv.System([ball, *frames])
