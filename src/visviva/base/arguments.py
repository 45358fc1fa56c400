"""Errors of constructors' arguments, which name the class, the argument and the value."""

from __future__ import annotations

import math
import sys
from abc import ABCMeta
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import MISSING, Field, fields, is_dataclass
from functools import cache
from inspect import Parameter, Signature, signature
from types import NoneType, UnionType
from typing import TYPE_CHECKING, Annotated, Any, Union, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, ConfigDict, TypeAdapter, ValidationError

from visviva.base.errors import InputError, nearest, shortened

MADE = "_is_made"
"""Attribute of objects whose constructor is through."""
UNEXPECTED = "unexpected_keyword_argument"
OBJECTS = ConfigDict(arbitrary_types_allowed=True)
LISTED = BeforeValidator(lambda value: value.tolist() if isinstance(value, np.ndarray) else value)
"""Arrays become lists, so that what has them as arguments holds plain data alone: comparable, hashable, storable."""
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
    visviva.base.errors.InputError: PointMass: mass -1 is not positive
    >>> vv.Ground(mass=1.0)
    Traceback (most recent call last):
    visviva.base.arguments.ArgumentError: Ground: mass: there is no such argument; there are name
    """

    def _make(cls, *args: Any, **kwargs: Any) -> Any:
        given = {**(by_name(cls, args) if is_dataclass(cls) else {}), **kwargs}
        for name, value in given.items():
            complaint = mistaken(plain_types(cls).get(name, frozenset()), value)
            if name in references(cls) and not is_reference(value):
                complaint = f"expected a component, a point or frame of it, or a measure, not {value!r}"
            if name in objects(cls) and (mapping := mapping_in(value)) is not None:
                complaint = (
                    f"input should be an instance of {objects(cls)[name]}, not {shortened(repr(mapping))}"
                )
            if complaint:
                raise ArgumentError(called(cls, kwargs.get("name")), (name,), complaint)
        if is_dataclass(cls) and not hasattr(cls, "__pydantic_validator__"):
            return fixed(super().__call__(**converted(cls, named(cls, args, kwargs))), given.values())
        try:
            return fixed(super().__call__(*args, **kwargs), given.values())
        except ValidationError as error:
            raise refusal(cls, kwargs.get("name"), error) from None

    if (
        not TYPE_CHECKING
    ):  # pyright would believe that constructors return what it does, and take any arguments
        __call__ = _make

    @property
    def __signature__(cls) -> Signature:
        """Of the constructor: its fields."""
        if not is_dataclass(cls):
            raise AttributeError(f"{cls.__name__} is no dataclass")
        return Signature(sorted((parameter(f) for f in fields(cls) if f.init), key=lambda p: p.kind))

    @__signature__.setter
    def __signature__(cls, value: Any) -> None:
        """Pydantic would set one that does not know the fields of a class which it completes late."""


class Unchanging(metaclass=Validated):
    """Base of arguments that keep their own arguments, as what is made of them would not follow.

    Those that no user derives from are frozen dataclasses instead.

    Examples
    --------
    >>> import visviva as vv
    >>> vv.NeoHooke(young=1.0, poisson=0.3).young = 2.0
    Traceback (most recent call last):
    visviva.base.errors.InputError: NeoHooke: young stays as given; make another by dataclasses.replace(it, young=2.0)
    """

    def __setattr__(self, name: str, value: Any) -> None:
        """Refuse to set an argument."""
        argument = getattr(type(self), "__dataclass_fields__", {}).get(name)
        if MADE in vars(self) and argument is not None and argument.init:
            cure = f"make another by dataclasses.replace(it, {name}={value!r})"
            raise InputError(f"{type(self).__name__}: {name} stays as given; {cure}")
        super().__setattr__(name, value)

    def __delattr__(self, name: str) -> None:
        """Refuse to delete an argument."""
        self.__setattr__(name, None)
        super().__delattr__(name)


class FrozenDict(dict[Any, Any]):
    """A dictionary that cannot be changed.

    Examples
    --------
    >>> FrozenDict(a=1)["b"] = 2
    Traceback (most recent call last):
    visviva.base.errors.InputError: this dictionary is an argument of what was made of it, and stays as it is
    """

    def _refuse(self, *args: Any, **kwargs: Any) -> Any:
        raise InputError("this dictionary is an argument of what was made of it, and stays as it is")

    __setitem__ = __delitem__ = __ior__ = update = setdefault = pop = popitem = clear = _refuse

    def __reduce__(self) -> tuple[type, tuple[dict[Any, Any]]]:
        return FrozenDict, (dict(self),)


def fixed(made: Any, given: Iterable[Any] = ()) -> Any:
    """An object whose arguments that are arrays and lists cannot be changed in place.

    Nobody would notice an entry that is set: what is made of an array stays as it is. Arrays that were `given` are
    copied, as they are the user's own.

    Examples
    --------
    >>> import visviva as vv
    >>> vv.PointMass(mass=1.0).velocity[0] = 5.0
    Traceback (most recent call last):
    ValueError: assignment destination is read-only
    """
    theirs = {id(value) for value in given}
    if isinstance(made, Unchanging):
        vars(made)[MADE] = True
    for f in fields(made) if is_dataclass(made) else ():
        value = vars(made).get(f.name)
        if not f.init:
            continue
        if isinstance(value, np.ndarray) and value.flags.writeable:
            own = value.copy() if id(value) in theirs or not value.flags.owndata else value
            own.setflags(write=False)
            vars(made)[f.name] = own
        elif type(value) in FROZEN:
            vars(made)[f.name] = FROZEN[type(value)](value)
    return made


FROZEN: dict[type, Callable[[Any], Any]] = {list: tuple, dict: FrozenDict}
"""Types of arguments that could be changed in place, and those that keep their values."""


class Named(type):
    """Type of the classes whose constructors look at the values themselves: names that do not fit are input errors.

    Examples
    --------
    >>> import visviva as vv
    >>> vv.System([vv.PointMass(mass=1.0)], newtn=vv.Newton())
    Traceback (most recent call last):
    visviva.base.arguments.ArgumentError: System: newtn: there is no such argument; did you mean 'newton'?
    """

    def _make(cls, *args: Any, **kwargs: Any) -> Any:
        named(cls, args, kwargs)
        return super().__call__(*args, **kwargs)

    if not TYPE_CHECKING:
        __call__ = _make

    @property
    def __signature__(cls) -> Signature:
        """Of the constructor."""
        own = signature(cls.__init__)  # type: ignore[misc]
        return own.replace(parameters=list(own.parameters.values())[1:], return_annotation=Signature.empty)


def named(cls: type, args: tuple[Any, ...], kwargs: Mapping[str, Any]) -> dict[str, Any]:
    """All arguments by name, which must be those of the constructor."""
    known, placed = parameters(cls), by_name(cls, args)
    for name in kwargs:
        if name not in known:
            raise ArgumentError(cls.__name__, (name,), f"there is no such argument{nearest(name, known)}")
        if name in placed:
            raise ArgumentError(cls.__name__, (name,), "this argument is given twice, by place and by name")
    given = {**placed, **kwargs}
    for name, p in known.items():
        if p.default is p.empty and name not in given:
            raise ArgumentError(cls.__name__, (name,), "this argument is needed")
    return given


@cache
def parameters(cls: type) -> Mapping[str, Parameter]:
    """Of a constructor; to make them anew for every object takes longer than most objects do."""
    return signature(cls).parameters


def by_name(cls: type, args: tuple[Any, ...]) -> dict[str, Any]:
    """Arguments given by place."""
    if not args:
        return {}
    names = [p.name for p in parameters(cls).values() if p.kind is p.POSITIONAL_OR_KEYWORD]
    if len(args) > len(names):
        some = f"{len(names) or 'no'} argument{'' if len(names) == 1 else 's'}"
        raise InputError(
            f"{cls.__name__} takes {some} without a name, not {len(args)}{meant(cls, names, args)}"
        )
    return dict(zip(names, args, strict=False))


def meant(cls: type, names: list[str], args: tuple[Any, ...]) -> str:
    """End of a message about too many arguments: how to write them."""
    known = list(parameters(cls))
    if len(names) == 1 and len(args) in (2, 3) and all(map(is_number, args)):
        return f"; write {cls.__name__}({names[0]}=({', '.join(f'{a:g}' for a in args)}))"
    return f"; give them by name: {', '.join(f'{name}=' for name in known[:8])}" if known else ""


def converted(cls: type, given: Mapping[str, Any]) -> dict[str, Any]:
    """Arguments of a dataclass that is not one of Pydantic's, validated by their types."""
    types = adapters(cls)
    found = {}
    for name, value in given.items():
        try:
            found[name] = types[name].validate_python(value) if name in types else value
        except ValidationError as error:
            where, complaint = told(error)
            raise ArgumentError(cls.__name__, (name, *where), complaint) from None
    return found


