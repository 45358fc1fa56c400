"""How much faster several processes are, part by part, and what the memory of each goes to.

    python benchmarks/ranks.py [--cells 16000] [--most 2] [--rounds 20]
    mpiexec -n 2 python benchmarks/ranks.py --memory [--cells 64000]      what the memory of a process goes to

starts itself with one process and with several: with the same cells (strong scaling) and with as many to each (weak).
Printed are milliseconds of the clock, the least of the rounds, with the efficiency: 1 where so many processes take the
same time for as many times the work. Every program that runs beside spoils these figures; processes that wait for
others use up a core. A last table compares PETSc with the solvers of the core in one process.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import visviva as vv
from visviva.analysis.march import prepare
from visviva.base.world import world

RUBBER = vv.NeoHooke(young=1000.0, poisson=0.3)
WAITING = {"MPIR_CVAR_POLLS_BEFORE_YIELD": "1", "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


def block(n_cells: int, linear: Any = None, density: float = 0.0) -> vv.System:
    """A block that is pulled at one end; its length grows with its cells."""
    n = max(2, round((n_cells / 4) ** (1 / 3)))
    counts = (max(2, n_cells // n**2), n, n)
    mesh = vv.BoxMesh(size=(counts[0] / n, 1, 1), counts=counts)
    solid = vv.Solid(mesh=mesh, material=RUBBER, density=density)
    pull = vv.Traction(solid=solid, faces="x1", traction=(20.0, 0, 0), times="t")
    return vv.System([solid, vv.Fixed(solid=solid, nodes="x0"), pull], newton=vv.Newton(linear=linear))


def cavity(n_cells: int) -> vv.System:
    """Water in a square box with a lid that moves, elements Q2Q1."""
    n = max(4, round(n_cells**0.5))
    mesh = vv.RectangleMesh(size=(1, 1), counts=(n, n), cell="quad9")
    water = vv.Fluid(mesh=mesh, density=1.0, viscosity=0.01)
    lid = vv.VelocityBoundary(fluid=water, faces="y1", velocity=("t", 0, 0))
    return vv.System([water, lid, *(vv.NoSlip(fluid=water, faces=f) for f in ("x0", "x1", "y0"))])


def least(work: Callable[[], Any], rounds: int) -> float:
    """Milliseconds of the clock that all processes take together, at least."""
    found = np.inf
    for _ in range(rounds):
        world().largest(0.0)
        start = time.perf_counter()
        work()
        found = min(found, world().largest(time.perf_counter() - start))
    return 1e3 * found


def assembly(system: vv.System, scheme: vv.Scheme) -> Callable[[], Any]:
    """Residual and tangent of a step."""
    prepare(system, scheme)
    step, core = scheme.step(system.time, 0.1), system.core
    signals, residual, values = system.signals(step).copy(), np.zeros(len(system.x)), np.zeros(core.n_entries)
    return lambda: core.assemble(step, signals, residual, values)


def measured(n_cells: int, rounds: int) -> dict[str, float]:
    """Of every part, and what a process holds at most."""
    found = {
        "assembly of solids": least(assembly(block(n_cells), vv.Static()), rounds),
        "assembly of solids in time steps": least(
            assembly(block(n_cells, density=1.0), vv.EnergyMomentum()), rounds
        ),
        "assembly of flow": least(assembly(cavity(n_cells), vv.EnergyMomentum()), rounds),
    }
    system = block(n_cells, vv.Petsc())
    prepare(system, vv.Static())
    found["a step of statics, PETSc"] = least(
        lambda: vv.quasi_static(system, until=system.time + 1, step=1.0), 1
    )
    return found


def print_memory(n_cells: int) -> None:
    """By how much a process grows from part to part of a step of statics, in bytes for each unknown of the system."""
    from visviva_petsc.solver import Solver

    grown: dict[str, float] = {}
    last = [resident()]

    def note(part: str) -> None:
        now = resident()
        grown[part] = grown.get(part, 0.0) + world().largest(now - last[0])
        last[0] = now

    def noted(name: str, part: str) -> None:
        work = getattr(Solver, name)

        def during(self: Any, *given: Any) -> Any:
            note("the rest")
            done = work(self, *given)
            note(part)
            return done

        setattr(Solver, name, during)

    system = block(n_cells, vv.Petsc())
    n = len(system.x)
    note("model, vectors, terms and pattern of the core")
    prepare(system, vv.Static())
    note("checks before the first step")
    for name, part in (("analyze", "matrix of PETSc"), ("factor", "its multigrid"), ("solve", "its vectors")):
        noted(name, part)
    vv.quasi_static(system, until=1.0, step=1.0)
    note("the rest")
    most = world().largest(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024)
    if world().rank == 0:
        print(
            f"{world().size} processes, {n} unknowns; at most {most / n:.0f} bytes for each of them, of these"
        )
        for part, size in grown.items():
            print(f"  {part:<48} {size / n:>6.0f}")


def resident() -> float:
    """Bytes in memory at present."""
    with open("/proc/self/statm", encoding="ascii") as file:
        return float(file.read().split()[1]) * resource.getpagesize()


def launched(n: int, n_cells: int, rounds: int) -> dict[str, float]:
    """What so many processes measure."""
    command = [sys.executable, __file__, "--here", "--cells", str(n_cells), "--rounds", str(rounds)]
    environment = os.environ | WAITING
    done = subprocess.run(
        ["mpiexec", "-n", str(n), *command], env=environment, capture_output=True, text=True, check=True
    )
    found: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
    return found


def print_scaling(n_cells: int, most: int, rounds: int) -> None:
    """Tables of strong and of weak scaling."""
    one = launched(1, n_cells, rounds)
    n = 2
    while n <= most:
        same, more = launched(n, n_cells, rounds), launched(n, n * n_cells, rounds)
        print(f"{n} processes; ms, and efficiency: {n_cells} cells, and {n * n_cells}")
        for name, alone in one.items():
            strong, weak = alone / n / same[name], alone / more[name]
            print(
                f"  {name:<34} {alone:>9.1f} {same[name]:>9.1f} {strong:>6.2f} {more[name]:>9.1f} {weak:>6.2f}"
            )
        n *= 2


def print_comparison(n_cells: int) -> None:
    """PETSc and the solvers of the core in one process: processor seconds of a step of statics."""
    for name, linear in (("core", None), ("PETSc", vv.Petsc())):
        system = block(n_cells, linear)
        prepare(system, vv.Static())
        start = time.process_time()
        vv.quasi_static(system, until=1.0, step=1.0)
        print(
            f"  {name:<6} {time.process_time() - start:>7.2f} s, {len(system.x)} unknowns: {system.linear_explanation}"
        )


def main() -> None:
    """Print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--cells", type=int, default=16_000)
    parser.add_argument("--most", type=int, default=2, help="processes")
    parser.add_argument("--rounds", type=int, default=20)
    parser.add_argument("--memory", action="store_true", help="of the processes that were started, by part")
    parser.add_argument("--here", action="store_true", help="measure in the processes that were started")
    given = parser.parse_args()
    if given.here:
        found = measured(given.cells, given.rounds)
        if world().rank == 0:
            print(json.dumps(found))
        return
    if given.memory:
        print_memory(given.cells)
        return
    print_scaling(given.cells, given.most, given.rounds)
    print("one process, a step of statics")
    print_comparison(given.cells)


if __name__ == "__main__":
    main()
