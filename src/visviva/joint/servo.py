"""Servo (control) constraints [7]: outputs follow functions of time, the inputs of given actuators are the unknowns."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.component import Component, settings
from visviva.errors import InputError
from visviva.law import Law, LawKind
from visviva.measure import measures_of, strains_of
from visviva.timefunction import OfTime

if TYPE_CHECKING:
    from visviva.model import Model
    from visviva.system import System

Array = NDArray[np.float64]


@dataclass(config=settings, eq=False, kw_only=True)
class Servo(Component):
    """Prescribed outputs with unknown inputs.

    Parameters
    ----------
    output : list of measures
        What is prescribed: points (three outputs each), joints (their coordinate), or other measures.
    follows : list of functions of time
        One for each output, see `TimeFunction`.
    actuators : list of measures
        As many as outputs; each input is the force or torque conjugate to its actuator (joint, measure).
    """

    output: list[Any]
    follows: list[OfTime]
    actuators: list[Any]

    def __post_init__(self) -> None:
        self._output = measures_of(self.label, self.output)
        self._actuators = measures_of(self.label, self.actuators)

    def contribute(self, model: Model) -> None:
        outputs, actuators = strains_of(self._output), strains_of(self._actuators)
        n = len(outputs)
        for what, count in (("functions of time to follow", len(self.follows)), ("actuators", len(actuators))):
            if count != n:
                raise InputError(f"{self.label}: {n} outputs need {n} {what}, not {count}")
        self._multipliers = model.multipliers(self, "input", n, stage=2, block=self)
        law = Law(LawKind.SERVO)
        model.constrain(
            self, self._multipliers, [*outputs, *actuators], targets=self.follows, law=law, n=n
        )

    def inputs(self, system: System) -> Array:
        """Inputs (n,) of the actuators in the last step, at the scheme's evaluation point."""
        m = self._multipliers
        return np.array(system.x[m.start : m.start + m.size])
