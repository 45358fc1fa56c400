"""Statics of solids against closed forms: thick walls under pressure, bending, torsion, own weight."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from reference import hyperelastic as h

import visviva as vv
from verification.solids import Array, displacement, static

E, NU = 250.0, 0.1
HOOKE = vv.LinearElastic(young=E, poisson=NU)


# --- thick walls under inner pressure -----------------------------------------------------------------------
def wall(shape: str, material: vv.Material, cell: str, n: int, inner: float, outer: float, pressure: float,
         follower: bool, steps: int = 1) -> tuple[vv.Solid, vv.System]:  # fmt: skip
    """A cylinder in plane strain, or a sphere by its meridian over the north; (r, z) are the coordinates."""
    if shape == "cylinder":
        mesh = vv.RectangleMesh(
            size=(outer - inner, (outer - inner) / 2), counts=(n, n // 2), cell=cell, origin=(inner, 0)
        ).build()
        slides = ("y0", "y1")
    else:
        flat = vv.RectangleMesh(size=(1, 1), counts=(n, n), cell=cell).build()
        r, phi = inner + (outer - inner) * flat.points[:, 0], np.pi / 2 * flat.points[:, 1]
        places = np.column_stack([r * np.cos(phi), r * np.sin(phi)])
        places[np.abs(places) < 1e-14] = 0.0
        mesh = vv.Mesh(places, flat.cells, face_sets=flat.face_sets)
        slides = ("y0",)
    solid = vv.Solid(mesh=mesh, material=material, plane="axisymmetric")
    held: list[Any] = [vv.SymmetryPlane(solid=solid, nodes=s, normal=(0, 1, 0)) for s in slides]
    if shape == "sphere":
        held.append(vv.SymmetryPlane(solid=solid, nodes="y1", normal=(1, 0, 0)))
    push = vv.Pressure(solid=solid, faces="x0", pressure=f"{pressure} * t", follower=follower)
    return solid, static([solid, *held, push], step=1 / steps)


def lame(shape: str, r: float) -> tuple[float, float]:
    """Radial displacement and hoop stress for radii 1 and 2 and pressure 1."""
    if shape == "cylinder":
        u = 1 / (E * 3) * (1 + NU) * ((1 - 2 * NU) * r + 4 / r)
        return u, (1 + 4 / r**2) / 3
    return 1 / (E * 7) * ((1 - 2 * NU) * r + (1 + NU) * 4 / r**2), (1 + 4 / r**3) / 7


@pytest.mark.parametrize("shape", ["cylinder", "sphere"])
@pytest.mark.parametrize(
    ("cell", "order"), [("tri3", 2), ("quad4", 2), ("tri6", 3), ("quad8", 3), ("quad9", 3)]
)
def test_lame(shape: str, cell: str, order: int) -> None:
    """Radii 1 and 2, u(1) = 0.00704, u(2) = 0.00528 (cylinder), 0.0029714286, 0.0015428571 (sphere)."""
    error = []
    for n in (4, 8, 16):
        solid, system = wall(shape, HOOKE, cell, n, 1.0, 2.0, 1.0, follower=False)
        X = solid.points
        r = X[:, 0] if shape == "cylinder" else np.linalg.norm(X, axis=1)
        u = np.linalg.norm(solid.displacements(system.x), axis=1)
        error.append(np.sqrt(np.mean((u - [lame(shape, float(at))[0] for at in r]) ** 2)))
    assert np.log2(error[1] / error[2]) > order - 0.2
    assert error[-1] < (1e-5 if order == 2 else 1e-7)
    stress = vv.FieldAt(solid=solid, field="cauchy", at=(1.0, 0.0, 0.0))(system)
    assert stress[2] == pytest.approx(lame(shape, 1.0)[1], rel=0.1 if order == 2 else 5e-3)


@pytest.mark.parametrize("cell", ["hex20", "hex27", "tet10"])
def test_lame_cylinder_in_space(cell: str) -> None:
    """A quarter between symmetry planes, the same numbers."""
    mesh = vv.HollowCylinderMesh(
        inner_radius=1, outer_radius=2, height=0.4, counts=(4, 8, 1), cell=cell, angle=np.pi / 2
    )
    solid = vv.Solid(mesh=mesh, material=HOOKE)
    planes = {"start": (0, 1, 0), "end": (1, 0, 0), "bottom": (0, 0, 1), "top": (0, 0, 1)}
    held = [vv.SymmetryPlane(solid=solid, nodes=name, normal=n) for name, n in planes.items()]
    push = vv.Pressure(solid=solid, faces="inner", pressure=1.0, follower=False)
    system = static([solid, *held, push])
    for r in (1.0, 2.0):
        assert displacement(system, solid, (r, 0, 0))[0] == pytest.approx(lame("cylinder", r)[0], rel=2e-3)


@pytest.mark.parametrize("shape", ["cylinder", "sphere"])
@pytest.mark.parametrize("name", ["neo_hooke", "mooney"])
def test_large_inflation(shape: str, name: str) -> None:
    """Compressible rubber blown up by a third, against the radial equation of equilibrium by collocation."""
    material, W = {
        "neo_hooke": (vv.NeoHooke(lame_lambda=3.0, shear=1.0), h.neo_hooke(3.0, 1.0)),
        "mooney": (
            vv.MooneyRivlin(c10=0.4, c01=0.1, bulk=5.0, isochoric=True, volumetric="simo"),
            h.mooney(0.4, 0.1, 5.0),
        ),
    }[name]
    pressure = {"cylinder": 0.35, "sphere": 0.55}[shape]
    exact = h.inflated(W, 1.0, 2.0, pressure, shape)
    assert exact[0] > 0.25
    solid, system = wall(shape, material, "quad9", 8, 1.0, 2.0, pressure, follower=True, steps=4)
    found = [displacement(system, solid, (r, 0))[0] for r in (1.0, 2.0)]
    np.testing.assert_allclose(found, exact, rtol=2e-5)


def incompressible(shape: str, la: float) -> float:
    """Pressure per shear modulus of an incompressible neo-Hooke wall of radii 1 and 2 at the inner stretch `la`."""
    if shape == "sphere":
        lb = (1 + (la**3 - 1) / 8) ** (1 / 3)
        return 2 * ((1 / lb + 1 / (4 * lb**4)) - (1 / la + 1 / (4 * la**4)))
    lb = np.sqrt(1 + (la**2 - 1) / 4)
    return float(np.log(la / lb) + (1 / lb**2 - 1 / la**2) / 2)


@pytest.mark.parametrize(("shape", "la"), [("cylinder", 1.4), ("sphere", 1.4), ("cylinder", 2.0)])
def test_inflation_in_the_incompressible_limit(shape: str, la: float) -> None:
    """Bulk modulus 1000 shear moduli: from the pressure of the closed form to its stretch, up to 1/1000."""
    rubber = vv.NeoHooke(shear=1.0, bulk=1000.0, isochoric=True)
    solid, system = wall(
        shape, rubber, "quad9", 10, 1.0, 2.0, incompressible(shape, la), follower=True, steps=8
    )
    assert 1 + displacement(system, solid, (1.0, 0))[0] == pytest.approx(la, rel=2e-3)


def test_published_inflation_of_mooneys_cylinder() -> None:
    """Radii 7 and 18.625, C10 = 80, C01 = 20, incompressible: u = 1.1215548, 3.2115017, 7.1818714 at 46, 100, 150."""
    rubber = vv.MooneyRivlin(c10=80.0, c01=20.0, bulk=2e5, isochoric=True)
    for pressure, u in ((46.0, 1.1215548), (100.0, 3.2115017), (150.0, 7.1818714)):
        solid, system = wall("cylinder", rubber, "quad9", 10, 7.0, 18.625, pressure, follower=True, steps=6)
        assert displacement(system, solid, (7.0, 0))[0] == pytest.approx(u, rel=2e-3)


# --- bending ------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("cell", ["tet10", "hex20", "hex27"])
def test_pure_bending_of_the_linear_theory(cell: str) -> None:
    """u = k (x y, -(x^2 + nu (y^2 - z^2))/2, -nu y z): quadratic cells represent it; the moment is E I k.

    The curvature is so small that lever arms are those of the reference.
    """
    k, nu = 1e-6, 0.3
    solid = vv.Solid(
        mesh=vv.BoxMesh(size=(4, 1, 0.8), counts=(3, 2, 1), cell=cell, origin=(0, -0.5, -0.4)),
        material=vv.LinearElastic(young=100.0, poisson=nu),
    )

    def bent(t: float, X: Array) -> Array:
        x, y, z = X.T
        return t * k * np.column_stack([x * y, -(x * x + nu * (y * y - z * z)) / 2, -nu * y * z])

    ends = [vv.Prescribed(solid=solid, nodes=side, motion=bent) for side in ("x0", "x1")]
    system = static([solid, *ends])
    np.testing.assert_allclose(solid.displacements(system.x), bent(1.0, solid.points), atol=1e-14)
    inertia = 0.8 / 12
    torque = vv.SectionTorque(solid=solid, point=(2.1, 0, 0), normal=(1, 0, 0))(system)
    assert torque == pytest.approx([0, 0, -100 * inertia * k], abs=1e-6 * 100 * inertia * k)


RIVLIN = {
    30: (9.063024075, 10.06165983, 0.03479241687),
    60: (4.303167667, 5.297787138, 0.06891545914),
    90: (2.727133324, 3.715299973, 0.1017732688),
    120: (1.947253456, 2.926848871, 0.1328976884),
    150: (1.485750588, 2.455030233, 0.1619727214),
    180: (1.183208929, 2.140813451, 0.1888305862),
}
"""Inner and outer radius and moment of a block 1 x 5 of incompressible neo-Hooke (mu = 1) by its angle in degrees."""


def bent(t: float, X: Array) -> Array:
    """Displacements at the angle pi t: ``r^2 = 2 a X + b`` with ``r1 r2 = a^2``, angle ``Y / a``, from x = r1 on."""
    a = 5 / (np.pi * max(t, 1e-12))
    first = np.sqrt(np.sqrt(a**2 + a**4) - a)
    r, phi = np.sqrt(2 * a * X[:, 0] + first**2), X[:, 1] / a
    along = (
        2 * a * X[:, 0] / (r + first) - 2 * r * np.sin(phi / 2) ** 2
    )  # r cos(phi) - first, for small t too
    return np.column_stack([along, r * np.sin(phi), 0 * r]) - X


def rivlins_block(cell: str, n: int) -> tuple[Array, Array]:
    """Half of the block, its end plane moved: relative errors of moments, thickness and forces, and the last of places.

    Net forces on the end, which vanish, are relative to the moments.
    """
    mesh = vv.RectangleMesh(size=(1, 2.5), counts=(n, 2 * n), cell=cell)
    solid = vv.Solid(mesh=mesh, material=vv.NeoHooke(shear=1.0, poisson=0.5), formulation="mixed")
    middle = vv.SymmetryPlane(solid=solid, nodes="y0", normal=(0, 1, 0))
    end = vv.Prescribed(solid=solid, nodes="y1", motion=bent)
    system = vv.System([solid, middle, end])
    result = vv.quasi_static(system, until=1.0, step=1 / 6)
    errors = []
    for state, (inner, outer, moment) in zip(result.states[1:], RIVLIN.values(), strict=True):
        x, force = solid.positions(state), solid.nodal_forces(state)
        arm = x[solid.nodes("y1")] + [inner, 0, 0]
        found = abs(np.cross(arm, force[solid.nodes("y1")])[:, 2].sum())
        thickness = np.ptp(x[solid.nodes("y0"), 0])
        net = np.abs(force[solid.nodes("y1")].sum(axis=0)).max() / moment
        errors.append([abs(found / moment - 1), abs(thickness / (outer - inner) - 1), net])
    places = solid.displacements(system.x) - bent(1.0, solid.points)
    return np.array(errors), np.abs(places).max()


@pytest.mark.parametrize(("cell", "order", "error"), [("quad9", 3.2, 6e-6), ("tri6", 2.7, 5e-5)])
def test_rivlins_block(cell: str, order: float, error: float) -> None:
    """Bent from 30 to 180 degrees, by which inner fibres lose a quarter of their length; closed form (Rivlin 1949)."""
    (_, coarse), (errors, fine) = rivlins_block(cell, 4), rivlins_block(cell, 8)
    assert np.log2(coarse / fine) > order
    assert errors.max() < error
    assert fine < error


# --- torsion, own weight ------------------------------------------------------------------------------------
def twist(solid: vv.Solid, height: float, rate: float, free: bool) -> list[vv.Prescribed]:
    """Ends that turn about z by `rate` per length; `free` to warp along z."""

    def turned(t: float, X: Array) -> Array:
        angle = t * rate * X[:, 2] if not free else np.full(len(X), t * rate) * X[:, 2]
        c, s = np.cos(angle), np.sin(angle)
        return np.column_stack([c * X[:, 0] - s * X[:, 1], s * X[:, 0] + c * X[:, 1], X[:, 2]]) - X

    directions = (True, True, not free)
    sides = ("z0", "z1") if free else ("bottom", "top")
    return [vv.Prescribed(solid=solid, nodes=side, motion=turned, directions=directions) for side in sides]


def test_saint_venants_torsion_of_a_square_bar() -> None:
    """T = 0.1405770 G a^4 per twist, the greatest shear stress 0.6753 G a: ends turn and are free to warp."""
    rate, G = 1e-5, 10.0
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(8, 8, 1), cell="hex20", origin=(-0.5, -0.5, 0))
    solid = vv.Solid(mesh=mesh, material=vv.LinearElastic(shear=G, poisson=0.3))
    corner = int(np.argmin(np.linalg.norm(solid.points - (-0.5, -0.5, 0), axis=1)))
    hold = vv.Fixed(solid=solid, nodes=[corner], directions=(False, False, True))
    system = static([solid, *twist(solid, 1.0, rate, free=True), hold])
    torque = vv.SupportTorque(solid=solid, nodes="z1")(system)
    assert torque[2] == pytest.approx(0.1405770 * G * rate, rel=1e-4)
    shear = vv.FieldAt(solid=solid, field="cauchy", at=(0.5, 0, 0.5))(system)
    assert shear[4] == pytest.approx(0.6753 * G * rate, rel=1e-2)


def test_large_torsion_of_an_incompressible_cylinder() -> None:
    """Mooney-Rivlin, radius 1, twist 0.5 per length between ends that keep their distance.

    T = pi psi (C1 + C2), N = -pi psi^2 (C1 + 2 C2) / 2 (Rivlin 1949). A bulk modulus of 100 lets a bar between
    bonded ends change its axial force by some hundredths.
    """
    psi, c1, c2 = 0.5, 0.4, 0.1
    mesh = vv.CylinderMesh(radius=1, height=1, counts=(2, 2, 1), cell="hex27")
    rubber = vv.MooneyRivlin(c10=c1, c01=c2, bulk=100.0, isochoric=True)
    solid = vv.Solid(mesh=mesh, material=rubber)
    system = static([solid, *twist(solid, 1.0, psi, free=False)], step=0.25)
    torque = vv.SupportTorque(solid=solid, nodes="top")(system)[2]
    force = vv.SupportForce(solid=solid, nodes="top")(system)[2]
    assert torque == pytest.approx(np.pi * psi * (c1 + c2), rel=2e-3)
    assert force == pytest.approx(-np.pi * psi**2 * (c1 + 2 * c2) / 2, rel=3e-2)


@pytest.mark.parametrize("cell", ["hex8", "tet10", "hex20", "wedge6"])
def test_bar_hangs_under_its_weight(cell: str) -> None:
    """nu = 0: u(z) = -rho g (L z - z^2 / 2) / E at the nodes of any mesh along z, the support carries rho g V."""
    mesh = vv.BoxMesh(size=(1, 1, 4), counts=(1, 1, 4), cell=cell)
    solid = vv.Solid(mesh=mesh, material=vv.LinearElastic(young=100.0, poisson=0.0), density=2.0)
    system = static([solid, vv.Fixed(solid=solid, nodes="z0"), vv.Gravity(acceleration=(0, 0, -1.5))])
    z = solid.points[:, 2]
    exact = -3.0 * (4 * z - z**2 / 2) / 100
    u = solid.displacements(system.x)[:, 2]
    ends = np.isin(z, range(5)) if cell in ("hex8", "hex20") else np.zeros(0, dtype=int)
    np.testing.assert_allclose(u[ends], exact[ends], atol=1e-12)
    assert np.abs(u - exact).max() < 0.01 * np.abs(exact).max()
    assert vv.SupportForce(solid=solid)(system) == pytest.approx([0, 0, 12.0], abs=1e-11)
