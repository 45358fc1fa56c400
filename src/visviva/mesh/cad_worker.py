"""Meshes what a CAD file describes, by Gmsh, as a program of its own: a reader that breaks down ends this, not a run.

Files are read by their named format alone; what opens files of any kind, and runs scripts, is never called.
"""

from __future__ import annotations

import json
import signal
import sys
from typing import Any

KINDS = {3: "solid", 2: "face", 1: "edge"}
HEALED = 1e-3
"""Of the size of cells: how far edges of faces that come alone, as in IGES, may lie apart."""
MANY = 2e7
"""Cells; more are taken for a size in another unit."""
READING = 300
"""Seconds of the clock; damaged shapes may be read, and meshed, for ever."""
MESHING = (30, 1e-3)
"""The same for all that follows, and more for every cell that is expected, tenfold of what it takes."""
CELL = {3: 0.12, 2: 0.43}
"""Volume or area of a regular cell with edges of length 1."""


class Refused(Exception):
    """Error of a geometry that cannot be meshed."""


def read(gmsh: Any, order: dict[str, Any]) -> int:
    """Import the shapes; returns their highest dimension."""
    occ = gmsh.model.occ
    occ.importShapes(order["path"], highestDimOnly=True, format=order["format"])
    occ.synchronize()
    if not gmsh.model.getEntities(3) and order["format"] == "iges":
        occ.healShapes([], tolerance=HEALED * order["size"], makeSolids=True)
        occ.synchronize()
    found = max((dim for dim, _ in gmsh.model.getEntities()), default=0)
    if found < 2:
        raise Refused("it holds no faces or solids")
    return int(found)


def refuse_many(gmsh: Any, dim: int, order: dict[str, Any]) -> None:
    """Refuse a size that makes more cells than anybody waits for, and set the time for those that it makes."""
    size, unit = order["size"], order["unit"]
    measure = sum(gmsh.model.occ.getMass(dim, tag) for _, tag in gmsh.model.getEntities(dim))
    cells = measure / (CELL[dim] * size**dim)
    if cells > MANY:
        what = "a volume" if dim == 3 else "an area"
        raise Refused(
            f"cells of the size {size * unit:g} would be {cells:.0e} in {what} of {measure * unit**dim:.3g}: take a "
            "larger size, or say the unit of length that the mesh is to have"
        )
    signal.alarm(int(MESHING[0] + MESHING[1] * cells))


def name(gmsh: Any, dim: int) -> None:
    """Groups of the shapes and of their faces, by their names in the file or by their numbers."""
    for d in (dim, dim - 1):
        tags = [tag for _, tag in gmsh.model.getEntities(d)]
        given = {tag: gmsh.model.getEntityName(d, tag).split("/")[-1] for tag in tags}
        labels = list(given.values())
        for tag in tags:
            label = given[tag] if given[tag] and labels.count(given[tag]) == 1 else f"{KINDS[d]}{tag}"
            gmsh.model.addPhysicalGroup(d, [tag], name=label)


def mesh(gmsh: Any, order: dict[str, Any]) -> None:
    """Read, mesh and write, by the order of the program that has called; sizes are in what the reader makes of lengths.

    Those of STEP and IGES are millimetres, of which the `unit` of the order is one.
    """
    for option, value in {
        "General.Terminal": 0,
        "General.NumThreads": 1,
        "Mesh.MeshSizeMax": order["size"],
        "Mesh.ElementOrder": order["order"],
        "Mesh.HighOrderOptimize": int(order["order"] > 1),
    }.items():
        gmsh.option.setNumber(option, value)
    signal.alarm(READING)
    dim = read(gmsh, order)
    refuse_many(gmsh, dim, order)
    name(gmsh, dim)
    gmsh.model.mesh.generate(dim)
    unit = order["unit"]
    gmsh.model.mesh.affineTransform([unit, 0, 0, 0, 0, unit, 0, 0, 0, 0, unit, 0])
    gmsh.write(order["target"])


def main() -> None:
    """Take the order from the first argument; ends with words on the error output where it is refused."""
    try:
        import gmsh
    except (ImportError, OSError) as error:  # its shared library needs some of the system
        sys.exit(f'CAD files need the package gmsh: pip install "visviva[gmsh]" ({error})')
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    try:
        mesh(gmsh, json.loads(sys.argv[1]))
    except Refused as refused:
        sys.exit(str(refused))
    except Exception as error:  # it raises plain exceptions
        sys.exit(f"Gmsh says: {error}")
    finally:
        gmsh.finalize()


if __name__ == "__main__":
    main()
