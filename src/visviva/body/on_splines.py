"""Common part of solids on spline patches, whose unknowns are the positions of control points."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.body.carriers import Carriers, ControlPoints
from visviva.body.element import nodal_masses
from visviva.body.mesh_points import FacePoints, Points
from visviva.body.solid import Solid
from visviva.body.solid_fields import FULL, OF_STRESS, quantity
from visviva.body.space import Table
from visviva.body.spline_periods import CLOSE, leaders
from visviva.body.spline_points import SplineFacePoints, SplinePoints
from visviva.body.spline_space import SplineSpace, in_three
from visviva.body.touching import Skin
from visviva.component.announcements import Repeating
from visviva.component.values import Pairs
from visviva.mesh.faces import Faces
from visviva.mesh.mesh import Mesh
from visviva.mesh.periodic import partners
from visviva.mesh.spline import SplineSource
from visviva.model.field import Vectors
from visviva.model.form import Form, Vector

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


class OnSplines(Solid):
    """Base of solids on splines, to stand before what else they derive from.

    Attributes
    ----------
    splines : SplineSpace
    """

    mesh: SplineSource  # type: ignore[assignment]
    splines: SplineSpace

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.formulation != "displacement" or self.plane == "axisymmetric" or self.lumped:
            raise InputError(
                f"{self.label}: splines need formulation = 'displacement', plane strain or stress, and no lumped "
                f"masses, not {self.formulation!r}, {self.plane!r}, lumped = {self.lumped}"
            )

    def _checked_mesh(self) -> Mesh:
        try:
            self.splines = SplineSpace(self.mesh, self._smooth_pairs, self.thickness, are_one=False)
            self._tables = self.splines.cells()
        except InputError as error:
            raise InputError(f"{self.label}: {error}") from None
        return self.splines.grid

    @property
    def _smooth_pairs(self) -> Pairs:
        """Sides at which control points do not end, so that `PeriodicFaces` joins all that reach across."""
        return ()

    # --- control points ------------------------------------------------------------------------------------
    @cached_property
    def carriers(self) -> Carriers:
        return ControlPoints(self)

    def node_unknowns(self, nodes: Any) -> NDArray[np.int32]:
        raise InputError(f"{self.label} stands on splines, whose nodes are no unknowns, as is needed here")

    def combination(self, nodes: Any, weights: Any) -> Vector:
        import scipy.sparse as sp

        row = sp.csr_array(np.asarray(weights)[None] @ self.splines.samples[np.asarray(nodes)])
        first = self.carriers.unknowns(row.indices)
        kept = [(int(u), float(w)) for u, w in zip(first, row.data, strict=True) if w != 0.0]
        parts = [Form(tuple((u + c, w) for u, w in kept)) for c in range(self.dimension)]
        x, y, z = (*parts, Form())[:3]
        return Vector((x, y, z))

    def vectors(self, model: Model) -> Vectors:
        n = self.splines.size
        return self.carriers.unknowns(np.arange(n)).astype(np.int64), np.ones(n, dtype=bool), self.dimension

    def skin(self, chosen: str | Faces, fine: bool = False) -> Skin:
        every, faces = np.arange(self.grid.n_nodes), self.faces(chosen)
        first = lambda: self.carriers.unknowns(np.arange(self.splines.size))  # noqa: E731
        return Skin(first, self.splines.samples, self.points, every, faces, faces, self.dimension)

    # --- points and masses ---------------------------------------------------------------------------------
    def cell_points(self) -> Iterator[Points]:
        for t in self._tables:
            yield SplinePoints(nodes=t.numbers, N=t.N, X=t.X, size=t.size)

    def face_points(self, faces: Faces, *, on_sides: bool = False) -> Iterator[FacePoints]:
        for s in self.splines.sides(faces):
            yield SplineFacePoints(
                nodes=s.numbers,
                N=s.N,
                X=s.X,
                size=s.size,
                dN=s.slopes,
                weights=s.weights,
                normal=s.normal,
                drawn=s.drawn,
                shapes=s.shapes,
            )

    def _packed_masses(self, table: Table) -> Array:
        a, b = np.triu_indices(table.N.shape[2])
        packed = np.einsum("mq,mqk,mqk->mk", table.size, table.N[..., a], table.N[..., b])
        return np.ascontiguousarray(self.density * packed)

    @cached_property
    def control_mass(self) -> Array:
        """Share (n,) of every control point in the mass."""
        return nodal_masses(self.splines.size, ((t.numbers, self._packed_masses(t)) for t in self._tables))

    def _masses_of_nodes(self) -> Array:
        """By which nodes stand for the control points that move them."""
        S = self.splines.samples
        return np.asarray(S @ (self.control_mass / S.sum(axis=0)))

    def mass_blocks(self, model: Model) -> Iterator[tuple[Ints, Array]]:
        for t in self._tables if self.density > 0 and self.dimension == 3 else ():
            mass = self.density * np.einsum("mq,mqa,mqb->mab", t.size, t.N, t.N)
            yield self.carriers.unknowns(t.numbers).astype(np.int64), mass

    def declare(self, model: Model) -> None:
        self._joined = [pair for sides in model.announced(self, Repeating) for pair in sides.pairs]
        super().declare(model)

    def _start(self) -> tuple[Array, Array]:
        v = self.initial_velocities()
        pairs = [pair for pair in self._joined if v.any() and self._agree(v, pair)]
        return self.splines.control, self.splines.fitted(v, leaders(self.splines, pairs) if pairs else None)

    def _agree(self, v: Array, pair: tuple[str, str]) -> bool:
        """Whether these velocities of nodes are the same on both sides."""
        one, two = partners(self.grid, *pair, self.label).T
        return bool(np.abs(v[one] - v[two]).max(initial=0.0) <= CLOSE * np.abs(v).max(initial=0.0))

    # --- what it shows -------------------------------------------------------------------------------------
    def at_points(self, name: str, x: Array) -> Array:
        width, function = quantity(name)
        return np.concatenate([function(part).reshape(-1, width) for *_, part in self._evaluated(x)])

    def volume(self, x: Array) -> float:
        total = sum(float((volume * part.J).sum()) for _, _, _, volume, part in self._evaluated(x))
        return total / (self.thickness if self.dimension == 2 else 1.0)

    def nodal_forces(self, x: Array, cells: NDArray[np.bool_] | None = None) -> Array:
        if cells is not None:
            raise InputError(f"{self.label} stands on splines, whose cells exert no forces of their own")
        total = np.zeros((self.grid.n_nodes, 3))
        for nodes, force in self._exerted(x):
            np.subtract.at(total, self.splines.anchors[nodes], in_three(force))
        return total

    def _exerted(self, x: Array) -> Iterator[tuple[Ints, Array]]:
        """Control points (m, k) of the elements, and their forces (m, k, d)."""
        x = np.ascontiguousarray(x, dtype=float)
        return ((part.nodes, part.term.forces(x, 0, len(part.nodes))) for part in self._elements)

    @cached_property
    def _projection(self) -> Any:
        """Factors of the matrix of least squares."""
        import scipy.sparse as sp
        from scipy.sparse.linalg import splu

        parts = [np.einsum("mq,mqa,mqb->mab", t.size, t.N, t.N) for t in self._tables]
        pairs = [
            np.broadcast_to(t.numbers[:, :, None], a.shape) for t, a in zip(self._tables, parts, strict=True)
        ]
        rows = np.concatenate([r.ravel() for r in pairs])
        columns = np.concatenate([np.swapaxes(r, 1, 2).ravel() for r in pairs])
        values = np.concatenate([a.ravel() for a in parts])
        return splu(sp.csc_array(sp.coo_array((values, (rows, columns)), shape=(self.splines.size,) * 2)))

    def _smoothed(self, names: tuple[str, ...], x: Array) -> dict[str, Array]:
        found = {}
        for name in names:
            width, _ = quantity("cauchy" if name in OF_STRESS else name)
            values = self.at_points("cauchy" if name in OF_STRESS else name, x)
            load = np.zeros((self.splines.size, width))
            for t in self._tables:
                here, values = np.split(values, [t.size.size])
                density = here.reshape(*t.size.shape, width)
                np.add.at(load, t.numbers, np.einsum("mq,mqk,mqc->mkc", t.size, t.N, density))
            nodal = np.asarray(self.splines.samples @ self._projection.solve(load))
            shown = OF_STRESS[name](nodal[:, FULL]) if name in OF_STRESS else nodal
            found[name] = shown[:, 0] if shown.ndim == 2 and shown.shape[1] == 1 else shown
        return found
