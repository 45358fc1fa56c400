"""Bodies leaving a fluid: the face through which a place has gone, and the displaced fluid that stays behind."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.flow.boundary_faces import flow_faces
from visviva.model.term import Stencils, Term

if TYPE_CHECKING:
    from visviva.flow.conditions import Condition
    from visviva.flow.fluid import Fluid

Array = NDArray[np.float64]


def gone_through(fluid: Fluid, place: Array, time: float) -> tuple[Condition | None, bool]:
    """The condition at the nearest face that a place (d,) outside lies beyond, and whether fluid may leave there."""
    (image,) = next(fluid.periods.images(place[None, :]))
    nearest: tuple[float, Condition | None, bool] = np.inf, None, False
    for condition in fluid.conditions.listed:
        velocity = condition.velocities_at(time)
        for p in flow_faces(fluid.grid, condition.chosen):
            middle, outward = p.X[:, :, : len(image)].mean(axis=1), p.normal.sum(axis=1)
            beyond = np.einsum("mi,mi->m", image - middle, outward) > 0
            away = np.where(beyond, np.linalg.norm(image - middle, axis=1), np.inf)
            k = int(np.argmin(away))
            if away[k] < nearest[0]:
                out = float(np.einsum("qk,qi,ki->", p.N[k], p.normal[k], velocity[p.nodes[k]])) > 0
                nearest = float(away[k]), condition, condition.is_open or out
    return nearest[1:]


class Displaced(Term):
    """Inertia and weight of the fluid that a body displaces, as far as the body is within the fluid.

    What a body no longer displaces where it has left belongs to the fluid that went through the opening with it: its
    kinetic energy is booked as work of the account "displaced".

    Parameters
    ----------
    unknowns : int array (n, k d)
        Of nodes, or of origin and directors.
    mass : array (n, k, k)
        Of elements of displaced fluid, negative.
    origins : bool array (k,)
        Which of these are positions.
    share : callable
        The part of each (n,) that is within the fluid in the present step.
    acceleration : callable
        Of gravity (d,).
    """

    kind, stores = "displaced", "kinetic"

    def __init__(
        self,
        unknowns: Any,
        mass: Array,
        origins: NDArray[np.bool_],
        share: Callable[[], Array | None],
        acceleration: Callable[[], Array],
    ) -> None:
        super().__init__()
        self.unknowns, self.mass, self.origins = np.asarray(unknowns, dtype=np.int32), mass, origins
        self.order = np.full(unknowns.shape[1], 2, dtype=np.int32)
        self._shape = len(mass), mass.shape[1], unknowns.shape[1] // mass.shape[1]
        self._share, self._acceleration = share, acceleration
        self.history = {"share": np.ones(len(mass))}  # at the end of the last step

    @property
    def _now(self) -> Array:
        """The share (n,) in the step under way."""
        return self.trial.get("share", self.history["share"])

    def _times_mass(self, x: Array) -> Array:
        return np.asarray(np.einsum("nab,nbc->nac", self.mass, x.reshape(self._shape)))

    def _weight(self) -> Array:
        """Forces (n, k, d) that hold up."""
        return np.asarray(
            np.einsum("nab,b,c->nac", self.mass, self.origins.astype(float), self._acceleration())
        )

    def residual(self, s: Stencils) -> Array:
        found = self._share()
        if found is not None:
            self.trial["share"] = found
        force = self._times_mass(s.second_rate) - self._weight()
        return np.asarray(self._now[:, None] * force.reshape(len(self.mass), -1))

    def tangent(self, s: Stencils) -> Array:
        n, k, d = self._shape
        blocks = np.einsum("nab,ij->naibj", self.mass, np.eye(d)).reshape(n, k * d, k * d)
        return np.asarray(s.step.second_rate_factor * self._now[:, None, None] * blocks)

    def _kinetic(self, v: Array) -> Array:
        return np.asarray(0.5 * np.einsum("nac,nac->n", v.reshape(self._shape), self._times_mass(v)))

    def energy(self, s: Stencils) -> Array:
        return self._now * self._kinetic(s.v1)

    def work(self, s: Stencils) -> Array:
        moved = (s.x1 - s.x0).reshape(self._shape)
        weight = np.einsum("nac,nac->n", moved, self._weight())
        gone = self.history["share"] - self._now
        return np.asarray(self._now * weight - gone * self._kinetic(s.v0))

    def momentum(self, s: Stencils) -> Array:
        n, k, d = self._shape
        x, p = np.zeros((2, n, k, 3))
        x[:, :, :d] = s.x1.reshape(self._shape)
        p[:, :, :d] = self._now[:, None, None] * self._times_mass(s.v1)
        return np.hstack([p[:, self.origins].sum(axis=1), np.cross(x, p).sum(axis=1)])

    def accept(self, s: Stencils) -> None:
        self.history["share"] = self._now.copy()
