"""Servo (control) constraints [7]: outputs follow functions of time, actuators' inputs are unknown."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.base.timefunction import OfTime
from visviva.component.component import Component, settings
from visviva.measure.measures import Reading, measures_of, refuse_elsewhere, strains_of
from visviva.model.law import Law, LawKind
from visviva.system.memory import undisturbed

if TYPE_CHECKING:
    from visviva.model.model import Model
    from visviva.model.state import State
    from visviva.scheme.schemes import Scheme
    from visviva.system.system import System

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

    Notes
    -----
    The inputs act along the gradients of the actuators' measures only; their work is booked as "servo".

    Where the actuators reach the outputs directly (inverse dynamics of an arm) every scheme serves; inputs of
    the midpoint schemes have order two if the path's third derivative starts at zero, else order one. Where
    they do not (a crane holds its load by a rope; its trolley moves the load only by the rope's direction)
    the equations have index five: inputs depend on the path's fourth derivative. Positions then still
    converge with order two under the midpoint schemes, but their inputs oscillate, the worse the smaller the
    step, and are refused. ``GeneralizedAlpha(rho=0)`` gives positions and inputs with order two,
    `BackwardEuler` with order one; both want a constant step. The run must start on the path, at rest or with
    velocities that fit it, and the path should have a continuous fourth derivative.

    Examples
    --------
    >>> import visviva as vv
    >>> ground, arm = vv.Ground(), vv.RigidBody(mass=2.0, inertia=(1, 1, 1), position=(1, 0, 0))
    >>> axle = vv.Revolute(a=ground, b=arm, at=(0, 0, 0), axis=(0, 0, 1))
    >>> height = vv.Position(of=arm, direction=(0, 1, 0))
    >>> servo = vv.Servo(output=[height], follows=["sin(t**2)"], actuators=[axle])
    >>> result = vv.simulate(vv.System([ground, arm, axle, servo]), until=0.01, step=0.001)
    >>> round(float(servo.inputs(result.system)[0]), 2)  # inertia 3 times angular acceleration 2
    6.0
    """

    output: list[Any]
    follows: list[OfTime]
    actuators: list[Any]

    def __post_init__(self) -> None:
        self._output = measures_of(self.label, self.output)
        self._actuators = measures_of(self.label, self.actuators)

    def announce(self, model: Model) -> None:
        for measure in (*self._output, *self._actuators):
            measure.announce(model)

    def contribute(self, model: Model) -> None:
        outputs, actuators = strains_of(self, self._output), strains_of(self, self._actuators)
        n = len(outputs)
        for what, count in (
            ("functions of time to follow", len(self.follows)),
            ("actuators", len(actuators)),
        ):
            if count != n:
                raise InputError(f"{self.label}: {n} outputs need {n} {what}, not {count}")
        for k, output in enumerate(outputs, 1):
            if not output.gradient(model.initial[0]):
                raise InputError(f"{self.label}: output {k} of {n} cannot move; give one of a body that can")
        self._multipliers = model.multipliers(self, "input", n, stage=2, block=self)
        law = Law(LawKind.SERVO)
        model.constrain(self, self._multipliers, [*outputs, *actuators], targets=self.follows, law=law, n=n)

    def start(self, state: State, scheme: Scheme) -> None:
        """Refuse schemes whose inputs oscillate; begin with multipliers that Newton would not find."""
        system = cast("System", state)  # whose instant is solved for
        if scheme.theta == 0.5 and self._is_indirect(system):
            raise InputError(
                f"{self.label}: its actuators do not accelerate its outputs directly, and the inputs of "
                f"{scheme} oscillate without converging; use GeneralizedAlpha(rho=0) or BackwardEuler()"
            )
        if not np.any(self.inputs(system)):
            initial_inputs(system)

    def _is_indirect(self, system: System) -> bool:
        """Whether some inputs of this servo do not accelerate its outputs (index above three)."""
        from visviva.system.actuated import Actuated

        with undisturbed(system):
            at = Actuated(system)
            at.factor()
            own = np.isin(at.multipliers, list(self._multipliers.unknowns))
            return bool(at.open_multipliers()[own].any())

    def inputs(self, system: System) -> Array:
        """Inputs (n,) of the actuators in the last step, at the scheme's evaluation point."""
        refuse_elsewhere(self, system)
        m = self._multipliers
        return np.array(system.x[m.start : m.start + m.size])


@dataclass(config=settings, frozen=True, kw_only=True)
class ServoInputs(Reading):
    """Probe: inputs (n,) of the actuators of a servo constraint in the last step.

    Parameters
    ----------
    servo : Servo
        Of the system. Inputs are torques on angles, forces on strokes and points, at the scheme's evaluation point.
    """

    servo: Servo

    def told_by_state(self, system: System) -> bool:
        return False

    def __call__(self, system: System) -> Array:
        """Present value."""
        return self.servo.inputs(system)


def initial_inputs(system: System) -> None:
    """Multipliers of this state, the least if inputs do not accelerate the outputs: exact for a start from rest."""
    from visviva.system.actuated import Actuated
    from visviva.system.consistency import accelerations

    at = Actuated(system)
    at.factor()
    system.x[at.multipliers] = accelerations(system, at)[1]
    system.invalidate()
