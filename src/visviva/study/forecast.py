"""Forecast of the size of a run's files, told before the first step."""

from __future__ import annotations

from dataclasses import dataclass

LARGE, LONG = 1e8, 10.0
"""Bytes and seconds that are worth a word."""
DIGITS = 19
"""Bytes of a number in a table."""


@dataclass(frozen=True)
class Forecast:
    """Numbers and sizes of what will be written, if steps keep their length.

    Attributes
    ----------
    frames, states, rows : int
        Of the trajectory, of the file of states, of tables.
    frame, state, row : float
        Bytes of one of each.
    seconds : float
        For all, as the first ones took.
    free : float
        Bytes on the disk.

    Examples
    --------
    >>> print(Forecast(1001, 101, 1001, 2.0e6, 1.0e6, 400.0, seconds=12.0, free=1e12))
    output: 1001 frames of 2 MB, 101 states of 1 MB, 1001 rows: 2.1 GB in all (1000 GB are free), 12 s of the run
    """

    frames: int
    states: int
    rows: int
    frame: float
    state: float
    row: float
    seconds: float
    free: float

    @property
    def total(self) -> float:
        """Bytes in all."""
        return self.frames * self.frame + self.states * self.state + self.rows * self.row

    @property
    def is_large(self) -> bool:
        """True if the files are large, or writing takes long, so that the user is told."""
        return self.total > min(LARGE, self.free) or self.seconds > LONG

    def __str__(self) -> str:
        what = f"{self.frames} frames of {size(self.frame)}, {self.states} states of {size(self.state)}"
        room = f"{size(self.free)} are free" + ", which is not enough" * (self.total > self.free)
        text = f"output: {what}, {self.rows} rows: {size(self.total)} in all ({room})"
        return f"{text}, {self.seconds:.2g} s of the run"


def size(n: float) -> str:
    """A number of bytes in words.

    Examples
    --------
    >>> size(950.0), size(2.04e6), size(3.2e10)
    ('950 B', '2 MB', '32 GB')
    """
    for unit, factor in (("GB", 1e9), ("MB", 1e6), ("kB", 1e3)):
        if n >= factor:
            return f"{n / factor:.2g} {unit}" if n < 100 * factor else f"{n / factor:.0f} {unit}"
    return f"{n:.0f} B"
