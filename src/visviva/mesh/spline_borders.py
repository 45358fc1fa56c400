"""Corners, edges and sides of patches of splines."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.mesh.spline import SplinePatch

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
KINDS = ("corner", "edge", "side")


@dataclass(frozen=True, eq=False, kw_only=True)
class Border:
    """A corner, an edge or a side of a patch, that control points lie on.

    Attributes
    ----------
    number : int
        Of all borders.
    patch : int
    ends : tuple of int or None
        By direction: 0 at its start, -1 at its end, None along it.
    control : array of int
        Control points of the patch, by the directions along the border.
    corners : tuple of int
        Ascending numbers of the places where it ends, the same for borders that end in the same places.
    """

    number: int
    patch: int
    ends: tuple[int | None, ...]
    control: Ints
    corners: tuple[int, ...]

    @property
    def along(self) -> list[int]:
        """Directions along it."""
        return [k for k, end in enumerate(self.ends) if end is None]

    @property
    def is_side(self) -> bool:
        return len(self.along) == len(self.ends) - 1

    @property
    def turn(self) -> int:
        """1 for a side whose directions and outward normal are right-handed, as those of the patch are, else -1."""
        (k,) = (k for k, end in enumerate(self.ends) if end is not None)
        return (-1 if k % 2 else 1) * (1 if self.ends[k] == -1 else -1)

    def __str__(self) -> str:
        where = " ".join("xyz"[k] + str(abs(end)) for k, end in enumerate(self.ends) if end is not None)
        kind = "side" if self.is_side else KINDS[len(self.along)]
        return f"{kind} {where} of patch {self.patch}"


def borders(patches: Sequence[SplinePatch], close: float) -> Iterator[Border]:
    """All borders of patches, in the directions that begin and end in control points.

    Raises
    ------
    InputError
        If an edge has no length.
    """
    count = 0
    for k, (patch, places) in enumerate(zip(patches, corner_places(patches, close), strict=True)):
        shape, points = patch.control.shape[:-1], patch.control.reshape(-1, patch.dimension)
        number = np.arange(int(np.prod(shape))).reshape(shape)
        choices = [(None, 0, -1) if patch.is_clamped(a) else (None,) for a in range(patch.dimension)]
        for ends in product(*choices):
            if all(end is None for end in ends):
                continue
            chosen = tuple(slice(None) if end is None else end for end in ends)
            control = np.asarray(number[chosen])
            corners = np.ravel(places[chosen])
            border = Border(
                number=count, patch=k, ends=ends, control=control, corners=tuple(sorted(corners.tolist()))
            )
            if control.ndim == 1 and np.ptp(points[control], axis=0).max() <= close:
                raise InputError(
                    f"{border} is a single point, {points[control[0]].round(6).tolist()}, where its control points "
                    "would come apart; give patches whose sides have a length, such as a square within a disc"
                )
            count += 1
            yield border


def corner_places(patches: Sequence[SplinePatch], close: float) -> list[Ints]:
    """Number of the place of each corner, of shape (2, 2) or (2, 2, 2), patch by patch."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    d = patches[0].dimension
    at = np.ix_(*[[0, -1]] * d)
    points = np.concatenate([patch.control[at].reshape(-1, d) for patch in patches])
    i, j = cKDTree(points).query_pairs(close, output_type="ndarray").T
    _, place = connected_components(
        coo_array((np.ones(len(i)), (i, j)), shape=(len(points),) * 2), directed=False
    )
    return list(np.asarray(place, dtype=np.int64).reshape(-1, *[2] * d))
