"""Shapes: volume, centre, inertia and surfaces against quadrature and polyhedral sums."""

import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray
from pydantic import TypeAdapter

from visviva.base.errors import InputError
from visviva.body.inertia import MassProperties, check_inertia, combine, place
from visviva.body.shape import Box, Capsule, Cone, Cylinder, Shape, Sphere, SurfaceMesh

Array = NDArray[np.float64]

BOX, SPHERE, CYLINDER = Box((1.0, 2.0, 3.5)), Sphere(1.3), Cylinder(0.7, 2.2)
CONE, CAPSULE = Cone(0.6, 1.9), Capsule(0.5, 1.7)
ROUND = [SPHERE, CYLINDER, CONE, CAPSULE]
SIMPLE = [BOX, *ROUND]
PROFILES = {  # radius as a function of height, on the intervals where it is smooth
    SPHERE: [(-1.3, 1.3, lambda z: np.sqrt(1.3**2 - z**2))],
    CYLINDER: [(-1.1, 1.1, lambda z: 0.7 + 0 * z)],
    CONE: [(0.0, 1.9, lambda z: 0.6 * z / 1.9)],
    CAPSULE: [
        (-1.35, -0.85, lambda z: np.sqrt(np.maximum(0.25 - (z + 0.85) ** 2, 0))),
        (-0.85, 0.85, lambda z: 0.5 + 0 * z),
        (0.85, 1.35, lambda z: np.sqrt(np.maximum(0.25 - (z - 0.85) ** 2, 0))),
    ],
}
lengths = st.floats(0.05, 20.0)
shapes = st.one_of(
    st.builds(Box, st.tuples(lengths, lengths, lengths)),
    st.builds(Sphere, lengths),
    *(st.builds(kind, lengths, lengths) for kind in (Cylinder, Cone, Capsule)),
)


def name(shape: Shape) -> str:
    return type(shape).__name__


def polyhedral_sums(points: Array, triangles: NDArray[np.int64]) -> tuple[float, Array, Array]:
    """Volume, ∫x dV and ∫x xᵀ dV as sums over the signed tetrahedra from the origin to each triangle.

    Over a tetrahedron with one corner at the origin, ∫x xᵀ dV = V/20 (Σ a aᵀ + s sᵀ), s the sum of corners a.
    """
    corners = points[triangles]
    volumes = np.linalg.det(corners) / 6
    total = corners.sum(axis=1)
    first = np.einsum("t,ti->i", volumes, total) / 4
    second = np.einsum("t,tai,taj->ij", volumes, corners, corners) + np.einsum(
        "t,ti,tj->ij", volumes, total, total
    )
    return float(volumes.sum()), first, second / 20


def mass_properties(surface: tuple[Array, NDArray[np.int64]], density: float) -> tuple[float, Array, Array]:
    volume, first, second = polyhedral_sums(*surface)
    centre = first / volume
    E = density * (second - volume * np.outer(centre, centre))
    return density * volume, centre, np.trace(E) * np.eye(3) - E


def deviation(ours: tuple[float, Array, Array], other: tuple[float, Array, Array], size: float) -> float:
    """Largest relative difference of mass, centre and inertia."""
    mass = abs(ours[0] - other[0]) / ours[0]
    centre = np.abs(ours[1] - other[1]).max() / size
    return float(max(mass, centre, np.abs(ours[2] - other[2]).max() / np.abs(ours[2]).max()))


def as_mesh(shape: Shape, resolution: int = 12) -> SurfaceMesh:
    points, triangles = shape.surface(resolution)
    return SurfaceMesh(points=points, triangles=triangles)


@pytest.mark.parametrize("shape", ROUND, ids=name)
def test_round_shapes_agree_with_gauss_quadrature_over_their_discs(shape: Shape) -> None:
    nodes, weights = np.polynomial.legendre.leggauss(20)
    volume = first = along = across = 0.0
    for low, high, radius in PROFILES[shape]:
        z = 0.5 * (low + high) + 0.5 * (high - low) * nodes
        w = 0.5 * (high - low) * weights
        area = np.pi * radius(z) ** 2
        volume, first = volume + w @ area, first + w @ (area * z)
        along, across = along + w @ (area * z**2), across + w @ (area * radius(z) ** 2 / 4)
    along -= first**2 / volume
    mass, centre, inertia = shape.inertia(density=2.5)
    assert mass == pytest.approx(2.5 * volume, rel=1e-13)
    assert centre == pytest.approx([0, 0, first / volume], rel=1e-13, abs=1e-13)
    diagonal = np.array([across + along, across + along, 2 * across])
    assert inertia == pytest.approx(2.5 * np.diag(diagonal), rel=1e-13)


def test_box_is_its_own_polyhedron() -> None:
    assert deviation(BOX.inertia(3.0), mass_properties(BOX.surface(), 3.0), 1.0) < 1e-15


