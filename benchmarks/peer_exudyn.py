"""The benchmark cases in Exudyn, with its default settings except for files, step and linear solver.

Rigid bodies have Euler-parameter nodes and the Newton iteration is the modified one: both are its defaults.
It offers no rope over a winch, so the crane's rope is a distance of constant length.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

import numpy as np
from audit import Body
from cases import GRAVITY, Array, Case, Joint, Kind, State
from measure import Record, parser, report
from numpy.typing import NDArray

Indices = NDArray[np.intp]
SCHEMES = ("trapezoidal", "generalised-alpha")


class Model:
    """The Exudyn system of a case."""

    def __init__(self, case: Case) -> None:
        import exudyn

        self.exudyn, self.case = exudyn, case
        self.container = exudyn.SystemContainer()
        self.system: Any = self.container.AddSystem()
        self.ground = self.system.CreateGround()
        self.items: list[Any] = []
        for index, point in enumerate(case.is_point):
            self.items.append(self.add_point(index) if point else self.add_body(index))
        for joint in case.joints:
            JOINTS[joint.kind](self, joint)
        self.system.Assemble()
        self.rows, self.turning = self.coordinate_rows()
        self.reference = np.array(
            self.system.systemData.GetODE2Coordinates(exudyn.ConfigurationType.Reference)
        )

    def common(self, index: int) -> dict[str, Any]:
        start = self.case.start
        return {
            "referencePosition": start.positions[index],
            "initialVelocity": start.velocities[index],
            "gravity": [0, 0, -GRAVITY],
            "show": False,
        }

    def add_point(self, index: int) -> Any:
        return self.system.CreateMassPoint(mass=self.case.masses[index], **self.common(index))

    def add_body(self, index: int) -> Any:
        from exudyn import rigidBodyUtilities

        start = self.case.start
        inertia: Any = rigidBodyUtilities.RigidBodyInertia(  # type: ignore[no-untyped-call]
            mass=self.case.masses[index], inertiaTensor=self.case.inertias[index]
        )
        return self.system.CreateRigidBody(
            inertia=inertia,
            referenceRotationMatrix=start.rotations[index],
            initialAngularVelocity=start.angular_velocities[index],
            **self.common(index),
        )

    def pair(self, joint: Joint) -> list[Any]:
        """The joined items; -1 is the last entry, the ground."""
        items = [*self.items, self.ground]
        return [items[joint.first], items[joint.second]]

    def spherical(self, joint: Joint) -> None:
        self.system.CreateSphericalJoint(itemNumbers=self.pair(joint), position=joint.position, show=False)

    def revolute(self, joint: Joint) -> None:
        self.system.CreateRevoluteJoint(
            itemNumbers=self.pair(joint), position=joint.position, axis=joint.axis, show=False
        )

    def prismatic(self, joint: Joint) -> None:
        self.system.CreatePrismaticJoint(
            itemNumbers=self.pair(joint), position=joint.position, axis=joint.axis, show=False
        )

    def point_on_line(self, joint: Joint) -> None:
        """A ball joint with the axis left free, which the ground's own axes allow along a global axis."""
        held = [int(abs(component) < 0.5) for component in joint.axis]
        self.system.CreateSphericalJoint(
            itemNumbers=self.pair(joint), position=joint.position, constrainedAxes=held, show=False
        )

    def distance(self, joint: Joint) -> None:
        assert joint.end is not None
        self.system.CreateDistanceConstraint(
            itemNumbers=self.pair(joint),
            localPosition0=self.local(joint.first, joint.position),
            localPosition1=self.local(joint.second, joint.end),
            show=False,
        )

    def local(self, index: int, point: Array) -> Array:
        """A global point of the start in the body's own axes."""
        body = Body(self.case, self.case.start, index)
        return np.asarray(self.case.start.rotations[index].T @ (point - body.centre))

    def coordinate_rows(self) -> tuple[Indices, Indices]:
        """First coordinate of each body, and which of them have Euler parameters behind the position."""
        nodes = [self.system.GetObject(item)["nodeNumber"] for item in self.items]
        rows = np.array([self.system.GetNodeODE2Index(node) for node in nodes])
        return rows, np.flatnonzero(~self.case.is_point)

    def state(self) -> State:
        """The current state from the system's coordinates."""
        data, n = self.system.systemData, len(self.rows)
        # GetODE2CoordinatesTotal corrupts memory in 1.13.6, so the sum is formed here.
        place = self.reference + np.array(data.GetODE2Coordinates())
        rate = np.array(data.GetODE2Coordinates_t())
        first = self.rows[:, None] + np.arange(3)
        rotations, spins = np.tile(np.eye(3), (n, 1, 1)), np.zeros((n, 3))
        parameters = self.rows[self.turning][:, None] + np.arange(3, 7)
        rotations[self.turning] = rotation_matrices(place[parameters])
        spins[self.turning] = angular_velocities(place[parameters], rate[parameters])
        return State(place[first], rotations, rate[first], spins)


