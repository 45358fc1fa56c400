"""The cases of shells.py in Kratos: corotational four-node shells with six unknowns a node.

Newton's method is Kratos' own, to increments of 1e-8 of the displacements, as ours.
"""

from __future__ import annotations

import time
from collections.abc import Iterable

import KratosMultiphysics as Kratos
import KratosMultiphysics.LinearSolversApplication
import KratosMultiphysics.StructuralMechanicsApplication
import numpy as np
from KratosMultiphysics.python_linear_solver_factory import ConstructSolver
from shell_cases import CYLINDER, PLATE, Cylinder, Plate

ELEMENTS = {"Kratos, thin shell": "ShellThinElementCorotational3D4N"}
"""The thick one's tangents are singular here, in Kratos 10.4.4."""
TOLERANCE, MOST = 1e-8, 60
UNKNOWNS = [
    (getattr(Kratos, f"{what}_{axis}"), getattr(Kratos, f"{force}_{axis}"))
    for what, force in (("DISPLACEMENT", "REACTION"), ("ROTATION", "REACTION_MOMENT"))
    for axis in "XYZ"
]
VECTORS = (
    Kratos.DISPLACEMENT,
    Kratos.ROTATION,
    Kratos.REACTION,
    Kratos.REACTION_MOMENT,
    Kratos.VELOCITY,
    Kratos.ACCELERATION,
    Kratos.ANGULAR_VELOCITY,
    Kratos.ANGULAR_ACCELERATION,
    Kratos.VOLUME_ACCELERATION,
)


class Shell:
    """A shell of a grid of points (n, n, 3) in Kratos with what solves it."""

    def __init__(self, element: str, points: np.ndarray, case: Plate | Cylinder, density: float) -> None:
        self.n, self.model = len(points), Kratos.Model()
        self.part = part = self.model.CreateModelPart("shell")
        part.SetBufferSize(2)
        part.ProcessInfo[Kratos.DOMAIN_SIZE] = 3
        for variable in (*VECTORS, Kratos.NEGATIVE_FACE_PRESSURE, Kratos.POSITIVE_FACE_PRESSURE):
            part.AddNodalSolutionStepVariable(variable)
        for k, point in enumerate(points.reshape(-1, 3)):
            part.CreateNewNode(k + 1, *map(float, point))
        self.fill(ELEMENTS[element], case, density)

    def fill(self, element: str, case: Plate | Cylinder, density: float) -> None:
        """Material, elements and unknowns."""
        part, n = self.part, self.n
        material = part.CreateNewProperties(1)
        material[Kratos.YOUNG_MODULUS], material[Kratos.POISSON_RATIO] = case.young, case.poisson
        material[Kratos.DENSITY], material[Kratos.THICKNESS] = density, case.thickness
        law = Kratos.KratosGlobals.GetConstitutiveLaw("LinearElasticPlaneStress2DLaw")
        material[Kratos.CONSTITUTIVE_LAW] = law.Clone()
        for i in range(n - 1):
            for j in range(n - 1):
                a = i * n + j + 1
                part.CreateNewElement(element, i * (n - 1) + j + 1, [a, a + 1, a + n + 1, a + n], material)
        for unknown, reaction in UNKNOWNS:
            Kratos.VariableUtils().AddDof(unknown, reaction, part)

    def node(self, i: int, j: int) -> Kratos.Node:
        return self.part.GetNode(i * self.n + j + 1)

    def fix(self, nodes: Iterable[tuple[int, int]], which: Iterable[int]) -> None:
        """Hold unknowns, counted as in UNKNOWNS."""
        which = tuple(which)
        for i, j in nodes:
            for k in which:
                self.node(i, j).Fix(UNKNOWNS[k][0])

    def prepare(self, scheme: Kratos.Scheme) -> Kratos.ImplicitSolvingStrategy:
        """Newton's method with a sparse LU."""
        solver = ConstructSolver(Kratos.Parameters('{"solver_type": "LinearSolversApplication.sparse_lu"}'))
        builder = Kratos.ResidualBasedBlockBuilderAndSolver(solver)
        criterion = Kratos.DisplacementCriteria(TOLERANCE, TOLERANCE)
        strategy = Kratos.ResidualBasedNewtonRaphsonStrategy(
            self.part, scheme, criterion, builder, MOST, False, False, True
        )
        strategy.SetEchoLevel(0)
        strategy.Initialize()
        return strategy

    def advance(self, strategy: Kratos.ImplicitSolvingStrategy, at: float) -> int:
        """One step to a time; the iterations it took."""
        self.part.CloneTimeStep(at)
        strategy.InitializeSolutionStep()
        strategy.Predict()
        if not strategy.SolveSolutionStep():
            raise RuntimeError("Kratos did not converge")
        strategy.FinalizeSolutionStep()
        return int(self.part.ProcessInfo[Kratos.NL_ITERATION_NUMBER])


