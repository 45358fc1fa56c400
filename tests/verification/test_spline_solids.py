"""Solids on splines: patch tests, closed forms on curved patches, order, what is conserved, supports, loads."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from verification.test_spline_patches import half, turned
from verification.test_splines import ring

Array = NDArray[np.float64]
STEEL = vv.SaintVenantKirchhoff(young=1000.0, poisson=0.3)
RUBBER = vv.NeoHooke(young=100.0, poisson=0.3)


def bent(patch: vv.SplinePatch) -> vv.SplinePatch:
    """With control points inside moved at random."""
    control, inner = patch.control.copy(), (slice(1, -1),) * patch.dimension
    shift = np.random.default_rng(3).uniform(-0.03, 0.03, size=control.shape)
    control[inner] += shift[inner]
    return replace(patch, control=control)


def meshes() -> dict[str, Any]:
    plane = {
        f"degree {p}": bent(vv.SplineBox(size=(1, 1), counts=(3, 2), degree=p).parts()[0])
        for p in (1, 2, 3, 4)
    }
    space = {
        f"cube {p}": bent(vv.SplineBox(size=(1, 1, 1), counts=(3, 2, 2), degree=p).parts()[0]) for p in (1, 2)
    }
    joined = vv.SplinePatches(patches=(bent(half(3, 2, 0.0)), turned(bent(half(3, 2, 1.0)))))
    return {**plane, **space, "joined": joined}


@pytest.mark.parametrize("name", meshes())
def test_patch_test(name: str) -> None:
    """An affine motion of the boundary is followed inside, with an even stress."""
    solid = vv.SplineSolid(mesh=meshes()[name], material=RUBBER)
    d = solid.dimension
    F = np.eye(3)
    F[:d, :d] += np.random.default_rng(1).uniform(-0.15, 0.15, size=(d, d))
    edge = vv.Prescribed(
        solid=solid, nodes=solid.grid.boundary().nodes, motion=lambda t, X: t * X @ (F - np.eye(3)).T
    )
    system = vv.System([solid, edge])
    vv.quasi_static(system, until=1.0, step=0.5)
    np.testing.assert_allclose(solid.positions(system.x), solid.points @ F.T, atol=1e-10)
    stress = solid.smoothed(["cauchy"], system.x)["cauchy"]
    exact = cube_stress(F)
    np.testing.assert_allclose(stress, np.tile(exact, (len(stress), 1)), atol=1e-8)


def cube_stress(F: Array) -> Array:
    """Of a plain element of the same material."""
    solid = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), material=RUBBER)
    system = vv.System([solid])
    system.x[:] = (solid.points @ F.T).ravel()
    return solid.smoothed(["cauchy"], system.x)["cauchy"][0]


def test_patch_test_of_a_ring_up_to_quadrature() -> None:
    """Rational functions are integrated to high order, not exactly."""
    F, errors = np.array([[1.1, 0.2, 0], [-0.1, 0.9, 0], [0, 0, 1]]), []
    for n in (2, 4):
        solid = vv.SplineSolid(mesh=ring().refined(n), material=RUBBER)
        motion = lambda t, X: t * X @ (F - np.eye(3)).T  # noqa: E731
        edge = vv.Prescribed(solid=solid, nodes=solid.grid.boundary().nodes, motion=motion)
        system = vv.System([solid, edge])
        vv.quasi_static(system, until=1.0, step=0.5)
        errors.append(np.abs(solid.positions(system.x) - solid.points @ F.T).max())
    assert errors[0] < 3e-5
    assert np.log2(errors[0] / errors[1]) > 4


def tube(n: int) -> tuple[float, float]:
    """Radial displacement within and hoop stress outside of a quarter tube under pressure, of linear elasticity."""
    tiny = 1e-6
    material = vv.LinearElastic(young=1000.0, poisson=0.3)
    solid = vv.SplineSolid(mesh=ring().refined(n), material=material)
    parts = [
        solid,
        vv.SymmetryPlane(solid=solid, nodes="y0", normal=(0, 1, 0)),
        vv.SymmetryPlane(solid=solid, nodes="y1", normal=(1, 0, 0)),
        vv.Pressure(solid=solid, faces="x0", pressure=tiny, follower=False),
    ]
    system = vv.System(parts)
    vv.quasi_static(system, until=1.0, step=1.0)
    inner = solid.nodes("x0")
    u = np.linalg.norm(solid.displacements(system.x)[inner], axis=1) / tiny
    outer = solid.nodes("x1")
    stress = solid.smoothed(["cauchy"], system.x)["cauchy"][outer] / tiny
    return float(u.mean()), float((stress[:, 0] + stress[:, 1]).mean())


def test_tube_of_lame() -> None:
    """u(a) of a thick tube in plane strain; at the free surface the hoop stress is the trace in the plane."""
    a, b, E, nu = 1.0, 2.0, 1000.0, 0.3
    A = a**2 / (b**2 - a**2)
    u = (1 + nu) / E * (A * (1 - 2 * nu) * a + A * b**2 / a)
    coarse, fine = (tube(n) for n in (4, 8))
    assert fine[0] == pytest.approx(u, rel=1e-4)
    assert fine[1] == pytest.approx(2 * A, rel=3e-3)
    assert np.log2(abs(coarse[0] - u) / abs(fine[0] - u)) > 3.5


def test_volume_and_mass_of_a_ring() -> None:
    solid = vv.SplineSolid(mesh=ring().refined(4), material=STEEL, density=2.0, thickness=0.5)
    system = vv.System([solid])
    assert solid.volume(system.x) == pytest.approx(3 * np.pi / 4, rel=1e-6)
    assert solid.mass == pytest.approx(3 * np.pi / 4, rel=1e-6)
    centre = solid.mass_moment(system.x) / solid.mass
    exact = 2 / 3 * 7 / 3 * 2 / np.pi  # (r2^3 - r1^3) / (r2^2 - r1^2) of an angle of 90 degrees
    np.testing.assert_allclose(centre, [exact, exact, 0], rtol=1e-6)
    assert solid.nodal_mass.sum() == pytest.approx(solid.mass, rel=1e-12)


@pytest.mark.parametrize("name", ["degree 3", "cube 2", "joined"])
def test_what_flies_keeps_energy_and_momenta(name: str) -> None:
    spin = (0.0, 0.0, 2.0) if "cube" not in name else (1.0, 0.5, 2.0)
    solid = vv.SplineSolid(
        mesh=meshes()[name],
        material=RUBBER,
        density=1.0,
        velocity=lambda X: np.stack([0.5 * X[:, 0] ** 2, 0.2 + 0 * X[:, 0], 0 * X[:, 0]], axis=1),
        angular_velocity=spin,
    )
    result = vv.simulate(vv.System([solid]), until=0.5, step=0.025)
    kept = result.conservation()
    for name in ("energy", "momentum_x", "momentum_y", "angular_z"):
        assert kept[name] < 1e-10
    assert np.ptp(result.ledger["potential_strain"]) > 1e-3


def wave_error(degree: int, n: int) -> float:
    """Of displacement (L2) under a body force that makes a smooth one, small strains."""
    E, nu, tiny = 1000.0, 0.25, 1e-6
    lam, mu = E * nu / (1 + nu) / (1 - 2 * nu), E / 2 / (1 + nu)
    k = np.pi

    def u(X: Array) -> Array:
        s = np.sin(k * X[:, 0]) * np.sin(k * X[:, 1])
        return tiny * np.stack([s, s, 0 * s], axis=1)

    def force(t: float, X: Array) -> Array:
        ss = np.sin(k * X[:, 0]) * np.sin(k * X[:, 1])
        cc = np.cos(k * X[:, 0]) * np.cos(k * X[:, 1])
        f = k * k * ((lam + 3 * mu) * ss - (lam + mu) * cc)
        return t * tiny * np.stack([f, f, 0 * f], axis=1)

    solid = vv.SplineSolid(
        mesh=vv.SplineBox(size=(1, 1), counts=(n, n), degree=degree),
        material=vv.LinearElastic(young=E, poisson=nu),
    )
    held = vv.Fixed(solid=solid, nodes=solid.grid.boundary().nodes)
    system = vv.System([solid, held, vv.BodyForce(solid=solid, force=force)])
    vv.quasi_static(system, until=1.0, step=1.0)
    found = solid.displacements(system.x) - u(solid.points)
    return float(np.sqrt((found**2).sum(axis=1).mean()) / tiny)


@pytest.mark.parametrize("degree", [1, 2, 3, 4])
def test_order_of_displacements(degree: int) -> None:
    coarse, fine = (wave_error(degree, n) for n in ((8, 16) if degree < 3 else (4, 8)))
    assert np.log2(coarse / fine) > degree + 1 - 0.25


def beam(dimension: int, **options: Any) -> vv.SplineSolid:
    plane, space = ((4, 1), (8, 2), 3), ((4, 1, 1), (6, 2, 2), 2)
    size, counts, degree = plane if dimension == 2 else space
    box = vv.SplineBox(size=size, counts=counts, degree=degree)
    return vv.SplineSolid(mesh=box, **({"material": RUBBER, "density": 1.0} | options))


@pytest.mark.parametrize("dimension", [2, 3])
def test_loads_and_what_holds(dimension: int) -> None:
    """Total forces by hand; the balances of what moves close."""
    body = beam(dimension)
    middle = (0.0, 0.5, 0.5 * (dimension == 3))
    coupling = vv.DistributedCoupling(solid=body, faces="x1")
    parts = [
        body,
        coupling,
        vv.Spherical(a=vv.Ground(), b=body, at=middle),
        vv.Gravity(acceleration=(0, -10, 0)),
        vv.Pressure(solid=body, faces="y1", pressure="20*t"),
        vv.Traction(solid=body, faces="x1", traction=(0, -1, 0)),
        vv.ElasticFoundation(solid=body, faces="y0", normal=5.0, damping=1.0),
        vv.Force(on=coupling.point((4.0, *middle[1:])), force=(1.0, 0, 0)),
    ]
    result = vv.simulate(vv.System(parts), until=0.2, step=0.01)
    assert result.conservation()["energy"] < 1e-11
    held = beam(dimension, density=0.0, material=vv.LinearElastic(young=1e7, poisson=0.0))
    loads = [
        vv.Fixed(solid=held, nodes="x0"),
        vv.Pressure(solid=held, faces="y1", pressure=2.0, follower=False),
        vv.Traction(solid=held, faces="x1", traction=(3.0, 0, 0)),
        vv.BodyForce(solid=held, force=(0, -0.5, 0)),
    ]
    system = vv.System([held, *loads])
    vv.quasi_static(system, until=1.0, step=1.0)
    np.testing.assert_allclose(vv.SupportForce(solid=held, nodes="x0")(system), [-3.0, 10.0, 0.0], atol=1e-9)
    torque = vv.SupportTorque(solid=held, about=(0, *middle[1:]))(system)
    np.testing.assert_allclose(torque, [0, 0, 2 * 10.0], atol=1e-3)  # but for the little that it bends
    inner = -held.nodal_forces(system.x)[held.nodes("x0")].sum(axis=0)
    on_the_side = (
        0.5 / 4 if dimension == 2 else 4 / 6 / 3
    )  # integral of the first function, whose load is not in it
    np.testing.assert_allclose(inner, [-3.0, (2.0 + 0.5) * (4 - on_the_side), 0.0], atol=1e-9)


@pytest.mark.parametrize("dimension", [2, 3])
def test_couplings_to_a_part_of_a_side(dimension: int) -> None:
    """The whole force on them comes to the support, with its moment about the middle of these faces."""
    body = beam(dimension, density=0.0, material=vv.LinearElastic(young=1e3, poisson=0.3))
    side = body.faces("x1")
    lower = side.where(side.centres(body.points)[:, 1] < 0.5)
    coupling = vv.DistributedCoupling(solid=body, faces=lower)
    place, force = np.array([4.0, 0.25, 0.5 * (dimension == 3)]), 1e-6 * np.array([1.0, 0.5, 0.0])
    load = vv.Force(on=coupling.point((0, 0, 0)), force=tuple(force))
    system = vv.System([body, coupling, load, vv.Fixed(solid=body, nodes="x0")])
    vv.quasi_static(system, until=1.0, step=1.0)
    np.testing.assert_allclose(vv.SupportForce(solid=body, nodes="x0")(system), -force, atol=1e-11)
    torque = vv.SupportTorque(solid=body, about=(0, 0, 0))(system)
    np.testing.assert_allclose(torque, -np.cross(place, force), atol=1e-11)


@pytest.mark.parametrize("dimension", [2, 3])
def test_contact_by_penalty(dimension: int) -> None:
    """Momentum and energy of two blocks that collide in free flight."""
    lower = beam(dimension)
    size, origin = ((2, 1), (1, 1.02)) if dimension == 2 else ((2, 1, 0.8), (1, 1.02, 0.1))
    box = vv.SplineBox(size=size, counts=(4, 2, 2)[:dimension], degree=2, origin=origin)
    upper = vv.SplineSolid(mesh=box, material=RUBBER, density=1.0, velocity=(0, -1, 0))
    touch = vv.Contact(first=upper, first_faces="y0", second=lower, second_faces="y1", enforcement="penalty")
    system = vv.System([lower, upper, touch])
    result = vv.simulate(system, until=0.2, step=0.005)
    kept = result.conservation()
    assert kept["energy"] < 1e-10
    assert kept["momentum_y"] < 1e-10
    assert lower.velocities(system.x, system.v)[:, 1].min() < -0.1


def test_prescribed_motion_of_a_side() -> None:
    """A table and a function of places give the same; sides go where they are told."""
    ends = []
    for motion in ((None, "0.1*t", None), lambda t, X: np.tile([0.0, 0.1 * t, 0.0], (len(X), 1))):
        body = beam(2)
        directions = (False, True, False)
        side = vv.Prescribed(solid=body, nodes="x1", motion=motion, directions=directions)
        system = vv.System([body, vv.Fixed(solid=body, nodes="x0"), side])
        result = vv.simulate(system, until=0.3, step=0.01)
        assert result.conservation()["energy"] < 1e-11
        np.testing.assert_allclose(body.displacements(system.x)[body.nodes("x1")][:, 1], 0.03, atol=1e-12)
        ends.append(system.x)
    np.testing.assert_allclose(*ends, atol=1e-7)


def test_bending_frequencies() -> None:
    """The first mode of a slender cantilever, of Euler and Bernoulli's beam but for shear (0.3 % of rotation too)."""
    box = vv.SplineBox(size=(20, 1), counts=(10, 1), degree=3)
    material = vv.LinearElastic(young=1e4, poisson=0.0)
    body = vv.SplineSolid(mesh=box, material=material, density=1.0)
    found = vv.modes(vv.System([body, vv.Fixed(solid=body, nodes="x0")]), 2).frequencies
    exact = np.array([1.875104, 4.694091]) ** 2 / 20**2 * np.sqrt(1e4 / 12) / (2 * np.pi)
    np.testing.assert_allclose(found[0], exact[0], rtol=4e-3)
    np.testing.assert_allclose(found[1], exact[1], rtol=3e-2)


