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
from visviva.base.told import Teller, arguments_of, digest_of, shortened
from visviva.base.world import world
from visviva.component.component import Component

if TYPE_CHECKING:
    from visviva.model.driving import Driving
    from visviva.model.field import Field, Prescription
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
        With the first that differs.
    """
    if world().size == 1:
        return
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


def refuse_different_states(fields: Sequence[Field], x: Array, v: Array) -> None:
    """Refuse unknowns (n,) and rates (n,) of which another process has others; random ones have no seed."""
    if world().size == 1:
        return
    texts: Arguments = {}
    for f in fields:
        part, of = slice(f.start, f.start + f.size), f"{f.name} (unknowns from {f.start} on)"
        values = {f"state of {of}": x[part], f"rates of {of}": v[part], f"what is held of {of}": f.fixed}
        texts.setdefault(f.component.label, {}).update(told("", values, {}, []))
    compare(texts, "begin with a state")


def refuse_different_starts(fields: Sequence[Field]) -> None:
    """Refuse states that others begin with otherwise."""
    if world().size > 1:
        x, v = (np.concatenate([getattr(f, name) for f in fields]) for name in ("values", "rates"))
        refuse_different_states(fields, x, v)


def refuse_different_arguments(of: str, **arguments: Any) -> None:
    """Refuse arguments of a function, times and schemes among them, of which another process has others."""
    if world().size > 1:
        compare({of: told("", arguments, {}, [])}, of)


def refuse_different_edits(system: System) -> None:
    """Refuse a state, should it not be that of a step in one of the processes, of which another has others."""
    if world().size > 1:
        with world().doing(f"march system {system.composition.number}"):
            if world().largest(system.report is None or is_edited(system)):
                refuse_different_states(system.model.fields, system.x, system.v)


def agreed(what: str, owners: Sequence[str], values: Sequence[Array]) -> Sequence[Array]:
    """What functions of these owners gave in every process, as the first has it: the same but for rounding.

    Raises
    ------
    InputError
        With the first owner of whom another process has another value.
    """
    if world().size == 1 or not owners:
        return values
    with world().doing(f"compare {what}"):
        firsts: Sequence[Array] = world().first(values)
        differ = [k for k, pair in enumerate(zip(values, firsts, strict=True)) if not is_alike(*pair)]
        if not world().largest(len(differ)):
            return firsts
        k = min(k for those in world().together(differ) for k in those)
        first, *others = world().together(values[k])
    raise InputError(f"processes differ: {owners[k]}: {what} is {first_unlike(first, others)}. {CALLED}")


def agreed_motions(prescribed: Sequence[Prescription], time: float) -> Sequence[Array]:
    """Values of what is prescribed, as the first process has them."""
    owners, values = [p.component.label for p in prescribed], [p.values(time) for p in prescribed]
    return agreed(f"what it prescribes at t = {time:g}", owners, values)


def agreed_signals(driving: Driving, step: Any, length: float) -> Array:
    """Functions of time, see `Driving.values`, as the first process has them."""
    values = driving.values(step, length)
    if world().size == 1:  # asked for in every evaluation
        return values
    found = agreed(f"its function of time at t = {step.t1:g}", driving.owners, [*values.T])
    return np.ascontiguousarray(np.transpose(found))


def is_alike(own: Array, other: Array) -> bool:
    """Whether values are the same but for rounding."""
    return own.shape == other.shape and not unlike(own, other).any()


def unlike(own: Array, other: Array) -> NDArray[np.bool_]:
    """Which values are not the same."""
    size = np.abs(other[np.isfinite(other)]).max(initial=0.0)
    return ~np.isclose(own, other, rtol=0.0, atol=ALIKE * size, equal_nan=True)


def first_unlike(first: Array, others: Sequence[Array]) -> str:
    """The first value that another process has otherwise, in words."""
    k, other = next((k, other) for k, other in enumerate(others, 1) if not is_alike(other, first))
    if other.shape != first.shape:
        return f"of shape {first.shape} in process 0, {other.shape} in process {k}"
    at = np.argmax(unlike(other, first))
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
    raise InputError(
        f"processes differ: {difference(first, other, k)}. Each runs the whole script, and has to make the same of it: "
        "give random numbers a seed, take components from lists rather than sets, let nothing depend on the process, "
        "and start one version of visviva and of the script"
    )


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
