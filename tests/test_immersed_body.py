"""Immersed rigid bodies: marks, balance of energy and forces, joints, and what is refused."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from immersed_parts import body, box, flap, part
from numpy.typing import NDArray
from scipy.spatial import cKDTree

import visviva as vv
from visviva.analysis.march import advance, begin
from visviva.base.errors import InputError
from visviva.flow.marks import marks
from visviva.measure.reactions import reaction
from visviva.study.restart import load, records_of, write
from visviva.system.consistency import initial_acceleration

Array = NDArray[np.float64]


def drifting(speed: str) -> tuple[vv.System, vv.RigidBody]:
    """A block of the fluid's own density in a stream without shear, whose speed is 1 at the start."""
    mesh = vv.RectangleMesh(size=(2, 1), counts=(12, 6), cell="quad4")
    water = vv.Fluid(mesh=mesh, density=1.0, viscosity=0.1, velocity=(1, 0, 0))
    sides = [vv.FreeSlip(fluid=water, faces=side) for side in ("y0", "y1")]
    ends = [
        vv.VelocityBoundary(fluid=water, faces="x0", velocity=(speed, 0, 0)),
        vv.Outlet(fluid=water, faces="x1"),
    ]
    block = vv.RigidBody(shape=vv.Box(size=(0.4, 0.4, 1.0)), density=1.0, position=(0.5, 0.5, 0.0))
    return vv.System([water, *sides, *ends, block, vv.ImmersedBody(body=block, fluid=water)]), block


# --- schemes that project rates -----------------------------------------------------------------------------
@pytest.mark.parametrize(
    "scheme", [vv.GeneralizedAlpha(), vv.GeneralizedAlpha(rho=0.0), vv.VariationalMidpoint()]
)
def test_a_body_of_the_density_of_a_stream_drifts_with_it(scheme: vv.Scheme) -> None:
    """Its mass less that of the fluid in its place is none: projected rates were lost, and it nearly stood still."""
    system, block = drifting("1 + t")
    vv.simulate(system, until=0.4, step=0.02, scheme=scheme)
    moved = system.value(block.point().position) - block.position
    assert moved == pytest.approx([0.4 + 0.4**2 / 2, 0, 0], abs=1e-10)
    assert system.v[block.motion.unknowns[:3]] == pytest.approx([1.4, 0, 0], abs=1e-10)


