"""Mechanics and heat in turn beside all unknowns at once, and what a single turn loses.

    python benchmarks/staggered.py [--around 60] [--cells 14]

A spinning torus without boundaries, steps of some lengths; a cube that is clamped and held at one side and heated at
the other, steps of dynamics and one of statics: seconds of one processor for a step, and Newton's iterations. Then the
energy of a free, uneven block: turns to the end of the iteration, and one turn of each, in which the mechanics see the
entropies where the step begins, and heat where they end.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import numpy as np
from heat import torus
from numpy.typing import NDArray

import visviva as vv
from visviva.system.steps import Attempt

Array = NDArray[np.float64]
IN_TURN = vv.Newton(linear=vv.Staggered())


def beside(
    name: str, make: Callable[[vv.Newton], vv.System], run: Callable[[vv.System], object], steps: int
) -> None:
    """Prints seconds of a step, all at once and in turn, the least of two rounds each."""
    newtons = {"at once": vv.Newton(), "in turn": IN_TURN}
    least, ends, iterations = dict.fromkeys(newtons, np.inf), {}, {}
    for _ in range(2):
        for how, newton in newtons.items():
            system = make(newton)
            start = time.process_time()
            iterations[how] = run(system)
            least[how] = min(least[how], (time.process_time() - start) / steps)
            ends[how] = system.x.copy()
    apart = np.abs(ends["at once"] - ends["in turn"]).max() / np.abs(ends["at once"]).max()
    counts = " ".join(f"{iterations[how]:8.1f}" for how in newtons)
    seconds = " ".join(f"{least[how]:9.4f}" for how in newtons)
    print(f"{name:28s} {len(system.x):8d} {seconds} {counts} {apart:9.0e}")


def spinning(around: int, length: float) -> None:
    warm = vv.Heat(conductivity=5.0, capacity=1.0, expansion=1e-4)

    def make(newton: vv.Newton) -> vv.System:
        given = {"heat": warm, "temperature": lambda X: 293.15 + X[:, 0] / 10}
        return vv.System(list(torus(around, vv.ThermoelasticSolid, **given).components), newton)

    def run(system: vv.System) -> float:
        return float(np.mean([system.step(length).iterations for _ in range(20)]))

    beside(f"torus, steps of {length:g}", make, run, 20)


def heated(cells: int) -> None:
    def make(newton: vv.Newton) -> vv.System:
        body = vv.ThermoelasticSolid(
            mesh=vv.BoxMesh(size=(1, 1, 1), counts=(cells,) * 3),
            material=vv.NeoHooke(young=1e5, poisson=0.3),
            density=1000.0,
            heat=vv.Heat(conductivity=1.0, capacity=1e3, expansion=1e-3),
        )
        held = vv.PrescribedTemperature(body=body, nodes="x0", value=293.15)
        flux = vv.HeatFlux(body=body, faces="x1", flux=20.0)
        return vv.System([body, vv.Fixed(solid=body, nodes="x0"), held, flux], newton)

    def moved(system: vv.System) -> float:
        return vv.simulate(system, until=4.0, step=2.0).statistics.iterations / 2

    def still(system: vv.System) -> float:
        return vv.quasi_static(system, until=1.0, step=1.0).statistics.iterations

    beside("cube, steps of 2", make, moved, 2)
    beside("cube, statics", make, still, 1)


def block(newton: vv.Newton | None = None) -> vv.System:
    """Hot and cold, spinning, as the torus is but for its coupling number of 0.03."""
    body = vv.ThermoelasticSolid(
        mesh=vv.BoxMesh(size=(10, 8, 6), counts=(2, 2, 2)),
        material=vv.NeoHooke(young=2250.0, poisson=0.3),
        density=0.1,
        heat=vv.Heat(conductivity=5.0, capacity=1.0, expansion=1e-4),
        temperature=lambda X: 293.15 + 5 * X[:, 0],
        angular_velocity=(0.1, 0.2, 0.3),
    )
    return vv.System([body], newton)


def one_turn(system: vv.System, h: float) -> None:
    """A step whose mechanics are solved once, by the entropies at its start, and then its heat, once."""
    import scipy.sparse as sp
    from scipy.sparse.linalg import spsolve

    scheme, core = vv.EnergyMomentum(), system.core
    step = scheme.step(system.time, h)
    row, col, unknown = (np.array(a) for a in core.csr)
    residual, values = np.zeros(len(system.x)), np.zeros(len(col))
    core.dx[:] = h * np.where(system.order == 2, system.v, 0.0)
    for is_mechanics in (True, False):
        part = np.flatnonzero((system.order[unknown] == 2) == is_mechanics)
        for _ in range(8):
            core.assemble(step, system.signals(step), residual, values)
            A = sp.csr_array((values, col, row), shape=(len(unknown),) * 2)[part][:, part]
            core.dx[unknown[part]] -= spsolve(A.tocsc(), residual[unknown[part]])
    system.accept(Attempt(step, system.signals(step).copy(), None), scheme)


def lost(h: float, until: float = 2.0) -> None:
    """Prints the largest change of the energy, relative to what moves at the start."""
    found = []
    for way in (lambda system: system.step(h), lambda system: one_turn(system, h)):
        system = block(IN_TURN)
        system.evaluate_ledger()
        start, change = system.core.energy.sum(), 0.0
        moving = [account.kind == "kinetic" for account in system.model.accounts]
        kinetic = system.core.energy[moving].sum()
        for _ in range(round(until / h)):
            way(system)
            change = max(change, abs(system.core.energy.sum() - start))
        found.append(change / kinetic)
    print(f"{h:28g} {found[0]:12.1e} {found[1]:12.1e}")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--around", type=int, default=60, help="cells around the torus")
    parser.add_argument("--cells", type=int, default=14, help="along an edge of the cube")
    given = parser.parse_args()
    print(f"{'':28s} unknowns  at once   in turn  iterations         apart by")
    for length in (0.02, 0.1, 0.4):
        spinning(given.around, length)
    heated(given.cells)
    print("energy, steps of               in turn     one turn")
    for h in (0.05, 0.1, 0.2):
        lost(h)


if __name__ == "__main__":
    main()
