"""Rotary crane of Hesch & Betsch (2012), section 4.1, as a Lagrangian model in five minimal coordinates.

Coordinates q = (alpha, u, phi1, phi2, theta): crane angle, trolley stroke, two swing angles of the rope,
winch angle. The crane axis is e3 through the origin, gravity is -g e3, the girder and the trolley move in the
plane z = 0. In the frame turning with the crane (first axis along the girder, third axis e3)

    rope direction   e(phi1, phi2) = (sin phi1, cos phi1 sin phi2, -cos phi1 cos phi2)
    rope length      L = L0 + r_w theta                       (rope leaves at the centre of the winch)
    trolley, winch   (u, 0, 0)
    load             (u, 0, 0) + L e

Inertia: the E_i of the paper's Table 1 are values of the Euler tensor, so the moment of inertia about axis i
is E_j + E_k. Girder centre on the crane axis, its axis 3 along e3: J = 8.3 + 208.3. The trolley gives 2 *
1.0417. The winch spins about its principal axis 3 (J = 0.01 + 0.01 = 0.02), which is horizontal and
perpendicular to the girder; about e3 it gives 0.01 + 0.25 = 0.26 whatever its angle. Sum about the crane
axis: 218.9434. Angular velocity of the winch is alpha' e3 + theta' n with n perpendicular to e3, so the
kinetic energy has no alpha'-theta' product from the winch itself, and the winch angle adds nothing to the
angular momentum about e3:

    T = 218.9434 alpha'^2 / 2 + 0.02 theta'^2 / 2 + 53 (u'^2 + u^2 alpha'^2) / 2 + 10 |r'|^2 / 2,    V = 10 g
    z.

With the winch along the girder instead, T is the same function: the trajectory does not depend on that
choice.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .integrate import Array, read_table, solve, write_table

GRAVITY = 9.81
ROPE_LENGTH, WINCH_RADIUS = 1.2, 0.1
STROKE, RATE = 1.5, 1.32
GIRDER, TROLLEY_AND_WINCH, LOAD = 100.0, 53.0, 10.0
AXIS_INERTIA = (8.3 + 208.3) + (1.0417 + 1.0417) + (0.01 + 0.25)
WINCH_INERTIA = 0.01 + 0.01
E1, E2, E3 = np.eye(3)
TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])  # e3 x ( . )
START = np.array([0.0, STROKE, 0.0, 0.0, 0.0, RATE, 0.0, 0.0, 0.0, 0.0])
COLUMNS = [
    *("t", "alpha", "u", "theta", "length", "x", "y", "z", "alpha_rate", "u_rate", "theta_rate"),
    *("vx", "vy", "vz", "tension", "energy", "momentum3", "ground_x", "ground_y", "ground_z"),
]


def rope(q: Array) -> tuple[Array, Array, Array]:
    """Rope direction e, its derivatives by (phi1, phi2) as columns, and its second derivatives (2, 2, 3)."""
    s1, c1, s2, c2 = np.sin(q[2]), np.cos(q[2]), np.sin(q[3]), np.cos(q[3])
    e = np.array([s1, c1 * s2, -c1 * c2])
    first = np.array([[c1, 0.0], [-s1 * s2, c1 * c2], [s1 * c2, c1 * s2]])
    mixed = np.array([0.0, -s1 * c2, -s1 * s2])
    return e, first, np.array([[-e, mixed], [mixed, np.array([0.0, -c1 * s2, c1 * c2])]])


def load_kinematics(q: Array, dq: Array) -> tuple[Array, Array, Array, Array]:
    """In the crane's frame: position, Jacobian (3, 5), velocity, and the acceleration left when q'' = 0."""
    e, first, second = rope(q)
    length, length_rate = ROPE_LENGTH + WINCH_RADIUS * q[4], WINCH_RADIUS * dq[4]
    position = q[1] * E1 + length * e
    relative = np.column_stack([E1, length * first, WINCH_RADIUS * e])
    jacobian = np.column_stack([TURN @ position, relative])
    drift = relative @ dq[1:]
    bend = np.einsum("ijk,i,j->k", second, dq[2:4], dq[2:4])
    bias = length * bend + 2.0 * length_rate * (first @ dq[2:4])
    bias += dq[0] * (TURN @ (2.0 * drift + dq[0] * (TURN @ position)))
    return position, jacobian, jacobian @ dq, bias


