"""PETSc's matrix from rows of several processes: against sums of dense matrices, and what it takes of memory."""

from __future__ import annotations

import ctypes
import sys
from pathlib import Path

import pytest

from processes.launch import launched, missing

pytestmark = pytest.mark.skipif(bool(missing()), reason=f"needs {missing()}")
PARTS = """
import numpy as np
import scipy.sparse as sp
from mpi4py import MPI
from visviva_petsc.filled import Filled
from visviva_petsc.world import owners

comm, n = MPI.COMM_WORLD, 60
some = np.random.default_rng(1)
known = [np.sort(some.choice(n, 35, replace=False)) for _ in range(comm.size)]
if comm.size > 2:
    known[-1] = known[0].copy()  # none of its own
parts = [sp.random(35, 35, 0.2, "csr", random_state=some) for _ in known]
for part in parts:
    part.sort_indices()
owner = np.full(n, comm.size)
for rank, unknown in reversed(list(enumerate(known))):
    owner[unknown] = rank
order = np.argsort(owner, kind="stable")
number = np.argsort(order, kind="stable")
unknown, part = known[comm.rank], parts[comm.rank]
row, col = part.indptr.astype(np.int64), part.indices.astype(np.int32)
n_all = int((owner < comm.size).sum())
matrix = Filled(comm, int((owner == comm.rank).sum()), row, col, number[unknown], 1)
whole = np.zeros((n, n))
for size in (1.0, -3.0):
    matrix.fill(size * part.data)
    whole[:] = 0
    for theirs, added in zip(known, parts):
        whole[np.ix_(number[theirs], number[theirs])] += size * added.toarray()
    first, end = matrix.A.getOwnershipRange()
    found = matrix.A.getValues(np.arange(first, end, dtype=np.int32), np.arange(n_all, dtype=np.int32))
    assert np.array_equal(found, whole[first:end, :n_all]) or comm.size > 2
    assert np.allclose(found, whole[first:end, :n_all], rtol=1e-14, atol=0)
lacking = [i for i in range(first, end) if i not in matrix.A.getRow(i)[0]]
print(f"agrees, {len(lacking)} without a diagonal\\n", end="")
"""
GROWN = """
import resource

import numpy as np
from mpi4py import MPI
from visviva_petsc.solver import Solver

comm = MPI.COMM_WORLD


def resident():
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * resource.getpagesize()


n, beside = 100_000, 40
unknown = np.arange(comm.rank * (n - 3000), comm.rank * (n - 3000) + n, dtype=np.int32)
first = np.clip(np.arange(n) - beside, 0, n - 2 * beside)
col = (first[:, None] + np.arange(2 * beside)).astype(np.int32).ravel()
row = np.arange(0, len(col) + 1, 2 * beside, dtype=np.int64)
values, total = np.ones(len(col)), n + (comm.size - 1) * (n - 3000)
of = {"multiplier": np.zeros(total, dtype=np.int32), "modes": np.zeros((n, 0))}
of["node"] = np.arange(n + 1, dtype=np.int32)
solver = Solver("none", {"ksp_type": "preonly", "pc_type": "none"})
before = resident()
solver.analyze(row, col, unknown, of)
solver.factor(values)
print(f"{(resident() - before) / len(col):.2f}\\n", end="")
"""

HEAP = """
pieces = [np.ones(250) for _ in range(50_000)]
del pieces[:-1]
held = resident()
solver.analyze(row, col, unknown, of)
print(f"{(held - resident()) / 1e6:.0f}\\n", end="")
"""


@pytest.mark.parametrize("n", [1, 2, 3])
def test_rows_of_all_are_added(n: int, tmp_path: Path) -> None:
    """Random ones, many of them of several processes, and many without a diagonal, which PETSc's factors want."""
    (tmp_path / "parts.py").write_text(PARTS)
    done = launched(n, str(tmp_path / "parts.py"))
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("agrees") == n
    assert done.stdout.count(" 0 without") == n


@pytest.mark.parametrize("n", [1, 2])
def test_an_entry_takes_a_value_and_a_column(n: int, tmp_path: Path) -> None:
    """12 bytes; lists of coordinates, and where each value goes, took 16 more."""
    (tmp_path / "grown.py").write_text(GROWN)
    done = launched(n, str(tmp_path / "grown.py"))
    assert done.returncode == 0, done.stderr
    assert all(12 < float(size) < 17 for size in done.stdout.split()), done.stdout


def test_free_pieces_of_the_heap_are_given_back(tmp_path: Path) -> None:
    """100 MB of small pieces, below one that is not free."""
    if sys.platform != "linux" or not hasattr(ctypes.CDLL(None), "malloc_trim"):
        pytest.skip("this heap gives nothing back")
    (tmp_path / "heap.py").write_text(GROWN.replace("100_000", "1_000").replace("3000", "0") + HEAP)
    done = launched(0, str(tmp_path / "heap.py"))
    assert done.returncode == 0, done.stderr
    assert int(done.stdout.split()[-1]) > 80
