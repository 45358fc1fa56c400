"""Formulations of solids against locking: what their elements have beside nodes; see docs/theory/solids.rst."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.body.element import Geometry, geometry
from visviva.body.solid_fields import linear
from visviva.mesh.cells import CELLS
from visviva.mesh.quadrature import Rule, mass_rule, stiffness_rule

if TYPE_CHECKING:
    from visviva.material.material import Material
    from visviva.mesh.mesh import Mesh

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

Formulation = Literal["displacement", "F-bar", "enhanced", "mixed"]

CONSTANT = ("quad4", "hex8")
"""Cells with one pressure, which may alternate between neighbours in the incompressible limit."""
LINEAR = ("quad9", "hex20", "hex27")
"""Cells with a linear pressure of their own."""
CONTINUOUS = ("tri3", "tri6", "tet4", "tet10", "wedge6")
"""Cells with a continuous pressure, linear between the corners. One constant in each wedge6 would lock: its triangles
keep their area one by one then."""
STABILISED = ("tri3", "tet4", "wedge6")
"""Cells whose pressure is kept from oscillating."""
STIFFEST = 1e6
"""Pressures of materials whose bulk modulus exceeds this multiple of the shear modulus stay among the equations:
without them these would lose as many digits."""
BRICKS = ("quad4", "hex8")

SUITED = {"F-bar": BRICKS, "enhanced": BRICKS, "mixed": (*CONSTANT, *LINEAR, *CONTINUOUS)}


def check(
    label: str, kind: Formulation, grid: Mesh, material: Material, *, stress_free_across: bool, heated: bool
) -> None:
    """Refuse combinations of formulation, cells, plane and material that do not go together."""
    if kind != "mixed" and not np.isfinite(material.lame[0]):
        raise InputError(
            f"{label}: its material is incompressible, which elements of displacements alone cannot carry; use "
            "formulation='mixed'"
        )
    if kind == "displacement":
        return
    for cell in grid.cells:
        if cell not in SUITED[kind]:
            fit = [name for name, cells in SUITED.items() if cell in cells] or ["displacement"]
            raise InputError(
                f"{label}: formulation={kind!r} is for the cells {', '.join(SUITED[kind])}, and its mesh has {cell}; "
                f"for those take formulation={fit[0]!r}, or convert the mesh"
            )
    if stress_free_across and kind != "enhanced":
        raise InputError(
            f"{label}: in plane stress the thickness adapts and no volume locks; take formulation='displacement' or "
            f"'enhanced' instead of {kind!r}"
        )
    if kind == "mixed" and heated:
        raise InputError(
            f"{label}: formulation={kind!r} does not know thermal_strain; take formulation='F-bar' or 'enhanced', "
            "or 'displacement' with cells of second order"
        )
    if kind == "mixed":
        _check_pressures(label, grid, material)


def _check_pressures(label: str, grid: Mesh, material: Material) -> None:
    """Refuse materials whose change of volume the pressures of the cells cannot carry."""
    bulk = material.split().bulk
    if bulk <= 0:
        raise InputError(
            f"{label}: the modulus of its material's volumetric energy is {bulk:g}, which a pressure cannot "
            "stand for; nothing locks either: take formulation='displacement' or 'enhanced'"
        )
    constant = [cell for cell in grid.cells if cell in CONSTANT]
    if constant and not np.isfinite(bulk):
        better = "quad9" if grid.dimension == 2 else "hex27"
        raise InputError(
            f"{label}: its material is incompressible, and the constant pressures of {', '.join(constant)} may "
            f"then alternate without resistance; make the mesh with cell={better!r}, or take a Poisson's ratio below "
            "0.5, 0.4999 say"
        )


# --- F-bar --------------------------------------------------------------------------------------------------
def scaled(energy: Callable[[Any], Any], directions: int) -> Callable[[Any], Any]:
    """The energy of ``Cbar = (det C0 / det C)^(1/3) C`` as a function (12, n) of C and of C0 at the centre.

    With two `directions` the part in the plane is scaled alone.
    """

    def determinant(C: Any) -> Any:
        plane = C[0] * C[1] - C[3] ** 2
        if directions == 2:
            return plane
        return C[2] * plane + 2 * C[3] * C[4] * C[5] - C[0] * C[4] ** 2 - C[1] * C[5] ** 2

    def of_both(C: Any) -> Any:
        factor = (determinant(C[6:]) / determinant(C[:6])) ** (1 / directions)
        rows = range(6) if directions == 3 else (0, 1, 3)
        return energy(np.stack([factor * C[k] if k in rows else C[k] for k in range(6)]))

    return of_both


def centre(points: Array, nodes: Ints, cell: str, *, axisymmetric: bool) -> Geometry:
    """Gradients at the centres of the elements."""
    middle = CELLS[cell].nodes.mean(axis=0, keepdims=True)
    return geometry(points, nodes, cell, rule=Rule(middle, np.ones(1)), axisymmetric=axisymmetric)


# --- enhanced strains ---------------------------------------------------------------------------------------
def enhanced(points: Array, nodes: Ints, cell: str, g: Geometry) -> Geometry:
    """Geometry with the gradients of d more 'nodes', the enhanced modes ``M_k = (j0 / j) xi_k J0^-T e_k``.

    Their unknowns `alpha_k` (d,) add ``sum alpha_k x M_k`` to F; the modes are orthogonal to constant stresses, so
    patches pass (Simo & Rifai 1990, Simo & Armero 1992).
    """
    xi, w = stiffness_rule(cell).points, stiffness_rule(cell).weights
    middle = CELLS[cell].nodes.mean(axis=0)
    d = len(middle)
    J0 = np.einsum("eai,aj->eij", points[nodes], CELLS[cell].dN(middle[None])[0])
    ratio = g.volume.sum(axis=1, keepdims=True) / w.sum() * w / g.volume
    modes = np.einsum("eq,qk,ekj->eqkj", ratio, xi - middle, np.linalg.inv(J0))
    hoop = None if g.hoop is None else np.pad(g.hoop, ((0, 0), (0, 0), (0, d)))
    return Geometry(np.ascontiguousarray(np.concatenate([g.gradients, modes], axis=2)), g.volume, hoop)


def without_mass(mass: Array, k: int, more: int) -> Array:
    """Packed mass matrices of k nodes for `more` further ones that have none."""
    a, b = np.triu_indices(k)
    wide: Array = np.zeros((len(mass), (k + more) * (k + more + 1) // 2))
    wide[:, a * (k + more) - a * (a - 1) // 2 + b - a] = mass
    return wide


# --- pressures ----------------------------------------------------------------------------------------------
def pressure_numbers(grid: Mesh, shared: Ints) -> tuple[Mapping[str, Ints], Ints]:
    """Numbers (m, p) of the pressures of each cell type's elements, and the element (n,) that alone has it or -1.

    Nodes of one number `shared` (n_nodes,) have one continuous pressure.
    """
    d, numbers, n, own = grid.dimension, {}, 0, [np.zeros(0, dtype=np.int64)]
    corners = [
        shared[nodes[:, : CELLS[cell].n_corners]] for cell, nodes in grid.cells.items() if cell in CONTINUOUS
    ]
    place = np.full(grid.n_nodes, -1)
    if corners:
        used = np.unique(np.concatenate([c.ravel() for c in corners]))
        n = len(used)
        place[used] = np.arange(n)
        own.append(np.full(n, -1))
    for cell, nodes in grid.cells.items():
        if cell in CONTINUOUS:
            numbers[cell] = place[shared[nodes[:, : CELLS[cell].n_corners]]]
        else:
            p = 1 if cell in CONSTANT else d + 1
            numbers[cell] = n + np.arange(len(nodes) * p).reshape(-1, p)
            own.append(n + np.repeat(np.arange(len(nodes)), p))
            n += numbers[cell].size
    return numbers, np.concatenate(own)


def pressure_shapes(grid: Mesh, cell: str, nodes: Ints, xi: Array) -> Array:
    """Shape functions (m, q, p) of the pressure at reference points: of the corners, or 1, x, y (, z)."""
    if cell in CONSTANT:
        return np.ones((len(nodes), len(xi), 1))
    if cell in CONTINUOUS:
        N = linear(CELLS[cell]).N(xi)
        return np.broadcast_to(N, (len(nodes), *N.shape)).copy()
    X = grid.points[nodes]
    middle = X.mean(axis=1, keepdims=True)
    size = np.abs(X - middle).max(axis=(1, 2), keepdims=True)
    linear_part = (CELLS[cell].N(xi) @ X - middle) / size
    return np.ascontiguousarray(np.concatenate([np.ones((*linear_part.shape[:2], 1)), linear_part], axis=2))


def pressure_compliance(
    grid: Mesh,
    cell: str,
    nodes: Ints,
    *,
    bulk: float,
    shear: float,
    thickness: float = 1.0,
    axisymmetric: bool = False,
) -> Array:
    """``1 / bulk`` times the pressures' Gram matrices (m, p, p), and what stabilises cells of equal order.

    That is the distance of the pressure from its mean over the element, over the shear modulus (Dohrmann & Bochev
    2004).
    """
    rule = mass_rule(cell)
    w = geometry(grid.points, nodes, cell, rule=rule, thickness=thickness, axisymmetric=axisymmetric).volume
    N = pressure_shapes(grid, cell, nodes, rule.points)
    gram: Array = np.einsum("eq,eqk,eql->ekl", w, N, N)
    total: Array = gram / bulk
    if cell in STABILISED:
        mean = np.einsum("eq,eqk->ek", w, N)
        spread = gram - mean[:, :, None] * mean[:, None, :] / w.sum(axis=1)[:, None, None]
        total = total + spread / shear
    return np.ascontiguousarray(total)
