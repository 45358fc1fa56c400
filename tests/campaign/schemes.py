"""Every scheme on every example mechanism at five step sizes: accurate to its order, or an honest failure.

The end of a short motion is compared with one of the energy-momentum scheme at steps 32 times shorter than the
shortest, in positions and velocities. A run that ends counts as accurate where its error keeps below what the
scheme's order makes of the two shortest steps' error, or is no larger than the reference's own; one that stops must
have raised an error of the package.

Prints the table with ``python -m campaign.schemes`` in ``tests``; all rows take about two minutes.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import visviva as vv
from visviva.scene.gallery import example

Array = NDArray[np.float64]

SCHEMES = (
    vv.EnergyMomentum(),
    vv.Midpoint(),
    vv.VariationalMidpoint(),
    vv.BackwardEuler(),
    vv.BDF2(),
    vv.GeneralizedAlpha(0.9),
    vv.GeneralizedAlpha(0.5),
    vv.GeneralizedAlpha(0.0),
)
MOTIONS = {
    "bricard": 0.4,
    "crane": 0.4,
    "double_pendulum": 0.4,
    "four_bar": 0.2,
    "free_body": 0.4,
    "heavy_top": 0.01,
    "lagrange_top": 0.01,
    "n_four_bar": 0.2,
    "pendulum": 0.4,
    "screw": 0.4,
    "slider_crank": 0.2,
    "spring_pendulum": 0.4,
    "triple_pendulum": 0.1,
}
"""Examples and the times to which they are run: a fraction of a swing or turn, so that no motion is chaotic yet."""
COUNTS = (8, 16, 32, 64, 128)
"""Numbers of steps."""
FINE = 32 * COUNTS[-1]
LOOSE = 4.0
"""Errors at long steps may exceed what order and short steps promise by this factor: terms of higher order."""
SMALL = 1e-8
"""Errors below this share of the motion are not asked to fall: the reference's own are a tenth of it."""


class Run(NamedTuple):
    """How a motion ended: positions and velocities, or why there are none."""

    state: tuple[Array, Array] | None
    failure: str = ""

    def error(self, exact: tuple[Array, Array], scales: tuple[float, float]) -> float:
        """Largest distance of a position or velocity, relative to way and speed."""
        if self.state is None:
            return np.inf
        return max(float(np.abs(a - b).max()) / s for a, b, s in zip(self.state, exact, scales, strict=True))


@dataclass(frozen=True)
class Row:
    """One scheme on one mechanism."""

    name: str
    scheme: vv.Scheme
    errors: tuple[float, ...]
    failures: tuple[str, ...]

    @property
    def order(self) -> float:
        """Observed between the two shortest steps."""
        return float(np.log2(self.errors[-2] / self.errors[-1]))

    @property
    def verdict(self) -> str:
        """``accurate``, ``honest`` if longer steps failed with an error, or what is wrong."""
        finest = self.errors[-1]
        if not np.isfinite(finest):
            return "WRONG: the shortest steps fail"
        for n, error in zip(COUNTS, self.errors, strict=True):
            allowed = LOOSE * finest * (COUNTS[-1] / n) ** self.scheme.order
            if np.isfinite(error) and error > max(allowed, SMALL):
                return f"WRONG: {error:.1e} in {n} steps"
        if finest > SMALL and self.order < self.scheme.order - 0.3:
            return f"WRONG: order {self.order:.2f}"
        return "honest" if any(self.failures) else "accurate"


def moved(name: str, scheme: vv.Scheme, n: int) -> Run:
    """An example after its time in `n` steps."""
    system = example(name).study().system
    until = MOTIONS[name]
    try:
        for _ in vv.march(system, until=until, step=until / n, scheme=scheme):
            pass
    except vv.VisvivaError as error:
        return Run(None, str(error).splitlines()[0])
    return Run(state(system))


def state(system: vv.System) -> tuple[Array, Array]:
    """Positions and velocities without multipliers."""
    moves = system.order == 2
    return system.x[moves].copy(), system.v[moves].copy()


def rows(names: Sequence[str] = tuple(MOTIONS), schemes: Sequence[vv.Scheme] = SCHEMES) -> Iterator[Row]:
    """All rows of some mechanisms and schemes."""
    for name in names:
        system = example(name).study().system
        start, _ = state(system)
        exact = moved(name, vv.EnergyMomentum(), FINE).state
        assert exact is not None, name
        scales = float(np.abs(exact[0] - start).max()), float(np.abs(exact[1]).max())
        for scheme in schemes:
            runs = [moved(name, scheme, n) for n in COUNTS]
            errors = tuple(r.error(exact, scales) for r in runs)
            yield Row(name, scheme, errors, tuple(r.failure for r in runs))


def main() -> int:
    """Print the table; the exit status tells whether anything is wrong."""
    wrong = 0
    print(f"{'mechanism':18s}{'scheme':24s}" + "".join(f"{n:>10d}" for n in COUNTS) + "   order  verdict")
    for row in rows():
        figures = "".join(
            f"{'failed' if f else f'{e:.1e}':>10s}" for e, f in zip(row.errors, row.failures, strict=True)
        )
        print(f"{row.name:18s}{row.scheme!s:24s}{figures}{row.order:8.2f}  {row.verdict}", flush=True)
        wrong += row.verdict.startswith("WRONG")
    return min(wrong, 1)


if __name__ == "__main__":
    sys.exit(main())
