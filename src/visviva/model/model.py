"""The model that components build when they join a system: fields of unknowns and elements of terms, in batches."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visviva import _core
from visviva.base.errors import InputError
from visviva.model.batch import along, book, strain_batch
from visviva.model.composition import Composition
from visviva.model.driving import Driving
from visviva.model.entropies import Entropies
from visviva.model.field import Field, Owner, Prescription, Role, supply_of
from visviva.model.form import Form, Strain, refuse_foreign, strain
from visviva.model.law import Law, LawKind
from visviva.model.reductions import Reductions

if TYPE_CHECKING:
    from visviva.model.term import Term

Array = NDArray[np.float64]
T = TypeVar("T")


@dataclass(eq=False)
class Account:
    """A place in the ledger: whose energy or work of which kind."""

    component: int
    kind: str
    category: str  # kinetic, potential, work, dissipation, heat, constraint, or one of entropy


@dataclass(eq=False)
class Element:
    """Strains under a law, with the multipliers and signals it needs.

    `shift` is added to the unknowns of the strains, so that elements of equal structure can share theirs.
    """

    strains: Sequence[Strain]
    law: Law
    multipliers: Sequence[int]
    signals: Sequence[int]
    account: int
    component: int
    shift: int = 0


@dataclass(frozen=True, eq=False)
class Growing:
    """A field that never shrinks, sizes (n,) of its unknowns, and whether these rest where they would shrink."""

    field: Field
    sizes: Array
    held: bool


@dataclass(eq=False)
class Model:
    """Collects fields and elements while components contribute; the system then hands them to the core."""

    components: Sequence[Owner] = ()
    fields: list[Field] = field(default_factory=list)
    elements: list[Element] = field(default_factory=list)
    masses: list[tuple[Any, ...]] = field(default_factory=list)
    terms: list[tuple[Term, int]] = field(default_factory=list)
    batches: list[_core.Term] = field(default_factory=list)
    functions: list[Callable[..., Any]] = field(default_factory=list)
    accounts: list[Account] = field(default_factory=list)
    driving: Driving = field(default_factory=Driving)
    reductions: Reductions = field(default_factory=Reductions)
    entropies: Entropies = field(default_factory=Entropies)
    growing: list[Growing] = field(default_factory=list)
    nodes: dict[Owner, list[tuple[int, bool]]] = field(default_factory=dict)
    length: float = 1.0
    lengths: dict[int, float] = field(default_factory=dict)  # of small parts apart, by id of their components
    _composition: Composition = field(default_factory=Composition)
    _announced: dict[int, list[object]] = field(default_factory=dict)  # by number of the component
    _transport: list[Field] = field(default_factory=list)
    _numbers: dict[int, int] = field(default_factory=dict)
    _opened: dict[tuple[int, str, str], int] = field(default_factory=dict)
    _initial: Array = field(default_factory=lambda: np.zeros((2, 64)))  # with room to grow

    def index(self, component: Owner) -> int:
        """Number of a component."""
        if len(self._numbers) != len(self.components):
            self._numbers = {id(c): k for k, c in enumerate(self.components)}
        number = self._numbers.get(id(component))
        if number is None:
            raise InputError(
                f"{component.label} is used by another component but is not part of the system; add it"
            )
        return number

    # --- what components tell about each other ---------------------------------------------------------------
    def announce(self, about: Owner, what: object) -> None:
        """Tell what is done to a component; all have told before the first makes its fields."""
        self._announced.setdefault(self.index(about), []).append(what)

    def announced(self, about: Owner, kind: type[T]) -> list[T]:
        """Announcements of a kind about a component, in the order of the components that made them."""
        return [what for what in self._announced.get(self.index(about), ()) if isinstance(what, kind)]

    def length_of(self, component: Owner) -> float:
        """Length that its positions are measured by: extent of the model, or of the small part of it that it is in."""
        return self.lengths.get(id(component), self.length)

    def sizes_of(self, strains: Sequence[Strain]) -> Array:
        """Large changes (n_e,) of strains, 1 where unknowns tell none."""
        scale = np.concatenate([f.scale for f in self.fields]) if self.fields else np.zeros(0)
        return np.array([s.size(scale) or 1.0 for s in strains])

    # --- unknowns ------------------------------------------------------------------------------------------
    def field(
        self,
        component: Owner,
        name: str,
        values: ArrayLike,
        rates: ArrayLike | None = None,
        *,
        role: Role = Role.MOTION,
        scale: float | ArrayLike | None = None,
        stage: int = 0,
        block: Any = None,
        fixed: ArrayLike = False,
        node: int = 1,
        part: int = 0,
        element: ArrayLike = (),
        instantaneous: bool = True,
        least: float = 1.0,
    ) -> Field:
        """New unknowns; see `Field`."""
        x = np.array(values, dtype=float).ravel()
        v = np.zeros(x.shape) if rates is None else np.array(rates, dtype=float).ravel()
        if scale is None:
            scale = 0.0 if role.order == 0 else 1.0
        scales = np.broadcast_to(np.asarray(scale, dtype=float), x.shape)
        held = np.array(np.broadcast_to(np.asarray(fixed, dtype=bool), x.shape))
        start = self.n_unknowns
        block = (component, name) if block is None and stage == 0 else (block or component)
        local = np.asarray(element, dtype=np.int32).ravel()
        new = Field(
            component,
            name,
            role,
            start,
            x,
            v,
            scales,
            stage,
            block,
            held,
            node,
            part,
            instantaneous,
            local,
            self._composition,
            least=least,
        )
        self.fields.append(new)
        if role.order == 1:
            self._transport.append(new)
        self.refresh(new)
        return new

    def refresh(self, new: Field) -> None:
        """To be called after initial values or rates of a field were changed."""
        end = new.start + new.size
        if end > self._initial.shape[1]:
            self._initial = np.hstack([self._initial, np.zeros((2, end))])
        self._initial[:, new.start : end] = new.values, new.rates

    def hold(self, held: Field, numbers: ArrayLike, values: ArrayLike | None = None) -> None:
        """Fix unknowns of a field, given by their numbers in it, at their initial or other values, at rest.

        Raises
        ------
        InputError
            If something moves one of them already.
        """
        k = np.asarray(numbers, dtype=int)
        for p in self.driving.prescribed:
            if (moved := np.isin(held.start + k, p.unknowns)).any():
                self._refuse_held(p.component, held, int(k[np.argmax(moved)]), "another support")
        held.fixed[k] = True
        held.rates[k] = 0.0
        if values is not None:
            held.values[k] = values
        self.refresh(held)

    def prescribe(
        self,
        component: Owner,
        moved: Field,
        numbers: ArrayLike,
        values: Callable[[float], Array],
        rates: Callable[[float, float], Array],
        kinks: Iterable[float] = (),
    ) -> None:
        """Let unknowns of a field, given by their numbers in it, move as functions of time with values (k,) say.

        Their rates (k,) follow from a time and the length of steps, 0 where that is not known.
        At `kinks` their rates may jump.

        Raises
        ------
        InputError
            If something holds or moves one of them already.
        """
        k = np.asarray(numbers, dtype=int)
        if np.any(moved.fixed[k]):
            first = int(k[np.argmax(moved.fixed[k])])
            others = [p.component.label for p in self.driving.prescribed if moved.start + first in p.unknowns]
            self._refuse_held(component, moved, first, " and ".join(others) or "another support")
        self.hold(moved, k, values(0.0))
        moved.rates[k] = rates(0.0, 0.0)
        self.refresh(moved)
        account = self.account(
            component, "supply" if moved.order == 1 else "prescribed motion", supply_of(moved)
        )
        unknowns = np.asarray(moved.start + k, dtype=np.int32)
        self.driving.prescribed.append(
            Prescription(
                component, unknowns, values, rates, account, moved.role.supply, kinks := tuple(kinks)
            )
        )
        self.driving.bend(kinks, account)

    @staticmethod
    def _refuse_held(mover: Owner, moved: Field, number: int, others: str) -> NoReturn:
        raise InputError(
            f"{mover.label} prescribes {moved.name}[{number}] of {moved.component.label}, which {others} holds "
            "already; take its node out of one of them"
        )

    @property
    def initial(self) -> tuple[Array, Array]:
        """Initial values and rates of all unknowns made so far."""
        if self._composition.is_settled:  # what grows with components has served
            self._initial = np.zeros((2, 0))
            every = [[f.values for f in self.fields], [f.rates for f in self.fields]]
            return np.concatenate(every[0]), np.concatenate(every[1])
        x, v = self._initial[:, : self.n_unknowns]
        return x, v

    def multipliers(
        self,
        component: Owner,
        name: str,
        n: int,
        *,
        stage: int = 1,
        block: Any = None,
        part: int = 0,
        instantaneous: bool = True,
    ) -> Field:
        """Unknown multipliers of `n` constraints."""
        return self.field(
            component,
            name,
            np.zeros(n),
            role=Role.MULTIPLIER,
            stage=stage,
            block=block,
            part=part,
            instantaneous=instantaneous,
        )

    @property
    def n_unknowns(self) -> int:
        return self.fields[-1].start + self.fields[-1].size if self.fields else 0

    # --- books ---------------------------------------------------------------------------------------------
    def account(self, component: Owner, kind: str, category: str) -> int:
        """Number of the account of a component, a kind and a category, opened on first use."""
        key = self.index(component), kind, category
        if key not in self._opened:
            self._opened[key] = len(self.accounts)
            self.accounts.append(Account(*key))
        return self._opened[key]

    def signal(self, component: Owner, function: Any, has_rate: bool = False) -> int:
        """Number of a component's function of time (whatever `TimeFunction` takes); -1 for none.

        Loads need its values alone; where its rate is needed too, it is asked for times around those of steps.
        """
        return self.driving.signal(component.label, function, has_rate)

    # --- physics -------------------------------------------------------------------------------------------
    def inertia(self, component: Owner, start: int, mass: ArrayLike, positions: Sequence[bool]) -> None:
        """Constant symmetric mass (k, k) between k nodes of three unknowns from `start` on.

        `positions` marks the nodes that move along under a translation (they make up linear momentum).
        """
        m = np.asarray(mass, dtype=float)
        nodes = [(start + 3 * k, bool(p)) for k, p in enumerate(positions)]
        self.nodes.setdefault(component, []).extend(nodes)
        entries = [(a, b, value) for a, row in enumerate(m.tolist()) for b, value in enumerate(row)]
        pairs = tuple((a, b) for a, b, value in entries if value != 0.0)
        values = [value for _, _, value in entries if value != 0.0]
        key = (2, len(m), 3, pairs, tuple(bool(p) for p in positions))
        account = self.account(component, "kinetic", "kinetic")
        index = list(range(start, start + 3 * len(m)))
        self.masses.append((key, index, values, account, self.index(component)))

    def inertias(
        self,
        component: Owner,
        vectors: NDArray[np.integer],
        mass: Array,
        positions: Sequence[bool],
        d: int = 3,
    ) -> None:
        """Constant symmetric mass (m, k, k) of m elements between k vectors of d unknowns each.

        `vectors` (m, k) gives their first unknowns.
        """
        a, b = np.nonzero(np.any(mass != 0, axis=0))
        key = (2, mass.shape[1], d, tuple(zip(a.tolist(), b.tolist(), strict=True)), tuple(positions))
        account, number = self.account(component, "kinetic", "kinetic"), self.index(component)
        unknowns = (vectors[:, :, None] + np.arange(d)).reshape(len(vectors), -1)
        for index, values in zip(unknowns.tolist(), mass[:, a, b].tolist(), strict=True):
            self.masses.append((key, index, values, account, number))

    def potential(self, component: Owner, kind: str, strains: Any, law: Law) -> None:
        """Potential energy ``W(e)`` of one strain (or several, for a law that takes several).

        Raises
        ------
        InputError
            If one sees an unknown of order 1, whose equation is no balance of forces.
        """
        self._refuse_transport(component, strains)
        self._element(component, strains, law, (), (), self.account(component, kind, "potential"))

    def _refuse_transport(self, component: Owner, strains: Any) -> None:
        if not self._transport:
            return
        seen = {u for e in strains_of(strains) for u in e.unknowns}
        for f in self._transport:
            if found := sorted(seen.intersection(f.unknowns)):
                raise InputError(
                    f"{component.label} has a potential of {f.name}[{found[0] - f.start}] of {f.component.label}, an "
                    "unknown of order 1, whose equation balances rates and no forces; give a vv.Term its residual, or "
                    "make the field of order 0, where the energy is least, or 2, for motion"
                )

    def dissipate(self, component: Owner, kind: str, strains: Any, law: Law) -> None:
        """A law of strain rates."""
        self._element(component, strains, law, (), (), self.account(component, kind, "dissipation"))

    def act(self, component: Owner, kind: str, strains: Any, law: Law, times: Any = None) -> None:
        """A law whose stresses do work on the system, driven by a function of time if it takes one."""
        account = self.account(component, kind, "work")
        self._element(component, strains, law, (), (self.signal(component, times),), account)

    def load(self, component: Owner, kind: str, strains: Any, amplitude: float, at: Any) -> None:
        """Generalised force ``amplitude * at(t)`` conjugate to a strain; `at` None means constant."""
        self.act(component, kind, strains, Law(LawKind.LOAD, (amplitude, 0.0)), at)

    def constrain(
        self,
        component: Owner,
        multipliers: Field,
        strains: Sequence[Strain | Form],
        *,
        first: int = 0,
        targets: Sequence[Any] | None = None,
        law: Law | None = None,
        n: int | None = None,
        shift: int = 0,
    ) -> None:
        """Constraints ``strain_i = target_i(t)`` (or zero), one multiplier each from `first` on.

        Elements whose strains differ by the numbers of their unknowns alone may share one tuple of them and
        give the `shift` of these numbers: it is compiled once.
        """
        n = len(strains) if n is None else n
        numbers = [multipliers.start + first + k for k in range(n)]
        signals = [self.signal(component, f, has_rate=True) for f in targets] if targets else [-1] * n
        driven = any(s >= 0 for s in signals)
        account = self.account(
            component, "drive" if driven else "constraint", "work" if driven else "constraint"
        )
        law = Law(LawKind.CONSTRAINT) if law is None else law
        servo = law.kind is LawKind.SERVO
        if servo:
            account = self.account(component, "servo", "work")
        self.driving.drive(numbers, signals, account, servo)
        self._element(component, strains, law, numbers, signals, account, shift)

    def grow(self, growing: Field, sizes: Array, held: bool = True) -> None:
        """Let unknowns of a field of order 0 never shrink.

        `held` are those that have no other reason not to: either an unknown rests in a step or its equation holds, so
        that what holds it does no work. The products of `sizes` (n,) and what they have grown by tell how far, as the
        area of a crack.
        """
        self.growing.append(Growing(growing, sizes, held))

    def term(self, component: Owner, term: Term) -> None:
        """A whole term written in Python."""
        self.terms.append((term, self.index(component)))

    def keep(self, function: Callable[..., Any]) -> None:
        """Keep a function alive that the core calls, which refers to it weakly: it may know the system."""
        self.functions.append(function)

    def batch(self, term: _core.Term) -> None:
        """A term of the core that stands for many elements."""
        self.batches.append(term)

    def strain_batch(
        self, component: Owner, kind: str, category: str, term: _core.StrainTerm, n: int
    ) -> None:
        """A batch of `n` elements given by arrays, see `visviva.model.batch`."""
        term.name = component.label
        account = self.account(component, kind, category)
        book(term, [account] * n, [self.index(component)] * n, n)
        self.batch(term)

    def dead_forces(self, component: Owner, kind: str, first: NDArray[np.int32], force: Array) -> None:
        """Potential ``-f . x`` of constant forces (n, d) on nodes whose unknowns begin at `first` (n,)."""
        n, d = force.shape
        index = np.asarray(first)[:, None] + np.arange(d)
        term = strain_batch(along(d), Law(LawKind.LINEAR), index, -force, (1.0, 0.0))
        self.strain_batch(component, kind, "potential", term, n)

    def nodal_loads(
        self, component: Owner, kind: str, first: NDArray[np.int32], force: Array, times: Any
    ) -> None:
        """Forces (n, d) times a function of time on nodes whose unknowns begin at `first` (n,)."""
        n, d = force.shape
        index = np.asarray(first)[:, None] + np.arange(d)
        term = strain_batch(
            along(d), Law(LawKind.LOAD), index, force, (1.0, 0.0), self.signal(component, times)
        )
        self.strain_batch(component, kind, "work", term, n)

    def _element(
        self,
        component: Owner,
        strains: Any,
        law: Law,
        multipliers: Sequence[int],
        signals: Sequence[int],
        account: int,
        shift: int = 0,
    ) -> None:
        number, listed = self.index(component), strains_of(strains)
        for e in listed:
            refuse_foreign(component.label, e, self._composition)
        self.elements.append(Element(listed, law, multipliers, signals or [-1], account, number, shift))


def strains_of(strains: Any) -> Sequence[Strain]:
    """Strains of one or several, which may be forms."""
    listed = strains if isinstance(strains, list | tuple) else [strains]
    return listed if all(isinstance(s, Strain) for s in listed) else [strain(s) for s in listed]
