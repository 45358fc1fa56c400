"""Geometrically exact shells with directors of unit length (Betsch & Saenger 2009)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.body.director_body import DirectorBody
from visviva.body.mesh_points import FacePoints, in_space
from visviva.body.shell_checks import refuse_slits, refuse_thick
from visviva.body.shell_membrane import enhanced_strains
from visviva.body.shell_section import ShellSection
from visviva.body.shell_skin import shell_skin
from visviva.body.shell_surface import ShellSurface, place, shell_surfaces, unit
from visviva.body.touching import Skin, looks_up
from visviva.body.turned_cells import most_turned, turn
from visviva.component.component import settings
from visviva.component.values import Vector3, VectorOrFunction
from visviva.mesh.cells import CELLS
from visviva.mesh.faces import Faces
from visviva.mesh.generate import MeshSource
from visviva.mesh.mesh import Mesh
from visviva.mesh.quadrature import mass_rule
from visviva.model.assumed import add_assumed
from visviva.model.form import Form, Strain, Vector, dot

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Mask = NDArray[np.bool_]
MOST = 0.5
"""Change of the square of an interpolated director up to which strains are believed: four-node cells turn by 90 degrees
then, and bending is wrong by a tenth."""
SIDES = ("lower", "upper")
FIELDS = {"membrane_force": 3, "bending_moment": 3, "shear_force": 2}
FACES = {"lower_stress": (0, 0), "upper_stress": (-1, 1)}
"""Layer, and which of its faces."""
PARTS = {"membrane_force": slice(0, 3), "bending_moment": slice(3, 6), "shear_force": slice(6, 8)}


@dataclass(config=settings, eq=False, kw_only=True)
class Shell(DirectorBody):
    """A surface with a director of constant length at each node, that stretches, bends and shears by any amount.

    Parameters
    ----------
    mesh : Mesh, or a generator or file that gives one
        Of quadrilaterals with four or nine nodes and triangles with three or six, mixed at will, in space; a plane mesh
        lies at z = 0. Their nodes run anticlockwise seen from above.
    section : ShellSection, or one for each cell
        `HomogeneousSection` or `Laminate`; cells are counted type by type, in the order of the mesh.
    first : (3,), or a function of positions (n, 3) with values (n, 3), optional
        What direction 1 of the section is near to; by default that from a cell's first to its second node.
    kinks : {'refused', 'rigid', 'hinged'}
        What is done where cells meet at more than 45 degrees, in sharper folds than about them and in branches: refused
        (folds under 45 degrees are said), or each smooth part has a director of its own there, which keeps its angles
        to the others, or none: a hinge.
    slits : {'refused', 'open'}
        Whether edges may lie on each other without common nodes, as they do where meshes were not merged: open ones
        move apart, unless a `Tie` or a `Contact` minds them.
    membrane : {'compatible', 'enhanced'}
        Of four-node cells: with enhanced strains (Simo & Rifai 1990) they bend in their own plane as they should, where
        compatible ones are too stiff by far. Others do so anyway.
    velocity : (3,), or a function of reference positions (n, 3) with values (n, 3)
    angular_velocity : (3,)
        Initial rotation about the centre of mass, of the directors as well; with `velocity` alone they start at rest.

    Notes
    -----
    Strains are ``(phi,a . phi,b) / 2``, ``(phi,a . d,b + phi,b . d,a) / 2`` and ``phi,a . d`` less those of the
    reference, sampled and interpolated as `visviva.body.natural_strains` says (MITC3, MITC4, MITC9, Regge): thin
    shells do not lock in shear, those of nine nodes nor in the membrane.
    The stress across the thickness vanishes. A rotation about the director has no stiffness.

    Examples
    --------
    >>> import visviva as vv
    >>> strip = vv.RectangleMesh(size=(10, 1), counts=(16, 1))
    >>> shell = vv.Shell(mesh=strip, section=vv.HomogeneousSection(thickness=0.1, young=1.2e6))
    >>> vv.System([shell, vv.Clamped(solid=shell, nodes="x0")]).check().degrees_of_freedom
    160
    """

    mesh: Mesh | MeshSource
    section: ShellSection | tuple[ShellSection, ...]
    first: VectorOrFunction | None = None
    kinks: Literal["refused", "rigid", "hinged"] = "refused"
    slits: Literal["refused", "open"] = "refused"
    membrane: Literal["compatible", "enhanced"] = "compatible"
    velocity: VectorOrFunction = (0.0, 0.0, 0.0)
    angular_velocity: Vector3 = (0.0, 0.0, 0.0)

    n_held = 1
    thickness = 1.0  # of plane meshes, which this is none of

    def __post_init__(self) -> None:
        self.grid = with_space(self.built_mesh())
        found = shell_surfaces(self.label, self.grid, self.first, self.kinks != "refused")
        self.parts: tuple[ShellSurface, ...] = found[0]
        self._kinked = found[1]
        self.refuse_section_count()
        refuse_thick(self.parts, self.by_type(self.by_cell(lambda s: s.heights)))
        if self.slits == "refused":
            refuse_slits(self.label, self.grid.points, {part.kind: part.cells for part in self.parts})

    @property
    def volumes(self) -> list[Array]:
        """Areas (m, q) of the middle surface."""
        return [part.areas for part in self.parts]

    # --- sections ------------------------------------------------------------------------------------------
    @cached_property
    def _moments(self) -> Array:
        """Mass per area, its first and second moment (m, 3)."""
        return self.by_cell(lambda s: s.inertia())

    @cached_property
    def _stiffness_of_parts(self) -> list[Array]:
        """Of the sections (m, 8, 8), type by type."""
        sizes = self.by_type(np.diff(self.by_cell(lambda s: s.heights), axis=1)[:, 0])
        every = zip(self.parts, self.by_type(self.stiffness), sizes, strict=True)
        return [part.relieved(C, size) for part, C, size in every]

    @cached_property
    def _strains_of_samples(self) -> list[Array]:
        """Matrices to strains of the sections (m, q, 8, n) from those sampled, type by type."""
        every = zip(self.parts, self._stiffness_of_parts, strict=True)
        return [
            enhanced_strains(part, C)
            if part.kind == "quad4" and self.membrane == "enhanced"
            else part.section_strains
            for part, C in every
        ]

    @property
    def modulus(self) -> float:
        """Largest membrane stiffness by thickness."""
        heights = self.by_cell(lambda s: s.heights)
        return float((self.stiffness[:, 0, 0] / (heights[:, 1] - heights[:, 0])).max())

    # --- what it contributes -------------------------------------------------------------------------------
    @property
    def cells(self) -> tuple[Ints, ...]:
        return tuple(part.cells for part in self.parts)

    @property
    def triads(self) -> Array:
        return self.parts[0].directors[: self.grid.n_nodes, None]

    @property
    def more(self) -> tuple[Ints, Array]:
        return self._kinked, self.parts[0].directors[self.grid.n_nodes :]

    def cell_vectors(self, number: int) -> Ints:
        part = self.parts[number]
        return np.stack([2 * part.cells, self._vectors_of_turns(part.turns)], axis=2)

    def _vectors_of_turns(self, turns: Ints) -> Ints:
        """Of directors, those of the nodes first, then those of `more`: their numbers among all vectors."""
        n = self.grid.n_nodes
        return np.where(turns < n, 2 * turns + 1, turns + n)

    def turn_unknowns(self, turns: Ints) -> NDArray[np.int32]:
        """First unknowns of directors, numbered as in `turns_of_edges`."""
        return np.asarray(self.vector_unknowns()[self._vectors_of_turns(turns)])

    @cached_property
    def cell_mass(self) -> tuple[Array, ...]:
        found = []
        for part, moments in zip(self.parts, self.by_type(self._moments), strict=True):
            N = part.N
            m0, m1, m2 = moments.T
            M = np.stack([np.stack([m0, m1], axis=1), np.stack([m1, m2], axis=1)], axis=1)
            found.append(np.einsum("mq,qa,qb,mvw->mavbw", part.areas, N, N, M, optimize=True))
        return tuple(found)

    def contribute(self, model: Model) -> None:
        clamped = self.clamped(model)
        for k in np.flatnonzero(~self.unheld(model)).tolist():
            d = Vector.of(self.motion.start + 6 * k + 3)
            model.constrain(self, self._multipliers, [0.5 * dot(d, d) - 0.5], first=k)
            model.reductions.eliminate_director(self.motion.start + 6 * k + 3, self._multipliers.start + k)
        self._join(model, clamped)
        unknowns = self.vector_unknowns()
        every = zip(self.parts, self._stiffness_of_parts, self._strains_of_samples, strict=True)
        for number, (part, C, A) in enumerate(every):
            slots = unknowns[self.cell_vectors(number)].transpose(0, 2, 1).reshape(len(part.cells), -1)
            add_assumed(model, self, part.assumed, slots, part.stiffness(C, A), part.reference)
        self.add_inertia(model)

    def _join(self, model: Model, clamped: Mask) -> None:
        """Directors beyond one for each node: of unit length, and at their angles to the others unless hinged."""
        unknowns, reference = self.vector_unknowns(), self.reference_vectors
        nodes = self._kinked
        strains: list[Strain | Form] = []
        for node in np.unique(nodes[~clamped[nodes]]).tolist():
            numbers = [2 * node + 1, *(len(reference) - len(nodes) + np.flatnonzero(nodes == node))]
            d = [Vector.of(int(unknowns[k])) for k in numbers]
            strains += self.joined(d, reference[numbers])
        if strains:
            multipliers = model.multipliers(self, "kinks", len(strains))
            for k, strain in enumerate(strains):
                model.constrain(self, multipliers, [strain], first=k)

    def joined(self, d: list[Vector], reference: Array) -> list[Strain | Form]:
        """Constraints that hold the directors of a node beyond the first, by their values (k, 3) in the reference."""
        if self.kinks == "rigid":
            return at_their_angles(d, reference)
        return [0.5 * dot(other, other) - 0.5 for other in d[1:]]

    # --- strains -------------------------------------------------------------------------------------------
    def strains_of_parts(self, x: Array) -> list[Array]:
        """Strains (m, q, 8) along the directions of the section of the cells of each type."""
        phi, directors = self._positions_directors(x)
        changes = [part.change(phi, directors) for part in self.parts]
        return [
            (A @ e[:, None, :, None])[..., 0] for A, e in zip(self._strains_of_samples, changes, strict=True)
        ]

    def _positions_directors(self, x: Array) -> tuple[Array, Array]:
        """Positions (n, 3), and directors numbered as in `turns_of_edges`."""
        vectors, n = x[self.vector_unknowns()[:, None] + np.arange(3)], 2 * self.grid.n_nodes
        return vectors[:n:2], np.concatenate([vectors[1:n:2], vectors[n:]])

    def invalid(self, x: Array) -> str:
        """Cells that turn so far that they bend and shear with little force."""
        directors, first = self._positions_directors(x)[1], 0
        for part in self.parts:
            own, reference = (d[part.turns][:, :, None] for d in (directors, part.directors))
            k, change = most_turned(part.N, own, reference)
            if change > MOST:
                return (
                    f"cell {first + k} of {self.label} turns by {turn(own[k]):.0f} degrees from node to node, so that "
                    f"squares of its interpolated directors are wrong by {change:.0%} and it bends without force; mesh "
                    "it finer: cells of four nodes turn by 90 degrees at most"
                )
            first += len(part.cells)
        return ""

    def resultants_of_parts(self, x: Array) -> list[Array]:
        """Membrane forces, moments and shear forces (m, q, 8) per length, of the cells of each type."""
        parts = zip(self._stiffness_of_parts, self.strains_of_parts(x), strict=True)
        return [np.einsum("mij,mqj->mqi", C, e) for C, e in parts]

    def strains(self, x: Array) -> Array:
        """Strains (m, q, 8) along the directions of the section: membrane, curvature, shear; of one type of cells."""
        return self._alone(self.strains_of_parts(x))

    def resultants(self, x: Array) -> Array:
        """Membrane forces, moments and shear forces (m, q, 8) per length, in the order of the strains."""
        return self._alone(self.resultants_of_parts(x))

    def layer_stresses(self, x: Array, layer: int) -> list[Array]:
        """Stresses 11, 22, 12 (m, q, 2, 3) at the lower and upper face of a layer, of the cells of each type.

        Along the directions of the section; layers are counted from the lower face, or with -1 from the upper one.

        Raises
        ------
        InputError
            If a section has no such layer.
        """
        counts = [len(section.sheets()) for section in self.sections]
        if not all(-n <= layer < n for n in counts):
            raise InputError(f"{self.label}: layer {layer} is not one of the {min(counts)} of its sections")
        moduli = self.by_type(self.by_cell(lambda s: s.sheets()[layer].moduli))
        heights = self.by_type(self.by_cell(lambda s: s.sheets()[layer][:2]))
        found = []
        for Q, z, e in zip(moduli, heights, self.strains_of_parts(x), strict=True):
            at_faces = e[:, :, None, :3] + z[:, None, :, None] * e[:, :, None, 3:6]
            found.append(np.einsum("mij,mqfj->mqfi", Q, at_faces))
        return found

    def _alone(self, parts: list[Array]) -> Array:
        if len(parts) > 1:
            raise InputError(
                f"{self.label}: its cells are of {len(parts)} types; strains_of_parts and resultants_of_parts give "
                "those of each"
            )
        return parts[0]

    def directors(self, x: Array) -> Array:
        """Directors (n, 3) of the nodes; at kinks those of one part."""
        return self.triads_at(x)[:, 0]

    # --- attachment ----------------------------------------------------------------------------------------
    def place(self, X: Array) -> Vector:
        nodes, turns, N, height = place(self.parts, np.asarray(X, dtype=float))
        point = self.combination(nodes, N)
        if abs(height) <= 1e-12 * self.extent:
            return point
        first = self.turn_unknowns(turns).tolist()
        parts = [
            Form(tuple((u + c, height * float(w)) for u, w in zip(first, N, strict=True))) for c in range(3)
        ]
        x, y, z = parts
        return point + Vector((x, y, z))

    def turn(self, direction: Array, X: Array) -> Vector:
        raise InputError(
            f"{self.label} has no frames: nothing resists rotations about its directors; attach points to it, or "
            "spread moments over a patch by vv.DistributedCoupling and along edges by vv.EdgeMoment"
        )

    # --- faces ---------------------------------------------------------------------------------------------
    def faces(self, chosen: str | Faces) -> Faces:
        """Its sides 'upper' and 'lower', or edges by the name of their set, 'all' for the whole border, or as given.

        Raises
        ------
        InputError
            If there is no such set, or none in it.
        """
        if isinstance(chosen, str) and chosen in SIDES and chosen not in self.grid.face_sets:
            cells = {part.kind: part.cells for part in self.parts}
            if chosen == "lower":
                cells = {kind: nodes[:, reversed_nodes(kind)] for kind, nodes in cells.items()}
            return Faces(cells, dict(zip(cells, self.by_type(np.arange(self.n_cells)), strict=True)))
        return super().faces(chosen)

    @cached_property
    def heights(self) -> Array:
        """Of the lower and the upper side (n, 2) along the directors: means of the cells around nodes."""
        total, count = np.zeros((self.grid.n_nodes, 2)), np.zeros(self.grid.n_nodes)
        for part, heights in zip(self.parts, self.by_type(self.by_cell(lambda s: s.heights)), strict=True):
            np.add.at(total, part.cells, heights[:, None])
            np.add.at(count, part.cells, 1)
        return total / np.maximum(count, 1)[:, None]

    def skin(self, chosen: str | Faces, fine: bool = False) -> Skin:
        """Both sides with the rim for 'all', 'upper', 'lower', or what is chosen of them; of edges their rim."""
        return shell_skin(self, chosen)

    def face_points(self, faces: Faces, *, on_sides: bool = False) -> Iterator[FacePoints]:
        """Points of sides, on the middle of the shell or `on_sides`, and of edges, whose normals are in it."""
        sides = {kind: nodes for kind, nodes in faces.cells.items() if CELLS[kind].dimension == 2}
        edges = {kind: nodes for kind, nodes in faces.cells.items() if CELLS[kind].dimension == 1}
        for kind, nodes in sides.items():
            for p in super().face_points(Faces({kind: nodes}, {kind: faces.owners[kind]})):
                yield self._on_side(p, kind, faces.owners[kind]) if on_sides else p
        for kind, nodes in edges.items():
            turns = self.turns_of_edges(nodes, faces.owners[kind])
            yield edge_points(kind, nodes, self.points, self.every_director[turns])

    def _on_side(self, p: FacePoints, kind: str, owners: Ints) -> FacePoints:
        """Points of sides half a thickness above or below the middle."""
        up = looks_up(p.nodes, self.cells_of(kind, owners))
        heights = np.where(up[:, None], self.heights[p.nodes, 1], self.heights[p.nodes, 0])
        turns = self.turns_of_edges(p.nodes, owners)
        found = raised(p, self.points[p.nodes], self.every_director[turns], heights)
        return replace(found, directors=lambda: self.turn_unknowns(turns))

    def cells_of(self, kind: str, owners: Ints) -> Ints:
        """Nodes (m, k) of cells of a type by their numbers among all."""
        begins = np.cumsum([0, *(len(part.cells) for part in self.parts)])
        (number,) = [k for k, part in enumerate(self.parts) if part.kind == kind]
        return np.asarray(self.parts[number].cells[owners - begins[number]])

    @property
    def every_director(self) -> Array:
        """Of the reference: one of each node, then those beyond (n + e, 3)."""
        return self.parts[0].directors

    def node_of_turn(self, turn: int) -> int:
        """Node whose director it is, of `every_director`."""
        n = self.grid.n_nodes
        return turn if turn < n else int(self._kinked[turn - n])

    def turns_of_edges(self, nodes: Ints, owners: Ints) -> Ints:
        """Indices into `every_director` of the cells that own edges, at the edges' nodes (m, k); -1 if not theirs."""
        found, first = np.full(nodes.shape, -1), 0
        for part in self.parts:
            mine = (owners >= first) & (owners < first + len(part.cells))
            own = owners[mine] - first
            same = part.cells[own][:, None] == nodes[mine][..., None]
            turns = np.take_along_axis(part.turns[own], np.argmax(same, axis=2), axis=1)
            found[mine] = np.where(same.any(axis=2), turns, -1)
            first += len(part.cells)
        return found

    # --- what it shows -------------------------------------------------------------------------------------
    def volume(self, x: Array) -> float:
        """Area at the unknowns `x`."""
        total = 0.0
        for part in self.parts:
            J = part.tangents_at(self.positions(x))
            size = np.linalg.norm(np.cross(J[..., 0], J[..., 1]), axis=2)
            total += float((part.rule.weights * size).sum())
        return total

    def _widths_at_points(self) -> Mapping[str, int]:
        return FIELDS | dict.fromkeys(FACES, 3)

    def at_points(self, name: str, x: Array) -> Array:
        if name in FACES:
            layer, face = FACES[name]
            return np.concatenate([S[:, :, face].reshape(-1, 3) for S in self.layer_stresses(x, layer)])
        values = [r[..., PARTS[name]].reshape(-1, FIELDS[name]) for r in self.resultants_of_parts(x)]
        return np.concatenate(values)


