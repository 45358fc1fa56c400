"""The half cylinder of `half_cylinder.py` at rest in the flow, body-fitted, in NGSolve (`pip install ngsolve mkl`).

    python benchmarks/half_cylinder_fitted.py [--sizes 0.1 0.05]

prints how far its top moves and how its area changes, for three laws of the solid, as they are and where it keeps
its volume, as an immersed one does, which moves with an incompressible fluid. One system of equations: velocity and
displacement P2 everywhere, pressure P1 in the fluid, and in the solid where that keeps its volume.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import Any

import netgen.occ as occ
import ngsolve as ng
import numpy as np
from half_cylinder_case import CENTRE, FLOOR, HEIGHT, LAME, LENGTH, RADIUS, SHEAR

SOFT = 1e-10
"""Of the fluid's mesh: on the solid's surface its equations are added to those that hold the velocity there."""
STEPS, MOST, TOLERANCE = 8, 25, 1e-9


def linear(F: Any) -> Any:
    """Linear elasticity, of whatever displacements."""
    strain = ng.Sym(F) - ng.Id(2)
    return LAME * ng.Trace(strain) * ng.Id(2) + 2 * SHEAR * strain


def saint_venant_kirchhoff(F: Any) -> Any:
    """Saint-Venant and Kirchhoff's law."""
    strain = 0.5 * (F.trans * F - ng.Id(2))
    return F * (LAME * ng.Trace(strain) * ng.Id(2) + 2 * SHEAR * strain)


def neo_hooke(F: Any) -> Any:
    """That of the package."""
    inverse = ng.Inv(F).trans
    return SHEAR * (F - inverse) + LAME * ng.log(ng.Det(F)) * inverse


LAWS: dict[str, Callable[[Any], Any]] = {
    "linear elastic": linear,
    "Saint-Venant-Kirchhoff": saint_venant_kirchhoff,
    "neo-Hooke": neo_hooke,
}


def mesh_of(size: float) -> ng.Mesh:
    """Triangles, `size` in the solid and up to three times that in the fluid."""
    channel = occ.MoveTo(0, FLOOR).Rectangle(LENGTH, HEIGHT).Face()
    channel.edges.Min(occ.X).name, channel.edges.Max(occ.X).name = "inflow", "outlet"
    channel.edges.Min(occ.Y).name = channel.edges.Max(occ.Y).name = "wall"
    solid = occ.Circle(CENTRE, RADIUS).Face() * channel
    solid.faces.name, solid.faces.maxh = "solid", size
    solid.edges.Min(occ.Y).name = "wall"
    fluid = channel - solid
    fluid.faces.name = "fluid"
    whole = occ.OCCGeometry(occ.Glue([fluid, solid]), dim=2)
    mesh = ng.Mesh(whole.GenerateMesh(maxh=3 * size, grading=0.3))
    return mesh.Curve(2)


class Rest:
    """The steady equations on triangles of a size."""

    def __init__(self, size: float, law: Callable[[Any], Any], keeps_volume: bool) -> None:
        self.mesh = mesh_of(size)
        velocities = ng.VectorH1(self.mesh, order=2, dirichlet="inflow|wall")
        places = ng.VectorH1(self.mesh, order=2, dirichlet="inflow|wall|outlet")
        parts = ("fluid", "solid") if keeps_volume else ("fluid",)
        pressures = [ng.H1(self.mesh, order=1, definedon=part) for part in parts]
        self.space = ng.FESpace([velocities, places, *pressures])
        self.state = ng.GridFunction(self.space)
        self.f = ng.BilinearForm(self.space)
        (v, d, p, *inner), (w, z, q, *volume) = self.space.TnT()
        F = ng.Id(2) + ng.Grad(d)
        J, inverse = ng.Det(F), ng.Inv(F)
        rates, tests = ng.Grad(v) * inverse, ng.Grad(w) * inverse
        stress = 2 * ng.Sym(rates) - p * ng.Id(2)  # density and viscosity are one
        fluid = (rates * v) * w + ng.InnerProduct(stress, tests) - q * ng.Trace(rates)
        moved = SOFT * ng.InnerProduct(F - inverse.trans + ng.log(J) * inverse.trans, ng.Grad(z))
        solid = ng.InnerProduct(law(F), ng.Grad(w)) + v * z
        if keeps_volume:
            solid -= inner[0] * J * ng.Trace(tests) + volume[0] * (J - 1)
        self.f += (J * fluid + moved).Compile() * ng.dx("fluid") + solid.Compile() * ng.dx("solid")

    def let_in(self, part: float) -> None:
        """Set the inflow to a part of the whole."""
        velocities = self.space.components[0]
        held = ng.GridFunction(velocities)
        profile = ng.CF((part * (1 + 2 * ng.y) * (1 - ng.y), 0))
        held.Set(profile, definedon=self.mesh.Boundaries("inflow"))
        fixed = ~np.array(list(velocities.FreeDofs()))
        self.state.components[0].vec.FV().NumPy()[fixed] = held.vec.FV().NumPy()[fixed]

    def solve(self) -> None:
        """Newton's method."""
        residual, change = (self.state.vec.CreateVector() for _ in range(2))
        for _ in range(MOST):
            self.f.Apply(self.state.vec, residual)
            self.f.AssembleLinearization(self.state.vec)
            change.data = self.f.mat.Inverse(self.space.FreeDofs(), "pardiso") * residual
            self.state.vec.data -= change
            size = np.abs(change.FV().NumPy()[: self.space.components[0].ndof]).max()
            if size < TOLERANCE:
                return
            if not size < 1e3:
                break
        raise RuntimeError("no equilibrium")

    def answer(self) -> str:
        """Displacement of the top, and the solid's area per that of the start."""
        moved = self.state.components[1]
        x, y = moved(self.mesh(CENTRE[0], CENTRE[1] + RADIUS - 1e-9))
        solid = self.mesh.Materials("solid")
        now, start = (
            ng.Integrate(ng.CF(a), self.mesh, definedon=solid) for a in (ng.Det(ng.Id(2) + ng.Grad(moved)), 1)
        )
        return f"{x:.4f}, {y:.4f}, area {now / start:.4f}"


def rest(size: float, law: Callable[[Any], Any], keeps_volume: bool) -> str:
    """What is found at the whole inflow, or where nothing is found any more."""
    equations = Rest(size, law, keeps_volume)
    for step in range(1, STEPS + 1):
        equations.let_in(step / STEPS)
        try:
            equations.solve()
        except RuntimeError as failure:
            return f"{failure} at {step / STEPS:.3g} of the inflow"
    return equations.answer()


def main() -> None:
    """Print what the laws do."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    options.add_argument(
        "--sizes", type=float, nargs="+", default=[0.1, 0.05], help="of triangles in the solid"
    )
    sizes = options.parse_args().sizes
    for name, law in LAWS.items():
        for keeps_volume in (False, True):
            for size in sizes:
                kind = "keeps its volume" if keeps_volume else "as it is"
                print(f"{name}, {kind}, triangles of {size}: {rest(size, law, keeps_volume)}", flush=True)


if __name__ == "__main__":
    ng.SetNumThreads(1)
    main()
