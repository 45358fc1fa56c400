"""Bulk data of Nastran, against bodies whose areas, volumes and places are known."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import visviva as vv
from visviva.mesh.cells import CELLS

PLATE = """GRID,1,,0.,0.,0.
GRID,2,,1.,0.,0.
GRID,3,,1.,1.,0.
GRID,4,,0.,1.,0.
GRID,5,,2.,0.,0.
GRID,6,,2.,1.,0.
"""
SECOND = "CQUAD4,2,8,2,5,6,3\n"


def built(folder: Path, text: str, name: str = "deck.bdf") -> vv.Mesh:
    (folder / name).write_text(f"SOL 101\nCEND\nBEGIN BULK\n{text}ENDDATA\n")
    return vv.MeshFile(folder / name).build()


def sector(system: str, grid: str, first: str = "") -> str:
    """A quarter of an annulus between radii 1 and 2, in 30 sectors of 3 degrees."""
    nodes = [(1 + r, 3.0 * k) for k in range(31) for r in (0, 1)]
    grids = "".join(grid.format(n=n, r=r, a=a) for n, (r, a) in enumerate(nodes, 1))
    cells = "".join(f"CQUAD4,{k},7,{2 * k - 1},{2 * k},{2 * k + 2},{2 * k + 1}\n" for k in range(1, 31))
    return first + grids + system + cells


CYLINDER = "CORD2C,1,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n"
SHIFTED = "CORD2C,1,5,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nCORD2R,5,,10.,0.,0.,10.,0.,1.\n,10.,1.,0.\n"
BY_NODES = "GRID,91,,0.,0.,0.\nGRID,92,,0.,0.,3.\nGRID,93,,2.,0.,0.\nCORD1C,4,92,91,93,1,91,92,93\n"


@pytest.mark.parametrize(
    ("text", "corner"),
    [
        (sector(CYLINDER, "GRID,{n},1,{r},{a},0.\n"), (0, 2)),
        (sector(CYLINDER, "GRID,{n},,{r},{a},0.\n", "GRDSET,,1\n"), (0, 2)),
        (sector(SHIFTED, "GRID,{n},1,{r},{a},0.\n"), (8, 0)),  # turned by a right angle
        (sector(BY_NODES, "GRID,{n},1,{r},{a},0.\n"), (0, 2)),
        (sector(CYLINDER.replace("CORD2C", "CORD2S"), "GRID,{n},1,{r},90.,{a}\n"), (0, 2)),
    ],
)
def test_nodes_in_any_coordinate_system(text: str, corner: tuple[float, float], tmp_path: Path) -> None:
    """The area of chords is 3/2 n sin(90 degrees / n)."""
    mesh = built(tmp_path, text)
    assert mesh.volume == pytest.approx(1.5 * 30 * np.sin(np.pi / 60), rel=1e-12)
    last = mesh.points[mesh.cells["quad4"][-1, 2]]
    np.testing.assert_allclose(last[:2], corner, atol=1e-12)


@pytest.mark.parametrize(
    ("card", "cell"),
    [(name, "quad4") for name in ("CQUAD4", "CQUADR", "CQUADX", "CPLSTN4", "CPLSTS4", "CQUADX4")]
    + [(name, "tri3") for name in ("CTRIA3", "CTRIAR", "CTRIAX", "CPLSTN3", "CPLSTS3", "CTRAX3")],
)
def test_plates_of_all_names(card: str, cell: str, tmp_path: Path) -> None:
    nodes = "1,2,3,4" if cell == "quad4" else "1,2,3"
    mesh = built(tmp_path, f"{PLATE}{card},1,7,{nodes}\n{SECOND}")
    assert mesh.volume == pytest.approx(2 if cell == "quad4" else 1.5)
    assert {name: len(rows) for name, rows in mesh.cell_sets.items()} == {"7": 1, "8": 1}


def lines(name: str, numbers: list[int], style: str) -> str:
    """An entry in small, large or free format."""
    if style == "free":
        rows = [numbers[k : k + 8] for k in range(0, len(numbers), 8)]
        return "".join(f"{'' if k else name},{','.join(map(str, row))}\n" for k, row in enumerate(rows))
    width, n = (16, 4) if style == "large" else (8, 8)
    star = "*" if style == "large" else ""
    rows = [numbers[k : k + n] for k in range(0, len(numbers), n)]
    heads = [name + star] + [star or "+"] * (len(rows) - 1)
    return "".join(
        f"{head:8}" + "".join(f"{i:{width}d}" for i in row) + "\n"
        for head, row in zip(heads, rows, strict=True)
    )


@pytest.mark.parametrize("style", ["small", "large", "free"])
@pytest.mark.parametrize(
    ("card", "cell"),
    [("CTETRA", "tet4"), ("CTETRA", "tet10"), ("CHEXA", "hex8"), ("CHEXA", "hex20"), ("CPENTA", "wedge6")],
)
def test_solids_in_every_format(card: str, cell: str, style: str, tmp_path: Path) -> None:
    """Middles of CHEXA stand below, upright, above."""
    box = vv.BoxMesh(size=(1, 2, 3), counts=(2, 1, 2), cell=cell).build()
    order = [*range(12), 16, 17, 18, 19, 12, 13, 14, 15] if cell == "hex20" else range(CELLS[cell].n_nodes)
    text = "".join(f"GRID,{n},,{x!r},{y!r},{z!r}\n" for n, (x, y, z) in enumerate(box.points.tolist(), 1))
    for k, row in enumerate(box.cells[cell] + 1, 1):
        text += lines(card, [k, 4, *row[list(order)].tolist()], style)
    mesh = built(tmp_path, text)
    assert np.array_equal(mesh.cells[cell], box.cells[cell])
    assert mesh.check().volume == pytest.approx(6)


def test_fields_that_are_left_blank(tmp_path: Path) -> None:
    """Coordinates are zero, properties none; middles may all be left out."""
    small = "GRID           1              0.      0.      0.\nGRID           2              1.      0.\n"
    small += "GRID           3             1.0    1.+0    1.-3\nGRID           4             0.0     1.0\n"
    mesh = built(tmp_path, small + "CQUAD8         1               1       2       3       4\n")
    assert mesh.points.tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0.001], [0, 1, 0]]
    assert (list(mesh.cells), mesh.cell_sets) == (["quad4"], {})


def test_included_files_are_read(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "one.bdf").write_text("INCLUDE 'nodes.bdf'\nCQUAD4,1,7,1,2,3,4\n")
    (tmp_path / "parts" / "nodes.bdf").write_text("$ nodes\n" + PLATE)
    text = "INCLUDE 'parts/\n one.bdf'\n" + SECOND
    assert built(tmp_path, text).volume == pytest.approx(2)
    with pytest.raises(vv.InputError, match="is outside"):
        vv.MeshFile(tmp_path / "deck.bdf", within=tmp_path / "parts").build()
    (tmp_path / "parts" / "nodes.bdf").write_text(PLATE + "CSHEAR,5,1,1,2,3,4\n")
    with pytest.raises(vv.InputError, match=r"nodes.bdf, line 7: CSHEAR 5 is not read"):
        vv.MeshFile(tmp_path / "deck.bdf").build()
    (tmp_path / "parts" / "nodes.bdf").unlink()
    with pytest.raises(vv.InputError, match="includes what does not exist"):
        vv.MeshFile(tmp_path / "deck.bdf").build()


def test_springs_masses_and_materials_are_passed_over(tmp_path: Path) -> None:
    others = (
        "CONM2,9,1,,5.\nCELAS2,10,1.,1,1\nCBUSH,11,3,1,2\nPSHELL,8,1,.1\nMAT1,1,2.+11,,.3\nSPC1,1,123,1,2\n"
    )
    mesh = built(tmp_path, PLATE + others + "CROD,3,5,1,2\nCQUAD4,1,7,1,2,3,4,45.\n" + SECOND)
    assert (list(mesh.cells), sorted(mesh.cell_sets)) == (["quad4"], ["7", "8"])
    assert mesh.face_sets["5"].n_faces == 1  # of the rod


ONE = "CQUAD4,1,7,1,2,3,4\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (PLATE + "CSHEAR,1,7,1,2,3,4\n", r"line 10: CSHEAR 1 is not read: write .*CQUAD4"),
        (PLATE + ONE + "CPYRAM,3,7,1,2,3,4,5\n", "CPYRAM 3 is not read"),
        (PLATE + ONE + "CTRAX6,3,7,1,2,3,4,5,6\n", "CTRAX6 3 is not read"),
        (PLATE + ONE + "CBEND,3,7,1,2\n", "CBEND 3 is not read"),
        (PLATE + ONE + "GRIDF,3,7,1\n", "GRIDF 3 is not read"),
        (PLATE + "=,*1,=,*1.,==\n" + ONE, "line 10: = .* is not read"),
        (PLATE + "BEGIN SUPER=1\n" + ONE, "begins another model"),
        (PLATE + "GRID,6,,2.5,1.,0.\n" + ONE, "line 10: GRID 6 is there twice: line 9"),
        (PLATE + ONE + ONE, "line 11: CQUAD4 1 is there twice: line 10"),
        (PLATE + "GRID,7,3,2.5,1.,0.\n" + ONE, "GRID 7 is given in the coordinate system 3, which is not there"),
        (PLATE + "GRID,7,,2.5,1.x,0.\n" + ONE, "GRID 7 has '1.x' where a number belongs"),
        (PLATE + "GRID,7,,INF,1.,0.\n" + ONE, "GRID 7 has 'INF' where a number belongs"),
        (PLATE + "CQUAD4,1_0,7,1,2,3,4\n", "CQUAD4 1_0 has '1_0' where a whole number belongs"),
        (PLATE + "CORD2C,1,1,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nGRID,7,1,1.,1.,1.\n" + ONE, "CORD2C 1 refers to itself"),
        (PLATE + "CORD2R,1,,0.,0.,0.,0.,0.,1.\n,0.,0.,3.\nGRID,7,1,1.,1.,1.\n" + ONE, "three points in a line"),
        (PLATE + "CQUAD4,1,7,1,2,3,99\n", "CQUAD4 1 has the node 99, which is not there"),
        (PLATE + "CQUAD4,1,7,1,2,3,3\n", "CQUAD4 1 has the nodes 1 2 3 3, not 4 different ones"),
        (PLATE + "CTRIA6,1,7,1,2,3,4,,5\n", "CTRIA6 1 has the nodes 1 2 3 4 5, not 3 or 6"),
        (PLATE + "CQUAD4,1,7,1,2,3,4,,.5\n", "CQUAD4 1 is moved off its nodes"),
        (PLATE + "CBAR,1,7,1,2,0.,0.,1.\n,,,0.,.1,0.\n", "CBAR 1 is moved off its nodes"),
        (PLATE + "CTRIA3*,1,7,1,2,3\n", "line 10: the line has more than 4 fields"),
        (PLATE + "CQUAD,1,7,1,2,3,4,5,6,7\n", "line 10: the line has more than 8 fields"),
        (PLATE + f"{'CQUAD4':8}{1:8d}{7:8d}{1:8d}{'':40}+A\n{'+B':8}{2:8d}\n", "goes on in another line"),
        (PLATE, "there are no cells in it"),
        (ONE, "there are no nodes"),
    ],
)  # fmt: skip
def test_what_is_not_understood_is_refused(text: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(vv.InputError, match=message):
        built(tmp_path, text)


def test_large_fields_that_go_on_in_small_ones_are_refused(tmp_path: Path) -> None:
    """The third coordinate came to stand where none is read."""
    nodes = "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,1.,1.,0.\nGRID*,4,,0.,1.\n"
    plate = "CQUAD4,1,7,1,2,3,4\n"
    with pytest.raises(vv.InputError, match="goes on in a line without"):
        built(tmp_path, f"{nodes},0.5\n{plate}")
    assert built(tmp_path, f"{nodes}*,0.5\n{plate}", "large.bdf").points[3] == pytest.approx([0, 1, 0.5])


def test_a_byte_order_mark_hides_no_element(tmp_path: Path) -> None:
    text = "CQUAD4,1,7,1,2,3,4\nGRID,1,,0.,0.\nGRID,2,,1.,0.\nGRID,3,,1.,1.\nGRID,4,,0.,1.\n"
    (tmp_path / "marked.bdf").write_text(text + "CTRIA3,2,7,1,2,3\n", encoding="utf-8-sig")
    cells = vv.MeshFile(path=str(tmp_path / "marked.bdf")).build().cells
    assert {name: len(rows) for name, rows in cells.items()} == {"quad4": 1, "tri3": 1}
