"""Speed of contact: two blocks in statics, two tori in impact, and how the cost grows with the mesh.

    python benchmarks/contact.py [blocks | tori | growth | condensed] [--large] [--rounds 3] [--python PATH]

CPU time of one process; run it with OMP_NUM_THREADS=1 to compare with others, without to see what threads do to the
wall time. `blocks` alternates with Kratos (ALM mortar, AMGCL) if PATH is a Python interpreter that has
KratosMultiphysics with its ContactStructuralMechanicsApplication; where it has not, the figures measured with it
elsewhere are quoted, and said to be that. `condensed` alternates multipliers among the equations with condensed ones,
for the blocks in statics and thrown onto each other.
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
import time
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np

import visviva as vv
from visviva.analysis.march import prepare
from visviva.examples import tori

SIZES = {9: ((14, 14, 7), (12, 12, 6)), 72: ((30, 30, 14), (26, 26, 12))}
"""Bricks of both blocks, by thousands of unknowns."""
QUOTED = {9: (1.14, 4, 0.286), 72: (13.8, 4, 3.45)}
"""Kratos 10.4.4, ALM mortar with AMGCL, on another machine: CPU s per step, iterations, CPU s per iteration."""
PUSH = (0.03, 0.0, -0.05)
STEPS = 5
FLIGHT, FLIGHT_STEP = 20, 5e-4
"""Steps of a block that is thrown, and their length."""
TOLERANCE = 1e-8
"""Of increments, relative to the load step."""
MULTIPLIERS: dict[str, dict[str, Any]] = {
    "standard, kept": {},
    "dual, kept": {"multipliers": "dual"},
    "dual, condensed": {"multipliers": "dual", "condensed": True},
    "vertices, kept": {"formulation": "node-to-segment"},
    "vertices, condensed": {"formulation": "node-to-segment", "condensed": True},
}
"""Pressures among the equations, and condensed."""
FIRST_TOUCH = 1.02
"""Time at which the tubes of the tori would touch."""


@dataclass
class Cost:
    """CPU seconds and iterations of steps, and contact's own share."""

    steps: int = 0
    cpu: float = 0.0
    wall: float = 0.0
    iterations: int = 0
    tangents: int = 0
    contact: dict[str, float] = field(default_factory=dict)

    def row(self, label: str) -> str:
        """One line of a table, per step."""
        n = max(self.steps, 1)
        own = ", ".join(f"{name} {1e3 * s / n:.1f}" for name, s in self.contact.items())
        return (
            f"  {label:12s} {self.steps:3d} steps: CPU {self.cpu / n:.3f} s, wall {self.wall / n:.3f} s, "
            f"{self.iterations / n:.1f} iterations, {self.tangents / n:.1f} tangents; contact in ms: {own}"
        )


def blocks(counts: Any, thrown: bool = False, **options: Any) -> tuple[vv.System, vv.Solid, vv.Contact]:
    """Two blocks on each other, the lower one wider and clamped, the top of the upper one pushed down and aside.

    Or the upper one is thrown onto the lower one.
    """
    rubber = vv.NeoHooke(young=1000.0, poisson=0.3)
    under, over = counts
    lower = vv.BoxMesh(size=(1.3, 1.3, 0.5), counts=under, origin=(-0.16, -0.14, 0)).build()
    upper = vv.BoxMesh(size=(1, 1, 0.5), counts=over).build()
    above = upper.moved((0, 0, 0.502 if thrown else 0.5))
    bodies = [
        vv.Solid(mesh=lower, material=rubber, density=float(thrown)),
        vv.Solid(
            mesh=above, material=rubber, density=float(thrown), velocity=(0.5, 0, -2) if thrown else (0, 0, 0)
        ),
    ]
    motion = tuple(f"{u} * t" for u in PUSH)
    supports: list[Any] = [vv.Fixed(solid=bodies[0], nodes="z0")]
    if not thrown:
        supports.append(vv.Prescribed(solid=bodies[1], nodes="z1", motion=motion))
    contact = vv.Contact(first=bodies[1], first_faces="z0", second=bodies[0], second_faces="z1", **options)
    return vv.System([*bodies, *supports, contact]), bodies[1], contact


def push_blocks(thousands: int, thrown: bool = False, **options: Any) -> tuple[Cost, float]:
    """Push or throw in steps; the costs, and the mean displacement of the upper block's lower face along z."""
    system, upper, contact = blocks(SIZES[thousands], thrown, **options)
    scheme: vv.Scheme = vv.EnergyMomentum() if thrown else vv.Static(tolerance=TOLERANCE)
    steps, h = (FLIGHT, FLIGHT_STEP) if thrown else (STEPS, 1 / STEPS)
    prepare(system, scheme)
    cost, marching = Cost(), vv.march(system, until=steps * h, step=h, scheme=scheme)
    for _ in range(steps):
        measure(cost, contact, lambda: next(marching))
    moved = upper.displacements(system.x)[upper.mesh.points[:, 2] == upper.mesh.points[:, 2].min()]
    print(f"  {system.linear_explanation}")
    print_parts(system, h, scheme, contact)
    if options:
        print(
            f"  forces on other pressures' nodes at most {spread(system, h, scheme, contact):.1e} of the own"
        )
    return cost, float(moved[:, 2].mean())