def accelerations(y: Array, locked: bool, controls: ArrayLike = (0.0, 0.0, 0.0, 0.0, 0.0)) -> Array:
    """q'' from M q'' = Q - h + controls, M = sum of J^T m J; `locked` leaves the winch angle out."""
    q, dq = y[:5], y[5:]
    _, jacobian, _, bias = load_kinematics(q, dq)
    trolley = np.column_stack([q[1] * E2, E1, np.zeros((3, 3))])
    trolley_bias = dq[0] * (2.0 * dq[1] * E2 - dq[0] * q[1] * E1)
    mass = np.diag([AXIS_INERTIA, 0.0, 0.0, 0.0, WINCH_INERTIA])
    mass += LOAD * jacobian.T @ jacobian + TROLLEY_AND_WINCH * trolley.T @ trolley
    force = np.asarray(controls) - LOAD * jacobian.T @ (bias + GRAVITY * E3)
    force = force - TROLLEY_AND_WINCH * trolley.T @ trolley_bias
    n = 4 if locked else 5
    return np.append(np.linalg.solve(mass[:n, :n], force[:n]), np.zeros(5 - n))


def energy_and_momentum(y: Array) -> tuple[float, float]:
    """Total energy (potential zero at the trolley's height) and angular momentum about the crane axis."""
    q, dq = y[:5], y[5:]
    position, _, velocity, _ = load_kinematics(q, dq)
    turning = AXIS_INERTIA + TROLLEY_AND_WINCH * q[1] ** 2
    kinetic = turning * dq[0] ** 2 + WINCH_INERTIA * dq[4] ** 2 + TROLLEY_AND_WINCH * dq[1] ** 2
    energy = 0.5 * kinetic + 0.5 * LOAD * velocity @ velocity + LOAD * GRAVITY * position[2]
    return float(energy), float(turning * dq[0] + LOAD * np.cross(position, velocity)[2])


def row(t: float, y: Array, locked: bool) -> Array:
    """One row of `COLUMNS` from a state; `ground_*` is the force on the ground in the crane's revolute joint,
    global axes."""
    q, dq = y[:5], y[5:]
    position, jacobian, velocity, bias = load_kinematics(q, dq)
    second = accelerations(y, locked)
    acceleration = jacobian @ second + bias
    trolley = (second[1] - q[1] * dq[0] ** 2) * E1 + (q[1] * second[0] + 2.0 * dq[0] * dq[1]) * E2
    inertial = TROLLEY_AND_WINCH * trolley + LOAD * acceleration
    ground = -inertial - (GIRDER + TROLLEY_AND_WINCH + LOAD) * GRAVITY * E3
    tension = -LOAD * (acceleration + GRAVITY * E3) @ rope(q)[0]
    c, s = np.cos(q[0]), np.sin(q[0])
    spatial = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    length = ROPE_LENGTH + WINCH_RADIUS * q[4]
    head = [t, q[0], q[1], q[4], length, *(spatial @ position), dq[0], dq[1], dq[4], *(spatial @ velocity)]
    return np.array([*head, tension, *energy_and_momentum(y), *(spatial @ ground)])


def trajectory(times: ArrayLike, locked: bool = False, rtol: float = 1e-13) -> dict[str, Array]:
    """Columns `COLUMNS` at `times` (first must be 0), free winch or winch locked at theta = 0."""

    def rhs(_: float, y: Array) -> Array:
        return np.concatenate([y[5:], accelerations(y, locked)])

    times = np.asarray(times, dtype=float)
    states = solve(rhs, START, times, rtol)
    rows = np.array([row(t, y, locked) for t, y in zip(times, states, strict=True)])
    return dict(zip(COLUMNS, rows.T, strict=True))


def free() -> dict[str, Array]:
    """Cached free motion, t = 0, 0.05 ... 2."""
    return read_table("crane_free.csv")


def locked() -> dict[str, Array]:
    """Cached motion with the winch locked, t = 0, 0.25 ... 10."""
    return read_table("crane_locked.csv")


def write() -> None:
    """Regenerate both tables."""
    head = "Rotary crane (Hesch & Betsch 2012, section 4.1), five-coordinate Lagrangian model,\n"
    head += "own computation, Dormand-Prince 8(5,3), rtol 1e-13; definition: tests/reference/crane.py; "
    for name, times, is_locked in (
        ("free", np.linspace(0.0, 2.0, 41), False),
        ("locked", np.linspace(0.0, 10.0, 41), True),
    ):
        table = trajectory(times, is_locked)
        rows = np.column_stack([table[c] for c in COLUMNS])
        write_table(f"crane_{name}.csv", head + f"winch {name}", COLUMNS, rows)
