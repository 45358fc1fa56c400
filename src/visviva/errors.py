"""Errors that visviva raises on purpose; each message says what was wrong and what cures it."""

import difflib
from collections.abc import Iterable


class VisvivaError(Exception):
    """Base of all errors raised by visviva."""


class InputError(VisvivaError, ValueError):
    """Something the user gave cannot be used."""


class RunError(VisvivaError, RuntimeError):
    """A computation that was well posed by its input failed on the way."""


def nearest(name: str, known: Iterable[str]) -> str:
    """End of a message about an unknown name: the nearest known one, or all if there are few.

    Examples
    --------
    >>> nearest("omga", ["omega", "radius"])
    "; did you mean 'omega'?"
    """
    listed = sorted(known)
    close = [k for k in listed if k.lower() == name.lower()]
    close = close or difflib.get_close_matches(name, listed, n=1, cutoff=0.5)
    if not close:
        lower = {k.lower(): k for k in listed}
        close = [lower[k] for k in difflib.get_close_matches(name.lower(), lower, n=1, cutoff=0.5)]
    if close:
        return f"; did you mean {close[0]!r}?"
    return f"; there are {', '.join(listed[:12])}{', ...' if len(listed) > 12 else ''}" if listed else ""
