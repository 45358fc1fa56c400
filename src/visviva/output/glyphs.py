"""Glyphs of pictures: arrows of vectors, crosses of principal values, diagrams along beams."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from visviva.base.errors import InputError, nearest
from visviva.output.coloring import fluids_of
from visviva.output.pictures import DIAGRAM
from visviva.output.skin import CELL_OF, skin
from visviva.output.standing import Standing
from visviva.output.surface import Surface

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

MOST = 300
"""Arrows or crosses at most: more than that hide each other."""
REACH = 0.1
"""Length of the longest glyph, of the size of what is in view."""
STEPS = 20
"""Moments at which the largest value is looked for."""

TENSOR = [[0, 3, 5], [3, 1, 4], [5, 4, 2]]
"""Places of the entries of a symmetric tensor among its six components xx, yy, zz, xy, yz, zx."""


def no_lines() -> Array:
    """No lines (0, 2, 3)."""
    return np.zeros((0, 2, 3))


@dataclass(frozen=True)
class Glyphs:
    """Glyphs of one moment.

    Attributes
    ----------
    arrows : (n, 2, 3) array
        Ends of arrows, the tip second.
    positive, negative : (n, 2, 3) arrays
        Ends of lines: principal values above and below zero.
    outlines : (n, 2, 3) array
        Ends of the lines of diagrams.
    sheets : (n, 4, 3) array
        Corners of the faces between diagrams and their beams.
    """

    arrows: Array = field(default_factory=no_lines)
    positive: Array = field(default_factory=no_lines)
    negative: Array = field(default_factory=no_lines)
    outlines: Array = field(default_factory=no_lines)
    sheets: Array = field(default_factory=lambda: np.zeros((0, 4, 3)))

    def and_also(self, others: Glyphs) -> Glyphs:
        """Both together."""
        names = ("arrows", "positive", "negative", "outlines", "sheets")
        return Glyphs(
            **{name: np.concatenate([getattr(self, name), getattr(others, name)]) for name in names}
        )

    @property
    def ends(self) -> Array:
        """All points (n, 3)."""
        lines = (self.arrows, self.positive, self.negative, self.outlines, self.sheets)
        return np.concatenate([part.reshape(-1, 3) for part in lines])


NO_GLYPHS = Glyphs()


class MotionGlyphs:
    """The glyphs of a motion or a moment, of one length per value at all times.

    Parameters
    ----------
    motion
        What is drawn.
    vectors
        A field of vectors, drawn as arrows, or of symmetric tensors, drawn as crosses of their principal values: lines
        along the principal directions, red where positive and blue where negative.
    diagram
        A force or moment in the sections of beams, ``bending_1`` and the like, drawn as its diagram.
    time
        The only moment that is drawn, whose largest value then has the longest glyph; all of them if not given.

    Raises
    ------
    InputError
        If there is no such field, or it is neither.

    Examples
    --------
    >>> import tempfile, visviva as vv
    >>> cube = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1))
    >>> body = vv.Solid(mesh=cube, material=vv.NeoHooke(young=1, poisson=0), density=1.0, velocity=(2, 0, 0))
    >>> file = tempfile.mkdtemp() + "/t.vtkhdf"
    >>> vv.simulate(vv.System([body]), until=0.2, step=0.1).write(file)
    >>> with Standing(file) as motion:
    ...     glyphs = MotionGlyphs(motion, "velocity").at(0.2)
    >>> glyphs.arrows.shape, len(glyphs.sheets)
    ((8, 2, 3), 0)
    """

    def __init__(
        self, motion: Standing, vectors: str = "", diagram: str = "", time: float | None = None
    ) -> None:
        self._motion = motion
        self._kinds: list[Arrows | Crosses | Diagram] = []
        if vectors:
            width = width_of(motion, vectors)
            self._kinds.append(Crosses(motion, vectors) if width == 6 else Arrows(motion, vectors))
        if diagram:
            self._kinds.append(Diagram(motion, diagram))
        chosen = [float(motion.times[k]) for k in motion.chosen_steps(STEPS)] if time is None else [time]
        self._times = chosen if self._kinds else []
        extent = float(np.linalg.norm(np.ptp(motion.cloud(STEPS), axis=0))) or 1.0
        self._largest = [max(kind.largest(moment) for moment in self._times) for kind in self._kinds]
        self._scales = [
            kind.reach(extent) / (largest or 1.0)
            for kind, largest in zip(self._kinds, self._largest, strict=True)
        ]

    @property
    def text(self) -> str:
        """Legend: the value of the longest glyph."""
        labels, pairs = self._motion.labels, zip(self._kinds, self._largest, strict=True)
        said = [f"{kind.called} {labels.valued(kind.name, largest)}" for kind, largest in pairs]
        return "".join(f"    {text}" for text in said)

    def at(self, time: float) -> Glyphs:
        """The glyphs at a time."""
        points, found = self._motion.points_at(time), NO_GLYPHS
        for kind, scale in zip(self._kinds, self._scales, strict=True):
            found = found.and_also(kind.glyphs(time, points, scale))
        return found

    def cloud(self) -> Array:
        """Points (n, 3) that shall be in view: those of the motion and of its glyphs."""
        return np.concatenate([self._motion.cloud(), *(self.at(time).ends for time in self._times)])


class Arrows:
    """Vectors at points spread over the surfaces that have them."""

    called = "longest arrow:"

    def __init__(self, motion: Standing, name: str) -> None:
        self.name, self._motion = name, motion
        self._spots = spots_of(motion, name)

    def largest(self, time: float) -> float:
        """Length of the longest vector."""
        return max((float(np.linalg.norm(v, axis=1).max()) for v in self._values(time).values()), default=0.0)

    def reach(self, extent: float) -> float:
        """Length of the longest arrow, so that neighbours can be told apart."""
        return apart(self._motion, self._spots, extent)

    def glyphs(self, time: float, points: Sequence[Array], scale: float) -> Glyphs:
        """Arrows at the present points."""
        lines = [
            np.stack([points[k][self._spots[k]], points[k][self._spots[k]] + scale * v], axis=1)
            for k, v in self._values(time).items()
        ]
        return Glyphs(arrows=np.concatenate([no_lines(), *lines]))

    def _values(self, time: float) -> dict[int, Array]:
        field = self._motion.field_at(self.name, time)
        return {k: self._motion.turned(np.nan_to_num(field[k][spots])) for k, spots in self._spots.items()}


class Crosses:
    """Principal values and directions of symmetric tensors at points spread over the surfaces that have them."""

    called = "longest line:"

    def __init__(self, motion: Standing, name: str) -> None:
        self.name, self._motion = name, motion
        self._spots = spots_of(motion, name)

    def largest(self, time: float) -> float:
        """Largest amount of a principal value."""
        return max((float(np.abs(w).max()) for w, _ in self._values(time).values()), default=0.0)

    def reach(self, extent: float) -> float:
        """Length of the longest line, so that neighbours can be told apart."""
        return apart(self._motion, self._spots, extent)

    def glyphs(self, time: float, points: Sequence[Array], scale: float) -> Glyphs:
        """Lines with their middles at the present points."""
        lines, above = [no_lines()], [np.zeros(0, dtype=bool)]
        for k, (values, directions) in self._values(time).items():
            half = 0.5 * scale * np.abs(values)[:, :, None] * directions
            middle = points[k][self._spots[k]][:, None]
            lines.append(np.stack([middle - half, middle + half], axis=2).reshape(-1, 2, 3))
            above.append(values.ravel() > 0)
        every, positive = np.concatenate(lines), np.concatenate(above)
        return Glyphs(positive=every[positive], negative=every[~positive])

    def _values(self, time: float) -> dict[int, tuple[Array, Array]]:
        """Values (n, 3) and unit vectors (n, 3, 3) by rows."""
        field, found = self._motion.field_at(self.name, time), {}
        for k, spots in self._spots.items():
            values, vectors = np.linalg.eigh(np.nan_to_num(field[k][spots])[:, TENSOR])
            found[k] = values, self._motion.turned(np.swapaxes(vectors, 1, 2))
        return found


class Diagram:
    """The course of a force or moment along beams, as a sheet that stands on their lines."""

    called = "highest:"

    def __init__(self, motion: Standing, name: str) -> None:
        self.name, self._motion = DIAGRAM + name, motion
        if self.name not in motion.fields:
            known = [field.removeprefix(DIAGRAM) for field in motion.fields if field.startswith(DIAGRAM)]
            stored = f"; stored are {', '.join(known)}" if known else ""
            raise InputError(
                f"{motion.path}: holds no diagram {name!r}{nearest(name, known)}{stored}; a run with beams stores what "
                "its study names, fields=['diagram_bending_1', ...]: of shear_1, shear_2, normal, bending_1, "
                "bending_2 and torsion"
            )
        values = motion.field(self.name, 0)
        self._rings = {k: Rings(motion.surfaces[k]) for k, v in enumerate(values) if np.isfinite(v).all()}

    def largest(self, time: float) -> float:
        """Largest amount."""
        values = self._motion.field_at(self.name, time)
        return max((float(np.linalg.norm(values[k], axis=1).max()) for k in self._rings), default=0.0)

    def reach(self, extent: float) -> float:
        """Height of the diagram."""
        return REACH * extent

    def glyphs(self, time: float, points: Sequence[Array], scale: float) -> Glyphs:
        """Sheets between the lines and the values on them, and the outlines of these."""
        values = self._motion.field_at(self.name, time)
        outlines, sheets = [no_lines()], [np.zeros((0, 4, 3))]
        for k, rings in self._rings.items():
            foot, arm = rings.means(points[k]), scale * self._motion.turned(rings.means(values[k]))
            a, b = rings.spans.T
            outlines += [
                np.stack([foot + arm, foot], axis=1), np.stack([(foot + arm)[a], (foot + arm)[b]], axis=1)
            ]  # fmt: skip
            sheets += between(foot[a], arm[a], foot[b], arm[b])
        return Glyphs(outlines=np.concatenate(outlines), sheets=np.concatenate(sheets))


class Rings:
    """The outlines of a beam's sections among the points that are drawn of it.

    Attributes
    ----------
    spans : (m, 2) array
        Numbers of the sections that follow each other along the line.
    """

    def __init__(self, surface: Surface) -> None:
        sides = surface.cells[0]  # a to its neighbour in the section, on to the next section, and back
        n = len(surface.points)
        rows, columns = np.concatenate([sides[:, :2], sides[:, :1:-1]]).T
        around = coo_array((np.ones(len(rows)), (rows, columns)), shape=(n, n))
        self._count, self._ring = connected_components(around, directed=False)
        self.spans: Ints = np.unique(self._ring[sides[:, [0, 3]]], axis=0)

    def means(self, values: Array) -> Array:
        """Means (n, 3) over the sections of values at the points."""
        total = np.zeros((self._count, 3))
        np.add.at(total, self._ring, values)
        return np.asarray(total / np.bincount(self._ring)[:, None])


def between(foot: Array, arm: Array, other: Array, reach: Array) -> list[Array]:
    """Faces (m, 4, 3) of a diagram over spans from one foot to the other; two triangles where it crosses the line."""
    crosses = np.einsum("mi,mi->m", arm, reach) < 0
    sizes = np.linalg.norm(arm, axis=1), np.linalg.norm(reach, axis=1)
    share = sizes[0] / np.where(crosses, sizes[0] + sizes[1], 1.0)
    zero = foot + share[:, None] * (other - foot)
    whole = np.stack([foot, other, other + reach, foot + arm], axis=1)[~crosses]
    first = np.stack([foot, zero, zero, foot + arm], axis=1)[crosses]
    return [whole, first, np.stack([zero, other, other + reach, zero], axis=1)[crosses]]


def width_of(motion: Standing, name: str) -> int:
    """Number of components of a field that can be drawn as arrows (3) or crosses (6)."""
    drawable = [n for n, width in motion.fields.items() if width in (3, 6) and not motion.labels.is_list(n)]
    if name not in drawable:
        what = "is neither a vector nor a symmetric tensor" if name in motion.fields else "is not stored"
        raise InputError(f"{motion.path}: {name!r} {what}{nearest(name, drawable)}")
    return motion.fields[name]


def spots_of(motion: Standing, name: str) -> dict[int, Ints]:
    """Points of the surfaces that have a field, few enough to be told apart; of volumes those that are seen."""
    start = motion.points(0)  # surfaces of rigid bodies have points in coordinates of their own
    low = np.min([points.min(axis=0) for points in start], axis=0)
    having = [k for k, v in enumerate(motion.field(name, 0)) if not np.isnan(v).all()]
    still = fluids_of(motion)
    shown = {k: seen(motion.surfaces[k], inside=k in still) for k in having}
    size = max((float(np.ptp(start[k], axis=0).max()) for k in having), default=0.0) / 40
    while True:
        chosen = {k: spread(start[k], ids, low, size) for k, ids in shown.items()}
        if sum(map(len, chosen.values())) <= max(MOST, len(having)):
            return chosen
        size *= 1.2


def apart(motion: Standing, spots: dict[int, Ints], extent: float) -> float:
    """Length of glyphs somewhat above the distance of these points, within bounds."""
    start = motion.points(0)
    points = np.concatenate([np.zeros((0, 3)), *(start[k][ids] for k, ids in spots.items())])
    distances = cKDTree(points).query(points, k=2)[0][:, 1] if len(points) > 1 else np.zeros(1)
    return float(np.clip(1.6 * np.median(distances), 0.03 * extent, REACH * extent))


def seen(surface: Surface, inside: bool) -> Ints:
    """Numbers of the points that are seen: of opaque volumes those of their faces."""
    kinds = [CELL_OF.get(number) for number in surface.types]
    if inside or not any(kind is not None and kind.dimension == 3 for kind in kinds):
        return np.arange(len(surface.points))
    return np.unique(np.concatenate([block.ravel() for block in skin(surface)]))


def spread(points: Array, ids: Ints, low: Array, size: float) -> Ints:
    """One of the points in every cube of this size, that nearest to its middle."""
    if not size > 0:
        return ids
    places = (points[ids] - low) / size
    cubes = np.floor(places)
    order = np.argsort(np.linalg.norm(places - cubes - 0.5, axis=1), kind="stable")
    _, first = np.unique(cubes[order], axis=0, return_index=True)
    return np.sort(ids[order[first]])
