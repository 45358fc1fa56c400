"""The directory of one run and the names of the files in it."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

from visviva.base.errors import InputError
from visviva.output.labels import Labels
from visviva.output.lock import locked
from visviva.output.manifest import note, own, refuse_others, remove
from visviva.output.safe_files import replacing, reporting


@dataclass(frozen=True)
class RunDirectory:
    """The files of one run; make one with `create` for a new run or `open` for an existing one.

    Examples
    --------
    >>> import tempfile
    >>> run = RunDirectory.create(tempfile.mkdtemp() + "/crane")
    >>> run.write_summary({"steps": 200, "closing_error": 1.5e-14})
    >>> RunDirectory.open(run.path).read_summary()["steps"]
    200
    """

    path: Path

    @property
    def trajectory(self) -> Path:
        """Shapes of all components over time, for ParaView."""
        return self.path / "trajectory.vtkhdf"

    @property
    def ledger(self) -> Path:
        """Energies, momenta and defects per step."""
        return self.path / "ledger.csv"

    @property
    def probes(self) -> Path:
        """Time series which the model defines."""
        return self.path / "probes.csv"

    @property
    def summary(self) -> Path:
        """Figures of the whole run."""
        return self.path / "summary.json"

    @property
    def state(self) -> Path:
        """Last state, from which the run resumes."""
        return self.path / "state.h5"

    @property
    def states(self) -> Path:
        """States that were kept, one row each."""
        return self.path / "states.npy"

    @property
    def arguments(self) -> Path:
        """Fingerprint of the study, compared when the run is resumed."""
        return self.path / "arguments.json"

    @property
    def labels(self) -> Path:
        """Names and units of what the files hold."""
        return self.path / "labels.json"

    @property
    def probes_plot(self) -> Path:
        """Plot of the probes."""
        return self.path / "probes.png"

    @property
    def energy_plot(self) -> Path:
        """Plot of the ledger."""
        return self.path / "energy.png"

    @property
    def picture(self) -> Path:
        """Picture of the system."""
        return self.path / "picture.png"

    def picture_at(self, time: float) -> Path:
        """Picture of a moment."""
        return self.path / f"picture-{time:g}.png"

    @property
    def movie(self) -> Path:
        """Movie of the motion."""
        return self.path / "movie.mp4"

    @property
    def page(self) -> Path:
        """The motion as a page for browsers."""
        return self.path / "motion.html"

    @property
    def starting(self) -> Path:
        """Mark of a run that has not yet saved its first state: nothing in it is worth keeping."""
        return self.path / ".starting"

    @property
    def earlier(self) -> tuple[Path, ...]:
        """Files of a run that got as far as its first state."""
        if _never_began(self):
            return ()
        return tuple(file for file in own(self) if file in self.files and file.exists())

    @property
    def files(self) -> tuple[Path, ...]:
        """All files that a run may write."""
        series = (
            self.trajectory,
            self.ledger,
            self.probes,
            self.summary,
            self.state,
            self.states,
            self.arguments,
            self.labels,
        )
        return (*series, self.energy_plot, self.probes_plot, self.picture, self.movie, self.page)

    @classmethod
    def create(cls, path: str | Path, overwrite: bool = False) -> Self:
        """Make the directory of a new run.

        Parameters
        ----------
        path
            Directory; made with its parents if missing.
        overwrite
            Delete the files of an earlier run in it (and nothing else), as is done with one that never began.

        Raises
        ------
        InputError
            If the directory cannot be written, holds a run and `overwrite` is false, or files of no run that have names
            of a run's.
        """
        run = cls(Path(path))
        _prepare(run.path)
        earlier = run.earlier
        if earlier and not overwrite:
            held = f"{run.path}: already holds a run ({earlier[0].name})"
            raise InputError(f"{held}; resume it, overwrite it, or choose another directory")
        refuse_others(run)
        for file in own(run):
            remove(file)
        note(run, run.files[:8])  # what is drawn later is claimed then
        return run

    @classmethod
    def open(cls, path: str | Path) -> Self:
        """Find an existing run, to resume, plot or show it.

        Raises
        ------
        InputError
            If there is no run in the directory.
        """
        run = cls(Path(path))
        if not any(file.exists() for file in run.files):
            raise InputError(f"{run.path}: holds no run (no {run.trajectory.name}, no {run.state.name})")
        if _never_began(run):
            raise InputError(
                f"{run.path}: holds a run that never saved a state; run it again, without resuming"
            )
        return run

    @contextmanager
    def writing(self, lock: bool = True) -> Iterator[None]:
        """Be the only one who writes in the directory, which is made if missing; without `lock` that is not seen to.

        Raises
        ------
        InputError
            If another process writes there, or the directory cannot be written.
        """
        _prepare(self.path)
        with locked(self.path) if lock else nullcontext():
            yield

    def begin(self) -> None:
        """Mark what is written from now on as a run that has yet to save its first state."""
        with reporting(self.starting):
            self.starting.touch()

    def write_summary(self, summary: Mapping[str, Any]) -> None:
        """Write the figures of the run as JSON; numbers and arrays of numpy are welcome.

        Not-a-number and infinity become null, since JSON has neither.
        """
        self.write_json(self.summary, summary)

    def read_summary(self) -> dict[str, Any]:
        """Read the figures of the run."""
        return self.read_json(self.summary)

    def write_labels(self, labels: Labels) -> None:
        """Note names and units of what the files hold."""
        self.write_json(self.labels, labels.noted())

    def read_labels(self) -> Labels:
        """Names and units of what the files hold; none known in runs of earlier versions."""
        return Labels.of(self.read_json(self.labels)) if self.labels.exists() else Labels()

    def write_json(self, path: Path, content: Mapping[str, Any]) -> None:
        """Replace a file of the run by one that holds `content`."""
        text = json.dumps(_plain(content), indent=2, allow_nan=False)
        with reporting(path), replacing(path) as temporary:
            temporary.write_text(text + "\n", encoding="utf-8")

    def read_json(self, path: Path) -> dict[str, Any]:
        """Read a file of the run.

        Raises
        ------
        InputError
            If it is missing or damaged.
        """
        try:
            content = json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise InputError(f"{path}: cannot be read ({error})") from error
        if not isinstance(content, dict):
            raise InputError(f"{path}: is damaged (holds no names with values)")
        return content


def _never_began(run: RunDirectory) -> bool:
    """Whether a run was cut off before its first state."""
    return run.starting.exists() and not run.state.exists()


def _prepare(path: Path) -> None:
    """Make the directory and prove by writing that it can be written; modes alone do not tell."""
    proof = path / f".writable-{os.getpid()}"
    try:
        path.mkdir(parents=True, exist_ok=True)
        proof.touch()
        proof.unlink()
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror}); choose another directory") from error


def _plain(value: Any) -> Any:
    """Reduce numpy values, paths and containers to what JSON knows."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value if isinstance(value, str | int | None) else str(value)
