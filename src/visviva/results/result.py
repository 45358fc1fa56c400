"""Result of a run: states, ledger, statistics, and the audit of what was conserved."""

from __future__ import annotations

import shutil
import tempfile
import weakref
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError, nearest
from visviva.base.html import table
from visviva.base.world import world
from visviva.measure.measures import Measure, refuse_elsewhere
from visviva.model.form import Form, Strain, Vector, refuse_foreign
from visviva.output.numbers_out import dataframe, write_table
from visviva.output.states import StateFile
from visviva.results.audit import audit
from visviva.results.ledger import MOMENTA, Ledger
from visviva.results.looking_back import looked_back, tabulated, units_of_columns
from visviva.results.naming import with_clock
from visviva.results.recorded import Recorded, refuse_no_probe
from visviva.results.showing import (
    Picture,
    html_of,
    movie_of,
    picture_of,
    plot_of,
    view_of,
    write_directory,
    write_trajectory,
)
from visviva.system.memory import holds, refuse_recomposed

if TYPE_CHECKING:
    from visviva.output.directory import RunDirectory
    from visviva.output.page import Page
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
    swings: int = 0
    """Most steps in a row that took back enough of the change of the one before to ring, see `Swings`."""


@dataclass
class Kept:
    """States that are kept in memory."""

    times: list[float] = field(default_factory=list)
    states: list[Array] = field(default_factory=list)
    rates: list[Array] = field(default_factory=list)
    records: list[list[Array]] = field(default_factory=list)

    n_bytes: int = 0

    def append(self, time: float, x: Array, v: Array, records: list[Array]) -> None:
        """Keep a state."""
        self.n_bytes += x.nbytes + v.nbytes + sum(r.nbytes for r in records)
        self.times.append(time)
        for values, kept in ((x, self.states), (v, self.rates)):
            kept.append(values.copy() if values.any() else np.zeros(values.shape))
            kept[-1].setflags(write=False)
        self.records.append(records)


def spilled(kept: Kept) -> StateFile:
    """States in a temporary file, which goes with them."""
    folder = tempfile.mkdtemp(prefix="visviva-")
    file = StateFile(Path(folder) / "states.npy", len(kept.states[0]), [r.shape for r in kept.records[0]])
    weakref.finalize(file, shutil.rmtree, folder, ignore_errors=True)
    for time, x, v, records in zip(kept.times, kept.states, kept.rates, kept.records, strict=True):
        file.append(time, x, v, records)
    return file


