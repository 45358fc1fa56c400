"""Maxwell branches: what a spring behind a dashpot adds to a material."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

import numpy as np
from pydantic.dataclasses import dataclass

from visviva import _core
from visviva.base.arguments import Unchanging, vector
from visviva.base.errors import InputError
from visviva.component.component import settings
from visviva.component.values import Number
from visviva.material.material import Kind, Material

REFUSED = (Kind.HOLZAPFEL, Kind.USER)


@dataclass(config=settings, kw_only=True)
class Shift(Unchanging):
    """Base of how times of relaxation depend on the temperature."""

    @abstractmethod
    def parameters(self) -> list[float]:
        """Of the core: kind, c1, c2, reference; see ``visviva/point/heated_branch.hpp``."""


@dataclass(config=settings, kw_only=True)
class WLF(Shift):
    """Times times ``a`` with ``log10 a = -c1 (T - reference) / (c2 + T - reference)`` (Williams, Landel & Ferry 1955).

    Parameters
    ----------
    c1, c2 : float
        The second is a difference of temperatures. Where ``T < reference - c2`` nothing relaxes.
    reference : float
        Absolute temperature at which times are as given.

    Examples
    --------
    >>> import visviva as vv
    >>> vv.MaxwellBranch(time=1.0, shift=vv.WLF(reference=293.15)).shift.c1
    17.44
    """

    reference: Number
    c1: Number = 17.44
    c2: Number = 51.6

    def __post_init__(self) -> None:
        refuse_not_positive(self, "reference", "c1", "c2")

    def parameters(self) -> list[float]:
        return [1.0, float(np.log(10) * self.c1), self.c2, self.reference]


@dataclass(config=settings, kw_only=True)
class Arrhenius(Shift):
    """Times times ``a`` with ``ln a = energy / gas_constant (1 / T - 1 / reference)``.

    Parameters
    ----------
    energy : float
        Of activation, by the amount of substance.
    reference : float
        Absolute temperature at which times are as given.
    gas_constant : float
        In the units of the model.

    Examples
    --------
    >>> import visviva as vv
    >>> vv.Arrhenius(energy=80e3, reference=300.0).parameters()[0]
    2.0
    """

    energy: Number
    reference: Number
    gas_constant: Number = 8.31446261815324

    def __post_init__(self) -> None:
        refuse_not_positive(self, "energy", "reference", "gas_constant")

    def parameters(self) -> list[float]:
        return [2.0, self.energy / self.gas_constant, 1.0, self.reference]


class Branch(Unchanging):
    """Base of what relaxes beside a material."""


@dataclass(config=settings, kw_only=True)
class MaxwellBranch(Branch):
    """A spring and a dashpot in series, beside the material of a `ViscoelasticSolid` or `ThermoviscoelasticSolid`.

    The spring stores ``share W(Ce)`` with the elastic strain ``Ce = Fv^-T C Fv^-1`` made isochoric; the dashpot follows
    the deviator of the branch's Kirchhoff stress, with ``det Fv = 1`` (Reese & Govindjee 1998).

    Parameters
    ----------
    time : float
        Of relaxation, for small strains: viscosity by shear modulus of the branch.
    share : float
        By which the spring's energy is multiplied.
    spring : Material, optional
        Whose energy; by default that of the solid. Isotropic, of finite strains; its volumetric part counts nothing.
    shift : WLF or Arrhenius, optional
        How `time` depends on the temperature, of solids that have one.

    Examples
    --------
    >>> import visviva as vv
    >>> vv.MaxwellBranch(time=1.5, share=2.0).share
    2.0
    """

    time: Number
    share: Number = 1.0
    spring: Material | None = None
    shift: Shift | None = None

    def __post_init__(self) -> None:
        refuse_not_positive(self, "time", "share")

    def parameters(self, label: str, material: Material) -> list[float]:
        """Of the core beside a solid's `material`, see ``visviva/point/branch.hpp``.

        Raises
        ------
        InputError
            If the spring is no isotropic material of finite strains.
        """
        spring = self.spring or material
        if spring.small or spring.kind in REFUSED:
            raise InputError(
                f"{label}: a MaxwellBranch has no spring of {type(spring).__name__}; give spring=vv.NeoHooke(...) or "
                "another isotropic material of finite strains"
            )
        own = list(spring.constants())
        place = _core.bulk_place(int(spring.kind))
        if place >= 0 and not np.isfinite(own[place]):
            own[place] = 0.0
        viscosity = self.share * spring.lame[1] * self.time
        rest = [0.0] * (_core.MATERIAL_PARAMETERS - len(own))
        return [float(int(spring.kind)), self.share, 2 / viscosity, *own, *rest]

    def heated_parameters(self, label: str, material: Material) -> list[float]:
        """Of the core where the branch heats, see ``visviva/point/heated_branch.hpp``."""
        shift = [0.0, 0.0, 1.0, 1.0] if self.shift is None else self.shift.parameters()
        return [*self.parameters(label, material), *shift]


def refuse_not_positive(given: object, *names: str) -> None:
    """Refuse arguments that are not positive.

    Raises
    ------
    InputError
    """
    for name in names:
        if not getattr(given, name) > 0:
            raise InputError(f"{type(given).__name__}: {name} = {getattr(given, name):g} is not positive")


def prony(
    fractions: Sequence[float], times: Sequence[float], shift: Shift | None = None
) -> tuple[MaxwellBranch, ...]:
    """Branches of a Prony series ``G(t) / G(0) = 1 - sum g_i (1 - exp(-t / t_i))``.

    Parameters
    ----------
    fractions : sequence of float
        ``g_i``, of the instantaneous shear modulus; positive, their sum less than one. The solid's material is that of
        long times.
    times : sequence of float
        ``t_i``, positive.
    shift : WLF or Arrhenius, optional
        Of all branches.

    Returns
    -------
    tuple of MaxwellBranch

    Raises
    ------
    InputError

    Examples
    --------
    >>> import visviva as vv
    >>> [branch.share for branch in vv.prony((0.5, 0.25), (0.1, 10.0))]
    [2.0, 1.0]
    """
    g, t = vector("prony", "fractions", fractions, None), vector("prony", "times", times, None)
    if g.shape != t.shape:
        raise InputError(f"prony: {g.size} fractions and {t.size} times; give one time for each fraction")
    if not (np.all(g > 0) and np.all(t > 0)):
        raise InputError(f"prony: fractions {g.tolist()} and times {t.tolist()} must all be positive")
    if not g.sum() < 1:
        raise InputError(
            f"prony: the fractions' sum {g.sum():g} leaves nothing for long times; it must be below 1"
        )
    left = 1 - g.sum()
    shares = (g / left).tolist()
    return tuple(MaxwellBranch(time=b, share=a, shift=shift) for a, b in zip(shares, t.tolist(), strict=True))
