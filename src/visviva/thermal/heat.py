"""Storage and conduction of heat in materials that deform."""

from __future__ import annotations

from abc import abstractmethod
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva import _core
from visviva.base.arguments import Unchanging
from visviva.base.errors import InputError
from visviva.body import formulation as forms
from visviva.body.solid_fields import FULL, components
from visviva.component.component import settings
from visviva.component.values import Function, Matrix, Number, positive_tensor
from visviva.material.material import Material
from visviva.material.user_material import UserMaterial
from visviva.mesh.geometry import determinant
from visviva.model.callback import Function as Derivatives
from visviva.thermal.capacity import Capacity, capacity_of
from visviva.thermal.legendre import Internal

Array = NDArray[np.float64]
Table = tuple[tuple[Number, Number], ...]
REST = np.array([[1.0], [1.0], [1.0], [0.0], [0.0], [0.0]])
HALVES = np.array([1.0, 1.0, 1.0, 0.5, 0.5, 0.5])
"""Of derivatives by one of two equal components."""


class HeatLaw(Unchanging):
    """Base of what tells how a material stores and conducts heat.

    Attributes
    ----------
    reference : float
        Absolute temperature at which entropies vanish without strain.
    """

    reference: Number

    def material(self, given: Material | None) -> Material:
        """Whose stiffness a body of this law has, if it was `given` one.

        Raises
        ------
        InputError
            If there is none, or one too many.
        """
        if given is None:
            raise InputError(f"{type(self).__name__} needs the material whose energy it heats; give material")
        return given

    def energy(self, scaled: int = 0) -> Derivatives | None:
        """Internal energy of C - I and entropy (7, n), if it is not one of the core.

        Where volumes change as the centre's, along `scaled` directions, of C - I, C0 - I there and entropy (13, n).
        """
        return None

    @abstractmethod
    def parameters(self, material: Material) -> list[float]:
        """Of the core, see ``visviva/point/thermoelastic.hpp``."""

    @abstractmethod
    def start_entropy(self, T: Array) -> Array:
        """Entropies (n,) per reference volume of temperatures (n,) without strain."""

    @abstractmethod
    def respond(self, material: Material, C: Array, s: Array) -> tuple[Array, Array, Array]:
        """Temperature (n,), second Piola-Kirchhoff stress (n, 6) and internal energy (n,).

        Parameters
        ----------
        C : array (n, 6)
            Right Cauchy-Green tensors by components 11, 22, 33, 12, 23, 31.
        s : array (n,)
            Entropy per reference volume.
        """


@dataclass(config=settings, kw_only=True)
class Heat(HeatLaw):
    """Storage and conduction of heat in a material that deforms.

    The free energy is
    ``W(C) (1 + moduli_slope (T - T0)) - 3 K expansion (T - T0) ln J + c (T - T0 - T ln(T / T0))`` with
    the material's energy W, its bulk modulus K and the reference T0; the last part is that of the capacity c where
    that depends on the temperature.

    Parameters
    ----------
    conductivity : float, or array (3,) or (3, 3)
        Isotropic, along the axes, or a symmetric tensor.
    capacity : float, or rows of temperature and capacity
        Heat per reference volume and temperature at constant strain. Between the rows of a table, six at most, it is
        linear, beyond its ends it stays.
    expansion : float
        Strain per temperature that heat alone would leave, at small changes.
    reference : float
        Absolute temperature T0 at which there is no stress without strain: a body that begins at another, in the
        shape of its mesh, begins with stress.
    moduli_slope : float
        Change of the moduli per temperature, as a share: ``1 / reference`` for the entropic elasticity of rubber.
    in_space : bool
        An isotropic conductivity is that of the deformed body (Fourier's law in space); else that of the reference.
    conductivity_slope, capacity_slope : float
        Their change per temperature, as a share of what they are at the reference.

    Examples
    --------
    >>> import visviva as vv
    >>> steel = vv.Heat(conductivity=50.0, capacity=7850.0 * 460, expansion=1.2e-5)
    >>> polymer = vv.Heat(conductivity=0.2, capacity=[(250.0, 1.4e6), (350.0, 2.0e6)])
    """

    conductivity: Number | Matrix
    capacity: Number | Table
    expansion: Number = 0.0
    reference: Number = 293.15
    moduli_slope: Number = 0.0
    in_space: bool = True
    conductivity_slope: Number = 0.0
    capacity_slope: Number = 0.0

    def __post_init__(self) -> None:
        if not self.reference > 0:
            raise InputError(f"Heat: reference = {self.reference:g} is not positive")
        self.stores: Capacity = capacity_of("Heat", self.capacity, self.capacity_slope, self.reference)
        self.tensor = positive_tensor("Heat", "the conductivity", self.conductivity)

    @property
    def is_isotropic(self) -> bool:
        """Whether the conductivity is a number."""
        return np.ndim(self.conductivity) == 0

    def beyond_slopes(self, T: Array) -> str:
        """Say which of capacity, conductivity and moduli is not positive at some of these temperatures (n,)."""
        slopes = {"capacity": self.capacity_slope, "conductivity": self.conductivity_slope}
        for what, slope in {**slopes, "moduli": self.moduli_slope}.items():
            least = 1 + slope * (T - self.reference)
            if np.any(least <= 0):
                worst = float(T[np.argmin(least)])
                return f"{what}_slope = {slope:g} leaves nothing positive at a temperature of {worst:g}"
        return ""

    def coupling(self, material: Material) -> float:
        """Stress per temperature, 3 K expansion, of a material."""
        lam, mu = material.lame
        return 3 * (lam + 2 * mu / 3) * self.expansion if self.expansion else 0.0

    def coupling_number(self, material: Material, T: float) -> float:
        """By what share expansion stiffens a bar between walls that keeps its entropy, ``T (3 K expansion)^2 / (M c)``.

        M is the modulus ``lambda + 2 mu`` of the bar, c the capacity at the temperature T.
        """
        beta, (lam, mu) = self.coupling(material), material.lame
        return float(T * beta**2 / ((lam + 2 * mu) * self.stores.at(np.array([T]))[0])) if beta else 0.0

    def parameters(self, material: Material) -> list[float]:
        own = material.constants()
        heat = [float(int(material.kind)), self.stores.c, self.reference, self.coupling(material)]
        more = [
            float(self.in_space and self.is_isotropic),
            self.conductivity_slope,
            *self.stores.parameters(),
        ]
        rest = [0.0] * (_core.MATERIAL_PARAMETERS - len(own))
        return [*heat, self.moduli_slope, *self.tensor, *more, *own, *rest]

    def start_entropy(self, T: Array) -> Array:
        return self.stores.entropy(T)

    def respond(self, material: Material, C: Array, s: Array) -> tuple[Array, Array, Array]:
        W, S, _ = material.respond(C)
        M = self._strain_entropy(material, C, W)
        T = self.stores.temperature(s - M)
        rise = T - self.reference
        inverse: Array = components(np.asarray(np.linalg.inv(C[:, FULL]), dtype=float))
        stress = (1 + self.moduli_slope * rise)[:, None] * S - (self.coupling(material) * rise)[
            :, None
        ] * inverse
        return T, stress, W + self.reference * M + self.stores.content(T)

    def _strain_entropy(self, material: Material, C: Array, W: Array) -> Array:
        """Entropy (n,) that the strain takes at one temperature."""
        log_j = 0.5 * np.log(determinant(C[:, FULL]))
        return np.asarray(self.coupling(material) * log_j - self.moduli_slope * W)


