"""Immersed rigid bodies against exact solutions and a body-fitted obstacle."""

from __future__ import annotations

import numpy as np
import pytest
from discs import disc
from immersed_parts import FALLEN, RADIUS, falling
from numpy.typing import NDArray

import visviva as vv
from visviva.examples import hinged_valve

Array = NDArray[np.float64]


def fall(n: int, cell: str) -> float:
    """Speed of a disc by the exact one."""
    log = vv.RigidBody(shape=vv.Cylinder(radius=RADIUS, length=1.0), density=2.0, position=FALLEN)
    system, exact = falling(log, n, cell)
    return float(-log.point().position.rate(system.v)[1] / exact)


def test_falling_disc() -> None:
    """The drag of a cylinder between walls: within a twelfth on four cells across, and closer on eight."""
    coarse, fine = fall(20, "quad4"), fall(40, "quad4")
    assert abs(fine - 1) < 0.02
    assert abs(coarse - 1) < 0.09
    assert fall(10, "quad9") == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize(("elements", "n"), [("Q2Q1", 4), ("Q1Q1", 8)])
def test_disc_in_shear_turns_at_half_the_rate(elements: str, n: int) -> None:
    """In the middle of a round vessel whose wall moves like plane shear: the rotation of the flow, half the shear rate.

    The rest of the flow strains; round a disc that takes no torque.
    """

    def shear(X: Array) -> Array:
        return np.asarray(X[:, 1:2] * [1.0, 0.0, 0.0])

    fluid = vv.Fluid(mesh=disc(1.0, (0, 0), n), elements=elements, density=1.0, viscosity=1.0, velocity=shear)
    log = vv.RigidBody(shape=vv.Cylinder(radius=0.3, length=1.0), density=1.0)
    wall = vv.VelocityBoundary(fluid=fluid, faces="all", velocity=lambda t, X: shear(X))
    system = vv.System([fluid, wall, log, vv.ImmersedBody(body=log, fluid=fluid)], vv.Newton(tolerance=1e-10))
    result = vv.simulate(system, until=1.0, step=0.05)
    a, b, _ = (d.value(system.x) for d in log.directors)
    rates = [log.directors[0].rate(v) for v in (system.v, result.rates[-2])]
    assert np.mean([np.dot(r, b) for r in rates]) == pytest.approx(-0.5, abs=5e-3)
    assert np.arctan2(a[1], a[0]) == pytest.approx(-0.5, abs=2e-3)
    assert np.allclose(log.point().position.value(system.x), 0.0, rtol=0, atol=1e-12)


def let_go(n: int, step: float) -> float:
    """Acceleration of a light disc by that in potential flow: added mass 1.168 in a box without friction.

    Fluid of little viscosity, around marks that are as close as nodes.
    """
    radius, density, end, added = 0.3, 0.3, 0.1, 1.1677
    mesh = vv.RectangleMesh(size=(2, 2), counts=(n, n), origin=(-1, -1))
    water = vv.Fluid(mesh=mesh, density=1.0, viscosity=1e-4)
    log = vv.RigidBody(shape=vv.Cylinder(radius=radius, length=1.0), density=density)
    wet = vv.ImmersedBody(body=log, fluid=water, spacing=1.0)
    gravity = vv.Gravity(acceleration=(0, -1, 0))
    system = vv.System([water, vv.FreeSlip(fluid=water, faces="all"), log, wet, gravity])
    vv.simulate(system, until=end, step=step)
    acceleration = 2 * log.point().position.value(system.x)[1] / end**2
    return float(acceleration * (density + added) / (1 - density))


@pytest.mark.parametrize("n", [32, 48])
def test_a_light_disc_is_let_go_as_in_potential_flow(n: int) -> None:
    """In ten steps, in which stabilisation lets through about as much as the fluid that sticks to the disc holds up."""
    assert let_go(n, 0.01) == pytest.approx(1.0, rel=0.05)


def test_a_light_disc_is_let_go_too_slowly_in_short_steps_on_few_cells() -> None:
    """The fluid sticks to a part of a cell around it: an error of the first order in cells, and on the safe side."""
    coarse, fine = (1 - let_go(n, 0.0025) for n in (24, 48))
    assert 0.0 < fine < 0.6 * coarse < 0.18


def drag(n: int, cell: str) -> float:
    """Drag of a held cylinder in a channel at the Reynolds number 20, on a mesh that is not fitted to it."""
    height, length, at = 0.41, 1.0, (0.2, 0.2, 0.0)
    mesh = vv.RectangleMesh(size=(length, height), counts=(round(length / height * n), n), cell=cell)

    def inflow(t: float, X: Array) -> Array:
        return 1.2 * X[:, 1:2] * (height - X[:, 1:2]) / height**2 * np.array([1.0, 0.0, 0.0])

    fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=1e-3, velocity=lambda X: inflow(0, X))
    post = vv.RigidBody(shape=vv.Cylinder(radius=0.05, length=1.0), density=1.0, position=at)
    ground = vv.Ground()
    wet = vv.ImmersedBody(body=post, fluid=fluid)
    parts = [
        fluid,
        vv.VelocityBoundary(fluid=fluid, faces="x0", velocity=inflow),
        *(vv.NoSlip(fluid=fluid, faces=side) for side in ("y0", "y1")),
        vv.Outlet(fluid=fluid, faces="x1"),
        ground,
        post,
        vv.Rigid(a=ground, b=post, at=at),
        wet,
    ]
    system = vv.System(parts, vv.Newton(tolerance=1e-8))
    for _ in vv.march(system, until=8.0, step=0.5, scheme=vv.BackwardEuler()):
        pass
    return float(2 * wet.forces(system.x)[:, 0].sum() / (0.2**2 * 0.1))


def test_held_body_is_an_obstacle() -> None:
    """DFG benchmark 2D-1, drag 5.5795 body-fitted: a sixth more with 8 cells of equal order across, less with 16."""
    coarse, fine = (drag(n, "quad4") / 5.57953523384 - 1 for n in (32, 64))
    assert 0.0 < fine < 0.6 * coarse
    assert coarse < 0.17


def test_leaflets_open_alike_on_their_hinges() -> None:
    """A rigid valve: balance, mirrored leaflets, feet on their hinges, and springs that hold what has turned."""
    study = hinged_valve.study(until=0.1)
    result = vv.simulate(study.system, until=study.until, step=study.step, scheme=study.scheme)
    hinged_valve.check(result)
    lower, upper = (float(study.probes[f"{side}_angle"](study.system)) for side in ("lower", "upper"))  # type: ignore[operator]
    assert lower == pytest.approx(-upper, abs=1e-8)
    assert 0.5 < upper < 0.7
    assert result.ledger["potential_spring"][-1] == pytest.approx(30.0 * upper**2, rel=1e-6)
    assert np.abs(result.ledger["imbalance"]).max() < 1e-10 * np.abs(result.ledger["work_supply"]).max()
