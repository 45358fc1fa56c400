"""Unknowns that are means over a step where the scheme is a conserving one, and what they are at an instant."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol, runtime_checkable
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from visviva.scheme.schemes import load_step
from visviva.system.instant import instant
from visviva.system.memory import undisturbed

if TYPE_CHECKING:
    from visviva.model.model import Model
    from visviva.system.system import System

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@runtime_checkable
class Averaging(Protocol):
    """A component some of whose unknowns balance forces of a whole step, and are no state."""

    @property
    def averages(self) -> tuple[Ints, Ints]:
        """These unknowns (n,), and those (n,) whose equations, linear in them, tell what they are at an instant."""
        ...


KNOWN: WeakKeyDictionary[Model, tuple[Ints, Ints]] = WeakKeyDictionary()
"""They are asked for at every look at forces, and do not change as long as the model is the same."""


def averages(system: System) -> tuple[Ints, Ints]:
    """Those of all components."""
    if system.model not in KNOWN:
        none = np.zeros(0, dtype=np.int64)
        found = [(none, none), *(c.averages for c in system.components if isinstance(c, Averaging))]
        means, rows = (np.concatenate([pair[k] for pair in found]) for k in range(2))
        KNOWN[system.model] = means, rows
    return KNOWN[system.model]


def has_averages(system: System) -> bool:
    """Whether there are any."""
    return len(averages(system)[0]) > 0


def forces_at_rest(system: System) -> Array:
    """Residual (n,) by unknown of the present configuration, without inertia."""
    step = load_step(system.time, 0.0)
    if not has_averages(system):
        return system.residual(step)
    with undisturbed(system):
        settle_averages(system)
        return system.residual(step)


def settle_averages(system: System) -> None:
    """Bring them to the present instant, at the system's unknowns and rates."""
    import scipy.sparse.linalg as spl

    means, rows = averages(system)
    if not len(means):
        return
    residual, K = system.tangent(instant(system.time, theta=1.0, rates=True))
    row, column = (np.searchsorted(system.free_unknowns, u) for u in (rows, means))
    system.x[means] -= spl.spsolve(K[row][:, column].tocsc(), residual[rows])
