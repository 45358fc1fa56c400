"""The solids in DOLFINx (Debian's python3-dolfinx 0.5) with MUMPS' Cholesky factors, or multigrid by GAMG."""

from __future__ import annotations

from typing import Any

import dolfinx
import numpy as np
import ufl
from mpi4py import MPI
from petsc4py import PETSc
from record import Record
from solid_cases import Array, SolidCase
from solid_measure import main, march

COMPILER = {"cffi_extra_compile_args": ["-O3", "-march=native"]}


class Dolfinx:
    """The discretisation; unknowns are numbered node by node, the nodes in an order of DOLFINx."""

    def __init__(self, case: SolidCase, solver: str) -> None:
        shape = ufl.VectorElement("Lagrange", "hexahedron", 1)
        cells = case.cells[:, [0, 1, 3, 2, 4, 5, 7, 6]]
        mesh = dolfinx.mesh.create_mesh(MPI.COMM_SELF, cells, case.points, ufl.Mesh(shape))
        self.space = dolfinx.fem.VectorFunctionSpace(mesh, ("Lagrange", 1))
        self.place = np.empty(len(case.points), dtype=np.int64)  # in the space, of a node
        nodes, dofs = mesh.geometry.dofmap.array, self.space.dofmap.list.array
        self.place[np.asarray(mesh.geometry.input_global_indices)[nodes]] = dofs
        held = np.flatnonzero(self.vector(np.repeat(case.held[:, None], 3, axis=1)))
        self.jump = dolfinx.fem.Function(self.space)
        nodes = np.unique(held // 3).astype(np.int32)
        self.supports = [dolfinx.fem.dirichletbc(self.jump, nodes)]
        self.forms(case)
        self.solver = PETSc.KSP().create(MPI.COMM_SELF)
        if solver == "MUMPS":
            self.solver.setType("preonly")
            self.solver.getPC().setType("cholesky")
            self.solver.getPC().setFactorSolverType("mumps")
        else:
            self.solver.setType("cg")
            self.solver.setTolerances(rtol=1e-6)
            self.solver.getPC().setType("gamg")

    def forms(self, case: SolidCase) -> None:
        """Energy, its derivatives, and the masses."""
        lame, mu = case.lame
        self.u = dolfinx.fem.Function(self.space)
        w, d = ufl.TestFunction(self.space), ufl.TrialFunction(self.space)
        F = ufl.Identity(3) + ufl.grad(self.u)
        J = ufl.det(F)
        W = mu / 2 * (ufl.inner(F, F) - 3 - 2 * ufl.ln(J)) + lame / 2 * ufl.ln(J) ** 2
        energy = W * ufl.dx(metadata={"quadrature_degree": 3})
        f = ufl.derivative(energy, self.u, w)
        density = dolfinx.fem.Constant(self.space.mesh, PETSc.ScalarType(case.density))
        mass = density * ufl.inner(w, d) * ufl.dx(metadata={"quadrature_degree": 3})
        K = ufl.derivative(f, self.u, d)
        self.W, self.f, self.K, self.M = (
            dolfinx.fem.form(form, jit_params=COMPILER) for form in (energy, f, K, mass)
        )
        self.matrix = dolfinx.fem.petsc.create_matrix(self.K)
        self.matrix.setOption(PETSc.Mat.Option.SPD, True)
        self.mass = self.assembled(dolfinx.fem.petsc.create_matrix(self.K), self.M)
        self.out, self.right = self.mass.createVecLeft(), self.mass.createVecRight()

    def assembled(self, matrix: Any, form: Any, bcs: Any = ()) -> Any:
        matrix.zeroEntries()
        dolfinx.fem.petsc.assemble_matrix(matrix, form, bcs=list(bcs))
        matrix.assemble()
        return matrix

    def vector(self, nodal: Array) -> Array:
        values = np.empty(nodal.shape)
        values[self.place] = nodal
        return values.reshape(-1)

    def nodal(self, vector: Array) -> Array:
        return vector.reshape(-1, 3)

    def force(self, u: Array) -> Array:
        self.u.x.array[:] = u
        return np.array(dolfinx.fem.petsc.assemble_vector(self.f).array)

    def prepare(self, u: Array, c: float) -> None:
        self.u.x.array[:] = u
        self.assembled(self.matrix, self.K, self.supports)
        if c:
            self.matrix.axpy(c, self.mass, PETSc.Mat.Structure.SAME_NONZERO_PATTERN)

    def solve(self, r: Array, jump: Array) -> Array:
        self.jump.x.array[:] = jump
        self.right.array[:] = r
        if jump.any():
            dolfinx.fem.petsc.apply_lifting(self.right, [self.K], [self.supports])
        dolfinx.fem.petsc.set_bc(self.right, self.supports)
        self.solver.setOperators(self.matrix)
        self.solver.solve(self.right, self.out)
        return np.array(self.out.array)

    def inertia(self, a: Array) -> Array:
        self.right.array[:] = a
        self.mass.mult(self.right, self.out)
        return np.array(self.out.array)

    def strain_energy(self, u: Array) -> float:
        self.u.x.array[:] = u
        return float(dolfinx.fem.assemble_scalar(self.W))


def run(case: SolidCase, variant: str, audited: bool) -> Record:
    """March the case; see `solid_measure.main`."""
    return march(Dolfinx(case, variant), case, audited)


if __name__ == "__main__":
    main(run, ("MUMPS", "GAMG"))
