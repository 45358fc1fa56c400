"""Scene files of solids: round trips to the same bits, and wrong names with the nearest valid one."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
import yaml

import visviva as vv
from visviva.scene import read_scene, scene_schema, write_scene


def composed() -> vv.Study:
    """Solids with all that a file can say of them."""
    material = vv.NeoHooke(young=100.0, poisson=0.3, volumetric="simo")
    beam = vv.Solid(
        mesh=vv.BoxMesh(size=(2, 0.5, 0.4), counts=(3, 1, 1), cell="hex20"),
        material=material,
        density=1.2,
        velocity=(0, 0, 0.1),
        stiffness_damping=0.001,
        name="beam",
    )
    plate = vv.Solid(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(2, 2), cell="quad8"),
        material=vv.Ogden(mu=(10.0, -4.0), alpha=(2.0, -1.5), bulk=60.0),
        density=1.0,
        thickness=0.1,
        name="plate",
    )
    end, rim = (
        vv.RigidCoupling(solid=beam, faces="x1", name="end"),
        vv.DistributedCoupling(solid=plate, faces="x0"),
    )
    tip = vv.RigidBody(mass=0.3, inertia=(0.1, 0.1, 0.1), position=(2.3, 0.25, 0.2), name="tip")
    ground = vv.Ground()
    weld = vv.Rigid(a=end, b=tip, at=(2, 0.25, 0.2), name="weld")
    pin = vv.Revolute(a=ground, b=rim, at=(0, 0.5, 0), axis=(0, 0, 1), name="pin")
    parts: list[Any] = [
        vv.Prescribed(solid=beam, nodes="x0", motion=("0.01*sin(9*t)", 0.0, None)),
        vv.Fixed(solid=beam, nodes=[0, 1], directions=(False, False, True)),
        vv.SymmetryPlane(solid=plate, nodes="y1", normal=(0, 1, 0)),
        vv.Traction(solid=beam, faces="z1", traction=(0, 0, 0.3), times=[[0, 0], [1, 1]]),
        vv.Pressure(solid=beam, faces="y1", pressure="2*t"),
        vv.Pressure(solid=plate, faces="all", pressure=0.3, follower=False),
        vv.BodyForce(solid=plate, force=(0.1, 0, 0)),
        vv.ElasticFoundation(solid=beam, faces="z0", normal=3.0, tangential=1.0, damping=0.1),
        vv.Force(on=beam.point((1.1, 0.2, 0.3)), force=(0, 0.2, 0)),
        vv.Spring(a=ground.point((1, 1, 1)), b=beam.point((1.0, 0.5, 0.4)), stiffness=2.0),
        vv.Gravity(acceleration=(0, -0.3, 0)),
    ]
    options = vv.Newton(linear=vv.Direct(memory_limit=1e12))
    probes: dict[str, Any] = {
        "rise": vv.Displacement(of=beam.point((2, 0, 0)), direction=(0, 0, 1)),
        "speed": vv.Velocity(of=plate, at=(1, 1, 0)),
        "stress": vv.FieldAt(solid=beam, field="cauchy", at=(0.4, 0.1, 0.2)),
        "worst": vv.Extreme(solid=beam, field="von_mises"),
        "held": vv.SupportForce(solid=beam, nodes="x0"),
        "moment": vv.SupportTorque(solid=beam, nodes="x0", about=(0, 0.25, 0.2)),
        "cut": vv.SectionForce(solid=beam, point=(1, 0, 0), normal=(1, 0, 0)),
        "bend": vv.SectionTorque(solid=beam, point=(1, 0, 0), normal=(1, 0, 0)),
        "weld": vv.ReactionForce(joint=weld),
        "pin": vv.ReactionTorque(joint=pin),
    }
    system = vv.System([beam, plate, end, rim, tip, ground, weld, pin, *parts], options)
    return vv.Study(system, until=0.1, step=0.02, probes=probes, title="solids")


def march(study: vv.Study) -> bytes:
    vv.simulate(study.system, until=study.until, step=study.step, project=True)
    return bytes(study.system.x.tobytes() + study.system.v.tobytes())


@pytest.mark.parametrize("suffix", [".yaml", ".toml"])
def test_solids_round_trip_to_identical_bits(suffix: str, tmp_path: Path) -> None:
    study = composed()
    write_scene(study, tmp_path / f"one{suffix}")
    again = read_scene(tmp_path / f"one{suffix}")
    write_scene(again, tmp_path / f"two{suffix}")
    assert (tmp_path / f"one{suffix}").read_text() == (tmp_path / f"two{suffix}").read_text()
    assert again.system.newton == study.system.newton
    assert march(again) == march(study)
    assert list(again.probes) == list(study.probes)
    for name in study.probes:
        values = [s.probes[name](s.system) for s in (study, again)]  # type: ignore[operator]
        np.testing.assert_array_equal(*values)
        assert np.any(values[0] != 0), name


def test_the_schema_holds_for_solids(tmp_path: Path) -> None:
    write_scene(composed(), tmp_path / "one.yaml")
    jsonschema.validate(yaml.safe_load((tmp_path / "one.yaml").read_text()), scene_schema())


def test_meshes_from_files_round_trip(tmp_path: Path) -> None:
    vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2)).build().write(tmp_path / "box.vtu")
    (tmp_path / "scene.yaml").write_text(
        "system:\n"
        "  block: {Solid: {mesh: {MeshFile: {path: box.vtu}}, density: 1.0,\n"
        "                  material: {NeoHooke: {young: 100.0, poisson: 0.3}}}}\n"
        "run: {until: 0.1, step: 0.05}\n"
    )
    study = read_scene(tmp_path / "scene.yaml")
    assert study.system.n_coordinates == 81
    write_scene(study, tmp_path / "sub.yaml")
    assert read_scene(tmp_path / "sub.yaml").system.n_coordinates == 81


SCENE = """
title: block
system:
  block:
    Solid:
      mesh: {BoxMesh: {size: [1, 1, 1], counts: [2, 2, 2]}}
      material: {NeoHooke: {young: 100.0, poisson: 0.3}}
      density: 1.0
  floor: {Fixed: {solid: block, nodes: z0}}
  push: {Traction: {solid: block, faces: z1, traction: [0, 0, -1], times: t}}
  frame: {RigidCoupling: {solid: block, faces: x1}}
