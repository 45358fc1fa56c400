"""Shells against closed forms, published tables and the linear obstacle course."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from verification.shell_cases import (
    CASES,
    corner,
    hemisphere,
    linear,
    part_of_cylinder,
    pinched_cylinder,
    scordelis_lo,
    sheet,
    symmetric,
)

Array = NDArray[np.float64]


# --- the linear obstacle course: values at these meshes are those known of the four-node element ----------------
@pytest.mark.parametrize(("n", "share"), [(4, 0.9445), (8, 0.9732), (16, 0.9891)])
def test_scordelis_lo(n: int, share: float) -> None:
    """Dvorkin & Bathe (1984)."""
    assert scordelis_lo(n, "quad4") == pytest.approx(share, abs=2e-3)


@pytest.mark.parametrize(("n", "share"), [(8, 0.745), (16, 0.930), (32, 0.989)])
def test_pinched_cylinder(n: int, share: float) -> None:
    """Dvorkin & Bathe (1984)."""
    assert pinched_cylinder(n, "quad4") == pytest.approx(share, abs=2e-3)


@pytest.mark.parametrize(("n", "share"), [(8, 0.993), (16, 0.990)])
def test_hemisphere_with_a_hole(n: int, share: float) -> None:
    """Of 0.0940 (MacNeal & Harder); Simo et al. have 0.093."""
    assert hemisphere(n, "quad4") == pytest.approx(share, abs=2e-3)


COURSE = [
    ("Scordelis-Lo roof", "quad9", 8, 0.012),
    ("Scordelis-Lo roof", "tri6", 16, 0.012),
    ("pinched cylinder", "quad9", 16, 0.01),
    ("pinched cylinder", "tri6", 24, 0.02),
    ("hemisphere with a hole", "quad9", 16, 0.02),
    ("hemisphere with a hole", "tri6", 16, 0.03),
    ("hemisphere with a hole", "tri6", 32, 0.01),
    ("thin twisted beam, in its plane", "tri6", 16, 0.01),
    ("thin twisted beam, across", "tri6", 16, 0.01),
    ("thin twisted beam, in its plane", "tri6", 32, 0.01),
    ("thin twisted beam, across", "tri6", 32, 0.01),
    ("hypar, 1/100", "tri6", 32, 0.01),
    ("hypar, 1/1000", "tri6", 32, 0.025),
    ("hypar, 1/10000", "tri6", 32, 0.05),
    ("twisted beam, in its plane", "quad4", 12, 0.01),
    ("twisted beam, in its plane", "quad9", 12, 0.01),
    ("twisted beam, in its plane", "tri6", 12, 0.01),
    ("twisted beam, across", "quad9", 12, 0.01),
    ("twisted beam, across", "tri6", 12, 0.01),
    ("thin twisted beam, in its plane", "quad4", 24, 0.01),
    ("thin twisted beam, across", "quad4", 24, 0.01),
    ("thin twisted beam, in its plane", "quad9", 24, 0.01),
    ("thin twisted beam, across", "quad9", 24, 0.01),
    ("Raasch's hook", "quad4", 32, 0.02),
    ("Raasch's hook", "quad9", 32, 0.02),
    ("Raasch's hook", "tri6", 32, 0.02),
    ("curved cantilever, in its plane", "quad9", 12, 0.02),
    ("curved cantilever, in its plane", "tri6", 12, 0.02),
    ("hemisphere with a hole", "tri3", 16, 0.02),
    ("thin twisted beam, across", "tri3", 24, 0.01),
    ("Raasch's hook", "tri3", 32, 0.02),
    ("pinched cylinder", "tri3", 32, 0.02),
    ("hypar, 1/100", "quad4", 16, 0.02),
    ("hypar, 1/100", "quad9", 16, 0.02),
    ("hypar, 1/1000", "quad9", 16, 0.02),
    ("hypar, 1/10000", "quad9", 16, 0.02),
    *(("straight cantilever, along", cell, 8, 0.01) for cell in ("quad4", "quad9", "tri3", "tri6")),
    *(("straight cantilever, across", cell, 16, 0.01) for cell in ("quad4", "quad9", "tri6")),
    ("straight cantilever, in its plane", "quad9", 8, 0.01),
    ("straight cantilever, in its plane", "tri6", 16, 0.015),
    *(("straight cantilever, twist", cell, 16, 0.01) for cell in ("quad4", "quad9")),
    ("straight cantilever, twist", "tri6", 16, 0.02),
    *(("Z section, stress", cell, 8, 0.03) for cell in ("quad4", "quad9", "tri6")),
    ("closed hemisphere", "quad4", 16, 0.01),
    ("closed hemisphere", "quad9", 8, 0.01),
]


@pytest.mark.parametrize(("case", "cell", "n", "tolerance"), COURSE, ids=str)
def test_obstacle_course(case: str, cell: str, n: int, tolerance: float) -> None:
    """Within one or two per cent of the published values; `n` counts nodes from node to node."""
    found, options = CASES[case]
    assert found(n, cell, **options) == pytest.approx(1.0, abs=tolerance)


ENHANCED = [
    ("Scordelis-Lo roof", 8, 0.01),
    ("hemisphere with a hole", 8, 0.01),
    ("closed hemisphere", 16, 0.01),
    ("twisted beam, in its plane", 12, 0.01),
    ("twisted beam, across", 12, 0.02),
    ("curved cantilever, in its plane", 8, 0.04),
    ("curved cantilever, in its plane", 16, 0.01),
    ("straight cantilever, in its plane", 8, 0.01),
    ("hypar, 1/100", 16, 0.01),
    ("hypar, 1/1000", 16, 0.02),
    ("hypar, 1/10000", 16, 0.02),
]


@pytest.mark.parametrize(("case", "n", "tolerance"), ENHANCED, ids=str)
def test_obstacle_course_with_enhanced_membrane(case: str, n: int, tolerance: float) -> None:
    """Four-node cells, of which compatible ones reach 0.126 of the curved cantilever in its plane with 8 along."""
    found, options = CASES[case]
    assert found(n, "quad4", membrane="enhanced", **options) == pytest.approx(1.0, abs=tolerance)


def test_curved_cantilever_across() -> None:
    """With two cells across, the usual mesh, 0.96 of MacNeal's: torsion is resolved by more of them."""
    found = [CASES["curved cantilever, across"][0](24, "quad9", axis=2, across=m) for m in (2, 4, 8)]
    assert found[0] == pytest.approx(0.961, abs=2e-3)
    assert found[2] == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize("case", ["Scordelis-Lo roof", "pinched cylinder", "hypar, 1/100", "hypar, 1/1000"])
