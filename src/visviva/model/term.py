"""Terms written in Python: batches of equal stencils with residual, tangent, energy, history if wanted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.base.errors import NO_VALUE, NotFinite, RunError, VisvivaError
from visviva.model.entropies import PRODUCED, SUPPLIED

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Stencils:
    """Unknowns of a term's elements over a step; all arrays (n, n_local).

    Attributes
    ----------
    step : Step
        ``t0, t1, te, h, theta, theta_g, discrete_gradient`` of the step. The books of `Static`, `BDF2` and
        `GeneralizedAlpha` ask for the forces at the start of an accepted step by going it backwards: from x1 to x0
        with ``h < 0``. Increments over h are rates there as well, but nothing evolves: ``has_length`` is False, as
        at an instant, and the history to work with is that at the start of the step.
    x0, x1 : array
        Unknowns at both ends.
    rate, second_rate : array
        Rates of motion and transport unknowns at the evaluation point, second rates of motion.
    v1 : array
        Rates at the end of an accepted step (for the ledger).
    v0 : array
        Rates at the start of the step.
    """

    step: Any
    x0: Array
    x1: Array
    rate: Array
    second_rate: Array
    v1: Array
    v0: Array

    @property
    def x(self) -> Array:
        """Unknowns at the evaluation point ``x0 + theta (x1 - x0)``."""
        x: Array = self.x0 + self.step.theta * (self.x1 - self.x0)
        return x


class Term:
    """Base of terms in Python.

    A subclass sets `unknowns` (n, n_local), `order` (n_local,) of its unknowns, and defines `residual`; the
    rest is optional: without `tangent` the residual is differentiated numerically, without `energy` the
    ledger books the term's work, ``-residual . dx`` unless `work` says otherwise (as it must for unknowns of
    order 1). With `energy` a `work` of its own is what the term does beside storing that: a damper's loss, say.

    Attributes
    ----------
    kind : str
        Name of its column in the ledger.
    stores : str
        'potential' or 'kinetic': what its energy, if it has one, counts as.
    brings : str
        'work' or 'heat': what its work counts as.
    produces : bool
        Whether the entropy that it brings arises and is never lost; else it comes from outside or goes there.
    history : dict of arrays
        State of its own; changed in `accept` only, and kept in restart files.
    trial : dict of arrays
        What the residual has found of the same names, for the tangent and the books of the same trial state.

    Notes
    -----
    The ledger's momenta are those of what stores kinetic energy: by its derivatives with respect to the rates of
    points and directors of components, unless `momentum` says otherwise (as it must where the velocities are
    no rates of those).
    """

    unknowns: NDArray[np.int32]
    order: NDArray[np.int32]
    kind = "user"
    stores = "potential"
    brings = "work"
    produces = False
    label = "user term"

    def __init__(self) -> None:
        self.history: dict[str, Array] = {}
        self.trial: dict[str, Array] = {}
        self.history_at_tangent: dict[
            str, Array
        ] = {}  # when the tangent last asked for was made, for restarts
        self.history_before: dict[str, Array] = {}  # when the step accepted last began, for its forces

    def residual(self, s: Stencils) -> Array:
        """Contribution (n, n_local) to the equations of its unknowns."""
        raise NotImplementedError

    def tangent(self, s: Stencils) -> Array:
        """Derivative (n, n_local, n_local) of the residual with respect to `x1`, rates included."""
        return numerical_tangent(self, s)

    energy: Callable[[Stencils], Array] | None = None
    """Energy (n,) at the end of the step, if the term stores energy."""

    def work(self, s: Stencils) -> Array:
        """Work (n,) that the term does over the step."""
        w: Array = -np.einsum("ij,ij->i", self.residual(s), s.x1 - s.x0)
        return w

    def momentum(self, s: Stencils) -> Array:
        """Linear and angular momentum (n, 6) at the end of the step."""
        total = np.zeros((len(s.x1), 6))
        if self.energy is None or not self._places:
            return total
        columns = np.array([c for place in self._places for c in place.columns])
        p = np.zeros_like(s.x1)
        p[:, columns] = kinetic_momenta(self.energy, s, columns)
        for place in self._places:
            x, part = np.zeros((2, len(total), 3))
            x[:, place.axes], part[:, place.axes] = s.x1[:, place.columns], p[:, place.columns]
            total[:, :3] += part if place.is_position else 0.0
            total[:, 3:] += np.cross(x, part)
        return total

    def accept(self, s: Stencils) -> None:
        """The step is accepted: update `history`."""

    look: Callable[[Array], None] | None = None
    """Called with all unknowns of the system where a step begins; the array is valid during the call alone."""

    # --- hand-over to the core -----------------------------------------------------------------------------
    def rate_factors(self, step: Any) -> tuple[Array, Array]:
        """Derivatives of rate and second rate with respect to `x1`, by local unknown."""
        first = np.choose(self.order, [0.0, step.transport_factor, step.rate_factor])
        second = np.where(self.order == 2, step.second_rate_factor, 0.0)
        return first, second

    def build(self, model: Model, component: int) -> _core.Term:
        """The core's term that calls this one."""
        owner = model.components[component]
        self.label = owner.label
        n = len(self.unknowns)
        stores = self.energy is not None
        self._works = not stores or type(self).work is not Term.work
        account = model.account(owner, self.kind, self.stores if stores else self.brings)
        index = np.ascontiguousarray(self.unknowns, dtype=np.int32)
        moving = n and self.stores == "kinetic" and self.energy is not None
        self._places = places(model, index[0]) if moving else []
        self._scale = scale_of(model, index[0]) if n else np.zeros(0)
        # The core keeps weak references only (a term may know its system); they live here.
        self._calls = self._residual, self._tangent, self._ledger, self._accept
        term = _core.CallbackTerm(index, *self._calls)
        if self._works:
            term.work_account = model.account(owner, self.kind, self.brings)
        if self.look is not None:
            self._looks = self.look
            term.ask_to_look(self._looks, model.n_unknowns)
        term.name = owner.label
        if model.entropies.touches(index):
            term.entropy_account = model.account(owner, self.kind, PRODUCED if self.produces else SUPPLIED)
        term.book(np.full(n, account, dtype=np.int32), np.full(n, component, dtype=np.int32))
        return term

    def _residual(self, *args: Any) -> None:
        self._hand(args[6], "residual", self.residual, seen(args))

    def _tangent(self, *args: Any) -> None:
        if args[0].has_length:  # that of an instant is not kept
            self.history_at_tangent = copies(self.label, self.history | self.trial)
        self._hand(args[7], "tangent", self.tangent, seen(args))

    def _ledger(self, *args: Any) -> None:
        s = seen(args)
        if self.energy is not None:
            self._hand(args[8], "energy", self.energy, s)
        if self._works:
            self._hand(args[9], "work", self.work, s)
        self._hand(args[10], "momentum", self.momentum, s)

    def _hand(self, room: Array, what: str, function: Callable[[Stencils], Array], s: Stencils) -> None:
        """Values for the core; of states that are tried there may be none, and no warnings are due."""
        try:
            with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
                found = function(s)
        except VisvivaError:
            raise
        except NO_VALUE as error:
            raise NotFinite(f"{self.label}: its {what} raised {type(error).__name__}: {error}") from error
        room[:] = checked(self.label, what, found, room.shape)

    def _accept(self, *args: Any) -> None:
        self.history_before = copies(self.label, self.history)
        self.accept(seen(args))


