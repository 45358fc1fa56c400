"""What components build when they join a system: fields of unknowns and elements of terms, in batches."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visviva import _core
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

    @property
    def size(self) -> int:
        return len(self.values)

    @property
    def unknowns(self) -> range:
        return range(self.start, self.start + self.size)

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
class Element:
    """Strains under a law, with the multipliers and signals it needs."""

    strains: Sequence[Strain]
    law: Law
    multipliers: Sequence[int]
    signals: Sequence[int]
    account: int
    component: int
    inputs: Any = None


@dataclass(eq=False)
class Model:
    """Collects fields and elements while components contribute; the system then hands them to the core."""

    components: list[Component] = field(default_factory=list)
    fields: list[Field] = field(default_factory=list)
    elements: list[Element] = field(default_factory=list)
    masses: list[tuple[Any, ...]] = field(default_factory=list)
    terms: list[tuple[Term, int]] = field(default_factory=list)
    accounts: list[Account] = field(default_factory=list)
    signals: list[TimeFunction] = field(default_factory=list)
    rigid: list[list[int]] = field(default_factory=list)
    nodes: dict[Component, list[tuple[int, bool]]] = field(default_factory=dict)
    length: float = 1.0
    _numbers: dict[int, int] = field(default_factory=dict)
    _opened: dict[tuple[int, str, str], int] = field(default_factory=dict)

    def index(self, component: Component) -> int:
        """Number of a component."""
        if len(self._numbers) != len(self.components):
            self._numbers = {id(c): k for k, c in enumerate(self.components)}
        if id(component) not in self._numbers:
            raise InputError(
                f"{component.label} is used by another component but is not part of the system; add it"
            )
        return self._numbers[id(component)]

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
    ) -> Field:
        """New unknowns; see `Field`."""
        x = np.array(values, dtype=float).ravel()
        v = np.zeros_like(x) if rates is None else np.array(rates, dtype=float).ravel()
        if scale is None:
            scale = 0.0 if order == 0 else 1.0
        scales = np.broadcast_to(np.asarray(scale, dtype=float), x.shape).copy()
        start = self.n_unknowns
        block = (component, name) if block is None and stage == 0 else (block or component)
        held = np.broadcast_to(np.asarray(fixed, dtype=bool), x.shape).copy()
        new = Field(component, name, order, start, x, v, scales, stage, multiplier, block, held)
        self.fields.append(new)
        return new

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
        pairs = [(a, b) for a in range(len(m)) for b in range(len(m)) if m[a, b] != 0.0]
        key = (2, len(m), 3, tuple(pairs), tuple(bool(p) for p in positions))
        account = self.account(component, "kinetic", "kinetic")
        index = list(range(start, start + 3 * len(m)))
        self.masses.append((key, index, [m[a, b] for a, b in pairs], account, self.index(component)))

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
    ) -> None:
        """Constraints ``strain_i = target_i(t)`` (or zero), one multiplier each from `first` on."""
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
        self._element(component, strains, law, numbers, signals, account)

    def term(self, component: Component, term: Term) -> None:
        """A whole term written in Python."""
        self.terms.append((term, self.index(component)))

    def _element(
        self,
        component: Component,
        strains: Any,
        law: Law,
        multipliers: Sequence[int],
        signals: Sequence[int],
        account: int,
    ) -> None:
        listed = strains if isinstance(strains, list | tuple) else [strains]
        exact = [strain(s) for s in listed]
        self.elements.append(
            Element(exact, law, multipliers, signals or [-1], account, self.index(component))
        )


# --- hand-over to the core ----------------------------------------------------------------------------------


@dataclass(eq=False)
class Stencil:
    """One element as the core wants it: numbered forms, products, and the unknowns they need."""

    key: tuple[Any, ...]
    index: list[int]
    weights: list[float]
    y_const: list[float]
    e_const: list[float]
    entries: dict[str, Any]


def stencil(element: Element) -> Stencil:
    """Compile an element's strains into a stencil; equal keys can share a batch."""
    forms: dict[Form, int] = {}
    unknowns: dict[int, int] = {}

    def number(form: Form) -> int:
        if form not in forms:
            forms[form] = len(forms)
            for u, _ in form.weights:
                unknowns.setdefault(u, len(unknowns))
        return forms[form]

    quad, coefficients, lin, e_const = [], [], [], []
    for i, e in enumerate(element.strains):
        for c, a, b in e.products:
            quad.append((i, number(a), number(b)))
            coefficients.append(c)
        e_const.append(e.linear.constant)
        if e.linear.weights:
            lin.append((i, number(Form(e.linear.weights))))
    entries = sorted((unknowns[u], row, w) for form, row in forms.items() for u, w in form.weights)
    shape = {
        "counts": (
            len(unknowns),
            len(forms),
            len(element.strains),
            len(element.multipliers),
            element.law.kind,
        ),
        "forms": tuple((row, col) for col, row, _ in entries),
        "quad": tuple(quad),
        "coefficients": tuple(coefficients),
        "lin": tuple(lin),
    }
    key = (*shape.values(), len(element.law.parameters), len(element.signals), element.law.callback)
    index = [*unknowns, *element.multipliers]
    return Stencil(key, index, [w for *_, w in entries], [f.constant for f in forms], e_const, shape)


def _columns(rows: Sequence[Sequence[float]], dtype: type = np.float64) -> NDArray[Any]:
    """From one row per element to element-fastest storage."""
    return np.ascontiguousarray(np.array(rows, dtype=dtype).reshape(len(rows), -1).T)


def strain_terms(model: Model) -> list[_core.Term]:
    """Batches of equal stencils, in order of first appearance."""
    groups: dict[tuple[Any, ...], list[tuple[Stencil, Element]]] = defaultdict(list)
    rigidity = {unknown for body in model.rigid for unknown in body[12:]}
    for element in model.elements:
        s = stencil(element)
        groups[not rigidity.isdisjoint(element.multipliers), s.key].append((s, element))
    terms: list[_core.Term] = []
    for (is_rigidity, _), members in groups.items():
        stencils, elements = zip(*members, strict=True)
        shape = stencils[0].entries
        n = len(stencils)
        term = _core.StrainTerm(
            list(shape["counts"]),
            np.array(shape["forms"], dtype=np.int32).reshape(-1, 2),
            np.array(shape["quad"], dtype=np.int32).reshape(-1, 3),
            np.array(shape["coefficients"], dtype=float),
            np.array(shape["lin"], dtype=np.int32).reshape(-1, 2),
            np.ones(len(shape["lin"])),
            _columns([s.index for s in stencils], np.int32),
            _columns([s.weights for s in stencils]),
            _columns([s.y_const for s in stencils]),
            _columns([s.e_const for s in stencils]),
            _columns([e.law.parameters for e in elements]),
            _columns([e.signals for e in elements], np.int32),
        )
        if elements[0].law.callback is not None:
            term.set_callback(elements[0].law.callback)
        term.is_rigidity = is_rigidity
        term.name = model.components[elements[0].component].label
        book(term, [e.account for e in elements], [e.component for e in elements], n)
        terms.append(term)
    return terms


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


def book(term: _core.Term, account: list[int], component: list[int], n: int) -> None:
    """Tell a term where its energy, work, momentum and defects are booked."""
    term.book(np.array(account, dtype=np.int32).reshape(n), np.array(component, dtype=np.int32).reshape(n))
