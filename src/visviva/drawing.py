"""What is drawn of a system: surfaces of its components, and where their points are at a state."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from visviva.component import Attachable
from visviva.form import Vector
from visviva.output.surface import Surface

if TYPE_CHECKING:
    from visviva.study import Study
    from visviva.system import System

Array = NDArray[np.float64]
Line = tuple[Vector, Vector]


class Drawing:
    """The surfaces of a system and, for any state, the points of each.

    Parameters
    ----------
    system : System
        Every component with a `surface` is drawn, and the `lines` of ropes and springs.
    lines : sequence of (Vector, Vector)
        Further lines between two points.
    spots : mapping
        Further single points by name.

    Attributes
    ----------
    surfaces : tuple of Surface
        Named after the components, points in their own coordinates.

    Examples
    --------
    >>> import visviva as vv
    >>> ball = vv.PointMass(mass=1.0, position=(0, 0, 2), name="ball")
    >>> system = vv.System([vv.Ground(), ball])
    >>> drawing = Drawing(system)
    >>> drawing.surfaces[0].name, float(drawing.points(system.x)[0][:, 2].mean().round(9))
    ('ball', 2.0)
    """

    def __init__(
        self, system: System, lines: Sequence[Line] = (), spots: Mapping[str, Vector] | None = None
    ) -> None:
        drawn = [(c, c.surface()) for c in system.components if isinstance(c, Attachable)]
        solids = [(c, surface) for c, surface in drawn if surface is not None]
        named = list(named_lines(system, lines))
        taken = {str(c.name) for c, _ in solids} | {name for name, _ in named}
        free = {name: spot for name, spot in (spots or {}).items() if name not in taken}
        self.surfaces = (
            *(Surface(str(c.name), points, triangles) for c, (points, triangles) in solids),
            *(Surface(name, [p.value(system.x) for p in line], [[0, 1]]) for name, line in named),
            *(Surface(name, [spot.value(system.x)], [[0]]) for name, spot in free.items()),
        )
        self._n_solids, self._n_lines = len(solids), len(named)
        vectors = [v for c, _ in solids for v in placement(c)]
        vectors += [end for _, line in named for end in line] + list(free.values())
        self._map, self._constant = stacked(vectors, len(system.x))

    def points(self, x: Array) -> list[Array]:
        """Points of every surface at the unknowns `x`."""
        values = (self._map @ x + self._constant).reshape(-1, 3)
        n, m = 4 * self._n_solids, 4 * self._n_solids + 2 * self._n_lines
        moved = [
            s.points @ frame[1:] + frame[0]
            for s, frame in zip(self.surfaces, values[:n].reshape(-1, 4, 3), strict=False)
        ]
        return [*moved, *values[n:m].reshape(-1, 2, 3), *values[m:, None]]


def named_lines(system: System, lines: Sequence[Line]) -> Iterator[tuple[str, Line]]:
    """Lines of components under their names, then the given ones that are not among them."""
    drawn: set[Line] = set()
    for component in system.components:
        for k, line in enumerate(component.lines()):
            drawn.add(line)
            yield (f"{component.name}-{k + 1}" if k else str(component.name)), line
    for k, line in enumerate(lines):
        if line not in drawn:
            yield f"line-{k + 1}", line


def placement(component: Attachable) -> list[Vector]:
    """Origin and three directions of a component; directions of space where it has none of its own."""
    origin = component.place(np.zeros(3))
    if not component.has_directions:
        return [origin, *(Vector.constant(e) for e in np.eye(3))]
    return [origin, *(component.turn(e) for e in np.eye(3))]


def stacked(vectors: Sequence[Vector], n_unknowns: int) -> tuple[sparse.csr_array, Array]:
    """All components of vectors as one matrix on the unknowns plus constants."""
    forms = [form for vector in vectors for form in vector]
    entries = [(row, u, w) for row, form in enumerate(forms) for u, w in form.weights]
    row, column, weight = zip(*entries, strict=True) if entries else ((), (), ())
    matrix = sparse.csr_array((weight, (row, column)), shape=(len(forms), n_unknowns), dtype=float)
    return matrix, np.array([form.constant for form in forms])


def draw(study: Study) -> Drawing:
    """What is drawn of a study: its system, its ropes, and its trails where no component has their name."""
    spots = {name: study.probes[name] for name in study.trails if name in study.probes}
    return Drawing(study.system, study.ropes, {n: v for n, v in spots.items() if isinstance(v, Vector)})


def trail_names(study: Study, drawing: Drawing) -> list[str]:
    """Which surfaces leave a trail: those named in the study."""
    return [s.name for s in drawing.surfaces if s.name in study.trails]
