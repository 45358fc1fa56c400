"""Benchmarks of NAFEMS (The standard NAFEMS benchmarks, 1990; Selected benchmarks for natural frequency analysis)."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import pytest
import scipy.linalg

import visviva as vv
from verification.solids import static

STEEL = {"young": 210e3, "poisson": 0.3}


def elliptic(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """From the inner ellipse, 2 x 1, to the outer one, 3.25 x 2.75, along the angle v pi / 2."""
    angle = v * np.pi / 2
    return (2 + 1.25 * u) * np.cos(angle), (1 + 1.75 * u) * np.sin(angle)


def test_le1_elliptic_membrane() -> None:
    """LE1: quarter of the plate in plane stress, 10 MPa outward on its edge: 92.7 MPa at (2, 0); p-elements 92.6582."""
    errors = []
    for n in (8, 16, 32):
        unit = vv.RectangleMesh(size=(1, 1), counts=(n, n), cell="quad8").build()
        x, y = elliptic(unit.points[:, 0], unit.points[:, 1])
        places = np.column_stack([x, y])
        places[np.abs(places) < 1e-12] = 0.0
        mesh = vv.Mesh(places, unit.cells, face_sets=unit.face_sets)
        solid = vv.Solid(mesh=mesh, material=vv.LinearElastic(**STEEL), plane="stress", thickness=0.1)
        system = static(
            [
                solid,
                vv.SymmetryPlane(solid=solid, nodes="y0", normal=(0, 1, 0)),
                vv.SymmetryPlane(solid=solid, nodes="y1", normal=(1, 0, 0)),
                vv.Pressure(solid=solid, faces="x1", pressure=-10.0, follower=False),
            ]
        )
        stress = vv.FieldAt(solid=solid, field="cauchy", at=(2.0, 0.0, 0.0))(system)
        errors.append(abs(stress[1] / 92.6582 - 1))
    assert errors[-1] < 1e-3


def test_fv32_tapered_membrane() -> None:
    """FV32: 44.623 130.03 162.70 246.05 379.90 391.44 Hz; p-elements give the figures below."""
    corners = ((0.0, -2.5), (10.0, -0.5), (10.0, 0.5), (0.0, 2.5))
    exact = [44.61702, 130.00946, 162.68874, 245.98583, 379.7171, 391.40418]
    mesh = vv.QuadrilateralMesh(corners=corners, counts=(24, 12), cell="quad9")
    solid = vv.Solid(
        mesh=mesh,
        material=vv.LinearElastic(young=200e9, poisson=0.3),
        density=8000.0,
        plane="stress",
        thickness=0.05,
    )
    found = vv.modes(vv.System([solid, vv.Fixed(solid=solid, nodes="x0")]), n=6).frequencies
    assert found == pytest.approx(exact, rel=1e-4)


def thick_plate() -> tuple[vv.Solid, vv.System]:
    """LE10: quarter of an elliptic plate with a hole, 0.6 thick, 1 MPa on top; the middle of its edge is held in z."""
    box = vv.BoxMesh(size=(1, 1, 1), counts=(10, 12, 4), cell="hex20").build()
    x, y = elliptic(box.points[:, 0] ** 1.5, box.points[:, 1])
    places = np.column_stack([x, y, 0.6 * box.points[:, 2] - 0.3])
    places[np.abs(places) < 1e-12] = 0.0
    mesh = vv.Mesh(places, box.cells, face_sets=box.face_sets)
    solid = vv.Solid(mesh=mesh, material=vv.LinearElastic(**STEEL))
    rim = solid.nodes("x1")
    middle = rim[np.abs(solid.points[rim, 2]) < 1e-9]
    system = static(
        [
            solid,
            vv.SymmetryPlane(solid=solid, nodes=np.setdiff1d(solid.nodes("y0"), rim), normal=(0, 1, 0)),
            vv.SymmetryPlane(solid=solid, nodes=np.setdiff1d(solid.nodes("y1"), rim), normal=(1, 0, 0)),
            vv.Fixed(solid=solid, nodes=np.setdiff1d(rim, middle), directions=(True, True, False)),
            vv.Fixed(solid=solid, nodes=middle),
            vv.Traction(solid=solid, faces="z1", traction=(0, 0, -1.0)),
        ]
    )
    return solid, system


def test_le10_thick_plate() -> None:
    """Stress 22 at (2, 0, 0.3): -5.38 MPa; p-elements give -5.35 +- 0.03."""
    solid, system = thick_plate()
    stress = vv.FieldAt(solid=solid, field="cauchy", at=(2.0, 0.0, 0.3))(system)
    assert stress[1] == pytest.approx(-5.38, abs=0.04)
    assert stress[2] == pytest.approx(-1.0, abs=0.02)


def meridian(v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Places (n, 2) on the inner and outer side of LE11's profile: sphere and cylinder, a taper outside."""
    k = np.minimum((4 * v).astype(int), 3)
    t = 4 * v - k
    high = np.sqrt(0.5) + (1.79 - np.sqrt(0.5)) * (k - 2 + t) / 2
    angle = np.pi / 8 * (k + t)
    inner = np.where(
        (k < 2)[:, None],
        np.column_stack([np.cos(angle), np.sin(angle)]),
        np.column_stack([np.full_like(v, np.sqrt(0.5)), high]),
    )
    ends = np.array([(1.4 * np.sqrt(0.75), 0.7), (0.0, 0.0), (1.0, 1.39), (1.0, 1.79)])
    ends[1] = (ends[0] + ends[2]) / 2
    angle = np.pi / 6 * t
    arc = 1.4 * np.column_stack([np.cos(angle), np.sin(angle)])
    first, last = ends[np.maximum(k - 1, 0)], ends[k]
    return inner, np.where((k == 0)[:, None], arc, first + t[:, None] * (last - first))


