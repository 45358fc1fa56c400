"""Where the time of a step goes: the parts of Newton's iteration timed one by one, in CPU time of one process.

    python benchmarks/profile_steps.py [--case crane ...] [--steps 2000]

Mechanisms are those of the comparison; `torus` is the hollow torus of Hesch & Betsch in flight and `block` a cube of
30 x 30 x 30 hexahedra under traction, of which one load step is solved; `valve` are the first steps of the paper's two
flaps in a channel at full size, with what finding the flaps in the fluid and coupling them to it takes. Figures are the
best of some repetitions.
The calls that time the parts also begin the terms anew and evaluate what rigid bodies need no residual for, so that
the shares add up to somewhat more than the whole.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from cases import build
from ours import system_of

import visviva as vv
from visviva.analysis.march import prepare
from visviva.examples import valve as example

MECHANISMS = {"crane": 4, "four-bar": 3, "chain-ball": 10, "chain-revolute": 10}


def best(work: Callable[[], Any], repeat: int, clock: Callable[[], float] = time.process_time) -> float:
    """Shortest time in microseconds of calling `work`, several times at once if it is short."""
    start = clock()
    work()
    once = max(clock() - start, 1e-7)
    inner = max(1, int(2e-3 / once))
    shortest = np.inf
    for _ in range(repeat):
        start = clock()
        for _ in range(inner):
            work()
        shortest = min(shortest, (clock() - start) / inner)
    return 1e6 * shortest


def parts(system: vv.System, step: Any, repeat: int) -> dict[str, float]:
    """Microseconds of the parts at the present state; what a call from Python takes by itself is subtracted."""
    core, signals = system.core, system.signals(step).copy()
    residual, d = np.zeros(len(system.x)), np.zeros(len(system.x))
    values = np.zeros(len(system.pattern[1]))
    call = best(lambda: core.refuse(step, signals), repeat)
    r = best(lambda: core.assemble(step, signals, residual, None), repeat)
    both = best(lambda: core.assemble(step, signals, residual, values), repeat)
    whole = best(lambda: core.linearise(step, signals, residual), max(1, repeat // 3))
    right = residual.copy() if residual.any() else np.random.default_rng(0).standard_normal(len(d))
    solve = best(lambda: core.linear_solve(step, right, d), repeat)
    ledger = best(lambda: core.evaluate_ledger(step, signals, True), repeat)
    return {
        "residual": r - call,
        "tangent": both - r,
        "factorise": whole - both,
        "solve": solve - call,
        "ledger": ledger - call,
    }


def profile_dynamics(name: str, system: vv.System, h: float, steps: int, repeat: int) -> None:
    """March, then time the parts at the state reached."""
    scheme = vv.EnergyMomentum()
    prepare(system, scheme)
    for _ in range(min(steps, 20)):
        system.step(h, scheme)
    iterations = factorizations = 0
    start = time.process_time()
    for _ in range(steps):
        report = system.step(h, scheme)
        iterations, factorizations = iterations + report.iterations, factorizations + report.factorizations
    total = 1e6 * (time.process_time() - start) / steps
    share = parts(system, scheme.step(system.time, h), repeat)
    its, facts = iterations / steps, factorizations / steps
    rows = [
        ("residual", share["residual"], its),
        ("solve", share["solve"], its),
        ("tangent", share["tangent"], facts),
        ("factorise", share["factorise"], facts),
        ("ledger", share["ledger"], 1.0),
    ]
    print(f"{name}: {len(system.x)} unknowns, {total:.1f} us/step, linear solver: {system.core.solver}")
    for label, once, times in rows:
        print(f"  {label:10s} {once:12.2f} us x {times:5.2f} per step = {100 * once * times / total:5.1f} %")
    rest = total - sum(once * times for _, once, times in rows)
    print(f"  {'rest':10s} prediction, update, tests, Python    {100 * rest / total:5.1f} %")


def profile_valve(steps: int, repeat: int) -> None:
    """The first steps, while the flaps open fast, then the parts at the state reached."""
    study = example.study()
    system, h, scheme = study.system, study.step, vv.EnergyMomentum()
    prepare(system, scheme)
    core, immersed = system.core, [c for c in system.components if isinstance(c, vv.Immersed)]
    iterations = factorizations = 0
    before, wired = core.revision, core.rewiring
    start = time.process_time()
    for _ in range(steps):
        report = system.step(h, scheme)
        iterations, factorizations = iterations + report.iterations, factorizations + report.factorizations
    total = (time.process_time() - start) / steps
    patterns = (core.revision - before) / steps
    location = sum(c.costs["location"] for c in immersed) / steps
    wiring = (core.rewiring - wired) / steps
    memory = core.memory()
    again = 1e-6 * best(lambda: core.restore(memory), max(1, repeat // 3))
    share = {name: 1e-6 * t for name, t in parts(system, scheme.step(system.time, h), repeat).items()}
    once = share["residual"] + share["tangent"] + share["factorise"]
    analysis = again - once - (wiring / patterns if patterns else 0.0)
    its, facts = iterations / steps, factorizations / steps
    rows = [
        ("residual", share["residual"], its),
        ("tangent", share["tangent"], facts),
        ("factorise", share["factorise"], facts),
        ("solve", share["solve"], its),
        ("analyse", analysis, patterns),
        ("new pattern", wiring / max(patterns, 1e-9), patterns),
        ("locate", location, 1.0),
        ("ledger", share["ledger"], 1.0),
    ]
    print(
        f"valve: {core.n_equations} equations, {total:.3f} s/step over {steps} steps, linear solver: {core.solver}"
    )
    for label, each, times in rows:
        print(f"  {label:12s} {each:8.4f} s x {times:5.2f} per step = {100 * each * times / total:5.1f} %")
    coupled = location + wiring
    print(f"  location and coupling {coupled:.4f} s per step = {100 * coupled / total:.1f} %")


def torus() -> vv.System:
    """The hollow torus of the paper with a spin."""
    tube = vv.Solid(
        mesh=vv.HollowTorusMesh(),
        material=vv.NeoHooke(young=2250.0, poisson=0.3),
        density=0.1,
        velocity=(30.0, 0.0, 23.0),
        angular_velocity=(0.1, 0.2, 0.3),
    )
    return vv.System([tube], vv.Newton(tolerance=1e-8))


def profile_block(n: int, repeat: int) -> None:
    """One load step of a cube."""
    cube = vv.Solid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(n, n, n)), material=vv.NeoHooke(young=1000.0, poisson=0.3)
    )
    pull = vv.Traction(solid=cube, faces="x1", traction=(0, 0, -20.0), times="t")
    system = vv.System([cube, vv.Fixed(solid=cube, nodes="x0"), pull])
    start = time.process_time()
    result = vv.quasi_static(system, until=1.0, step=1.0, scheme=vv.Static(tolerance=1e-8))
    total = time.process_time() - start
    print(f"block: {len(system.x)} unknowns; {system.linear_explanation}")
    iterations = result.statistics.iterations
    print(f"  load step {total:.2f} s, {iterations} iterations, {total / iterations:.2f} s each")
    share = parts(system, vv.Static().step(system.time, 0.1), max(1, repeat // 5))
    del share["ledger"]
    for label, once in share.items():
        print(f"  {label:10s} {1e-6 * once:8.3f} s, {once / n**3:6.2f} us per element")


def main() -> None:
    """Profile the cases asked for."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--case", action="append", choices=[*MECHANISMS, "torus", "block", "valve"])
    parser.add_argument(
        "--steps",
        type=int,
        default=2000,
        help="steps of a mechanism; the torus and the valve take a hundredth",
    )
    parser.add_argument("--repeat", type=int, default=20)
    given = parser.parse_args()
    for name in given.case or [*MECHANISMS, "torus", "block", "valve"]:
        if name == "valve":
            profile_valve(max(5, given.steps // 100), max(3, given.repeat // 4))
        elif name == "block":
            profile_block(30, given.repeat)
        elif name == "torus":
            profile_dynamics(name, torus(), 0.01, max(5, given.steps // 100), max(2, given.repeat // 5))
        else:
            profile_dynamics(
                name, system_of(build(name, MECHANISMS[name]))[0], 1e-3, given.steps, given.repeat
            )


if __name__ == "__main__":
    main()
