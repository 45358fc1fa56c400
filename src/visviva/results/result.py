"""What a run leaves: states, ledger, statistics, and the audit of what was conserved."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.arguments import refuse_other
from visviva.base.errors import InputError, nearest
from visviva.measure.measures import Measure
from visviva.model.form import Form, Strain, Vector
from visviva.results.audit import audit
from visviva.results.ledger import MOMENTA, Ledger

if TYPE_CHECKING:
    from visviva.output.states import StateFile
    from visviva.scheme.schemes import Scheme
    from visviva.system.system import System

Array = NDArray[np.float64]


@dataclass
class Statistics:
    """Counts and times of a run."""

    steps: int = 0
    iterations: int = 0
    factorizations: int = 0
    rejected: int = 0
    seconds: float = 0.0


@dataclass
class Kept:
    """States that are kept in memory."""

    times: list[float] = field(default_factory=list)
    states: list[Array] = field(default_factory=list)
    rates: list[Array] = field(default_factory=list)
    records: list[list[Array]] = field(default_factory=list)

    def append(self, time: float, x: Array, v: Array, records: list[Array]) -> None:
        """Keep a state."""
        self.times.append(time)
        self.states.append(x.copy())
        self.rates.append(v.copy())
        self.records.append(records)


@dataclass
class Result:
    """A run's states, ledger and statistics.

    Attributes
    ----------
    times : array (n,)
        Times of the kept states, to be read.
    states, rates : sequences of arrays
        Unknowns and rates at these times; those of a run in a directory are read from its file.
    records : sequence of lists of arrays
        What contacts showed at these times.
    ledger : Ledger
        One row per accepted step.
    """

    system: System
    scheme: Scheme
    ledger: Ledger
    kept: Kept | StateFile = field(default_factory=Kept)
    statistics: Statistics = field(default_factory=Statistics)
    _times: Array = field(
        default_factory=lambda: np.zeros(0), init=False, repr=False
    )  # as far as they are read

    @property
    def times(self) -> Array:
        known, kept = len(self._times), self.kept.times
        if known != len(kept):
            self._times = np.append(self._times, kept[known:])
            self._times.setflags(write=False)
        return self._times

    @property
    def states(self) -> Sequence[Array]:
        return self.kept.states

    @property
    def rates(self) -> Sequence[Array]:
        return self.kept.rates

    @property
    def records(self) -> Sequence[list[Array]]:
        return self.kept.records

    def history(self, what: Form | Vector | Strain | Measure) -> Array:
        """Values of a form, vector, strain or measure at the kept times, (n,) or (n, k)."""
        wanted = "a form, vector, strain or measure such as vv.Position(of=body)"
        refuse_other("Result.history", "what", what, Form | Vector | Strain | Measure, wanted)
        if not isinstance(what, Measure):
            return np.array([what.value(x) for x in self.states])
        values = np.array([[e.value(x) for e in what.strains()] for x in self.states])
        return values[:, 0] if values.shape[1] == 1 else values

    def write(
        self, path: str | Path, fields: Sequence[str] = ("von_mises", "pressure", "cauchy", "energy")
    ) -> None:
        """Write the kept states as a trajectory (``*.vtkhdf``), for ParaView, pictures and movies.

        Where the times do not grow, as on a path through limit points, the numbers of the states stand for them.

        Parameters
        ----------
        path
            File to write.
        fields
            Fields of solids to store beside displacements, velocities and what contacts show; see `Solid.nodal`.

        Examples
        --------
        >>> import tempfile, visviva as vv
        >>> from visviva.output import Trajectory
        >>> steel = vv.LinearElastic(young=2.0, poisson=0.0)
        >>> bar = vv.Solid(mesh=vv.BoxMesh(size=(4, 1, 1), counts=(2, 1, 1)), material=steel, density=1.0)
        >>> result = vv.simulate(vv.System([bar]), until=0.2, step=0.1)
        >>> path = tempfile.mkdtemp() + "/bar.vtkhdf"
        >>> result.write(path)
        >>> Trajectory(path).fields["cauchy"]
        6
        """
        from visviva.output.vtkhdf import TrajectoryWriter
        from visviva.results.drawing import Drawing

        drawing = Drawing(self.system, fields=fields)
        grow = bool((np.diff(self.times) > 0).all())
        times = (self.times if grow else np.arange(len(self.times), dtype=float)).tolist()
        with TrajectoryWriter(path, drawing.surfaces, len(times)) as writer:
            for time, x, v, records in zip(times, self.states, self.rates, self.records, strict=False):
                writer.append(time, drawing.points(x), drawing.values(x, v, records))

    def conservation(self) -> dict[str, float]:
        """Relative errors: energy balance, each momentum, constraints at position and velocity level.

        Relative to `Ledger.energy_scale`, `Ledger.momentum_scale`, the reach of the constraints, and that times
        `Ledger.rate_scale`.
        """
        ledger = self.ledger
        figures = {"energy": ledger.imbalance()}
        figures |= {name: ledger.drift(name) for name in MOMENTA}
        figures["constraints"] = ledger.greatest("defect_position")
        figures["constraint rates"] = ledger.greatest("defect_velocity") / ledger.rate_scale
        return figures

    def audit(self) -> str:
        """What was conserved, in ten lines; also printed."""
        text = audit(self)
        print(text)
        return text

    def assert_conserved(self, *names: str, tolerance: float = 1e-9) -> None:
        """Raise `AssertionError` unless these figures of `conservation` are below `tolerance`."""
        figures = self.conservation()
        for name in names or ("energy", "constraints"):
            if name not in figures:
                raise InputError(f"assert_conserved: nothing is called {name!r}{nearest(name, figures)}")
            if not figures[name] <= tolerance:
                raise AssertionError(f"{name} is not conserved: error {figures[name]:.3e} > {tolerance:.1e}")


def figures(result: Result) -> dict[str, Any]:
    """Numbers of a run for its summary."""
    s = result.statistics
    return {
        "coordinates": result.system.n_coordinates,
        "constraints": result.system.n_constraints,
        "linear solver": result.system.linear_explanation,
        "steps": s.steps,
        "iterations": s.iterations,
        "factorizations": s.factorizations,
        "rejected": s.rejected,
        "seconds": s.seconds,
        "conservation": result.conservation(),
    }
