"""Errors that visviva raises on purpose; each message says what was wrong and what cures it."""

import difflib
import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager

MAX_WORD, MAX_MESSAGE, MAX_NAME = 400, 1000, 200


def shortened(message: str) -> str:
    """A message in which what was given is not repeated at any length: long words and long messages lose their middles.

    Examples
    --------
    >>> len(shortened("there is no class " + 10**5 * "x"))
    105
    """
    words = re.sub(rf"\S{{{MAX_WORD},}}", lambda word: f"{word[0][:60]}...{word[0][-24:]}", message)
    return words if len(words) <= MAX_MESSAGE else f"{words[:600]} ... {words[-300:]}"


class VisvivaError(Exception):
    """Base of all errors raised by visviva.

    Parameters
    ----------
    message : str
        What was wrong, with which value, and what cures it; what is too long loses its middle.
    """

    def __init__(self, message: str = "") -> None:
        super().__init__(shortened(message))


class InputError(VisvivaError, ValueError):
    """Something the user gave cannot be used."""


class RunError(VisvivaError, RuntimeError):
    """A computation that was well posed by its input failed on the way."""


class NotFinite(RunError):
    """Something has no finite value at a state that is tried: a shorter step may not come there."""


NO_VALUE = ArithmeticError, ValueError
"""What functions of Python raise where they have no value, as ``math.sqrt(-1)`` does."""


@contextmanager
def named(what: str) -> Iterator[None]:
    """Inside a user's function is called: what it raises becomes an error that names it.

    Raises
    ------
    NotFinite, RunError

    Examples
    --------
    >>> with named("Spring 'rope': its energy"):
    ...     1 / 0
    Traceback (most recent call last):
    visviva.base.errors.NotFinite: Spring 'rope': its energy raised ZeroDivisionError: division by zero
    """
    try:
        yield
    except VisvivaError:
        raise
    except Exception as error:
        kind = NotFinite if isinstance(error, NO_VALUE) else RunError
        told = f": {error}" if str(error) else ""
        # of a `StopIteration` with a cause `contextmanager` takes the new error for one of its own
        cause = None if isinstance(error, StopIteration) else error
        raise kind(f"{what} raised {type(error).__name__}{told}") from cause


_apart: list[str] = []


def called_apart() -> str:
    """What is being done that processes come to each by itself, and none has to come to; nothing if all do the same."""
    if _apart:
        return _apart[-1]
    from visviva import _core  # here, so that the command line can tell of an unknown instruction set

    caller = _core.caller()
    return f"{caller}: a function in its equations" if caller else ""


@contextmanager
def apart(what: str) -> Iterator[None]:
    """Inside, this process does something by itself, and cannot ask others, as may be in any function of the core.

    Examples
    --------
    >>> with apart("writing a file"):
    ...     called_apart()
    'writing a file'
    """
    _apart.append(what)
    try:
        yield
    finally:
        _apart.pop()


def nearest(name: str, known: Iterable[str]) -> str:
    """End of a message about an unknown name: the nearest known one, or all if there are few.

    Examples
    --------
    >>> nearest("omga", ["omega", "radius"])
    "; did you mean 'omega'?"
    """
    listed = sorted(known)
    close = [k for k in listed if k.lower() == name.lower()]
    if len(name) > MAX_NAME:  # comparing takes the square of the length
        return ""
    close = close or difflib.get_close_matches(name, listed, n=1, cutoff=0.5)
    if not close:
        lower = {k.lower(): k for k in listed}
        close = [lower[k] for k in difflib.get_close_matches(name.lower(), lower, n=1, cutoff=0.5)]
    if close:
        return f"; did you mean {close[0]!r}?"
    return f"; there are {', '.join(listed[:12])}{', ...' if len(listed) > 12 else ''}" if listed else ""
