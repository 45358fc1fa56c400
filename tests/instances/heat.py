"""Heat conduction in a bar: transport (order 1) with exchange at one end."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.component.component import Component, settings
from visviva.component.values import Number
from visviva.model.field import Role
from visviva.model.model import Model
from visviva.model.term import Stencils, Term

Array = NDArray[np.float64]


class Conduction(Term):
    """``c T' - (k T_x)_x = 0`` in linear elements; stores heat and passes it on without loss."""

    kind = "heat"

    def __init__(self, nodes: NDArray[np.int32], length: float) -> None:
        super().__init__()
        self.unknowns, self.order = nodes, np.array([1, 1])
        self.capacity = length / 6 * np.array([[2.0, 1.0], [1.0, 2.0]])
        self.conduction = 1 / length * np.array([[1.0, -1.0], [-1.0, 1.0]])

    def residual(self, s: Stencils) -> Array:
        return s.rate @ self.capacity + s.x @ self.conduction

    def tangent(self, s: Stencils) -> Array:
        K = s.step.transport_factor * self.capacity + s.step.theta * self.conduction
        return np.broadcast_to(K, (len(self.unknowns), 2, 2))

    def energy(self, s: Stencils) -> Array:
        heat: Array = (s.x1 @ self.capacity).sum(axis=1)
        return heat


class Exchange(Term):
    """Heat ``a (T - T_outside)`` leaves at a node; differentiated numerically."""

    kind = "exchange"

    def __init__(self, node: int, coefficient: float, outside: float) -> None:
        super().__init__()
        self.unknowns, self.order = np.array([[node]], dtype=np.int32), np.array([1])
        self.coefficient, self.outside = coefficient, outside

    def residual(self, s: Stencils) -> Array:
        return self.coefficient * (s.x - self.outside)

    def work(self, s: Stencils) -> Array:
        supplied: Array = -s.step.h * self.residual(s)[:, 0]
        return supplied


@dataclass(config=settings, eq=False, kw_only=True)
class Bar(Component):
    """A bar of length 1 with exchange at its left end; `temperatures` initially at equally spaced nodes."""

    temperatures: Any = (1.0, 3.0, -1.0, 0.5, 2.0)
    exchange: Number = 0.7
    outside: Number = 0.2

    def declare(self, model: Model) -> None:
        self.heat = model.field(self, "temperature", self.temperatures, role=Role.CONTENT)

    def contribute(self, model: Model) -> None:
        nodes = np.arange(self.heat.start, self.heat.start + self.heat.size, dtype=np.int32)
        pairs = np.stack([nodes[:-1], nodes[1:]], axis=1)
        model.term(self, Conduction(pairs, 1.0 / (len(nodes) - 1)))
        if self.exchange:
            model.term(self, Exchange(int(nodes[0]), self.exchange, self.outside))
