"""What one process does apart from the others: refused with a sentence, or harmless; nobody waits for ever."""

from __future__ import annotations

from pathlib import Path

import pytest

from processes.launch import launched, missing

pytestmark = pytest.mark.skipif(bool(missing()), reason=f"needs {missing()}")
FORKS = """
import os
import sys

import visviva as vv
from visviva.base.world import world

block = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(4, 2, 2)), material=vv.NeoHooke(young=1.0, poisson=0.3),
                 density=1.0, angular_velocity=(0, 0, 1), name="block")
system = vv.System([block])
vv.simulate(system, until=0.1, step=0.05)
for status in (0, 3, "error") if world().rank == 0 else ():
    child = os.fork()
    if child == 0:
        if status == "error":
            raise KeyError("of the child")
        sys.exit(status)
    print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
vv.simulate(system, until=0.2, step=0.05)
if world().rank == 0:
    print("through")
"""


def test_what_a_process_forks_ends_alone(tmp_path: Path) -> None:
    """It was taken for a process that leaves the others, and ended them."""
    (tmp_path / "forks.py").write_text(FORKS)
    done = launched(2, str(tmp_path / "forks.py"))
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == ["0", "3", "1", "through"]
    assert done.stderr.count("of the child") == 2  # a line of the script, and the error


MESHES = """
import os
import sys

import visviva as vv
from visviva.base.world import world

opened = []
sys.addaudithook(lambda event, what: opened.append(what) if event == "open" and what[0] == sys.argv[1] else None)
vv.BoxMesh(size=(1, 1, 1), counts=(4, 2, 2)).build().write(sys.argv[1])
opened = world().together(len(opened))
read = vv.MeshFile(sys.argv[1]).build()
try:
    read.write("no/such/folder.vtu")
except Exception as error:
    print(world().rank, len(read.points), min(opened[0], 1), opened[1], type(error).__name__)
"""


def test_meshes_are_written_by_the_first_process(tmp_path: Path) -> None:
    """Processes that wrote one file at once could break it."""
    (tmp_path / "meshes.py").write_text(MESHES)
    done = launched(2, str(tmp_path / "meshes.py"), str(tmp_path / "box.vtu"))
    assert done.returncode == 0, done.stderr
    first, second = sorted(done.stdout.splitlines())
    assert first.split()[1:4] == ["45", "1", "0"]
    assert first[1:] == second[1:]
