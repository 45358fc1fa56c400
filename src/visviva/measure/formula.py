"""Probes composed of other probes by an expression."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from pydantic import BeforeValidator
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError, nearest
from visviva.base.timefunction import Expression
from visviva.component.component import settings
from visviva.joint.joint import Joint
from visviva.measure.measures import JointCoordinate, Reading
from visviva.measure.names import columns_of

if TYPE_CHECKING:
    from visviva.system.system import System


def reading(what: Any) -> Any:
    """A joint stands for its coordinate."""
    return JointCoordinate(joint=what) if isinstance(what, Joint) else what


AnyReading = Annotated[Reading, BeforeValidator(reading)]


@dataclass(config=settings, frozen=True, kw_only=True)
class Formula(Reading):
    """Probe: an expression of other probes.

    Parameters
    ----------
    formula : str
        What expressions of `TimeFunction` may use, in the names of `of`, and ``t`` for the time; of probes with
        several components ``name_x, name_y, name_z`` or as they are called in ``probes.csv``.
    of : dict of str to probe

    Examples
    --------
    >>> import visviva as vv
    >>> ball = vv.PointMass(mass=2.0, velocity=(3, 4, 0))
    >>> energy = vv.Formula(formula="m/2*(v_x**2 + v_y**2)", of={"v": vv.Velocity(of=ball)})
    Traceback (most recent call last):
    visviva.base.errors.InputError: Formula: 'm' in 'm/2*(v_x**2 + v_y**2)' is no probe; there are t, v
    >>> energy = vv.Formula(formula="v_x**2 + v_y**2", of={"v": vv.Velocity(of=ball)})
    >>> energy(vv.System([ball]))
    25.0
    """

    formula: str
    of: dict[str, AnyReading]

    @cached_property
    def _expression(self) -> Expression:
        return Expression(self.formula)

    def __post_init__(self) -> None:
        known = ["t", *self.of]
        for name in self._expression.names:
            if name not in known and not any(name.startswith(f"{own}_") for own in self.of):
                told = nearest(name, known) or f"; there are {', '.join(known)}"
                raise InputError(f"Formula: {name!r} in {self.formula!r} is no probe{told}")

    def told_by_state(self, system: System) -> bool:
        return all(probe.told_by_state(system) for probe in self.of.values())

    def __call__(self, system: System) -> float:
        values = {"t": complex(system.time)}
        for name, probe in self.of.items():
            numbers = np.ravel(probe(system))
            names = columns_of(name, probe, numbers)
            values |= {column: complex(number) for column, number in zip(names, numbers, strict=True)}
        return self._expression(values)
