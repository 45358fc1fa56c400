"""Linear elasticity and the materials that extend it to finite strains."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from pydantic.dataclasses import dataclass

from visviva.component.component import settings
from visviva.material.material import OF_BLATZ_KO, VOLUMETRIC, Elastic, Kind, Split, Volumetric


@dataclass(config=settings, kw_only=True)
class LinearElastic(Elastic):
    """Hooke's law for small strains and rotations: ``W = lambda/2 (tr e)^2 + mu e:e`` of ``e = sym(F) - I``.

    Not frame-indifferent: for parts that turn, take `SaintVenantKirchhoff`.

    Parameters
    ----------
    young, poisson, shear, bulk, lame_lambda : float
        Two of them: Young's modulus, Poisson's ratio, shear modulus, bulk modulus, Lame's first constant, for small
        strains (force per area). ``poisson = 0.5`` is for solids of ``formulation="mixed"``.

    Examples
    --------
    >>> LinearElastic(young=2.5, poisson=0.25).lame
    (1.0, 1.0)
    """

    kind: ClassVar[Kind] = Kind.HOOKE
    small: ClassVar[bool] = True

    def constants(self) -> list[float]:
        return list(self.lame)


@dataclass(config=settings, kw_only=True)
class SaintVenantKirchhoff(Elastic):
    """``W = lambda/2 (tr E)^2 + mu E:E`` of Green's strain ``E = (C - I)/2``: large rotations, small strains.

    Parameters
    ----------
    young, poisson, shear, bulk, lame_lambda : float
        Two of them: Young's modulus, Poisson's ratio, shear modulus, bulk modulus, Lame's first constant, for small
        strains (force per area). ``poisson = 0.5`` is for solids of ``formulation="mixed"``.
    """

    kind: ClassVar[Kind] = Kind.HOOKE

    def constants(self) -> list[float]:
        return list(self.lame)


@dataclass(config=settings, kw_only=True)
class NeoHooke(Elastic):
    """Compressible neo-Hooke ``W = mu/2 (tr C - 3 - 2 ln J) + lambda U(J)``.

    Parameters
    ----------
    young, poisson, shear, bulk, lame_lambda : float
        Two of them: Young's modulus, Poisson's ratio, shear modulus, bulk modulus, Lame's first constant, for small
        strains (force per area). ``poisson = 0.5`` is for solids of ``formulation="mixed"``.
    volumetric : {'logarithmic', 'quadratic', 'simo'}
        ``U`` = ``ln^2 J / 2``, ``(J - 1)^2 / 2``, ``(J^2 - 1 - 2 ln J) / 4``.
    isochoric : bool
        The split form ``W = mu/2 (J^(-2/3) tr C - 3) + kappa U(J)`` with the bulk modulus ``kappa`` instead.

    Examples
    --------
    >>> NeoHooke(shear=1.0, bulk=2.0, isochoric=True).constants()
    [0.5, 0.0, 0.0, 0.0, 2.0, 0.0]
    """

    volumetric: Volumetric = "logarithmic"
    isochoric: bool = False

    @property
    def kind(self) -> Kind:  # type: ignore[override]
        return Kind.ISOCHORIC if self.isochoric else Kind.NEO_HOOKE

    def constants(self) -> list[float]:
        L, mu = self.lame
        U = VOLUMETRIC[self.volumetric]
        return [mu / 2, 0.0, 0.0, 0.0, self.bulk_modulus, U] if self.isochoric else [mu, L, U]


@dataclass(config=settings, kw_only=True)
class BlatzKo(Elastic):
    """``W = mu/2 (tr C - 3) + mu/beta (J^-beta - 1)`` with ``beta = 2 nu / (1 - 2 nu)`` (Blatz & Ko 1962).

    Parameters
    ----------
    young, poisson, shear, bulk, lame_lambda : float
        Two of them: Young's modulus, Poisson's ratio, shear modulus, bulk modulus, Lame's first constant, for small
        strains (force per area). ``poisson = 0.5`` is for solids of ``formulation="mixed"``.


    Raises
    ------
    InputError
        Also if Poisson's ratio is not positive.
    """

    kind: ClassVar[Kind] = Kind.BLATZ_KO

    def __post_init__(self) -> None:
        Elastic.__post_init__(self)
        if not self.lame[0] > 0:
            raise self.refuse(f"it needs a positive Poisson's ratio, lambda is {self.lame[0]:g}")

    def constants(self) -> list[float]:
        L, mu = self.lame
        return [mu, L / mu]  # 2 nu / (1 - 2 nu) = lambda / mu

    def split(self) -> Split:
        """``W = mu/2 (tr C - 3 - 2 ln J) + lambda U(J)`` with ``U = ((J^-beta - 1) / beta + ln J) / beta``."""
        L, mu = self.lame
        rigid = np.isinf(L)  # ln J then measures the volume as well as anything
        return Split(
            Kind.NEO_HOOKE, [mu, 0.0, 0.0, 0.0 if rigid else L / mu], None, L, 0 if rigid else OF_BLATZ_KO
        )
