"""Flows: velocities, and pressures beside them, by preconditioners of their own."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc

from visviva_petsc.solver import Solver

Ints = NDArray[np.int64]

BESIDE = {
    "ksp_type": "gmres",
    "ksp_pc_side": "right",
    "ksp_gmres_restart": "100",
    "ksp_rtol": "1e-3",  # Newton goes on anyway
    "ksp_max_it": "300",
    "pc_type": "fieldsplit",
    "pc_fieldsplit_type": "schur",
    "pc_fieldsplit_schur_fact_type": "upper",
    "fieldsplit_velocity_ksp_type": "preonly",
    "fieldsplit_velocity_pc_type": "bjacobi",
}
"""Block triangular, with incomplete factors of what a process has of the velocities."""
COMMUTATOR = {
    "pc_fieldsplit_schur_precondition": "self",
    "fieldsplit_pressure_ksp_type": "richardson",
    "fieldsplit_pressure_ksp_richardson_scale": "-1",  # PETSc's commutator is that of the complement's negative
    "fieldsplit_pressure_ksp_max_it": "1",
    "fieldsplit_pressure_ksp_norm_type": "none",
    "fieldsplit_pressure_pc_type": "lsc",
    "fieldsplit_pressure_pc_lsc_scale_diag": "1",
    "fieldsplit_pressure_lsc_ksp_type": "preonly",
    "fieldsplit_pressure_lsc_pc_type": "gamg",
}
"""The least-squares commutator of the pressures: right for long steps and short ones."""
SIMPLE = {
    "pc_fieldsplit_schur_precondition": "selfp",
    "fieldsplit_pressure_ksp_type": "preonly",
    "fieldsplit_pressure_pc_type": "gamg",
}
"""What the diagonal of the velocities gives of the complement, beside what stabilises pressures."""


class FlowSolver(Solver):
    """Solves the equations of flows, which alone are there.

    Elements of Taylor and Hood take the commutator, stabilised ones, which have entries between pressures, SIMPLE.
    """

    def analyze(self, row: Ints, col: Ints, unknown: Ints, of: dict[str, Any]) -> None:
        """Take the pattern, and which equations are those of pressures."""
        super().analyze(row, col, unknown, of)
        first, end = self.A.getOwnershipRange()
        is_pressure = np.zeros(end - first, dtype=bool)
        number = self.equation - first
        own = (number >= 0) & (number < end - first)
        is_pressure[number[own]] = np.asarray(of["algebraic"])[own] != 0
        self.parts = [
            PETSc.IS().createGeneral((first + np.flatnonzero(chosen)).astype(PETSc.IntType), comm=self.comm)
            for chosen in (~is_pressure, is_pressure)
        ]
        self.is_prepared = False

    def prepare(self) -> None:
        """Take the preconditioner of the pressures that goes with the elements, as the first values tell."""
        if self.is_prepared:
            return
        among = self.A.createSubMatrix(self.parts[1], self.parts[1])
        self.set_options((SIMPLE if among.norm() > 0 else COMMUTATOR) | self.options)
        self.ksp.getPC().setFieldSplitIS(*zip(("velocity", "pressure"), self.parts, strict=True))
        among.destroy()
        self.is_prepared = True
