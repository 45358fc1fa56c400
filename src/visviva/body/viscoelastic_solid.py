"""Solids whose stress relaxes: Maxwell branches beside their material."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.body.solid import Solid
from visviva.body.solid_term import Elements
from visviva.component.component import settings
from visviva.material.branch import MaxwellBranch
from visviva.model.points import Group, PhysicsKind, add_points

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
BRANCH = (PhysicsKind.BRANCH, PhysicsKind.BRANCH_IN_PLANE, PhysicsKind.BRANCH_OF_REVOLUTION)


class Branched:
    """Base of solids with Maxwell branches."""

    label: str

    def nodal_forces(self, x: Array, cells: NDArray[np.bool_] | None = None) -> Array:
        """Refused: the forces of branches depend on more than `x`.

        Raises
        ------
        InputError
        """
        raise InputError(
            f"{self.label}: the forces of its branches do not follow from a state alone, and sections have none; "
            "vv.SupportForce tells what supports carry"
        )


@dataclass(config=settings, eq=False, kw_only=True)
class ViscoelasticSolid(Branched, Solid):
    """A solid of a generalised Maxwell material in finite strains.

    Takes the arguments of `Solid`, whose material is that of long times, and

    Parameters
    ----------
    branches : sequence of MaxwellBranch
        Springs behind dashpots beside the material; `prony` makes them of a series.

    Notes
    -----
    Every branch has a viscous strain of its own at every quadrature point. The same discrete gradient that gives the
    stress drives the dashpots, so that with the energy-momentum scheme what they dissipate, a quadratic form of that
    force, is exactly what the energy loses; the ledger has it as "dissipated", the energy of the springs as "stored".
    Branches see the strains of displacements: they have no volumetric stress, so that 'F-bar' and 'mixed' go with them.
    Fields of stress are those of the material alone, without the branches. Creep and relaxation are of
    second order in the step, but for `BackwardEuler`. Branches that relax in a hundredth of a step ring under
    `EnergyMomentum` and `Midpoint`: take `BDF2` or `GeneralizedAlpha` there.

    Examples
    --------
    >>> import visviva as vv
    >>> rubber = vv.NeoHooke(shear=1.0, bulk=100.0)
    >>> block = vv.ViscoelasticSolid(
    ...     mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)),
    ...     material=rubber,
    ...     density=1.0,
    ...     branches=vv.prony((0.5,), (0.1,)),
    ... )
    >>> vv.System([block]).n_coordinates
    24
    """

    branches: Sequence[MaxwellBranch]

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.branches:
            raise InputError(f"{self.label}: branches is empty; give vv.MaxwellBranch(...), or take vv.Solid")
        if self.formulation == "enhanced" or self.plane == "stress":
            what = "formulation = 'enhanced'" if self.formulation == "enhanced" else "plane = 'stress'"
            raise InputError(f"{self.label}: {what} has strains that branches do not see; take another one")
        if self._is_heated:
            raise InputError(f"{self.label}: takes no thermal_strain")
        if any(branch.shift for branch in self.branches):
            raise InputError(
                f"{self.label}: has no temperature by which the times of its branches could shift; take "
                "vv.ThermoviscoelasticSolid"
            )
        self._constants = [branch.parameters(self.label, self.body_material) for branch in self.branches]

    def _elements_of(self, model: Model, cell: str, nodes: Ints, first: int, some: Ints) -> Elements:
        made = super()._elements_of(model, cell, nodes, first, some)
        g = self._geometry(cell, nodes)
        group = Group(self.node_unknowns(nodes), g.columns, None, True)
        for constants in self._constants:
            add_points(model, self, g.chosen(BRANCH), [group], g.volume, constants)
        return made
