"""Bodies with a scalar field that separates into phases, on meshes that stand still."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visviva.base.errors import InputError, NotFinite, nearest
from visviva.body.space import MeshSpace, ScalarSpace, Table
from visviva.body.spline_space import SplineSpace
from visviva.component.announcements import Given
from visviva.component.limited import Limited
from visviva.component.meshed import Meshed, refuse_thickness
from visviva.component.values import Matrix, Number, NumberAtPlace, positive_tensor
from visviva.mesh.faces import Faces, chosen_faces, chosen_nodes
from visviva.mesh.generate import MeshSource
from visviva.mesh.mesh import Mesh
from visviva.mesh.spline import SplineSource
from visviva.model.callback import Function
from visviva.model.field import FAINT, Field, Role
from visviva.model.points import Group
from visviva.phase.free_energy import FreeEnergy, UserFreeEnergy, temperature_at
from visviva.phase.interface import Interface, interface, tells_all
from visviva.phase.mobility import Mobility

if TYPE_CHECKING:
    from visviva._core import PointTerm
    from visviva.model.field import Owner
    from visviva.model.model import Model

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


WARMER = 0.01
"""Of temperatures, by which steps of those are apart at which interfaces are looked at ahead."""
ABOUT = 0.01
"""Of the values of a field, about which phases are seen that are looked for there."""
PASSED = 101
"""Values between the least and the largest of a field, all of which it has somewhere."""
NEAR_PURE = 0.01
"""Phases nearer to the ends of logarithms than this pass them by what interfaces overshoot."""


class PhaseBody(Limited, Meshed):
    """Base of bodies with a concentration or an order parameter.

    Attributes
    ----------
    phase : Field
        Its coefficients, once it is part of a system.
    space : ScalarSpace
    start_values : array (n,)
        At the nodes, at the start.
    scale : float
        A large change of the field, once it is part of a system.
    """

    mesh: Mesh | MeshSource | SplineSource
    free_energy: FreeEnergy
    gradient_energy: Number | Matrix
    periodic: Any
    thickness: Number
    phase: Field
    space: ScalarSpace
    start_values: Array
    quantity: str
    _mobility: Mobility
    potential: Field | None = None
    level_at_sides = False
    scale: float
    _found: tuple[FreeEnergy, Interface | None] | None = None
    _resolved: frozenset[int] = frozenset()
    """Temperatures, counted by their logarithm, at which interfaces are known to be wide enough."""
    _seen: tuple[tuple[float, float], ...] = ()
    """Where phases have been looked for on the way."""
    cure = "take a mesh of cells without nodes between their corners"
    """Of logarithms that act inside of elements only."""
    lumps = True
    """Whether logarithms are summed at the corners of cells, where they keep the field inside of their domain."""

    def _prepare(self, given: NumberAtPlace) -> None:
        """Mesh, space, start values, and what is refused of them."""
        self._tensor = positive_tensor(self.label, "gradient_energy =", self.gradient_energy)
        try:
            self.space = self._space()
        except InputError as error:
            raise InputError(f"{self.label}: {error}") from None
        self.grid = self.space.grid
        refuse_thickness(self.label, self.thickness, self.grid.points.shape[1])
        self.start_values = self._sampled(given)
        self._refuse_outside()
        self._refuse_missed()
        for time in (0.0, *self.free_energy.turns):
            self._refuse_thin_interface(time)

    def _space(self) -> ScalarSpace:
        if isinstance(self.mesh, SplineSource):
            return SplineSpace(self.mesh, self.periodic, self.thickness, self.level_at_sides)
        grid = (self.mesh.build() if isinstance(self.mesh, MeshSource) else self.mesh).check()
        return MeshSpace(
            grid,
            self.periodic,
            self.thickness,
            label=self.label,
            at_corners=self.lumps and self.free_energy.has_domain,
        )

    def _sampled(self, given: NumberAtPlace) -> Array:
        found = given(self.points.copy()) if callable(given) else given
        values = np.asarray(found, dtype=float)
        if values.shape not in ((), (self.grid.n_nodes,)) or not np.all(np.isfinite(values)):
            raise InputError(
                f"{self.label}: its {self.quantity} has shape {values.shape}, or is not finite, for "
                f"{self.grid.n_nodes} places (n, 3); it must give n finite numbers"
            )
        return np.array(np.broadcast_to(values, (self.grid.n_nodes,)))

    def _refuse_outside(self) -> None:
        low, high = self.free_energy.domain
        off = np.flatnonzero((self.start_values <= low) | (self.start_values >= high))
        if len(off):
            at = ", ".join(f"{x:.4g}" for x in self.points[off[0]])
            raise InputError(
                f"{self.label}: its {self.quantity} is {self.start_values[off[0]]:g} at ({at}), outside of the "
                f"logarithms of {type(self.free_energy).__name__}, which hold "
                f"between {low:g} and {high:g}; start a little inside"
            )

    def _refuse_missed(self) -> None:
        missed = np.flatnonzero(self._mobility.missed(self.start_values))
        if len(missed):
            said = self._mobility.missing(float(self.start_values[missed[0]]))
            raise InputError(f"{self.label}: at the start {self._a} of {said}")

    @property
    def _start(self) -> tuple[float, float]:
        """Least and largest value at the start."""
        return float(self.start_values.min()), float(self.start_values.max())

    def interface(self, time: float = 0.0) -> Interface | None:
        """The flat interface between its phases at a time, across the direction of the least gradient energy."""
        energy = self.free_energy.at(time)
        if self._found is None or self._found[0] is not energy:
            self._found = energy, self._interface_of(energy)
        return self._found[1]

    def _interface_of(self, energy: FreeEnergy, start: tuple[float, float] | None = None) -> Interface | None:
        stiffnesses = np.linalg.eigvalsh(self._stiffness)
        found = interface(energy, float(stiffnesses.min()), start or self._start)
        return found and replace(found, alike=bool(np.ptp(stiffnesses) <= 1e-12 * stiffnesses.max()))

    @property
    def _stiffness(self) -> Array:
        """Its gradient energy (d, d) in the directions of its mesh."""
        d = self.grid.points.shape[1]
        return full(self._tensor)[:d, :d]

    def _refuse_thin_interface(self, time: float) -> None:
        try:
            found = self.interface(time)
        except NotFinite as error:
            raise InputError(
                f"{self.label}: {error}; it starts between {self._start[0]:g} and {self._start[1]:g}: let it have "
                "values there and in between, or take vv.FloryHuggins or vv.RegularSolution for logarithms"
            ) from None
        self._refuse_thin(found, f" at t = {time:g}" if time else "")

    def _refuse_thin(self, found: Interface | None, where: str) -> None:
        if found is None or not self._is_thin(found):
            return
        width, spacing = self._resolution(found)
        wider = 2 * spacing / width
        raise InputError(
            f"{self.label}: an interface is {width:.3g} wide{where}, the distance of its nodes {spacing:.3g}: less "
            f"than two cells resolve it; take cells of {width / 4:.2g}, or a gradient_energy of "
            f"{float(np.max(self._tensor)) * wider * wider:.3g} at least"
        )

    def _refuse_thin_beyond(self, c: Array) -> None:
        """Refuse thin interfaces between phases that are not those nearest to the start, or not seen from there.

        What bends down separates: where it does so between the least and the largest of coefficients `c` for the first
        time, phases are looked for about that.

        Raises
        ------
        InputError
        """
        if self._sees_all:
            return
        at = self._first_bent(c)
        if at is None:
            return
        found, way = self._interface_of(self.free_energy, (at, at)), ABOUT * max(float(np.ptp(c)), abs(at))
        if found is not None:
            self._refuse_thin(found, f", between {found.low:.6g} and {found.high:.6g}")
            self._seen = (*self._seen, (found.low, found.high))
        self._seen = (*self._seen, (at - way, at + way))

    @cached_property
    def _sees_all(self) -> bool:
        """Whether it has no phases but those between which interfaces were looked at from the start."""
        found = self.interface()
        return tells_all(self.free_energy.at(0.0)) and (found is None or found.alone)

    def _first_bent(self, c: Array) -> float | None:
        """A value at or between coefficients at which the energy bends down, and no phases were looked for yet."""
        found, c = self.interface(), np.concatenate([c, np.linspace(c.min(), c.max(), PASSED)])
        try:
            off = self.free_energy.curvatures(c) < 0
        except NotFinite:
            return None
        for low, high in (*self._seen, *([(found.low, found.high)] if found else [])):
            off &= (c < low) | (c > high)
        return float(np.sort(c[off])[np.count_nonzero(off) // 2]) if off.any() else None

    def _is_thin(self, found: Interface) -> bool:
        width, spacing = self._resolution(found)
        return width < 2 * spacing * (1 - 1e-9)

    def _resolution(self, found: Interface) -> tuple[float, float]:
        """Width of an interface and distance of nodes, of all directions where it is least resolved."""
        if found.alike:
            return found.width, self.space.spacing
        stiffnesses, directions = np.linalg.eigh(self._stiffness)
        spacings = np.minimum(np.abs(directions.T) @ self.space.spacings, self.space.spacing)
        widths = found.width * np.sqrt(stiffnesses / stiffnesses.min())
        worst = int((spacings / widths).argmax())
        return float(widths[worst]), float(spacings[worst])

    def _refuse_thin_on_the_way(self, time: float) -> None:
        """Refuse interfaces that are too thin at a time: they are looked at once for all temperatures nearby."""
        now = warmth(self.free_energy, time)
        if now in self._resolved:
            return
        near = [self._interface_of(self.free_energy.heated(np.exp(WARMER * k))) for k in (now, now + 1)]
        if any(found is not None and self._is_thin(found) for found in near):
            self._refuse_thin_interface(time)
        else:
            self._resolved |= {now}

    def remarks(self) -> list[str]:
        start = f"{self.label}: its {self.quantity} at the start"
        return [*self.space.torn(start, self.start_values), *self._on_logarithms()]

    def _on_logarithms(self) -> list[str]:
        """Between corners nothing keeps nodes in the domain of logarithms, only quadrature points."""
        found, lumped = self.interface(), isinstance(self.space, MeshSpace) and self.space.is_lumped
        if found is None or lumped or not self.free_energy.has_domain:
            return []
        low, high = self.free_energy.domain
        if min(found.low - low, high - found.high) > NEAR_PURE:
            return []
        return [
            f"{self.label}: its phases are of {found.low:.2g} and {found.high:.6g}, near the ends of logarithms, which "
            f"here act inside of elements only: nodes may go beyond, and steps stay short; {self.cure}"
        ]

    # --- its mesh ------------------------------------------------------------------------------------------
    def nodes(self, chosen: str | Faces | ArrayLike) -> Ints:
        """Nodes (k,) by the name of a set of nodes or faces, 'all', `Faces`, or their numbers."""
        return chosen_nodes(self.grid, chosen, self.label)

    def faces(self, chosen: str | Faces) -> Faces:
        """Faces (edges if plane) by the name of their set, 'all' for the whole boundary, or as given."""
        return chosen_faces(self.grid, chosen, self.label)

    # --- what it contributes -------------------------------------------------------------------------------
    def field_in(self, model: Model, component: Owner) -> Field:
        """Its field, as one of a component; of what is empty and has no phases nothing tells a large change."""
        known = self._known_change(model, component)
        self.scale = known or 1.0
        c = self.space.fitted(self.start_values)
        least = float(known > 0)
        return model.field(component, self.quantity, c, role=Role.CONTENT, scale=self.scale, least=least)

    def _known_change(self, model: Model, component: Owner) -> float:
        """A large change of the field: between its phases, or of its start and of values that it is given."""
        given = [told.values for told in model.announced(component, Given)]
        found = self.interface()
        if found is not None:
            given.append(np.array([found.low, found.high]))
        values = np.concatenate([self._start, *given])
        faint = FAINT * float(np.abs(values).max()) if found is None else 0.0
        return max(float(np.ptp(values)), faint)

    def constants(self, time: float = 0.0) -> list[float]:
        """Of energy and mobility at a time, see ``visviva/point/mixture.hpp``."""
        energy, mobility = self.free_energy.at(time), self._mobility.at(time)
        return [*energy.constants(), *self._tensor, *mobility.constants()]

    def drive(self, model: Model, component: Owner, term: PointTerm) -> None:
        """Let constants of a term of a component follow the temperature, where that changes in time."""
        changing = [part for part in (self.free_energy, self._mobility) if part.changes]
        if not changing:
            return

        @lru_cache(maxsize=8)
        def constants(time: float) -> list[float]:
            if self.free_energy.changes:
                self._refuse_thin_on_the_way(time)
            return self.constants(time)

        n, first = len(self.free_energy.constants()), len(self.free_energy.constants()) + len(self._tensor)
        places = [*range(n)] * self.free_energy.changes
        places += [*range(first, len(constants(0.0)))] * self._mobility.changes
        account = model.account(component, "temperature", "work")
        signals = [(k, model.signal(component, lambda t, k=k: constants(t)[k])) for k in places]
        term.drive(signals, account)

    def _user_energy(self) -> Function | None:
        """The energy of value and gradient where it is the user's."""
        if not isinstance(self.free_energy, UserFreeEnergy):
            return None
        K, f = full(self._tensor), self.free_energy.function

        def energy(e: Any) -> Any:
            return f(e[0]) + 0.5 * np.einsum("an,ab,bn->n", e[1:], K, e[1:])

        slope = self.scale / self.space.spacing
        return Function(
            energy, 4, 1, f"{self.label}: its free energy", np.array([self.scale, slope, slope, slope])
        )

    def group(self, field: Field, table: Table, weights: Array) -> Group:
        """Unknowns of a field with their weights."""
        return Group(field.start + table.numbers, weights)

    # --- what it shows -------------------------------------------------------------------------------------
    def coefficients(self, field: Field, x: Array) -> Array:
        """Coefficients of a field among the unknowns `x` of the system."""
        return np.array(x[field.start : field.start + field.size])

    def values(self, x: Array) -> Array:
        """The concentration or order parameter (n,) at the nodes."""
        return self.space.at_nodes(self.coefficients(self.phase, x))

    def integral(self, x: Array) -> float:
        """Of the concentration or order parameter over the body, at the unknowns `x`."""
        c = self.coefficients(self.phase, x)
        return float(sum((t.size * t.at(c)).sum() for t in self.space.cells()))

    def energies(self, x: Array, time: float = 0.0) -> tuple[float, float]:
        """Chemical energy and gradient energy at the unknowns `x`, and at a time where temperatures change."""
        c, K, bulk, gradient = self.coefficients(self.phase, x), full(self._tensor), 0.0, 0.0
        energy = self.free_energy.at(time)
        for t in self.space.cells():
            bulk += float((t.size * energy.values(t.at(c))).sum())
            g = t.slopes(c)
            gradient += 0.5 * float(np.einsum("mq,mqa,ab,mqb->", t.size, g, K, g))
        return bulk, gradient

    def positions(self, x: Array) -> Array:
        return self.points

    def velocities(self, x: Array, v: Array) -> Array:
        return np.zeros_like(self.points)

    def widths(self) -> Mapping[str, int]:
        return {self.quantity: 1}

    def _shown(self, name: str, x: Array) -> Array:
        return self.values(x)

    def smoothed(self, names: Sequence[str], x: Array) -> dict[str, Array]:
        for name in names:
            if name not in self.widths():
                raise InputError(f"{self.label} has no field {name!r}{nearest(name, self.widths())}")
        return {name: self._shown(name, x) for name in names}

    def invalid(self, x: Array) -> str:
        """Points where its mobility is not the user's."""
        c = self.coefficients(self.phase, x)
        self._refuse_thin_beyond(c)
        return missed_mobility(self, self.label, c)

    @property
    def _a(self) -> str:
        return "an order" if self.quantity == "order" else f"a {self.quantity}"

    def trouble(self, x: Array) -> str:
        if found := self.invalid(x):
            return found
        low, high = self.free_energy.domain
        c = self.values(x)
        worst = int(np.argmax(np.maximum(low - c, c - high)))
        if low < c[worst] < high:
            return ""
        at = ", ".join(f"{X:.4g}" for X in self.points[worst])
        return (
            f"{self.label} has a {self.quantity} of {c[worst]:.4g} at node {worst} near ({at}), outside of the "
            f"logarithms of {type(self.free_energy).__name__}; shorter steps stay inside"
        )


