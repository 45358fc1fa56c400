"""What `campaign.generated` feeds in: a case is a command line or a call, with whether it has to be refused."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import yaml

import visviva as vv
from visviva.base.arguments import Named, Validated
from visviva.component.component import Component
from visviva.scene.yaml12 import load

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
SOLID = """
system:
  ground: Ground
  bar: {Solid: {mesh: {BoxMesh: {size: [2, 1, 1], counts: [2, 1, 1], cell: hex8}},
        material: {NeoHooke: {young: 100.0, poisson: 0.3}}, density: 1.0, velocity: [0, 0, 0.1]}}
  foot: {Fixed: {solid: bar, nodes: x0}}
  end: {RigidCoupling: {solid: bar, faces: x1}}
  ball: {PointMass: {mass: 0.5, position: [2, 0.5, 0.5]}}
  link: {Spherical: {a: end, b: ball, at: [2, 0.5, 0.5]}}
  load: {Pressure: {solid: bar, faces: z1, pressure: 0.1*t}}
  weight: {Gravity: {acceleration: [0, 0, -9.81]}}
run: {until: 1.0, step: 0.1, scheme: {GeneralizedAlpha: {rho: 0.8}}}
newton: {tolerance: 1.0e-12, max_iterations: 20}
probes: {tip: {Position: {of: ball}}}
trails: [tip]
"""


@dataclasses.dataclass(frozen=True)
class Case:
    """Input with a description; `is_bad` where it means nothing and has to be refused."""

    what: str
    is_bad: bool
    command: list[str] = dataclasses.field(default_factory=list)
    call: Callable[[], Any] | None = None


def case(random: Random, seed: int, folder: Path) -> Case:
    """The case of a number: kinds take turns."""
    return (scene, text, argument, mesh, mesh_file, option, system)[seed % 7](random, folder)


# --- scenes: values and keys --------------------------------------------------------------------------------
def places(data: Any, key: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """All places in plain data."""
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    return [key, *(place for name, item in items for place in places(item, (*key, name)))]


def at(data: Any, key: tuple[Any, ...]) -> Any:
    for part in key:
        data = data[part]
    return data


def sources() -> list[str]:
    return [file.read_text() for file in sorted(EXAMPLES.glob("*.yaml"))] + [SOLID]


NO_NUMBERS: list[Any] = [
    "much",
    True,
    math.nan,
    math.inf,
    [1, 2],
    {"a": 1},
    "1_000",
    "yes",
    "1:30",
    "0x",
    [[]],
]


def scene(random: Random, folder: Path) -> Case:
    """A scene with a value or key replaced by one that means nothing there."""
    data = load(random.choice(sources()))[0]
    kind = random.choice(["number", "key", "class", "reference", "boolean", "vector", "section"])
    found = [place for place in places(data) if place and fits(kind, data, place)]
    if not found:
        return scene(random, folder)
    place = random.choice(found)
    parent, name, value = at(data, place[:-1]), place[-1], at(data, place)
    if kind in ("key", "class"):
        put: Any = random.choice([name + "x", name.swapcase() + "_", "", "k" * 150, "ä\u2028", "0"])
        parent[put] = parent.pop(name)
    else:
        spoilt = {
            "number": NO_NUMBERS,
            "reference": [*NO_NUMBERS, "nobody", ""],
            "section": [3, True, "text", [1], math.nan, ["a", "b"], [[]], {"": 1}],
            "boolean": ["yes", "off", 1, 0.5, [], {}, "true "],
            "vector": [
                [1, 2],
                [1, 2, 3, 4],
                [1, 2, "3"],
                [1, 2, True],
                [1, None, 2],
                "abc",
                1.0,
                [[1, 2, 3]] * 2,
            ],
        }
        put = parent[name] = random.choice(spoilt[kind])
    file = folder / "scene.yaml"
    file.write_text(yaml.safe_dump(data, sort_keys=False, allow_unicode=True))
    return Case(
        f"scene, {'.'.join(map(str, place))}: {value!r:.60} -> {put!r:.60}", True, ["check", str(file)]
    )


def fits(kind: str, data: Any, place: tuple[Any, ...]) -> bool:
    """Whether something at a place can be spoilt for sure."""
    value, name = at(data, place), place[-1]
    is_argument = len(place) > 3 and place[0] == "system" and place[2][:1].isupper()
    if kind == "number":
        here = len(place) == 4 if is_argument else place[0] in ("run", "newton")
        return here and isinstance(value, float) and name not in ANYTHING
    if kind == "vector":
        return (
            is_argument and len(place) == 4 and name in ("at", "axis", "position", "velocity", "acceleration")
        )
    if kind == "boolean":
        return is_argument and isinstance(value, bool)
    if kind == "reference":
        return is_argument and len(place) == 4 and name in ("a", "b", "solid", "joint", "on", "winch")
    if kind == "section":
        return (
            len(place) <= 2 and place[0] in ("system", "run", "newton", "probes") and isinstance(value, dict)
        )
    if kind == "class":
        return len(place) == 3 and place[0] in ("system", "probes") and name[:1].isupper()
    return isinstance(name, str) and (len(place) == 1 or (is_argument and len(place) == 4))


ANYTHING = ("motion", "torque", "force", "times", "pressure")
"""Arguments that take more than numbers."""


# --- scenes: texts --------------------------------------------------------------------------------------------
TOKENS = [
    "&a [*a, *a]", "*nothing", "!!python/object/apply:os.system [ls]", "!!timestamp 2001-13-45", "\0", "\t", "\x07",
    "{", "}", "[" * 200, "]", ": ", "- ", "? ", "|", ">", "%YAML 9.9\n", "---\n", "...\n", "'", '"', "#", "1" * 5000,
    "9" * 400, "k" * 2000, "+".join(["t"] * 20_000), "null", "~", ".nan", "\u2028", "\ufeff", "\n\n", "<<: *a", "1e999",
]  # fmt: skip


def text(random: Random, folder: Path) -> Case:
    """A scene's text with something cut out, put in, or doubled."""
    source, name = random.choice(sources()), random.choice(["scene.yaml", "scene.yaml", "scene.toml"])
    for _ in range(random.randint(1, 3)):
        i, j = sorted(random.randrange(len(source) + 1) for _ in range(2))
        j = min(j, i + random.randint(0, 40))
        put = random.choice(["", source[i:j] * 2, random.choice(TOKENS), chr(random.randrange(1, 0x300))])
        source = source[:i] + put + source[j:]
    file = folder / name
    file.write_bytes(source.encode("utf-8", errors="surrogatepass"))
    if random.random() < 0.1:
        file.write_bytes(random.randbytes(random.randint(0, 300)))
    return Case(f"text of {name}", False, ["check", str(file)])