def test_three_node_triangles_converge(case: str) -> None:
    """From below."""
    found, options = CASES[case]
    error = [1.0 - found(n, "tri3", **options) for n in (8, 16, 32)]
    assert error[0] > 1.3 * error[1] > 1.6 * error[2] > 0


def test_simply_supported_plate() -> None:
    """Kirchhoff's deflection 0.00406235 p L^4 / D under a pressure, for thin plates: no locking down to 1/1000."""
    for thickness in (1e-2, 1e-3):
        shell = vv.Shell(
            mesh=vv.RectangleMesh(size=(0.5, 0.5), counts=(12, 12)), section=sheet(thickness, 1e9, 0.3)
        )
        held = [vv.Fixed(solid=shell, nodes=edge, directions=(False, False, True)) for edge in ("x0", "y0")]
        pressure = 1e-3 * 1e9 * thickness**3
        load = vv.Traction(solid=shell, faces="upper", traction=(0, 0, pressure * 1e-3))
        system = linear(shell, *held, *symmetric(shell, x="x1", y="y1"), load)
        bending = 1e9 * thickness**3 / 12 / (1 - 0.3**2)
        found = shell.displacements(system.x)[corner(shell, "x1", "y1"), 2]
        assert found / (1e-3 * pressure / bending) == pytest.approx(0.00406235, rel=6e-3)


# --- patch tests --------------------------------------------------------------------------------------------
PATCH = vv.Mesh(
    np.pad([(0, 0), (24, 0), (24, 12), (0, 12), (4, 2), (18, 3), (16, 8), (8, 8)], ((0, 0), (0, 1))) / 100,
    {"quad4": [(0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7), (4, 5, 6, 7)]},
)  # fmt: skip
"""Of MacNeal & Harder (1985)."""


