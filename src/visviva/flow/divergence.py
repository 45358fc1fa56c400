"""The divergence of a fluid's velocities, weighed by the shape functions of its pressures."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import scipy.sparse as sp

    from visviva.flow.elements import Batch

Ints = NDArray[np.int64]


def divergence_rows(
    batches: Iterable[Batch],
    node_unknowns: Callable[[Ints], NDArray[np.int32]],
    pressure_number: Mapping[str, Ints],
    shape: tuple[int, int],
) -> sp.csr_array:
    """Matrix (pressures, unknowns of a system) that takes these to ``-int M_b div v dV``, the balance of mass.

    Parameters
    ----------
    batches : list of Batch
    node_unknowns : callable
        First unknowns of the velocities of nodes.
    pressure_number : dict
        Numbers (m, p) of the pressures of the elements of each cell type.
    shape : (2,)
        How many pressures and unknowns there are.

    Examples
    --------
    >>> import visviva as vv
    >>> square = vv.RectangleMesh(size=(1, 1), counts=(2, 2))
    >>> air = vv.Fluid(mesh=square, density=1.0, viscosity=1.0, velocity=lambda X: 3 * X)
    >>> system = vv.System([air, vv.FluidTraction(fluid=air, faces="all", traction=(0, 0, 0))])
    >>> shape = air.pressure.size, len(system.x)
    >>> rows = divergence_rows(air.batches, air.node_unknowns, air.pressure_number, shape)
    >>> float(rows.sum(axis=0) @ system.x)
    -6.0
    """
    import scipy.sparse as sp

    rows = sp.csr_array(shape)
    for batch in batches:
        gradients, volume = batch.geometry()
        values = -np.einsum("mq,qp,mqkc->mpkc", volume, batch.M, gradients)
        velocity = node_unknowns(batch.nodes)[:, None, :, None] + np.arange(gradients.shape[-1])
        pressure = pressure_number[batch.cell][:, :, None, None]
        at = [np.broadcast_to(k, values.shape).ravel() for k in (pressure, velocity)]
        rows = rows + sp.coo_array((values.ravel(), tuple(at)), shape=rows.shape).tocsr()
    return rows
