"""Strains and stresses of solids: at the quadrature points of elements, and smoothed to nodes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError, nearest
from visviva.base.world import world
from visviva.body.element import is_curved
from visviva.mesh.cells import CELLS, Cell
from visviva.mesh.geometry import determinant
from visviva.mesh.quadrature import stiffness_rule
from visviva.model.callback import AcrossFree

if TYPE_CHECKING:
    from visviva.body.solid_term import Elements
    from visviva.material.material import Material
    from visviva.mesh.mesh import Mesh
    from visviva.model.callback import Function

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

FULL = [[0, 3, 5], [3, 1, 4], [5, 4, 2]]
"""Places of a symmetric tensor's entries among its six components 11, 22, 33, 12, 23, 31."""
Evaluated = tuple[str, Ints, Ints, Array, "Fields"]
"""Cell type, nodes (m, k), numbers, volumes (m, q) and fields (m, q, ...) of some elements."""
Valued = tuple[str, Ints, Array, Array]
"""Cell type, nodes (m, k), volumes (m, q) and values (m, q, columns) of some elements."""
CHUNK = 4096  # elements whose fields are held at a time; a multiple of eight


@dataclass(frozen=True, eq=False)
class Fields:
    """Strains and stresses at quadrature points; leading dimensions (...) are elements and their points.

    Materials of small strains have one stress, and ``C = I + 2 e``.

    Attributes
    ----------
    F : array, (..., 3, 3)
        Deformation gradient.
    second_piola : array, (..., 3, 3)
        Second Piola-Kirchhoff stress `S` of the material; viscous stresses are not in it.
    energy : array, (...)
        Strain energy per reference volume.
    small : bool
        Whether the material is one of small strains.

    Examples
    --------
    >>> import visviva as vv
    >>> rubber = vv.NeoHooke(shear=1.0, lame_lambda=1.0)
    >>> block = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), material=rubber)
    >>> system = vv.System([block])
    >>> fields = block.fields(1.1 * system.x)
    >>> fields.F.shape, float(fields.pressure[0, 0].round(6))
    ((1, 8, 3, 3), -0.3726)
    """

    F: Array
    second_piola: Array
    energy: Array
    small: bool

    @cached_property
    def C(self) -> Array:
        """Right Cauchy-Green tensor (..., 3, 3)."""
        if not self.small:
            return np.swapaxes(self.F, -1, -2) @ self.F
        C: Array = self.F + np.swapaxes(self.F, -1, -2) - np.eye(3)
        return C

    @property
    def green(self) -> Array:
        """Green's strain (..., 3, 3); the small strain of materials of small strains."""
        E: Array = (self.C - np.eye(3)) / 2
        return E

    @cached_property
    def J(self) -> Array:
        """Ratio of volumes (...)."""
        return determinant(self.F)

    @property
    def first_piola(self) -> Array:
        """First Piola-Kirchhoff stress (..., 3, 3): force per reference area, first index of the force."""
        return self.second_piola if self.small else self.F @ self.second_piola

    @cached_property
    def cauchy(self) -> Array:
        """Cauchy's stress (..., 3, 3): force per present area."""
        if self.small:
            return self.second_piola
        sigma: Array = self.first_piola @ np.swapaxes(self.F, -1, -2) / self.J[..., None, None]
        return sigma

    @property
    def pressure(self) -> Array:
        """Mean Cauchy stress (...) with the opposite sign."""
        p: Array = -np.trace(self.cauchy, axis1=-2, axis2=-1) / 3
        return p

    @property
    def von_mises(self) -> Array:
        """Equivalent stress (...) of von Mises, of Cauchy's stress."""
        return equivalent(self.cauchy)

    @property
    def principal_stresses(self) -> Array:
        """Principal values (..., 3) of Cauchy's stress, the largest first."""
        return principal(self.cauchy)

    @property
    def stretches(self) -> Array:
        """Principal stretches (..., 3), the largest first."""
        stretches: Array = np.sqrt(np.maximum(np.linalg.eigvalsh(self.C)[..., ::-1], 0.0))
        return stretches


