"""Probes of cracks."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.component.component import settings
from visviva.component.values import Number, Vector3
from visviva.measure.measures import Reading
from visviva.phase.fracturing_solid import FracturingSolid

if TYPE_CHECKING:
    from visviva.system.system import System

Array = NDArray[np.float64]


@dataclass(config=settings, frozen=True, kw_only=True)
class CrackEnergy(Reading):
    """Probe: energy that the cracks of a body hold, whatever its mesh adds to it.

    Parameters
    ----------
    solid : FracturingSolid
    """

    solid: FracturingSolid

    @property
    def quantity(self) -> str:
        return "energy"

    def __call__(self, system: System) -> float:
        return self.solid.crack_energy(system.x)


@dataclass(config=settings, frozen=True, kw_only=True)
class CrackArea(Reading):
    """Probe: area of the cracks of a body, in the plane their length times the thickness.

    Their energy by the toughness: damage ahead of a crack counts, and cells of size h make it larger, by the share
    ``h / 2 l`` with AT2 and ``3 h / 8 l`` with AT1, and up to twice that where two rows of cells are damaged through,
    as straight on from a slit of `Mesh.opened`.

    Parameters
    ----------
    solid : FracturingSolid
    """

    solid: FracturingSolid

    @property
    def quantity(self) -> str:
        return "area"

    def __call__(self, system: System) -> float:
        return self.solid.crack_energy(system.x) / self.solid.toughness


@dataclass(config=settings, frozen=True, kw_only=True)
class CrackTip(Reading):
    """Probe: reference position (3,) of what is cracked farthest along a direction.

    Parameters
    ----------
    solid : FracturingSolid
    along : array (3,)
    level : float
        Damage from which on a place is cracked; between nodes the level is found along edges of cells.
    """

    solid: FracturingSolid
    along: Vector3
    level: Number = 0.9

    def __post_init__(self) -> None:
        if not np.any(self.along):
            raise InputError("CrackTip: along = (0, 0, 0) is no direction")
        if not 0 < self.level < 1:
            raise InputError(f"CrackTip: level = {self.level:g} is not between 0 and 1")

    @property
    def quantity(self) -> str:
        return "length"

    def __call__(self, system: System) -> Array:
        d, X = self.solid.damages(system.x), self.solid.points
        if not np.any(d >= self.level):
            return np.full(3, np.nan)
        a, b = self._edges.T
        crossing = (d[a] >= self.level) != (d[b] >= self.level)
        a, b = a[crossing], b[crossing]
        share = ((self.level - d[a]) / (d[b] - d[a]))[:, None]
        places = np.concatenate([X[d >= self.level], (1 - share) * X[a] + share * X[b]])
        along = np.asarray(self.along) / np.abs(self.along).max()
        reach = places @ (along / np.linalg.norm(along))
        tip: Array = places[reach >= reach.max() - 1e-9 * np.ptp(X)].mean(axis=0)
        return tip

    @property
    def _edges(self) -> NDArray[np.int64]:
        """Pairs (n, 2) of nodes of one cell."""
        pairs = []
        for rows in self.solid.grid.cells.values():
            a, b = np.triu_indices(rows.shape[1], 1)
            pairs.append(np.stack([rows[:, a].ravel(), rows[:, b].ravel()], axis=1))
        return np.concatenate(pairs)
