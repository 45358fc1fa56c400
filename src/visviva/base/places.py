"""Functions of places that users give."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.arguments import as_numbers
from visviva.base.errors import InputError, RunError, named

Array = NDArray[np.float64]
ASKED = (
    "it is asked of a part of the points at once (types of cells, processes); let it hinge on the values of each point "
    "alone"
)


def of_places(whose: str, what: str, function: Callable[..., Any], X: Array, shape: tuple[int, ...]) -> Array:
    """Values of a function of places (n, 3), of the shape that is asked for."""
    found = as_numbers(function(X.copy()))  # which may move what it is given
    if found.shape != shape or not np.isfinite(found).all():
        raise InputError(
            f"{whose}: the function {what} gave shape {found.shape} or values that are not finite for positions "
            f"{X.shape}; give shape {shape}"
        )
    return found


def refuse_gathered(
    whose: str, what: str, function: Callable[[Array], Any], X: Array, found: Array, change: Array
) -> None:
    """Refuse a function that has other values at places (n, 3) alone than it `found` at all of them at once.

    It is asked by batches, and by each process for its own of them. Looked at are some places, those with the largest
    `change` (n, columns) from values that were right among them.
    """
    n, size = len(X), float(np.abs(found).max(initial=0.0))
    for k in [*change.argmax(axis=0), change.sum(axis=1).argmin(), 0, n // 2, n - 1]:
        for other in (k, (k + n // 2 + 1) % n):  # of one place alone the span is nothing, as across a plane
            alone = _alone(whose, what, function, X[[k, other]])
            is_right = alone.shape == (2, *found.shape[1:])
            if is_right and np.allclose(alone[0], found[k], rtol=1e-4, atol=1e-6 * size):
                break
        else:
            raise InputError(
                f"{whose}: its {what} at {X[k].tolist()} is {found[k].tolist()}, and of this point alone "
                f"{np.atleast_1d(alone)[0].tolist()}: {ASKED}, not on X.max(), X.mean() or len(X)"
            )


def _alone(whose: str, what: str, function: Callable[[Array], Any], X: Array) -> Array:
    """Values at a few points."""
    try:
        with named(f"{whose}: its {what}"):
            return np.asarray(function(X), dtype=float)
    except RunError as error:
        raise InputError(f"{str(error).splitlines()[0]}, of two points alone: {ASKED}") from error


class OfAll:
    """A user's function ``f(t, X)`` of places (n, 3), that is asked of all of them at once."""

    def __init__(self, whose: str, what: str, function: Callable[[float, Array], Any]) -> None:
        self.whose, self.what, self.function = whose, what, function

    def __call__(self, time: float, X: Array) -> Array:
        return np.array(self.function(time, X.copy()), dtype=float)  # it may move X, and keep what it gives


class OfPart(OfAll):
    """One that is asked of a part of them at once: of a type of cells, or of those of a process.

    Whether that matters is looked at at all times at which it is not as before.
    """

    def __init__(self, whose: str, what: str, function: Callable[[float, Array], Any]) -> None:
        super().__init__(whose, what, function)
        self._last: dict[tuple[int, bytes], tuple[float, Array]] = {}  # by points, to see where it changes

    def __call__(self, time: float, X: Array) -> Array:
        found = super().__call__(time, X)
        if len(X) and found.shape[:1] == X.shape[:1] and np.isfinite(found).all():
            self._look(time, X, found)
        return found

    def _look(self, time: float, X: Array, found: Array) -> None:
        n = len(X)
        # no cell shares a point with another, nor a batch three of them
        points = n, X[[0, n // 2, n - 1]].tobytes()
        before, values = self._last.get(points, (None, np.zeros_like(found)))
        if before == time:
            return
        self._last[points] = time, found.copy()
        change = np.abs(found - values).reshape(n, -1)
        if change.any():
            refuse_gathered(self.whose, self.what, partial(self.function, time), X, found, change)
