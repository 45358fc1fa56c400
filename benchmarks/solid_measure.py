"""One measurement of one code on a solid: the time integration and Newton's method that all codes share, the clocks,
and the command line. A code that brings its own Newton's method gives a function `run` as `march` here."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from record import Record
from solid_cases import BUILDERS, TOLERANCE, Array, SolidCase

MOST = 20
"""Iterations of Newton's method, after which a step has failed."""


class Discretisation(Protocol):
    """What a code offers; its vectors (n_dofs,) are numbered as it likes."""

    def vector(self, nodal: Array) -> Array:
        """Of values at the case's nodes (n, 3)."""

    def nodal(self, vector: Array) -> Array:
        """Values at nodes (n, 3), in any order."""

    def force(self, u: Array) -> Array:
        """Internal forces at a displacement."""

    def prepare(self, u: Array, c: float) -> None:
        """Make the matrix K(u) + c M."""

    def solve(self, r: Array, jump: Array) -> Array:
        """Solve with that matrix for an increment d: the free rows of K d = r, with d = jump where nodes are held."""

    def inertia(self, a: Array) -> Array:
        """Product with the mass matrix."""

    def strain_energy(self, u: Array) -> float:
        """Energy stored in the solid."""


def mean_displacement(displacements: Array) -> float:
    """Mean length of displacements (n, 3)."""
    return float(np.linalg.norm(displacements, axis=1).mean())


def march(code: Discretisation, case: SolidCase, audited: bool) -> Record:
    """Take the steps of a case; `audited` runs note the energy after each."""
    record = Record()
    free = ~code.vector(np.repeat(case.held[:, None], 3, axis=1)).astype(bool)
    motion, v = code.vector(np.where(case.held[:, None], case.motion, 0.0)), code.vector(case.velocity)
    u = a = 0.0 * v
    h = case.step if case.density > 0 else 0.0
    for _ in range(case.steps):
        if audited:
            record.energies.append(code.strain_energy(u) + 0.5 * float(v @ code.inertia(v)))
        with record.timed("cpu"):
            u, v, a = step(code, record, (u, v, a), motion, free, h)
        record.steps += 1
    record.note(mean_displacement(code.nodal(u)))
    return record


State = tuple[Array, Array, Array]


def step(code: Discretisation, record: Record, state: State, motion: Array, free: Any, h: float) -> State:
    """One step of the trapezoidal rule, or a load step if h = 0: at its end f(u) + M a = 0 for the free unknowns."""
    u0, v0, a0 = state
    c = 4 / h**2 if h else 0.0
    u = u0 + h * v0 + h**2 / 4 * a0  # the acceleration at its end is guessed to be zero
    a, jump = 0.0 * a0, motion
    for _ in range(MOST):
        with record.timed("assembly"):
            f, inertia = code.force(u), (code.inertia(a) if h else a)
            r = np.where(free, -f - inertia, 0.0)
            small = np.linalg.norm(r) <= TOLERANCE * (np.linalg.norm(f) + np.linalg.norm(inertia))
            if small and not jump.any():
                return u, v0 + h / 2 * (a0 + a), a
            code.prepare(u, c)
        with record.timed("solution"):
            d = code.solve(r, jump)
        u, a, jump = u + d, a + c * d, 0.0 * jump
        record.iterations += 1
    raise RuntimeError(f"no convergence in {MOST} iterations")


Run = Callable[[SolidCase, str, bool], Record]
"""Of a case, a variant of the code (its linear solver or scheme), and whether to note energies."""


def main(run: Run, variants: tuple[str, ...]) -> None:
    """Command line of a code: prints one line of JSON, the fields of `Record`; the first variant is the default."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--variant", choices=variants, default=variants[0])
    parser.add_argument("--case", choices=BUILDERS, required=True)
    parser.add_argument("--n", type=int, required=True, help="bricks along an edge or around")
    parser.add_argument("--steps", type=int, help="number of steps; default: the case's")
    parser.add_argument("--step", type=float, help="step size; default: the case's")
    parser.add_argument("--energies", action="store_true", help="note the energy before every step")
    chosen = parser.parse_args()
    case = BUILDERS[chosen.case](chosen.n)
    for name in ("steps", "step"):
        object.__setattr__(case, name, getattr(chosen, name) or getattr(case, name))
    run(case, chosen.variant, chosen.energies).tell()
