"""Meshes in files: Gmsh, Abaqus, VTK and what meshio knows, with their sets; CAD files, which are meshed."""

from __future__ import annotations

import io
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any, Literal
from urllib.parse import unquote

import numpy as np
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.mesh import cad, exodus, ls_dyna, nastran
from visviva.mesh.abaqus import Reader
from visviva.mesh.cells import CELLS, Ints
from visviva.mesh.collect import VERTEX, Collection, dimension_of
from visviva.mesh.generate import CONFIG, Length, MeshSource
from visviva.mesh.mesh import Mesh
from visviva.mesh.node_orders import EXODUS_ENDINGS, read_order
from visviva.mesh.source_files import existing, refuse_outside
from visviva.mesh.write_mesh import load_meshio

NAMES = {cell.meshio: cell.name for cell in CELLS.values()} | {"vertex": VERTEX}
CAN_REFER = (".xdmf", ".xmf", ".med", ".h5m", ".cgns", ".hmf", *EXODUS_ENDINGS, ".nc")
"""Endings of formats whose files can name other files to be read with them."""


@dataclass(frozen=True, config=CONFIG)
class MeshFile(MeshSource):
    """Mesh from a file.

    Cells of the highest dimension are the mesh. Named groups of them become sets of cells, groups of their
    faces (edges in the plane) sets of faces, groups of anything lower sets of nodes. Physical groups of Gmsh
    without a name, and properties of Nastran, are called by their number.

    Parameters
    ----------
    path : path
        ``.msh`` of Gmsh with physical groups; ``.inp`` of Abaqus with NSET, ELSET and SURFACE; ``.vtu`` and
        ``.vtk``, where whole-numbered arrays of zeros and ones are sets; ``.med`` with its groups, ``.bdf``, ``.nas``
        and ``.fem`` of Nastran with properties, ``.e`` of Exodus with its blocks and sets, whatever else meshio reads;
        ``.k``, ``.key`` and ``.dyn`` of LS-DYNA with parts and sets; ``.geo`` of Gmsh, a script which is run and
        meshed, if it is trusted; ``.step``, ``.stp``, ``.iges``, ``.igs`` and ``.brep``, shapes which Gmsh meshes by
        tetrahedra, and shapes without volume by triangles.
    drop_orphans : bool
        Whether nodes that belong to no cell are left out, such as centres of circles.
    trust : bool
        Run the script of a ``.geo`` file. Such scripts can run any command of the system: read them before. A scene
        file cannot say this; `read_scene` takes `trust`, the command line ``--trust``.
    size : length, optional
        Of cells, for CAD files, which need it; cells are smaller where edges are shorter.
    order : {1, 2}, optional
        Of the cells of CAD files, 2 by default; those have their nodes on curved faces, and do not lock as tet4 do.
    unit : {"mm", "cm", "m", "in", "ft"}
        Of length that the mesh of a STEP or IGES file shall have, whatever that of the file; millimetres by default.
        Files of BREP have none.
    part : str, optional
        Name of a group of cells which alone is the mesh, such as the stiffeners of a hull, without nodes of others.
    within : path, optional
        Folder which reading must not leave, for files that the file includes as well; that of the scene for meshes in
        scene files unless ``allow_outside`` is said.

    Raises
    ------
    InputError
        By `build`, with the path, if the file cannot be read, is a script that is not trusted, holds unknown cells,
        or faces that no cell has; if a CAD file is not of the format that its ending says.

    Notes
    -----
    CAD files are read by their named format alone, and no script in them is run. Sets of their faces and solids have
    their names in the file, if no other has the same, else ``face1``, ``solid1`` and so on (``edge1`` of shapes without
    volume). Solids that touch each other are not connected: take them one by one, by `part`, and tie them.

    Instances of Abaqus' parts stand where the assembly has them. If there are several, their sets are called
    ``INSTANCE.SET`` and the cells of each ``INSTANCE``; ``part="INSTANCE"`` is one of them as a mesh of its own.

    Parts of LS-DYNA are sets of cells by their titles, else ``part1``; sets without a title are ``nodes1``,
    ``segments1`` (of faces), ``parts1`` and ``elements1``, by their numbers; those of Exodus ``block1``, ``nodes1`` and
    ``sides1``.

    Nodes of Nastran may be given in any coordinate system. Its elements without a property are in no set; springs,
    dampers, masses and welds are no cells; what would make or move nodes or elements and is not read is refused.

    Needs the package meshio, but for Abaqus, LS-DYNA and Nastran files: ``pip install "visviva[mesh]"``; for ``.geo``
    and CAD also gmsh: ``pip install "visviva[gmsh]"``.

    Examples
    --------
    >>> import tempfile
    >>> from visviva import BoxMesh
    >>> file = tempfile.mkdtemp() + "/box.inp"
    >>> BoxMesh(size=(1, 1, 1), counts=(2, 2, 2), cell="tet10").build().write(file)
    >>> MeshFile(file).build()
    <Mesh: 125 nodes, 48 tet10; sets: x0, x1, y0, y1, z0, z1>
    """

    path: Path
    drop_orphans: bool = False
    trust: bool = False
    size: Length | None = None
    order: Literal[1, 2] | None = None
    unit: Literal["mm", "cm", "m", "in", "ft"] | None = None
    part: str | None = None
    within: Path | None = None

    def build(self) -> Mesh:
        """The mesh."""
        refuse_outside(existing(self.path), self.within)
        try:
            read = self._collection()
            mesh = (read if self.part is None else read.part(self.part)).mesh()
        except ValueError as error:
            raise InputError(f"{self.path} cannot be used as a mesh: {error}") from error
        return mesh.without_orphans() if self.drop_orphans or self.part is not None else mesh

    def _collection(self) -> Collection:
        suffix = self.path.suffix.lower()
        if suffix in cad.FORMATS:
            return self._cad()
        self._refuse_sizes()
        if suffix == ".inp":
            return Reader(self.within).read(self.path)
        if suffix in ls_dyna.ENDINGS:
            return ls_dyna.Reader(self.within).read(self.path)
        if suffix in nastran.ENDINGS:
            return nastran.Reader(self.within).read(self.path)
        if suffix == ".geo":
            self._refuse_untrusted()
            with tempfile.TemporaryDirectory() as folder:
                return _of_meshio(_meshio_read(_meshed(self.path, Path(folder) / "mesh.msh")))
        if self.within is not None and suffix in CAN_REFER:
            raise InputError(
                f"files *{suffix} can name others to be read, which may be outside the scene's folder: convert it to "
                ".vtu, or allow it by --allow-outside (in Python read_scene(..., allow_outside=True))"
            )
        read = _meshio_read(self.path)
        if suffix == ".vtk":  # its names are written without blanks
            read.point_data = {unquote(name): data for name, data in read.point_data.items()}
            read.cell_data = {unquote(name): data for name, data in read.cell_data.items()}
        made = _of_meshio(read)
        made.blocks = [
            read_order(suffix, kind, rows, made.points)
            for kind, rows in zip(made.types, made.blocks, strict=True)
        ]
        return exodus.with_names(made, self.path) if suffix in EXODUS_ENDINGS else made

    def _cad(self) -> Collection:
        with tempfile.TemporaryDirectory() as folder:
            made = cad.meshed(
                self.path, Path(folder) / "mesh.msh", size=self.size, order=self.order or 2, unit=self.unit,
                alone=self.within is not None,
            )  # fmt: skip
            return _of_meshio(_meshio_read(made))

    def _refuse_sizes(self) -> None:
        given = [name for name in ("size", "order", "unit") if getattr(self, name) is not None]
        if given:
            raise InputError(
                f"{' and '.join(given)} only tell how CAD files ({', '.join(cad.FORMATS)}) are meshed"
            )

    def _refuse_untrusted(self) -> None:
        if not self.trust:
            raise InputError(
                "it is a script of Gmsh, which can run any command of the system: read it, then trust it by --trust "
                "(in Python MeshFile(..., trust=True) or read_scene(..., trust=True)), or mesh it to a .msh file"
            )


