"""Solids on splines of degrees 2 to 4 in space: orders of convergence, a sphere and tubes of Lamé, patch test."""

from __future__ import annotations

from math import comb

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from verification.test_spline_solids import RUBBER, bent

Array = NDArray[np.float64]
E, NU = 1000.0, 0.25
STEEL = vv.LinearElastic(young=E, poisson=NU)
INNER, OUTER = 1.0, 1.5


def wave_error(degree: int, n: int) -> tuple[float, float]:
    """Of displacement and of stress (L2, relative) under a body force that makes smooth ones, small strains."""
    lam, mu, k = E * NU / (1 + NU) / (1 - 2 * NU), E / 2 / (1 + NU), np.pi

    def sines(X: Array) -> tuple[Array, Array]:
        return np.sin(k * X), np.cos(k * X)

    def u(X: Array) -> Array:
        s, _ = sines(X)
        return np.repeat(s.prod(axis=1)[:, None], 3, axis=1)

    def grad(X: Array) -> Array:
        """Of each component, which are equal (n, 3)."""
        s, c = sines(X)
        return k * np.stack([c[:, i] * s[:, i - 1] * s[:, i - 2] for i in range(3)], axis=1)

    def force(t: float, X: Array) -> Array:
        s, c = sines(X)
        mixed = [
            sum(c[:, i] * c[:, j] * s[:, 3 - i - j] for j in range(3) if j != i) - s.prod(axis=1)
            for i in range(3)
        ]  # second derivatives by i and j, summed over j, by k^2
        own = 3 * mu * s.prod(axis=1)
        return t * k * k * np.stack([own - (lam + mu) * m for m in mixed], axis=1)

    solid = vv.SplineSolid(mesh=vv.SplineBox(size=(1, 1, 1), counts=(n, n, n), degree=degree), material=STEEL)
    held = vv.Fixed(solid=solid, nodes=solid.grid.boundary().nodes)
    system = vv.System([solid, held, vv.BodyForce(solid=solid, force=force)])
    vv.quasi_static(system, until=1.0, step=1.0)
    X = solid.points
    off = solid.displacements(system.x) - u(X)
    G = np.repeat(grad(X)[:, None], 3, axis=1)
    strain = 0.5 * (G + G.swapaxes(1, 2))
    stress = lam * np.trace(strain, axis1=1, axis2=2)[:, None, None] * np.eye(3) + 2 * mu * strain
    exact = np.stack([stress[:, i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))], axis=1)
    stray = solid.smoothed(["cauchy"], system.x)["cauchy"] - exact
    return float(np.linalg.norm(off) / np.linalg.norm(u(X))), float(
        np.linalg.norm(stray) / np.linalg.norm(exact)
    )


@pytest.mark.parametrize(("degree", "fine"), [(2, 8), (3, 6), (4, 6)])
def test_order_of_displacements_and_stresses(degree: int, fine: int) -> None:
    errors = np.array([wave_error(degree, n) for n in (4, fine)])
    orders = np.log(errors[0] / errors[1]) / np.log(fine / 4)
    assert orders[0] > degree + 1 - 0.25
    assert orders[1] > degree


@pytest.mark.parametrize("degree", [3, 4])
def test_patch_test_up_to_quadrature(degree: int) -> None:
    """An affine motion: Jacobians of such degrees are integrated to high order, not exactly; those of a cuboid are."""
    F, off = np.array([[1.1, 0.2, 0], [-0.1, 0.9, 0.1], [0.05, 0, 1]]), []
    box = vv.SplineBox(size=(1, 1, 1), counts=(2, 1, 1), degree=degree).parts()[0]
    for patch in (box, bent(box), bent(box).refined(2)):
        solid = vv.SplineSolid(mesh=patch, material=RUBBER)
        edge = vv.Prescribed(
            solid=solid, nodes=solid.grid.boundary().nodes, motion=lambda t, X: t * X @ (F - np.eye(3)).T
        )
        system = vv.System([solid, edge])
        vv.quasi_static(system, until=1.0, step=0.5)
        off.append(np.abs(solid.positions(system.x) - solid.points @ F.T).max())
    assert off[0] < 1e-13
    assert off[1] < 1e-5
    assert np.log2(off[1] / off[2]) > 4


def bernstein(p: int, x: Array) -> Array:
    """Values (n, p + 1)."""
    return np.stack([comb(p, i) * x**i * (1 - x) ** (p - i) for i in range(p + 1)], axis=1)


def clamped(p: int) -> list[float]:
    """Knots of one span."""
    return [0.0] * (p + 1) + [1.0] * (p + 1)


