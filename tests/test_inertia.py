"""Inertia algebra against sums over point masses, and its refusals."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.body.inertia import (
    MassProperties,
    check_inertia,
    combine,
    euler_tensor,
    inertia_tensor,
    place,
    principal_axes,
    rotate_tensor,
    steiner,
)

Array = NDArray[np.float64]
Cloud = tuple[Array, Array]

vectors = arrays(float, 3, elements=st.floats(-3, 3))
quaternions = arrays(float, 4, elements=st.floats(-1, 1)).filter(lambda q: np.linalg.norm(q) > 0.1)


@st.composite
def clouds(draw: st.DrawFn) -> Cloud:
    """Masses (n,) and positions (n, 3) of particles."""
    n = draw(st.integers(4, 7))
    masses = draw(arrays(float, n, elements=st.floats(0.1, 3)))
    return masses, draw(arrays(float, (n, 3), elements=st.floats(-3, 3)))


def rotation_of(q: Array) -> Array:
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


rotations = st.builds(rotation_of, quaternions)


def about(masses: Array, positions: Array, point: Array) -> Array:
    """Inertia tensor of particles about a point, by its definition J ω = Σ m r x (ω x r)."""
    r = positions - point
    columns = [np.sum(masses[:, None] * np.cross(r, np.cross(omega, r)), axis=0) for omega in np.eye(3)]
    return np.column_stack(columns)


def properties(cloud: Cloud) -> MassProperties:
    masses, positions = cloud
    centre = masses @ positions / masses.sum()
    return MassProperties(float(masses.sum()), centre, about(masses, positions, centre))


def close(a: Array, b: Array) -> bool:
    return bool(np.allclose(a, b, rtol=1e-12, atol=1e-12))


@given(clouds())
def test_euler_tensor_is_the_second_moment(cloud: Cloud) -> None:
    masses, positions = cloud
    _, centre, J = properties(cloud)
    second_moment = np.einsum("p,pi,pj->ij", masses, positions - centre, positions - centre)
    assert close(euler_tensor(J), second_moment)
    assert close(inertia_tensor(second_moment), J)


def test_principal_euler_values_are_those_of_equation_8() -> None:
    J = np.array([3.0, 4.0, 5.5])
    assert euler_tensor(np.diag(J)).diagonal().tolist() == [0.5 * (4.0 + 5.5 - 3.0), 2.25, 0.75]


@given(clouds(), vectors)
def test_parallel_axes(cloud: Cloud, point: Array) -> None:
    mass, centre, J = properties(cloud)
    assert close(J + steiner(mass, centre - point), about(*cloud, point))


@given(clouds(), vectors, rotations)
def test_a_placed_part_is_the_moved_cloud(cloud: Cloud, position: Array, R: Array) -> None:
    masses, positions = cloud
    moved = properties((masses, position + positions @ R.T))
    placed = place(properties(cloud), position, R)
    assert placed.mass == moved.mass
    assert close(placed.centre, moved.centre)
    assert close(placed.inertia, moved.inertia)


@given(clouds(), clouds(), clouds())
def test_a_compound_is_the_union_of_clouds(a: Cloud, b: Cloud, c: Cloud) -> None:
    whole = properties((np.concatenate([a[0], b[0], c[0]]), np.vstack([a[1], b[1], c[1]])))
    combined = combine(properties(part) for part in (a, b, c))
    assert combined.mass == pytest.approx(whole.mass, rel=1e-14)
    assert close(combined.centre, whole.centre)
    assert close(combined.inertia, whole.inertia)
    nested = combine([combine([properties(a), properties(b)]), properties(c)])
    assert close(nested.inertia, combined.inertia)
    hollow = combine([combined, (-nested.mass / 4, nested.centre, -nested.inertia / 4)])
    assert close(hollow.inertia, 0.75 * combined.inertia)


@given(clouds(), rotations)
def test_every_cloud_is_admissible_in_every_frame(cloud: Cloud, R: Array) -> None:
    J = properties(cloud).inertia
    assume(np.abs(J).max() > 1e-3)
    smallest = check_inertia(J)
    assert smallest >= 0
    assert check_inertia(rotate_tensor(J, R)) == pytest.approx(smallest, rel=1e-9, abs=1e-10)


@given(arrays(float, 3, elements=st.floats(0.1, 10)), rotations)
def test_triangle_inequality_decides(moments: Array, R: Array) -> None:
    J = R @ np.diag(moments) @ R.T
    excess = 2 * moments.max() - moments.sum()
    assume(abs(excess) > 1e-9)
    if excess < 0:
        assert check_inertia(0.5 * (J + J.T)) == pytest.approx(-excess / 2, rel=1e-5)
    else:
        with pytest.raises(InputError, match="triangle inequality"):
            check_inertia(0.5 * (J + J.T))


@given(rotations)
def test_plates_and_rods_have_exactly_no_thickness(R: Array) -> None:
    for moments in ((1.0, 2.0, 3.0), (1.0, 1.0, 0.0)):
        assert check_inertia(rotate_tensor(np.diag(moments), R)) == 0.0


@given(arrays(float, 3, elements=st.sampled_from([1.0, 1.5, 2.0, 2.25])), rotations)
def test_principal_axes_diagonalise(moments: Array, R: Array) -> None:
    J = rotate_tensor(np.diag(moments), R)
    values, axes = principal_axes(J)
    assert values == pytest.approx(np.sort(moments), rel=1e-12)
    assert close(axes.T @ axes, np.eye(3))
    assert np.linalg.det(axes) == pytest.approx(1.0)
    assert np.allclose(axes @ np.diag(values) @ axes.T, J, atol=1e-11)


@given(rotations)
def test_principal_axes_do_not_hang_on_round_off(R: Array) -> None:
    """Equal moments leave the axes open: noise in the last digits must not choose them."""
    noise = 1e-15 * (R + R.T)
    for J in (np.eye(3), np.diag([1.0, 2.0, 2.0]), np.diag([1.0, 1.0, 1.5])):
        assert np.allclose(principal_axes(J + noise)[1], np.eye(3), atol=1e-13)
    assert principal_axes(np.diag([3.0, 1.0, 2.0]))[1].tolist() == [[0, 0, 1], [1, 0, 0], [0, 1, 0]]


@pytest.mark.parametrize(
    ("inertia", "message"),
    [
        (np.diag([1, 1, 2.1]), r"triangle inequality.*\(1, 1, 2.1\).*by 0.1: .*centre of mass"),
        (np.diag([1, 1, -0.1]), r"positive.*\(-0.1, 1, 1\).*centre of mass"),
        (np.zeros((3, 3)), "positive.*point mass"),
        (np.diag([1, 1, np.nan]), "not finite"),
        (np.eye(3) + np.eye(3, k=1) * 0.1, "not symmetric.*by 0.1"),
        ([1, 1, 1], r"shape \(3,\).*\(3, 3\)"),
        ([[1, 0], [0]], "not an array of numbers"),
    ],
)
def test_impossible_inertia_is_refused_with_the_cure(inertia: Array, message: str) -> None:
    with pytest.raises(InputError, match=message):
        check_inertia(inertia)


def test_compounds_and_placements_refuse_nonsense() -> None:
    unit = MassProperties(1.0, np.zeros(3), np.eye(3))
    with pytest.raises(InputError, match="total mass of 0 parts"):
        combine([])
    with pytest.raises(InputError, match="total mass of 2 parts is 0"):
        combine([unit, (-1.0, [0, 0, 0], -np.eye(3))])
    with pytest.raises(InputError, match="left-handed"):
        place(unit, rotation=np.diag([1, 1, -1]))
    with pytest.raises(InputError, match="not orthonormal by"):
        place(unit, rotation=1.1 * np.eye(3))
    with pytest.raises(InputError, match="position has shape"):
        place(unit, position=[0, 0])
