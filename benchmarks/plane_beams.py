"""Time of a step of a swinging chain of beam elements: plane beams, beams in space, and those held in a plane.

Run: PYTHONPATH=src python benchmarks/plane_beams.py
"""

from __future__ import annotations

import time
from typing import Any

import visviva as vv

STEPS = 100
SECTION = vv.GivenSection(stiffness=(1e4, 1e4, 1e4, 1e2, 1e2, 1e2), mass=1.0, moments=(0.01, 0.01, 0))


def system(kind: str, count: int) -> vv.System:
    """A beam on a hinge under its weight."""
    mesh = vv.LineMesh(points=[(0, 0, 0), (1, 0, 0)], count=count)
    beam: Any = (
        vv.PlaneBeam(mesh=mesh, section=SECTION) if kind == "plane" else vv.Beam(mesh=mesh, section=SECTION)
    )
    ground = vv.Ground()
    hinge = vv.Revolute(a=ground, b=beam, at=(0, 0, 0), axis=(0, 0, 1))
    parts = [ground, beam, hinge, vv.Gravity(acceleration=(0, -9.81, 0))]
    if kind == "held in a plane":
        parts.append(vv.SymmetryPlane(solid=beam, nodes="all", normal=(0, 0, 1)))
    return vv.System(parts)


def milliseconds(kind: str, count: int) -> float:
    """Least processor time of a step in three runs."""
    found = []
    for _ in range(3):
        swinging = system(kind, count)
        start = time.process_time()
        vv.simulate(swinging, until=STEPS * 0.005, step=0.005)
        found.append((time.process_time() - start) / STEPS * 1e3)
    return min(found)


if __name__ == "__main__":
    print(f"{'elements':>10}{'plane':>10}{'in space':>10}{'held in a plane':>18}   ms per step")
    for n in (16, 100, 400):
        plane, space, held = (milliseconds(kind, n) for kind in ("plane", "in space", "held in a plane"))
        print(f"{n:10d}{plane:10.3f}{space:10.3f}{held:18.3f}")
