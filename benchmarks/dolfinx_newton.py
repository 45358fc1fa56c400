"""An iteration of Newton's method in DOLFINx (Debian's python3-dolfinx 0.5), with factors of MUMPS."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import dolfinx
import numpy as np
import ufl
from mpi4py import MPI
from petsc4py import PETSc

COMPILER = {"cffi_extra_compile_args": ["-O3", "-march=native"]}


class Iteration:
    """Residual and tangent of a form in `new`, and their solution.

    `conditions` hold increments at zero, and `places` are those unknowns that convergence is judged by.
    """

    def __init__(self, residual: Any, new: Any, places: Any, conditions: Sequence[Any] = ()) -> None:
        self.new, self.places, self.conditions = new, places, list(conditions)
        self.f = dolfinx.fem.form(residual, jit_params=COMPILER)
        self.K = dolfinx.fem.form(ufl.derivative(residual, new), jit_params=COMPILER)
        self.matrix = dolfinx.fem.petsc.create_matrix(self.K)
        self.right = dolfinx.fem.petsc.create_vector(self.f)
        self.out = self.right.duplicate()
        self.solver = PETSc.KSP().create(MPI.COMM_SELF)
        self.solver.setType("preonly")
        self.solver.getPC().setType("lu")
        self.solver.getPC().setFactorSolverType("mumps")

    def assemble(self) -> None:
        """Residual and tangent."""
        with self.right.localForm() as local:
            local.set(0.0)
        dolfinx.fem.petsc.assemble_vector(self.right, self.f)
        dolfinx.fem.petsc.set_bc(self.right, self.conditions)
        self.matrix.zeroEntries()
        dolfinx.fem.petsc.assemble_matrix(self.matrix, self.K, bcs=self.conditions)
        self.matrix.assemble()

    def advance(self) -> tuple[float, float]:
        """Takes the increment off; sizes at the places of it and of the state."""
        self.solver.setOperators(self.matrix)
        self.solver.solve(self.right, self.out)
        self.new.x.array[:] -= self.out.array
        change, size = (np.linalg.norm(a[self.places]) for a in (self.out.array, self.new.x.array))
        return float(change), float(size)
