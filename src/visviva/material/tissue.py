"""Fibre-reinforced materials."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.component.component import settings
from visviva.component.values import Number, Vector3
from visviva.material.material import VOLUMETRIC, Kind, Material, Volumetric

Array = NDArray[np.float64]


@dataclass(config=settings, kw_only=True)
class HolzapfelGasserOgden(Material):
    """Two families of fibres in a neo-Hookean ground substance (Gasser, Ogden & Holzapfel 2006).

    ``W = mu/2 (I1 - 3) + k1/(2 k2) sum_f (exp(k2 <E_f>^2) - 1) + bulk U(J)`` with
    ``E_f = kappa (I1 - 3) + (1 - 3 kappa) (a_f.C a_f - 1)``, all invariants isochoric, fibres in tension only.

    Parameters
    ----------
    shear, k1, k2, bulk : float
        Shear modulus of the ground substance, stiffness and nonlinearity of the fibres, bulk modulus.
    dispersion : float
        ``kappa``, 0 (aligned) to 1/3 (isotropic).
    fibres : two directions (3,)
        In the reference configuration; normalised. Equal directions make one family twice as stiff.
    volumetric : {'logarithmic', 'quadratic', 'simo'}
        ``U`` = ``ln^2 J / 2``, ``(J - 1)^2 / 2``, ``(J^2 - 1 - 2 ln J) / 4``.
    """

    shear: Number
    k1: Number
    k2: Number
    bulk: Number
    fibres: tuple[Vector3, Vector3]
    dispersion: Number = 0.0
    volumetric: Volumetric = "simo"
    kind: ClassVar[Kind] = Kind.HOLZAPFEL

    def __post_init__(self) -> None:
        self.positive("shear", "k1", "k2", "bulk")
        if not 0 <= self.dispersion <= 1 / 3:
            raise self.refuse(f"dispersion = {self.dispersion:g} is outside 0 ... 1/3")
        if any(np.linalg.norm(a) == 0 for a in self.fibres):
            raise self.refuse("a fibre has no direction: (0, 0, 0)")

    def constants(self) -> list[float]:
        U = VOLUMETRIC[self.volumetric]
        tensors = [x for a in self.fibres for x in structure(a)]
        return [self.shear, self.k1, self.k2, self.dispersion, self.bulk, U, *tensors]

    @property
    def lame(self) -> tuple[float, float]:
        return self.bulk - 2 / 3 * self.shear, self.shear


def structure(direction: Any) -> list[float]:
    """Structure tensor ``a x a`` of a direction as (11, 22, 33, 12, 23, 31)."""
    a = np.asarray(direction, dtype=float) / np.linalg.norm(direction)
    return [float(a[i] * a[j]) for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))]
