"""visviva's side of the comparison."""

from __future__ import annotations

from typing import Any

import numpy as np
from cases import GRAVITY, GROUND, Case, Kind, State
from measure import Record, main

import visviva as vv

JOINTS = {
    Kind.SPHERICAL: vv.Spherical,
    Kind.REVOLUTE: vv.Revolute,
    Kind.PRISMATIC: vv.Prismatic,
    Kind.POINT_ON_LINE: vv.PointOnLine,
}


def bodies_of(case: Case) -> list[Any]:
    """The case's bodies, point masses where it has no inertia."""
    bodies: list[Any] = []
    s = case.start
    for k, (mass, J) in enumerate(zip(case.masses, case.inertias, strict=True)):
        motion = {"mass": mass, "position": s.positions[k], "velocity": s.velocities[k]}
        if not J.any():
            bodies.append(vv.PointMass(**motion))
        else:
            turn = {"rotation": s.rotations[k], "angular_velocity": s.angular_velocities[k]}
            bodies.append(vv.RigidBody(inertia=J, **motion, **turn))
    return bodies


def system_of(case: Case) -> tuple[vv.System, list[Any]]:
    """The case as a system."""
    ground, bodies = vv.Ground(), bodies_of(case)
    parts: list[Any] = [ground, *bodies, vv.Gravity(acceleration=(0, 0, -GRAVITY))]
    for joint in case.joints:
        a = ground if joint.first == GROUND else bodies[joint.first]
        b = ground if joint.second == GROUND else bodies[joint.second]
        if joint.kind is Kind.DISTANCE:
            parts.append(vv.Distance(a=a.point_at(joint.position), b=b.point_at(joint.end)))
        else:
            parts.append(JOINTS[joint.kind](a=a, b=b, at=joint.position, axis=joint.axis))
    return vv.System(parts), bodies


def state_of(system: vv.System, bodies: list[Any]) -> State:
    """Positions, rotations and velocities of all bodies."""
    x, v = system.x, system.v
    n = len(bodies)
    state = State(np.zeros((n, 3)), np.tile(np.eye(3), (n, 1, 1)), np.zeros((n, 3)), np.zeros((n, 3)))
    for k, body in enumerate(bodies):
        start = system.model.nodes[body][0][0]
        state.positions[k], state.velocities[k] = x[start : start + 3], v[start : start + 3]
        if isinstance(body, vv.RigidBody):
            D, Ddot = x[start + 3 : start + 12].reshape(3, 3), v[start + 3 : start + 12].reshape(3, 3)
            state.rotations[k] = D.T
            state.angular_velocities[k] = 0.5 * np.cross(D, Ddot).sum(axis=0)
    return state


def audit(record: Record, system: vv.System) -> None:
    """Note the ledger's energy and vertical angular momentum."""
    record.energies.append(float(system.core.energy.sum()))
    record.momenta.append(float(system.core.momentum.reshape(-1, 6).sum(axis=0)[5]))


def run(case: Case, scheme: str, step: float, steps: int, sample_every: int) -> Record:
    """March the case; see `measure.Run`."""
    system, bodies = system_of(case)
    record = Record()
    system.check()
    system.evaluate_ledger()
    audit(record, system)
    with record.timed():
        marching = vv.march(system, until=steps * step, step=step)
        for k, report in enumerate(marching, 1):
            record.iterations += report.iterations
            record.jacobians += report.factorizations
            if sample_every and k % sample_every == 0:
                record.states.append(state_of(system, bodies))
                audit(record, system)
    return record


if __name__ == "__main__":
    main("visviva", ("energy-momentum",), run)
