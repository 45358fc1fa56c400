"""Crank-rocker: crank 0.5, coupler 1.8, rocker 1.5, ground 2 (slender rods of 1 kg); the crank goes round.

All four hinges are revolute joints in space, so that three of their twenty constraints are redundant.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import visviva as vv

Z = (0.0, 0.0, 1.0)


def rod(start: np.ndarray, end: np.ndarray, rate: float, velocity: np.ndarray, name: str) -> vv.RigidBody:
    """Slender rod between two points that turns with `rate`, its centre moving with `velocity`."""
    length = float(np.linalg.norm(end - start))
    c, s = (end - start)[:2] / length
    width = 0.04
    inertia = (width**2 / 6, length**2 / 12, length**2 / 12)
    R = [[c, -s, 0], [s, c, 0], [0, 0, 1]]
    moving: dict[str, Any] = {"velocity": velocity, "angular_velocity": (0, 0, rate)}
    box = vv.Box(size=(length, width, width))
    return vv.RigidBody(
        mass=1.0, inertia=inertia, shape=box, position=(start + end) / 2, rotation=R, name=name, **moving
    )


def study(rate: float = 5.0, gravity: float = 9.81, until: float = 20.0, step: float = 0.01) -> vv.Study:
    """Starts with the crank upright, turning with `rate` rad/s; gravity along -y."""
    crank, coupler, rocker, span = 0.5, 1.8, 1.5, 2.0
    O, A, D = np.zeros(3), np.array([0, crank, 0]), np.array([span, 0, 0])
    gap = D - A
    square = gap @ gap
    along = (coupler**2 - rocker**2 + square) / (2 * square)
    B = A + along * gap + np.sqrt(coupler**2 / square - along**2) * np.cross(Z, gap)
    # velocity of B along coupler and rocker: vA + beta Z x AB = gamma Z x DB
    vA = rate * np.cross(Z, A)
    sides = np.column_stack([np.cross(Z, B - A), -np.cross(Z, B - D)])[:2]
    beta, gamma = np.linalg.solve(sides, -vA[:2])
    vB = gamma * np.cross(Z, B - D)
    ground = vv.Ground()
    bars = [
        rod(O, A, rate, vA / 2, "crank"),
        rod(A, B, beta, (vA + vB) / 2, "coupler"),
        rod(D, B, gamma, vB / 2, "rocker"),
    ]
    first, second, third = bars
    pairs = ((ground, first, O), (first, second, A), (third, second, B), (ground, third, D))
    hinges = [vv.Revolute(a=a, b=b, at=p, axis=Z, name=f"hinge {k}") for k, (a, b, p) in enumerate(pairs, 1)]
    system = vv.System([ground, *bars, *hinges, vv.Gravity(acceleration=(0, -gravity, 0))])
    probes = {"A": vv.Position(of=first, at=A), "B": vv.Position(of=third, at=B)}
    return vv.Study(
        system, until, step, probes=probes, trails=("B",), units="SI", title="Four-bar (crank-rocker)"
    )


def check(result: vv.Result) -> None:
    """Energy and closure of the loop."""
    result.assert_conserved("energy", "constraints")