def test_heat_stretches() -> None:
    """A free body takes the strain of heat, exactly."""
    body = vv.SplineSolid(mesh=ring().refined(2), material=RUBBER, thermal_strain=0.05, plane="stress")
    parts = [
        vv.SymmetryPlane(solid=body, nodes="y0", normal=(0, 1, 0)),
        vv.SymmetryPlane(solid=body, nodes="y1", normal=(1, 0, 0)),
    ]
    system = vv.System([body, *parts])
    vv.quasi_static(system, until=1.0, step=1.0)
    np.testing.assert_allclose(body.displacements(system.x), 0.05 * body.points, atol=1e-5)


def other(solid: vv.SplineSolid) -> vv.Solid:
    mesh = vv.RectangleMesh(size=(2, 1), counts=(2, 1), origin=(1, 1))
    return vv.Solid(mesh=mesh, material=RUBBER, density=1.0)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: beam(2, formulation="F-bar"), "splines need formulation = 'displacement'"),
        (lambda: beam(2, plane="axisymmetric"), "plane strain or stress"),
        (lambda: beam(2, lumped=True), "lumped = True"),
        (lambda: vv.RigidCoupling(solid=beam(2), faces="x0"), "take vv.DistributedCoupling"),
        (lambda: vv.SymmetryPlane(solid=beam(2), nodes="x0", normal=(1, 1, 0)), "a plane across an axis"),
        (
            lambda: vv.Tie(first=(b := beam(2)), first_faces="y1", second=other(b), second_faces="y0"),
            "as first",
        ),
        (
            lambda: vv.Contact(first=(b := beam(2)), first_faces="y1", second=other(b), second_faces="y0"),
            "take enforcement='penalty'",
        ),
        (
            lambda: vv.System([b := beam(2), vv.Fixed(solid=b, nodes=[40])]),
            "to hold 1 of its nodes would hold others beside them",
        ),
    ],
)
def test_refusals(make: Any, words: str) -> None:
    with pytest.raises(vv.InputError, match=words):
        make()


