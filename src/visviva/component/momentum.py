"""Axes along which momentum passes between a component and what is in no system."""

from __future__ import annotations

from typing import Any

import numpy as np

Axes = tuple[str, str]
"""Axes of linear momentum, and those about which there is angular momentum: ``("z", "xy")``."""

NOWHERE: Axes = ("", "")
EVERYWHERE: Axes = ("xyz", "xyz")
ABOUT_ANY: Axes = ("", "xyz")
"""Of torques whose direction turns."""
ROUNDING = 1e-12
"""Components below this part of the largest are those of rounding, in vectors that were turned."""


def axes_along(vectors: Any) -> str:
    """Axes along which vectors (3,) or (n, d) have components; all of what is a function, as it may point anywhere.

    Examples
    --------
    >>> axes_along((0, 0, -9.81)), axes_along([(1, 0), (0, 2)]), axes_along(lambda t, X: X)
    ('z', 'xy', 'xyz')
    """
    if callable(vectors):
        return "xyz"
    sizes = np.abs(np.atleast_2d(np.asarray(vectors, dtype=float))).max(axis=0, initial=0.0)
    return "".join(
        c for c, size in zip("xyz", sizes, strict=False) if size > ROUNDING * sizes.max(initial=0.0)
    )


def by_forces(axes: str) -> Axes:
    """Momenta that forces along these axes change; a force along an axis changes no angular momentum about it.

    Examples
    --------
    >>> by_forces("z"), by_forces("xz")
    (('z', 'xy'), ('xz', 'xyz'))
    """
    return axes, ABOUT_ANY[1] if len(axes) > 1 else "".join(c for c in "xyz" if axes and c != axes)


def joined(*several: Axes) -> Axes:
    """Union of the momenta that several components change."""
    linear, angular = ("".join(c for c in "xyz" if any(c in axes[k] for axes in several)) for k in (0, 1))
    return linear, angular
