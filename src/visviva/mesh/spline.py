"""Splines as meshes: tensor products of B-splines, plain or rational, in a plane or in space."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BeforeValidator, PlainSerializer, WithJsonSchema

from visviva.base.arguments import LISTED, Validated
from visviva.base.errors import InputError
from visviva.mesh.grid import SIDES, Grid
from visviva.mesh.mesh import Mesh

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


def _numbers(value: Any) -> Any:
    try:
        return np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise ValueError(f"expected an array of numbers, not {value!r}") from None


NESTED = WithJsonSchema({"type": "array", "description": "numbers in lists in lists"})
Numbers = Annotated[Any, BeforeValidator(_numbers), PlainSerializer(lambda a: a.tolist()), NESTED]
Knots = Annotated[
    Any,
    BeforeValidator(lambda value: tuple(_numbers(t) for t in value)),
    PlainSerializer(lambda knots: [t.tolist() for t in knots]),
    NESTED,
]


class SplineSource(metaclass=Validated):
    """Base of what gives patches of splines.

    Attributes
    ----------
    numbers : list of array of int, (n_control,), or None
        Of the control points of each patch, the same where patches are joined; None for a single patch.
    """

    numbers: ClassVar[list[Ints] | None] = None

    def parts(self, periodic: Sequence[int] = ()) -> tuple[SplinePatch, ...]:
        """The patches, smooth across the ends of some coordinates, which are taken for the same.

        Raises
        ------
        InputError
            If it cannot be that.
        """
        raise NotImplementedError


@dataclass(frozen=True, eq=False)
class SplinePatch(SplineSource):
    """A patch of B-splines or NURBS: a map of parameters, one per direction, to points.

    Parameters
    ----------
    degrees : sequence of int
        Two in a plane, three in space; 1 to 4.
    knots : sequence of arrays
        Ascending, as many in each direction as there are control points and the degree more and one.
    control : array (n1, n2, 2) or (n1, n2, n3, 3)
        Control points.
    weights : array (n1, n2) or (n1, n2, n3), optional
        Positive, of a rational patch.
    wrapped : sequence of int
        Directions that go on at their end as they begin: the last control points, as many as the degree, stand for the
        first ones, are these or all moved by the same, with the same weights and distances of knots.

    Notes
    -----
    Basis functions are evaluated by ``scipy.interpolate``. Of a knot that stands once, the patch has as many
    continuous derivatives as the degree less one.

    Examples
    --------
    A quarter of a ring, exactly:

    >>> import numpy as np
    >>> arc = np.array([(1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    >>> ring = SplinePatch(
    ...     degrees=(1, 2),
    ...     knots=([0, 0, 1, 1], [0, 0, 0, 1, 1, 1]),
    ...     control=np.stack([arc, 2 * arc]),
    ...     weights=np.outer([1.0, 1.0], [1.0, 0.5**0.5, 1.0]),
    ... )
    >>> places = ring.at(np.array([(0.0, 0.3), (1.0, 0.7)]))
    >>> np.linalg.norm(places, axis=1).round(12).tolist()
    [1.0, 2.0]
    >>> ring.refined(2).counts
    (2, 2)
    """

    degrees: Annotated[tuple[int, ...], LISTED]
    knots: Knots
    control: Numbers
    weights: Numbers | None = None
    wrapped: Annotated[tuple[int, ...], LISTED] = ()

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "degrees", tuple(int(p) for p in self.degrees))
        shape = self.control.shape[:-1]
        if (
            len(self.degrees) not in (2, 3)
            or len(shape) != len(self.degrees)
            or self.control.shape[-1] != len(shape)
        ):
            raise InputError(
                f"SplinePatch: degrees {self.degrees} and control points of shape {self.control.shape} do not fit: "
                "(n1, n2, 2) in a plane, (n1, n2, n3, 3) in space"
            )
        for k, (p, t, n) in enumerate(zip(self.degrees, self.knots, shape, strict=True)):
            self._check_direction(k, p, t, n)
        if not np.all(np.isfinite(self.control)):
            raise InputError("SplinePatch: control has numbers that are not finite")
        if self.weights is not None and (self.weights.shape != shape or not np.all(self.weights > 0)):
            raise InputError(
                f"SplinePatch: weights of shape {self.weights.shape} need shape {shape}, all positive"
            )
        for k in self.wrapped:
            self._check_wrapped(k)

    def _check_direction(self, k: int, p: int, t: Array, n: int) -> None:
        if not 1 <= p <= 4:
            raise InputError(f"SplinePatch: degree {p} of direction {k} is not between 1 and 4")
        if t.ndim != 1 or len(t) != n + p + 1:
            raise InputError(
                f"SplinePatch: direction {k} has {n} control points of degree {p}, so it needs {n + p + 1} knots, not "
                f"{len(t)}"
            )
        if np.any(np.diff(t) < 0) or not np.all(np.isfinite(t)):
            worst = int(np.argmin(np.diff(t)))
            raise InputError(
                f"SplinePatch: knots of direction {k} are not ascending: {t[worst]:g} is followed by {t[worst + 1]:g}"
            )
        inner = t[p : n + 1]
        if inner[-1] <= inner[0] or np.unique(t, return_counts=True)[1].max() > p + 1:
            raise InputError(f"SplinePatch: direction {k} has no length, or a knot more than {p + 1} times")
        within = inner[(inner > inner[0]) & (inner < inner[-1])]
        if np.any(torn := within[p:] == within[: max(len(within) - p, 0)]):
            raise InputError(
                f"SplinePatch: the knot {within[int(np.argmax(torn))]:g} of direction {k} stands more than {p} times, "
                "so the patch is torn there; give it so often at most, or two patches joined by vv.SplinePatches"
            )

    def _check_wrapped(self, k: int) -> None:
        """Whether a direction goes on at its end as it begins."""
        if k not in range(len(self.degrees)):
            raise InputError(f"SplinePatch: wrapped has direction {k} of {len(self.degrees)}")
        p, t = self.degrees[k], self.knots[k]
        period = self.control.shape[k] - p
        if period < p + 1:
            raise InputError(
                f"SplinePatch: direction {k} of degree {p} needs {2 * p + 1} control points to be wrapped, not "
                f"{period + p}"
            )
        shift = t[period:] - t[: len(t) - period]
        points = np.moveaxis(self.control, k, 0)
        moved = points[period:] - points[:p]
        w = np.ones(self.control.shape) if self.weights is None else self.weights
        ratio = np.divide(*(np.moveaxis(w, k, 0)[part] for part in (slice(period, None), slice(p))))
        for what, off, size in (
            ("knots", shift, np.ptp(t)),
            ("control points", moved.reshape(-1, moved.shape[-1]), np.ptp(points)),
            ("weights", ratio, ratio.max()),
        ):
            if np.ptp(off, axis=0).max() > 1e-9 * size:
                raise InputError(
                    f"SplinePatch: wrapped has direction {k}, but its last {what} are not those it begins with; repeat "
                    f"the first {p} control points, their weights and the knots between them at its end"
                )

    # --- sizes ---------------------------------------------------------------------------------------------
    @property
    def dimension(self) -> int:
        """2 or 3."""
        return len(self.degrees)

    def breaks(self, k: int) -> Array:
        """Ends of the knot spans of a direction."""
        p, t = self.degrees[k], self.knots[k]
        return np.unique(t[p : len(t) - p])

    @property
    def counts(self) -> tuple[int, ...]:
        """Knot spans by direction."""
        return tuple(len(self.breaks(k)) - 1 for k in range(self.dimension))

    @property
    def smoothness(self) -> int:
        """So many derivatives are continuous inside of it."""
        return min(p - m for p, m in zip(self.degrees, self._multiplicities(), strict=True))

    def _multiplicities(self) -> list[int]:
        found = []
        for k, p in enumerate(self.degrees):
            t = self.knots[k]
            inside = t[p + 1 : len(t) - p - 1]
            inside = inside[(inside > t[p]) & (inside < t[len(t) - p - 1])]
            most = int(np.unique(inside, return_counts=True)[1].max(initial=1))
            ends = (
                [int(np.count_nonzero(t == t[at])) for at in (p, len(t) - p - 1)] if k in self.wrapped else []
            )
            found.append(max([most, *ends]))
        return found

    # --- evaluation ----------------------------------------------------------------------------------------
    def basis(self, k: int, x: Array) -> tuple[Ints, Array]:
        """The first function (n,) that is not zero at parameters (n,), and values and two derivatives (3, n, p + 1)."""
        from scipy.interpolate import BSpline

        p, t = self.degrees[k], self.knots[k]
        n = len(t) - p - 1
        span = np.clip(np.searchsorted(t, x, side="right") - 1, p, n - 1)
        while np.any(flat := t[span] == t[span + 1]):  # at the end
            span = np.where(flat, span - 1, span)
        functions = BSpline(t, np.eye(n), p, extrapolate=True)
        middle = 0.5 * (t[span] + t[span + 1])
        place = np.where(
            np.isclose(x, t[span + 1], rtol=0, atol=1e-13 * (t[-1] - t[0])), x - 1e-15 * (x - middle), x
        )
        columns = span[:, None] - p + np.arange(p + 1)
        rows = np.arange(len(x))[:, None]
        values = [
            functions(place, nu=d)[rows, columns] if d <= p else np.zeros(columns.shape) for d in range(3)
        ]
        return span - p, np.stack(values)

    def functions(self, xi: Array) -> tuple[Ints, Array, Array, Array]:
        """Nonzero rational basis functions at parameters (n, d).

        Returns
        -------
        numbers (n, k) in the order of control points, values (n, k), gradients (n, k, d), and second
        derivatives (n, k, d, d) by the parameters.
        """
        d, shape = self.dimension, self.control.shape[:-1]
        found = [self.basis(k, xi[:, k]) for k in range(d)]
        local = [first[:, None] + np.arange(p + 1) for (first, _), p in zip(found, self.degrees, strict=True)]
        numbers = np.zeros((len(xi), 1), dtype=np.int64)
        for k in range(d):
            numbers = (numbers[:, :, None] * shape[k] + local[k][:, None, :]).reshape(len(xi), -1)

        def product(orders: Sequence[int]) -> Array:
            total = np.ones((len(xi), 1))
            for k in range(d):
                total = (total[:, :, None] * found[k][1][orders[k]][:, None, :]).reshape(len(xi), -1)
            return total

        unit = np.eye(d, dtype=int)
        N = product([0] * d)
        dN = np.stack([product(list(unit[a])) for a in range(d)], axis=2)
        H = np.stack(
            [np.stack([product(list(unit[a] + unit[b])) for b in range(d)], axis=2) for a in range(d)], axis=2
        )
        return (numbers, *self._rational(numbers, N, dN, H))

    def _rational(self, numbers: Ints, N: Array, dN: Array, H: Array) -> tuple[Array, Array, Array]:
        if self.weights is None:
            return N, dN, H
        w = self.weights.ravel()[numbers]
        N, dN, H = N * w, dN * w[:, :, None], H * w[:, :, None, None]
        W, dW, HW = N.sum(axis=1), dN.sum(axis=1), H.sum(axis=1)
        R = N / W[:, None]
        dR = (dN - R[:, :, None] * dW[:, None]) / W[:, None, None]
        cross = dR[:, :, :, None] * dW[:, None, None, :]
        HR = (H - cross - np.swapaxes(cross, 2, 3) - R[:, :, None, None] * HW[:, None]) / W[
            :, None, None, None
        ]
        return R, dR, HR

    def at(self, xi: ArrayLike) -> Array:
        """Points (n, d) of parameters (n, d)."""
        numbers, N, _, _ = self.functions(np.asarray(xi, dtype=float))
        points = self.control.reshape(-1, self.dimension)
        return np.asarray(np.einsum("nk,nkc->nc", N, points[numbers]))

    # --- others --------------------------------------------------------------------------------------------
    def refined(self, times: int) -> SplinePatch:
        """The same patch with every knot span divided into this number of spans by simple knots."""
        if times < 1:
            raise InputError(f"SplinePatch: refined({times}) needs 1 at least")
        patch = self
        for k in range(self.dimension):
            b = self.breaks(k)
            more = (b[:-1, None] + np.diff(b)[:, None] * np.arange(1, times) / times).ravel()
            for x in more:
                patch = patch._with_knot(k, float(x))
        return patch

    def _with_knot(self, k: int, x: float) -> SplinePatch:
        """Boehm's algorithm in homogeneous coordinates; at the last end, from the left."""
        p, t = self.degrees[k], self.knots[k]
        w = np.ones(self.control.shape[:-1]) if self.weights is None else self.weights
        P = np.moveaxis(np.concatenate([self.control * w[..., None], w[..., None]], axis=-1), k, 0)
        span = int(np.searchsorted(t, x, side="left" if x >= t[len(t) - p - 1] else "right")) - 1
        new = np.empty((len(P) + 1, *P.shape[1:]))
        new[: span - p + 1], new[span + 1 :] = P[: span - p + 1], P[span:]
        for i in range(span - p + 1, span + 1):
            a = (x - t[i]) / (t[i + p] - t[i])
            new[i] = a * P[i] + (1 - a) * P[i - 1]
        Q = np.moveaxis(new, 0, k)
        knots = (*self.knots[:k], np.insert(t, span + 1, x), *self.knots[k + 1 :])
        weights = None if self.weights is None else Q[..., -1]
        return replace(self, knots=knots, control=Q[..., :-1] / Q[..., -1:], weights=weights)

    def cut(self, direction: int, at: float) -> tuple[SplinePatch, SplinePatch]:
        """The same patch as two, that meet where the parameter of a direction is `at`.

        Raises
        ------
        InputError
            If that is not inside.
        """
        b = self.breaks(direction)
        if not b[0] < at < b[-1]:
            raise InputError(f"SplinePatch: cut({direction}, {at:g}) is not between {b[0]:g} and {b[-1]:g}")
        return self._between(direction, float(b[0]), at), self._between(direction, at, float(b[-1]))

    def is_clamped(self, k: int) -> bool:
        """True if the sides at both ends of a direction consist of control points."""
        p, t = self.degrees[k], self.knots[k]
        return bool(t[1] == t[p] and t[-2] == t[-p - 1])

    def clamped(self, directions: Iterable[int]) -> SplinePatch:
        """The same patch with control points on the sides that some directions end in."""
        patch = self
        for k in directions:
            if not self.is_clamped(k):
                patch = patch._between(k, *self.breaks(k)[[0, -1]])
        return patch

    def _between(self, k: int, a: float, b: float) -> SplinePatch:
        """Of parameters a to b of direction k alone: knots there, as many as the degree, make control points ends."""
        p, patch = self.degrees[k], self
        for x in (a, b):
            while np.count_nonzero(patch.knots[k] == x) < p:
                patch = patch._with_knot(k, x)
        t = patch.knots[k]
        after, before = int(np.searchsorted(t, a, side="right")), int(np.searchsorted(t, b, side="left"))
        kept = (slice(None),) * k + (slice(after - p - 1, before),)
        ends = [np.full(p + 1, a), t[after:before], np.full(p + 1, b)]
        return replace(
            patch,
            knots=(*patch.knots[:k], np.concatenate(ends), *patch.knots[k + 1 :]),
            control=patch.control[kept],
            weights=None if patch.weights is None else patch.weights[kept],
            wrapped=tuple(w for w in patch.wrapped if w != k),
        )

    def parts(self, periodic: Sequence[int] = ()) -> tuple[SplinePatch, ...]:
        if missing := set(periodic) - set(self.wrapped):
            raise InputError(
                f"SplinePatch: nothing says that it is smooth across the ends of direction {min(missing)}: repeat its "
                "first control points at its end and say wrapped=..., or take vv.SplineBox where that is its shape"
            )
        return (self.clamped(k for k in range(self.dimension) if k not in periodic),)

    def sampled(self, samples: int) -> tuple[Mesh, Array]:
        """A mesh with this number of cells along each knot span, and the parameters (n_nodes, d) of its nodes."""
        counts = [samples * n for n in self.counts]
        grid = Grid(counts, "quad4" if self.dimension == 2 else "hex8")
        xi = np.empty_like(grid.places)
        for k in range(self.dimension):
            b = self.breaks(k)
            xi[:, k] = np.interp(grid.places[:, k] * (len(b) - 1), np.arange(len(b)), b)
        return grid.mesh(self.at(xi), SIDES[: self.dimension]), xi


@dataclass(frozen=True)
class SplineBox(SplineSource):
    """Splines on a rectangle or cuboid with edges along the axes, with equal knot spans.

    Parameters
    ----------
    size : two or three lengths
    counts : two or three numbers
        Knot spans along each edge.
    degree : int
        1 to 4; a spline of degree p has p - 1 continuous derivatives.
    origin : point, optional
        The corner with the least coordinates.

    Examples
    --------
    >>> SplineBox(size=(2, 1), counts=(4, 2), degree=3).parts()[0].control.shape
    (7, 5, 2)
    """

    size: Annotated[tuple[float, ...], LISTED]
    counts: Annotated[tuple[int, ...], LISTED]
    degree: int = 2
    origin: Annotated[tuple[float, ...], LISTED] = ()

    def __post_init__(self) -> None:
        if len(self.size) not in (2, 3) or len(self.counts) != len(self.size):
            raise InputError(
                f"SplineBox: size {self.size} and counts {self.counts} need two or three numbers each"
            )
        if not (min(self.size) > 0 and min(self.counts) >= 1):
            raise InputError(f"SplineBox: size {self.size} and counts {self.counts} need positive numbers")
        if not 1 <= self.degree <= 4:
            raise InputError(f"SplineBox: degree = {self.degree} is not between 1 and 4")
        if self.origin and len(self.origin) != len(self.size):
            raise InputError(f"SplineBox: origin {self.origin} needs {len(self.size)} coordinates")

    def parts(self, periodic: Sequence[int] = ()) -> tuple[SplinePatch, ...]:
        p, knots, greville = self.degree, [], []
        origin = self.origin or (0.0,) * len(self.size)
        for k, (length, n) in enumerate(zip(self.size, self.counts, strict=True)):
            if k in periodic and n < p + 1:
                raise InputError(
                    f"SplineBox: a periodic direction of degree {p} needs {p + 1} spans at least, not {n}"
                )
            ends = np.arange(-p, n + p + 1)
            t = length / n * (ends if k in periodic else np.clip(ends, 0, n))
            knots.append(t)
            greville.append(origin[k] + np.stack([t[i + 1 : i + p + 1].mean() for i in range(n + p)]))
        control = np.stack(np.meshgrid(*greville, indexing="ij"), axis=-1)
        return (
            SplinePatch(degrees=(p,) * len(self.size), knots=knots, control=control, wrapped=tuple(periodic)),
        )
