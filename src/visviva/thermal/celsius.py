"""Temperatures that count from absolute zero: those not above it are refused, degrees Celsius remarked on."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visviva.base.errors import InputError

Array = NDArray[np.float64]
ROOM = 5.0, 60.0
"""What is common in degrees Celsius and rare in kelvin: helium boils at 4.2 K, nitrogen freezes at 63 K."""
ROOM_IN_KELVIN = 200.0, 350.0
"""Beside what is so warm, the cold end of a cryostat may well be in kelvin."""


def refuse_below_zero(label: str, temperatures: ArrayLike) -> None:
    """Refuse temperatures of what `label` names that are not above absolute zero.

    Raises
    ------
    InputError
    """
    least = float(np.min(temperatures, initial=np.inf))
    if not least > 0:
        raise InputError(f"{label}: a temperature of {least:g} is not above absolute zero; give kelvin")


def looks_celsius(T: Array) -> bool:
    """Whether temperatures look as if they were in degrees Celsius.

    Examples
    --------
    >>> [looks_celsius(np.array(T)) for T in ([20.0, 35.0], [77.4], [4.2, 20.0], [20.0, 293.0], [20.0, 800.0])]
    [True, False, False, False, True]
    """
    coldest, warmest = float(T.min()), float(T.max())
    return ROOM[0] <= coldest < ROOM[1] and not ROOM_IN_KELVIN[0] <= warmest <= ROOM_IN_KELVIN[1]


def taken_for_kelvin(label: str, what: str, T: Array) -> list[str]:
    """A remark on such temperatures (n,) of what counts them from absolute zero."""
    if not looks_celsius(T):
        return []
    return [
        f"{label}: temperatures count from absolute zero, and {what} is {T.min():g}; if that is in degrees Celsius, "
        f"give {T.min() + 273.15:g} (and a reference in kelvin)"
    ]


def scales_differ(colder: float, warmer: float) -> bool:
    """Whether one temperature seems to be in degrees Celsius and the other in kelvin."""
    return (colder <= 0 or ROOM[0] <= colder < ROOM[1]) and 150 < warmer - colder < 450
