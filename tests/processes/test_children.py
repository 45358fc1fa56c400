"""What one of several processes starts by itself, or forks: none of them, it ends and computes alone."""

from __future__ import annotations

from pathlib import Path

import pytest

from processes.launch import launched, missing

pytestmark = pytest.mark.skipif(bool(missing()), reason=f"needs {missing()}")
FORKS = """
import atexit
import os
import signal
import sys
import time

import visviva as vv
from visviva.base.world import world


def made():
    block = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(4, 2, 2)), material=vv.NeoHooke(young=1.0, poisson=0.3),
                     density=1.0, angular_velocity=(0, 0, 1), name="block")
    return vv.System([block])


def child(kind):
    if kind == "error":
        raise KeyError("of the child")
    if kind == "raised":
        raise SystemExit(4)
    if kind == "exit":
        exit(5)
    if kind == "ended":
        time.sleep(60)
    if kind == "caught":
        try:
            sys.exit(6)
        except SystemExit:
            sys.exit()
    if kind == "file":
        global left_open
        atexit.register(print, "handled")
        left_open = open(sys.argv[1], "w")
        left_open.write("data")
        sys.exit()
    if kind == "own system":
        system = made()
        vv.simulate(system, until=0.1, step=0.05)
        os._exit(not (abs(system.x - reached).max() < 1e-9 and world().size == 1))
    if kind == "their system":
        try:
            system.step(0.05)
        except vv.InputError as error:
            os._exit("none of the 2 that share" in str(error))
    sys.exit(kind)


system = made()
vv.simulate(system, until=0.1, step=0.05)
reached = system.x.copy()
kinds = (0, 3, "error", "ended", "raised", "exit", "caught", "file", "own system", "their system")
for kind in kinds if world().rank == 0 else ():
    forked = os.fork()
    if forked == 0:
        child(kind)
    if kind == "ended":
        time.sleep(0.2)
        os.kill(forked, signal.SIGTERM)
    print(os.waitstatus_to_exitcode(os.waitpid(forked, 0)[1]), flush=True)
vv.simulate(system, until=0.2, step=0.05)
if world().rank == 0:
    print(open(sys.argv[1]).read(), "through")
"""


@pytest.mark.parametrize("before", ["", "import mpi4py.MPI\n"], ids=["visviva", "MPI"])
def test_what_a_process_forks_ends_alone(before: str, tmp_path: Path) -> None:
    """It ended all others; or with status 0 where it had failed, and files that it left open were empty.

    Where MPI was imported before, it ended with status 1 whatever it did.
    """
    (tmp_path / "forks.py").write_text(before + FORKS)
    done = launched(2, str(tmp_path / "forks.py"), str(tmp_path / "data"), limit=120)
    assert done.returncode == 0, done.stderr
    assert " ".join(done.stdout.split()) == "0 3 1 -15 4 5 0 handled 0 0 1 data through"
    assert done.stderr.count("of the child") == 2  # a line of the script, and the error


OTHER = """
from mpi4py import MPI

MPI.get_vendor = lambda: ("another", (1, 0, 0))
"""


def test_what_is_forked_from_mpi_that_nobody_knows_has_to_say_its_status(tmp_path: Path) -> None:
    (tmp_path / "forks.py").write_text(OTHER + FORKS.replace("kinds = (0,", "kinds = (0,) or ("))
    done = launched(2, str(tmp_path / "forks.py"), str(tmp_path / "forks.py"), limit=120)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("1\n")
    assert done.stderr.count("end it by os._exit(status)") == 1


SOLVING = """
import multiprocessing
import os
import subprocess
import sys

import visviva as vv


def block(_=0):
    solid = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2)), material=vv.NeoHooke(young=1.0, poisson=0.3),
                     density=1.0, angular_velocity=(0, 0, 1), name="block")
    system = vv.System([solid, vv.Gravity()], newton=vv.Newton(linear=vv.Petsc("")))
    vv.simulate(system, until=0.1, step=0.05)
    return float(system.x[5])


if __name__ == "__main__":
    how, when = sys.argv[1:]
    if how == "child":
        print(block())
        sys.exit()
    if when == "after":
        block()
    if os.environ.get("PMI_RANK", "0") == "0":
        if how == "subprocess":
            command = [sys.executable, __file__, "child", ""]
            print(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
        else:
            with multiprocessing.get_context(how).Pool(2) as pool:
                print(*pool.map(block, (0, 0)))
    last = block()
    print(last) if os.environ["PMI_RANK"] == "0" else None
"""