@pytest.mark.parametrize("cell", ["quad8", "quad9"])
def test_le11_solid_cylinder_taper_sphere(cell: Literal["quad8", "quad9"]) -> None:
    """LE11: heated by r + z, ends held along the axis: sigma_zz = -105 MPa at the inner side of the lower end.

    Both elements converge towards -105.66, 0.6 % beyond the target.
    """
    found = []
    for n in (2, 4, 8):
        unit = vv.RectangleMesh(size=(1, 1), counts=(2 * n, 8 * n), cell=cell).build()
        inner, outer = meridian(unit.points[:, 1])
        places = inner + unit.points[:, :1] * (outer - inner)
        mesh = vv.Mesh(places, unit.cells, face_sets=unit.face_sets)
        solid = vv.Solid(
            mesh=mesh,
            material=vv.LinearElastic(**STEEL),
            plane="axisymmetric",
            thermal_strain=lambda X: 2.3e-4 * (X[:, 0] + X[:, 1]),
        )
        ends = [vv.SymmetryPlane(solid=solid, nodes=side, normal=(0, 1, 0)) for side in ("y0", "y1")]
        stress = vv.FieldAt(solid=solid, field="cauchy", at=(1.0, 0.0, 0.0))(static([solid, *ends]))
        found.append(stress[1])
    assert found[-1] == pytest.approx(-105.0, rel=0.01)
    assert found[-1] == pytest.approx(-105.66, rel=0.004)
    assert abs(found[2] - found[1]) < 0.45 * abs(found[1] - found[0])


