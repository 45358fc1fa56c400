"""Where the time of a run goes, by phase."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from time import perf_counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from visviva.system.system import System

PHASES = ("assembly", "contact", "factorisation", "solution", "ledger", "output", "rest")
"""Contact: of what is in contact, tied or immersed, with search and new patterns. Rest: prediction, rates, and all that
Python does, functions of the user among them."""


class Profile:
    """Seconds of a run by the clock.

    Parameters
    ----------
    system : System
        Its core times its phases from now on.
    """

    def __init__(self, system: System) -> None:
        self.core, self.output, self.whole = system.core, 0.0, 0.0
        self.core.profile(True)
        self._start = perf_counter()

    @contextmanager
    def writing(self) -> Iterator[None]:
        """Count the time spent in the block as output."""
        start = perf_counter()
        try:
            yield
        finally:
            self.output += perf_counter() - start

    def stop(self) -> None:
        """The run is over."""
        self.whole = perf_counter() - self._start
        self.core.profile(False)

    def figures(self) -> dict[str, float]:
        """Seconds by phase, which add up to the whole, and how often was solved, in how many iterations."""
        core = self.core.phases
        found = {name: core[name] for name in PHASES if name in core} | {"output": self.output}
        found["rest"] = self.whole - sum(found.values())
        return found | {"solutions": core["solutions"], "iterations": core["iterations"]}


def profile_text(figures: Mapping[str, float]) -> str:
    """A table of the phases.

    Examples
    --------
    >>> parts = dict.fromkeys(PHASES, 0.0) | {"assembly": 3.0, "rest": 1.0}
    >>> print(profile_text(parts | {"solutions": 4, "iterations": 10}).splitlines()[1])
    assembly            3.000    75 %
    """
    whole = sum(figures[name] for name in PHASES) or 1.0
    lines = [f"{'phase':15s} {'seconds':>9s}  share"]
    lines += [f"{name:15s} {figures[name]:9.3f} {100 * figures[name] / whole:5.0f} %" for name in PHASES]
    each = figures["iterations"] / max(figures["solutions"], 1)
    solved = f", {each:.1f} iterations of the linear solver each" if each else ""
    return "\n".join([*lines, f"{figures['solutions']:.0f} linear systems solved{solved}"])
