"""Mass of the fluid displaced by bodies, which moves along with them, for projections of rates."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.component.announcements import Wetting
from visviva.system.instant import Instant
from visviva.system.memory import returning

if TYPE_CHECKING:
    import scipy.sparse as sp

    from visviva.scheme.schemes import Table
    from visviva.system.system import System

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


def displaced_mass(system: System) -> sp.csr_array:
    """Mass (n, n) of fluid in the places of bodies: it moves along, so that these are projected by masses of their own.

    Without it what floats in a fluid of its own density has no mass, but rounding.
    """
    import scipy.sparse as sp

    n = len(system.x)
    rows, columns, values = [np.zeros(0, dtype=np.int64)], [np.zeros(0, dtype=np.int64)], [np.zeros(0)]
    for wet in (c for c in system.components if isinstance(c, Wetting)):
        for unknowns, mass in wet.displaced_fluid:
            for along in np.moveaxis(unknowns, 2, 0):
                row = np.broadcast_to(along[:, :, None], mass.shape)
                rows.append(row.ravel())
                columns.append(row.swapaxes(1, 2).ravel())
                values.append(-mass.ravel())
    places = np.concatenate(rows), np.concatenate(columns)
    return sp.csr_array(sp.coo_array((np.concatenate(values), places), shape=(n, n)))


def impulse_at_start(system: System, at: Instant, step: Any, table: Table, x0: Array, trial: Array) -> Array:
    """Half of the impulse of the multipliers in a step, (h/2) G_0^T lambda, on the coordinates of `at`.

    What keeps a body in shape that lies in a fluid, its directors orthonormal, answers to forces of the fluid, of which
    rates know nothing: these follow from where the fluid takes the body. In its place is what would give the change of
    the rates across the shape, of the mass by which the body is heavier than the fluid, ``M``:

        -1/2 P^T M (v* - v_0),    P = B^T (G_0 B^T)^-1 G_0,    B = G_0 (M + M_fluid)^-1.
    """
    fluid = displaced_mass(system)[at.coordinates][:, at.coordinates]
    wet = abs(fluid).sum(axis=0) > 0
    with returning(system):
        system.x[:] = x0
        start = Instant(system) if wet.any() else None
        kept = _kept_in_shape(start, wet) if start else np.zeros(len(at.multipliers), dtype=bool)
        system.core.dx[:] = trial - x0
        system.core.dx[at.multipliers[kept]] = -x0[at.multipliers[kept]]
        with_them = system.residual(step)
        system.core.dx[at.multipliers] = -x0[at.multipliers]
        impulse: Array = 0.5 * step.h * (with_them - system.residual(step))[at.coordinates]
    if start is None or not kept.any():
        return impulse
    by_increment, by_rate = table[2][:2]
    after = system.v[at.coordinates]
    before = (after - by_increment * (trial - x0)[at.coordinates]) / by_rate
    return impulse + _of_excess(
        start.G[kept][:, wet], start.M[wet][:, wet], fluid[wet][:, wet], wet, after - before
    )


def _kept_in_shape(start: Instant, wet: Mask) -> Mask:
    """Which multipliers act on nothing but bodies in fluids."""
    acts: Array = abs(start.G).sum(axis=1)
    alone: Array = abs(start.G[:, wet]).sum(axis=1)
    return np.asarray((acts > 0) & (alone == acts))


def _of_excess(G: Any, excess: Any, fluid: Any, wet: Mask, change: Array) -> Array:
    import scipy.sparse as sp
    from scipy.sparse.linalg import splu

    give = 1e-12 * abs(G).sum(axis=1) ** 2 / (excess + fluid).diagonal().max()  # of what is held twice
    K = sp.block_array([[excess + fluid, G.T], [G, sp.diags_array(-give)]], format="csc")
    asked = np.concatenate([excess @ change[wet], np.zeros(G.shape[0])])
    impulse = np.zeros(len(wet))
    impulse[wet] = -0.5 * (G.T @ splu(K).solve(asked)[-G.shape[0] :])
    return impulse
