"""Periodic sides of bodies on meshes: opposite faces move alike, but for a mean deformation."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.arguments import LISTED
from visviva.base.errors import InputError
from visviva.base.timefunction import OfTime
from visviva.body.director_body import DirectorBody
from visviva.body.mesh_body import MeshBody
from visviva.component.announcements import Facing
from visviva.component.component import Component, settings
from visviva.component.momentum import Axes, axes_along, by_forces
from visviva.component.values import Matrix
from visviva.mesh.periodic import numbering, refuse_periodic

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
    they must stay as far apart as they are, moved alike at all times. Loads on paired faces are refused. Temperatures
    of the body are not paired, and concentrations are where `MixtureSolid` says so, by its `periodic`.

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
    pairs: Annotated[Sequence[tuple[str, str]], LISTED]
    strain: Matrix = (0.0, 0.0, 0.0)
    times: OfTime | None = None

    def __post_init__(self) -> None:
        if not self.pairs:
            raise InputError(f"{self.label}: pairs is empty; name opposite sets of faces")
        if isinstance(self.solid, DirectorBody):
            raise InputError(
                f"{self.label}: directors of {self.solid.label} would turn freely at its ends; take a solid"
            )
        for pair in self.pairs:
            if pair[0] == pair[-1]:
                raise InputError(f"{self.label}: {tuple(pair)} is no pair of two sets of faces")
        try:
            number, _ = numbering(self.solid.grid, [(p[0], p[-1]) for p in self.pairs], self.label)
        except InputError as error:
            raise InputError(f"{self.label}: {error}") from None
        first = np.unique(number, return_index=True)[1][number]
        self.leaders = first  # of each node the one whose image it is
        self._followers = np.flatnonzero(first != np.arange(len(first)))
        self._leaders = first[self._followers]
        given = np.asarray(self.strain, dtype=float)
        self._gradient = np.diag(given) if given.ndim == 1 else given
        self._times: Any = self.times

    @property
    def outside_axes(self) -> Axes:
        apart = self.solid.points[self._followers] - self.solid.points[self._leaders]
        return "", by_forces(axes_along([*apart, *apart @ self._gradient.T]))[1]  # pairs pull past each other

    def announce(self, model: Model) -> None:
        model.announce(self.solid, self)

    def declare(self, model: Model) -> None:
        model.index(self.solid)
        for facing in model.announced(self.solid, Facing):
            refuse_periodic(facing.by.label, self.solid, self.pairs, self.solid.faces(facing.faces))

    def contribute(self, model: Model) -> None:
        d, X = self.solid.dimension, self.solid.points
        more = (X[self._followers] - X[self._leaders]) @ self._gradient.T
        free = ~self._both_held(model, more)
        self.multipliers = model.multipliers(self, "traction", int(free.sum()))
        first = 0
        for a, b, wider, own in zip(self._leaders, self._followers, more.tolist(), free, strict=True):
            apart = self.solid.combination([b, a], [1.0, -1.0]).components[:d]
            forms = [form for form, is_free in zip(apart, own, strict=True) if is_free]
            if not forms:
                continue
            plain, wider = (X[b] - X[a])[:d][own].tolist(), np.array(wider)[:d][own].tolist()
            if self._times is None:
                held = [form - (p + w) for form, p, w in zip(forms, plain, wider, strict=True)]
                model.constrain(self, self.multipliers, held, first=first)
            else:
                moving = [form - p for form, p in zip(forms, plain, strict=True)]
                model.constrain(
                    self, self.multipliers, moving, first=first, targets=[self._target(w) for w in wider]
                )
            first += len(forms)

    def _both_held(self, model: Model, more: Array) -> NDArray[np.bool_]:
        """Components (n, d) of pairs whose both nodes are held, at their distance.

        Raises
        ------
        InputError
            If it may change.
        """
        motion, d = self.solid.motion, self.solid.dimension
        a, b = (
            self.solid.node_unknowns(nodes)[:, None] - motion.start + np.arange(d)
            for nodes in (self._leaders, self._followers)
        )
        both: NDArray[np.bool_] = motion.fixed[a] & motion.fixed[b]
        movers = np.full(motion.size, None)
        for p in model.driving.prescribed:
            inside = p.unknowns[(p.unknowns >= motion.start) & (p.unknowns < motion.start + motion.size)]
            movers[inside - motion.start] = p.component
        pairs = zip(movers[a].flat, movers[b].flat, strict=True)
        alike = [m is n for m, n in pairs]  # a motion that is not refuses itself
        still = np.abs(more[:, :d]) <= 1e-12 * np.abs(self.solid.points).max()
        lost = both & ~(np.reshape(alike, both.shape) & still)
        if lost.any():
            k = int(np.argmax(lost.any(axis=1)))
            raise InputError(
                f"{self.label}: supports hold both the node at {self.solid.points[self._leaders[k]].tolist()} and its "
                f"image at {self.solid.points[self._followers[k]].tolist()}, which then need not move apart as "
                "strain and times say: hold those of one side alone, as images follow"
            )
        return both

    def _target(self, size: float) -> Any:
        """``size g(t)``; None where that is nothing."""
        g = self._times
        assert g is not None
        return (lambda t: size * g(t)) if size else 0.0