@pytest.mark.parametrize("density", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("step", [0.02, 0.005])
def test_a_body_in_a_swirl_has_rates_under_the_variational_midpoint_rule(step: float, density: float) -> None:
    """Those of a scheme that projects none; they swung from step to step, after 20 by a fifth of themselves."""

    def rates(scheme: vv.Scheme) -> tuple[Array, float]:
        parts = body(density=density)
        system = vv.System(parts)
        vv.simulate(system, until=20 * step, step=step, scheme=scheme)
        x, v = (a[part(parts, vv.RigidBody).motion.unknowns].reshape(4, 3) for a in (system.x, system.v))
        return v[0], float(np.cross(x[1], v[1])[2])

    found, expected = rates(vv.VariationalMidpoint()), rates(vv.EnergyMomentum())
    assert found[0] == pytest.approx(expected[0], abs=1e-3)
    assert found[1] == pytest.approx(expected[1], rel=(3.5 * step) ** 2)  # as it turns by that in a step


@pytest.mark.parametrize("at", [0.0, 0.3])
def test_a_disc_turns_with_a_fluid_that_turns_as_a_whole(at: float) -> None:
    """Places and rates are of second order in the step: those of ``exp(W t)``."""
    W = 2.0 * np.array([(0, -1, 0), (1, 0, 0), (0, 0, 0)])
    turned = np.array([(np.cos(0.8), -np.sin(0.8), 0), (np.sin(0.8), np.cos(0.8), 0), (0, 0, 1)])

    def error(step: float) -> tuple[float, float]:
        mesh = vv.RectangleMesh(size=(2, 2), counts=(6, 6), cell="quad9", origin=(-1, -1))
        water = vv.Fluid(
            mesh=mesh, density=1.0, viscosity=0.1, velocity=lambda X: np.pad(X[:, :2], ((0, 0), (0, 1))) @ W.T
        )
        edge = vv.VelocityBoundary(fluid=water, faces="all", velocity=lambda t, X: X @ W.T)
        disc = vv.RigidBody(shape=vv.Cylinder(radius=0.3, length=1.0), density=1.0, position=(at, 0, 0))
        system = vv.System([water, edge, disc, vv.ImmersedBody(body=disc, fluid=water)])
        vv.simulate(system, until=0.4, step=step, scheme=vv.VariationalMidpoint())
        x, v = (a[disc.motion.unknowns].reshape(4, 3)[:3] for a in (system.x, system.v))
        exact = np.stack([turned @ (at, 0, 0), *turned.T[:2]])
        return float(np.abs(x - exact).max()), float(np.abs(v - exact @ W.T).max())

    coarse, fine = error(0.04), error(0.02)
    for one, other in zip(coarse, fine, strict=True):
        assert 3.5 < one / other < 4.5
    assert fine[1] < 0.002


def test_accelerations_at_another_moment_are_those_of_the_stream() -> None:
    """Those that generalised alpha starts from belong to a step before, with ``rho=0``; they were none."""
    system, block = drifting("1 + t + t**2")
    system.check()
    initial_acceleration(system, vv.GeneralizedAlpha(rho=0.0), 0.1)
    assert system.core.a[block.motion.unknowns[0]] == pytest.approx(1 - 2 * 0.1, rel=0.01)


# --- marks --------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("spacing", [0.1, 0.07, 0.03])
@pytest.mark.parametrize(
    ("shape", "plane"),
    [
        (vv.Box(size=(0.7, 0.4, 1.0)), True),
        (vv.Cylinder(radius=0.3, length=1.0), True),
        (vv.Box(size=(0.5, 0.02, 1.0)), True),
        (vv.Sphere(radius=0.2), False),
        (vv.Box(size=(0.3, 0.2, 0.4)), False),
        (vv.Box(size=(0.5, 0.02, 0.4)), False),
    ],
)
def test_marks_are_equally_far_apart(shape: Any, plane: bool, spacing: float) -> None:
    """None much closer than the spacing; every place of the surface has one near."""
    found = marks(shape, spacing, plane=plane)
    assert cKDTree(found).query(found, k=2)[0][:, 1].min() > 0.55 * spacing
    points, triangles = shape.surface(resolution=96)
    middles = points[triangles].mean(axis=1)
    if plane:
        middles = middles[np.abs(middles[:, 2]) < 0.4] * [1, 1, 0]
    assert cKDTree(found).query(middles)[0].max() < 1.2 * spacing
    assert np.all(found[:, 2] == 0) == plane


def test_marks_follow_an_outline_that_is_not_convex() -> None:
    """A prism over an L: marks inside are inside, and its six corners are marked."""
    pytest.importorskip("trimesh")
    corners = np.array([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)], dtype=float)
    n = len(corners)
    points = np.vstack([np.column_stack([corners, np.full(n, z)]) for z in (-0.5, 0.5)])
    flat = np.array([(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)])
    k = np.arange(n)
    after = np.roll(k, -1)
    sides = np.vstack([np.column_stack([k, after, after + n]), np.column_stack([k, after + n, k + n])])
    shape = vv.SurfaceMesh(points=points, triangles=np.vstack([flat[:, ::-1], flat + n, sides]))
    assert shape.volume == pytest.approx(3.0)
    found = marks(shape, 0.2, plane=True)[:, :2]
    assert cKDTree(found).query(corners)[0].max() < 1e-12
    assert not np.any((found > 1 + 1e-9).all(axis=1))
    assert len(found) == pytest.approx(3.0 / 0.04 + 0.5 * 8 / 0.2, rel=0.2)


# --- balances -----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("density", [0.5, 1.0, 3.0])
@pytest.mark.parametrize(
    ("build", "cell"), [(body, "quad4"), (body, "tri6"), (flap, "quad4"), (flap, "quad9")]
)
def test_energy_of_a_closed_box_balances(build: Any, cell: str, density: float) -> None:
    """Energy changes by dissipation alone, and marks move with the fluid, over many steps."""
    parts = build(cell, 6, density=density)
    system = vv.System(parts)
    result = vv.simulate(system, until=0.6, step=0.02)
    ledger = result.ledger
    assert np.abs(ledger["imbalance"]).max() < 1e-12 * ledger["total"][0]
    assert np.all(np.diff(ledger["work_viscosity"]) < 0)
    assert np.abs(ledger["defect_position"]).max() < 1e-11
    wet = part(parts, vv.ImmersedBody)
    assert np.linalg.norm(wet.places(system.x) - wet.places(result.states[0]), axis=1).max() > 0.02


def test_hinge_holds_and_spring_stores() -> None:
    """What turns about a hinge in the fluid keeps its point there, and energy goes into the spring."""
    parts = flap("quad9", 6)
    system = vv.System(parts)
    result = vv.simulate(system, until=0.5, step=0.02)
    block = part(parts, vv.RigidBody)
    point = block.point((-0.15, 0, 0)).position
    assert np.allclose(point.value(system.x), (0.47, 0.5, 0.0), rtol=0, atol=1e-12)
    hinge = part(parts, vv.Revolute)
    angle = hinge.coordinate("angle").value(system.x)
    assert abs(angle) > 0.05
    assert result.ledger["potential_spring"][-1] == pytest.approx(0.01 * angle**2)


