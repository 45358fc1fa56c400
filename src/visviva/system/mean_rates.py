"""Positions without mass, whose rates are differences over steps, as those of contents are.

Equations ask for no rates of theirs at an instant. Schemes whose new rates are twice the mean of a step less the old
ones would let what their start is off by alternate for ever: of bodies in balance from the start on all of it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva.system.freedom import massless
from visviva.system.instant import instant
from visviva.system.memory import undisturbed

if TYPE_CHECKING:
    from visviva.scheme.schemes import Scheme
    from visviva.system.system import System

Ints = NDArray[np.int64]


def moved_by_means(system: System, scheme: Scheme) -> Ints:
    """Unknowns (k,) of free positions without mass that no constraint joins to others, under such a scheme."""
    found = [u for body, u in massless(system) if scheme.keeps_swinging and are_positions(system, body)]
    if not found:
        return np.zeros(0, dtype=np.int64)
    free = system.free_unknowns
    with undisturbed(system):
        A = abs(system.tangent(instant(system.time, leading=1.0))[1])
    light = np.isin(free, np.concatenate(found)) & (A.diagonal() == 0)
    held = system.is_lasting_constraint[free]
    mixed = held & (A @ (~light & ~held).astype(float) > 0)  # constraints of others
    joined = A.T @ mixed.astype(float) > 0
    return np.asarray(free[light & ~joined], dtype=np.int64)


def are_positions(system: System, body: object) -> bool:
    """Whether all vectors of a body are positions; lengths of directors are held at every instant."""
    vectors = body.vectors(system.model)  # type: ignore[attr-defined]
    return vectors is not None and bool(np.all(vectors[1]))
