"""Orders of the nodes in files of other programs, against cells whose middles are known."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import visviva as vv
from visviva.mesh.cells import CELLS
from visviva.mesh.node_orders import MED, written_order


def of_gmsh(cell: str, file: Path) -> None:
    """A box of 1 x 2 x 3 by Gmsh, whose writers, and the library of MED, number nodes."""
    gmsh = pytest.importorskip("gmsh")
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)
        occ, mesh = gmsh.model.occ, gmsh.model.mesh
        occ.extrude(
            [(2, occ.addRectangle(0, 0, 0, 1, 2))], 0, 0, 3, [1], recombine=not cell.startswith("tet")
        )
        occ.synchronize()
        if cell.startswith("hex"):
            for _, curve in gmsh.model.getEntities(1):
                mesh.setTransfiniteCurve(curve, 3)
            for _, surface in gmsh.model.getEntities(2):
                mesh.setTransfiniteSurface(surface)
                mesh.setRecombine(2, surface)
        mesh.generate(3)
        mesh.setOrder(2 if cell in ("tet10", "hex20") else 1)
        gmsh.model.addPhysicalGroup(3, [1], name="all")
        gmsh.model.addPhysicalGroup(2, [1], name="foot")
        gmsh.write(str(file))
    finally:
        gmsh.finalize()


OF_GMSH = {".med": list(MED), ".bdf": list(MED), ".key": ["tet4", "tet10", "hex8"]}
"""Its wedges in files of LS-DYNA are twisted, and its bricks of 20 nodes a keyword that is refused."""


@pytest.mark.parametrize(("ending", "cell"), [(e, cell) for e, cells in OF_GMSH.items() for cell in cells])
def test_cells_of_gmsh_are_not_inside_out(cell: str, ending: str, tmp_path: Path) -> None:
    """Nor are our own, and middles lie in the middle of their corners."""
    of_gmsh(cell, tmp_path / f"box{ending}")
    mesh = vv.MeshFile(tmp_path / f"box{ending}").build().check()
    assert [faces.n_faces > 0 for faces in mesh.face_sets.values()] == [True]
    assert mesh.volume == pytest.approx(6)
    rows = mesh.cells[cell]
    rounding = 1e-6 if ending == ".bdf" else 1e-9  # numbers of eight characters
    for node, group in enumerate(CELLS[cell].middles, CELLS[cell].n_corners):
        np.testing.assert_allclose(
            mesh.points[rows[:, node]], mesh.points[rows[:, list(group)]].mean(axis=1), atol=rounding
        )
    mesh.write(tmp_path / "again.med")
    again = vv.MeshFile(tmp_path / "again.med").build().check()
    assert np.array_equal(again.cells[cell], rows)


@pytest.mark.parametrize("cell", MED)
def test_files_of_meshio_are_read_as_they_are(cell: str, tmp_path: Path) -> None:
    """Its writer leaves nodes in the order of VTK."""
    meshio = pytest.importorskip("meshio")
    box = vv.BoxMesh(size=(1, 2, 3), counts=(1, 2, 1), cell=cell).build()
    meshio.write_points_cells(tmp_path / "box.med", box.points, [(CELLS[cell].meshio, box.cells[cell])])
    assert np.array_equal(vv.MeshFile(tmp_path / "box.med").build().check().cells[cell], box.cells[cell])


def test_other_files_keep_their_order() -> None:
    rows = np.arange(20)[None]
    assert written_order(".vtu", "hex20", rows) is rows
