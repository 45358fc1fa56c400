"""Processes that a launcher of MPI started, and whether they know of each other."""

from __future__ import annotations

import os
import stat

from visviva.base.errors import InputError

SIZES = ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS")
"""Where Open MPI, MPICH and Intel MPI, and Slurm's srun say how many they started. ``SLURM_NTASKS`` counts what a batch
script may start, and is there in the script itself, which is one process."""
RANKS = ("OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK", "SLURM_PROCID")
"""Where they say which of them this one is."""

world = 1
"""Processes that compute together; what lets them do so sets it."""


MARK = "VISVIVA_PROCESS"
"""Where a process that a launcher started says to those that it starts itself that they are none of its kind."""


def mark() -> None:
    """Note for those that this process starts that it is one of several that a launcher started."""
    os.environ[MARK] = f"{os.getpid()} {os.environ.get('PMIX_NAMESPACE', '')}"


def is_started_by_one() -> bool:
    """Whether one of several processes has started this one, which has its environment, and is none of them.

    A launcher that is started anew gives other names, or a socket of its own.
    """
    pid, _, job = os.environ.get(MARK, "").partition(" ")
    if not pid or int(pid) == os.getpid() or job != os.environ.get("PMIX_NAMESPACE", ""):
        return False
    if job:
        return True
    try:
        return not stat.S_ISSOCK(os.fstat(number_in("PMI_FD")).st_mode)
    except OSError:
        return True


def number_in(name: str) -> int:
    """A number among the variables of the environment, or 0."""
    text = os.environ.get(name, "")
    return int(text) if text.isdigit() else 0


def n_launched() -> int:
    """Processes that were started at once with this one, as far as it can know."""
    return n_told() or 1 + (0 if is_started_by_one() else number_in("PMIX_RANK"))


def n_told() -> int:
    """Number of processes according to the launcher, 0 if unknown: PMIx gives the rank alone."""
    return 0 if is_started_by_one() else max(map(number_in, SIZES))


def is_first() -> bool:
    """True in the process that prints and writes for all."""
    return n_launched() == 1 or not any(map(number_in, RANKS))


def refuse_unaware() -> None:
    """Refuse processes that do not know of each other: each would run everything, and write the same files.

    Raises
    ------
    InputError
        If more processes were launched than compute together.

    Examples
    --------
    >>> refuse_unaware()
    """
    n = n_launched()
    if n <= world:
        return
    name = next((name for name in (*SIZES, "PMIX_RANK") if number_in(name)), "")
    raise InputError(
        f"{n} processes were launched ({name} = {os.environ[name]}), and each would run all of it and write the same "
        "files: start one process, whose threads share the cores (--threads); runs that have nothing to do with each "
        f"other are started by env -u {name} visviva run ... with directories of their own"
    )
