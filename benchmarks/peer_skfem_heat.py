"""Heat in a cube of n^3 hexahedra, the same discrete problem here and in scikit-fem, in one process.

    pip install scikit-fem pyamg
    python benchmarks/peer_skfem_heat.py [--n 40] [--steps 5]

One side is held at 1 + t, one exchanges heat, the others let none through; steps of the midpoint rule. scikit-fem
assembles its matrices once, since the problem is linear, and solves every step by conjugate gradients with smoothed
aggregation (PyAMG), as is done here. Prints seconds of one processor, and how far temperatures at the end are apart.
The assembly of visviva is that of a step, residual and tangent of a problem that it does not know to be linear.
"""

from __future__ import annotations

import argparse
import importlib
import os
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]
STEP = 0.01
EXCHANGE, AMBIENT = 2.0, 3.0


def seconds(call: Callable[[], Any]) -> tuple[float, Any]:
    """Time of the processor, and what the call gives."""
    start = time.process_time()
    found = call()
    return time.process_time() - start, found


def at_start(X: Array) -> Array:
    """Temperatures (n,) at places (n, 3)."""
    return np.asarray(np.sin(3 * X[:, 0]) * X[:, 1])


def ours(n: int, steps: int) -> tuple[float, float, float, Array, Array]:
    """Seconds of set-up, of the assembly of a step, of a step; places and temperatures at the end."""

    def made() -> tuple[vv.ThermalBody, vv.System]:
        body = vv.ThermalBody(
            mesh=vv.BoxMesh(size=(1, 1, 1), counts=(n, n, n)), conductivity=1.0, temperature=at_start
        )
        held = vv.PrescribedTemperature(body=body, nodes="x0", value="1 + t")
        cooled = vv.Convection(body=body, faces="x1", coefficient=EXCHANGE, ambient=AMBIENT)
        return body, vv.System([body, held, cooled])

    setup, (body, system) = seconds(made)
    step = vv.EnergyMomentum().step(0.0, STEP)
    signals, residual, values = system.signals(step), np.zeros(len(system.x)), np.zeros(system.core.n_entries)
    assembly, _ = seconds(lambda: system.core.assemble(step, signals, residual, values))
    marching = vv.march(system, until=steps * STEP, step=STEP)
    first, _ = seconds(lambda: next(marching))
    rest, _ = seconds(lambda: [next(marching) for _ in range(steps - 1)])
    return setup + first, assembly, rest / (steps - 1), body.points, body.temperatures(system.x)


def theirs(n: int, steps: int) -> tuple[float, float, float, Array, Array]:
    """The same of scikit-fem; the first step is part of the set-up there, too."""
    fem, amg = importlib.import_module("skfem"), importlib.import_module("pyamg")
    models = importlib.import_module("skfem.models.poisson")
    sparse = importlib.import_module("scipy.sparse.linalg")

    def made() -> Any:
        line = np.linspace(0, 1, n + 1)
        mesh = fem.MeshHex.init_tensor(line, line, line)
        return mesh, fem.Basis(mesh, fem.ElementHex1())

    setup, (mesh, basis) = seconds(made)
    outer = fem.FacetBasis(mesh, fem.ElementHex1(), facets=mesh.facets_satisfying(lambda x: x[0] > 1 - 1e-9))

    def assembled() -> Any:
        M, K = models.mass.assemble(basis), models.laplace.assemble(basis)
        return (
            M,
            K + EXCHANGE * models.mass.assemble(outer),
            EXCHANGE * AMBIENT * models.unit_load.assemble(outer),
        )

    assembly, (M, K, load) = seconds(assembled)
    X = mesh.p.T
    held = np.flatnonzero(X[:, 0] < 1e-9)
    free = np.setdiff1d(np.arange(len(X)), held)
    T = at_start(X)
    T[held] = 1.0
    A, B = (M / STEP + 0.5 * K).tocsr(), (M / STEP - 0.5 * K).tocsr()
    inner, beside = A[free][:, free].tocsr(), A[free][:, held]
    hierarchy, ml = seconds(lambda: amg.smoothed_aggregation_solver(inner))
    precondition, spent = ml.aspreconditioner(), []

    def solved(t1: float) -> None:
        right = (B @ T + load)[free] - beside @ np.full(len(held), 1 + t1)
        found, failed = sparse.cg(inner, right, x0=T[free], rtol=1e-8, M=precondition)
        assert not failed
        T[free], T[held] = found, 1 + t1

    for k in range(steps):
        spent.append(seconds(lambda k=k: solved((k + 1) * STEP))[0])
    return setup + assembly + hierarchy + spent[0], assembly, float(np.mean(spent[1:])), X, T


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--n", type=int, default=40, help="cells along an edge")
    parser.add_argument("--steps", type=int, default=5)
    given = parser.parse_args()
    found = {"visviva": ours(given.n, given.steps), "scikit-fem": theirs(given.n, given.steps)}
    print(f"{(given.n + 1) ** 3} nodes    to the first step   assembly   step, s")
    for name, (first, assembly, step, _, _) in found.items():
        print(f"{name:12s} {first:17.3f} {assembly:14.4f} {step:9.4f}")
    sorted_by_place = [T[np.lexsort(np.round(X, 9).T)] for *_, X, T in found.values()]
    print(f"temperatures differ by {np.abs(sorted_by_place[0] - sorted_by_place[1]).max():.1e}")


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    main()
