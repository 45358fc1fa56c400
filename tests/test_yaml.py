"""What a scene file may hold: YAML's core schema alone, in bounds, refused in one line with file and line."""

from __future__ import annotations

import math
import time
from pathlib import Path
from typing import Any

import pytest

import visviva as vv
from visviva.cli import main
from visviva.scene import read_scene, write_scene
from visviva.scene.gallery import plain_value
from visviva.scene.yaml12 import load, plain

SCENE = """system:
  ground: Ground
  arm: {RigidBody: {mass: 2.0, inertia: [1, 1, 1]}}
  hinge: {Revolute: {a: ground, b: arm, at: [0, 0, 0], angle: true}}
run: {until: 1.0, step: 0.1}
"""

# Section 10.3.2 of the YAML 1.2.2 specification, and what YAML 1.1 reads otherwise.
CORE: dict[str, Any] = {
    "": None, "~": None, "null": None, "Null": None, "NULL": None, "nuLL": "nuLL",
    "true": True, "True": True, "TRUE": True, "false": False, "tRue": "tRue",
    "yes": "yes", "no": "no", "on": "on", "off": "off", "y": "y", "N": "N",
    "0": 0, "-19": -19, "+12": 12, "0o14": 12, "0x3A": 58, "012": 12, "014": 14, "08": 8, "1_000": "1_000",
    "0b11": "0b11", "-0o7": "-0o7", "190:20:30": "190:20:30", "12:30:45": "12:30:45",
    "0.": 0.0, "-0.0": -0.0, ".5": 0.5, "+12e03": 12000.0, "-2E+05": -2e5, "1e-3": 0.001, "1e": "1e",
    ".inf": math.inf, "-.Inf": -math.inf, "+.INF": math.inf, "inf": "inf", "nan": "nan",
    "2001-12-14": "2001-12-14", "2001-13-45": "2001-13-45",
    "2001-12-14t21:59:43.10-05:00": "2001-12-14t21:59:43.10-05:00",
    "=": "=", "<<": "<<",
}  # fmt: skip


@pytest.mark.parametrize("text", CORE)
def test_scalars_are_read_by_the_core_schema(text: str) -> None:
    expected = CORE[text]
    assert plain(text) == expected
    assert type(plain(text)) is type(expected)
    assert plain_value(text) == expected


def test_keys_are_texts_as_they_stand() -> None:
    data, lines = load("on: 1\nno: 2\n1.0: 3\n~: 4\n'a b': 5\n")
    assert list(data) == ["on", "no", "1.0", "~", "a b"]
    assert [lines[(key,)] for key in data] == [1, 2, 3, 4, 5]


def test_aliases_are_copies_and_tags_of_the_core_are_known() -> None:
    data, lines = load("a: &x [1, {b: 2}]\nc: *x\nd: !!str 12\ne: !!float 3\nf: ! 4\ng: !!int 5\n")
    assert data == {"a": [1, {"b": 2}], "c": [1, {"b": 2}], "d": "12", "e": 3.0, "f": "4", "g": 5}
    data["c"][1]["b"] = 7
    assert data["a"][1]["b"] == 2
    assert lines[("c",)] == 2


def bomb(n: int) -> str:
    rows = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    rows += [f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 10)}]" for k in range(1, n)]
    return "\n".join(rows)


