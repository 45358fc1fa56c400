"""Contact against analytic solutions: patches, Hertz, a bar and a rigid block that bounce."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from contact_parts import stacked
from numpy.typing import NDArray

import visviva as vv
from visviva.component.component import Component

Array = NDArray[np.float64]

KINDS: dict[str, dict[str, Any]] = {
    "dissipative": {},
    "conserving": {"impact": "conserving"},
    "penalty": {"enforcement": "penalty", "stiffness": 9e5},
}


# --- patch test ---------------------------------------------------------------------------------------------
LINEAR = [(2, "quad4"), (2, "tri3"), (3, "hex8"), (3, "tet4")]
QUADRATIC = [(2, "quad8"), (2, "tri6"), (3, "hex20"), (3, "hex27"), (3, "tet10")]


CONDENSED = {"multipliers": "dual", "condensed": True}


@pytest.mark.parametrize("options", [{}, CONDENSED], ids=["standard", "condensed"])
@pytest.mark.parametrize(("dimension", "cell"), LINEAR + QUADRATIC)
def test_patch(dimension: int, cell: str, options: dict[str, Any]) -> None:
    """Uniform stress and the displacement of the bar or of plane strain, to round-off, in one load step."""
    a, b, contact, parts = stacked(dimension, cell, **options)
    system = vv.System(parts)
    vv.quasi_static(system, until=1.0, step=1.0)
    axis = dimension - 1
    for solid in (a, b):
        stress = solid.at_points("cauchy", system.x)
        assert np.abs(stress[:, axis] + 10).max() < 1e-9
        assert np.abs(np.delete(stress, [axis, 2], axis=1)).max() < 1e-9
    top = a.nodes("xyz"[axis] + "1")
    exact = -0.02 if dimension == 3 else -0.0182
    assert np.abs(a.displacements(system.x)[top, axis] - exact).max() < 1e-11
    force = vv.ContactForce(contact=contact)(system)
    assert force[axis] == pytest.approx(10.0, rel=1e-9)


# --- Hertz --------------------------------------------------------------------------------------------------
def hertz(per_width: int) -> tuple[Array, Array, float]:
    """Half of a long cylinder (R = 8, E = 200, nu = 0.3) pressed onto a rigid plane: places, pressures, force."""
    R, width, height, a = 8.0, 7.0, 9.0, 0.32
    size = a / per_width
    n = round(2 * a / size)
    fine = np.linspace(0, 2 * a, n + 1)
    x = np.concatenate([fine, 2 * a + (width - 2 * a) * np.linspace(0, 1, n + 1)[1:] ** 2])
    y = (np.expm1(4.5 * np.linspace(0, 1, 2 * n + 1)) / np.expm1(4.5)) * height
    unit = vv.RectangleMesh(size=(1, 1), counts=(len(x) - 1, len(y) - 1)).build()
    i = np.rint(unit.points * [len(x) - 1, len(y) - 1]).astype(int)
    X, Y = x[i[:, 0]], y[i[:, 1]]
    arc = R - np.sqrt(R**2 - X**2)
    mesh = vv.Mesh(
        np.column_stack([X, arc + Y * (height - arc) / height]), unit.cells, face_sets=unit.face_sets
    )
    steel = vv.LinearElastic(young=200.0, poisson=0.3)
    cylinder = vv.Solid(mesh=mesh, material=steel)
    plane = vv.Solid(mesh=vv.RectangleMesh(size=(8, 1), counts=(5, 1), origin=(-0.5, -1)), material=steel)
    contact = vv.Contact(first=cylinder, second=plane, first_faces="y0", second_faces="y1")
    parts: list[Component] = [
        cylinder,
        plane,
        contact,
        vv.Fixed(solid=plane, nodes="all"),
        vv.SymmetryPlane(solid=cylinder, nodes="x0", normal=(1, 0, 0)),
        vv.Prescribed(solid=cylinder, nodes="y1", motion=(None, "-0.026*t", None)),
    ]
    system = vv.System(parts)
    vv.quasi_static(system, until=1.0, step=0.25)
    surface = cylinder.faces("y0").nodes
    order = np.argsort(cylinder.points[surface, 0])
    x = cylinder.positions(system.x)[surface, 0][order]
    return x, contact.pressures[order], 2 * float(vv.ContactForce(contact=contact)(system)[1])


def hertz_error(per_width: int) -> tuple[float, float]:
    """Error of the largest pressure, and of the pressures in the mean square, against Hertz for the same force."""
    x, p, F = hertz(per_width)
    stiff, R = 200 / (1 - 0.3**2), 8.0
    a, largest = np.sqrt(4 * F * R / (np.pi * stiff)), np.sqrt(F * stiff / (np.pi * R))
    exact = largest * np.sqrt(np.clip(1 - (x / a) ** 2, 0, None))
    assert np.all(p[x > 1.3 * a] == 0)
    square = np.trapezoid((p - exact) ** 2, x) / np.trapezoid(exact**2, x)
    return float(abs(p[0] / largest - 1)), float(np.sqrt(square))


def test_hertz_line_contact_converges() -> None:
    """R = 8, E = 200, nu = 0.3, against Hertz's pressures on a half-space for the force that is measured.

    The body is 25 half widths wide, which leaves about one per cent in the largest pressure.
    """
    coarse, fine = hertz_error(4), hertz_error(8)
    assert fine[0] < 0.02
    assert fine[1] < 0.7 * coarse[1] < 0.1


# --- a bar against a wall -----------------------------------------------------------------------------------
def bar(n: int, h: float, **options: Any) -> tuple[vv.Result, Array, Array]:
    """Bar of length 10 and speed 10 that hits a rigid wall at t = 0.05 (Doyen, Ern & Piperno 2011: c = 30)."""
    material = vv.LinearElastic(young=900.0, poisson=0.0)
    mesh = vv.RectangleMesh(size=(10, 1), counts=(n, 1)).build()
    rod = vv.Solid(mesh=mesh, material=material, density=1.0, velocity=(10, 0, 0))
    wall = vv.Solid(mesh=vv.RectangleMesh(size=(1, 2), counts=(1, 1), origin=(10.5, -0.5)), material=material)
    contact = vv.Contact(first=rod, second=wall, first_faces="x1", second_faces="x0", **options)
    parts: list[Component] = [rod, wall, contact, vv.Fixed(solid=wall, nodes="all")]
    parts.append(vv.Fixed(solid=rod, nodes="all", directions=(0, 1, 0)))
    system, force, speed = vv.System(parts), [], []
    probe = vv.ContactForce(contact=contact)

    def observe(s: vv.System) -> None:
        force.append(-probe(s)[0])
        speed.append(rod.nodal_mass @ rod.velocities(s.x, s.v)[:, 0] / 10)

    result = vv.simulate(system, until=0.85, step=h, observe=observe)
    return result, np.array(force), np.array(speed)


@pytest.mark.parametrize("kind", KINDS)
def test_bar_against_a_wall(kind: str) -> None:
    """Mean force 300 over 2 L / c, so that the bar leaves with -10."""
    result, force, speed = bar(40, 0.004, **KINDS[kind])
    total = result.ledger["total"]
    assert speed[-1] == pytest.approx(-10, abs=0.25)
    assert 0.004 * force.sum() == pytest.approx(300 * 2 / 3, rel=0.0125)
    assert np.max(total - total[0]) < 1e-9 * total[0]
    if kind != "dissipative":
        assert np.abs(total - total[0]).max() < 1e-9 * total[0]


# --- a rigid block on a penalty -----------------------------------------------------------------------------
def test_rigid_block_bounces_like_a_point_mass_on_a_spring() -> None:
    """m = 1, k = 1e4, v = 1: contact lasts pi sqrt(m / k) = 0.0314159, penetration v sqrt(m / k) = 0.01."""
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 1), origin=(-0.5, -0.5, -1))
    table = vv.Solid(mesh=mesh, material=vv.LinearElastic(young=100.0, poisson=0.3))
    block = vv.RigidBody(
        shape=vv.Box(size=(1.4, 1.4, 1)), mass=1.0, position=(0, 0, 0.502), velocity=(0, 0, -1)
    )
    contact = vv.Contact(first=table, second=block, first_faces="z1", enforcement="penalty", stiffness=1e4)
    system = vv.System([table, block, contact, vv.Fixed(solid=table, nodes="all")])
    h, heights, times = 5e-4, [0.002], [0.0]

    def observe(s: vv.System) -> None:
        heights.append(float(s.value(block.point((0, 0, -0.5)).position)[2]))
        times.append(s.time)

    result = vv.simulate(system, until=0.04, step=h, observe=observe)
    z, t = np.array(heights), np.array(times)
    down, up = (np.flatnonzero(np.diff(np.sign(z)) == s)[0] for s in (-2, 2))
    crossing = [t[k] + (t[k + 1] - t[k]) * z[k] / (z[k] - z[k + 1]) for k in (down, up)]
    assert crossing[1] - crossing[0] == pytest.approx(0.0314159, rel=2e-3)
    assert z.min() == pytest.approx(-0.01, rel=2e-3)
    result.assert_conserved("energy", tolerance=1e-10)
