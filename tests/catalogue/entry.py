"""What a line of the catalogue is, and names for what runs of it conserve."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import visviva as vv
from visviva.component.component import Component
from visviva.system.check import fit

Components = list[Component]

NOTHING: frozenset[str] = frozenset()
ENERGY = frozenset({"energy"})
LINEAR = frozenset({"momentum_x", "momentum_y", "momentum_z"})
ANGULAR = frozenset({"angular_x", "angular_y", "angular_z"})
MOMENTA = LINEAR | ANGULAR
ALL = ENERGY | MOMENTA
AXIAL = frozenset({"angular_z"})
FALLING = ENERGY | {"momentum_x", "momentum_y", "angular_z"}
PLANE_MOMENTA = frozenset({"momentum_x", "momentum_y", "angular_z"})
IN_PLANE = ENERGY | PLANE_MOMENTA


@dataclass(frozen=True)
class Entry:
    """A line of the catalogue.

    Attributes
    ----------
    h : float
        A coarse step for it.
    steps : int
        How many of them the conservation test takes.
    analytic : bool
        Whether its tangents are free of differences.
    balances : bool
        Whether the ledger has all that its energy changes by; history fields of cracks leave something out.
    """

    name: str
    build: Callable[[], Components]
    conserves: frozenset[str]
    h: float = 0.02
    steps: int = 300
    analytic: bool = True
    balances: bool = True

    def system(self, **options: Any) -> vv.System:
        """A fresh system, its initial state moved onto the constraints."""
        system = vv.System(self.build(), vv.Newton(**options))
        system.report = fit(system, project=True)
        return system
