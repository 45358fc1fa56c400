"""Contact on half-spaces against Hertz and the flat punch: the exact field moves the outer boundary.

So nothing of the error is that of a body of finite size.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from reference.half_space import FlatPunch, Sphere, of_line_force, of_point_force

import visviva as vv
from verification.measure import orders

Array = NDArray[np.float64]
YOUNG, POISSON = 200.0, 0.3
BALL = Sphere(radius=100.0, depth=0.01, young=YOUNG, poisson=POISSON)
PUNCH = FlatPunch(half_width=1.0, force=2.0, young=YOUNG, poisson=POISSON)


# --- the references -----------------------------------------------------------------------------------------
@pytest.mark.parametrize("dimension", [2, 3])
def test_reference_fields_are_in_equilibrium(dimension: int) -> None:
    """Navier's equations by differences, and the surface moves as the formulas of the contacts say."""
    field = of_point_force if dimension == 3 else of_line_force
    X, h = np.array([[0.7, -0.4, 0.9]])[:, -dimension:], 1e-3
    eye = h * np.eye(dimension)

    def second(i: int, j: int) -> Any:
        ends = [
            (s * t, field(X + s * eye[i] + t * eye[j], YOUNG, POISSON)[0]) for s in (1, -1) for t in (1, -1)
        ]
        return sum(sign * u for sign, u in ends) / (4 * h * h)

    laplace = sum(second(i, i) for i in range(dimension))
    of_divergence = np.array([sum(second(i, j)[j] for j in range(dimension)) for i in range(dimension)])
    assert np.abs(laplace + of_divergence / (1 - 2 * POISSON)).max() < 1e-4 * np.abs(laplace).max()


def test_reference_surfaces_follow_sphere_and_punch() -> None:
    inside = np.array([[0.3, 0.1, 1e-3], [0.0, 0.6, 1e-3]])
    tiny = Sphere(radius=1.0, depth=1e-4, young=YOUNG, poisson=POISSON)
    far = np.array([[40.0, 0.0, 30.0]]) * tiny.half_width
    exact = tiny.force * of_point_force(far, YOUNG, POISSON)
    assert np.abs(tiny.displacement(far) - exact).max() < 1e-3 * np.abs(exact).max()
    # Johnson 3.42a: u_z = (1 - nu^2) pi p0 (2 a^2 - r^2) / 4 a E = d - r^2 / 2 R at the surface
    largest, a = BALL.pressure(np.zeros(1))[0], BALL.half_width
    r = np.hypot(*inside[:, :2].T)
    johnson = (1 - POISSON**2) * np.pi * largest * (2 * a**2 - r**2) / (4 * a * YOUNG)
    assert johnson == pytest.approx(BALL.depth - r**2 / (2 * BALL.radius), rel=1e-12)
    between = np.cos(
        (2 * np.pi * np.array([5, 12]) + np.pi / 3) / 40
    )  # where the sum over 40 forces is exact
    under = np.column_stack([between, np.full(2, 1e-12)])
    assert PUNCH.displacement(under)[:, 1] == pytest.approx(PUNCH.depth, rel=1e-6)


# --- meshes -------------------------------------------------------------------------------------------------
def graded(size: float, fine: float, end: float, growth: float) -> Array:
    """Grid lines from 0: apart by `size` as far as `fine`, then farther and farther beyond `end`."""
    lines = list(size * np.arange(round(fine / size) + 1))
    while lines[-1] < end:
        size *= growth
        lines.append(lines[-1] + size)
    return np.array(lines)


def block(*lines: Array) -> vv.Mesh:
    """A mesh of hexahedra or quadrilaterals with these grid lines."""
    shape: Any = vv.BoxMesh if len(lines) == 3 else vv.RectangleMesh
    counts = np.array([len(line) - 1 for line in lines])
    unit = shape(size=(1,) * len(lines), counts=tuple(counts)).build()
    index = np.rint(unit.points * counts).astype(int)
    points = np.column_stack([line[k] for line, k in zip(lines, index.T, strict=True)])
    return vv.Mesh(points, unit.cells, face_sets=unit.face_sets)


def pressed(mesh: vv.Mesh, exact: Any, second: Any, **options: Any) -> tuple[vv.Solid, vv.Contact, vv.System]:
    """A part of a half-space that its exact far field presses onto something at rest."""
    body = vv.Solid(mesh=mesh, material=vv.LinearElastic(young=YOUNG, poisson=POISSON))
    d, up = body.dimension, np.eye(3)[body.dimension - 1]
    outer = np.unique(np.concatenate([body.nodes(f"{axis}1") for axis in "xyz"[:d]]))

    def motion(t: float, X: Array) -> Array:
        moved = np.pad(exact.displacement(X[:, :d]), ((0, 0), (0, 3 - d)))
        return np.asarray(t * (moved - exact.depth * up))

    contact = vv.Contact(first=body, first_faces="xyz"[d - 1] + "0", second=second, **options)
    parts = [body, second, contact, vv.Prescribed(solid=body, nodes=outer, motion=motion)]
    for axis, normal in zip("xyz"[: d - 1], np.eye(3), strict=False):
        inner = np.setdiff1d(body.nodes(f"{axis}0"), outer)
        parts.append(vv.SymmetryPlane(solid=body, nodes=inner, normal=normal))
    if isinstance(second, vv.Solid):
        parts.append(vv.Fixed(solid=second, nodes="all"))
    system = vv.System(parts)
    vv.quasi_static(system, until=1.0, step=1.0)
    return body, contact, system


