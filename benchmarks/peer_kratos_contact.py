"""The two blocks in Kratos (KratosContactStructuralMechanicsApplication of PyPI): augmented Lagrangian mortar.

Its own analysis with its defaults: dual multipliers that are condensed, derivatives of normals left out, and AMGCL.
"""

from __future__ import annotations

import json
from typing import Any

import KratosMultiphysics as Kratos
import KratosMultiphysics.ConstitutiveLawsApplication
import KratosMultiphysics.ContactStructuralMechanicsApplication
import KratosMultiphysics.StructuralMechanicsApplication
from contact_case import Block, ContactCase, main
from KratosMultiphysics.ContactStructuralMechanicsApplication.alm_contact_process import ALMContactProcess
from KratosMultiphysics.ContactStructuralMechanicsApplication.contact_structural_mechanics_static_solver import (
    CreateSolver,
)
from record import Record


def settings(case: ContactCase) -> dict[str, Any]:
    """Of the solver."""
    tolerances = {
        f"{kind}_{sort}_tolerance": case.tolerance if sort == "relative" else 1e-12
        for kind in ("displacement", "residual")
        for sort in ("relative", "absolute")
    }
    more = {f"contact_{name}": value for name, value in tolerances.items()}
    return {
        "solver_type": "static",
        "model_part_name": "Structure",
        "domain_size": 3,
        "echo_level": 0,
        "analysis_type": "non_linear",
        "model_import_settings": {"input_type": "use_input_model_part"},
        "time_stepping": {"time_step": 1.0 / case.steps},
        "convergence_criterion": "contact_residual_criterion",
        "max_iteration": 20,
        "contact_settings": {"mortar_type": "ALMContactFrictionless", **more},
        "linear_solver_settings": {"solver_type": "amgcl"},
        **tolerances,
    }


class Blocks:
    """The model with its solver and its search for contact."""

    def __init__(self, case: ContactCase) -> None:
        self.case, self.model = case, Kratos.Model()
        self.solver = CreateSolver(self.model, Kratos.Parameters(json.dumps(settings(case))))
        self.solver.AddVariables()
        self.part = self.model.GetModelPart("Structure")
        self.part.ProcessInfo[Kratos.DOMAIN_SIZE] = 3
        self.part.SetBufferSize(2)
        self.fill()
        self.solver.ImportModelPart()
        self.solver.PrepareModelPart()
        self.solver.AddDofs()
        search = {
            "model_part_name": "Structure",
            "contact_model_part": {"0": ["Touching"]},
            "assume_master_slave": {"0": ["Slave"]},
            "contact_type": "Frictionless",
        }
        self.search = ALMContactProcess(self.model, Kratos.Parameters(json.dumps(search)))
        self.search.ExecuteInitialize()
        self.solver.Initialize()
        self.search.ExecuteBeforeSolutionLoop()

    def fill(self) -> None:
        """Nodes, bricks, the surfaces that touch, and the nodes that are held."""
        part, case = self.part, self.case
        rubber = part.CreateNewProperties(1)
        rubber[Kratos.YOUNG_MODULUS], rubber[Kratos.POISSON_RATIO] = case.young, case.poisson
        law = Kratos.KratosGlobals.GetConstitutiveLaw("HyperElastic3DLaw")
        rubber[Kratos.CONSTITUTIVE_LAW] = law.Clone()
        touching = part.CreateSubModelPart("Touching")
        slave = part.CreateSubModelPart("Slave")
        shift = len(case.lower.points)
        self.add(case.lower, 0, case.lower.top, (touching,), rubber)
        self.add(case.upper, shift, case.upper.bottom, (touching, slave), rubber)
        self.held = [part.GetNode(int(k) + 1) for k in set(case.lower.bottom.ravel())]
        self.moved = [part.GetNode(int(k) + 1 + shift) for k in set(case.upper.top.ravel())]
        self.face = [part.GetNode(int(k) + 1 + shift) for k in set(case.upper.bottom.ravel())]

    def add(self, block: Block, shift: int, faces: Any, parts: Any, material: Any) -> None:
        """A block whose nodes come after `shift` others."""
        first = 1 + self.part.NumberOfElements()
        for k, x in enumerate(block.points):
            self.part.CreateNewNode(k + 1 + shift, *map(float, x))
        for k, cell in enumerate(block.cells):
            nodes = [int(i) + 1 + shift for i in cell]
            self.part.CreateNewElement("TotalLagrangianElement3D8N", first + k, nodes, material)
        first = 1 + self.part.NumberOfConditions()
        for k, face in enumerate(faces):
            nodes = [int(i) + 1 + shift for i in face]
            self.part.CreateNewCondition("SurfaceCondition3D4N", first + k, nodes, material)
        used = sorted({int(i) + 1 + shift for i in faces.ravel()})
        for other in parts:
            other.AddNodes(used)
            other.AddConditions(list(range(first, first + len(faces))))

    def hold(self, t: float) -> None:
        """Prescribe displacements of what is held."""
        for node in (*self.held, *self.moved):
            for unknown in (Kratos.DISPLACEMENT_X, Kratos.DISPLACEMENT_Y, Kratos.DISPLACEMENT_Z):
                node.Fix(unknown)
        for node in self.moved:
            node.SetSolutionStepValue(Kratos.DISPLACEMENT, Kratos.Array3([u * t for u in self.case.motion]))

    def step(self, t: float, record: Record) -> None:
        """One step."""
        self.solver.AdvanceInTime(t - 1.0 / self.case.steps)
        self.hold(t)
        self.search.ExecuteInitializeSolutionStep()
        self.solver.InitializeSolutionStep()
        self.solver.Predict()
        if not self.solver.SolveSolutionStep():
            raise RuntimeError("no convergence")
        self.solver.FinalizeSolutionStep()
        self.search.ExecuteFinalizeSolutionStep()
        record.iterations += self.part.ProcessInfo[Kratos.NL_ITERATION_NUMBER]


def run(case: ContactCase, variant: str) -> Record:
    """March the case."""
    Kratos.Logger.GetDefaultOutput().SetSeverity(Kratos.Logger.Severity.WARNING)
    blocks, record = Blocks(case), Record()
    for k in range(case.steps):
        with record.timed("cpu"):
            blocks.step((k + 1) / case.steps, record)
        record.steps += 1
    heights = [node.GetSolutionStepValue(Kratos.DISPLACEMENT_Z) for node in blocks.face]
    record.note(sum(heights) / len(heights))
    return record


if __name__ == "__main__":
    main(run, ("AMGCL",))
