"""The flow that every code in the comparison runs, and the command line that all of them share.

A channel with n x n/4 square cells in which a parabolic profile pulsates, and that all start from. Codes with the same
elements and scheme (Taylor-Hood, midpoint, skew-symmetric convection) solve the same discrete problem: the velocity
along the channel in its middle, a node of all meshes, agrees to the tolerance after the last step.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from record import Record, command

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FlowCase:
    """Everything in the units that the flow defines."""

    n: int = 256
    length: float = 4.0
    height: float = 1.0
    density: float = 100.0
    viscosity: float = 1.0
    step: float = 0.01
    steps: int = 5
    tolerance: float = 1e-8
    """Of the increments of velocity, relative to the velocity."""

    @property
    def counts(self) -> tuple[int, int]:
        """Cells along and across."""
        return self.n, self.n // 4

    @property
    def middle(self) -> tuple[float, float]:
        """Of the channel."""
        return self.length / 2, self.height / 2

    def strength(self, t: float) -> float:
        """Of the inflow."""
        return 1.0 + math.sin(2 * math.pi * t)

    def profile(self, y: Array) -> Array:
        """Velocity along the channel at unit strength."""
        return 4.0 * y * (self.height - y) / self.height**2


class Case(Protocol):
    """What a march needs of a case."""

    @property
    def step(self) -> float: ...

    @property
    def steps(self) -> int: ...

    @property
    def tolerance(self) -> float: ...


class Discretisation(Protocol):
    """The case in a code that leaves Newton's method to its user."""

    @property
    def case(self) -> Case: ...

    def begin(self, t: float) -> None:
        """The state becomes that of the start of a step, with the inflow of its end."""

    def assemble(self) -> None:
        """Residual and tangent."""

    def advance(self) -> tuple[float, float]:
        """Solves and takes the increment off; sizes of the velocities in it, and of the velocities."""

    def answer(self) -> float:
        """Velocity along the channel in its middle."""


MOST = 20
"""Iterations of a step."""


def march(flow: Discretisation) -> Record:
    """March the case by Newton's method."""
    record, case = Record(), flow.case
    for k in range(case.steps):
        with record.timed("cpu"):
            flow.begin((k + 1) * case.step)
            iterate(flow, record)
        record.steps += 1
    record.note(flow.answer())
    return record


def iterate(flow: Discretisation, record: Record) -> None:
    """Newton's method for one step."""
    for _ in range(MOST):
        with record.timed("assembly"):
            flow.assemble()
        with record.timed("solution"):
            change, whole = flow.advance()
        record.iterations += 1
        if change <= flow.case.tolerance * whole:
            return
    raise RuntimeError(f"no convergence in {MOST} iterations")


def main(run: Callable[[Any, str], Record], variants: tuple[str, ...], kind: type[Any] = FlowCase) -> None:
    """Command line of a code, see `record.command`."""
    command(run, variants, kind, "n")
