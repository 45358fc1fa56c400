"""Processes that a launcher of MPI started, and whether they know of each other."""

from __future__ import annotations

import os

from visviva.base.errors import InputError

SIZES = ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS")
"""Where Open MPI, MPICH and Intel MPI, and Slurm's srun say how many they started. ``SLURM_NTASKS`` counts what a batch
script may start, and is there in the script itself, which is one process."""
RANKS = ("OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK", "SLURM_PROCID")
"""Where they say which of them this one is."""

world = 1
"""Processes that compute together; what lets them do so sets it."""


def number_in(name: str) -> int:
    """A number among the variables of the environment, or 0."""
    text = os.environ.get(name, "")
    return int(text) if text.isdigit() else 0


def n_launched() -> int:
    """Processes that were started at once with this one, as far as it can know."""
    return n_told() or number_in("PMIX_RANK") + 1


def n_told() -> int:
    """Number of processes according to the launcher, 0 if unknown: PMIx gives the rank alone."""
    return max(map(number_in, SIZES))


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