def copies(label: str, history: dict[str, Array]) -> dict[str, Array]:
    """A history that stays as it is now.

    Raises
    ------
    RunError
        If a value is no array of numbers, which could not be kept in restart files.
    """
    for name, value in history.items():
        if not isinstance(value, np.ndarray | np.generic) or value.dtype.hasobject:
            raise RunError(
                f"{label}: history[{name!r}] = {value!r} is no array of numbers; keep np.array({value!r})"
            )
    return {name: value.copy() for name, value in history.items()}


def seen(args: tuple[Any, ...]) -> Stencils:
    """Values of a step as the core passes them."""
    step, x0, x1, rate, second_rate, v1 = args[:6]
    return Stencils(step, x0, x1, rate, second_rate, v1, v0=args[11])


@dataclass(frozen=True)
class Place:
    """A point or director among the unknowns of a stencil: its columns, and which coordinates they are."""

    columns: list[int]
    axes: list[int]
    is_position: bool


def places(model: Model, unknowns: NDArray[np.int32]) -> list[Place]:
    """The points and directors of components that a stencil (n_local,) sees; others of a batch are alike."""
    owner: dict[int, tuple[int, int, bool]] = {}
    for component in model.components:
        starts, positions, width = component.vectors(model) or ((), (), 0)
        for start, is_position in zip(starts, positions, strict=True):
            owner |= {int(start) + c: (int(start), c, bool(is_position)) for c in range(width)}
    found: dict[int, Place] = {}
    for column, unknown in enumerate(unknowns.tolist()):
        if unknown in owner:
            start, axis, is_position = owner[unknown]
            place = found.setdefault(start, Place([], [], is_position))
            place.columns.append(column)
            place.axes.append(axis)
    return list(found.values())