def test_motor_turns_a_body_in_the_fluid() -> None:
    """A disc that a motor turns in a round vessel drags the fluid with it: torque 4 pi mu w R^2 / (1 - R^2 / b^2)."""
    from discs import disc

    radius, rate, viscosity = 0.4, 2.0, 1.5
    errors = []
    for n in (4, 8):
        fluid = vv.Fluid(mesh=disc(1.0, (0, 0), n), elements="Q1Q1", density=0.1, viscosity=viscosity)
        wheel, ground = vv.RigidBody(shape=vv.Cylinder(radius=radius, length=1.0), density=1.0), vv.Ground()
        hinge = vv.Revolute(a=ground, b=wheel, at=(0, 0, 0))
        motor = vv.Motor(joint=hinge, motion=f"{rate} * t")
        wet = vv.ImmersedBody(body=wheel, fluid=fluid)
        system = vv.System([fluid, vv.NoSlip(fluid=fluid, faces="all"), wheel, ground, hinge, motor, wet])
        for _ in vv.march(system, until=1.0, step=0.1, scheme=vv.BackwardEuler()):
            pass
        exact = 4 * np.pi * viscosity * rate * radius**2 / (1 - radius**2)
        errors.append(abs(motor.effort(system)) / exact - 1)
    assert abs(errors[1]) < 0.1
    assert abs(errors[1]) < 0.75 * abs(errors[0])


@pytest.mark.parametrize("density", [3.0, 0.5])
def test_a_held_body_at_rest_weighs_less_by_the_fluid_it_displaces(density: float) -> None:
    """Archimedes: the joint bears (rho_s - rho_f) g times the area."""
    parts = body("quad4", 8, density=density)
    fluid = box("quad4", 8, velocity=(0.0, 0.0, 0.0), viscosity=1.0)
    block, ground = part(parts, vv.RigidBody), vv.Ground()
    weld = vv.Rigid(a=ground, b=block, at=block.position)
    wet = vv.ImmersedBody(body=block, fluid=fluid)
    gravity = vv.Gravity(acceleration=(0, -2.0, 0))
    system = vv.System([fluid, vv.NoSlip(fluid=fluid, faces="all"), block, ground, weld, wet, gravity])
    vv.simulate(system, until=2.0, step=0.2, scheme=vv.BackwardEuler())
    force, _ = reaction(system, weld)
    assert wet.total_mass == pytest.approx(-0.06)
    assert abs(force[1]) == pytest.approx(abs(density - 1.0) * 0.06 * 2.0, rel=1e-3)
    assert force[0] == pytest.approx(0.0, abs=1e-4)


# --- fluid that passes between marks ------------------------------------------------------------------------
def released(spacing: float, n: int = 16, cell: str = "quad9", **fluid: Any) -> vv.System:
    """A light disc at rest in a fluid of hardly any viscosity, which gravity pulls."""
    mesh = vv.RectangleMesh(size=(2, 2), counts=(n, n), origin=(-1, -1), cell=cell)
    water = vv.Fluid(mesh=mesh, density=1.0, viscosity=fluid.get("viscosity", 1e-4))
    disc = vv.RigidBody(shape=vv.Cylinder(radius=0.3, length=1.0), density=0.3)
    wet = vv.ImmersedBody(body=disc, fluid=water, spacing=spacing, name="wet")
    pull = vv.Gravity(acceleration=(0, -1.0, 0))
    return vv.System([water, vv.FreeSlip(fluid=water, faces="all"), disc, wet, pull])


