"""Probes read off the kept states of a run that is over."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.measure.measures import Reading, remembers, touches
from visviva.measure.names import columns_of, units_of
from visviva.results.recorded import value_of
from visviva.system.memory import undisturbed

if TYPE_CHECKING:
    from visviva.base.unit_labels import Units
    from visviva.results.result import Result

Array = NDArray[np.float64]


def looked_back(result: Result, probe: Any) -> Array:
    """Values (n,) or (n, k) of a probe at the kept states, which the system takes one after the other.

    Raises
    ------
    InputError
        If states do not tell it.
    """
    refuse_untold(result, probe)
    system, found = result.system, []
    with undisturbed(system):
        for time, x, v in zip(result.times.tolist(), result.states, result.rates, strict=True):
            system.x[:], system.v[:] = x, v
            system.time = time
            system.invalidate()
            system.stepper.last = system.stepper.told_forces = None
            system.stepper.solves_means = result.scheme.solves_means
            found.append(np.array(value_of(system, probe), dtype=float))
    return np.array(found)


def refuse_untold(result: Result, probe: Any) -> None:
    """Refuse probes that need more than unknowns, rates and time."""
    system = result.system
    reads = isinstance(probe, Reading)
    if not (probe.told_by_state(system) if reads else not (remembers(system) or touches(system))):
        name = (
            type(probe).__name__ if isinstance(probe, Reading) else getattr(probe, "__name__", "a function")
        )
        raise InputError(
            f"Result.history: {name} belongs to a step, and kept states do not tell it; keep it while the run goes on: "
            "simulate(..., record=[probe]), or as a probe of a study"
        )


def tabulated(result: Result, probes: Mapping[str, Any]) -> dict[str, Array]:
    """Columns of probes with their times, which they must share."""
    times: Array | None = None
    columns: dict[str, Array] = {}
    for name, probe in probes.items():
        values = result.history(probe)
        own = result.recorded_times if result.recorded.find(probe) is not None else result.times
        if times is not None and len(own) != len(times):
            raise InputError(
                "Result: what was recorded at every step and what is read off fewer kept states has no common times; "
                "ask for them one after the other"
            )
        times = own
        for column, part in zip(
            columns_of(name, probe, values[0]), values.reshape(len(values), -1).T, strict=True
        ):
            columns[column] = part
    return {"time": result.times if times is None else times, **columns}


def units_of_columns(result: Result, probes: Mapping[str, Any], units: Units) -> dict[str, str]:
    """Units of these columns, as far as they are known."""
    found = dict[str, str]()
    for name, probe in probes.items():
        first = result.history(probe)[0]
        found |= dict(zip(columns_of(name, probe, first), units_of(name, probe, first, units), strict=True))
    return {"time": units["time"] if result.scheme.has_inertia else "", **found}
