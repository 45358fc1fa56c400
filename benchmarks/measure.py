"""One measurement of one code: what a code must offer, and the command line that all of them share.

A code is a module with a function `run` of the type `Run` that ends in

    if __name__ == "__main__":
        main("visviva", ("energy-momentum",), run)

and then answers `python FILE --case chain-ball --n 100` with one line of JSON, the fields of `Measurement`.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from typing import Any, Protocol

import audit
from cases import BUILDERS, Case, State, build


@dataclass
class Record:
    """What a run leaves behind: times of the loop over steps, the work in it and the states seen.

    A code may give its own energies and vertical angular momenta, the first at the start: velocities of
    directors hold more than the angular velocity, from which the audit would compute them otherwise.
    """

    cpu: float = 0.0
    wall: float = 0.0
    iterations: int = 0
    jacobians: int = 0
    states: list[State] = field(default_factory=list)
    energies: list[float] = field(default_factory=list)
    momenta: list[float] = field(default_factory=list)

    @contextmanager
    def timed(self) -> Iterator[None]:
        """Measure the enclosed block, which should hold the loop over steps and nothing else."""
        wall, cpu = time.perf_counter(), time.process_time()
        yield
        self.cpu, self.wall = time.process_time() - cpu, time.perf_counter() - wall


class Run(Protocol):
    """Simulate a case from its start in one thread and without writing files.

    With `sample_every` > 0 the state after every so many steps is recorded and the times do not matter;
    with 0 nothing is observed. The start itself is not recorded. Raise `RuntimeError` where a step fails.
    """

    def __call__(self, case: Case, scheme: str, step: float, steps: int, sample_every: int) -> Record: ...


@dataclass(frozen=True)
class Measurement:
    """Times per step in microseconds; errors are relative (see `errors`), or None where not measured."""

    code: str
    scheme: str
    case: str
    n: int
    step: float
    steps: int
    cpu_us: float | None = None
    wall_us: float | None = None
    iterations: float | None = None
    jacobians: float | None = None
    energy_error: float | None = None
    momentum_error: float | None = None
    position_defect: float | None = None
    velocity_defect: float | None = None
    failure: str | None = None


def errors(case: Case, record: Record) -> dict[str, float | None]:
    """Greatest energy error by the greatest kinetic energy, greatest relative change of the vertical angular
    momentum, and the constraint defects of the last state."""
    states = record.states
    energy, momentum = audit.energy(case, case.start), audit.vertical_momentum(case, case.start)
    scale = max(audit.kinetic(case, state) for state in [case.start, *states])
    own = [abs(e - record.energies[0]) for e in record.energies]
    drift = max(own or [abs(audit.energy(case, state) - energy) for state in states])
    own = [abs(m - record.momenta[0]) for m in record.momenta]
    change = max(own or [abs(audit.vertical_momentum(case, state) - momentum) for state in states])
    position, velocity = audit.defects(case, states[-1])
    return {
        "energy_error": drift / scale,
        "momentum_error": change / abs(momentum) if case.turns_freely else None,
        "position_defect": position,
        "velocity_defect": velocity,
    }


def timing(record: Record, steps: int) -> dict[str, Any]:
    """Times and work per step."""
    return {
        "cpu_us": 1e6 * record.cpu / steps,
        "wall_us": 1e6 * record.wall / steps,
        "iterations": record.iterations / steps,
        "jacobians": record.jacobians / steps,
    }


def measure(run: Run, case: Case, scheme: str, step: float, steps: int, audited: int) -> dict[str, Any]:
    """Time a run and, if wanted, run that many steps again with some 100 states recorded."""
    figures = timing(run(case, scheme, step, steps, 0), steps)
    if audited:
        seen = run(case, scheme, step, audited, max(1, audited // 100))
        figures |= errors(case, seen)
    return figures


def parser(schemes: Sequence[str]) -> argparse.ArgumentParser:
    """The options that every code understands; the first scheme is the default."""
    options = argparse.ArgumentParser()
    options.add_argument("--case", choices=BUILDERS, required=True)
    options.add_argument("--n", type=int, default=10, help="links of a chain")
    options.add_argument("--scheme", choices=schemes, default=schemes[0])
    options.add_argument("--step", type=float, help="step size in seconds; default: the case's")
    options.add_argument("--steps", type=int, help="number of steps; default: the case's")
    options.add_argument("--errors", action="store_true", help="repeat the run to audit its states")
    options.add_argument("--error-steps", type=int, help="number of steps of that; default: as timed")
    return options


def report(code: str, run: Run, chosen: argparse.Namespace) -> None:
    """Print one measurement as a line of JSON; a failed run is reported, not raised."""
    case = build(chosen.case, chosen.n)
    step, steps = chosen.step or case.step, chosen.steps or case.steps
    audited = (chosen.error_steps or steps) if chosen.errors else 0
    head = (code, chosen.scheme, chosen.case, len(case.masses), step, steps)
    try:
        figures = measure(run, case, chosen.scheme, step, steps, audited)
        result = Measurement(*head, **figures)
    except RuntimeError as error:
        result = Measurement(*head, failure=" ".join(str(error).split())[:200])
    print(json.dumps(asdict(result)), flush=True)


def main(code: str, schemes: Sequence[str], run: Run) -> None:
    """Command line of a code."""
    report(code, run, parser(schemes).parse_args())