JOINTS: dict[Kind, Callable[[Model, Joint], None]] = {
    Kind.SPHERICAL: Model.spherical,
    Kind.REVOLUTE: Model.revolute,
    Kind.PRISMATIC: Model.prismatic,
    Kind.POINT_ON_LINE: Model.point_on_line,
    Kind.DISTANCE: Model.distance,
}


def rotation_matrices(parameters: Array) -> Array:
    """Rotation matrices (n, 3, 3) of Euler parameters (n, 4), scalar part first."""
    w, x, y, z = parameters.T
    rows = [
        [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]
    return np.moveaxis(np.array(rows), -1, 0)


def angular_velocities(parameters: Array, rates: Array) -> Array:
    """Global angular velocities (n, 3) of Euler parameters (n, 4) and their rates."""
    scalar, vector = parameters[:, :1], parameters[:, 1:]
    return np.asarray(2 * (scalar * rates[:, 1:] - rates[:, :1] * vector + np.cross(vector, rates[:, 1:])))


def settings(model: Model, scheme: str, step: float, steps: int) -> Any:
    """Default settings; the trapezoidal rule is the Newmark scheme with constraints at velocity level."""
    chosen = model.exudyn.SimulationSettings()
    time = chosen.timeIntegration
    time.numberOfSteps, time.endTime = steps, steps * step
    time.generalizedAlpha.spectralRadius = 0.9
    time.generalizedAlpha.useNewmark = scheme == "trapezoidal"
    time.generalizedAlpha.useIndex2Constraints = scheme == "trapezoidal"
    chosen.solution.file.write = False
    chosen.solution.sensors.active = False
    chosen.parallel.numberOfThreads = 1
    # The default is dense: equal within the noise for three or four bodies, half as fast for ten.
    chosen.linearSolver.solverType = model.exudyn.LinearSolverType.EigenSparse
    chosen.linearSolver.reuseAnalyzedPattern = True
    return chosen


def observe(model: Model, record: Record, step: float, every: int) -> None:
    """Record a state after every so many steps, counted by the time, since the solver may shorten steps."""

    def after_step(system: Any, time: float) -> bool:
        if time >= (len(record.states) + 1) * every * step * (1 - 1e-12):
            record.states.append(model.state())
        return True

    model.system.SetPostStepUserFunction(after_step)


def run(case: Case, scheme: str, step: float, steps: int, sample_every: int) -> Record:
    """Simulate a case; see `measure.Run`."""
    model, record = Model(case), Record()
    if sample_every:
        observe(model, record, step, sample_every)
    solver, chosen = model.exudyn.MainSolverImplicitSecondOrder(), settings(model, scheme, step, steps)
    if not solver.InitializeSolver(model.system, chosen):
        raise RuntimeError("Exudyn: the solver could not be initialised")
    with record.timed():
        success = solver.SolveSteps(model.system, chosen)
    solver.FinalizeSolver(model.system, chosen)
    if not success:
        raise RuntimeError(f"Exudyn stopped at t = {solver.it.currentTime:g}")
    record.iterations, record.jacobians = solver.it.newtonStepsCount, solver.it.newtonJacobiCount
    return record


def main() -> None:
    """Command line; `--fast` loads the build of Exudyn without range checks and with AVX2."""
    options = parser(SCHEMES)
    options.add_argument("--fast", action="store_true", help="load exudynCPPfast")
    chosen = options.parse_args()
    sys.exudynFast = chosen.fast  # type: ignore[attr-defined]  # read when exudyn is imported, hence late imports
    report("exudyn (fast)" if chosen.fast else "exudyn", run, chosen)


if __name__ == "__main__":
    main()
