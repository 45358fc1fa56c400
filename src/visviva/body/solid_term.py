"""Parts of the core's terms of solids: elements of one type, energies given in Python, damping."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.base.world import world
from visviva.body import formulation as forms
from visviva.body.formulation import Formulation
from visviva.material.material import Material
from visviva.mesh.cells import CELLS
from visviva.mesh.geometry import jacobians, measure
from visviva.mesh.mesh import Mesh
from visviva.mesh.quadrature import stiffness_rule
from visviva.model.callback import AcrossFree, Function

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Elements:
    """Elements of one type of a solid.

    Attributes
    ----------
    cell : str
    nodes : array, (m, k)
    numbers : array, (m,)
        Among all of the solid.
    thermal : array, (m, q), or None
        Thermal strains at the quadrature points.
    term : object
        The core's.
    volume : array, (m, q)
        Of the quadrature points in the reference configuration.
    """

    cell: str
    nodes: Ints
    numbers: Ints
    thermal: Array | None
    term: Any
    volume: Array


def shared_out(grid: Mesh) -> NDArray[np.bool_]:
    """Cells (n_cells,) of a mesh that belong to this one of several processes."""
    own: NDArray[np.bool_] = world().parts(grid) == world().rank
    return own


def whole(values: Sequence[Array], numbers: Sequence[Ints]) -> Array:
    """Values (m, ...) of elements of all processes in the order of their numbers, from those of this one."""
    together = world().together((list(values), list(numbers)))
    found = np.concatenate([part for parts, _ in together for part in parts])
    order = np.argsort(np.concatenate([part for _, parts in together for part in parts]), kind="stable")
    return found[order]


def brick_term(
    material: Material,
    index: NDArray[np.int32],
    points: Array,
    nodes: Ints,
    density: float,
    mass: Array | None,
    damping: Array | None,
) -> tuple[Any, Array]:
    """Term of bricks of eight nodes, and volumes (m, 8) of its points.

    It works out gradients of shape functions and consistent masses whenever it needs them: what it would keep of
    these are 232 numbers for every brick, as much as two thirds of the matrix.

    Parameters
    ----------
    material
    index : array of int (m, 8)
        First unknown of every node.
    points : array (n, 3)
        Where the nodes of the mesh are in the reference configuration.
    nodes : array of int (m, 8)
    density : float
        Of what has a consistent mass, else 0.
    mass : array (m, 36), optional
        Any other.
    damping : array (m, 3), optional
    """
    rule, cell = stiffness_rule("hex8"), CELLS["hex8"]
    N, dN = cell.N(rule.points), cell.dN(rule.points)
    a, b = np.triu_indices(8)
    term = _core.SolidTerm.of_bricks(
        int(material.kind),
        material.small,
        np.ascontiguousarray(index),
        np.ascontiguousarray(points[nodes]),
        np.ascontiguousarray(dN),
        rule.weights,
        material.parameters(len(index)),
        np.ascontiguousarray(density * N[:, a] * N[:, b]) if density > 0 else None,
        mass,
        damping,
    )
    return term, rule.weights * measure(jacobians(points, nodes, dN))


def own_energy(
    label: str, material: Material, formulation: Formulation, *, in_plane: bool, across_free: bool
) -> Function | None:
    """A material's energy with its derivatives, if it is given in Python; one for all cells.

    With F-bar volumes change `in_plane` alone, or in space; stress may be free `across` the plane.
    """
    energy: Callable[[Any], Any] | None = material.energy
    if formulation == "mixed":
        energy = material.split().energy
    if energy is None:
        return None
    n, kind = 6, AcrossFree if across_free else Function
    if formulation == "F-bar":
        energy, n = forms.scaled(energy, 2 if in_plane else 3), 12
    return kind(energy, n, 1, f"{label}: energy of its material")


def rayleigh(
    material: Material, formulation: Formulation, of_mass: float, of_stiffness: float, *, across_free: bool
) -> Array:
    """Constants (3,) of damping: of the mass, and of the moduli lambda and mu."""
    lam, mu = material.lame
    if formulation in ("F-bar", "mixed"):  # rates of volume at every point would lock
        lam = 0.0
    if across_free:  # what is left of small strains without stress across
        lam = 2 * lam * mu / (lam + 2 * mu)
    return np.array([of_mass, of_stiffness * lam, of_stiffness * mu])
