"""Threads of this process."""

from __future__ import annotations

import os
import platform
from collections.abc import Iterable

from visviva.base.arguments import whole
from visviva.base.errors import InputError

MOST = 4096
"""More are a mistake."""


def n_cores() -> int:
    """Cores on which this process may run, by its affinity mask."""
    return len(cores())


def cores() -> frozenset[int]:
    """Numbers of these."""
    return frozenset(
        os.sched_getaffinity(0) if hasattr(os, "sched_getaffinity") else range(os.cpu_count() or 1)
    )


def here() -> tuple[str, int, frozenset[int]]:
    """Name of the machine, threads of this process, and cores on which they may run."""
    return platform.node(), use_threads(), cores()


def crowds(processes: Iterable[tuple[str, int, frozenset[int]]]) -> list[str]:
    """Of each machine on which processes have more threads than cores, a sentence; of each there is what `here` gives.

    Examples
    --------
    >>> crowds([("a", 2, frozenset({0, 1})), ("a", 2, frozenset({0, 1})), ("b", 1, frozenset({0}))])
    ['2 processes on a have 4 threads on 2 cores, where they wait for each other: give each fewer (--threads 1)']
    >>> crowds([("a", 1, frozenset({0})), ("a", 1, frozenset({1}))])  # each has its own
    []
    """
    machines: dict[str, list[tuple[int, frozenset[int]]]] = {}
    for name, threads, places in processes:
        machines.setdefault(name, []).append((threads, places))
    found = []
    for name, those in machines.items():
        total, n_places = sum(n for n, _ in those), len(frozenset().union(*(c for _, c in those)))
        few = max(1, n_places // len(those))
        cure = f"give each fewer (--threads {few})" if len(those) <= n_places else "start fewer of them"
        if total > n_places and len(those) > 1:
            found.append(
                f"{len(those)} processes on {name} have {total} threads on {n_places} core{'s' * (n_places > 1)}, "
                f"where they wait for each other: {cure}"
            )
    return found


def use_threads(n: int | None = None) -> int:
    """Set the number of threads used from now on, by whichever thread of Python; returns the number in use.

    They share assembly, products with matrices, contact search and factorisations, of PARDISO as well. Results are the
    same bits for any number: what threads do is divided in one way, and so is PARDISO's factorisation. Systems that
    several threads of Python step at once take as many each.

    Parameters
    ----------
    n : int, optional
        Threads; None tells how many there are. Without a call there are as many as the process may use cores
        (its affinity mask), or as ``OMP_NUM_THREADS`` says.

    Raises
    ------
    InputError
        If it is no whole number from 1 to 4096.

    Examples
    --------
    >>> import visviva as vv
    >>> before = vv.use_threads()
    >>> vv.use_threads(2)
    2
    >>> vv.use_threads(before) == before
    True
    """
    from visviva import _core  # here, so that the command line can tell of an unknown instruction set

    if n is not None:
        n = whole("use_threads", "n", n)
        if n > MOST:
            raise InputError(f"use_threads: n = {n} are more than {MOST}; take one a core, here {n_cores()}")
        _core.use_threads(n)
    return int(_core.n_threads())


def told() -> str:
    """Number of threads in words, with a warning if there are fewer cores.

    Examples
    --------
    >>> told().split()[0].isdigit()
    True
    """
    n, cores = use_threads(), n_cores()
    text = f"{n} thread{'s' * (n > 1)}"
    return f"{text} on {cores} core{'s' * (cores > 1)}, where they wait for each other" * (n > cores) or text
