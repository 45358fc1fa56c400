"""Large solids: bytes of each unknown, and a matrix that multigrid borrows instead of keeping its own."""

import os
import subprocess
import sys

import numpy as np
import pytest

import visviva as vv
from visviva.analysis.load_steps import Equilibrium

RUBBER = vv.SaintVenantKirchhoff(young=1e3, poisson=0.3)
GROWN = """
import visviva as vv
from visviva.analysis.march import prepare

def now():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * 4096

n = 47
before = now()
mesh = vv.BoxMesh(size=(1, 1, 1), counts=(n, n, n)).build()
solid = vv.Solid(mesh=mesh, material=vv.SaintVenantKirchhoff(young=1e3, poisson=0.3), density=1.0)
pull = vv.Traction(solid=solid, faces="x1", traction=(0.0, 1.0, 0.0), times="t")
system = vv.System([solid, vv.Fixed(solid=solid, nodes="x0"), pull])
print(system.core.n_equations, now() - before, 12 * len(system.core.csr[1]))
"""


def test_bytes_of_bricks_beside_their_matrix() -> None:
    """Gradients at points and masses alone would be 620 for each equation, rigid motions kept for multigrid 96."""
    done = subprocess.run(
        [sys.executable, "-c", GROWN],
        env={**os.environ, "OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        check=True,
    )
    n, grown, matrix = map(int, done.stdout.split())
    assert n >= 300_000
    assert (grown - matrix) / n < 650


def block(linear: vv.Iterative | vv.Direct) -> vv.System:
    """A block on three planes of symmetry, whose held unknowns have rows beside free ones."""
    solid = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(4, 4, 9)), material=RUBBER)
    hold = [
        vv.Fixed(solid=solid, nodes=f"{axis}0", directions=(axis == "x", axis == "y", axis == "z"))
        for axis in "xyz"
    ]
    pull = vv.Traction(solid=solid, faces="z1", traction=(0.0, 0.0, 1.0), times="t")
    return vv.System([solid, *hold, pull], newton=vv.Newton(linear=linear))


def test_who_looks_at_the_tangent_leaves_what_multigrid_borrows(monkeypatch: pytest.MonkeyPatch) -> None:
    """The solution is asked for once more after a look, as at the start of an arc, and has the digits of factors."""
    choose = vv.Iterative.choose

    def borrowing(options, problem):  # type: ignore[no-untyped-def]
        choice = choose(options, problem)
        for one in choice.in_order:
            one.borrow_from = 0
        return choice

    monkeypatch.setattr(vv.Iterative, "choose", borrowing)
    found = []
    for linear in (vv.Iterative(preconditioner="multigrid", max_iterations=60), vv.Direct()):
        equilibrium = Equilibrium(block(linear), vv.Static())
        equilibrium.linearise(0.0)
        slope = equilibrium.slope(0.0, 1.0)
        once = equilibrium.solve(0.0, slope)
        found.append(equilibrium.refined(0.0, slope, once))
    assert np.abs(found[0] - found[1]).max() < 1e-10 * np.abs(found[1]).max()
