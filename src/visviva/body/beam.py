"""Geometrically exact beams in directors (Betsch & Steinmann 2002)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.arguments import number, place
from visviva.base.errors import InputError
from visviva.body.beam_diagrams import DIAGRAMS, at_ends, rounded_off, upright
from visviva.body.beam_line import BeamLine, Place, beam_line, parted_at_kinks
from visviva.body.beam_shapes import with_shapes_of_beams
from visviva.body.beam_strains import BeamStrains
from visviva.body.director_body import DirectorBody
from visviva.body.mesh_points import Points
from visviva.body.rigid import RIGIDITY
from visviva.body.round_skin import round_skin
from visviva.body.section import CrossSection
from visviva.body.swept import Swept
from visviva.body.touching import Skin
from visviva.body.turned_cells import most_turned, turn
from visviva.component.announcements import Holding, Straining
from visviva.component.component import settings
from visviva.component.point import Frame
from visviva.component.values import Vector3, VectorOrFunction
from visviva.mesh.cells import CELLS
from visviva.mesh.faces import Faces
from visviva.mesh.generate import MeshSource
from visviva.mesh.mesh import Mesh
from visviva.mesh.quadrature import mass_rule
from visviva.mesh.quality import check_shape
from visviva.model.form import Form, Strain, Vector
from visviva.model.points import PhysicsKind, add_points
from visviva.output.surface import Surface

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Mask = NDArray[np.bool_]
MOST = float(np.sin(np.pi / 8) ** 2)
"""Change of products of interpolated directors up to which strains are believed: stretch is wrong by 8 % there.

