"""Components: what the user names. Each bundles fields, terms, points and what is drawn of it."""

from __future__ import annotations

import weakref
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence, Set
from contextlib import contextmanager
from copy import deepcopy
from dataclasses import MISSING, Field, fields
from types import FunctionType
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import ConfigDict
from pydantic.dataclasses import dataclass

from visviva.base.arguments import MADE, Validated, fixed
from visviva.base.errors import InputError
from visviva.component.momentum import EVERYWHERE, Axes
from visviva.component.within import within
from visviva.model.field import Vectors
from visviva.model.form import Vector

if TYPE_CHECKING:
    import scipy.sparse as sp

    from visviva.model.model import Model
    from visviva.model.state import State
    from visviva.scheme.schemes import Scheme

    RateConstraints = tuple[NDArray[np.int64], sp.csr_array, NDArray[np.float64]]

Array = NDArray[np.float64]

settings = ConfigDict(arbitrary_types_allowed=True, extra="forbid", validate_default=True, defer_build=True)
"""Validation of the constructors of components: unknown arguments are refused."""


LONG = 60
"""Characters of an argument that are shown; longer ones lose their ends."""


def short(value: Any) -> str:
    """An argument in few words: components by their labels, arrays by their shapes."""
    if isinstance(value, Component):
        return value.label
    component = getattr(value, "component", None)
    if isinstance(component, Component):
        return f"{type(value).__name__.lower()} of {component.label}"
    if isinstance(value, FunctionType):
        return value.__name__
    if isinstance(value, np.ndarray):
        return repr(value.tolist()) if value.size <= 3 else f"array of {' x '.join(map(str, value.shape))}"
    if isinstance(value, list | tuple) and len(value) <= 3:
        return (
            f"[{', '.join(map(short, value))}]"
            if isinstance(value, list)
            else f"({', '.join(map(short, value))})"
        )
    text = (
        f"{len(value)} items" if isinstance(value, list | tuple | Mapping) else " ".join(repr(value).split())
    )
    return text if len(text) <= LONG else f"{text[:LONG]}..."


def is_told(component: Component, f: Field[Any]) -> bool:
    """True if the argument differs from its default, or has none."""
    value = getattr(component, f.name, None)
    if f.default is MISSING:
        return True
    if isinstance(value, np.ndarray):
        return f.default is None or not np.array_equal(value, np.asarray(f.default, dtype=object))
    return value is not f.default and not (
        isinstance(value, str | int | float | tuple) and value == f.default
    )


WAS_SET = "_was_set"
"""Attribute of components of which an argument was set before they were in a system."""
EDITION = "_edition"
"""Attribute of components that is another object whenever arguments have taken effect anew."""
COMPOSITION = "_composition"
"""Attribute of components that are in a system: the composition that their unknowns are numbered in."""


class Composed(Validated):
    """Type of components, which know when they are made: from then on arguments that are set are validated."""

    def _make(cls, *args: Any, **kwargs: Any) -> Any:
        made = super().__call__(*args, **kwargs)
        vars(made).update({MADE: True, EDITION: object()})
        return made

    if not TYPE_CHECKING:
        __call__ = _make


