"""Keyword files of LS-DYNA, against bodies whose volumes and areas are known."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import visviva as vv

CUBE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
TWO = [*CUBE, (2, 0, 0), (2, 1, 0), (2, 0, 1), (2, 1, 1)]
BRICKS = [(11, 3, 1, 2, 3, 4, 5, 6, 7, 8), (12, 7, 2, 9, 10, 3, 6, 11, 12, 7)]


def columns(rows: list[tuple[int, ...]], width: int) -> str:
    return "\n".join("".join(f"{n:{width}d}" for n in row) for row in rows)


def nodes_of(points: list[tuple[float, ...]], width: int = 8, real: int = 16) -> str:
    rows = (
        f"{k:{width}d}" + "".join(f"{value:{real}.8g}" for value in point)
        for k, point in enumerate(points, 1)
    )
    return "*NODE\n" + "\n".join(rows)


def deck(*parts: str, head: str = "*KEYWORD") -> str:
    return "\n".join([head, "$ a remark, with commas", *parts, "*END\n"])


def built(tmp_path: Path, text: str, **options: Any) -> vv.Mesh:
    file = tmp_path / "deck.k"
    file.write_text(text)
    return vv.MeshFile(file, **options).build()


SETS = f"""*PART
left block
{columns([(3, 1, 1)], 10)}
right block
{columns([(7, 1, 1)], 10)}
*SET_NODE_LIST_TITLE
bottom
{columns([(1,), (1, 2, 3, 4, 9, 10)], 10)}
*SET_NODE_LIST_GENERATE
{columns([(5,), (1, 4, 11, 90)], 10)}
*SET_SEGMENT
{columns([(2,), (9, 10, 12, 11)], 10)}{4 * "       0.0"}
{columns([(1, 5, 8, 4)], 10)}
*SET_PART_LIST
{columns([(4,), (3, 7)], 10)}
*SET_SOLID_TITLE
one
{columns([(9,), (12,)], 10)}"""


def test_bricks_with_parts_and_sets(tmp_path: Path) -> None:
    mesh = built(tmp_path, deck(SETS, nodes_of(TWO), "*ELEMENT_SOLID\n" + columns(BRICKS, 8)))
    assert mesh.cells["hex8"].tolist() == [[n - 1 for n in brick[2:]] for brick in BRICKS]
    assert {name: cells.tolist() for name, cells in mesh.cell_sets.items()} == {
        "left block": [0],
        "right block": [1],
        "parts4": [0, 1],
        "one": [1],
    }
    assert mesh.node_sets["bottom"].tolist() == [0, 1, 2, 3, 8, 9]
    assert mesh.node_sets["nodes5"].tolist() == [0, 1, 2, 3, 10, 11]
    assert sorted(mesh.face_sets["segments2"].owners["quad4"].tolist()) == [0, 1]
    steel = vv.NeoHooke(young=1.0, poisson=0.3)
    body = vv.Solid(mesh=mesh, material=steel, density=3.0)
    assert body.mass == pytest.approx(6.0, rel=1e-14)


@pytest.mark.parametrize(
    ("head", "width", "real"), [("*KEYWORD I10=Y", 10, 16), ("*KEYWORD LONG=Y", 20, 20), ("*KEYWORD", 0, 0)]
)
def test_wide_columns_and_commas(head: str, width: int, real: int, tmp_path: Path) -> None:
    if width:
        parts = nodes_of(TWO, width, real), "*ELEMENT_SOLID\n" + columns(BRICKS, width)
    else:
        points = [f"{k},{x},{y},{z}" for k, (x, y, z) in enumerate(TWO, 1)]
        parts = "*NODE\n" + "\n".join(points), "*element_solid\n" + "\n".join(str(b)[1:-1] for b in BRICKS)
    wide, plain = (
        built(tmp_path, deck(*some, head=h))
        for some, h in ((parts, head), ((nodes_of(TWO), "*ELEMENT_SOLID\n" + columns(BRICKS, 8)), "*KEYWORD"))
    )
    assert np.array_equal(wide.points, plain.points)
    assert np.array_equal(wide.cells["hex8"], plain.cells["hex8"])
    assert set(wide.cell_sets) == {"part3", "part7"}


def test_bricks_that_are_wedges_and_tetrahedra(tmp_path: Path) -> None:
    """Of the volumes of a wedge, 1/2, and a tetrahedron, 1/6; with nodes in a line of their own."""
    rows = columns([(1, 1, 1, 2, 3, 4, 5, 5, 8, 8)], 8)
    wedge = built(tmp_path, deck(nodes_of(CUBE), "*ELEMENT_SOLID\n" + rows), drop_orphans=True)
    material = vv.NeoHooke(young=1.0, poisson=0.3)
    assert vv.Solid(mesh=wedge, material=material, density=1.0).mass == pytest.approx(0.5)
    rows = columns([(1, 1), (1, 2, 4, 5, 5, 5, 5, 5, 0, 0), (2, 1, 2, 3, 4, 7, 7, 7, 7, 7)], 8)
    tets = built(tmp_path, deck(nodes_of(CUBE), "*ELEMENT_SOLID\n" + rows), drop_orphans=True)
    assert vv.Solid(mesh=tets, material=material, density=1.0).mass == pytest.approx(2 / 6)


@pytest.mark.parametrize(
    ("nodes", "cell", "volume"),
    [((1, 2, 3, 3, 5, 6, 7, 7), "wedge6", 1 / 2), ((1, 2, 3, 3, 6, 6, 6, 6), "tet4", 1 / 6)],
)
def test_bricks_whose_third_and_fourth_nodes_are_one(
    nodes: tuple[int, ...], cell: str, volume: float, tmp_path: Path
) -> None:
    """Half a cube by a cut through upright edges, as meshers for other programs write wedges; a corner of it."""
    text = deck(nodes_of(CUBE), "*ELEMENT_SOLID\n" + columns([(1, 1, *nodes)], 8))
    mesh = built(tmp_path, text, drop_orphans=True).check()
    assert (list(mesh.cells), mesh.volume) == ([cell], pytest.approx(volume))


def test_sets_by_columns_and_increments(tmp_path: Path) -> None:
    """Columns behind the members are properties; increments stand behind the first and last."""
    sets = f"""*SET_NODE_COLUMN_TITLE
