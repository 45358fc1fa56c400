"""A scene neither runs scripts nor reads outside of its folder unless who reads it says so."""

from __future__ import annotations

import builtins
import io
from pathlib import Path
from typing import Any

import pytest

import visviva as vv
from visviva.cli import main
from visviva.scene import read_scene, scene_schema, write_scene

SCENE = """
system:
  plate: {Solid: {mesh: {MeshFile: {path: PATH}}, material: {NeoHooke: {young: 1.0, poisson: 0.3}}, density: 1.0}}
run: {until: 1.0, step: 0.1}
"""
BODY = """
system:
  rock: {RigidBody: {shape: {SurfaceMesh: {file: PATH}}, density: 1.0}}
run: {until: 1.0, step: 0.1}
"""
TETRAHEDRON = """mtllib secret.mtl
v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
f 1 3 2
f 1 2 4
f 1 4 3
f 2 3 4
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "scene").mkdir()
    vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)).build().write(tmp_path / "box.inp")
    (tmp_path / "rock.obj").write_text(TETRAHEDRON)
    return tmp_path / "scene"


def scene(folder: Path, path: str | Path, text: str = SCENE) -> Path:
    file = folder / "scene.yaml"
    file.write_text(text.replace("PATH", str(path)))
    return file


def script(folder: Path) -> Path:
    """A script of Gmsh that leaves a file behind when it is run."""
    (folder / "plate.geo").write_text(
        f'SystemCall "touch {folder}/ran";\n'
        "Point(1) = {0, 0, 0, 1}; Point(2) = {1, 0, 0, 1}; Point(3) = {0, 1, 0, 1};\n"
        "Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 1};\n"
        "Curve Loop(1) = {1, 2, 3}; Plane Surface(1) = {1};\n"
    )
    return folder / "ran"


@pytest.mark.parametrize("command", ["check", "run"])
def test_no_script_is_run_unless_trusted(
    command: str, folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("gmsh")
    monkeypatch.chdir(folder)
    ran, file = script(folder), scene(folder, "plate.geo")
    assert main([command, str(file)]) == 2
    told = capsys.readouterr().err
    assert f"{file}:3" in told
    assert "can run any command" in told
    assert "--trust" in told
    assert not ran.exists()
    assert main([command, str(file), "--trust", *(["--until", "0.1"] if command == "run" else [])]) == 0
    assert ran.exists()


def test_a_scene_cannot_trust_itself(folder: Path) -> None:
    ran = script(folder)
    for key, value in (("trust", "true"), ("within", "/")):
        file = scene(folder, f"plate.geo, {key}: {value}")
        with pytest.raises(vv.InputError, match=f"{key}: unknown key"):
            read_scene(file)
        with pytest.raises(vv.InputError, match="unknown key"):
            read_scene(scene(folder, "plate.geo"), {f"plate.mesh.{key}": True})
    assert not {"trust", "within"} & set(scene_schema()["$defs"]["MeshFile"]["properties"])
    assert not ran.exists()


def test_python_trusts_a_script_by_an_argument(folder: Path) -> None:
    pytest.importorskip("gmsh")
    ran = script(folder)
    with pytest.raises(vv.InputError, match=r"trust=True"):
        vv.MeshFile(folder / "plate.geo").build()
    assert not ran.exists()
    assert vv.MeshFile(folder / "plate.geo", trust=True).build().volume == pytest.approx(0.5)
    assert read_scene(scene(folder, "plate.geo"), trust=True).system.components[0].grid.n_nodes > 2


@pytest.mark.parametrize("text", [SCENE, BODY], ids=["mesh", "shape"])
def test_nothing_outside_is_read_unless_allowed(
    text: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    name = "box.inp" if text is SCENE else "rock.obj"
    (folder / "link").symlink_to(folder.parent)
    for path in (f"../{name}", folder.parent / name, f"link/{name}", f"../scene/../{name}"):
        file = scene(folder, path, text)
        with pytest.raises(vv.InputError, match=r"outside the scene's folder.*--allow-outside"):
            read_scene(file)
        assert main(["check", str(file)]) == 2
        assert "--allow-outside" in capsys.readouterr().err
        read_scene(file, allow_outside=True)
        assert main(["check", str(file), "--allow-outside"]) == 0
    (folder / name).write_bytes((folder.parent / name).read_bytes())
    for path in (name, folder / name, f"../scene/{name}"):
        read_scene(scene(folder, path, text))


def test_included_files_and_formats_that_name_files_stay_inside(folder: Path) -> None:
    (folder / "part.inp").write_text("*INCLUDE, INPUT=../box.inp\n")
    with pytest.raises(vv.InputError, match=r"part\.inp includes .*box\.inp is outside the scene's folder"):
        read_scene(scene(folder, "part.inp"))
    read_scene(scene(folder, "part.inp"), allow_outside=True)
    (folder / "part.xdmf").write_text("<Xdmf/>")
    with pytest.raises(vv.InputError, match=r"can name others to be read"):
        read_scene(scene(folder, "part.xdmf"))
    (folder / "part.inp").write_text("*INCLUDE, INPUT=part.inp\n")
    with pytest.raises(vv.InputError, match="does it include itself"):
        read_scene(scene(folder, "part.inp"))


def test_materials_named_by_a_surface_are_not_read(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Only the file itself is opened."""
    opened: list[str] = []
    real = io.open

    def watched(file: Any, *args: Any, **options: Any) -> Any:
        opened.append(str(file))
        return real(file, *args, **options)

    (folder / "rock.obj").write_text(TETRAHEDRON)
    (folder / "secret.mtl").write_text("newmtl a\n")
    monkeypatch.setattr(io, "open", watched)
    monkeypatch.setattr(builtins, "open", watched)
    vv.SurfaceMesh(file=folder / "rock.obj")
    assert [name for name in opened if "rock.obj" in name]
    assert not [name for name in opened if "secret" in name]


def test_shapes_are_read_by_their_named_format_alone(folder: Path) -> None:
    (folder / "part.step").write_text("ISO-10303-21;")
    with pytest.raises(vv.InputError, match="cannot be read as a mesh by its ending"):
        vv.SurfaceMesh(file=folder / "part.step")


def test_names_that_no_file_can_have_are_refused(folder: Path) -> None:
    for name in ("a" * 300 + ".msh", "b/" * 3000 + "c.inp"):
        with pytest.raises(vv.InputError, match=r"there is no mesh file|outside"):
            read_scene(scene(folder, name))
        with pytest.raises(vv.InputError, match="there is no mesh file"):
            vv.MeshFile(name).build()
        with pytest.raises(vv.InputError, match="there is no mesh file"):
            vv.SurfaceMesh(file=name)


def test_what_is_written_reads_back_without_permissions(folder: Path) -> None:
    (folder / "box.inp").write_bytes((folder.parent / "box.inp").read_bytes())
    system = read_scene(scene(folder, "box.inp"), allow_outside=True, trust=True).system
    write_scene(system, folder / "again.yaml")
    assert "trust" not in (folder / "again.yaml").read_text()
    read_scene(folder / "again.yaml")