@pytest.mark.parametrize("degree", [2, 3])
def test_growth_of_phases_with_misfit(degree: int) -> None:
    """``R = -M k^2 (f'' + 2 eta^2 E / (1 - nu) + kappa k^2)`` (Cahn 1961), of waves that strain along themselves."""
    k, eta, E, nu = 0.35, 0.06, 20.0, 0.3
    length = np.pi / k
    body = vv.SplineMixtureSolid(
        mesh=vv.SplineBox(size=(length, length / 8), counts=(10, 2), degree=degree),
        material=vv.SaintVenantKirchhoff(young=E, poisson=nu),
        free_energy=vv.DoubleWell(barrier=5.0, low=0.3, high=0.7),
        gradient_energy=2.0,
        mobility=5.0,
        concentration=lambda X: 0.5 + 1e-5 * np.cos(k * X[:, 0]),
        reference=0.5,
        eigenstrain=eta,
    )
    across = vv.Prescribed(solid=body, nodes="all", motion=(None, 0.0, None))
    ends = [vv.Prescribed(solid=body, nodes=side, motion=(0.0, None, None)) for side in ("x0", "x1")]
    system = vv.System([body, across, *ends])
    vv.simulate(system, until=1.0, step=0.02)
    rate = -5 * k**2 * (-0.8 + 2 * eta**2 * E / (1 - nu) + 2 * k**2)
    assert np.log((body.values(system.x)[0] - 0.5) / 1e-5) == pytest.approx(rate, rel=1e-3)


