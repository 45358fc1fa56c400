"""CAD files are meshed by their named format; what is in them is geometry, and never a command."""

from __future__ import annotations

import re
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import visviva as vv
from visviva.scene import read_scene

gmsh = pytest.importorskip("gmsh")

VOLUME = 10 * 5 * 2 - 2 * np.pi
"""Of a plate with a hole of radius 1."""


def plate(occ: Any) -> None:
    occ.cut([(3, occ.addBox(0, 0, 0, 10, 5, 2))], [(3, occ.addCylinder(5, 2.5, 0, 0, 0, 2, 1))])


def two_boxes(occ: Any) -> None:
    occ.addBox(0, 0, 0, 1, 1, 1), occ.addBox(3, 0, 0, 2, 1, 1)


def square(occ: Any) -> None:
    occ.cut([(2, occ.addRectangle(0, 0, 0, 4, 4))], [(2, occ.addDisk(2, 2, 0, 1, 1))])


def shape(file: Path, draw: Callable[[Any], None] = plate, unit: str = "") -> Path:
    """A file of the shape that `draw` makes, in the format of its ending."""
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        draw(gmsh.model.occ)
        gmsh.model.occ.synchronize()
        gmsh.write(str(file))
    finally:
        gmsh.finalize()
    if unit:  # the writer knows millimetres alone
        text = file.read_text()
        assert "SI_UNIT(.MILLI.,.METRE.)" in text
        file.write_text(text.replace("SI_UNIT(.MILLI.,.METRE.)", unit))
    return file


@pytest.mark.parametrize("ending", ["step", "stp", "STEP", "iges", "igs", "brep"])
def test_shapes_are_meshed_with_their_faces(ending: str, tmp_path: Path) -> None:
    mesh = vv.MeshFile(
        shape(tmp_path / f"plate.{ending.lower()}").rename(tmp_path / f"plate.{ending}"), size=1.0
    )
    built = mesh.build().check()
    assert list(built.cells) == ["tet10"]
    assert built.volume == pytest.approx(VOLUME, rel=2e-3)  # curved cells, 8 around the hole
    areas = sorted(built.faces(f"face{k}").area(built.points) for k in range(1, 8))
    wanted = sorted([10, 10, 20, 20, 50 - np.pi, 50 - np.pi, 4 * np.pi])
    assert areas == pytest.approx(wanted, rel=1e-2)
    assert np.ptp(built.points, axis=0) == pytest.approx([10, 5, 2])


def test_cells_have_the_size_and_order_asked_for(tmp_path: Path) -> None:
    file = shape(tmp_path / "plate.step")
    coarse, fine = (vv.MeshFile(file, size=size, order=1).build() for size in (1.0, 0.5))
    assert list(fine.cells) == ["tet4"]
    assert 5 < fine.n_cells / coarse.n_cells < 11
    assert VOLUME < fine.volume < coarse.volume < 1.01 * VOLUME  # the hole is a polygon


@pytest.mark.parametrize(
    ("inside", "unit", "factor"),
    [("", "mm", 1.0), ("", None, 1.0), ("", "m", 1e-3), ("", "in", 1 / 25.4),
     ("SI_UNIT($,.METRE.)", "m", 1.0), ("SI_UNIT($,.METRE.)", "mm", 1e3)],
)  # fmt: skip
def test_lengths_are_converted_to_the_unit_of_the_mesh(
    inside: str, unit: Any, factor: float, tmp_path: Path
) -> None:
    file = shape(tmp_path / "plate.step", unit=inside)
    mesh = vv.MeshFile(file, size=2 * factor, unit=unit).build()
    assert np.ptp(mesh.points, axis=0) == pytest.approx(np.array([10, 5, 2]) * factor)
    assert mesh.n_cells < 1000


def test_several_solids_are_sets_and_parts(tmp_path: Path) -> None:
    file = shape(tmp_path / "boxes.brep", two_boxes)
    both = vv.MeshFile(file, size=0.5).build()
    assert both.volume == pytest.approx(3)
    long = vv.MeshFile(file, size=0.5, part="solid2").build()
    assert long.volume == pytest.approx(2)
    assert sum(faces.area(long.points) for faces in long.face_sets.values()) == pytest.approx(10)


def test_shapes_without_volume_are_meshed_by_triangles(tmp_path: Path) -> None:
    mesh = vv.MeshFile(shape(tmp_path / "square.brep", square), size=0.5).build().check()
    assert list(mesh.cells) == ["tri6"]
    assert mesh.volume == pytest.approx(16 - np.pi, rel=1e-3)
    sides = [mesh.faces(f"edge{k}").area(mesh.points) for k in range(1, 6)]
    assert sorted(sides) == pytest.approx([4, 4, 4, 4, 2 * np.pi], rel=1e-3)


