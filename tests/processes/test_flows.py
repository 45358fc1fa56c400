"""Flows by several processes, velocities and pressures in turn."""

from __future__ import annotations

from pathlib import Path

import pytest

from processes.launch import launched, missing

pytestmark = pytest.mark.skipif(bool(missing()), reason=f"needs {missing()}")

FLOWS = """
import sys
import numpy as np
import visviva as vv
from visviva.base.world import world
from visviva.linear import choice

choice.LARGE_FLOW = 0
directory, by = sys.argv[1:]

def stepped(cell, n, step):
    water = vv.Fluid(mesh=vv.BoxMesh(size=(2, 1, 1), counts=(2 * n, n, n), cell=cell), density=1.0, viscosity=0.05)
    profile = lambda t, X: 5 * t * X[:, 1:2] * (1 - X[:, 1:2]) * [4, 0, 0]
    inlet, out = vv.VelocityBoundary(fluid=water, faces="x0", velocity=profile), vv.Outlet(fluid=water, faces="x1")
    walls = [vv.NoSlip(fluid=water, faces=side) for side in ("y0", "y1", "z0", "z1")]
    linear = vv.Direct() if by == "factors" else vv.Petsc()
    system = vv.System([water, inlet, out, *walls], newton=vv.Newton(linear=linear))
    vv.simulate(system, until=2 * step, step=step)
    return system

for cell, n, step in (("hex8", 4, 0.02), ("hex8", 4, 0.2), ("hex27", 3, 0.02), ("hex27", 3, 2.0)):
    system, file = stepped(cell, n, step), f"{directory}/{cell}{step}.npy"
    if by == "factors":
        np.save(file, system.x)
    elif world().rank == 0:
        known = np.load(file)
        away = np.abs(system.x - known).max() / np.abs(known).max()
        print(away < 1e-10, system.core.solver == "PETSc: GMRES with velocities and pressures in turn")
"""


def test_flows_are_those_of_factors(tmp_path: Path) -> None:
    """Of elements that are stabilised and such that are not, by short steps and long ones."""
    (tmp_path / "script.py").write_text(FLOWS)
    for n, by in ((0, "factors"), (1, "PETSc"), (3, "PETSc")):
        done = launched(n, str(tmp_path / "script.py"), str(tmp_path), by)
        assert done.returncode == 0, done.stderr
        assert done.stdout.split() == (["True"] * 8 if n else [])
