"""Newton's method for the equations of a step, and the failure of it."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from visviva.base.arguments import Validated, bounded
from visviva.base.errors import RunError, VisvivaError
from visviva.linear.choice import LinearOptions

if TYPE_CHECKING:
    from visviva.system.system import System


@dataclass(frozen=True)
class Newton(metaclass=Validated):
    """Newton's method for the equations of a step.

    Parameters
    ----------
    tolerance : float
        Largest estimated error of an accepted iterate, relative to each unknown's own scale and to how far
        the step goes. Forces of constraints and contact on a coordinate, whose work is booked, may be wrong by ten
        times that part of the largest force in the step: of constraints, or of inertia and stiffness by the diagonal of
        the tangent.
    max_iterations : int
        After this many the step has failed; after half as many more where the last increments are below 1e-6.
    keep_factor : float
        A factorisation is kept while it contracts the error at least by this factor per iteration; 0 means a
        new tangent in every iteration.
    tangents : int, optional
        So many iterations at the start of every step make tangents of their own, whatever the contraction: where
        steps are predicted badly, the first tangent is not worth keeping. By default 2 where immersed solids are
        thinner than the cells around them, else 0.
    null_space : bool or None
        Reduce rigid bodies to six unknowns by the discrete null space; None decides by what the system holds.
    regularization : float
        Taken off the scaled diagonal of redundant constraints, so that the tangent stays regular; a hundredfold in
        factors of the whole matrix.
    linear : Automatic, Direct, Iterative, Staggered or Petsc
        How the linear systems are solved; None chooses by size and kind of the system. What was chosen, and
        why, stands in `System.linear_explanation`.
    """

    tolerance: float = 1e-13
    max_iterations: int = 25
    keep_factor: float = 0.3
    tangents: int | None = None
    null_space: bool | None = None
    regularization: float = 1e-13
    linear: LinearOptions | None = None

    def __post_init__(self) -> None:
        bounded(self, tolerance=(1e-300, 1.0), max_iterations=(1, 1e9), keep_factor=(0.0, 1.0))
        bounded(self, regularization=(0.0, 1.0))
        if self.tangents is not None:
            bounded(self, tangents=(0, 1e9))


@dataclass(frozen=True)
class GivenUp:
    """Report of a step that was abandoned because a term had no value at a trial state."""

    reason: str
    worst_unknown: int = -1
    increments: tuple[float, ...] = ()


class StepFailure(RunError):
    """A step that did not converge.

    Parameters
    ----------
    system : System
        Whose step it was, with the increment of the last iteration.
    time, h : float
        Start and length of the step.
    report : StepReport
        Of Newton's method, from the core.

    Attributes
    ----------
    time, h : float
        Start and length of the step.
    reason : str
        What ended the iteration.
    component, unknown : str
        Where the last increment was largest.
    increments : list of float
        Relative size of the increment in every iteration.
    trouble : str
        What components found wrong with the last iterate, such as an inverted element.
    """

    def __init__(self, system: System, time: float, h: float, report: Any) -> None:
        self.component, self.unknown = system.describe(report.worst_unknown)
        self.increments = list(report.increments)
        self.time, self.h, self.reason = time, h, report.reason
        self.trouble = trouble_of(system)
        history = ", ".join(f"{i:.1e}" for i in self.increments[-6:])
        worst = f"; worst is {self.unknown} of {self.component}" if report.worst_unknown >= 0 else ""
        relative = f"; relative increments ... {history}" if history else ""
        super().__init__(
            f"the step from t = {time:.9g} with h = {h:.3g} failed: {report.reason}{worst}{relative}. "
            f"{self.trouble}Try a smaller step, or look at this "
            f"component's data near t = {time:.4g}"
        )


def trouble_of(system: System) -> str:
    """Complaints of components about the trial state, or its start if it is not finite, in sentences; empty if none."""
    trial = system.x + system.core.dx
    if not np.isfinite(trial).all():
        trial = system.x
    with suppress(VisvivaError, np.linalg.LinAlgError), np.errstate(all="ignore"):  # states may be wild
        return "".join(f"{found}. " for c in system.components if (found := c.trouble(trial)))
    return ""