def equivalent(stress: Array) -> Array:
    """Equivalent stress (...) of von Mises of stresses (..., 3, 3)."""
    deviator = stress - np.trace(stress, axis1=-2, axis2=-1)[..., None, None] / 3 * np.eye(3)
    value: Array = np.sqrt(1.5 * np.sum(deviator**2, axis=(-2, -1)))
    return value


def principal(stress: Array) -> Array:
    """Principal values (..., 3) of stresses (..., 3, 3), the largest first."""
    values: Array = np.linalg.eigvalsh(stress).astype(float)[..., ::-1]
    return values


def components(tensor: Array) -> Array:
    """Six components (..., 6) 11, 22, 33, 12, 23, 31 of symmetric tensors (..., 3, 3)."""
    return tensor[..., [0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]]


QUANTITIES: dict[str, tuple[int, Callable[[Fields], Array]]] = {
    "von_mises": (1, lambda f: f.von_mises),
    "pressure": (1, lambda f: f.pressure),
    "cauchy": (6, lambda f: components(f.cauchy)),
    "second_piola": (6, lambda f: components(f.second_piola)),
    "first_piola": (9, lambda f: f.first_piola.reshape(*f.J.shape, 9)),
    "principal_stresses": (3, lambda f: f.principal_stresses),
    "green": (6, lambda f: components(f.green)),
    "stretches": (3, lambda f: f.stretches),
    "J": (1, lambda f: f.J),
    "energy": (1, lambda f: f.energy),
}
"""Fields of solids by name: number of components, and values (..., components) to smooth, record and write."""

OF_STRESS: dict[str, Callable[[Array], Array]] = {"von_mises": equivalent, "principal_stresses": principal}
"""Quantities with kinks where stresses pass through zero: at nodes, they are those of the smoothed stress."""


def quantity(name: str) -> tuple[int, Callable[[Fields], Array]]:
    """Number of components and function of a quantity.

    Raises
    ------
    InputError
        With the nearest valid name.
    """
    if name not in QUANTITIES:
        raise InputError(f"there is no field {name!r}{nearest(name, QUANTITIES)}")
    return QUANTITIES[name]


def evaluated(
    parts: Sequence[Elements], x: Array, material: Material, formulation: str, energy: Function | None
) -> Iterator[Evaluated]:
    """Fields of the elements of all types, some thousand at a time; of the `energy` of a user's material too."""
    x = np.ascontiguousarray(x, dtype=float)
    for part in parts:
        n = len(part.nodes)
        step = max(n, 1) if material.energy is not None else CHUNK  # a user's function is called once
        for start in range(0, n, step):
            some = slice(start, min(start + step, n))
            fields = of_points(part.term.fields(x, some.start, some.stop), material.small)
            stretch = np.ones_like(fields.J) if part.thermal is None else 1 + part.thermal[some]
            if isinstance(energy, AcrossFree):
                fields = across_free(fields, energy, stretch)
            elif material.energy is not None and formulation == "F-bar":
                fields = responding(fields, material, stretch)
            yield part.cell, part.nodes[some], part.numbers[some], part.volume[some], fields


def across_free(part: Fields, energy: AcrossFree, stretch: Array) -> Fields:
    """Fields with the F33 of plane stress, which the core does not know of a user's energy, where heat stretches."""
    C = components(part.C) / stretch[..., None] ** 2
    F = part.F.copy()
    F[..., 2, 2] = stretch * np.sqrt(energy.settled(C.reshape(-1, 6).T)[2].reshape(part.J.shape))
    return replace(part, F=F)


def responding(part: Fields, material: Material, stretch: Array) -> Fields:
    """Fields with a user's stress of the F of F-bar, which the core does not know either."""
    C = components(part.C) / stretch[..., None] ** 2
    energy, S, _ = material.respond(C.reshape(-1, 6))
    second_piola = S.reshape(C.shape)[..., FULL] * stretch[..., None, None]
    return replace(part, second_piola=second_piola, energy=energy.reshape(stretch.shape) * stretch**3)


def of_points(values: Array, small: bool) -> Fields:
    """Fields from the core's rows (..., 16)."""
    F = values[..., :9].reshape(*values.shape[:-1], 3, 3)
    return Fields(F, values[..., 9:15][..., FULL], values[..., 15], small)


