"""The language of scene files: the public constructors of visviva, found by looking, not by registration."""

from __future__ import annotations

import dataclasses
import types
import typing
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import visviva
from visviva.body.section import Section
from visviva.body.shape import Shape
from visviva.body.shell_section import Layer
from visviva.component.component import Component
from visviva.joint.joint import Joint
from visviva.linear.choice import LinearOptions
from visviva.material.branch import Branch, Shift
from visviva.material.material import Material
from visviva.measure.measures import Reading
from visviva.mesh.generate import MeshSource
from visviva.mesh.spline import SplineSource
from visviva.phase.free_energy import FreeEnergy
from visviva.phase.mobility import Mobility
from visviva.scheme.schemes import Scheme
from visviva.thermal.heat import HeatLaw

T = TypeVar("T")

STUDY = ("probes", "trails", "fields", "moments", "movie", "pictures", "units")
TOP_LEVEL = ("title", "notes", "system", "newton", "run", *STUDY)
RUN = ("until", "step", "scheme", "adaptive")
ATTACHMENTS: dict[str, tuple[str, ...]] = {
    "point": ("X",),
    "point_at": ("x",),
    "frame": ("X", "axes"),
    "frame_at": ("x", "axis", "first"),
}
"""Methods of components that give points and frames, with their arguments."""


CHOICES: dict[str, type[Any]] = {
    "shape": Shape,
    "mesh": MeshSource,
    "splines": SplineSource,
    "material": Material,
    "branch": Branch,
    "shift": Shift,
    "section": Section,
    "layer": Layer,
    "heat": HeatLaw,
    "free energy": FreeEnergy,
    "mobility": Mobility,
    "linear": LinearOptions,
}
"""Kinds of values among which an argument chooses, by their names in the schema."""


BASES = (Joint,)
"""Public classes that users derive their own from, and nobody makes."""


@cache
def classes() -> tuple[tuple[str, type[Any]], ...]:
    """All public classes of visviva with their names."""
    found = ((name, getattr(visviva, name)) for name in visviva.__all__)
    return tuple((name, item) for name, item in found if isinstance(item, type))


def public(base: type[T]) -> dict[str, type[T]]:
    """Public classes of visviva derived from `base`, by name.

    Examples
    --------
    >>> "RigidBody" in public(Component), "Component" in public(Component)
    (True, False)
    """
    return {name: cls for name, cls in classes() if issubclass(cls, base) and cls not in (base, *BASES)}


@cache
def components() -> dict[str, type[Component]]:
    """Constructors of components of a system."""
    return public(Component)


@cache
def values() -> dict[str, type[Any]]:
    """Constructors of arguments: shapes, meshes, materials, sections, options of solvers, measures, probes."""
    choices = {name: cls for base in CHOICES.values() for name, cls in public(base).items()}
    return {**choices, **public(Reading)}


@cache
def probes() -> dict[str, type[Any]]:
    """Constructors of probes."""
    return public(Reading)


@cache
def schemes() -> dict[str, type[Scheme]]:
    """Time integration schemes."""
    return public(Scheme)


PERMISSIONS = ("trust", "within")
"""Arguments that a file must not give itself: who reads it does."""


def arguments(cls: type[Any]) -> dict[str, Any]:
    """Arguments that a file gives a constructor, with their types; the name of a component is its key."""
    hints = typing.get_type_hints(cls, include_extras=True)
    names = [f.name for f in dataclasses.fields(cls) if f.init]
    other = ("name", *PERMISSIONS) if issubclass(cls, Component) else PERMISSIONS
    return {n: hints[n] for n in names if n not in other}


def leaves(hint: Any) -> list[Any]:
    """The types that a union or list is made of; annotated types stay whole."""
    if typing.get_origin(hint) in (typing.Union, types.UnionType, list, tuple):
        return [leaf for part in typing.get_args(hint) for leaf in leaves(part)]
    return [hint]


def is_reference(hint: Any) -> bool:
    """Whether an argument of this type is a component, a point, a frame or a measure."""
    return any(
        leaf is Any or (isinstance(leaf, type) and issubclass(leaf, Component)) for leaf in leaves(hint)
    )


def named(hint: Any) -> Any:
    """The type of the values of an argument that is a mapping from names; None for other arguments."""
    return typing.get_args(hint)[1] if typing.get_origin(hint) is dict else None


def is_boolean(hint: Any) -> bool:
    """Whether an argument of this type is true or false."""
    return bool in leaves(hint)


def is_path(hint: Any) -> bool:
    """Whether an argument of this type is a file."""
    return Path in leaves(hint)
