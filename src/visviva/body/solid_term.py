"""A solid as the core takes it: the term of its elements of one type, with what their formulation adds."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.body import formulation as forms
from visviva.body.element import geometry, solid_rule
from visviva.model.callback import AcrossFree, Function

if TYPE_CHECKING:
    from visviva.body.solid import Solid
    from visviva.model.model import Model

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


def solid_term(solid: Solid, model: Model, cell: str, nodes: Ints, first: int) -> tuple[Any, Array]:
    """The term of cells with their nodes (m, k), numbered from `first`, and the volumes (m, q) of its points."""
    points, d = solid.grid.points, solid.dimension
    g = geometry(points, nodes, cell, thickness=solid.thickness, axisymmetric=solid.axisymmetric)
    damped = solid.mass_damping > 0 or solid.stiffness_damping > 0
    index, parameters = solid.node_unknowns(nodes), solid.material.parameters(len(nodes))
    kind = solid.material.kind
    mass = solid.cell_masses(cell, nodes) if solid.density > 0 else None
    if solid.formulation == "enhanced":
        modes = solid.inner.start + np.arange(first * d * d, (first + len(nodes)) * d * d, d)
        index = np.hstack([index, modes.reshape(len(nodes), d)])
        g = forms.enhanced(solid, cell, nodes, g)
        mass = None if mass is None else forms.without_mass(mass, nodes.shape[1], d)
    elif solid.formulation == "mixed":
        split = solid.material.split()
        kind, parameters = split.kind, np.tile(split.constants, (len(nodes), 1))
        index = np.hstack([index, solid.inner.start + solid.pressure_numbers[cell]])
    term = _core.SolidTerm(
        int(kind),
        solid.material.small,
        np.ascontiguousarray(index, dtype=np.int32),
        g.gradients,
        g.volume,
        parameters,
        g.hoop,
        mass,
        damping(solid, len(nodes)) if damped else None,
    )
    term.name = solid.label
    complete(term, solid, cell, nodes)
    kinetic = model.account(solid, "kinetic", "kinetic") if solid.density > 0 else -1
    dissipated = model.account(solid, "damping", "dissipation") if damped else -1
    strain = model.account(solid, "strain", "potential")
    term.book_solid(strain, kinetic, dissipated, model.index(solid), first)
    return term, g.volume


def complete(term: Any, solid: Solid, cell: str, nodes: Ints) -> None:
    """Tell the term what its solid has beside the strains of its cells."""
    term.set_plane_stress(solid.plane == "stress" and solid.callback is None)
    term.start_stress = solid.used_tangent == "start"
    if callable(solid.thermal_strain) or solid.thermal_strain:
        term.set_thermal(solid.thermal(cell, nodes))
    if solid.formulation == "F-bar":
        middle = forms.centre(solid, cell, nodes)
        hoop = None if middle.hoop is None else middle.hoop[:, 0]
        term.set_centre(middle.gradients[:, 0], hoop)
    elif solid.formulation == "mixed":
        split = solid.material.split()
        rule = solid_rule(solid.grid.points, nodes, cell)
        shapes = forms.pressure_shapes(solid.grid, cell, nodes, rule.points)
        compliance = forms.pressure_compliance(solid, cell, nodes, split.bulk)
        term.set_pressure(shapes, compliance, split.measure, solid.inner.multiplier)
    if solid.callback is not None:
        term.set_callback(solid.callback)


def own_energy(solid: Solid) -> Function | None:
    """The material's energy with its derivatives, if it is given in Python; one for all cells."""
    energy: Callable[[Any], Any] | None = solid.material.energy
    if solid.formulation == "mixed":
        energy = solid.material.split().energy
    if energy is None:
        return None
    n, kind = 6, AcrossFree if solid.plane == "stress" else Function
    if solid.formulation == "F-bar":
        plane = solid.dimension == 2 and not solid.axisymmetric
        energy, n = forms.scaled(energy, 2 if plane else 3), 12
    return kind(energy, n, 1, f"{solid.label}: energy of its material")


def damping(solid: Solid, n: int) -> Array:
    """Rayleigh's constants (n, 3): of the mass, and of the moduli lambda and mu."""
    lam, mu = solid.material.lame
    if solid.formulation in ("F-bar", "mixed"):  # rates of volume at every point would lock
        lam = 0.0
    if solid.plane == "stress":  # what is left of small strains without stress across
        lam = 2 * lam * mu / (lam + 2 * mu)
    constants = [solid.mass_damping, solid.stiffness_damping * lam, solid.stiffness_damping * mu]
    return np.tile(constants, (n, 1))
