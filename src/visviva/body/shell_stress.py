"""Stresses in the layers of shells whose directors stretch."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.body.shell_layers import full
from visviva.material.material import OF_BLATZ_KO, TRACE, Material, Split

Array = NDArray[np.float64]


def second_piola(material: Material, C: Array, pressure: Array | None) -> Array:
    """Stresses (..., 6) at right Cauchy-Green tensors (..., 6), with pressures (...) of mixed formulations."""
    flat = np.ascontiguousarray(C.reshape(-1, 6))
    if pressure is None:
        return np.asarray(material.respond(flat)[1]).reshape(C.shape)
    split, out = material.split(), np.empty((len(flat), 28))
    rest = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    _core.material(int(split.kind), np.array(split.constants), flat - rest, out)
    of_volume = volume_gradient(split, C) * pressure[..., None]
    return np.asarray(2 * out[:, 1:7].reshape(C.shape) + of_volume)


def volume_gradient(split: Split, C: Array) -> Array:
    """Twice the derivative by C of the measure of the volume, ``g`` with the volumetric energy ``bulk g^2 / 2``."""
    if split.measure == TRACE:
        return np.broadcast_to([1.0, 1.0, 1.0, 0.0, 0.0, 0.0], C.shape)
    tensor = full(C)
    inverse = np.linalg.inv(tensor)[..., [0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]]
    J = np.sqrt(np.linalg.det(tensor))
    return np.asarray(slope(split, J)[..., None] * inverse)


def slope(split: Split, J: Array) -> Array:
    """``J dg/dJ``."""
    if split.measure == 0:
        return np.ones_like(J)
    if split.measure == 1:
        return J
    log = np.log(J)
    near = np.abs(log) < 1e-5
    safe = np.where(near, 1.0, log)
    if split.measure == OF_BLATZ_KO:
        b = split.constants[3]
        y = b * safe
        full_slope = -np.expm1(-y) / (np.sign(y) * np.sqrt(2 * (np.expm1(-y) + y)))
        return np.where(near, 1 - b * log / 3, full_slope)
    g = np.sign(safe) * np.sqrt(0.5 * (np.expm1(2 * safe) - 2 * safe))
    return np.where(near, 1 + 2 * log / 3, 0.5 * np.expm1(2 * safe) / g)