def kinetic_momenta(energy: Callable[[Stencils], Array], s: Stencils, columns: Array) -> Array:
    """Derivatives (n, k) of an energy by the rates in some columns; exact for squares of rates."""
    p = np.empty((len(s.v1), len(columns)))
    d = 1e-3 * max(1.0, float(np.abs(s.v1).max(initial=0.0)))
    for k, column in enumerate(columns):
        ends = []
        for sign in (1.0, -1.0):
            v1 = s.v1.copy()
            v1[:, column] += sign * d
            ends.append(np.asarray(energy(replace(s, v1=v1))))
        p[:, k] = (ends[0] - ends[1]) / (2 * d)
    return p


def checked(label: str, what: str, value: Any, shape: tuple[int, ...]) -> Array:
    """The array a user's function returned, or an error that names whose it is."""
    a = np.asarray(value, dtype=float)
    if a.shape != shape:
        raise RunError(f"{label}: its {what} has shape {a.shape}, expected {shape}")
    if not np.all(np.isfinite(a)):
        raise NotFinite(f"{label}: its {what} is not finite: {a[~np.isfinite(a)][:3].tolist()}")
    return a


SMALL = 0.1
"""Of the scale of an unknown: differences are no shorter than those of a value of this size."""


def scale_of(model: Model, unknowns: NDArray[np.int32]) -> Array:
    """Sizes (nl,) at which changes of unknowns are large, 1 where none is told."""
    scale = np.ones(len(unknowns))
    for f in model.fields:
        own = (unknowns >= f.start) & (unknowns < f.start + f.size)
        scale[own] = f.scale[unknowns[own] - f.start]
    return np.where(scale > 0, scale, 1.0)


def numerical_tangent(term: Term, s: Stencils) -> Array:
    """Central differences of a term's residual, over parts of the sizes of what it sees and may see."""
    n, nl = s.x1.shape
    K = np.empty((n, nl, nl))
    first, second = term.rate_factors(s.step)
    scale = getattr(term, "_scale", np.ones(nl))
    for j in range(nl):
        d = 6e-6 * max(SMALL * scale[j], float(np.abs(s.x1[:, j]).max()))
        ends = []
        for sign in (1.0, -1.0):
            x1, rate, acc = s.x1.copy(), s.rate.copy(), s.second_rate.copy()
            x1[:, j] += sign * d
            rate[:, j] += sign * d * first[j]
            acc[:, j] += sign * d * second[j]
            ends.append(term.residual(replace(s, x1=x1, rate=rate, second_rate=acc)))
        K[:, :, j] = (ends[0] - ends[1]) / (2 * d)
    return K