@pytest.mark.parametrize("when", ["before", "after"])
@pytest.mark.parametrize("how", ["subprocess", "spawn", "fork"])
def test_what_one_starts_may_solve_by_petsc(how: str, when: str, tmp_path: Path) -> None:
    """They took part in MPI as the one that had started them: its internal errors, or waiting for ever.

    What is forked where MPI has begun cannot begin it anew.
    """
    (tmp_path / "script.py").write_text(SOLVING)
    done = launched(2, str(tmp_path / "script.py"), how, when, limit=120)
    if (how, when) == ("fork", "after"):
        assert done.returncode != 0
        assert "forked from one of 2" in done.stderr
        return
    assert done.returncode == 0, done.stderr
    assert "ERROR" not in done.stderr  # PETSc's, where a pool ends its workers
    values = [float(value) for value in done.stdout.split()]
    assert values == pytest.approx([values[-1]] * len(values), abs=1e-12)
    assert len(values) == (2 if how == "subprocess" else 3)


ASKED = """
import os
import signal
import time

import visviva as vv

vv.System([vv.PointMass(mass=1.0, position=(0, 0, 0))], newton=vv.Newton(linear=vv.Petsc("")))
import petsc4py.PETSc
os.kill(os.getpid(), signal.SIGTERM)
time.sleep(60)
"""


def test_one_that_is_asked_to_end_has_no_error(tmp_path: Path) -> None:
    """PETSc called it one, and told how to find what had caused it."""
    (tmp_path / "script.py").write_text(ASKED)
    done = launched(0, str(tmp_path / "script.py"), limit=60)
    assert (done.returncode, done.stdout, done.stderr) == (-15, "", "")


EACH = """
import os
import sys

from mpi4py import MPI

rank = MPI.COMM_WORLD.rank
del os.environ["PMI_SIZE"]
import visviva as vv


def block(linear, stiff):
    solid = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2)), material=vv.NeoHooke(young=stiff, poisson=0.3),
                     density=1.0, angular_velocity=(0, 0, 1), name="block")
    held = vv.Fixed(solid=solid, nodes="z0")
    system = vv.System([solid, held, vv.Gravity()], newton=vv.Newton(linear=linear))
    vv.simulate(system, until=0.2, step=0.05 / (1 + rank))
    return system.x


assert abs(block(vv.Petsc(""), 1.0 + rank) - block(vv.Automatic(), 1.0 + rank)).max() < 1e-10
print("through")
"""


def test_processes_that_take_themselves_out_have_systems_of_their_own(tmp_path: Path) -> None:
    """As the refusal advises those who vary parameters: matrices of all were added up by PETSc, without a word."""
    (tmp_path / "each.py").write_text(EACH)
    done = launched(2, str(tmp_path / "each.py"), limit=60)
    # Counted, as the words of two processes may come before the ends of their lines.
    assert (done.returncode, done.stdout.count("through")) == (0, 2), done.stderr


TAKEN = """
import os
import sys

import visviva as vv

vv.System([vv.PointMass(mass=1.0)])
rank = os.environ["PMI_RANK"]
for name in [name for name in os.environ if name.startswith("PMI_")]:
    del os.environ[name]
if rank == "1":
    sys.exit()
vv.System([vv.PointMass(mass=1.0)])
"""


def test_all_are_ended_whatever_the_environment_has_become(tmp_path: Path) -> None:
    (tmp_path / "taken.py").write_text(TAKEN)
    done = launched(2, str(tmp_path / "taken.py"), limit=60)
    assert done.returncode != 0
    assert "process 1 of 2 has come to its end, and process 0 waits for it" in done.stderr
