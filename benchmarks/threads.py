"""How much faster two threads are than one, part by part, beside what the memory allows.

    python benchmarks/threads.py [--threads 2] [--rounds 5]

prints per part the milliseconds of the clock with one thread and with several, measured in turn (the least of the
rounds), and how many times as fast several are; before them the bandwidth of copying arrays that fit no cache, as
STREAM does. Parts that only read and write memory cannot gain more than that. Other programs on the same cores make
several threads look worse than they are, the processor's time per part says how much work there is in all: where it
is the same for both, threads cost nothing of their own.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from growth_cases import CASES

import visviva as vv
from visviva.analysis.march import prepare

Work = Callable[[], Any]
LARGE = 2**25
"""Bytes that fit no cache."""


def bandwidth(n_threads: int, rounds: int = 5) -> float:
    """Bytes per second that threads read and write while they copy arrays of their own."""
    parts = [(np.ones(LARGE // 8), np.empty(LARGE // 8)) for _ in range(n_threads)]
    shortest = np.inf
    with ThreadPoolExecutor(n_threads) as pool:
        for _ in range(rounds):
            start = time.perf_counter()
            list(pool.map(lambda part: [np.copyto(part[1], part[0]) for _ in range(4)], parts))
            shortest = min(shortest, time.perf_counter() - start)
    return 2 * 4 * LARGE * n_threads / shortest


def evaluated(system: vv.System, scheme: Any, h: float) -> tuple[Work, Work, Work]:
    """Assembly, assembly with factors or preconditioner, and a solution of a system at its present state."""
    prepare(system, scheme)
    step, core = scheme.step(system.time, h), system.core
    signals, residual, d = system.signals(step).copy(), np.zeros(len(system.x)), np.zeros(len(system.x))
    values, right = np.zeros(len(system.pattern[1])), np.random.default_rng(0).standard_normal(len(d))
    core.linearise(step, signals, residual)
    return (
        lambda: core.assemble(step, signals, residual, values),
        lambda: core.linearise(step, signals, residual),
        lambda: core.linear_solve(step, right, d),
    )


def parts() -> Iterator[tuple[str, Work]]:
    """What is timed; factorisations keep the number of threads of their analysis."""
    for case, title in (("statics", "in statics"), ("dynamics", "in time steps")):
        motion = CASES[case].build(24)
        assembly, tangent, solution = evaluated(motion.system, motion.scheme, motion.step)
        yield f"assembly of hex8 {title}", assembly
        yield f"tangent and preconditioner {title}", tangent
        yield f"solution {title}: {motion.system.core.solver}", solution
    motion = CASES["statics"].build(18)
    motion.system.newton = vv.Newton(linear=vv.Direct())
    _, tangent, solution = evaluated(motion.system, motion.scheme, motion.step)
    yield f"assembly and factors: {motion.system.core.solver}", tangent
    yield "solution by these factors", solution
    motion = CASES["contact"].build(20)
    next(vv.march(motion.system, until=1.5 * motion.step, step=motion.step, scheme=motion.scheme))
    yield "search for contact", motion.system.core.find_neighbours
    yield "assembly with contact", evaluated(motion.system, motion.scheme, motion.step)[0]
    chain = CASES["chain"].build(100)
    yield (
        "small: a chain of 100 bodies, tangent and factors",
        evaluated(chain.system, chain.scheme, chain.step)[1],
    )


def timed(work: Work) -> tuple[float, float]:
    """Milliseconds of the clock and of the processor."""
    clock, processor = time.perf_counter(), time.process_time()
    work()
    return 1e3 * (time.perf_counter() - clock), 1e3 * (time.process_time() - processor)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--rounds", type=int, default=5)
    given = parser.parse_args()
    one, several = bandwidth(1), bandwidth(given.threads)
    print(f"copying: {one / 1e9:.1f} GB/s by one thread, {several / 1e9:.1f} by {given.threads}, ", end="")
    print(f"{several / one:.2f} times as much")
    print(f"{'ms by threads':>66s} {'1':>9s} {given.threads:>9d} {'faster':>7s} {'processor':>10s}")
    numbers = (1, given.threads)
    for alone, shared in zip(*(list(parts()) for n in numbers if vv.use_threads(n)), strict=True):
        title, shortest = alone[0], np.full((2, 2), np.inf)
        for _ in range(given.rounds):
            for k, n in enumerate(numbers):
                vv.use_threads(n)
                shortest[k] = np.minimum(shortest[k], timed((alone, shared)[k][1]))
        (a, cpu), (b, more) = shortest
        print(f"{title:>66s} {a:9.2f} {b:9.2f} {a / b:7.2f} {more / cpu:10.2f}", flush=True)


if __name__ == "__main__":
    main()
