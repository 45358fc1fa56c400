"""Probes of mixtures and order parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.component.component import settings
from visviva.component.values import Number
from visviva.measure.measures import Reading
from visviva.phase.allen_cahn import AllenCahn
from visviva.phase.cahn_hilliard import CahnHilliard
from visviva.phase.exclusion import Exclusion
from visviva.phase.interface import unclear
from visviva.phase.mixture_solid import MixtureSolid
from visviva.phase.statistics import domain_size, interface_area, phase_volume

if TYPE_CHECKING:
    from visviva.system.system import System

Array = NDArray[np.float64]
Body = CahnHilliard | AllenCahn | MixtureSolid


def coefficients(body: Body, system: System) -> Array:
    """Of the concentration or order parameter."""
    return np.asarray(system.x[body.phase.start : body.phase.start + body.phase.size])


@dataclass(config=settings, frozen=True, kw_only=True)
class InterfaceArea(Reading):
    """Probe: area of the interfaces, ``integral of |grad c|`` over the difference of the phases.

    Parameters
    ----------
    body : CahnHilliard, MixtureSolid or AllenCahn
    phases : (float, float), optional
        Values on both sides of interfaces. By default those that its free energy separates into, of the time being if
        that changes; without two there is no interface. To be given for order parameters that exclude each other,
        (0, 1) for grains, and for mixtures in solids, where stress moves the phases.
    """

    body: Body
    phases: tuple[Number, Number] | None = None

    def __post_init__(self) -> None:
        if self.phases is not None and not self.phases[0] < self.phases[1]:
            raise InputError(f"InterfaceArea: phases = {self.phases} do not ascend")
        if self.phases is None and isinstance(self.body, MixtureSolid):
            found = self.body.interface()
            without = "" if found is None else f", which are {found.low:.4g} and {found.high:.4g} without any"
            raise InputError(
                f"InterfaceArea: stress moves the phases of {self.body.label}{without}, and its free energy does not "
                "tell by how much; give phases=(low, high)"
            )
        if self.phases is None and not self.body.free_energy.changes and self.body.interface() is None:
            raise InputError(
                f"InterfaceArea: the free energy of {self.body.label} has no two phases; give phases=(low, high)"
            )

    def __call__(self, system: System) -> Any:
        phases = self.phases or self._separated(system)
        if phases is None:
            return 0.0
        return interface_area(self.body.space.cells(), coefficients(self.body, system), phases[1] - phases[0])

    def _separated(self, system: System) -> tuple[float, float] | None:
        """What the free energy separates into."""
        for other in system.components:
            if isinstance(other, Exclusion) and self.body in other.bodies:
                raise InputError(
                    f"InterfaceArea: {self.body.label} is one of several order parameters of {other.label}, and its "
                    "free energy alone does not tell its phases; give phases=(low, high), (0, 1) for grains"
                )
        found = self.body.interface(system.time)
        is_conserved = not isinstance(self.body, AllenCahn) or self.body.conserved
        if found is not None and (why := unclear(found, is_conserved)):
            raise InputError(
                f"InterfaceArea: the free energy of {self.body.label} {why}; between which values interfaces are it "
                "does not tell: give phases=(low, high)"
            )
        return None if found is None else (found.low, found.high)


@dataclass(config=settings, frozen=True, kw_only=True)
class PhaseVolume(Reading):
    """Probe: volume where the concentration or order parameter is above a value.

    Places of interfaces are found to a seventh of the distance of nodes.

    Parameters
    ----------
    body : CahnHilliard, MixtureSolid or AllenCahn
    above : float
    """

    body: Body
    above: Number

    def __call__(self, system: System) -> Any:
        c = coefficients(self.body, system)
        return phase_volume(self.body.space.cells(), c, self.above, self.body.grid.dimension)


@dataclass(config=settings, frozen=True, kw_only=True)
class PhaseEnergy(Reading):
    """Probe: energy of a mixture or order parameter.

    Parameters
    ----------
    body : CahnHilliard or AllenCahn
    part : {'all', 'chemical', 'gradient'}
    """

    body: CahnHilliard | AllenCahn
    part: Literal["all", "chemical", "gradient"] = "all"

    def __call__(self, system: System) -> Any:
        chemical, gradient = self.body.energies(system.x, system.time)
        return {"all": chemical + gradient, "chemical": chemical, "gradient": gradient}[self.part]


@dataclass(config=settings, frozen=True, kw_only=True)
class DomainSize(Reading):
    """Probe: wavelength of the phases, ``2 pi / <k>`` by the structure factor of a box.

    Parameters
    ----------
    body : CahnHilliard, MixtureSolid or AllenCahn
        On a rectangle or box along the axes, that goes on as its mirror image where it is not periodic. All waves of
        four and more nodes are counted.
    """

    body: Body

    def __post_init__(self) -> None:
        size, volume = np.ptp(self.body.grid.points, axis=0), self.body.grid.volume
        box = float(np.prod(size[size > 0]))
        if abs(volume - box) > 1e-6 * box:
            raise InputError(
                f"DomainSize: {self.body.label} fills {volume:.6g} of {box:.6g} between its ends along the axes; "
                "waves are counted in boxes along the axes alone"
            )

    def __call__(self, system: System) -> Any:
        X = self.body.grid.points
        ends = [X[self.body.grid.nodes(pair[0])] for pair in self.body.periodic]
        periodic = [
            any(np.ptp(end[:, i]) < 1e-6 * size for end in ends) for i, size in enumerate(np.ptp(X, axis=0))
        ]
        c = coefficients(self.body, system)
        return domain_size(self.body.space.cells(), c, np.ptp(X, axis=0), self.body.space.spacings, periodic)
