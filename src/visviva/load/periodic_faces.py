"""Periodic sides of bodies on meshes: opposite faces move alike, but for a mean deformation."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.arguments import LISTED
from visviva.base.errors import InputError
from visviva.base.timefunction import OfTime
from visviva.body.mesh_body import MeshBody
from visviva.component.component import Component, settings
from visviva.component.momentum import Axes, axes_along, by_forces
from visviva.component.values import Matrix
from visviva.mesh.periodic import numbering

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
    meaning in a body that repeats.

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

    solid: MeshBody
    pairs: Annotated[Sequence[tuple[str, str]], LISTED]
    strain: Matrix = (0.0, 0.0, 0.0)
    times: OfTime | None = None

    def __post_init__(self) -> None:
        if not self.pairs:
            raise InputError(f"{self.label}: pairs is empty; name opposite sets of faces")
        for pair in self.pairs:
            if pair[0] == pair[-1]:
                raise InputError(f"{self.label}: {tuple(pair)} is no pair of two sets of faces")
        try:
            number, _ = numbering(self.solid.grid, [(p[0], p[-1]) for p in self.pairs], self.label)
        except InputError as error:
            raise InputError(f"{self.label}: {error}") from None
        first = np.unique(number, return_index=True)[1][number]
        self._followers = np.flatnonzero(first != np.arange(len(first)))
        self._leaders = first[self._followers]
        given = np.asarray(self.strain, dtype=float)
        self._gradient = np.diag(given) if given.ndim == 1 else given
        self._times: Any = self.times

    @property
    def outside_axes(self) -> Axes:
        apart = self.solid.points[self._followers] - self.solid.points[self._leaders]
        return "", by_forces(axes_along([*apart, *apart @ self._gradient.T]))[1]  # pairs pull past each other

    def declare(self, model: Model) -> None:
        model.index(self.solid)
        self.multipliers = model.multipliers(self, "traction", self.solid.dimension * len(self._followers))

    def contribute(self, model: Model) -> None:
        d, X = self.solid.dimension, self.solid.points
        for k, (a, b) in enumerate(zip(self._leaders, self._followers, strict=True)):
            apart = self.solid.combination([b, a], [1.0, -1.0])
            plain = (X[b] - X[a]).tolist()
            more = (self._gradient @ (X[b] - X[a])).tolist()
            forms = list(apart.components)[:d]
            if self._times is None:
                held = [form - (plain[c] + more[c]) for c, form in enumerate(forms)]
                model.constrain(self, self.multipliers, held, first=d * k)
                continue
            moving = [form - plain[c] for c, form in enumerate(forms)]
            targets = [self._target(more[c]) for c in range(d)]
            model.constrain(self, self.multipliers, moving, first=d * k, targets=targets)

    def _target(self, size: float) -> Any:
        """``size g(t)``; None where that is nothing."""
        g = self._times
        assert g is not None
        return (lambda t: size * g(t)) if size else 0.0