@cache
def adapters(cls: type) -> dict[str, TypeAdapter[Any]]:
    """Validator of the arguments of a dataclass."""
    try:
        hints = get_type_hints(cls, include_extras=True)
    except NameError:  # names that only a type checker imports
        return {}
    return {f.name: TypeAdapter(hints[f.name], config=OBJECTS) for f in fields(cls) if f.init}


def called(cls: type, name: Any) -> str:
    """Name in messages of the object that a constructor was to make."""
    return f"{cls.__name__} {name!r}" if isinstance(name, str) else cls.__name__


@cache
def plain_types(cls: type) -> dict[str, frozenset[type]]:
    """The arguments of a class that take Booleans or numbers alone, with the types they are made of."""
    try:
        hints = get_type_hints(cls)
    except NameError:  # names that only a type checker imports
        return {}
    return {name: types for name, hint in hints.items() if (types := plain_leaves(hint))}


def plain_leaves(hint: Any) -> frozenset[type]:
    """The types that a hint is made of, if it is made of Booleans and numbers alone; none otherwise."""
    types = frozenset(leaves(hint)) - {NoneType}
    return types if types <= {bool, int, float} else frozenset()


def leaves(hint: Any) -> Iterator[Any]:
    """The types that a union, list or tuple is made of."""
    if get_origin(hint) is Annotated:
        yield from leaves(get_args(hint)[0])
    elif get_origin(hint) in (Union, UnionType, list, tuple):
        for part in get_args(hint):
            if part is not ...:
                yield from leaves(part)
    else:
        yield hint


