"""Springs and dampers between points."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic.dataclasses import dataclass

from visviva.component import settings
from visviva.errors import InputError
from visviva.form import squared
from visviva.joint.base import Joint, initial
from visviva.law import length, viscous_length
from visviva.values import Number

if TYPE_CHECKING:
    from visviva.model import Model


@dataclass(config=settings, eq=False, kw_only=True)
class Spring(Joint):
    """Linear spring and damper between two points: force ``stiffness (l - free_length) + damping dl/dt``.

    Parameters
    ----------
    a, b : component or Point
        What it connects; `at_a`, `at_b` say where on a component, its own origin if not given.
    stiffness, damping : float
        Not negative.
    free_length : float
        Length without force; the initial length if not given.
    """

    stiffness: Number = 0.0
    damping: Number = 0.0
    free_length: Number | None = None
    at_a: Any = None
    at_b: Any = None
    needs_frames = False

    def __post_init__(self) -> None:
        super().__post_init__()
        for what in ("stiffness", "damping"):
            if getattr(self, what) < 0:
                raise InputError(f"{self.label}: {what} {getattr(self, what):g} is negative")

    def _attach(self, side: Any) -> Any:
        at = self.at_a if side is self.a else self.at_b
        if hasattr(side, "position") and hasattr(side, "X"):
            return side
        return side.point() if at is None else side.point_at(at)

    def contribute(self, model: Model) -> None:
        A, B = self._sides
        e = squared(B.p - A.p)
        l0 = float(np.sqrt(e.value(initial(model)[0])))
        if l0 == 0:
            raise InputError(f"{self.label}: its two points coincide initially, so it has no direction")
        if self.stiffness:
            free = l0 if self.free_length is None else self.free_length
            model.potential(self, "spring", e, length(self.stiffness, free))
        if self.damping:
            model.dissipate(self, "damper", e, viscous_length(self.damping))
