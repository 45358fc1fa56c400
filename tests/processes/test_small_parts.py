"""Bodies with fewer cells than there are processes: a run by some goes on with any number."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from processes.launch import launched, missing
from visviva.output.tables import read_table

pytestmark = pytest.mark.skipif(bool(missing()), reason=f"needs {missing()}")
SMALL = """
import sys

import visviva as vv

rubber = vv.NeoHooke(young=100.0, poisson=0.3)


def box(x, n=1, z=0.0):
    return vv.BoxMesh(size=(1, 1, 1), counts=(n, 1, 1), origin=(x, 0, z))


parts = []
for k, formulation in enumerate(("displacement", "enhanced", "mixed", "F-bar")):
    parts.append(vv.Solid(mesh=box(3 * k), material=rubber, density=1.0, formulation=formulation, velocity=(0, 0, -1),
                          name=formulation))
warm = vv.ThermalBody(mesh=box(12), conductivity=1.0, capacity=1.0, temperature=lambda X: 300 + X[:, 0], name="warm")
long = vv.ThermalBody(mesh=box(15, 3), conductivity=1.0, capacity=1.0, temperature=lambda X: 300 + X[:, 0], name="long")
floor = vv.Solid(mesh=box(0, z=-1.12), material=rubber, density=1.0, name="floor")
contact = vv.Contact(first=parts[0], first_faces="z0", second=floor, second_faces="z1", friction=0.3)
parts += [floor, contact, warm, long, vv.HeatFlux(body=warm, faces="x1", flux=3.0)]
study = vv.Study(vv.System(parts), float(sys.argv[2]), 0.05, title="small")
result = vv.run(study, sys.argv[1], pictures=False, progress=False, every=1, resume=len(sys.argv) > 3)
"""


def test_runs_of_small_parts_go_on(tmp_path: Path) -> None:
    """A process that had none of a body's cells knew other records, and refused the file."""
    script, run = tmp_path / "small.py", tmp_path / "run"
    script.write_text(SMALL)
    for n, name, until in (
        (0, "alone", 0.4),
        (2, "run", 0.2),
        (2, "run", 0.3),
        (3, "run", 0.35),
        (0, "run", 0.4),
    ):
        more = ["resume"] if (tmp_path / name).exists() else []
        done = launched(n, str(script), str(tmp_path / name), str(until), *more)
        assert done.returncode == 0, done.stderr
    one, other = (read_table(place / "ledger.csv") for place in (tmp_path / "alone", run))
    assert list(one) == list(other)
    size = max(float(np.abs(column).max()) for column in one.values())
    assert max(float(np.abs(one[name] - other[name]).max()) for name in one) < 1e-11 * size
    assert np.abs(one["time"][1:]).min() > 0


EMPTY = """
import sys

import numpy as np
import visviva as vv
from visviva.base.world import world


def energy(C):
    assert C[0].max() > 0  # of no points at all there is no largest
    return 20 * ((C[0] + C[1] + C[2] - 3) ** 2 + 2 * (C[3] ** 2 + C[4] ** 2 + C[5] ** 2))


def box(x):
    return vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1), origin=(x, 0, 0))


def flat(x):
    return vv.RectangleMesh(size=(1, 1), counts=(1, 1), origin=(x, 0))


def pull(t, X):
    return np.outer(X[:, 0] / X[:, 0].max(), [0, t, 0])


given = {"angular_velocity": (0, 0, 0.5), "material": vv.UserMaterial(function=energy), "density": 1.0}
bodies = [
    vv.Solid(mesh=box(0), **given),
    vv.Solid(mesh=box(2), formulation="F-bar", **given),
    vv.Solid(mesh=box(4), formulation="enhanced", **given),
    vv.Solid(mesh=flat(6), plane="stress", thickness=0.1, **given),
    vv.Solid(mesh=flat(8), formulation="F-bar", **given),
]
system = vv.System([*bodies, *(vv.Traction(solid=b, faces="x1", traction=pull) for b in bodies)])
vv.simulate(system, until=0.2, step=0.05)
found = [system.x]
for body in bodies:
    found += [body.smoothed(["von_mises"], system.x)["von_mises"], body.mean("energy", system.x)]
    found += [np.ravel(body.fields(system.x).F), np.ravel(body.nodal_forces(system.x))]
if world().rank == 0:
    np.save(sys.argv[1], np.concatenate(found))
"""


def test_functions_of_the_user_are_not_asked_about_no_points(tmp_path: Path) -> None:
    """Processes without cells asked an energy of F-bar, with strains that are not its own, and all ended."""
    (tmp_path / "empty.py").write_text(EMPTY)
    for n in (0, 2, 3):
        done = launched(n, str(tmp_path / "empty.py"), str(tmp_path / f"{n}.npy"))
        assert done.returncode == 0, done.stderr
    one, *others = (np.load(tmp_path / f"{n}.npy") for n in (0, 2, 3))
    for other in others:
        assert np.abs(other - one).max() < 1e-11 * np.abs(one).max()
