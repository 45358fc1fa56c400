"""Chain of rods on ball joints with spin (triple ball-joint pendulum), in the rods' axis vectors only.

Rod k has mass m, length L, moments J_t (transverse) and J_a (axial) about its centre, unit axis a_k. Its
upper end hangs on the previous rod's lower end, the first on the origin. Ball joints on the axis exert no
axial torque and the rods are symmetric, so each axial rate W_k = omega_k . a_k is constant. With x_k =
sum_{j<k} L a_j + L a_k / 2 the kinetic energy is a'^T A a' / 2 + sum J_a W_k^2 / 2 (A constant, N x N) and

    sum_j A_kj a_j'' = f_k + J_a W_k a_k x a_k' + mu_k a_k,   |a_k| = 1,   f_k = -g e3 m L (N - k - 1/2), k =
    0 ... N-1.

Default data: m = L = 1, J_t = 1/12, J_a = m r^2 / 2 with r = .05, g = 9.81; all rods in line 30 degrees below
the horizontal, d1 = (cos 30, 0, -sin 30), d2 = e2, d3 = d1 x d2, all with omega = 30 d1 + 2 d2 + 2.5 d3: E0 =
25.7400 J.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .integrate import Array, cross, read_table, solve, write_table

GRAVITY, MASS, LENGTH, RADIUS, RODS = 9.81, 1.0, 1.0, 0.05, 3
TRANSVERSE, AXIAL = MASS * LENGTH**2 / 12, MASS * RADIUS**2 / 2
TILT = np.pi / 6
FRAME = np.array([[np.cos(TILT), 0.0, np.sin(TILT)], [0.0, 1.0, 0.0], [-np.sin(TILT), 0.0, np.cos(TILT)]])
BODY_RATE = np.array([30.0, 2.0, 2.5])
ENERGY = 25.74


def matrices(rods: int) -> tuple[Array, Array]:
    """A (N, N) and the lever of gravity m L (N - k - 1/2), shape (N,)."""
    levers = np.tril(np.full((rods, rods), LENGTH), -1) + 0.5 * LENGTH * np.eye(rods)
    return MASS * levers.T @ levers + TRANSVERSE * np.eye(rods), MASS * levers.sum(axis=0)


def accelerations(a: Array, da: Array, spin: float) -> Array:
    """a'' of all rods, shape (N, 3): the multipliers mu from a.a'' = -|a'|^2."""
    rods = len(a)
    mass, lever = matrices(rods)
    inverse = np.linalg.inv(mass)
    force = AXIAL * spin * np.cross(a, da) - GRAVITY * lever[:, None] * np.array([0.0, 0.0, 1.0])
    free = inverse @ force
    mu = np.linalg.solve(inverse * (a @ a.T), -np.sum(da * da, axis=1) - np.sum(a * free, axis=1))
    return np.asarray(free + inverse @ (mu[:, None] * a))


def start(rods: int = RODS) -> tuple[Array, Array]:
    """Axes and their rates at t = 0, each (N, 3): a' = omega x a."""
    a = FRAME[:, 0]
    return np.tile(a, (rods, 1)), np.tile(cross(FRAME @ BODY_RATE, a), (rods, 1))


def invariants(a: Array, da: Array, spin: float) -> tuple[float, float]:
    """Energy and angular momentum about the vertical through the origin."""
    mass, lever = matrices(len(a))
    kinetic = 0.5 * np.sum(da * (mass @ da)) + 0.5 * len(a) * AXIAL * spin**2
    momentum = np.sum(np.cross(a, mass @ da), axis=0) + AXIAL * spin * a.sum(axis=0)
    return float(kinetic + GRAVITY * lever @ a[:, 2]), float(momentum[2])


def trajectory(times: ArrayLike, rods: int = RODS, rtol: float = 1e-13) -> dict[str, Array]:
    """t; axes (n, N, 3), ends of the rods (n, N, 3), rates of the axes (n, N, 3); energy, momentum3 (n,);
    times[0] = 0.

    The solutions at rtol 1e-11 and 1e-13 agree to 4e-11 until t = 4 (to 2e-12 until t = 1).
    """
    spin, shape = BODY_RATE[0], (2, rods, 3)

    def rhs(_: float, y: Array) -> Array:
        a, da = y.reshape(shape)
        return np.concatenate([da.ravel(), accelerations(a, da, spin).ravel()])

    states = solve(rhs, np.concatenate([x.ravel() for x in start(rods)]), times, rtol).reshape(-1, *shape)
    axes, rates = states[:, 0], states[:, 1]
    both = np.array([invariants(a, da, spin) for a, da in states])
    ends = LENGTH * np.cumsum(axes, axis=1)
    return {
        **{"t": np.asarray(times, dtype=float), "axes": axes, "ends": ends, "rates": rates},
        **{"energy": both[:, 0], "momentum3": both[:, 1]},
    }


COLUMNS = [
    "t",
    *(f"{c}{k}" for k in "123" for c in "xyz"),
    *(f"v{c}{k}" for k in "123" for c in "xyz"),
    "energy",
    "momentum3",
]


def cached() -> dict[str, Array]:
    """Default chain at t = 0, 0.1 ... 4: ends of the rods xk yk zk, their velocities, energy, momentum3."""
    return read_table("chain3.csv")


def write() -> None:
    """Regenerate the table."""
    a = trajectory(np.linspace(0.0, 4.0, 41))
    speeds = LENGTH * np.cumsum(a["rates"], axis=1)
    n = len(a["t"])
    rows = np.column_stack(
        [a["t"], a["ends"].reshape(n, 9), speeds.reshape(n, 9), a["energy"], a["momentum3"]]
    )
    head = "Three rods on ball joints with spin, own computation in axis vectors,\n"
    head += "Dormand-Prince 8(5,3), rtol 1e-13; ends of the rods and their velocities;\n"
    head += "definition: tests/reference/chain.py"
    write_table("chain3.csv", head, COLUMNS, rows)
