"""Shells with kinks and branches: several directors at a node."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from verification.shell_cases import linear, sheet, stretching

Array = NDArray[np.float64]


def plate(to: Any, counts: tuple[int, int], cell: str) -> vv.Mesh:
    """A unit square taken to space."""
    flat = vv.RectangleMesh(size=(1, 1), counts=counts, cell=cell).build()
    return vv.Mesh(to(*flat.points.T), flat.cells)


def welded(first: vv.Mesh, *others: vv.Mesh) -> vv.Mesh:
    for other in others:
        first = first.merged(other, weld=1e-9)
    return first


def tee(n: int, cell: str) -> vv.Mesh:
    """A standing plate with a lying one on it."""
    return welded(
        plate(lambda s, y: np.stack([0 * s, y, s], axis=1), (n, n), cell),
        plate(lambda s, y: np.stack([s / 2 - 0.5, y, 0 * s + 1], axis=1), (n // 2, n), cell),
        plate(lambda s, y: np.stack([s / 2, y, 0 * s + 1], axis=1), (n // 2, n), cell),
    )


T_SHAPE = {0.05: (0.198, 0.168), 0.25: (0.823, 0.615), 0.5: (1.085, 0.755), 1.0: (1.253, 0.815)}
"""Neunteufel & Schoeberl (2024): by P / 3000, the way of one end along x and the other down."""


@pytest.mark.parametrize(
    ("kind", "cell", "n"),
    [
        *((vv.Shell, cell, n) for cell, n in (("quad4", 8), ("quad9", 4), ("tri3", 8), ("tri6", 4))),
        (vv.ExtensibleShell, "quad4", 8),
    ],
)
def test_t_shaped_cantilever(kind: Any, cell: str, n: int) -> None:
    """Clamped below, pulled at one end: within one per cent of their largest values."""
    section = sheet(0.1, 6e6) if kind is vv.Shell else stretching(0.1, 6e6)
    shell = kind(mesh=tee(n, cell), section=section, kinks="rigid")
    border = shell.faces("all")
    end = border.where(border.centres(shell.points)[:, 0] < -0.5 + 1e-9)
    load = vv.Traction(solid=shell, faces=end, traction=(3e3, 0, 3e3), times="t")
    foot = np.flatnonzero(shell.points[:, 2] < 1e-9)
    system = vv.System([shell, vv.Clamped(solid=shell, nodes=foot), load])
    a, b = (np.argmin(np.linalg.norm(shell.points - X, axis=1)) for X in ((-0.5, 0, 1), (0.5, 0, 1)))
    for share, (right, down) in T_SHAPE.items():
        vv.quasi_static(system, until=share, step=0.05)
        u = shell.displacements(system.x)
        assert (u[a, 0], -u[b, 2]) == pytest.approx((right, down), abs=0.0125)


@pytest.mark.parametrize(("kinks", "sway"), [("rigid", 5 / 84), ("hinged", 1 / 6)])
@pytest.mark.parametrize(
    ("kind", "cell", "n", "tolerance"),
    [
        (vv.Shell, "quad4", 16, 5e-3),
        (vv.Shell, "quad9", 3, 1e-3),
        (vv.Shell, "tri6", 8, 7e-3),
        (vv.ExtensibleShell, "quad4", 16, 5e-3),
    ],
)
def test_portal(kind: Any, kinks: Any, sway: float, cell: str, n: int, tolerance: float) -> None:
    """Two legs and a lintel, all alike, pushed aside by P: 5 / 84 P h^3 / E I with rigid corners, 1 / 6 with hinges."""
    mesh = welded(
        plate(lambda s, y: np.stack([0 * s, 0.1 * y, s], axis=1), (n, 1), cell),
        plate(lambda s, y: np.stack([s, 0.1 * y, 0 * s + 1], axis=1), (n, 1), cell),
        plate(lambda s, y: np.stack([0 * s + 1, 0.1 * y, 1 - s], axis=1), (n, 1), cell),
    )
    section = sheet(0.01, 1e9) if kind is vv.Shell else stretching(0.01, 1e9)
    shell = kind(mesh=mesh, section=section, kinks=kinks)
    foot = np.flatnonzero(shell.points[:, 2] < 1e-9)
    push = vv.Force(on=shell.point((0.0, 0.05, 1.0)), force=(1e-6, 0, 0))
    system = linear(shell, vv.Clamped(solid=shell, nodes=foot), push)
    found = system.value(shell.point((0.0, 0.05, 1.0)).position)[0]
    assert found / (1e-6 / (1e9 * 0.1 * 0.01**3 / 12)) == pytest.approx(sway, rel=tolerance)


@pytest.mark.parametrize("kind", [vv.Shell, vv.ExtensibleShell])
def test_flight_of_a_kinked_shell(kind: Any) -> None:
    """A star of three panels and a lid on them, with two and three directors at nodes: all books are balanced."""
    panels = [
        plate(lambda s, y, a=a: np.stack([s * np.cos(a), s * np.sin(a), y], axis=1), (2, 2), "quad4")
        for a in (0.2, 2.2, 4.4)
    ]
    along, across = np.array([np.cos(0.2), np.sin(0.2), 0.0]), np.array([-np.sin(0.2), np.cos(0.2), 0.1])
    lid = plate(lambda s, y: np.outer(s, along) + np.outer(y, across) + (0, 0, 1), (2, 2), "quad4")
    made = sheet if kind is vv.Shell else stretching
    shell = kind(
        mesh=welded(*panels, lid),
        section=made(0.05, 1e4, 0.3, density=10.0),
        kinks="rigid",
        velocity=lambda X: np.stack([0.3 * np.sin(3 * X[:, 1]), 0 * X[:, 0], 0.5 * X[:, 0]], axis=1),
        angular_velocity=(0.5, 1.0, -0.7),
    )
    assert np.bincount(shell.more[0]).max() == 3  # the own one and those of two panels and the lid
    ledger = vv.simulate(vv.System([shell]), until=1.0, step=0.01).ledger
    assert np.ptp(ledger["potential_stored"]) > 1e-3 * ledger["total"][0]
    for name in ("total", *(f"{what}_{axis}" for what in ("momentum", "angular") for axis in "xyz")):
        assert np.ptp(ledger[name]) < 1e-11 * abs(ledger["total"][0]), name


def folded(angle: float) -> vv.Mesh:
    """Two flat halves."""
    c, s = np.cos(angle), np.sin(angle)
    return welded(
        plate(lambda x, y: np.stack([x - 1, y, 0 * x], axis=1), (3, 3), "quad4"),
        plate(lambda x, y: np.stack([x * c, y, x * s], axis=1), (3, 3), "quad4"),
    )


def test_folds_are_told() -> None:
    """What a mean director would average away is refused or said, and kept with kinks."""
    section = sheet(0.01, 1e6)
    with pytest.raises(vv.InputError, match="kinks='rigid' or 'hinged'"):
        vv.Shell(mesh=folded(1.0), section=section)
    with pytest.warns(UserWarning, match="kink of 29 degrees"):
        vv.Shell(mesh=folded(0.5), section=section)
    for angle in (0.5, 1.0):
        assert len(vv.Shell(mesh=folded(angle), section=section, kinks="rigid").more[0]) == 4
    upside = folded(1.0)
    cells = upside.cells["quad4"].copy()
    cells[9:] = cells[9:, ::-1]
    with pytest.raises(vv.InputError, match="upper sides on different sides"):
        vv.Shell(mesh=vv.Mesh(folded(0.3).points, {"quad4": cells}), section=section, kinks="rigid")
