"""From scene files to studies: every key is an argument of a constructor, validated by that constructor."""

from __future__ import annotations

import ast
import inspect
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field, TypeAdapter, ValidationError

from visviva.analysis.adaptive import Adaptive
from visviva.base.arguments import ArgumentError, mistaken, plain_leaves, refuse_other, told
from visviva.base.errors import InputError, nearest
from visviva.base.unit_labels import Units
from visviva.component.component import Component
from visviva.component.point import Attachable
from visviva.mesh.source_files import refuse_outside
from visviva.output.pictures import Pictures
from visviva.scene import language
from visviva.scene.gallery import Source, plain_value
from visviva.scene.text import Document, parse
from visviva.scene.yaml12 import Key
from visviva.scheme.schemes import Scheme
from visviva.system.newton import Newton
from visviva.system.system import System

if TYPE_CHECKING:
    from visviva.study.study import Study

WORDS = ("yes", "no", "on", "off", "y", "n", "t", "f", "true", "false")
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]


def read_scene(
    file: str | Path,
    changes: Mapping[str, Any] | None = None,
    *,
    trust: bool = False,
    allow_outside: bool = False,
) -> Study:
    """Compose the study that a scene file describes.

    Parameters
    ----------
    file : path
        YAML, or TOML if it ends with ``.toml``.
    changes : mapping
        Values by dotted key that replace those of the file, e.g. ``{"girder.mass": 90.0, "run.step": 0.01}``;
        components are found by their names.
    trust : bool
        Run the meshing scripts that the scene names (``.geo`` of Gmsh), which can run any command of the system.
    allow_outside : bool
        Read files that the scene names also where they are not in its folder.

    Raises
    ------
    InputError
        With file, line, key and the nearest valid name, if anything in it is not understood.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> file = pathlib.Path(tempfile.mkdtemp()) / "drop.yaml"
    >>> _ = file.write_text('''
    ... system:
    ...   ball: {PointMass: {mass: 2.0, position: [0, 0, 1]}}
    ...   gravity: {Gravity: {acceleration: [0, 0, -10]}}
    ... run: {until: 1.0, step: 0.1}
    ... ''')
    >>> study = read_scene(file)
    >>> study.system.components[0].mass, study.until
    (2.0, 1.0)
    """
    from visviva.measure.names import USUAL
    from visviva.study.study import Study

    if not isinstance(file, str | Path):
        raise InputError(f"read_scene: file is the path of a scene file, not {file!r}")
    refuse_other("read_scene", "changes", changes, Mapping | None, "a mapping from keys to values")
    document = parse(file)
    if not isinstance(document.data, dict):
        raise document.error((), f"a scene is a mapping of {', '.join(language.TOP_LEVEL)}")
    for key, value in (changes or {}).items():
        change(document, key, value)
    data = document.data
    known_keys(document, (), data, language.TOP_LEVEL)
    reader = Reader(document, trust=trust, allow_outside=allow_outside)
    system = reader.system()
    run = data.get("run")
    if not isinstance(run, dict):
        raise document.error(("run",), "is missing: give run: {until: END, step: LENGTH}")
    known_keys(document, ("run",), run, language.RUN)
    return Study(
        system,
        until=reader.value(("run", "until"), run.get("until"), Positive),
        step=reader.value(("run", "step"), run.get("step"), Positive),
        scheme=reader.scheme(("run", "scheme"), run.get("scheme", "EnergyMomentum")),
        adaptive=reader.construct(("run", "adaptive"), Adaptive, run["adaptive"])
        if "adaptive" in run
        else None,
        probes=reader.probes(),
        trails=tuple(reader.value(("trails",), data.get("trails", []), list[str])),
        fields=tuple(reader.value(("fields",), data.get("fields", list(USUAL)), list[str])),
        moments=tuple(reader.value(("moments",), data.get("moments", []), list[float])),
        movie=reader.value(("movie",), data.get("movie", False), bool),
        pictures=reader.construct(("pictures",), Pictures, data.get("pictures", {})),
        title=reader.value(("title",), data.get("title", Path(file).stem), str),
        notes=reader.value(("notes",), data.get("notes", ""), str),
        units=reader.units(data.get("probes") or {}),
    )


def compose_scene(file: str, changes: Mapping[str, Any], **allowed: bool) -> Source:
    """A scene file as a source of a run, with what `read_scene` takes to be allowed."""
    return Source(read_scene(file, changes, **allowed), Path(file).name, dict(changes))


def scheme_of_text(text: str) -> Scheme:
    """A scheme from its name, with arguments as in Python if it takes any.

    Examples
    --------
    >>> scheme_of_text("GeneralizedAlpha(rho=0.8)")
    GeneralizedAlpha(rho=0.8)
    """
    try:
        found = ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        found = None
    match found:
        case ast.Name(id=name):
            keywords: list[ast.keyword] = []
        case ast.Call(func=ast.Name(id=name), args=[], keywords=keywords):
            pass
        case _:
            raise InputError(f"--scheme {text!r}: write it as NAME or NAME(key=value)")
    plain = {k.arg or "**": plain_value(ast.unparse(k.value)) for k in keywords}
    if len(plain) < len(keywords):
        raise InputError(f"--scheme {text!r}: an argument is given twice")
    return Reader(Document(Path("--scheme"), {})).scheme((), {name: plain})


