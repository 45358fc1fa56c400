"""visviva's side of the comparison of solids: energy-momentum steps, or the trapezoidal rule like the others."""

from __future__ import annotations

from typing import Any

import numpy as np
from record import Record
from solid_cases import TOLERANCE, SolidCase
from solid_measure import main, mean_displacement

import visviva as vv
from visviva.analysis.march import prepare


def system_of(case: SolidCase) -> tuple[vv.System, vv.Solid]:
    """The case as a system."""
    mesh = vv.Mesh(points=case.points, cells={"hex8": case.cells})
    rubber = vv.NeoHooke(young=case.young, poisson=case.poisson)
    solid = vv.Solid(mesh=mesh, material=rubber, density=case.density, velocity=lambda X: case.velocity)
    parts: list[Any] = [solid]
    for motion in np.unique(case.motion[case.held], axis=0):
        nodes = np.flatnonzero(case.held & (case.motion == motion).all(axis=1))
        moved = [f"{move} * t" for move in motion]
        parts.append(vv.Prescribed(solid=solid, nodes=nodes, motion=tuple(moved)))
    return vv.System(parts, vv.Newton(tolerance=TOLERANCE)), solid


def scheme_of(case: SolidCase, variant: str) -> vv.Scheme:
    """Generalised-alpha is the trapezoidal rule if nothing is damped."""
    if case.density == 0:
        return vv.Static(tolerance=TOLERANCE)
    return vv.EnergyMomentum() if variant == "energy-momentum" else vv.GeneralizedAlpha(rho=1.0)


def marched(system: vv.System, scheme: vv.Scheme, step: float, steps: int) -> Record:
    """Time so many steps of a system."""
    record = Record()
    prepare(system, scheme)
    marching = vv.march(system, until=steps * step, step=step, scheme=scheme)
    for _ in range(steps):
        with record.timed("cpu"):
            report = next(marching)
        record.steps += 1
        record.iterations += report.iterations
    return record


def whole_iteration(record: Record, system: vv.System, step: Any) -> None:
    """Time residual, tangent and solution on their own, for in the steps a tangent may serve many iterations.

    No solver needs the tangent copied to Python; what that takes is subtracted.
    """
    core, signals = system.core, system.signals(step).copy()
    residual, d, whole = np.zeros(len(system.x)), np.zeros(len(system.x)), Record()
    copying = Record()
    values = np.zeros(len(system.pattern[1]))
    right = np.random.default_rng(0).standard_normal(len(d))
    core.assemble(step, signals, residual, values)  # memory touched for the first time is slow
    other = values.copy()
    for _ in range(3):
        with record.timed("assembly"):
            core.assemble(step, signals, residual, values)
        with copying.timed("cpu"):
            np.copyto(other, values)
        with whole.timed("cpu"):
            core.linearise(step, signals, residual)
            core.linear_solve(step, right, d)
    record.assembly = (record.assembly - copying.cpu) * record.iterations / 3
    record.solution = whole.cpu * record.iterations / 3 - record.assembly


def run(case: SolidCase, variant: str, audited: bool) -> Record:
    """March the case; see `solid_measure.main`."""
    system, solid = system_of(case)
    scheme, record = scheme_of(case, variant), Record()
    prepare(system, scheme)
    marching = vv.march(system, until=case.steps * case.step, step=case.step, scheme=scheme)
    for _ in range(case.steps):
        if audited:
            system.evaluate_ledger()
            record.energies.append(float(system.core.energy.sum()))
        with record.timed("cpu"):
            report = next(marching)
        record.steps += 1
        record.iterations += report.iterations
    record.note(mean_displacement(solid.displacements(system.x)))
    whole_iteration(record, system, scheme.step(system.time, case.step))
    return record


if __name__ == "__main__":
    main(run, ("energy-momentum", "trapezoidal"))
