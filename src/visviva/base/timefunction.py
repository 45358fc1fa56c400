"""Functions of time: numbers, expressions such as ``"2*sin(3*t)"``, tables, Python functions as one type."""

from __future__ import annotations

import ast
import bisect
import cmath
import inspect
import math
import operator
import sys
from collections.abc import Callable, Mapping, Sequence, Set
from functools import cached_property
from itertools import pairwise
from typing import Annotated, Any

from pydantic import BeforeValidator, PlainSerializer, WithJsonSchema

from visviva.base.differences import central_rate, forward_rate
from visviva.base.errors import InputError, shortened

Evaluator = Callable[[Any], complex]
Source = float | str | tuple[tuple[float, float], ...] | Callable[[float], float]

OPERATORS: dict[type[ast.AST], Callable[..., Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: lambda a, b: _power(a, b),
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
}
NAMES = {"pi": math.pi}
NOTICEABLE = 0.05
"""Part of the largest slope of a table by which the slope jumps at a kink; what was sampled finely bends by less."""
ROUNDING, ULPS = 1e-9, 1e-15
"""Parts of a step, and of a time, that two times may differ by and still be the same."""
COMPLEX = 2.0**-100
"""Length of the complex step that expressions are differentiated by."""
MAX_LENGTH, MAX_DEPTH = 10_000, 300
CURE = "give a table, or in Python a function"


def rounding(time: float, step: float) -> float:
    """By so much two times near `time` may differ and be the same: k h is not what a table calls that moment."""
    return max(ROUNDING * abs(step), ULPS * abs(time))


def _power(a: complex, b: complex) -> complex:
    whole = b.imag == 0 and b.real == round(b.real) and abs(b.real) < 100
    return a ** (int(b.real) if whole else b)


def _least(*values: complex) -> complex:
    return min(values, key=lambda z: z.real)


def _greatest(*values: complex) -> complex:
    return max(values, key=lambda z: z.real)


def _absolute(z: complex) -> complex:
    return -z if z.real < 0 else z


def _step(z: complex) -> complex:
    return 1.0 if z.real >= 0 else 0.0


def _smoothstep(z: complex) -> complex:
    x = _least(_greatest(z, 0.0), 1.0)
    return x * x * x * (10 + x * (6 * x - 15))


FUNCTIONS: dict[str, Callable[..., complex]] = {
    **{name: getattr(cmath, name) for name in ("sin", "cos", "tan", "exp", "log", "sqrt")},
    **{name: getattr(cmath, name) for name in ("sinh", "cosh", "tanh", "asin", "acos", "atan")},
    "abs": _absolute,
    "min": _least,
    "max": _greatest,
    "step": _step,
    "smoothstep": _smoothstep,
}
ARGUMENTS = {"min": range(1, 99), "max": range(1, 99)}


class TimeFunction:
    """A prescribed function of time, callable, with its `rate`.

    Parameters
    ----------
    source : float, str, list of [t, value], callable or TimeFunction
        A constant; an expression in ``t`` of numbers, ``+ - * / **``, ``pi`` and sin, cos, tan, exp, log,
        sqrt, sinh, cosh, tanh, asin, acos, atan, abs, min, max, ``step(x)`` (0 for x < 0, else 1) and
        ``smoothstep(x)`` (0 to 1 over 0 < x < 1, twice continuously differentiable); a table, linear between
        its points and constant outside; or a Python function of t.

    Raises
    ------
    InputError
        If the expression uses anything else, or the table's times do not increase.

    Examples
    --------
    >>> f = TimeFunction("2*sin(3*t)")
    >>> f(0.0), f.rate(0.0)
    (0.0, 6.0)
    >>> TimeFunction([[0, 0], [2, 10]])(0.5)
    2.5
    """

    def __init__(self, source: Any) -> None:
        if isinstance(source, bool):
            raise InputError(f"{source} is no number, expression or table of time")
        self.source: Source = source.source if isinstance(source, TimeFunction) else _plain(source)
        if callable(self.source):
            self._value: Callable[[float], float] = self._called
            self._rate: Callable[[float, float], float] = self._difference
        elif isinstance(self.source, str):
            self._expression = _compile(self.source)
            self._value, self._rate = self._evaluate, self._derivative
        elif isinstance(self.source, tuple):
            self._times = [t for t, _ in self.source]
            self._value, self._rate = self._interpolate, self._slope
        else:
            constant = self.source
            self._value, self._rate = lambda t: constant, lambda t, step: 0.0

    def __call__(self, t: float) -> float:
        """Value at time `t`."""
        return self._value(t)

    def rate(self, t: float, step: float = 0.0) -> float:
        """Rate at time `t`: exact, but of a Python function by differences of sixth order over parts of a `step`.

        Runs give the length of theirs. Without one, differences over several distances of time are compared. At a point
        of a table it is that before it, also where the time is behind it by rounding.
        """
        return self._rate(t, step)

    def __repr__(self) -> str:
        return f"TimeFunction({self.source!r})"

    def __reduce__(self) -> tuple[type[TimeFunction], tuple[Source]]:
        return TimeFunction, (self.source,)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, TimeFunction) and self.source == other.source

    def __hash__(self) -> int:
        return hash(repr(self.source))

    @cached_property
    def kinks(self) -> tuple[float, ...]:
        """Times at which its rate jumps, as far as they are known: points of a table where it bends noticeably."""
        if not isinstance(self.source, tuple):
            return ()
        slopes = [0.0, *((b - a) / (t1 - t0) for (t0, a), (t1, b) in pairwise(self.source)), 0.0]
        least = NOTICEABLE * max(map(abs, slopes))
        return tuple(t for t, (a, b) in zip(self._times, pairwise(slopes), strict=True) if abs(b - a) > least)

    def rate_after(self, t: float, step: float = 0.0) -> float:
        """Rate just after time `t`: where a function has a kink, be it behind by rounding, what it goes on with."""
        if isinstance(self.source, tuple):
            return self._piece(bisect.bisect_right(self._times, t + rounding(t, step)))[2]
        return float(forward_rate(self._value, t, step)) if callable(self.source) else self.rate(t)

    def curvature(self, t: float, step: float = 0.0) -> float:
        """Second derivative at time `t`, as steps of a length see it.

        Of a table its second difference over a step to both sides, which holds for what was sampled finely; 0 where a
        kink is as near as that, for what happens there happens at once.
        """
        if not isinstance(self.source, tuple):
            return float(central_rate(lambda s: self.rate(s, step), t, step))
        if step == 0 or any(abs(kink - t) < 1.5 * step for kink in self.kinks):
            return 0.0
        return (self(t + step) - 2 * self(t) + self(t - step)) / step**2

    # --- a Python function: rate by differences -------------------------------------------------------------
    def _called(self, t: float) -> float:
        value = self.source(t)  # type: ignore[operator]
        try:
            return float(value)
        except (TypeError, ValueError):
            raise InputError(
                f"a function of time gave {value!r} at t = {t:g}, which is no number: {self.source!r}"
            ) from None

    def _difference(self, t: float, step: float) -> float:
        return float(central_rate(self._value, t, step))

    # --- an expression: rate by a complex step, exact to round-off ------------------------------------------
    def _evaluate(self, t: float) -> float:
        value = self._at(t)
        if abs(value.imag) > 1e-12 * abs(value.real):
            raise InputError(f"{self.source!r} is not real at t = {t:g}")
        return value.real

    def _derivative(self, t: float, step: float) -> float:
        rate = self._complex_step(t, COMPLEX)
        if abs(rate) < COMPLEX and rate != self._complex_step(t, COMPLEX / 2):
            return 0.0  # what depends on the length of the step is its error: t**3 at 0 gives its square
        return rate

    def _complex_step(self, t: float, length: float) -> float:
        return self._at(complex(t, length)).imag / length

    def _at(self, t: complex) -> complex:
        try:
            return complex(self._expression(t))
        except (ArithmeticError, ValueError) as error:
            raise InputError(f"{self.source!r} cannot be evaluated at t = {t.real:g}: {error}") from None

    # --- a table --------------------------------------------------------------------------------------------
    def _piece(self, k: int) -> tuple[float, float, float]:
        """Start, value and slope of the piece that ends at the point `k`."""
        table: Any = self.source
        if k in (0, len(table)):
            return self._times[min(k, len(table) - 1)], table[min(k, len(table) - 1)][1], 0.0
        (t0, f0), (t1, f1) = table[k - 1], table[k]
        return t0, f0, (f1 - f0) / (t1 - t0)

    def _interpolate(self, t: float) -> float:
        start, value, slope = self._piece(bisect.bisect_left(self._times, t))
        return value + slope * (t - start)

    def _slope(self, t: float, step: float) -> float:
        return self._piece(bisect.bisect_left(self._times, t - rounding(t, step)))[2]


