"""How materials that deform store and conduct heat."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva import _core
from visviva.base.arguments import Validated
from visviva.base.errors import InputError
from visviva.body.solid_fields import FULL, components
from visviva.component.component import settings
from visviva.component.values import Matrix, Number
from visviva.material.material import Material
from visviva.mesh.geometry import determinant
from visviva.thermal.thermal_body import conductivities

Array = NDArray[np.float64]


class HeatLaw(metaclass=Validated):
    """Base of what tells how a material stores and conducts heat."""


@dataclass(config=settings, kw_only=True)
class Heat(HeatLaw):
    """How a material that deforms stores and conducts heat.

    The free energy is
    ``W(C) (1 + moduli_slope (T - T0)) - 3 K expansion (T - T0) ln J + c (T - T0 - T ln(T / T0))`` with
    the material's energy W, its bulk modulus K and the reference T0.

    Parameters
    ----------
    conductivity : float, or array (3,) or (3, 3)
        Isotropic, along the axes, or a symmetric tensor.
    capacity : float
        Heat per reference volume and temperature at constant strain.
    expansion : float
        Strain per temperature that heat alone would leave, at small changes.
    reference : float
        Absolute temperature T0 at which there is no stress without strain.
    moduli_slope : float
        Change of the moduli per temperature, as a share: ``1 / reference`` for the entropic elasticity of rubber.
    in_space : bool
        An isotropic conductivity is that of the deformed body (Fourier's law in space); else that of the reference.

    Examples
    --------
    >>> import visviva as vv
    >>> steel = vv.Heat(conductivity=50.0, capacity=7850.0 * 460, expansion=1.2e-5)
    """

    conductivity: Number | Matrix
    capacity: Number
    expansion: Number = 0.0
    reference: Number = 293.15
    moduli_slope: Number = 0.0
    in_space: bool = True

    def __post_init__(self) -> None:
        for name in ("capacity", "reference"):
            if not getattr(self, name) > 0:
                raise InputError(f"Heat: {name} = {getattr(self, name):g} is not positive")
        self.tensor = conductivities("Heat", self.conductivity)

    @property
    def is_isotropic(self) -> bool:
        """Whether the conductivity is a number."""
        return np.ndim(self.conductivity) == 0

    def coupling(self, material: Material) -> float:
        """Stress per temperature, 3 K expansion, of a material."""
        lam, mu = material.lame
        return 3 * (lam + 2 * mu / 3) * self.expansion if self.expansion else 0.0

    def parameters(self, material: Material) -> list[float]:
        """Of the core, see ``visviva/point/thermoelastic.hpp``."""
        own = material.constants()
        heat = [float(int(material.kind)), self.capacity, self.reference, self.coupling(material)]
        spatial = float(self.in_space and self.is_isotropic)
        rest = [0.0] * (_core.MATERIAL_PARAMETERS - len(own))
        return [*heat, self.moduli_slope, *self.tensor, spatial, *own, *rest]

    def respond(self, material: Material, C: Array, s: Array) -> tuple[Array, Array, Array]:
        """Temperature (n,), second Piola-Kirchhoff stress (n, 6) and internal energy (n,).

        Parameters
        ----------
        C : array (n, 6)
            Right Cauchy-Green tensors by components 11, 22, 33, 12, 23, 31.
        s : array (n,)
            Entropy per reference volume.
        """
        W, S, _ = material.respond(C)
        M, rise = self._rise(material, C, W, s)
        inverse: Array = components(np.asarray(np.linalg.inv(C[:, FULL]), dtype=float))
        stress = (1 + self.moduli_slope * rise)[:, None] * S - (self.coupling(material) * rise)[
            :, None
        ] * inverse
        return self.reference + rise, stress, W + self.reference * M + self.capacity * rise

    def _rise(self, material: Material, C: Array, W: Array, s: Array) -> tuple[Array, Array]:
        """Entropy (n,) that the strain takes at the reference temperature, and temperature (n,) less that."""
        log_j = 0.5 * np.log(determinant(C[:, FULL]))
        M = self.coupling(material) * log_j - self.moduli_slope * W
        return M, self.reference * np.expm1((s - M) / self.capacity)

    def temperature(self, material: Material, C: Array, s: Array) -> Array:
        """Temperature (n,) at Cauchy-Green tensors (n, 6) and entropies (n,)."""
        return self.reference + self._rise(material, C, material.respond(C)[0], s)[1]

    def entropy_gradient(self, material: Material, C: Array) -> Array:
        """Derivative (n, 3, 3) by C of the entropy that the strain takes at one temperature."""
        inverse = np.linalg.inv(C[:, FULL])
        S = material.respond(C)[1][:, FULL]
        return np.asarray(0.5 * (self.coupling(material) * inverse - self.moduli_slope * S))
