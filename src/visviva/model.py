"""What components build when they join a system: fields of unknowns and elements of terms, in batches."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visviva import _core
from visviva.batch import along, book, strain_batch
from visviva.errors import InputError
from visviva.form import Form, Strain, Vector, strain
from visviva.law import Law, LawKind
from visviva.timefunction import TimeFunction

if TYPE_CHECKING:
    from visviva.component import Component
    from visviva.term import Term

Array = NDArray[np.float64]


@dataclass(eq=False)
class Field:
    """A block of unknowns with its order in time: 2 motion, 1 transport, 0 algebraic.

    Attributes
    ----------
    start, size : int
        The unknowns ``start ... start + size - 1`` of the system.
    scale : float
        A change of this size is large (length of the model, 1 for directors and angles); 0: not judged.
    stage : int
        Order of elimination: 0 has inertia, 1 multipliers and massless coordinates, 2 couples only those.
    block : object
        Unknowns of equal block are eliminated together; by default the component.
    fixed : bool array
        Unknowns that keep their values and have no equation.
    node : int
        So many consecutive unknowns make up a node of a mesh.
    definite : bool
        Whether the energy is least in them; not so for pressures.
    element : int array (size,)
        The only element that touches each unknown, which is eliminated with that element's equations before the
        others are solved; -1 if several do. An element's own unknowns follow each other.
    amount : bool
        Of order 1: whether the ledger counts what they store by itself (heat), not by half its square as for
        velocities. It decides what flows in through those that are held.
    symmetric : bool
        Whether the tangent is so, in statics at least; not where something is carried along.
    """

    component: Component
    name: str
    order: int
    start: int
    values: Array
    rates: Array
    scale: Array
    stage: int
    multiplier: bool
    block: Any
    fixed: NDArray[np.bool_]
    node: int = 1
    definite: bool = True
    amount: bool = True
    symmetric: bool = True
    element: NDArray[np.int32] = field(default_factory=lambda: np.zeros(0, dtype=np.int32))

    def __post_init__(self) -> None:
        if len(self.element) == 0:
            self.element = np.full(self.size, -1, dtype=np.int32)

    @property
    def is_local(self) -> bool:
        """Whether elements eliminate all of its unknowns."""
        return self.size > 0 and bool(np.all(self.element >= 0))

    @property
    def size(self) -> int:
        return len(self.values)

    @property
    def unknowns(self) -> range:
        return range(self.start, self.start + self.size)

    @property
    def supply(self) -> int:
        """What held unknowns take in from the force r that holds them, see the core's `Supply`."""
        return 0 if self.order != 1 else 1 + self.amount

    def form(self, k: int = 0) -> Form:
        """The `k`-th unknown as a form."""
        return Form(((self.start + k, 1.0),))

    def vector(self, node: int = 0) -> Vector:
        """Three unknowns as a vector."""
        return Vector.of(self.start + 3 * node)


@dataclass(eq=False)
class Account:
    """A place in the ledger: whose energy or work of which kind."""

    component: int
    kind: str
    category: str  # kinetic, potential, work, dissipation, constraint


@dataclass(eq=False)
class Prescription:
    """Fixed unknowns that move as a function of time says.

    Attributes
    ----------
    unknowns : int array (k,)
    values : callable
        Their values (k,) at a time.
    rates : callable
        Their rates (k,) just after a time.
    account : int
        Where the work of what moves them is booked.
    supply : int
        See `Field.supply`.
    """

    component: Component
    unknowns: NDArray[np.int32]
    values: Callable[[float], Array]
    rates: Callable[[float], Array]
    account: int
    supply: int

    def acceleration(self, time: float) -> Array:
        """Second derivatives (k,) of the values just after a time, by differences forward."""
        d = 1e-3 * max(1.0, abs(time))
        f = [self.values(time + k * d) for k in range(5)]
        return (35 * f[0] - 104 * f[1] + 114 * f[2] - 56 * f[3] + 11 * f[4]) / (12 * d * d)


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


