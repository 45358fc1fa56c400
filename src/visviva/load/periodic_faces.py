"""Periodic sides of bodies on meshes: opposite faces move alike, but for a mean deformation."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError, RunError
from visviva.base.timefunction import OfTime
from visviva.body.director_body import DirectorBody
from visviva.body.mesh_body import MeshBody
from visviva.component.announcements import Facing, Repeating
from visviva.component.component import Component, settings
from visviva.component.momentum import Axes, axes_along, by_forces
from visviva.component.values import Matrix, Pairs
from visviva.mesh.periodic import numbering, refuse_apart, refuse_periodic
from visviva.model.form import Form

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]


@dataclass(config=settings, eq=False, kw_only=True)
class PeriodicFaces(Component):
    """Opposite sides of a solid that move alike, as those of a cell that repeats in space.

    Parameters
    ----------
    solid : a solid on a mesh
    pairs : sequence of (str, str)
        Sets of faces, of equal meshes, that are taken for the same.
    strain : array (3,) or (3, 3)
        Mean displacement gradient G (along the axes, or whole): partners keep the distance ``(1 + g(t) G) (X2 - X1)``.
    times : number, expression or table of time
        ``g(t)``.

    Notes
    -----
    What strains the cell does the work of "drive" in the ledger; where `times` is left out the strain is there from
    the start, and does none. Constraint forces cancel in pairs, so that the momentum is kept; angular momentum has no
    meaning in a body that repeats. What holds nodes of one side holds their images on the other; where both are held
    they must stay as far apart as they are, moved alike at all times. Loads on paired faces are refused. What else
    nodes have, damages, entropies, temperatures and continuous pressures, images share: it goes on beyond the sides.
    Concentrations of `MixtureSolid` do by its `periodic`, which has to name the same pairs. Splines are continuous
    across their sides, with their slopes where `SplineSolid` names them `periodic`, too; control points and weights of
    both have to be the same.

    Examples
    --------
    >>> import visviva as vv
    >>> import numpy as np
    >>> cell = vv.Solid(
    ...     mesh=vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2)), material=vv.SaintVenantKirchhoff(young=10.0, poisson=0.0)
    ... )
    >>> sides = vv.PeriodicFaces(
    ...     solid=cell, pairs=[("x0", "x1"), ("y0", "y1"), ("z0", "z1")], strain=(0.1, 0.0, 0.0), times="t"
    ... )
    >>> system = vv.System([cell, sides, vv.Fixed(solid=cell, nodes=np.array([0]))])
    >>> result = vv.quasi_static(system, until=1.0, step=0.5)
    >>> round(float(result.ledger["potential_strain"][-1]), 9) == round(5 * (0.5 * (1.1**2 - 1)) ** 2, 9)
    True
    """

    contributes_last: ClassVar[int] = 1  # after supports

    solid: MeshBody
    pairs: Pairs
    strain: Matrix = (0.0, 0.0, 0.0)
    times: OfTime | None = None

    def __post_init__(self) -> None:
        if not self.pairs:
            raise InputError(f"{self.label}: pairs is empty; name opposite sets of faces")
        if isinstance(self.solid, DirectorBody):
            raise InputError(
                f"{self.label}: directors of {self.solid.label} would turn freely at its ends; take a solid"
            )
        try:
            number, _ = numbering(self.solid.grid, self.pairs, self.label)
        except InputError as error:
            raise InputError(f"{self.label}: {error}") from None
        self.leaders = np.unique(number, return_index=True)[1][
            number
        ]  # of each node the one whose image it is
        try:
            self._links = self.solid.carriers.links(self.leaders, self.pairs)
        except InputError as error:
            raise InputError(f"{self.label}: {self.solid.label}: {error}") from None
        given = np.asarray(self.strain, dtype=float)
        self._gradient = np.diag(given) if given.ndim == 1 else given
        self._times: Any = self.times

    @property
    def outside_axes(self) -> Axes:
        apart = self._links @ self.solid.carriers.points
        return "", by_forces(axes_along([*apart, *apart @ self._gradient.T]))[1]  # pairs pull past each other

    def announce(self, model: Model) -> None:
        model.announce(self.solid, self)
        model.announce(self.solid, Repeating(self.pairs))

    def declare(self, model: Model) -> None:
        model.index(self.solid)
        for facing in model.announced(self.solid, Facing):
            refuse_periodic(facing.by.label, self.solid, self.pairs, self.solid.faces(facing.faces))

    def contribute(self, model: Model) -> None:
        d, rows = self.solid.dimension, self._links
        plain = rows @ self.solid.carriers.points
        more = plain @ self._gradient.T
        free = ~self._all_held(model, more)
        self.multipliers = model.multipliers(self, "traction", int(free.sum()))
        first, unknowns, ends = 0, self.solid.carriers.unknowns(rows.indices).tolist(), rows.indptr.tolist()
        for k, own in enumerate(free):
            part = slice(ends[k], ends[k + 1])
            terms = list(zip(unknowns[part], rows.data[part].tolist(), strict=True))
            forms = [Form(tuple((u + c, w) for u, w in terms)) for c in np.flatnonzero(own).tolist()]
            if not forms:
                continue
            apart, wider = plain[k, :d][own].tolist(), more[k, :d][own].tolist()
            if self._times is None:
                held = [form - (p + w) for form, p, w in zip(forms, apart, wider, strict=True)]
                model.constrain(self, self.multipliers, held, first=first)
            else:
                moving = [form - p for form, p in zip(forms, apart, strict=True)]
                model.constrain(
                    self, self.multipliers, moving, first=first, targets=[self._target(w) for w in wider]
                )
            first += len(forms)

    def _all_held(self, model: Model, more: Array) -> NDArray[np.bool_]:
        """Components (n, d) of what is all held, at its distance.

        Raises
        ------
        InputError
            If it may change.
        """
        motion, rows = self.solid.motion, self._links
        at = (
            self.solid.carriers.unknowns(rows.indices)[:, None]
            - motion.start
            + np.arange(self.solid.dimension)
        )
        held: NDArray[np.bool_] = np.logical_and.reduceat(motion.fixed[at], rows.indptr[:-1])
        movers = np.full(motion.size, -1)
        for k, p in enumerate(model.driving.prescribed):
            inside = p.unknowns[(p.unknowns >= motion.start) & (p.unknowns < motion.start + motion.size)]
            movers[inside - motion.start] = k
        low, high = (which.reduceat(movers[at], rows.indptr[:-1]) for which in (np.minimum, np.maximum))
        still = np.abs(more[:, : self.solid.dimension]) <= 1e-12 * np.abs(self.solid.points).max()
        lost = held & ~((low == high) & still)  # a motion that is not alike refuses itself
        if lost.any():
            k = int(np.argmax(lost.any(axis=1)))
            a, b = self.solid.carriers.points[rows.indices[rows.indptr[[k, k + 1]] - [0, 1]]].tolist()
            raise InputError(
                f"{self.label}: supports hold both the node at {a} and its image at {b}, which then need not move "
                "apart as strain and times say: hold those of one side alone, as images follow"
            )
        return held

    def _target(self, size: float) -> Any:
        """``size g(t)``; None where that is nothing."""
        g = self._times
        assert g is not None
        return (lambda t: size * g(t)) if size else 0.0


def shared_values(solid: MeshBody, what: str, number: NDArray[np.int64], values: Array) -> Array:
    """Values at the start of each of the `number` (n,), of those of nodes (n,).

    Raises
    ------
    InputError
        If nodes of one number differ.
    """
    try:
        refuse_apart(solid.label, what, number, values, 0.0)
    except RunError as error:
        raise InputError(str(error)) from None
    first: Array = values[np.unique(number, return_index=True)[1]]
    return first
