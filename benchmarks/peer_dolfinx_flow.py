"""The flow in DOLFINx (Debian's python3-dolfinx 0.5): elements of Taylor and Hood, midpoint, factors of MUMPS."""

from __future__ import annotations

from typing import Any

import dolfinx
import numpy as np
import ufl
from dolfinx_newton import Iteration
from flow_case import FlowCase, main, march
from mpi4py import MPI
from petsc4py import PETSc
from record import Record


class Channel:
    """The discretisation."""

    def __init__(self, case: FlowCase) -> None:
        self.case = case
        corners = [np.zeros(2), np.array([case.length, case.height])]
        kind = dolfinx.mesh.CellType.quadrilateral
        mesh = dolfinx.mesh.create_rectangle(MPI.COMM_SELF, corners, list(case.counts), kind)
        vector = ufl.VectorElement("Lagrange", mesh.ufl_cell(), 2)
        scalar = ufl.FiniteElement("Lagrange", mesh.ufl_cell(), 1)
        self.space = dolfinx.fem.FunctionSpace(mesh, ufl.MixedElement(vector, scalar))
        self.new, self.old = (dolfinx.fem.Function(self.space) for _ in range(2))
        self.velocities, self.places = self.space.sub(0).collapse()
        self.boundary(mesh)
        self.forms(mesh)

    def boundary(self, mesh: Any) -> None:
        """Walls and inflow hold velocities, as increments of Newton's method see it zeros."""
        case, edges = self.case, mesh.topology.dim - 1

        def held(where: Any) -> Any:
            facets = dolfinx.mesh.locate_entities_boundary(mesh, edges, where)
            both = (self.space.sub(0), self.velocities)
            return dolfinx.fem.locate_dofs_topological(both, edges, facets)

        self.inflow = dolfinx.fem.Function(self.velocities)
        still = dolfinx.fem.Function(self.velocities)
        sub = self.space.sub(0)
        walls = held(lambda x: np.isclose(x[1], 0.0) | np.isclose(x[1], case.height))
        inlet = held(lambda x: np.isclose(x[0], 0.0))
        self.conditions = [
            dolfinx.fem.dirichletbc(self.inflow, inlet, sub),
            dolfinx.fem.dirichletbc(still, walls, sub),
        ]
        self.zeros = [dolfinx.fem.dirichletbc(still, dofs, sub) for dofs in (inlet, walls)]
        self.set_inflow(0.0)
        start = dolfinx.fem.Function(self.velocities)
        start.interpolate(lambda x: np.array([case.profile(x[1]), 0.0 * x[1]]))
        for function in (self.new, self.old):
            function.x.array[self.places] = start.x.array

    def set_inflow(self, t: float) -> None:
        case = self.case
        values = lambda x: np.array([case.strength(t) * case.profile(x[1]), 0.0 * x[1]])  # noqa: E731
        self.inflow.interpolate(values)

    def forms(self, mesh: Any) -> None:
        """Residual of a midpoint step with skew-symmetric convection, and its derivative."""
        case = self.case
        rho, mu = (dolfinx.fem.Constant(mesh, PETSc.ScalarType(c)) for c in (case.density, case.viscosity))
        v1, p = ufl.split(self.new)
        v0, _ = ufl.split(self.old)
        w, q = ufl.TestFunctions(self.space)
        v, n = (v0 + v1) / 2, ufl.FacetNormal(mesh)
        facets = dolfinx.mesh.locate_entities_boundary(mesh, 1, lambda x: np.isclose(x[0], case.length))
        tags = dolfinx.mesh.meshtags(mesh, 1, np.sort(facets), np.ones(len(facets), dtype=np.int32))
        out = ufl.Measure("ds", domain=mesh, subdomain_data=tags)(1)
        residual = rho / case.step * ufl.inner(v1 - v0, w) * ufl.dx
        residual += rho / 2 * (ufl.inner(ufl.grad(v) * v, w) - ufl.inner(ufl.grad(w) * v, v)) * ufl.dx
        residual += 2 * mu * ufl.inner(ufl.sym(ufl.grad(v)), ufl.grad(w)) * ufl.dx
        residual -= (p * ufl.div(w) + q * ufl.div(v1)) * ufl.dx
        outward = ufl.dot(v, n)
        residual += rho / 2 * ufl.conditional(outward > 0, outward, 0.0) * ufl.inner(v, w) * out
        residual -= mu * ufl.inner(ufl.grad(v).T * n, w) * out
        self.iteration = Iteration(residual, self.new, self.places, self.zeros)
        self.assemble, self.advance = self.iteration.assemble, self.iteration.advance

    def begin(self, t: float) -> None:
        """The last state, with the velocities that are held."""
        self.set_inflow(t)
        self.old.x.array[:] = self.new.x.array
        dolfinx.fem.petsc.set_bc(self.new.vector, self.conditions)

    def answer(self) -> float:
        """Velocity along the channel in its middle."""
        x = self.velocities.tabulate_dof_coordinates()[:, :2]
        node = int(np.argmin(np.linalg.norm(x - self.case.middle, axis=1)))
        return float(self.new.x.array[self.places].reshape(-1, 2)[node, 0])


def run(case: FlowCase, variant: str) -> Record:
    """March the case."""
    return march(Channel(case))


if __name__ == "__main__":
    main(run, ("Q2Q1",))
