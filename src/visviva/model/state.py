"""The view that components have of their system: its present state, and the core that holds it."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from visviva.model.model import Model

Array = NDArray[np.float64]


class State(Protocol):
    """A system as its components see it.

    Attributes
    ----------
    model : Model
        The unknowns that components have made.
    core : object
        The compiled system.
    has_inertia : bool
        Whether masses take part, as they do not in statics.
    """

    model: Model
    core: Any
    has_inertia: bool

    @property
    def x(self) -> Array:
        """Present unknowns (n,)."""
        ...

    @property
    def x_with_reactions(self) -> Array:
        """The same (n,) with the multipliers of lasting constraints, and the pressures, that belong to this instant."""
        ...

    @property
    def v(self) -> Array:
        """Present rates (n,)."""
        ...

    @property
    def is_given(self) -> bool:
        """Whether the state was given, and is not that of a step."""
        ...

    @property
    def time(self) -> float:
        """Present time."""
        ...

    @property
    def last_step(self) -> float:
        """Length of the step that led to the present state; 0 without one."""
        ...

    @property
    def constrains_motion(self) -> bool:
        """Whether constraints act on motion alone."""
        ...

    def evaluate_ledger(self) -> None:
        """Fill the core's sums with the present state."""
        ...
