"""Several patches of splines, or the ends of one, joined where their corners, edges and sides are the same."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise, permutations, product
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from visviva.base.arguments import LISTED
from visviva.base.errors import InputError
from visviva.mesh.spline import SplinePatch, SplineSource
from visviva.mesh.spline_borders import Border, borders
from visviva.mesh.spline_overlap import refuse_open

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
CLOSE = 1e-9
"""Part of the size of all patches by which control points of joined sides may be apart."""


@dataclass(frozen=True, eq=False)
class SplinePatches(SplineSource):
    """Patches of splines that are joined, continuous without their slopes, where two of their sides are the same.

    Parameters
    ----------
    patches : sequence of SplinePatch
        Two in a plane, or in space. Sides that lie on each other must have the same control points, weights (but for
        a factor), degrees and knots (but for their range), in any direction: a side along two others is cut by
        `SplinePatch.cut`. So must edges in space. Sides of one patch are joined as well, as of a closed ring.

    Notes
    -----
    Patches whose knots at their ends stand once are given control points there, without a change of shape. The sides
    that are not joined are sets of faces by the number of their patch, such as ``"0.x0"``.

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
        if len({p.dimension for p in self.patches}) != 1:
            raise InputError("SplinePatches: give one or more patches, all in the plane or all in space")
        clamped = tuple(p.clamped(range(p.dimension)) for p in self.patches)
        object.__setattr__(self, "patches", clamped)
        try:
            object.__setattr__(self, "numbers", joined(clamped))
        except InputError as error:
            raise InputError(f"SplinePatches: {error}") from None

    def parts(self, periodic: Sequence[int] = ()) -> tuple[SplinePatch, ...]:
        if periodic:
            raise InputError("periodic sides are those of one patch, not of several that are joined")
        return self.patches


