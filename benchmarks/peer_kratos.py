"""The solids in Kratos with AMGCL (KratosStructuralMechanicsApplication and KratosConstitutiveLawsApplication of PyPI).

Kratos brings its own schemes and builder of equations; Newton's method is written out so that its parts can be timed.
"""

from __future__ import annotations

import KratosMultiphysics as Kratos
import KratosMultiphysics.ConstitutiveLawsApplication
import KratosMultiphysics.StructuralMechanicsApplication
import numpy as np
from KratosMultiphysics.python_linear_solver_factory import ConstructSolver
from record import Record
from solid_cases import TOLERANCE, Array, SolidCase
from solid_measure import MOST, main, mean_displacement

AMGCL = """{"solver_type": "amgcl", "krylov_type": "cg", "smoother_type": "ilu0", "tolerance": 1e-6,
"coarsening_type": "smoothed_aggregation", "use_block_matrices_if_possible": true, "max_iteration": 500}"""
UNKNOWNS = {
    Kratos.DISPLACEMENT_X: Kratos.REACTION_X,
    Kratos.DISPLACEMENT_Y: Kratos.REACTION_Y,
    Kratos.DISPLACEMENT_Z: Kratos.REACTION_Z,
}


class Model:
    """The case in Kratos with what solves it."""

    def __init__(self, case: SolidCase) -> None:
        self.case, self.model = case, Kratos.Model()
        self.part = part = self.model.CreateModelPart("solid")
        part.SetBufferSize(2)
        part.ProcessInfo[Kratos.DOMAIN_SIZE] = 3
        part.ProcessInfo[Kratos.DELTA_TIME] = case.step
        for variable in (
            Kratos.DISPLACEMENT,
            Kratos.REACTION,
            Kratos.VELOCITY,
            Kratos.ACCELERATION,
            Kratos.VOLUME_ACCELERATION,
        ):
            part.AddNodalSolutionStepVariable(variable)
        self.fill()
        static = Kratos.ResidualBasedIncrementalUpdateStaticScheme
        self.scheme = Kratos.ResidualBasedNewmarkDisplacementScheme() if case.density > 0 else static()
        self.builder = Kratos.ResidualBasedBlockBuilderAndSolver(ConstructSolver(Kratos.Parameters(AMGCL)))
        self.strategy = Kratos.ResidualBasedNewtonRaphsonStrategy(
            part, self.scheme, Kratos.ResidualCriteria(TOLERANCE, 0.0), self.builder, MOST, False, False, True
        )
        self.strategy.Initialize()

    def fill(self) -> None:
        """Nodes, elements, material, unknowns and their start."""
        case, part = self.case, self.part
        for k, point in enumerate(case.points):
            part.CreateNewNode(k + 1, *map(float, point))
        material = part.CreateNewProperties(1)
        material[Kratos.YOUNG_MODULUS], material[Kratos.POISSON_RATIO] = case.young, case.poisson
        material[Kratos.DENSITY] = case.density
        law = Kratos.KratosGlobals.GetConstitutiveLaw("HyperElastic3DLaw")
        material[Kratos.CONSTITUTIVE_LAW] = law.Clone()
        for k, cell in enumerate(case.cells):
            part.CreateNewElement("TotalLagrangianElement3D8N", k + 1, [int(i) + 1 for i in cell], material)
        for unknown, reaction in UNKNOWNS.items():
            Kratos.VariableUtils().AddDof(unknown, reaction, part)
        for node, velocity, held in zip(part.Nodes, case.velocity, case.held, strict=True):
            node.SetSolutionStepValue(Kratos.VELOCITY, Kratos.Array3(velocity.tolist()))
            for unknown in UNKNOWNS if held else ():
                node.Fix(unknown)

    def displacements(self) -> Array:
        return np.array([node.GetSolutionStepValue(Kratos.DISPLACEMENT) for node in self.part.Nodes])

    def guess(self) -> None:
        """Move all nodes as the case says: moving those that are held alone would turn elements inside out."""
        for node, motion in zip(self.part.Nodes, self.case.motion, strict=True):
            u = node.GetSolutionStepValue(Kratos.DISPLACEMENT) + Kratos.Array3(motion.tolist())
            node.SetSolutionStepValue(Kratos.DISPLACEMENT, u)

    def step(self, number: int, record: Record) -> None:
        """One step."""
        self.part.CloneTimeStep(number * self.case.step)
        self.part.ProcessInfo[Kratos.STEP] = number
        if self.case.motion.any():
            self.guess()
        self.strategy.InitializeSolutionStep()
        self.strategy.Predict()
        self.strategy.MoveMesh()  # elements look at the places of their nodes
        self.newton(record)
        self.strategy.FinalizeSolutionStep()

    def newton(self, record: Record) -> None:
        """Newton's method until the forces left over are small beside the first ones."""
        A, b = self.strategy.GetSystemMatrix(), self.strategy.GetSystemVector()
        d, space, first = self.strategy.GetSolutionVector(), Kratos.UblasSparseSpace(), 0.0
        for _ in range(MOST):
            with record.timed("solution"):
                space.SetToZeroMatrix(A), space.SetToZeroVector(b), space.SetToZeroVector(d)
                self.builder.BuildAndSolve(self.scheme, self.part, A, d, b)
            first = first or space.TwoNorm(b)
            self.scheme.Update(self.part, self.builder.GetDofSet(), A, d, b)
            self.strategy.MoveMesh()
            record.iterations += 1
            with record.timed("assembly"):
                space.SetToZeroVector(b)
                self.builder.BuildRHS(self.scheme, self.part, b)
            if space.TwoNorm(b) <= TOLERANCE * first:
                return
        raise RuntimeError(f"no convergence in {MOST} iterations")

    def divide(self, record: Record) -> None:
        """Build and solve are one call, so the matrix is built once more to know the share of each."""
        share = Record()
        A, b = self.strategy.GetSystemMatrix(), self.strategy.GetSystemVector()
        with share.timed("assembly"):
            self.builder.Build(self.scheme, self.part, A, b)
        record.assembly += record.iterations * share.assembly
        record.solution -= record.iterations * share.assembly


def run(case: SolidCase, variant: str, audited: bool) -> Record:
    """March the case; see `solid_measure.main`."""
    Kratos.Logger.GetDefaultOutput().SetSeverity(Kratos.Logger.Severity.WARNING)
    model, record = Model(case), Record()
    for number in range(1, case.steps + 1):
        with record.timed("cpu"):
            model.step(number, record)
        record.steps += 1
    model.divide(record)
    record.note(mean_displacement(model.displacements()))
    return record


if __name__ == "__main__":
    main(run, ("AMGCL",))
