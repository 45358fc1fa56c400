"""Drawing of a system: surfaces of its components, and the places of their points at a state."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from visviva.base.errors import InputError, nearest
from visviva.body.solid_fields import QUANTITIES
from visviva.component.meshed import Meshed
from visviva.component.point import Attachable
from visviva.contact import contact_fields as of_contact
from visviva.contact.contact import Contact
from visviva.flow.flow_fields import FIELDS
from visviva.measure.names import SINGLE
from visviva.model.form import Vector
from visviva.output.surface import Surface

if TYPE_CHECKING:
    from visviva.system.system import System

Array = NDArray[np.float64]
Line = tuple[Vector, Vector]


class Drawing:
    """The surfaces of a system and, for any state, the points of each.

    Parameters
    ----------
    system : System
        Every component with a `surface` is drawn, the cells of solids and fluids, and the `lines` of ropes and springs.
    spots : mapping
        Further single points by name.
    fields : sequence of str
        Fields of solids and fluids to store, beside displacements, velocities and what contacts show; see
        `Solid.nodal` and `FlowField`. Single components are fields too: ``cauchy_xx``, ``section_moment_torsion``.

    Attributes
    ----------
    surfaces : tuple of Surface
        Named after the components, points of bodies in their own coordinates.

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
        self._meshes = [c for c in system.components if isinstance(c, Meshed)]
        named = list(named_lines(system))
        taken = {str(c.name) for c in (*(c for c, _ in bodies), *self._meshes)} | {name for name, _ in named}
        free = {name: spot for name, spot in (spots or {}).items() if name not in taken}
        self.surfaces = (
            *(Surface(str(c.name), points, triangles) for c, (points, triangles) in bodies),
            *(component.drawn() for component in self._meshes),
            *(Surface(name, [p.value(system.x) for p in line], [[0, 1]]) for name, line in named),
            *(Surface(name, [spot.value(system.x)], [[0]]) for name, spot in free.items()),
        )
        self._n_bodies, self._n_lines = len(bodies), len(named)
        placed = [
            placement(c) if c.moves_rigidly else [c.place(X) for X in points] for c, (points, _) in bodies
        ]
        self._ends = np.cumsum([len(v) for v in placed])
        self._rigid = [c.moves_rigidly for c, _ in bodies]
        vectors = [v for part in placed for v in part]
        vectors += [end for _, line in named for end in line] + list(free.values())
        self._map, self._constant = stacked(vectors, len(system.x))
        self._start = self.points(system.model.initial[0])
        self._contacts = [c for c in system.components if isinstance(c, Contact)]
        self._starts = np.cumsum([0, *(len(surface.points) for surface in self.surfaces)])
        places = zip(self._meshes, self._starts[self._n_bodies :].tolist(), strict=False)
        starts = dict(places)
        self._painting = of_contact.Painting(self._contacts, starts, int(self._starts[-1]))
        shown = [name for name in fields if self._painting.is_blank or name not in of_contact.FIELDS]
        self.fields = self._known(shown)

    def _known(self, fields: Sequence[str]) -> dict[str, int]:
        """Requested fields that some component has, with their numbers of components."""
        everything = {*QUANTITIES, *FIELDS, *(name for c in self._meshes for name in c.widths())}
        for name in fields:
            if name not in everything and SINGLE.get(name, (name, 0))[0] not in everything:
                raise InputError(f"there is no field {name!r}{nearest(name, everything)}")
        found = [(name, c.widths()[name]) for name in fields for c in self._meshes if name in c.widths()]
        widths = {of for c in self._meshes for of in c.widths()}
        found += [(name, 1) for name in fields if name in SINGLE and SINGLE[name][0] in widths]
        return {name: width for name, width in found if name != "velocity"}

    @property
    def stored(self) -> dict[str, int]:
        """Numbers of components of all that is stored at points, by name."""
        of_contacts = {} if self._painting.is_blank else of_contact.FIELDS
        return self.fields | of_contacts | ({"velocity": 3, "displacement": 3} if self.surfaces else {})

    def points(self, x: Array) -> list[Array]:
        """Points of every surface at the unknowns `x`."""
        return self._placed(self._map @ x + self._constant, [c.drawn_positions(x) for c in self._meshes])

    def velocities(self, x: Array, v: Array) -> list[Array]:
        """Velocities of the points of every surface at the unknowns `x` and rates `v`."""
        return self._placed(self._map @ v, [c.drawn_velocities(x, v) for c in self._meshes])

    def values(self, x: Array, v: Array, records: Sequence[Array] | None = None) -> dict[str, Array]:
        """Stored quantities over the points of all surfaces, (n,) or (n, components).

        Displacements count from the start. Where a component has no such field, there is NaN. Contacts show their
        last step, or what they recorded then (see `Result.records`).
        """
        if not self.surfaces:
            return {}
        moved = [now - then for now, then in zip(self.points(x), self._start, strict=True)]
        found = {"displacement": np.concatenate(moved), "velocity": np.concatenate(self.velocities(x, v))}
        n = self._starts[-1]
        for name, width in self.fields.items():
            found[name] = np.full((n, width) if width > 1 else n, np.nan)
        for component, start in zip(self._meshes, self._starts[self._n_bodies :], strict=False):
            wide = component.widths()
            own = [name for name, width in self.fields.items() if wide.get(name) == width]
            single = [name for name in self.fields if name in SINGLE and SINGLE[name][0] in wide]
            whole = component.drawn_fields(list(dict.fromkeys([*own, *(SINGLE[n][0] for n in single)])), x)
            parts = {name: whole[name] for name in own}
            parts |= {name: whole[SINGLE[name][0]][:, SINGLE[name][1]] for name in single}
            for name, part in parts.items():
                found[name][start : start + len(part)] = part
        if not self._painting.is_blank:
            shown = [c.record(x) for c in self._contacts] if records is None else records
            found |= self._painting.values(shown)
        return found

    def _placed(self, mapped: Array, meshes: list[Array]) -> list[Array]:
        """Vectors at the points of every surface, from the mapped ones and those of the meshes."""
        values = mapped.reshape(-1, 3)
        n = int(self._ends[-1]) if self._n_bodies else 0
        m = n + 2 * self._n_lines
        of_bodies = zip(self.surfaces, np.split(values, self._ends)[:-1], self._rigid, strict=False)
        moved = [s.points @ part[1:] + part[0] if rigid else part for s, part, rigid in of_bodies]
        return [*moved, *meshes, *values[n:m].reshape(-1, 2, 3), *values[m:, None]]


def named_lines(system: System) -> Iterator[tuple[str, Line]]:
    """Lines of components under their names."""
    for component in system.components:
        for k, line in enumerate(component.lines()):
            yield (f"{component.name}-{k + 1}" if k else str(component.name)), line


def placement(component: Attachable) -> list[Vector]:
    """Origin and three directions of what moves rigidly; directions of space where it has none of its own."""
    origin = component.place(np.zeros(3))
    if not component.has_directions:
        return [origin, *(Vector.constant(e) for e in np.eye(3))]
    return [origin, *(component.turn(e, np.zeros(3)) for e in np.eye(3))]


def stacked(vectors: Sequence[Vector], n_unknowns: int) -> tuple[sparse.csr_array, Array]:
    """All components of vectors as one matrix on the unknowns plus constants."""
    forms = [form for vector in vectors for form in vector]
    entries = [(row, u, w) for row, form in enumerate(forms) for u, w in form.weights]
    row, column, weight = zip(*entries, strict=True) if entries else ((), (), ())
    matrix = sparse.csr_array((weight, (row, column)), shape=(len(forms), n_unknowns), dtype=float)
    return matrix, np.array([form.constant for form in forms])