@pytest.mark.parametrize("shape", ROUND, ids=name)
def test_surfaces_converge_to_the_closed_form_with_order_2(shape: Shape) -> None:
    exact = shape.inertia(2.0)
    errors = [deviation(exact, mass_properties(shape.surface(n), 2.0), 1.0) for n in (32, 64, 128)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx([2.0, 2.0], abs=0.02)
    assert errors[-1] < 4e-3


@pytest.mark.parametrize("shape", SIMPLE, ids=name)
@pytest.mark.parametrize("resolution", [3, 4, 7, 32])
def test_surfaces_are_closed_and_look_outwards(shape: Shape, resolution: int) -> None:
    points, triangles = shape.surface(resolution)
    edges = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    assert {tuple(e) for e in edges.tolist()} == {(b, a) for a, b in edges.tolist()}
    assert len(np.unique(edges, axis=0)) == len(edges)
    assert len(points) - len(edges) // 2 + len(triangles) == 2  # Euler's formula, every point in use
    assert sorted(set(triangles.ravel().tolist())) == list(range(len(points)))
    a, b, c = points[triangles].transpose(1, 0, 2)
    outwards = np.einsum("ti,ti->t", np.cross(b - a, c - a), (a + b + c) / 3 - shape.centre)
    assert (outwards > 0).all()  # all of these shapes are convex


def test_the_surface_meets_the_stated_extents() -> None:
    for shape, low, high in [
        (BOX, (-0.5, -1, -1.75), (0.5, 1, 1.75)),
        (SPHERE, (-1.3,) * 3, (1.3,) * 3),
        (CYLINDER, (-0.7, -0.7, -1.1), (0.7, 0.7, 1.1)),
        (CONE, (-0.6, -0.6, 0), (0.6, 0.6, 1.9)),
        (CAPSULE, (-0.5, -0.5, -1.35), (0.5, 0.5, 1.35)),
    ]:
        points, _ = shape.surface(32)
        assert np.allclose(points.min(axis=0), low, atol=1e-15)
        assert np.allclose(points.max(axis=0), high, atol=1e-15)


def test_the_cone_is_the_published_top() -> None:
    """Top of Betsch & Leyendecker: r = 0.05, h = 0.1, density 2700, standing on its tip."""
    mass, centre, inertia = Cone(radius=0.05, height=0.1).inertia(2700)
    assert mass == pytest.approx(0.70685834706, rel=1e-11)
    assert centre[2] == pytest.approx(0.075)
    assert inertia.diagonal() == pytest.approx([5.3014376e-4] * 3, rel=1e-8)


@given(shapes, st.floats(1e-3, 1e4))
def test_every_shape_has_an_admissible_inertia(shape: Shape, density: float) -> None:
    mass, _, inertia = shape.inertia(density)
    assert mass > 0
    assert check_inertia(inertia) > 0


@given(shapes, lengths)
def test_inertia_scales_with_the_fifth_power_of_length(shape: Shape, scale: float) -> None:
    larger = type(shape)(*(np.multiply(value, scale) for value in vars(shape).values()))
    expected = np.array(shape.inertia(1.0).inertia) * scale**5
    assert larger.inertia(1.0).inertia == pytest.approx(expected, rel=1e-12)


def test_a_capsule_is_a_compound() -> None:
    points, triangles = Sphere(0.5).surface(256)
    half_ball = MassProperties(*mass_properties((np.maximum(points, [-1, -1, 0]), triangles), 1.0))
    upper = place(half_ball, (0, 0, 0.85))
    lower = place(half_ball, (0, 0, -0.85), rotation=np.diag([1.0, -1.0, -1.0]))
    compound = combine([Cylinder(0.5, 1.7).inertia(1.0), upper, lower])
    assert deviation(CAPSULE.inertia(1.0), compound, 1.0) < 3e-4  # the surface of the ball is a polyhedron


# Surface meshes


@given(shapes, arrays(float, 3, elements=st.floats(-5, 5)))
def test_mesh_moments_agree_with_polyhedral_sums(shape: Shape, offset: Array) -> None:
    points, triangles = shape.surface(9)
    mesh = SurfaceMesh(points=points + offset, triangles=triangles)
    exact = mass_properties((points, triangles), 1.7)
    size = float(np.abs(points).max())
    moved = (exact[0], exact[1] + offset, exact[2])
    thin = size / np.ptp(points, axis=0).min()
    assert deviation(mesh.inertia(1.7), moved, size) < 1e-13 * thin**2 * (1 + np.abs(offset).max() / size)


def test_mesh_moments_keep_their_digits_far_from_the_origin() -> None:
    points, triangles = BOX.surface()
    far = SurfaceMesh(points=points + 2.0**20, triangles=triangles).inertia(1.0)
    assert far.centre == pytest.approx([2.0**20] * 3, rel=1e-15)
    assert far.inertia == pytest.approx(BOX.inertia(1.0).inertia, rel=1e-14)


@pytest.mark.parametrize("kind", ["stl", "obj", "ply"])
def test_mesh_files(tmp_path: Path, kind: str) -> None:
    trimesh = pytest.importorskip("trimesh")
    points, triangles = CONE.surface(24)
    file = tmp_path / f"cone.{kind}"
    trimesh.Trimesh(points, triangles, process=False).export(file)
    mesh = SurfaceMesh(file=file)
    single = 1e-6  # binary STL and PLY store single precision
    assert deviation(mass_properties((points, triangles), 1.0), mesh.inertia(1.0), 1.0) < single
    assert len(mesh.surface()[0]) == len(points)


def test_a_textured_file_is_closed_by_position(tmp_path: Path) -> None:
    """A seam of texture coordinates doubles points in an OBJ file without opening the body."""
    points, triangles = BOX.surface()
    soup = "".join(
        f"v {x} {y} {z}\nvt {i % 3} {i % 2}\n" for i, (x, y, z) in enumerate(points[triangles.ravel()])
    )
    faces = "".join(f"f {i}/{i} {i + 1}/{i + 1} {i + 2}/{i + 2}\n" for i in range(1, 3 * len(triangles), 3))
    (tmp_path / "box.obj").write_text(soup + faces)
    mesh = SurfaceMesh(file=tmp_path / "box.obj")
    assert mesh.volume == pytest.approx(7.0, rel=1e-14)
    assert len(mesh.surface()[0]) == 8


def test_triangles_that_collapse_in_a_file_do_no_harm(tmp_path: Path) -> None:
    points, triangles = BOX.surface()
    collapsed = np.array([[0, 0, 1], [2, 5, 5], [3, 4, 3]])
    corners = "".join(f"v {x} {y} {z}\n" for x, y, z in points)
    faces = "".join(f"f {a} {b} {c}\n" for a, b, c in np.vstack([triangles, collapsed]) + 1)
    (tmp_path / "box.obj").write_text(corners + faces)
    mesh = SurfaceMesh(file=tmp_path / "box.obj")
    assert mesh.volume == pytest.approx(7.0, rel=1e-14)
    assert len(mesh.surface()[1]) == len(triangles)


def test_a_cavity_is_subtracted() -> None:
    outer, inner = Box((2, 2, 2)).surface(), Box((1, 1, 1)).surface()
    points = np.vstack([outer[0], inner[0]])
    mesh = SurfaceMesh(points=points, triangles=np.vstack([outer[1], inner[1][:, ::-1] + 8]))
    assert mesh.volume == pytest.approx(7.0, rel=1e-14)
    assert mesh.inertia(1.0).inertia == pytest.approx((32 - 1) / 6 * np.eye(3), rel=1e-14, abs=1e-14)


@given(st.sampled_from(SIMPLE), st.data())
def test_contradictory_triangles_of_one_surface_are_turned_outwards(
    shape: Shape, data: st.DataObject
) -> None:
    points, triangles = shape.surface(8)
    turned = data.draw(arrays(bool, len(triangles)).filter(lambda t: 0 < t.sum() < len(t)))
    mixed = np.where(turned[:, None], triangles[:, ::-1], triangles)
    mesh = SurfaceMesh(points=points, triangles=mixed)
    assert mesh.volume == pytest.approx(as_mesh(shape, 8).volume, rel=1e-13)
    assert polyhedral_sums(*mesh.surface())[0] == pytest.approx(mesh.volume, rel=1e-13)


def klein_bottle(n: int = 6) -> tuple[Array, NDArray[np.int64]]:
    """A closed surface of one side only: a torus grid glued with a reflection."""
    i, j = np.divmod(np.arange(n * n), n)

    def index(a: NDArray[np.int64], b: NDArray[np.int64]) -> NDArray[np.int64]:
        return np.asarray((a % n) * n + np.where(a >= n, -b, b) % n)

    quad = np.column_stack([index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)])
    points = np.random.default_rng(1).normal(size=(n * n, 3))
    return points, np.vstack([quad[:, [0, 1, 2]], quad[:, [0, 2, 3]]])