def test_membrane_patch() -> None:
    """Distorted cells stretch evenly; moved at the border, the inner nodes follow, and forces are constant."""
    A = 1e-3 * np.array([(1.0, 0.5), (0.5, 1.0)])

    def motion(t: float, X: Array) -> Array:
        return t * np.pad(X[:, :2] @ A.T, ((0, 0), (0, 1)))

    shell = vv.Shell(mesh=PATCH, section=sheet(0.001, 1e6, 0.25), first=(1, 0, 0))
    border = vv.Prescribed(solid=shell, nodes=[0, 1, 2, 3], motion=motion)
    inner = vv.Fixed(solid=shell, nodes=[4, 5, 6, 7], directions=(False, False, True))
    system = linear(shell, border, inner)
    np.testing.assert_allclose(shell.displacements(system.x)[:, :2], shell.points[:, :2] @ A.T, atol=1e-12)
    forces = shell.resultants(system.x)[..., :3].reshape(-1, 3)
    np.testing.assert_allclose(forces, np.broadcast_to(forces[0], forces.shape), rtol=1e-8)
    assert forces[0, 0] == pytest.approx(0.001 * 1333.0, rel=2e-3)  # stress 1333, 1333, 400


def test_bending_patch() -> None:
    """Distorted cells bend to a surface of constant curvatures, with constant moments."""
    curve = 1e-3 * np.array([(1.0, 0.5), (0.5, 1.0)])

    def heights(X: Array) -> Array:
        return 0.5 * np.einsum("ni,ij,nj->n", X[:, :2], curve, X[:, :2])

    shell = vv.Shell(mesh=PATCH, section=sheet(0.001, 1e6, 0.25), first=(1, 0, 0))
    system = vv.System([shell])
    x = system.x.copy()
    first = shell.node_unknowns(np.arange(8))
    x[first + 2] = heights(shell.points)
    slope = shell.points[:, :2] @ curve
    x[first[:, None] + np.array([3, 4])] = -slope
    found = shell.strains(x)
    np.testing.assert_allclose(
        found[..., 3:5], np.broadcast_to([-1e-3, -1e-3], found[..., 3:5].shape), rtol=1e-3
    )
    np.testing.assert_allclose(found[..., 5], -1e-3, rtol=1e-3)
    assert np.abs(found[..., 6:]).max() < 0.03 * np.abs(slope).max()


# --- large rotations ----------------------------------------------------------------------------------------
def test_cantilever_under_end_shear() -> None:
    """Sze, Liu & Lo (2004), 3.1: the elastica. Of second order in the elements' length."""
    error = []
    for n in (8, 16, 32):
        shell = vv.Shell(mesh=vv.RectangleMesh(size=(10, 1), counts=(n, 1)), section=sheet(0.1, 1.2e6))
        load = vv.Traction(solid=shell, faces="x1", traction=(0, 0, 4.0), times="t")
        system = vv.System([shell, vv.Clamped(solid=shell, nodes="x0"), load])
        vv.quasi_static(system, until=1.0, step=0.1)
        u = shell.displacements(system.x)[shell.nodes("x1")].mean(axis=0)
        error.append(float(np.hypot(u[0] + 3.2894, u[2] - 6.6996)))
    assert np.log2(error[0] / error[1]) > 1.7
    assert error[2] < 3e-3


PLY = {"thickness": 1.0, "young": 2068.5, "across": 517.125, "poisson": 0.3, "shear": 795.6}


@pytest.mark.parametrize(
    ("angles", "expected"), [((), 16.1), ((0, 90, 0), 37.92), ((90, 0, 90), 22.722)], ids=str
)
def test_pinched_half_cylinder(angles: tuple[float, ...], expected: float) -> None:
    """Sze, Liu & Lo (2004), 3.7, at a tenth of the load: one material, and laminates. From below, of second order."""
    plies = tuple(vv.Ply(angle=angle, **PLY) for angle in angles)
    section = vv.Laminate(plies=plies) if plies else sheet(3.0, 2068.5, 0.3)
    coarse, fine = (pinched_half(section, n) for n in (12, 24))
    assert coarse < fine < 1.01 * expected
    assert (4 * fine - coarse) / 3 == pytest.approx(expected, rel=0.02)


def pinched_half(section: Any, n: int) -> float:
    """The way of the load, of a symmetric half."""
    shell = vv.Shell(mesh=part_of_cylinder(101.6, 304.8, np.pi / 2, n), section=section, first=(0, 1, 0))
    held = vv.Clamped(solid=shell, nodes="x0")
    sides = [
        vv.SymmetryPlane(solid=shell, nodes=np.setdiff1d(shell.nodes(edge), shell.nodes("x0")), normal=normal)
        for edge, normal in (("y0", (1, 0, 0)), ("y1", (0, 0, 1)))
    ]
    top = corner(shell, "x1", "y0")
    load = vv.Force(on=shell.point(shell.points[top]), force=(0, 0, -100.0), times="t")
    system = vv.System([shell, held, *sides, load])
    vv.quasi_static(system, until=1.0, step=0.5)
    return float(-shell.displacements(system.x)[top, 2])


