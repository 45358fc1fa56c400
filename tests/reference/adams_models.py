"""Own Newton-Euler model of the cases in `adams`: constraints at acceleration level, multipliers give the
reactions.

State: centre x, velocity v, attitude R (9), spatial angular velocity w. With constraint rows A v + B w = 0 at
velocity level and their rates A v' + B w' = -c,

    m v' = m g + A^T l + F,    J w' + w x J w = B^T l + M,    A v' + B w' = -c,

F, M from springs. Over 5 s the drift of the positions stays below 1e-9, far under the digits compared.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from .adams import CASES, COLUMNS, GRAVITY, Case
from .integrate import Array, cross, read_table, skew, solve, write_table

Rows = tuple[Array, Array, Array]


def point_rows(directions: Array, arm: Array, w: Array) -> Rows:
    """Velocity of the body's joint point along the rows of `directions` is zero."""
    return directions, -directions @ skew(arm), directions @ cross(w, cross(w, arm))


def turn_rows(directions: Array) -> Rows:
    """Angular velocity along the rows of `directions` is zero."""
    n = len(directions)
    return np.zeros((n, 3)), directions, np.zeros(n)


def perpendicular_rows(ground: Array, body: Array, w: Array) -> Rows:
    """Each row of `ground` (fixed) stays perpendicular to `body` (turning with w)."""
    n = len(ground)
    return np.zeros((n, 3)), ground @ skew(body).T, ground @ cross(w, cross(w, body))


def distance_rows(arm: Array, offset: Array, v: Array, w: Array) -> Rows:
    """offset . (velocity of the point) = 0."""
    velocity = v + cross(w, arm)
    bend = offset @ cross(w, cross(w, arm)) + velocity @ velocity
    return offset[None, :], cross(arm, offset)[None, :], np.array([bend])


def constraint_rows(case: Case, arm: Array, offset: Array, turn: Array, v: Array, w: Array) -> Rows:
    """Rows of a case; `arm` centre to joint point, `offset` ground point to joint point, `turn` = R
    R(0)^T."""
    across = case.frame[:, :2].T
    body = turn @ case.frame
    parallel = perpendicular_rows(across, body[:, 2], w)
    parts: dict[str, Callable[[], list[Rows]]] = {
        "spherical": lambda: [point_rows(np.eye(3), arm, w)],
        "revolute": lambda: [point_rows(np.eye(3), arm, w), parallel],
        "torsion spring": lambda: [point_rows(np.eye(3), arm, w), parallel],
        "cylindrical": lambda: [point_rows(across, arm, w), parallel],
        "prismatic": lambda: [point_rows(across, arm, w), turn_rows(np.eye(3))],
        "universal": lambda: [point_rows(np.eye(3), arm, w), perpendicular_rows(across[:1], body[:, 1], w)],
        "distance": lambda: [distance_rows(arm, offset, v, w)],
        "spring": lambda: [turn_rows(np.zeros((0, 3)))],
    }
    a, b, c = zip(*parts[case.joint](), strict=True)
    return np.vstack(a), np.vstack(b), np.concatenate(c)


def spring_action(
    case: Case, arm: Array, offset: Array, turn: Array, v: Array, w: Array
) -> tuple[Array, Array]:
    """Force and torque about the centre on the body by the case's spring and damper."""
    if case.joint == "torsion spring":
        axis, body = case.frame[:, 2], turn @ case.frame
        angle = np.arctan2(case.frame[:, 1] @ body[:, 0], case.frame[:, 0] @ body[:, 0])
        return np.zeros(3), -(case.stiffness * angle + case.damping * (w @ axis)) * axis
    if case.joint == "spring":
        length = np.linalg.norm(offset)
        direction = offset / length
        rate = direction @ (v + cross(w, arm))
        force = -(case.stiffness * (length - case.length) + case.damping * rate) * direction
        return force, cross(arm, force)
    return np.zeros(3), np.zeros(3)


