"""Fields of unknowns with their roles, and what moves those that are fixed."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from enum import Enum
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from visviva.base.differences import forward_curvature
from visviva.base.timefunction import rounding
from visviva.model.composition import Composition
from visviva.model.form import Form, Vector

Array = NDArray[np.float64]
Vectors = tuple[NDArray[np.int64], NDArray[np.bool_], int]


class Owner(Protocol):
    """Whose fields and terms they are: a component, as far as models ask it."""

    @property
    def label(self) -> str:
        """Name used in messages."""
        ...

    def vectors(self, model: Any) -> Vectors | None:
        """Vectors it is made of: first unknowns (n,), whether each is a position (n,), and components, 2 or 3.

        Positions move along under a translation, directors do not. None for what cannot move.
        """
        ...

    def weigh(self, model: Any, acceleration: Array) -> None:
        """Add the potential of uniform gravity."""
        ...

    @property
    def total_mass(self) -> float:
        """Its mass."""
        ...

    @property
    def carries_heat(self) -> bool:
        """Whether it has temperatures."""
        ...

    def mass_blocks(self, model: Any) -> Iterator[tuple[NDArray[np.int64], Array]]:
        """Its mass between vectors of three unknowns: where these begin (m, k), and the mass matrices (m, k, k)."""
        ...


FAINT = 0.01
"""Changes of what starts uniform, over its value, that are the least to be resolved."""


class Role(Enum):
    """Kind of unknowns: it decides how they move in time, how they are booked, and which solvers suit them.

    Attributes
    ----------
    MOTION
        Positions, directors, angles: order 2 in time.
    CONTENT
        What is transported and stored by itself, such as heat: order 1. The ledger counts the stored quantity.
    VELOCITY
        Of a flow: order 1. The ledger counts half its square; what it carries along makes tangents unsymmetric.
    STATE
        Without rates: where the energy is least, such as enhanced strains.
    MULTIPLIER
        Of constraints, such as the pressure of what is incompressible.
    POTENTIAL
        Chemical potential that a content follows in a step: without rates, and as many as there are contents.
    TEMPERATURE
        At which entropy is exchanged over a step: without rates, it follows from what stores energy.
    SOLID_PRESSURE, FLUID_PRESSURE, CONTACT_PRESSURE
        Pressures (of contact: tractions, too) that follow from a compliance, a stabilisation, or by an inequality:
        the energy is largest in them.
    """

    MOTION = "motion"
    CONTENT = "content"
    VELOCITY = "velocity"
    STATE = "state"
    MULTIPLIER = "multiplier"
    POTENTIAL = "potential"
    TEMPERATURE = "temperature"
    SOLID_PRESSURE = "solid pressure"
    FLUID_PRESSURE = "fluid pressure"
    CONTACT_PRESSURE = "contact pressure"

    @property
    def order(self) -> int:
        """In time."""
        return ORDERS.get(self, 0)

    @property
    def bears(self) -> bool:
        """Whether it stands for forces: the energy is largest in it."""
        return self not in ORDERS and self not in (Role.STATE, Role.POTENTIAL, Role.TEMPERATURE)

    @property
    def supply(self) -> int:
        """Kind of energy that held unknowns receive from the force r that holds them, see the core's `Supply`."""
        return SUPPLIES.get(self, 0)

    @property
    def has_least_energy(self) -> bool:
        """Whether stable equilibria have the least energy in it."""
        return self in (Role.MOTION, Role.STATE)


ORDERS = {Role.MOTION: 2, Role.CONTENT: 1, Role.VELOCITY: 1}
SUPPLIES = {Role.VELOCITY: 1, Role.CONTENT: 2}


@dataclass(eq=False)
class Field:
    """A block of unknowns of one role.

    Attributes
    ----------
    start, size : int
        The unknowns ``start ... start + size - 1`` of the system.
    scale : float
        A change of this size is large (length of the model, 1 for directors and angles); 0: not judged.
    least : float
        Of what is transported: part of the scale that is known to be reached. Errors of adaptive steps are measured by
        that, or by the largest change up to now; 0: nothing tells how large changes will be.
    stage : int
        Order of elimination: 0 has inertia, 1 multipliers and massless coordinates, 2 couples only those.
    block : object
        Unknowns of equal block are eliminated together; by default the component.
    fixed : bool array
        Unknowns that keep their values and have no equation.
    node : int
        So many consecutive unknowns make up a node of a mesh.
    beside : Field or None
        One whose nodes are at the same places: iterative solvers take the unknowns of both there together.
    part : int
        So many consecutive unknowns make up a block of their own, together with the part of the same number of other
        fields of that block; 0: all are one.
    element : int array (size,)
        The only element that touches each unknown, which is eliminated with that element's equations before the
        others are solved; -1 if several do. An element's own unknowns follow each other.
    instantaneous : bool
        Of multipliers: whether their constraints hold at every instant; else they speak of what happens in a step.
    composition : Composition, optional
        Of the system that numbers the unknowns.
    moves : bool
        Whether the component itself gave rates; what it is carried by or prescribed may add others later.
    """

    component: Owner
    name: str
    role: Role
    start: int
    values: Array
    rates: Array
    scale: Array
    stage: int
    block: Any
    fixed: NDArray[np.bool_]
    node: int = 1
    part: int = 0
    instantaneous: bool = True
    element: NDArray[np.int32] = field(default_factory=lambda: np.zeros(0, dtype=np.int32))
    composition: Composition | None = None
    beside: Field | None = None
    least: float = 1.0
    moves: bool = field(init=False)

    def __post_init__(self) -> None:
        self.moves = bool(np.any(self.rates))
        if len(self.element) == 0:
            self.element = np.full(self.size, -1, dtype=np.int32)

    @property
    def order(self) -> int:
        """In time, of its role."""
        return self.role.order

    @property
    def multiplier(self) -> bool:
        """Whether it holds multipliers of constraints."""
        return self.role is Role.MULTIPLIER

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

    def form(self, k: int = 0) -> Form:
        """The `k`-th unknown as a form."""
        return Form(((self.start + k, 1.0),), 0.0, self.composition)

    def vector(self, node: int = 0) -> Vector:
        """Three unknowns as a vector."""
        return Vector.of(self.start + 3 * node).owned(self.composition)


def supply_of(held: Field) -> str:
    """Category of what held unknowns of a field take in: heat, or work."""
    return "heat" if held.role is Role.CONTENT and held.component.carries_heat else "work"


@dataclass(eq=False)
class Prescription:
    """Fixed unknowns that move as a function of time says.

    Attributes
    ----------
    unknowns : int array (k,)
    values : callable
        Their values (k,) at a time.
    rates : callable
        Their rates (k,) just after a time, given the length of steps, 0 if that is not known.
    account : int
        Where the work of what moves them is booked.
    supply : int
        See `Role.supply`.
    kinks : tuple of float
        When rates may jump.
    """

    component: Owner
    unknowns: NDArray[np.int32]
    values: Callable[[float], Array]
    rates: Callable[[float, float], Array]
    account: int
    supply: int
    kinks: tuple[float, ...] = ()

    def acceleration(self, time: float, step: float) -> Array:
        """Second derivatives (k,) of the values just after a time, by differences over parts of a step.

        Nothing where these would reach beyond a kink: what happens there happens at once.
        """
        near = rounding(time, step)
        if any(near < kink - time < step + near for kink in self.kinks):
            return np.zeros(len(self.unknowns))
        values: Array = forward_curvature(self.values, time, step)
        return values
