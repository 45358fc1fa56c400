"""Uniform gravity."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.body.mesh_body import MeshBody
from visviva.component.component import Component, settings
from visviva.component.meshed import Meshed
from visviva.component.momentum import Axes, axes_along, by_forces
from visviva.component.values import Vector3

if TYPE_CHECKING:
    from visviva.model.model import Model


@dataclass(config=settings, eq=False, kw_only=True)
class Gravity(Component):
    """Uniform acceleration of everything that has mass.

    What is plane lies in x and y, and feels nothing of the default; what is axisymmetric has its axis along y.

    Parameters
    ----------
    acceleration : array (3,)
        In space (length per time squared).

    Raises
    ------
    InputError
        When a system is made: if it acts on nothing, as across a plane model, or across the axis of what is
        axisymmetric.

    Examples
    --------
    >>> import visviva as vv
    >>> ball = vv.PointMass(mass=1.0)
    >>> system = vv.System([ball, vv.Gravity(acceleration=(0, -9.81, 0))])
    """

    acceleration: Vector3 = (0.0, 0.0, -9.81)
    name: str | None = "gravity"

    @property
    def outside_axes(self) -> Axes:
        return by_forces(axes_along(self.acceleration))

    def announce(self, model: Model) -> None:
        for component in model.components:
            model.announce(component, self)

    def contribute(self, model: Model) -> None:
        heavy = [c for c in model.components if c.total_mass]
        flat = bool(heavy) and all(isinstance(c, Meshed) and c.dimension == 2 for c in heavy)
        if flat and self.acceleration[2] and not self.acceleration[:2].any():
            raise InputError(
                f"{self.label}: acts along z, on bodies that are plane; acceleration=(0, -9.81, 0) is down in y"
            )
        turned = [c for c in heavy if isinstance(c, MeshBody) and c.axisymmetric]
        if turned and (self.acceleration[0] or self.acceleration[2]):
            raise InputError(
                f"{self.label}: {turned[0].label} is axisymmetric about y, and {self.acceleration.tolist()} is not; "
                "mesh it in space"
            )
        for component in model.components:
            component.weigh(model, self.acceleration)