def known_keys(document: Document, key: Key, data: Mapping[str, Any], known: Iterable[str]) -> None:
    """Refuse keys that mean nothing."""
    for name in data:
        if name not in known:
            raise document.error((*key, name), f"unknown key{nearest(name, known)}")


def change(document: Document, dotted: str, value: Any) -> None:
    """Replace a value by its dotted key; class names between need not be written."""
    parts = dotted.split(".")
    system = document.data.get("system")
    if parts[0] not in language.TOP_LEVEL and isinstance(system, dict):
        if parts[0] not in system:
            known = [*language.TOP_LEVEL, *system]
            raise document.error((), f"there is nothing called {parts[0]!r}{nearest(parts[0], known)}")
        parts = ["system", *parts]
    at: Any = document.data
    for part in parts[:-1]:
        at = inside(at, part)
        if isinstance(at, list) and part.isdigit() and int(part) < len(at):
            at = at[int(part)]
        elif isinstance(at, dict):
            if at.get(part) is None:
                at[part] = {}
            at = at[part]
        else:
            raise document.error((), f"{dotted} leads nowhere at {part!r}")
    at, last = inside(at, parts[-1]), parts[-1]
    if isinstance(at, list) and last.isdigit() and int(last) < len(at):
        at[int(last)] = value
    elif isinstance(at, dict):
        at[last] = value
    else:
        raise document.error((), f"{dotted} leads nowhere at {last!r}")


def inside(data: Any, part: str) -> Any:
    """The arguments of a constructor, unless the class itself is meant."""
    if isinstance(data, dict) and len(data) == 1 and part not in data:
        ((name, arguments),) = data.items()
        if name[:1].isupper() and isinstance(arguments, dict | None):
            if arguments is None:
                data[name] = arguments = {}
            return arguments
    return data


