"""Squares of frequencies that rounding of the stiffness hides: zeros of free motions, and losses, which are refused."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.analysis.linearized import Linearized
from visviva.base.errors import InputError
from visviva.body.mesh_body import MeshBody
from visviva.mesh.cells import CELLS
from visviva.system.freedom import null_space, rigid_motions

Array = NDArray[np.float64]


class Lost(InputError):
    """A frequency that double precision does not hold."""


LOST = 1e-3
"""Part of a square of a frequency that rounding may change; beyond it the square is lost."""
RIGID = 0.03
"""Distance from rigid motions, by mass, below which a motion is rigid; a cantilever's first mode has three times it."""


def noise(K: Any, z: Array) -> Array:
    """Typical effect of rounding the entries of a stiffness (n, n) on its quadratic forms with vectors (n, k)."""
    squares: Array = (z**2 * (K.multiply(K) @ z**2)).sum(axis=0)
    return float(np.finfo(float).eps) * np.sqrt(squares)


def refuse_lost(linear: Linearized, squared: Array, z: Array, doubt: Array) -> None:
    """Refuse squares (k,) hidden by `doubt` (k,), unless all bodies with meshes move rigidly in the motions z (n, k).

    Raises
    ------
    Lost
    """
    lost = np.flatnonzero(LOST * np.abs(squared) <= doubt)
    for k, body in zip(lost, bent(linear, z[:, lost]), strict=True):
        if body is not None and LOST * loading(linear, body, z[:, k]) <= doubt[k]:
            raise Lost(
                f"modes: the frequency of a mode that bends {body.label} is lost in rounding, as all below "
                f"{np.sqrt(doubt[k] / LOST):.2g} rad per time are: the body is too slender or thin for its length, or "
                "for so small cells; take fewer and longer ones, a thicker section, or let it be rigid"
            )


def loading(linear: Linearized, body: MeshBody, z: Array) -> float:
    """About what load steps have changed the square of a motion (n,) by: where that is known zero may be the answer.

    At a bifurcation stress takes from the stiffness all that there is. It is the strain times the stiffness against
    stretching, by the energy stored, and acts on slopes; energy that motion has brought counts for nothing.
    """
    system, grid, found = linear.at.system, body.grid, body.vectors(linear.at.system.model)
    if system.has_inertia or found is None:
        return 0.0
    starts, is_position, width = found
    index, (stretch, motion) = starts[is_position][:, None] + np.arange(width), np.zeros((2, len(system.x)))
    motion[linear.at.coordinates], place = z, system.x[index]
    stretch[index] = place - place.mean(axis=0)
    u, owner = stretch[linear.at.coordinates], system.model.index(body)
    stored = sum(system.core.energy[k] for k, a in enumerate(system.model.accounts) if a.component == owner)
    slopes = np.zeros(0)
    for name, nodes in grid.cells.items():
        corners = nodes[:, : CELLS[name].n_corners]
        along, moved = (a[corners] - a[np.roll(corners, 1, axis=1)] for a in (place, motion[index]))
        slopes = np.append(slopes, (moved**2).sum(axis=2) / (along**2).sum(axis=2))
    return float(np.sqrt(2 * abs(stored * float(u @ (linear.K @ u)))) * slopes.mean())


def bent(linear: Linearized, z: Array) -> list[MeshBody | None]:
    """For each motion (n, k), of unit mass, the body with a mesh that it strains most, None if all move rigidly."""
    bodies: list[Any] = [c for c in linear.at.system.components if isinstance(c, MeshBody)]
    lack = np.array([np.full(z.shape[1], RIGID), *(strain(linear, body, z) for body in bodies)])
    return [[None, *bodies][k] for k in np.argmax(lack, axis=0).tolist()]


def strain(linear: Linearized, body: MeshBody, z: Array) -> Array:
    """Part (k,) of motions (n, k), by mass, beside the rigid motions that parts of a body may have."""
    at, found, motions = linear.at, np.zeros(z.shape[1]), rigid_motions(linear.at.system, body)
    fixed = np.concatenate([f.fixed for f in at.system.model.fields])
    for unknowns in parts(linear, body) if motions is not None else ():
        assert motions is not None
        possible = motions.moves[:, motions.possible]
        free = possible @ null_space(possible[unknowns[fixed[unknowns]]])
        own = np.isin(at.coordinates, unknowns)[:, None]
        rigid, moves = np.where(own, free[at.coordinates], 0.0), np.where(own, z, 0.0)
        weighted = at.M @ rigid
        rest = moves - rigid @ (np.linalg.pinv(rigid.T @ weighted, hermitian=True) @ (weighted.T @ moves))
        found = np.maximum(found, np.sqrt(np.abs((rest * (at.M @ rest)).sum(axis=0))))
    return found


def parts(linear: Linearized, body: MeshBody) -> list[NDArray[np.int64]]:
    """Unknowns of each part of a body that is connected, those that are held among them."""
    import scipy.sparse as sp
    from scipy.sparse.csgraph import connected_components

    system, found = linear.at.system, body.vectors(linear.at.system.model)
    if found is None:
        return []
    starts, _, width = found
    index = starts[:, None] + np.arange(width)
    number = np.full(len(system.x), -1)
    number[index] = np.arange(len(starts))[:, None]
    first, other, unknown = system.pattern
    row = number[unknown[np.repeat(np.arange(len(unknown)), np.diff(first))]]
    col = number[unknown[other]]
    own = (row >= 0) & (col >= 0)
    links = sp.coo_array((np.ones(int(own.sum())), (row[own], col[own])), shape=(len(starts),) * 2)
    n, part = connected_components(links, directed=False)
    return [index[part == k].ravel() for k in range(n)]
