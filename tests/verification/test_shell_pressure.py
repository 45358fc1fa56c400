"""Pressures and tractions on the sides of shells and on their middle, against closed forms."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import pytest

import visviva as vv

RADIUS, LENGTH, THICK, YOUNG, POISSON = 1.0, 0.3, 0.1, 1e6, 0.3
Side = Literal["upper", "lower"]


def quarter(counts: tuple[int, int], *, cell: Any = "quad9") -> vv.Mesh:
    """Of a tube around y, whose directors point outwards; sets x0, z0 where it is cut, y0, y1 at its ends."""
    flat = vv.RectangleMesh(size=(LENGTH, np.pi / 2), counts=counts, cell=cell).build()
    y, a = flat.points.T
    points = np.stack([RADIUS * np.sin(a), -y, RADIUS * np.cos(a)], axis=1)
    names = {"x0": "y1", "x1": "y0", "y0": "x0", "y1": "z0"}
    of = {names[name]: faces for name, faces in flat.face_sets.items()}
    sets = {names[name]: nodes for name, nodes in flat.node_sets.items() if name in names}
    return vv.Mesh(points, flat.cells, face_sets=of, node_sets=sets)


def tube(counts: tuple[int, int] = (1, 8), thickness: float = THICK) -> vv.Shell:
    section = vv.HomogeneousSection(thickness=thickness, young=YOUNG, poisson=POISSON)
    return vv.Shell(mesh=quarter(counts), section=section)


def cut(shell: vv.Shell, *edges: str) -> list[vv.SymmetryPlane]:
    normals = {"x0": (1, 0, 0), "y0": (0, 1, 0), "y1": (0, 1, 0), "z0": (0, 0, 1)}
    return [vv.SymmetryPlane(solid=shell, nodes=edge, normal=normals[edge]) for edge in edges]


def effective(side: Side, middle: bool) -> float:
    """Radius at which the pressure acts."""
    return RADIUS if middle else RADIUS + (0.5 if side == "upper" else -0.5) * THICK


@pytest.mark.parametrize("follower", [True, False])
@pytest.mark.parametrize(("side", "middle"), [("upper", False), ("lower", False), ("lower", True)])
def test_hoop_force_of_a_tube(side: Side, middle: bool, follower: bool) -> None:
    """N = p r at the radius r of the side: of what pushes inside and pulls the tube apart, or pushes from outside."""
    shell, p = tube(), 1e-3
    load = vv.Pressure(solid=shell, faces=side, pressure=f"{p}*t", follower=follower, middle=middle)
    system = vv.System([shell, *cut(shell, "x0", "y0", "z0"), load])
    vv.quasi_static(system, until=1.0, step=1.0)
    hoop = shell.resultants(system.x)[..., 1].mean()
    sign = -1.0 if side == "upper" else 1.0
    assert hoop == pytest.approx(sign * p * effective(side, middle), rel=2e-3)


SLOW = 1e-3
"""A rate of the load at which its stiffness is rounding beside that of the tube."""


@pytest.mark.parametrize("rate", [1.0, SLOW])
@pytest.mark.parametrize(("side", "middle"), [("upper", False), ("lower", False), ("lower", True)])
def test_critical_pressure_of_a_long_tube_is_the_same_on_all_sides(
    side: Side, middle: bool, rate: float
) -> None:
    """3 D / R^3: curves beside a middle of constant length enclose its area and a constant; p r would differ by 1 %."""
    thick = 0.02
    shell = tube((1, 16), thick)
    sign = -1 if side == "lower" else 1
    load = vv.Pressure(solid=shell, faces=side, pressure=f"{rate * sign}*t", middle=middle)
    found = vv.buckling(vv.System([shell, *cut(shell, "x0", "y0", "y1", "z0"), load]), 1).factors[0]
    exact = 3 * YOUNG * thick**3 / (12 * (1 - POISSON**2)) / RADIUS**3
    assert rate * found == pytest.approx(exact, rel=2e-3)


@pytest.mark.parametrize("middle", [True, False])
def test_pressure_has_no_potential_where_edges_are_free(middle: bool) -> None:
    """Of a ring whose edges may move along its axis."""
    ring = tube((1, 4))
    load = vv.Pressure(solid=ring, faces="upper", pressure="t", middle=middle)
    with pytest.raises(vv.InputError, match="not symmetric"):
        vv.buckling(vv.System([ring, *cut(ring, "x0", "y0", "z0"), load]), 1)


@pytest.mark.parametrize("poisson", [0.0, 0.45])
def test_a_block_between_pressures_gets_thinner(poisson: float) -> None:
    """-p / E across and nu p / E along, of directors that stretch."""
    solid = vv.SaintVenantKirchhoff(young=YOUNG, poisson=poisson)
    block = vv.ExtensibleShell(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(2, 2)),
        section=vv.SolidSection(material=solid, thickness=0.2),
    )
    push = [vv.Pressure(solid=block, faces=side, pressure="10*t") for side in ("upper", "lower")]
    held = [
        vv.SymmetryPlane(solid=block, nodes=f"{n}0", normal=d)
        for n, d in (("x", (1, 0, 0)), ("y", (0, 1, 0)))
    ]
    floor = vv.Fixed(solid=block, nodes="all", directions=(False, False, True))
    system = vv.System([block, *held, floor, *push])
    vv.quasi_static(system, until=1.0, step=1.0)
    strain = 10 / YOUNG
    across = block.directors(system.x)[:, 2] - 1
    np.testing.assert_allclose(across, -strain, rtol=1e-4)
    np.testing.assert_allclose(
        block.displacements(system.x)[block.nodes("x1"), 0], poisson * strain, atol=1e-4 * strain
    )


def test_tractions_along_both_sides_are_a_moment() -> None:
    """Against each other along the sides of a strip they bend it by the moment T t (L - x); the shear force is zero."""
    length, T = 2.0, 1e-4
    section = vv.HomogeneousSection(thickness=THICK, young=YOUNG)
    strip = vv.Shell(mesh=vv.RectangleMesh(size=(length, 0.2), counts=(8, 1), cell="quad9"), section=section)
    pull = [
        vv.Traction(solid=strip, faces=side, traction=(sign * T, 0, 0), times="t")
        for side, sign in (("upper", 1.0), ("lower", -1.0))
    ]
    system = vv.System([strip, vv.Clamped(solid=strip, nodes="x0"), *pull])
    vv.quasi_static(system, until=1.0, step=1.0)
    tip = -T * THICK * length**3 / 3 / (YOUNG * THICK**3 / 12)
    np.testing.assert_allclose(strip.displacements(system.x)[strip.nodes("x1"), 2], tip, rtol=1e-3)


def test_middle_is_for_sides_of_shells() -> None:
    block = vv.Solid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)),
        material=vv.NeoHooke(young=1.0, poisson=0.3),
        density=1.0,
    )
    for part, faces in ((block, "z1"), (tube(), "y0")):
        with pytest.raises(vv.InputError, match="middle=True is for the sides of shells"):
            vv.Pressure(solid=part, faces=faces, pressure=1.0, middle=True)
