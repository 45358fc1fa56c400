"""Immersed solids against exact solutions."""

from __future__ import annotations

import numpy as np
import pytest
from discs import annulus, disc
from immersed_parts import FALLEN, RADIUS, falling, vortex
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]


def test_solid_like_the_fluid_changes_nothing() -> None:
    """Of the same density and without stiffness: the fluid's own stress acts in its place."""

    def velocities(parts: list[vv.Component], fluid: vv.Fluid) -> Array:
        system = vv.System([fluid, vv.NoSlip(fluid=fluid, faces="all"), *parts])
        vv.simulate(system, until=0.5, step=0.05)
        return fluid.velocities(system.x, system.v)

    def box() -> vv.Fluid:
        mesh = vv.RectangleMesh(size=(1, 1), counts=(10, 10), cell="quad9")
        return vv.Fluid(mesh=mesh, density=2.0, viscosity=0.01, velocity=vortex)

    alone, fluid = box(), box()
    feather = vv.NeoHooke(young=1e-9, poisson=0.3)
    solid = vv.Solid(mesh=disc(0.15, (0.6, 0.4), 3), material=feather, density=2.0)
    both = velocities([solid, vv.Immersed(solid=solid, fluid=fluid)], fluid)
    without = velocities([], alone)
    assert np.abs(without).max() > 0.3
    assert np.allclose(both, without, rtol=0, atol=1e-8)


def thread(n: int) -> tuple[Array, float]:
    """Pressures inside and outside of a stretched circular thread in a fluid at rest, and the greatest velocity.

    The force per angle is the second derivative of the places along the angle: the pressure jumps by 1. A skin
    without stiffness carries the thread's springs.
    """
    mesh = vv.RectangleMesh(size=(1, 1), counts=(n, n), cell="quad9")
    fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=1.0)
    skin_mesh = annulus((0.25, 0.251), (1, 4 * n), (0.5, 0.5))
    skin = vv.Solid(mesh=skin_mesh, material=vv.NeoHooke(young=1e-9, poisson=0.3), density=1.0)
    knots = [skin.point(X) for X in skin.points[: 4 * n]]
    pull = len(knots) / (2 * np.pi)
    springs = [
        vv.Spring(a=a, b=b, stiffness=pull, free_length=0.0)
        for a, b in zip(knots, [*knots[1:], knots[0]], strict=True)
    ]
    walls = vv.NoSlip(fluid=fluid, faces="all")
    system = vv.System([fluid, walls, skin, vv.Immersed(solid=skin, fluid=fluid), *springs])
    for _ in vv.march(system, until=0.02, step=0.01, scheme=vv.BackwardEuler()):
        pass
    places = fluid.at([(0.5, 0.5), (0.05, 0.05)])
    return places.pressures(system.x), float(np.abs(fluid.velocities(system.x, system.v)).max())


def test_pressure_in_a_thread() -> None:
    """Exact with mean zero: 1 - pi/16 inside, -pi/16 outside, and rest: spurious velocities vanish like the cells."""
    exact = np.array([1 - np.pi / 16, -np.pi / 16])
    coarse, fine = thread(16), thread(32)
    assert np.abs(coarse[0] - exact).max() < 1e-2
    assert np.abs(fine[0] - exact).max() < 5e-4
    assert fine[1] < 0.55 * coarse[1] < 3e-3


def fall(n: int) -> float:
    """Speed of a stiff disc by the exact one."""
    stiff = vv.NeoHooke(young=1e3, poisson=0.3)
    solid = vv.Solid(mesh=disc(RADIUS, FALLEN[:2], 4), material=stiff, density=2.0)
    system, exact = falling(solid, n, "quad9")
    return float(-(solid.nodal_mass @ solid.velocities(system.x, system.v))[1] / solid.mass / exact)


def test_falling_disc() -> None:
    """The drag of a cylinder between walls, of first order in the cells: a disc is felt half a cell too wide."""
    coarse, fine = fall(10), fall(20)
    assert 0.85 < fine < 0.92
    assert 2 * fine - coarse == pytest.approx(1.0, abs=0.04)


def inflated(n: int) -> tuple[float, float]:
    """Area that a ring encloses more, per what flowed into it, and pressure inside, after it was blown up from 0.25
    to 0.275 and rests."""
    inner, a, b, t_end, path = 0.15, 0.25, 0.3125, 1.0, (0.275**2 - 0.25**2) / (2 * 0.15)

    def source(t: float, X: Array) -> Array:
        return X / inner * (path * 2 / t_end * np.sin(np.pi * t / t_end) ** 2 if t < t_end else 0.0)

    fluid = vv.Fluid(
        mesh=annulus((inner, 0.6), (3 * n, 2 * n), cell="quad9", quarter=True), density=1e-3, viscosity=0.01
    )
    rubber = vv.NeoHooke(young=2.6, poisson=0.3)  # shear modulus 1; the fluid keeps the volume
    ring = vv.Solid(mesh=annulus((a, b), (n, 3 * n), quarter=True), material=rubber, density=1e-3)
    system = vv.System(
        [
            fluid,
            vv.VelocityBoundary(fluid=fluid, faces="x0", velocity=source),
            vv.Outlet(fluid=fluid, faces="x1"),
            *(vv.FreeSlip(fluid=fluid, faces=side) for side in ("y0", "y1")),
            ring,
            vv.Fixed(solid=ring, nodes="y0", directions=(False, True, False)),
            vv.Fixed(solid=ring, nodes="y1", directions=(True, False, False)),
            vv.Immersed(solid=ring, fluid=fluid),
        ],
        vv.Newton(tolerance=1e-9),
    )
    for _ in vv.march(system, until=1.5, step=0.1):
        pass
    inside = np.flatnonzero(np.isclose(np.linalg.norm(ring.points, axis=1), a))
    radius = float(np.linalg.norm(ring.positions(system.x)[inside], axis=1).mean())
    pressure = fluid.at([(0.13, 0.13), (0.4, 0.4)]).pressures(system.x)
    return (radius**2 - a**2) / (2 * inner * path), float(pressure[0] - pressure[1])


