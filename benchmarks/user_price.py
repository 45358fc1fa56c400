"""What a component of the user in Python costs beside the package's own: microseconds per step and per call.

    python benchmarks/user_price.py [steps]

One ball on a spring; every variant is the same spring, given in another way. Processor time, best of five.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

import numpy as np

import visviva as vv

STIFFNESS, LENGTH = 100.0, 1.0


def count(function: Callable, calls: list[int]) -> Callable:
    """The function, counting its calls."""

    def counted(*arguments):
        calls[0] += 1
        return function(*arguments)

    return counted


def spring_force(t, x, v):
    l = np.sqrt(x @ x)
    return -STIFFNESS * (l - LENGTH) / l * x


def energy(e):
    return 0.5 * STIFFNESS * (np.sqrt(e[0]) - LENGTH) ** 2


class SpringTerm(vv.Term):
    """The spring as a whole term; `counted` is called once per residual."""

    def __init__(self, counted: Callable) -> None:
        super().__init__()
        self.counted = counted

    def residual(self, s):
        return -np.stack([self.counted(0.0, x, None) for x in s.x])


class SpringTermWithTangent(SpringTerm):
    """The same with its tangent."""

    def tangent(self, s):
        x = s.x[0]
        l = np.sqrt(x @ x)
        K = STIFFNESS * ((1 - LENGTH / l) * np.eye(3) + LENGTH / l**3 * np.outer(x, x))
        return s.step.theta * K[None]


def variants(calls: list[int]) -> dict[str, Callable]:
    """Components by name, made from ground and ball."""
    f, W = count(spring_force, calls), count(energy, calls)
    return {
        "own spring (core)": lambda a, b: vv.Spring(a=a, b=b, stiffness=STIFFNESS, free_length=LENGTH),
        "Spring(energy=W)": lambda a, b: vv.Spring(
            a=a, b=b, energy=count(lambda l: 0.5 * STIFFNESS * (l - LENGTH) ** 2, calls)
        ),
        "Potential": lambda a, b: vv.Potential(of=[vv.SquaredDistance(a=a, b=b)], energy=W),
        "Force": lambda a, b: vv.Force(on=b, force=f),
        "Constraint (rod)": lambda a, b: vv.Constraint(
            of=[vv.SquaredDistance(a=a, b=b)], function=count(lambda e: e[0] - 1.21, calls)
        ),
        "Term": lambda a, b: vv.UserTerm(term=SpringTerm(f), on=[b]),
        "Term with tangent": lambda a, b: vv.UserTerm(term=SpringTermWithTangent(f), on=[b]),
    }


def measure(name: str, steps: int) -> tuple[float, float, float]:
    """Microseconds per step, calls of the user's function and iterations per step."""
    best = np.inf
    for _ in range(5):
        calls = [0]
        ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(1.1, 0, 0), velocity=(0, 2, 0))
        system = vv.System([ground, ball, variants(calls)[name](ground, ball)])
        scheme, iterations = vv.EnergyMomentum(), 0
        system.step(0.01, scheme)
        calls[0], start = 0, time.process_time()
        for _ in range(steps):
            iterations += system.step(0.01, scheme).iterations
        best = min(best, time.process_time() - start)
    return 1e6 * best / steps, calls[0] / steps, iterations / steps


def main() -> None:
    steps = int(sys.argv[1]) if len(sys.argv) > 1 else 500
    calls: list[int] = [0]
    base = measure("own spring (core)", steps)[0]
    print(f"{'':22s} us/step  iterations  calls of the user's function  us more per call")
    for name in variants(calls):
        us, n, iterations = measure(name, steps)
        more = f"{(us - base) / n:8.1f}" if n else "       -"
        print(f"{name:22s} {us:7.1f}  {iterations:10.2f}  {n:28.1f}  {more}")


if __name__ == "__main__":
    main()
