"""What one measurement of one code leaves behind."""

from __future__ import annotations

import argparse
import json
import resource
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from typing import Any


@dataclass
class Record:
    """CPU seconds of the steps, and of the assemblies and linear solutions in them; what the run left behind."""

    cpu: float = 0.0
    assembly: float = 0.0
    solution: float = 0.0
    iterations: int = 0
    steps: int = 0
    tangents: int = 0
    unknowns: int = 0
    energies: list[float] = field(default_factory=list)
    answer: float = float("nan")
    peak_mb: float = 0.0

    @contextmanager
    def timed(self, what: str) -> Iterator[None]:
        """Add the CPU time of the enclosed block to the attribute `what`."""
        start = time.process_time()
        yield
        setattr(self, what, getattr(self, what) + time.process_time() - start)

    def note(self, answer: float) -> None:
        """Note a result that shows that all have solved the same problem, and the memory."""
        self.answer = answer
        self.peak_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024

    def tell(self) -> None:
        """Print it as the line of JSON that `contenders.measure` reads."""
        print(json.dumps(asdict(self)), flush=True)


def command(run: Callable[[Any, str], Record], variants: tuple[str, ...], kind: type[Any], size: str) -> None:
    """Command line of a code; the first variant is the default.

    `kind` makes the case of its `size`, its `steps` and, where it has one, the length `step`.
    """
    parser = argparse.ArgumentParser()
    parser.add_argument("--variant", choices=variants, default=variants[0])
    names = [name for name in (size, "steps", "step") if hasattr(kind, name)]
    for name in names:
        parser.add_argument(f"--{name}", type=type(getattr(kind, name)), default=getattr(kind, name))
    chosen = vars(parser.parse_args())
    run(kind(**{name: chosen[name] for name in names}), chosen["variant"]).tell()