@cache
def references(cls: type) -> frozenset[str]:
    """The arguments of a class of the package by which it names others: those of any type."""
    if not cls.__module__.startswith("visviva."):
        return frozenset()
    try:
        hints = get_type_hints(cls, include_extras=True)
    except NameError:
        return frozenset()
    return frozenset(name for name, hint in hints.items() if hint is Any)


def is_reference(value: Any) -> bool:
    """Whether a value can stand for others: components, points and measures are dataclasses, or functions give them."""
    if isinstance(value, list | tuple):
        return all(map(is_reference, value))
    return value is None or ((is_dataclass(value) or callable(value)) and not isinstance(value, type))


@cache
def objects(cls: type) -> dict[str, str]:
    """The arguments of a class that take objects of others and no mappings, with what to call these.

    Pydantic would make them of mappings, past their constructors: bases of components and materials out of ``{}``.
    """
    try:
        hints = get_type_hints(cls)
    except NameError:  # names that only a type checker imports
        return {}
    found = {}
    for name, hint in hints.items():
        kinds = list(leaves(hint))
        made = dict.fromkeys(k.__name__ for k in kinds if isinstance(k, type) and is_dataclass(k))
        if made and not any(get_origin(kind) or kind in (Any, dict) for kind in kinds):
            found[name] = " or ".join(made)
    return found


def mapping_in(value: Any) -> Any:
    """The mapping that a value is, or that stands in its list; None where there is none."""
    values = value if isinstance(value, list | tuple) else [value]
    return next((item for item in values if isinstance(item, Mapping)), None)


def mistaken(types: frozenset[type], value: Any) -> str:
    """Complaint about a value that would be turned into a Boolean or number though it is none; else nothing.

    Pydantic takes the text 'yes' for True, '2' for 2 and True for 1.
    """
    if not types or value is None:
        return ""
    if types == {bool} and not isinstance(value, bool | np.bool_ | list | tuple):
        return f"write true or false, not {value!r}"
    wrong = (str, bytes) if bool in types else (str, bytes, bool, np.bool_)
    for item in value if isinstance(value, list | tuple) else [value]:
        if isinstance(item, wrong):
            return f"input should be a valid number, not {item!r}"
    return ""


def refuse_other(whose: str, what: str, value: Any, kind: Any, wanted: str) -> None:
    """Refuse an argument of another type."""
    if not isinstance(value, kind) or isinstance(value, str | bytes):
        raise InputError(f"{whose}: {what} is {wanted}, not {shortened(repr(value))}")


def is_number(value: Any) -> bool:
    """Whether a value is a real number, of Python or of numpy, that a float can be."""
    if isinstance(value, bool) or not isinstance(value, float | int | np.floating | np.integer):
        return False
    return not (isinstance(value, int) and abs(value) > sys.float_info.max)


def number(whose: str, what: str, value: Any) -> float:
    """An argument as a number; infinity and not-a-number are some."""
    if not is_number(value):
        raise InputError(f"{whose}: {what} = {value!r} is not a number")
    return float(value)