Two-node cells turn by 45 degrees then, where they carry the largest moment; those of three nodes by 160.
"""
STEEP = float(np.sin(np.pi / 9) ** 2)
"""The same of two-node cells at 40 degrees, from which on it is told when a step fails."""
FIELDS = {"section_force": 3, "section_moment": 3, **dict.fromkeys(DIAGRAMS, 3)}
RIGID = {"shear": (0, 1), "stretch": (2,)}
"""Numbers of the strains that can be held at zero."""


@dataclass(config=settings, eq=False, kw_only=True)
class Beam(DirectorBody):
    """A beam whose cross sections stay plane and rigid: it stretches, shears, bends and twists by any amount.

    Its nodes have a position and three directors, which are interpolated alike, so that the strains do not change under
    rigid motions nor depend on the way a state was reached. Sections are described along the directors d1 and d2;
    d3 is along the line in the reference.

    Parameters
    ----------
    mesh : Mesh, or a generator or file that gives one
        Of lines in space (`LineMesh`, `ArcMesh`, `MeshFile`), all of one type of cells. Nodes inside cells of four are
        moved along their curves to where those of Gauss & Lobatto are.
    section : CrossSection, or one for each cell
    first : (3,), or a function of reference positions (n, 3) with values (n, 3), optional
        What the director d1 is near to, made normal to the line: a function twists the beam. By default it is carried
        along from the start without turning about the line, where it is the axis of space most across.
    rigid : sequence of 'shear', 'stretch'
        Strains that are held at zero by multipliers at the points of every cell, as the section's stiffness against
        them is as large as you like; their resultants are those multipliers.
    kinks : {'refused', 'rigid', 'hinged'}
        What is done where cells meet at more than 45 degrees and where lines branch: refused, as a mesh too coarse
        for a smooth line looks the same; joined rigidly; or hinged, all cells to each other, as by ball joints: there
        all cells but the first have nodes of their own, behind those of the mesh.
    velocity : (3,), or a function of reference positions (n, 3) with values (n, 3)
    angular_velocity : (3,)
        Initial rotation about the centre of mass, of the directors as well; with `velocity` alone they start at rest.

    Notes
    -----
    Strains are ``d_i . phi'``, with ``- d_3 . d_3 / 2`` beside the third, and ``(d_k . d_j' - d_j . d_k') / 2`` less
    those of the reference, integrated with one point less than an element has nodes. Between nodes the directors of a
    frame are orthonormal up to the error of the interpolation; at nodes they are exactly so.

    Examples
    --------
    >>> import visviva as vv
    >>> strip = vv.RectangleSection(width=1.0, height=0.1, young=1.2e6)
    >>> beam = vv.Beam(mesh=vv.LineMesh(points=[(0, 0, 0), (10, 0, 0)], count=10), section=strip)
    >>> vv.System([beam, vv.Clamped(solid=beam, nodes="start")]).check().degrees_of_freedom
    60
    """

    mesh: Mesh | MeshSource
    section: CrossSection | tuple[CrossSection, ...]
    first: VectorOrFunction | None = None
    rigid: tuple[Literal["shear", "stretch"], ...] = ()
    kinks: Literal["refused", "rigid", "hinged"] = "refused"
    velocity: VectorOrFunction = (0.0, 0.0, 0.0)
    angular_velocity: Vector3 = (0.0, 0.0, 0.0)

    has_directions = True
    n_held = 6
    thickness = 1.0  # of plane meshes, which this is none of

    def __post_init__(self) -> None:
        self.grid = with_shapes_of_beams(self.built_mesh())
        self._hinges = np.zeros((0, 2), dtype=np.int64)
        if self.kinks in self._parted:
            self.grid, self._hinges = parted_at_kinks(self.label, self.grid)
        turned = self.kinks == "rigid" and not len(self._hinges)
        self.line: BeamLine = beam_line(self.label, self.grid, self._across, kinks=turned)
        try:
            check_shape(self.grid)
        except InputError as error:
            raise InputError(f"{self.label}: {error}") from None
        self.refuse_section_count()
        self._strains = BeamStrains(self.line)
        self._held_strains = sorted({k for name in self.rigid for k in RIGID[name]})

    @property
    def volumes(self) -> list[Array]:
        """Lengths (m, q) of the line."""
        return [self._strains.length]

    _parted: ClassVar[tuple[str, ...]] = ("hinged",)
    """Kinks at which cells have nodes of their own."""

    @property
    def _across(self) -> Any:
        """The direction that the director d1 is chosen closest to."""
        return self.first

    @property
    def cells(self) -> tuple[Ints, ...]:
        return (self.line.cells,)

    @property
    def triads(self) -> Array:
        return self.line.triads

    def cell_points(self) -> Iterator[Points]:
        xi, w = mass_rule(self.line.kind)
        N, _, speed = self.line.slopes(xi)
        X = np.einsum("qk,mkc->mqc", N, self.line.points[self.line.cells])
        yield Points(nodes=self.line.cells, N=N, X=X, size=w * speed)

    # --- sections ------------------------------------------------------------------------------------------
    @cached_property
    def _moments(self) -> Array:
        """Mass per length between position, d1 and d2 (m, 3, 3)."""

        def of(section: CrossSection) -> Array:
            mass, centre, moments = section.inertia()
            M = np.empty((3, 3))
            M[0, 0], M[0, 1:], M[1:, 0], M[1:, 1:] = mass, mass * centre, mass * centre, moments
            return M

        return self.by_cell(of)

    @property
    def modulus(self) -> float:
        """Of an equivalent square section, or over the circle of a round one: what contact is scaled by."""
        C = self.stiffness
        radii = [section.round for section in self.sections]
        if None not in radii:
            return float((C[:, 2, 2] / (np.pi * np.array(radii, dtype=float) ** 2)).max())
        return float((C[:, 2, 2] ** 2 / (12 * np.maximum(C[:, 3, 3], C[:, 4, 4]))).max())

    # --- integration ---------------------------------------------------------------------------------------
    @cached_property
    def cell_mass(self) -> tuple[Array, ...]:
        xi, w = np.polynomial.legendre.leggauss(self.line.cells.shape[1])
        N, _, speed = self.line.slopes(xi[:, None])
        mass = np.einsum("mq,qa,qb,mvw->mabvw", w * speed, N, N, self._moments)
        to_nodes = np.zeros(
            (*self.line.cells.shape, 3, 4)
        )  # position, d1, d2 of the cell from those of a node
        to_nodes[:, :, 0, 0] = 1.0
        to_nodes[:, :, 1:, 1:] = self.line.turns[:, :, :2]
        return (np.einsum("mabvw,mavr,mbws->marbs", mass, to_nodes, to_nodes),)

    # --- what it contributes -------------------------------------------------------------------------------
    def contribute(self, model: Model) -> None:
        clamped = self.clamped(model)
        held = clamped.copy()
        for what in model.announced(self, Holding):
            held[what.nodes] = True
        for k in np.flatnonzero(~clamped).tolist():
            model.constrain(self, self._multipliers, RIGIDITY, first=6 * k, shift=self.motion.start + 12 * k)
            if not held[k]:
                u, m = self.motion.start + 12 * k, self._multipliers.start + 6 * k
                model.reductions.rigid.append([*range(u, u + 12), *range(m, m + 6)])
        self._heated = model.announced(self, Straining)
        smooth = np.all(self.line.turns == np.eye(3), axis=(1, 2, 3))
        for cells in parted(np.stack([smooth, self._law]).T):
            self._add_strained(model, cells)
        if self._held_strains:
            self._hold_strains(model)
        if len(self._hinges):
            self._hinge(model)
        self.add_inertia(model)

    @cached_property
    def _damping(self) -> Array:
        """Of the sections of all cells (m, 6, 6)."""
        return self.by_cell(lambda s: s.damping_matrix())

    @cached_property
    def _law(self) -> Ints:
        """Cells (m,) of equal numbers have the same kind of law, and the same function if it is one of the user."""
        numbers = {id(s): k + 1 for k, s in enumerate(self.sections) if s.energy_function() is not None}
        damped = np.any(self._damping != 0, axis=(1, 2))
        return np.asarray([2 * numbers.get(id(s), 0) for s in self.sections] + damped)

    def _add_strained(self, model: Model, cells: Ints) -> None:
        """Elements of some cells of one law."""
        nodes = self.line.cells[cells]
        groups = self._strains.groups(cells, self.node_unknowns(nodes), self.director_unknowns(nodes))
        a, b = np.triu_indices(6)
        parameters, kind = self.stiffness[cells][:, a, b], PhysicsKind.BEAM
        if self._law[cells[0]] % 2:
            parameters, kind = np.hstack([parameters, self._damping[cells][:, a, b]]), PhysicsKind.DAMPED_BEAM
        length, reference = self._strains.length[cells], self._strains.reference[cells]
        at_points = np.repeat(parameters[:, None], length.shape[1], axis=1)
        energy = self.sections[cells[0]].energy_function()
        add_points(model, self, kind, groups, length, at_points, reference, energy)

    def _hold_strains(self, model: Model) -> None:
        """A multiplier for each rigid strain at each point."""
        (m, q), chosen = self._strains.length.shape, self._held_strains
        n = q * len(chosen)
        self._forces = model.multipliers(self, "section forces", m * n, part=n)
        for c in range(m):
            found = [self.strain_forms(c, k) for k in range(q)]
            model.constrain(self, self._forces, [at[i] for at in found for i in chosen], first=n * c)

    def _hinge(self, model: Model) -> None:
        """Nodes that are one place stay so."""
        multipliers = model.multipliers(self, "hinges", 3 * len(self._hinges), part=3)
        for k, (a, b) in enumerate(self.node_unknowns(self._hinges).tolist()):
            apart = Vector.of(b) - Vector.of(a)
            model.constrain(self, multipliers, list(apart), first=3 * k)

    # --- strains -------------------------------------------------------------------------------------------
    def strains(self, x: Array) -> Array:
        """Strains (m, q, 6) at the points of the cells: shear along d1 and d2, extension, curvatures, twist."""
        return self._strains.of(self.positions(x), self.directors(x)) - self._strains.reference

    def strain_forms(self, cell: int, point: int) -> list[Strain]:
        """The six strains at a point of a cell, of the unknowns of the system."""
        nodes = self.line.cells[cell]
        return self._strains.forms(
            cell, point, self.node_unknowns(nodes), self.director_unknowns(nodes), range(6)
        )

    def resultants(self, x: Array) -> Array:
        """Elastic forces and moments (m, q, 6) in the sections, along their directors, in the order of the strains."""
        e = self.strains(x)
        found = np.einsum("mij,mqj->mqi", self.stiffness, e - sum(h.strain(x) for h in self._heated))
        for k in np.unique(self._law[self._law > 1]):
            cells = np.flatnonzero(self._law == k)
            flat = e[cells].reshape(-1, 6).T
            energy = self.sections[cells[0]].energy_function()
            found[cells] = energy.gradient(flat)[0].T.reshape(len(cells), -1, 6)
        if self._held_strains:
            force = x[self._forces.start : self._forces.start + self._forces.size].reshape(*e.shape[:2], -1)
            found[..., self._held_strains] = force / self._strains.length[..., None]
        return np.asarray(found)

    def directors(self, x: Array) -> Array:
        """Directors (n, 3, 3) of the nodes by rows."""
        return self.triads_at(x)

    def nodal_forces(self, x: Array, cells: Mask | None = None) -> Array:
        """Forces (n, 3) of the strained elements on the nodes, of the chosen cells (n_cells,) or all."""
        nodes, slope, length = self.line.cells, self._strains.slope, self._strains.length
        own = np.einsum("mkij,mkjc->mkic", self.line.turns, self.directors(x)[nodes])
        n = np.einsum("mqi,qk,mkic->mqc", self.resultants(x)[..., :3], self._strains.N, own)
        if cells is not None:
            n[~cells] = 0.0
        total = np.zeros((self.grid.n_nodes, 3))
        np.add.at(total, nodes, np.einsum("mq,mqk,mqc->mkc", length, slope, n))
        return total

    def skin(self, chosen: str | Faces, fine: bool = False) -> Skin:
        """Points along the middle of a round bar: its nodes, and between them by a radius where it shall be `fine`.

        Raises
        ------
        InputError
            If its sections are not round, of unlike radii, or only a part of it is chosen.
        """
        if chosen != "all":
            raise InputError(
                f"{self.label} is a line and has no faces; it is touched all along: leave out faces"
            )
        radii = {section.round for section in self.sections}
        (radius,) = radii if len(radii) == 1 else (None,)
        if radius is None:
            raise InputError(
                f"{self.label}: only round bars of one radius touch others; give a vv.TubeSection, or a "
                "vv.GivenSection with its outside, and beams of other sections as solids or shells"
            )
        found = round_skin(self.line, radius, fine, self._vectors)
        return replace(found, drawn=self._swept.nodes, mass=self.density / (2 * radius))

    def _vectors(self) -> NDArray[np.int32]:
        """First unknowns (4 n,) of positions, and of the first, second and third directors."""
        first = self.node_unknowns(np.arange(self.grid.n_nodes))
        return np.concatenate([first + 3 * k for k in range(4)])

    def faces(self, chosen: str | Faces) -> Faces:
        """There are none.

        Raises
        ------
        InputError
        """
        raise InputError(
            f"{self.label} is a line and has no faces; attach to it by beam.frame(s) and load it by vv.LineLoad"
        )

    def invalid(self, x: Array) -> str:
        """Cells that turn so far that they stretch without force."""
        return self._turned(x, MOST) or super().invalid(x)

    def trouble(self, x: Array) -> str:
        """The same; two-node cells carry moments up to angles of 45 degrees between their nodes."""
        found = self._turned(x, STEEP if self.line.cells.shape[1] == 2 else MOST)
        return found or super().trouble(x)

    def _turned(self, x: Array, most: float) -> str:
        """Sentence on the cell that turns most, if interpolation changes products of directors by more than `most`."""
        nodes, turns = self.line.cells, self.line.turns
        own = turns @ self.directors(x)[nodes]
        k, change = most_turned(self._strains.N, own, self.line.own)
        if not change > most:
            return ""
        return (
            f"cell {k} of {self.label} turns by {turn(own[k]):.0f} degrees from node to node, so that products of its "
            f"interpolated directors are wrong by {change:.0%} and it stretches without force; take more cells, or "
            "such of more nodes: those of two turn evenly by 45 degrees at most, of three by 160"
        )

    # --- attachment ----------------------------------------------------------------------------------------
    def at(self, s: float) -> Array:
        """The reference position (3,) at an arc length from the start of its line."""
        return self.line.at_length(number(self.label, "arc length", s), self.label)

    def frame(self, X: Any = 0.0, axes: Any = None) -> Frame:
        """A frame at the reference position or arc length `X`, by default along the directors there.

        `axes` are three orthonormal rows in the reference.
        """
        X = self.at(X) if np.ndim(X) == 0 else place(self.label, "X", X)
        if axes is None:
            found = self.line.place(X, self.label)
            u, _, v = np.linalg.svd(self._reference_directors(found))
            axes = u @ v
        return Frame(self, X, place(self.label, "axes", axes, (3, 3)))

    def frame_of_node(self, node: int) -> Frame:
        """The frame of a node's own directors."""
        return Frame(self, self.line.points[node], self.line.triads[node])

    def _reference_directors(self, found: Place) -> Array:
        return np.asarray(np.einsum("k,kij->ij", found.N, self._own_at(found)))

    def _own_at(self, found: Place) -> Array:
        """Directors (k, 3, 3) of the cell of a place at its nodes."""
        cell = int(np.flatnonzero(np.all(self.line.cells == found.nodes, axis=1))[0])
        return np.asarray(self.line.own[cell])

    def place(self, X: Array) -> Vector:
        found = self.line.place(np.asarray(X, dtype=float), self.label)
        arm = found.offset @ self._reference_directors(found)
        return self.combination(found.nodes, found.N) + self._direction(found, arm)

    def turn(self, direction: Array, X: Array) -> Vector:
        return self._direction(self.line.place(np.asarray(X, dtype=float), self.label), direction)

    def _direction(self, found: Place, direction: Array) -> Vector:
        """A vector of the reference (3,) that goes along with the directors at a place."""
        parts = np.linalg.solve(self._reference_directors(found).T, direction)
        cell = int(np.flatnonzero(np.all(self.line.cells == found.nodes, axis=1))[0])
        weights = found.N[:, None] * np.einsum("i,kij->kj", parts, self.line.turns[cell])
        entries = [
            (int(u), float(w))
            for k in range(3)
            for u, w in zip(self.director_unknowns(found.nodes)[:, k], weights[:, k], strict=True)
            if abs(w) > 1e-15
        ]
        x, y, z = (Form(tuple((u + c, w) for u, w in entries)) for c in range(3))
        return Vector((x, y, z))

    # --- what it shows -------------------------------------------------------------------------------------
    def volume(self, x: Array) -> float:
        """Length at the unknowns `x`."""
        tangent = np.einsum("mqk,mkc->mqc", self._strains.slope, self.positions(x)[self.line.cells])
        return float((self._strains.length * np.linalg.norm(tangent, axis=2)).sum())

    @cached_property
    def _swept(self) -> Swept:
        contours = [section.contour() for section in self.sections]
        most = max(map(len, contours))
        return Swept(self.line, np.stack([padded(contour, most) for contour in contours]))

    def drawn(self) -> Surface:
        points = self._swept.points(self.line.points, self.line.triads)
        return Surface(str(self.name), points, self._swept.cells)

    def drawn_positions(self, x: Array) -> Array:
        return self._swept.points(self.positions(x), self.directors(x))

    def drawn_velocities(self, x: Array, v: Array) -> Array:
        return self._swept.points(self.positions(v), self.directors(v))

    def drawn_fields(self, names: Sequence[str], x: Array) -> dict[str, Array]:
        plain = self.smoothed([name for name in names if name not in DIAGRAMS], x)
        found = {name: values[self._swept.nodes] for name, values in plain.items()}
        (m, k), nodes = self.line.cells.shape, CELLS[self.line.kind].nodes[:, 0]
        for name in DIAGRAMS.keys() & set(names):  # they jump between cells, where smoothing would hide it
            ends = at_ends(self.at_points(name, x).reshape(m, -1, 3), nodes)
            found[name] = np.repeat(ends.reshape(m * k, 3), self._swept.contours.shape[1], axis=0)
        return found

    def _widths_at_points(self) -> Mapping[str, int]:
        return FIELDS

    def at_points(self, name: str, x: Array) -> Array:
        if name in DIAGRAMS:
            own = np.einsum("mkij,mkjc->mkic", self.line.turns, self.directors(x)[self.line.cells])
            directors = np.einsum("qk,mkic->mqic", self._strains.N, own)
            scale = np.einsum("mii->mi", self.stiffness).copy()
            scale[:, self._held_strains] = 0.0
            told = rounded_off(self.resultants(x), scale, self.line.lengths)
            return upright(name, told, directors).reshape(-1, 3)
        part = slice(0, 3) if name == "section_force" else slice(3, 6)
        return self.resultants(x)[..., part].reshape(-1, 3)


def padded(contour: Array, n: int) -> Array:
    """A polygon of n points: the last one is repeated."""
    return np.concatenate([contour, np.repeat(contour[-1:], n - len(contour), axis=0)])


def parted(rows: Any) -> list[Ints]:
    """Numbers of the rows (m, k) that are equal."""
    _, group = np.unique(rows, axis=0, return_inverse=True)
    return [np.flatnonzero(group.ravel() == g) for g in range(int(group.max()) + 1)]
