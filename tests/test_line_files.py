"""Lines of beams in mesh files: round trips, files of other programs, parts of them, beams from them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import visviva as vv

ROD = vv.TubeSection(radius=0.01, young=2e11)
GMSH = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
4
0 3 "start"
1 1 "legs"
1 2 "arm"
2 4 "plate"
$EndPhysicalNames
$Nodes
6
1 0 0 0
2 1 0 0
3 2 0 0
4 2 1 0
5 0 0 1
6 1 0 1
$EndNodes
$Elements
5
1 15 2 3 1 1
2 1 2 1 1 1 2
3 1 2 1 1 2 3
4 1 2 2 2 3 4
{plate}$EndElements
"""
PLATE = "5 3 2 4 1 1 2 6 5\n"
ABAQUS = """*NODE
1, 0., 0., 0.
2, 1., .1, 0.
3, 2., 0., 0.
4, 3., -.1, 0.
5, 4., 0., 0.
*ELEMENT, TYPE=B32, ELSET=rail
1, 1, 2, 3
2, 3, 4, 5
*NSET, NSET=end
5
"""


@pytest.mark.parametrize("ending", [".vtu", ".vtk", ".msh", ".inp"])
@pytest.mark.parametrize("cell", ["line2", "line3", "line4"])
def test_round_trip(cell: str, ending: str, tmp_path: Path) -> None:
    mesh = vv.ArcMesh(radius=1.0, angle=2.0, rise=1.0, count=3, cell=cell).build().with_cells("half", [0, 1])
    if (cell, ending) == ("line4", ".inp"):
        with pytest.raises(vv.InputError, match="cannot hold cells line4"):
            mesh.write(tmp_path / "line.inp")
        return
    mesh.write(tmp_path / f"line{ending}")
    again = vv.MeshFile(tmp_path / f"line{ending}").build()
    np.testing.assert_allclose(again.points, mesh.points, atol=1e-15)
    np.testing.assert_array_equal(again.cells[cell], mesh.cells[cell])
    assert again.nodes("end").tolist() == mesh.nodes("end").tolist()
    assert again.cell_set("half").tolist() == [0, 1]


def test_lines_of_gmsh_and_points_on_them(tmp_path: Path) -> None:
    (tmp_path / "frame.msh").write_text(GMSH.replace("{plate}", "").replace("\n5\n1 15", "\n4\n1 15"))
    mesh = vv.MeshFile(tmp_path / "frame.msh", drop_orphans=True).build()
    assert mesh.nodes("start").tolist() == [0]
    assert {name: cells.tolist() for name, cells in mesh.cell_sets.items()} == {"legs": [0, 1], "arm": [2]}
    beam = vv.Beam(mesh=mesh, section=ROD, kinks="rigid")
    assert beam.line.lengths.sum() == pytest.approx(3.0)


def test_a_part_of_a_file_with_other_cells(tmp_path: Path) -> None:
    """The legs below a plate: lines alone, without the plate's nodes."""
    (tmp_path / "frame.msh").write_text(GMSH.replace("{plate}", PLATE))
    mesh = vv.MeshFile(tmp_path / "frame.msh", part="legs").build()
    assert mesh.points.tolist() == [[0, 0, 0], [1, 0, 0], [2, 0, 0]]
    assert mesh.nodes("start").tolist() == [0]
    assert vv.Beam(mesh=mesh, section=ROD).at(1.5).tolist() == [1.5, 0, 0]
    with pytest.raises(vv.InputError, match=r"no group of cells 'leg' in it.*legs"):
        vv.MeshFile(tmp_path / "frame.msh", part="leg").build()


def test_beams_of_abaqus_have_their_middle_second(tmp_path: Path) -> None:
    (tmp_path / "rail.inp").write_text(ABAQUS)
    mesh = vv.MeshFile(tmp_path / "rail.inp").build()
    assert mesh.cells["line3"].tolist() == [[0, 2, 1], [2, 4, 3]]
    assert vv.Beam(mesh=mesh, section=ROD).line.lengths.sum() == pytest.approx(
        2 * np.sqrt(1.04) + 10 * np.arcsinh(0.2), rel=1e-6
    )
    assert mesh.nodes("end").tolist() == [4]


def test_two_coordinates_lie_in_a_plane_of_space(tmp_path: Path) -> None:
    text = "*NODE\n1, 0., 0.\n2, 1., 1.\n*ELEMENT, TYPE=B21\n1, 1, 2\n"
    (tmp_path / "plane.inp").write_text(text)
    beam = vv.Beam(mesh=vv.MeshFile(tmp_path / "plane.inp"), section=ROD)
    assert beam.points.tolist() == [[0, 0, 0], [1, 1, 0]]
