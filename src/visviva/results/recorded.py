"""Histories that are kept at every step while a run goes on."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError, nearest
from visviva.measure.measures import Reading
from visviva.model.form import Form, Strain, Vector
from visviva.system.agreement import agreed

if TYPE_CHECKING:
    from visviva.system.system import System

Record = Iterable[Any] | Mapping[str, Any]
READ = Form | Vector | Strain | Reading
WANTED = "a form, vector, strain, measure or probe such as vv.Position(of=body), or a function of the system"


def value_of(system: System, probe: Any) -> Any:
    """Present value of a probe."""
    return system.value(probe) if isinstance(probe, Form | Vector | Strain) else probe(system)


def refuse_no_probe(whose: str, what: str, probe: Any) -> None:
    """Refuse what cannot be read off a system."""
    if not isinstance(probe, READ) and (not callable(probe) or isinstance(probe, type)):
        raise InputError(f"{whose}: {what} is {WANTED}, not {probe!r}")


@dataclass
class Recorded:
    """Probes by name, their values at every step, and the times of these.

    Examples
    --------
    >>> import visviva as vv
    >>> ball = vv.PointMass(mass=1.0)
    >>> system, place = vv.System([ball]), vv.Position(of=ball)
    >>> recorded = Recorded.of("simulate", [place])
    >>> recorded.take(system)
    >>> recorded.find(place), recorded.values("probe_1").shape
    ('probe_1', (1, 3))
    """

    probes: dict[str, Any] = field(default_factory=dict)
    times: list[float] = field(default_factory=list)
    rows: list[list[NDArray[np.float64]]] = field(default_factory=list)

    @classmethod
    def of(cls, whose: str, record: Record) -> Recorded:
        """From probes, or probes by name."""
        if isinstance(record, READ) or not isinstance(record, Iterable) or isinstance(record, str):
            raise InputError(f"{whose}: record is a list of probes, or probes by name, not {record!r}")
        named = record if isinstance(record, Mapping) else {f"probe_{k + 1}": p for k, p in enumerate(record)}
        for name, probe in named.items():
            refuse_no_probe(whose, f"record {name!r}", probe)
        return cls(dict(named))

    def take(self, system: System) -> None:
        """Take the present values."""
        if self.probes:
            self.times.append(system.time)
            values = [np.array(value_of(system, p), dtype=float) for p in self.probes.values()]
            names = [f"record {name!r}" for name in self.probes]
            self.rows.append(list(agreed(f"its value at t = {system.time:g}", names, values)))

    def find(self, what: Any) -> str | None:
        """The name under which a probe is recorded, if it is.

        Raises
        ------
        InputError
            If a name is given under which nothing is recorded.
        """
        if isinstance(what, str):
            if what not in self.probes:
                told = nearest(what, self.probes) or "; simulate(record={name: probe}) records"
                raise InputError(f"Result.history: nothing is recorded as {what!r}{told}")
            return what
        return next((name for name, probe in self.probes.items() if probe is what), None)

    def values(self, name: str) -> NDArray[np.float64]:
        """Values of a probe at all times, (n,) or (n, k)."""
        k = list(self.probes).index(name)
        return np.array([row[k] for row in self.rows])
