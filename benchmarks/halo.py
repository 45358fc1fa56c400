"""What processes exchange: nodes beyond the borders of real partitions, and the messages of a real solve.

    python benchmarks/halo.py [--cells 1000000] [--most 4096]       partitions of a hollow torus
    mpiexec -n 4 python benchmarks/halo.py --solve [--cells 8000]    what an iteration of conjugate gradients sends

A node belongs to the first part that has a cell of it. Before every product with the matrix a process needs the nodes
that share a cell with one of its own and belong to others: these are counted, with the processes that they come from.
`--solve` counts by PETSc's own log, for a cube in statics with its multigrid, all levels included. Needs
`visviva-petsc`; METIS cuts where `pymetis` is there.
"""

from __future__ import annotations

import argparse
import resource
import time
from importlib.util import find_spec

import numpy as np
from numpy.typing import NDArray
from visviva_petsc.partition import parts_of

import visviva as vv
from visviva.base.world import world

Ints = NDArray[np.int64]


def torus(n_cells: int) -> vv.Mesh:
    """About so many bricks, as fine in all directions as the paper's."""
    fine = (n_cells / (118 * 34 * 2)) ** (1 / 3)
    counts = tuple(max(1, round(fine * n)) for n in (118, 34, 2))
    return vv.HollowTorusMesh(major_radius=76.0, outer_minor_radius=24.0, wall=4.5, counts=counts).build()


def exchanged(mesh: vv.Mesh, part: Ints, n_parts: int) -> tuple[Ints, Ints, Ints]:
    """Nodes (n_parts,) of every part, those that it needs of others, and from how many others these come."""
    cells = mesh.cells["hex8"]
    owner = np.full(mesh.n_nodes, n_parts)
    np.minimum.at(owner, cells.ravel(), np.repeat(part, cells.shape[1]))
    found = []
    for a in range(8):
        for b in range(8):
            far = owner[cells[:, a]] != owner[cells[:, b]]
            found.append(owner[cells[far, a]] * np.int64(mesh.n_nodes) + cells[far, b])
    needed = np.unique(np.concatenate(found))
    who, node = np.divmod(needed, mesh.n_nodes)
    pairs = np.unique(who * np.int64(n_parts) + owner[node])
    return (
        np.bincount(owner, minlength=n_parts),
        np.bincount(who, minlength=n_parts),
        np.bincount(pairs // n_parts, minlength=n_parts),
    )


def print_partitions(n_cells: int, most: int) -> None:
    """A line for every number of parts."""
    mesh = torus(n_cells)
    by = "METIS" if find_spec("pymetis") else "bisection of places"
    print(f"{mesh.n_cells} cells, {3 * mesh.n_nodes} unknowns, parts by {by}; means and largest of all parts")
    print(f"{'parts':>6} {'unknowns':>18} {'needed of others':>18} {'share':>6} {'from others':>12}")
    n_parts = 2
    while n_parts <= most:
        own, needed, others = exchanged(mesh, parts_of(mesh, n_parts), n_parts)
        print(
            f"{n_parts:>6} {3 * own.mean():>10.0f} {3 * own.max():>7} {3 * needed.mean():>10.0f} "
            f"{3 * needed.max():>7} {needed.sum() / own.sum():>6.2f} {others.mean():>7.1f} {others.max():>4}",
            flush=True,
        )
        n_parts *= 4 if n_parts > 2 else 2


def print_solution(n_cells: int) -> None:
    """Messages, bytes and reductions of an iteration, by the log of PETSc."""
    from petsc4py import PETSc

    PETSc.Log.begin()
    n = round(n_cells ** (1 / 3))
    solid = vv.Solid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(n, n, n)), material=vv.NeoHooke(young=1000.0, poisson=0.3)
    )
    pull = vv.Traction(solid=solid, faces="x1", traction=(0, 0, -20.0), times="t")
    newton = vv.Newton(linear=vv.Petsc())
    system = vv.System([solid, vv.Fixed(solid=solid, nodes="x0"), pull], newton=newton)
    start = time.perf_counter()
    vv.quasi_static(system, until=1.0, step=1.0)
    seconds = time.perf_counter() - start
    info = lambda name: PETSc.Log.Event(name).getPerfInfo()  # noqa: E731
    comm, solve, iterations = PETSc.COMM_WORLD.tompi4py(), info("KSPSolve"), max(info("PCApply")["count"], 1)
    memory = comm.gather(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024)
    messages, length = comm.allreduce(np.array([solve["numMessages"], solve["messageLength"]]))
    each = messages / iterations / comm.size
    reductions = sum(info(name)["count"] for name in ("VecDot", "VecTDot", "VecMDot", "VecNorm"))
    if comm.rank == 0:
        print(
            f"{comm.size} processes, {system.n_coordinates} unknowns, {iterations} cycles of multigrid, in each a "
            f"process sends {each:.1f} messages of {length / max(messages, 1):.0f} bytes and "
            f"is in {reductions / iterations:.1f} reductions; {seconds:.1f} s, MB of each {memory}"
        )


def main() -> None:
    """Print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--cells", type=int, default=0)
    parser.add_argument("--most", type=int, default=4096, help="parts")
    parser.add_argument("--solve", action="store_true")
    given = parser.parse_args()
    if given.solve:
        print_solution(given.cells or 8000)
    elif world().rank == 0:
        print_partitions(given.cells or 1_000_000, given.most)


if __name__ == "__main__":
    main()
