"""What a step of a shell costs, beside Kratos' four-node shells where that is installed.

    python benchmarks/shells.py [--rounds 3] [--steps 10] [--counts 40]

Two cases, ours and Kratos' in turn, one thread, the least of the rounds. *Plate*: a clamped square plate that swings
with large rotations, by the energy-momentum scheme, and by Newmark's in Kratos; the time is that of a step, ledger
included. *Cylinder*: the example `pinched_cylinder` in load steps to a tenth of the largest force; the time is that of
the whole path. Kratos (of PyPI, with its StructuralMechanicsApplication and LinearSolversApplication) has corotational
thin shells, and Eigen's sparse LU as the fastest of its direct solvers. Deflections tell that both solve the same.
"""

from __future__ import annotations

import argparse
import importlib.util
import os
import time
from collections.abc import Callable
from dataclasses import dataclass

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from shell_cases import CYLINDER, PLATE

import visviva as vv
from visviva.examples import pinched_cylinder


@dataclass(frozen=True)
class Run:
    """Seconds, iterations of Newton's method, and the deflection that was found."""

    seconds: float
    iterations: float
    deflection: float


def plate(count: int, steps: int) -> Run:
    """Ours: seconds per step."""
    case = PLATE
    shell = vv.Shell(
        mesh=vv.RectangleMesh(size=(1.0, 1.0), counts=(count, count)),
        section=vv.HomogeneousSection(
            thickness=case.thickness, young=case.young, poisson=case.poisson, density=case.density
        ),
        velocity=lambda X: np.stack([0 * X[:, 0], 0 * X[:, 0], case.velocity(X[:, 0])], axis=1),
    )
    system = vv.System([shell, vv.Clamped(solid=shell, nodes="x0")])
    scheme = vv.EnergyMomentum()
    system.step(case.step, scheme)
    start = time.process_time()
    reports = [system.step(case.step, scheme) for _ in range(steps)]
    took = (time.process_time() - start) / steps
    corner = np.argmax(shell.points[:, 0] + shell.points[:, 1])
    found = float(shell.positions(system.x)[corner, 2])
    return Run(took, sum(r.iterations for r in reports) / steps, found)


def cylinder(count: int, steps: int) -> Run:
    """Ours: seconds of all load steps."""
    system = pinched_cylinder.study(count=count).system
    start = time.process_time()
    reports = list(vv.march(system, until=1.0, step=1.0 / CYLINDER.load_steps, scheme=vv.Static()))
    took = time.process_time() - start
    (tube,) = (c for c in system.components if isinstance(c, vv.Shell))
    top = np.argmin(np.linalg.norm(tube.points - np.array((0, 100.0, 100.0)), axis=1))
    return Run(took, len(reports), 100.0 - float(tube.positions(system.x)[top, 2]))


def peers() -> dict[str, dict[str, Callable[[int, int], Run]]]:
    """Kratos' elements by case, none where it is missing."""
    if importlib.util.find_spec("KratosMultiphysics") is None:
        return {"plate": {}, "cylinder": {}}
    import peer_kratos_shells as kratos

    return {
        "plate": {k: lambda n, s, k=k: Run(*kratos.plate(k, n, s)) for k in kratos.ELEMENTS},
        "cylinder": {k: lambda n, s, k=k: Run(*kratos.cylinder(k, n)) for k in kratos.ELEMENTS},
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--steps", type=int, default=10)
    parser.add_argument("--counts", type=int, nargs="+", default=[40])
    given = parser.parse_args()
    others = peers()
    if not others["plate"]:
        print("Kratos is not installed")
    print("| case | unknowns | code | s | by ours | iterations | deflection |")
    print("|---|---|---|---|---|---|---|")
    for case, ours in (("plate", plate), ("cylinder", cylinder)):
        for count in given.counts:
            codes = {"visviva": ours, **others[case]}
            runs: dict[str, list[Run]] = {name: [] for name in codes}
            for _ in range(given.rounds):
                for name, code in codes.items():
                    runs[name].append(code(count, given.steps))
            best = {name: min(found, key=lambda r: r.seconds) for name, found in runs.items()}
            for name, r in best.items():
                ratio = r.seconds / best["visviva"].seconds
                print(
                    f"| {case} | {6 * (count + 1) ** 2} | {name} | {r.seconds:.3g} | {ratio:.1f} "
                    f"| {r.iterations:.1f} | {r.deflection:.5g} |",
                    flush=True,
                )


if __name__ == "__main__":
    main()
