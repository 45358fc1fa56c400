"""Energy of cracks and degradation of a material's energy, at points; the core has the same in C++."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.base.errors import InputError
from visviva.body.solid_fields import FULL, components
from visviva.material.material import VOLUMETRIC, Kind, Material

Array = NDArray[np.float64]
Model = Literal["AT1", "AT2"]
Irreversibility = Literal["active set", "history"]
SplitName = Literal["none", "volumetric", "spectral"]
NONE, TRACE, VOLUME, GREEN, LOGARITHMIC = range(5)
"""Splits of the core, see ``visviva/point/fracture.hpp``."""
LINEAR = {"AT1": True, "AT2": False}
TINY = 1e-300
IDENTITY = np.array([1.0, 1, 1, 0, 0, 0])
NORMALISED = {"AT1": 8 / 3, "AT2": 2.0}
"""Four times the integral of the root of the local part, by which a crack costs the toughness."""


@dataclass(frozen=True, eq=False)
class CrackLaw:
    """Energy ``g(d) W+ + W- + Gc / (c l) (w(d) + l^2 |grad d|^2)``, ``g = (1 - rest) (1 - d)^2 + rest``.

    ``w = d, c = 8/3`` (AT1), or ``w = d^2, c = 2`` (AT2).
    """

    label: str
    material: Material
    toughness: float
    length: float
    model: Model
    split: SplitName
    rest: float

    @property
    def number(self) -> int:
        """The split in the core.

        Raises
        ------
        InputError
            If the material has no such split.
        """
        kind = self.material.kind
        if self.split == "none":
            return NONE
        if kind is Kind.HOOKE:
            return TRACE if self.split == "volumetric" else GREEN
        if kind is Kind.HENCKY:
            return VOLUME if self.split == "volumetric" else LOGARITHMIC
        if self.split == "volumetric" and is_isochoric(self.material):
            return VOLUME
        cure = "vv.SaintVenantKirchhoff (Green's strains) or vv.Hencky (logarithmic strains)"
        if self.split == "volumetric":
            cure += ", or one of isochoric=True"
        raise InputError(
            f"{self.label}: split = {self.split!r} does not know {type(self.material).__name__}; take {cure}"
        )

    @property
    def _constants(self) -> tuple[float, float]:
        """Of the part that cracks leave."""
        lam, mu = self.material.lame
        if self.number == VOLUME:
            return lam + 2 * mu / 3, self._measure
        return (lam + 2 * mu / 3 if self.number == TRACE else lam), mu

    @property
    def _measure(self) -> float:
        return self.material.constants()[_core.bulk_place(int(self.material.kind)) + 1]

    @property
    def local(self) -> float:
        """Energy per volume of full damage."""
        return self.toughness / (NORMALISED[self.model] * self.length)

    @property
    def gradient(self) -> float:
        """Factor of the square of the gradient."""
        return self.toughness * self.length / NORMALISED[self.model]

    def parameters(self) -> list[float]:
        """Of the core."""
        own = self.material.constants()
        first, second = self._constants
        head = [float(int(self.material.kind)), float(self.number), first, second]
        crack = [self.local, float(LINEAR[self.model]), self.gradient, self.rest]
        return [*head, *crack, *own, *[0.0] * (_core.MATERIAL_PARAMETERS - len(own))]

    def soundness(self, d: Array) -> Array:
        """``g(d)``"""
        g: Array = (1 - self.rest) * (1 - d) ** 2 + self.rest
        return g

    def crack_energy(self, d: Array, gradient: Array) -> Array:
        """Energy (...) per volume of damages (...) and gradients (..., k)."""
        w = d if LINEAR[self.model] else d * d
        density: Array = self.local * w + self.gradient * np.sum(gradient**2, axis=-1)
        return density

    def even_damage(self, C: Array, volume: float = 1.0) -> Array:
        """Damages (n,) that balance energies ``volume W(C)`` of tensors C (n, 6), the same from place to place."""
        drive = 2 * volume * (1 - self.rest) * (self.material.respond(C)[0] - self.left(C)[0])
        linear = float(LINEAR[self.model])
        d: Array = np.maximum(drive - linear * self.local, 0.0) / np.maximum(
            drive + 2 * (1 - linear) * self.local, TINY
        )
        return d

    def respond(self, C: Array, d: Array) -> tuple[Array, Array]:
        """Energy (n,) and second Piola-Kirchhoff stress (n, 6) of tensors C (n, 6) with damages (n,)."""
        W, S, _ = self.material.respond(C)
        W_left, S_left = self.left(C)
        g = self.soundness(d)
        return g * (W - W_left) + W_left, g[:, None] * (S - S_left) + S_left

    def left(self, C: Array) -> tuple[Array, Array]:
        """Energy (n,) and stress (n, 6) that cracks leave."""
        number, (first, second) = self.number, self._constants
        if number == NONE:
            return np.zeros(len(C)), np.zeros_like(C)
        if number == TRACE:
            shrinks = np.minimum(0.5 * (C[:, :3].sum(axis=1) - 3), 0.0)
            return 0.5 * first * shrinks**2, (first * shrinks)[:, None] * IDENTITY
        if number == VOLUME:
            return volume_left(C, first, second)
        values, n = np.linalg.eigh(C[:, FULL])
        log = number == LOGARITHMIC
        e = 0.5 * np.log(values) if log else 0.5 * (values - 1)
        trace, parts = np.minimum(e.sum(axis=1), 0.0), np.minimum(e, 0.0)
        stress = first * trace[:, None] + 2 * second * parts
        S = np.einsum("ma,mia,mja->mij", stress / values if log else stress, n, n)
        return 0.5 * first * trace**2 + second * (parts**2).sum(axis=1), components(S)


def is_isochoric(material: Material) -> bool:
    """A material whose energy is ``W(J^(-2/3) C) + bulk U(J)``: its first part does not change with the volume.

    That is asked of the energy itself, in two strains of shape, each with two volumes.

    Examples
    --------
    >>> import visviva as vv
    >>> [is_isochoric(vv.NeoHooke(young=1.0, poisson=0.3, isochoric=choice)) for choice in (True, False)]
    [True, False]
    """
    if material.energy is not None or _core.bulk_place(int(material.kind)) < 0:
        return False
    shape = 0.01 * np.array([[2.0, -1, 1, 0.5, 1.5, -1], [-2, 1, -1, 0.5, -1, 1.5]]) + IDENTITY
    out = np.empty((4, 28))
    C = np.concatenate([shape, 1.1 * shape])
    _core.material(int(material.kind), np.array(material.split().constants), C - IDENTITY, out)
    rounding = 1e-9 * np.abs(out[:2, 0])
    return bool(np.all(np.abs(out[2:, 0] - out[:2, 0]) <= rounding))


def volume_left(C: Array, bulk: float, measure: float) -> tuple[Array, Array]:
    """Energy and stress of a volume that shrinks."""
    full = C[:, FULL]
    J = np.sqrt(np.linalg.det(full))
    j, log = J - 1, np.log(J)
    if measure == VOLUMETRIC["logarithmic"]:
        U, slope = 0.5 * log**2, log / J
    elif measure == VOLUMETRIC["quadratic"]:
        U, slope = 0.5 * j**2, j
    else:
        U, slope = 0.25 * (J**2 - 1 - 2 * log), 0.5 * (J - 1 / J)
    factor = np.where(J < 1, bulk, 0.0)
    S: Array = (factor * slope * J)[:, None] * components(np.asarray(np.linalg.inv(full)))
    return factor * U, S