def stride(body: PhaseBody) -> float:
    """By how much a field may change in an iteration: not past what is between phases, or past logarithms."""
    if body.free_energy.has_domain:
        return 0.5
    return 0.5 * body.scale if body.interface() is not None else np.inf


def missed_mobility(body: PhaseBody, label: str, c: Array) -> str:
    """Where coefficients `c` leave the mobility of a body that is called so, in a sentence; empty if nowhere."""
    mobility = body._mobility
    return first_point(
        label, body.space, c, mobility.missed, lambda value: f"{body._a} of {mobility.missing(value)}"
    )


def first_point(
    label: str,
    space: ScalarSpace,
    coefficients: Array,
    test: Callable[[Array], NDArray[np.bool_]],
    said: Callable[[float], str],
) -> str:
    """The first point of quadrature whose value fails a test, and what is said of it; empty if none does."""
    first = 0
    for table in space.cells():
        c = table.at(coefficients)
        if np.any(found := test(c)):
            e, q = np.argwhere(found)[0]
            at = ", ".join(f"{X:.4g}" for X in table.X[e, q])
            return f"element {first + e} of {label} near ({at}): {said(float(c[e, q]))}"
        first += len(c)
    return ""


def warmth(energy: FreeEnergy, time: float) -> int:
    """Number of the step of temperatures, `WARMER` apart, that an energy has reached at a time."""
    return int(np.floor(np.log(temperature_at(energy, time)) / WARMER))


def full(tensor: Array) -> Array:
    """(3, 3) of components 11, 22, 33, 12, 23, 31."""
    return np.asarray(tensor[[[0, 3, 5], [3, 1, 4], [5, 4, 2]]])
