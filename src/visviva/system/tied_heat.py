"""Temperatures that are tied but jump at the start: heat passes across the tie at once.

Whatever conducts, the flow into a jump of no width is infinite, so the temperatures there are the same after no time.
Steps that meet a jump make other things of it. Bonds between balances of entropy pass that, so that the jump evens out
as in an engine that works and ends too cold, and discrete gradients, that ask for one temperature of the step, leave a
jump which turns over in every step.

So heat passes in steps of no length, in which all else rests, of the energy-momentum scheme, which keep energy: with
half of the jump in their middle. Secants of the energy are not quite the means of the temperatures, so that a little is
left, for the next one.
"""

from __future__ import annotations

from contextlib import ExitStack, suppress
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError, NotFinite
from visviva.model.field import Role
from visviva.scheme.schemes import EnergyMomentum
from visviva.system.algebraic import settle, solve_groups
from visviva.system.memory import undisturbed
from visviva.thermal.carrier import EntropySupply
from visviva.thermal.exchange import HeatBond

if TYPE_CHECKING:
    from visviva.model.field import Field
    from visviva.system.system import System

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
LENGTH = 1e-30
"""Of a step in which nothing else changes a content, by more than rounding."""
JUMPS, FITS = 1e-6, 1e-12
"""Smaller parts of the temperatures are no jumps, as what interpolations differ by; those that are close up to this."""
ROUNDS, LEAST = 30, 1e-3
"""Steps at most, and the least part of a jump that one closes: tables of capacity have humps."""


def begin_consistently(system: System) -> None:
    """Give what has no rates the values of the state given, and temperatures that are tied the same ones."""
    settle(system)
    even_out(system)
    system.stepper.is_edited = False


def even_out(system: System) -> None:
    """Let heat pass across ties until temperatures fit; the stepper has what to tell."""
    ties = [t for t, _ in system.model.terms if isinstance(t, HeatBond)]
    if all(_fits(tie, system.x, JUMPS) for tie in ties):
        return
    start, bodies = system.x.copy(), _tied(system, ties)
    with undisturbed(system):
        closed, found = _closed(system, ties, bodies), system.x.copy()
    if not closed:
        names = " and ".join(dict.fromkeys(f.component.label for f in bodies))
        raise InputError(
            f"the temperatures of {names} differ where a vv.HeatTie joins them, and cannot be evened out before the "
            "first step: give temperatures at the start that differ less there, or the vv.HeatTie a conductance"
        )
    system.x[:] = found
    system.invalidate()
    system.stepper.is_edited = False
    for f in (f for f in bodies if f.name == "temperature"):
        change = np.abs(found - start)[f.unknowns].max()
        if change > JUMPS * np.abs(start[f.unknowns]).max():
            system.stepper.moves.append(
                f"{f.name} of {f.component.label} by {change:.3g}, as a vv.HeatTie asks"
            )


def _fits(tie: HeatBond, x: Array, part: float = FITS) -> bool:
    jump, size = tie.jump(x)
    return bool(np.all(np.abs(jump) <= part * size))


def _tied(system: System, ties: list[HeatBond]) -> list[Field]:
    """All fields of the bodies that are tied."""
    own = np.concatenate([tie.unknowns[:, 1:].ravel() for tie in ties])
    owners = {
        id(f.component)
        for f in system.model.fields
        if f.role is Role.CONTENT and np.isin(own, f.unknowns).any()
    }
    return [f for f in system.model.fields if id(f.component) in owners]


def _closed(system: System, ties: list[HeatBond], bodies: list[Field]) -> bool:
    """Whether jumps are closed by heat."""
    held = [t.unknowns[:, 0] for t, _ in system.model.terms if isinstance(t, EntropySupply)]
    stored = np.setdiff1d(_unknowns(bodies, Role.CONTENT, Role.STATE), np.concatenate([[], *held]))
    changing = np.concatenate(
        [stored, _unknowns(bodies, Role.TEMPERATURE), *(t.unknowns[:, 0] for t in ties)]
    )
    part = 1.0
    for _ in range(ROUNDS):
        if all(_fits(tie, system.x) for tie in ties):
            return True
        found = _closes(system, ties, changing, part)
        if found:
            system.x[stored] += system.core.dx[stored]
            system.core.dx[:] = 0.0
            settle(system)
        part = min(2 * part, 1.0) if found else 0.5 * part
        if part < LEAST:
            return False
    return False


def _unknowns(fields: list[Field], *roles: Role) -> Ints:
    return np.concatenate([[], *(f.unknowns for f in fields if f.role in roles)]).astype(np.int64)


def _closes(system: System, ties: list[HeatBond], changing: Ints, part: float) -> bool:
    """Whether a step is found that closes this part of the jumps; it is then the core's ``dx``."""
    system.core.dx[:] = 0.0
    with ExitStack() as stack, suppress(NotFinite):
        for tie in ties:
            stack.enter_context(tie.closing(part, system.x))
        return not solve_groups(system, [changing], EnergyMomentum().step(system.time, LENGTH))
    return False