@dataclass(config=settings, kw_only=True)
class UserHeat(HeatLaw):
    """A free energy of strain and temperature by a Python function; it stands for material and heat together.

    Stress, entropy, capacity, their coupling and all tangents follow from it.

    Parameters
    ----------
    function : callable
        Maps ``C`` as an array (6, n), rows 11, 22, 33, 12, 23, 31, and absolute temperatures (n,) to free energies
        (n,) per reference volume. Written with numpy functions that take complex numbers.
    conductivity, reference, in_space
        As for `Heat`.

    Examples
    --------
    >>> import numpy as np
    >>> import visviva as vv
    >>> def rubber(C, T):
    ...     J2 = (C[0] * (C[1] * C[2] - C[4]**2) - C[3] * (C[3] * C[2] - C[4] * C[5])
    ...           + C[5] * (C[3] * C[4] - C[1] * C[5]))
    ...     W = 0.5 * (C[0] + C[1] + C[2] - 3 - np.log(J2)) + 0.5 * np.log(J2) ** 2
    ...     return W * T / 300 - 0.01 * (T - 300) * np.log(J2) + 2.0 * (T - 300 - T * np.log(T / 300))
    >>> heat = vv.UserHeat(function=rubber, conductivity=0.1, reference=300.0)
    >>> mesh = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1))
    >>> block = vv.ThermoelasticSolid(mesh=mesh, heat=heat, temperature=320.0)
    """

    function: Function
    conductivity: Number | Matrix
    reference: Number = 293.15
    in_space: bool = True

    def __post_init__(self) -> None:
        if not self.reference > 0:
            raise InputError(f"UserHeat: reference = {self.reference:g} is not positive")
        self.tensor = positive_tensor("UserHeat", "the conductivity", self.conductivity)
        self._internal = Internal(self.function, 6, self.reference, "UserHeat", REST[:, 0])
        self._capacity = float(self._internal.capacity(REST, np.array([self.reference]))[0])
        if not self._capacity > 0:
            raise InputError(
                f"UserHeat: the heat capacity -T d2psi/dT2 of its function is {self._capacity:g} at rest and the "
                "reference temperature, which is not positive"
            )

    @cached_property
    def _elastic(self) -> UserMaterial:
        return UserMaterial(function=lambda C: self.function(C, np.full(C.shape[1], self.reference)))

    def material(self, given: Material | None) -> Material:
        if given is not None:
            raise InputError("UserHeat holds the energy of the material too; leave out material")
        return self._elastic

    def energy(self, scaled: int = 0) -> Derivatives:
        if not scaled:
            return self._internal.energy()

        def free(C: Array, T: Array) -> Array:
            return np.asarray(forms.scaled(lambda bar: self.function(bar, T), scaled)(C))

        return Internal(free, 12, self.reference, "UserHeat", np.tile(REST[:, 0], 2)).energy()

    def parameters(self, material: Material) -> list[float]:
        spatial = float(self.in_space and np.ndim(self.conductivity) == 0)
        more = [spatial, 0.0, *capacity_of("UserHeat", 1.0, 0.0, self.reference).parameters()]
        rest = [0.0] * _core.MATERIAL_PARAMETERS
        return [float(int(material.kind)), 1.0, self.reference, 0.0, 0.0, *self.tensor, *more, *rest]

    def start_entropy(self, T: Array) -> Array:
        return self._internal.entropy(np.repeat(REST, len(T), axis=1), T)

    def respond(self, material: Material, C: Array, s: Array) -> tuple[Array, Array, Array]:
        W = self.energy()
        e = np.vstack([C.T - REST, s])
        g = W.gradient(e)[0]
        return g[6], 2 * (HALVES[:, None] * g[:6]).T, W.value(e)[0]
