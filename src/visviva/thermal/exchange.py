"""Terms by which heat passes from one body to another, over surfaces that need not match."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visviva.model.term import Stencils, Term
from visviva.thermal.carrier import HeatCarrier

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Columns = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Side:
    """Nodes (m, k) of a body that takes part in an exchange, and the columns of a stencil that are theirs.

    Attributes
    ----------
    unknowns : int array (m, c)
        Of the balances at the nodes, then, where these are of entropy, of their temperatures, each mode by mode.
    columns : int array (c,)
        Of these in the stencil.
    is_entropy : bool
        Whether entropy is balanced: heat counts by the temperature at which it passes, that of the step.
    modes : array (n,)
        What the temperatures of a node count for at the faces, see `HeatCarrier.heat_modes`.
    """

    unknowns: NDArray[np.int32]
    columns: Columns
    is_entropy: bool
    modes: Array

    @classmethod
    def of(cls, body: HeatCarrier, nodes: Ints, modes: Array, first: int) -> Side:
        """Of a body, with columns from the first on."""
        fields = [body.balance_unknowns(nodes)]
        if body.balances_entropy:
            fields.append(body.temperature_unknowns(nodes))
        unknowns = np.hstack([field + i for field in fields for i in range(len(modes))])
        return cls(unknowns, first + np.arange(unknowns.shape[1]), body.balances_entropy, modes)

    @property
    def order(self) -> NDArray[np.int32]:
        """In time, of the unknowns."""
        found = np.ones(len(self.columns), dtype=np.int32)
        if self.is_entropy:
            found[len(found) // 2 :] = 0
        return found

    @property
    def balances(self) -> Columns:
        """Columns of the balances (n, k)."""
        own = self.columns[: len(self.columns) // 2] if self.is_entropy else self.columns
        return own.reshape(len(self.modes), -1)

    @property
    def warmth(self) -> Columns:
        """Columns of the temperatures (n, k)."""
        own = self.columns[len(self.columns) // 2 :] if self.is_entropy else self.columns
        return own.reshape(len(self.modes), -1)

    def temperatures(self, s: Stencils, at_end: bool = False) -> tuple[Array, float]:
        """At which heat passes (m, k), and their derivative by the end of the step."""
        x, rise = (s.x1, 1.0) if self.is_entropy or at_end else (s.x, s.step.theta)
        return np.einsum("i,mik->mk", self.modes, x[:, self.warmth]), rise

    def give(self, found: Array, amount: Array) -> None:
        """Add an amount (m, k) at the nodes to the residual of their balances."""
        for mode, columns in zip(self.modes, self.balances, strict=True):
            found[:, columns] += mode * amount

    def give_slopes(self, K: Array, other: Side, block: Array) -> None:
        """Add its derivatives (m, k, l) by the temperatures of another side."""
        for mode, rows in zip(self.modes, self.balances, strict=True):
            for share, columns in zip(other.modes, other.warmth, strict=True):
                K[np.ix_(np.arange(len(K)), rows, columns)] += mode * share * block


class HeatExchange(Term):
    """Heat ``conductance (T1 - T2)`` per area from one body to another, at points that both share.

    Parameters
    ----------
    bodies, nodes, modes : of both, nodes (m, k1) and (m, k2), and modes of their faces
    N : shape functions (m, q, k1) and (m, q, k2) of both
    size : array (m, q)
        Areas of the points.
    conductance : float
    """

    kind = "exchange"
    brings = "heat"

    def __init__(
        self,
        bodies: Sequence[HeatCarrier],
        nodes: Sequence[Ints],
        modes: Sequence[Array],
        N: Sequence[Array],
        size: Array,
        conductance: float,
    ) -> None:
        super().__init__()
        first = Side.of(bodies[0], nodes[0], modes[0], 0)
        self.sides = first, Side.of(bodies[1], nodes[1], modes[1], len(first.columns))
        self.unknowns = np.ascontiguousarray(
            np.hstack([side.unknowns for side in self.sides]), dtype=np.int32
        )
        self.order = np.concatenate([side.order for side in self.sides])
        self.N, self.size, self.conductance = N, size, conductance
        self.produces = all(side.is_entropy for side in self.sides)

    def passes(self, s: Stencils) -> tuple[list[Array], list[float], Array]:
        """Temperatures (m, q) of both at the points, their derivatives, and the heat (m, q) from first to second."""
        T, slope = zip(*(side.temperatures(s) for side in self.sides), strict=True)
        at = [np.einsum("mqk,mk->mq", N, t) for N, t in zip(self.N, T, strict=True)]
        return at, list(slope), self.size * self.conductance * (at[0] - at[1])

    def residual(self, s: Stencils) -> Array:
        T, _, heat = self.passes(s)
        found = np.zeros_like(s.x1)
        for side, N, at, sign in zip(self.sides, self.N, T, (1.0, -1.0), strict=True):
            amount = heat / at if side.is_entropy else heat
            side.give(found, sign * np.einsum("mqk,mq->mk", N, amount))
        return found

    def tangent(self, s: Stencils) -> Array:
        T, slope, heat = self.passes(s)
        K = np.zeros((*s.x1.shape, s.x1.shape[1]))
        conductance = self.size * self.conductance
        for side, N, at, sign in zip(self.sides, self.N, T, (1.0, -1.0), strict=True):
            by = 1 / at if side.is_entropy else np.ones_like(at)
            for other, M, rise, turn in zip(self.sides, self.N, slope, (1.0, -1.0), strict=True):
                change = turn * conductance * by
                if other is side and side.is_entropy:
                    change = change - heat * by**2
                block = np.einsum("mqk,mql->mkl", (sign * rise * change)[:, :, None] * N, M)
                side.give_slopes(K, other, block)
        return K

    def work(self, s: Stencils) -> Array:
        return np.zeros(len(s.x1))


class HeatBond(Term):
    """Temperatures of two bodies that are the same, ``rows . T = 0``, by the heat that passes.

    The multiplier of a row is the heat per time that its weights carry from the positive to the negative ones, and the
    entropy where both bodies balance that: with weights that add up to nothing neither heat nor entropy is made.

    Parameters
    ----------
    body : HeatCarrier of each column
    multipliers : int array (m,)
    nodes : int array (m, r1) and (m, r2)
        Of both bodies, -1 where a row has fewer.
    modes : arrays
        Of the faces of both.
    weights : arrays (m, r1) and (m, r2)
    """

    kind = "exchange"
    brings = "heat"

    def __init__(
        self,
        bodies: Sequence[HeatCarrier],
        multipliers: NDArray[np.int32],
        nodes: Sequence[Ints],
        modes: Sequence[Array],
        weights: Sequence[Array],
    ) -> None:
        super().__init__()
        first = Side.of(bodies[0], np.maximum(nodes[0], 0), modes[0], 1)
        second = Side.of(bodies[1], np.maximum(nodes[1], 0), modes[1], 1 + len(first.columns))
        self.bodies, self.sides, self.weights = tuple(bodies), (first, second), weights
        self.produces = all(side.is_entropy for side in self.sides)
        parts = [multipliers[:, None]]
        for side, of in zip(self.sides, nodes, strict=True):
            there = np.tile(of >= 0, (1, len(side.modes) * (1 + side.is_entropy)))
            parts.append(
                np.where(there, side.unknowns, multipliers[:, None])
            )  # what is not there weighs nothing
        self.unknowns = np.ascontiguousarray(np.hstack(parts), dtype=np.int32)
        self.order = np.concatenate([np.zeros(1, dtype=np.int32), first.order, second.order])
        self.there = [of >= 0 for of in nodes]
        self._divided = [
            side.is_entropy and not (first.is_entropy and second.is_entropy) for side in self.sides
        ]  # where what flows is heat, and entropy is balanced
        self._missed = np.zeros(len(multipliers))
        self.at_end = not (first.is_entropy or second.is_entropy)

    def jump(self, x: Array) -> tuple[Array, Array]:
        """What rows (m,) miss their constraints by at all unknowns of the system, and its size at the bodies' warmest.

        Not that of the temperatures there: ties in degrees Celsius may meet at zero, where these are rounding.
        """
        parts = [
            w * np.einsum("i,mik->mk", side.modes, x[self.unknowns[:, side.warmth]])
            for side, w in zip(self.sides, self.weights, strict=True)
        ]
        warmest = max(float(np.abs(x[np.asarray(b.warmth[1].unknowns)]).max()) for b in self.bodies)
        return sum(p.sum(axis=1) for p in parts), warmest * sum(np.abs(w).sum(axis=1) for w in self.weights)

    @contextmanager
    def closing(self, part: float, x: Array) -> Iterator[None]:
        """Inside, steps of midpoint rules from the state `x` close a part of what constraints miss there, by heat."""
        jump, before = self.jump(x)[0], self._divided
        self._missed = (1 - part) * jump if self.at_end else (1 - 0.5 * part) * jump
        self._divided = [side.is_entropy for side in self.sides]
        try:
            yield
        finally:
            self._divided, self._missed = before, np.zeros(len(jump))

    def _temperatures(self, s: Stencils) -> list[tuple[Array, float]]:
        return [side.temperatures(s, self.at_end) for side in self.sides]

    def residual(self, s: Stencils) -> Array:
        found = np.zeros_like(s.x1)
        found[:, 0] = -self._missed
        data = zip(self.sides, self.weights, self._temperatures(s), self._divided, self.there, strict=True)
        for side, w, (T, _), divided, there in data:
            found[:, 0] += np.sum(w * T, axis=1)
            amount = w * s.x1[:, :1]
            side.give(found, amount / np.where(there, T, 1.0) if divided else amount)
        return found

    def tangent(self, s: Stencils) -> Array:
        K = np.zeros((*s.x1.shape, s.x1.shape[1]))
        data = zip(self.sides, self.weights, self._temperatures(s), self._divided, self.there, strict=True)
        for side, w, (T, rise), divided, there in data:
            by = np.where(there, T, 1.0)
            side.give(K[:, :, 0], w / by if divided else w)
            for mode, columns in zip(side.modes, side.warmth, strict=True):
                K[:, 0, columns] += mode * rise * w
            if divided:
                side.give_slopes(K, side, -(w * s.x1[:, :1] / by**2)[:, :, None] * np.eye(w.shape[1]))
        return K

    def work(self, s: Stencils) -> Array:
        return np.zeros(len(s.x1))
