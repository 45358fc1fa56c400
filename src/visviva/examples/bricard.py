"""Bricard mechanism of the IFToMM benchmark library (A04): six revolute joints whose axes make it movable.

Counting says 0 degrees of freedom, in truth there is 1: one constraint is redundant in every position.
"""

from __future__ import annotations

import numpy as np

import visviva as vv

POINTS = np.array([[0, 0, 0], [1, 0, 0], [1, -1, 0], [1, -1, 1], [0, -1, 1], [0, 0, 1]], dtype=float)
AXES = np.eye(3)[[1, 2, 0, 1, 2, 0]]


def bar(start: np.ndarray, end: np.ndarray, name: str) -> vv.RigidBody:
    """A bar of 1 kg, 1 x 0.1 x 0.1, between two points one apart along a coordinate axis."""
    along = end - start
    other = np.roll(np.abs(along), 1)
    R = np.column_stack([along, other, np.cross(along, other)])
    return vv.RigidBody(
        shape=vv.Box(size=(1, 0.1, 0.1)), mass=1.0, position=(start + end) / 2, rotation=R, name=name
    )


def study(gravity: float = 9.81, until: float = 10.0, step: float = 0.01) -> vv.Study:
    """Five bars start at rest, the sixth is the ground; gravity along -y."""
    ground = vv.Ground()
    bars = [bar(POINTS[k], POINTS[k + 1], f"bar {k + 1}") for k in range(5)]
    ring = [ground, *bars, ground]
    hinges = [
        vv.Revolute(a=ring[k], b=ring[k + 1], at=POINTS[k], axis=AXES[k], name=f"hinge {k + 1}")
        for k in range(6)
    ]
    system = vv.System([ground, *bars, *hinges, vv.Gravity(acceleration=(0, -gravity, 0))])
    probes = {f"P{k}": vv.Position(of=bars[k], at=POINTS[k]) for k in (2, 3, 4)}
    return vv.Study(
        system, until, step, probes=probes, trails=("P3",), units="SI", title="Bricard mechanism (IFToMM A04)"
    )


def check(result: vv.Result) -> None:
    """Energy and closure of the ring."""
    result.assert_conserved("energy", "constraints")