def finite(whose: str, what: str, value: Any) -> float:
    """An argument as a finite number."""
    if not (is_number(value) and math.isfinite(value)):
        raise InputError(f"{whose}: {what} = {value!r} is not a finite number")
    return float(value)


def positive(whose: str, what: str, value: Any) -> float:
    """An argument as a positive finite number."""
    if not (is_number(value) and 0 < value < math.inf):
        raise InputError(f"{whose}: {what} = {value!r} is not a positive number")
    return float(value)


def whole(whose: str, what: str, value: Any) -> int:
    """An argument as a whole number, at least 1."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < 1:
        raise InputError(f"{whose}: {what} = {value!r} is not a whole number that is at least 1")
    return int(value)


def place(whose: str, what: str, value: Any, shape: tuple[int, ...] = (3,)) -> NDArray[np.float64]:
    """An argument as an array of finite numbers of a shape."""
    found = as_numbers(value)
    if found.shape != shape or not np.isfinite(found).all():
        wanted = "3 finite numbers" if shape == (3,) else "3 rows of 3 finite numbers"
        raise InputError(f"{whose}: {what} is {wanted}, not {value!r}")
    return found


def vector(whose: str, what: str, value: Any, n: int | None) -> NDArray[np.float64]:
    """An argument as a row of n finite numbers, of any length for None."""
    found = as_numbers(value)
    if found.ndim != 1 or n not in (None, len(found)) or not np.isfinite(found).all():
        counted = "a row of" if n is None else n
        raise InputError(f"{whose}: {what} is {counted} finite numbers, not {value!r}")
    return found


def as_numbers(value: Any) -> NDArray[np.float64]:
    """What is given as an array, or a single not-a-number of what is none: texts, rows of several lengths."""
    try:
        return np.array(value, dtype=float)
    except (TypeError, ValueError, OverflowError):
        return np.array(math.nan)


def bounded(thing: Any, **bounds: tuple[float, float]) -> None:
    """Refuse arguments of an object that are not within their bounds."""
    for name, (least, most) in bounds.items():
        value = getattr(thing, name)
        if not least <= value <= most:
            kind = type(thing).__name__
            raise InputError(f"{kind}: {name} = {value} is not a number from {least:g} to {most:g}")


def refuse_unless(right: bool, whose: Any, what: str, wanted: str) -> None:
    """Refuse an argument of a component that is not `wanted`, which says also what to do instead."""
    if not right:
        raise InputError(f"{whose.label}: {what} {getattr(whose, what):g} is not {wanted}")


def parameter(f: Field[Any]) -> Parameter:
    """A field of a dataclass as a parameter of its constructor."""
    kind = Parameter.KEYWORD_ONLY if f.kw_only else Parameter.POSITIONAL_OR_KEYWORD
    given = [d for d in (f.default, f.default_factory) if d is not MISSING]
    return Parameter(f.name, kind, default=given[0] if given else Parameter.empty, annotation=f.type)


def refusal(cls: type, name: Any, error: ValidationError) -> InputError:
    """The error to raise for a failed validation."""
    first = worst(error)
    original = first.get("ctx", {}).get("error")
    if isinstance(original, InputError) and not first["loc"]:
        return original  # from the constructor's own checks, which say whose
    whose = called(cls, name)
    where, complaint = told(error)
    if where and isinstance(where[0], int):  # given by its place
        where = (list(parameters(cls))[where[0]], *where[1:])
    if first["type"] == UNEXPECTED:
        complaint = f"there is no such argument{nearest(str(where[-1]), parameters(cls))}"
    elif first["type"] in ABSENT:
        complaint = "this argument is needed"
    return ArgumentError(whose, where, complaint)


def worst(error: ValidationError) -> Any:
    """The error of a failed validation to report: unknown names before missing ones, which they may stand for."""
    found = error.errors()
    return next((each for each in found if each["type"] == UNEXPECTED), found[0])


def told(error: ValidationError) -> tuple[tuple[str | int, ...], str]:
    """Place and message of an error of a validation, in one line."""
    first = worst(error)
    message = first["msg"].removeprefix("Value error, ")
    # parts of unions have names of their own, which are no arguments
    where = tuple(part for part in first["loc"] if isinstance(part, int) or part.isidentifier())[:2]
    hidden = isinstance(first["input"], dict) or first["type"] == "value_error"
    shown = "" if hidden else f", not {first['input']!r}"
    return where, f"{message[:1].lower()}{message[1:]}{shown}"
