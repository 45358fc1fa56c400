"""Scene files: round trips, the same bits as Python, refusals by file, line and key, JSON Schema."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
import yaml

import visviva as vv
from visviva.examples import crane
from visviva.scene import read_scene, scene_schema, write_scene
from visviva.scene.language import components

EXAMPLES = Path(__file__).parent.parent / "examples"
SCENES = sorted(EXAMPLES.glob("*.yaml"))


def march(system: vv.System, until: float = 0.2) -> tuple[bytes, bytes]:
    vv.simulate(system, until=until, step=0.01, project=True)
    return system.x.tobytes(), system.v.tobytes()


def mechanism() -> vv.System:
    """Many kinds of components, arguments and references."""
    ground = vv.Ground()
    arm = vv.RigidBody(
        shape=vv.Box(size=(1, 0.1, 0.2)),
        density=300.0,
        position=(0.5, 0, 0),
        angular_velocity=(0, 0, 0.1),
        name="arm",
    )
    sled = vv.RigidBody(
        mass=2.0, inertia=[[1, 0.1, 0], [0.1, 1.2, 0], [0, 0, 0.9]], centre=(0.1, 0, 0), position=(2, 0, 0)
    )
    ball = vv.PointMass(mass=1 / 3, position=(0.3, 0.1, -1), name="ball with: odd, name")
    hinge = vv.Revolute(a=ground, b=arm, at=(0, 0, 0), axis=(0.1, 0, 1), first=(1, 0, 0))
    rail = vv.Prismatic(a=ground.frame_at((2, 0, 0), (1, 2, 3)), b=sled.frame_at((2, 0, 0), (1, 2, 3)))
    rod = vv.Distance(a=arm.point((0.5, 0, 0)), b=sled.point_at((1.9, 0.05, 0)))
    parts = [
        vv.JointSpring(joint=rail, stiffness=3.0),
        vv.JointForce(joint=rail, force=[[0, 0], [1, 2]]),
        vv.Spring(a=arm, b=ball, stiffness=20.0, damping=0.1, at_a=(1, 0, 0)),
        vv.Force(on=ball.point(), force=(1, 0, 0), times="sin(3*t)"),
        vv.FollowerForce(on=arm, force=(0, 0.1, 0), at=(1, 0, 0)),
        vv.Gravity(acceleration=(0, 0.1, -9.81)),
    ]
    return vv.System([ground, arm, sled, ball, hinge, rail, rod, *parts], vv.Newton(keep_factor=0.0))


def test_scene_of_the_crane_is_the_crane_bit_by_bit() -> None:
    scene, python = read_scene(EXAMPLES / "crane.yaml"), crane.study()
    assert (scene.until, scene.step, scene.scheme) == (python.until, python.step, python.scheme)
    assert [c.name for c in scene.system.components] == [c.name for c in python.system.components]
    assert march(scene.system, 2.0) == march(python.system, 2.0)


@pytest.mark.parametrize("suffix", [".yaml", ".toml"])
def test_round_trip_marches_to_identical_bits(suffix: str, tmp_path: Path) -> None:
    system = mechanism()
    write_scene(system, tmp_path / f"first{suffix}")
    first = read_scene(tmp_path / f"first{suffix}").system
    write_scene(first, tmp_path / f"second{suffix}")  # before it has moved
    reference = march(system)
    assert march(first) == reference
    write_scene(first, tmp_path / f"third{suffix}")  # and after: the present state is no argument
    assert (tmp_path / f"second{suffix}").read_text() == (tmp_path / f"third{suffix}").read_text()
    second = read_scene(tmp_path / f"second{suffix}").system
    assert second.newton == vv.Newton(keep_factor=0.0)
    assert march(second) == reference


@pytest.mark.parametrize("file", SCENES, ids=lambda f: f.stem)
def test_studies_round_trip_with_probes(file: Path, tmp_path: Path) -> None:
    study = read_scene(file)
    study.scheme, study.fields = vv.GeneralizedAlpha(rho=0.7), ("stretches", "J")
    write_scene(study, tmp_path / "copy.toml")
    again = read_scene(tmp_path / "copy.toml")
    assert list(again.probes) == list(study.probes)
    assert (again.trails, again.title, again.scheme) == (study.trails, study.title, study.scheme)
    assert again.fields == study.fields
    for name in study.probes:
        ours, theirs = study.probes[name](study.system), again.probes[name](again.system)
        np.testing.assert_array_equal(ours, theirs)


def test_starts_by_expressions_of_place(tmp_path: Path) -> None:
    """A pattern, a crack and a warm end begin in a file as by functions of Python."""
    mesh, wave = vv.RectangleMesh(size=(8, 8), counts=(8, 8)), "0.5 + 0.1*cos(x)*cos(0.5*y)"
    settings: Any = {"free_energy": vv.DoubleWell(barrier=1.0), "gradient_energy": 8.0, "name": "alloy"}
    alloy = vv.CahnHilliard(mesh=mesh, concentration=wave, **settings)
    wall = vv.ThermalBody(mesh=mesh, conductivity=1.0, temperature="300 + 20*exp(-x)", name="wall")
    steel, tough = vv.SaintVenantKirchhoff(young=1.0, poisson=0.2), {"toughness": 1.0, "length": 2.0}
    plate = vv.FracturingSolid(
        mesh=mesh, material=steel, damage="max(0, 1 - abs(y - 4))", name="plate", **tough
    )
    write_scene(vv.Study(vv.System([alloy, wall, plate]), 0.1, 0.1), tmp_path / "starts.yaml")
    again = {c.name: c for c in read_scene(tmp_path / "starts.yaml").system.components}
    x, y = alloy.points[:, :2].T
    np.testing.assert_allclose(
        again["alloy"].start_values, 0.5 + 0.1 * np.cos(x) * np.cos(0.5 * y), rtol=1e-14
    )
    np.testing.assert_allclose(again["plate"].start_damages, np.maximum(0, 1 - np.abs(y - 4)), rtol=1e-14)
    np.testing.assert_allclose(again["wall"].temperature(wall.points), 300 + 20 * np.exp(-x), rtol=1e-14)
    with pytest.raises(
        vv.InputError, match=r"concentration: 't' in '0.5 \+ t' is unknown; there are x, y, z"
    ):
        vv.CahnHilliard(mesh=mesh, concentration="0.5 + t", **settings)


def test_python_functions_and_own_classes_are_refused(tmp_path: Path) -> None:
    class Mine(vv.PointMass):
        pass

    hinge = vv.Revolute(a=vv.Ground(), b=vv.RigidBody(mass=1, inertia=(1, 1, 1)), at=(0, 0, 0))
    motor = vv.Motor(joint=hinge, motion=lambda t: t, name="motor")
    for system, message in (
        (vv.System([hinge.a, hinge.b, hinge, motor]), "Motor 'motor': motion is .*function"),
        (vv.System([Mine(mass=1.0)]), "the class Mine is not part of visviva"),
    ):
        with pytest.raises(vv.InputError, match=message):
            write_scene(system, tmp_path / "no.yaml")
    study = crane.study()
    study.probes["sway"] = lambda system: float(system.x[0])  # type: ignore[index]
    with pytest.raises(vv.InputError, match=r"probe 'sway' is a form or a function"):
        write_scene(study, tmp_path / "no.yaml")
    assert not (tmp_path / "no.yaml").exists()


def test_every_public_component_is_in_the_language_and_the_schema() -> None:
    names = set(components())
    assert {"RigidBody", "PointMass", "Ground", "Gear", "Servo", "Bushing", "TorquePair"} <= names
    definitions = scene_schema()["$defs"]
    assert names <= set(definitions)
    single = definitions["component"]["anyOf"][1]
    assert set(single["properties"]) == names


BASE: dict[str, Any] = {
    "system": {
        "ground": {"Ground": {}},
        "girder": {"RigidBody": {"mass": 1.0, "inertia": [1, 1, 1]}},
        "hinge": {"Revolute": {"a": "ground", "b": "girder", "at": [0, 0, 0]}},
    },
    "run": {"until": 1.0, "step": 0.1},
}
BAD: dict[str, tuple[list[str], Any, str]] = {
    # name: key path, value, message
    "unknown section": (["sytem"], {}, r"scene\.yaml:\d+: sytem: unknown key; did you mean 'system'\?"),
    "unknown class": (["system", "girder"], {"RigidBdy": {}}, r"RigidBdy: there is no class.*'RigidBody'"),
    "unknown argument": (
        ["system", "girder", "RigidBody", "mas"],
        3,
        r"girder\.RigidBody\.mas: unknown key.*'mass'",
    ),
    "missing argument": (["system", "girder"], {"PointMass": {}}, r"girder\.PointMass: needs the key 'mass'"),
    "wrong length": (
        ["system", "girder", "RigidBody", "position"],
        [1, 2],
        r"position: expected a list of 3 numbers",
    ),
    "not a number": (["system", "girder", "RigidBody", "mass"], "heavy", r"mass: .*valid number.*'heavy'"),
    "nan": (["system", "girder", "RigidBody", "mass"], float("nan"), r"RigidBody\.mass: .*finite number"),
    "nan in a list": (
        ["system", "girder", "RigidBody", "velocity"],
        [0, float("nan"), 0],
        r"velocity: .*finite",
    ),
    "infinite": (["system", "hinge", "Revolute", "at"], [0, float("inf"), 0], r"at: .*finite"),
    "dangling": (
        ["system", "hinge", "Revolute", "b"],
        "girdr",
        r"hinge\.Revolute\.b: there is no component.*'girder'",
    ),
    "itself": (["system", "hinge", "Revolute", "b"], "ground", r"hinge.*joins Ground 'ground' with itself"),
    "circle": (
        ["system", "hinge", "Revolute", "b"],
        "hinge",
        r"b: refers to itself by way of hinge -> hinge",
    ),
    "no body": (["system", "hinge", "Revolute", "b"], 7, r"b: expected the name of a component"),
    "point": (["system", "hinge", "Revolute", "b"], {"frame": "girder", "y": 1}, r"b\.y: unknown key"),
    "point numbers": (
        ["system", "hinge", "Revolute", "b"],
        {"frame": "girder", "X": [0, 0]},
        r"b\.X: expected 3 finite",
    ),
    "axes": (
        ["system", "hinge", "Revolute", "b"],
        {"frame": "girder", "axes": [[1, 0, 0], [0, 0, 1], [0, 1, 0]]},
        r"not right-handed and orthonormal",
    ),
    "no attachment": (["system", "hinge", "Revolute", "b"], {"pont": "girder"}, r"b\.pont: .*'point'"),
    "negative mass": (
        ["system", "girder", "RigidBody", "mass"],
        -1.0,
        r"girder\.RigidBody: .*mass -1 is not positive",
    ),
    "zero mass": (["system", "girder"], {"PointMass": {"mass": 0}}, r"mass 0 is not positive"),
    "left-handed": (
        ["system", "girder", "RigidBody", "rotation"],
        [[1, 0, 0], [0, 1, 0], [0, 0, -1]],
        r"left-handed",
    ),
    "triangle inequality": (["system", "girder", "RigidBody", "inertia"], [1, 1, 3], r"girder"),
    "shape": (["system", "girder", "RigidBody", "shape"], {"Bx": {"size": [1, 1, 1]}}, r"shape\.Bx: .*'Box'"),
    "shape size": (
        ["system", "girder", "RigidBody", "shape"],
        {"Box": {"size": [1, 1, -1]}},
        r"Box\.size.*greater than 0",
    ),
    "expression": (
        ["system", "motor"],
        {"Motor": {"joint": "hinge", "motion": "2*sine(t)"}},
        r"motor\.Motor.*sine",
    ),
    "scheme": (["run", "scheme"], "EnergyMomentun", r"run\.scheme\.EnergyMomentun: .*'EnergyMomentum'"),
    "scheme argument": (["run", "scheme"], {"GeneralizedAlpha": {"roh": 0.8}}, r"roh: unknown key.*'rho'"),
    "until": (["run", "until"], 0, r"run\.until: .*greater than 0"),
    "step": (["run", "step"], -0.1, r"run\.step: .*greater than 0"),
    "no step": (["run"], {"until": 1.0}, r"run\.step"),
    "no run": (["run"], None, r"run: is missing"),
    "newton": (["newton"], {"tol": 1}, r"newton\.tol: unknown key.*'tolerance'"),
    "probe": (["probes"], {"p": {"Positon": {"of": "girder"}}}, r"probes\.p\.Positon: .*'Position'"),
    "function": (["system", "f"], {"Potential": {"of": ["girder"], "energy": "x"}}, r"energy: .*function"),
}


def changed(path: list[str], value: Any) -> dict[str, Any]:
    data = copy.deepcopy(BASE)
    at = data
    for part in path[:-1]:
        at = at[part]
    at[path[-1]] = value
    return data


@pytest.mark.parametrize("name", BAD)
def test_bad_scenes_are_refused_by_key(name: str, tmp_path: Path) -> None:
    path, value, message = BAD[name]
    file = tmp_path / "scene.yaml"
    file.write_text(yaml.safe_dump(changed(path, value), sort_keys=False))
    with pytest.raises(vv.InputError, match=message) as error:
        read_scene(file)
    assert str(file) in str(error.value)
    assert "\n" not in str(error.value)


def test_base_of_the_bad_scenes_is_good(tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(BASE))
    assert read_scene(tmp_path / "scene.yaml").system.n_constraints == 11


def test_lines_are_named(tmp_path: Path) -> None:
    file = tmp_path / "scene.yaml"
    file.write_text("system:\n  ball:\n    PointMass:\n      mass: 1e-3\n      postion: [0, 0, 0]\n")
    with pytest.raises(vv.InputError, match=r"scene\.yaml:5: .*'position'"):
        read_scene(file)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("system: [", "while parsing"),
        ("- 1\n- 2", "a scene is a mapping"),
        ("", "system: is missing"),
        ("system: &a {b: *a}", "contains itself|found undefined alias|expected"),
        ("run: {}\nrun: {}", r"scene\.yaml:2: run: the key 'run' occurs twice"),
    ],
)
def test_unreadable_files(text: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(text)
    with pytest.raises(vv.InputError, match=message):
        read_scene(tmp_path / "scene.yaml")


def test_missing_and_broken_files(tmp_path: Path) -> None:
    with pytest.raises(vv.InputError, match="no such file"):
        read_scene(tmp_path / "none.yaml")
    (tmp_path / "s.toml").write_text("a = [1,")
    with pytest.raises(vv.InputError, match="toml"):
        read_scene(tmp_path / "s.toml")
    (tmp_path / "b.yaml").write_bytes(b"\xff\xfe\x00bad")
    with pytest.raises(vv.InputError, match="cannot be read"):
        read_scene(tmp_path / "b.yaml")


def test_order_of_components_in_the_file_does_not_matter_for_references(tmp_path: Path) -> None:
    data = copy.deepcopy(BASE)
    data["system"] = dict(reversed(data["system"].items()))
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(data, sort_keys=False))
    system = read_scene(tmp_path / "scene.yaml").system
    assert [c.name for c in system.components] == ["hinge", "girder", "ground"]


def test_changes_by_dotted_path() -> None:
    file = EXAMPLES / "crane.yaml"
    study = read_scene(file, {
        "girder.mass": 90.0, "system.load.PointMass.mass": 7.0, "run.step": 0.02, "trolley.position.2": 0.5,
        "run.scheme": {"GeneralizedAlpha": {"rho": 0.5}}, "newton.tolerance": 1e-12,
        "load.velocity": [0, 1, 0],
    })  # fmt: skip
    parts = {c.name: c for c in study.system.components}
    assert (parts["girder"].mass, parts["load"].mass, study.step) == (90.0, 7.0, 0.02)
    assert parts["trolley"].position.tolist() == [1.5, 0, 0.5]
    assert parts["load"].velocity.tolist() == [0, 1, 0]
    assert study.scheme == vv.GeneralizedAlpha(rho=0.5)
    assert study.system.newton.tolerance == 1e-12
    for key, message in (
        ("girdr.mass", "nothing called 'girdr'; did you mean 'girder'"),
        ("girder.mas", "mas: unknown key; did you mean 'mass'"),
        ("trolley.position.7", "leads nowhere"),
        ("run.stp", "did you mean 'step'"),
    ):
        with pytest.raises(vv.InputError, match=message):
            read_scene(file, {key: 1.0})


# --- the schema ---------------------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def validator() -> jsonschema.Draft202012Validator:
    schema = scene_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


@pytest.mark.parametrize("file", SCENES, ids=lambda f: f.stem)
def test_shipped_scenes_satisfy_the_schema(file: Path, validator: Any) -> None:
    validator.validate(yaml.safe_load(file.read_text()))


def test_written_scenes_satisfy_the_schema(tmp_path: Path, validator: Any) -> None:
    write_scene(mechanism(), tmp_path / "s.yaml")
    validator.validate(yaml.safe_load((tmp_path / "s.yaml").read_text()))


BY_VALUE = (
    "nan",
    "infinite",
    "dangling",
    "itself",
    "circle",
    "axes",
    "negative",
    "zero",
    "left",
    "triangle",
    "expres",
)


@pytest.mark.parametrize("name", [n for n in BAD if not n.startswith(BY_VALUE)])
def test_schema_refuses_what_its_shape_tells(name: str, validator: Any) -> None:
    path, value, _ = BAD[name]
    assert validator.is_valid(BASE)
    assert not validator.is_valid(changed(path, value))
