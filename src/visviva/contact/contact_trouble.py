"""Messages of contact: why a step does not converge, and why there is no tangent for modes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.contact.contact_surface import Surface, positions

Array = NDArray[np.float64]

AT_LIMIT = 1e-6
"""Tractions that miss Coulomb's limit by no more than this part of it have reached it by slipping."""
TOUCHING = 1e-9
"""Gaps below this part of the size of the first surface's facets are neither open nor closed without pressure."""


def without_tangent(pressures: Array, gaps: Array, tractions: Array, friction: float, size: float) -> str:
    """Why contact cannot be linearised at these pressures (n,), gaps (n,) and tractions (n, 3); empty if it can."""
    presses = pressures > 0
    touches = ~presses & (np.abs(gaps) <= TOUCHING * size)
    if touches.any():
        return (
            f"it touches without pressure at {int(touches.sum())} of its vertices, which are neither open nor "
            "closed; press the surfaces together by a load, or move them apart"
        )
    limit = (1 - AT_LIMIT) * friction * pressures
    slips = presses & (np.linalg.norm(tractions, axis=1) >= limit) & (friction > 0)
    if slips.any():
        return (
            f"friction is at Coulomb's limit at {int(slips.sum())} of its vertices, which slip or are about to; "
            "raise friction, or leave it out"
        )
    return ""


def unsettled(term: _core.ContactTerm, surface: Surface, friction: float, x: Array) -> str:
    """Sentence on vertices of the first side that still change between open and closed, or between facets, at `x`."""
    vertices, cure = term.unsettled, ""
    what = "opens and closes, or sticks and slips," if friction > 0 else "opens and closes"
    if not vertices:
        vertices, what = term.roaming, "goes to and fro between facets"
        cure = "; formulation='mortar' is not bound to single facets"
    if not vertices:
        return ""
    places = positions(surface, x)[vertices[:3]]
    near = ", ".join("(" + ", ".join(f"{c:.4g}" for c in place) + ")" for place in places)
    return f"still {what} at {len(vertices)} vertices, such as near {near}{cure}"
