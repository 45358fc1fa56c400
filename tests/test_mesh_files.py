"""Mesh files: round trips of every cell type with all sets, files of other programs, refusals."""

from __future__ import annotations

import builtins
import sys
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_mesh import PLANES, SOLIDS, enclosed

import visviva as vv
from visviva.mesh.cells import CELLS
from visviva.scene import read_scene, write_scene

PLATE = Path(__file__).parent / "data" / "plate.msh"


def all_sets(mesh: vv.Mesh) -> dict[str, Any]:
    """All sets in a form that can be compared, without the order of faces."""
    found: dict[str, Any] = {}
    for name, faces in mesh.face_sets.items():
        rows = [np.column_stack([faces.owners[k], faces.cells[k]]).tolist() for k in faces.cells]
        found["faces", name] = sorted(row for part in rows for row in part)
    found |= {("nodes", name): members.tolist() for name, members in mesh.node_sets.items()}
    return found | {("cells", name): members.tolist() for name, members in mesh.cell_sets.items()}


def sample(cell: str) -> vv.Mesh:
    """A mesh with sets of all kinds; faces are in two sets, cells in two or none."""
    if cell in SOLIDS:
        mesh = vv.BoxMesh(size=(1, 2, 3), counts=(2, 3, 2), cell=cell).build()
    else:
        mesh = vv.RectangleMesh(size=(1, 2), counts=(2, 3), cell=cell).build()
    mesh = mesh.with_nodes("tip", [0, 3]).with_nodes("far end", lambda X: X[:, 1] == 2)
    mesh = mesh.with_cells("low", lambda X: X[:, 1] < 1).with_cells("left", lambda X: X[:, 0] < 0.5)
    return mesh.with_faces("all", mesh.boundary())


@pytest.mark.parametrize("ending", [".vtu", ".vtk", ".msh", ".inp", ".med"])
@pytest.mark.parametrize("cell", SOLIDS + PLANES)
def test_round_trip(cell: str, ending: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mesh = sample(cell)
    if ending == ".med" and cell in ("hex27", "quad9"):
        with pytest.raises(vv.InputError, match="meshio cannot write"):
            mesh.write(tmp_path / "mesh.med")
        return
    mesh.write(tmp_path / f"mesh{ending}")
    again = vv.MeshFile(tmp_path / f"mesh{ending}").build().check()
    np.testing.assert_array_equal(again.points, mesh.points)
    assert list(again.cells) == [cell]
    np.testing.assert_array_equal(again.cells[cell], mesh.cells[cell])
    assert all_sets(again) == all_sets(mesh)
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize("ending", [".vtu", ".msh", ".inp", ".med"])
def test_round_trip_of_several_types(ending: str, tmp_path: Path) -> None:
    hexes = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2)).build().with_cells("soft", lambda X: X[:, 0] < 0.5)
    wedges = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2), cell="wedge6", origin=(0, 0, 1)).build()
    mesh = hexes.merged(wedges.with_cells("soft", [2, 3]), weld=1e-9)
    mesh.write(tmp_path / f"mesh{ending}")
    again = vv.MeshFile(tmp_path / f"mesh{ending}").build().check()
    assert list(again.cells) == ["hex8", "wedge6"]
    # Faces between both parts, which only one of their cells can own, are not compared.
    ours, theirs = ({k: v for k, v in all_sets(m).items() if k[1] not in ("z0", "z1")} for m in (mesh, again))
    assert theirs == ours
    assert again.volume == pytest.approx(2)


@pytest.mark.parametrize("cell", SOLIDS + PLANES)
def test_vtk_reads_what_is_written(cell: str, tmp_path: Path) -> None:
    pyvista = pytest.importorskip("pyvista")
    mesh = sample(cell)
    mesh.write(tmp_path / "mesh.vtu")
    grid = pyvista.read(tmp_path / "mesh.vtu").extract_cells(range(mesh.n_cells))
    sizes = grid.compute_cell_sizes()
    total = sizes["Volume"].sum() if cell in SOLIDS else sizes["Area"].sum()
    assert abs(total) == pytest.approx(mesh.volume, rel=1e-6)
    assert grid.cell_data["low"].sum() == len(mesh.cell_set("low"))


