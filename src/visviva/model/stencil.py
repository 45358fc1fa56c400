"""Hand-over to the core: strains compiled to stencils, and elements of equal ones in batches."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.model.batch import book
from visviva.model.form import Form, Strain
from visviva.model.model import Element, Model


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
        """Structure common to all stencils of a batch."""
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
    rigidity = {unknown for body in model.reductions.rigid for unknown in body[12:]}
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
