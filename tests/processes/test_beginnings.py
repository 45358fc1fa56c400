"""Processes of which one fails, ends or is interrupted before all have come together: none waits for ever."""

from __future__ import annotations

from pathlib import Path

import pytest

from processes.launch import launched, missing

pytestmark = pytest.mark.skipif(bool(missing()), reason=f"needs {missing()}")
BLOCK = """
import os
import signal
import subprocess
import sys

import visviva as vv

kind, is_second = sys.argv[1], os.environ["PMI_RANK"] == "1"


def block(k):
    body = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(2, 1, 1)), material=vv.NeoHooke(young=1.0, poisson=0.3),
                    density=1.0, angular_velocity=(0, 0, 1))
    system = vv.System([body])
    vv.simulate(system, until=0.2, step=0.1)
    return system.x[0]

"""
EARLY = """
class Interrupting:
    def find_spec(self, name, path=None, target=None):
        if name == kind:
            os.kill(os.getpid(), signal.SIGINT)


if is_second:
    sys.meta_path.insert(0, Interrupting())
    if kind == "hook":  # of a package that shows errors in its way
        sys.excepthook = lambda *error: print("own hook", file=sys.stderr) or sys.exit(3)
        sys.stdout = None
    if kind in ("file", "hook"):
        open("/of/another/machine")
block(0)
print("through")
"""


@pytest.mark.parametrize(
    ("kind", "told"),
    [
        ("file", "FileNotFoundError"),
        ("hook", "own hook"),
        ("mpi4py", "KeyboardInterrupt"),
        ("visviva_petsc.choice", "KeyboardInterrupt"),
        ("visviva_petsc.flow", "KeyboardInterrupt"),
        ("visviva_petsc.world", "KeyboardInterrupt"),
    ],
)
def test_one_that_does_not_come_ends_all(kind: str, told: str, tmp_path: Path) -> None:
    (tmp_path / "script.py").write_text(BLOCK + EARLY)
    done = launched(2, str(tmp_path / "script.py"), kind, limit=60)
    assert done.returncode != 0
    assert told in done.stderr
    assert "through" not in done.stdout


ALONE = """
import os
import sys

from mpi4py import MPI

if MPI.COMM_WORLD.rank == 0:
    import visviva as vv

    mesh = vv.RectangleMesh(size=(1, 1), counts=(2, 2)).build()
    os.system(f"{sys.executable} -c 'import visviva as vv; vv.System([vv.PointMass(mass=1.0, position=(0, 0, 0))])'")
    print(MPI.COMM_WORLD.allreduce(mesh.n_cells))
else:
    MPI.COMM_WORLD.allreduce(3)
sys.exit(5)
"""


def test_one_that_uses_no_system_waits_for_nobody(tmp_path: Path) -> None:
    """Programs of MPI may use visviva in one process alone, and what this one starts by a shell is none of them."""
    (tmp_path / "script.py").write_text(ALONE)
    done = launched(2, str(tmp_path / "script.py"), limit=60)
    assert (done.returncode, done.stdout.strip(), done.stderr) == (5, "7", "")


STARTED = """
if __name__ == "__main__":
    import multiprocessing

    if is_second:
        block(0) if kind == "after" else None
        with multiprocessing.get_context("spawn").Pool(2) as pool:
            print(*pool.map(block, (1, 2)))
        code = "import visviva as vv; print(vv.base.processes.n_launched())"
        print(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout)
    if kind == "before" or not is_second:
        block(0)
"""


@pytest.mark.parametrize("kind", ["before", "after"])
def test_what_one_starts_by_itself_is_none_of_them(kind: str, tmp_path: Path) -> None:
    """Python of others, with the environment of the first: they took themselves for it, and ended in MPI's errors."""
    (tmp_path / "script.py").write_text(BLOCK + STARTED)
    done = launched(2, str(tmp_path / "script.py"), kind, limit=90)
    assert done.returncode == 0, done.stderr
    first, second, n = done.stdout.split()
    assert first == second
    assert n == "1"


WITHOUT = """
import importlib.util

if is_second:
    found = importlib.util.find_spec
    importlib.util.find_spec = lambda name, *of: None if name == "visviva_petsc" else found(name, *of)
"""
BY_ITSELF = """
block(0)
print("through")
"""
COMMAND = """
from visviva.cli import main

sys.exit(main(["check", "cantilever"]))
"""


@pytest.mark.parametrize("run", [BY_ITSELF, COMMAND], ids=["script", "command"])
def test_one_that_lacks_the_package_ends_all(run: str, tmp_path: Path) -> None:
    """It computed by itself, to its end, or ended with a sentence, while the other waited for it for ever."""
    (tmp_path / "script.py").write_text(BLOCK + WITHOUT + run)
    done = launched(2, str(tmp_path / "script.py"), "", limit=60)
    assert done.returncode != 0
    assert "2 processes were launched" in done.stderr
    assert "through" not in done.stdout
