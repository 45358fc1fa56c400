"""Probes of temperatures and of heat."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.component.component import settings
from visviva.component.remembered import remembered
from visviva.component.values import Nodes, Vector3
from visviva.measure.measures import Reading
from visviva.mesh.locate import locate
from visviva.thermal.carrier import HeatCarrier
from visviva.thermal.fluid_heat import FluidHeat
from visviva.thermal.thermal_body import ThermalBody

if TYPE_CHECKING:
    from visviva.system.system import System

Array = NDArray[np.float64]


@dataclass(config=settings, frozen=True, kw_only=True)
class TemperatureAt(Reading):
    """Probe: temperature at a place of a body.

    Parameters
    ----------
    body : ThermalBody, ThermoelasticSolid, ThermalShell, ThermalBeam or FluidHeat
    at : array (3,)
        Reference position; of shells and beams on the surface or line of their mesh: the mean across the section there.
    """

    body: HeatCarrier
    at: Vector3 = (0.0, 0.0, 0.0)

    def told_by_state(self, system: System) -> bool:
        return True

    @property
    def quantity(self) -> str:
        return "temperature"

    def __post_init__(self) -> None:
        _ = self._place

    @remembered("body")
    def _place(self) -> tuple[Any, Array]:
        return locate(self.body.grid, self.at[: self.body.dimension], self.body.label)

    def __call__(self, system: System) -> Any:
        nodes, weights = self._place
        return weights @ self.body.temperatures(system.x)[nodes]


@dataclass(config=settings, frozen=True, kw_only=True)
class HeatFlow(Reading):
    """Probe: heat per time that comes in at nodes whose temperature is held.

    It is the residual of the equations that held temperatures leave unanswered, which balances what is stored and all
    other heat to the tolerance of the solver; of the midpoint schemes, that in the middle of the last step. Where a
    fluid comes in it is what that brings as well, above the reference.

    Parameters
    ----------
    body : ThermalBody or FluidHeat
    nodes : str or int array
        Name of a set of nodes or faces, 'all', or numbers.
    """

    body: ThermalBody | FluidHeat
    nodes: Nodes

    def __post_init__(self) -> None:
        self.body.nodes(self.nodes)

    def __call__(self, system: System) -> float:
        unknowns = np.unique(self.body.temperature_unknowns(self.body.nodes(self.nodes)))
        held = self.body.heat.fixed[unknowns - self.body.heat.start]
        return float(np.sum(system.holding_forces()[unknowns[held]]))
