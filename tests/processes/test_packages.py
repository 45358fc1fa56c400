"""What visviva-petsc does with PETSc and MPI: options that go with their solver, messages, patience."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from processes.launch import launched, missing

pytestmark = pytest.mark.skipif(bool(missing()), reason=f"needs {missing()}")


def said(n: int, script: str, directory: Path) -> str:
    """What a script prints in so many processes."""
    (directory / "script.py").write_text(script)
    done = launched(n, str(directory / "script.py"))
    assert done.returncode == 0, done.stderr
    return done.stdout


OPTIONS = """
import gc
from petsc4py import PETSc
import visviva as vv

def run():
    rubber, mesh = vv.NeoHooke(young=1e3, poisson=0.3), vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2))
    block = vv.Solid(mesh=mesh, material=rubber)
    pull = vv.Traction(solid=block, faces="x1", traction=(1, 0, 0), times="t")
    parts = [block, vv.Fixed(solid=block, nodes="x0"), pull]
    system = vv.System(parts, newton=vv.Newton(linear=vv.Petsc("-ksp_rtol 1e-8")))
    vv.simulate(system, until=1.0, step=0.5, scheme=vv.Static())
    return ours()

def ours():
    return sum("visviva" in name for name in PETSc.Options().getAll())

there = run()
gc.collect()
print(there > 0, ours())
"""


def test_options_of_petsc_go_with_their_solver(tmp_path: Path) -> None:
    assert said(0, OPTIONS, tmp_path).split() == ["True", "0"]


UNKNOWN = """
import visviva as vv
from visviva.base.world import world
from visviva.linear.choice import Problem
from visviva_petsc.choice import choose

solid, joints = Problem(n=54, n_entries=1800, symmetric=True, definite=True, has_modes=True), Problem(n=9, n_entries=27)
for problem, options in (
    (solid, "-ksp_rtol 1e-9 -ksp_view -mg_levels_ksp_max_it 3 -mg_levels_4_pc_type sor"),
    (solid, "-ksp_rtol 1e-9 -ksp_rtoll 1e-9 -log_view"),
    (solid, "-ksp_rtol much"),
    (solid, "-pc_type nonsense"),
    (joints, "-mat_nothing 1"),
    (joints, "-ksp_rtol 1e-9 -pc_type lu"),
    (solid, "-ksp_atol 1e-2"),
):
    try:
        told = vv.Petsc(options).choose(problem).explanation.split(", with ")[1]
    except vv.InputError as error:
        told = str(error)
    if world().rank == 0:
        print(told)
"""


def test_options_that_no_solver_takes_are_refused_by_name(tmp_path: Path) -> None:
    for n in (0, 2):
        told = said(n, UNKNOWN, tmp_path).splitlines()
        assert "-mg_levels_4_pc_type sor" in told[0]
        assert "no solver here takes -ksp_rtoll, -log_view (" in told[1]
        assert "much has no numeric value" in told[2]
        assert "PC type nonsense" in told[3]
        assert "no solver here takes -mat_nothing (here are: factors of " in told[4]
        assert "-pc_type lu" in told[5]
        assert "by -ksp_atol a solver may end where it begins" in told[6]


IDLE = """
import visviva as vv
from visviva.base.world import world

ends = []
for options in ("", "-ksp_max_it 0 -ksp_converged_maxits"):
    bar = vv.Solid(
        mesh=vv.BoxMesh(size=(4, 1, 1), counts=(4, 1, 1)), density=1.0, material=vv.NeoHooke(young=100.0, poisson=0.3)
    )
    pull = vv.Traction(solid=bar, faces="x1", traction=(0, 0.5, 0), times="t")
    parts = [bar, vv.Fixed(solid=bar, nodes="x0"), pull]
    system = vv.System(parts, newton=vv.Newton(linear=vv.Petsc(options)))
    vv.simulate(system, until=0.2, step=0.05)
    ends.append(float(system.x[-2]))
if world().rank == 0:
    print(ends[0] > 1.0, abs(ends[1] - ends[0]) < 1e-9)
"""


def test_what_a_solver_leaves_whole_is_solved_by_another(tmp_path: Path) -> None:
    """No increment was taken for a step that needs none: nothing moved, and the audit said that all was well."""
    for n in (0, 2):
        assert said(n, IDLE, tmp_path).splitlines()[-1] == "True True"


JOINTED = """
import numpy as np
import visviva as vv

