"""Constant linear forms of the unknowns, and strains: quadratic functions of them.

A `Form` is a number that depends linearly on the unknowns, a `Vector` is three of them, a `Strain` is a
polynomial of second degree in forms. Points and directors of bodies are vectors, so a joint or a spring is
written as a few strains, e.g. ``dot(p - q, p - q)``, and knows nothing of what it is attached to.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Form:
    """``constant + sum weight * x[unknown]``."""

    weights: tuple[tuple[int, float], ...] = ()
    constant: float = 0.0

    def __add__(self, other: Form | float) -> Form:
        if not isinstance(other, Form):
            return Form(self.weights, self.constant + other)
        if not (self.weights and other.weights):
            return Form(self.weights or other.weights, self.constant + other.constant)
        total = dict(self.weights)
        for unknown, weight in other.weights:
            total[unknown] = total.get(unknown, 0.0) + weight
        return Form(tuple([(u, w) for u, w in total.items() if w != 0.0]), self.constant + other.constant)

    def __sub__(self, other: Form | float) -> Form:
        return self + (-1.0) * other

    def __neg__(self) -> Form:
        return -1.0 * self

    def __mul__(self, factor: float) -> Form:
        if factor == 0.0:
            return Form()
        return Form(tuple([(u, factor * w) for u, w in self.weights]), factor * self.constant)

    __rmul__ = __mul__

    def value(self, x: Array) -> float:
        """Value at the unknowns `x`."""
        return self.constant + sum([w * float(x[u]) for u, w in self.weights])

    def rate(self, v: Array) -> float:
        """Value of the linear part at `v`."""
        return sum(w * float(v[u]) for u, w in self.weights)

    def size(self, scale: Array) -> float:
        """A large change of it, where those of unknowns are `scale`."""
        return max((abs(w) * float(scale[u]) for u, w in self.weights), default=0.0)


@dataclass(frozen=True, slots=True)
class Vector:
    """Three forms."""

    components: tuple[Form, Form, Form]

    @staticmethod
    def constant(value: Sequence[float] | Array) -> Vector:
        """A fixed vector (3,)."""
        x, y, z = (Form((), float(c)) for c in value)
        return Vector((x, y, z))

    @staticmethod
    def of(
        start: int, weights: Sequence[float] | Array = (1.0,), constant: Sequence[float] = (0, 0, 0)
    ) -> Vector:
        """``constant + sum_k weights[k] * (x[start + 3 k], ...)``: nodes of three unknowns each, in a row."""
        return Vector.at([start + 3 * k for k in range(len(weights))], weights, constant)

    @staticmethod
    def at(
        nodes: Sequence[int], weights: Sequence[float] | Array, constant: Sequence[float] = (0, 0, 0)
    ) -> Vector:
        """The same for nodes whose first unknowns are `nodes`."""
        kept = [(int(n), float(w)) for n, w in zip(nodes, weights, strict=True) if w]
        a, b, c = constant
        x = Form(tuple(kept), float(a))
        y = Form(tuple([(n + 1, w) for n, w in kept]), float(b))
        z = Form(tuple([(n + 2, w) for n, w in kept]), float(c))
        return Vector((x, y, z))

    def __iter__(self) -> Iterator[Form]:
        return iter(self.components)

    def __getitem__(self, k: int) -> Form:
        return self.components[k]

    def __add__(self, other: Vector) -> Vector:
        (x, y, z), (a, b, c) = self.components, other.components
        return Vector((x + a, y + b, z + c))

    def __sub__(self, other: Vector) -> Vector:
        (x, y, z), (a, b, c) = self.components, other.components
        return Vector((x - a, y - b, z - c))

    def __mul__(self, factor: float) -> Vector:
        x, y, z = (factor * a for a in self)
        return Vector((x, y, z))

    __rmul__ = __mul__

    def along(self, direction: Sequence[float] | Array) -> Form:
        """Component along a fixed direction (3,)."""
        total = Form()
        for a, d in zip(self, direction, strict=True):
            if d != 0.0:
                total = total + float(d) * a
        return total

    def value(self, x: Array) -> Array:
        """Value (3,) at the unknowns `x`."""
        return np.array([a.value(x) for a in self])

    def rate(self, v: Array) -> Array:
        """Rate (3,) at the velocities `v`."""
        return np.array([a.rate(v) for a in self])


@dataclass(frozen=True, slots=True)
class Strain:
    """``linear + sum coefficient * form_a * form_b``."""

    products: tuple[tuple[float, Form, Form], ...] = ()
    linear: Form = Form()

    def __add__(self, other: Strain | Form | float) -> Strain:
        other = strain(other)
        return Strain(self.products + other.products, self.linear + other.linear)

    __radd__ = __add__

    def __sub__(self, other: Strain | Form | float) -> Strain:
        return self + (-1.0) * strain(other)

    def __rsub__(self, other: Strain | Form | float) -> Strain:
        return strain(other) + (-1.0) * self

    def __mul__(self, factor: float) -> Strain:
        return Strain(tuple((factor * c, a, b) for c, a, b in self.products), factor * self.linear)

    __rmul__ = __mul__

    def value(self, x: Array) -> float:
        """Value at the unknowns `x`."""
        return self.linear.value(x) + sum(c * a.value(x) * b.value(x) for c, a, b in self.products)

    def rate(self, x: Array, v: Array) -> float:
        """Time derivative at the unknowns `x` with rates `v`."""
        products = (c * (a.rate(v) * b.value(x) + a.value(x) * b.rate(v)) for c, a, b in self.products)
        return self.linear.rate(v) + sum(products)

    def size(self, scale: Array) -> float:
        """A large change of it, where those of unknowns are `scale`."""
        products = (abs(c) * a.size(scale) * b.size(scale) for c, a, b in self.products)
        return max(self.linear.size(scale), *products, 0.0)

    @property
    def unknowns(self) -> set[int]:
        """Unknowns that it sees."""
        forms = [self.linear, *(f for _, a, b in self.products for f in (a, b))]
        return {u for f in forms for u, _ in f.weights}

    def gradient(self, x: Array) -> dict[int, float]:
        """Nonzero derivatives by unknown at `x`."""
        g: dict[int, float] = dict(self.linear.weights)
        for c, a, b in self.products:
            for form, factor in ((a, c * b.value(x)), (b, c * a.value(x))):
                for u, w in form.weights:
                    g[u] = g.get(u, 0.0) + factor * w
        return g


def strain(a: Strain | Form | float) -> Strain:
    """Whatever is given, as a strain."""
    if isinstance(a, Strain):
        return a
    return Strain((), a if isinstance(a, Form) else Form((), float(a)))


def product(a: Form, b: Form) -> Strain:
    """The product of two forms; constants stay out of the quadratic part."""
    if not a.weights:
        return Strain((), a.constant * b)
    if not b.weights:
        return Strain((), b.constant * a)
    return Strain(((1.0, a, b),))


def dot(a: Vector, b: Vector) -> Strain:
    """Scalar product of two vectors."""
    x, y, z = map(product, a.components, b.components)
    return Strain(x.products + y.products + z.products, x.linear + y.linear + z.linear)


def squared(a: Vector) -> Strain:
    """Squared length of a vector."""
    return dot(a, a)
