"""Errors that visviva raises on purpose; each message says what was wrong and what cures it."""


class VisvivaError(Exception):
    """Base of all errors raised by visviva."""


class InputError(VisvivaError, ValueError):
    """Something the user gave cannot be used."""


class RunError(VisvivaError, RuntimeError):
    """A computation that was well posed by its input failed on the way."""
