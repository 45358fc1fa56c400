"""A motion as a series of files for ParaView (.pvd with .vtu), which have a place for the names of components."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

from visviva.base.errors import InputError
from visviva.output.manifest import PIECE
from visviva.output.reader import blocks
from visviva.output.safe_files import called, replacing, reporting
from visviva.output.trajectory import Trajectory

COMPONENTS = {
    3: ("x", "y", "z"),
    6: ("xx", "yy", "zz", "xy", "yz", "zx"),
    9: tuple(a + b for a in "xyz" for b in "xyz"),
}
"""Names of the components of vectors, symmetric tensors and tensors."""
HEAD = '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n<Collection>\n'
END = "</Collection>\n</VTKFile>\n"


def write_pvd(
    trajectory: str | Path, file: str | Path, *, progress: Callable[[int, int], None] | None = None
) -> Path:
    """Write a motion as ``*.pvd``, with a ``*.vtu`` of every component and moment in a folder of the same name.

    Parameters
    ----------
    trajectory
        A ``trajectory.vtkhdf``.
    file
        To write.
    progress
        Called with the number of moments done and of all.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        If PyVista is not installed, or the folder holds other files than such pieces.
    RunError
        If a file cannot be written.
    """
    target = called(file, "meshes by component and moment", ".pvd")
    folder = target.with_suffix("")
    refuse_foreign(folder)
    with reporting(folder):
        folder.mkdir(parents=True, exist_ok=True)
    lines = []
    with Trajectory(trajectory) as motion:
        for step, time in enumerate(motion.times.tolist()):
            meshes = blocks(motion, time)
            for k, name in enumerate(meshes.keys()):
                piece = folder / f"{k:03d}-{step:05d}.vtu"
                name_components(meshes[k], motion.labels.parts)
                with reporting(piece):
                    meshes[k].save(piece)
                place = quoteattr(f"{folder.name}/{piece.name}")
                lines.append(
                    f'<DataSet timestep="{time!r}" part="{k}" name={quoteattr(name)} file={place}/>\n'
                )
            if progress is not None:
                progress(step + 1, len(motion.times))
    with reporting(target), replacing(target) as temporary:
        temporary.write_text(HEAD + "".join(lines) + END, encoding="utf-8")
    return target


def refuse_foreign(folder: Path) -> None:
    """Refuse a folder that is of somebody else."""
    others = [f.name for f in folder.iterdir() if not PIECE.fullmatch(f.name)] if folder.is_dir() else []
    if others:
        raise InputError(f"{folder}: holds {others[0]!r}, which is no piece of a motion: give another name")


def name_components(mesh: Any, parts: Mapping[str, Sequence[str]]) -> None:
    """Give the fields of a mesh the names of their components: those in `parts`, or of vectors and tensors."""
    data = mesh.GetPointData()
    for name in mesh.point_data:
        array = data.GetAbstractArray(name)
        width = array.GetNumberOfComponents()
        for k, component in enumerate(parts.get(name, COMPONENTS.get(width, ()))):
            array.SetComponentName(k, component)
