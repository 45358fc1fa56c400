"""Record of the study in a run directory, and comparison with it when the run is resumed."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Self

from visviva.base.errors import InputError
from visviva.output.directory import RunDirectory
from visviva.study.fingerprint import changes, fingerprint
from visviva.system.agreement import Arguments

if TYPE_CHECKING:
    from visviva.study.study import Study

FORMAT = "visviva arguments 1"
SHOWN = 4  # changes in a message; the file has them all


@dataclass
class Origin:
    """The arguments of a run's study.

    Attributes
    ----------
    arguments : dict
        See `fingerprint`.
    untold : list of str
        What cannot be compared when the run is resumed.
    forced : list of dict
        Every time at which the run went on with other arguments, and their changes.
    """

    arguments: Arguments
    untold: list[str]
    forced: list[dict[str, Any]] = field(default_factory=list)

    @classmethod
    def of(cls, study: Study) -> Self:
        """Record of a study."""
        return cls(*fingerprint(study))

    def write(self, files: RunDirectory) -> None:
        """Note it in the directory."""
        noted = {"format": FORMAT, "arguments": self.arguments, "untold": self.untold, "forced": self.forced}
        files.write_json(files.arguments, noted)

    @classmethod
    def read(cls, files: RunDirectory) -> Self:
        """Contents of the record.

        Raises
        ------
        InputError
            If there is no such note that this version can read.
        """
        if not files.arguments.exists():
            raise InputError(
                f"{files.path}: does not note what it was run with (no {files.arguments.name}), as runs of "
                "visviva 0.1 did not; start anew in another directory"
            )
        noted = files.read_json(files.arguments)
        if noted.get("format") != FORMAT:
            raise InputError(
                f"{files.arguments}: has layout {noted.get('format')!r}, this version reads {FORMAT!r}; "
                "start anew in another directory"
            )
        try:
            return cls(noted["arguments"], noted["untold"], noted["forced"])
        except KeyError as error:
            raise InputError(f"{files.arguments}: is damaged (no {error})") from None

    def resumed(self, files: RunDirectory, study: Study, force: bool) -> tuple[Self, list[str]]:
        """The origin of the run that goes on with a study, and what has changed.

        Raises
        ------
        InputError
            If anything has changed, unless `force`.
        """
        now = type(self).of(study)
        now.forced = list(self.forced)
        found = changes(self.arguments, now.arguments)
        if found and not force:
            shown = "; ".join(found[:SHOWN]) + (f"; and {len(found) - SHOWN} more" * (len(found) > SHOWN))
            raise InputError(
                f"{files.path}: was run with something else: {shown}. Resume with the same, start anew in another "
                "directory, or go on with --force (force=True) if the change is meant"
            )
        return now, found
