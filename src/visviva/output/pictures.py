"""Appearance of the pictures and the movie of a run, in Python and in scene files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from visviva.base.arguments import Validated
from visviva.base.errors import InputError, nearest

Camera = tuple[Sequence[float], Sequence[float], Sequence[float]]

COLORS = "viridis"
"""Colour map of fields."""

DIAGRAM = "diagram_"
"""What names of stored diagrams begin with."""

PRESETS = {
    "front": ((0.0, -1.0, 0.0), (0.0, 0.0, 1.0)),
    "back": ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
    "left": ((-1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    "right": ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    "top": ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0)),
    "bottom": ((0.0, 0.0, -1.0), (0.0, 1.0, 0.0)),
    "iso": ((1.0, -1.0, 0.8), (0.0, 0.0, 1.0)),
}
"""Directions from which one looks at the whole, and what is up then."""
LARGEST = 16384
"""Most pixels along an edge of a picture."""

ALWAYS = ("displacement", "velocity")
"""Fields that every trajectory holds."""

WIDTHS = {"field": (1, 3), "vectors": (3, 6)}
"""Numbers of components of fields that colour surfaces, and of those that are drawn as glyphs."""


@dataclass(frozen=True)
class Pictures(metaclass=Validated):
    """Contents and viewpoint of the pictures and the movie of a run.

    Parameters
    ----------
    field : str
        What colours surfaces, a number or the length of a vector; the first stored of the study's fields if not given.
    vectors : str
        A field of vectors, drawn as arrows, such as ``velocity`` or ``heat_flux``, or of symmetric tensors, drawn as
        lines along the principal directions, such as ``cauchy``: red in tension, blue in compression.
    diagram : str
        A force or moment in the sections of beams that is drawn along them: ``shear_1``, ``shear_2``, ``normal``,
        ``bending_1``, ``bending_2`` or ``torsion``; bending moments stand on the side in tension.
    limits : (2,), optional
        Values at the ends of the colour bar; round ones around those of the whole motion if not given.
    outline : bool
        Draw everything as it was at the start, too, as a shade.
    camera : str or (3, 3), optional
        Position, point looked at and up direction, or ``front``, ``back``, ``left``, ``right``, ``top``, ``bottom``,
        ``iso``. By default all is in view.
    size : (2,), optional
        Width and height in pixels, even ones; 1600 x 1000 for pictures and 1280 x 720 for movies if not given.
    cmap : str
        Colour map of matplotlib.
    deform : float
        Factor of displacements, of what has some.

    Notes
    -----
    What they show is stored in the trajectory, whether the study's `fields` name it or not.

    Examples
    --------
    >>> import visviva as vv
    >>> section = vv.TubeSection(radius=0.05, young=1e9, poisson=0.25, density=1.0)
    >>> beam = vv.Beam(mesh=vv.LineMesh(points=[(0, 0, 0), (1, 0, 0)], count=4), section=section)
    >>> system = vv.System([beam, vv.Clamped(solid=beam, nodes="start")])
    >>> study = vv.Study(system, until=1.0, step=0.1, pictures=vv.Pictures(diagram="bending_1", camera="front"))
    >>> study.stored[-1]
    'diagram_bending_1'
    """

    field: str = ""
    vectors: str = ""
    diagram: str = ""
    limits: tuple[float, float] | None = None
    outline: bool = False
    camera: str | Camera | None = None
    size: tuple[int, int] | None = None
    cmap: str = COLORS
    deform: float = 1.0

    def __post_init__(self) -> None:
        refuse_camera(self.camera, "Pictures: ")
        if self.limits is not None and not self.limits[0] < self.limits[1]:
            raise InputError(f"Pictures: limits = {self.limits} are not in order")
        if self.size is not None:
            refuse_size(self.size)
            if self.size[0] % 2 or self.size[1] % 2:
                raise InputError(f"Pictures: size = {self.size}: movies need an even width and height")
        if self.cmap != COLORS:
            refuse_unknown_colors(self.cmap)

    @property
    def named(self) -> dict[str, str]:
        """The fields that are shown, by what shows them."""
        found = {"field": self.field, "vectors": self.vectors}
        found["diagram"] = f"{DIAGRAM}{self.diagram}" if self.diagram else ""
        return {what: name for what, name in found.items() if name}

    @property
    def options(self) -> dict[str, Any]:
        """Options of `snapshot` and `movie`, without the field if there is none, and sizes that are their own."""
        return {name: value for name, value in asdict(self).items() if value not in ("", None)}

    def refuse_unshown(self, stored: Mapping[str, int]) -> None:
        """Refuse what cannot be shown, by the number of components of all that is stored.

        Raises
        ------
        InputError
            With what can be.
        """
        for what, name in self.named.items():
            known = [n for n, width in stored.items() if can_show(what, n, width)]
            if name not in known:
                raise InputError(
                    f"Pictures: {what} {name!r} is nothing that this system has and it can show"
                    f"{nearest(name, known)}"
                )


def can_show(what: str, name: str, width: int) -> bool:
    """True if a field of this number of components can be colours (`field`), glyphs (`vectors`) or a diagram."""
    return name.startswith(DIAGRAM) if what == "diagram" else width in WIDTHS[what]


def refuse_camera(camera: str | Camera | None, where: str = "") -> None:
    """Refuse a camera that has no such name, or sees nothing.

    Raises
    ------
    InputError
        With the names, or what is wrong with the vectors.
    """
    if isinstance(camera, str):
        if camera not in PRESETS:
            raise InputError(f"{where}there is no camera {camera!r}{nearest(camera, PRESETS)}")
    elif camera is not None:
        eye, target, up = np.array(camera, dtype=float)
        across, length = np.cross(target - eye, up), np.linalg.norm(target - eye) * np.linalg.norm(up)
        if not (length > 0 and np.linalg.norm(across) > 1e-9 * length):
            raise InputError(
                f"{where}camera = {camera} sees nothing: it is (eye, target, up), where the target lies beside the "
                "eye and up points in another direction than the view"
            )


def refuse_size(size: tuple[int, int]) -> None:
    """Refuse pictures of sizes that no renderer draws."""
    if min(size) < 16 or max(size) > LARGEST:
        raise InputError(f"a picture is 16 to {LARGEST} pixels wide and high, not {size[0]} x {size[1]}")


def refuse_unknown_colors(name: str) -> None:
    """Refuse colour maps that matplotlib does not know."""
    from matplotlib import colormaps

    if name not in colormaps:
        raise InputError(f"there is no colour map {name!r}{nearest(name, list(colormaps))}")
