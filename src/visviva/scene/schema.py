"""JSON Schema of scene files, made from the constructors themselves."""

from __future__ import annotations

import dataclasses
import inspect
import types
import typing
from collections.abc import Mapping
from typing import Any

from pydantic import TypeAdapter

from visviva.analysis.adaptive import Adaptive
from visviva.component.component import settings
from visviva.component.values import VECTOR_SCHEMA
from visviva.output.pictures import Pictures
from visviva.scene import language
from visviva.system.newton import Newton

Schema = dict[str, Any]

TEXT: Schema = {"type": "string"}
POSITIVE: Schema = {"type": "number", "exclusiveMinimum": 0}
AXES: Schema = {"type": "array", "items": VECTOR_SCHEMA, "minItems": 3, "maxItems": 3}


def scene_schema() -> Schema:
    """JSON Schema (draft 2020-12) of scene files.

    Examples
    --------
    >>> schema = scene_schema()
    >>> schema["$defs"]["RigidBody"]["properties"]["mass"]
    {'type': 'number'}
    """
    components, values, probes = language.components(), language.values(), language.probes()
    classes: dict[str, type[Any]] = {
        **components,
        **values,
        **probes,
        **language.schemes(),
        "Newton": Newton,
        "Adaptive": Adaptive,
        "Pictures": Pictures,
    }
    definitions = {name: constructor(cls) for name, cls in classes.items()}
    definitions |= {
        "component": one_of(components),
        "probe": one_of(probes),
        "scheme": one_of(language.schemes()),
    }
    definitions |= {name: one_of(language.public(base)) for name, base in language.CHOICES.items()}
    definitions |= {"reference": reference()}
    run = {
        "until": POSITIVE,
        "step": POSITIVE,
        "scheme": {"$ref": "#/$defs/scheme"},
        "adaptive": ref("Adaptive"),
    }
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "visviva scene",
        **closed(
            {
                "title": TEXT,
                "notes": TEXT,
                "system": {"type": "object", "minProperties": 1, "additionalProperties": ref("component")},
                "newton": ref("Newton"),
                "run": closed(run, required=["until", "step"]),
                "probes": {"type": "object", "additionalProperties": ref("probe")},
                "trails": {"type": "array", "items": TEXT},
                "fields": {"type": "array", "items": TEXT},
                "moments": {"type": "array", "items": {"type": "number"}},
                "movie": {"type": "boolean"},
                "pictures": ref("Pictures"),
                "units": {"anyOf": [TEXT, {"type": "object", "additionalProperties": TEXT}]},
            },
            required=["system", "run"],
        ),
        "$defs": definitions,
    }


def ref(name: str) -> Schema:
    """Reference to a definition."""
    return {"$ref": f"#/$defs/{name}"}


def closed(properties: Mapping[str, Schema], required: list[str] | None = None) -> Schema:
    """An object with these keys and no others."""
    schema: Schema = {"type": "object", "properties": dict(properties), "additionalProperties": False}
    return schema | ({"required": required} if required else {})


def one_of(classes: Mapping[str, Any]) -> Schema:
    """``{Class: arguments}``, or the bare name of a class that needs none."""
    bare = [name for name, cls in classes.items() if not needed(cls)]
    single = closed({name: {"anyOf": [ref(name), {"type": "null"}]} for name in classes})
    single |= {"minProperties": 1, "maxProperties": 1}
    return {"anyOf": [{"enum": bare}, single]} if bare else single


def needed(cls: type[Any]) -> list[str]:
    """Arguments of a constructor without a default."""
    parameters = inspect.signature(cls).parameters.values()
    return [p.name for p in parameters if p.default is p.empty and p.kind is not p.VAR_KEYWORD]


def reference() -> Schema:
    """The name of a component, a point or frame of it, a measure, or a list of these."""
    shapes = {
        "X": VECTOR_SCHEMA,
        "x": VECTOR_SCHEMA,
        "axis": VECTOR_SCHEMA,
        "first": VECTOR_SCHEMA,
        "axes": AXES,
    }
    attached = [
        closed({method: TEXT} | {n: shapes[n] for n in names}, [method] + ["x"] * method.endswith("_at"))
        for method, names in language.ATTACHMENTS.items()
    ]
    several = {"type": "array", "items": ref("reference")}
    return {"anyOf": [TEXT, *attached, one_of(language.values()), several]}


def constructor(cls: type[Any]) -> Schema:
    """The arguments of a constructor."""
    hints = language.arguments(cls)
    schema = closed({name: argument(hint) for name, hint in hints.items()}, needed(cls))
    documentation = inspect.getdoc(cls)
    if documentation and not documentation.startswith(f"{cls.__name__}("):
        schema["description"] = documentation.split("\n\n")[0].replace("\n", " ")
    defaults = {f.name: f.default for f in dataclasses.fields(cls) if f.default is not dataclasses.MISSING}
    for name, default in defaults.items():
        if name in hints and isinstance(default, bool | int | float | str):
            schema["properties"][name] |= {"default": default}
    return schema


def argument(hint: Any) -> Schema:
    """A value of an argument."""
    if language.is_reference(hint):
        return ref("reference")
    if language.named(hint):
        return {"type": "object", "additionalProperties": ref("reference")}
    leaves = [leaf for leaf in language.leaves(hint) if leaf is not types.NoneType]
    for name, base in language.CHOICES.items():
        if any(isinstance(leaf, type) and issubclass(leaf, base) for leaf in leaves):
            return ref(name)
    if language.is_path(hint):
        return dict(TEXT)
    parts = typing.get_args(hint)
    if typing.get_origin(hint) in (typing.Union, types.UnionType):
        hints = [part for part in parts if part is not types.NoneType]
        schemas = [plain(part) for part in hints]
        return schemas[0] if len(schemas) == 1 else {"anyOf": schemas}
    return plain(hint)


def plain(hint: Any) -> Schema:
    """Schema of plain data, from pydantic; types that no file can hold match nothing."""
    leaves = language.leaves(hint)
    if any(isinstance(leaf, type) and leaf.__module__.startswith("visviva") for leaf in leaves):
        return {
            "not": {},
            "description": f"{leaves[0].__name__}: an object of Python; not possible in a file",
        }
    return TypeAdapter(hint, config=settings).json_schema()
