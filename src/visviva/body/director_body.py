"""Bodies on meshes whose nodes carry directors: what beams and shells share."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.body.mesh_body import MeshBody
from visviva.body.mesh_points import in_space
from visviva.component.announcements import Clamping, Guiding
from visviva.component.limited import Limited
from visviva.mesh.generate import MeshSource
from visviva.mesh.mesh import Mesh
from visviva.model.field import Field, Vectors

if TYPE_CHECKING:
    from visviva.component.component import Component
    from visviva.model.model import Model

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Mask = NDArray[np.bool_]

DEPENDENT = 1e-7
"""Remainder of a unit gradient without those of other constraints, above which a constraint counts as independent."""


class DirectorBody(MeshBody, Limited):
    """Base of bodies whose nodes have a position and some directors, one after the other, all interpolated alike.

    What derives from it says where the directors are at first, how heavy its cells are, and what holds its directors
    together.

    Attributes
    ----------
    n_held : int
        Constraints between the directors of a node.
    """

    mesh: Mesh | MeshSource
    section: Any
    n_held: int
    _multipliers: Field
    _more: Field

    @property
    def dimension(self) -> int:
        return 3

    @property
    def is_thin(self) -> bool:
        return True

    def move_reference(self, model: Model, nodes: Ints, by: Array) -> None:
        raise InputError(
            f"{self.label}: its nodes cannot be moved to fit another surface, as its directors, thickness and masses "
            "would stay; let its mesh fit from the start"
        )

    # --- what derives from it says -------------------------------------------------------------------------
    @property
    @abstractmethod
    def cells(self) -> Sequence[Ints]:
        """Nodes (m, k) of the cells, type by type."""

    @property
    @abstractmethod
    def triads(self) -> Array:
        """Directors (n, r, 3) of the nodes in the reference."""

    @property
    @abstractmethod
    def cell_mass(self) -> Sequence[Array]:
        """Mass (m, k, 1 + r, k, 1 + r) of the cells between position and directors of their nodes, type by type."""

    @property
    def more(self) -> tuple[Ints, Array]:
        """Nodes (e,) that have directors (e, 3) beyond their r ones."""
        return np.zeros(0, dtype=np.int64), np.zeros((0, 3))

    def cell_vectors(self, number: int) -> Ints:
        """Vectors (m, k, 1 + r) of the cells of a type: of node i, i (1 + r) on; those of `more` follow all nodes."""
        r = self.triads.shape[1] + 1
        return np.asarray(r * self.cells[number][..., None] + np.arange(r))

    # --- its mesh and sections -----------------------------------------------------------------------------
    def built_mesh(self) -> Mesh:
        """The mesh that is given, or what its generator gives, in space."""
        try:
            grid = self.mesh.build() if isinstance(self.mesh, MeshSource) else self.mesh
        except InputError as error:
            raise InputError(f"{self.label}: {error}") from None
        return grid if grid.points.shape[1] == 3 else replace(grid, points=in_space(grid))

    def refuse_section_count(self) -> None:
        """Refuse a list of sections that has not one for each cell."""
        m = self.n_cells
        if isinstance(self.section, tuple) and len(self.section) != m:
            raise InputError(
                f"{self.label}: {len(self.section)} sections for {m} cells; give one, or one for each"
            )

    @property
    def n_cells(self) -> int:
        """Of all types."""
        return sum(map(len, self.cells))

    def by_type(self, values: NDArray[Any]) -> list[NDArray[Any]]:
        """Values (m, ...) of all cells, type by type."""
        return np.split(values, np.cumsum([len(cells) for cells in self.cells])[:-1])

    @cached_property
    def sections(self) -> tuple[Any, ...]:
        """Of every cell."""
        return self.section if isinstance(self.section, tuple) else (self.section,) * self.n_cells

    def by_cell(self, of: Any) -> Array:
        """A property of the section for every cell (m, ...)."""
        different = {id(s): s for s in self.sections}
        found = {key: np.asarray(of(s), dtype=float) for key, s in different.items()}
        return np.stack([found[id(s)] for s in self.sections])

    @cached_property
    def stiffness(self) -> Array:
        """Of the sections of all cells (m, n, n), by their n strains."""
        return self.by_cell(lambda s: s.stiffness_matrix())

    # --- masses --------------------------------------------------------------------------------------------
    def _masses_of_nodes(self) -> Array:
        nodal = np.zeros(self.grid.n_nodes)
        for cells, mass in zip(self.cells, self.cell_mass, strict=True):
            np.add.at(nodal, cells, mass[:, :, 0, :, 0].sum(axis=2))
        return nodal

    @property
    def density(self) -> float:  # type: ignore[override]
        """Mass per length or area; zero if the body has no mass."""
        return self.mass / float(sum(part.sum() for part in self.volumes))

    @cached_property
    def _first_moments(self) -> Array:
        """Weights of all vectors (n (1 + r) + e,) in mass times the centre of mass."""
        total = np.zeros(len(self.reference_vectors))
        for k, mass in enumerate(self.cell_mass):
            np.add.at(total, self.cell_vectors(k), mass[..., 0].sum(axis=3))
        return total

    @property
    def reference_vectors(self) -> Array:
        """Positions and directors of all nodes, one after the other, then those of `more`."""
        d = self.dimension
        nodes = np.concatenate([self.points[:, None, :d], self.triads], axis=1).reshape(-1, d)
        return np.concatenate([nodes, self.more[1][:, :d]])

    def mass_moment(self, x: Array) -> Array:
        vectors = x[self.vector_unknowns()[:, None] + np.arange(self.dimension)]
        return np.asarray(self._first_moments @ vectors)

    def _centre(self) -> Array:
        if not self.mass > 0:
            return super()._centre()
        centre = self._first_moments @ self.reference_vectors / self.mass
        return np.pad(centre, (0, 3 - self.dimension))

    def weigh(self, model: Model, acceleration: Array) -> None:
        heavy = np.flatnonzero(self._first_moments)
        if len(heavy):
            force = self._first_moments[heavy, None] * np.asarray(acceleration)[: self.dimension]
            model.dead_forces(self, "gravity", self.vector_unknowns()[heavy], force)

    def add_inertia(self, model: Model) -> None:
        """Add the kinetic energy of all cells."""
        unknowns = self.vector_unknowns()
        for number, mass in enumerate(self.cell_mass):
            if np.any(mass):
                m, k, r = mass.shape[:3]
                vectors = unknowns[self.cell_vectors(number)].reshape(m, k * r)
                positions = tuple(np.tile(np.arange(r) == 0, k).tolist())
                model.inertias(self, vectors, mass.reshape(m, k * r, k * r), positions, self.dimension)

    # --- its unknowns --------------------------------------------------------------------------------------
    @cached_property
    def _width(self) -> int:
        """Unknowns of a node."""
        return self.dimension * (1 + int(self.triads.shape[1]))

    def node_unknowns(self, nodes: Any) -> NDArray[np.int32]:
        return np.asarray(self.motion.start + self._width * np.asarray(nodes), dtype=np.int32)

    def director_unknowns(self, nodes: Any) -> NDArray[np.int32]:
        """First unknowns (..., r) of the directors of each node."""
        d = self.dimension
        return np.asarray(self.node_unknowns(nodes)[..., None] + np.arange(d, self._width, d), dtype=np.int32)

    def vector_unknowns(self) -> NDArray[np.int32]:
        """First unknowns of all vectors, see `cell_vectors`."""
        d = self.dimension
        nodes = self.motion.start + d * np.arange(self._width // d * self.grid.n_nodes)
        count = len(self.more[0])
        more = self._more.start + 3 * np.arange(count) if count else np.zeros(0, dtype=np.int64)
        return np.concatenate([nodes, more]).astype(np.int32)

    def directors_of(self, nodes: Ints) -> Ints:
        """First unknowns (k,) of all directors of nodes."""
        own = self.director_unknowns(nodes).ravel()
        more = self.vector_unknowns()[-len(self.more[0]) :] if len(self.more[0]) else own[:0]
        return np.concatenate([own, more[np.isin(self.more[0], nodes)]]).astype(np.int64)

    def hold_directors(self, model: Model, nodes: Ints, axis: int) -> None:
        """Hold the components along an axis of the directors of nodes."""
        own = self.director_unknowns(nodes).ravel() - self.motion.start
        model.hold(self.motion, own + axis)
        self.hold_lengths(model, nodes)
        more = np.flatnonzero(np.isin(self.more[0], nodes))
        if len(more):
            model.hold(self._more, 3 * more + axis)

    def hold_lengths(self, model: Model, nodes: Ints) -> None:
        """Hold multipliers of constraints between directors that follow from others, their held components given."""
        width, n = self._width, self.n_held
        held = self.motion.fixed.reshape(-1, width)[:, self.dimension :]
        for node in nodes.tolist():
            rows = constraint_rows(self.triads[node])[:n] * ~held[node]
            numbers = n * node + np.arange(n)
            free = numbers[~self._multipliers.fixed[numbers]]
            kept = independent(rows[free - n * node])
            model.hold(self._multipliers, np.delete(free, kept))

    def clamped(self, model: Model) -> Mask:
        """Nodes (n,) that neither move nor turn."""
        found = np.zeros(self.grid.n_nodes, dtype=bool)
        for what in model.announced(self, Clamping):
            found[what.nodes] = True
        return found

    def unheld(self, model: Model) -> Mask:
        """Nodes (n,) whose directors need no constraints: clamped ones, and those that follow others."""
        found = self.clamped(model)
        for what in model.announced(self, Guiding):
            found[what.nodes] = True
        return found

    def declare(self, model: Model) -> None:
        d = self.dimension
        q = np.concatenate([self.points[:, None, :d], self.triads], axis=1)
        turning = np.cross(self.angular_velocity, np.pad(self.triads, ((0, 0), (0, 0), (0, 3 - d))))
        v = np.concatenate([self.initial_velocities()[:, None], turning[..., :d]], axis=1)
        clamped = self.clamped(model)
        fixed, scale = np.zeros(q.shape, dtype=bool), np.ones_like(q)
        fixed[clamped], v[clamped], scale[:, 0] = True, 0.0, model.length
        whole: Any = {"node": self._width, "part": self._width}
        self.motion = model.field(self, "node", q, v, scale=scale.ravel(), fixed=fixed.ravel(), **whole)
        n = self.n_held
        self._multipliers = model.multipliers(
            self, "directors", n * len(q), stage=0, block=self.motion.block, part=n
        )
        unheld = np.flatnonzero(self.unheld(model))
        model.hold(self._multipliers, (n * unheld[:, None] + np.arange(n)).ravel())
        nodes, directors = self.more
        if len(nodes):
            held = np.repeat(clamped[nodes], 3)
            rates = np.where(clamped[nodes, None], 0.0, np.cross(self.angular_velocity, directors))
            self._more = model.field(self, "director", directors, rates, scale=1.0, fixed=held, node=3)

    def vectors(self, model: Model) -> Vectors:
        first = self.vector_unknowns().astype(np.int64)
        d = self.dimension
        r = self._width // d
        number = np.arange(len(first))
        return first, (number % r == 0) & (number < r * self.grid.n_nodes), d

    # --- what it shows -------------------------------------------------------------------------------------
    def triads_at(self, x: Array) -> Array:
        """Directors (n, r, 3) of the nodes at the unknowns `x` of the system; or rates or forces of them."""
        first = self.node_unknowns(np.arange(self.grid.n_nodes))
        own = np.arange(self.dimension, self._width)
        return np.asarray(x[first[:, None] + own]).reshape(self.triads.shape)

    def turning(self, force: Array, x: Array) -> Array:
        """Torques (n, 3) on the nodes by forces on their directors, of forces on all unknowns of the system."""
        flat = ((0, 0), (0, 0), (0, 3 - self.dimension))
        at, pull = (np.pad(self.triads_at(values), flat) for values in (x, force))
        torque = np.asarray(np.cross(at, pull).sum(axis=1))
        nodes = self.more[0]
        if len(nodes):
            more = self.vector_unknowns()[-len(nodes) :, None] + np.arange(3)
            np.add.at(torque, nodes, np.cross(x[more], force[more]))
        return torque

    def _smoothed(self, names: tuple[str, ...], x: Array) -> dict[str, Array]:
        count = sum(np.bincount(cells.ravel(), minlength=self.grid.n_nodes) for cells in self.cells)
        found = {}
        for name in names:
            total = np.zeros((self.grid.n_nodes, self.widths()[name]))
            for cells, mean in zip(self.cells, self.by_type(np.asarray(self.mean(name, x))), strict=True):
                np.add.at(total, cells, mean.reshape(len(mean), 1, -1))
            means = total / np.maximum(count, 1)[:, None]
            found[name] = means[:, 0] if means.shape[1] == 1 else means
        return found


def constraint_rows(directors: Array) -> Array:
    """Gradients (c, d r) of the constraints of r directors (r, d): of lengths, then of products by pairs."""
    r, d = directors.shape
    pairs = [(i, i) for i in range(r)] + [(i, j) for i in range(r) for j in range(i + 1, r)]
    rows = np.zeros((len(pairs), r, d))
    for k, (i, j) in enumerate(pairs):
        rows[k, i] = directors[j]
        rows[k, j] = directors[i]
    return rows.reshape(len(pairs), d * r)


def independent(rows: Array) -> list[int]:
    """Numbers of rows that are no combination of those before them."""
    basis: list[Array] = []
    kept = []
    for k, row in enumerate(rows):
        rest = row - sum((b @ row) * b for b in basis) if basis else row
        length = float(np.linalg.norm(rest))
        if length > DEPENDENT:
            basis.append(rest / length)
            kept.append(k)
    return kept


def refuse_thin(label: str, what: str, *bodies: Component | None) -> None:
    """Refuse beams and shells for what asks for the surface of a volume.

    Raises
    ------
    InputError
    """
    for body in bodies:
        if body is not None and body.is_thin:
            raise InputError(f"{label}: {body.label} has no surface about its thickness yet; {what}")