@dataclass(config=settings, eq=False, kw_only=True)
class Component(metaclass=Composed):
    """Base of everything that a system is composed of.

    A component takes part in a system in three rounds: `announce` tells what it does to others, `declare` makes its
    fields, `contribute` adds its terms, where it may use the points of any other component.

    Parameters
    ----------
    name : str, optional
        Unique in a system: messages, tables, pictures and ``system["name"]`` know it by that. By default that of its
        class with a number.
    """

    name: str | None = None

    contributes_last: ClassVar[int] = 0  # since it asks what others hold: those with larger numbers later
    carries_heat = False  # whether it has temperatures that what it touches could see
    is_fixed = False  # without unknowns, so that others may attach to it though it is in no system

    def __init_subclass__(cls, **options: Any) -> None:
        """Components write themselves shortly, whatever arrays they are made of."""
        super().__init_subclass__(**options)
        if "__repr__" not in vars(cls):
            cls.__repr__ = Component.__repr__  # type: ignore[method-assign]  # a dataclass would write its own

    def __repr__(self) -> str:
        told = [
            f"{f.name}={short(getattr(self, f.name, None))}"
            for f in fields(self)
            if f.init and is_told(self, f)
        ]
        return f"{type(self).__name__}({', '.join(told)})"

    def __deepcopy__(self, memo: dict[int, Any]) -> Component:
        """One made of copies of the same arguments, in no system."""
        made = type(self).__new__(type(self))
        memo[id(self)] = made
        vars(made).update({name: deepcopy(value, memo) for name, value in self._as_made().items()})
        made.forget()
        return made

    def __copy__(self) -> Component:
        """One made of the same arguments, in no system."""
        made = type(self).__new__(type(self))
        vars(made).update(self._as_made())
        made.forget()
        return made

    def _as_made(self) -> dict[str, Any]:
        """The arguments; of a class of the user's own that is no dataclass all there is, as nothing else is known."""
        if "__dataclass_fields__" in vars(type(self)):
            return {f.name: getattr(self, f.name) for f in fields(self) if f.init}
        return {
            name: value
            for name, value in vars(self).items()
            if name not in (MADE, WAS_SET, EDITION, COMPOSITION, "_system")
        }

    def forget(self) -> None:
        """Forget the system that it was in, so that it can be put into one again."""
        given = self._as_made()
        vars(self).clear()
        vars(self).update(given)
        if "__dataclass_fields__" in vars(type(self)) and hasattr(self, "__post_init__"):
            self.__post_init__()
        fixed(self)
        vars(self).update({MADE: True, EDITION: object()})

    def __setattr__(self, name: str, value: Any) -> None:
        """Set an attribute; arguments are validated, and in a system they wait for `System.reset`."""
        arguments = getattr(type(self), "__dataclass_fields__", {})
        if MADE not in vars(self) or name not in arguments or not arguments[name].init:
            super().__setattr__(name, value)
            return
        system = system_of(self)
        if "__dataclass_fields__" not in vars(type(self)):  # of the user's own, made in a way of its own
            super().__setattr__(name, value)
        elif system is None:
            made = type(self)(**(self._as_made() | {name: value}))
            vars(self).clear()
            vars(self).update(vars(made) | {WAS_SET: True})
        else:
            vars(self)[name] = getattr(type(self)(**(self._as_made() | {name: value})), name)
        if system is not None:
            system.changed.setdefault(self.label, []).append(name)

    @property
    def label(self) -> str:
        """Name used in messages."""
        return f"{type(self).__name__} '{self.name}'" if self.name else type(self).__name__

    def announce(self, model: Model) -> None:
        """Tell, by `Model.announce`, what it will do to others that act on that when they declare or contribute."""

    def declare(self, model: Model) -> None:
        """Make the fields."""

    def contribute(self, model: Model) -> None:
        """Add the terms."""

    def start(self, state: State, scheme: Scheme) -> None:
        """Before the first step of a run with a scheme."""

    def follow_start(self, state: State) -> None:
        """After the check has moved the start of other components onto their constraints."""

    def rate_constraints(self, state: State) -> RateConstraints | None:
        """Conditions on accelerations besides the constraints of an instant, for schemes that start from them.

        Returns
        -------
        multipliers (m,), gradients (m, n) by the accelerations of all unknowns, and what these shall add up to (m,).
        """
        return None

    def trouble(self, x: Array) -> str:
        """Trouble of the component at the unknowns `x` of the system, for the message of a step that failed."""
        return ""

    @property
    def outside_axes(self) -> Axes:
        """Along which axes it exchanges linear, and about which angular momentum with what is in no system.

        What acts by forces that are equal and opposite, or by none, does so nowhere; unless one side is the ground.
        """
        return EVERYWHERE

    @property
    def touches(self) -> bool:
        """True if it acts by an inequality, like contact."""
        return False

    @property
    def rubs(self) -> bool:
        """True if it acts by friction: such forces have no potential."""
        return False

    @property
    def collides(self) -> bool:
        """True if velocities may jump within a step (impact), which the motion before does not announce."""
        return False

    @property
    def overlaps(self) -> Array:
        """Depths (n,) of overlaps of what `collides` at the state evaluated last; adaptive steps bound their growth."""
        return np.zeros(0)

    def unfit_for_modes(self) -> str:
        """Why small motions about the last evaluation do not vibrate linearly, and a cure; empty if they do or may."""
        return ""

    @property
    def least_tangents(self) -> int:
        """So many iterations of a step should make tangents of their own where `Newton` does not say."""
        return 0

    def remarks(self) -> list[str]:
        """Remarks on accuracy that the check prints before the first step, in sentences."""
        return []

    def gauges(self, state: State) -> dict[str, float]:
        """Numbers about the last step that are shown while a run goes on, by name."""
        return {}

    def weights(self) -> list[tuple[float, Vector]]:
        """Masses with the points they hang on: what uniform gravity acts upon."""
        return []

    @property
    def total_mass(self) -> float:
        """Its mass."""
        return sum(m for m, _ in self.weights())

    def mass_moment(self, x: Array) -> Array:
        """Mass times the position of its centre (3,), at the unknowns `x` of the system."""
        moments = [m * np.asarray(place.value(x)) for m, place in self.weights()]
        return np.sum(moments, axis=0) if moments else np.zeros(3)

    def weigh(self, model: Model, acceleration: Array) -> None:
        """Add the potential of uniform gravity."""
        from visviva.model.law import linear

        for mass, centre in self.weights():
            e = centre.along(-mass * acceleration)
            if e.weights:
                model.potential(self, "gravity", e, linear(1.0))

    def mass_blocks(self, model: Model) -> Iterator[tuple[NDArray[np.int64], Array]]:
        """Its mass between vectors of three unknowns: where these begin (m, k), and the mass matrices (m, k, k)."""
        number, alike = model.index(self), defaultdict(list)
        for key, index, values, _, owner in model.masses:
            if owner == number:
                alike[key].append((index[::3], values))
        for (_, k, _, pairs, _), found in alike.items():
            mass = np.zeros((len(found), k, k))
            mass[:, *np.array(pairs).T] = [values for _, values in found]
            yield np.array([starts for starts, _ in found], dtype=np.int64), mass

    def vectors(self, model: Model) -> Vectors | None:
        """Vectors that carry the component, see `Owner`; None for components without points."""
        return None

    @property
    def is_thin(self) -> bool:
        """Whether its mesh is a line or a middle surface, so that its faces bound no volume."""
        return False

    def surface(self) -> Any:
        """Drawn surface in own coordinates: points (n, 3) and triangles (m, 3); None for nothing."""
        return None

    def outline(self) -> Any:
        """Its exact shape and the frame of that (`Outline`), for contact; None if only triangles of it are known."""
        return None

    def record(self, x: Array) -> Array | None:
        """Record of the last step, which ended at `x`, that does not follow from `x`; kept with every state."""
        return None

    def lines(self) -> list[tuple[Vector, Vector]]:
        """Lines that are drawn of it, from point to point (ropes, rods, springs)."""
        return []


