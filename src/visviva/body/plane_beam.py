"""Geometrically exact beams of plane systems: two coordinates and one director of two at each node."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.body.beam import Beam
from visviva.body.plane_skin import plane_skin, reach_of
from visviva.body.touching import Skin
from visviva.component.announcements import Straining
from visviva.component.component import settings
from visviva.mesh.faces import Faces
from visviva.model.batch import Layout, strain_batch
from visviva.model.form import Form, Strain, Vector, dot
from visviva.model.law import Law, LawKind

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
IN_PLANE = [1, 2, 3]
"""Strains of a beam in the plane: shear along d2, extension, curvature about d1."""
ACROSS = [0, 4, 5]
QUARTER = np.array([[0.0, -1.0], [1.0, 0.0]])
"""The rotation that takes d2 to d3."""
SMALL = 1e-12
SIDES = ("all", "left", "right", "ends")


@dataclass(config=settings, eq=False, kw_only=True)
class PlaneBeam(Beam):
    """A beam in the plane z = 0, as plane solids are there: four unknowns at each node and one constraint.

    Nodes have a position and the director d2 across the line in the plane. Of the other directors d1 is the normal of
    the plane, and d3 is d2 turned by a quarter. What the plane has no part in joints and loads is left out. It touches
    others and itself (`Contact`) by its sides, half the height of its section to the 'left' and 'right' of its line.

    Parameters
    ----------
    mesh : Mesh, or a generator or file that gives one
        Of lines with z = 0.
    section : CrossSection, or one for each cell
        Their d1 is the normal of the plane, so that `RectangleSection.width` is across the plane, and `height` in it.
        Shear along d2, extension and bending about d1 count, and may couple with each other only.
    rigid, kinks, velocity, angular_velocity
        As for `Beam`. Cells have nodes of their own at all kinks, behind those of the mesh.

    Notes
    -----
    Directors are interpolated as those of `Beam`, and results are the same as those of one whose nodes a
    `SymmetryPlane` holds. The second director of Betsch & Steinmann in the plane is a linear form of the first one
    here, so that two unknowns and two constraints of theirs are not there.

    Examples
    --------
    Rolled up to a circle by a moment, within the error of 20 cells:

    >>> import numpy as np, visviva as vv
    >>> section = vv.RectangleSection(width=1.0, height=0.1, young=1.2e6)
    >>> strip = PlaneBeam(mesh=vv.LineMesh(points=[(0, 0, 0), (12, 0, 0)], count=20, cell="line3"), section=section)
    >>> clamp = vv.Clamped(solid=strip, nodes="start")
    >>> bend = vv.Torque(on=strip.frame(12.0), torque=(0, 0, 2 * np.pi * 100 / 12), times="t")
    >>> system = vv.System([strip, clamp, bend])
    >>> _ = vv.quasi_static(system, until=1.0, step=0.1)
    >>> bool(np.abs(strip.positions(system.x)[strip.nodes("end")]).max() < 0.01)
    True
    """

    n_held = 1
    _parted: ClassVar[tuple[str, ...]] = ("hinged", "rigid")

    def __post_init__(self) -> None:
        if self.first is not None:
            raise InputError(
                f"{self.label}: d1 is the normal of the plane; leave out first, or take a vv.Beam"
            )
        super().__post_init__()
        if np.any(self.grid.points[:, 2] != 0):
            raise InputError(f"{self.label}: its mesh leaves the plane z = 0; take a vv.Beam")
        self._held_strains = [k for k in self._held_strains if k in IN_PLANE]
        if any(section.energy_function() is not None for section in self.sections):
            raise InputError(f"{self.label}: a vv.UserSection is for a vv.Beam")
        for what, C in (("stiffness", self.stiffness), ("damping", self._damping)):
            coupled = np.abs(C[:, IN_PLANE][:, :, ACROSS]).max(initial=0.0)
            if coupled > SMALL * np.abs(C).max(initial=0.0):
                raise InputError(
                    f"{self.label}: the {what} of its section couples strains in the plane with others (by "
                    f"{coupled:g}), so that it would leave it; take a vv.Beam"
                )

    @property
    def dimension(self) -> int:
        return 2

    @property
    def _across(self) -> Any:
        return (0.0, 0.0, 1.0)

    @property
    def triads(self) -> Array:
        return self.line.triads[:, 1:2, :2]

    @cached_property
    def cell_mass(self) -> tuple[Array, ...]:
        xi, w = np.polynomial.legendre.leggauss(self.line.cells.shape[1])
        N, _, speed = self.line.slopes(xi[:, None])
        moments = self._moments[:, [0, 2]][:, :, [0, 2]]
        return (np.einsum("mq,qa,qb,mvw->mavbw", w * speed, N, N, moments),)

    # --- what it contributes -------------------------------------------------------------------------------
    def contribute(self, model: Model) -> None:
        self._heated = model.announced(self, Straining)
        free = ~self.unheld(model)
        joined = self._hinges[:, 1] if self.kinks == "rigid" else self._hinges[:0, 1]
        free[joined] = False
        model.hold(self._multipliers, joined)
        for k in np.flatnonzero(free).tolist():
            n = self._second([k], [1.0])
            model.constrain(self, self._multipliers, [0.5 * dot(n, n) - 0.5], first=k)
        self._add_law(model, "stored", "potential", LawKind.QUADRATIC, self.stiffness)
        if np.any(self._damping):
            self._add_law(model, "dissipated", "dissipation", LawKind.VISCOUS, self._damping)
        if self._held_strains:
            self._hold_strains(model)
        if len(self._hinges):
            self._join(model)
        self.add_inertia(model)

    def _add_law(self, model: Model, what: str, category: str, kind: LawKind, matrix: Array) -> None:
        """Springs or dampers along combinations of the strains in which they do not couple."""
        nodes = self.line.cells
        (m, q), k = self._strains.length.shape, nodes.shape[1]
        rows = uncoupled(matrix[:, IN_PLANE][:, :, IN_PLANE])  # (m, 3, 3)
        free = np.einsum("mrs,mqs->mqr", rows, self._strains.reference[..., IN_PLANE])
        index = np.concatenate([self.node_unknowns(nodes)[..., None], self.director_unknowns(nodes)], axis=2)
        index = (index[..., None] + np.arange(2)).reshape(m, 4 * k)
        N, slope = np.broadcast_to(self._strains.N, (m, q, k)), self._strains.slope
        shear, stretch, bend = (rows[:, None, :, s, None] for s in range(3))
        n, dn, x = N[:, :, None], slope[:, :, None], np.broadcast_to(slope[:, :, None], (m, q, 3, k))
        dn = np.broadcast_to(dn, x.shape)
        weights = np.concatenate(
            [
                *(shear * n, -stretch * n, shear * n, stretch * n, x, x, bend * n, bend * n, dn, dn),
                *(-0.5 * stretch * n, -0.5 * stretch * n, n + 0 * x, n + 0 * x),
            ],
            3,
        )
        length = np.broadcast_to(self._strains.length[..., None], free.shape)
        term = strain_batch(
            one_strain(k),
            Law(kind),
            np.repeat(index, 3 * q, axis=0),
            weights.reshape(3 * m * q, -1),
            np.column_stack([length.ravel(), free.ravel()]),
        )
        model.strain_batch(self, what, category, term, 3 * m * q)

    def _join(self, model: Model) -> None:
        """Nodes of pieces that are one place stay so, and where they are rigid their directors turn alike."""
        joined: list[list[Form]] = []
        for a, b in self._hinges.tolist():
            ties = list(self.combination([b], [1.0]) - self.combination([a], [1.0]))[:2]
            if self.kinks == "rigid":
                (here,), (there,) = self.triads[a], self.triads[b]
                along, turned = float(here @ there), float((QUARTER @ here) @ there)
                both = along * self._second([a], [1.0]) + turned * self._third([a], [1.0])
                ties += list(self._second([b], [1.0]) - both)[:2]
            joined.append(ties)
        n = len(joined[0])
        multipliers = model.multipliers(self, "kinks", n * len(joined), part=n)
        for k, forms in enumerate(joined):
            model.constrain(self, multipliers, forms, first=n * k)

    # --- strains -------------------------------------------------------------------------------------------
    def strain_forms(self, cell: int, point: int) -> list[Strain]:
        nodes, N, slope = self.line.cells[cell], self._strains.N[point], self._strains.slope[cell, point]
        tangent, d2, d3 = self.combination(nodes, slope), self._second(nodes, N), self._third(nodes, N)
        none = dot(tangent, Vector.constant((0.0, 0.0, 1.0)))
        bend = 0.5 * (dot(d3, self._second(nodes, slope)) - dot(d2, self._third(nodes, slope)))
        found = [none, dot(d2, tangent), dot(d3, tangent) - 0.5 * dot(d3, d3), bend, none, none]
        return [e - float(c) for e, c in zip(found, self._strains.reference[cell, point], strict=True)]

    def directors(self, x: Array) -> Array:
        found = np.zeros((self.grid.n_nodes, 3, 3))
        found[:, 0, 2] = 1.0
        found[:, 1, :2] = self.triads_at(x)[:, 0]
        found[:, 2, :2] = found[:, 1, :2] @ QUARTER.T
        return found

    def _second(self, nodes: Any, weights: Any) -> Vector:
        """Weighted sum of directors d2."""
        own = list(zip(self.director_unknowns(nodes)[..., 0].tolist(), map(float, weights), strict=True))
        return Vector((Form(tuple(own)), Form(tuple((u + 1, w) for u, w in own)), Form()))

    def _third(self, nodes: Any, weights: Any) -> Vector:
        """Weighted sum of directors d3."""
        x, y, none = self._second(nodes, weights)
        return Vector((-1.0 * y, x, none))

    # --- attachment ----------------------------------------------------------------------------------------
    def place(self, X: Array) -> Vector:
        found = self.line.place(np.asarray(X, dtype=float), self.label)
        if abs(found.offset[0]) > SMALL * self.extent:
            raise InputError(f"{self.label}: {np.asarray(X).tolist()} lies off its plane z = 0")
        along = self.combination(found.nodes, found.N)
        arms = self._second(found.nodes, found.offset[1] * found.N)
        return along + arms + self._third(found.nodes, found.offset[2] * found.N)

    def turn(self, direction: Array, X: Array) -> Vector:
        found = self.line.place(np.asarray(X, dtype=float), self.label)
        normal, second, third = np.linalg.solve(self._reference_directors(found).T, direction)
        turned = self._second(found.nodes, second * found.N) + self._third(found.nodes, third * found.N)
        return turned + Vector.constant((0.0, 0.0, float(normal)))

    def skin(self, chosen: str | Faces, fine: bool = False) -> Skin:
        """The sides 'left' and 'right' of its line, its free 'ends', or 'all' of them.

        Raises
        ------
        InputError
            If something else is chosen, or a section has no outline.
        """
        if chosen not in SIDES:
            raise InputError(
                f"{self.label} is touched at 'left' and 'right' of its line, at its 'ends' or at 'all' of them, not at "
                f"{chosen if isinstance(chosen, str) else 'other faces'!r}"
            )
        found = plane_skin(self.line, self._reach, self._hinges.ravel(), str(chosen), self._vectors)
        return replace(found, drawn=self._swept.nodes, mass=self.density)

    @cached_property
    def _reach(self) -> Array:
        """Of the sections of all cells (m, 2) to the left and to the right."""
        return self.by_cell(reach_of)

    @property
    def modulus(self) -> float:
        """Stiffness against stretch by height, which contact is scaled by."""
        return float((self.stiffness[:, 2, 2] / np.diff(self._reach, axis=1)[:, 0]).max())

    def _vectors(self) -> NDArray[np.int32]:
        """First unknowns (2 n,) of positions and of directors d2."""
        first = self.node_unknowns(np.arange(self.grid.n_nodes))
        return np.concatenate([first, first + 2])

    # --- what it shows -------------------------------------------------------------------------------------
    def drawn_velocities(self, x: Array, v: Array) -> Array:
        turning = self.directors(v)
        turning[:, 0] = 0.0
        return self._swept.points(self.positions(v), turning)


def uncoupled(C: Array) -> Array:
    """Rows R (m, n, n) for matrices (m, n, n) without negative eigenvalues, so that ``C = R^T R``."""
    size = np.sqrt(np.einsum("mii->mi", C))
    size[size == 0] = 1.0
    values, vectors = np.linalg.eigh(C / (size[:, :, None] * size[:, None, :]))
    return np.asarray(
        np.sqrt(np.maximum(values, 0.0))[:, :, None] * vectors.transpose(0, 2, 1) * size[:, None, :]
    )


def one_strain(k: int) -> Layout:
    """One strain ``p . phi' + q x n' + r . n`` of k nodes with unknowns x, y, n_x, n_y.

    Forms are p, made of n and n turned by a quarter, phi', q along n, n', r along n, and n.
    """
    x, y, nx, ny = ([4 * a + c for a in range(k)] for c in range(4))
    places = [(0, nx), (0, ny), (1, ny), (1, nx), (2, x), (3, y), (4, nx), (5, ny), (6, nx), (7, ny)]
    places += [(8, nx), (9, ny), (10, nx), (11, ny)]
    forms = [(form, u) for form, unknowns in places for u in unknowns]
    products = [(0, 0, 2), (0, 1, 3), (0, 4, 7), (0, 5, 6), (0, 8, 10), (0, 9, 11)]
    return Layout(4 * k, 12, 1, forms, products=products, coefficients=[1, 1, 1, -1, 1, 1])