# --- arguments of constructors --------------------------------------------------------------------------------
class Odd:
    """An object that no argument takes."""

    def __repr__(self) -> str:
        return "<odd>"


BAD = [Odd(), {1, 2}, 1j, b"bytes", Odd, ..., {"odd": Odd()}, [Odd()]]
ODD = [None, "", "text", "\0", [], {}, (), (1, 2), [[1], [2, 3]], math.nan, math.inf, -1.0, 0, 10**400, True,
       "x" * 10**5,
       np.zeros((2, 2)), np.array(["a"]), np.float32(1.0), np.int64(1), 1e308, -1e308, 5e-324, "1e3", [None] * 3,
       lambda *a: 1, Path("x"), vv.Ground(name="other")]  # fmt: skip

LIKELY = ["all", "x0", "x1", "multipliers", "penalty", "mixed", "F-bar", "enhanced", "stress", "axisymmetric", "mortar",
          0.5, 1.0, 2.0, 1e6, 1e-6, (("x0", "x1"),), [["y0", "y1"]], "x", "t", (1.0, 0.0, 0.0), (0.0, 0.0, 0.0), False,
          vv.Heat(conductivity=1.0, capacity=1.0), vv.NeoHooke(young=1.0, poisson=0.5),
          vv.BoxMesh(size=(1, 1, 1), counts=(2, 1, 1)), vv.RectangleMesh(size=(1, 1), counts=(2, 1))]  # fmt: skip
"""What means something to many an argument, but seldom beside the others."""


@cache
def objects() -> dict[str, Any]:
    """One object of every public class that is made of arguments."""
    from test_bad_input import composed

    return {name: thing for name, thing in composed().items() if hasattr(vv, name)}


def argument(random: Random, folder: Path) -> Case:
    """A constructor with an argument that is replaced, unknown or left out."""
    found = objects()
    name = random.choice(sorted(found))
    given = {f.name: getattr(found[name], f.name) for f in dataclasses.fields(found[name]) if f.init}
    given.pop("name", None) if isinstance(found[name], Component) else None
    known = sorted(given) or ["arguments"]
    is_bad = random.random() < 0.5
    is_known = random.random() < 0.9 or not isinstance(type(found[name]), Validated | Named)
    key = random.choice(known) + ("" if is_known else "_")
    value = random.choice(BAD if is_bad else ODD)
    what = f"{name}({key}={value!r:.60})"
    kind = type(found[name])
    return Case(what, is_bad or key not in known, call=lambda: kind(**{**given, key: value}))