def solved(linear):
    rubber, mesh = vv.NeoHooke(young=100, poisson=0.3), vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2))
    solid = vv.Solid(mesh=mesh, material=rubber, density=1)
    body = vv.RigidBody(mass=2.0, inertia=(1, 1, 1), position=(1.5, 0.5, 0.5))
    held = vv.RigidCoupling(solid=solid, faces="x1")
    joint = vv.Rigid(a=held, b=body, at=(1.2, 0.5, 0.5))
    parts = [solid, body, held, joint, vv.Fixed(solid=solid, nodes="x0"), vv.Gravity()]
    system = vv.System(parts, newton=vv.Newton(linear=linear))
    start = system.x.copy()
    vv.simulate(system, until=0.2, step=0.05)
    return system, start

(system, start), (own, _) = solved(vv.Petsc("-pc_type lu -pc_factor_shift_type nonzero")), solved(vv.Direct())
moving = own.order > 0
print(np.abs(system.x - own.x)[moving].max() < 1e-10 * np.abs(own.x - start)[moving].max(), system.core.solver)
"""


def test_joints_are_solved_by_what_the_user_names(tmp_path: Path) -> None:
    """Their equations have no diagonal, which factors want to find."""
    assert said(0, JOINTED, tmp_path).split()[:2] == ["True", "PETSc:"]


FACTORED = """
import sys
import numpy as np
from mpi4py import MPI
from petsc4py import PETSc
import visviva as vv
from visviva.base.world import world

def stepped(linear):
    solid = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(4, 2, 2)), material=vv.NeoHooke(young=100, poisson=0.3))
    body, ground = vv.RigidBody(mass=2.0, inertia=(1, 1, 1), position=(1.5, 0.5, 0.5)), vv.Ground()
    held = vv.RigidCoupling(solid=solid, faces="x1")
    weld = vv.Rigid(a=held, b=body, at=(1.2, 0.5, 0.5))
    hinge = vv.Revolute(a=ground, b=body, at=(2.0, 0.5, 0.5), axis=(0, 1, 0))
    parts = [solid, body, ground, held, weld, hinge, vv.Gravity(acceleration=(0, 0, -9.81))]
    system = vv.System(parts, newton=vv.Newton(linear=linear))
    start = system.x.copy()
    vv.simulate(system, until=0.2, step=0.05, scheme=vv.BackwardEuler())
    return system, start

package, file = sys.argv[1:]
if package == "none":
    system, start = stepped(vv.Direct())
    np.savez(file, x=system.x[system.order > 0], way=np.abs(system.x - start)[system.order > 0].max())
elif not PETSc.Sys.hasExternalPackage(package):
    print("missing")
else:
    system, _ = stepped(vv.Petsc(f"-pc_factor_mat_solver_type {package}"))
    known = np.load(file)
    if world().rank == 0:
        told = f"with -pc_factor_mat_solver_type {package}" in system.linear_explanation and system.core.solver
        print(np.abs(system.x[system.order > 0] - known["x"]).max() < 1e-10 * known["way"], told)
"""


@pytest.mark.parametrize("package", ["mumps", "superlu_dist"])
def test_factors_that_processes_share_are_those_of_one(package: str, tmp_path: Path) -> None:
    (tmp_path / "script.py").write_text(FACTORED)
    for n, name in ((0, "none"), (2, package)):
        done = launched(n, str(tmp_path / "script.py"), name, str(tmp_path / "known.npz"))
        assert done.returncode == 0, done.stderr
    if done.stdout.startswith("missing"):
        pytest.skip(f"PETSc was built without {package}")
    assert done.stdout.startswith("True PETSc: factors of")


PIECES = """
import numpy as np
from mpi4py import MPI
from visviva_petsc import gathered

gathered.PIECE = 3  # as if a message could not count any further
comm = MPI.COMM_WORLD
sizes = [4, 0, 10]
found = gathered.gathered(comm, 100.0 * comm.rank + np.arange(sizes[comm.rank]))
if comm.rank == 0:
    print([part.tolist() for part in found] == [[100.0 * k + i for i in range(n)] for k, n in enumerate(sizes)])
else:
    assert found == []
"""


def test_more_numbers_than_a_message_counts_come_in_pieces(tmp_path: Path) -> None:
    assert said(3, PIECES, tmp_path).split() == ["True"]


MERGED = """
import sys
from functools import partial
import numpy as np
import visviva as vv
from visviva.base.world import world
from visviva.linear.choice import Automatic, Choice, LinearOptions
from visviva_petsc import choice, gathered

class Kept(gathered.Gathered):
    def analyze(self, row, col, unknown, of):
        super().analyze(row, col, unknown, of)
        if self.comm.rank == 0:
            np.savez(sys.argv[1], known=self.known, **self.whole)

class ByFirst(LinearOptions):
    is_shared = True

    def choose(self, problem):
        own = Automatic().choose(problem)
        return Choice(tuple(choice.outside(partial(Kept, by)) for by in own.in_order), own.explanation)