def test_gmsh_file() -> None:
    """Written by Gmsh 4.15: a square of edge 2 without a quarter circle about a corner."""
    mesh = vv.MeshFile(PLATE).build().check()
    assert mesh.points.shape == (11, 2)
    lengths = {name: mesh.faces(name).area(mesh.points) for name in mesh.face_sets}
    chords = 4 * np.sin(np.pi / 8)
    assert lengths == pytest.approx({"hole": chords, "symmetry": 2, "edges": 4, "77": 2})
    assert mesh.volume == pytest.approx(4 - np.sin(np.pi / 4))
    assert mesh.points[mesh.nodes("corner")].tolist() == [[2, 2]]
    assert len(mesh.cell_set("plate")) == mesh.n_cells
    assert enclosed(mesh, mesh.faces("hole")) < 0  # the outside of the plate is towards the origin
    assert enclosed(mesh, mesh.boundary()) == pytest.approx(mesh.volume)


# A cube under a wedge with the keywords of a typical file: sets by ranges, by names, by elements;
# a surface by elements and by sets; lines that go on; capitals that do not matter; things that do not concern a mesh.
INPUT = """*Heading
 ** a comment
*Node, nset=ALL
 10, 0., 0., 0.
 20, 1., 0., 0.
 30, 1., 1., 0.
 40, 0., 1., 0.
 50, 0., 0., 1.
 60, 1., 0., 1.
 70, 1., 1., 1.
 80, 0., 1., 1.
 90, 0., .5, 2.
 91, 1., .5, 2.
*Element, type=C3D8R, elset=Cube
 7, 10, 20, 30, 40,
 50, 60, 70, 80
*Element, type=C3D6
 8, 50, 80, 90, 60, 70, 91
*Include, input=sets.inp
*Material, name=steel
*Elastic
 2.1e5, 0.3
"""
SETS = """*Nset, nset=bottom, generate
 10, 40, 10
*NSET, NSET="both ends"
 BOTTOM, 90
 91,
*Nset, nset=of cube, elset=CUBE
*Elset, elset=every
 cube, 8
*Surface, type=element,
 name=sides
 cube, S3
 8, S1
*Surface, name=free
 every,
*Surface, type=node, name=tips
 90,
 91,
"""


def write_input(folder: Path, text: str = INPUT, sets: str = SETS) -> Path:
    """The file above, or a change of it."""
    (folder / "sets.inp").write_text(sets)
    (folder / "mesh.inp").write_text(text)
    return folder / "mesh.inp"


def test_abaqus_file(tmp_path: Path) -> None:
    mesh = vv.MeshFile(write_input(tmp_path)).build().check()
    assert {name: len(rows) for name, rows in mesh.cells.items()} == {"hex8": 1, "wedge6": 1}
    assert mesh.volume == pytest.approx(1.5)
    nodes = {name: mesh.nodes(name).tolist() for name in mesh.node_sets}
    assert nodes == {
        "ALL": list(range(10)),
        "bottom": [0, 1, 2, 3],
        "both ends": [0, 1, 2, 3, 8, 9],
        "of cube": list(range(8)),
        "tips": [8, 9],
    }
    assert {name: members.tolist() for name, members in mesh.cell_sets.items()} == {
        "Cube": [0],
        "every": [0, 1],
    }
    sides = mesh.faces("sides")
    assert sides.cells["quad4"].tolist() == [[0, 1, 5, 4]]
    assert set(sides.cells["tri3"][0]) == {4, 7, 8}
    assert {kind: owner.tolist() for kind, owner in sides.owners.items()} == {"quad4": [0], "tri3": [1]}
    assert enclosed(mesh, mesh.faces("free")) == pytest.approx(1.5)


