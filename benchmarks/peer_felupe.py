"""The solids in felupe with PARDISO (`pip install felupe pypardiso`)."""

from __future__ import annotations

import felupe
import numpy as np
import pypardiso
from record import Record
from solid_cases import Array, SolidCase
from solid_measure import main, march


class Felupe:
    """The discretisation; unknowns are numbered node by node."""

    def __init__(self, case: SolidCase) -> None:
        region = felupe.RegionHexahedron(felupe.Mesh(case.points, case.cells, "hexahedron"))
        self.field = felupe.FieldContainer([felupe.Field(region, dim=3)])
        lame, mu = case.lame
        self.material = felupe.NeoHookeCompressible(mu=mu, lmbda=lame)
        self.solid = felupe.SolidBody(self.material, self.field, density=case.density)
        self.mass = self.solid.assemble.mass()
        self.free = np.flatnonzero(np.repeat(~case.held, 3))
        self.held = np.flatnonzero(np.repeat(case.held, 3))

    def vector(self, nodal: Array) -> Array:
        return nodal.reshape(-1)

    def nodal(self, vector: Array) -> Array:
        return vector.reshape(-1, 3)

    def force(self, u: Array) -> Array:
        self.field[0].values[:] = u.reshape(-1, 3)
        return np.asarray(self.solid.assemble.vector(self.field).toarray().ravel())

    def prepare(self, u: Array, c: float) -> None:
        K = self.solid.assemble.matrix(self.field)
        self.matrix = K + c * self.mass if c else K

    def solve(self, r: Array, jump: Array) -> Array:
        d = jump.copy()
        rows = self.matrix[self.free]
        d[self.free] = pypardiso.spsolve(
            rows[:, self.free], r[self.free] - rows[:, self.held] @ jump[self.held]
        )
        return d

    def inertia(self, a: Array) -> Array:
        return np.asarray(self.mass @ a)

    def strain_energy(self, u: Array) -> float:
        self.field[0].values[:] = u.reshape(-1, 3)
        (density,) = self.material.function([*self.field.extract(), None])[:1]
        at_rest = 1.5 * self.material.mu
        return float(((density - at_rest) * self.field.region.dV).sum())


def run(case: SolidCase, variant: str, audited: bool) -> Record:
    """March the case; see `solid_measure.main`."""
    return march(Felupe(case), case, audited)


if __name__ == "__main__":
    main(run, ("PARDISO",))
