"""Shells of every type of cells, and mixed ones: patch tests, thin plates, free flight, large rotations."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from verification.shell_cases import bent, corner, linear, part_of_cylinder, sheet, symmetric

Array = NDArray[np.float64]
KINDS = ("quad4", "quad9", "tri3", "tri6")

POINTS = np.array(
    [(0, 0), (0.24, 0), (0.24, 0.12), (0, 0.12), (0.04, 0.02), (0.18, 0.03), (0.16, 0.08), (0.08, 0.08)]
)
QUADS = np.array([(0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7), (4, 5, 6, 7)])
TRIS = np.concatenate([QUADS[:, [0, 1, 2]], QUADS[:, [0, 2, 3]]])
IN_SPACE = np.pad(POINTS, ((0, 0), (0, 1)))
UNEVEN = vv.RectangleMesh(size=(0.24, 0.12), counts=(3, 2)).build()
UNEVEN = vv.Mesh(
    np.pad(UNEVEN.points + 2 * UNEVEN.points * (UNEVEN.points - (0.24, 0.12)), ((0, 0), (0, 1))), UNEVEN.cells
)
PATCHES = {
    "quad4": vv.Mesh(IN_SPACE, {"quad4": QUADS}),
    "quad9": UNEVEN.quadratic("quad9"),
    "tri3": vv.Mesh(IN_SPACE, {"tri3": TRIS}),
    "tri6": vv.Mesh(IN_SPACE, {"tri3": TRIS}).quadratic("tri6"),
    "mixed": vv.Mesh(IN_SPACE, {"quad4": QUADS[:3], "tri3": TRIS[[3, 4, 8, 9]]}),
}
"""The distorted cells of MacNeal & Harder (1985), also in triangles. Nine-node cells are exact as rectangles."""


def node(shell: vv.Shell, x: float, y: float) -> int:
    return int(np.argmin(np.linalg.norm(shell.points[:, :2] - (x, y), axis=1)))


@pytest.mark.parametrize("membrane", ["compatible", "enhanced"])
@pytest.mark.parametrize("kind", PATCHES)
def test_membrane_patch(kind: str, membrane: Any) -> None:
    """Moved evenly at the border, the inner nodes follow, and forces are constant."""
    A = 1e-3 * np.array([(1.0, 0.5), (0.5, 1.0)])
    shell = vv.Shell(mesh=PATCHES[kind], section=sheet(0.001, 1e6, 0.25), first=(1, 0, 0), membrane=membrane)
    border = shell.faces("all").nodes

    def motion(t: float, X: Array) -> Array:
        return t * np.pad(X[:, :2] @ A.T, ((0, 0), (0, 1)))

    inner = vv.Fixed(
        solid=shell, nodes=np.setdiff1d(np.arange(shell.grid.n_nodes), border), directions=(0, 0, 1)
    )
    system = linear(shell, vv.Prescribed(solid=shell, nodes=border, motion=motion), inner)
    np.testing.assert_allclose(shell.displacements(system.x)[:, :2], shell.points[:, :2] @ A.T, atol=1e-11)
    forces = np.concatenate([r.reshape(-1, 8) for r in shell.resultants_of_parts(system.x)])
    np.testing.assert_allclose(forces[:, :3], np.broadcast_to(forces[0, :3], (len(forces), 3)), rtol=1e-7)
    assert forces[0, 0] == pytest.approx(0.001 * 1333.0, rel=2e-3)


@pytest.mark.parametrize("kind", PATCHES)
def test_bending_patch(kind: str) -> None:
    """Moments along two edges bend it with one moment everywhere, w = -M x (x - L) / 2 D (1 - nu^2) along its sides."""
    shell = vv.Shell(mesh=PATCHES[kind], section=sheet(0.001, 1e6, 0.25), first=(1, 0, 0))
    size = 1e-9
    ends = [
        vv.EdgeMoment(
            shell=shell, edges=shell.grid.select_faces(lambda X, at=at: abs(X[:, 0] - at) < 1e-9), moment=m
        )
        for at, m in ((0.0, (0, size, 0)), (0.24, (0, -size, 0)))
    ]
    held = [
        vv.Fixed(solid=shell, nodes=[node(shell, 0, 0)], directions=(True, True, True)),
        vv.Fixed(solid=shell, nodes=[node(shell, 0.24, 0)], directions=(False, True, True)),
        vv.Fixed(solid=shell, nodes=[node(shell, 0, 0.12)], directions=(False, False, True)),
    ]
    system = linear(shell, *ends, *held)
    found = np.concatenate([r.reshape(-1, 8) for r in shell.resultants_of_parts(system.x)])
    scale = np.abs(found[:, 3]).max()
    np.testing.assert_allclose(
        found[:, 3:6], scale * np.sign(found[0, 3]) * np.eye(3)[[0] * len(found)], atol=1e-5 * scale
    )
    assert scale == pytest.approx(size, rel=1e-5)
    assert np.abs(found[:, 6:]).max() < 1e-4 * size / 0.12
    curvature = size / (1e6 * 0.001**3 / 12)
    x, y, _ = shell.points.T
    w = 0.5 * curvature * (x * (x - 0.24) - 0.25 * y * (y - 0.12))
    np.testing.assert_allclose(shell.displacements(system.x)[:, 2], w, atol=2e-3 * np.abs(w).max())


def test_nine_node_cells_are_nearly_right_on_distorted_patches() -> None:
    """Their assumed strains do not balance constant stresses of distorted cells: forces are wrong by some per cent."""
    shell = vv.Shell(
        mesh=vv.Mesh(IN_SPACE, {"quad4": QUADS}).quadratic("quad9"),
        section=sheet(0.001, 1e6),
        first=(1, 0, 0),
    )
    pull = vv.Traction(
        solid=shell, faces=shell.grid.select_faces(lambda X: X[:, 0] > 0.2399), traction=(1e-3, 0, 0)
    )
    held = vv.SymmetryPlane(solid=shell, nodes=np.flatnonzero(shell.points[:, 0] < 1e-9), normal=(1, 0, 0))
    flat = vv.Fixed(solid=shell, nodes="all", directions=(False, False, True))
    system = linear(
        shell, held, flat, vv.Fixed(solid=shell, nodes=[0], directions=(False, True, False)), pull
    )
    forces = shell.resultants(system.x)[..., 0]
    assert 1e-6 < np.abs(forces / 1e-3 - 1).max() < 0.03


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("thickness", [1e-2, 1e-3])
def test_thin_plates(kind: str, thickness: float) -> None:
    """Simply supported under a pressure: Kirchhoff's 0.00406235 p L^4 / D; nothing locks."""
    mesh = bent((0.5, 0.5), (16, 16), lambda x, y: np.stack([x, y, 0 * x], axis=1), kind)
    shell = vv.Shell(mesh=mesh, section=sheet(thickness, 1e9, 0.3))
    held = [vv.Fixed(solid=shell, nodes=edge, directions=(False, False, True)) for edge in ("x0", "y0")]
    bending = 1e9 * thickness**3 / 12 / (1 - 0.3**2)
    load = vv.Traction(solid=shell, faces="upper", traction=(0, 0, 1e-6 * bending))
    system = linear(shell, *held, *symmetric(shell, x="x1", y="y1"), load)
    found = shell.displacements(system.x)[corner(shell, "x1", "y1"), 2]
    assert found / 1e-6 == pytest.approx(0.00406235, rel=0.012)


