"""Rubber-like materials."""

from __future__ import annotations

from typing import ClassVar

from pydantic.dataclasses import dataclass

from visviva.component.component import settings
from visviva.component.values import Number
from visviva.material.material import VOLUMETRIC, Elastic, Kind, Material, Volumetric


@dataclass(config=settings, kw_only=True)
class MooneyRivlin(Material):
    """Mooney-Rivlin, compressible or split.

    ``W = c10 (I1 - 3) + c01 (I2 - 3) - (2 c10 + 4 c01) ln J + bulk U(J)``, or with `isochoric`
    ``W = c10 (J^(-2/3) I1 - 3) + c01 (J^(-4/3) I2 - 3) + bulk U(J)``.

    Parameters
    ----------
    c10, c01, bulk : float
        Constants; the shear modulus of small strains is ``2 (c10 + c01)``, their bulk modulus is `bulk` with
        `isochoric`, else ``bulk + 4/3 c10 + 16/3 c01``.
    volumetric : {'logarithmic', 'quadratic', 'simo'}
        ``U`` = ``ln^2 J / 2``, ``(J - 1)^2 / 2``, ``(J^2 - 1 - 2 ln J) / 4``.
    isochoric : bool
        Take the form in which `bulk` alone resists changes of volume.

    Notes
    -----
    `bulk` is finite. For rubber that keeps its volume take `isochoric`, some 10^4 times the shear modulus for `bulk`,
    and ``Solid(formulation="mixed")``, which does not lock; the error is in proportion to shear modulus by `bulk`. Or
    give the function to `UserMaterial` with ``bulk=np.inf``.

    Examples
    --------
    A cube stretched to twice its length, beside ``2 (c10 + c01 / l) (l - 1 / l^2)`` of what is incompressible:

    >>> import visviva as vv
    >>> rubber = vv.MooneyRivlin(c10=1.0, c01=0.25, bulk=2.5e4, isochoric=True)
    >>> mesh = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1), cell="hex27")
    >>> cube = vv.Solid(mesh=mesh, material=rubber, formulation="mixed")
    >>> sides = ("x0", (1, 0, 0)), ("y0", (0, 1, 0)), ("z0", (0, 0, 1))
    >>> held = [vv.SymmetryPlane(solid=cube, nodes=side, normal=normal) for side, normal in sides]
    >>> pull = vv.Prescribed(solid=cube, nodes="x1", motion=("t", None, None))
    >>> system = vv.System([cube, *held, pull])
    >>> _ = vv.quasi_static(system, until=1.0, step=0.25)
    >>> force = vv.SupportForce(solid=cube, nodes="x1")(system)[0]
    >>> f"{force / (2 * (1.0 + 0.25 / 2) * (2 - 1 / 4)) - 1:.1e}"
    '-8.1e-05'
    """

    c10: Number
    c01: Number
    bulk: Number
    volumetric: Volumetric = "quadratic"
    isochoric: bool = False

    def __post_init__(self) -> None:
        if not self.c10 + self.c01 > 0:
            raise self.refuse(f"c10 + c01 = {self.c10 + self.c01:g} is not positive: no stiffness in shear")
        if self.bulk < 0 or (self.isochoric and self.bulk == 0):
            raise self.refuse(f"bulk = {self.bulk:g} is not positive")

    @property
    def kind(self) -> Kind:  # type: ignore[override]
        return Kind.ISOCHORIC if self.isochoric else Kind.MOONEY

    def constants(self) -> list[float]:
        a, b, U = self.c10, self.c01, VOLUMETRIC[self.volumetric]
        return [a, 0.0, 0.0, b, self.bulk, U] if self.isochoric else [a, b, 2 * (a + 2 * b), self.bulk, U]

    @property
    def lame(self) -> tuple[float, float]:
        mu = 2 * (self.c10 + self.c01)
        if self.isochoric:
            return self.bulk - 2 / 3 * mu, mu
        return self.bulk + 4 * self.c01, mu


@dataclass(config=settings, kw_only=True)
class Yeoh(Material):
    """Yeoh: ``W = sum_k c_k (J^(-2/3) I1 - 3)^k + bulk U(J)``, k = 1, 2, 3.

    Parameters
    ----------
    c1, c2, c3 : float
        Constants (force per area); `c1`, half of the shear modulus of small strains, is positive.
    bulk : float
        Bulk modulus (force per area), positive.
    volumetric : {'logarithmic', 'quadratic', 'simo'}
        ``U`` = ``ln^2 J / 2``, ``(J - 1)^2 / 2``, ``(J^2 - 1 - 2 ln J) / 4``.
    """

    c1: Number
    c2: Number
    c3: Number
    bulk: Number
    volumetric: Volumetric = "simo"
    kind: ClassVar[Kind] = Kind.ISOCHORIC

    def __post_init__(self) -> None:
        self.positive("c1", "bulk")

    def constants(self) -> list[float]:
        return [self.c1, self.c2, self.c3, 0.0, self.bulk, VOLUMETRIC[self.volumetric]]

    @property
    def lame(self) -> tuple[float, float]:
        return self.bulk - 4 / 3 * self.c1, 2 * self.c1


