"""Membrane strains that four-node cells lack when they bend within their own plane."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from visviva.body.shell_surface import ShellSurface

Array = NDArray[np.float64]


def enhanced_strains(part: ShellSurface, C: Array) -> Array:
    """Strains (m, q, 8, n) of those sampled, with enhanced membrane strains that leave the least energy.

    Those of Simo & Rifai (1990): 11 linear along the first coordinate, 22 along the second, 12 along both, so that no
    constant stress does work on them. The sections' stiffness C (m, 8, 8) does not change, so that they are linear in
    the strains sampled and leave once and for all.
    """
    A, areas = part.section_strains, part.areas
    G = modes(part)
    CG = areas[..., None, None] * (C[:, None, :, :3] @ G)
    own = np.einsum("mqia,mqib->mab", G, CG[:, :, :3])
    share = np.linalg.solve(own, np.einsum("mqja,mqjn->man", CG, A))
    found = A.copy()
    found[:, :, :3] -= np.einsum("mqia,man->mqin", G, share)
    return found


def modes(part: ShellSurface) -> Array:
    """Enhanced strains 11, 22, 2 x 12 along the section's directions (m, q, 3, 4), whose integrals vanish."""
    xi, eta = part.rule.points.T
    along = np.zeros((len(xi), 3, 4))
    along[:, 0, 0], along[:, 1, 1], along[:, 2, 2], along[:, 2, 3] = xi, eta, xi, eta
    density = part.areas / part.rule.weights
    shape = density.mean(axis=1, keepdims=True) / density
    middle = part.plane_turns.mean(axis=1, keepdims=True)
    return np.asarray(shape[..., None, None] * (middle @ along))
