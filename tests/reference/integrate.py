"""What every reference here needs: accurate integration, a two-tolerance check, tables, rotations."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import solve_ivp

Array = NDArray[np.float64]
Rhs = Callable[[float, Array], Array]

DATA = Path(__file__).resolve().parent.parent / "data"


def solve(rhs: Rhs, y0: ArrayLike, times: ArrayLike, rtol: float = 1e-13) -> Array:
    """Solution of y' = rhs(t, y) at `times` (ascending, y0 belongs to times[0]); shape (len(times), len(y0)).

    Dormand-Prince 8(5,3) from one output time to the next, because its dense output is less accurate than its
    steps.
    """
    times = np.asarray(times, dtype=float)
    states = [np.asarray(y0, dtype=float)]
    step = np.inf
    for t0, t1 in pairwise(times):
        first = min(step, t1 - t0) if np.isfinite(step) else None
        piece = solve_ivp(rhs, (t0, t1), states[-1], "DOP853", rtol=rtol, atol=rtol, first_step=first)
        if not piece.success:
            raise RuntimeError(piece.message)
        states.append(piece.y[:, -1])
        step = float(np.max(np.diff(piece.t)))
    return np.array(states)


def two_tolerances(rhs: Rhs, y0: ArrayLike, times: ArrayLike, coarse: float = 1e-11) -> float:
    """Largest difference between the solutions at `coarse` and at 1e-13: the error bar of a reference."""
    return float(np.abs(solve(rhs, y0, times, coarse) - solve(rhs, y0, times)).max())


def skew(a: ArrayLike) -> Array:
    """Matrix of a x ( . ), shape (3, 3)."""
    x, y, z = np.asarray(a, dtype=float)
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def cross(a: Array, b: Array) -> Array:
    """a x b of two vectors, much faster than numpy's general routine."""
    (a1, a2, a3), (b1, b2, b3) = a.tolist(), b.tolist()
    return np.array([a2 * b3 - a3 * b2, a3 * b1 - a1 * b3, a1 * b2 - a2 * b1])


def axis_rotation(axis: ArrayLike, angle: float) -> Array:
    """Rotation by `angle` about the unit vector along `axis` (Rodrigues), shape (3, 3)."""
    k = skew(np.asarray(axis, dtype=float) / np.linalg.norm(axis))
    return np.asarray(np.eye(3) + np.sin(angle) * k + (1.0 - np.cos(angle)) * (k @ k))


def write_table(name: str, header: str, columns: Sequence[str], rows: ArrayLike, fmt: str = "%.15g") -> None:
    """Write tests/data/`name`: comment lines (source, definition), one line of column names, then the
    numbers."""
    text = "".join(f"# {line}\n" for line in header.strip().splitlines())
    with (DATA / name).open("w") as file:
        file.write(text + ",".join(columns) + "\n")
        np.savetxt(file, np.asarray(rows, dtype=float), fmt=fmt, delimiter=",")


def read_table(name: str) -> dict[str, Array]:
    """Columns of tests/data/`name` by name, each of shape (rows,)."""
    lines = [line for line in (DATA / name).read_text().splitlines() if not line.startswith("#")]
    values = np.loadtxt(lines[1:], delimiter=",", ndmin=2)
    return dict(zip(lines[0].split(","), values.T, strict=True))
