"""Algebra of mass properties: inertia tensor, Euler tensor, parallel axes, principal axes, compounds.

Throughout, `J` is the usual inertia tensor ``∫ρ (|x|² I - x xᵀ) dV`` and `E` the Euler tensor ``∫ρ x xᵀ dV``,
whose principal values ``E_i = ½ (J_j + J_k - J_i)`` fill the constant mass matrix of a body in directors.
"""

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visviva.base.errors import InputError

Array = NDArray[np.float64]

ROUND_OFF = 1e-12
"""Relative size below which a difference of moments of inertia counts as round-off."""
UNTURNED = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


class MassProperties(NamedTuple):
    """Mass, centre of mass (3,), and inertia tensor (3, 3) about that centre, all in one frame."""

    mass: float
    centre: Array
    inertia: Array


def euler_tensor(inertia: ArrayLike) -> Array:
    """Euler tensor ``E = ½ tr(J) I - J`` of an inertia tensor (3, 3) about the same point.

    Examples
    --------
    >>> euler_tensor(np.diag([3.0, 4.0, 5.0])).diagonal().tolist()
    [3.0, 2.0, 1.0]
    """
    J = _array(inertia, (3, 3), "inertia")
    E: Array = np.diag(0.5 * (_sum_of_others(J) - J.diagonal())) - _off_diagonal(J)
    return E


def inertia_tensor(euler: ArrayLike) -> Array:
    """Inertia tensor ``J = tr(E) I - E`` of an Euler tensor (3, 3); the inverse of `euler_tensor`."""
    E = _array(euler, (3, 3), "Euler tensor")
    J: Array = np.diag(_sum_of_others(E)) - _off_diagonal(E)
    return J


def steiner(mass: float, offset: ArrayLike) -> Array:
    """Inertia tensor (3, 3) of a point mass at `offset` (3,): what parallel axes add to the central inertia.

    Examples
    --------
    A rod of mass 12 and length 1, about its end instead of its centre:

    >>> float((np.diag([1.0, 1.0, 0.0]) + steiner(12.0, [0.0, 0.0, 0.5]))[0, 0])
    4.0
    """
    a = _array(offset, (3,), "offset")
    return inertia_tensor(mass * np.outer(a, a))


def rotate_tensor(tensor: ArrayLike, rotation: ArrayLike) -> Array:
    """Components ``R T Rᵀ`` of a tensor (3, 3) once its body is turned by the matrix `rotation` (3, 3)."""
    R = _rotation(rotation)
    rotated: Array = R @ _array(tensor, (3, 3), "tensor") @ R.T
    return rotated


def principal_axes(inertia: ArrayLike) -> tuple[Array, Array]:
    """Principal moments and axes of an inertia tensor.

    Parameters
    ----------
    inertia : array_like, (3, 3)
        Symmetric tensor.

    Returns
    -------
    moments : ndarray, (3,)
        In ascending order.
    axes : ndarray, (3, 3)
        The axes as columns, right-handed. The choice is fixed by the tensor alone: among axes of equal moment
        those nearest to the coordinate axes are taken, and each axis points to the positive side of the
        coordinate axis nearest to it, the third as the right hand demands.

    Raises
    ------
    InputError
        If the tensor is not symmetric or not finite.

    Examples
    --------
    >>> moments, axes = principal_axes(np.diag([2.0, 1.0, 2.0]))
    >>> moments.tolist(), axes[:, 0].tolist()
    ([1.0, 2.0, 2.0], [0.0, 1.0, 0.0])
    """
    J = _symmetric(inertia)
    moments, vectors = np.linalg.eigh(J)
    cluster = np.cumsum(np.diff(moments, prepend=moments[0]) > ROUND_OFF * np.abs(moments).max())
    axes = np.zeros((3, 3))
    for i in range(3):
        basis = vectors[:, cluster == cluster[i]]
        eigenspace = basis @ basis.T - axes[:, cluster == cluster[i]] @ axes[:, cluster == cluster[i]].T
        nearest = np.argmax(np.round(eigenspace.diagonal(), 9))
        axes[:, i] = eigenspace[:, nearest] / np.linalg.norm(eigenspace[:, nearest])
    axes[:, 2] = np.cross(axes[:, 0], axes[:, 1])
    return np.einsum("ji,jk,ki->i", axes, J, axes), axes