PHASES: dict[str, Any] = {
    "material": RUBBER,
    "free_energy": vv.DoubleWell(barrier=5.0, low=0.3, high=0.7),
    "gradient_energy": 0.4,
    "mobility": 5.0,
    "reference": 0.5,
    "moduli": (0.8, 0.5),
    "concentration": lambda X: 0.5 + 0.1 * np.cos(2 * X[:, 0]) * np.cos(3 * X[:, 1]),
}


def joined_halves() -> vv.SplinePatches:
    return vv.SplinePatches(patches=(half(6, 2, 0.0), turned(half(6, 2, 1.0))))


def test_phases_in_motion_close_one_balance() -> None:
    """In finite strain, on two patches, with moduli that depend on the composition."""
    moving = {"density": 0.2, "eigenstrain": 0.3, "velocity": lambda X: 0.2 * X}
    body = vv.SplineMixtureSolid(mesh=joined_halves(), **PHASES, **moving)
    system = vv.System([body])
    mass = body.integral(system.x)
    result = vv.simulate(system, until=0.2, step=0.01)
    kept = result.conservation()
    assert max(kept[name] for name in ("energy", "momentum_x", "momentum_y", "angular_z")) < 1e-10
    assert body.integral(system.x) == pytest.approx(mass, rel=1e-12)
    assert np.all(np.diff(result.ledger["total"]) < 0)


