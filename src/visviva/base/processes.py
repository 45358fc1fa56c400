"""Processes that a launcher of MPI started, and whether they know of each other."""

from __future__ import annotations

import os
import stat
import sys
import time
from contextlib import suppress

from visviva.base.errors import InputError

SIZES = ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS")
"""Where Open MPI, MPICH and Intel MPI, and Slurm's srun say how many they started. ``SLURM_NTASKS`` counts what a batch
script may start, and is there in the script itself, which is one process."""
RANKS = ("OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK", "SLURM_PROCID")
"""Where they say which of them this one is."""
JOBS = ("PMIX_NAMESPACE", "OMPI_MCA_ess_base_jobid", "SLURM_JOB_ID", "SLURM_STEP_ID")
"""Where they name what they started."""

world = 1
"""Processes that compute together; what lets them do so sets it."""


LAUNCHERS = ("PMI_", "PMIX_", "OMPI_COMM", "OMPI_MCA_ess", "OMPI_MCA_orte", "HYDI_", "MPI_LOCAL")
"""How the names begin by which launchers tell MPI what it is to be part of."""
MARK = "VISVIVA_PROCESS"
"""Where a process that a launcher started says to those that it starts itself that they are none of its kind."""


def mark() -> None:
    """Note for those that this process starts that it is one of several that a launcher started."""
    os.environ[MARK] = " ".join([f"{os.getpid()}", job(), socket_of_launcher()])


def is_started_by_one() -> bool:
    """Whether one of several processes has started this one, which has its environment, and is none of them."""
    pid, theirs, socket = (os.environ.get(MARK, "").split(" ") + 2 * [""])[:3]
    return bool(pid) and pid != f"{os.getpid()}" and theirs == job() and socket_of_launcher() in ("", socket)


def begin_alone(what: str) -> None:
    """Let MPI begin as one process where this one is none of those that its environment names, or they were taken out.

    Raises
    ------
    InputError
        If MPI has begun before, in the process that forked this one.
    """
    is_started = is_started_by_one()
    is_left = not any(map(number_in, SIZES)) and any(name in os.environ for name in (*RANKS[:3], "PMI_FD"))
    if not is_started and not is_left:
        return
    if (module := sys.modules.get("mpi4py.MPI")) is not None:
        if is_started and module.COMM_WORLD.size > 1:
            raise InputError(
                f"{what}: a process that was forked from one of {module.COMM_WORLD.size} would speak in its name; "
                "start it anew (multiprocessing.get_context('spawn')), or let it use the solvers of visviva itself"
            )
        return
    for name in [name for name in os.environ if name.startswith(LAUNCHERS)]:
        del os.environ[name]
    if is_started:
        os.environ[MARK] = " ".join([os.environ[MARK].split(" ")[0], job(), ""])


def job() -> str:
    """What a launcher that is started anew gives other names."""
    return "/".join(os.environ.get(name, "") for name in JOBS)


def socket_of_launcher() -> str:
    """Which one MPICH's launcher is spoken to by; what is started anew by Python has none."""
    try:
        found = os.fstat(int(os.environ.get("PMI_FD", "")))
    except (OSError, ValueError):
        return ""
    return f"{found.st_ino}" if stat.S_ISSOCK(found.st_mode) else ""


def end_all(code: int) -> None:
    """Have the launcher end all processes that it started, for one that fails before it knows the others.

    They may wait for it in MPI, which it has not begun. MPICH's launcher is asked as MPI would ask it; others end all
    where one ends by an error.
    """
    if n_told() <= 1:
        return
    last_words()
    if (module := sys.modules.get("mpi4py.MPI")) is not None and module.Is_initialized():
        if not module.Is_finalized():
            module.COMM_WORLD.Abort(code)
    elif socket_of_launcher():
        with suppress(OSError, ValueError):
            os.write(int(os.environ["PMI_FD"]), f"cmd=abort exitcode={code}\n".encode())


def last_words() -> None:
    """Have what was said until now come through before all are ended."""
    for stream in (sys.stdout, sys.stderr):
        with suppress(Exception):  # users may have put anything there
            stream.flush()
    time.sleep(0.5)  # launchers may drop what they have not passed on yet


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
        f"other are started by env -u {name} visviva run ... with directories of their own (or take {name} out of "
        "os.environ before visviva is imported)"
    )
