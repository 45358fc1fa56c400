"""The two flaps in NGSolve (`pip install ngsolve mkl`): body-fitted, one system of equations for flow, flaps and mesh.

Velocity and displacement P2 everywhere, pressure P1 in the fluid. The fluid's mesh moves as a soft neo-Hookean solid,
stiffer where cells are small. Rates, stresses and the mesh are taken at one instant a little beyond the middle of the
step. In the first two iterations of a step tangents are made anew, then as the variant says.
"""

from __future__ import annotations

from typing import Any

import netgen.occ as occ
import ngsolve as ng
import numpy as np
from flow_case import main, march
from ngsolve_factors import factors
from record import Record
from valve_case import ValveCase

SOFT = 1e-12
"""Of the fluid's mesh: on the flaps' surface its equations are added to those that move the flaps with the velocity."""
KEEP = 0.3
"""Contraction up to which a tangent is kept."""


def mesh_of(case: ValveCase) -> ng.Mesh:
    """Triangles with `case.n` spaces between nodes of P2 along the channel, two triangles over a flap's thickness."""

    def box(x: float, y: float, size: tuple[float, float]) -> Any:
        return occ.MoveTo(x, y).Rectangle(*size).Face()

    channel = box(0, 0, (case.length, case.height))
    for side, name in ((occ.X, "inflow"), (occ.Y, "wall")):
        channel.edges.Min(side).name = name
        channel.edges.Max(side).name = "outlet" if side == occ.X else name
    left, size = case.right - case.thickness, (case.thickness, case.flap)
    flaps = [box(left, y, size) for y in (0.0, case.height - case.flap)]
    for flap, edge in zip(flaps, (flaps[0].edges.Min(occ.Y), flaps[1].edges.Max(occ.Y)), strict=True):
        flap.faces.name, flap.faces.maxh, edge.name = "flap", case.thickness / 2, "wall"
        channel = channel - flap
    channel.faces.name = "fluid"
    whole = occ.OCCGeometry(occ.Glue([channel, *flaps]), dim=2)
    return ng.Mesh(whole.GenerateMesh(maxh=2 * case.length / case.n, grading=0.3))


class Valve:
    """The discretisation."""

    def __init__(self, case: ValveCase, keeps: bool) -> None:
        self.case, self.keeps, self.mesh = case, keeps, mesh_of(case)
        velocities = ng.VectorH1(self.mesh, order=2, dirichlet="inflow|wall")
        places = ng.VectorH1(self.mesh, order=2, dirichlet="inflow|wall|outlet")
        self.space = velocities * places * ng.H1(self.mesh, order=1, definedon="fluid")
        self.new, self.old = ng.GridFunction(self.space), ng.GridFunction(self.space)
        self.right, self.out = (self.new.vec.CreateVector() for _ in range(2))
        self.free = np.array(list(self.space.FreeDofs()))
        self.inverse: Any = None
        self.changes: list[float] = []
        self.tangents = 0
        self.form()

    def form(self) -> None:
        """Residual of a step."""
        case = self.case
        (v1, d1, p), (w, z, q) = self.space.TnT()
        v0, d0, _ = self.old.components
        s, h = 0.5 + case.damping, case.step
        v = (1 - s) * v0 + s * v1
        one = ng.Id(2)
        F = one + (1 - s) * ng.Grad(d0) + s * ng.Grad(d1)
        J, inverse = ng.Det(F), ng.Inv(F)
        gradients, tests = ((1 - s) * ng.Grad(v0) + s * ng.Grad(v1)) * inverse, ng.Grad(w) * inverse
        acceleration, motion = (v1 - v0) / h, (d1 - d0) / h
        stress = 2 * case.viscosity * ng.Sym(gradients) - p * one
        fluid = case.density * (acceleration + gradients * (v - motion)) * w
        fluid += ng.InnerProduct(stress, tests) - q * ng.Trace(gradients)
        mesh = ng.InnerProduct(F - inverse.trans + ng.log(J) * inverse.trans, ng.Grad(z))
        moved = SOFT / ng.specialcf.mesh_size**2 * mesh
        lam, mu = case.lame
        flap = case.density * acceleration * w + (motion - v) * z
        flap += ng.InnerProduct(mu * (F - inverse.trans) + lam * ng.log(J) * inverse.trans, ng.Grad(w))
        self.f = ng.BilinearForm(self.space)
        self.f += (J * fluid + moved).Compile(realcompile=True, wait=True) * ng.dx("fluid")
        self.f += flap.Compile(realcompile=True, wait=True) * ng.dx("flap")

    def begin(self, t: float) -> None:
        """The last state with the velocities that are held; places move on as in the step before."""
        case, places = self.case, self.space.Range(1)
        new, old = (state.vec.FV().NumPy() for state in (self.new, self.old))
        moved = new[places.start : places.stop] - old[places.start : places.stop]
        old[:] = new
        inflow = ng.CF((case.strength(t) * ng.y * (case.height - ng.y), 0))
        self.new.components[0].Set(inflow, definedon=self.mesh.Boundaries("inflow"))
        new[self.free] = old[self.free]
        new[places.start : places.stop] += moved
        self.changes = []

    @property
    def anew(self) -> bool:
        """Whether the next iteration takes a tangent of its own."""
        c = self.changes
        return not self.keeps or len(c) < 2 or c[-1] > KEEP * c[-2]

    def assemble(self) -> None:
        """Residual and, if need be, tangent."""
        self.f.Apply(self.new.vec, self.right)
        if self.anew:
            self.f.AssembleLinearization(self.new.vec)

    def advance(self) -> tuple[float, float]:
        """Takes the increment off; sizes of the velocities in it and in the state."""
        if self.anew:
            self.tangents += 1
            fits = (
                self.changes and self.tangents > 2
            )  # order and matching of the first tangents of all do not
            self.inverse = factors(self.f.mat, self.space.FreeDofs(), self.inverse if fits else None)
        self.out.data = self.inverse * self.right
        self.new.vec.data -= self.out
        self.changes.append(self.size(self.out))
        if not np.isfinite(self.changes[-1]):
            raise RuntimeError("Newton's method diverges")
        return self.changes[-1], self.size(self.new.vec)

    def size(self, vector: Any) -> float:
        """Of velocities."""
        return float(np.linalg.norm(vector.FV().NumPy()[: self.space.components[0].ndof]))

    def answer(self) -> float:
        """Displacement of the lower tip along the channel."""
        x, y = self.case.tip
        return float(self.new.components[1](self.mesh(x, y - 1e-9))[0])


def run(case: ValveCase, variant: str) -> Record:
    """March the case."""
    valve = Valve(case, variant == "kept")
    record = march(valve)
    record.tangents = valve.tangents
    record.unknowns = int(valve.free.sum())
    return record


if __name__ == "__main__":
    ng.SetNumThreads(1)
    main(run, ("kept", "anew"), ValveCase)