def momentum_not_carried(system: vv.System, step: float) -> float:
    """After the first step from rest: that of the fluid within, as far as it is not the disc's, by the impulse.

    The latter follows from the motion of the disc, whose weight and inertia are those of what it has more than fluid.
    """
    water, disc = (next(c for c in system.components if isinstance(c, k)) for k in (vv.Fluid, vv.RigidBody))
    at, speed = (disc.point().position.value(system.x), disc.point().position.rate(system.v)[1])
    radii, weights = np.polynomial.legendre.leggauss(12)
    radii, weights = 0.15 * (radii + 1), 0.15 * weights
    angles = np.linspace(0, 2 * np.pi, 96, endpoint=False)
    places = at[:2] + radii[:, None, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    flow = water.at(places.reshape(-1, 2)).velocities(system.x)[:, 1].reshape(len(radii), -1)
    slip = float(((flow - speed).mean(axis=1) * 2 * np.pi * radii) @ weights)
    area = np.pi * 0.3**2
    impulse = (0.3 - 1.0) * area * (speed + 1.0 * step)
    return abs(slip) / max(abs(impulse), area * abs(speed))


@pytest.mark.parametrize(("cell", "n"), [("quad4", 32), ("quad9", 16)])
def test_fluid_that_passes_between_marks_is_told(cell: str, n: int) -> None:
    """A sixth and more of its momentum in the first step, as integrals over the disc and the motion of that say."""
    system = released(1.5, n, cell)
    result = vv.simulate(system, until=0.01, step=0.01)
    (lag,) = result.ledger.sizes.lags
    assert lag.part == pytest.approx(momentum_not_carried(system, 0.01), rel=0.1)
    assert lag.part > 0.14
    cure = "take spacing=1$" if cell == "quad4" else "take spacing=1.2$"
    assert re.search(
        f"fluid within .* lacks 0.[123].* of its momentum: WRONG, .* between the marks of .*wet.*{cure}",
        result.audit(),
        re.MULTILINE,
    )


@pytest.mark.parametrize(
    ("spacing", "cell", "n", "viscosity"),
    [(1.0, "quad4", 32, 1e-4), (1.2, "quad9", 16, 1e-4), (1.5, "quad4", 32, 0.1), (1.2, "tri3", 32, 1e-4)],
)
def test_closer_marks_and_viscosity_hold_the_fluid(
    spacing: float, cell: str, n: int, viscosity: float
) -> None:
    result = vv.simulate(released(spacing, n, cell, viscosity=viscosity), until=0.1, step=0.01)
    assert 0 < result.ledger.sizes.lags[0].part < 0.065
    assert "fluid within" not in result.audit()


def test_what_is_not_carried_goes_on_from_a_file_to_the_bit(tmp_path: Path) -> None:
    whole = vv.simulate(released(1.5, 16, "quad4"), until=0.04, step=0.01)
    for k in range(4):
        result, books = begin(released(1.5, 16, "quad4"))
        if k:
            load(tmp_path / "state.h5", result, books)
        for _ in advance(result, books, until=(k + 1) * 0.01, step=0.01):
            pass
        write(tmp_path / "state.h5", records_of(result, books), {})
    assert np.array_equal(result.ledger.sizes.lags[0].memory, whole.ledger.sizes.lags[0].memory)


# --- bad input ----------------------------------------------------------------------------------------------
def wet(**options: Any) -> vv.ImmersedBody:
    return vv.ImmersedBody(body=part(body(**options), vv.RigidBody), fluid=box())


BAD: dict[str, tuple[Callable[[], Any], str]] = {
    "spacing": (
        lambda: vv.ImmersedBody(body=part(body(), vv.RigidBody), fluid=box(), spacing=0.0),
        "spacing = 0.0 is not a number from 0.1 to 10",
    ),
    "marks too close": (
        lambda: vv.ImmersedBody(body=part(body(), vv.RigidBody), fluid=box("quad9"), spacing=1.0),
        "marks with a spacing of 1 .*; take at least 1.1 with its elements, 1.5 is usual",
    ),
    "marks too close in triangles": (
        lambda: vv.ImmersedBody(body=part(body(), vv.RigidBody), fluid=box("tri6"), spacing=1.2),
        "take at least 1.3",
    ),
    "no shape": (
        lambda: wet(shape=None, density=None, mass=1.0, inertia=(1.0, 1.0, 1.0)),
        "has no shape; give it one",
    ),
    "thickness": (
        lambda: wet(shape=vv.Sphere(radius=0.1)),
        "is 0.2 long along its z axis and must have the length 1",
    ),
    "tilted": (
        lambda: wet(rotation=((1, 0, 0), (0, 0, -1), (0, 1, 0))),
        "third director of RigidBody must be normal to the plane",
    ),
    "velocity of its own": (
        lambda: wet(velocity=(1, 0, 0)),
        "starts with the velocity of Fluid; leave out its own",
    ),
    "outside": (lambda: vv.System(body(position=(0.9, 0.5, 0))), r"lies outside of Fluid.* at \(1.05, 0.4\)"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input(name: str) -> None:
    build, message = BAD[name]
    with pytest.raises(InputError, match=message):
        build()


@pytest.mark.parametrize(("spacing", "cell", "said"), [(1.2, "quad9", True), (1.5, "quad9", False)])
def test_marks_that_are_nearly_too_close_are_remarked_on(spacing: float, cell: Any, said: bool) -> None:
    wet = vv.ImmersedBody(body=part(body(), vv.RigidBody), fluid=box(cell), spacing=spacing)
    assert bool(wet.remarks()) == said