@pytest.mark.parametrize("ending", ["step", "iges", "brep"])
def test_no_script_is_run(ending: str, tmp_path: Path) -> None:
    """Neither of a file that is one, nor of one that begins as a shape does."""
    command = f'SystemCall "touch {tmp_path}/ran";\n'
    file = tmp_path / f"plate.{ending}"
    file.write_text(command)
    with pytest.raises(vv.InputError, match=rf"it does not begin as files \*\.{ending} do"):
        vv.MeshFile(file, size=1.0).build()
    shape(file)
    whole = file.read_text()
    for text in (command + whole, whole + command, whole[:90] + "\n" + command + whole[90:]):
        file.write_text(text)
        with suppress(vv.InputError):  # what follows a whole shape may not be read
            vv.MeshFile(file, size=1.0).build()
        assert not (tmp_path / "ran").exists()


def test_torn_files_are_refused_in_a_line(tmp_path: Path) -> None:
    for ending in ("step", "iges", "brep"):
        whole = shape(tmp_path / f"plate.{ending}").read_bytes()
        for part in (0.1, 0.9, 0.97):
            file = tmp_path / f"torn.{ending}"
            file.write_bytes(whole[: int(part * len(whole))])
            with pytest.raises(vv.InputError, match=r"cannot be used as a mesh") as error:
                vv.MeshFile(file, size=1.0).build()
            assert "\n" not in str(error.value)


def test_damage_amid_a_file_is_told(tmp_path: Path) -> None:
    """An entity whose name is gone, a line that is gone."""
    file = shape(tmp_path / "plate.step")
    file.write_text(re.sub(r"#\d+ = FACE_BOUND", "= ", file.read_text(), count=1))
    with pytest.raises(vv.InputError, match=r"its reader finds it damaged \(ERR StepFile"):
        vv.MeshFile(file, size=1.0).build()
    file = shape(tmp_path / "plate.iges")
    lines = file.read_text().splitlines(keepends=True)
    file.write_text("".join(lines[:60] + lines[61:]))
    with pytest.raises(vv.InputError, match=r"does not end as files \*\.iges do"):
        vv.MeshFile(file, size=1.0).build()


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        ("plate.step", {}, r"say the size of its cells"),
        ("plate.brep", {"size": 1.0, "unit": "m"}, r"know no unit of length"),
        ("plate.step", {"size": 1e-3}, r"cells of the size 0\.001 would be .* a volume of 93\.7"),
        ("plate.x_t", {"size": 1.0}, r"size only tell how CAD files \(\.step.*\) are meshed"),
        ("plate.x_t", {}, r"meshio cannot read it"),
        ("plate.msh", {"order": 2, "unit": "m"}, r"order and unit only tell how CAD files"),
    ],
)
def test_what_cannot_be_meant_is_refused(name: str, options: Any, message: str, tmp_path: Path) -> None:
    shape(tmp_path / "plate.step"), shape(tmp_path / "plate.brep")
    (tmp_path / "plate.x_t").write_text("**ABCDEFGHIJKLMNOPQRSTUVWXYZ"), (tmp_path / "plate.msh").touch()
    with pytest.raises(vv.InputError, match=message):
        vv.MeshFile(tmp_path / name, **options).build()


def test_a_package_that_cannot_be_loaded_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = shape(tmp_path / "plate.step")
    (tmp_path / "gmsh.py").write_text("raise OSError('libGLU.so.1: cannot open shared object file')")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    with pytest.raises(vv.InputError, match=r"need the package gmsh: pip install .visviva\[gmsh\]. \(libGLU"):
        vv.MeshFile(file, size=1.0).build()


def test_scenes_mesh_files_of_their_folder_that_name_no_others(tmp_path: Path) -> None:
    file = shape(tmp_path / "plate.step")
    scene = tmp_path / "scene.yaml"
    scene.write_text("""
system:
  plate: {Solid: {mesh: {MeshFile: {path: plate.step, size: 0.002, unit: m}}, material: {NeoHooke: {young: 1.0, poisson: 0.3}}}}
run: {until: 1.0, step: 0.1}
""")  # noqa: E501
    assert read_scene(scene).system.components[0].grid.volume == pytest.approx(1e-9 * VOLUME, rel=5e-3)
    text = file.read_text()
    file.write_text(
        text.replace(
            "ENDSEC;\nEND-ISO", "#9999 = DOCUMENT_FILE('../secret','','',#1,'',$);\nENDSEC;\nEND-ISO"
        )
    )
    assert "DOCUMENT_FILE" in file.read_text()
    with pytest.raises(vv.InputError, match=r"it names other files.*--allow-outside"):
        read_scene(scene)
