"""Base of materials: an energy of the strain, given to the core by its number and parameters."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva import _core
from visviva.base.arguments import Unchanging
from visviva.base.errors import InputError
from visviva.component.component import settings
from visviva.component.values import Number

Array = NDArray[np.float64]

Volumetric = Literal["logarithmic", "quadratic", "simo"]
"""Energy of the volume change per bulk stiffness: ``ln^2 J / 2``, ``(J - 1)^2 / 2``, ``(J^2 - 1 - 2 ln J) / 4``."""

VOLUMETRIC = {"logarithmic": 0.0, "quadratic": 1.0, "simo": 2.0}


PACKED = [[a * 6 - a * (a - 1) // 2 + b - a if a <= b else b * 6 - b * (b - 1) // 2 + a - b for b in range(6)]
          for a in range(6)]  # fmt: skip
"""Places of the entries of a symmetric matrix (6, 6) in its upper triangle by rows."""


Kind = _core.MaterialKind
"""The energies of the core (cpp/visviva/material/material_list.hpp)."""

TRACE, OF_BLATZ_KO = 3, 4
"""Numbers of the volumetric energies of linear materials, ``(tr e)^2 / 2``, and of Blatz and Ko's."""


class Split(NamedTuple):
    """A material in two: what no pressure carries, and the volumetric energy that pressures stand for.

    Parameters
    ----------
    kind, constants
        The rest in the core.
    energy : callable or None
        The rest, if it is a function of the user.
    bulk : float
        Modulus of the volumetric energy; infinite for incompressible materials.
    measure : int
        Its number in the core.
    """

    kind: Kind
    constants: list[float]
    energy: Callable[[Any], Any] | None
    bulk: float
    measure: int


@dataclass(config=settings, kw_only=True)
class Material(Unchanging):
    """Base of all materials; a material knows nothing of elements or time."""

    kind: ClassVar[Kind]
    small: ClassVar[bool] = False

    def parameters(self, n: int) -> Array:
        """Parameters of the energy for `n` elements, (n, n_par)."""
        return np.broadcast_to(np.array(self.constants(), dtype=float), (n, len(self.constants()))).copy()

    def constants(self) -> list[float]:
        """Parameters that all elements share."""
        raise NotImplementedError

    @property
    def lame(self) -> tuple[float, float]:
        """Lame's constants ``lambda, mu`` of small strains about rest."""
        raise NotImplementedError

    def split(self) -> Split:
        """The volumetric energy and the rest.

        Examples
        --------
        >>> import visviva as vv
        >>> vv.LinearElastic(young=3.0, poisson=0.5).split()[1:]
        ([0.0, 1.0], None, inf, 3)
        """
        rest, place = list(self.constants()), _core.bulk_place(int(self.kind))
        bulk, rest[place] = rest[place], 0.0
        measure = TRACE if self.kind is Kind.HOOKE else int(rest[place + 1])
        return Split(self.kind, rest, None, bulk, measure)

    def respond(self, C: Array) -> tuple[Array, Array, Array]:
        """Energy, stress and moduli at right Cauchy-Green tensors.

        Symmetric tensors are given by the components 11, 22, 33, 12, 23, 31.

        Parameters
        ----------
        C : array, (n, 6)
            For materials of small strains ``I + 2 e``.

        Returns
        -------
        energy : array, (n,)
            Per reference volume.
        stress : array, (n, 6)
            ``S = 2 dW/dC``, second Piola-Kirchhoff.
        moduli : array, (n, 6, 6)
            Tensor ``4 d2W/dC2``: in ``dS = moduli : dC / 2`` pairs off the diagonal count twice.

        Examples
        --------
        >>> import visviva as vv
        >>> W, S, D = vv.NeoHooke(shear=1.0, lame_lambda=1.0).respond(np.array([[1.0, 1.0, 1.0, 0.2, 0.0, 0.0]]))
        >>> S[0, :4].round(4).tolist()
        [-0.0629, -0.0629, -0.0204, 0.2126]
        """
        out = np.empty((len(C), 28))
        rest = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
        _core.material(
            int(self.kind), np.array(self.constants(), dtype=float), np.asarray(C, float) - rest, out
        )
        return out[:, 0], 2 * out[:, 1:7], 4 * out[:, 7:][:, PACKED]

    @property
    def energy(self) -> Callable[[Any], Any] | None:
        """A user's energy, if it is one."""
        return None

    def refuse(self, text: str) -> InputError:
        """An error with the material's name."""
        return InputError(f"{type(self).__name__}: {text}")

    def positive(self, *names: str) -> None:
        """Refuse parameters that are not positive."""
        for name in names:
            value = getattr(self, name)
            if not value > 0:
                raise self.refuse(f"{name} = {value:g} is not positive")


