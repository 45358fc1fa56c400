"""IFToMM A04, Bricard mechanism: six revolute joints, redundant constraints, one degree of freedom.

Joints at P0 = (0,0,0), P1 = (1,0,0), P2 = (1,-1,0), P3 = (1,-1,1), P4 = (0,-1,1), P5 = (0,0,1) with axes y,
z, x, y, z, x at the start; bar P5-P0 is the ground, gravity along -y, start at rest. The five bars between
are 1 kg boxes 1 x 0.1 x 0.1. Three-fold symmetry makes the closed chain explicit in the first joint angle q
(about +y):

    joint angles q, p, q, p, q, p    with    sin p = -sin q / (1 + sin q),

checked here by the closure of the chain. Then I(q) q'' + I_q q'^2 / 2 + V_q = 0, derivatives by complex
steps.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .integrate import Array, read_table, solve, write_table

GRAVITY = 9.81
STARTS = np.array(
    [[0, 0, 0], [1, 0, 0], [1, -1, 0], [1, -1, 1], [0, -1, 1], [0, 0, 1], [0, 0, 0]], dtype=float
)
AXES = (1, 2, 0, 1, 2, 0)
AXIAL, TRANSVERSE = (0.1**2 + 0.1**2) / 12, (1.0 + 0.1**2) / 12


def rotation(axis: int, angle: complex) -> np.ndarray:
    """Rotation about a coordinate axis; complex angles allowed."""
    c, s = np.cos(angle), np.sin(angle)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3, dtype=complex)
    matrix[i, i], matrix[i, j], matrix[j, i], matrix[j, j] = c, -s, s, c
    return matrix


def chain(q: complex) -> tuple[list[np.ndarray], list[np.ndarray], list[np.ndarray]]:
    """Joint positions P0..P6 (P6 = P0 when closed), attitudes of bars 1..5, joint axes; 5 bars from the first
    joint."""
    p = -np.arcsin(np.sin(q) / (1.0 + np.sin(q)))
    points, frames, axes, frame = [STARTS[0].astype(complex)], [], [], np.eye(3, dtype=complex)
    for k, axis in enumerate(AXES):
        axes.append(frame[:, axis])
        frame = frame @ rotation(axis, q if k % 2 == 0 else p)
        frames.append(frame)
        points.append(points[-1] + frame @ (STARTS[k + 1] - STARTS[k]))
    return points, frames, axes


def closure(q: float) -> float:
    """Defect of the loop: the sixth frame must be the identity and P5 must stay at (0, 0, 1)."""
    points, frames, _ = chain(q)
    return float(max(np.abs(frames[5] - np.eye(3)).max(), np.abs(points[5] - STARTS[5]).max()))


def energies(q: complex) -> tuple[complex, complex]:
    """I(q) with T = I q'^2 / 2, and V(q)."""
    points, _, axes = chain(q)
    slope = -np.cos(q) / (1.0 + np.sin(q)) ** 2 / np.sqrt(1.0 - (np.sin(q) / (1.0 + np.sin(q))) ** 2)
    spin, velocity = np.zeros(3, dtype=complex), np.zeros(3, dtype=complex)
    inertia, potential = 0j, 0j
    for k in range(5):
        spin = spin + axes[k] * (1.0 if k % 2 == 0 else slope)
        bar = points[k + 1] - points[k]
        sweep = np.cross(spin, bar)
        centre = velocity + 0.5 * sweep
        along = spin @ bar
        inertia += centre @ centre + TRANSVERSE * (spin @ spin) + (AXIAL - TRANSVERSE) * along**2
        potential += GRAVITY * 0.5 * (points[k] + points[k + 1])[1]
        velocity = velocity + sweep
    return inertia, potential


def trajectory(times: ArrayLike, rtol: float = 1e-13) -> dict[str, Array]:
    """t, q1, rate, energy (zero at the start up to the constant -3 g) and P2, P3, P4 of shape (len(times),
    3)."""

    def rhs(_: float, y: Array) -> Array:
        inertia, potential = energies(y[0] + 1e-30j)
        force = -0.5e30 * inertia.imag * y[1] ** 2 - 1e30 * potential.imag
        return np.array([y[1], force / inertia.real])

    times = np.asarray(times, dtype=float)
    angle, rate = solve(rhs, [0.0, 0.0], times, rtol).T
    points = np.real([chain(a)[0] for a in angle])
    inertia, potential = np.real([energies(a) for a in angle]).T
    energy = 0.5 * inertia * rate**2 + potential
    return {"t": times, "q1": angle, "rate": rate, "energy": energy} | {
        f"P{k}": points[:, k] for k in (2, 3, 4)
    }


COLUMNS = ["t", "q1", "rate", "energy", *(f"P{k}{c}" for k in "234" for c in "xyz")]


def cached() -> dict[str, Array]:
    """Columns `COLUMNS` at t = 0, 0.25 ... 10."""
    return read_table("bricard.csv")


def write() -> None:
    """Regenerate the table."""
    a = trajectory(np.linspace(0.0, 10.0, 41))
    rows = np.column_stack([a[k] for k in ("t", "q1", "rate", "energy", "P2", "P3", "P4")])
    head = "Bricard mechanism IFToMM A04, own one-coordinate model, Dormand-Prince 8(5,3), rtol 1e-13;\n"
    head += "q1 about +y, joints P2 P3 P4; definition: tests/reference/bricard.py"
    write_table("bricard.csv", head, COLUMNS, rows)
