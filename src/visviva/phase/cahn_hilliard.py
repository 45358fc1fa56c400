"""Mixtures that separate by diffusion (Cahn & Hilliard)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.body.space import Table
from visviva.body.spline_space import SplineSpace
from visviva.component.component import settings
from visviva.component.values import Matrix, Number, NumberAtPlace, Pairs
from visviva.mesh.generate import MeshSource
from visviva.mesh.mesh import Mesh
from visviva.mesh.spline import SplineBox, SplineSource
from visviva.model.field import Role
from visviva.model.points import PhysicsKind, add_points
from visviva.phase.free_energy import FreeEnergy, UserFreeEnergy
from visviva.phase.mobility import Mobility, mobility_of
from visviva.phase.phase_body import PhaseBody, stride

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]


@dataclass(config=settings, eq=False, kw_only=True)
class CahnHilliard(PhaseBody):
    """A mixture that separates by diffusion: ``c' = div(M grad mu)``, ``mu = f'(c) - div(K grad c)``.

    Concentration and chemical potential are fields of the same finite elements, of any type and order, in space, in a
    plane, or on a surface in space.

    Parameters
    ----------
    mesh : Mesh, or a generator or file that gives one, or a patch of splines
    free_energy : FreeEnergy
        ``f(c)`` per volume.
    gradient_energy : float, or array (3,) or (3, 3)
        ``K`` of ``grad c . K grad c / 2`` per volume; isotropic, along the axes, or a symmetric tensor.
    concentration : float, expression in x, y, z, or function of positions (n, 3) with values (n,)
        At the start.
    mobility : float or Mobility
        ``M(c)``.
    periodic : sequence of (str, str)
        Pairs of sets of faces, of equal meshes, that are taken for the same. Other faces let nothing through.
    thickness : float
        Of a plane mesh.
    form : {'mixed', 'direct'}
        'direct' has no potential, and needs splines with continuous first derivatives (Gomez et al. 2008).

    Notes
    -----
    The potential that moves the mixture in a step is the discrete gradient of the energy: with the energy-momentum
    scheme, the energy falls in every step, of any length, by exactly what diffusion dissipates, and the integral of the
    concentration is kept to rounding. The ledger books the energy as "stored".

    The direct form tests ``c' - div(M grad(f' - kappa laplace c))`` with functions that do not hold the potential, so
    that it keeps the mass and the order, and measures the energy, but makes no promise about it (Gomez & Hughes 2011):
    what it dissipates is in no account of the ledger, as the audit says.
    At the sides of a `SplineBox` that are not periodic, the concentration has no slope across them.

    Examples
    --------
    >>> import visviva as vv
    >>> import numpy as np
    >>> alloy = vv.CahnHilliard(
    ...     mesh=vv.RectangleMesh(size=(16, 16), counts=(16, 16)),
    ...     free_energy=vv.DoubleWell(barrier=5.0, low=0.3, high=0.7),
    ...     gradient_energy=2.0,
    ...     mobility=5.0,
    ...     concentration=lambda X: 0.5 + 0.01 * np.cos(0.4 * X[:, 0]),
    ... )
    >>> result = vv.simulate(vv.System([alloy]), until=2.0, step=0.5)
    >>> energy = result.ledger["potential_stored"]
    >>> bool(np.all(np.diff(energy) < 0)), result.conservation()["energy"] < 1e-10
    (True, True)
    """

    mesh: Mesh | MeshSource | SplineSource
    free_energy: FreeEnergy
    gradient_energy: Number | Matrix
    concentration: NumberAtPlace
    mobility: Number | Mobility = 1.0
    periodic: Pairs = ()
    thickness: Number = 1.0
    form: Literal["mixed", "direct"] = "mixed"
    quantity = "concentration"

    def __post_init__(self) -> None:
        self._mobility = mobility_of(self.label, self.mobility)
        self.level_at_sides = self.form == "direct"
        self._prepare(self.concentration)
        if self.form == "direct":
            self._refuse_rough()

    def _refuse_rough(self) -> None:
        if not isinstance(self.space, SplineSpace) or self.space.smoothness < 1:
            raise InputError(
                f"{self.label}: form = 'direct' needs splines whose first derivatives are continuous, such as "
                "vv.SplineBox(degree=2); take form = 'mixed' on others"
            )
        if np.ptp(self._tensor[:3]) or np.any(self._tensor[3:]):
            raise InputError(
                f"{self.label}: form = 'direct' needs an isotropic gradient_energy; take 'mixed'"
            )
        if not isinstance(self.mesh, SplineBox) and len(self.periodic) < self.space.grid.dimension:
            raise InputError(
                f"{self.label}: form = 'direct' knows sides without flux of vv.SplineBox alone; take form = 'mixed'"
            )
        if isinstance(self.free_energy, UserFreeEnergy):
            raise InputError(
                f"{self.label}: form = 'direct' needs an energy of the core, such as PolynomialEnergy"
            )

    def declare(self, model: Model) -> None:
        self.phase = self.field_in(model, self)
        if self.form == "mixed":
            self.potential = model.field(self, "potential", 0 * self.phase.values, role=Role.POTENTIAL)
            self.potential.beside = self.phase

    def contribute(self, model: Model) -> None:
        energy = self._user_energy()
        for table in self.space.cells():
            kind, weights = PhysicsKind.MIXTURE, table.columns()
            if self.potential is None:
                kind, weights = PhysicsKind.SMOOTH_MIXTURE, table.smooth_columns()
            groups = [self.group(f, table, weights) for f in (self.phase, self.potential) if f is not None]
            term = add_points(model, self, kind, groups, table.size, self.constants(), energy=energy)
            term.limit(0, stride(self))
            self.drive(model, self, term)

    @property
    def unbooked(self) -> str:
        """Why the ledger lacks some of what its energy changes by; empty if it does not."""
        return (
            "has form = 'direct', whose ledger lacks what diffusion dissipates"
            if self.form == "direct"
            else ""
        )

    def potential_at(self, table: Table, c: Array, time: float) -> Array:
        """Potentials (m, q) of the direct form at points of elements with coefficients `c` (m, k)."""
        value, *_, laplacian = np.moveaxis(np.einsum("mqka,mk->mqa", table.smooth_columns(), c), -1, 0)
        return np.asarray(self.free_energy.at(time).slopes(value) - self._tensor[0] * laplacian)

    def widths(self) -> Mapping[str, int]:
        return {"concentration": 1, "potential": 1} if self.form == "mixed" else {"concentration": 1}

    def _shown(self, name: str, x: Array) -> Array:
        return self.potentials(x) if name == "potential" else self.values(x)

    def potentials(self, x: Array) -> Array:
        """Chemical potentials (n,) at the nodes: under conserving schemes means over the last step of `x`."""
        if self.potential is None:
            raise InputError(f"{self.label}: form = 'direct' has no potentials")
        return self.space.at_nodes(self.coefficients(self.potential, x))
