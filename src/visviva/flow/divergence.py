"""The divergence of a fluid's velocities, weighed by the shape functions of its pressures."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import scipy.sparse as sp

    from visviva.flow.fluid import Fluid


def divergence_rows(fluid: Fluid, n: int) -> sp.csr_array:
    """Matrix (pressures, n) that takes `n` unknowns of a system to ``-int M_b div v dV``, the balance of mass.

    Examples
    --------
    >>> import visviva as vv
    >>> square = vv.RectangleMesh(size=(1, 1), counts=(2, 2))
    >>> air = vv.Fluid(mesh=square, density=1.0, viscosity=1.0, velocity=lambda X: 3 * X)
    >>> system = vv.System([air, vv.FluidTraction(fluid=air, faces="all", traction=(0, 0, 0))])
    >>> float(divergence_rows(air, len(system.x)).sum(axis=0) @ system.x)
    -6.0
    """
    import scipy.sparse as sp

    rows = sp.csr_array((fluid.pressure.size, n))
    for batch in fluid.batches:
        gradients, volume = batch.geometry()
        values = -np.einsum("mq,qp,mqkc->mpkc", volume, batch.M, gradients)
        velocity = fluid.node_unknowns(batch.nodes)[:, None, :, None] + np.arange(fluid.dimension)
        pressure = fluid.pressure_number[batch.cell][:, :, None, None]
        at = [np.broadcast_to(k, values.shape).ravel() for k in (pressure, velocity)]
        rows = rows + sp.coo_array((values.ravel(), tuple(at)), shape=rows.shape).tocsr()
    return rows