def test_le11_in_space_with_its_field_computed() -> None:
    """The same as a quarter in space whose field of temperature is that of its surface and of what arises inside.

    Sources of -k / r keep it at r + z. Stress is that of finite strains, a thousandth off.
    """
    unit = vv.BoxMesh(size=(1, 1, 1), counts=(5, 20, 2), cell="hex20").build()
    across, along, around = unit.points.T
    inner, outer = meridian(along)
    r, z = (inner + across[:, None] * (outer - inner)).T
    angle = 0.5 * np.pi * (1 - around)
    mesh = vv.Mesh(
        np.column_stack([r * np.cos(angle), r * np.sin(angle), z]), unit.cells, face_sets=unit.face_sets
    )
    solid = vv.ThermoelasticSolid(
        mesh=mesh,
        material=vv.SaintVenantKirchhoff(**STEEL),
        heat=vv.Heat(conductivity=1.0, capacity=1e4, expansion=2.3e-4, reference=300.0),
    )

    def radius(X: np.ndarray) -> np.ndarray:
        return np.asarray(np.hypot(X[:, 0], X[:, 1]))

    surface = np.unique(np.concatenate([solid.nodes(side) for side in ("x0", "x1", "y0", "y1")]))
    system = vv.System([
        solid,
        vv.PrescribedTemperature(body=solid, nodes=surface, value=lambda t, X: 300 + radius(X) + X[:, 2]),
        vv.HeatSource(body=solid, power=lambda t, X: -1 / radius(X)),
        *(vv.SymmetryPlane(solid=solid, nodes=side, normal=n) for side, n in
          (("y0", (0, 0, 1)), ("y1", (0, 0, 1)), ("z0", (1, 0, 0)), ("z1", (0, 1, 0)))),
    ])  # fmt: skip
    vv.quasi_static(system, until=1.0, step=1.0)
    off = solid.temperatures(system.x) - (300 + radius(solid.points) + solid.points[:, 2])
    assert np.abs(off).max() < 1e-3
    stress = vv.FieldAt(solid=solid, field="cauchy", at=(1.0, 0.0, 0.0))(system)
    assert stress[2] == pytest.approx(-105.0, rel=0.01)


THIN = 0.05


def plate_frequency(square: float) -> float:
    """Frequency of a mode of the plate 10 x 10 x 0.05 by its number omega a^2 sqrt(rho h / D)."""
    stiffness, mass = 200e9 * THIN**3 / (12 * (1 - 0.3**2)), 8000.0 * THIN
    return float(square / 100 * np.sqrt(stiffness / mass) / (2 * np.pi))


def free_plate(n: int) -> vv.System:
    """FV12: n x n bricks of second order."""
    mesh = vv.BoxMesh(size=(10, 10, THIN), counts=(n, n, 1), cell="hex20")
    return vv.System(
        [vv.Solid(mesh=mesh, material=vv.LinearElastic(young=200e9, poisson=0.3), density=8000.0)]
    )


def test_fv12_free_square_plate() -> None:
    """FV12: six rigid motions, then 1.622 2.360 2.922 4.190 4.190 7.356 7.356 7.668 Hz.

    Bricks so thin approach them from above: the pair is 3.8, 1.6, 0.84, 0.31 % too high on 8, 12, 16, 24 bricks a
    side, the others at most 1.8, 0.53, 0.28, 0.11 %.
    """
    published = np.array([1.622, 2.360, 2.922, 4.190, 4.190, 7.356, 7.356, 7.668])
    coarse, fine = (vv.modes(free_plate(n), n=14).frequencies for n in (8, 16))
    assert np.abs(fine[:6]).max() < 1e-2
    errors = fine[6:] / published - 1
    assert errors.min() > 0
    assert errors.max() < 0.009
    assert errors[5:7] == pytest.approx((coarse[11:13] / published[5:7] - 1) / 2**2.2, rel=0.05)


def test_t13_simply_supported_thin_plate() -> None:
    """Test 13: 2.377 5.961 5.961 9.483 12.133 12.133 15.468 15.468 Hz; exact are the numbers pi^2 (m^2 + n^2).

    The published figures above the first are those of the mesh of the benchmark, up to 2.1 % off the exact ones.
    """
    published = [2.377, 5.961, 5.961, 9.483, 12.133, 12.133, 15.468, 15.468]
    pairs = [(1, 1), (1, 2), (2, 1), (2, 2), (1, 3), (3, 1), (2, 3), (3, 2)]
    exactly = [plate_frequency(np.pi**2 * (m * m + n * n)) for m, n in pairs]
    assert exactly[0] == pytest.approx(published[0], abs=1e-3)
    errors = []
    for n in (8, 12):
        system = simply_supported_plate("hex20", (n, n, 1), hard=True, thickness=THIN)
        found = vv.modes(system, n=8).frequencies
        errors.append(found / exactly - 1)
    assert errors[1].min() > 0
    assert errors[1].max() < 0.026
    assert errors[0].max() / errors[1].max() > 2.5
    assert found == pytest.approx(published, rel=0.022)


