"""Names of Exodus II, against what VTK reads in the same files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import visviva as vv

netCDF4 = pytest.importorskip("netCDF4")
SIDES = {"hex8": 6, "hex20": 6, "hex27": 6, "tet4": 4, "tet10": 4, "wedge6": 5}


def add_sides(file: Path, sets: dict[str, tuple[list[int], list[int]]]) -> None:
    """Sets of sides by cells and numbers of their sides, from 1 on."""
    with netCDF4.Dataset(file, "a") as f:
        f.createDimension("num_side_sets", len(sets))
        numbers = f.createVariable("ss_prop1", "i4", ("num_side_sets",))
        numbers[:] = np.arange(1, len(sets) + 1)
        numbers.setncattr("name", "ID")
        f.createVariable("ss_status", "i4", ("num_side_sets",))[:] = 1
        names = f.createVariable("ss_names", "S1", ("num_side_sets", "len_string"))
        for k, (name, parts) in enumerate(sets.items(), 1):
            names[k - 1, :] = np.array(list(name.ljust(33, "\0")), "S1")
            f.createDimension(f"num_side_ss{k}", len(parts[0]))
            for what, values in zip(("elem", "side"), parts, strict=True):
                f.createVariable(f"{what}_ss{k}", "i4", (f"num_side_ss{k}",))[:] = values


def sides_of_vtk(file: Path, n: int) -> list[Any]:
    exodus = pytest.importorskip("vtkmodules.vtkIOExodus")
    pyvista = pytest.importorskip("pyvista")
    reader = exodus.vtkExodusIIReader()
    reader.SetFileName(str(file))
    reader.UpdateInformation()
    for k in range(n):
        reader.SetObjectStatus(reader.SIDE_SET, k, 1)
    reader.Update()
    sides = pyvista.wrap(reader.GetOutput())["Side Sets"]
    return [sides[k].points for k in range(n)]


@pytest.mark.parametrize("cell", SIDES)
def test_sides_are_those_of_vtk(cell: str, tmp_path: Path) -> None:
    file, n = tmp_path / f"{cell}.e", SIDES[cell]
    vv.BoxMesh(size=(1, 2, 3), counts=(1, 1, 2), cell=cell).build().write(file)
    add_sides(file, {f"side {k}": ([1], [k]) for k in range(1, n + 1)})
    ours = vv.MeshFile(file).build()
    for k, theirs in enumerate(sides_of_vtk(file, n), 1):
        faces = ours.face_sets[f"side {k}"]
        nodes = np.unique(np.concatenate([rows.ravel() for rows in faces.cells.values()]))
        corners = {tuple(point) for point in np.round(theirs, 6).tolist()}
        assert faces.n_faces == 1
        assert corners <= {tuple(point) for point in np.round(ours.points[nodes], 6).tolist()}


@pytest.mark.parametrize("cell", ["hex20", "hex27"])
def test_nodes_have_the_order_of_vtk(cell: str, tmp_path: Path) -> None:
    """What VTK reads has the middles of its own order."""
    file = tmp_path / f"{cell}.e"
    box = vv.BoxMesh(size=(1, 2, 3), counts=(1, 1, 1), cell=cell).build()
    box.write(file)
    reader = pytest.importorskip("vtkmodules.vtkIOExodus").vtkExodusIIReader()
    reader.SetFileName(str(file))
    reader.Update()
    theirs = pytest.importorskip("pyvista").wrap(reader.GetOutput())["Element Blocks"][0].get_cell(0).points
    assert np.allclose(theirs, box.points[box.cells[cell][0]])
    assert np.array_equal(vv.MeshFile(file).build().cells[cell], box.cells[cell])


def test_blocks_and_sets_without_names(tmp_path: Path) -> None:
    meshio = pytest.importorskip("meshio")
    box = vv.BoxMesh(size=(1, 1, 2), counts=(1, 1, 2)).build()
    cells = [("hexahedron", rows[None]) for rows in box.cells["hex8"]]
    meshio.write_points_cells(
        tmp_path / "two.e", box.points, cells, point_sets={"low": np.array([0, 1, 2, 3])}
    )
    mesh = vv.MeshFile(tmp_path / "two.e").build()
    assert {name: rows.tolist() for name, rows in mesh.cell_sets.items()} == {"block1": [0], "block2": [1]}
    assert {name: rows.tolist() for name, rows in mesh.node_sets.items()} == {"low": [0, 1, 2, 3]}


def test_blocks_may_be_empty_and_stored_in_any_order(tmp_path: Path) -> None:
    """The first of three has no cells, and the third is stored before the second."""
    file = tmp_path / "blocks.e"
    points = vv.BoxMesh(size=(1, 1, 2), counts=(1, 1, 2)).build()
    with netCDF4.Dataset(file, "w") as f:
        sizes = {
            "len_string": 33,
            "num_dim": 3,
            "num_nodes": 12,
            "num_elem": 2,
            "num_el_blk": 3,
            "eight": 8,
            "one": 1,
        }
        for name, size in sizes.items():
            f.createDimension(name, size)
        f.createVariable("coord", "f8", ("num_dim", "num_nodes"))[:] = points.points.T
        names = f.createVariable("eb_names", "S1", ("num_el_blk", "len_string"))
        for k, name in enumerate(("EMPTY", "STEEL", "RUBBER")):
            names[k, :] = np.array(list(name.ljust(33, "\0")), "S1")
        for number, row in ((3, 1), (2, 0)):
            block = f.createVariable(f"connect{number}", "i4", ("one", "eight"))
            block[:] = points.cells["hex8"][row : row + 1] + 1
            block.elem_type = "HEX8"
    add_sides(file, {"top": ([2], [6])})
    mesh = vv.MeshFile(file).build()
    heights = {
        name: mesh.points[mesh.cells["hex8"][rows[0]]][:, 2].mean() for name, rows in mesh.cell_sets.items()
    }
    assert heights == {"STEEL": 0.5, "RUBBER": 1.5}
    assert mesh.points[mesh.face_sets["top"].nodes][:, 2].tolist() == [2.0] * 4
    with netCDF4.Dataset(file, "a") as f:
        f.variables["elem_ss1"][:] = 7
    with pytest.raises(vv.InputError, match="'top' has element 7, which is not there"):
        vv.MeshFile(file).build()


def test_sides_that_no_cell_has_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "tet.e"
    vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1), cell="tet4").build().write(file)
    add_sides(file, {"fifth": ([2], [5])})
    with pytest.raises(vv.InputError, match="'fifth' has side 5 of a tet4"):
        vv.MeshFile(file).build()


@pytest.mark.parametrize(("n_dim", "first"), [(2, 1), (3, 3)])
@pytest.mark.parametrize("name", ["TRI", "TRI3", "triangle"])
def test_edges_of_triangles_in_space_follow_their_faces(
    n_dim: int, first: int, name: str, tmp_path: Path
) -> None:
    """In space sides 1 and 2 are both faces, edges 3 to 5 (manual of Exodus II, triangular shells)."""
    file, corners = tmp_path / "tri.e", np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0.5]])[:, :n_dim]
    with netCDF4.Dataset(file, "w", format="NETCDF3_64BIT_OFFSET") as f:
        f.setncatts({"api_version": np.float32(5.1), "version": np.float32(5.1), "title": "x"})
        f.floating_point_word_size = np.int32(8)
        sizes = {"len_string": 33, "num_dim": n_dim, "num_nodes": 3, "num_elem": 1, "num_el_blk": 1}
        for key, size in {**sizes, "num_el_in_blk1": 1, "num_nod_per_el1": 3}.items():
            f.createDimension(key, size)
        for axis, values in zip("xyz", corners.T, strict=False):
            f.createVariable(f"coord{axis}", "f8", ("num_nodes",))[:] = values
        numbers = f.createVariable("eb_prop1", "i4", ("num_el_blk",))
        numbers[:] = 1
        numbers.setncattr("name", "ID")
        block = f.createVariable("connect1", "i4", ("num_el_in_blk1", "num_nod_per_el1"))
        block[:] = [[1, 2, 3]]
        block.elem_type = name
    add_sides(file, {f"side {k}": ([1], [k]) for k in range(1, first + 3)})
    mesh = vv.MeshFile(file).build()
    for k in range(1, first + 3):
        edge = [((0, 1), (1, 2), (2, 0))[k - first]] if k >= first else []
        assert mesh.face_sets[f"side {k}"].cells.get("line2", np.zeros((0, 2))).tolist() == [
            list(e) for e in edge
        ]


@pytest.mark.parametrize(
    ("cell", "name"),
    [("wedge6", "WEDGE6"), ("wedge6", "WEDGE"), ("tet4", "TETRA4"), ("tet4", "TET4"), ("tet4", "tetra"),
     ("tet10", "TET10"), ("hex20", "HEX"), ("tri3", "SHELL3"), ("tri3", "TRISHELL"), ("quad4", "SHELL")],
)  # fmt: skip
def test_cells_by_any_of_their_names(cell: str, name: str, tmp_path: Path) -> None:
    """meshio knows WEDGE but not WEDGE6, and raised KeyError: 'tetra4' for TETRA4."""
    if cell in SIDES:
        mesh = vv.BoxMesh(size=(1, 2, 3), counts=(1, 2, 1), cell=cell).build()
    else:
        mesh = vv.RectangleMesh(size=(2, 3), counts=(1, 2), cell=cell).build()
    vv.Mesh(mesh.points, mesh.cells).write(tmp_path / "mesh.e")
    with netCDF4.Dataset(tmp_path / "mesh.e", "a") as file:
        file.variables["connect1"].elem_type = name
    again = vv.MeshFile(tmp_path / "mesh.e").build()
    assert list(again.cells) == [cell]
    assert again.volume == pytest.approx(6)
    with netCDF4.Dataset(tmp_path / "mesh.e") as file:
        assert file.variables["connect1"].elem_type == name  # the file is left as it was


def test_cells_that_are_not_known(tmp_path: Path) -> None:
    mesh = vv.BoxMesh(size=(1, 2, 3), counts=(1, 2, 1)).build()
    vv.Mesh(mesh.points, mesh.cells).write(tmp_path / "mesh.e")
    with netCDF4.Dataset(tmp_path / "mesh.e", "a") as file:
        file.variables["connect1"].elem_type = "NFACED"
    with pytest.raises(vv.InputError, match="block 1 holds cells NFACED of 8 nodes; known are HEX8"):
        vv.MeshFile(tmp_path / "mesh.e").build()
