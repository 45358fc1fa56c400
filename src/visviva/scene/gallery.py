"""Studies by name: the examples of the package, with parameters given as text."""

from __future__ import annotations

import inspect
import pkgutil
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, get_type_hints

from visviva.base.arguments import refuse_other
from visviva.base.errors import InputError, nearest

if TYPE_CHECKING:
    from visviva.results.result import Result
    from visviva.study.study import Study


VARIABLE = (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)


@dataclass(frozen=True)
class Source:
    """A study with its origin: a name, the parameters that were set, and the check of its result."""

    study: Study
    name: str
    parameters: Mapping[str, Any]
    check: Callable[[Result], None] | None = None


def example_names() -> list[str]:
    """Names of all examples."""
    from visviva import examples

    return sorted(m.name for m in pkgutil.iter_modules(examples.__path__) if not m.name.startswith("_"))


def example(name: str) -> ModuleType:
    """The module of an example."""
    plain, names = name.replace("-", "_"), example_names()
    if plain not in names:
        raise InputError(f"there is no example or file {name!r}{nearest(plain, names)}")
    return import_module(f"visviva.examples.{plain}")


def first_line(module: ModuleType) -> str:
    """Summary of an example."""
    return (module.__doc__ or "").strip().split("\n")[0]


def compose_example(name: str, parameters: Mapping[str, Any]) -> Source:
    """An example with parameters, checked against the signature of its function `study`."""
    return compose_module(example(name), name, parameters)


def compose_file(file: str, parameters: Mapping[str, Any]) -> Source:
    """A user's Python file with a function `study`, with parameters like those of an example."""
    from visviva.scene.user_file import load

    return compose_module(load(file), Path(file).name, parameters)


def compose_module(module: ModuleType, name: str, parameters: Mapping[str, Any]) -> Source:
    """Study returned by the function `study` of a module."""
    from visviva.study.study import Study

    known, hints = inspect.signature(module.study).parameters, get_type_hints(module.study)
    given = {}
    for key, value in parameters.items():
        if key not in known:
            raise InputError(f"{name}: there is no parameter {key!r}{nearest(key, known)}")
        given[key] = converted(f"{name}: {key}", value, hints.get(key, Any))
    for key, parameter in known.items():
        if parameter.default is parameter.empty and parameter.kind not in VARIABLE and key not in given:
            raise InputError(f"{name}: study needs a value for {key!r}: --set {key}=VALUE")
    made = module.study(**given)
    refuse_other(name, "what study() returns", made, Study, "a vv.Study")
    return Source(made, name, given, getattr(module, "check", None))


def parameters_of(module: ModuleType) -> list[tuple[str, str, str]]:
    """Name, type and default of the parameters of a module's function `study`."""
    found = []
    for key, p in inspect.signature(module.study).parameters.items():
        if p.kind in VARIABLE:
            continue
        kind = (
            p.annotation
            if isinstance(p.annotation, str)
            else getattr(p.annotation, "__name__", str(p.annotation))
        )
        found.append(
            (key, "" if p.annotation is p.empty else kind, "" if p.default is p.empty else f"{p.default!r}")
        )
    return found


def described(module: ModuleType, name: str) -> str:
    """Summary of a model, and its parameters with their types and defaults, for ``--set``."""
    text = (module.study.__doc__ or module.__doc__ or "").strip()
    rows = [(key, kind, default) for key, kind, default in parameters_of(module)]
    if not rows:
        return f"{name}: {text}\n\nIt takes no parameters."
    width = max(len(key) for key, _, _ in rows)
    lines = [f"  {key:{width}}  {kind} = {default}" for key, kind, default in rows]
    return "\n".join([f"{name}: {text}", "", "Parameters (--set key=value):", *lines])


def converted(what: str, value: Any, kind: Any) -> Any:
    """A value as the annotated type of a parameter."""
    from pydantic import TypeAdapter, ValidationError

    from visviva.base.arguments import mistaken, plain_leaves

    if complaint := mistaken(plain_leaves(kind), value):
        raise InputError(f"{what} = {value!r}: {complaint}")
    try:
        return TypeAdapter(kind).validate_python(value)
    except ValidationError as error:
        raise InputError(f"{what} = {value!r}: {error.errors()[0]['msg']}") from None


def assignments(texts: Iterable[str]) -> dict[str, Any]:
    """Values by key from texts like ``key=value``; values are written as in YAML.

    Examples
    --------
    >>> assignments(["omega=1.5e0", "winch=locked", "axis=[0, 0, 1]"])
    {'omega': 1.5, 'winch': 'locked', 'axis': [0, 0, 1]}
    """
    given = {}
    for text in texts:
        key, equals, value = text.partition("=")
        if not equals or not key.strip():
            raise InputError(f"--set {text!r}: write it as key=value")
        given[key.strip()] = plain_value(value.strip())
    return given


def plain_value(text: str) -> Any:
    """A number, text, list or mapping from its YAML notation; 1e-3 is a number, too."""
    from visviva.scene import yaml12

    try:
        return yaml12.load(text)[0]
    except yaml12.Unreadable as error:
        raise InputError(f"cannot read the value {text[:60]!r}; write it as in YAML ({error})") from None