# --- systems ----------------------------------------------------------------------------------------------------
@cache
def entries() -> list[Any]:
    """What the catalogue and the test of scenes compose, and what neither has: smooth cells, and slots that close."""
    from catalogue import CATALOGUE
    from catalogue.entry import NOTHING, Entry
    from test_language import MORE

    return [*CATALOGUE, *MORE, Entry("smooth cell", smooth_cell, NOTHING), Entry("slot", slot, NOTHING)]


def smooth_cell() -> list[Component]:
    pairs = (("x0", "x1"), ("y0", "y1"))
    mesh = vv.SplineBox(size=(1, 1), counts=(3, 3))
    body = vv.SplineSolid(
        mesh=mesh, material=vv.NeoHooke(young=1.0, poisson=0.3), density=1.0, periodic=pairs
    )
    joint = vv.Spherical(a=(ground := vv.Ground()), b=body, at=(0, 0, 0))
    return [body, ground, joint, vv.PeriodicFaces(solid=body, pairs=pairs, strain=0.1 * np.eye(3), times="t")]


def slot() -> list[Component]:
    from verification.test_self_contact_statics import RUBBER, slotted

    body = vv.Solid(mesh=slotted(), material=RUBBER, density=1.0)
    top, base = (np.flatnonzero(body.grid.points[:, 1] == y) for y in (1.0, 0.0))
    motion = ("0.1*t", "-t", None)
    return [
        body,
        vv.Prescribed(solid=body, nodes=top, motion=motion),
        vv.Fixed(solid=body, nodes=base),
        vv.Contact(first=body, first_faces="slot", friction=0.3, enforcement="multipliers"),
    ]


def system(random: Random, folder: Path) -> Case:
    """A system in which an argument of a component is replaced, composed and taken a step, of statics or dynamics."""
    entry = random.choice(entries())
    parts = entry.build()
    k = random.randrange(len(parts))
    fields = [f.name for f in dataclasses.fields(parts[k]) if f.init and f.name != "name"]
    if not fields or not hasattr(vv, type(parts[k]).__name__):
        return system(random, folder)
    key = random.choice(fields)
    now = getattr(parts[k], key)
    sized = [now * factor for factor in (-1.0, 0.0, 1e-6, 1e6, 1e300)] if isinstance(now, float) else []
    value, scheme = (
        random.choice([*random.choice([ODD, LIKELY]), *sized * 20]),
        vv.Static() if random.random() < 0.3 else None,
    )

    def step() -> None:
        given = {name: getattr(parts[k], name) for name in fields} | {key: value}
        composed = vv.System([*parts[:k], type(parts[k])(**given), *parts[k + 1 :]])
        for _ in vv.march(composed, until=entry.h, step=entry.h, scheme=scheme, project=True):
            pass
        if not np.isfinite(composed.x).all():
            raise ArithmeticError("unknowns that are no numbers")

    return Case(f"{entry.name}: {type(parts[k]).__name__}({key}={value!r:.60})", False, call=step)


SETS = ["node_sets", "face_sets", "cell_sets"]


# --- meshes -----------------------------------------------------------------------------------------------------
def mesh(random: Random, folder: Path) -> Case:
    """A mesh of arrays with one of them spoilt."""
    whole = vv.BoxMesh(size=(1, 1, 1), counts=(2, 1, 1)).build()
    points, cells = whole.points.copy(), whole.cells["hex8"].copy()
    n = random.randrange(len(points))
    changes: dict[str, dict[str, Any]] = {
        "nan": {"points": np.where(np.arange(len(points))[:, None] == n, math.nan, points)},
        "flat points": {"points": points.ravel()},
        "points in 4D": {"points": np.pad(points, ((0, 0), (0, 1)))},
        "texts": {"points": [["a", "b", "c"]]},
        "ragged": {"points": [[1, 2, 3], [1, 2]]},
        "no points": {"points": None},
        "odd points": {"points": random.choice(BAD)},
        "too large": {"cells": {"hex8": cells + len(points)}},
        "negative": {"cells": {"hex8": cells - 1}},
        "half": {"cells": {"hex8": cells + 0.5}},
        "few": {"cells": {"hex8": cells[:, :7]}},
        "unknown": {"cells": {"hex9": cells}},
        "odd type": {"cells": {random.choice([3, None, ""]): cells}},
        "list": {"cells": [cells]},
        "odd cells": {"cells": random.choice([None, 3, "hex8", {"hex8": None}, {"hex8": "1"}, {"hex8": Odd()}])},
        "twice": {"cells": {"hex8": np.where(cells == cells[0, 0], cells[0, 1], cells)}},
        "inverted": {"cells": {"hex8": np.roll(cells, 4, axis=1)}},
        "collapsed": {"points": points * [1, 1, 0]},
        "node set": {"node_sets": {"s": [n, 99]}},
        "odd node set": {"node_sets": {"s": random.choice(["abc", [0.5], None, Odd()])}},
        "odd sets": {random.choice(SETS): random.choice([3, "s", [1], {"s": Odd()}])},
        "cell set": {"cell_sets": {"s": [2]}},
        "face set": {"face_sets": {"s": [[0, 1, 2, 3]]}},
    }  # fmt: skip
    what = random.choice(sorted(changes))
    given = {"points": points, "cells": {"hex8": cells}} | changes[what]
    return Case(f"mesh, {what}", True, call=lambda: used(vv.Mesh(**given)))


