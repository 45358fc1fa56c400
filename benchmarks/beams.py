"""What a step of a beam costs, beside Exudyn's geometrically exact beam where that is installed.

    python benchmarks/beams.py [--steps 50]

The flying spaghetti of Simo & Vu-Quoc (1988) in two-node elements, the first steps of its loads, one thread. Ours is
the energy-momentum scheme with its default tolerance, Exudyn's is generalised alpha with modified Newton and a
relative tolerance of 1e-6. The time is that of stepping alone, of the processor; ours counts the ledger.
"""

from __future__ import annotations

import argparse
import importlib.util
import itertools
import time
from typing import Any

import numpy as np

import visviva as vv
from visviva.examples import spaghetti

CASES = ((16, 0.01), (833, 0.01), (1429, 0.001), (8333, 0.001))
"""Elements and step."""


def ours(count: int, step: float, steps: int) -> tuple[float, Any]:
    """Milliseconds per step, and where the loaded end is."""
    system = spaghetti.study(count=count, step=step).system
    for _ in vv.march(system, until=step, step=step):
        pass
    start = time.process_time()
    for _ in vv.march(system, until=steps * step, step=step):
        pass
    took = 1e3 * (time.process_time() - start) / (steps - 1)
    (beam,) = (c for c in system.components if isinstance(c, vv.Beam))
    return took, beam.positions(system.x)[0]


def exudyns(count: int, step: float, steps: int) -> tuple[float, Any]:
    """The same of Exudyn."""
    import exudyn as exu
    from exudyn import itemInterface as items
    from exudyn import utilities

    system = exu.SystemContainer().AddSystem()
    start, end = np.array([6.0, 0, 0]), np.array([0, 8.0, 0])
    along = (end - start) / 10.0
    across = np.array([0, 0, 1.0])
    turn = utilities.RotationMatrix2EulerParameters(
        np.stack([along, across, np.cross(along, across)], axis=1)
    )
    places = [start + (end - start) * k / count for k in range(count + 1)]
    nodes = [system.AddNode(items.NodeRigidBodyEP(referenceCoordinates=[*p, *turn])) for p in places]
    section = exu.BeamSection()
    section.stiffnessMatrix = np.diag([1e4, 1e4, 1e4, 500, 500, 500])
    section.inertia, section.massPerLength = np.diag([20.0, 10, 10]), 1.0
    for pair in itertools.pairwise(nodes):
        system.AddObject(
            items.ObjectBeamGeometricallyExact(
                nodeNumbers=list(pair), length=10.0 / count, sectionData=section
            )
        )
    marker = system.AddMarker(items.MarkerNodeRigid(nodeNumber=nodes[0]))
    system.AddLoad(
        items.LoadForceVector(
            markerNumber=marker, loadVectorUserFunction=lambda m, t, v: [0.1 * pulse(t), 0, 0]
        )
    )
    system.AddLoad(
        items.LoadTorqueVector(
            markerNumber=marker, loadVectorUserFunction=lambda m, t, v: [0, -0.5 * pulse(t), -pulse(t)]
        )
    )
    system.Assemble()
    options = exu.SimulationSettings()
    options.timeIntegration.numberOfSteps, options.timeIntegration.endTime = steps, steps * step
    options.timeIntegration.generalizedAlpha.spectralRadius = 0.9
    options.timeIntegration.newton.useModifiedNewton = True
    options.timeIntegration.newton.relativeTolerance = 1e-6  # round-off of many elements is above its 1e-8
    options.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    options.solution.file.write = False
    begin = time.process_time()
    system.SolveDynamic(options)
    took = 1e3 * (time.process_time() - begin) / steps
    return took, system.GetNodeOutput(nodes[0], exu.OutputVariableType.Position)


def pulse(t: float) -> float:
    return 80 * t if t < 2.5 else max(0.0, 400 - 80 * t)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--steps", type=int, default=50)
    steps = parser.parse_args().steps
    has_peer = importlib.util.find_spec("exudyn") is not None
    print("| elements | unknowns in directors | step | ours ms | Exudyn ms | ratio | distance of ends |")
    print("|---|---|---|---|---|---|---|")
    for count, step in CASES:
        mine, end = min((ours(count, step, steps) for _ in range(3)), key=lambda pair: pair[0])
        other, ratio, apart = "", "", ""
        if has_peer:
            try:
                theirs, place = min((exudyns(count, step, steps) for _ in range(3)), key=lambda pair: pair[0])
                other, ratio = f"{theirs:.3g}", f"{theirs / mine:.1f}"
                apart = f"{np.linalg.norm(np.asarray(place) - end):.1e}"
            except Exception as error:  # the peer's own errors have no base class of ours
                other = type(error).__name__
        print(
            f"| {count} | {12 * (count + 1)} | {step:g} | {mine:.3g} | {other} | {ratio} | {apart} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