# --- points ---------------------------------------------------------------------------------------------------
def test_points_anywhere_on_a_shell_and_above_it() -> None:
    """They start where they are asked for, and turn along with the shell."""
    shell = vv.Shell(mesh=part_of_cylinder(1.0, 1.0, 1.2, 4), section=sheet(0.05, 1e4, density=10.0))
    system = vv.System([shell])
    rng = np.random.default_rng(2)
    x = system.x.copy()
    turn = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    turn *= np.linalg.det(turn)
    n = 6 * shell.grid.n_nodes
    x[:n] = (x[:n].reshape(-1, 3) @ turn.T).ravel()
    for k in range(20):
        cell = shell.cells[0][rng.integers(len(shell.cells[0]))]
        share = rng.dirichlet(np.ones(4))
        share = np.outer(
            [share[0] + share[1], share[2] + share[3]], [share[0] + share[3], share[1] + share[2]]
        )
        N = share.ravel()[[0, 1, 3, 2]]
        X = N @ shell.points[cell] + (0.1 * (k % 3)) * (N @ shell.directors(system.x)[cell])
        place = shell.point(X).position
        np.testing.assert_allclose(system.value(place), X, atol=1e-12)
        np.testing.assert_allclose(place.value(x), turn @ X, atol=1e-12)
    with pytest.raises(vv.InputError, match="lies beside it"):
        shell.point((0.0, 2.0, 1.0)).position  # noqa: B018


def test_a_panel_hangs_on_ball_joints_and_a_rope() -> None:
    """Joints and masses at any point of it; energy is conserved."""
    flat = vv.RectangleMesh(size=(1.0, 0.8), counts=(8, 6))
    panel = vv.Shell(mesh=flat, section=sheet(0.02, 1e5, 0.3, density=50.0))
    ground, bob = vv.Ground(), vv.PointMass(mass=0.5, position=(0.9, 0.5, -0.6))
    hinges = [vv.Spherical(a=ground, b=panel, at=(0.0, y, 0.0)) for y in (0.1, 0.63)]
    rope = vv.Distance(a=panel.point((0.9, 0.5, 0.01)), b=bob.point())
    system = vv.System([ground, panel, bob, *hinges, rope, vv.Gravity()])
    result = vv.simulate(system, until=0.5, step=0.005)
    result.assert_conserved("energy", tolerance=1e-10)
    assert system.value(panel.point((1.0, 0.4, 0.0)).position)[2] < -0.3


# --- dynamics -----------------------------------------------------------------------------------------------
def test_free_flight() -> None:
    """Energy, momentum and angular momentum of a curved shell that tumbles and swings, to round-off."""
    mesh = part_of_cylinder(1.0, 1.0, 1.2, 4)
    shell = vv.Shell(
        mesh=mesh,
        section=sheet(0.05, 1e4, 0.3, density=10.0),
        velocity=lambda X: np.stack([0.3 * np.sin(3 * X[:, 1]), 0 * X[:, 0], 0.5 * X[:, 0]], axis=1),
        angular_velocity=(0.5, 1.0, -0.7),
    )
    result = vv.simulate(vv.System([shell]), until=4.0, step=0.01)
    ledger = result.ledger
    assert np.ptp(ledger["potential_stored"]) > 1e-3 * ledger["total"][0]
    for name in ("total", *(f"{kind}_{axis}" for kind in ("momentum", "angular") for axis in "xyz")):
        assert np.ptp(ledger[name]) < 1e-11 * abs(ledger["total"][0]), name


def test_frequencies_of_a_plate() -> None:
    """Simply supported, w = pi^2 (m^2 + n^2) sqrt(D / m) for side 1: the first three, two of them alike."""
    shell = vv.Shell(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(12, 12)), section=sheet(0.005, 1e9, 0.3, density=1e3)
    )
    edges = [
        vv.Fixed(solid=shell, nodes=edge, directions=(True, True, True)) for edge in ("x0", "x1", "y0", "y1")
    ]
    found = 2 * np.pi * vv.modes(vv.System([shell, *edges]), 3).frequencies
    unit = np.pi**2 * np.sqrt(1e9 * 0.005**3 / 12 / (1 - 0.09) / 5.0)
    np.testing.assert_allclose(found / unit, (2, 5, 5), rtol=0.03)
