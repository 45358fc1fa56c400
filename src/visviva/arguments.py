"""What is wrong with the arguments of a constructor, as an error that names the class, argument and value."""

from __future__ import annotations

from abc import ABCMeta
from dataclasses import MISSING, Field, fields, is_dataclass
from inspect import Parameter, Signature, signature
from typing import Any

from pydantic import ValidationError

from visviva.errors import InputError, nearest

UNEXPECTED = "unexpected_keyword_argument"
ABSENT = "missing_keyword_only_argument", "missing_argument", "missing"


class ArgumentError(InputError):
    """An argument that a constructor refuses.

    Attributes
    ----------
    where : tuple of str and int
        The argument, and the place in it.
    complaint : str
        What is wrong there.
    """

    def __init__(self, whose: str, where: tuple[str | int, ...], complaint: str) -> None:
        self.where, self.complaint = where, complaint
        place = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in where)[1:]
        super().__init__(f"{whose}: {place}: {complaint}" if where else f"{whose}: {complaint}")


class Validated(ABCMeta):
    """Type of the classes whose constructors validate their arguments: refusals are input errors.

    Examples
    --------
    >>> import visviva as vv
    >>> vv.PointMass(mass=-1.0)
    Traceback (most recent call last):
    visviva.errors.InputError: PointMass: mass -1 is not positive
    >>> vv.PointMass(weight=1.0)
    Traceback (most recent call last):
    visviva.arguments.ArgumentError: PointMass: mass: this argument is needed
    """

    def __call__(cls, *args: Any, **kwargs: Any) -> Any:
        try:
            return super().__call__(*args, **kwargs)
        except ValidationError as error:
            raise refusal(cls, kwargs.get("name"), error) from None

    @property
    def __signature__(cls) -> Signature:
        """Of the constructor: its fields."""
        if not is_dataclass(cls):
            raise AttributeError(f"{cls.__name__} is no dataclass")
        return Signature(sorted((parameter(f) for f in fields(cls) if f.init), key=lambda p: p.kind))

    @__signature__.setter
    def __signature__(cls, value: Any) -> None:
        """Pydantic would set one that does not know the fields of a class which it completes late."""


def parameter(f: Field[Any]) -> Parameter:
    """A field of a dataclass as a parameter of its constructor."""
    kind = Parameter.KEYWORD_ONLY if f.kw_only else Parameter.POSITIONAL_OR_KEYWORD
    given = [d for d in (f.default, f.default_factory) if d is not MISSING]
    return Parameter(f.name, kind, default=given[0] if given else Parameter.empty, annotation=f.type)


def refusal(cls: type, name: Any, error: ValidationError) -> InputError:
    """The error to raise for a failed validation."""
    first = error.errors()[0]
    original = first.get("ctx", {}).get("error")
    if isinstance(original, InputError) and not first["loc"]:
        return original  # from the constructor's own checks, which say whose
    whose = f"{cls.__name__} {name!r}" if isinstance(name, str) else cls.__name__
    where, complaint = told(error)
    if first["type"] == UNEXPECTED:
        complaint = f"there is no such argument{nearest(str(where[-1]), signature(cls).parameters)}"
    elif first["type"] in ABSENT:
        complaint = "this argument is needed"
    return ArgumentError(whose, where, complaint)


def told(error: ValidationError) -> tuple[tuple[str | int, ...], str]:
    """Place and message of the first error of a validation, in one line."""
    first = error.errors()[0]
    message = first["msg"].removeprefix("Value error, ")
    # parts of unions have names of their own, which are no arguments
    where = tuple(part for part in first["loc"] if isinstance(part, int) or part.isidentifier())[:2]
    hidden = isinstance(first["input"], dict) or first["type"] == "value_error"
    shown = "" if hidden else f", not {first['input']!r}"
    return where, f"{message[:1].lower()}{message[1:]}{shown}"