def of_each(parts: Iterable[Elements], x: Array) -> Iterator[Evaluated]:
    """Fields of elements whose terms give them at points, in rows as `of_points` takes them."""
    for part in parts:
        fields = of_points(part.term.fields(x, 0, len(part.nodes)), False)
        yield part.cell, part.nodes, part.numbers, part.volume, fields


def summed(grid: Mesh, forces: Iterable[tuple[Ints, Array]], cells: NDArray[np.bool_] | None) -> Array:
    """Forces (n, 3) on nodes, against the residuals (m, k, d) of elements of nodes (m, k); of some `cells`, or all."""
    total, first = np.zeros((grid.n_nodes, 3)), 0
    for nodes, force in forces:
        if cells is not None:
            force *= cells[first : first + len(force), None, None]
        np.subtract.at(total, nodes, np.pad(force, ((0, 0), (0, 0), (0, 3 - force.shape[2]))))
        first += len(force)
    return total


def smoothed(
    grid: Mesh, names: Sequence[str], points: Iterable[Evaluated], *, add_up: bool = False
) -> dict[str, Array]:
    """Quantities at the nodes, (n_nodes,) or (n_nodes, components) each.

    In every element the polynomial of least squares through the values at its quadrature points is taken to
    its nodes; a node has the mean of its elements, weighted by their volumes. Linear fields on undistorted
    elements (constant ones for tri3 and tet4) come out exactly. Von Mises' and principal stresses are those of
    the smoothed Cauchy stress. Elements that are not here are added up where other processes have them.
    """
    wanted = list(dict.fromkeys("cauchy" if name in OF_STRESS else name for name in names))
    found = _fitted(grid, wanted, points, add_up)
    return {
        name: OF_STRESS[name](found["cauchy"][:, FULL]) if name in OF_STRESS else found[name]
        for name in names
    }


def _fitted(grid: Mesh, names: Sequence[str], points: Iterable[Evaluated], add_up: bool) -> dict[str, Array]:
    """Quantities at the nodes, side by side in one mean."""
    chosen = [quantity(name) for name in names]
    ends = np.cumsum([0, *(width for width, _ in chosen)])

    def parts() -> Iterator[Valued]:
        for cell, nodes, _, volume, fields in points if chosen else ():
            values = [function(fields).reshape(*volume.shape, width) for width, function in chosen]
            yield cell, nodes, volume, np.concatenate(values, axis=2)

    mean = means(grid, int(ends[-1]), parts(), add_up=add_up)
    columns = {name: mean[:, a:b] for name, a, b in zip(names, ends, ends[1:], strict=False)}
    return {name: part[:, 0] if part.shape[1] == 1 else part for name, part in columns.items()}


def means(grid: Mesh, columns: int, parts: Iterable[Valued], *, add_up: bool = False) -> Array:
    """Means (n_nodes, columns) over the elements at each node of polynomials fitted in each element."""
    total, weight = np.zeros((grid.n_nodes, columns)), np.zeros(grid.n_nodes)
    for cell, nodes, volume, values in parts:
        taken = np.einsum("aq,eqc->eac", extrapolation(cell, is_curved(grid.points, nodes, cell)), values)
        size = volume.sum(axis=1)
        for a in range(nodes.shape[1]):
            weight += np.bincount(nodes[:, a], size, len(weight))
            for c in range(columns):
                total[:, c] += np.bincount(nodes[:, a], size * taken[:, a, c], len(weight))
    if add_up and columns:
        world().sum(total)
        world().sum(weight)
    return np.asarray(total / (weight[:, None] if columns else 1.0))


@cache
def extrapolation(cell: str, curved: bool = False) -> Array:
    """Matrix (nodes, points) that takes values at the quadrature points to the nodes by least squares."""
    xi = stiffness_rule(cell, curved).points
    for candidate in (CELLS[cell], linear(CELLS[cell])):
        N = candidate.N(xi)
        if np.linalg.matrix_rank(N) == N.shape[1]:
            return np.asarray(candidate.N(CELLS[cell].nodes) @ np.linalg.pinv(N))
    return np.full((CELLS[cell].n_nodes, len(xi)), 1 / len(xi))


def linear(cell: Cell) -> Cell:
    """The type of the same shape that has corners alone."""
    return next(c for c in CELLS.values() if c.family is cell.family and not c.middles)