def edge_points(kind: str, nodes: Ints, points: Array, directors: Array) -> FacePoints:
    """Quadrature points of edges, whose nodes run as those of their cells do; directors (m, k, 3)."""
    xi, w = mass_rule(kind)
    N, dN = CELLS[kind].N_dN(xi)
    tangent = np.einsum("mkc,qk->mqc", points[nodes], dN[:, :, 0])
    outward = np.cross(tangent, np.einsum("mkc,qk->mqc", directors, N))
    size = w * np.linalg.norm(tangent, axis=2)
    X = np.einsum("mkc,qk->mqc", points[nodes], N)
    return FacePoints(nodes=nodes, N=N, X=X, size=size, dN=dN, weights=w, normal=unit(outward))


def raised(p: FacePoints, points: Array, directors: Array, heights: Array) -> FacePoints:
    """Face points at heights (m, k) along the directors (m, k, 3) of the nodes at these points (m, k, 3)."""
    places = points + heights[..., None] * directors
    tangents = np.einsum("mkc,qkt->mqtc", places, p.dN)
    outward = np.cross(tangents[:, :, 0], tangents[:, :, 1])
    size = np.linalg.norm(outward, axis=2)
    X = np.einsum("mkc,qk->mqc", places, p.N)
    found: Any = {"X": X, "size": p.weights * size, "normal": outward / size[..., None]}
    return replace(p, **found, heights=heights)


