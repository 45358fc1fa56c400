"""Dead loads distributed over volumes or surfaces of solids, constant in space or any function of it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError, RunError
from visviva.base.places import OfPart
from visviva.base.timefunction import OfTime
from visviva.body.director_body import refuse_thin
from visviva.body.mesh_body import MeshBody
from visviva.body.mesh_points import Points
from visviva.component.component import Component, settings
from visviva.component.momentum import Axes, axes_along, by_forces
from visviva.component.values import VectorOrField
from visviva.load.force import guarded
from visviva.model.batch import components, strain_batch
from visviva.model.law import Law, LawKind

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]


class Distribution:
    """Force per volume or area of a solid: a vector (3,) times a function of time, or a function ``f(t, X)``."""

    def __init__(self, label: str, what: str, solid: MeshBody, value: Any, times: Any) -> None:
        self.label, self.what, self.solid, self.value, self.times = label, what, solid, value, times
        self._function = OfPart(label, what, guarded(label, what, value)) if callable(value) else None
        if self._function is not None and times is not None:
            raise InputError(f"{label}: a {what} that is a function has time in it; drop times")
        try:
            start = self.at(0.0, solid.points)
        except RunError as error:
            raise InputError(str(error)) from error
        if solid.dimension == 2 and np.any(start[:, 2] != 0):
            raise InputError(f"{label}: a plane solid cannot be loaded out of its plane")

    def at(self, time: float, X: Array) -> Array:
        """Values (..., 3) at a time and reference positions (..., 3)."""
        if self._function is None:
            return np.broadcast_to(self.value, X.shape)
        places = X.reshape(-1, 3)
        found = self._function(time, places)
        if found.shape != places.shape:
            raise RunError(
                f"{self.label}: its {self.what} has shape {found.shape} for positions {places.shape}"
            )
        if not np.isfinite(found).all():
            raise RunError(f"{self.label}: its {self.what} is not finite at t = {time:g}")
        return found.reshape(X.shape)

    def contribute(self, model: Model, owner: Component, points: Sequence[Points]) -> None:
        """Let the load act at these quadrature points."""
        model.index(self.solid)
        gathered = Gathered(self.solid, points)

        def force(time: float) -> Array:
            return gathered.forces([self.at(time, p.X) for p in points])

        if self._function is None:
            model.nodal_loads(owner, self.what, gathered.first, force(0.0), self.times)
            return
        law = Law(LawKind.RATE_CALLBACK, callback=forces_of_time(force))
        self.callback = law.callback  # the core does not keep it alive
        d = self.solid.dimension
        index = gathered.first[:, None] + np.arange(d)
        term = strain_batch(components(d), law, index, 1.0, (0.0, 0.0))
        model.strain_batch(owner, self.what, "work", term, len(index))


class Gathered:
    """Sums of what acts at quadrature points over the vectors that their places are made of.

    Attributes
    ----------
    first : array of int, (n,)
        First unknowns of these vectors.
    """

    def __init__(self, solid: MeshBody, points: Sequence[Points]) -> None:
        unknowns = [p.unknowns(solid) for p in points]
        self.first, slots = np.unique(np.concatenate([u.ravel() for u in unknowns]), return_inverse=True)
        self._slots = np.split(slots, np.cumsum([u.size for u in unknowns])[:-1])
        self._points, self._dimension = points, solid.dimension

    def forces(self, densities: Sequence[Array]) -> Array:
        """Forces (n, d) by densities (m, q, 3) of the points of each type."""
        total = np.zeros((len(self.first), 3))
        for p, slots, density in zip(self._points, self._slots, densities, strict=True):
            np.add.at(total, slots, p.forces(density).reshape(-1, 3))
        return total[:, : self._dimension]


def forces_of_time(force: Any) -> Any:
    """The core's callback for forces (n, d) that are a function of time alone; kept as long as time stands."""
    last: list[Any] = [None, None]

    def call(
        n: int, want_tangent: bool, t: float, h: float, discrete: bool, arrays: tuple[Array, ...]
    ) -> None:
        if last[0] != t:
            last[:] = t, -force(t).T
        arrays[5][:, :n] = last[1]
        if want_tangent:
            arrays[6][:] = arrays[7][:] = 0.0

    return call


@dataclass(config=settings, eq=False, kw_only=True)
class BodyForce(Component):
    """Dead load per reference volume, all over a solid.

    Parameters
    ----------
    solid : Solid
    force : array (3,) or callable
        Force per reference volume; expressions in t, x, y, z of time and reference position, ``("-x*t", 0, 0)``; or
        ``f(t, X)`` of time and reference positions (n, 3) with values (n, 3).
    times : number, expression, table or callable
        Factor as a function of time, see `TimeFunction`.

    Examples
    --------
    >>> import visviva as vv
    >>> mesh = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2))
    >>> block = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1e3, poisson=0.3), density=1.0)
    >>> spin = lambda t, X: 4.0 * X * (1, 1, 0)
    >>> system = vv.System([block, vv.BodyForce(solid=block, force=spin)])
    """

    solid: MeshBody
    force: VectorOrField
    times: OfTime | None = None

    @property
    def outside_axes(self) -> Axes:
        return by_forces(axes_along(self.force))

    def __post_init__(self) -> None:
        refuse_thin(
            self.label,
            "give a beam a vv.LineLoad, a shell a vv.Traction on its side 'upper', or both vv.Gravity",
            self.solid,
        )
        self._distribution = Distribution(self.label, "body force", self.solid, self.force, self.times)

    def contribute(self, model: Model) -> None:
        self._distribution.contribute(model, self, list(self.solid.cell_points()))