def bad_meshes() -> dict[str, tuple[Array, NDArray[np.int64], str]]:
    points, triangles = BOX.surface()
    one_turned = np.vstack([triangles[:1, ::-1], triangles[1:]])
    two = np.vstack([points, points + 9])
    flat = points * (1, 1, 0)
    neighbour = np.array([6, 7, 8, 9, 10, 11, 12, 13])[triangles]
    return {
        "open": (points, triangles[1:], "3 of 18 edges do not belong .* fill the holes"),
        "fin": (points, np.vstack([triangles, triangles[:1]]), "not closed: 3 of"),
        "inside out": (points, triangles[:, ::-1], r"inside out, its volume is -7: .*\[:, ::-1\]"),
        "several surfaces": (two, np.vstack([one_turned, triangles + 8]), "contradict .* several surfaces"),
        "one side": (*klein_bottle(), "contradict .* one side only"),
        "flat": (flat, triangles, "encloses no volume"),
        "beyond": (points[:7], triangles, "names point 7, but there are only 7"),
        "touching along an edge": (
            np.vstack([points, np.add(points[2:], (0, 2, 3.5))]),
            np.vstack([triangles, neighbour]),
            "not closed: 1 of 35 .* split bodies",
        ),
    }


@pytest.mark.parametrize("case", list(bad_meshes()))
def test_bad_meshes_are_refused_with_the_cure(case: str) -> None:
    points, triangles, message = bad_meshes()[case]
    with pytest.raises(InputError, match=message):
        SurfaceMesh(points=points, triangles=triangles)


