"""The solids in NGSolve (`pip install ngsolve mkl`) with its compiled expressions and factors of PARDISO."""

from __future__ import annotations

from typing import Any

import netgen.meshing as netgen
import ngsolve as ng
import numpy as np
from ngsolve_factors import factors
from record import Record
from solid_cases import Array, SolidCase
from solid_measure import main, march


def mesh_of(case: SolidCase) -> ng.Mesh:
    """The case's mesh; vertices keep their numbers."""
    mesh = netgen.Mesh(dim=3)
    points = [mesh.Add(netgen.MeshPoint(netgen.Pnt(*map(float, p)))) for p in case.points]
    mesh.Add(netgen.FaceDescriptor(surfnr=1, domin=1, domout=0, bc=1))
    mesh.SetMaterial(1, "rubber")
    for cell in case.cells:
        mesh.Add(netgen.Element3D(1, [points[k] for k in cell]))
    return ng.Mesh(mesh)


class NGSolve:
    """The discretisation; unknowns are numbered direction by direction."""

    def __init__(self, case: SolidCase) -> None:
        space = ng.VectorH1(mesh_of(case), order=1)
        lame, mu = case.lame
        u, w = space.TnT()
        rule = {ng.HEX: ng.IntegrationRule(ng.HEX, 3)}
        dx = ng.dx(intrules=rule)
        F = (ng.Id(3) + ng.Grad(u)).MakeVariable()
        lnJ = ng.log(ng.Det(F))
        W = mu / 2 * (ng.InnerProduct(F, F) - 3 - 2 * lnJ) + lame / 2 * lnJ * lnJ
        self.form = ng.BilinearForm(space, symmetric=True)
        self.form += ng.Variation(W.Compile(realcompile=True, wait=True) * dx)
        mass = ng.BilinearForm(space, symmetric=True)
        mass += case.density * ng.InnerProduct(u, w) * dx
        self.mass = mass.Assemble().mat
        self.free = ng.BitArray(space.ndof)
        self.free.Set()
        for k in np.flatnonzero(self.vector(np.repeat(case.held[:, None], 3, axis=1))):
            self.free.Clear(int(k))
        self.inverse: Any = None
        self.u, self.out = (ng.GridFunction(space).vec.CreateVector() for _ in range(2))

    def vector(self, nodal: Array) -> Array:
        return nodal.T.reshape(-1).astype(float)

    def nodal(self, vector: Array) -> Array:
        return vector.reshape(3, -1).T

    def at(self, u: Array) -> ng.BaseVector:
        self.u.FV().NumPy()[:] = u
        return self.u

    def force(self, u: Array) -> Array:
        self.form.Apply(self.at(u), self.out)
        return np.array(self.out.FV().NumPy())

    def prepare(self, u: Array, c: float) -> None:
        self.form.AssembleLinearization(self.at(u))
        if c:
            self.form.mat.AsVector().data += c * self.mass.AsVector()

    def solve(self, r: Array, jump: Array) -> Array:
        if jump.any():
            self.out.data = self.form.mat * self.at(jump)
            r = r - self.out.FV().NumPy()
        self.inverse = factors(self.form.mat, self.free, self.inverse, flags={"ordering": "metis"})
        self.out.data = self.inverse * self.at(r)
        return np.asarray(jump + self.out.FV().NumPy())

    def inertia(self, a: Array) -> Array:
        self.out.data = self.mass * self.at(a)
        return np.array(self.out.FV().NumPy())

    def strain_energy(self, u: Array) -> float:
        return float(self.form.Energy(self.at(u)))


def run(case: SolidCase, variant: str, audited: bool) -> Record:
    """March the case; see `solid_measure.main`."""
    return march(NGSolve(case), case, audited)


if __name__ == "__main__":
    ng.SetNumThreads(1)
    main(run, ("PARDISO",))
