"""visviva's side of the comparison of flows: midpoint steps, elements of Taylor and Hood or stabilised ones."""

from __future__ import annotations

import numpy as np
from flow_case import Array, FlowCase, main
from ours_solids import marched, whole_iteration
from record import Record

import visviva as vv

CELLS = {"Q2Q1": "quad9", "Q1Q1": "quad4"}


def system_of(case: FlowCase, elements: str) -> tuple[vv.System, vv.Fluid]:
    """The case as a system."""

    def inflow(t: float, X: Array) -> Array:
        return np.asarray(case.strength(t) * case.profile(X[:, 1:2]) * [1.0, 0.0, 0.0])

    mesh = vv.RectangleMesh(size=(case.length, case.height), counts=case.counts, cell=CELLS[elements])
    fluid = vv.Fluid(
        mesh=mesh, density=case.density, viscosity=case.viscosity, velocity=lambda X: inflow(0.0, X)
    )
    boundary = [
        vv.VelocityBoundary(fluid=fluid, faces="x0", velocity=inflow),
        *(vv.NoSlip(fluid=fluid, faces=side) for side in ("y0", "y1")),
        vv.Outlet(fluid=fluid, faces="x1"),
    ]
    return vv.System([fluid, *boundary], vv.Newton(tolerance=case.tolerance)), fluid


def run(case: FlowCase, variant: str) -> Record:
    """March the case."""
    system, fluid = system_of(case, variant)
    scheme = vv.EnergyMomentum()
    record = marched(system, scheme, case.step, case.steps)
    record.note(float(fluid.at([case.middle]).velocities(system.x)[0, 0]))
    whole_iteration(record, system, scheme.step(system.time, case.step))
    return record


if __name__ == "__main__":
    main(run, ("Q2Q1", "Q1Q1"))