def simply_supported_plate(
    cell: str, counts: tuple[int, int, int], hard: bool = False, thickness: float = 1.0
) -> vv.System:
    """FV52: 10 x 10 x 1, E = 200e9, rho = 8000; edges of the lower face held in z.

    `hard`: instead the sides cannot move along themselves, as those of the plates of theory.
    """
    mesh = vv.BoxMesh(size=(10, 10, thickness), counts=counts, cell=cell).build()
    X = mesh.points
    solid = vv.Solid(mesh=mesh, material=vv.LinearElastic(young=200e9, poisson=0.3), density=8000.0)
    side = np.abs(X[:, :2] - 5) > 5 - 1e-9
    if not hard:
        line = np.flatnonzero(side.any(axis=1) & (X[:, 2] < 1e-9))
        return vv.System([solid, vv.Fixed(solid=solid, nodes=line, directions=(False, False, True))])
    corner = side.all(axis=1)
    held = [
        (side[:, 0] & ~corner, (False, True, True)),
        (side[:, 1] & ~corner, (True, False, True)),
        (corner, (True, True, True)),
    ]
    supports = [vv.Fixed(solid=solid, nodes=np.flatnonzero(s), directions=d) for s, d in held]
    return vv.System([solid, *supports])


def mindlin(m: int, n: int) -> float:
    """Frequency of a mode of the simply supported plate by Mindlin's theory with his shear factor pi^2 / 12."""
    E, nu, rho, h, a = 200e9, 0.3, 8000.0, 1.0, 10.0
    shear, D = np.pi**2 / 12 * E / (2 * (1 + nu)) * h, E * h**3 / (12 * (1 - nu**2))
    mass, turn, k = rho * h, rho * h**3 / 12, (m**2 + n**2) * np.pi**2 / a**2
    roots = np.roots([mass * turn / shear, -(mass + (turn + D * mass / shear) * k), D * k**2])
    return float(np.sqrt(roots.min()) / (2 * np.pi))


def exact(m: int, n: int, degree: int = 7) -> float:
    """The same by three-dimensional elasticity: sines along the plate, polynomials across it."""
    E, nu, rho, h, a = 200e9, 0.3, 8000.0, 1.0, 10.0
    mu, lam = E / (2 * (1 + nu)), E * nu / ((1 + nu) * (1 - 2 * nu))
    p, q, k = m * np.pi / a, n * np.pi / a, degree + 1
    z, w = np.polynomial.legendre.leggauss(2 * k)
    P = np.polynomial.legendre.legvander(z, degree)
    dP = np.column_stack(
        [np.polynomial.legendre.legval(z, np.polynomial.legendre.legder(row)) for row in np.eye(k)]
    ) * (2 / h)
    u, v, f = (np.kron(row, P) for row in np.eye(3))
    du, dv, df = (np.kron(row, dP) for row in np.eye(3))
    strains = [(2 * mu, p * u), (2 * mu, q * v), (2 * mu, df), (lam, df - p * u - q * v)]
    strains += [(mu, q * u + p * v), (mu, dv + q * f), (mu, du + p * f)]
    K = sum(c * e.T @ (w[:, None] * e) for c, e in strains)
    M = sum(rho * e.T @ (w[:, None] * e) for e in (u, v, f))
    return float(np.sqrt(scipy.linalg.eigh(K, M, eigvals_only=True)[0]) / (2 * np.pi))