def test_sets_whose_names_differ_in_capitals_are_one(tmp_path: Path) -> None:
    """Under the name as it was first written; names in quotes are kept apart."""
    more = """*Nset, nset=TOP
 50, 60
*Nset, nset=top
 70, 80
*Nset, nset="Top"
 90,
*Elset, elset=CUBE
 8,
*Surface, name=Free
 cube, S1
*Surface, name=FREE
 7, S2
"""
    file = write_input(tmp_path, sets=SETS.replace("*Surface, name=free\n every,\n", "") + more)
    mesh = vv.MeshFile(file).build()
    assert mesh.nodes("TOP").tolist() == [4, 5, 6, 7]
    assert mesh.nodes("Top").tolist() == [8]
    assert "top" not in mesh.node_sets
    assert mesh.cell_sets["Cube"].tolist() == [0, 1]
    assert set(mesh.face_sets) == {"sides", "Free"}
    assert len(mesh.faces("Free").cells["quad4"]) == 2


def test_an_instance_stands_where_its_part_was_moved_and_turned(tmp_path: Path) -> None:
    """A translation first, then a turn about the axis through (1, 0, 0) and (1, 2, 0)."""
    instance = "*Instance, name=i, part=P\n 1., 0., 3.\n 1., 0., 0., 1., 2., 0., 90.\n*End instance\n"
    part = vv.MeshFile(write_input(tmp_path, "*Part, name=p\n" + INPUT)).build()
    assembled = "*Part, name=p\n" + INPUT.replace("*Material", "*End part\n" + instance + "*Material")
    moved = vv.MeshFile(write_input(tmp_path, assembled)).build()
    x, y, z = (part.points + np.array([0.0, 0.0, 3.0])).T  # seen from the axis
    np.testing.assert_allclose(moved.points, np.column_stack([z + 1.0, y, -x]), atol=1e-14)
    assert moved.check().volume == pytest.approx(part.volume)


ASSEMBLY = """*Part, name=Cube
*Node
 1, 0., 0., 0.
 2, 1., 0., 0.
 3, 1., 1., 0.
 4, 0., 1., 0.
 5, 0., 0., 1.
 6, 1., 0., 1.
 7, 1., 1., 1.
 8, 0., 1., 1.
*Element, type=C3D8, elset=Whole
 1, 1, 2, 3, 4, 5, 6, 7, 8
*Nset, nset=Bottom, generate
 1, 4, 1
*Surface, name=Top
 1, S2
*End Part
*Part, name=Pin
*Node
 1, 0., 0., 0.
 2, .5, 0., 0.
 3, 0., .5, 0.
 4, 0., 0., .5
*Element, type=C3D4
 1, 1, 2, 3, 4
*End Part
*Assembly, name=Assembly
*Instance, name=Lower, part=Cube
*End Instance
*Instance, name=Upper, part=cube
 0., 0., 1.
*End Instance
*Instance, name=Pin-1, part=Pin
 3., 0., 0.
*Node
 9, 1., 0., 0.
*End Instance
*Node
 1, 9., 9., 9.
*Nset, nset=joined, instance=Upper
 Bottom,
*Nset, nset=joined, instance=Lower
 5, 6
*Elset, elset=_outer_S1, internal, instance=lower
 1,
*Surface, name=outer
 _outer_S1, S1
 Upper.Whole, S2
*Nset, nset=tip
 Pin-1.4,
*End Assembly
"""


def test_several_instances(tmp_path: Path) -> None:
    """Every instance where it stands, with numbers and sets of its own; sets of the assembly across them."""
    (tmp_path / "mesh.inp").write_text(ASSEMBLY)
    mesh = vv.MeshFile(tmp_path / "mesh.inp", drop_orphans=True).build().check()
    assert mesh.volume == pytest.approx(2 + 0.5**3 / 6)
    assert mesh.points[mesh.nodes("Lower.Bottom")][:, 2].tolist() == [0.0] * 4
    assert mesh.points[mesh.nodes("Upper.Bottom")][:, 2].tolist() == [1.0] * 4
    upper = mesh.points[8:12]
    assert mesh.points[mesh.nodes("joined")].tolist() == [[0, 0, 1], [1, 0, 1], *upper.tolist()]
    assert mesh.points[mesh.nodes("tip")].tolist() == [[3.0, 0.0, 0.5]]
    assert mesh.faces("outer").centres(mesh.points).tolist() == [[0.5, 0.5, 0.0], [0.5, 0.5, 2.0]]
    assert mesh.faces("Upper.Top").centres(mesh.points)[0, 2] == 2.0
    volumes = {name: mesh.volumes[mesh.cell_set(name)].sum() for name in ("Lower", "Upper", "Pin-1")}
    assert volumes == pytest.approx({"Lower": 1.0, "Upper": 1.0, "Pin-1": 0.5**3 / 6})