def _plain(source: Any) -> Source:
    """A source checked and turned into plain data."""
    if callable(source) and not isinstance(source, type):
        _refuse_arguments(source)
        return source  # type: ignore[no-any-return]
    if isinstance(source, str):
        return source
    if isinstance(source, Sequence) or getattr(source, "ndim", 0) > 0:
        return _table(source)
    try:
        number = float(source)
    except (TypeError, ValueError, OverflowError):
        raise InputError(
            "a function of time is a number, an expression in t, a table or a function, not "
            + shortened(repr(source))
        ) from None
    if not math.isfinite(number):
        raise InputError(f"a function of time cannot be the constant {number}")
    return number


def _refuse_arguments(function: Callable[..., Any]) -> None:
    try:
        inspect.signature(function).bind(0.0)
    except ValueError:  # written in C, and says nothing of its arguments
        pass
    except TypeError as error:
        raise InputError(
            f"a function of time is called with t alone, and {function!r} takes other arguments ({error}); functions "
            "of time and place f(t, X) stand alone, where they are taken, and not for one component"
        ) from None


def _table(source: Any) -> tuple[tuple[float, float], ...]:
    try:
        rows = tuple((float(t), float(value)) for t, value in source)
    except (TypeError, ValueError):
        raise InputError(f"a table of a function of time has rows [t, value], not {source!r}") from None
    if not rows or not all(math.isfinite(x) for row in rows for x in row):
        raise InputError(f"a table of a function of time needs finite numbers, not {rows}")
    for (t0, _), (t1, _) in pairwise(rows):
        if t1 <= t0:
            raise InputError(f"the times of a table must increase, but {t1:g} follows {t0:g}")
    return rows


