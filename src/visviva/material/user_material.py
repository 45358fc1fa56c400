"""A material by a Python function."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError, RunError
from visviva.component.component import settings
from visviva.component.values import Function
from visviva.material.material import VOLUMETRIC, Kind, Material, Split, Volumetric

Array = NDArray[np.float64]


@dataclass(config=settings, kw_only=True)
class UserMaterial(Material):
    """A material given by its energy alone.

    Parameters
    ----------
    function : callable
        Maps ``C`` as an array (6, n), rows 11, 22, 33, 12, 23, 31, to energies (n,) per reference volume. Written
        with numpy functions that take complex numbers, first derivatives are exact to round-off.
    bulk : float
        Modulus of a volumetric energy ``bulk U(J)`` beside the function, infinite for incompressible materials. With
        formulation "mixed" it is what the pressures stand for; without it, that is ``lambda ln^2 J / 2`` with
        `lambda` of small strains, and the rest of the function stays as it is.
    volumetric : {'logarithmic', 'quadratic', 'simo'}
        ``U`` = ``ln^2 J / 2``, ``(J - 1)^2 / 2``, ``(J^2 - 1 - 2 ln J) / 4``.

    Raises
    ------
    InputError
        If the energy is not finite about rest, has another shape or a kink where its stress jumps. A stress at rest
        is warned of with its value: prestress is legal.

    Examples
    --------
    >>> import numpy as np
    >>> def neo_hooke(C):
    ...     J2 = (C[0] * (C[1] * C[2] - C[4]**2) - C[3] * (C[3] * C[2] - C[4] * C[5])
    ...           + C[5] * (C[3] * C[4] - C[1] * C[5]))
    ...     return 0.5 * (C[0] + C[1] + C[2] - 3 - np.log(J2)) + 0.125 * np.log(J2) ** 2
    >>> UserMaterial(function=neo_hooke).lame
    (1.0, 1.0)
    """

    function: Function
    bulk: float = 0.0
    volumetric: Volumetric = "logarithmic"
    kind: ClassVar[Kind] = Kind.USER

    def __post_init__(self) -> None:
        if not self.bulk >= 0:
            raise self.refuse(f"bulk = {self.bulk:g} is not positive")
        try:
            examine(self.function)
        except RunError as error:
            raise InputError(str(error)) from error

    def constants(self) -> list[float]:
        return [0.0]

    def respond(self, C: Array) -> tuple[Array, Array, Array]:
        from visviva.model.callback import Function as Derivatives

        e = np.ascontiguousarray(np.asarray(C, dtype=float).T)
        W = Derivatives(self.energy, 6, 1, "UserMaterial")
        share = np.array([1.0, 1.0, 1.0, 0.5, 0.5, 0.5])  # of a derivative by one of two equal components
        S = 2 * share[:, None] * W.gradient(e)[0]
        D = 4 * np.outer(share, share)[:, :, None] * W.hessian(e)[0]
        return W.value(e)[0], S.T, D.transpose(2, 0, 1)

    @property
    def energy(self) -> Callable[[Any], Any]:
        return with_volume(self.function, self.bulk, self.volumetric) if self.bulk else self.function

    def split(self) -> Split:
        if self.bulk:
            return Split(self.kind, [0.0], self.function, self.bulk, int(VOLUMETRIC[self.volumetric]))
        bulk = self.lame[0]
        return Split(self.kind, [0.0], with_volume(self.function, -bulk, "logarithmic"), bulk, 0)

    @property
    def lame(self) -> tuple[float, float]:
        """Mean constants of small strains, from second derivatives at rest."""
        from visviva.model.callback import Function as Derivatives

        rest = np.array([[1.0], [1.0], [1.0], [0.0], [0.0], [0.0]])
        H = 4 * Derivatives(self.function, 6, 1, "UserMaterial").hessian(rest)[0, :, :, 0]
        lam = (H[0, 1] + H[1, 2] + H[2, 0]) / 3
        mu = ((H[0, 0] + H[1, 1] + H[2, 2]) / 3 - lam) / 2
        return round(float(lam), 9) + self.bulk, round(float(mu), 9)


def log_of_volume(C: Any) -> Any:
    """``ln J`` of right Cauchy-Green tensors (6, n)."""
    det = C[0] * (C[1] * C[2] - C[4] ** 2) - C[3] * (C[3] * C[2] - C[4] * C[5])
    return 0.5 * np.log(det + C[5] * (C[3] * C[4] - C[1] * C[5]))


ENERGY: dict[Volumetric, Callable[[Any], Any]] = {
    "logarithmic": lambda L: 0.5 * L * L,
    "quadratic": lambda L: 0.5 * np.expm1(L) ** 2,
    "simo": lambda L: 0.25 * (np.expm1(2 * L) - 2 * L),
}
"""Volumetric energies per modulus, of ``L = ln J``."""


def with_volume(function: Callable[[Any], Any], bulk: float, kind: Volumetric) -> Callable[[Any], Any]:
    """The energy ``function(C) + bulk U(J)``."""
    U = ENERGY[kind]
    return lambda C: np.asarray(function(C)).reshape(-1) + bulk * U(log_of_volume(C))


PATHS = {"uniaxial": (1, 0, 0, 0, 0, 0), "volumetric": (1, 1, 1, 0, 0, 0), "shear": (0, 0, 0, 1, 0, 0)}
"""Directions in C along which an energy is tried."""
REACH = 0.3
"""Distance from rest, in C."""


def examine(function: Callable[[Any], Any]) -> None:
    """Try an energy at rest and along some paths from it.

    Raises
    ------
    RunError
        If it raises, has another shape, is not finite at rest, has a kink or hinges on other points.
    """
    from visviva.model.callback import Function as Derivatives

    W = Derivatives(function, 6, 1, "UserMaterial, its energy")
    rest = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    W.value(rest[:, None])
    for name, path in PATHS.items():
        refuse_kink(W, name, rest, np.array(path, dtype=float))
    away = np.array(list(PATHS.values()), dtype=float).T
    refuse_hinged(W, rest[:, None] + np.hstack([0.1 * REACH * away, 0.9 * REACH * away, -0.9 * REACH * away]))
    stress = 2 * W.gradient(rest[:, None])[0, :, 0] * [1, 1, 1, 0.5, 0.5, 0.5]
    stiffness = 4 * np.abs(W.hessian(rest[:, None])).max()
    if np.abs(stress).max() > 1e-7 * stiffness:
        warnings.warn(
            f"UserMaterial: its stress at rest is {stress.round(9).tolist()} (11, 22, 33, 12, 23, 31), not zero; a "
            "body of it is prestressed. If that is not meant, add terms to the energy that take it away",
            stacklevel=2,
        )


def refuse_hinged(W: Any, C: Array) -> None:
    """Refuse values at some C (6, n) that are others where these are alone: each process asks for its own points."""
    with np.errstate(all="ignore"):
        together = np.real(W.raw(C)[0]).astype(float)
        alone = np.array([np.real(W.raw(c[:, None])[0]).astype(float)[0] for c in C.T])
    known = np.isfinite(together) & np.isfinite(alone)  # the energy need not be defined everywhere
    apart = np.abs(np.subtract(together, alone, where=known, out=np.zeros(len(alone))))
    if apart.max() > 1e-6 * np.abs(together[known]).max(initial=0.0):
        k = int(apart.argmax())
        raise RunError(
            f"UserMaterial, its energy: at C = {C[:, k].round(6).tolist()} it is {together[k]:g} among other points "
            f"and {alone[k]:g} alone; let it hinge on the C of its own point, not on their number or largest"
        )


def refuse_kink(W: Any, name: str, rest: Array, path: Array) -> None:
    """Refuse a jump of the slope of `W` along a path: second differences that do not shrink with their distance."""
    s = np.linspace(-REACH, REACH, 62)  # rest is between two points, a kink there as well
    centre, least = 0.0, np.inf
    for _ in range(4):
        with np.errstate(all="ignore"):
            f = np.real(W.raw(rest[:, None] + path[:, None] * s)[0]).astype(float)
        if not np.isfinite(f).all():
            return  # not defined so far from rest
        distance = s[1] - s[0]
        jumps = np.abs(f[2:] - 2 * f[1:-1] + f[:-2]) / distance
        worst = int(np.argmax(jumps))
        slope = np.abs(np.diff(f) / distance).max()
        if jumps[worst] <= max(
            0.3 * least if least < np.inf else 0.0, 1e-6 * slope, 1e-9 * np.abs(f).max() / distance
        ):
            return
        centre, least = float(s[worst + 1]), float(jumps[worst])
        s = np.linspace(centre - 2 * distance, centre + 2 * distance, 62)
    raise RunError(
        f"UserMaterial, its energy: it has a kink near C = {(rest + centre * path).round(6).tolist()} ({name}), where "
        f"its slope along the path jumps by about {least:.2g}; Newton's method needs a continuous stress: round it off"
    )