def name_components(components: Sequence[Component]) -> None:
    """Give names to those that have none.

    Raises
    ------
    InputError
        If two have the same, or one is no component.
    """
    for c in components:
        if not isinstance(c, Component):
            raise InputError(f"a system is composed of components, not of {c!r}")
    seen: Counter[str] = Counter()
    taken = {c.name for c in components if c.name}
    for c in components:
        if c.name is None:
            kind = type(c).__name__.lower()
            while c.name is None or c.name in taken:
                seen[kind] += 1
                vars(c)["name"] = f"{kind}-{seen[kind]}"
            taken.add(c.name)
    twice = [c for c, k in Counter(map(id, components)).items() if k > 1]
    if twice:
        named = next(c.label for c in components if id(c) == twice[0])
        raise InputError(f"{named} is listed twice among the components of a system")
    doubled = [n for n, k in Counter(c.name for c in components).items() if k > 1]
    if doubled:
        raise InputError(f"several components are called {doubled[0]!r}; names must be unique")


def system_of(component: Component) -> Any:
    """The system that a component is in, None if there is none or it is gone."""
    return vars(component).get("_system", lambda: None)()


@contextmanager
def claimed(system: Any, components: Sequence[Component]) -> Iterator[None]:
    """Make components those of a system, which is composed of them meanwhile; where that fails, they are in none.

    Raises
    ------
    InputError
        If one is no component, has the name of another, names one that is not here, or belongs to another system.
    """
    name_components(components)
    refuse_loose(components)
    try:
        _claim(system, components)
        yield
    except BaseException:
        for c in components:
            if system_of(c) is system:
                del vars(c)["_system"], vars(c)[COMPOSITION]
        raise
    finally:
        for c in components:
            vars(c)[MADE] = True