def spread(system: vv.System, h: float, scheme: vv.Scheme, contact: vv.Contact) -> float:
    """The largest force of a pressure on another pressure's node, by that on its own."""
    core, first = system.core, contact.first
    assert isinstance(first, vv.Solid)
    core.dx[:] = np.where(system.order == 2, h * system.v, 0.0)
    _, K = system.tangent(scheme.step(system.time, h))
    nodes = first.node_unknowns(first.faces(contact.first_faces).nodes)
    rows = np.searchsorted(system.free_unknowns, nodes[:, None] + np.arange(3))
    columns = np.searchsorted(system.free_unknowns, contact.pressure.unknowns)
    force = np.linalg.norm(K[rows.ravel()][:, columns].toarray().reshape(*rows.shape, -1), axis=1)
    own = np.diag(force).copy()
    np.fill_diagonal(force, 0.0)
    return float((force.max(axis=0)[own > 0] / own[own > 0]).max())


def measure(cost: Cost, contact: vv.Contact, step: Any) -> None:
    """Take a step and note what it took."""
    before, wall, cpu = contact.costs, time.perf_counter(), time.process_time()
    report = step()
    cost.wall += time.perf_counter() - wall
    cost.cpu += time.process_time() - cpu
    cost.steps, cost.iterations = cost.steps + 1, cost.iterations + report.iterations
    cost.tangents += report.factorizations
    for name, value in contact.costs.items():
        cost.contact[name] = cost.contact.get(name, 0.0) + value - before[name]


def compare_blocks(sizes: list[int], rounds: int, interpreter: str) -> None:
    """Statics beside Kratos."""
    there = has_kratos(interpreter)
    if not there:
        print(
            f"{interpreter} has no ContactStructuralMechanicsApplication: Kratos' figures are quoted, not run"
        )
    for size in sizes:
        print(f"two blocks, {size}k unknowns")
        times = []
        for _ in range(rounds):
            cost, mean = push_blocks(size)
            times.append(cost.cpu / cost.steps)
            print(cost.row("visviva"), f"mean uz {mean:.6f}")
        step, iterations, iteration = QUOTED[size]
        ours, each = statistics.median(times), statistics.median(times) * cost.steps / cost.iterations
        print(
            f"  visviva {ours:.3f} s per step, {each:.3f} s per iteration; Kratos (quoted) {step} s, {iterations} "
            f"iterations, {iteration} s; ratios {step / ours:.1f} and {iteration / each:.1f}"
        )


def compare_condensed(sizes: list[int], rounds: int) -> None:
    """Pressures among the equations beside condensed ones, in alternating rounds."""
    for size, thrown in ((s, t) for s in sizes for t in (False, True)):
        print(f"two blocks, {size}k unknowns, {'thrown' if thrown else 'statics'}")
        times: dict[str, list[float]] = {}
        for _ in range(rounds):
            for name, options in MULTIPLIERS.items():
                cost, mean = push_blocks(size, thrown, **options)
                times.setdefault(name, []).append(cost.cpu / cost.steps)
                print(cost.row(name), f"mean uz {mean:.8f}")
        print(
            "  median CPU s per step:", ", ".join(f"{n} {statistics.median(t):.3f}" for n, t in times.items())
        )


def has_kratos(interpreter: str) -> bool:
    """Whether an interpreter has Kratos with contact."""
    command = [interpreter, "-c", "import KratosMultiphysics.ContactStructuralMechanicsApplication"]
    return subprocess.run(command, capture_output=True, check=False).returncode == 0


