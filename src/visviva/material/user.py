"""A material by a Python function."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.component import settings
from visviva.material.base import Kind, Material
from visviva.values import Function

Array = NDArray[np.float64]


@dataclass(config=settings, kw_only=True)
class UserMaterial(Material):
    """A material given by its energy alone.

    Parameters
    ----------
    function : callable
        Maps ``C`` as an array (6, n), rows 11, 22, 33, 12, 23, 31, to energies (n,) per reference volume. Written
        with numpy functions that take complex numbers, first derivatives are exact to round-off.

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
    kind: ClassVar[Kind] = Kind.USER

    def constants(self) -> list[float]:
        return [0.0]

    def respond(self, C: Array) -> tuple[Array, Array, Array]:
        from visviva.callback import Function as Derivatives

        e = np.ascontiguousarray(np.asarray(C, dtype=float).T)
        W = Derivatives(self.function, 6, 1, "UserMaterial")
        share = np.array([1.0, 1.0, 1.0, 0.5, 0.5, 0.5])  # of a derivative by one of two equal components
        S = 2 * share[:, None] * W.gradient(e)[0]
        D = 4 * np.outer(share, share)[:, :, None] * W.hessian(e)[0]
        return W.value(e)[0], S.T, D.transpose(2, 0, 1)

    @property
    def energy(self) -> Callable[[Any], Any]:
        return self.function  # type: ignore[no-any-return]

    @property
    def lame(self) -> tuple[float, float]:
        """Mean constants of small strains, from second derivatives at rest."""
        from visviva.callback import Function as Derivatives

        rest = np.array([[1.0], [1.0], [1.0], [0.0], [0.0], [0.0]])
        H = 4 * Derivatives(self.function, 6, 1, "UserMaterial").hessian(rest)[0, :, :, 0]
        lam = (H[0, 1] + H[1, 2] + H[2, 0]) / 3
        mu = ((H[0, 0] + H[1, 1] + H[2, 2]) / 3 - lam) / 2
        return round(float(lam), 9), round(float(mu), 9)