DIGITS = "7" * 5000
BAD: dict[str, tuple[str, str]] = {
    "alias bomb": (bomb(12), r":4: a3.*stand for more than 10000 values"),
    "alias of itself": ("system: &a\n  b: *a\n", r":2: system\.b: .*contains itself"),
    "unknown alias": ("system: *nothing\n", r":1: system: .*names no anchor"),
    "depth": ("system: " + "[" * 100_000, r":1: .*nested more than 50 deep"),
    "depth of blocks": ("\n".join(" " * k + "a:" for k in range(200)), r":5\d: .*nested more than 50 deep"),
    "digits": (SCENE.replace("2.0", DIGITS), r":3: system\.arm\.RigidBody\.mass: .*5000 characters"),
    "digits of a float": (SCENE.replace("2.0", f"0.{DIGITS}"), r":3: .*characters"),
    "too large": (SCENE.replace("2.0", "1e999"), r":3: .*mass: the number 1e999 is too large"),
    "NUL": (SCENE.replace("ground: Ground", "ground\0: Ground"), r":2: .*not allowed"),
    "NUL by escape": (SCENE.replace("Ground", '"Gro\\0und"'), r":2: .*the character NUL"),
    "control character": (SCENE.replace("Ground", "Gro\x07und"), r":2: .*not allowed"),
    "date by tag": (SCENE.replace("2.0", "!!timestamp 2001-13-45"), r":3: .*the tag !!timestamp means nothing"),
    "tag of Python": (SCENE.replace("2.0", "!!python/object/apply:os.system [ls]"),
                      r":3: .*!!python/object.*means nothing"),
    "binary": (SCENE.replace("2.0", "!!binary gIGC"), r":3: .*!!binary means nothing"),
    "own tag": (SCENE.replace("2.0", "!mass 2"), r":3: .*!mass means nothing"),
    "wrong tag": (SCENE.replace("2.0", "!!int two"), r":3: .*'two' is no int"),
    "long key": ("k" * 100_000 + ": 1\n", r":\d: "),
    "longer key": ("k" * 500 + ": 1\n", r":1: the key .*500 characters"),
    "long text": (SCENE + "notes: " + "x" * 200_000, r":6: notes: .*too long"),
    "list as key": ("[a, b]: 1\n", r":1: a key is a text"),
    "two documents": (SCENE + "---\n" + SCENE, r":6: .*more than one document"),
    "key twice": ("a: 1\na: 2\n", r":2: a: the key 'a' occurs twice"),
    "not closed": ("system: {a: [1, 2\n", r":\d: while parsing"),
    "tab": ("system:\n\ta: 1\n", r":2: .*character"),
    **{
        word: (SCENE.replace("angle: true", f"angle: '{word}'" if word == "true" else f"angle: {word}"),
               rf":4: .*angle: write true or false, not '{word}'")
        for word in ("yes", "no", "on", "off", "Yes", "OFF", "y", "true")
    },
    "number for a Boolean": (SCENE.replace("angle: true", "angle: 1"), r":4: .*angle: .*true or false"),
    "text for a number": (SCENE.replace("2.0", "'2.0'"), r":3: .*mass: .*number"),
    "Boolean for a number": (SCENE.replace("2.0", "true"), r":3: .*mass: .*number"),
    "text in a vector": (SCENE.replace("[0, 0, 0]", "[0, 0, '0']"), r":4: .*at: .*numbers"),
    "sexagesimal": (SCENE.replace("until: 1.0", "until: 1:30"), r":5: run\.until: .*number"),
    "long word for a number": (SCENE.replace("2.0", "x" * 50_000), r":3: .*mass: "),
    "long class": (SCENE.replace("Ground", "G" * 50_000), r":2: "),
    "missing values": ("system:\nrun:\n", r":1: system: is missing"),
    "top is a text": ("hello", "a scene is a mapping"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_bad_files_are_refused_in_a_line(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text, message = BAD[name]
    file = tmp_path / "scene.yaml"
    file.write_text(text)
    start = time.perf_counter()
    with pytest.raises(vv.InputError, match=message) as error:
        read_scene(file)
    assert time.perf_counter() - start < 5.0
    assert len(str(error.value)) < 1100
    assert "\n" not in str(error.value)
    assert main(["check", str(file)]) == 2
    told = capsys.readouterr().err
    assert str(file) in told
    assert len(told.splitlines()) == 1


DEEP = "system = " + "[" * 5000
TOML: dict[str, tuple[str, str]] = {
    "date": ("title = 2001-12-14\n", "title: a date or time"),
    "moment": ("title = 2001-12-14T07:32:00Z\n", "title: a date or time"),
    "bad date": ("title = 2001-13-45\n", "toml"),
    "depth": (DEEP, "nested too deeply|toml"),
    "some depth": ("a = " + "[" * 60 + "]" * 60, "nested more than 50 deep"),
    "digits": (f"a = {DIGITS}\n", "s.toml"),
    "large": (f"a = 1{'0' * 400}\n", "a: a number is too large"),
    "long key": ("k" * 100_000 + " = 1\n", "100000 characters"),
    "NUL": ('title = "a\\u0000b"\n', "NUL"),
}


@pytest.mark.parametrize("name", TOML)
def test_bad_toml_is_refused_in_a_line(name: str, tmp_path: Path) -> None:
    text, message = TOML[name]
    (tmp_path / "s.toml").write_text(text)
    with pytest.raises(vv.InputError, match=message) as error:
        read_scene(tmp_path / "s.toml")
    assert len(str(error.value)) < 1100
    assert "\n" not in str(error.value)


def test_files_that_are_none(tmp_path: Path) -> None:
    with pytest.raises(vv.InputError, match="there is no such file"):
        read_scene(tmp_path)
    with pytest.raises(vv.InputError, match=r"cannot be read|no such file"):
        read_scene(tmp_path / ("a" * 300 + ".yaml"))
    (tmp_path / "large.yaml").write_text("# comment\n" * 500_000)
    with pytest.raises(vv.InputError, match="larger than 4 MiB"):
        read_scene(tmp_path / "large.yaml")


@pytest.mark.parametrize("name", ["1e3", "0o17", "on", "null", "12", "2001-12-14", "yes", "a: b", "~"])
def test_names_that_look_like_values_are_written_and_read(name: str, tmp_path: Path) -> None:
    ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(0, 0, 1), name=name)
    write_scene(vv.System([ground, ball, vv.Distance(a=ground, b=ball, at=(0, 0, 0))]), tmp_path / "s.yaml")
    assert read_scene(tmp_path / "s.yaml").system.components[1].name == name