newton: {linear: {Direct: {memory_limit: 1.0e12}}}
run: {until: 1.0, step: 0.5}
probes:
  stress: {FieldAt: {solid: block, field: von_mises, at: [0.5, 0.5, 0.5]}}
  held: {SupportForce: {solid: block, nodes: z0}}
"""


def refused(text: str, tmp_path: Path) -> str:
    (tmp_path / "scene.yaml").write_text(text)
    with pytest.raises(vv.InputError) as caught:
        read_scene(tmp_path / "scene.yaml")
    return str(caught.value)


@pytest.mark.parametrize(
    ("line", "old", "new", "words"),
    [
        (5, "Solid:", "Solit:", "did you mean 'Solid'"),
        (6, "BoxMesh", "BoxMash", "did you mean 'BoxMesh'"),
        (6, "counts", "count", "did you mean 'counts'"),
        (7, "NeoHooke", "NeoHook", "did you mean 'NeoHooke'"),
        (7, "young", "youngs", "did you mean 'young'"),
        (8, "density", "densty", "did you mean 'density'"),
        (9, "solid: block", "solid: blok", "did you mean 'block'"),
        (9, "nodes: z0", "nodes: zz0", "no set of nodes or faces 'zz0'; did you mean 'z0'"),
        (10, "faces: z1", "faces: zz1", "no set of faces 'zz1'; did you mean 'z1'"),
        (10, "Traction", "Tracton", "did you mean 'Traction'"),
        (10, "traction:", "tractions:", "did you mean 'traction'"),
        (11, "RigidCoupling", "RigidCuopling", "did you mean 'RigidCoupling'"),
        (11, "faces: x1", "faces: xx1", "did you mean 'x1'"),
        (12, "linear:", "linar:", "did you mean 'linear'"),
        (12, "Direct", "Dirct", "did you mean 'Direct'"),
        (12, "memory_limit", "memory_limt", "did you mean 'memory_limit'"),
        (15, "FieldAt", "FielAt", "did you mean 'FieldAt'"),
        (15, "von_mises", "von_misses", "did you mean 'von_mises'"),
        (16, "SupportForce", "SupportForces", "did you mean 'SupportForce'"),
        (16, "nodes: z0", "nodes: zz0", "did you mean 'z0'"),
    ],
)
def test_wrong_names_give_line_and_nearest_valid_name(
    line: int, old: str, new: str, words: str, tmp_path: Path
) -> None:
    lines = SCENE.splitlines()
    assert old in lines[line - 1], lines[line - 1]
    lines[line - 1] = lines[line - 1].replace(old, new)
    message = refused("\n".join(lines), tmp_path)
    assert f"scene.yaml:{line}: " in message
    assert words in message


def test_values_out_of_range_give_line_and_value(tmp_path: Path) -> None:
    message = refused(SCENE.replace("poisson: 0.3", "poisson: 0.5"), tmp_path)
    assert "Solid 'block': its material is incompressible" in message
    message = refused(SCENE.replace("poisson: 0.3", "poisson: 0.7"), tmp_path)
    assert "scene.yaml:7: " in message
    assert "poisson = 0.7 is outside" in message
    message = refused(SCENE.replace("density: 1.0", "density: -1.0"), tmp_path)
    assert "density = -1 is negative" in message


def test_functions_of_python_are_refused_by_name(tmp_path: Path) -> None:
    block = vv.Solid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)),
        material=vv.NeoHooke(young=1, poisson=0.3),
        name="block",
    )
    for load, words in (
        (
            vv.Traction(solid=block, faces="x1", traction=lambda t, X: X, name="pull"),
            "Traction 'pull': traction",
        ),
        (
            vv.Prescribed(solid=block, nodes="x1", motion=lambda t, X: X, name="move"),
            "Prescribed 'move': motion",
        ),
        (vv.Pressure(solid=block, faces="x1", pressure=lambda t: t, name="gas"), "Pressure 'gas': pressure"),
    ):
        with pytest.raises(vv.InputError, match=words):
            write_scene(vv.System([block, load]), tmp_path / "no.yaml")
        del block._system  # type: ignore[attr-defined]
