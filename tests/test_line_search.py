"""Line searches of statics: where the work of the residual along an increment vanishes, and what is refused."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from visviva.analysis.load_steps import Bracket

REFUSED = np.nan


def parts(work: Callable[[float], float], most: int) -> list[tuple[float, float]]:
    """Parts of an increment that are tried from the whole on, and the work there."""
    bracket, s, tried = Bracket(work(0.0)), 1.0, []
    for _ in range(most):
        tried.append((s, work(s)))
        s = bracket.next(*tried[-1])
    return tried


@pytest.mark.parametrize("root", [0.02, 0.11, 0.47, 0.8])
@pytest.mark.parametrize("steepness", [1.0, 30.0, 1e4])
def test_a_kink_is_found(root: float, steepness: float) -> None:
    """The work is -1 at first and rises behind a kink: below a fifth of it on either side the search ends."""

    def work(s: float) -> float:
        return -1 + s / root if s < root else steepness * (s - root)

    tried = parts(work, 40)
    assert min(abs(g) for _, g in tried) < 0.2
    assert all(0 < s <= 1 for s, _ in tried)


@pytest.mark.parametrize("limit", [0.5, 0.1, 0.01])
def test_refused_states_are_not_gone_beyond(limit: float) -> None:
    """Whatever was too long before: beyond what is refused lies nothing, and what is tried then is shorter."""
    tried = parts(lambda s: -1 + s if s < limit else REFUSED, 30)
    for (s, g), (then, _) in pairwise(tried):
        assert then < s or np.isfinite(g)
    assert 0 < min(s for s, g in tried if np.isfinite(g)) < limit


@dataclass
class Line:
    """Equilibrium along one unknown: states from `low` to `high` are refused, though their work is finite."""

    low: float
    high: float
    dx: Any = field(default_factory=lambda: np.ones(1))
    system: Any = field(default_factory=lambda: SimpleNamespace(components=[]))

    def residual(self, time: float) -> Any:
        return np.sign(self.dx - 0.9)

    def _refused(self, time: float) -> str:
        return "turned inside out" if self.low < self.dx[0] <= self.high else ""
