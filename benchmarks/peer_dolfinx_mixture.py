"""The mixture in DOLFINx (Debian's python3-dolfinx 0.5), with factors of MUMPS."""

from __future__ import annotations

import dolfinx
import ufl
from dolfinx_newton import Iteration
from flow_case import march
from mixture_case import MixtureCase, main
from mpi4py import MPI
from record import Record


class Square:
    """The discretisation."""

    def __init__(self, case: MixtureCase) -> None:
        self.case = case
        mesh = dolfinx.mesh.create_unit_square(MPI.COMM_SELF, case.n, case.n)
        linear = ufl.FiniteElement("Lagrange", mesh.ufl_cell(), 1)
        self.space = dolfinx.fem.FunctionSpace(mesh, ufl.MixedElement(linear, linear))
        self.new, self.old = (dolfinx.fem.Function(self.space) for _ in range(2))
        self.concentrations, self.places = self.space.sub(0).collapse()
        start = dolfinx.fem.Function(self.concentrations)
        start.interpolate(lambda x: case.start(x[0], x[1]))
        self.new.x.array[self.places] = start.x.array
        self.forms()

    def forms(self) -> None:
        """Residual of a step, and its derivative."""
        case = self.case
        c1, mu = ufl.split(self.new)
        c0, _ = ufl.split(self.old)
        q, w = ufl.TestFunctions(self.space)
        c = ufl.variable((c0 + c1) / 2)
        slope = ufl.diff(case.barrier * c**2 * (1 - c) ** 2, c)
        residual = (c1 - c0) / case.step * q * ufl.dx
        residual += case.mobility * ufl.inner(ufl.grad(mu), ufl.grad(q)) * ufl.dx
        points = ufl.dx(metadata={"quadrature_degree": 2})  # as visviva has them: three in a triangle
        residual += (mu - slope) * w * points
        residual -= case.gradient_energy * ufl.inner(ufl.grad((c0 + c1) / 2), ufl.grad(w)) * ufl.dx
        self.iteration = Iteration(residual, self.new, self.places)
        self.assemble, self.advance = self.iteration.assemble, self.iteration.advance

    def begin(self, t: float) -> None:
        """The last state."""
        self.old.x.array[:] = self.new.x.array

    def answer(self) -> float:
        """Standard deviation of the concentrations at the nodes."""
        return float(self.new.x.array[self.places].std())


def run(case: MixtureCase, variant: str) -> Record:
    """March the case."""
    return march(Square(case))


if __name__ == "__main__":
    main(run, ("MUMPS",))
