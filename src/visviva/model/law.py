"""Energies and laws of strains: those known to the core, and functions of the user at batch level."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva import _core

Array = NDArray[np.float64]


LawKind = _core.LawKind
"""The laws of the core (`cpp/visviva/strain/strain.hpp`)."""


@dataclass(frozen=True)
class Law:
    """A law of the core with its parameters, or a function of the user (`callback`)."""

    kind: LawKind
    parameters: tuple[float, ...] = (0.0, 0.0)
    callback: Callable[..., Any] | None = None


def linear(k: float) -> Law:
    """Energy ``W = k e``."""
    return Law(LawKind.LINEAR, (k, 0.0))


def quadratic(k: float, free: float = 0.0) -> Law:
    """Energy ``W = k/2 (e - free)^2``."""
    return Law(LawKind.QUADRATIC, (k, free))


def length(k: float, free: float) -> Law:
    """Energy ``W = k/2 (sqrt(e) - free)^2`` of a squared length ``e``."""
    return Law(LawKind.LENGTH, (k, free))


def load(amplitude: float) -> Law:
    """Generalised force ``amplitude * s(t)`` that does work on the strain."""
    return Law(LawKind.LOAD, (amplitude, 0.0))


def viscous(c: float) -> Law:
    """Resisting generalised force ``c de/dt``."""
    return Law(LawKind.VISCOUS, (c, 0.0))


def viscous_length(c: float) -> Law:
    """Resisting force ``c dl/dt`` along the length ``l = sqrt(e)``."""
    return Law(LawKind.VISCOUS_LENGTH, (c, 0.0))