@dataclass(config=settings, kw_only=True)
class Gent(Material):
    """Gent: ``W = -mu Jm/2 ln(1 - (J^(-2/3) I1 - 3)/Jm) + bulk U(J)`` with ``Jm = limit``.

    Parameters
    ----------
    shear : float
        Shear modulus of small strains, mu (force per area), positive.
    limit : float
        Jm, positive: the energy grows beyond all bounds where ``J^(-2/3) I1 - 3`` comes near to it.
    bulk : float
        Bulk modulus (force per area), positive.
    volumetric : {'logarithmic', 'quadratic', 'simo'}
        ``U`` = ``ln^2 J / 2``, ``(J - 1)^2 / 2``, ``(J^2 - 1 - 2 ln J) / 4``.
    """

    shear: Number
    limit: Number
    bulk: Number
    volumetric: Volumetric = "simo"
    kind: ClassVar[Kind] = Kind.GENT

    def __post_init__(self) -> None:
        self.positive("shear", "limit", "bulk")

    def constants(self) -> list[float]:
        return [self.shear, self.limit, self.bulk, VOLUMETRIC[self.volumetric]]

    @property
    def lame(self) -> tuple[float, float]:
        return self.bulk - 2 / 3 * self.shear, self.shear


@dataclass(config=settings, kw_only=True)
class Ogden(Material):
    """Ogden with up to three terms: ``W = sum_k mu_k/alpha_k (l1^alpha_k + l2^alpha_k + l3^alpha_k - 3) + bulk U(J)``.

    Parameters
    ----------
    mu, alpha : tuples of float
        The shear modulus of small strains is ``sum mu_k alpha_k / 2``.
    bulk : float
        Resistance against changes of volume (force per area); positive where `isochoric`, else not negative.
    volumetric : {'logarithmic', 'quadratic', 'simo'}
        ``U`` = ``ln^2 J / 2``, ``(J - 1)^2 / 2``, ``(J^2 - 1 - 2 ln J) / 4``.
    isochoric : bool
        Stretches ``l_i`` are divided by ``J^(1/3)``; if not, ``- sum mu_k ln J`` makes the rest stress-free, and the
        bulk modulus of small strains is `bulk` plus two thirds of the shear modulus.

    Examples
    --------
    >>> Ogden(mu=(1.0,), alpha=(2.0,), bulk=10.0).lame[1]
    1.0
    """

    mu: tuple[Number, ...]
    alpha: tuple[Number, ...]
    bulk: Number
    volumetric: Volumetric = "simo"
    isochoric: bool = True
    kind: ClassVar[Kind] = Kind.OGDEN

    def __post_init__(self) -> None:
        if not 1 <= len(self.mu) == len(self.alpha) <= 3:
            raise self.refuse(f"give one to three pairs, not mu = {self.mu}, alpha = {self.alpha}")
        if 0 in self.alpha:
            raise self.refuse(f"alpha = {self.alpha} must not be zero")
        if not self.lame[1] > 0:
            raise self.refuse(f"the shear modulus sum mu alpha / 2 = {self.lame[1]:g} is not positive")
        if self.bulk < 0 or (self.isochoric and self.bulk == 0):
            raise self.refuse(f"bulk = {self.bulk:g} is not positive")

    def constants(self) -> list[float]:
        pairs = [*zip(self.mu, self.alpha, strict=True), (0.0, 1.0), (0.0, 1.0)][:3]
        split = 1.0 if self.isochoric else 0.0
        return [self.bulk, VOLUMETRIC[self.volumetric], split, *(x for pair in pairs for x in pair)]

    @property
    def lame(self) -> tuple[float, float]:
        mu = sum(m * a for m, a in zip(self.mu, self.alpha, strict=True)) / 2
        return (self.bulk - 2 / 3 * mu if self.isochoric else self.bulk), mu


@dataclass(config=settings, kw_only=True)
class Hencky(Elastic):
    """Hencky: ``W = shear |dev ln U|^2 + bulk U(J)``, Hooke's law between logarithmic strain and Kirchhoff's stress.

    With the logarithmic volumetric energy ``bulk ln^2 J / 2`` it is quadratic in logarithms; at large stretches its
    nominal stress falls.

    Parameters
    ----------
    young, poisson, shear, bulk, lame_lambda : float
        Two of them: Young's modulus, Poisson's ratio, shear modulus, bulk modulus, Lame's first constant, for small
        strains (force per area). ``poisson = 0.5`` is for solids of ``formulation="mixed"``.
    volumetric : {'logarithmic', 'quadratic', 'simo'}
        ``U`` = ``ln^2 J / 2``, ``(J - 1)^2 / 2``, ``(J^2 - 1 - 2 ln J) / 4``.

    Examples
    --------
    >>> Hencky(shear=1.0, bulk=2.0).lame[1]
    1.0
    """

    volumetric: Volumetric = "logarithmic"
    kind: ClassVar[Kind] = Kind.HENCKY

    def constants(self) -> list[float]:
        return [self.bulk_modulus, VOLUMETRIC[self.volumetric], self.lame[1]]
