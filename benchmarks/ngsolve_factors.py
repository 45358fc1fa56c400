"""Factors of PARDISO in NGSolve, for every comparison with it."""

from __future__ import annotations

from typing import Any


def factors(matrix: Any, free: Any, kept: Any = None, **options: Any) -> Any:
    """The inverse over the `free` unknowns; `kept`, made of the same matrix before, spares a new analysis."""
    if kept is None:
        return matrix.Inverse(free, inverse="pardiso", **options)
    kept.Update()
    return kept