def test_fv52_solid_plate() -> None:
    """Three free motions in the plane, then 45.897, 109.44 twice, 167.89, 193.59 and 206.19 twice.

    The targets of bending are Mindlin's plate with hard supports, in which the edges cannot move along themselves.
    Edges held along their lower line in z alone, as the benchmark says for solids, can: the first mode is softer by
    2.4 % on this mesh, and by about 5 % on fine ones.
    """
    assert [mindlin(*k) for k in ((1, 1), (1, 2), (2, 2))] == pytest.approx(
        [45.897, 109.44, 167.89], rel=5e-5
    )
    found = vv.modes(simply_supported_plate("hex20", (4, 4, 1)), n=10).frequencies
    assert np.abs(found[:3]).max() < 1e-2
    assert found[3:] == pytest.approx([45.897, 109.44, 109.44, 167.89, 193.59, 206.19, 206.19], rel=0.025)


def test_thick_plate_by_elasticity() -> None:
    """FV52 with hard supports against the solution of three-dimensional elasticity, 0.2 % above Mindlin's."""
    expected = [exact(*k) for k in ((1, 1), (1, 2), (2, 1))]
    assert exact(1, 1, degree=5) == pytest.approx(exact(1, 1), rel=1e-6)
    errors = []
    for n in (4, 8):
        found = vv.modes(simply_supported_plate("hex20", (n, n, 2), hard=True), n=3).frequencies
        errors.append(np.abs(found / expected - 1).max())
    assert errors[1] < 0.003
    assert errors[0] / errors[1] > 8
    assert expected[0] / mindlin(1, 1) == pytest.approx(1.0017, abs=1e-4)


def ring(counts: tuple[int, int], inner: Any, outer: Any, grading: float) -> vv.Mesh:
    """A quarter between two curves of s from 0 to 2, finer at the inner one; its sides are x0, x1, y0, y1."""
    unit = vv.RectangleMesh(size=(1, 1), counts=counts, cell="quad8").build()
    u, s = np.expm1(grading * unit.points[:, :1]) / np.expm1(grading), 2 * unit.points[:, 1]
    places = (1 - u) * np.column_stack(inner(s)) + u * np.column_stack(outer(s))
    places[np.abs(places) < 1e-12] = 0.0
    return vv.Mesh(places, unit.cells, face_sets=unit.face_sets)


def square(half: float, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return half * np.minimum(1, 2 - s), half * np.minimum(1, s)


def circle(s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return np.cos(s * np.pi / 4), np.sin(s * np.pi / 4)


def hot_spot(half: float, n: int = 4) -> float:
    """Stress beside a spot of radius 1 in the middle of a square plate that would expand by 1e-3 if it was free."""
    core = vv.RectangleMesh(size=(0.5, 0.5), counts=(n, n), cell="quad8").build()
    spot = vv.Mesh(core.points, core.cells).merged(
        ring((n, 2 * n), lambda s: square(0.5, s), circle, 0.1), weld=1e-6
    )
    spot = spot.with_faces("rim", lambda X: np.hypot(X[:, 0], X[:, 1]) > 1 - 1e-6)
    plate = ring((4 * n, 2 * n), circle, lambda s: square(half, s), 1.5 * np.log(half))
    steel = vv.LinearElastic(young=100e3, poisson=0.3)
    hot = vv.Solid(mesh=spot, material=steel, plane="stress", thickness=1.0, thermal_strain=1e-3)
    cold = vv.Solid(mesh=plate, material=steel, plane="stress", thickness=1.0)
    supports = [
        vv.SymmetryPlane(
            solid=solid, nodes=np.flatnonzero(solid.mesh.points[:, k] < 1e-9), normal=np.eye(3)[k]
        )
        for solid in (hot, cold)
        for k in range(2)
    ]
    tie = vv.Tie(first=cold, first_faces="x0", second=hot, second_faces="rim")
    system = static([hot, cold, tie, *supports])
    return float(vv.FieldAt(solid=cold, field="cauchy", at=(1.0, 0.0, 0.0))(system)[1])


def test_t1_membrane_with_a_hot_spot() -> None:
    """T1: a hot spot in a square plate ten times as wide: 50 MPa beside it; E strain / 2 in one that is wider still."""
    assert hot_spot(10.0) == pytest.approx(50.0, rel=0.01)
    assert hot_spot(100.0, n=8) == pytest.approx(50.0, rel=0.001)