class Reader:
    """Builds the objects of one document."""

    def __init__(self, document: Document, *, trust: bool = False, allow_outside: bool = False) -> None:
        self.document = document
        self.folder = document.file.parent
        self.within = None if allow_outside else self.folder
        self.permissions = {"trust": trust, "within": self.within}
        self._made: dict[str, Component] = {}
        self._making: list[str] = []

    # --- the sections ---------------------------------------------------------------------------------------
    def system(self) -> System:
        """All components, in the order of the file."""
        data = self.document.data
        self._described = data.get("system")
        if not isinstance(self._described, dict) or not self._described:
            raise self.document.error(("system",), "is missing: give components by name")
        parts = [self.component(name, ("system", name)) for name in self._described]
        newton = self.construct(("newton",), Newton, {} if data.get("newton") is None else data["newton"])
        try:
            return System(parts, newton)
        except InputError as error:
            raise self.document.error(("system",), str(error)) from None

    def units(self, probes: Iterable[str]) -> Any:
        """Names of units: a text, or names by quantity or probe."""
        given = self.value(("units",), self.document.data.get("units"), str | dict[str, str] | None)
        try:
            Units.of(given).refuse_unknown(probes)
        except InputError as error:
            raise self.document.error(("units",), str(error)) from None
        return given

    def probes(self) -> dict[str, Any]:
        """Probes of the scene."""
        data = self.document.data.get("probes")
        if data is None:
            return {}
        if not isinstance(data, dict):
            raise self.document.error(("probes",), f"expected probes by name, not {data!r}")
        return {
            name: self.instance(("probes", name), given, language.probes()) for name, given in data.items()
        }

    def scheme(self, key: Key, given: Any) -> Scheme:
        """A scheme from its name, or its name with arguments."""
        scheme: Scheme = self.instance(key, given, language.schemes())
        return scheme

    # --- objects --------------------------------------------------------------------------------------------
    def component(self, name: str, key: Key) -> Component:
        """A component by its name; made with what it refers to when it is first asked for."""
        if name in self._made:
            return self._made[name]
        if name not in self._described:
            raise self.document.error(key, f"there is no component {name!r}{nearest(name, self._described)}")
        if name in self._making:
            raise self.document.error(key, f"refers to itself by way of {' -> '.join([*self._making, name])}")
        self._making.append(name)
        known = language.components()
        made: Component = self.instance(("system", name), self._described[name], known, name=name)
        self._making.pop()
        self._made[name] = made
        return made

    def instance(self, key: Key, given: Any, known: Mapping[str, type[Any]], **more: Any) -> Any:
        """An object from ``Class`` or ``{Class: {argument: value}}``."""
        if isinstance(given, str):
            given = {given: {}}
        if not isinstance(given, dict) or len(given) != 1:
            raise self.document.error(key, f"expected {{Class: {{argument: value}}}}, not {given!r}")
        ((name, arguments),) = given.items()
        if name not in known:
            raise self.document.error((*key, name), f"there is no class {name!r}{nearest(name, known)}")
        return self.construct((*key, name), known[name], {} if arguments is None else arguments, **more)

    def construct(self, key: Key, cls: type[Any], given: Any, **more: Any) -> Any:
        """Call a constructor with arguments from the file."""
        if not isinstance(given, dict):
            raise self.document.error(key, f"expected arguments by name, not {given!r}")
        hints = language.arguments(cls)
        known_keys(self.document, key, given, hints)
        arguments = {n: self.argument((*key, n), value, hints[n]) for n, value in given.items()}
        more |= {n: self.permissions[n] for n in inspect.signature(cls).parameters if n in self.permissions}
        missing = [
            n for n, p in inspect.signature(cls).parameters.items() if p.default is p.empty and n not in given
        ]
        if missing:
            raise self.document.error(key, f"needs the key {missing[0]!r}")
        try:
            return cls(**arguments, **more)
        except ArgumentError as error:
            raise self.document.error((*key, *error.where), error.complaint) from None
        except InputError as error:
            raise self.document.error(key, str(error)) from None

    def value(self, key: Key, given: Any, kind: Any) -> Any:
        """A plain value of a given type."""
        if complaint := mistaken(plain_leaves(kind), given):
            raise self.document.error(key, complaint)
        try:
            return TypeAdapter(kind).validate_python(given)
        except ValidationError as error:
            where, message = told(error)
            raise self.document.error((*key, *where), message) from None

    # --- arguments ------------------------------------------------------------------------------------------
    def argument(self, key: Key, given: Any, hint: Any) -> Any:
        """A value of a constructor's argument: plain data, another constructor, or a reference."""
        if language.is_reference(hint):
            return self.reference(key, given)
        if language.named(hint) and isinstance(given, dict):
            return {name: self.reference((*key, name), item) for name, item in given.items()}
        if language.is_path(hint) and isinstance(given, str):
            return self.path(key, given)
        if isinstance(given, dict):
            return self.instance(key, given, language.values())
        if isinstance(given, list) and given and all(isinstance(item, dict) for item in given):
            return [self.instance((*key, k), item, language.values()) for k, item in enumerate(given)]
        if isinstance(given, str) and given.lower() in WORDS and language.is_boolean(hint):
            raise self.document.error(
                key, f"write true or false, not {given!r}: those alone are Booleans here"
            )
        return given

    def path(self, key: Key, given: str) -> Path:
        """A file by its path relative to the scene."""
        try:
            refuse_outside(self.folder / given, self.within)
        except InputError as error:
            raise self.document.error(key, str(error)) from None
        return self.folder / given

    def reference(self, key: Key, given: Any) -> Any:
        """A component by name, a point or frame of it, a measure, or a list of these."""
        if isinstance(given, str):
            return self.component(given, key)
        if isinstance(given, list):
            return [self.reference((*key, k), item) for k, item in enumerate(given)]
        if isinstance(given, dict):
            methods = [m for m in language.ATTACHMENTS if m in given]
            if methods:
                return self.attachment(key, methods[0], given)
            if len(given) == 1:
                known = language.values()
                ((name, _),) = given.items()
                if name not in known:
                    raise self.document.error(
                        (*key, name),
                        f"there is no such thing{nearest(name, [*language.ATTACHMENTS, *known])}",
                    )
                return self.instance(key, given, known)
        expected = "the name of a component, or e.g. {point: NAME, X: [0, 0, 0]}"
        raise self.document.error(key, f"expected {expected}, not {given!r}")

    def attachment(self, key: Key, method: str, given: dict[str, Any]) -> Any:
        """A point or frame: ``{method: NAME, argument: value}``."""
        known_keys(self.document, key, given, (method, *language.ATTACHMENTS[method]))
        name = given[method]
        if not isinstance(name, str):
            raise self.document.error((*key, method), f"expected the name of a component, not {name!r}")
        component = self.component(name, (*key, method))
        if not isinstance(component, Attachable):
            raise self.document.error((*key, method), f"nothing can be attached to {component.label}")
        arguments = {n: given[n] for n in language.ATTACHMENTS[method] if n in given}
        for n, value in arguments.items():
            self.numbers((*key, n), value, (3, 3) if n == "axes" else (3,))
        if method.endswith("_at") and "x" not in given:
            raise self.document.error(key, "needs the key 'x'")
        try:
            return getattr(component, method)(**arguments)
        except InputError as error:
            raise self.document.error(key, str(error)) from None

    def numbers(self, key: Key, given: Any, shape: tuple[int, ...]) -> None:
        """Refuse what is not an array of finite numbers of this shape."""
        import numpy as np

        try:
            found = np.array(given, dtype=float)
        except (TypeError, ValueError):
            raise self.document.error(key, f"expected numbers, not {given!r}") from None
        if found.shape != shape or not np.isfinite(found).all():
            wanted = "3 finite numbers" if shape == (3,) else "3 rows of 3 finite numbers"
            raise self.document.error(key, f"expected {wanted}, not {given!r}")