def _claim(system: Any, components: Sequence[Component]) -> None:
    for c in components:
        owner = system_of(c)
        if owner is not None and any(c is other for other in owner.components):  # a copy keeps the reference
            raise InputError(
                f"{c.label} belongs to another system; copy.deepcopy the components before reuse"
            )
        vars(c).update({"_system": weakref.ref(system), COMPOSITION: system.composition})
        vars(c).pop(MADE, None)


def begin_anew(components: Sequence[Component]) -> None:
    """Make all forget what they worked out of their arguments, each after those that its arguments name."""
    left = {id(c): c for c in components}

    def forget(c: Component) -> None:
        if left.pop(id(c), None) is None:
            return
        for value in c._as_made().values():
            for other in mentioned(value):
                forget(other)
        c.forget()

    for c in components:
        forget(c)


def begin_if_set(components: Sequence[Component]) -> None:
    """Begin anew with components of no system, if an argument of one was set after others had looked at it."""
    free = [c for c in components if isinstance(c, Component) and system_of(c) is None]
    if any(WAS_SET in vars(c) for c in free):
        begin_anew(free)


def refuse_changed(system: Any) -> None:
    """Refuse arguments of components that were set since their system was made, as it goes on without them."""
    for label, names in system.changed.items():
        raise InputError(
            f"{label}: {' and '.join(dict.fromkeys(names))} changed since the system was made, which knows "
            "nothing of it; system.reset(), or vv.simulate(..., start='beginning'), begins anew with it"
        )


def refuse_loose(components: Sequence[Component]) -> None:
    """Refuse components that name others which are not among them."""
    here = {id(c) for c in components}
    for c in components:
        refuse_absent(c.label, {f.name: getattr(c, f.name) for f in fields(c)}, here)


def refuse_absent(whose: str, given: Mapping[str, Any], here: Set[int]) -> None:
    """Refuse values, by their names, that name a component of which the `id` is not in a set."""
    absent = ((name, c) for name, value in given.items() for c in mentioned(value))
    for name, other in absent:
        if not (other.is_fixed or id(other) in here):
            raise InputError(
                f"{whose}: {name} is {other.label}, which is not in the system: add it to the list of its components"
            )


def mentioned(value: Any) -> Iterator[Component]:
    """Components that an argument is, attaches to, or measures."""
    return within(value, Component)


def characteristic_length(components: Sequence[Component]) -> float:
    """Extent of the model: the scale of positions in convergence tests and reports."""
    places = [getattr(c, "position", None) for c in components]
    places += [getattr(c, "at", None) for c in components]
    given = np.array([p for p in places if p is not None and np.shape(p) == (3,)], dtype=float)
    sizes = [np.linalg.norm(np.ptp(given, axis=0)) if len(given) else 0.0]
    sizes += [float(getattr(c, "extent", 0.0)) for c in components]
    for c in components:
        m = getattr(c, "mass_properties", None)
        if m is not None:
            mass, _, J = m()
            sizes.append(float(np.sqrt(np.trace(J) / mass)))
    return float(max(sizes)) or way_of_one(components, given)


def way_of_one(components: Sequence[Component], places: Array) -> float:
    """The length of a model without extent, of one point: how far it is from the origin, where the ground stands, else
    what it goes in a unit of time, 1 where it does neither."""
    velocities = [getattr(c, "velocity", None) for c in components]
    speeds = [np.linalg.norm(v) for v in velocities if v is not None and np.shape(v) == (3,)]
    far = np.linalg.norm(places, axis=1) if len(places) else np.zeros(1)
    return float(far.max()) or float(max(speeds, default=0.0)) or 1.0
