"""Heat between a solid or a rigid body and the fluid that it is immersed in."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva import _core
from visviva.base.errors import InputError
from visviva.component.component import Component, settings
from visviva.component.momentum import NOWHERE
from visviva.component.values import FaceSet, Number
from visviva.flow.immersed import Immersed
from visviva.flow.immersed_body import ImmersedBody
from visviva.flow.immersed_thin import ImmersedThin
from visviva.flow.marks import shares
from visviva.model.entropies import SUPPLIED
from visviva.thermal.carrier import HeatCarrier
from visviva.thermal.fluid_heat import FluidHeat
from visviva.thermal.lumps import HeatStore

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(config=settings, eq=False, kw_only=True)
class ImmersedHeat(Component):
    """Heat that passes between the surface of what is immersed and the fluid around it, wherever it moves.

    Parameters
    ----------
    immersed : Immersed, ImmersedThin or ImmersedBody
        Of a solid, beam or shell that carries heat, or of a rigid body whose heat `store` holds.
    heat : FluidHeat
        Of the same fluid.
    conductance : float
        Heat per time, area and difference of temperatures: ``conductance (T_fluid - T_solid)`` flows into every node of
        the surface, with its share of the area in the reference, out of the fluid where the node is. What is thin takes
        its mean temperature, and the conductance of all its sides together: per area of a shell's middle, per length of
        a beam.
    faces : str or Faces
        Which part of the surface of a solid.
    store : HeatStore, optional
        Of a rigid body; every mark of its surface conducts with the area that is nearest to it.

    Notes
    -----
    What leaves the fluid enters the solid, exactly. The fluid that a solid displaces is there as far as its heat is
    concerned: it stores and conducts beside the solid. See :doc:`/theory/heat`.

    Examples
    --------
    >>> import visviva as vv
    >>> water = vv.Fluid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(4, 4, 4)), density=1.0, viscosity=1.0)
    >>> heat = vv.FluidHeat(fluid=water, conductivity=0.1, capacity=1.0, temperature=300.0)
    >>> mesh = vv.BoxMesh(size=(0.3, 0.3, 0.3), counts=(2, 2, 2), origin=(0.35, 0.35, 0.35))
    >>> warm = vv.Heat(conductivity=1.0, capacity=2.0, reference=300.0)
    >>> rubber = vv.NeoHooke(young=10.0, poisson=0.3)
    >>> ball = vv.ThermoelasticSolid(mesh=mesh, material=rubber, density=1.0, heat=warm, temperature=400.0)
    >>> immersed = vv.Immersed(solid=ball, fluid=water)
    >>> cooling = vv.ImmersedHeat(immersed=immersed, heat=heat, conductance=2.0)
    >>> system = vv.System([water, vv.NoSlip(fluid=water, faces="all"), heat, ball, immersed, cooling])
    >>> result = vv.simulate(system, until=0.2, step=0.05)
    >>> bool(310 < ball.temperatures(system.x).mean() < 340)
    True
    """

    outside_axes = NOWHERE

    immersed: Immersed | ImmersedThin | ImmersedBody
    heat: FluidHeat
    conductance: Number
    faces: FaceSet = "all"
    store: HeatStore | None = None

    contributes_last: ClassVar[int] = 2  # after what is immersed

    def __post_init__(self) -> None:
        if not self.conductance > 0:
            raise InputError(f"{self.label}: conductance = {self.conductance:g} is not positive")
        if self.heat.fluid is not self.immersed.fluid:
            raise InputError(
                f"{self.label}: {self.heat.label} is that of {self.heat.fluid.label}, and {self.immersed.label} lies "
                f"in {self.immersed.fluid.label}"
            )
        if isinstance(self.immersed, ImmersedBody):
            self._refuse_body(self.immersed)
        else:
            self._areas = self._areas_of(self.immersed)

    def _refuse_body(self, immersed: ImmersedBody) -> None:
        if self.store is None:
            raise InputError(
                f"{self.label}: {immersed.body.label} is rigid and carries no heat; give store, a vv.HeatStore"
            )
        if not isinstance(self.faces, str) or self.faces != "all":
            raise InputError(f"{self.label}: heat passes the whole surface of a rigid body; leave out faces")

    def _areas_of(self, immersed: Immersed | ImmersedThin) -> Array:
        """Areas (n,) of the chosen faces by nodes of the solid, of what is thin of its middle, or lengths."""
        solid = immersed.carried
        if self.store is not None:
            raise InputError(f"{self.label}: store is for rigid bodies; {solid.label} carries heat itself")
        if not isinstance(solid, HeatCarrier):
            raise InputError(f"{self.label}: {solid.label} carries no heat; make it a {self._kind(immersed)}")
        if isinstance(immersed, ImmersedThin):
            if self.faces != "all":
                raise InputError(
                    f"{self.label}: heat passes all sides of {solid.label} at once; leave out faces"
                )
            return immersed.shares()
        try:
            chosen = solid.faces(self.faces)
        except InputError as error:
            raise InputError(f"{self.label}: {error}") from None
        areas = np.zeros(solid.grid.n_nodes)
        for p in solid.face_points(chosen):
            np.add.at(areas, p.nodes, p.size @ (p.N**2 / np.sum(p.N**2, axis=1)[:, None]))
        return areas

    @staticmethod
    def _kind(immersed: Immersed | ImmersedThin) -> str:
        return (
            "vv.ThermoelasticSolid" if isinstance(immersed, Immersed) else "vv.ThermalShell or vv.ThermalBeam"
        )

    def _sides(self) -> tuple[Ints, Ints, Array, bool]:
        """Unknowns (n,) that balance and that tell temperatures, areas (n,), whether entropy is balanced."""
        if isinstance(self.immersed, ImmersedBody):
            assert self.store is not None
            plane = self.immersed.fluid.dimension == 2
            n, marks = len(self.immersed.marks), self.immersed.marks
            areas = shares(self.immersed.shape, marks, self.immersed.distance, plane=plane)
            return np.full(n, self.store.entropy.start), np.full(n, self.store.algorithmic.start), areas, True
        solid: Any = self.immersed.carried
        nodes = self.immersed.followers
        balance, temperature = solid.balance_unknowns(nodes), solid.temperature_unknowns(nodes)
        return balance, temperature, self._areas[nodes], solid.balances_entropy

    def contribute(self, model: Model) -> None:
        model.index(self.immersed), model.index(self.heat)
        balance, temperature, areas, balances_entropy = self._sides()
        self.term = _core.ImmersedHeat(
            self.immersed.term,
            np.ascontiguousarray(balance, dtype=np.int32),
            np.ascontiguousarray(temperature, dtype=np.int32),
            np.ascontiguousarray(self.conductance * areas),
            balances_entropy,
            self.heat.fluid.flow.start,
            self.heat.heat.start,
            self.heat.dimension,
        )
        self.term.name = self.label
        if balances_entropy:
            self.term.entropy_account = model.account(self, "fluid", SUPPLIED)
        model.batch(self.term)
