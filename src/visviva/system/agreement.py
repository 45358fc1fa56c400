"""Processes that share a system have to compose the same: what they tell of it is compared before they go on."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, closing, nullcontext
from itertools import islice
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

import visviva
from visviva.base.errors import InputError
from visviva.base.processes import refuse_unaware
from visviva.base.told import Teller, arguments_of, digest_of, shortened
from visviva.base.world import tell_crowds, world
from visviva.component.component import Component

if TYPE_CHECKING:
    from visviva.model.driving import Driving
    from visviva.model.field import Field
    from visviva.system.newton import Newton
    from visviva.system.system import System

T = TypeVar("T")
Array = NDArray[np.float64]
Arguments = dict[str, dict[str, str]]
"""Values of arguments, by the labels of components and the names of arguments."""
ALIKE = 1e-9
"""Differences, relative to the largest of some values, by which these are the same but for rounding."""
CALLED = (
    "Every process calls it, and has to get the same: give random numbers a seed, and use nothing that other functions "
    "have noted, which not all processes call as often; or ask all of them, by world().first(number) or "
    "world().largest(number) of visviva.base.world"
)

SAME = (
    "Each runs the whole script, and has to make the same of it: give random numbers a seed, take components from "
    "lists rather than sets, let nothing depend on the process, and start one version of visviva and of the script"
)


def told(
    owner: str, arguments: Mapping[str, Any], names: Mapping[int, str], untold: list[str]
) -> dict[str, str]:
    """Arguments in words; the reasons why parts of them are not told are added to `untold`."""
    texts: dict[str, str] = {}
    for name, value in arguments.items():
        teller = Teller(names)
        texts[name] = shortened(teller.text(value))
        untold.extend(f"{owner}: {name} ({reason})" for reason in teller.untold)
    return texts


def names_of(components: Sequence[Component]) -> dict[int, str]:
    """By what components are told where arguments refer to them."""
    return {id(c): f"component {c.name!r}" for c in components}


def told_components(
    components: Sequence[Component], names: Mapping[int, str], untold: list[str]
) -> Arguments:
    """All arguments of components."""
    return {c.label: told(c.label, {"class": type(c)} | arguments_of(c), names, untold) for c in components}


def variables_of(components: Sequence[Component], names: Mapping[int, str]) -> Arguments:
    """What functions among the arguments of components use."""
    texts: Arguments = {}
    for c in components:
        for name, value in arguments_of(c).items():
            teller = Teller(names)
            teller.text(value)
            texts.setdefault(c.label, {}).update({f"{name}: {k}": v for k, v in teller.variables.items()})
    return texts


def refuse_different(components: Sequence[Component], newton: Newton) -> None:
    """Refuse components of which another process has others, in another order or with other arguments.

    Raises
    ------
    InputError
        With the first that differs, or if this process was started with others and cannot come together with them.
    """
    if world().size == 1:
        return refuse_unaware()
    tell_crowds()
    names, untold, to = names_of(components), list[str](), "compose a system"
    compare(
        {
            "visviva": {"version": visviva.__version__},
            "Newton": told("", arguments_of(newton), names, untold),
        },
        to,
    )
    compare({"system": {f"component {k}": c.label for k, c in enumerate(components, 1)}}, to)
    compare(told_components(components, names, untold), to, lambda: variables_of(components, names))


def refuse_different_newton(newton: Newton) -> None:
    """Refuse options of the solver of which another process has others: they would take other iterations."""
    if world().size > 1:
        compare({"Newton": told("", arguments_of(newton), {}, [])}, "choose options of Newton's method")


def agree_on_states(fields: Sequence[Field], x: Array, v: Array) -> None:
    """Give all processes the unknowns (n,) and rates (n,) of the first, which theirs are but for rounding.

    Raises
    ------
    InputError
        With the first field that another process has otherwise; random values have no seed.
    """
    if world().size == 1 or not fields:
        return
    texts: Arguments = {}
    for f in fields:
        held = told("", {f"what is held of {place_of(f)}": f.fixed}, {}, [])
        texts.setdefault(f.component.label, {}).update(held)
    compare(texts, "begin with a state")
    parts, owners = [slice(f.start, f.start + f.size) for f in fields], [f.component.label for f in fields]
    # rates may be differences of functions over unknown times: they are rounded as these are in a unit of time
    sizes = [max(largest_of(f.scale), largest_of(x[part])) for f, part in zip(fields, parts, strict=True)]
    for kind, of_all in {"state": x, "rates": v}.items():
        names = [f"{kind} of {place_of(f)}" for f in fields]
        found = agreed(names, owners, [of_all[part] for part in parts], sizes, SAME)
        for part, values in zip(parts, found, strict=True):
            of_all[part] = values


def place_of(field: Field) -> str:
    """Which unknowns a field has, in words."""
    return f"{field.name} (unknowns from {field.start} on)"


def agree_on_starts(fields: Sequence[Field]) -> None:
    """The same of what fields begin with."""
    if world().size > 1 and fields:
        x, v = (np.concatenate([getattr(f, name) for f in fields]) for name in ("values", "rates"))
        agree_on_states(fields, x, v)
        for f in fields:
            f.values[:], f.rates[:] = x[f.unknowns], v[f.unknowns]


def refuse_different_arguments(of: str, **arguments: Any) -> None:
    """Refuse arguments of a function, times and schemes among them, of which another process has others."""
    if world().size > 1:
        compare({of: told("", arguments, {}, [])}, of)


def agree_on_edits(system: System) -> None:
    """The same of a state, should it not be that of a step in one of the processes."""
    if world().size > 1:
        with world().doing(f"march system {system.composition.number}"):
            if world().largest(system.report is None or is_edited(system)):
                agree_on_states(system.model.fields, system.x, system.v)


def agreed(
    what: str | Sequence[str],
    owners: Sequence[str],
    values: Sequence[Array],
    sizes: Sequence[float] = (),
    cure: str = CALLED,
) -> Sequence[Array]:
    """What functions of these owners gave in every process, as the first has it: the same but for rounding.

    Parameters
    ----------
    what : str, or list of str
        In words, of each of them if there are several.
    sizes : list of float
        What changes in each of them are small against, should the values be small themselves.
    cure : str
        What to do, should they differ.

    Raises
    ------
    InputError
        With the first owner of whom another process has another value.
    """
    if world().size == 1 or not owners:
        return values
    sizes, names = sizes or [0.0] * len(values), [what] * len(values) if isinstance(what, str) else what
    whose = dict.fromkeys(f"{owner}: {name}" for owner, name in zip(owners, names, strict=True))
    with world().doing(f"compare values ({', '.join([*whose][:3])}{', ...' if len(whose) > 3 else ''})"):
        firsts: Sequence[Array] = world().first(values)
        pairs = enumerate(zip(values, firsts, sizes, strict=True))
        differ = [k for k, pair in pairs if not is_alike(*pair)]
        if not world().largest(len(differ)):
            return firsts
        k = min(k for those in world().together(differ) for k in those)
        first, *others = world().together(values[k])
    raise InputError(
        f"processes differ: {owners[k]}: {names[k]} is {first_unlike(first, others, sizes[k])}. {cure}"
    )


def agreed_motions(system: System, time: float) -> Sequence[Array]:
    """Values of what is prescribed, as the first process has them."""
    moved = system.model.driving.prescribed
    return of_prescribed(system, f"what it prescribes at t = {time:g}", [p.values(time) for p in moved])


def agreed_rates(system: System) -> Sequence[Array]:
    """Rates of what is prescribed just after the present time, as the first process has them."""
    time, step = system.time, system.clock.step
    rates = [p.rates(time, step) for p in system.model.driving.prescribed]
    return of_prescribed(system, f"the rate of what it prescribes at t = {time:g}", rates, 1 / (step or 1))


def agreed_accelerations(system: System) -> Sequence[Array]:
    """The same of its second derivatives."""
    time, step = system.time, system.clock.step
    second = [p.acceleration(time, step) for p in system.model.driving.prescribed]
    what = f"the second rate of what it prescribes at t = {time:g}"
    return of_prescribed(system, what, second, 1 / (step or 1) ** 2)


def of_prescribed(system: System, what: str, values: Sequence[Array], rate: float = 1.0) -> Sequence[Array]:
    """What is prescribed, or its rates, as the first process has it: rounded as changes at some `rate` are."""
    if world().size == 1:
        return values
    moved = system.model.driving.prescribed
    sizes = [
        rate * max(largest_of(system.scale[p.unknowns]), largest_of(system.x[p.unknowns])) for p in moved
    ]
    return agreed(what, [p.component.label for p in moved], values, sizes)


def agreed_signals(driving: Driving, step: Any, length: float) -> Array:
    """Functions of time, see `Driving.values`, as the first process has them."""
    values = driving.values(step, length)
    if world().size == 1:  # asked for in every evaluation
        return values
    found = agreed(f"its function of time at t = {step.t1:g}", driving.owners, [*values.T])
    return np.ascontiguousarray(np.transpose(found))


def agreed_curvatures(system: System) -> Array:
    """Second derivatives of functions of time at present, see `Driving.curvatures`, as the first process has them."""
    driving, time, step = system.model.driving, system.time, system.clock.step
    values = driving.curvatures(time, step)
    if world().size == 1:
        return values
    sizes = [abs(f(time)) / (step or 1) ** 2 for f in driving.signals]
    what = f"the second rate of its function of time at t = {time:g}"
    return np.ravel(agreed(what, driving.owners, [*values.reshape(-1, 1)], sizes))


def is_alike(own: Array, other: Array, size: float = 0.0) -> bool:
    """Whether values are the same but for rounding, of what is of some size."""
    return own.shape == other.shape and not unlike(own, other, size).any()


def unlike(own: Array, other: Array, size: float) -> NDArray[np.bool_]:
    """Which values are not the same."""
    size = max(size, largest_of(other[np.isfinite(other)]))
    return ~np.isclose(own, other, rtol=0.0, atol=ALIKE * size, equal_nan=True)


def largest_of(values: Array) -> float:
    """Largest magnitude among values, 0 without any."""
    return float(np.abs(values).max(initial=0.0))


def first_unlike(first: Array, others: Sequence[Array], size: float) -> str:
    """The first value that another process has otherwise, in words."""
    k, other = next((k, other) for k, other in enumerate(others, 1) if not is_alike(other, first, size))
    if other.shape != first.shape:
        return f"of shape {first.shape} in process 0, {other.shape} in process {k}"
    at = np.argmax(unlike(other, first, size))
    return f"{first.flat[at]!s} in process 0, {other.flat[at]!s} in process {k}"


def is_edited(system: System) -> bool:
    """Whether the state was changed since the last step, be that told or not."""
    return system.stepper.is_edited or not system.core.is_unchanged


def in_step(system: System, steps: Iterator[T]) -> Iterator[T]:
    """The same steps, each of which all processes take together."""
    with closing(steps) if isinstance(steps, Generator) else nullcontext():
        if world().size == 1:
            yield from steps
            return
        while True:
            with stepping(system):
                found = list(islice(steps, 1))
            if not found:
                return
            yield found[0]


def stepping(system: System, h: Any = "", scheme: Any = "") -> AbstractContextManager[None]:
    """Inside, all processes take the same step of the same system from the same state."""
    if world().size == 1:
        return nullcontext()
    words = f"take a step of system {system.composition.number} from t = {system.time!r}"
    if h != "":
        words += f" with h = {h!r} by {scheme!r}"
    if is_edited(system):
        words += f", whose state is none of a step: {Teller({}).text(np.concatenate([system.x, system.v]))}"
    return world().doing(words)


def compare(texts: Arguments, to: str, within: Callable[[], Arguments] = dict) -> None:
    """Refuse texts of which another process has others, by the first that differs, where all are `to` do the same.

    What differs `within` is told rather, if it is known.
    """
    with world().doing(to):
        if len(set(world().together(digest_of(repr(texts))))) == 1:
            return
        inner = within()
        first, *others = world().together({k: inner.get(k, {}) | given for k, given in texts.items()})
    k, other = next((k, other) for k, other in enumerate(others, 1) if repr(other) != repr(first))
    raise InputError(f"processes differ: {difference(first, other, k)}. {SAME}")


def difference(first: Arguments, other: Arguments, k: int) -> str:
    """The first difference between the texts of the first process and of process `k`."""
    for owner, name, one, another in differing(first, other):
        return f"{owner}: {name} is {one} in process 0, {another} in process {k}"
    return "the order of what they have"


def differing(first: Arguments, other: Arguments) -> Iterator[tuple[str, str, str, str]]:
    """Owner, name and both values of arguments that are not the same; "nothing" where there is none."""
    for owner in dict.fromkeys([*first, *other]):
        a, b = first.get(owner, {}), other.get(owner, {})
        for name in dict.fromkeys([*a, *b]):
            one, another = a.get(name, "nothing"), b.get(name, "nothing")
            if one != another:
                yield owner, name, one, another
