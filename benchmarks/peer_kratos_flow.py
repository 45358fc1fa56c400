"""The flow in Kratos (KratosFluidDynamicsApplication of PyPI): stabilised elements, Bossak's scheme, AMGCL.

Its own elements (QSVMS) and scheme, so its velocities differ from the others' by what discretisation leaves.
"""

from __future__ import annotations

import KratosMultiphysics as Kratos
import KratosMultiphysics.FluidDynamicsApplication
import numpy as np
from flow_case import FlowCase, main
from KratosMultiphysics.FluidDynamicsApplication.navier_stokes_monolithic_solver import CreateSolver
from record import Record

SETTINGS = """{{
    "model_part_name": "channel", "domain_size": 2, "reform_dofs_at_each_step": false, "echo_level": 0,
    "model_import_settings": {{"input_type": "use_input_model_part"}},
    "formulation": {{"element_type": "qsvms"}}, "maximum_iterations": 20,
    "relative_velocity_tolerance": {tolerance}, "absolute_velocity_tolerance": 1e-14,
    "relative_pressure_tolerance": {tolerance}, "absolute_pressure_tolerance": 1e-14,
    "linear_solver_settings": {{"solver_type": "amgcl"}},
    "volume_model_part_name": "channel", "skin_parts": ["skin"], "no_skin_parts": [],
    "time_stepping": {{"automatic_time_step": false, "time_step": {step}}}, "time_scheme": "bossak"
}}"""


class Channel:
    """The model with its solver."""

    def __init__(self, case: FlowCase) -> None:
        self.case, self.model = case, Kratos.Model()
        settings = SETTINGS.format(tolerance=case.tolerance, step=case.step)
        self.solver = CreateSolver(self.model, Kratos.Parameters(settings))
        self.part = self.model.GetModelPart("channel")
        self.solver.AddVariables()
        self.fill()
        self.solver.ImportModelPart()
        self.solver.PrepareModelPart()
        self.solver.AddDofs()
        self.solver.Initialize()

    def fill(self) -> None:
        """Nodes with their start, elements, the condition at the end, and the held velocities."""
        case, part = self.case, self.part
        nx, ny = case.counts
        part.ProcessInfo[Kratos.DOMAIN_SIZE] = 2
        part.SetBufferSize(self.solver.GetMinimumBufferSize())
        water = part.CreateNewProperties(1)
        water[Kratos.DENSITY], water[Kratos.DYNAMIC_VISCOSITY] = case.density, case.viscosity
        water[Kratos.CONSTITUTIVE_LAW] = Kratos.KratosGlobals.GetConstitutiveLaw("Newtonian2DLaw").Clone()
        skin = part.CreateSubModelPart("skin")
        x, y = np.linspace(0, case.length, nx + 1), np.linspace(0, case.height, ny + 1)
        number = lambda i, j: 1 + i + j * (nx + 1)  # noqa: E731
        for j in range(ny + 1):
            for i in range(nx + 1):
                part.CreateNewNode(number(i, j), float(x[i]), float(y[j]), 0.0)
        for k in range(nx * ny):
            i, j = k % nx, k // nx
            corners = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)]
            part.CreateNewElement("Element2D4N", k + 1, corners, water)
        for j in range(ny):
            ends = [number(nx, j), number(nx, j + 1)]
            skin.AddNodes(ends)
            skin.CreateNewCondition("LineCondition2D2N", j + 1, ends, water)
        self.inlet = [part.GetNode(number(0, j)) for j in range(ny + 1)]
        self.middle = part.GetNode(number(nx // 2, ny // 2))
        self.walls = [part.GetNode(number(i, j)) for i in range(nx + 1) for j in (0, ny)]
        self.end = [part.GetNode(number(nx, j)) for j in range(ny + 1)]

    def hold(self) -> None:
        """Start from the profile; velocities of walls and inlet stay as they are set."""
        for node in self.part.Nodes:
            v = Kratos.Array3([float(self.case.profile(np.asarray(node.Y))), 0.0, 0.0])
            for back in range(self.part.GetBufferSize()):
                node.SetSolutionStepValue(Kratos.VELOCITY, back, v)
        for node in (*self.walls, *self.inlet):
            for unknown in (Kratos.VELOCITY_X, Kratos.VELOCITY_Y):
                node.Fix(unknown)

    def step(self, t: float, record: Record) -> None:
        """One step."""
        info = self.part.ProcessInfo
        self.solver.AdvanceInTime(t - self.case.step)
        for node in self.inlet:
            u = self.case.strength(t) * float(self.case.profile(np.asarray(node.Y)))
            node.SetSolutionStepValue(Kratos.VELOCITY_X, u)
        self.solver.InitializeSolutionStep()
        self.solver.Predict()
        if not self.solver.SolveSolutionStep():
            raise RuntimeError("no convergence")
        self.solver.FinalizeSolutionStep()
        record.iterations += info[Kratos.NL_ITERATION_NUMBER]


def run(case: FlowCase, variant: str) -> Record:
    """March the case."""
    Kratos.Logger.GetDefaultOutput().SetSeverity(Kratos.Logger.Severity.WARNING)
    channel, record = Channel(case), Record()
    channel.hold()
    for k in range(case.steps):
        with record.timed("cpu"):
            channel.step((k + 1) * case.step, record)
        record.steps += 1
    record.note(channel.middle.GetSolutionStepValue(Kratos.VELOCITY_X))
    return record


if __name__ == "__main__":
    main(run, ("AMGCL",))