def reversed_nodes(kind: str) -> Ints:
    """The nodes of a cell seen from below."""
    nodes = CELLS[kind].nodes
    away = np.linalg.norm(nodes[None] - nodes[:, None, ::-1], axis=2)
    return np.asarray(np.argmin(away, axis=1))


def at_their_angles(d: list[Vector], reference: Array, *, stretch: bool = False) -> list[Strain | Form]:
    """Constraints by which directors keep the angles of their values (k, 3) in the reference, and lengths of one.

    If they stretch, they do so alike: all are as long as the first one, whose length is free.
    """
    length = dot(d[0], d[0])
    strains: list[Strain | Form] = []
    for k in range(1, len(d)):
        across = np.cross(reference[0], reference[1])
        if k > 1 and abs(across @ reference[k]) < 0.05 * np.linalg.norm(across):  # in their plane
            a, b = np.linalg.lstsq(reference[:2].T, reference[k], rcond=None)[0].tolist()
            strains += [
                z - a * x - b * y for x, y, z in zip(*(v.components for v in (d[0], d[1], d[k])), strict=True)
            ]
            continue
        for other, share in [(k, 1.0), *((j, float(reference[k] @ reference[j])) for j in range(min(k, 2)))]:
            factor = 0.5 if other == k else 1.0
            strains.append(factor * dot(d[k], d[other]) - factor * share * (length if stretch else 1.0))
    return strains


def with_space(grid: Mesh) -> Mesh:
    """A mesh whose nodes have three coordinates."""
    if grid.points.shape[1] == 3:
        return grid
    sets: Any = {"node_sets": grid.node_sets, "face_sets": grid.face_sets, "cell_sets": grid.cell_sets}
    return Mesh(in_space(grid), grid.cells, **sets)
