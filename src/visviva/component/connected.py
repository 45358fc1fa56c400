"""Parts of a model that nothing connects but the ground, and how large they are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields

import numpy as np
from numpy.typing import NDArray

from visviva.component.component import Component, characteristic_length, mentioned

Array = NDArray[np.float64]

SMALL = 1e-2
"""Parts smaller than this share of the model are measured by their own length, but no part by less than this share of
how far it is from the origin: rounding of positions is to stay small."""


def lengths_of_parts(components: Sequence[Component], whole: float) -> dict[int, float]:
    """The lengths of the small parts of a model of length `whole`, by the `id` of their components.

    Directors and positions of a beam of metres have nothing to do with the kilometres of the rock beside it.
    """
    lengths: dict[int, float] = {}
    for part in connected(components):
        far = max((float(np.abs(p).max(initial=0.0)) for c in part for p in places(c)), default=0.0)
        length = max(characteristic_length(part), SMALL * far)
        if length < SMALL * whole:
            lengths |= {id(c): length for c in part}
    return lengths


def connected(components: Sequence[Component]) -> list[list[Component]]:
    """Groups of components that name each other, one by one."""
    above = {id(c): id(c) for c in components}

    def root(key: int) -> int:
        while above[key] != key:
            above[key] = key = above[above[key]]
        return key

    for c in components:
        for f in fields(c):
            for other in mentioned(getattr(c, f.name)):
                if not other.is_fixed:
                    above[root(id(other))] = root(id(c))
    groups: dict[int, list[Component]] = {}
    for c in components:
        groups.setdefault(root(id(c)), []).append(c)
    return list(groups.values())


def places(component: Component) -> list[Array]:
    """Points at which a component says that it is."""
    given = (getattr(component, name, None) for name in ("position", "at", "points"))
    return [np.asarray(p, dtype=float) for p in given if p is not None and np.shape(p)[-1:] == (3,)]
