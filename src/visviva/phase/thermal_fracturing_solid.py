"""Solids that crack and conduct heat."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva import _core
from visviva.base.errors import InputError
from visviva.body.stressed_cells import StressedCells
from visviva.component.component import settings
from visviva.component.values import Number
from visviva.model.points import Group, PhysicsKind, add_points
from visviva.phase.crack_law import IDENTITY
from visviva.phase.fracturing_solid import FracturingSolid
from visviva.thermal.heat import Heat
from visviva.thermal.thermoelastic_checks import refuse_heat
from visviva.thermal.thermoelastic_solid import ThermoelasticSolid

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
CONDUCTING = {
    PhysicsKind.FRACTURE: PhysicsKind.CONDUCTING_FRACTURE,
    PhysicsKind.FRACTURE_IN_PLANE: PhysicsKind.CONDUCTING_FRACTURE_IN_PLANE,
    PhysicsKind.FRACTURE_OF_REVOLUTION: PhysicsKind.CONDUCTING_FRACTURE_OF_REVOLUTION,
}
"""The same with entropies and temperatures."""
DOUBLE = np.array([1.0, 1, 1, 2, 2, 2])
TOLD = 1e-3
"""Even damage by the start's temperatures from which on it is told."""


@dataclass(config=settings, eq=False, kw_only=True)
class ThermalFracturingSolid(FracturingSolid, ThermoelasticSolid):
    """A solid that cracks and conducts heat: its nodes have damages, entropies and temperatures beside positions.

    Takes the arguments of `FracturingSolid` without ``free_strain`` and ``irreversibility="history"``, those of
    `ThermoelasticSolid`, in the plane too, and

    Parameters
    ----------
    cracked_conductivity : float
        Share of the conductivity that full damage leaves; in between it falls with the square of what is sound.

    Notes
    -----
    The internal energy is ``(1 + e)^3 (g(d) W+(C / (1 + e)^2) + W-(C / (1 + e)^2))`` with the energy of cracks and the
    heat content of ``t``, where ``e = expansion (t - reference)`` and t is the temperature that the entropy has without
    strain. So free expansion drives no crack. The moduli are those at constant entropy, which exceed those at constant
    temperature by the share ``T (3 K expansion)^2 / (M c)``, a hundredth and less of ceramics and metals; the
    temperature ``T = d energy / d entropy`` is t with the heat of straining. Entropy is balanced as in
    `ThermoelasticSolid`: with the energy-momentum scheme kinetic, elastic and crack energy and heat are together kept
    to round-off, while damage never shrinks and entropy never falls. Moduli and toughness do not depend on the
    temperature.

    Examples
    --------
    >>> import visviva as vv
    >>> alumina = vv.SaintVenantKirchhoff(young=340e9, poisson=0.22)
    >>> plate = vv.ThermalFracturingSolid(
    ...     mesh=vv.RectangleMesh(size=(0.01, 0.01), counts=(10, 10)),
    ...     material=alumina,
    ...     heat=vv.Heat(conductivity=20.0, capacity=3.5e6, expansion=8e-6, reference=600.0),
    ...     toughness=42.0,
    ...     length=2e-3,
    ...     density=3900.0,
    ...     temperature=600.0,
    ... )
    >>> cold = vv.PrescribedTemperature(body=plate, nodes="y0", value=300.0)
    >>> system = vv.System([plate, cold])
    >>> result = vv.simulate(system, until=1e-7, step=1e-8)  # what is cold from the start on is damaged then
    >>> round(float(plate.damages(result.states[0]).max()), 2), result.conservation()["energy"] < 1e-10
    (1.03, True)
    """

    cracked_conductivity: Number = 1.0
    _other_way: ClassVar[str] = ""

    def _refuse_others(self) -> None:
        FracturingSolid._refuse_others(self)
        if self.free_strain is not None:
            raise InputError(
                f"{self.label}: takes no free_strain; heat strains it, by vv.Heat(expansion=...)"
            )
        if self.irreversibility != "active set":
            raise InputError(
                f"{self.label}: irreversibility = 'history' knows no heat yet; take 'active set'"
            )
        if self.lumped:
            raise InputError(f"{self.label}: takes no lumped masses")
        if not 0 < self.cracked_conductivity <= 1:
            raise InputError(
                f"{self.label}: cracked_conductivity = {self.cracked_conductivity:g} is no share from above 0, where "
                "cracked nodes have no temperature, to 1"
            )
        if self._own_heat.moduli_slope:
            raise InputError(
                f"{self.label}: moduli_slope = {self._own_heat.moduli_slope:g}: moduli of what cracks do not change "
                "with the temperature yet; leave it 0"
            )
        refuse_heat(self, self._own_heat)

    @property
    def _own_heat(self) -> Heat:
        if not isinstance(self.heat, Heat):
            raise InputError(f"{self.label}: {type(self.heat).__name__} does not crack yet; take vv.Heat")
        return self.heat

    def remarks(self) -> list[str]:
        return [
            *FracturingSolid.remarks(self),
            *ThermoelasticSolid.remarks(self),
            *self._strained_at_the_start(),
        ]

    def _strained_at_the_start(self) -> list[str]:
        """A remark on the damage by free strains that all of it has before anything moves."""
        heat, T = self._own_heat, self.start_temperatures
        nearest = float(np.clip(heat.reference, T.min(), T.max()))
        stretch = 1 + heat.expansion * (nearest - heat.reference)
        d = float(self.law.even_damage(IDENTITY[None] / stretch**2, stretch**3)[0])
        if d <= TOLD:
            return []
        return [
            f"{self.label}: is at {nearest:.6g} K or farther from the reference {heat.reference:.6g} K of its heat, "
            f"where it is free of stress, and nothing has moved yet: that damages it by {d:.2g} all over; give "
            "vv.Heat(reference=...) the temperature at which it is free of stress"
        ]

    # --- what it contributes -------------------------------------------------------------------------------
    def contribute(self, model: Model) -> None:
        ThermoelasticSolid.contribute(self, model)

    def _add_cells(
        self, model: Model, kind: PhysicsKind, groups: list[Group], at: StressedCells, scalar: Array
    ) -> None:
        heat = self._own_heat.parameters(self.body_material)[: -_core.MATERIAL_PARAMETERS]
        heat[3:5] = self._own_heat.expansion, self.cracked_conductivity  # see point/heated_fracture.hpp
        for field in (self.entropy, self.algorithmic):
            groups.append(Group(field.start + self._number[at.nodes], scalar))
        parameters = [*heat, *self.law.parameters()]
        self._conducts.append(add_points(model, self, CONDUCTING[kind], groups, at.volume, parameters))

    def _unstrained(self, x: Array, of: Ints, N: Array) -> Array:
        """Temperatures (m, q) that the entropies of nodes (m, k) have without strain."""
        return self._own_heat.stores.temperature(self._entropies(x)[of] @ N.T)

    def _stretches(self, x: Array, of: Ints, N: Array) -> Array:
        heat = self._own_heat
        return 1 + heat.expansion * (self._unstrained(x, of, N) - heat.reference)

    # --- what it shows -------------------------------------------------------------------------------------
    def _temperatures_at(self, x: Array, part: StressedCells) -> Array:
        heat, (_, C) = self._own_heat, part.strains(x)
        S, W = part.respond(x, part.nodes, C)
        t, stretch = self._unstrained(x, part.nodes, part.N), self._stretches(x, part.nodes, part.N)
        by_stretch = (3 * W - (S * C) @ DOUBLE) / stretch
        return np.asarray(t * (1 + heat.expansion * by_stretch / heat.stores.at(t)))
