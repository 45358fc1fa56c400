"""Moments along edges of shells: which directors take them, and what torque they exert."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv
from visviva.mesh.faces import Faces

MOMENT = 1e-3


# --- hinges -------------------------------------------------------------------------------------------------
def angle(which: tuple[str, ...]) -> tuple[vv.Shell, Faces]:
    """Two strips of four cells each at a right angle, hinged, with the hinge as the edge of those that are named."""
    flat = [(i / 4, y, 0) for i in range(5) for y in (0, 1)]
    down = [(1, y, -i / 4) for i in range(1, 5) for y in (0, 1)]
    cells = [(2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1) for i in range(8)]
    sets = {"a": [0, 1], "b": [16, 17]}
    mesh = vv.Mesh(np.array([*flat, *down], dtype=float), {"quad4": cells}, node_sets=sets)
    sheet = vv.HomogeneousSection(thickness=0.05, young=1e6)
    edges = {"flat": ([8, 9], 3), "down": ([9, 8], 4)}
    nodes, owners = zip(*(edges[name] for name in which), strict=True)
    return vv.Shell(mesh=mesh, section=sheet, kinks="hinged"), Faces(
        {"line2": np.array(nodes)}, {"line2": np.array(owners)}
    )


def work_of(shell: vv.Shell, edges: Faces, *supports: Any) -> tuple[vv.System, vv.EdgeMoment]:
    moment = vv.EdgeMoment(shell=shell, edges=edges, moment=(0, MOMENT, 0))
    system = vv.System([shell, *supports, moment])
    vv.quasi_static(system, until=1.0, step=1.0)
    return system, moment


@pytest.mark.parametrize("which", [("flat",), ("down",), ("flat", "down")], ids=" and ".join)
def test_a_moment_at_a_hinge_bends_the_part_that_owns_the_edge(which: tuple[str, ...]) -> None:
    """M at the end of a strip that is clamped at the other, propped by the other strip: 3 M x / 2 L - M / 2 in it."""
    shell, edges = angle(which)
    supports = [vv.Clamped(solid=shell, nodes=name) for name in "ab"]
    hinge = vv.Fixed(solid=shell, nodes=[8, 9], directions=(True, True, True))
    system, _ = work_of(shell, edges, *supports, hinge)
    bent = np.abs(shell.resultants(system.x)[..., 3].mean(axis=1)).reshape(2, 4)
    middle = np.abs(1.5 * (np.arange(4) + 0.5) / 4 - 0.5) * MOMENT
    np.testing.assert_allclose(bent[0], middle if "flat" in which else 0.0, atol=0.02 * MOMENT)
    np.testing.assert_allclose(bent[1], middle[::-1] if "down" in which else 0.0, atol=0.02 * MOMENT)


# --- torque -------------------------------------------------------------------------------------------------
SECTION = vv.HomogeneousSection(thickness=0.1, young=1e3, density=1.0)
RUBBER = vv.SolidSection(thickness=0.1, material=vv.NeoHooke(young=1e3, poisson=0.3), density=1.0)


@pytest.mark.parametrize(
    ("kind", "section", "length"),
    [(vv.Shell, SECTION, 1.0), *((vv.ExtensibleShell, RUBBER, size) for size in (1.0, 0.8, 0.6))],
)
def test_angular_momentum_grows_by_the_moment_whatever_the_length_of_directors(
    kind: Any, section: Any, length: float
) -> None:
    shell = kind(mesh=vv.RectangleMesh(size=(4, 1), counts=(8, 2)), section=section)
    system = vv.System([shell, vv.EdgeMoment(shell=shell, edges="x1", moment=(0, -MOMENT, 0))])
    for first in shell.director_unknowns(np.arange(shell.grid.n_nodes))[:, 0]:
        system.x[first : first + 3] *= length
    ledger = vv.simulate(system, until=1e-5, step=1e-5).ledger
    found = [(ledger[f"angular_{k}"][-1] - ledger[f"angular_{k}"][0]) / 1e-5 for k in "xyz"]
    np.testing.assert_allclose(found, (0, -MOMENT, 0), atol=1e-9 * MOMENT)


@pytest.mark.parametrize(("kind", "section"), [(vv.Shell, SECTION), (vv.ExtensibleShell, RUBBER)])
def test_the_work_of_a_moment_is_what_the_shell_gains(kind: Any, section: Any) -> None:
    """In large steps, in which directors stretch and turn far."""
    shell = kind(mesh=vv.RectangleMesh(size=(4, 1), counts=(8, 2)), section=section)
    moment = vv.EdgeMoment(shell=shell, edges="x1", moment=(0, -0.05, 0))
    system = vv.System([shell, vv.Clamped(solid=shell, nodes="x0"), moment])
    ledger = vv.simulate(system, until=2.0, step=0.1).ledger
    work = ledger.last("work_edge moment")
    assert work > 1e-3
    assert ledger.size("imbalance") < 1e-9 * work