@dataclass(eq=False)
class Model:
    """Collects fields and elements while components contribute; the system then hands them to the core."""

    components: list[Component] = field(default_factory=list)
    fields: list[Field] = field(default_factory=list)
    elements: list[Element] = field(default_factory=list)
    masses: list[tuple[Any, ...]] = field(default_factory=list)
    terms: list[tuple[Term, int]] = field(default_factory=list)
    batches: list[_core.Term] = field(default_factory=list)
    accounts: list[Account] = field(default_factory=list)
    signals: list[TimeFunction] = field(default_factory=list)
    prescribed: list[Prescription] = field(default_factory=list)
    dependences: list[tuple[int, int]] = field(default_factory=list)
    rigid: list[list[int]] = field(default_factory=list)
    nodes: dict[Component, list[tuple[int, bool]]] = field(default_factory=dict)
    length: float = 1.0
    _numbers: dict[int, int] = field(default_factory=dict)
    _opened: dict[tuple[int, str, str], int] = field(default_factory=dict)
    _initial: Array = field(default_factory=lambda: np.zeros((2, 64)))  # with room to grow

    def index(self, component: Component) -> int:
        """Number of a component."""
        if len(self._numbers) != len(self.components):
            self._numbers = {id(c): k for k, c in enumerate(self.components)}
        number = self._numbers.get(id(component))
        if number is None:
            raise InputError(
                f"{component.label} is used by another component but is not part of the system; add it"
            )
        return number

    # --- unknowns ------------------------------------------------------------------------------------------
    def field(
        self,
        component: Component,
        name: str,
        values: ArrayLike,
        rates: ArrayLike | None = None,
        *,
        order: int = 2,
        scale: float | ArrayLike | None = None,
        stage: int = 0,
        multiplier: bool = False,
        block: Any = None,
        fixed: ArrayLike = False,
        node: int = 1,
        definite: bool = True,
        element: ArrayLike = (),
        amount: bool = True,
        symmetric: bool = True,
    ) -> Field:
        """New unknowns; see `Field`."""
        x = np.array(values, dtype=float).ravel()
        v = np.zeros_like(x) if rates is None else np.array(rates, dtype=float).ravel()
        if scale is None:
            scale = 0.0 if order == 0 else 1.0
        scales, held = np.empty_like(x), np.empty(x.shape, dtype=bool)
        scales[:], held[:] = scale, fixed
        start = self.n_unknowns
        block = (component, name) if block is None and stage == 0 else (block or component)
        local = np.asarray(element, dtype=np.int32).ravel()
        new = Field(
            component,
            name,
            order,
            start,
            x,
            v,
            scales,
            stage,
            multiplier,
            block,
            held,
            node,
            definite,
            amount,
            symmetric,
            local,
        )
        self.fields.append(new)
        self._remember(new)
        return new

    def refresh(self, changed: Field) -> None:
        """To be called after initial values or rates of a field were changed."""
        self._remember(changed)

    def _remember(self, new: Field) -> None:
        end = new.start + new.size
        if end > self._initial.shape[1]:
            self._initial = np.hstack([self._initial, np.zeros((2, end))])
        self._initial[:, new.start : end] = new.values, new.rates

    def hold(self, held: Field, numbers: ArrayLike, values: ArrayLike | None = None) -> None:
        """Fix unknowns of a field, given by their numbers in it, at their initial or other values, at rest."""
        k = np.asarray(numbers, dtype=int)
        held.fixed[k] = True
        held.rates[k] = 0.0
        if values is not None:
            held.values[k] = values
        self._remember(held)

    def prescribe(
        self,
        component: Component,
        moved: Field,
        numbers: ArrayLike,
        values: Callable[[float], Array],
        rates: Callable[[float], Array],
    ) -> None:
        """Let unknowns of a field, given by their numbers in it, move as functions of time with values (k,) say.

        Raises
        ------
        InputError
            If something holds or moves one of them already.
        """
        k = np.asarray(numbers, dtype=int)
        if np.any(moved.fixed[k]):
            first = int(k[np.argmax(moved.fixed[k])])
            others = [p.component.label for p in self.prescribed if moved.start + first in p.unknowns]
            raise InputError(
                f"{component.label} prescribes {moved.name}[{first}] of {moved.component.label}, which "
                f"{' and '.join(others) or 'another support'} holds already; take its node out of one of them"
            )
        self.hold(moved, k, values(0.0))
        moved.rates[k] = rates(0.0)
        self._remember(moved)
        account = self.account(component, "supply" if moved.order == 1 else "prescribed motion", "work")
        unknowns = np.asarray(moved.start + k, dtype=np.int32)
        self.prescribed.append(Prescription(component, unknowns, values, rates, account, moved.supply))

    def supplied(self) -> tuple[NDArray[np.int32], ...]:
        """Held unknowns that take in work or heat: their numbers, accounts, and what they take in."""
        rows = [(int(u), p.account, p.supply) for p in self.prescribed for u in p.unknowns]
        moving = {u for u, _, _ in rows}
        for f in self.fields:
            still = [u for u in f.unknowns if f.order == 1 and f.fixed[u - f.start] and u not in moving]
            rows += [(u, self.account(f.component, "supply", "work"), f.supply) for u in still]
        table = np.array(rows, dtype=np.int32).reshape(-1, 3)
        return tuple(np.ascontiguousarray(column) for column in table.T)

    @property
    def initial(self) -> tuple[Array, Array]:
        """Initial values and rates of all unknowns made so far."""
        x, v = self._initial[:, : self.n_unknowns]
        return x, v

    def multipliers(
        self, component: Component, name: str, n: int, *, stage: int = 1, block: Any = None
    ) -> Field:
        """Unknown multipliers of `n` constraints."""
        return self.field(component, name, np.zeros(n), order=0, stage=stage, multiplier=True, block=block)

    @property
    def n_unknowns(self) -> int:
        return self.fields[-1].start + self.fields[-1].size if self.fields else 0

    # --- books ---------------------------------------------------------------------------------------------
    def account(self, component: Component, kind: str, category: str) -> int:
        """Number of the account of a component, a kind and a category, opened on first use."""
        key = self.index(component), kind, category
        if key not in self._opened:
            self._opened[key] = len(self.accounts)
            self.accounts.append(Account(*key))
        return self._opened[key]

    def signal(self, function: Any) -> int:
        """Number of a prescribed function of time (whatever `TimeFunction` takes); -1 for none."""
        if function is None:
            return -1
        self.signals.append(TimeFunction(function))
        return len(self.signals) - 1

    # --- physics -------------------------------------------------------------------------------------------
    def inertia(self, component: Component, start: int, mass: ArrayLike, positions: Sequence[bool]) -> None:
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

    def potential(self, component: Component, kind: str, strains: Any, law: Law) -> None:
        """Potential energy ``W(e)`` of one strain (or several, for a law that takes several)."""
        self._element(component, strains, law, (), (), self.account(component, kind, "potential"))

    def dissipate(self, component: Component, kind: str, strains: Any, law: Law) -> None:
        """A law of strain rates."""
        self._element(component, strains, law, (), (), self.account(component, kind, "dissipation"))

    def act(self, component: Component, kind: str, strains: Any, law: Law, times: Any = None) -> None:
        """A law whose stresses do work on the system, driven by a function of time if it takes one."""
        account = self.account(component, kind, "work")
        self._element(component, strains, law, (), (self.signal(times),), account)

    def load(self, component: Component, kind: str, strains: Any, amplitude: float, at: Any) -> None:
        """Generalised force ``amplitude * at(t)`` conjugate to a strain; `at` None means constant."""
        self.act(component, kind, strains, Law(LawKind.LOAD, (amplitude, 0.0)), at)

    def constrain(
        self,
        component: Component,
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
        signals = [self.signal(f) for f in targets] if targets else [-1] * n
        driven = any(s >= 0 for s in signals)
        account = self.account(
            component, "drive" if driven else "constraint", "work" if driven else "constraint"
        )
        law = Law(LawKind.CONSTRAINT) if law is None else law
        if law.kind is LawKind.SERVO:
            account = self.account(component, "servo", "work")
        self._element(component, strains, law, numbers, signals, account, shift)

    def depend(self, unknown: int, multiplier: int) -> None:
        """Let an unknown leave the equations with a multiplier whose constraint, linear in it, gives it by others.

        The constraint must be that of a term of its own, and linear in the multiplier too.
        """
        self.dependences.append((unknown, multiplier))

    def term(self, component: Component, term: Term) -> None:
        """A whole term written in Python."""
        self.terms.append((term, self.index(component)))

    def batch(self, term: _core.Term) -> None:
        """A term of the core that stands for many elements."""
        self.batches.append(term)

    def strain_batch(
        self, component: Component, kind: str, category: str, term: _core.StrainTerm, n: int
    ) -> None:
        """A batch of `n` elements given by arrays, see `visviva.batch`."""
        term.name = component.label
        account = self.account(component, kind, category)
        book(term, [account] * n, [self.index(component)] * n, n)
        self.batch(term)

    def dead_forces(self, component: Component, kind: str, first: NDArray[np.int32], force: Array) -> None:
        """Potential ``-f . x`` of constant forces (n, d) on nodes whose unknowns begin at `first` (n,)."""
        n, d = force.shape
        index = np.asarray(first)[:, None] + np.arange(d)
        term = strain_batch(along(d), Law(LawKind.LINEAR), index, -force, (1.0, 0.0))
        self.strain_batch(component, kind, "potential", term, n)

    def nodal_loads(
        self, component: Component, kind: str, first: NDArray[np.int32], force: Array, times: Any
    ) -> None:
        """Forces (n, d) times a function of time on nodes whose unknowns begin at `first` (n,)."""
        n, d = force.shape
        index = np.asarray(first)[:, None] + np.arange(d)
        term = strain_batch(along(d), Law(LawKind.LOAD), index, force, (1.0, 0.0), self.signal(times))
        self.strain_batch(component, kind, "work", term, n)

    def _element(
        self,
        component: Component,
        strains: Any,
        law: Law,
        multipliers: Sequence[int],
        signals: Sequence[int],
        account: int,
        shift: int = 0,
    ) -> None:
        listed = strains if isinstance(strains, list | tuple) else [strains]
        exact = listed if all(isinstance(s, Strain) for s in listed) else [strain(s) for s in listed]
        number = self.index(component)
        self.elements.append(Element(exact, law, multipliers, signals or [-1], account, number, shift))


# --- hand-over to the core ----------------------------------------------------------------------------------


@dataclass(eq=False)
class Stencil:
    """Strains as the core wants them: numbered forms, products, and the unknowns they need."""

    unknowns: list[int]
    weights: list[float]
    y_const: list[float]
    e_const: list[float]
    forms: tuple[tuple[int, int], ...]
    quad: tuple[tuple[int, int, int], ...]
    coefficients: tuple[float, ...]
    lin: tuple[tuple[int, int], ...]

    @property
    def structure(self) -> tuple[Any, ...]:
        """What is equal for all stencils of a batch."""
        counts = len(self.unknowns), len(self.y_const), len(self.e_const)
        return (*counts, self.forms, self.quad, self.coefficients, self.lin)


def stencil(strains: Sequence[Strain]) -> Stencil:
    """Compile the strains of an element."""
    forms: dict[Form, int] = {}
    unknowns: dict[int, int] = {}

    def number(form: Form) -> int:
        row = forms.setdefault(form, len(forms))
        if row == len(forms) - 1:
            for u, _ in form.weights:
                unknowns.setdefault(u, len(unknowns))
        return row

    quad, coefficients, lin = [], [], []
    for i, e in enumerate(strains):
        for c, a, b in e.products:
            quad.append((i, number(a), number(b)))
            coefficients.append(c)
        if e.linear.weights:
            lin.append((i, number(Form(e.linear.weights))))
    entries = sorted([(unknowns[u], row, w) for form, row in forms.items() for u, w in form.weights])
    return Stencil(
        list(unknowns),
        [w for _, _, w in entries],
        [f.constant for f in forms],
        [e.linear.constant for e in strains],
        tuple([(row, col) for col, row, _ in entries]),
        tuple(quad),
        tuple(coefficients),
        tuple(lin),
    )


def _columns(rows: Sequence[Sequence[float]], dtype: type = np.float64) -> NDArray[Any]:
    """From one row per element to element-fastest storage."""
    return np.ascontiguousarray(np.array(rows, dtype=dtype).reshape(len(rows), -1).T)


def strain_terms(model: Model) -> list[_core.Term]:
    """Batches of equal stencils, in order of first appearance."""
    groups: dict[tuple[Any, ...], list[tuple[Stencil, Element]]] = defaultdict(list)
    rigidity = {unknown for body in model.rigid for unknown in body[12:]}
    compiled: dict[int, tuple[Stencil, tuple[Any, ...]]] = {}  # by identity: many elements share strains
    for element in model.elements:
        known = compiled.get(id(element.strains))
        if known is None:
            s = stencil(element.strains)
            known = compiled[id(element.strains)] = s, s.structure
        s, structure = known
        law, n_multipliers = element.law, len(element.multipliers)
        like = law.kind, len(law.parameters), law.callback, n_multipliers, len(element.signals)
        groups[not rigidity.isdisjoint(element.multipliers), like, structure].append((s, element))
    return [strain_term(model, is_rigidity, members) for (is_rigidity, *_), members in groups.items()]


def strain_term(model: Model, is_rigidity: bool, members: list[tuple[Stencil, Element]]) -> _core.Term:
    """One batch."""
    s, first = members[0]
    stencils, elements = zip(*members, strict=True)
    index = [[u + e.shift for u in s.unknowns] + list(e.multipliers) for s, e in members]
    n_multipliers = len(first.multipliers)
    term = _core.StrainTerm(
        [len(s.unknowns), len(s.y_const), len(s.e_const), n_multipliers, first.law.kind],
        np.array(s.forms, dtype=np.int32).reshape(-1, 2),
        np.array(s.quad, dtype=np.int32).reshape(-1, 3),
        np.array(s.coefficients, dtype=float),
        np.array(s.lin, dtype=np.int32).reshape(-1, 2),
        np.ones(len(s.lin)),
        _columns(index, np.int32),
        _columns([s.weights for s in stencils]),
        _columns([s.y_const for s in stencils]),
        _columns([s.e_const for s in stencils]),
        _columns([e.law.parameters for e in elements]),
        _columns([e.signals for e in elements], np.int32),
    )
    if first.law.callback is not None:
        term.set_callback(first.law.callback)
    term.is_rigidity = is_rigidity
    term.name = model.components[first.component].label
    book(term, [e.account for e in elements], [e.component for e in elements], len(members))
    return term


def inertia_terms(model: Model) -> list[_core.Term]:
    """Batches of equal mass stencils."""
    groups: dict[tuple[Any, ...], list[tuple[Any, ...]]] = defaultdict(list)
    for key, *rest in model.masses:
        groups[key].append(tuple(rest))
    terms: list[_core.Term] = []
    for (order, nodes, dim, pairs, positions), members in groups.items():
        index, mass, account, component = (list(c) for c in zip(*members, strict=True))
        term = _core.InertiaTerm(
            order,
            nodes,
            dim,
            np.array(pairs, dtype=np.int32),
            _columns(mass),
            _columns(index, np.int32),
            np.array(positions, dtype=np.int32),
        )
        book(term, account, component, len(members))
        terms.append(term)
    return terms