def _meshed(script: Path, target: Path) -> Path:
    """Let Gmsh run a script and mesh what it makes."""
    try:
        import gmsh
    except (ImportError, OSError) as error:  # its shared library needs some of the system
        raise InputError(
            f'a script of Gmsh needs the package gmsh: pip install "visviva[gmsh]" ({error})'
        ) from error
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(script))
        gmsh.model.mesh.generate(gmsh.model.getDimension())
        gmsh.write(str(target))
    except Exception as error:  # it raises plain exceptions
        raise InputError(f"Gmsh says: {error}") from error
    finally:
        gmsh.finalize()
    return target


def _meshio_read(path: Path) -> Any:
    meshio = load_meshio()
    named = {".msh": "gmsh"}  # else meshio tries Ansys first, and prints what fails
    said = io.StringIO()  # it prints what it raises as well
    try:
        with redirect_stdout(said), redirect_stderr(said), _complete(path) as file:
            return meshio.read(file, file_format=named.get(path.suffix.lower()))
    except InputError:
        raise
    except ModuleNotFoundError as error:
        raise InputError(
            f"meshio reads *{path.suffix} by another package: pip install {error.name}"
        ) from error
    except (Exception, SystemExit) as error:  # its readers raise whatever the bytes lead them to, or exit
        raise InputError(f"meshio cannot read it ({type(error).__name__}: {error})") from error