def test_one_of_several_instances_is_a_mesh_of_its_own(tmp_path: Path) -> None:
    (tmp_path / "mesh.inp").write_text(ASSEMBLY)
    upper = vv.MeshFile(tmp_path / "mesh.inp", part="Upper").build().check()
    assert upper.n_cells == 1
    assert upper.faces("outer").centres(upper.points).tolist() == [[0.5, 0.5, 2.0]]
    assert set(upper.node_sets) == {"Upper.Bottom", "joined"}
    assert set(upper.face_sets) == {"Upper.Top", "outer"}


@pytest.mark.parametrize(
    ("lines", "shift"),
    [(" , , 5.\n", (0, 0, 5)), (" 0., ,5.D0\n", (0, 0, 5)), (" 1.\n", (1, 0, 0)), (" , , ,\n", (0, 0, 0))],
)
def test_numbers_left_blank_are_zero(tmp_path: Path, lines: str, shift: tuple[float, ...]) -> None:
    part = vv.MeshFile(write_input(tmp_path, "*Part, name=p\n" + INPUT)).build()
    instance = f"*End part\n*Instance, name=i, part=p\n{lines}*End instance\n*Material"
    blank = INPUT.replace(" 20, 1., 0., 0.", " 20, 1.0d0, , 0.,").replace("*Material", instance)
    moved = vv.MeshFile(write_input(tmp_path, "*Part, name=p\n" + blank)).build()
    np.testing.assert_allclose(moved.points, part.points + shift, atol=1e-15)


def test_an_instance_may_only_be_turned(tmp_path: Path) -> None:
    """The line of its translation is blank."""
    part = vv.MeshFile(write_input(tmp_path, "*Part, name=p\n" + INPUT)).build()
    turn = "*End part\n*Instance, name=i, part=p\n\n 0., 0., 0., 0., 0., 1., 90.\n*End instance\n*Material"
    turned = vv.MeshFile(write_input(tmp_path, "*Part, name=p\n" + INPUT.replace("*Material", turn))).build()
    x, y, z = part.points.T
    np.testing.assert_allclose(turned.points, np.column_stack([-y, x, z]), atol=1e-14)


def test_plane_parts_stay_in_their_plane(tmp_path: Path) -> None:
    cell = "*Part, name=p\n*Node\n 1, 0., 0.\n 2, 1., 0.\n 3, 0., 1.\n*Element, type=CPE3\n 1, 1, 2, 3\n*End part\n"
    plane = cell + "*Instance, name=i, part=p\n 1., 2.\n"
    turned = vv.MeshFile(write_input(tmp_path, plane + " 1., 2., 0., 1., 2., 1., 90.\n")).build()
    np.testing.assert_allclose(turned.points, [[1, 2], [1, 3], [0, 2]], atol=1e-15)
    with pytest.raises(vv.InputError, match="out of its plane"):
        vv.MeshFile(write_input(tmp_path, plane + " 0., 0., 0., 1., 0., 0., 90.\n")).build()