@dataclass(repr=False)
class Result:
    """A run's states, ledger and statistics.

    Attributes
    ----------
    system : System
        What has moved. Refused after `System.reset`, by which it forgets this run; what was kept of it stays readable.
    scheme : Scheme
        What it was marched with.
    times : array (n,)
        Times of the kept states, to be read.
    states, rates : sequences of arrays
        Unknowns and rates at these times; those of a run in a directory are read from its file.
    records : sequence of lists of arrays
        What contacts showed at these times.
    ledger : Ledger
        One row per accepted step.
    statistics : Statistics
        Numbers of steps, iterations, factorisations and rejected steps, and seconds.
    kept : Kept or StateFile
        What `times`, `states`, `rates` and `records` are read from.
    recorded : Recorded
        Histories that were kept at every step.
    directory : RunDirectory, optional
        Where the run was written to.
    """

    _system: System
    scheme: Scheme
    ledger: Ledger
    kept: Kept | StateFile = field(default_factory=Kept)
    statistics: Statistics = field(default_factory=Statistics)
    recorded: Recorded = field(default_factory=Recorded)
    directory: RunDirectory | None = None
    _times: Array = field(
        default_factory=lambda: np.zeros(0), init=False, repr=False
    )  # as far as they are read

    def __post_init__(self) -> None:
        self._composition, self.stability = self._system.composition, self._system.stepper.stability

    @property
    def system(self) -> System:
        self._refuse_other_run()
        return self._system

    def _refuse_other_run(self) -> None:
        refuse_recomposed("Result", self._system, self._composition)

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

    def history(self, what: Any) -> Array:
        """Values of a form, vector, strain, measure or probe over time, (n,) or (n, k).

        What was recorded is there at every step (`recorded_times`), by its name too; everything else is read off the
        kept states, at `times`.

        Raises
        ------
        InputError
            If it is no probe, or one that kept states do not tell, such as the force of a contact: with what does.
        """
        name = self.recorded.find(what)
        if name is not None:
            return self.recorded.values(name)
        refuse_no_probe("Result.history", "what", what)
        self._refuse_other_run()
        if isinstance(what, Form | Vector | Strain):
            refuse_foreign("Result.history", what, self.system.composition)
            return np.array([what.value(x) for x in self.states])
        if not isinstance(what, Measure):
            return looked_back(self, what)
        refuse_elsewhere(what, self.system)
        values = np.array([[e.value(x) for e in what.strains()] for x in self.states])
        return values[:, 0] if values.shape[1] == 1 else values

    @property
    def recorded_times(self) -> Array:
        """Times (n,) of what was recorded."""
        return np.array(self.recorded.times)

    # --- numbers out ----------------------------------------------------------------------------------------
    def to_dataframe(self, *probes: Any, **named: Any) -> Any:
        """Histories as a table of pandas with the times as index: of everything recorded, or of these probes.

        Examples
        --------
        >>> import visviva as vv
        >>> ball = vv.PointMass(mass=1.0, velocity=(1, 0, 0))
        >>> result = vv.simulate(vv.System([ball]), until=0.2, step=0.1)
        >>> result.to_dataframe(place=vv.Position(of=ball)).columns.tolist()
        ['place_x', 'place_y', 'place_z']
        """
        return dataframe(with_clock(self.columns(*probes, **named), self.scheme))

    def to_csv(self, path: str | Path, *probes: Any, **named: Any) -> Path:
        """Histories as a table with names per component, and units where they are known; see `to_dataframe`."""
        columns = self.columns(*probes, **named)
        units = self.column_units(*probes, **named)
        together = {name: (values, units.get(name, "")) for name, values in columns.items()}
        return write_table(path, with_clock(together, self.scheme))

    def columns(self, *probes: Any, **named: Any) -> dict[str, Array]:
        """Columns (n,) by name, ``time`` first: of everything recorded, or of these probes."""
        return tabulated(self, self._wanted(*probes, **named))

    def column_units(self, *probes: Any, **named: Any) -> dict[str, str]:
        """Units of `columns`, as far as they are known."""
        return units_of_columns(self, self._wanted(*probes, **named), self._system.units)

    def _wanted(self, *probes: Any, **named: Any) -> dict[str, Any]:
        wanted = {f"probe_{k + 1}": p for k, p in enumerate(probes)} | named
        return wanted or self.recorded.probes

    # --- to be looked at ------------------------------------------------------------------------------------
    def plot(self, file: str | Path | None = None, *probes: Any, **named: Any) -> Picture:
        """Energies and the error of their balance, and below them what was recorded, or these probes.

        Parameters
        ----------
        file : path, optional
            ``*.png``, ``*.pdf`` or ``*.svg``. A notebook shows what is returned.
        """
        return plot_of(self, file, self._wanted(*probes, **named))

    def picture(self, file: str | Path | None = None, **options: Any) -> Picture:
        """A moment of the motion, the end unless ``time=`` is given.

        Options are those of `visviva.output.picture.snapshot`.

        Parameters
        ----------
        file : path, optional
            ``*.png``. A notebook shows what is returned.
        """
        return picture_of(self, file, **options)

    def movie(self, file: str | Path, **options: Any) -> Path:
        """A movie of the motion, ``*.mp4`` or ``*.gif``; options are those of `visviva.output.movie.movie`."""
        return movie_of(self, file, **options)

    def view(self, *, window: bool = False, **options: Any) -> Page | None:
        """Show the motion as a page that plays: below the cell of a notebook, or in the browser.

        Parameters
        ----------
        window : bool
            A window of PyVista in its place.
        **options
            ``largest=`` bytes of the page; of a window those of `visviva.output.viewer.show`.

        Returns
        -------
        Page
            With ``save(file)`` and ``open()``.
        """
        return view_of(self, window=window, **options)

    def write(self, path: str | Path, fields: Sequence[str] | None = None) -> None:
        """Write what is kept: a trajectory (``*.vtkhdf``) for ParaView, or a directory with tables and plot besides.

        Where the times do not grow, as on a path through limit points, the numbers of the states stand for them.

        Parameters
        ----------
        path
            File to write, or a directory, in which `visviva plot`, `picture`, `movie` and `vv.read` find it.
        fields
            Fields to store beside displacements, velocities and what contacts show; see `Solid.nodal`. Unless they are
            given, stresses and energies of solids, and temperatures, concentrations, orders and damages.

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
        with world().doing(f"write {path}"):
            write = write_trajectory if Path(path).suffix == ".vtkhdf" else write_directory
            write(self, path, fields)

    def __repr__(self) -> str:
        end = f"{self.statistics.steps} steps to t = {self.ledger.last('time'):g}"
        return f"Result({end} with {self.scheme}, {len(self.times)} states kept)"

    def _repr_html_(self) -> str:
        is_present = holds(self._system, self._composition)
        return html_of(self) if is_present else table([], title=repr(self))

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
        """Audit of what was conserved, in ten lines; also printed."""
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