# --- Hertz --------------------------------------------------------------------------------------------------
def on_sphere(n: int) -> tuple[vv.Mesh, Any, dict[str, Any]]:
    """A quarter of a flat half-space on an exact sphere, n cells by half width."""
    growth = 1 + 1.8 / n
    lines = graded(1 / n, 1.25, 3.5, growth)
    ball = vv.Obstacle(shape=vv.Sphere(radius=BALL.radius), at=(0, 0, -BALL.radius))
    return block(lines, lines, graded(1 / n, 0.5, 3.5, growth)), ball, {}


def on_flat(n: int) -> tuple[vv.Mesh, Any, dict[str, Any]]:
    """A quarter of a paraboloid on a flat rigid face whose facets do not match."""
    mesh, _, _ = on_sphere(n)
    X = mesh.points.copy()
    X[:, 2] += (X[:, 0] ** 2 + X[:, 1] ** 2) / (2 * BALL.radius) * (1 - X[:, 2] / X[:, 2].max())
    table = vv.BoxMesh(size=(8, 8, 1), counts=(5, 5, 1), origin=(-0.7, -0.7, -1))
    face = vv.Solid(mesh=table, material=vv.LinearElastic(young=YOUNG, poisson=POISSON))
    bowl = vv.Mesh(X, mesh.cells, face_sets=mesh.face_sets)
    return bowl, face, {"second_faces": "z1"}


def hertz_errors(kind: Any, n: int) -> tuple[float, float, float]:
    """Errors of the force, of the largest pressure, and of the pressures in the mean square.

    The pressure at a vertex is its force by its area, which is what the body feels.
    """
    mesh, second, options = kind(n)
    body, contact, _ = pressed(mesh, BALL, second, **options)
    forces, areas = contact.forces[:, 2], contact.term.areas
    places = body.points[body.faces("z0").nodes]
    exact = BALL.pressure(np.hypot(places[:, 0], places[:, 1]))
    p = forces / np.where(areas > 0, areas, 1.0)
    square = areas @ (p - exact) ** 2 / (areas @ exact**2)
    return abs(4 * forces.sum() / BALL.force - 1), abs(p.max() / exact.max() - 1), float(np.sqrt(square))


@pytest.mark.parametrize("kind", [on_sphere, on_flat])
def test_hertz_point_contact_converges(kind: Any) -> None:
    """R = 100, E = 200, nu = 0.3, pressed by d = a^2 / R with a = 1: force and pressures."""
    coarse, fine = hertz_errors(kind, 4), hertz_errors(kind, 8)
    assert fine[0] < 0.01
    assert fine[1] < 0.02
    assert fine[2] < 0.6 * coarse[2] < 0.1


# --- flat punch ---------------------------------------------------------------------------------------------
def exact_box() -> Any:
    return vv.Obstacle(shape=vv.Box(size=(2, 2, 2)), at=(0, -1, 0)), {}


def rigid_block() -> Any:
    mesh = vv.RectangleMesh(size=(1.3, 1), counts=(2, 1), origin=(-0.3, -1))
    solid = vv.Solid(mesh=mesh, material=vv.LinearElastic(young=YOUNG, poisson=POISSON))
    return solid, {"second_faces": "y1"}


def punch_errors(kind: Any, n: int, beyond: float = 0.5) -> tuple[float, float]:
    """Errors of the force, and of the pressures on four fifths of the half width in the mean square.

    The punch' corner lies between two of the body's nodes, by a part of their distance `beyond` the inner one.
    """
    h = 1 / (n + beyond)
    mesh = block(graded(h, 1.25, 4.0, 1.2), graded(h, 0.5, 4.0, 1.2))
    second, options = kind()
    body, contact, system = pressed(mesh, PUNCH, second, **options)
    force = 2 * vv.ContactForce(contact=contact)(system)[1]
    x = body.points[body.faces("y0").nodes, 0]
    inner = x < 0.8
    exact, p = PUNCH.pressure(x[inner]), contact.pressures[inner]
    assert np.all(contact.pressures[x > 1 + 1.01 * h] == 0)
    return abs(force / PUNCH.force - 1), float(np.sqrt(np.mean((p - exact) ** 2) / np.mean(exact**2)))


@pytest.mark.parametrize("kind", [exact_box, rigid_block])
def test_flat_punch_converges(kind: Any) -> None:
    """p = P / (pi sqrt(a^2 - x^2)) with its infinite pressures at the corners."""
    found = np.array([punch_errors(kind, n) for n in (8, 16, 32)])
    assert (orders(found[:, 0]) > 0.7).all()
    assert found[-1].max() < 0.02


@pytest.mark.parametrize("beyond", [1e-6, 1e-3, 0.01, 0.1, 0.9, 0.99, 0.9999])
def test_corner_of_a_punch_beside_a_node(beyond: float) -> None:
    """The node beside it, which the punch hardly covers, neither ends Newton's method nor spoils force or pressures."""
    force, pressures = punch_errors(rigid_block, 8, beyond)
    assert force < 0.025
    assert pressures < 0.15


def rigid_block_by_vertices() -> Any:
    second, options = rigid_block()
    return second, {**options, "formulation": "node-to-segment"}


@pytest.mark.parametrize("beyond", [0.02, 0.5, 0.9])
def test_corner_of_a_punch_between_vertices(beyond: float) -> None:
    """Vertices that slide over the punch' border, whose facets are twenty times as long as theirs."""
    force, pressures = punch_errors(rigid_block_by_vertices, 32, beyond)
    assert force < 0.015
    assert pressures < 0.02
