"""Stiffness and mass of the layer below a surface in contact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from visviva.base.errors import InputError
from visviva.contact.contact_surface import Surface, layer_mass, mesh_bodies

if TYPE_CHECKING:
    from visviva.component.component import Component

AT_ONCE = 1 / 32
"""Part of a layer's mass that answers to the traction of one vertex: less than the share of a node, as consistent
masses let one node move more easily than all together (by 3.5 across the surface and 1.7 along each direction), and
nodes at edges and corners more easily still."""


@dataclass(frozen=True)
class Layer:
    """A layer of elements, as thick as a facet is wide, below the surfaces of bodies that touch.

    Attributes
    ----------
    label : str
        The contact, for messages.
    bodies : sequence of Component
        One or two.
    surface : Surface
        The first one's.
    size : float
        Largest diameter of a facet.
    """

    label: str
    bodies: Sequence[Component]
    surface: Surface
    size: float

    @property
    def moduli(self) -> list[float]:
        """Stiffness moduli of the bodies that deform; of plane ones, whose areas are lengths, times the thickness."""
        return [body.modulus * body.thickness for body in mesh_bodies(*self.bodies)]

    @property
    def stiffness(self) -> float:
        """Pressure per penetration; of a facet of the layer, force per penetration, where points feel forces.

        Raises
        ------
        InputError
            If no body deforms.
        """
        if not self.moduli:
            raise InputError(
                f"{self.label}: between rigid bodies nothing says how stiff contact should be; give its stiffness"
            )
        return min(self.moduli) / self.size * self._patch

    @property
    def inertia(self) -> float:
        """Mass by area that a traction at a vertex moves at once: a part of that of a layer of facets.

        Where points of rigid bodies feel forces, their mass and that of a facet of the layer.
        """
        meshes = mesh_bodies(*self.bodies)
        masses = [AT_ONCE * layer_mass(body, self.size) * self._patch for body in meshes]
        return min((m for m in (*masses, self.rigid_inertia) if m > 0), default=0.0)

    @property
    def rigid_inertia(self) -> float:
        """The same of rigid bodies and points alone, which is all that they answer to a traction with."""
        area, meshes = self.surface.areas.sum() / self.surface.copies, mesh_bodies(*self.bodies)
        rigid = [body for body in self.bodies if body not in meshes]
        return AT_ONCE * min((c.total_mass / area for c in rigid if c.total_mass > 0), default=0.0)

    @property
    def _patch(self) -> float:
        """Area that belongs to a vertex by which it counts: one of its own, or that of a facet for a point."""
        return 1.0 if len(self.surface.facets) or self.surface.across > 0 else self.size**2
