"""Results are the same bits for any number of threads."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from matrices import block

import visviva as vv
from visviva import _core
from visviva.base.threads import told
from visviva.linear.choice import Problem, missing_pardiso

RUN = """
import hashlib
import visviva as vv
rod = vv.Solid(mesh=vv.BoxMesh(size=(4, 1, 1), counts=(24, 12, 12)), material=vv.NeoHooke(young=1e3, poisson=0.3),
               density=1.0, angular_velocity=(0.1, 0.2, 2.0))
system = vv.System([rod, vv.Gravity()], vv.Newton(linear={linear}))
vv.simulate(system, until=0.03, step=0.01)
print(hashlib.sha256(system.x.tobytes() + system.v.tobytes() + system.core.energy.tobytes()).hexdigest())
"""


@pytest.mark.parametrize(
    "linear", ["None", "vv.Direct()", "vv.Iterative(method='gmres', preconditioner='block')"]
)
def test_bits_do_not_depend_on_threads(linear: str) -> None:
    """Assembly, products with vectors and ledger of 3456 elements."""

    def bits(threads: int) -> str:
        # threads that wait for each other shall not compute meanwhile
        more = {"OMP_NUM_THREADS": str(threads), "OMP_WAIT_POLICY": "passive"}
        environment = {**os.environ, **more}
        command = [sys.executable, "-c", RUN.format(linear=linear)]
        return subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout

    assert bits(1) == bits(2) == bits(3)


@pytest.fixture
def restored() -> Iterator[None]:
    before = vv.use_threads()
    yield
    vv.use_threads(before)


@pytest.mark.skipif(bool(missing_pardiso()), reason="PARDISO is not installed")
@pytest.mark.parametrize("kind", ["definite", "symmetric", "general"])
def test_factors_of_pardiso_are_the_same_bits(kind: str, restored: None) -> None:
    """They were others with two threads than with one, and with two others from run to run."""
    A = block(16).matrix
    known = Problem(n=A.shape[0], n_entries=A.nnz, symmetric=kind != "general", definite=kind == "definite")
    choice = vv.Direct(library="pardiso").choose(known)
    b, found = np.random.default_rng(0).standard_normal(A.shape[0]), set()
    for n in (1, 2, 3, 2):
        assert vv.use_threads(n) == n
        solver = _core.Linear(
            list(choice.in_order[:1]),
            A.indptr.astype(np.int64),
            A.indices.astype(np.int32),
            np.zeros(0, np.int32),
            np.zeros(0),
            np.zeros(len(b), np.int32),
        )
        x = np.zeros_like(b)
        assert solver.factor(A.data)
        assert solver.solve(b, x)
        np.testing.assert_allclose(A @ x, b, atol=1e-9)
        found.add(x.tobytes())
        vv.use_threads(3 - min(n, 2))  # another number than that of the analysis ended the process
        assert solver.factor(A.data)
        assert solver.solve(b, x)
        found.add(x.tobytes())
    assert len(found) == 1


@pytest.mark.skipif(not Path("/proc/self/maps").exists(), reason="no list of loaded libraries")
@pytest.mark.skipif(bool(missing_pardiso()), reason="PARDISO is not installed")
def test_the_process_has_one_openmp_runtime() -> None:
    """PARDISO on two threads takes that of the core, also of a repaired wheel."""
    loaded = 'for line in open("/proc/self/maps"): print("lib", line.split()[-1])'
    code = RUN.format(linear="vv.Direct(library='pardiso')") + loaded
    environment = {**os.environ, "OMP_NUM_THREADS": "2", "OMP_WAIT_POLICY": "passive"}
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    libraries = {line.split("/")[-1] for line in done.stdout.splitlines() if line.startswith("lib /")}
    assert any("mkl_gnu_thread" in name for name in libraries)
    assert len([name for name in libraries if re.match(r"lib(g|i|)omp[\d.-]", name)]) == 1


def test_the_number_holds_for_all_threads_of_python(restored: None) -> None:
    """It was that of the calling thread: what another one computed took as many as there are cores."""
    found = []

    def elsewhere() -> None:
        found.append(vv.use_threads())
        vv.use_threads(5)

    vv.use_threads(3)
    another = threading.Thread(target=elsewhere)
    another.start()
    another.join()
    assert [*found, vv.use_threads()] == [3, 5]


def test_every_parallel_region_is_told_the_number() -> None:
    core = Path(__file__).parents[1] / "cpp"
    regions = [
        line
        for file in sorted([*core.rglob("*.?pp"), *core.rglob("*.h")])
        for line in file.read_text().splitlines()
        if re.search(r"\bomp\b.*\bparallel\b", line)
    ]
    assert regions
    assert [line for line in regions if "num_threads(n_threads())" not in line] == []


def test_there_are_as_many_threads_as_cores() -> None:
    """Without a word about them there are those of the affinity mask, not of the machine."""
    held = "import os; os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})"
    code = f"{held}; import visviva as vv; print(vv.use_threads())"
    environment = {name: value for name, value in os.environ.items() if not name.startswith("OMP_")}
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "1"


def test_more_threads_than_cores_are_told(restored: None) -> None:
    n = len(os.sched_getaffinity(0))
    vv.use_threads(n + 1)
    assert told() == f"{n + 1} threads on {n} core{'s' * (n > 1)}, where they wait for each other"
    vv.use_threads(1)
    assert told() == "1 thread"