def test_bad_files_are_refused(tmp_path: Path) -> None:
    (tmp_path / "noise.stl").write_bytes(bytes(range(200)))
    (tmp_path / "model.xyzzy").write_text("hello")
    for file, message in [
        ("noise.stl", "no triangles|cannot be read"),
        ("model.xyzzy", "cannot be read"),
        ("no.stl", "no mesh"),
    ]:
        with pytest.raises(InputError, match=message):
            SurfaceMesh(file=tmp_path / file)


def test_a_mesh_is_given_in_one_way() -> None:
    points, triangles = BOX.surface()
    for arguments in (
        {},
        {"points": points},
        {"triangles": triangles},
        {"file": "a.stl", "points": points, "triangles": triangles},
    ):
        with pytest.raises(InputError, match="either `file` or both"):
            SurfaceMesh(**arguments)


def test_without_trimesh_the_message_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "trimesh", None)
    with pytest.raises(InputError, match=r"pip install \"visviva\[mesh\]\""):
        as_mesh(BOX)
    with pytest.raises(InputError, match=r"^a surface mesh needs the package"):
        SurfaceMesh(file=__file__)


# Plain data in, plain data out


@pytest.mark.parametrize("shape", [*SIMPLE, as_mesh(BOX)], ids=name)
def test_shapes_round_trip_through_plain_data(shape: Shape) -> None:
    adapter = TypeAdapter(type(shape))
    assert adapter.validate_json(adapter.dump_json(shape)) == shape
    assert adapter.json_schema()["additionalProperties"] is False


def test_shapes_are_values() -> None:
    assert Box(size=np.array([1, 2, 3])) == Box([1.0, 2.0, 3.0])
    assert hash(as_mesh(BOX)) == hash(as_mesh(BOX))
    with pytest.raises(AttributeError):
        SPHERE.radius = 2.0  # type: ignore[misc]


@pytest.mark.parametrize(
    ("kind", "arguments", "message"),
    [
        (Sphere, {"radius": 0}, "radius: .*greater than 0, not 0"),
        (Sphere, {"radius": float("nan")}, "radius: .*finite number, not nan"),
        (Sphere, {"radius": "wide"}, "radius: .*valid number.*, not 'wide'"),
        (Box, {"size": [1, 2]}, r"size\[2\]: .*needed"),
        (Box, {"size": [1, 2, 3, 4]}, "size: .*at most 3"),
        (Box, {"size": [1, -2, 3]}, r"size\[1\]: .*greater than 0, not -2"),
        (Cylinder, {"radius": 1, "length": float("inf")}, "length: .*finite"),
        (Cone, {"radius": 1, "height": 1, "hight": 1}, "hight: .*did you mean 'height'"),
        (Capsule, {"radius": 1}, "length: .*needed"),
        (SurfaceMesh, {"points": [[0, 0, float("nan")]], "triangles": [[0, 0, 0]]}, r"points\[0\].*finite"),
        (SurfaceMesh, {"points": [[0, 0, 0]], "triangles": [[0, 0.5, 0]]}, r"triangles\[0\].*integer"),
        (SurfaceMesh, {"points": [[0, 0, 0]], "triangles": [[0, -1, 0]]}, r"triangles\[0\].*greater"),
    ],
)
def test_bad_arguments_are_named(kind: type, arguments: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=f"{kind.__name__}: {message}"):
        kind(**arguments)


@pytest.mark.parametrize("density", [0.0, -1.0, float("nan"), float("inf")])
def test_density_is_positive(density: float) -> None:
    with pytest.raises(InputError, match=r"density is .* positive"):
        BOX.inertia(density)


def test_resolution_needs_three_segments() -> None:
    with pytest.raises(InputError, match="at least 3"):
        SPHERE.surface(2)
