"""Types of constructor arguments: validated on entry, plain data in scene files, described in JSON Schema."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, FiniteFloat, PlainSerializer, WithJsonSchema

Array = NDArray[np.float64]

NUMBER = {"type": "number"}


def _array(value: Any) -> Array:
    try:
        a = np.array(value, dtype=float)
    except (TypeError, ValueError):
        raise ValueError(f"expected numbers, not {value!r}") from None
    if not np.isfinite(a).all():
        raise ValueError(f"expected finite numbers, not {np.asarray(value).tolist()}")
    return a


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


def _function(value: Any) -> Any:
    if not callable(value):
        raise ValueError(f"expected a Python function, not {value!r}")
    return value


def _vector_or_function(value: Any) -> Any:
    return value if callable(value) else _vector(value)


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