def test_phases_at_rest_are_those_of_a_plain_mesh() -> None:
    """Quadratic elements of half the size: compositions, places and energies."""
    given = PHASES | {"eigenstrain": 0.1, "mobility": 0.1, "gradient_energy": 0.02}
    splines = vv.SplineMixtureSolid(mesh=joined_halves(), **given)
    mesh = vv.RectangleMesh(size=(2, 1), counts=(24, 12), cell="quad9")
    plain, found = vv.MixtureSolid(mesh=mesh, **given), []
    for body in (splines, plain):
        sides = [
            vv.SymmetryPlane(solid=body, nodes=np.flatnonzero(body.points[:, k] < 1e-9), normal=np.eye(3)[k])
            for k in range(2)
        ]
        system = vv.System([body, *sides])
        vv.simulate(system, until=0.1, step=0.01, scheme=vv.BackwardEuler())
        at = [int(np.argmin(np.abs(body.points - p).sum(axis=1))) for p in ((0, 0, 0), (1, 0, 0), (2, 1, 0))]
        found.append((body.values(system.x)[at], body.positions(system.x)[at], body.elastic_energy(system.x)))
    for one, other_one in zip(*found, strict=True):
        np.testing.assert_allclose(one, other_one, rtol=1e-3, atol=1e-5)
    assert found[0][2] > 1e-4
