"""What is drawn of a system: surfaces of its components, and where their points are at a state."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from visviva.body.fields import quantity, smoothed
from visviva.body.solid import Solid
from visviva.component import Attachable
from visviva.contact import fields as of_contact
from visviva.contact.contact import Contact
from visviva.form import Vector
from visviva.measure import Position
from visviva.mesh.cells import CELLS
from visviva.output.surface import Surface

if TYPE_CHECKING:
    from visviva.study import Probe, Study
    from visviva.system import System

Array = NDArray[np.float64]
Line = tuple[Vector, Vector]


class Drawing:
    """The surfaces of a system and, for any state, the points of each.

    Parameters
    ----------
    system : System
        Every component with a `surface` is drawn, the cells of solids, and the `lines` of ropes and springs.
    spots : mapping
        Further single points by name.
    fields : sequence of str
        Fields of solids to store, beside displacements, velocities and what contacts show; see `Solid.nodal`.

    Attributes
    ----------
    surfaces : tuple of Surface
        Named after the components, points of rigid bodies in their own coordinates.

    Raises
    ------
    InputError
        For a field that does not exist.

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
        self,
        system: System,
        spots: Mapping[str, Vector] | None = None,
        fields: Sequence[str] = (),
    ) -> None:
        drawn = [(c, c.surface()) for c in system.components if isinstance(c, Attachable)]
        bodies = [(c, surface) for c, surface in drawn if surface is not None]
        self._solids = [c for c in system.components if isinstance(c, Solid)]
        named = list(named_lines(system))
        taken = {str(c.name) for c in (*(c for c, _ in bodies), *self._solids)} | {name for name, _ in named}
        free = {name: spot for name, spot in (spots or {}).items() if name not in taken}
        self.surfaces = (
            *(Surface(str(c.name), points, triangles) for c, (points, triangles) in bodies),
            *(filled(solid) for solid in self._solids),
            *(Surface(name, [p.value(system.x) for p in line], [[0, 1]]) for name, line in named),
            *(Surface(name, [spot.value(system.x)], [[0]]) for name, spot in free.items()),
        )
        self._n_bodies, self._n_lines = len(bodies), len(named)
        vectors = [v for c, _ in bodies for v in placement(c)]
        vectors += [end for _, line in named for end in line] + list(free.values())
        self._map, self._constant = stacked(vectors, len(system.x))
        self._start = self.points(system.model.initial[0])
        self._contacts = [c for c in system.components if isinstance(c, Contact)]
        self._starts = np.cumsum([0, *(len(surface.points) for surface in self.surfaces)])
        starts = dict(zip(self._solids, self._starts[self._n_bodies :].tolist(), strict=False))
        self._painting = of_contact.Painting(self._contacts, starts, int(self._starts[-1]))
        shown = [name for name in fields if self._painting.is_blank or name not in of_contact.FIELDS]
        self._fields = {name: quantity(name)[0] for name in shown}

    @property
    def has_solids(self) -> bool:
        """Whether there is something that deforms."""
        return bool(self._solids)

    def points(self, x: Array) -> list[Array]:
        """Points of every surface at the unknowns `x`."""
        return self._placed(self._map @ x + self._constant, [solid.positions(x) for solid in self._solids])

    def velocities(self, v: Array) -> list[Array]:
        """Velocities of the points of every surface at the rates `v`."""
        return self._placed(self._map @ v, [solid.velocities(v) for solid in self._solids])

    def values(self, x: Array, v: Array, records: Sequence[Array] | None = None) -> dict[str, Array]:
        """Stored quantities over the points of all surfaces, (n,) or (n, components); none without solids.

        Displacements count from the start. Where a component has no such field, there is NaN. Contacts show their
        last step, or what they recorded then (see `Result.records`).
        """
        if not self._solids:
            return {}
        moved = [now - then for now, then in zip(self.points(x), self._start, strict=True)]
        found = {"displacement": np.concatenate(moved), "velocity": np.concatenate(self.velocities(v))}
        parts = [smoothed(solid, tuple(self._fields), x) for solid in self._solids]
        n = self._starts[-1]
        for name, width in self._fields.items():
            everywhere = np.full((n, width) if width > 1 else n, np.nan)
            for start, part in zip(self._starts[self._n_bodies :], parts, strict=False):
                everywhere[start : start + len(part[name])] = part[name]
            found[name] = everywhere
        if not self._painting.is_blank:
            shown = [c.record(x) for c in self._contacts] if records is None else records
            found |= self._painting.values(shown)
        return found

    def _placed(self, mapped: Array, solids: list[Array]) -> list[Array]:
        """Vectors at the points of every surface, from the mapped ones and those of the solids."""
        values = mapped.reshape(-1, 3)
        n, m = 4 * self._n_bodies, 4 * self._n_bodies + 2 * self._n_lines
        moved = [
            s.points @ frame[1:] + frame[0]
            for s, frame in zip(self.surfaces, values[:n].reshape(-1, 4, 3), strict=False)
        ]
        return [*moved, *solids, *values[n:m].reshape(-1, 2, 3), *values[m:, None]]


def filled(solid: Solid) -> Surface:
    """The cells of a solid at their reference positions."""
    cells = solid.grid.cells
    return Surface(str(solid.name), solid.points, list(cells.values()), [CELLS[name].vtk for name in cells])


def named_lines(system: System) -> Iterator[tuple[str, Line]]:
    """Lines of components under their names."""
    for component in system.components:
        for k, line in enumerate(component.lines()):
            yield (f"{component.name}-{k + 1}" if k else str(component.name)), line


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
    """What is drawn of a study: its system, and its trails where no component has their name."""
    places = {name: place_of(study.probes[name]) for name in study.trails if name in study.probes}
    spots = {name: place for name, place in places.items() if place is not None}
    return Drawing(study.system, spots, study.fields)


def place_of(probe: Probe) -> Vector | None:
    """The point that a probe records, if it does."""
    if isinstance(probe, Position) and probe.direction is None:
        return probe.place
    return probe if isinstance(probe, Vector) else None


def trail_names(study: Study, drawing: Drawing) -> list[str]:
    """Which surfaces leave a trail: those named in the study."""
    return [s.name for s in drawing.surfaces if s.name in study.trails]


def shown_field(study: Study, drawing: Drawing) -> str:
    """The field by which pictures are coloured: the first of the study, if there are solids."""
    return study.fields[0] if drawing.has_solids and study.fields else ""