def profile_tori(mesh: Any, flight: int, impact: int, late: float) -> None:
    """The tori of the paper: steps in free flight, of the impact, and with all the contact there is at t = `late`."""
    study = tori.study(mesh=mesh)
    system = study.system
    left, _, contact = system.components
    assert isinstance(left, vv.Solid)
    assert isinstance(contact, vv.Contact)
    prepare(system, study.scheme)
    ahead = FIRST_TOUCH - (flight + 2) * study.step  # until then the left torus flies without any strain
    system.x[left.motion.unknowns] += np.tile(ahead * np.array((30.0, 0.0, 23.0)), left.grid.n_nodes)
    system.time = ahead
    system.invalidate()
    parts: dict[str, Cost] = {"free flight": Cost(), "impact": Cost(), "later": Cost()}
    print(f"two tori, {len(system.x)} unknowns with pressures")
    until = max(late, FIRST_TOUCH + impact * study.step) + 1.0
    # a step that fails is halved, as in the example
    marching = vv.march(system, until=until, step=study.step, scheme=study.scheme)
    while parts["impact"].steps < impact or system.time < late:
        touching = contact.pressures.any()
        name = "free flight" if not touching else "impact" if parts["impact"].steps < impact else "later"
        measure(parts[name], contact, lambda: next(marching))
    print(f"  {system.linear_explanation}; {system.stepper.rejected} steps retried")
    for name, cost in parts.items():
        if cost.steps:
            print(cost.row(name))
    print(f"  {np.count_nonzero(contact.pressures)} gaps closed at t = {system.time:.2f}")
    print_parts(system, study.step, study.scheme, contact)


def print_parts(system: vv.System, h: float, scheme: vv.Scheme, contact: vv.Contact) -> None:
    """One residual, tangent and solution of the present state, timed by calls of their own."""
    step = scheme.step(system.time, h)
    signals, core = system.signals(step).copy(), system.core
    residual, d, values = np.zeros(len(system.x)), np.zeros(len(system.x)), np.zeros(len(system.pattern[1]))
    core.dx[:] = np.where(system.order == 2, h * system.v, 0.0)
    clock = time.process_time

    def timed(work: Any) -> tuple[float, float]:
        start, own = clock(), sum(contact.costs.values())
        work()
        return clock() - start, sum(contact.costs.values()) - own

    r, r_own = timed(lambda: core.assemble(step, signals, residual, None))
    both, both_own = timed(lambda: core.assemble(step, signals, residual, values))
    whole, whole_own = timed(lambda: core.linearise(step, signals, residual))
    solve, _ = timed(lambda: core.linear_solve(step, residual, d))
    print(
        f"  ms of one: residual {1e3 * r:.1f} (contact {1e3 * r_own:.1f}), tangent {1e3 * (both - r):.1f} "
        f"(contact {1e3 * (both_own - r_own):.1f}), factor {1e3 * (whole - both - whole_own + both_own):.1f}, "
        f"solution {1e3 * solve:.1f}: {core.solver}"
    )


def growth() -> None:
    """Contact's own share of a tangent over three refinements: with the surface, not with the volume."""
    rows = []
    for n in (4, 8, 16, 32):
        system, _, contact = blocks((((n, n, n // 2)), (n + 2, n + 2, n // 2)))
        scheme = vv.Static(tolerance=1e-8)
        prepare(system, scheme)
        system.core.find_neighbours()
        step = scheme.step(0.0, 0.2)
        system.prescribe(step)
        signals, residual = system.signals(step).copy(), np.zeros(len(system.x))
        values = np.zeros(len(system.pattern[1]))
        before, times = contact.costs, 5
        for _ in range(times):
            system.core.find_neighbours()
            system.core.assemble(step, signals, residual, values)
        own = {name: (s - before[name]) / times for name, s in contact.costs.items()}
        facets = n * n
        rows.append((n, len(system.x), facets, own))
        text = ", ".join(f"{name} {1e3 * s:.2f}" for name, s in own.items())
        print(f"n = {n}: {len(system.x)} unknowns, {facets} facets, contact in ms: {text}")
    for (n, *_, a), (m, *_, b) in pairwise(rows):
        for name in a:
            if a[name] > 0:
                print(f"  {name}: grows like n^{np.log(b[name] / a[name]) / np.log(m / n):.2f}", end="")
        print(f" from n = {n} to {m} (surface: n^2, volume: n^3)")


def main() -> None:
    """Measure what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("what", nargs="*", choices=["blocks", "tori", "growth", "condensed"], default=[])
    parser.add_argument("--large", action="store_true", help="also the blocks of 72k unknowns")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--mesh", choices=["full", "coarse"], default="full")
    parser.add_argument("--flight", type=int, default=5, help="steps of the tori in free flight")
    parser.add_argument("--impact", type=int, default=15, help="steps of the tori after they have touched")
    parser.add_argument("--late", type=float, default=0.0, help="go on to this time and measure there too")
    parser.add_argument("--python", default=sys.executable, metavar="PATH", help="interpreter with Kratos")
    chosen = parser.parse_args()
    what = chosen.what or ["blocks", "tori", "growth"]
    if "blocks" in what:
        compare_blocks([9, *([72] if chosen.large else [])], chosen.rounds, chosen.python)
    if "tori" in what:
        profile_tori(chosen.mesh, chosen.flight, chosen.impact, chosen.late)
    if "growth" in what:
        growth()
    if "condensed" in what:
        compare_condensed([9, *([72] if chosen.large else [])], chosen.rounds)


if __name__ == "__main__":
    main()
