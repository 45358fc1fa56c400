"""Values in words that can be compared: in records of runs, and between processes.

A value is told in one line: numbers and texts as they are, arrays, meshes and files by a digest of their bytes,
functions by a digest of their code with defaults, closure and the globals that they use, but for what they write
themselves (how often they were called). What is longer than a line becomes a digest.
"""

from __future__ import annotations

import copyreg
import dis
import sys
import sysconfig
from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import cache, singledispatchmethod
from hashlib import sha256
from pathlib import Path, PurePath
from types import BuiltinFunctionType, CodeType, FunctionType, MethodType, ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.written import own_records, written

LINE = 160  # characters; what is longer becomes a digest
FEW = 9  # numbers that are told one by one
INSTALLED = tuple(Path(sysconfig.get_path(name)).resolve() for name in ("stdlib", "purelib", "platlib"))


def arguments_of(value: Any) -> dict[str, Any]:
    """Arguments of a dataclass's constructor, as far as they count where two are compared."""
    return {f.name: getattr(value, f.name) for f in fields(value) if f.init and f.compare}


def shortened(text: str) -> str:
    """The text itself, or its begin with a digest of all of it."""
    digest = sha256(text.encode()).hexdigest()[:16]
    return text if len(text) <= LINE else f"{text[: LINE // 2]}... (digest {digest})"


class Teller:
    """Tells values in words that are equal where, and only where, the values are.

    Parameters
    ----------
    names : mapping of int to str
        What is told by name wherever it occurs, by identity.

    Attributes
    ----------
    untold : list of str
        Reasons why parts of the value are not told.
    variables : dict of str to str
        What functions within the value use of closures, globals and defaults.
    """

    def __init__(self, names: Mapping[int, str]) -> None:
        self._names = names
        self._told: dict[int, tuple[Any, str]] = {}  # with the values, so that no identity is used twice
        self.untold: list[str] = []
        self.variables: dict[str, str] = {}

    def text(self, value: Any) -> str:
        """The value in words; whole numbers look the same as ``int`` and as ``float``."""
        if isinstance(value, np.generic):
            value = value.item()
        if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
            return repr(int(value))
        if value is None or isinstance(value, bool | int | float | complex | str):
            return repr(value)
        if id(value) in self._names:
            return self._names[id(value)]
        if id(value) not in self._told:
            self._told[id(value)] = value, "..."  # should it contain itself
            self._told[id(value)] = value, self._tell(value)
        return self._told[id(value)][1]

    def _all(self, values: Any) -> str:
        return ", ".join(map(self.text, values))

    def _pairs(self, values: Mapping[Any, Any]) -> str:
        return ", ".join(f"{key}={self.text(value)}" for key, value in values.items())

    @singledispatchmethod
    def _tell(self, value: Any) -> str:
        """Any object: a dataclass by its arguments, others as they would be copied."""
        kind = self.text(type(value))
        if is_dataclass(value):
            return f"{kind}({self._pairs(arguments_of(value))})"
        try:
            parts = value.__reduce_ex__(2)
        except Exception:  # an object may refuse to be copied in any way
            self.untold.append(f"a {type(value).__name__} cannot be compared")
            return f"some {kind}"
        if isinstance(parts, str):  # a global's name
            return f"{kind}({self.text(getattr(value, '__wrapped__', parts))})"
        made_by, arguments, *state = parts
        made = "" if made_by in (type(value), copyreg.__newobj__) else f"{self.text(made_by)}, "  # type: ignore[attr-defined]
        records = set() if is_installed(type(value).__module__) else own_records(type(value))
        if state and isinstance(state[0], dict):
            state[0] = {k: v for k, v in state[0].items() if k not in records}
        given = [a for a in arguments if a is not type(value)] + [part for part in state if part]
        return f"{kind}({made}{self._all(given)})"

    @_tell.register(np.ndarray)
    def _(self, value: NDArray[Any]) -> str:
        if value.dtype.hasobject:
            return f"array({value.shape}, {self._all(value.ravel().tolist())})"
        if value.size <= FEW:
            return repr(value.tolist())
        digest = sha256(np.ascontiguousarray(value).data.cast("B")).hexdigest()[:16]
        return f"array({value.shape}, {value.dtype.str}, {digest})"

    @_tell.register(bytes)
    @_tell.register(bytearray)
    def _(self, value: bytes) -> str:
        return f"bytes({len(value)}, {sha256(value).hexdigest()[:16]})"

    @_tell.register
    def _(self, value: PurePath) -> str:
        try:
            with open(value, "rb") as file:
                digest = sha256()
                while block := file.read(1 << 20):
                    digest.update(block)
        except OSError as error:
            self.untold.append(f"{value} cannot be read: {error.strerror}")
            return f"file {value.name}"
        return f"file with digest {digest.hexdigest()[:16]}"

    @_tell.register
    def _(self, value: Enum) -> str:
        return f"{type(value).__name__}.{value.name}"

    @_tell.register(Sequence)
    def _(self, value: Sequence[Any]) -> str:
        return f"[{self._all(value)}]"

    @_tell.register(Set)
    def _(self, value: Set[Any]) -> str:
        return f"{{{', '.join(sorted(map(self.text, value)))}}}"

    @_tell.register(Mapping)
    def _(self, value: Mapping[Any, Any]) -> str:
        return "{" + ", ".join(f"{self.text(k)}: {self.text(v)}" for k, v in value.items()) + "}"

    # --- code -----------------------------------------------------------------------------------------------
    @_tell.register
    def _(self, value: ModuleType) -> str:
        return f"module {value.__name__}"

    @_tell.register
    def _(self, value: type) -> str:
        if is_installed(value.__module__):
            return value.__qualname__
        bodies = {k: v for k, v in vars(value).items() if is_written(k, v)}
        return f"{value.__qualname__}<{self._all(value.__bases__)}; {digest_of(self._pairs(bodies))}>"

    @_tell.register(property)
    @_tell.register(classmethod)
    @_tell.register(staticmethod)
    def _(self, value: Any) -> str:
        return self._all(getattr(value, name, None) for name in ("fget", "fset", "__func__"))

    @_tell.register
    def _(self, value: MethodType) -> str:
        return f"{self.text(value.__func__)} of {self.text(value.__self__)}"

    @_tell.register(np.ufunc)
    @_tell.register(BuiltinFunctionType)
    def _(self, value: Any) -> str:
        owner = getattr(value, "__self__", None)
        bound = "" if owner is None or isinstance(owner, ModuleType) else f" of {self.text(owner)}"
        return f"{getattr(value, '__module__', '')}.{value.__name__}{bound}"

    @_tell.register
    def _(self, value: FunctionType) -> str:
        name = f"{value.__module__}.{value.__qualname__}"
        if is_installed(value.__module__):
            return name
        parts = [self.text(value.__code__), self.text(value.__defaults__), self.text(value.__kwdefaults__)]
        parts += [self._variable(value, *content) for content in contents(value)]
        used = [(k, value.__globals__[k]) for k in looked_up(value.__code__) if k in value.__globals__]
        used += [item for k, v in used for item in attributes(k, v, value.__code__)]
        globals_told = ", ".join(f"{k}={self._variable(value, k, v)}" for k, v in used)
        for k, default in defaults(value):
            self.variables[f"{k} in function {value.__name__}"] = shortened(self.text(default))
        return f"function {value.__name__} with digest {digest_of(*parts, globals_told)}"

    def _variable(self, function: FunctionType, name: str, value: Any) -> str:
        """What a function uses, unless it writes there."""
        if any(name == n for n, _ in written(function.__code__)):
            return "its own"
        text = self.text(value)
        self.variables[f"{name} in function {function.__name__}"] = shortened(text)
        return text

    @_tell.register
    def _(self, value: CodeType) -> str:
        constants = self._all(value.co_consts)
        names = value.co_names, value.co_varnames, value.co_freevars, value.co_cellvars
        version = "{}.{}".format(*sys.version_info)  # code is compiled differently by the next one
        return f"Python {version} code {digest_of(value.co_code.hex(), repr(names), constants)}"


