"""Two balls of rubber in a free box of rubber, for thousands of steps: energy and momenta through impacts in space.

    python benchmarks/impacts.py [--kind conserving | penalty | dissipative] [--steps 4000] [--step 0.02]

prints the impacts of either ball with the box and of the balls with each other, the largest change of the energy, its
largest growth over the start and in a step, and the changes of the momenta, relative to energy and momentum at the
start. All three bodies are free and tumble; contact is that of mortar segments.

    python benchmarks/impacts.py --landing

prints how far a block of rubber that falls onto another one has come after 0.1 s, where its gap closes just at the end
of a step, and where it is a hundred-thousandth smaller and larger.
"""

from __future__ import annotations

import argparse
import time
from typing import Any

import numpy as np

import visviva as vv
from visviva.component.component import Component

KINDS: dict[str, dict[str, Any]] = {
    "conserving": {"impact": "conserving"},
    "penalty": {"enforcement": "penalty"},
    "dissipative": {},
}
BALLS = (
    ((1.27, 1.3, 1.31), (1.1, 0.7, 0.4), (0.3, 0, 0.8)),
    ((1.76, 1.72, 1.65), (-0.5, -0.9, 0.7), (0, -1, 0.2)),
)
"""Centres, velocities and angular velocities."""


def balls_in_a_box(**options: Any) -> tuple[list[Component], list[vv.Contact]]:
    """A hollow box of 26 bricks, two balls of 32 in its cavity, and their three contacts."""
    rubber = vv.NeoHooke(young=100.0, poisson=0.3)
    frame = vv.BoxMesh(size=(3, 3, 3), counts=(3, 3, 3)).build()
    bricks = frame.cells["hex8"]
    outer = np.any(np.abs(frame.points[bricks].mean(axis=1) - 1.5) > 0.6, axis=1)
    used, walls = np.unique(bricks[outer], return_inverse=True)
    hollow = vv.Mesh(frame.points[used], {"hex8": walls.reshape(-1, 8)})
    box = vv.Solid(mesh=hollow, material=rubber, density=1.0)
    balls = [
        vv.Solid(
            mesh=vv.SphereMesh(radius=0.22, counts=(1, 1)).build().moved(centre),
            material=rubber,
            density=1.0,
            velocity=velocity,
            angular_velocity=turning,
        )
        for centre, velocity, turning in BALLS
    ]
    one, other = balls
    contacts = [vv.Contact(first=ball, first_faces="outer", second=box, **options) for ball in balls]
    contacts.append(vv.Contact(first=one, first_faces="outer", second=other, second_faces="outer", **options))
    return [box, *balls, *contacts], contacts


def landing(gap: float, step: float, impact: Any) -> float:
    """How much higher a block is, 0.1 s after it was thrown down from this height with unit velocity."""
    rubber = vv.NeoHooke(young=1e5, poisson=0.3)
    lower = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 0.3), counts=(2, 2, 1)), material=rubber, density=1e3)
    mesh = vv.BoxMesh(size=(0.6, 0.6, 0.3), counts=(2, 2, 1)).build().moved((0.2, 0.2, 0.3 + gap))
    upper = vv.Solid(mesh=mesh, material=rubber, density=1e3, velocity=(0, 0, -1))
    contact = vv.Contact(first=lower, first_faces="z1", second=upper, second_faces="z0", impact=impact)
    system = vv.System([lower, upper, vv.Fixed(solid=lower, nodes="z0"), contact])
    height = vv.simulate(system, until=0.1, step=step).history(vv.CentreOfMass(of=upper))[:, 2]
    return float(height[-1] - height[0])


def print_landings() -> None:
    """A line for each impact and step."""
    for impact in ("conserving", "dissipative"):
        for step in (0.005, 0.0025, 0.00125, 0.000625, 0.0003125):
            heights = [landing(0.01 * share, step, impact) for share in (1 - 1e-5, 1, 1 + 1e-5)]
            print(f"{impact}, h = {step:g}: " + ", ".join(f"{height:.5f}" for height in heights))


def main() -> None:
    """Run and print."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    options.add_argument("--kind", choices=KINDS, default="conserving")
    options.add_argument("--steps", type=int, default=4000)
    options.add_argument("--step", type=float, default=0.02)
    options.add_argument("--landing", action="store_true")
    chosen = options.parse_args()
    if chosen.landing:
        return print_landings()
    parts, contacts = balls_in_a_box(**KINDS[chosen.kind])
    system = vv.System(parts)
    touches: list[list[bool]] = []

    def observe(_: vv.System) -> None:
        touches.append([bool(contact.pressures.max() > 0) for contact in contacts])

    start = time.process_time()
    until = chosen.steps * chosen.step
    result = vv.simulate(system, until=until, step=chosen.step, every=10**9, observe=observe)
    impacts = (np.diff(np.array(touches, dtype=int), axis=0) > 0).sum(axis=0)
    ledger, total = result.ledger, result.ledger["total"] / result.ledger["total"][0]
    momentum = np.linalg.norm([ledger[f"momentum_{axis}"][0] for axis in "xyz"])
    print(
        f"{chosen.kind}: {len(total) - 1} steps to t = {until:g}, {system.stepper.rejected} retried, impacts {impacts}"
    )
    print(
        f"  {result.statistics.iterations / (len(total) - 1):.1f} iterations by step, {len(system.x)} unknowns"
    )
    print(
        f"  energy changes by {np.abs(total - 1).max():.1e}, is above its start by {np.max(total - 1):.1e},"
    )
    print(f"  grows in a step by {np.diff(total).max():.1e}; {total[-1]:.4f} of it is left")
    for what in ("momentum", "angular"):
        changes = [float(np.ptp(ledger[f"{what}_{axis}"]) / momentum) for axis in "xyz"]
        print(f"  {what}: " + ", ".join(f"{axis} {c:.1e}" for axis, c in zip("xyz", changes, strict=True)))
    print(f"  {time.process_time() - start:.0f} s of CPU time")


if __name__ == "__main__":
    main()
