"""Order parameters that relax to where the energy is least (Allen & Cahn)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.component.component import settings
from visviva.component.values import Matrix, Number, NumberAtPlace, Pairs
from visviva.mesh.cells import CELLS
from visviva.mesh.generate import MeshSource
from visviva.mesh.mesh import Mesh
from visviva.mesh.spline import SplineSource
from visviva.model.field import Role
from visviva.model.points import Group, PhysicsKind, add_points
from visviva.phase.free_energy import FreeEnergy
from visviva.phase.mobility import Mobility, mobility_of
from visviva.phase.phase_body import PhaseBody, stride

if TYPE_CHECKING:
    from visviva.component.component import RateConstraints
    from visviva.model.model import Model
    from visviva.model.state import State

Array = NDArray[np.float64]
WEAK = 25
"""Widths of a radius that pulls at interfaces as little as what flat ones are to follow."""
FREE = 2.5, 4.0
"""Distances of nodes over the width with which they do, of cells of first and second order."""


@dataclass(config=settings, eq=False, kw_only=True)
class AllenCahn(PhaseBody):
    """An order parameter that relaxes: ``c' = -M (f'(c) - div(K grad c))``.

    Parameters
    ----------
    mesh : Mesh, or a generator or file that gives one, or a patch of splines
    free_energy : FreeEnergy
        ``f(c)`` per volume.
    gradient_energy : float, or array (3,) or (3, 3)
        ``K`` of ``grad c . K grad c / 2`` per volume.
    order : float, expression in x, y, z, or function of positions (n, 3) with values (n,)
        At the start.
    mobility : float or Mobility
        ``M``, which must not vanish.
    conserved : bool
        Whether a load, the same everywhere, keeps the integral of the order parameter.
    periodic : sequence of (str, str)
        Pairs of sets of faces that are taken for the same.
    thickness : float
        Of a plane mesh.

    Notes
    -----
    With the energy-momentum scheme the energy falls in every step by exactly what relaxation dissipates.

    Examples
    --------
    >>> import visviva as vv
    >>> import numpy as np
    >>> grains = vv.AllenCahn(
    ...     mesh=vv.RectangleMesh(size=(8, 2), counts=(32, 8)),
    ...     free_energy=vv.DoubleWell(barrier=0.25, low=-1.0),
    ...     gradient_energy=1.0,
    ...     order=lambda X: 0.1 * np.sin(X[:, 0]),
    ... )
    >>> result = vv.simulate(vv.System([grains]), until=2.0, step=0.1)
    >>> result.conservation()["energy"] < 1e-10
    True
    """

    mesh: Mesh | MeshSource | SplineSource
    free_energy: FreeEnergy
    gradient_energy: Number | Matrix
    order: NumberAtPlace
    mobility: Number | Mobility = 1.0
    conserved: bool = False
    periodic: Pairs = ()
    thickness: Number = 1.0
    quantity = "order"

    def __post_init__(self) -> None:
        self._mobility = mobility_of(self.label, self.mobility)
        self._prepare(self.order)
        still = np.flatnonzero(self._mobility.values(self.start_values) <= 0)
        if len(still):
            at = ", ".join(f"{x:.4g}" for x in self.points[still[0]])
            raise InputError(
                f"{self.label}: its mobility vanishes at the order {self.start_values[still[0]]:g} of the start, at "
                f"({at}): give one that does not"
            )

    def remarks(self) -> list[str]:
        remarks = super().remarks()
        if (found := self.interface()) is not None:
            remarks += held_back(f"{self.label}: its interfaces", self, *self._resolution(found))
        return remarks

    def declare(self, model: Model) -> None:
        self.phase = self.field_in(model, self)
        if self.conserved:
            self.load = model.field(self, "load", [0.0], role=Role.MULTIPLIER, instantaneous=False)

    def contribute(self, model: Model) -> None:
        kind = PhysicsKind.CONSERVED_ORDER if self.conserved else PhysicsKind.ORDER_PARAMETER
        energy = self._user_energy()
        for table in self.space.cells():
            groups = [self.group(self.phase, table, table.columns())]
            if self.conserved:
                one = np.ones((table.size.shape[1], 1, 1))
                groups.append(Group(np.full((len(table.numbers), 1), self.load.start), one))
            term = add_points(model, self, kind, groups, table.size, self.constants(), energy=energy)
            term.limit(0, stride(self))
            self.drive(model, self, term)

    def rate_constraints(self, state: State) -> RateConstraints | None:
        """Rates whose integral vanishes, where a load sees to that."""
        if not self.conserved:
            return None
        import scipy.sparse as sp

        integral = np.zeros((1, len(state.x)))
        for t in self.space.cells():
            weights = np.einsum("mqk,mq->mk", t.N, t.size)
            np.subtract.at(integral[0], self.phase.start + t.numbers, weights)
        return np.array([self.load.start]), sp.csr_array(integral), np.zeros(1)


def held_back(what: str, body: AllenCahn, width: float, spacing: float) -> list[str]:
    """A remark on few cells, which hold flat fronts back as ``benchmarks/front_speed.py`` prints."""
    wanted = FREE[any(CELLS[cell].n_nodes > CELLS[cell].n_corners for cell in body.grid.cells)]
    if width >= wanted * spacing * (1 - 1e-9):
        return []
    return [
        f"{what} are {width / spacing:.3g} distances of nodes wide; flat ones that are driven less than by a radius of "
        f"{WEAK} widths slow down, or stand still, along rows of these cells: take {wanted:g} distances or more"
    ]
