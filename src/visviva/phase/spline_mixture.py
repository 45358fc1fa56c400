"""Solids on splines whose phases separate."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.body.on_splines import OnSplines
from visviva.body.stressed_cells import StressedCells
from visviva.component.component import settings
from visviva.mesh.spline import SplineSource
from visviva.phase.mixture_solid import MixtureSolid

Array = NDArray[np.float64]


@dataclass(config=settings, eq=False, kw_only=True)
class SplineMixtureSolid(OnSplines, MixtureSolid):
    """A solid whose phases separate by diffusion, on splines: positions, concentration and potential are as smooth.

    Takes the arguments of `MixtureSolid`, periodic sides being those of a `SplineBox`, and

    Parameters
    ----------
    mesh : SplineBox, SplinePatch or SplinePatches
        What holds it, loads it and touches it as `SplineSolid` says.

    Examples
    --------
    >>> import visviva as vv
    >>> import numpy as np
    >>> alloy = vv.SplineMixtureSolid(
    ...     mesh=vv.SplineBox(size=(8, 8), counts=(6, 6), degree=2),
    ...     material=vv.SaintVenantKirchhoff(young=100.0, poisson=0.3),
    ...     density=1.0,
    ...     free_energy=vv.DoubleWell(barrier=5.0, low=0.3, high=0.7),
    ...     gradient_energy=2.0,
    ...     mobility=5.0,
    ...     concentration=lambda X: 0.5 + 0.05 * np.cos(0.8 * X[:, 0]),
    ...     eigenstrain=0.05,
    ...     reference=0.5,
    ... )
    >>> result = vv.simulate(vv.System([alloy]), until=0.5, step=0.05)
    >>> result.conservation()["energy"] < 1e-10
    True
    """

    mesh: SplineSource  # type: ignore[assignment]

    def _given_mesh(self) -> Any:
        return self.mesh

    def _parts(self) -> Iterator[tuple[str, StressedCells, StressedCells, Array | None]]:
        (cell,), d = self.grid.cells, self.dimension
        for t, mixture in zip(self._tables, self.space.cells(), strict=True):
            gradients = np.ascontiguousarray(t.gradients[..., :d])
            mixed = lambda x, of, t=mixture: t.at(self.coefficients(x))  # noqa: E731
            at = self._stressed_cells(t.numbers, gradients, t.size, t.N, mixed)
            yield cell, at, at, self._packed_masses(t) if self.density > 0 else None

    def _exerted(self, x: Array) -> Iterator[tuple[Any, Array]]:
        return ((part.nodes, part.forces(x)) for part in self._evaluations)