left
{columns([(5,)], 10)}
{columns([(4,)], 10)}       0.5
{columns([(8,)], 10)}
*SET_NODE_LIST_GENERATE_INCREMENT
{columns([(6,), (1, 7, 3), (12, 12, 1)], 10)}
*SET_PART_COLUMN
{columns([(9,), (3,)], 10)}       1.0
*SET_SOLID_GENERATE_INCREMENT
{columns([(2,), (11, 13, 2)], 10)}"""
    mesh = built(tmp_path, deck(sets, nodes_of(TWO), "*ELEMENT_SOLID\n" + columns(BRICKS, 8)))
    assert {name: (nodes + 1).tolist() for name, nodes in mesh.node_sets.items()} == {
        "left": [4, 8],
        "nodes6": [1, 4, 7, 12],
    }
    assert (mesh.cell_sets["parts9"].tolist(), mesh.cell_sets["elements2"].tolist()) == ([0], [0])


def test_thick_shells_have_numbers_of_their_own_and_parts_may_have_no_cells(tmp_path: Path) -> None:
    """A brick and a thick shell may both be element 11; springs alone make up part 9."""
    (brick, other), springs = BRICKS, "*PART\nsprings\n9\n*ELEMENT_DISCRETE\n1,9,1,2"
    sets = (
        "*SET_PART_LIST_TITLE\nall\n1\n3,7,9\n*SET_TSHELL_TITLE\nthick\n2\n11\n*SET_SOLID_TITLE\nsolid\n3\n11"
    )
    thick = "*ELEMENT_TSHELL\n" + columns([(11, *other[1:])], 8)
    text = deck(nodes_of(TWO), "*ELEMENT_SOLID\n" + columns([(11, *brick[1:])], 8), thick, springs, sets)
    mesh = built(tmp_path, text)
    assert {name: mesh.cell_sets[name].tolist() for name in ("all", "solid", "thick")} == {
        "all": [0, 1],
        "solid": [0],
        "thick": [1],
    }


def test_tetrahedra_of_ten_nodes(tmp_path: Path) -> None:
    corners = np.array([(0.0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)])
    middles = [corners[[i, j]].mean(axis=0) for i, j in ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))]
    points = [tuple(point) for point in [*corners, *middles]]
    rows = columns([(1, 1), tuple(range(1, 11))], 8)
    mesh = built(tmp_path, deck(nodes_of(points), "*ELEMENT_SOLID (ten nodes format)\n" + rows))
    body = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1.0, poisson=0.3), density=1.0)
    assert body.mass == pytest.approx(1 / 6, rel=1e-12)


def test_shells_and_what_they_hold(tmp_path: Path) -> None:
    """With thicknesses in lines of their own, which are no elements."""
    shells = columns([(1, 1, 1, 2, 3, 4)], 8) + "\n" + " 0.1" * 4 + "\n" + columns([(2, 1, 2, 9, 10, 10)], 8)
    mesh = built(
        tmp_path,
        deck(nodes_of(TWO), "*ELEMENT_SHELL_THICKNESS\n" + shells + "\n 0.1", "*ELEMENT_MASS\n1,2,3.0"),
        drop_orphans=True,
    )
    assert {kind: len(rows) for kind, rows in mesh.cells.items()} == {"quad4": 1, "tri3": 1}


def test_titles_may_be_blank_and_nothing_follows_the_end(tmp_path: Path) -> None:
    parts = f"*PART\n\n{columns([(3, 1, 1)], 10)}\nright block\n{columns([(7, 1, 1)], 10)}"
    text = deck(parts, nodes_of(TWO), "*ELEMENT_SOLID\n" + columns(BRICKS, 8)) + "*NODE\n1,0,0,0\n"
    assert set(built(tmp_path, text).cell_sets) == {"part3", "right block"}


def test_included_files(tmp_path: Path) -> None:
    (tmp_path / "nodes.inc").write_text(nodes_of(TWO) + "\n")
    text = deck("*INCLUDE\nnodes.inc", "*ELEMENT_SOLID\n" + columns(BRICKS, 8))
    assert built(tmp_path, text).n_cells == 2
    marked = "\ufeff*ELEMENT_SOLID\n" + columns(BRICKS, 10)  # its width is that of the first file
    (tmp_path / "bricks.inc").write_text(marked, encoding="utf-8")
    wide = deck(nodes_of(TWO, 10), "*INCLUDE\nbricks.inc", head="*KEYWORD I10=Y")
    assert built(tmp_path, wide).n_cells == 2
    inner = tmp_path / "inner"
    inner.mkdir()
    with pytest.raises(vv.InputError, match="outside the scene's folder"):
        built(inner, text.replace("nodes.inc", "../nodes.inc"), within=inner)
    with pytest.raises(vv.InputError, match="does it include itself"):
        built(tmp_path, deck("*INCLUDE\ndeck.k"))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("*NODE_TRANSFORM\n1,2", r"\*NODE_TRANSFORM is not read"),
        ("*ELEMENT_SPH\n1,1,0.1", r"\*ELEMENT_SPH is not read"),
        ("*ELEMENT_SOLID\n1,1,1,2,3,4,5,6,7,99", "there is no node 99"),
        ("*ELEMENT_SOLID\n1,1,1,2,3,4,5,5,5,5", "no tetrahedron, wedge or brick"),
        ("*ELEMENT_SOLID\n1,1,1,2,3,3,5,6,7,8", "no tetrahedron, wedge or brick"),
        (
            "*SET_NODE_GENERAL\n1\nBOX,1",
            r"SET_NODE_GENERAL: is not read: list its members by .SET_NODE_LIST, _COLUMN",
        ),
        (
            "*SET_SEGMENT_GENERAL_TITLE\nfront\n1\nPART,1",
            "_GENERAL_TITLE: is not read: .* by .SET_SEGMENT, or",
        ),
        ("*SET_SHELL_ADD\n1\n2,3", "SET_SHELL_ADD: is not read"),
        ("*SET_NODE_LIST_GENERATE_INCREMENT\n1\n1,7,0", "goes on by 0 from 1 to 7"),
        ("*ELEMENT_SHELL\n1,1,1,2,2,2", "neither 3 or 4 corners"),
        ("*SET_NODE_LIST\n1\n1,77", "set 'nodes1' has 77"),
        ("*SET_SEGMENT\n1\n1,7,1,7", "a segment has the nodes"),
        ("*NODE\n1,0,0,0", "node 1 is there twice"),
        ("*ELEMENT_SOLID\n12,1,1,2,3,4,5,6,7,8", "element 12 is there twice"),
        (
            "*SET_NODE_LIST_TITLE\nlow\n1\n1\n*SET_NODE_LIST_TITLE\nlow\n2\n2",
            "two sets or parts are called 'low'",
        ),
        ("*PART\nlow\n3\n*SET_PART_LIST_TITLE\nlow\n1\n7", "two sets or parts are called 'low'"),
        ("*SET_PART_LIST\n1\n99", "set 'parts1' has 99"),
        ("*SET_SOLID\n1\n99", "set 'elements1' has 99"),
        ("*NODE\n&n,0,0,0", "invalid literal"),
        ("*INCLUDE\nnowhere.k", "includes what does not exist"),
        ("*INCLUDE\nbare.inc", "bare.inc: '1,0,0,0' stands before the first keyword"),
    ],
)
def test_bad_files(text: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "bare.inc").write_text("$ nodes\n1,0,0,0\n")
    with pytest.raises(vv.InputError, match=message):
        built(tmp_path, deck(nodes_of(TWO), "*ELEMENT_SOLID\n" + columns(BRICKS, 8), text))
