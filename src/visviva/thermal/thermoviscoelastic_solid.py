"""Solids whose stress relaxes and heats them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.body.solid_term import Elements
from visviva.body.viscoelastic_solid import Branched
from visviva.component.component import settings
from visviva.material.branch import MaxwellBranch
from visviva.mesh.cells import CELLS
from visviva.mesh.quadrature import mass_rule
from visviva.model.entropies import PRODUCED
from visviva.model.points import Group, PhysicsKind, add_points
from visviva.thermal.thermoelastic_solid import ThermoelasticSolid

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
BRANCH = (
    PhysicsKind.HEATED_BRANCH,
    PhysicsKind.HEATED_BRANCH_IN_PLANE,
    PhysicsKind.HEATED_BRANCH_OF_REVOLUTION,
)


@dataclass(config=settings, eq=False, kw_only=True)
class ThermoviscoelasticSolid(Branched, ThermoelasticSolid):
    """A solid of a generalised Maxwell material in finite strains that dissipation heats.

    Takes the arguments of `ThermoelasticSolid`, whose material is that of long times, and

    Parameters
    ----------
    branches : sequence of MaxwellBranch
        Springs behind dashpots beside the material; `prony` makes them of a series. Their times may shift with the
        temperature, their springs do not depend on it.

    Notes
    -----
    Every branch has a viscous strain of its own at every quadrature point. What its dashpots dissipate, a quadratic
    form of the discrete force that drives them, is heat that arises at the temperature of the step: the total energy
    of an isolated body is kept to round-off, and its entropy never falls. Fields of stress, and measures that read
    them, are those of the material alone, without the branches, as those of `ViscoelasticSolid`.

    Examples
    --------
    >>> import visviva as vv
    >>> heat = vv.Heat(conductivity=0.2, capacity=1.8e6)
    >>> branches = vv.prony((0.5,), (0.1,), shift=vv.WLF(reference=293.15))
    >>> block = vv.ThermoviscoelasticSolid(
    ...     mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)),
    ...     material=vv.NeoHooke(shear=1e6, bulk=1e8),
    ...     density=1000.0,
    ...     heat=heat,
    ...     branches=branches,
    ... )
    >>> vv.System([block]).n_coordinates
    32
    """

    branches: Sequence[MaxwellBranch]

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.branches:
            raise InputError(
                f"{self.label}: branches is empty; give vv.MaxwellBranch(...), or take vv.ThermoelasticSolid"
            )
        if self.plane == "stress":
            raise InputError(
                f"{self.label}: plane = 'stress' has strains that branches do not see; take another one"
            )
        self._constants = [
            branch.heated_parameters(self.label, self.body_material) for branch in self.branches
        ]

    def _made(self, model: Model, cell: str, nodes: Ints, first: int) -> Elements:
        made = super()._made(model, cell, nodes, first)
        rule = mass_rule(cell)
        g, N = self._geometry(cell, nodes, rule), CELLS[cell].N(rule.points)[:, :, None]
        groups = [
            Group(self._vectors(nodes, first), g.columns, None, True),
            Group(self.algorithmic.start + self._number[nodes], N),
            Group(self.entropy.start + self._number[nodes], N),
        ]
        for constants in self._constants:
            branch = add_points(model, self, g.chosen(BRANCH), groups, g.volume, constants)
            branch.entropy_account = model.account(self, "viscosity", PRODUCED)
        return made