def sphere(n: int) -> vv.SplinePatches:
    """An octant of a hollow sphere of three patches of degree 4 and n spans, with sides on great circles.

    A patch of the plane with sides of lines and circles, quadratic and rational, is taken onto the sphere by the
    stereographic projection from its south pole, which takes circles onto circles.
    """
    a, c = np.tan(np.pi / 8), 1 / (1 + np.sqrt(3))  # of the middle of a side of the octant, and of its centre
    half = 0.5 * np.arctan2(c, 1 + c)  # of the angle of the circle about (-1, 0) through both
    w, tangent = np.cos(half), np.sqrt(2) * np.tan(half)
    net = np.empty((3, 3, 3))  # x w, y w, w
    net[0, 0], net[2, 0], net[0, 2], net[2, 2] = (0, 0, 1), (a, 0, 1), (0, a, 1), (c, c, 1)
    net[1, 0], net[0, 1] = (a / 2, 0, 1), (0, a / 2, 1)
    net[2, 1], net[1, 2] = w * np.array([a, tangent, 1]), w * np.array([tangent, a, 1])
    net[1, 1] = (net[1, 0] + net[0, 1] + net[2, 1] + net[1, 2]) / 2 - net[::2, ::2].sum(axis=(0, 1)) / 4
    x = np.linspace(0, 1, 5)
    X, Y, W = np.einsum("ai,bj,ijk->kab", bernstein(2, x), bernstein(2, x), net)
    on = np.stack([2 * X * W, 2 * Y * W, W * W - X * X - Y * Y, W * W + X * X + Y * Y], axis=2)
    back = np.linalg.inv(bernstein(4, x))
    P = np.einsum("ia,jb,abk->ijk", back, back, on)
    r = np.linspace(INNER, OUTER, 5)
    control = r[:, None] * (P[..., None, :3] / P[..., None, 3:])
    weights = np.repeat(P[..., 3:], len(r), axis=2)
    patches = [
        vv.SplinePatch(
            degrees=(4, 4, 4),
            knots=[clamped(4)] * 3,
            control=np.roll(control, turn, axis=-1),
            weights=weights,
        )
        for turn in range(3)
    ]
    return vv.SplinePatches(patches=tuple(patch.refined(n) for patch in patches))


def tube(degree: int, n: int) -> vv.SplinePatch:
    """A quarter of a thick tube of this degree and n spans along all directions."""
    arc = np.array([(1.0, 0.0, 1.0), (0.5**0.5, 0.5**0.5, 0.5**0.5), (0.0, 1.0, 1.0)])  # x w, y w, w
    for p in range(3, degree + 1):
        a = np.arange(p + 1)[:, None] / p
        arc = a * np.vstack([arc[:1], arc]) + (1 - a) * np.vstack([arc, arc[-1:]])
    even = np.linspace(0, 1, degree + 1)
    r = INNER + (OUTER - INNER) * even
    control = np.empty((len(r), degree + 1, degree + 1, 3))
    control[..., :2] = (r[:, None, None] * (arc[:, :2] / arc[:, 2:]))[:, :, None]
    control[..., 2] = even
    weights = np.broadcast_to(arc[:, 2][:, None], control.shape[:-1])
    patch = vv.SplinePatch(
        degrees=(degree,) * 3, knots=[clamped(degree)] * 3, control=control, weights=weights
    )
    return patch.refined(n)


def under_pressure(
    solid: vv.SplineSolid, within: list[str], planes: list[tuple[str, int]]
) -> tuple[Array, Array]:
    """Displacements and stresses at the nodes by the pressure, of linear elasticity."""
    parts = [
        *(vv.SymmetryPlane(solid=solid, nodes=side, normal=np.eye(3)[k]) for side, k in planes),
        *(vv.Pressure(solid=solid, faces=side, pressure=1.0, follower=False) for side in within),
    ]
    system = vv.System([solid, *parts])
    vv.quasi_static(system, until=1.0, step=1.0)
    return solid.displacements(system.x), solid.smoothed(["cauchy"], system.x)["cauchy"]


def sphere_errors(n: int) -> tuple[float, float]:
    """Of displacements and of hoop stresses, relative to the largest."""
    solid = vv.SplineSolid(mesh=sphere(n), material=STEEL)
    sides = [(f"{k}.{side}", (k + i) % 3) for k in range(3) for i, side in enumerate(("x0", "y0"))]
    u, stress = under_pressure(solid, [f"{k}.z0" for k in range(3)], sides)
    r = np.linalg.norm(solid.points, axis=1)
    share = INNER**3 / (OUTER**3 - INNER**3)
    exact = share / E * ((1 - 2 * NU) * r + (1 + NU) / 2 * OUTER**3 / r**2)
    hoop = share * (1 + OUTER**3 / (2 * r**3))
    return errors(solid, u, exact[:, None] * solid.points / r[:, None], stress, hoop)


def tube_errors(degree: int, n: int) -> tuple[float, float]:
    solid = vv.SplineSolid(mesh=tube(degree, n), material=STEEL)
    u, stress = under_pressure(solid, ["x0"], [("y0", 1), ("y1", 0), ("z0", 2), ("z1", 2)])
    across = solid.points * [1, 1, 0]
    r = np.linalg.norm(across, axis=1)
    share = INNER**2 / (OUTER**2 - INNER**2)
    exact = (1 + NU) / E * share * ((1 - 2 * NU) * r + OUTER**2 / r)
    hoop = share * (1 + OUTER**2 / r**2)
    return errors(solid, u, exact[:, None] * across / r[:, None], stress, hoop)


def errors(solid: vv.SplineSolid, u: Array, exact: Array, stress: Array, hoop: Array) -> tuple[float, float]:
    i = [[0, 3, 5], [3, 1, 4], [5, 4, 2]]
    largest = np.linalg.eigvalsh(stress[:, i])[:, -1]
    pairs = ((u, exact), (largest, hoop))
    off, stray = (float(np.linalg.norm(found - given) / np.linalg.norm(given)) for found, given in pairs)
    return off, stray


def test_tubes_and_sphere_of_lame() -> None:
    """Displacements and hoop stresses of thick walls under pressure within, by exact rational patches."""
    for found, bounds in (
        (tube_errors(2, 4), (2e-5, 1e-3)),
        (tube_errors(3, 2), (3e-5, 4e-3)),
        (tube_errors(4, 2), (2e-6, 3e-4)),
        (sphere_errors(2), (2e-5, 3e-4)),
    ):
        assert np.all(np.less(found, bounds))
