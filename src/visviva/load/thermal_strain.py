"""Strains of a beam by heat, as functions of time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.arguments import LISTED
from visviva.base.errors import InputError
from visviva.base.timefunction import OfTime, TimeFunction
from visviva.body.beam import Beam
from visviva.component.announcements import Straining
from visviva.component.component import settings
from visviva.component.momentum import NOWHERE
from visviva.component.values import Number

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]
Pair = Annotated[tuple[Number, Number], LISTED]


@dataclass(config=settings, eq=False, kw_only=True)
class ThermalStrain(Straining):
    """Strains that the sections of a beam take on without force, all along it: heating, shrinkage, a set curvature.

    Parameters
    ----------
    beam : Beam
    extension : float
        Such as the thermal expansion times the mean temperature.
    curvature : two numbers
        About d1 and d2, such as the expansion times the difference of temperature across, by the depth.
    times : number, expression, table or callable
        Factor as a function of time, see `TimeFunction`.

    Notes
    -----
    It acts by the forces ``C e`` of the stiffness C on the strains; what they do is booked as work "thermal".
    Resultants of the beam are without them. Stored energy is that of the whole strains.

    Examples
    --------
    >>> import visviva as vv
    >>> rod = vv.TubeSection(radius=0.01, young=2e11)
    >>> beam = vv.Beam(mesh=vv.LineMesh(points=[(0, 0, 0), (1, 0, 0)], count=4), section=rod)
    >>> heat = ThermalStrain(beam=beam, extension=1e-3, times="t")
    >>> _ = vv.quasi_static(s := vv.System([beam, vv.Clamped(solid=beam, nodes="start"), heat]), until=1.0, step=1.0)
    >>> round(float(beam.displacements(s.x)[-1, 0]), 9), bool(abs(beam.resultants(s.x)).max() < 1e-3)
    (0.001, True)
    """

    outside_axes = NOWHERE

    beam: Beam
    extension: Number = 0.0
    curvature: Pair = (0.0, 0.0)
    times: OfTime | None = None

    def __post_init__(self) -> None:
        if not self.extension > -1:
            raise InputError(
                f"{self.label}: extension = {self.extension:g} leaves no length; it must exceed -1"
            )
        if not np.any(self._given):
            raise InputError(f"{self.label}: neither extension nor curvature is given")
        if any(s.energy_function() is not None for s in self.beam.sections):
            raise InputError(
                f"{self.label}: {self.beam.label} has sections by an energy of the user; subtract the strains in it"
            )
        if self.extension and "stretch" in self.beam.rigid:
            raise InputError(
                f"{self.label}: {self.beam.label} cannot stretch; drop extension, or rigid='stretch'"
            )

    @property
    def _given(self) -> Array:
        return np.array([0.0, 0.0, self.extension, *self.curvature, 0.0])

    def strain(self, x: Array) -> Array:
        return self._given * float(x[self._factor.start])

    def announce(self, model: Model) -> None:
        model.announce(self.beam, self)

    def declare(self, model: Model) -> None:
        self._time = TimeFunction(1.0 if self.times is None else self.times)
        self._factor = model.field(self, "factor", [self._time(0.0)])

    def contribute(self, model: Model) -> None:
        model.prescribe(self, self._factor, [0], self._value, self._rate, self._time.kinks)
        forces = np.einsum("mij,mq,j->mqi", self.beam.stiffness, self.beam.volumes[0], self._given)
        for cell, at in enumerate(forces):
            for point, force in enumerate(at):
                e = self.beam.strain_forms(cell, point)
                total: Any = sum(float(f) * strain for f, strain in zip(force, e, strict=True) if f)
                model.load(self, "thermal", total, 1.0, self._time)

    def _value(self, time: float) -> Array:
        return np.array([self._time(time)])

    def _rate(self, time: float, step: float) -> Array:
        return np.array([self._time.rate_after(time, step)])