def test_plate_of_distorted_cells_that_moofekit_has() -> None:
    """Clamped at one side, 50 x 50 of the five distorted cells: 56.9754 of Bathe & Dvorkin's element."""
    mesh = vv.Mesh(IN_SPACE * (50 / 0.24, 50 / 0.12, 1), {"quad4": QUADS})
    shell = vv.Shell(mesh=mesh, section=sheet(1.0, 1e4, 0.3))
    loads = [
        vv.Traction(solid=shell, faces="upper", traction=(0, 0, -1e-8)),
        vv.Force(on=shell.point((50.0, 50.0, 0.0)), force=(0, 0, -50e-6)),
    ]
    system = linear(shell, vv.Clamped(solid=shell, nodes=[0, 3]), *loads)
    assert np.abs(shell.displacements(system.x)[:, 2]).max() * 1e6 == pytest.approx(56.9754, abs=1e-3)


# --- large rotations ----------------------------------------------------------------------------------------
TIP_SHEAR = {0.25: (0.563, 3.015), 0.5: (1.604, 4.933), 1.0: (3.286, 6.698)}
"""Sze, Liu & Lo (2004), 3.1: by P / 4, the way back and up; their last value is not the elastica's 3.2894, 6.6996."""


@pytest.mark.parametrize("kind", ["quad9", "tri6"])
def test_cantilever_under_end_shear(kind: str) -> None:
    """Along the table."""
    shell = vv.Shell(mesh=vv.RectangleMesh(size=(10, 1), counts=(8, 1), cell=kind), section=sheet(0.1, 1.2e6))
    load = vv.Traction(solid=shell, faces="x1", traction=(0, 0, 4.0), times="t")
    system = vv.System([shell, vv.Clamped(solid=shell, nodes="x0"), load])
    for share, (back, up) in TIP_SHEAR.items():
        vv.quasi_static(system, until=share, step=0.125)
        u = shell.displacements(system.x)[shell.nodes("x1")].mean(axis=0)
        assert (-u[0], u[2]) == pytest.approx((back, up), abs=0.012)


