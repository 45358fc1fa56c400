"""Loads along beams: forces and moments per length of the reference, dead or following the directors."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.base.timefunction import OfTime
from visviva.body.beam import Beam
from visviva.component.component import Component, settings
from visviva.component.momentum import EVERYWHERE, Axes, axes_along, by_forces, joined
from visviva.component.values import Vector3, VectorOrFunction
from visviva.load.distributed import Distribution
from visviva.load.force import carried
from visviva.load.torque import act
from visviva.model.form import Vector
from visviva.model.law import Law, LawKind

if TYPE_CHECKING:
    from visviva.model.model import Model


@dataclass(config=settings, eq=False, kw_only=True)
class LineLoad(Component):
    """Force and moment per reference length all along a beam.

    Parameters
    ----------
    beam : Beam
    force : (3,), or callable
        In space, or along the directors of the nodes with `follower`. A function ``f(t, X)`` of time and reference
        positions (n, 3) has values (n, 3); it is dead.
    moment : (3,)
        Likewise. Moments about fixed axes have no potential; their work is booked.
    follower : bool
        Whether both turn along with the beam.
    times : number, expression, table or callable
        Factor as a function of time, see `TimeFunction`.

    Examples
    --------
    >>> import visviva as vv
    >>> rod = vv.TubeSection(radius=0.01, young=2e11)
    >>> beam = vv.Beam(mesh=vv.LineMesh(points=[(0, 0, 0), (1, 0, 0)], count=8, cell="line3"), section=rod)
    >>> ends = vv.Clamped(solid=beam, nodes="start"), LineLoad(beam=beam, force=(0, 0, -1.0))
    >>> _ = vv.quasi_static(system := vv.System([beam, *ends]), until=1.0, step=1.0)
    >>> exact = -1.0 / (8 * rod.stiffness_matrix()[3, 3])
    >>> round(float(beam.displacements(system.x)[-1, 2] / exact), 3)
    1.0
    """

    beam: Beam
    force: VectorOrFunction = (0.0, 0.0, 0.0)
    moment: Vector3 = (0.0, 0.0, 0.0)
    follower: bool = False
    times: OfTime | None = None

    @property
    def outside_axes(self) -> Axes:
        return (
            EVERYWHERE
            if self.follower
            else joined(by_forces(axes_along(self.force)), ("", axes_along(self.moment)))
        )

    def __post_init__(self) -> None:
        self._has_force = callable(self.force) or bool(np.any(self.force))
        if callable(self.force) and self.follower:
            raise InputError(f"{self.label}: a force that is a function is dead; drop follower, or give (3,)")
        if not self._has_force and not np.any(self.moment):
            raise InputError(f"{self.label}: neither force nor moment is given")
        if not self.follower:
            self._dead = Distribution(self.label, "line load", self.beam, self.force, self.times)

    def contribute(self, model: Model) -> None:
        points = list(self.beam.cell_points())
        if self._has_force and not self.follower:
            self._dead.contribute(model, self, points)
        following = self.follower and self._has_force
        if not following and not np.any(self.moment):
            return
        shares = sum(p.spread(np.ones((*p.size.shape, 1)), self.beam.grid.n_nodes) for p in points)
        for node, share in enumerate(np.asarray(shares)[:, 0].tolist()):
            frame = self.beam.frame_of_node(node)
            d = frame.directors
            if following:
                push = carried(d, share * np.asarray(self.force))
                law = Law(LawKind.FOLLOWER)
                model.act(self, "line load", [*frame.position, *push], law, self.times)
            if np.any(self.moment):
                m = share * np.asarray(self.moment)
                turn = carried(d, m) if self.follower else Vector.constant(m)
                act(model, self, frame, turn, self.times)