def joined(patches: Sequence[SplinePatch], numbers: Sequence[Ints] | None = None) -> list[Ints]:
    """Numbers (n_control,) of the control points of each patch, the same where they are joined.

    Parameters
    ----------
    patches : sequence of SplinePatch
    numbers : sequence of arrays of int, (n_control,), optional
        Of control points, the same where they are one already.

    Raises
    ------
    InputError
        If sides lie on each other and are not the same, patches lie over each other, or one is joined to none.
    """
    if numbers is None:
        offset = np.cumsum([0, *(p.control.size // p.dimension for p in patches)])
        numbers = [np.arange(a, b) for a, b in pairwise(offset)]
    points = np.concatenate([p.control.reshape(-1, p.dimension) for p in patches])
    size = float(np.ptp(points, axis=0).max())
    found = list(borders(patches, CLOSE * size))
    pairs, met, free, reasons = matched(patches, found, CLOSE * size)
    refuse_open(patches, free, reasons, size)
    refuse_alone(found, met, reasons)
    first = [numbers[a.patch][here] for a, here, _, _ in pairs]
    second = [numbers[b.patch][there] for _, _, b, there in pairs]
    n = 1 + max(int(number.max()) for number in numbers)
    group = groups(first, second, n)
    return np.split(
        renumbered(group[np.concatenate(numbers)]), np.cumsum([len(number) for number in numbers])[:-1]
    )


Pair = tuple[Border, Ints, Border, Ints]


def matched(
    patches: Sequence[SplinePatch], found: Sequence[Border], close: float
) -> tuple[list[Pair], list[tuple[int, int]], list[Border], dict[tuple[int, int], str]]:
    """Borders that are the same, patches with a common side, borders that are not joined, and why pairs are not.

    Raises
    ------
    InputError
        If two patches lie on one side of what they share.
    """
    pairs: list[Pair] = []
    met, taken, reasons = [], set(), {}
    of_corners: dict[tuple[int, ...], list[Border]] = {}
    for border in found:
        of_corners.setdefault(border.corners, []).append(border)
    for a, b in (pair for alike in of_corners.values() for pair in combinations(alike, 2)):
        match = same(patches[a.patch], a, patches[b.patch], b, close)
        if isinstance(match, str):
            reasons[a.number, b.number] = match
        if match is None or isinstance(match, str):
            continue
        here, there, turn = match
        pairs.append((a, here, b, there))
        taken |= {a.number, b.number}
        if a.is_side:
            met.append((a.patch, b.patch))
            if a.turn * b.turn * turn > 0:
                raise InputError(
                    f"{a} and {b} are the same, and both patches lie on the same side of it, one over the other; "
                    "leave out one, or exchange two directions of a patch that is mirrored"
                )
    return pairs, met, [border for border in found if border.number not in taken], reasons


def refuse_alone(
    found: Sequence[Border], met: Sequence[tuple[int, int]], reasons: Mapping[tuple[int, int], str]
) -> None:
    """Refuse patches without a common side with what patch 0 is joined to."""
    first, second = np.array(met, dtype=np.int64).reshape(-1, 2).T
    part = groups([first], [second], 1 + found[-1].patch if found else 1)
    if np.all(part == part[0]):
        return
    for (i, j), reason in reasons.items():
        if part[found[i].patch] != part[found[j].patch] and found[i].is_side:
            raise InputError(
                f"{found[i]} and {found[j]} have the same corners, but {reason}; give both the same"
            )
    alone = int(np.flatnonzero(part != part[0])[0])
    raise InputError(
        f"patch {alone} is not joined to patch 0: no side of it, or of what it is joined to, is the same as a side "
        "there; move control points, or cut patches where others end"
    )


def groups(first: Sequence[Ints], second: Sequence[Ints], n: int) -> Ints:
    """Group of each of n things of which pairs are one."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    i, j = (np.concatenate([np.zeros(0, dtype=np.int64), *s]) for s in (first, second))
    return np.asarray(
        connected_components(coo_array((np.ones(len(i)), (i, j)), shape=(n, n)), directed=False)[1]
    )


def renumbered(group: Ints) -> Ints:
    """Numbers in the order of first appearance."""
    _, first, inverse = np.unique(group, return_index=True, return_inverse=True)
    rank = np.empty(len(first), dtype=np.int64)
    rank[np.argsort(first)] = np.arange(len(first))
    return np.asarray(rank[inverse])


def same(
    a: SplinePatch, one: Border, b: SplinePatch, other: Border, close: float
) -> tuple[Ints, Ints, float] | str | None:
    """Control points of two borders that are one, and -1 if mirrored; what sets them apart; None for other corners."""
    P, Q = a.control.reshape(-1, a.dimension), b.control.reshape(-1, b.dimension)
    here, there = one.control, other.control
    found: str | None = None
    for turned, axes in orientations(there):
        if np.abs(P[corners(here)] - Q[corners(turned)]).max() > 2 * close:
            continue
        along, across = one.along, [other.along[abs(s) - 1] for s in axes]
        if here.shape != turned.shape or [a.degrees[k] for k in along] != [b.degrees[k] for k in across]:
            found = (
                f"{here.shape} and {turned.shape} control points of degrees "
                f"{[a.degrees[k] for k in along]} and {[b.degrees[k] for k in across]}"
            )
        elif (apart := float(np.abs(P[here] - Q[turned]).max())) > 2 * close:
            found = f"control points that are {apart:.3g} apart"
        elif not all(
            np.allclose(unit(a.knots[k]), unit(b.knots[m], s < 0), rtol=0, atol=1e-9)
            for k, m, s in zip(along, across, axes, strict=True)
        ):
            found = "other knots"
        elif np.ptp(ratio := weights(a, here) / weights(b, turned)) > 1e-9 * ratio.max():
            found = "other weights"
        else:
            turn = np.eye(len(axes))[[abs(s) - 1 for s in axes]] * np.sign(axes)
            return here.ravel(), turned.ravel(), float(np.linalg.det(turn))
    return found


def orientations(border: Ints) -> Iterator[tuple[Ints, tuple[int, ...]]]:
    """The control points of a border from all its corners, and its directions from 1 on, negative if reversed."""
    for order in permutations(range(border.ndim)):
        for signs in product((1, -1), repeat=border.ndim):
            turned = np.transpose(border, order)[tuple(slice(None, None, s) for s in signs)]
            yield turned, tuple(s * (k + 1) for s, k in zip(signs, order, strict=True))


def corners(border: Ints) -> Ints:
    """Control points at the corners of a border."""
    return border[np.ix_(*([0, -1] for _ in range(border.ndim)))].ravel()


def unit(knots: Array, flip: bool = False) -> Array:
    """Knots from 0 to 1, or reversed."""
    t = (knots - knots[0]) / (knots[-1] - knots[0])
    return np.asarray(1 - t[::-1] if flip else t)


def weights(patch: SplinePatch, border: Ints) -> Array:
    """Weights of the control points of a border."""
    given = np.ones(patch.control.shape[:-1]) if patch.weights is None else patch.weights
    return np.asarray(given.ravel()[border])