def quiet() -> None:
    Kratos.Logger.GetDefaultOutput().SetSeverity(Kratos.Logger.Severity.WARNING)


def plate(element: str, count: int, steps: int) -> tuple[float, float, float]:
    """Seconds and iterations per step, and the height of a corner."""
    quiet()
    at = np.linspace(0, 1, count + 1)
    points = np.stack(np.broadcast_arrays(at[None, :], at[:, None], 0.0), axis=2)
    shell = Shell(element, points, PLATE, PLATE.density)
    shell.part.ProcessInfo[Kratos.DELTA_TIME] = PLATE.step
    shell.fix(((i, 0) for i in range(count + 1)), range(6))
    for node in shell.part.Nodes:
        node.SetSolutionStepValue(Kratos.VELOCITY_Z, 0, float(PLATE.velocity(node.X0)))
    strategy = shell.prepare(Kratos.ResidualBasedNewmarkDisplacementScheme())
    shell.advance(strategy, PLATE.step)
    start = time.process_time()
    iterations = sum(shell.advance(strategy, (k + 2) * PLATE.step) for k in range(steps))
    took = (time.process_time() - start) / steps
    return took, iterations / steps, shell.node(count, count).GetSolutionStepValue(Kratos.DISPLACEMENT_Z)


def cylinder(element: str, count: int) -> tuple[float, float, float]:
    """Seconds of all load steps, their number, and the deflection under the force."""
    quiet()
    case, ends = CYLINDER, range(count + 1)
    y = np.linspace(0, case.length / 2, count + 1)
    a = np.linspace(0, np.pi / 2, count + 1)
    points = np.stack(
        np.broadcast_arrays(case.radius * np.sin(a)[:, None], y[None, :], case.radius * np.cos(a)[:, None]),
        axis=2,
    )
    shell = Shell(element, points, case, 0.0)
    shell.fix(((i, 0) for i in ends), (0, 2))  # diaphragm
    shell.fix(((i, count) for i in ends), (1, 3, 5))  # middle
    shell.fix(((0, j) for j in ends), (0, 4, 5))  # crown
    shell.fix(((count, j) for j in ends), (2, 3, 4))  # side
    top = (0, count)
    load = shell.part.CreateNewCondition(
        "PointLoadCondition3D1N", 1, [top[0] * (count + 1) + top[1] + 1], shell.part.GetProperties(1)
    )
    strategy = shell.prepare(Kratos.ResidualBasedIncrementalUpdateStaticScheme())
    start = time.process_time()
    for k in range(1, case.load_steps + 1):
        force = -case.share * case.force / 4 * k / case.load_steps
        load.SetValue(KratosMultiphysics.StructuralMechanicsApplication.POINT_LOAD, [0.0, 0.0, force])
        shell.advance(strategy, float(k))
    took = time.process_time() - start
    return took, case.load_steps, -shell.node(*top).GetSolutionStepValue(Kratos.DISPLACEMENT_Z)
