"""Fields of a flow at its nodes: velocity, pressure, vorticity; and how well mass is kept."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError, nearest
from visviva.body.solid_fields import components, linear
from visviva.mesh.cells import CELLS

if TYPE_CHECKING:
    from visviva.flow.elements import Batch
    from visviva.flow.fluid import Fluid
    from visviva.output.streamlines import StreamFunction
    from visviva.output.surface import Surface

Array = NDArray[np.float64]

CHUNK = 4096  # elements whose gradients are held at a time


def mean_pressure(batches: Iterable[Batch], corners: Mapping[str, Array]) -> float:
    """Mean over a fluid of pressures (m, p) at the corners of the elements of each type."""
    total, size = 0.0, 0.0
    for batch in batches:
        _, volume = batch.geometry()
        total += float(np.sum(volume * (corners[batch.cell] @ batch.M.T)))
        size += float(volume.sum())
    return total / size


def nodal_pressures(batches: Iterable[Batch], corners: Mapping[str, Array], n: int) -> Array:
    """Pressures (n,) of the nodes, linear between those (m, p) at the corners of the elements of each type."""
    found = np.zeros(n)
    for batch in batches:
        found[batch.nodes] = corners[batch.cell] @ linear(CELLS[batch.cell]).N(CELLS[batch.cell].nodes).T
    return found


def divergences(batches: Iterable[Batch], v: Array) -> Iterator[tuple[Array, Array]]:
    """Divergences (m, q) of the nodes' velocities (n, 3) and volumes (m, q), some thousand elements at a time."""
    for batch in batches:
        for start in range(0, len(batch.nodes), CHUNK):
            part = slice(start, start + CHUNK)
            G, volume = batch.geometry(part)
            yield np.einsum("mkj,mqkj->mq", v[batch.nodes[part], : G.shape[3]], G), volume


def nodal_gradients(batches: Iterable[Batch], v: Array) -> Array:
    """Gradients (n, 3, 3) ``dv_i/dx_j`` of velocities (n, 3): of each element at its nodes, then means by volumes."""
    total, weight = np.zeros((len(v), 3, 3)), np.zeros(len(v))
    for batch in batches:
        cell = CELLS[batch.cell]
        X = batch.points[batch.nodes]
        J = np.einsum("mkd,akj->madj", X, cell.dN(cell.nodes))
        G = cell.dN(cell.nodes) @ np.linalg.inv(J)
        size = batch.geometry()[1].sum(axis=1)
        L = np.zeros((*batch.nodes.shape, 3, 3))
        L[..., : G.shape[3]] = np.einsum("mki,makj->maij", v[batch.nodes], G)
        np.add.at(total, batch.nodes, size[:, None, None, None] * L)
        np.add.at(weight, batch.nodes, size[:, None])
    mean: Array = total / weight[:, None, None]
    return mean


def vorticity(fluid: Fluid, x: Array) -> Array:
    """Curl of the velocity at the nodes: (n,) in the plane, (n, 3) in space."""
    L = nodal_gradients(fluid.batches, fluid.by_node(x))
    curl = np.stack([L[:, 2, 1] - L[:, 1, 2], L[:, 0, 2] - L[:, 2, 0], L[:, 1, 0] - L[:, 0, 1]], axis=1)
    return curl[:, 2] if fluid.dimension == 2 else curl


def velocity_gradient(fluid: Fluid, x: Array) -> Array:
    """Gradients (n, 9) ``dv_i/dx_j`` at the nodes: xx, xy, xz, yx and so on."""
    return nodal_gradients(fluid.batches, fluid.by_node(x)).reshape(-1, 9)


def stress(fluid: Fluid, x: Array) -> Array:
    """Cauchy's stress (n, 6) at the nodes: xx, yy, zz, xy, yz, zx of ``-p I + mu (grad v + grad v^T)``."""
    L = nodal_gradients(fluid.batches, fluid.by_node(x))
    sigma = fluid.viscosity * (L + np.swapaxes(L, 1, 2)) - fluid.pressures(x)[:, None, None] * np.eye(3)
    return components(sigma)


def stream_function(fluid: Fluid, x: Array) -> Array:
    """Stream function (n,) of a plane flow at the nodes, zero at the first one.

    Raises
    ------
    InputError
        In space.
    """
    if fluid.dimension != 2:
        raise InputError(f"{fluid.label}: only plane flows have a stream function")
    psi = fluid.streams(fluid.by_node(x)[:, :2])
    return np.asarray(psi - psi[0])


def streams(drawn: Surface) -> StreamFunction:
    """Solver for the stream function of a plane fluid, over triangles between all of its nodes."""
    from visviva.output.skin import skin
    from visviva.output.streamlines import StreamFunction

    parts = []
    for block in skin(drawn):
        parts += [block[:, [0, k, k + 1]] for k in range(1, block.shape[1] - 1)]
    return StreamFunction(drawn.points[:, :2], np.concatenate(parts))


FIELDS: dict[str, Callable[[Fluid, Array], Array]] = {
    "velocity": lambda fluid, x: fluid.by_node(x),
    "speed": lambda fluid, x: np.asarray(np.linalg.norm(fluid.by_node(x), axis=1)),
    "pressure": lambda fluid, x: fluid.pressures(x),
    "vorticity": vorticity,
    "velocity_gradient": velocity_gradient,
    "stress": stress,
    "stream_function": stream_function,
}
"""Fields of fluids that can be recorded and written by name."""


def widths(dimension: int) -> dict[str, int]:
    """Number of components of every field that all fluids have."""
    own = {"velocity": 3, "speed": 1, "pressure": 1, "vorticity": 1 if dimension == 2 else 3}
    return own | {"velocity_gradient": 9, "stress": 6} | ({"stream_function": 1} if dimension == 2 else {})


def flow_field(fluid: Fluid, name: str) -> Callable[[Array], Array]:
    """A field by its name, as a function of the unknowns.

    Raises
    ------
    InputError
        With the nearest valid name.
    """
    if name in fluid.carried:
        return fluid.carried[name]
    if name not in FIELDS:
        known = [*FIELDS, *fluid.carried]
        raise InputError(f"{fluid.label} has no field {name!r}{nearest(name, known)}")
    return partial(FIELDS[name], fluid)


def courant(batches: Iterable[Batch], v: Array, h: float) -> float:
    """Largest part of a cell, along the velocity (n, 3) at one of its nodes, that the fluid passes in a time `h`."""
    fastest = 0.0
    for batch in batches:
        along = np.einsum("mij,mkj->mki", batch.inverse, v[batch.nodes, : len(batch.shape)])
        squares = np.einsum("mki,ij,mkj->mk", along, batch.shape, along)
        fastest = max(fastest, float(np.sqrt(squares.max(initial=0.0))))
    return 0.5 * h * fastest


def divergence(batches: Iterable[Batch], v: Array) -> float:
    """Root mean square of the divergence of the nodes' velocities (n, 3) over the fluid."""
    total = size = 0.0
    for rate, volume in divergences(batches, v):
        total += float(np.sum(volume * rate**2))
        size += float(volume.sum())
    return float(np.sqrt(total / size))