class Expression:
    """An expression in any names, called with their values.

    Examples
    --------
    >>> area = Expression("a*b/2")
    >>> sorted(area.names), area({"a": 3.0, "b": 4.0})
    (['a', 'b'], 6.0)
    """

    def __init__(self, text: str) -> None:
        self.text, self._tree = text, _parsed(text)
        called = {id(n.func) for n in ast.walk(self._tree) if isinstance(n, ast.Call)}
        found = [n for n in ast.walk(self._tree) if isinstance(n, ast.Name) and id(n) not in called]
        self.names = {n.id for n in found} - set(NAMES)
        self._value = _build(self._tree, text, self.names)

    def __call__(self, values: Mapping[str, complex]) -> float:
        """Its value; numbers that are not finite or not real are errors."""
        try:
            value = complex(self._value(values))
        except KeyError as error:
            raise InputError(
                f"{error.args[0]!r} in {self.text!r} is unknown; there are {', '.join(values)}"
            ) from None
        except (ArithmeticError, ValueError) as error:
            raise InputError(f"{self.text!r} cannot be evaluated at {dict(values)}: {error}") from None
        if abs(value.imag) > 1e-12 * abs(value.real):
            raise InputError(f"{self.text!r} is not real at {dict(values)}")
        return value.real


def _compile(text: str) -> Evaluator:
    """An expression in t as nested functions; whatever is not listed above is refused."""
    return _build(_parsed(text), text)