@cache
def is_installed(module: str | None) -> bool:
    """Whether a module belongs to visviva (its examples do not), to Python or to an installed package."""
    top = (module or "__main__").split(".")[0]
    if top in ("visviva", "__main__"):
        return top == "visviva" and not str(module).startswith("visviva.examples")
    file = getattr(sys.modules.get(top), "__file__", None)
    return top in sys.stdlib_module_names or (
        file is not None and any(Path(file).resolve().is_relative_to(place) for place in INSTALLED)
    )


def is_written(name: str, value: Any) -> bool:
    """Whether an attribute of a class was written by its author, rather than made for it."""
    written = isinstance(value, FunctionType | property | classmethod | staticmethod)
    plain = isinstance(value, bool | int | float | str | tuple | np.ndarray)
    return written if name in ("__init__", "__call__") else (written or plain) and not name.startswith("__")


def contents(function: FunctionType) -> Iterator[tuple[str, Any]]:
    """Names and values in a function's closure."""
    for name, cell in zip(function.__code__.co_freevars, function.__closure__ or (), strict=True):
        try:
            yield name, cell.cell_contents
        except ValueError:  # not yet assigned
            yield name, None


def defaults(function: FunctionType) -> Iterator[tuple[str, Any]]:
    """Names and values of arguments that need not be given."""
    code, given = function.__code__, function.__defaults__ or ()
    yield from zip(code.co_varnames[code.co_argcount - len(given) :], given, strict=False)
    yield from (function.__kwdefaults__ or {}).items()


def looked_up(code: CodeType) -> list[str]:
    """Names of globals that a function and those within it use."""
    inner = [name for c in code.co_consts if isinstance(c, CodeType) for name in looked_up(c)]
    own = [i.argval for i in dis.get_instructions(code) if i.opname in ("LOAD_GLOBAL", "LOAD_NAME")]
    return sorted({*own, *inner})


def attributes(
    name: str, module: Any, code: CodeType, within: tuple[Any, ...] = ()
) -> Iterator[tuple[str, Any]]:
    """What functions may use of a module that is the user's own, and of modules in it: ``module.name``."""
    if (
        any(module is m for m in within)
        or not isinstance(module, ModuleType)
        or is_installed(module.__name__)
    ):
        return
    for attribute in sorted(names_in(code) & vars(module).keys()):
        inner = vars(module)[attribute]
        yield f"{name}.{attribute}", inner
        yield from attributes(f"{name}.{attribute}", inner, code, (*within, module))


def names_in(code: CodeType) -> set[str]:
    """Names of globals and attributes of a function and those within it."""
    inner = [names_in(c) for c in code.co_consts if isinstance(c, CodeType)]
    return set(code.co_names).union(*inner)


def digest_of(*texts: str) -> str:
    """Digest of texts."""
    return sha256("\0".join(texts).encode()).hexdigest()[:16]