rubber = vv.NeoHooke(young=100.0, poisson=0.3)
size, at = (1, 1, 1), (1.001, 0.1, -0.1)
one, two = vv.BoxMesh(size=size, counts=(3, 2, 2)), vv.BoxMesh(size=size, counts=(2, 3, 3), origin=at)
left, right = (vv.Solid(mesh=mesh, material=rubber, density=1.0, name=str(k)) for k, mesh in enumerate((one, two)))
meet = vv.Contact(first=right, first_faces="x0", second=left, second_faces="x1")
parts = [left, right, meet, vv.Fixed(solid=left, nodes="x0"), vv.Gravity(acceleration=(-9.81, 0, 0))]
system = vv.System(parts, newton=vv.Newton(linear=ByFirst()))
vv.simulate(system, until=0.2, step=0.05)
told = system.linear_explanation
if world().rank == 0:
    print("saddle" in told, told.count("pressures condensed"))
"""


def test_the_first_process_knows_of_equations_what_one_process_knows(tmp_path: Path) -> None:
    """Where blocks of nodes and what has no inertia were not told, contact was solved by factors alone."""
    (tmp_path / "script.py").write_text(MERGED)
    found = []
    for n in (0, 2):
        done = launched(n, str(tmp_path / "script.py"), str(tmp_path / f"{n}.npz"))
        assert done.returncode == 0, done.stderr
        assert done.stdout.split() == ["True", "0"]
        found.append(dict(np.load(tmp_path / f"{n}.npz")))
    assert found[0].keys() == found[1].keys() >= {"known", "node", "algebraic", "scale", "modes"}
    assert found[0]["algebraic"].any() and found[0]["modes"].any()  # noqa: PT018
    assert all(np.array_equal(found[0][name], found[1][name]) for name in found[0])


PATIENT = """
import time
from visviva.base.world import world
from visviva_petsc import world as together

together.PATIENCE = 0.2
those = world()
time.sleep(1.0 + 0.6 * those.rank)  # one has more to do before it comes to the same error
met = those.meets()
if those.rank == 0:
    print(met)
"""


def test_who_has_worked_long_waits_long_for_others(tmp_path: Path) -> None:
    """A fixed patience took processes that are slower for such that go on, and told of an error that all have twice."""
    assert said(2, PATIENT, tmp_path).split() == ["True"]


ALONE = """
import os
os.environ["PMIX_RANK"] = "0"
from visviva.base.world import Alone, world
print(isinstance(world(), Alone))
"""


def test_one_process_with_a_rank_of_pmix_is_alone(tmp_path: Path) -> None:
    """MPICH asked for its size ends the process where no server of PMIx answers."""
    assert said(0, ALONE, tmp_path).split() == ["True"]


MANY = """
import gc
import visviva as vv
from visviva.base.world import world

def used():
    gc.collect()
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) / 256  # MiB, of pages of 4 KiB

sizes, mesh = [], vv.BoxMesh(size=(1, 1, 1), counts=(12, 10, 10))
for _ in range(8):
    block = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=10.0, poisson=0.3), density=1.0)
    vv.System([block, vv.Fixed(solid=block, nodes="x0"), vv.Gravity()]).step(0.01)
    del block
    sizes.append(used())
if world().rank == 0:
    print(sizes[-1] - sizes[1])
"""


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="memory is read from /proc")
def test_systems_that_are_no_more_take_no_memory(tmp_path: Path) -> None:
    """PETSc kept the matrices of each until the end, 5 MiB here: processes may let go of them at different times."""
    assert float(said(2, MANY, tmp_path)) < 12.0


SIGNALLED = """
import os
import signal
import sys

import visviva as vv

signal.signal(signal.SIGTERM, lambda *given: sys.exit(print("saved", flush=True) or 5))
rubber, mesh = vv.NeoHooke(young=100, poisson=0.3), vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2))
block = vv.Solid(mesh=mesh, material=rubber, density=1.0)
linear = vv.Petsc() if sys.argv[1] == "0" else None
system = vv.System([block, vv.Gravity()], newton=vv.Newton(linear=linear))
system.step(0.01)
os.kill(os.getpid(), signal.SIGPIPE)  # which Python ignores
os.kill(os.getpid(), signal.SIGTERM)
print("went on")
"""


@pytest.mark.parametrize("n", [0, 2])
def test_signals_do_what_the_script_has_said(n: int, tmp_path: Path) -> None:
    """PETSc took them, and aborted."""
    (tmp_path / "script.py").write_text(SIGNALLED)
    done = launched(n, str(tmp_path / "script.py"), str(n), limit=60)
    assert done.returncode == 5, done.stderr
    assert done.stdout.count("saved") == max(n, 1)
    assert "went on" not in done.stdout
