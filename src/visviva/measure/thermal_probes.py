"""Probes of temperatures."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.component.component import settings
from visviva.component.values import Vector3
from visviva.measure.measures import Reading
from visviva.mesh.locate import locate
from visviva.thermal.carrier import HeatCarrier

if TYPE_CHECKING:
    from visviva.system.system import System

Array = NDArray[np.float64]


@dataclass(config=settings, frozen=True, kw_only=True)
class TemperatureAt(Reading):
    """Probe: temperature at a place of a body.

    Parameters
    ----------
    body : ThermalBody or ThermoelasticSolid
    at : array (3,)
        Reference position.
    """

    body: HeatCarrier
    at: Vector3 = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        _ = self._place

    @cached_property
    def _place(self) -> tuple[Any, Array]:
        return locate(self.body.grid, self.at[: self.body.dimension], self.body.label)

    def __call__(self, system: System) -> Any:
        nodes, weights = self._place
        return weights @ self.body.temperatures(system.x)[nodes]
