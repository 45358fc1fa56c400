"""What a GPU could do for solids: assembly, products and multigrid of bricks, beside ours on threads of the processor.

    python benchmarks/gpu.py [--counts 32 69 87] [--threads 1 2 16]

Needs CuPy and PyAMG; nothing of the package uses a GPU. A cube of n x n x n hexahedra of compressible neo-Hookean
material, held at one face, at a state slightly deformed. The GPU evaluates residual and tangent of each element by 64
threads, adds them into compressed rows (checked against ours), makes the coarse matrices of smoothed aggregation anew
(aggregates and prolongations are made on the processor and kept) and solves by conjugate gradients with a V-cycle of
damped Jacobi. Ours are the assembly of `elements.py` and the multigrid that statics takes by default; it keeps its
cycle for later tangents, but here it is made anew, as on the GPU. Products are SciPy's, by one thread. Times are of
the clock, the best of some repetitions, without first calls; the right-hand side is the same.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import scipy.sparse as sp
from elements import SCHEMES, cube

import visviva as vv
from visviva import _core
from visviva.analysis.march import prepare
from visviva.linear.choice import Problem

Array = Any  # of NumPy or CuPy
TOLERANCE = 1e-6

KERNEL = r"""
extern "C" __global__ void assemble(const double* X, const double* x, const int* cells, const int* free,
                                    const int* slot, const int* width, double mu, double lambda, double* residual,
                                    double* values) {
    __shared__ double D[8][8][3], g[8][8][3], F[8][9], w[8], p[8];
    const int e = blockIdx.x, t = threadIdx.x;
    const int* cell = cells + 8 * e;
    const int sx[8] = {-1, 1, 1, -1, -1, 1, 1, -1}, sy[8] = {-1, -1, 1, 1, -1, -1, 1, 1};
    const int sz[8] = {-1, -1, -1, -1, 1, 1, 1, 1};
    if (t < 8) {
        const double s = 0.57735026918962576451;
        const double a = s * sx[t], b = s * sy[t], c = s * sz[t];
        double N[8][3], J[9] = {0}, I[9];
        for (int n = 0; n < 8; ++n) {
            N[n][0] = 0.125 * sx[n] * (1 + b * sy[n]) * (1 + c * sz[n]);
            N[n][1] = 0.125 * sy[n] * (1 + a * sx[n]) * (1 + c * sz[n]);
            N[n][2] = 0.125 * sz[n] * (1 + a * sx[n]) * (1 + b * sy[n]);
            for (int i = 0; i < 3; ++i)
                for (int k = 0; k < 3; ++k) J[3 * i + k] += X[3 * cell[n] + i] * N[n][k];
        }
        #define INVERT(M, R, det) \
            R[0] = M[4] * M[8] - M[5] * M[7]; R[1] = M[2] * M[7] - M[1] * M[8]; R[2] = M[1] * M[5] - M[2] * M[4]; \
            R[3] = M[5] * M[6] - M[3] * M[8]; R[4] = M[0] * M[8] - M[2] * M[6]; R[5] = M[2] * M[3] - M[0] * M[5]; \
            R[6] = M[3] * M[7] - M[4] * M[6]; R[7] = M[1] * M[6] - M[0] * M[7]; R[8] = M[0] * M[4] - M[1] * M[3]; \
            const double det = M[0] * R[0] + M[1] * R[3] + M[2] * R[6]; \
            for (int i = 0; i < 9; ++i) R[i] /= det;
        INVERT(J, I, volume)
        double f[9] = {0}, inverse[9];
        for (int n = 0; n < 8; ++n) {
            for (int k = 0; k < 3; ++k)
                D[t][n][k] = N[n][0] * I[k] + N[n][1] * I[3 + k] + N[n][2] * I[6 + k];
            for (int i = 0; i < 3; ++i)
                for (int k = 0; k < 3; ++k) f[3 * i + k] += x[3 * cell[n] + i] * D[t][n][k];
        }
        INVERT(f, inverse, j)
        for (int n = 0; n < 8; ++n)
            for (int i = 0; i < 3; ++i)
                g[t][n][i] = inverse[i] * D[t][n][0] + inverse[3 + i] * D[t][n][1] + inverse[6 + i] * D[t][n][2];
        for (int i = 0; i < 9; ++i) F[t][i] = f[i];
        w[t] = volume;
        p[t] = mu - lambda * log(j);
    }
    __syncthreads();
    const int a = t / 8, b = t % 8, row = free[cell[a]], col = free[cell[b]];
    if (row < 0) return;
    if (b < 3) {
        double r = 0;
        for (int q = 0; q < 8; ++q) {
            double FD = 0;
            for (int k = 0; k < 3; ++k) FD += F[q][3 * b + k] * D[q][a][k];
            r += w[q] * (mu * FD - p[q] * g[q][a][b]);
        }
        atomicAdd(residual + 3 * row + b, r);
    }
    if (col < 0) return;
    double K[9] = {0};
    for (int q = 0; q < 8; ++q) {
        const double DD = mu * (D[q][a][0] * D[q][b][0] + D[q][a][1] * D[q][b][1] + D[q][a][2] * D[q][b][2]);
        for (int i = 0; i < 3; ++i)
            for (int k = 0; k < 3; ++k)
                K[3 * i + k] += w[q] * (p[q] * g[q][a][k] * g[q][b][i] + lambda * g[q][a][i] * g[q][b][k] +
                                        (i == k ? DD : 0.0));
    }
    double* to = values + slot[64 * e + t];
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) atomicAdd(to + i * width[row] + k, K[3 * i + k]);
}
"""


def clock(work: Callable[[], Any], repeat: int, wait: Callable[[], Any] = lambda: None) -> float:
    """Shortest time in seconds of some calls, after a first one that does not count."""
    work()
    best = np.inf
    for _ in range(repeat):
        wait()
        start = time.perf_counter()
        work()
        wait()
        best = min(best, time.perf_counter() - start)
    return float(best)


class Case:
    """The cube, its tangent by ours over the free unknowns, and rigid motions as near-null vectors."""

    def __init__(self, n: int) -> None:
        self.system = cube("hex8", n)
        self.solid: Any = self.system.components[0]
        prepare(self.system, SCHEMES["statics"])
        self.X = np.asarray(self.solid.grid.points, float)
        self.cells = np.asarray(self.solid.grid.cells["hex8"], np.int32)
        self.free_nodes = np.flatnonzero(self.X[:, 0] > 1e-9)
        step = SCHEMES["statics"].step(self.system.time, 0.01)
        residual, self.K = self.system.tangent(step)
        self.K.sort_indices()
        self.residual = residual
        x, y, z = self.X[self.free_nodes].T
        o, i = np.zeros_like(x), np.ones_like(x)
        turns = [[o, -z, y], [z, o, -x], [-y, x, o]]
        columns = [[i, o, o], [o, i, o], [o, o, i], *turns]
        self.modes = np.stack([np.stack(c, 1).ravel() for c in columns], 1)
        self.load = np.tile([0.0, 0.0, -1.0], len(self.free_nodes))


def ours(count: int, repeat: int) -> dict[str, float]:
    """Seconds of assembly, of multigrid made anew, and of its solution, by the threads of this process."""
    case = Case(count)
    core, step = case.system.core, SCHEMES["statics"].step(case.system.time, 0.01)
    signals = case.system.signals(step).copy()
    residual, values = np.zeros(len(case.system.x)), np.zeros(len(core.csr[1]))
    found = {"assembly": clock(lambda: core.assemble(step, signals, residual, values), repeat)}
    K, nodes = case.K, len(case.free_nodes)
    n = 3 * nodes
    problem = Problem(n, K.nnz, symmetric=True, definite=True, has_modes=True)
    choice = vv.Iterative(method="cg", preconditioner="multigrid", tolerance=TOLERANCE).choose(problem)
    firsts, flags = np.arange(0, n + 1, 3, dtype=np.int32), np.zeros(n, np.int32)
    row, col = K.indptr.astype(np.int64), K.indices.astype(np.int32)
    linear = _core.Linear(list(choice.in_order), row, col, firsts, case.modes.ravel(), flags)
    x = np.zeros(n)

    def anew() -> None:
        linear.forget()
        linear.factor(K.data)

    found["set-up"] = clock(anew, 2)
    found["solution"] = clock(lambda: linear.solve(case.load, x), 2)
    found["iterations"] = linear.iterations
    found["defect"] = float(np.linalg.norm(K @ x - case.load) / np.linalg.norm(case.load))
    found["product"] = clock(lambda: K @ x, repeat)
    return found


def slots(case: Case, node_row: Any, node_col: Any) -> tuple[Any, Any, Any]:
    """Where pairs of nodes of cells begin among the values, entries in rows of nodes, numbers of free nodes."""
    n = len(case.free_nodes)
    free = np.full(len(case.X), -1, np.int32)
    free[case.free_nodes] = np.arange(n)
    width = (3 * np.diff(node_row)).astype(np.int32)
    rows, cols = np.repeat(free[case.cells], 8, axis=1).ravel(), np.tile(free[case.cells], (1, 8)).ravel()
    inside = (rows >= 0) & (cols >= 0)
    keys = np.repeat(np.arange(n), np.diff(node_row)) * n + node_col
    at = np.searchsorted(keys, rows[inside].astype(np.int64) * n + cols[inside])
    start = 9 * node_row[:-1].astype(np.int64)  # of the three rows of a node, each of the width above
    slot = np.zeros(len(rows), np.int64)
    slot[inside] = start[rows[inside]] + 3 * (at - node_row[rows[inside]])
    return slot.astype(np.int32), width, free


class Cycle:
    """A V-cycle of smoothed aggregation, by arrays of NumPy or of CuPy."""

    def __init__(self, levels: Any, xp: Any, sparse: Any) -> None:
        self.xp, self.sparse = xp, sparse
        move = lambda A: sparse.csr_matrix(A) if xp is np else sparse.csr_matrix(sp.csr_matrix(A))  # noqa: E731
        self.P = [move(level.P.tocsr()) for level in levels[:-1]]
        self.R = [move(level.R.tocsr()) for level in levels[:-1]]

    def set_up(self, A: Any) -> None:
        """Make the coarse matrices and what damps them."""
        xp = self.xp
        self.A, self.damped = [A], []
        for P, R in zip(self.P, self.R, strict=True):
            A = self.A[-1]
            diagonal = A.diagonal()
            v = xp.ones(A.shape[0]) / np.sqrt(A.shape[0])
            rho = 1.0
            for _ in range(12):  # largest eigenvalue, as one smooths by
                v = (A @ v) / diagonal
                rho = xp.linalg.norm(v)
                v /= rho
            self.damped.append(4.0 / (3.0 * 1.1 * rho) / diagonal)
            self.A.append(self._product(R, self._product(A, P)))
        self.coarse = xp.linalg.inv(self.A[-1].toarray())

    def _product(self, A: Any, B: Any, entries: int = 4_000_000) -> Any:
        """A B by some rows at a time: the library's product takes kilobytes for an entry."""
        step = max(1, entries * A.shape[0] // max(A.nnz, 1))
        pieces = [A[k : k + step] @ B for k in range(0, A.shape[0], step)]
        return pieces[0] if len(pieces) == 1 else self.sparse.vstack(pieces).tocsr()

    def __call__(self, b: Any, level: int = 0) -> Any:
        if level == len(self.P):
            return self.coarse @ b
        A, d = self.A[level], self.damped[level]
        x = d * b
        x += d * (b - A @ x)
        x += self.P[level] @ self(self.R[level] @ (b - A @ x), level + 1)
        x += d * (b - A @ x)
        x += d * (b - A @ x)
        return x


def conjugate_gradients(A: Any, b: Any, precondition: Callable[[Any], Any], xp: Any) -> tuple[Any, int]:
    """Solution to `TOLERANCE`, and iterations."""
    x, r = xp.zeros_like(b), b.copy()
    z = precondition(r)
    p, rz, goal = z.copy(), float(r @ z), TOLERANCE * float(xp.linalg.norm(b))
    for k in range(1, 500):
        q = A @ p
        alpha = rz / float(p @ q)
        x += alpha * p
        r -= alpha * q
        if float(xp.linalg.norm(r)) <= goal:
            return x, k
        z = precondition(r)
        rz, old = float(r @ z), rz
        p = z + (rz / old) * p
    raise RuntimeError("conjugate gradients did not converge in 500 iterations")


def on_gpu(n: int, repeat: int) -> dict[str, float]:
    """The same by CuPy."""
    import cupy as cp
    import cupyx.scipy.sparse as csp
    import pyamg

    case = Case(n)
    blocks = case.K.tobsr((3, 3)) if hasattr(case.K, "tobsr") else sp.bsr_array(case.K, blocksize=(3, 3))
    blocks.sort_indices()
    slot, width, free = slots(case, blocks.indptr.astype(np.int64), blocks.indices.astype(np.int64))
    kernel = cp.RawKernel(KERNEL, "assemble")
    position = case.system.x[: 3 * len(case.X)]
    young, poisson = 1000.0, 0.3
    mu, L = young / 2 / (1 + poisson), young * poisson / (1 + poisson) / (1 - 2 * poisson)
    given = [cp.asarray(np.ascontiguousarray(a)) for a in (case.X, position, case.cells, free, slot, width)]
    residual, values = cp.zeros(3 * len(case.free_nodes)), cp.zeros(case.K.nnz)

    def assemble() -> None:
        residual[:], values[:] = 0.0, 0.0
        kernel((len(case.cells),), (64,), (*given, cp.float64(mu), cp.float64(L), residual, values))

    wait = cp.cuda.Device().synchronize
    found = {"assembly": clock(assemble, repeat, wait)}
    A = csp.csr_matrix((values, cp.asarray(case.K.indices), cp.asarray(case.K.indptr)), shape=case.K.shape)
    found["difference"] = float(abs(values.get() - case.K.data).max() / abs(case.K.data).max())
    start = time.perf_counter()
    levels = pyamg.smoothed_aggregation_solver(
        sp.bsr_matrix(case.K, blocksize=(3, 3)), B=case.modes, max_coarse=200, improve_candidates=None
    ).levels
    found["hierarchy by the processor"] = time.perf_counter() - start
    cycle, b = Cycle(levels, cp, csp), cp.asarray(case.load)
    found["set-up"] = clock(lambda: cycle.set_up(A), 2, wait)
    x, iterations = conjugate_gradients(A, b, cycle, cp)
    found["solution"] = clock(lambda: conjugate_gradients(A, b, cycle, cp), 2, wait)
    found["iterations"] = iterations
    found["defect"] = float(np.linalg.norm(case.K @ x.get() - case.load) / np.linalg.norm(case.load))
    found["product"] = clock(lambda: A @ x, repeat, wait)
    found["bytes"] = float(cp.get_default_memory_pool().total_bytes())
    return found


def apart(n: int, threads: int) -> dict[str, float]:
    """What `ours`, or with no threads `on_gpu`, finds in a process of its own."""
    command = [sys.executable, __file__, "--one", str(n), "--threads", str(threads)]
    environment = {**os.environ, "OMP_NUM_THREADS": str(max(1, threads))}
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stderr[-3000:])
    return dict(json.loads(done.stdout.splitlines()[-1]))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--counts", type=int, nargs="+", default=[32, 69, 87], help="cells along an edge")
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2], help="of the processor")
    parser.add_argument("--one", type=int, help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.one:
        threads = asked.threads[0]
        print(json.dumps(ours(asked.one, 5) if threads else on_gpu(asked.one, 20)))
        return
    columns = ("assembly", "product", "set-up", "solution")
    print(
        f"{'unknowns':>9s} {'by':>11s} "
        + " ".join(f"{c + ' [ms]':>14s}" for c in columns)
        + "  iterations, defect"
    )
    for n in asked.counts:
        for threads in [*asked.threads, 0]:
            found = apart(n, threads)
            by = f"{threads} thread{'s' * (threads > 1)}" if threads else "GPU"
            times = " ".join(f"{1e3 * found[c]:14.2f}" for c in columns)
            print(
                f"{3 * n * (n + 1) ** 2:9d} {by:>11s} {times}  {found['iterations']:.0f}, {found['defect']:.1e}",
                flush=True,
            )
            if not threads:
                print(
                    f"          matrix differs by {found['difference']:.1e}; hierarchy by the processor "
                    f"{found['hierarchy by the processor']:.1f} s, {found['bytes'] / 1e9:.1f} GB"
                )


if __name__ == "__main__":
    main()
