"""From systems and studies to scene files."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from visviva.base.errors import InputError
from visviva.base.timefunction import TimeFunction
from visviva.component.component import Component
from visviva.component.point import Frame, Point
from visviva.component.values import AtPlace, OfPlace
from visviva.measure.measures import Reading
from visviva.mesh.mesh import Mesh
from visviva.output.safe_files import replacing, reporting
from visviva.scene import language
from visviva.scheme.schemes import Scheme
from visviva.system.newton import Newton
from visviva.system.system import System

if TYPE_CHECKING:
    from visviva.study.study import Study


def write_scene(what: Study | System, file: str | Path, *, until: float = 1.0, step: float = 0.01) -> None:
    """Write a study or a system as a scene file, from which the same bits march.

    Parameters
    ----------
    what : Study or System
        As composed: what is written are the arguments of the constructors, not the present state.
    file : path
        YAML, or TOML if it ends with ``.toml``.
    until, step : float
        For a bare system, what the file says about its run.

    Raises
    ------
    InputError
        If something in it is a Python function or object that no file can hold, by name.

    Examples
    --------
    >>> import tempfile, visviva as vv
    >>> from visviva.scene import read_scene
    >>> file = tempfile.mkdtemp() + "/ball.yaml"
    >>> write_scene(vv.System([vv.PointMass(mass=2.0, velocity=(1, 0, 0), name="ball")]), file)
    >>> read_scene(file).system.components[0].velocity.tolist()
    [1.0, 0.0, 0.0]
    """
    path = Path(file)
    data = of_system(what, until, step) if isinstance(what, System) else of_study(what)
    text = toml(data) if path.suffix == ".toml" else yaml_text(data)
    with reporting(path), replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def of_study(study: Study) -> dict[str, Any]:
    """A study as plain data."""
    from visviva.measure.names import USUAL

    data = {"title": study.title, "notes": study.notes} | of_system(study.system, study.until, study.step)
    data["run"]["scheme"] = value("scheme", study.scheme)
    if study.adaptive:
        data["run"]["adaptive"] = given("adaptive", study.adaptive)
    data["probes"] = {}
    for name, probe in study.probes.items():
        if not isinstance(probe, Reading):
            raise InputError(
                f"probe {name!r} is a form or a function of Python, which no file can hold; use a measure "
                "such as vv.Position(of=...), vv.JointCoordinate(joint=...), or vv.ReactionForce(joint=...)"
            )
        data["probes"][name] = value(f"probe {name}", probe)
    data |= {"trails": list(study.trails), "moments": [float(t) for t in study.moments], "movie": study.movie}
    data["pictures"] = given("pictures", study.pictures)
    fields = {} if tuple(study.fields) == USUAL else {"fields": list(study.fields)}
    data["units"] = study.units if isinstance(study.units, str) else dict(study.system.units.names)
    return {key: item for key, item in data.items() if item} | fields


def of_system(system: System, until: float, step: float) -> dict[str, Any]:
    """A system as plain data."""
    data: dict[str, Any] = {}
    data["system"] = {str(c.name): described(c.label, c, language.components()) for c in system.components}
    if system.newton != Newton():
        data["newton"] = given(f"{Newton.__name__}", system.newton)
    data["run"] = {"until": float(until), "step": float(step)}
    return data


def described(label: str, thing: Any, known: Mapping[str, type[Any]]) -> dict[str, Any]:
    """``{Class: arguments}`` of an object of a public class."""
    name = type(thing).__name__
    if known.get(name) is not type(thing):
        raise InputError(f"{label}: the class {name} is not part of visviva, so no file can name it")
    return {name: given(label, thing)}


def given(label: str, thing: Any) -> dict[str, Any]:
    """Arguments of an object that differ from their defaults."""
    found = {}
    defaults = {f.name: f.default for f in dataclasses.fields(thing)}
    for name in language.arguments(type(thing)):
        item = value(f"{label}: {name}", getattr(thing, name))
        if item is not None and item != value(name, defaults[name]):
            found[name] = item
    return found


def value(label: str, item: Any) -> Any:
    """Plain data for an argument."""
    if item is None or item is dataclasses.MISSING:
        return None
    if isinstance(item, Component):
        return item.name
    if isinstance(item, Frame):
        return {"frame": item.component.name, "X": item.X.tolist(), "axes": item.axes.tolist()}
    if isinstance(item, Point):
        return {"point": item.component.name, "X": item.X.tolist()}
    if isinstance(item, Scheme):
        arguments = given(label, item)
        return {type(item).__name__: arguments} if arguments else type(item).__name__
    if isinstance(item, (*language.CHOICES.values(), Reading)):
        return described(label, item, {**language.values(), **language.probes()})
    return plain(label, item.source if isinstance(item, TimeFunction | AtPlace | OfPlace) else item)


def plain(label: str, item: Any) -> Any:
    """Numbers, texts, lists and paths."""
    if isinstance(item, np.ndarray | np.generic):
        return item.tolist()
    if isinstance(item, dict):
        return {name: value(f"{label}: {name}", part) for name, part in item.items()}
    if isinstance(item, list | tuple):  # TOML knows no null: a direction without prescribed motion is 'free'
        return ["free" if part is None else value(label, part) for part in item]
    if isinstance(item, Path):
        return str(item.absolute())
    if isinstance(item, bool | int | float | str):
        return item
    cure = "; write it to a file and give vv.MeshFile(path=...)" if isinstance(item, Mesh) else ""
    raise InputError(f"{label} is {item!r}, an object of Python, which no file can hold{cure}")


# --- notations ----------------------------------------------------------------------------------------------
def yaml_text(data: Mapping[str, Any]) -> str:
    """YAML, one line per short list or mapping."""
    import yaml

    from visviva.scene.yaml12 import plain

    class Dumper(yaml.SafeDumper):
        pass

    def text(dumper: yaml.SafeDumper, item: str) -> yaml.ScalarNode:
        style = None if plain(item) is item else '"'  # PyYAML knows YAML 1.1, where 1e3 is a text
        return dumper.represent_scalar("tag:yaml.org,2002:str", item, style=style)

    Dumper.add_representer(str, text)
    return yaml.dump(
        data, None, Dumper, sort_keys=False, default_flow_style=None, width=110, allow_unicode=True
    )


def toml(data: Mapping[str, Any]) -> str:
    """TOML: a table for every component and probe, what is inside them inline."""
    tops = [f"{quoted(key)} = {inline(item)}" for key, item in data.items() if not isinstance(item, dict)]
    sections = {key: item for key, item in data.items() if isinstance(item, dict)}
    blocks = [f"[{key}]\n" + "\n".join(pairs(item)) for key, item in sections.items()]
    return "\n\n".join(["\n".join(tops), *blocks] if tops else blocks) + "\n"


def pairs(table: Mapping[str, Any]) -> list[str]:
    """Lines ``key = value``."""
    return [f"{quoted(key)} = {inline(item)}" for key, item in table.items()]


def inline(item: Any) -> str:
    """A value in one line."""
    import json

    if isinstance(item, dict):
        return "{ " + ", ".join(pairs(item)) + " }" if item else "{}"
    if isinstance(item, list):
        return "[" + ", ".join(map(inline, item)) + "]"
    if isinstance(item, bool):
        return str(item).lower()
    return json.dumps(item, ensure_ascii=False) if isinstance(item, str) else repr(item)


def quoted(key: str) -> str:
    """A key, in quotes where it needs them."""
    import json

    bare = key.isascii() and key.replace("-", "").replace("_", "").isalnum()
    return key if bare else json.dumps(key, ensure_ascii=False)
