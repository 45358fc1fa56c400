"""What the verification tests share: runs sampled at given times, errors, orders, extrapolation."""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import visviva as vv
from visviva.scheme.clock import Clock
from visviva.study.study import measure
from visviva.system.memory import returning

Array = NDArray[np.float64]
Look = Callable[[vv.System], ArrayLike]


def sampled(
    system: vv.System, look: Look, times: ArrayLike, step: float, scheme: vv.Scheme | None = None
) -> tuple[Array, vv.Result]:
    """What `look` sees at `times` (multiples of `step`, ascending, first 0), and the result of the run."""
    wanted = list(np.asarray(times, dtype=float))
    seen = []

    def observe(s: vv.System) -> None:
        if len(seen) < len(wanted) and abs(s.time - wanted[len(seen)]) < 1e-6 * step:
            seen.append(look(s))

    observe(system)
    result = vv.simulate(system, until=wanted[-1], step=step, scheme=scheme, every=10**9, observe=observe)
    assert len(seen) == len(wanted)
    return np.array(seen, dtype=float), result


def errors(values: Sequence[Array], exact: ArrayLike) -> Array:
    """Largest absolute error of each solution."""
    return np.array([np.abs(v - np.asarray(exact)).max() for v in values])


def orders(errors: ArrayLike) -> Array:
    """Orders of convergence between solutions with halved steps."""
    e = np.asarray(errors, dtype=float)
    return np.asarray(np.log2(e[:-1] / e[1:]))


def extrapolated(values: Sequence[Array]) -> Array:
    """Richardson's extrapolation in even powers of the step, from steps halved each time, finest last."""
    row, factor = list(values), 4.0
    while len(row) > 1:
        row = [b + (b - a) / (factor - 1.0) for a, b in pairwise(row)]
        factor *= 4.0
    return row[0]


def conserved(result: vv.Result, *names: str, tolerance: float = 1e-9) -> None:
    """Energy, constraints and the momenta named hold to `tolerance` of their scale."""
    result.assert_conserved("energy", "constraints", *names, tolerance=tolerance)


def fresh(
    components: Sequence[vv.component.component.Component], newton: vv.Newton | None = None
) -> vv.System:
    """A system of copies of the components."""
    return vv.System(copy.deepcopy(list(components)), newton)


def resolved(study: vv.Study, newton: vv.Newton) -> tuple[vv.System, dict[str, Any]]:
    """The same system with other options of the solver, and the probes of it."""
    components, probes = copy.deepcopy((list(study.system.components), dict(study.probes)))
    return vv.System(components, newton), probes


def follow(study: vv.Study, names: Sequence[str], times: ArrayLike) -> tuple[Array, vv.Result]:
    """Probes of a study side by side at `times`, and the result of the run."""

    def look(s: vv.System) -> Array:
        return np.hstack([np.ravel(measure(s, study.probes[n])) for n in names])

    return sampled(study.system, look, times, study.step, study.scheme)


def reaction_at(result: vv.Result, joint: vv.joint.joint.Joint, k: int) -> tuple[Array, Array]:
    """Force and torque of a joint on its partner b at the k-th of all kept states, second order in the step."""
    system = result.system
    with returning(system):
        system.x[:], system.v[:] = result.states[k], result.rates[k]
        system.stepper.clock = Clock(result.times[k], system.clock.step)
        return vv.reaction(system, joint)
