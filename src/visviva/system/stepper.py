"""The stepper: the memory of marching, which is its clock, how the present state came about, how steps are chosen."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.arguments import positive, refuse_other
from visviva.output.checkpoint import Record
from visviva.scheme.clock import Clock
from visviva.scheme.schemes import Scheme
from visviva.system.stability import Stability

Array = NDArray[np.float64]

NAME, VERSION = "stepper", 2
"""Of its record."""


@dataclass
class Stepper:
    """State of the marching itself, besides the vectors and memory of the core.

    Attributes
    ----------
    clock : Clock
        Counts the steps.
    rejected : int
        Steps that failed, or were too inaccurate, and were tried again.
    has_acceleration : bool
        Whether the accelerations of the core belong to the present state.
    has_rates : bool
        Whether steps have left the rates of fields of order 1 that schemes with a history go on from.
    solves_means : bool
        Whether multipliers are means over the last step, or not known yet.
    is_given : bool
        Whether the state was given, and is not that of a step.
    is_edited : bool
        Whether the state was touched since the last step, or the last check.
    settled : Scheme, optional
        That whose runs begin from this state as it is: what it moves before the first step is moved once, so that
        a restart there goes on from the same bits.
    last : tuple, optional
        Step and signals that led to the present state.
    told_forces : array, optional
        Residual of the step that led to it, where a restart has told it.
    stability : Stability
        Of the equilibria that statics has found.
    means : array of int
        Unknowns of motion whose rates are means over the last step, as the scheme of the run has it.
    moves : list of str
        What was moved to begin consistently, in words, and is not told yet.
    pace : dict of str to Record
        What those who choose the steps carry on, by the names of their records.
    """

    clock: Clock = field(default_factory=Clock)
    rejected: int = 0
    has_acceleration: bool = False
    has_rates: bool = False
    solves_means: bool = True
    is_given: bool = True
    is_edited: bool = False
    settled: Scheme | None = None
    last: tuple[Any, Array] | None = None
    told_forces: Array | None = None
    stability: Stability = field(default_factory=Stability)
    means: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    moves: list[str] = field(default_factory=list)
    pace: dict[str, Record] = field(default_factory=dict)
    _tables: tuple[Scheme, float, bool, Any] | None = None  # of the last step; equal steps share them

    def step_of(self, scheme: Scheme, h: float) -> Any:
        """The core's step of length `h` from the present time."""
        kept = self._tables
        begins = not self.has_rates
        if kept is None or kept[1:3] != (h, begins) or (kept[0] is not scheme and kept[0] != scheme):
            h = positive("System.step", "h", h)
            refuse_other("System.step", "scheme", scheme, Scheme, "a scheme such as vv.EnergyMomentum()")
            kept = self._tables = scheme, h, begins, scheme.step(self.clock.time, h, begins=begins)
        return kept[3].moved_to(self.clock.time)

    def arrive(self, step: Any, signals: Array, scheme: Scheme) -> None:
        """The state is now that of a step."""
        self.led_by((step, signals))
        self.solves_means = scheme.solves_means
        self.clock.advance(step.h)
        self.has_acceleration = self.has_acceleration and scheme.needs_acceleration
        self.has_rates = scheme.needs_acceleration

    def led_by(self, last: tuple[Any, Array] | None) -> None:
        """The state is that of this step and its signals, also after its rates were changed."""
        self.last, self.told_forces = last, None
        self.is_edited, self.is_given = False, False

    def edited(self) -> None:
        """The state was changed from outside, and is no longer that of a step."""
        self.last = self.told_forces = self.settled = None
        self.is_edited, self.is_given, self.has_acceleration, self.has_rates = True, True, False, False

    def begin_run(self) -> None:
        """Forget what an earlier run has chosen and found."""
        self.pace.clear()
        self.stability = Stability()

    def record(self) -> Record:
        """Record for restarts; what chooses the steps has records of its own."""
        values = {
            "time": self.clock.time,
            "rejected": self.rejected,
            "has_acceleration": int(self.has_acceleration),
            "has_rates": int(self.has_rates),
            "solves_means": int(self.solves_means),
            "is_given": int(self.is_given),
        }
        values |= {f"clock.{name}": value for name, value in asdict(self.clock).items()}
        values |= {f"stability.{name}": value for name, value in asdict(self.stability).items()}
        return Record(NAME, VERSION, values=values)

    def recall(self, record: Record) -> None:
        """Go on from what was recorded; where it is not said, the state is that of a step."""
        values = record.values
        self.rejected, self.has_acceleration = int(values["rejected"]), bool(values["has_acceleration"])
        for part, name in ((self.clock, "clock"), (self.stability, "stability")):
            for known in fields(part):
                setattr(part, known.name, values.get(f"{name}.{known.name}", known.default))
        self.solves_means = bool(values["solves_means"])
        self.is_given = bool(values.get("is_given", False))
        self.has_rates = bool(values.get("has_rates", not self.is_given))

    def copy(self) -> Stepper:
        """A copy that does not change with this one."""
        clock, stability = replace(self.clock), replace(self.stability)
        return replace(self, clock=clock, stability=stability, moves=list(self.moves), pace=dict(self.pace))
