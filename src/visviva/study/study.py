"""A study: a system with what to do with it; what examples and scene files give and the command line runs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.analysis.adaptive import Adaptive
from visviva.base.arguments import Named, finite, positive, refuse_other
from visviva.base.errors import InputError, nearest
from visviva.component.component import refuse_absent
from visviva.measure.names import USUAL, columns_of, units_of, usual_fields
from visviva.model.form import Form, Strain, Vector, refuse_foreign
from visviva.output.pictures import ALWAYS, Pictures
from visviva.scheme.schemes import EnergyMomentum, Scheme
from visviva.system.agreement import agreed
from visviva.system.system import System

Array = NDArray[np.float64]
Probe = Form | Vector | Strain | Callable[[System], Any]
"""Type of probes: a form, vector or strain, or a function of the system."""


TYPES: tuple[tuple[str, Any, str], ...] = (
    ("system", System, "a vv.System"),
    ("scheme", Scheme, "a scheme such as vv.EnergyMomentum()"),
    ("probes", Mapping, "a mapping from names to probes"),
    ("trails", Iterable, "a list of names of probes"),
    ("fields", Iterable, "a list of names of fields"),
    ("moments", Iterable, "a list of times"),
    ("pictures", Pictures, "vv.Pictures(...)"),
    ("adaptive", Adaptive | None, "vv.Adaptive(...)"),
)
"""Arguments of a study."""


@dataclass
class Study(metaclass=Named):
    """A system, how long and by which steps to run it, and what to record.

    Parameters
    ----------
    system : System
    until, step : float
        End time and step length (time), positive.
    scheme : Scheme
    probes : dict
        Time series by name; a vector is recorded as name_x, name_y, name_z.
    trails : tuple of str
        Probes of positions whose path is drawn.
    fields : sequence of str
        Fields of solids that the trajectory holds beside displacements, velocities and what contacts show
        (``contact_pressure``, ``contact_gap``, ``contact_state``, ``contact_traction``); pictures show the first. By
        default stresses, and temperatures, concentrations and damages of what has them.
    moments : sequence of float
        Times of which `run` draws pictures, beside the end.
    movie : bool
        `run` makes a movie, too.
    pictures : Pictures
        What pictures and the movie show, and from where.
    title : str
    notes : str
        Choices the source leaves open.
    adaptive : Adaptive, optional
        Chooses step sizes; `step` is then the first.
    units : str or mapping, optional
        Names of the units in which the model is written, see `System`; names of probes may be keys, too.
    """

    system: System
    until: float
    step: float
    scheme: Scheme = field(default_factory=EnergyMomentum)
    probes: Mapping[str, Probe] = field(default_factory=dict)
    trails: tuple[str, ...] = ()
    fields: Sequence[str] = USUAL
    moments: Sequence[float] = ()
    movie: bool = False
    pictures: Pictures = field(default_factory=Pictures)
    title: str = ""
    notes: str = ""
    adaptive: Adaptive | None = None
    units: str | Mapping[str, str] | None = None

    def __post_init__(self) -> None:
        for what, kind, wanted in TYPES:
            refuse_other("Study", what, getattr(self, what), kind, wanted)
        self.step = positive("Study", "step", self.step)
        self.until = finite("Study", "until", self.until)
        if self.units is not None:
            self.system.units = self.units
        self.system.units.refuse_unknown(self.probes)
        refuse_absent("Study: probes", self.probes, {id(c) for c in self.system.components})
        for name, probe in self.probes.items():
            if isinstance(probe, Form | Vector | Strain):
                refuse_foreign(f"Study: probe {name!r}", probe, self.system.composition)
        unknown = [name for name in self.trails if name not in self.probes]
        if unknown:
            raise InputError(
                f"Study: trails name {unknown[0]!r}, which is no probe{nearest(unknown[0], self.probes)}"
            )

    @property
    def stored(self) -> tuple[str, ...]:
        """Fields that the trajectory holds because they are asked for, by name or by what pictures show."""
        shown = (name for name in self.pictures.named.values() if name not in ALWAYS)
        usual = usual_fields(self.system) if tuple(self.fields) == USUAL else ()
        return tuple(dict.fromkeys([*self.fields, *usual, *shown]))


def measure(system: System, probe: Probe) -> Any:
    """Present value of a probe."""
    return probe(system) if callable(probe) else system.value(probe)


def measured(study: Study) -> Sequence[Array]:
    """Present values of all probes, the same in all processes, each of which asks for them."""
    system, names = study.system, [f"probe {name!r}" for name in study.probes]
    values = [np.ravel(np.asarray(measure(system, p), dtype=float)) for p in study.probes.values()]
    return agreed(f"its value at t = {system.time:g}", names, values)


def probe_columns(study: Study) -> dict[str, str]:
    """Columns of the table of probes with their units: vectors as name_x, name_y, name_z."""
    units = study.system.units
    found = {"time": units["time"] if study.scheme.has_inertia else ""}
    for name, probe in study.probes.items():
        value = measure(study.system, probe)
        names, of = columns_of(name, probe, value), units_of(name, probe, value, units)
        found |= dict(zip(names, of, strict=True))
    return found