@contextmanager
def _complete(path: Path) -> Iterator[Path]:
    """The file; of Exodus a copy with names of cells that meshio knows."""
    if path.suffix.lower() not in EXODUS_ENDINGS:
        yield path
        return
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(shutil.copyfile(path, Path(folder) / path.name))
        exodus.rename_cells(copy)
        yield copy


def _of_meshio(read: Any) -> Collection:
    """Parts of a mesh read by meshio: cells, named groups, sets."""
    unknown = {block.type: len(block.data) for block in read.cells if block.type not in NAMES}
    if unknown:
        listed = ", ".join(f"{n} cells of type {name}" for name, n in unknown.items())
        raise InputError(f"it holds {listed}; known are {', '.join(CELLS)}")
    blocks = [np.asarray(block.data, dtype=np.int64) for block in read.cells]
    starts = np.cumsum([0, *map(len, blocks)])
    groups: dict[str, list[Ints]] = {}
    for name, block, rows in _groups(read):
        groups.setdefault(name, []).append(starts[block] + rows)
    return Collection(
        np.asarray(read.points, dtype=float),
        [NAMES[block.type] for block in read.cells],
        blocks,
        {name: np.unique(np.concatenate(parts)) for name, parts in groups.items()},
        {name: np.unique(np.asarray(nodes, np.int64)) for name, nodes in _node_sets(read)},
    )


def _groups(read: Any) -> Iterator[tuple[str, int, Ints]]:
    """Name, number of the block and rows in it of all groups of cells."""
    for name, blocks in read.cell_sets.items():
        if not name.startswith("gmsh:"):
            parts = enumerate(blocks)
            yield from ((name, k, np.asarray(rows, np.int64)) for k, rows in parts if np.size(rows))
    physical = read.cell_data.get("gmsh:physical")
    if physical is not None:
        called = {(int(tag), int(dim)): name for name, (tag, dim) in _tags(read).items()}
        for k, tags in enumerate(physical):
            dim = dimension_of(NAMES[read.cells[k].type])
            for tag in np.unique(tags[tags != 0]):
                yield called.get((int(tag), dim), str(tag)), k, np.flatnonzero(tags == tag)
    for k, families in enumerate(read.cell_data.get("cell_tags", ())):  # of MED
        for name, family in _families(getattr(read, "cell_tags", {})):
            yield name, k, np.flatnonzero(families == family)
    for name, data in read.cell_data.items():
        if (
            ":" not in name
            and name != "cell_tags"
            and _is_set(np.concatenate([np.asarray(part) for part in data]))
        ):
            yield from ((name, k, np.flatnonzero(part)) for k, part in enumerate(data) if np.any(part))


def _tags(read: Any) -> dict[str, Any]:
    return {name: value for name, value in read.field_data.items() if np.size(value) == 2}


def _families(tags: Any) -> list[tuple[str, int]]:
    """Names of groups with the families of MED that are in them."""
    return [(name, int(family)) for family, names in tags.items() for name in names]


def _node_sets(read: Any) -> Iterator[tuple[str, Ints]]:
    yield from read.point_sets.items()
    families = _families(getattr(read, "point_tags", {}))  # of MED
    for name in dict.fromkeys(name for name, _ in families):
        tags = [family for label, family in families if label == name]
        yield name, np.flatnonzero(np.isin(read.point_data["point_tags"], tags))
    for name, data in read.point_data.items():
        if ":" not in name and name != "point_tags" and _is_set(data):
            yield name, np.flatnonzero(data)


def _is_set(data: Any) -> bool:
    """Whether an array consists of zeros and ones in whole numbers."""
    return bool(
        data.ndim == 1 and np.issubdtype(data.dtype, np.integer) and np.all((data == 0) | (data == 1))
    )