def test_inflated_ring() -> None:
    """Area by what flows in; pressure of an incompressible neo-Hooke ring, ln(la/lb) + (1/lb^2 - 1/la^2) / 2."""
    la, lb = 0.275 / 0.25, 0.332838173892 / 0.3125
    exact = np.log(la / lb) + 0.5 * (lb**-2 - la**-2)
    assert exact == pytest.approx(0.0597967370178, abs=1e-11)
    (area, pressure), (fine_area, fine_pressure) = inflated(3), inflated(6)
    assert fine_area == pytest.approx(1.0, abs=0.03)
    assert abs(1 - fine_area) < 0.7 * abs(1 - area)
    assert 2 * fine_pressure - pressure == pytest.approx(exact, rel=0.02)


def test_oscillating_disc_balances_energy() -> None:
    """A disc in the middle of a vortex takes its energy up and gives it back; what is lost is lost to viscosity."""

    def swirl(X: Array) -> Array:
        x, y = 2 * np.pi * X[:, :2].T
        return 0.1 * np.pi * np.stack([np.sin(x) * np.cos(y), -np.cos(x) * np.sin(y), 0 * x], axis=1)

    mesh = vv.RectangleMesh(size=(1, 1), counts=(16, 16), cell="quad9")
    fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=1e-3, velocity=swirl)
    rubber = vv.NeoHooke(young=1.0, poisson=0.0)
    solid = vv.Solid(mesh=disc(0.2, (0.5, 0.5), 5), material=rubber, density=1.0)
    walls = vv.FreeSlip(fluid=fluid, faces="all")
    parts = [fluid, walls, solid, vv.Immersed(solid=solid, fluid=fluid)]
    system = vv.System(parts, vv.Newton(tolerance=1e-10))
    result = vv.simulate(system, until=0.8, step=0.02)
    ledger = result.ledger
    start = 0.25 * (0.1 * np.pi) ** 2
    assert ledger["kinetic"][0] == pytest.approx(start, rel=1e-3)
    assert ledger["potential_strain"].max() > 0.25 * start
    assert ledger["potential_strain"][35] < 0.1 * start
    assert (np.diff(ledger["total"]) < 0).all()
    result.assert_conserved("energy", tolerance=1e-12)


@pytest.mark.parametrize(("density", "exact", "step"), [(1400.0, 0.636945, 0.2), (140.0, 1.613051, 0.08)])
def test_added_mass_of_a_ring(density: float, exact: float, step: float) -> None:
    """Frequency of a ring that fluid fills and surrounds up to a rigid wall, in its mode of two waves.

    Reference: plane elasticity with nu = 0.3 and an ideal fluid. Here the fluid keeps the volume of the ring, so that
    its shear modulus is that which bends alike, mu = E / 4 / (1 - nu^2).
    """
    wall, mu, speed = 1.5, 1e6 / (4 * 0.91), 1e-3

    def start(X: Array) -> Array:
        r, theta = np.maximum(np.hypot(X[:, 0], X[:, 1]), 1e-9), np.arctan2(X[:, 1], X[:, 0])
        along = np.where(r < 1, r, (r - wall**4 / r**3) / (1 - wall**4)) * np.cos(2 * theta)
        across = np.where(r < 1, -r, -(r + wall**4 / r**3) / (1 - wall**4)) * np.sin(2 * theta)
        c, s = np.cos(theta), np.sin(theta)
        return speed * np.stack([along * c - across * s, along * s + across * c, 0 * r], axis=1)

    fluid = vv.Fluid(
        mesh=disc(wall, (0, 0), 10),
        density=density,
        viscosity=1e-6 * density,
        velocity=start,
        elements="Q2Q1",
    )
    ring = vv.Solid(
        mesh=annulus((0.95, 1.05), (2, 120)),
        material=vv.NeoHooke(young=2.6 * mu, poisson=0.3),
        density=1000.0,
        formulation="enhanced",
    )
    walls = vv.FreeSlip(fluid=fluid, faces="all")
    parts = [fluid, walls, ring, vv.Immersed(solid=ring, fluid=fluid)]
    system = vv.System(parts, vv.Newton(tolerance=1e-8))
    node, before = int(np.argmin(np.linalg.norm(ring.points[:, :2] - [1.0, 0.0], axis=1))), 0.0
    for _ in vv.march(system, until=7 / exact, step=step):
        u = float(ring.displacements(system.x)[node, 0])
        if u < 0:
            break
        before = u
    half_period = system.time - step * u / (u - before)
    assert np.pi / half_period == pytest.approx(exact, rel=0.07)
