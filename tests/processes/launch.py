"""Programs in several processes."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

ROOT = Path(__file__).parents[2]
BESIDE = f"{Path(sys.executable).parent}{os.pathsep}{os.environ.get('PATH', '')}"
YIELDING = {"MPIR_CVAR_POLLS_BEFORE_YIELD": "1", "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
"""Those that wait let others go on."""
SLEEPING = {"MPIR_CVAR_ENABLE_HEAVY_YIELD": "1"}
"""So they do where there are more of them than cores, where a yield alone comes back at once: twice as fast then."""


def missing() -> list[str]:
    """What is not there of that which several processes need."""
    found = [name for name in ("petsc4py", "mpi4py") if find_spec(name) is None]
    return found if shutil.which("mpiexec", path=BESIDE) else [*found, "mpiexec"]


def launched(n: int, *arguments: str, limit: float = 900) -> subprocess.CompletedProcess[str]:
    """Run Python in so many processes, 0 for one without a launcher, with packages and tests of the repository.

    Those that wait for each other for ever are ended after `limit` seconds.
    """
    paths = os.pathsep.join(str(ROOT / part) for part in ("src", "petsc", "tests"))
    command = [sys.executable, *arguments]
    if n:
        command = [str(shutil.which("mpiexec", path=BESIDE)), "-n", str(n), *command]
    waiting = YIELDING | (SLEEPING if n > (os.cpu_count() or 1) else {})
    environment = os.environ | waiting | {"PYTHONPATH": paths}
    return subprocess.run(
        command, env=environment, capture_output=True, text=True, timeout=limit, check=False
    )
