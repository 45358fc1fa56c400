"""Equilibrium paths of what cracks, by steps of the load and of the crack together, through snap-back."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from visviva.analysis.arc_length import ArcLength, Path
from visviva.analysis.load_steps import Equilibrium, NoEquilibrium
from visviva.base.arguments import bounded
from visviva.base.errors import InputError
from visviva.model.state import State

Array = NDArray[np.float64]


@dataclass(frozen=True)
class CrackControl(ArcLength):
    """Statics along the path of a growing crack, where the load may fall: dissipation control.

    A step goes on by so much of load and crack together, ``dt / step + growth of the crack / growth``: by the load as
    long as nothing cracks, by the crack where it runs. Cracks never shrink, so that this never turns back, whatever the
    load does (after Gutierrez 2004, whose measure is the energy that is dissipated).

    Parameters
    ----------
    growth : float
        Area of crack, in the plane times the thickness, that a step may grow by.

    Notes
    -----
    The area of a crack is taken to be the integral of ``d / (2 l)``, which counts damage ahead of cracks too. For
    `arc_length`, or `quasi_static`, which ends where the load has passed its end.
    """

    growth: float = 0.0
    longest: float = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.growth > 0:
            raise InputError(
                f"vv.CrackControl: growth = {self.growth:g} is not positive; give the area of crack that a step may "
                "grow by, such as that of a cell (in the plane its size times the thickness): growth=..."
            )
        bounded(self, growth=(1e-300, 1e300))
        if self.branch:
            raise InputError("vv.CrackControl: branch goes with vv.ArcLength alone")

    def path(self, equations: Equilibrium, unit: float) -> Path:
        return CrackPath(equations, unit, self.load_weight, self.growth)

    def refuse(self, state: State) -> None:
        super().refuse(state)
        if not state.model.growing:
            raise InputError(
                "vv.CrackControl: nothing here has damage; take vv.ArcLength() for a system without "
                "vv.FracturingSolid"
            )


@dataclass
class CrackPath(Path):
    """The extended system of a step by load and crack: equilibrium and a linear measure."""

    growth: float
    sizes: Array = field(init=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        self.sizes = np.zeros(len(self.equations.dx))
        for growing in self.equations.system.model.growing:
            self.sizes[growing.field.unknowns] = growing.sizes / self.growth

    def length(self, dx: Array, dt: float) -> float:
        return float(self.sizes @ dx) + dt / self.unit

    def retraced(self, a: Array, b: Array) -> bool:
        return False

    def predict(self, arc: float, previous: Array | None) -> float:
        e, arc = self.equations, arc or 1.0
        e.linearise(self.time)
        d = e.solve(self.time, self.slope())
        dt = self._share(arc, self.length(d, 1.0))
        self.time = e.system.time + dt
        e.at(self.time)
        e.dx[e.free] += (dt * d)[e.free]
        return arc

    def _share(self, part: float, whole: float) -> float:
        dt = part / whole if whole else np.inf
        if not np.isfinite(dt):
            raise NoEquilibrium(f"neither load nor crack goes on at the load parameter {self.time:.6g}")
        return dt

    def correct(self, arc: float) -> int:
        e, o, last = self.equations, self.equations.options, np.inf
        for k in range(o.max_iterations):
            r = e.linearise(self.time)
            settled = e.system.core.is_settled
            d1, d2 = e.solve(self.time, r), e.solve(self.time, self.slope())
            gap = self.length(e.dx, self.time - e.system.time) - arc
            change = self._share(-(gap + self.length(d1, 0.0)), self.length(d2, 1.0))
            d = d1 + change * d2
            size = e.size(d)
            if not np.isfinite(size) or size > 1e3:
                raise e.failure(self.time, "the iteration along the path diverges")
            self.time += change
            e.at(self.time)
            e.dx[e.free] += d[e.free]
            done = size <= o.tolerance * max(min(1.0, e.size(e.dx)), 1e-12)
            if settled and (done or e.is_exact(r, size, last)):
                e.residual(self.time)
                return k + 1
            last = size
        raise e.failure(self.time, "no convergence of the iteration along the path")
