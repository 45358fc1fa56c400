"""Heat that joints and couplings conduct between bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.component.announcements import Conducting
from visviva.component.component import Component, settings
from visviva.component.momentum import NOWHERE
from visviva.component.values import FaceSet, Number, Vector3
from visviva.mesh.locate import locate
from visviva.thermal.carrier import HeatCarrier
from visviva.thermal.exchange import HeatExchange

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(config=settings, eq=False, kw_only=True)
class HeatLink(Component):
    """Heat that a joint, a bolt or a coupling conducts between two bodies: ``conductance (T1 - T2)`` per time.

    Parameters
    ----------
    first, second : ThermalBody, ThermoelasticSolid or FluidHeat
    first_at, second_at : (3,), optional
        Where it begins and ends, in the reference configuration: the places of a joint, say.
    first_faces, second_faces : str or Faces, optional
        The faces of a coupling instead; then the mean temperatures of their areas count, and heat spreads over these.
    conductance : float
        Heat per time and difference of temperatures.

    Notes
    -----
    What leaves the one enters the other, exactly. Between solids that deform, energy is kept and the entropy produced
    is never negative. It holds nothing together: joints, couplings and springs do that.

    Examples
    --------
    >>> import visviva as vv
    >>> left = vv.ThermalBody(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2)), conductivity=1.0, temperature=10.0)
    >>> right = vv.ThermalBody(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1), origin=(5, 0, 0)), conductivity=1.0)
    >>> bolt = vv.HeatLink(first=left, first_at=(1, 0.5, 0.5), second=right, second_faces="x0", conductance=3.0)
    >>> system = vv.System([left, right, bolt])
    >>> result = vv.simulate(system, until=10.0, step=0.1)
    >>> right.temperatures(system.x).mean().round(3)
    np.float64(5.0)
    """

    outside_axes = NOWHERE

    first: HeatCarrier
    second: HeatCarrier
    conductance: Number
    first_at: Vector3 | None = None
    second_at: Vector3 | None = None
    first_faces: FaceSet | None = None
    second_faces: FaceSet | None = None

    def __post_init__(self) -> None:
        if not self.conductance > 0:
            raise InputError(f"{self.label}: conductance = {self.conductance:g} is not positive")
        if self.first is self.second:
            raise InputError(
                f"{self.label}: first and second are the same {self.first.label}; give two bodies"
            )
        ends = (
            ("first", self.first, self.first_at, self.first_faces),
            ("second", self.second, self.second_at, self.second_faces),
        )
        self._ends = [self._end(*end) for end in ends]

    def _end(self, which: str, body: HeatCarrier, at: Any, faces: Any) -> tuple[Ints, Array]:
        """Nodes and weights, which add up to one, of an end's temperature."""
        if (at is None) == (faces is None):
            raise InputError(f"{self.label}: give one of {which}_at and {which}_faces")
        try:
            if faces is None:
                nodes, weights = locate(body.grid, at[: body.dimension], body.label)
                return np.asarray(nodes), np.asarray(weights)
            total = np.zeros(body.grid.n_nodes)
            for p in body.face_points(body.faces(faces)):
                np.add.at(total, p.nodes, p.size @ p.N)
        except InputError as error:
            raise InputError(f"{self.label}: {error}") from None
        nodes = np.flatnonzero(total)
        return nodes, total[nodes] / total.sum()

    def announce(self, model: Model) -> None:
        model.announce(self.first, Conducting((self.first, self.second)))

    def contribute(self, model: Model) -> None:
        model.index(self.first), model.index(self.second)
        nodes = [n[None, :] for n, _ in self._ends]
        weights = [w[None, None, :] for _, w in self._ends]
        term = HeatExchange((self.first, self.second), nodes, weights, np.ones((1, 1)), self.conductance)
        model.term(self, term)