def _parsed(text: str) -> ast.expr:
    if len(text) > MAX_LENGTH:
        raise InputError(
            f"the expression {text[:40]!r}... has {len(text)} characters, more than {MAX_LENGTH}: {CURE}"
        )
    try:
        tree = ast.parse(text.strip(), mode="eval").body
    except SyntaxError as error:
        raise InputError(f"{text!r} is not an expression: {error.msg}") from None
    except (ValueError, RecursionError, MemoryError) as error:  # NUL, or too deep for Python's parser
        raise InputError(
            f"{text!r} is not an expression: {str(error) or 'it is nested too deeply'}"
        ) from None
    if _depth(tree) > MAX_DEPTH:
        raise InputError(f"the expression {text[:40]!r}... is more than {MAX_DEPTH} operations deep: {CURE}")
    return tree


def _depth(tree: ast.AST) -> int:
    """Depth of nested operations; a sum of n terms is n deep."""
    level, depth = [tree], 0
    while level:
        level, depth = [child for node in level for child in ast.iter_child_nodes(node)], depth + 1
    return depth


def _build(node: ast.AST, text: str, names: Set[str] = frozenset()) -> Evaluator:
    """A function of t, or of the values of `names` if there are any."""
    match node:
        case ast.Constant(value=bool()):
            pass
        case ast.Constant(value=int() | float() as constant):
            number = float(constant) if abs(constant) <= sys.float_info.max else math.inf
            if number == math.inf:
                raise InputError(f"a number in {text!r} is too large")
            return lambda t: number
        case ast.Name(id=name) if name in names:
            return lambda values: values[name]
        case ast.Name(id="t") if not names:
            return lambda t: t
        case ast.Name(id=name) if name in NAMES:
            return lambda t: NAMES[name]
        case ast.UnaryOp(op=op, operand=operand) if type(op) in OPERATORS:
            unary, inner = OPERATORS[type(op)], _build(operand, text, names)
            return lambda t: unary(inner(t))
        case ast.BinOp(left=left, op=op, right=right) if type(op) in OPERATORS:
            binary, a, b = OPERATORS[type(op)], _build(left, text, names), _build(right, text, names)
            return lambda t: binary(a(t), b(t))
        case ast.Call(func=ast.Name(id=name), args=args, keywords=[]) if name in FUNCTIONS:
            return _call(name, args, text, names)
    used = ast.unparse(node)
    known = ", ".join([*(names or ["t"]), *NAMES, *FUNCTIONS])
    raise InputError(
        f"{used!r} in {text!r} is not understood; an expression may use numbers, + - * / **, {known}"
    )


def _call(name: str, args: list[ast.expr], text: str, names: Set[str]) -> Evaluator:
    if len(args) not in ARGUMENTS.get(name, (1,)):
        raise InputError(f"{name} in {text!r} takes one argument, not {len(args)}")
    function, inner = FUNCTIONS[name], [_build(a, text, names) for a in args]
    return lambda t: function(*(f(t) for f in inner))


def _serialize(function: TimeFunction | None) -> Any:
    if function is None or not callable(function.source):
        return None if function is None else function.source
    raise ValueError("a Python function cannot be written to a file; use an expression such as '2*sin(3*t)'")


TIME_SCHEMA: dict[str, Any] = {
    "anyOf": [
        {"type": "number"},
        {"type": "string", "description": "expression in t, e.g. 2*sin(3*t)"},
        {
            "type": "array",
            "description": "rows [t, value]",
            "items": {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2},
        },
    ]
}
OfTime = Annotated[
    Any, BeforeValidator(TimeFunction), PlainSerializer(_serialize), WithJsonSchema(TIME_SCHEMA)
]
"""Argument of constructors that takes what `TimeFunction` takes."""
