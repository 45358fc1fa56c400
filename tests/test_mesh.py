"""Meshes: cell types, quadrature, generators, sets, checks, conversions."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from math import factorial, pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import visviva as vv
from visviva.mesh.cells import CELLS, Cell
from visviva.mesh.generate import MeshSource
from visviva.mesh.geometry import cell_axes
from visviva.mesh.quadrature import corner_rule, gauss, mass_rule, rule, simplex_rule, stiffness_rule

SOLIDS = ["hex8", "hex20", "hex27", "tet4", "tet10", "wedge6"]
PLANES = ["quad4", "quad8", "quad9", "tri3", "tri6"]
Faces = vv.Faces


def enclosed(mesh: vv.Mesh, faces: Faces) -> float:
    """Volume by the divergence theorem, from the faces alone, in one formula for edges and faces."""
    total = 0.0
    for kind, nodes in faces.cells.items():
        xi, w = mass_rule(kind)
        X = np.einsum("qk,mkd->mqd", CELLS[kind].N(xi), mesh.points[nodes])
        T = np.einsum("qkj,mkd->jmqd", CELLS[kind].dN(xi), mesh.points[nodes])
        normal = np.cross(T[0], T[1]) if len(T) == 2 else np.stack([T[0][..., 1], -T[0][..., 0]], axis=-1)
        total += float(np.einsum("mqd,mqd,q->", X, normal, w)) / mesh.dimension
    return total


# --- cell types ---------------------------------------------------------------------------------------------
@pytest.fixture(params=CELLS.values(), ids=lambda c: c.name)
def cell(request: pytest.FixtureRequest) -> Cell:
    """Every cell type."""
    return request.param  # type: ignore[no-any-return]


def inside(cell: Cell, n: int = 7) -> np.ndarray:
    """Points inside a reference cell: means of its corners by random weights."""
    weights = np.random.default_rng(1).dirichlet(np.ones(cell.n_corners), n)
    return np.asarray(weights @ cell.nodes[: cell.n_corners])


def test_shape_functions_are_one_at_their_node_and_zero_at_others(cell: Cell) -> None:
    rounding = 1e-16 if cell.name == "line4" else 0.0  # thirds are no binary fractions
    np.testing.assert_allclose(cell.N(cell.nodes), np.eye(cell.n_nodes), rtol=0, atol=rounding)


def test_shape_functions_sum_to_one_and_reproduce_positions(cell: Cell) -> None:
    x = inside(cell)
    np.testing.assert_allclose(cell.N(x).sum(axis=1), 1, atol=1e-14)
    np.testing.assert_allclose(cell.N(x) @ cell.nodes, x, atol=1e-14)
    np.testing.assert_allclose(cell.dN(x).sum(axis=1), 0, atol=1e-13)


def test_gradients_are_those_of_differences(cell: Cell) -> None:
    x, h = inside(cell), 1e-30  # polynomials may be evaluated at complex places
    for k in range(cell.dimension):
        z = x + 1j * h * np.eye(cell.dimension)[k]
        values = np.prod(z[:, None, :] ** np.array(cell.powers), axis=2) @ cell.coefficients
        np.testing.assert_allclose(cell.dN(x)[:, :, k], values.imag / h, atol=1e-13)


def test_shape_functions_are_those_of_vtk(cell: Cell) -> None:
    vtk = pytest.importorskip("vtk")
    theirs = vtk.vtkGenericCell.InstantiateCell(cell.vtk)
    assert theirs.GetNumberOfPoints() == cell.n_nodes
    low, high = (f(cell.nodes, axis=0) for f in (np.min, np.max))
    for x in [*inside(cell), *cell.nodes]:
        place = np.zeros(3)
        # coordinates of VTK go from 0 to 1, but for the cubic line
        place[: cell.dimension] = x if cell.name == "line4" else (x - low) / (high - low)
        weights = np.zeros(cell.n_nodes)
        theirs.InterpolateFunctions(place, weights)
        np.testing.assert_allclose(cell.N(x[None])[0], weights, atol=1e-13)


# Faces as the Abaqus manual lists them, corners counted from one.
ABAQUS = {
    "tri": ["12", "23", "31"],
    "quad": ["12", "23", "34", "41"],
    "tet": ["123", "142", "243", "341"],
    "hex": ["1234", "5876", "1562", "2673", "3784", "4851"],
    "wedge": ["123", "465", "1452", "2563", "3641"],
}


def test_faces_look_outwards_and_are_numbered_as_in_abaqus(cell: Cell) -> None:
    if not cell.faces:
        return
    listed = ABAQUS[cell.name.rstrip("0123456789")]
    found = [set(face.nodes[: len(text)] + 1) for face, text in zip(cell.faces, listed, strict=True)]
    assert found == [{int(c) for c in text} for text in listed]
    for face in cell.faces:
        kind = CELLS[face.type]
        here, X = kind.centre[None], cell.nodes[face.nodes]
        T = (X.T @ kind.dN(here)[0]).T
        normal = np.cross(*T) if len(T) == 2 else np.array([T[0][1], -T[0][0]])
        assert normal @ (kind.N(here)[0] @ X - cell.centre) > 0
        # Its further nodes lie where the face's own geometry has them.
        np.testing.assert_allclose(kind.N(kind.nodes[: kind.n_corners]) @ X, X[: kind.n_corners])
        for group, x in zip(kind.middles, X[kind.n_corners :], strict=True):
            np.testing.assert_array_equal(X[list(group)].mean(axis=0), x)


# --- quadrature ---------------------------------------------------------------------------------------------
def integral(cell: Cell, powers: tuple[int, ...]) -> float:
    """Of a monomial over the reference cell."""
    on_line = [(1 + (-1) ** p) / (p + 1) for p in powers]
    if cell.nodes.min() == -1 and cell.name != "wedge6":
        return float(np.prod(on_line))
    flat = powers[:2] if cell.name == "wedge6" else powers
    value = np.prod([factorial(p) for p in flat]) / factorial(sum(flat) + len(flat))
    return float(value * (on_line[2] if cell.name == "wedge6" else 1))


@pytest.mark.parametrize("degree", range(9))
def test_rules_integrate_monomials(cell: Cell, degree: int) -> None:
    points, weights = rule(cell.name, degree)
    assert (weights > 0).all()
    for powers in product(range(degree + 1), repeat=cell.dimension):
        flat = powers[: {"wedge6": 2}.get(cell.name, 3)]
        if (cell.nodes.min() == 0 or cell.name == "wedge6") and sum(flat) > degree:
            continue
        values = np.prod(points ** np.array(powers), axis=1)
        assert weights @ values == pytest.approx(integral(cell, powers), rel=1e-14, abs=3e-15)


def test_corners_integrate_linear_functions(cell: Cell) -> None:
    if cell.middles:
        with pytest.raises(vv.InputError, match="has nodes between its corners"):
            corner_rule(cell.name)
        return
    points, weights = corner_rule(cell.name)
    np.testing.assert_array_equal(cell.N(points), np.eye(cell.n_nodes))
    for powers in np.vstack([np.zeros(cell.dimension, int), np.eye(cell.dimension, dtype=int)]):
        exact = integral(cell, tuple(int(p) for p in powers))
        assert weights @ np.prod(points**powers, axis=1) == pytest.approx(exact, rel=1e-14, abs=1e-15)


def test_rules_are_no_better_than_they_say() -> None:
    assert gauss(2).weights @ gauss(2).points[:, 0] ** 4 != pytest.approx(2 / 5, rel=1e-3)
    for degree in (1, 2, 4, 5, 6):
        points, weights = simplex_rule(degree, 2)
        exact = factorial(degree + 1) / factorial(degree + 3)
        assert weights @ points[:, 0] ** (degree + 1) != pytest.approx(exact, rel=1e-8)


def test_points_lie_inside(cell: Cell) -> None:
    for degree in range(9):
        x = rule(cell.name, degree).points
        assert np.all((x > cell.nodes.min(axis=0)) & (x < cell.nodes.max(axis=0)))
        if cell.n_corners in (3, 4, 6) and cell.nodes.min() == 0:
            assert np.all(x.sum(axis=1) < 1)


def test_default_rules_have_the_usual_numbers_of_points() -> None:
    stiffness = {"tet4": 1, "tet10": 4, "hex8": 8, "hex20": 27, "hex27": 27, "wedge6": 6}
    stiffness |= {"tri3": 1, "tri6": 3, "quad4": 4, "quad8": 9, "quad9": 9}
    mass = stiffness | {"tet4": 4, "tet10": 14, "tri3": 3, "tri6": 6}
    assert {name: len(stiffness_rule(name).weights) for name in stiffness} == stiffness
    assert {name: len(mass_rule(name).weights) for name in mass} == mass


def test_unknown_types_are_refused_with_the_nearest() -> None:
    with pytest.raises(vv.InputError, match="did you mean 'hex20'"):
        rule("hexa20", 2)
    with pytest.raises(vv.InputError, match="degree is -1"):
        rule("hex8", -1)


# --- generators ---------------------------------------------------------------------------------------------
def box(cell: str) -> MeshSource:
    return vv.BoxMesh(size=(1, 2, 3), counts=(2, 3, 4), cell=cell, origin=(-1, 0, 2))


def tube(inner: float, outer: float, counts: tuple[int, int, int]) -> MeshSource:
    return vv.HollowCylinderMesh(inner_radius=inner, outer_radius=outer, height=1, counts=counts)


GENERATORS: dict[str, tuple[Callable[[int, str], MeshSource], float, list[str]]] = {
    "tube": (
        lambda n, c: vv.HollowCylinderMesh(
            inner_radius=1, outer_radius=2, height=3, counts=(n, 6 * n, n), cell=c
        ),
        9 * pi,
        SOLIDS,
    ),
    "tube_sector": (
        lambda n, c: vv.HollowCylinderMesh(
            inner_radius=1, outer_radius=2, height=3, counts=(n, 3 * n, n), cell=c, angle=2.5
        ),
        11.25,
        SOLIDS,
    ),
    "cylinder": (lambda n, c: vv.CylinderMesh(radius=2, height=1, counts=(n, n, 1), cell=c), 4 * pi, SOLIDS),
    "cylinder_sector": (
        lambda n, c: vv.CylinderMesh(radius=2, height=1, counts=(n, n, 1), cell=c, angle=4.0),
        8.0,
        SOLIDS,
    ),
    "pie": (
        lambda n, c: vv.CylinderMesh(radius=2, height=1, counts=(n, n, 1), cell=c, angle=0.4),
        0.8,
        SOLIDS,
    ),
    "ball": (lambda n, c: vv.SphereMesh(radius=2, counts=(n, n), cell=c), 32 / 3 * pi, SOLIDS[:5]),
    "torus": (
        lambda n, c: vv.HollowTorusMesh(
            major_radius=4, outer_minor_radius=2, wall=0.5, counts=(10 * n, 6 * n, n), cell=c
        ),
        2 * pi**2 * 4 * (4 - 2.25),
        SOLIDS,
    ),
}
CURVED = [(name, cell) for name, (_, _, cells) in GENERATORS.items() for cell in cells]


@pytest.mark.parametrize(("name", "cell"), CURVED)
def test_volumes_of_curved_meshes_converge(name: str, cell: str) -> None:
    make, exact, _ = GENERATORS[name]
    levels = [2, 4] if CELLS[cell].middles else [4, 8]
    errors = [abs(make(n, cell).build().volume - exact) for n in levels]
    order = 4 if CELLS[cell].middles else 2
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.25)
    assert errors[1] < 0.02 * exact


@pytest.mark.parametrize(("name", "cell"), CURVED)
def test_meshes_are_sound_and_their_sets_are_the_whole_outside(name: str, cell: str) -> None:
    mesh = GENERATORS[name][0](2, cell).build().check()
    assert mesh.quality().min() > 0.01
    named = sum(s.n_faces for s in mesh.face_sets.values())
    assert named == mesh.boundary().n_faces
    assert enclosed(mesh, mesh.boundary()) == pytest.approx(mesh.volume, rel=1e-13)
    assert sum(enclosed(mesh, s) for s in mesh.face_sets.values()) == pytest.approx(mesh.volume, rel=1e-13)


@pytest.mark.parametrize("cell", SOLIDS)
def test_box(cell: str) -> None:
    mesh = box(cell).build().check()
    assert mesh.volume == pytest.approx(6, rel=1e-14)
    assert mesh.bounding_box.tolist() == [[-1, 0, 2], [0, 2, 5]]
    areas = {name: mesh.faces(name).area(mesh.points) for name in mesh.face_sets}
    assert areas == pytest.approx({"x0": 6, "x1": 6, "y0": 3, "y1": 3, "z0": 2, "z1": 2})
    for k, name in enumerate("xyz"):
        for end in (0, 1):
            X = mesh.points[mesh.nodes(f"{name}{end}")]
            assert np.all(X[:, k] == mesh.bounding_box[end, k])
    assert enclosed(mesh, mesh.boundary()) == pytest.approx(6, rel=1e-14)
    assert mesh.boundary().n_faces == sum(s.n_faces for s in mesh.face_sets.values())


@pytest.mark.parametrize("cell", PLANES)
def test_plane_meshes(cell: str) -> None:
    rectangle = vv.RectangleMesh(size=(3, 2), counts=(3, 2), cell=cell, origin=(1, 1)).build().check()
    cook = vv.QuadrilateralMesh(corners=[(0, 0), (48, 44), (48, 60), (0, 44)], counts=(4, 3), cell=cell)
    for mesh, area in ((rectangle, 6), (cook.build().check(), 1440)):
        assert mesh.volume == pytest.approx(area, rel=1e-14)
        assert enclosed(mesh, mesh.boundary()) == pytest.approx(area, rel=1e-13)
        assert sum(enclosed(mesh, s) for s in mesh.face_sets.values()) == pytest.approx(area, rel=1e-13)
    mesh = cook.build()
    lengths = {name: mesh.faces(name).area(mesh.points) for name in mesh.face_sets}
    slant = {"y0": float(np.hypot(48, 44)), "y1": float(np.hypot(48, 16))}
    assert lengths == pytest.approx({"x0": 44, "x1": 16, **slant})


def test_areas_of_curved_sides() -> None:
    mesh = GENERATORS["tube_sector"][0](6, "hex27").build()
    areas = {name: mesh.faces(name).area(mesh.points) for name in mesh.face_sets}
    exact = {"inner": 7.5, "outer": 15, "start": 3, "end": 3, "bottom": 3.75, "top": 3.75}
    assert areas == pytest.approx(exact, rel=1e-4)
    X = mesh.points[mesh.nodes("end")]
    np.testing.assert_allclose(np.arctan2(X[:, 1], X[:, 0]), 2.5, rtol=1e-14)
    pie = GENERATORS["cylinder_sector"][0](4, "hex20").build()
    areas = {name: pie.faces(name).area(pie.points) for name in pie.face_sets}
    assert areas == pytest.approx({"outer": 8, "start": 2, "end": 2, "bottom": 8, "top": 8}, rel=1e-4)


@pytest.mark.parametrize("cell", ["hex20", "hex27", "tet10"])
def test_nodes_between_corners_lie_on_the_true_surface(cell: str) -> None:
    ball = vv.SphereMesh(radius=2, counts=(2, 1), cell=cell).build()
    radii = np.linalg.norm(ball.points[ball.nodes("outer")], axis=1)
    np.testing.assert_allclose(radii, 2, rtol=1e-14)


def test_torus_of_the_paper() -> None:
    mesh = vv.HollowTorusMesh().build().check()
    assert (mesh.n_nodes, mesh.n_cells) == (12036, 8024)
    flat = np.hypot(np.hypot(mesh.points[:, 0], mesh.points[:, 1]) - 76, mesh.points[:, 2])
    np.testing.assert_allclose(flat[mesh.nodes("outer")], 24, rtol=1e-13)
    np.testing.assert_allclose(flat[mesh.nodes("inner")], 19.5, rtol=1e-13)
    assert mesh.volume == pytest.approx(2 * pi**2 * 76 * (24**2 - 19.5**2), rel=0.01)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: vv.BoxMesh(size=(1, 1, 0), counts=(1, 1, 1)), "size.2"),
        (lambda: vv.BoxMesh(size=(1, 1, 1), counts=(1, 0, 1)), "counts.1"),
        (lambda: vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1), cell="quad4"), "cell"),
        (
            lambda: vv.HollowCylinderMesh(inner_radius=2, outer_radius=1, height=1, counts=(1, 8, 1)),
            "not below",
        ),
        (
            lambda: vv.HollowCylinderMesh(inner_radius=1, outer_radius=2, height=1, counts=(1, 2, 1)),
            "at least 3",
        ),
        (lambda: vv.HollowTorusMesh(wall=30), "wall < outer_minor_radius < major_radius"),
        (lambda: vv.CylinderMesh(radius=1, height=1, counts=(1, 1, 1), angle=7), "angle"),
        (
            lambda: vv.QuadrilateralMesh(corners=[(0, 0), (0, 1), (1, 1), (1, 0)], counts=(1, 1)),
            "anticlockwise",
        ),
    ],
)
def test_generators_refuse(make: Callable[[], object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make()


# --- sets ---------------------------------------------------------------------------------------------------
def test_unknown_sets_are_refused_with_the_nearest() -> None:
    mesh = box("hex8").build().with_nodes("handle", [0]).with_cells("layer", [1])
    for get, wrong, right in (
        (mesh.nodes, "handel", "handle"),
        (mesh.nodes, "X0", "x0"),
        (mesh.faces, "xx1", "x1"),
        (mesh.cell_set, "layers", "layer"),
    ):
        with pytest.raises(vv.InputError, match=f"{wrong}'; did you mean '{right}'"):
            get(wrong)


def test_sets_are_selected_by_place() -> None:
    mesh = box("tet10").build()
    again = (
        mesh.with_faces("left", lambda X: X[:, 0] < -1 + 1e-9)
        .with_nodes("below", lambda X: X[:, 2] == 2)
        .with_cells("front", lambda X: X[:, 1] < 1)
    )
    assert again.faces("left").nodes.tolist() == mesh.faces("x0").nodes.tolist()
    assert enclosed(again, again.faces("left")) == pytest.approx(enclosed(mesh, mesh.faces("x0")))
    assert again.nodes("below").tolist() == mesh.nodes("z0").tolist()
    assert 0 < len(again.cell_set("front")) < mesh.n_cells
    assert "left" not in mesh.face_sets
    with pytest.raises(vv.InputError, match=r"one True or False for each"):
        mesh.select_nodes(lambda X: X[:, 0])  # type: ignore[arg-type,return-value]


def test_a_mesh_does_not_change() -> None:
    points = np.eye(3)
    mesh = vv.Mesh(points, {"tri3": [(0, 1, 2)]})
    points[0] = 7
    assert mesh.points[0, 0] == 1
    with pytest.raises(ValueError, match="read-only"):
        mesh.points[0, 0] = 2


# --- other meshes -------------------------------------------------------------------------------------------
@given(st.floats(-3, 3), st.floats(0.1, 4))
def test_moved_rotated_scaled(angle: float, factor: float) -> None:
    mesh = vv.SphereMesh(radius=1, counts=(1, 1)).build()
    other = mesh.rotated(angle, axis=(1, 2, 3), about=(1, 0, 0)).scaled(factor).moved((1, 2, 3))
    assert other.check().volume == pytest.approx(factor**3 * mesh.volume, rel=1e-12)
    centre = other.points.mean(axis=0) - (1, 2, 3)
    assert np.linalg.norm(centre / factor - (1, 0, 0)) == pytest.approx(1, rel=1e-12)


def test_rotation_is_right_handed() -> None:
    turned = vv.Mesh([(1, 0, 0), (0, 0, 1), (0, 1, 0)], {"tri3": [(0, 1, 2)]}).rotated(pi / 2)
    np.testing.assert_allclose(turned.points, [(0, 1, 0), (0, 0, 1), (-1, 0, 0)], atol=1e-15)
    with pytest.raises(vv.InputError, match="positive"):
        turned.scaled((1, -1, 1))


@pytest.mark.parametrize("cell", SOLIDS)
def test_merged_and_welded(cell: str) -> None:
    left = box(cell).build().with_cells("left", lambda X: X[:, 0] > -9)
    right = left.moved((1, 0, 0))
    right = vv.Mesh(
        right.points, right.cells, face_sets=right.face_sets, cell_sets={"right": left.cell_set("left")}
    )
    both = left.merged(right, weld=1e-9).check()
    apart = left.merged(right)
    assert apart.n_nodes == 2 * left.n_nodes
    assert both.n_nodes == 2 * left.n_nodes - len(left.nodes("x1"))
    assert both.volume == pytest.approx(12, rel=1e-13)
    assert both.boundary().n_faces == 2 * left.boundary().n_faces - 2 * left.faces("x0").n_faces
    assert both.faces("y0").area(both.points) == pytest.approx(6)
    assert enclosed(both, both.boundary()) == pytest.approx(12, rel=1e-13)
    assert both.centres[both.cell_set("right"), 0].min() > 0
    for name in ("y0", "z1"):
        kinds = both.faces(name)
        for kind, owners in kinds.owners.items():  # owners hold the nodes of their faces
            rows = both.cells[cell][owners]
            assert all(set(f) <= set(r) for f, r in zip(kinds.cells[kind], rows, strict=True))


def test_merged_with_other_types() -> None:
    hexes = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2)).build()
    wedges = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2), cell="wedge6", origin=(1, 0, 0)).build()
    both = hexes.merged(wedges, weld=1e-9).merged(hexes.moved((2, 0, 0)), weld=1e-9).check()
    assert both.volume == pytest.approx(3)
    assert enclosed(both, both.boundary()) == pytest.approx(3)
    assert both.boundary().area(both.points) == pytest.approx(14)
    assert both.faces("y0").area(both.points) == pytest.approx(3)
    owners = np.concatenate(list(both.faces("y0").owners.values()))
    assert len(owners) == len(set(owners)) == 12
    assert np.all(both.centres[owners, 1] < 0.5)


RAISED = [("hex8", "hex20"), ("hex8", "hex27"), ("tet4", "tet10")]
RAISED += [("quad4", "quad8"), ("quad4", "quad9"), ("tri3", "tri6")]


@pytest.mark.parametrize(("linear", "quadratic"), RAISED)
def test_quadratic(linear: str, quadratic: str) -> None:
    def build(cell: str) -> vv.Mesh:
        if linear in SOLIDS:
            return box(cell).build()
        return vv.RectangleMesh(size=(2, 1), counts=(3, 2), cell=cell).build()

    coarse, wanted = build(linear).with_nodes("corner set", lambda X: X[:, 0] == X[0, 0]), build(quadratic)
    mesh = coarse.quadratic(quadratic).check()
    assert (mesh.n_nodes, mesh.n_cells) == (wanted.n_nodes, wanted.n_cells)
    assert mesh.volume == pytest.approx(wanted.volume, rel=1e-14)
    for name in wanted.face_sets:
        theirs = wanted.points[wanted.nodes(name)]
        ours = mesh.points[mesh.nodes(name)]
        np.testing.assert_allclose(np.unique(ours.round(12), axis=0), np.unique(theirs.round(12), axis=0))
        assert enclosed(mesh, mesh.faces(name)) == pytest.approx(
            enclosed(wanted, wanted.faces(name)), abs=1e-14
        )
    assert len(mesh.nodes("corner set")) == len(wanted.nodes("x0"))


def test_quadratic_refuses() -> None:
    with pytest.raises(vv.InputError, match="hex8 cannot become tet10: that takes tet4"):
        box("hex8").build().quadratic("tet10")
    with pytest.raises(vv.InputError, match="did you mean 'hex20'"):
        box("hex8").build().quadratic("hexa20")


@pytest.mark.parametrize("cell", ["hex8", "tet10", "wedge6"])
def test_renumbered_is_the_same_mesh_with_near_neighbours(cell: str) -> None:
    mesh = (
        vv.BoxMesh(size=(8, 1, 1), counts=(12, 3, 3), cell=cell)
        .build()
        .with_cells("a", lambda X: X[:, 0] < 2)
    )
    shuffle = np.random.default_rng(0).permutation(mesh.n_nodes)
    points = np.empty_like(mesh.points)
    points[shuffle] = mesh.points
    sets = {name: s.renumbered(shuffle, np.arange(mesh.n_cells)) for name, s in mesh.face_sets.items()}
    mixed = vv.Mesh(points, {cell: shuffle[mesh.cells[cell]]}, {"n": [0, 5]}, sets, mesh.cell_sets)
    new = mixed.renumbered().check()

    def bandwidth(m: vv.Mesh) -> int:
        return int(np.ptp(m.cells[cell], axis=1).max())

    assert bandwidth(new) < 0.5 * bandwidth(mixed)
    assert new.volume == pytest.approx(8, rel=1e-13)
    assert new.points[new.nodes("n")].sum() == pytest.approx(mixed.points[[0, 5]].sum())
    assert new.centres[new.cell_set("a"), 0].max() < 2
    assert len(new.cell_set("a")) == len(mesh.cell_set("a"))
    for name in mesh.face_sets:
        assert enclosed(new, new.faces(name)) == pytest.approx(enclosed(mesh, mesh.faces(name)), abs=1e-13)
        for kind, owners in new.faces(name).owners.items():
            rows, faces = new.cells[cell][owners], new.faces(name).cells[kind]
            assert all(set(f) <= set(r) for f, r in zip(faces, rows, strict=True))


# --- bad meshes ---------------------------------------------------------------------------------------------
def spoiled(cell: str, change: Callable[[np.ndarray, np.ndarray], object]) -> vv.Mesh:
    """A box after a change of its points and cells."""
    mesh = vv.BoxMesh(size=(2, 1, 1), counts=(4, 2, 2), cell=cell).build()
    points, rows = mesh.points.copy(), mesh.cells[cell].copy()
    change(points, rows)
    return vv.Mesh(points, {cell: rows})


@pytest.mark.parametrize("cell", SOLIDS)
def test_inverted_cells_are_named_with_number_and_place(cell: str) -> None:
    n = CELLS[cell].n_corners
    mirror = {8: [4, 5, 6, 7, 0, 1, 2, 3], 4: [1, 0, 2, 3], 6: [3, 4, 5, 0, 1, 2]}[n]

    def invert(points: np.ndarray, rows: np.ndarray) -> None:
        rows[5, :n] = rows[5, mirror]

    with pytest.raises(vv.InputError, match=rf"^1 cell of type {cell} is inverted.*cell 5.*at \(") as caught:
        spoiled(cell, invert).check()
    place = np.array(str(caught.value).split("at (")[1].split(")")[0].split(","), dtype=float)
    mesh = spoiled(cell, lambda points, rows: None)
    low, high = (f(mesh.points[mesh.cells[cell][5]], axis=0) for f in (np.min, np.max))
    assert np.all((place >= low - 1e-6) & (place <= high + 1e-6))


def test_mirror_images_are_recognised() -> None:
    def mirror(points: np.ndarray, rows: np.ndarray) -> None:
        points[:, 0] *= -1

    with pytest.raises(vv.InputError, match=r"16 cells of type hex8 are inverted.*All are inside out"):
        spoiled("hex8", mirror).check()


@pytest.mark.parametrize("cell", SOLIDS)
def test_flat_cells_are_degenerate(cell: str) -> None:
    def flatten(points: np.ndarray, rows: np.ndarray) -> None:
        points[rows[0], 2] = 0.0

    with pytest.raises(vv.InputError, match="degenerate, the first is cell 0"):
        spoiled(cell, flatten).check()


def test_concave_cells_are_found_at_their_corner() -> None:
    points = [(0, 0), (1, 0), (0.2, 0.2), (0, 1)]
    with pytest.raises(vv.InputError, match=r"at \(0.2, 0.2\)"):
        vv.Mesh(points, {"quad4": [(0, 1, 2, 3)]}).check()


def test_midside_nodes_out_of_place() -> None:
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1), cell="hex20").build()
    points = mesh.points.copy()
    points[mesh.cells["hex20"][0, 8]] = (0.1, 0, 0)  # nearer than a quarter to the corner
    with pytest.raises(vv.InputError, match="use straight edges"):
        vv.Mesh(points, mesh.cells).check()


def test_thin_cells_are_no_degenerate_cells() -> None:
    assert vv.BoxMesh(size=(1, 1, 1e-7), counts=(2, 2, 1)).build().check().quality().min() == pytest.approx(1)


def test_quality_is_one_at_best() -> None:
    tetrahedron = [(1, -1, -1), (1, 1, 1), (-1, 1, -1), (-1, -1, 1)]
    assert vv.Mesh(tetrahedron, {"tet4": [(0, 1, 2, 3)]}).quality() == pytest.approx(1)
    triangle = [(0, 0), (1, 0), (0.5, 0.75**0.5)]
    assert vv.Mesh(triangle, {"tri3": [(0, 1, 2)]}).quality() == pytest.approx(1)
    prism = [(*p, z) for z in (0, 5) for p in triangle]
    assert vv.Mesh(prism, {"wedge6": [range(6)]}).quality() == pytest.approx(1)


def test_orphans() -> None:
    mesh = box("hex8").build()
    more = vv.Mesh([(9, 9, 9), *mesh.points], {"hex8": mesh.cells["hex8"] + 1}, {"some": [0, 1]})
    with pytest.raises(vv.InputError, match=r"1 node of the mesh is in no cell.*node 0 at \(9, 9, 9\)"):
        more.check()
    cured = more.without_orphans().check()
    assert np.array_equal(cured.points, mesh.points)
    assert cured.nodes("some").tolist() == [0]


def test_other_bad_meshes() -> None:
    mesh = box("hex8").build()
    points, rows = mesh.points.copy(), mesh.cells["hex8"].copy()
    rows[3, 2] = rows[3, 1]
    with pytest.raises(vv.InputError, match="collapsed, with a node twice, the first is cell 3"):
        vv.Mesh(points, {"hex8": rows}).check()
    again = np.vstack([mesh.cells["hex8"], np.roll(mesh.cells["hex8"][5], 4)])
    with pytest.raises(
        vv.InputError, match=r"there twice: cell 24 has the nodes of cell 5; delete the copies"
    ):
        vv.Mesh(mesh.points, {"hex8": again}).check()
    points[7] = np.nan
    with pytest.raises(vv.InputError, match="point 7 of a mesh is not finite"):
        vv.Mesh(points, mesh.cells).check()
    mixed = vv.Mesh(mesh.points, {**mesh.cells, "quad4": mesh.faces("x0").cells["quad4"]})
    with pytest.raises(vv.InputError, match=r"24 hex8 \(3D\), 12 quad4 \(2D\)"):
        mixed.check()
    with pytest.raises(vv.InputError, match="no cells"):
        vv.Mesh(mesh.points, {}).check()


@pytest.mark.parametrize(
    ("points", "cells", "message"),
    [
        (np.zeros((8, 4)), {}, r"not \(8, 4\)"),
        (np.zeros((8, 3)), {"hexa8": [range(8)]}, "did you mean 'hex8'"),
        (np.zeros((8, 3)), {"hex8": [range(4)]}, r"\(m, 8\), not \(1, 4\)"),
        (np.zeros((8, 3)), {"tet4": [(0, 1, 2, 8)]}, "names number 8 of 8"),
        (np.zeros((8, 3)), {"tet4": [(0, 1, 2, -1)]}, "names number -1 of 8"),
        (np.zeros((8, 3)), {"tet4": [(0, 1, 2, 0.5)]}, "whole numbers"),
    ],
)
def test_meshes_that_make_no_sense(points: np.ndarray, cells: dict[str, object], message: str) -> None:
    with pytest.raises(vv.InputError, match=message):
        vv.Mesh(points, cells)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("cell", "points"),
    [
        ("line3", [(0, 0, 0), (0.5, 0, 0), (1, 0, 0)]),
        ("quad4", [(0, 0, 0), (1, 0, 0.1), (0, 1, 0), (1, 1, 0)]),
    ],
)
def test_lines_and_surfaces_in_space_must_not_fold_back(cell: str, points: list[tuple[float, ...]]) -> None:
    """Nodes in the order of their places instead of VTK's: a line of more than its length, a bow tie."""
    mesh = vv.Mesh(points, {cell: [range(len(points))]})
    with pytest.raises(vv.InputError, match=f"1 cell of type {cell} is inverted or degenerate"):
        mesh.check()
    if cell == "line3":
        with pytest.raises(vv.InputError, match=f"Beam 'rod': 1 cell of type {cell} is inverted"):
            vv.Beam(mesh=mesh, section=vv.GivenSection(stiffness=(1,) * 6), name="rod")


@pytest.mark.parametrize("cell", ["hex8", "tet4", "wedge6"])
def test_axes_of_cells_turn_with_the_mesh(cell: str) -> None:
    """What lies around a place in a fluid is told by them: along axes of space it changed with the frame."""
    box = vv.BoxMesh(size=(1, 2, 3), counts=(2, 2, 2), cell=cell).build()
    turn = box.rotated(0.7, axis=(1, 2, 3))
    axis, angle = np.array([1.0, 2.0, 3.0]) / np.sqrt(14), 0.7
    K = np.cross(np.eye(3), axis)
    R = np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K
    assert np.allclose(turn.points, box.points @ R.T)
    axes = cell_axes(box)
    assert np.allclose(cell_axes(turn), R @ axes)
    assert np.allclose(np.abs(np.linalg.det(axes)), box.volumes)