@pytest.mark.parametrize(("kind", "n", "tolerance"), [("quad4", 48, 0.06), ("quad9", 12, 0.01)])
def test_roll_up(kind: str, n: int, tolerance: float) -> None:
    """Sze, Liu & Lo (2004), 3.2: a moment of 50 pi / 3 makes a strip a circle; exact values on the way.

    From 0.8 of it on a strip that is free to do so swerves to its side, as the axis of the moment stays in space: the
    circle is followed past that.
    """
    shell = vv.Shell(mesh=vv.RectangleMesh(size=(12, 1), counts=(n, 1), cell=kind), section=sheet(0.1, 1.2e6))
    moment = vv.EdgeMoment(shell=shell, edges="x1", moment=(0, -50 * np.pi / 3, 0), times="t")
    system = vv.System([shell, vv.Clamped(solid=shell, nodes="x0"), moment])
    for share, back, up in (
        (0.25, 4.357, 7.643),
        (0.5, 12.0, 7.639),
        (0.75, 14.546, 2.546),
        (1.0, 12.0, 0.0),
    ):
        vv.quasi_static(system, until=share, step=0.05, scheme=vv.Static(unstable=share > 0.75))
        u = shell.displacements(system.x)[shell.nodes("x1")].mean(axis=0)
        assert (-u[0], u[2]) == pytest.approx((back, up), abs=tolerance)


def test_slit_annular_plate() -> None:
    """Sze, Liu & Lo (2004), 3.3, at a twentieth of the load: 2.455 and 3.370 at the two ends of the lifted edge."""

    def to(a: Array, r: Array) -> Array:
        return np.stack([(6 + r) * np.sin(a), (6 + r) * np.cos(a), 0 * a], axis=1)

    mesh = bent((2 * np.pi, 4.0), (40, 4), to, "quad9")
    shell = vv.Shell(mesh=mesh, section=sheet(0.03, 21e6), slits="open")
    load = vv.Traction(solid=shell, faces="x0", traction=(0, 0, 0.04), times="t")
    system = vv.System([shell, vv.Clamped(solid=shell, nodes="x1"), load])
    vv.quasi_static(system, until=1.0, step=0.5)
    up = shell.displacements(system.x)[[corner(shell, "x0", "y0"), corner(shell, "x0", "y1")], 2]
    assert up == pytest.approx((2.455, 3.370), rel=0.01)


# --- dynamics -----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("kind", ["quad9", "tri3", "tri6"])
def test_free_flight(kind: str) -> None:
    """Energy, momentum and angular momentum of a curved shell that tumbles and swings, to round-off."""
    shell = vv.Shell(
        mesh=part_of_cylinder(1.0, 1.0, 1.2, 4, kind),
        section=sheet(0.05, 1e4, 0.3, density=10.0),
        velocity=lambda X: np.stack([0.3 * np.sin(3 * X[:, 1]), 0 * X[:, 0], 0.5 * X[:, 0]], axis=1),
        angular_velocity=(0.5, 1.0, -0.7),
    )
    ledger: Any = vv.simulate(vv.System([shell]), until=1.0, step=0.01).ledger
    assert np.ptp(ledger["potential_stored"]) > 1e-3 * ledger["total"][0]
    for name in ("total", *(f"{what}_{axis}" for what in ("momentum", "angular") for axis in "xyz")):
        assert np.ptp(ledger[name]) < 1e-11 * abs(ledger["total"][0]), name
