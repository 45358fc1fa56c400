"""Types of constructor arguments: validated on entry, plain data in scene files, described in JSON Schema."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, BeforeValidator, FiniteFloat, PlainSerializer, WithJsonSchema

from visviva.base.arguments import LISTED
from visviva.base.errors import InputError
from visviva.base.timefunction import TIME_SCHEMA, Expression, TimeFunction

Array = NDArray[np.float64]

NUMBER = {"type": "number"}


def _array(value: Any) -> Array:
    try:
        given = np.asarray(value)
        # texts and Booleans would become numbers, and among numbers they do not show in the type of the array
        mixed = isinstance(value, list | tuple) and any(isinstance(item, bool) for item in flat(value))
        if given.dtype.kind not in "iuf" or mixed:
            raise TypeError
        a = given.astype(float)
    except (TypeError, ValueError):
        raise ValueError(f"expected numbers, not {value!r}") from None
    if not np.isfinite(a).all():
        raise ValueError(f"expected finite numbers, not {np.asarray(value).tolist()}")
    return a


def flat(value: Any) -> Iterator[Any]:
    """Leaves of nested lists."""
    for item in value:
        if isinstance(item, list | tuple):
            yield from flat(item)
        else:
            yield item


def _vector(value: Any) -> Array:
    a = _array(value)
    if a.shape != (3,):
        raise ValueError(f"expected a list of 3 numbers, not {np.asarray(value).tolist()!r}")
    return a


def _matrix(value: Any) -> Array:
    a = _array(value)
    if a.shape not in ((3,), (3, 3)):
        raise ValueError(f"expected 3 numbers or 3 rows of 3 numbers, not {np.asarray(value).tolist()!r}")
    return a


def _list(a: Array | None) -> Any:
    return None if a is None else a.tolist()


VECTOR_SCHEMA = {"type": "array", "items": NUMBER, "minItems": 3, "maxItems": 3}
Vector3 = Annotated[Any, BeforeValidator(_vector), PlainSerializer(_list), WithJsonSchema(VECTOR_SCHEMA)]
Matrix = Annotated[
    Any,
    BeforeValidator(_matrix),
    PlainSerializer(_list),
    WithJsonSchema(
        {"anyOf": [VECTOR_SCHEMA, {"type": "array", "items": VECTOR_SCHEMA, "minItems": 3, "maxItems": 3}]}
    ),
]
Number = FiniteFloat


def positive_tensor(label: str, what: str, given: Any) -> Array:
    """Six components 11, 22, 33, 12, 23, 31 of a number, of three along the axes, or of a matrix (3, 3).

    Raises
    ------
    InputError
        If it is not symmetric and positive; the message calls it `what`.

    Examples
    --------
    >>> positive_tensor("", "", [1.0, 2.0, 3.0]).tolist()
    [1.0, 2.0, 3.0, 0.0, 0.0, 0.0]
    """
    k = np.asarray(given, dtype=float)
    K = k if k.ndim == 2 else np.diag(np.broadcast_to(k, (3,)))
    if not np.allclose(K, K.T, rtol=1e-12, atol=0):
        raise InputError(f"{label}: {what} {K.tolist()} is not symmetric")
    if not np.linalg.eigvalsh(K).min() > 0:
        raise InputError(f"{label}: {what} {np.asarray(given).tolist()} is not positive in all directions")
    return np.asarray(K[[0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]])


def _is_function(value: Any) -> bool:
    """True for functions to be evaluated. Classes are callable too, but calling one would construct an object."""
    return callable(value) and not isinstance(value, type)


def _function(value: Any) -> Any:
    if not _is_function(value):
        raise ValueError(f"expected a Python function, not {value!r}")
    return value


def _vector_or_function(value: Any) -> Any:
    return value if _is_function(value) else _vector(value)


def _plain_vector(value: Any) -> Any:
    if callable(value):
        raise ValueError("a Python function cannot be written to a file")
    return _list(value)


Function = Annotated[
    Any,
    BeforeValidator(_function),
    PlainSerializer(_plain_vector),
    WithJsonSchema({"not": {}, "description": "a Python function; not possible in a file"}),
]
VectorOrFunction = Annotated[
    Any, BeforeValidator(_vector_or_function), PlainSerializer(_plain_vector), WithJsonSchema(VECTOR_SCHEMA)
]


class OfPlace:
    """Three expressions in the time t and the place x, y, z as a function ``f(t, X)``.

    Examples
    --------
    >>> OfPlace(["x*t", 0, "2"])(2.0, np.array([[3.0, 0.0, 0.0]])).tolist()
    [[6.0, 0.0, 2.0]]
    """

    def __init__(self, source: Any) -> None:
        self.source = list(source)
        if len(self.source) != 3 or not all(isinstance(s, str | int | float) for s in self.source):
            raise ValueError(f"expected three numbers or expressions in t, x, y, z, not {source!r}")
        self._parts = [Expression(str(s)) for s in self.source]
        unknown = {name for part in self._parts for name in part.names} - set("txyz")
        if unknown:
            raise ValueError(f"{min(unknown)!r} in {source!r} is unknown; there are t, x, y, z")

    def __repr__(self) -> str:
        return f"OfPlace({self.source!r})"

    def __call__(self, t: float, X: Array) -> Array:
        """Values (n, 3) at a time and places (n, 3)."""
        found = np.empty((len(X), 3))
        for k, part in enumerate(self._parts):
            if part.names <= {"t"}:
                found[:, k] = part({"t": complex(t)})
            else:
                found[:, k] = [
                    part(dict(zip("txyz", map(complex, (t, *place)), strict=True))) for place in X.tolist()
                ]
        return found


def _vector_or_field(value: Any) -> Any:
    is_list = isinstance(value, list | tuple)
    if is_list and any(isinstance(part, str) for part in value):
        return OfPlace(value)
    return value if isinstance(value, OfPlace) else _vector_or_function(value)


def _plain_field(value: Any) -> Any:
    return value.source if isinstance(value, OfPlace) else _plain_vector(value)


FIELD_SCHEMA = {"type": "array", "items": {"type": ["number", "string"]}, "minItems": 3, "maxItems": 3}
VectorOrField = Annotated[
    Any, BeforeValidator(_vector_or_field), PlainSerializer(_plain_field), WithJsonSchema(FIELD_SCHEMA)
]
"""A vector, a function ``f(t, X)``, or expressions in t, x, y, z."""


def _number_or_function(value: Any) -> Any:
    if _is_function(value):
        return value
    if isinstance(value, bool | str) or _array(value).ndim:
        raise ValueError(f"expected a number or a Python function, not {value!r}")
    return float(value)


def _plain_number(value: Any) -> Any:
    if callable(value):
        raise ValueError("a Python function cannot be written to a file")
    return value


NumberOrFunction = Annotated[
    Any, BeforeValidator(_number_or_function), PlainSerializer(_plain_number), WithJsonSchema(NUMBER)
]


class AtPlace:
    """An expression in the place x, y, z as a function ``f(X)`` of places (n, 3) with values (n,).

    Examples
    --------
    >>> AtPlace("0.5 + 0.1*cos(x)")(np.zeros((2, 3))).tolist()
    [0.6, 0.6]
    """

    def __init__(self, source: str) -> None:
        self.source, self._value = source, Expression(source)
        if unknown := self._value.names - set("xyz"):
            raise ValueError(f"{min(unknown)!r} in {source!r} is unknown; there are x, y, z")

    def __repr__(self) -> str:
        return f"AtPlace({self.source!r})"

    def __call__(self, X: Array) -> Array:
        places = (dict(zip("xyz", map(complex, place), strict=True)) for place in X.tolist())
        return np.array([self._value(place) for place in places])


def _number_at_place(value: Any) -> Any:
    return AtPlace(value) if isinstance(value, str) else _number_or_function(value)


def _plain_at_place(value: Any) -> Any:
    return value.source if isinstance(value, AtPlace) else _plain_number(value)


NumberAtPlace = Annotated[
    Any,
    BeforeValidator(_number_at_place),
    PlainSerializer(_plain_at_place),
    WithJsonSchema({"type": ["number", "string"]}),
]
"""A number, a function ``f(X)``, or an expression in x, y, z."""


def _curve(value: Any) -> Any:
    if _is_function(value):
        return value
    a = _array(value) if not isinstance(value, bool | str) else np.zeros((0, 0))
    if a.ndim == 0:
        return float(a)
    if a.ndim != 2 or a.shape[1] != 2 or len(a) < 2:
        raise ValueError(f"expected a number, rows of two numbers, or a Python function, not {value!r}")
    if not np.all(np.diff(a[:, 0]) > 0):
        raise ValueError(f"the first numbers of a table's rows must grow, not {a[:, 0].tolist()}")
    return a


def _plain_curve(value: Any) -> Any:
    if callable(value):
        raise ValueError("a Python function cannot be written to a file")
    return value.tolist() if isinstance(value, np.ndarray) else value


PAIR_SCHEMA = {"type": "array", "items": NUMBER, "minItems": 2, "maxItems": 2}
Curve = Annotated[
    Any,
    BeforeValidator(_curve),
    PlainSerializer(_plain_curve),
    WithJsonSchema({"anyOf": [NUMBER, {"type": "array", "items": PAIR_SCHEMA, "minItems": 2}]}),
]
"""A number, a table (n, 2) of places that grow and values between which lines are drawn, or a function of Python."""


def _nodes(value: Any) -> Any:
    if isinstance(value, str):
        return value
    found = np.asarray(value)
    if found.ndim != 1 or found.dtype.kind not in "iu" or not len(found):
        raise ValueError(
            f"expected the name of a set of nodes or faces, 'all', or numbers of nodes, not {value!r}"
        )
    return found.astype(np.int64)


Nodes = Annotated[
    Any,
    BeforeValidator(_nodes),
    PlainSerializer(lambda nodes: nodes if isinstance(nodes, str) else nodes.tolist()),
    WithJsonSchema(
        {"anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "integer"}, "minItems": 1}]}
    ),
]
"""Nodes of a solid: the name of a set of nodes or faces, 'all', or numbers."""


def _faces(value: Any) -> Any:
    from visviva.mesh.faces import Faces

    if not isinstance(value, str | Faces):
        raise ValueError(f"expected the name of a set of faces, 'all', or Faces, not {value!r}")
    return value


def _name(faces: Any) -> str:
    if not isinstance(faces, str):
        raise ValueError("faces without a name cannot be written to a file; give the mesh a set of them")
    return faces


FaceSet = Annotated[Any, BeforeValidator(_faces), PlainSerializer(_name), WithJsonSchema({"type": "string"})]
"""Faces of a solid: the name of a set, 'all' for the boundary, or `Faces`."""


def _pairs(value: Sequence[tuple[str, str]]) -> tuple[tuple[str, str], ...]:
    for first, second in value:
        if first == second:
            raise ValueError(f"{(first, second)!r} is no pair of two sets of faces")
    return tuple((first, second) for first, second in value)


Pairs = Annotated[Sequence[tuple[str, str]], LISTED, AfterValidator(_pairs)]
"""Names of sets of faces that are taken for the same, two by two."""


def _motion(value: Any) -> Any:
    if _is_function(value):
        return value
    if isinstance(value, str) or not hasattr(value, "__len__") or len(value) != 3:
        raise ValueError(f"expected a function of (t, X), or 3 functions of time or None, not {value!r}")
    return tuple(
        None if f is None or (isinstance(f, str) and f == "free") else TimeFunction(f) for f in value
    )


def _plain_time(f: TimeFunction) -> Any:
    return [list(row) for row in f.source] if isinstance(f.source, tuple) else f.source


def _plain_motion(value: Any) -> Any:
    if callable(value):
        raise ValueError("a Python function cannot be written to a file")
    return ["free" if f is None else _plain_time(f) for f in value]


Motion = Annotated[
    Any,
    BeforeValidator(_motion),
    PlainSerializer(_plain_motion),
    WithJsonSchema(
        {
            "type": "array",
            "items": {"anyOf": [TIME_SCHEMA, {"type": "null"}]},
            "minItems": 3,
            "maxItems": 3,
        }
    ),
]
"""Displacements: a function of time and positions, or a function of time, None or 'free' for each direction."""


def _time_and_place(value: Any) -> Any:
    return value if _is_function(value) and not isinstance(value, TimeFunction) else TimeFunction(value)


def _plain_time_and_place(value: Any) -> Any:
    return _plain_number(value) if not isinstance(value, TimeFunction) else _plain_time(value)


OfTimeAndPlace = Annotated[
    Any,
    BeforeValidator(_time_and_place),
    PlainSerializer(_plain_time_and_place),
    WithJsonSchema(TIME_SCHEMA),
]
"""A number, an expression or a table of time; or a function ``f(t, X)`` of time and positions (n, 3), giving (n,)."""
