"""Tying of meshes that do not match."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva import _core
from visviva.base.errors import InputError
from visviva.body.mesh_body import MeshBody
from visviva.body.touching import Skin
from visviva.component.announcements import Facing, Guiding, Holding
from visviva.component.component import Component, settings
from visviva.component.momentum import NOWHERE
from visviva.component.values import Number
from visviva.contact.contact_remarks import conducted, insulated, parted
from visviva.contact.tie_integrals import MortarSurfaces
from visviva.mesh.faces import Faces
from visviva.model.batch import book

if TYPE_CHECKING:
    import scipy.sparse as sp

    from visviva.model.model import Model

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Mask = NDArray[np.bool_]

THIN = 0.05
"""Vertices with less of their area than this over the other surface leave their share to their neighbours."""
TOUCHING = 1e-10
"""Ties that are violated by less than this share of the reach need no node to be moved."""


@dataclass(config=settings, eq=False, kw_only=True)
class Tie(Component):
    """Two surfaces of solids or shells that stick together though their meshes do not match.

    Parameters
    ----------
    first, second : Solid or Shell
        What is tied. The nodes of the first surface, which should be the finer one, follow those of the second.
    first_faces, second_faces : str or Faces
        Which part of the surface, by the name of a set of faces; 'all' for the whole boundary. Of shells 'upper' and
        'lower' are the sides, half a thickness beside the middle, and sets of edges the rims there.
    multipliers : {'dual', 'standard'}
        'dual': the nodes of the first surface leave the equations together with the multipliers, which stay
        positive definite. 'standard': the multipliers are unknowns.
    reach : float
        Surfaces farther apart than this are not tied; by default a tenth of the largest facet.

    Raises
    ------
    InputError
        If the surfaces do not touch, or something else holds the nodes of the first surface.

    Notes
    -----
    The constraints ``sum n_AB x_B - sum n_AC x_C = 0`` (Puso 2004; references [11] and [12] of the paper) are linear
    with constant weights of equal sums, so momenta and energy are exact with every scheme. They must hold in the
    reference configuration: where curved surfaces are faceted differently, nodes of the first mesh are moved there
    initially, by at most `moved`. Components of the nodes that a support holds are left to it if others are free (a
    plane of symmetry); nodes held altogether are refused. See :doc:`/theory/contact`.

    Examples
    --------
    >>> import visviva as vv
    >>> steel = vv.LinearElastic(young=100.0, poisson=0.3)
    >>> left = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(3, 3, 3)), material=steel)
    >>> mesh = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2), origin=(1, 0, 0))
    >>> right = vv.Solid(mesh=mesh, material=steel)
    >>> tie = vv.Tie(first=left, first_faces="x1", second=right, second_faces="x0")
    >>> held = vv.Fixed(solid=left, nodes="x0")
    >>> pulled = vv.Traction(solid=right, faces="x1", traction=(1, 0, 0))
    >>> system = vv.System([left, right, tie, held, pulled])
    >>> _ = vv.quasi_static(system, until=1.0, step=1.0)
    >>> float(tie.forces(system.x)[:, 0].sum().round(9))
    1.0
    """

    outside_axes = NOWHERE

    first: MeshBody
    second: MeshBody
    first_faces: str | Faces = "all"
    second_faces: str | Faces = "all"
    multipliers: Literal["dual", "standard"] = "dual"
    reach: Number | None = None

    def __post_init__(self) -> None:
        for body in (self.first, self.second):
            if body.has_directions:
                raise InputError(
                    f"{self.label}: {body.label} is a line; join it by vv.Rigid to the frame of a coupling on the other"
                )
        self.first.carriers.refuse_each_node(self.label, "take the other one as first, or vv.SplinePatches")
        if self.first is self.second:
            raise InputError(
                f"{self.label}: first and second are the same {self.first.label}; give two bodies"
            )
        if self.first.dimension != self.second.dimension:
            raise InputError(f"{self.label}: {self.first.label} and {self.second.label} differ in dimension")
        if self.first.axisymmetric != self.second.axisymmetric:
            raise InputError(
                f"{self.label}: one of {self.first.label} and {self.second.label} is axisymmetric"
            )
        if self.reach is not None and not self.reach > 0:
            raise InputError(f"{self.label}: reach = {self.reach:g} is not positive")
        sides = ((self.first, self.first_faces), (self.second, self.second_faces))
        try:
            skins = [solid.skin(chosen) for solid, chosen in sides]
        except InputError as error:
            raise InputError(f"{self.label}: {error}") from None
        self._used, self._others = skins[0].used, skins[1].used
        self._nodes = skins[0].nodes[self._used]
        pair = MortarSurfaces((self.first, skins[0]), (self.second, skins[1]), self.reach)
        self._reach = pair.reach
        self._weigh(pair)

    def _weigh(self, pair: MortarSurfaces) -> None:
        """Rows of constraints for the vertices that face the other surface."""
        share = pair.share
        self._tied = share > THIN
        if not self._tied.any():
            raise InputError(
                f"{self.label}: the surfaces of {self.first.label} and {self.second.label} do not touch: their nearest "
                f"nodes are {pair.distance():.3g} apart, and nothing beyond {pair.reach:.3g} is tied. Choose the faces "
                f"that face each other, move one of the meshes, or give a larger reach"
            )
        rows = pair.dual() if self.multipliers == "dual" else pair.standard()
        rows = with_neighbours(rows, pair.first.facets, self._tied, share > 0)
        self._rows = solved(rows, self._tied) if self.multipliers == "dual" else rows

    # --- part in the system ---------------------------------------------------------------------------------
    def announce(self, model: Model) -> None:
        model.announce(self.first, self)
        model.announce(self.second, self)
        model.announce(self.first, Facing(self, self.first_faces))
        model.announce(self.second, Facing(self, self.second_faces))
        if not self._follows:  # what is tied at both of its sides follows with its directors
            nodes, count = np.unique(self._nodes[self._tied], return_counts=True)
            model.announce(self.first, Guiding(nodes[count > 1]))

    def declare(self, model: Model) -> None:
        model.index(self.first), model.index(self.second)
        self._conducts = conducted(model, self.first, self.second)
        self._active = self._tied[:, None] & ~self._held(model)
        self._move(model)
        n = int(self._active.sum())
        self._number = np.full(self._active.shape, -1)
        field = model.multipliers(self, "tie", n)
        self._number[self._active] = field.start + np.arange(n)

    def _held(self, model: Model) -> Mask:
        """Components (n, d) of the nodes that supports hold; refuses nodes that are not free to follow."""
        d = self.first.dimension
        held = np.zeros((len(self._nodes), d), dtype=bool)
        for holding in model.announced(self.first, Holding):
            mine = np.isin(self._nodes, holding.nodes)
            if holding.directions is None:
                self._refuse(mine, holding.by)
            else:
                held[mine] |= holding.directions[:d]
                self._refuse(mine & held.all(axis=1), holding.by)
        for tie in model.announced(self.first, Tie):
            if tie is not self and tie.first is self.first:
                self._refuse(np.isin(self._used, tie._used[tie._tied]), tie)
        return held

    def _refuse(self, conflict: Mask, other: Component) -> None:
        nodes = self._nodes[conflict & self._tied]
        if len(nodes) == 0:
            return
        place = ", ".join(f"{c:.4g}" for c in self.first.points[nodes[0]])
        raise InputError(
            f"{self.label} lets {len(nodes)} nodes of {self.first.label} follow {self.second.label} that {other.label} "
            f"holds as well, such as node {nodes[0]} at ({place}): exchange first and second, or take these nodes out "
            "of one of them"
        )

    def _violation(self) -> Array:
        """Values (n, d) of the constraints in the reference configuration."""
        first, second = self._skins()
        X = np.vstack([first.points[self._used], second.points[self._others]])[:, : self.first.dimension]
        return np.asarray(self._rows @ X)

    def _skins(self) -> tuple[Skin, Skin]:
        """As they are now: other ties may have moved nodes."""
        return self.first.skin(self.first_faces), self.second.skin(self.second_faces)

    def _move(self, model: Model) -> None:
        """Move nodes of the first mesh so that the constraints hold in the reference configuration."""
        from scipy.sparse.linalg import spsolve

        gap = self._violation()
        shift = np.zeros_like(gap)
        own = self._rows[:, : len(self._nodes)]
        for i in range(gap.shape[1]):
            a = np.flatnonzero(self._active[:, i])
            if len(a):
                shift[a, i] = spsolve(own[a][:, a].tocsc(), -gap[a, i])
        self._shift = np.linalg.norm(shift, axis=1)
        if self.moved <= TOUCHING * self._reach:
            self._shift[:] = 0.0
            return
        if self.moved > self._reach:
            k = int(self._shift.argmax())
            place = ", ".join(f"{c:.4g}" for c in self.first.points[self._nodes[k]])
            raise InputError(
                f"{self.label}: node {self._nodes[k]} of {self.first.label} at ({place}) would have to move by "
                f"{self.moved:.3g} to lie on {self.second.label}, more than the reach {self._reach:.3g}. Refine the "
                "surfaces, leave faces out that do not touch, or give a larger reach"
            )
        if not self._follows:
            raise InputError(
                f"{self.label}: faces of {self.first.label} and {self.second.label} do not fit by {self.moved:.3g}, "
                f"and {self.first.label} cannot be moved to do so; exchange first and second, or lay its faces, which "
                "are half a thickness beside its middle, on the other"
            )
        self.first.move_reference(model, self._nodes, shift)

    @property
    def _follows(self) -> bool:
        """True if the points of the first surface are nodes, so that they can be moved and eliminated."""
        return type(self.first).skin is MeshBody.skin

    @property
    def moved(self) -> float:
        """Largest distance by which a node of the first mesh was moved so that the surfaces fit."""
        return float(self._shift.max(initial=0.0))

    def remarks(self) -> list[str]:
        return [*insulated(self.label, self._conducts, self.first, self.second), *self._parted]

    def contribute(self, model: Model) -> None:
        import scipy.sparse as sp

        self._parted = parted(self.label, model, self.first, self.second)
        left = np.abs(self._violation()[self._active]).max(initial=0.0)
        if left > 1e-6 * self._reach * abs(self._rows).max():
            raise InputError(
                f"{self.label}: another tie has moved nodes of {self.second.label} that {self.first.label} is tied "
                "to; exchange first and second of one of them, or let the meshes match there"
            )
        rows = self._rows[self._active.any(axis=1)]
        first, second = self._skins()
        of_vectors = sp.block_diag([first.weights[self._used], second.weights[self._others]], format="csr")
        rows = (rows @ of_vectors).tocsr()
        rows.sort_indices()
        unknown = np.concatenate([first.vectors(), second.vectors()])
        number = self._number[self._active.any(axis=1)]
        term = _core.TieTerm(
            self.first.dimension,
            rows.indptr.astype(np.int32),
            unknown[rows.indices],
            np.ascontiguousarray(number.ravel(), dtype=np.int32),
            np.ascontiguousarray(rows.data),
        )
        term.name = self.label
        book(term, [model.account(self, "constraint", "constraint")], [model.index(self)], 1)
        model.batch(term)
        if self.multipliers == "dual" and self._follows:
            unknowns = self.first.node_unknowns(self._nodes)[:, None] + np.arange(self.first.dimension)
            for pair in zip(unknowns[self._active], self._number[self._active], strict=True):
                model.reductions.eliminate(*map(int, pair))

    # --- results --------------------------------------------------------------------------------------------
    def forces(self, x: Array) -> Array:
        """Forces (n, 3) of the tie on the nodes of the first surface at the unknowns `x` of the system."""
        multiplier = np.where(self._active, x[self._number], 0.0)
        force = -(self._rows[:, : len(self._nodes)].T @ multiplier)
        return np.pad(force, ((0, 0), (0, 3 - self.first.dimension)))


def with_neighbours(rows: sp.csr_array, facets: Ints, tied: Mask, seen: Mask) -> sp.csr_array:
    """Rows to which those of vertices that are seen but not tied are added, shared out among their neighbours."""
    import scipy.sparse as sp

    facet, corner = np.nonzero(facets >= 0)
    on = sp.coo_array((np.ones(len(facet)), (facet, facets[facet, corner])), shape=(len(facets), len(tied)))
    thin = sp.diags_array((seen & ~tied).astype(float))
    beside = (sp.diags_array(tied.astype(float)) @ (on.T @ on) @ thin).tocsr()
    beside.eliminate_zeros()
    beside.data[:] = 1.0
    count = beside.sum(axis=0)
    share = beside @ sp.diags_array(1.0 / np.maximum(count, 1.0))
    keep = sp.diags_array(tied.astype(float))
    return ((keep + share) @ rows).tocsr()


def solved(rows: sp.csr_array, tied: Mask) -> sp.csr_array:
    """The same constraints, row by row without the other tied vertices of the first surface."""
    import scipy.sparse as sp

    n = len(tied)
    own = rows[:, :n]
    diagonal = own.diagonal()
    off = (own - sp.diags_array(diagonal)) @ sp.diags_array(
        np.where(tied, 1 / np.where(tied, diagonal, 1.0), 0.0)
    )
    combined = (rows - off @ rows).tocsr()
    combined.data[np.abs(combined.data) < 1e-15 * np.abs(diagonal).max()] = 0.0
    combined.eliminate_zeros()
    return combined