def check_inertia(inertia: ArrayLike) -> float:
    """Refuse an inertia tensor that no distribution of mass can have.

    Parameters
    ----------
    inertia : array_like, (3, 3)
        Inertia tensor about the centre of mass, in any frame.

    Returns
    -------
    float
        The smallest principal value of the Euler tensor, exactly 0 where it is round-off. Zero means a body
        without extent in some direction (a plate or a rod): possible, yet its mass matrix in directors is
        singular.

    Raises
    ------
    InputError
        If the tensor is not symmetric, not positive, or violates ``J_i <= J_j + J_k`` by more than round-off.

    Examples
    --------
    >>> check_inertia(np.diag([3.0, 4.0, 5.0]))
    1.0
    >>> check_inertia(np.diag([1.0, 1.0, 2.0]))  # a thin disc
    0.0
    """
    J = _symmetric(inertia)
    moments = np.linalg.eigvalsh(J)
    if moments[2] <= 0.0 or moments[0] < -ROUND_OFF * moments[2]:
        raise InputError(
            f"inertia must be positive, its principal moments are {_listed(moments)}: "
            "give the tensor about the centre of mass, or use a point mass for a body without extent"
        )
    smallest = 0.5 * float(moments[0] + moments[1] - moments[2])
    if smallest < -ROUND_OFF * moments[2]:
        raise InputError(
            f"inertia violates the triangle inequality: of its principal moments {_listed(moments)} the "
            f"largest exceeds the sum of the other two by {-2 * smallest:.6g}: give all moments about the "
            "centre of mass, with products of inertia J_ij = -∫ρ x_i x_j dV (some programs print the "
            "opposite sign), and round them less"
        )
    return smallest if smallest > ROUND_OFF * moments[2] else 0.0


def place(
    part: MassProperties, position: ArrayLike = (0.0, 0.0, 0.0), rotation: ArrayLike = UNTURNED
) -> MassProperties:
    """Mass properties in the outer frame of a part whose frame sits at `position` (3,), turned by `rotation`.

    The columns of `rotation` (3, 3) are the axes of the part's frame, seen from the outer frame.

    Raises
    ------
    InputError
        If `rotation` is not a proper rotation or a number is not finite.
    """
    R = _rotation(rotation)
    centre = _array(position, (3,), "position") + R @ part.centre
    return MassProperties(part.mass, centre, rotate_tensor(part.inertia, R))


def combine(parts: Iterable[tuple[float, ArrayLike, ArrayLike]]) -> MassProperties:
    """Mass properties of several parts taken as one rigid body.

    Parameters
    ----------
    parts : iterable of (mass, centre, inertia)
        Each with its centre of mass (3,) and its inertia (3, 3) about that centre, all in one frame (see
        `place`). A negative mass with a negative inertia cuts a hole.

    Returns
    -------
    MassProperties
        In the same frame.

    Raises
    ------
    InputError
        If there is no part, the total mass is not positive, or a shape or number is wrong.

    Examples
    --------
    Two unit point masses, two apart:

    >>> zero = np.zeros((3, 3))
    >>> mass, centre, inertia = combine([(1.0, [0, 0, 0], zero), (1.0, [2, 0, 0], zero)])
    >>> mass, centre.tolist(), inertia.diagonal().tolist()
    (2.0, [1.0, 0.0, 0.0], [0.0, 2.0, 2.0])
    """
    rows = [(m, _array(c, (3,), "centre"), _array(J, (3, 3), "inertia")) for m, c, J in parts]
    mass = float(sum(m for m, _, _ in rows))
    if not (np.isfinite(mass) and mass > 0.0):
        raise InputError(f"the total mass of {len(rows)} parts is {mass:g}: give parts whose sum is positive")
    centre = np.sum([m * c for m, c, _ in rows], axis=0) / mass
    inertia = np.sum([J + steiner(m, c - centre) for m, c, J in rows], axis=0)
    return MassProperties(mass, centre, inertia)


def _array(value: ArrayLike, shape: tuple[int, ...], name: str) -> Array:
    try:
        array = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name} is not an array of numbers: give an array of shape {shape}") from error
    if array.shape != shape:
        raise InputError(f"{name} has shape {array.shape}: give an array of shape {shape}")
    if not np.isfinite(array).all():
        raise InputError(f"{name} is not finite: {array.tolist()}")
    return array


def _sum_of_others(tensor: Array) -> Array:
    """Diagonal entries j + k for each i; the trace less entry i would lose the digits of thin bodies."""
    a, b, c = tensor.diagonal().tolist()
    return np.array([c + b, a + c, b + a])


def _off_diagonal(tensor: Array) -> Array:
    return tensor - np.diag(tensor.diagonal())


def _symmetric(inertia: ArrayLike) -> Array:
    J = _array(inertia, (3, 3), "inertia")
    error = float(np.abs(J - J.T).max())
    if error > ROUND_OFF * np.abs(J).max():
        raise InputError(
            f"inertia is not symmetric, opposite entries differ by {error:.6g}: "
            "give the full tensor with J_ij = J_ji"
        )
    return 0.5 * (J + J.T)


def _rotation(rotation: ArrayLike) -> Array:
    R = _array(rotation, (3, 3), "rotation")
    error = float(np.abs(R.T @ R - np.eye(3)).max())
    if error > 1e-9:
        raise InputError(
            f"rotation is not orthonormal by {error:.2g}: its columns must be three unit directors"
        )
    if np.linalg.det(R) < 0.0:
        raise InputError("rotation is left-handed (determinant -1): reverse one of its columns")
    return R


def _listed(values: NDArray[np.floating[Any]]) -> str:
    return "(" + ", ".join(f"{value:.6g}" for value in values) + ")"