def dynamics(case: Case, y: Array) -> tuple[Array, Array, Array, Array]:
    """v', w', and the joint's force on the body and torque on the body about the joint's ground point."""
    x, v, r, w = y[:3], y[3:6], y[6:15].reshape(3, 3), y[15:]
    turn = r @ case.attitude.T
    arm = turn @ (np.array(case.body_point) - np.array(case.centre))
    offset = x + arm - np.array(case.ground_point)
    a, b, c = constraint_rows(case, arm, offset, turn, v, w)
    force, torque = spring_action(case, arm, offset, turn, v, w)
    inertia, rows = (r * case.inertia) @ r.T, np.hstack([a, b])
    system = np.zeros((6 + len(c), 6 + len(c)))
    system[[0, 1, 2], [0, 1, 2]] = case.mass
    system[3:6, 3:6] = inertia
    system[:6, 6:], system[6:, :6] = -rows.T, rows
    weight = np.array([0.0, 0.0, -case.mass * GRAVITY])
    load = np.concatenate([weight + force, torque - cross(w, inertia @ w), -c])
    result = np.linalg.solve(system, load)
    on_body = force + a.T @ result[6:]
    about_ground = torque + b.T @ result[6:] + cross(x - np.array(case.ground_point), on_body)
    return result[:3], result[3:6], on_body, about_ground


def quaternion(r: Array) -> Array:
    """Quaternion (e0, e1, e2, e3) of a rotation matrix, e0 >= 0 (largest component first, so no
    cancellation)."""
    diagonal = np.diag(r)
    squares = np.array([1.0 + r.trace(), *(1.0 + 2.0 * diagonal - r.trace())])
    k = int(np.argmax(squares))
    upper = np.array([r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]])
    q = np.concatenate([[squares[0]], upper])
    if k > 0:
        q = np.array([upper[k - 1], *(r[k - 1] + r[:, k - 1])])
        q[k] = squares[k]
    return np.asarray(q * (np.copysign(1.0, q[0]) / np.linalg.norm(q)))


def output(case: Case, t: float, y: Array) -> Array:
    """One row of `adams.COLUMNS`: all that joint and spring do to the ground."""
    _, _, force, torque = dynamics(case, y)
    return np.array([t, *y[:6], *quaternion(y[6:15].reshape(3, 3)), *y[15:], *-force, *-torque])


def trajectory(case: Case, times: ArrayLike, rtol: float = 1e-12) -> dict[str, Array]:
    """Columns `adams.COLUMNS` of a case by the own model; times[0] = 0."""

    def rhs(_: float, y: Array) -> Array:
        dv, dw = dynamics(case, y)[:2]
        return np.concatenate([y[3:6], dv, (skew(y[15:]) @ y[6:15].reshape(3, 3)).ravel(), dw])

    times = np.asarray(times, dtype=float)
    first = np.concatenate([case.centre, np.zeros(3), case.attitude.ravel(), np.zeros(3)])
    states = solve(rhs, first, times, rtol)
    rows = np.array([output(case, t, y) for t, y in zip(times, states, strict=True)])
    return dict(zip(COLUMNS, rows.T, strict=True))


def cached(name: str) -> dict[str, Array]:
    """Own trajectory of a case at t = 0, 0.25 ... 5 with 13 digits: for orders of convergence beyond ADAMS'
    digits."""
    return read_table(f"joint_{name}.csv")


def write() -> None:
    """Regenerate all tables of `cached`."""
    for name, case in CASES.items():
        a = trajectory(case, np.linspace(0.0, 5.0, 21))
        head = f"Case {name}: own Newton-Euler model, Dormand-Prince 8(5,3), rtol 1e-12;\n"
        head += (
            "definition: tests/reference/adams.py, tests/reference/adams_models.py; columns as in adams_*.csv"
        )
        write_table(f"joint_{name}.csv", head, COLUMNS, np.column_stack([a[k] for k in COLUMNS]), "%.13g")
