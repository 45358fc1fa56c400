"""The flow in NGSolve (`pip install ngsolve mkl`): elements of Taylor and Hood, midpoint, factors of PARDISO."""

from __future__ import annotations

from typing import Any

import ngsolve as ng
import numpy as np
from flow_case import FlowCase, main, march
from ngsolve.meshes import MakeStructured2DMesh
from ngsolve_factors import factors
from record import Record


class Channel:
    """The discretisation."""

    def __init__(self, case: FlowCase) -> None:
        self.case = case
        nx, ny = case.counts
        mesh = MakeStructured2DMesh(
            quads=True, nx=nx, ny=ny, mapping=lambda x, y: (case.length * x, case.height * y)
        )
        velocities = ng.VectorH1(mesh, order=2, dirichlet="left|top|bottom")
        self.space = velocities * ng.H1(mesh, order=1)
        self.mesh = mesh
        self.new, self.old = ng.GridFunction(self.space), ng.GridFunction(self.space)
        self.time = ng.Parameter(0.0)
        self.profile = 4 * ng.y * (case.height - ng.y) / case.height**2
        self.strength = 1 + ng.sin(2 * np.pi * self.time)
        self.new.components[0].Set(ng.CF((self.profile, 0)))
        self.right, self.out = (self.new.vec.CreateVector() for _ in range(2))
        self.inverse: Any = None
        self.form()

    def form(self) -> None:
        """Residual of a midpoint step with skew-symmetric convection."""
        case = self.case
        (v1, p), (w, q) = self.space.TnT()
        v0 = self.old.components[0]
        rho, mu, h = case.density, case.viscosity, case.step
        v, gradients = (v0 + v1) / 2, (ng.Grad(v0) + ng.Grad(v1)) / 2
        n = ng.specialcf.normal(2)
        inside = rho / h * (v1 - v0) * w
        inside += rho / 2 * ((gradients * v) * w - (ng.Grad(w) * v) * v)
        inside += 2 * mu * ng.InnerProduct(ng.Sym(gradients), ng.Grad(w))
        inside -= p * ng.div(w) + q * ng.div(v1)
        outside = rho / 2 * ng.IfPos(v * n, v * n, 0) * (v * w) - mu * (gradients.trans * n) * w
        self.f = ng.BilinearForm(self.space)
        self.f += inside.Compile(realcompile=True, wait=True) * ng.dx(bonus_intorder=2)
        self.f += outside * ng.ds("right", skeleton=True, bonus_intorder=2)

    def begin(self, t: float) -> None:
        """The last state, with the velocities that are held."""
        self.old.vec.data = self.new.vec
        self.time.Set(t)
        inflow = ng.CF((self.strength * self.profile, 0))
        self.new.components[0].Set(inflow, definedon=self.mesh.Boundaries("left"))
        held = self.new.vec.FV().NumPy().copy()
        self.new.vec.data = self.old.vec
        fixed = ~np.array(list(self.space.FreeDofs()))
        self.new.vec.FV().NumPy()[fixed] = held[fixed]

    def assemble(self) -> None:
        """Residual and tangent."""
        self.f.Apply(self.new.vec, self.right)
        self.f.AssembleLinearization(self.new.vec)

    def advance(self) -> tuple[float, float]:
        """Takes the increment off; sizes of the velocities in it and in the state."""
        self.inverse = factors(self.f.mat, self.space.FreeDofs(), self.inverse)
        self.out.data = self.inverse * self.right
        self.new.vec.data -= self.out
        return self.size(self.out), self.size(self.new.vec)

    def size(self, vector: Any) -> float:
        """Of velocities."""
        return float(np.linalg.norm(vector.FV().NumPy()[: self.space.components[0].ndof]))

    def answer(self) -> float:
        """Velocity along the channel in its middle."""
        place = self.mesh(*self.case.middle)
        return float(self.new.components[0](place)[0])


def run(case: FlowCase, variant: str) -> Record:
    """March the case."""
    return march(Channel(case))


if __name__ == "__main__":
    ng.SetNumThreads(1)
    main(run, ("PARDISO",))
