"""Rates of functions of time of which only values are known, by differences of sixth order.

What is not resolved by the steps is not resolved by the run: so the step is the measure of how far to look, whatever
the time is and the unit it is counted in.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np

PART = 1 / 8
"""Part of a step between two points: of a wave of twenty steps truncation and rounding are then 1e-11 of its rate."""
ROUNDING = 30 * np.finfo(float).eps
"""Of differences, as a part of the values they are of: where these do not change at all, two agree on nothing."""
FARTHEST, CLOSER, TRIALS = 1e-3, 0.1234, 10
"""Where no step is known: the first distance (times the time, 1 at least), and how the next ones fall. Not by a ratio
of small numbers: whole periods at two distances would agree on a rate of nothing."""


def central_rate(f: Callable[[float], Any], t: float, step: float = 0.0) -> Any:
    """Rate at time `t` of a function, of arrays as well, in which steps of this length see enough.

    Where `step` is 0, of several distances that is taken which agrees best with the next.

    Examples
    --------
    >>> import math
    >>> round(central_rate(math.sin, 300.0, 0.1) / math.cos(300.0), 9)
    1.0
    >>> round(float(central_rate(lambda t: math.sin(1e6 * t), 0.0)), 3)
    1000000.0
    """
    return _over(_central, 1, f, t, step)


def forward_rate(f: Callable[[float], Any], t: float, step: float = 0.0) -> Any:
    """The same just after time `t`: where a function has a kink, what it goes on with.

    Examples
    --------
    >>> round(forward_rate(lambda t: max(t, 0.0), 0.0, 0.1), 9)
    1.0
    """
    return _over(_forward, 1, f, t, step)


def forward_curvature(f: Callable[[float], Any], t: float, step: float = 0.0) -> Any:
    """Second derivative just after time `t`.

    Examples
    --------
    >>> round(forward_curvature(lambda t: t * t, 1.0, 0.1), 9)
    2.0
    """
    return _over(_curvature, 2, f, t, step)


def _over(
    difference: Callable[..., Any], order: int, f: Callable[[float], Any], t: float, step: float
) -> Any:
    if step > 0:
        return difference(f, t, PART * step)
    lengths = FARTHEST * max(1.0, abs(t)) * CLOSER ** np.arange(TRIALS)
    found = [difference(f, t, length) for length in lengths]
    misfit = [float(np.max(np.abs(a - b), initial=0.0)) for a, b in pairwise(found)]
    rounding = ROUNDING * float(np.max(np.abs(f(t)), initial=0.0)) / lengths[:-1] ** order
    return found[int(np.argmin(misfit + rounding))]


def _central(f: Callable[[float], Any], t: float, d: float) -> Any:
    one, two, three = (f(t + k * d) - f(t - k * d) for k in (1, 2, 3))
    return (45 * one - 9 * two + three) / (60 * d)


def _forward(f: Callable[[float], Any], t: float, d: float) -> Any:
    weights = (-147, 360, -450, 400, -225, 72, -10)
    return sum(w * f(t + k * d) for k, w in enumerate(weights)) / (60 * d)


def _curvature(f: Callable[[float], Any], t: float, d: float) -> Any:
    weights = (812, -3132, 5265, -5080, 2970, -972, 137)
    return sum(w * f(t + k * d) for k, w in enumerate(weights)) / (180 * d * d)
