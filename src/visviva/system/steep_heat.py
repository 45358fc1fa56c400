"""Temperatures at the start that even out faster than a step lasts, and how short steps begin for them.

Such are steep from node to node or through a shell, as where they were given so, or evened out across a tie. Midpoint
rules would turn them over in every step. Other schemes go to the end of the first step by backward Euler, where these
are even; shorter ones follow how they even out, where there are such.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.base.world import announce
from visviva.model.field import Role
from visviva.system.instant import instant
from visviva.system.memory import undisturbed
from visviva.thermal.carrier import HeatCarrier
from visviva.thermal.exchange import HeatBond

if TYPE_CHECKING:
    from visviva.scheme.schemes import Scheme
    from visviva.system.system import System

Array = NDArray[np.float64]
EVEN = 1e-3
"""Differences up to this part of a temperature are none: entropy that they make is a millionth."""
MOST = 29
"""Halvings: shorter steps are lost in the rounding of times."""


def first_halvings(system: System, scheme: Scheme, h: float) -> int:
    """How often to halve a first step of length `h`.

    Until no temperature changes in it by more than a quarter of what they differ by.

    Raises
    ------
    InputError
        If they even out too fast for any length of steps that adds up to this one.
    """
    tied = {id(b) for t, _ in system.model.terms if isinstance(t, HeatBond) for b in t.bodies}
    bodies = [
        c for c in system.components if isinstance(c, HeatCarrier) and (c.balances_entropy or id(c) in tied)
    ]
    bodies = [c for c in bodies if _is_uneven(c, system.x)]
    if not bodies:
        return 0
    hasty = {c.label: h * rate for c, rate in zip(bodies, _rates(system, bodies), strict=True)}
    name = max(hasty, key=lambda label: hasty[label])
    n = math.ceil(math.log2(max(4 * hasty[name], 1.0)))
    if n > MOST and not scheme.keeps_swinging:
        return 0  # what is steep is gone after a step of backward Euler
    if n > MOST:
        raise InputError(
            f"{name}: its temperatures at the start even out within {h / hasty[name]:.2g}, {hasty[name]:.1g} times as "
            f"fast as a step of {h:g}: let it start with temperatures that differ less from node to node and through "
            "its thickness, or take steps that are shorter"
        )
    if n:
        announce(
            f"temperatures of {name} even out within {h / hasty[name]:.2g} at the start: the first step is divided, "
            f"from {math.ldexp(h, -n):.2g} on"
        )
    return n


def _is_uneven(body: HeatCarrier, x: Array) -> bool:
    differ, largest = _extremes(body, x)
    return differ > EVEN * largest


def begin_even(system: System, step: Any) -> None:
    """Begin the iteration of a first step that goes to its end with even temperatures of bodies that balance entropy.

    Of what steep ones make of heat the tangent sees the contrary, and leads below absolute zero.
    """
    if not (system.is_given and step.theta == 1 and step.transport_factor):
        return
    bodies = [c for c in system.components if isinstance(c, HeatCarrier) and c.balances_entropy]
    if bodies:
        numbers, changes = zip(*(_evening(system, body) for body in bodies), strict=True)
        system.core.begin_at(np.concatenate(numbers), np.concatenate(changes))


def _evening(system: System, body: HeatCarrier) -> tuple[NDArray[np.int32], Array]:
    """Unknowns of its temperatures, and by how much they differ from the mean."""
    numbers, modes = np.asarray(body.warmth[1].unknowns, dtype=np.int32), body.profiles().shape[1]
    parts = system.x[numbers].reshape(-1, modes)
    return numbers, (parts[:, 0].mean() * np.eye(1, modes) - parts).ravel()


def _extremes(body: HeatCarrier, x: Array) -> tuple[float, float]:
    """By how much its temperatures differ, and the largest one: below zero in degrees Celsius, maybe."""
    T = body.temperatures_across(x)
    return float(np.ptp(T)), float(np.abs(T).max())


def _rates(system: System, bodies: list[HeatCarrier]) -> list[float]:
    """Of the fastest temperature of each body, by all that its temperatures differ by, for what these alone drive."""
    means = np.zeros(len(system.x))
    for body in bodies:
        at, change = _evening(system, body)
        means[at] = change
    with undisturbed(system):
        uneven = system.residual(instant(system.time, theta=1.0))
        system.core.dx[:] = means
        driven = uneven - system.residual(instant(system.time, theta=1.0))
        system.core.dx[:] = 0.0
        M = abs(system.tangent(instant(system.time, leading=1.0))[1])
    stored, free = np.zeros(len(system.x)), system.free_unknowns
    contents = np.isin(
        free, np.concatenate([f.unknowns for f in system.model.fields if f.role is Role.CONTENT])
    )
    stored[free[contents]] = M[contents][:, contents].sum(axis=1)
    found = []
    for body in bodies:
        own, warm = body.warmth
        (differ, highest), size = _extremes(body, system.x), stored[np.asarray(own.unknowns)]
        rate = np.divide(driven[np.asarray(own.unknowns)], size, out=np.zeros(len(size)), where=size > 0)
        if body.balances_entropy:
            rate *= warm.scale / own.scale * highest / warm.scale[0]
        profiles = body.profiles()
        found.append(float(np.abs(rate.reshape(-1, profiles.shape[1]) @ profiles.T).max()) / differ)
    return found
