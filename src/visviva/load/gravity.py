"""Uniform gravity."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pydantic.dataclasses import dataclass

from visviva.component.component import Component, settings
from visviva.component.momentum import Axes, axes_along, by_forces
from visviva.component.values import Vector3

if TYPE_CHECKING:
    from visviva.model.model import Model


@dataclass(config=settings, eq=False, kw_only=True)
class Gravity(Component):
    """Uniform acceleration `acceleration` (3,) on everything that has mass."""

    acceleration: Vector3 = (0.0, 0.0, -9.81)
    name: str | None = "gravity"

    @property
    def outside_axes(self) -> Axes:
        return by_forces(axes_along(self.acceleration))

    def announce(self, model: Model) -> None:
        for component in model.components:
            model.announce(component, self)

    def contribute(self, model: Model) -> None:
        for component in model.components:
            component.weigh(model, self.acceleration)