BAD_INPUTS = {
    "cells made by a rule": (
        ("*Nset", "*Elgen, elset=Cube\n 1, 2, 1, 1\n*Nset"),
        "ELGEN makes or moves nodes",
    ),
    "moved system": (("*Node", "*System\n 1., 2., 3.\n*Node"), "SYSTEM makes or moves nodes"),
    "cylindrical coordinates": (("*Node", "*Node, system=C"), "only Cartesian coordinates"),
    "unknown element": (("C3D8R", "C3D15"), "'C3D15' are unknown"),
    "too few nodes": (("50, 60, 70, 80\n", "50, 60, 70\n"), "C3D8R do not have 8 nodes each"),
    "unknown node": (("50, 60, 70, 80\n", "50, 60, 70, 81\n"), "no node 81"),
    "node twice": ((" 20, 1.", " 10, 1."), "node 10 is there twice"),
    "mixed coordinates": ((" 20, 1., 0., 0.", " 20, 1., 0."), "some nodes have two coordinates"),
    "unknown set": ((" cube, 8", " cubes, 8"), "set of elements 'cubes' before its use; did you mean 'Cube'"),
    "unknown side": (("cube, S3", "cube, SPOS"), "takes side SPOS"),
    "no such side": (("8, S1", "8, S6"), "wedge6 has no side S6"),
    "word for a number": ((" 90, 0., .5", " 90, zero, .5"), "NODE.*zero"),
    "parts without instances": (
        ("*Material", "*Part, name=a\n*Part, name=b\n*Material"),
        "no .INSTANCE says where",
    ),
    "unknown part": (
        ("*Material", "*Part, name=a\n*Instance, name=i, part=aa\n*Material"),
        "no part 'aa'.*mean 'a'",
    ),
    "instance twice": (
        ("*Material", "*Part, name=a\n*Instance, name=i, part=a\n*Instance, name=i, part=a\n*Material"),
        "an instance of this name already",
    ),
    "part twice": (("*Material", "*Part, name=a\n*Part, name=A\n*Material"), "a part of this name already"),
    "unknown instance": (("*Nset, nset=bottom", "*Nset, instance=i, nset=bottom"), "no instance 'i'"),
    "missing file": (("sets.inp", "nothing.inp"), "does not exist"),
    "no name": (("nset=bottom, ", ""), "NSET"),
}


@pytest.mark.parametrize(("change", "message"), BAD_INPUTS.values(), ids=BAD_INPUTS)
def test_bad_abaqus_files(change: tuple[str, str], message: str, tmp_path: Path) -> None:
    assert change[0] in INPUT + SETS
    file = write_input(tmp_path, INPUT.replace(*change), SETS.replace(*change))
    with pytest.raises(vv.InputError, match=message) as caught:
        vv.MeshFile(file).build()
    assert "mesh.inp" in str(caught.value)


def med_and_nastran(folder: Path) -> tuple[Path, Path]:
    """A brick with groups of cells, faces and nodes, and two bars with properties."""
    import meshio

    corners = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)).build()
    brick, faces = corners.cells["hex8"], corners.boundary().cells["quad4"]
    tags = {"cell_tags": [np.array([-1]), np.array([-2, -3, -2, 0, 0, 0])]}
    on_points = {"point_tags": np.array([1, 1, 0, 0, 0, 0, 0, 2])}
    made = meshio.Mesh(corners.points, [("hexahedron", brick), ("quad", faces)], on_points, tags)
    made.cell_tags = {-1: ["steel"], -2: ["held", "both"], -3: ["loaded", "both"]}
    made.point_tags = {1: ["edge", "marked"], 2: ["marked"]}
    meshio.write(folder / "brick.med", made)
    bars = vv.BoxMesh(size=(3, 1, 1), counts=(3, 1, 1)).build()
    of_nastran = {"nastran:ref": [np.array([4, 4, 9])]}
    meshio.write_points_cells(
        folder / "bars.bdf", bars.points, [("hexahedron", bars.cells["hex8"])], cell_data=of_nastran
    )
    return folder / "brick.med", folder / "bars.bdf"


def test_groups_of_med_and_properties_of_nastran(tmp_path: Path) -> None:
    med, nastran = med_and_nastran(tmp_path)
    brick, bars = vv.MeshFile(med).build(), vv.MeshFile(nastran).build()
    assert {name: members.tolist() for name, members in brick.cell_sets.items()} == {"steel": [0]}
    assert {name: faces.n_faces for name, faces in brick.face_sets.items()} == {
        "held": 2,
        "both": 3,
        "loaded": 1,
    }
    assert {name: nodes.tolist() for name, nodes in brick.node_sets.items()} == {
        "edge": [0, 1],
        "marked": [0, 1, 7],
    }
    assert {name: members.tolist() for name, members in bars.cell_sets.items()} == {"4": [0, 1], "9": [2]}