def used(found: vv.Mesh) -> None:
    """A mesh is looked at where a solid is made of it."""
    vv.Solid(mesh=found, material=vv.NeoHooke(young=1.0, poisson=0.3), density=1.0)


def mesh_file(random: Random, folder: Path) -> Case:
    """A mesh in a file of which something was cut out or put in."""
    ending = random.choice(["inp", "msh", "vtk", "vtu", "stl", "obj", "xdmf", "geo", "med", "step", "iges"])
    path = folder / f"mesh.{ending}"
    if ending in ("inp", "msh", "vtk", "vtu"):
        vv.BoxMesh(size=(1, 1, 1), counts=(2, 1, 1)).build().write(path)
        data = path.read_bytes()
    else:
        data = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    for _ in range(random.randint(1, 4)):
        i = random.randrange(len(data) + 1)
        put = random.choice(
            [b"", b"\0", b"nan", b"-1", b"999999999999", b"*INCLUDE, INPUT=mesh.inp\n", random.randbytes(9)]
        )
        data = data[:i] + put + data[i + random.randint(0, 60) :]
    path.write_bytes(data)
    if ending in ("stl", "obj", "step"):
        return Case(f"mesh file *.{ending}", False, call=lambda: vv.SurfaceMesh(file=path))
    size = 1.0 if ending == "iges" else None
    return Case(f"mesh file *.{ending}", False, call=lambda: used(vv.MeshFile(path, size=size).build()))


# --- command lines ----------------------------------------------------------------------------------------------
WORDS = [
    "",
    "0",
    "-1",
    "nan",
    "inf",
    "-inf",
    "1e-300",
    "1e999",
    "x",
    "1,5",
    "0x10",
    "ä",
    "{",
    "[",
    "--",
    "9" * 5000,
]
OPTIONS: dict[str, list[str]] = {
    "--step": WORDS,
    "--until": ["", "-1", "nan", "inf", "x", "1e999", "{"],
    "--scheme": ["", "Midpoint(1)", "Midpoint()()", "Midpont", "GeneralizedAlpha(rho=2)", "GeneralizedAlpha(rho=nan)",
                 "Static(tolerance=-1)", "GeneralizedAlpha(roh=1)", "System", "BDF2(", "1", "ArcLength(most=x)",
                 "(" * 300],
    "--adaptive": ["", "0", "-1", "nan", "inf", "x"],
    "--set": ["", "length", "=", "lenght=1", "length=", "length=x", "length=nan", "length=-1", "length=[1",
              "length=yes", "length=" + "9" * 5000, "length=2001-01-01", "length={a: 1}", "length=true", "a.b=1",
              "length=*a"],
    "--save-every": ["", "-1", "nan", "x"],
    "--every": ["", "0", "-1", "1.5", "x", "nan"],
    "--unknown": ["1"],
    "--out": ["/dev/null/x", "x" * 300, "/proc/none"],
}  # fmt: skip
LINES = [[], ["rnu"], ["run"], ["check"], ["run", "nobody"], ["check", "x" * 300 + ".yaml"], ["run", "/"], ["run", ""],
         ["plot", "/"], ["movie", "nowhere"], ["picture", "nowhere", "--time", "nan"], ["view", "nowhere"],
         ["run", "a/b"],
         ["run", "none.yaml"], ["run", ".yaml"], ["check", "pendulum", "--set", "mass=yes"], ["schema", "extra"],
         ["run", "pendulum", "--resume", "--out", "nowhere"], ["run", "pendulum", "crane"], ["info", "--x"],
         ["run", "pendulum", "--force"], ["run", "pendulum", "--resume", "--overwrite"]]  # fmt: skip


def option(random: Random, folder: Path) -> Case:
    """A command line with an option that has no meaning, or none that has."""
    if random.random() < 0.25:
        line = random.choice(LINES)
        return Case(f"visviva {' '.join(line)[:80]}", line != [], line)
    name = random.choice(sorted(OPTIONS))
    value = random.choice(OPTIONS[name])
    more = [] if name == "--until" else ["--until", "0.02"]
    joined = random.random() < 0.5
    line = ["run", "pendulum", *([f"{name}={value}"] if joined else [name, value]), *more]
    return Case(f"visviva {' '.join(line)[:80]}", True, line)