@dataclass(config=settings, kw_only=True)
class Elastic(Material):
    """Base of materials with two elastic constants: give any two of five.

    Parameters
    ----------
    young, poisson, shear, bulk, lame_lambda : float
        Young's modulus, Poisson's ratio, shear modulus, bulk modulus, Lame's first constant, for small strains.
        ``poisson = 0.5`` is for solids of ``formulation="mixed"``.
    Raises
    ------
    InputError
        For other than two of them, ratios beyond -1 ... 0.5, and shear or bulk moduli that are not positive.
    """

    young: Number | None = None
    poisson: Number | None = None
    shear: Number | None = None
    bulk: Number | None = None
    lame_lambda: Number | None = None

    def __post_init__(self) -> None:
        given = {
            n: getattr(self, n)
            for n in ("young", "poisson", "shear", "bulk", "lame_lambda")
            if getattr(self, n) is not None
        }
        if len(given) != 2:
            raise self.refuse(
                f"give exactly two of young, poisson, shear, bulk, lame_lambda; given are {sorted(given) or 'none'}"
            )
        nu = given.get("poisson")
        if nu is not None and not -1 < nu <= 0.5:
            raise self.refuse(f"poisson = {nu:g} is outside -1 ... 0.5")
        self._lame = two_constants(given)
        if not (self._lame[1] > 0 and self._lame[0] + 2 / 3 * self._lame[1] > 0):
            raise self.refuse(
                f"shear modulus {self._lame[1]:g} and bulk modulus {self._lame[0] + 2 / 3 * self._lame[1]:g} that "
                f"follow from {given} must be positive"
            )

    @property
    def lame(self) -> tuple[float, float]:
        return self._lame

    @property
    def bulk_modulus(self) -> float:
        """Bulk modulus of small strains."""
        return self._lame[0] + 2 / 3 * self._lame[1]


def two_constants(given: dict[str, float]) -> tuple[float, float]:
    """Lame's constants from any two elastic constants.

    Examples
    --------
    >>> two_constants({"young": 2.5, "poisson": 0.25})
    (1.0, 1.0)
    """
    E, nu, G, K, L = (given.get(n) for n in ("young", "poisson", "shear", "bulk", "lame_lambda"))
    if G is None:
        if E is not None and nu is not None:
            G = E / (2 * (1 + nu))
        elif E is not None and K is not None:
            G = 3 * K * E / (9 * K - E)
        elif E is not None and L is not None:
            G = (E - 3 * L + np.sqrt(E * E + 9 * L * L + 2 * E * L)) / 4
        elif nu is not None and K is not None:
            G = 3 * K * (1 - 2 * nu) / (2 * (1 + nu))
        elif nu is not None and L is not None:
            G = L * (1 - 2 * nu) / (2 * nu) if nu else np.nan
        else:
            assert K is not None
            assert L is not None
            G = 1.5 * (K - L)
    if L is None:
        if K is not None:
            L = K - 2 / 3 * G
        elif nu is not None:
            L = 2 * G * nu / (1 - 2 * nu) if nu < 0.5 else np.inf
        else:
            assert E is not None
            L = G * (E - 2 * G) / (3 * G - E)
    return float(L), float(G)