def test_packages_that_formats_need_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "netCDF4", None)
    with pytest.raises(vv.InputError, match="pip install netCDF4"):
        vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)).build().write(tmp_path / "m.e")
    (tmp_path / "m.e").write_text("x")
    with pytest.raises(vv.InputError, match="pip install netCDF4"):
        vv.MeshFile(tmp_path / "m.e").build()


@pytest.mark.parametrize("cell", ["tet4", "hex20", "wedge6", "tri6", "quad4"])
def test_faces_by_where_they_look(cell: str) -> None:
    """Outward on every side, whatever cells; those that look away are left out."""
    flat = cell in ("tri6", "quad4")
    source = vv.RectangleMesh if flat else vv.BoxMesh
    d = 2 if flat else 3
    mesh = source(size=(3, 2, 1)[:d], counts=(3, 2, 1)[:d], cell=cell).build()
    for axis, sign in np.ndindex(d, 2):
        direction = np.eye(d)[axis] * (1 if sign else -1)
        found = mesh.boundary().facing(mesh.points, direction, within=30.0)
        named = mesh.faces(f"{'xyz'[axis]}{sign}")
        assert found.nodes.tolist() == named.nodes.tolist()
        assert found.area(mesh.points) == pytest.approx(named.area(mesh.points))


def test_other_files_are_refused(tmp_path: Path) -> None:
    import meshio

    with pytest.raises(vv.InputError, match="no mesh file"):
        vv.MeshFile(tmp_path / "nothing.vtu").build()
    (tmp_path / "text.vtu").write_text("no mesh at all")
    with pytest.raises(vv.InputError, match=r"text.vtu cannot be used as a mesh: meshio cannot read it"):
        vv.MeshFile(tmp_path / "text.vtu").build()
    points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.5, 0.5, 1)]
    meshio.write_points_cells(tmp_path / "pyramid.vtu", points, [("pyramid", [range(5)])])
    with pytest.raises(vv.InputError, match=r"1 cells of type pyramid; known are .*hex27"):
        vv.MeshFile(tmp_path / "pyramid.vtu").build()
    meshio.write_points_cells(tmp_path / "points.vtu", points, [("vertex", [[0], [1]])])
    with pytest.raises(vv.InputError, match="no cells"):
        vv.MeshFile(tmp_path / "points.vtu").build()


def test_faces_that_no_cell_has_are_refused(tmp_path: Path) -> None:
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)).build()
    loose = vv.Faces({"quad4": np.array([[0, 1, 6, 7]])}, {"quad4": np.array([0])})
    mesh.with_faces("loose", loose).write(tmp_path / "mesh.vtu")
    with pytest.raises(vv.InputError, match=r"quad4 with the nodes \[0, 1, 6, 7\] in 'loose' is no face"):
        vv.MeshFile(tmp_path / "mesh.vtu").build()


def test_orphans_of_files(tmp_path: Path) -> None:
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)).build()
    vv.Mesh([*mesh.points, (5, 5, 5)], mesh.cells, {"n": [7, 8]}).write(tmp_path / "mesh.vtu")
    with pytest.raises(vv.InputError, match=r"without_orphans"):
        vv.MeshFile(tmp_path / "mesh.vtu").build().check()
    assert vv.MeshFile(tmp_path / "mesh.vtu", drop_orphans=True).build().check().nodes("n").tolist() == [7]


@pytest.mark.parametrize("ending", [".bdf", ".e", ".xdmf"])
def test_sets_that_a_format_loses_are_told(ending: str, tmp_path: Path) -> None:
    mesh, file = sample("hex8"), tmp_path / f"mesh{ending}"
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", UserWarning)
        mesh.write(file)
    kept = all_sets(vv.MeshFile(file).build()) == all_sets(mesh)
    assert kept == (ending == ".xdmf")
    assert kept == (not [w for w in told if "cannot hold all sets" in str(w.message)])


