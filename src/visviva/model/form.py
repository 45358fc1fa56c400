"""Constant linear forms of the unknowns, and strains: quadratic functions of them.

A `Form` is a number that depends linearly on the unknowns, a `Vector` is three of them, a `Strain` is a
polynomial of second degree in forms. Points and directors of bodies are vectors, so a joint or a spring is
written as a few strains, e.g. ``dot(p - q, p - q)``, and knows nothing of what it is attached to.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.model.composition import Composition

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Form:
    """``constant + sum weight * x[unknown]``.

    Attributes
    ----------
    weights : tuple of (int, float)
        Numbers of unknowns with their weights.
    constant : float
    composition : Composition, optional
        Of the system that numbered the unknowns, if components made the form; it is refused elsewhere. What is made of
        bare numbers is read as it stands.
    """

    weights: tuple[tuple[int, float], ...] = ()
    constant: float = 0.0
    composition: Composition | None = field(default=None, compare=False, repr=False)

    def __add__(self, other: Form | float) -> Form:
        if not isinstance(other, Form):
            return Form(self.weights, self.constant + other, self.composition)
        composition = common(self.composition, other.composition)
        if not (self.weights and other.weights):
            return Form(self.weights or other.weights, self.constant + other.constant, composition)
        total = dict(self.weights)
        for unknown, weight in other.weights:
            total[unknown] = total.get(unknown, 0.0) + weight
        weights = tuple([(u, w) for u, w in total.items() if w != 0.0])
        return Form(weights, self.constant + other.constant, composition)

    def __sub__(self, other: Form | float) -> Form:
        return self + (-1.0) * other

    def __neg__(self) -> Form:
        return -1.0 * self

    def __mul__(self, factor: float) -> Form:
        if factor == 0.0:
            return Form()
        weights = tuple([(u, factor * w) for u, w in self.weights])
        return Form(weights, factor * self.constant, self.composition)

    __rmul__ = __mul__

    def owned(self, composition: Composition | None) -> Form:
        """The same, of unknowns that a composition has numbered."""
        return Form(self.weights, self.constant, composition) if self.weights else self

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

    def owned(self, composition: Composition | None) -> Vector:
        """The same, of unknowns that a composition has numbered."""
        x, y, z = self.components
        return Vector((x.owned(composition), y.owned(composition), z.owned(composition)))

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
    def forms(self) -> list[Form]:
        """Forms that it is made of."""
        return [self.linear, *(f for _, a, b in self.products for f in (a, b))]

    @property
    def unknowns(self) -> set[int]:
        """Unknowns that it sees."""
        return {u for f in self.forms for u, _ in f.weights}

    def gradient(self, x: Array) -> dict[int, float]:
        """Nonzero derivatives by unknown at `x`."""
        g: dict[int, float] = dict(self.linear.weights)
        for c, a, b in self.products:
            for form, factor in ((a, c * b.value(x)), (b, c * a.value(x))):
                for u, w in form.weights:
                    g[u] = g.get(u, 0.0) + factor * w
        return g


def common(a: Composition | None, b: Composition | None) -> Composition | None:
    """The composition of a form that is made of two."""
    if a is None or b is None or a is b:
        return b if a is None else a
    if not a.is_alike(b):
        raise InputError(
            "forms of two systems, or of one before and after a reset, have no sum: they number their unknowns "
            "differently; ask the joints and points of one system for all of them"
        )
    return b


def refuse_foreign(whose: str, what: Form | Vector | Strain, composition: Composition) -> None:
    """Refuse forms whose unknowns were numbered by another composition than the one they are to be read in.

    Raises
    ------
    InputError
        With the component and unknown meant, and the cure.
    """
    for form in [what] if isinstance(what, Form) else what if isinstance(what, Vector) else what.forms:
        own = form.composition
        if not (own is None or own is composition or own.is_alike(composition)):
            label, unknown = own.describe(form.weights[0][0])
            raise InputError(
                f"{whose}: this form sees {unknown} of {label} in another system, or before a reset that changed "
                "numbers or initial values, and would read other unknowns here. Ask for it anew (joint.coordinate(), "
                "point.position), or take a probe, which does so itself: vv.JointCoordinate(joint=...), "
                "vv.Position(of=...)"
            )


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
    """Scalar product of two vectors of forms, such as the directors and positions of the two sides of a joint.

    Parameters
    ----------
    a, b : Vector
        Linear in the unknowns.

    Returns
    -------
    Strain
        Quadratic in the unknowns.

    Examples
    --------
    >>> import visviva as vv
    >>> ball = vv.PointMass(mass=1.0, position=(3, 4, 0))
    >>> system, x = vv.System([ball]), ball.point().position
    >>> float(system.value(vv.dot(x, x)))
    25.0
    """
    x, y, z = map(product, a.components, b.components)
    return Strain(x.products + y.products + z.products, x.linear + y.linear + z.linear)


def squared(a: Vector) -> Strain:
    """Squared length of a vector."""
    return dot(a, a)
