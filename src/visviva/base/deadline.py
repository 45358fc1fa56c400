"""The end of the time that a run was given, as queues of clusters do."""

from __future__ import annotations

import re
import time

from visviva.base.errors import RunError

STARTED = time.monotonic()
"""Of the process, or nearly so."""
SPARE = 2.0
"""Longest steps that have to fit in before the end, and saves of the state."""


class TimeLimit(RunError):
    """The time that a run was given is over; its state is saved."""


def seconds_of(text: str) -> float:
    """Seconds of a time as queues write it: two numbers are minutes and seconds.

    Raises
    ------
    ValueError
        If it is none.

    Examples
    --------
    >>> seconds_of("30:00"), seconds_of("1:30:00"), seconds_of("2-00:00:10")
    (1800.0, 5400.0, 172810.0)
    """
    found = re.fullmatch(r"(?:(?:(\d+)-)?(\d+):([0-5]\d)|(\d+)):([0-5]\d)", text.strip())
    if not found:
        raise ValueError(
            f"{text!r} is no time such as 11:30:00, 30:00 (minutes:seconds) or 2-00:00:00 (days-hours:minutes:seconds)"
        )
    days, hours, minutes, alone, seconds = (int(part or 0) for part in found.groups())
    return 86400.0 * days + 3600.0 * hours + 60.0 * (minutes + alone) + seconds


def left_of(seconds: float | None) -> float | None:
    """Seconds left of a time limit that counts from the start of the process; always more than zero."""
    return None if seconds is None else max(seconds - (time.monotonic() - STARTED), 1e-3)


class Deadline:
    """Tells when the next step might not be through in time.

    Parameters
    ----------
    seconds : float
        From now on.

    Examples
    --------
    >>> deadline = Deadline(3600.0)
    >>> deadline.is_near(saving=0.1), deadline.is_near(saving=1800.0)
    (False, True)
    """

    def __init__(self, seconds: float) -> None:
        self.last = time.monotonic()
        self.end, self.longest = self.last + seconds, 0.0

    def is_near(self, saving: float) -> bool:
        """After a step: whether what is left is less than twice the longest step so far and saving the state."""
        now = time.monotonic()
        self.longest, self.last = max(self.longest, now - self.last), now
        return now + SPARE * (self.longest + saving) >= self.end