def test_what_cannot_be_written(tmp_path: Path) -> None:
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)).build()
    with pytest.raises(vv.InputError, match="two sets of the mesh are called 'x0'"):
        mesh.with_nodes("x0", [1]).write(tmp_path / "mesh.msh")
    with pytest.raises(vv.InputError, match="meshio cannot write"):
        mesh.write(tmp_path / "mesh.unknown")
    line = vv.LineMesh(points=[(0, 0, 0), (1, 0, 0)], cell="line4").build()
    with pytest.raises(vv.InputError, match="cannot hold cells line4"):
        line.write(tmp_path / "mesh.inp")


@pytest.mark.parametrize(("package", "file"), [("meshio", PLATE), ("gmsh", Path("plate.geo"))])
def test_missing_packages(package: str, file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def without(name: str, *rest: Any) -> Any:
        if name == package:
            raise ImportError(f"No module named {package!r}")
        return real(name, *rest)

    (tmp_path / "plate.geo").write_text("")
    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(vv.InputError, match=rf'needs the package {package}: pip install "visviva\['):
        vv.MeshFile(tmp_path / file, trust=True).build()


SCRIPT = """SetFactory("Built-in");
Point(1) = {0, 0, 0, 0.3}; Point(2) = {1, 0, 0, 0.3}; Point(3) = {2, 0, 0, 0.3};
Point(4) = {2, 2, 0, 0.3}; Point(5) = {0, 2, 0, 0.3}; Point(6) = {0, 1, 0, 0.3};
Line(1) = {2, 3}; Line(2) = {3, 4}; Line(3) = {4, 5}; Line(4) = {5, 6}; Circle(5) = {6, 1, 2};
Curve Loop(1) = {1, 2, 3, 4, 5}; Plane Surface(1) = {1};
Physical Curve("hole") = {5}; Physical Curve("all") = {1, 2, 3, 4, 5}; Physical Surface("plate") = {1};
Mesh.ElementOrder = 2;
"""


def test_gmsh_script(tmp_path: Path) -> None:
    pytest.importorskip("gmsh")
    (tmp_path / "plate.geo").write_text(SCRIPT)
    mesh = vv.MeshFile(tmp_path / "plate.geo", trust=True).build().check()
    assert list(mesh.cells) == ["tri6"]
    assert mesh.volume == pytest.approx(4 - np.pi / 4, rel=1e-5)
    assert mesh.faces("hole").area(mesh.points) == pytest.approx(np.pi / 2, rel=1e-5)
    assert enclosed(mesh, mesh.faces("all")) == pytest.approx(mesh.volume)
    (tmp_path / "plate.geo").write_text("Point(1) = {0;")
    with pytest.raises(vv.InputError, match="Gmsh says"):
        vv.MeshFile(tmp_path / "plate.geo", trust=True).build()


def test_scenes_hold_meshes(tmp_path: Path) -> None:
    """A generator with its arguments, and a file by its path relative to the scene."""
    sample("tet10").write(tmp_path / "part.inp")
    (tmp_path / "scene.yaml").write_text("""
system:
  ring: {Solid: {mesh: {HollowCylinderMesh: {inner_radius: 1, outer_radius: 2, height: 1, counts: [1, 8, 1]}},
                 material: {NeoHooke: {young: 1.0, poisson: 0.3}}, density: 1.0}}
  part: {Solid: {mesh: {MeshFile: {path: part.inp}}, material: {NeoHooke: {young: 1.0, poisson: 0.3}}}}
run: {until: 1.0, step: 0.1}
""")
    system = read_scene(tmp_path / "scene.yaml").system
    write_scene(system, tmp_path / "again.yaml")
    again = read_scene(tmp_path / "again.yaml").system
    for ours, theirs, cell in zip(system.components, again.components, ("hex8", "tet10"), strict=True):
        assert list(ours.grid.cells) == [cell]
        np.testing.assert_array_equal(ours.grid.points, theirs.grid.points)


def test_every_cell_type_has_its_own_name_everywhere() -> None:
    for names in ([c.vtk for c in CELLS.values()], [c.meshio for c in CELLS.values()]):
        assert len(set(names)) == len(CELLS)
