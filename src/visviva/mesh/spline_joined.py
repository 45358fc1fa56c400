"""Several patches of splines, joined where their sides are the same."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, permutations, product
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from visviva.base.arguments import LISTED
from visviva.base.errors import InputError
from visviva.mesh.grid import SIDES
from visviva.mesh.spline import SplinePatch, SplineSource

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
CLOSE = 1e-9
"""Part of the size of patches by which control points of joined sides may be apart."""


@dataclass(frozen=True, eq=False)
class SplinePatches(SplineSource):
    """Patches of splines that are joined, continuous without their slopes, where two of their sides are the same.

    Parameters
    ----------
    patches : sequence of SplinePatch
        Two in a plane, or in space. Sides whose corners are the same must have the same control points, weights (but
        for a factor), degrees and knots (but for their range), in any direction.

    Notes
    -----
    The sides that are not joined are sets of faces by the number of their patch, such as ``"0.x0"``.

    Examples
    --------
    >>> import numpy as np
    >>> left = SplinePatch(
    ...     degrees=(1, 1),
    ...     knots=([0, 0, 1, 1], [0, 0, 1, 1]),
    ...     control=np.array([[(0, 0), (0, 1)], [(1, 0), (1, 1)]]),
    ... )
    >>> right = SplinePatch(degrees=(1, 1), knots=left.knots, control=left.control + [1.0, 0.0])
    >>> [numbers.tolist() for numbers in SplinePatches(patches=(left, right)).numbers]
    [[0, 1, 2, 3], [2, 3, 4, 5]]
    """

    patches: Annotated[tuple[SplinePatch, ...], LISTED]

    def __post_init__(self) -> None:
        object.__setattr__(self, "patches", tuple(self.patches))
        if len({p.dimension for p in self.patches}) != 1:
            raise InputError("SplinePatches: give one or more patches, all in the plane or all in space")
        if any(p.wrapped for p in self.patches):
            raise InputError("SplinePatches: a patch that ends where it begins stands alone")
        object.__setattr__(self, "numbers", joined(self.patches))

    def parts(self, periodic: Sequence[int] = ()) -> tuple[SplinePatch, ...]:
        if periodic:
            raise InputError("periodic sides are those of one patch, not of several that are joined")
        return self.patches


def sides(patch: SplinePatch) -> Iterator[tuple[str, Ints]]:
    """Names of the sides and control points (n,) or (n, m) there, of those that control points lie on."""
    number = np.arange(int(np.prod(patch.control.shape[:-1]))).reshape(patch.control.shape[:-1])
    for k, names in enumerate(SIDES[: patch.dimension]):
        for end, name in zip((0, -1), names, strict=True):
            yield str(name), np.take(number, end, axis=k)


def joined(patches: Sequence[SplinePatch]) -> list[Ints]:
    """Numbers (n_control,) of the control points of each patch, the same where sides are joined.

    Raises
    ------
    InputError
        If sides have the same corners and are not the same, or a patch is joined to none.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    offset = np.concatenate([[0], np.cumsum([p.control.size // p.dimension for p in patches])])
    first, second, met = [], [], [(0, 0)]
    for a, b in combinations(range(len(patches)), 2):
        for (one, here), (other, there) in product(sides(patches[a]), sides(patches[b])):
            pairs = same(patches[a], one, here, patches[b], other, there)
            if pairs is None:
                continue
            if isinstance(pairs, str):
                raise InputError(
                    f"SplinePatches: side {one} of patch {a} and side {other} of patch {b} {pairs}"
                )
            first.append(offset[a] + pairs[0])
            second.append(offset[b] + pairs[1])
            met.append((a, b))
    n = int(offset[-1])
    i, j = (np.concatenate([np.zeros(0, dtype=np.int64), *s]) for s in (first, second))
    _, group = connected_components(coo_array((np.ones(len(i)), (i, j)), shape=(n, n)), directed=False)
    touching = coo_array((np.ones(len(met)), np.transpose(met)), shape=(len(patches),) * 2)
    count, part = connected_components(touching, directed=False)
    if count > 1:
        alone = int(np.flatnonzero(part != part[0])[0])
        raise InputError(
            f"SplinePatches: patch {alone} is not joined to patch 0: no side of it, or of what it is joined to, has "
            "the corners of a side there; move control points, or cut patches where others end"
        )
    return np.split(renumbered(group), offset[1:-1])


def renumbered(group: Ints) -> Ints:
    """Numbers in the order of first appearance."""
    _, first, inverse = np.unique(group, return_index=True, return_inverse=True)
    rank = np.empty(len(first), dtype=np.int64)
    rank[np.argsort(first)] = np.arange(len(first))
    return np.asarray(rank[inverse])


def same(
    a: SplinePatch, one: str, here: Ints, b: SplinePatch, other: str, there: Ints
) -> tuple[Ints, Ints] | str | None:
    """Control points of two sides that are one, what sets them apart, or None if they have other corners."""
    P, Q = a.control.reshape(-1, a.dimension), b.control.reshape(-1, b.dimension)
    close = CLOSE * max(np.ptp(P, axis=0).max(), np.ptp(Q, axis=0).max())
    found: str | None = None
    for turned, axes in orientations(there):
        if np.abs(P[corners(here)] - Q[corners(turned)]).max() > close:
            continue
        along, across = directions(a, one), [directions(b, other)[k] for k in abs_axes(axes)]
        if here.shape != turned.shape or [a.degrees[k] for k in along] != [b.degrees[k] for k in across]:
            found = (
                f"have the same corners, but {here.shape} and {turned.shape} control points of degrees "
                f"{[a.degrees[k] for k in along]} and {[b.degrees[k] for k in across]}; give both the same"
            )
            continue
        apart = np.abs(P[here] - Q[turned]).max()
        if apart > close:
            found = (
                f"have the same corners, but control points that are {apart:.3g} apart; give both the same"
            )
        elif not all(
            np.allclose(unit(a.knots[k]), unit(b.knots[m], flip), rtol=0, atol=1e-9)
            for k, m, flip in zip(along, across, [s < 0 for s in axes], strict=True)
        ):
            found = "have the same control points, but other knots; give both the same"
        elif np.ptp(weights(a, here) / weights(b, turned)) > 1e-9 * weights(a, here).max():
            found = "have the same control points, but other weights; give both the same"
        else:
            return here.ravel(), turned.ravel()
    return found


def orientations(side: Ints) -> Iterator[tuple[Ints, tuple[int, ...]]]:
    """The control points of a side from all its corners, and its directions from 1 on, negative if reversed."""
    for order in permutations(range(side.ndim)):
        for signs in product((1, -1), repeat=side.ndim):
            turned = np.transpose(side, order)[tuple(slice(None, None, s) for s in signs)]
            yield turned, tuple(s * (k + 1) for s, k in zip(signs, order, strict=True))


def abs_axes(axes: Sequence[int]) -> list[int]:
    """Directions without their signs, from 0 on."""
    return [abs(s) - 1 for s in axes]


def corners(side: Ints) -> Ints:
    """Control points at the corners of a side."""
    return side[np.ix_(*([0, -1] for _ in range(side.ndim)))].ravel()


def directions(patch: SplinePatch, side: str) -> list[int]:
    """Directions of a patch along its side."""
    return [k for k in range(patch.dimension) if k != "xyz".index(side[0])]


def unit(knots: Array, flip: bool = False) -> Array:
    """Knots from 0 to 1, or reversed."""
    t = (knots - knots[0]) / (knots[-1] - knots[0])
    return np.asarray(1 - t[::-1] if flip else t)


def weights(patch: SplinePatch, side: Ints) -> Array:
    """Weights of the control points of a side."""
    given = np.ones(patch.control.shape[:-1]) if patch.weights is None else patch.weights
    return np.asarray(given.ravel()[side])
