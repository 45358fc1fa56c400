"""Directors of constant length that leave the equations: the solution is that of the system with multipliers."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from catalogue import Components
from catalogue.beams import panel, swaying
from conftest import SCHEMES

import visviva as vv
from visviva.model.reductions import Reductions

STEPS, STEP = 8, 0.02
SOLVERS = {
    "blocks": vv.Newton(tolerance=1e-12),
    "factors": vv.Newton(tolerance=1e-12, linear=vv.Direct()),
    "eigen": vv.Newton(tolerance=1e-12, linear=vv.Direct(library="eigen")),
}


def plate(young: float = 2e3) -> vv.Shell:
    section = vv.HomogeneousSection(thickness=0.05, young=young, poisson=0.3, density=10.0)
    return vv.Shell(mesh=vv.RectangleMesh(size=(1.0, 0.8), counts=(3, 2)), section=section)


def clamped() -> Components:
    shell = plate(1e5)
    edge = vv.Clamped(solid=shell, nodes="x0")
    return [shell, edge, vv.Gravity(), vv.Pressure(solid=shell, faces="upper", pressure="0.5*sin(3*t)")]


def mirrored() -> Components:
    """A plate with symmetry planes, which hold one component of directors, and with a clamped side."""
    shell = plate()
    planes = [
        vv.SymmetryPlane(solid=shell, nodes=nodes, normal=normal)
        for nodes, normal in (("x1", (1, 0, 0)), ("y0", (0, 1, 0)))
    ]
    return [shell, *planes, vv.Clamped(solid=shell, nodes="x0"), vv.Gravity()]


def hinged() -> Components:
    """A plate that hangs by ball joints at two corners from a free body: a hinge along its edge."""
    shell = plate(1e5)
    body = vv.RigidBody(shape=vv.Box(size=(0.2, 0.8, 0.2)), density=20.0, position=(-0.1, 0.4, 0.0))
    joints = [vv.Spherical(a=body, b=shell, at=(0.0, y, 0.0)) for y in (0.0, 0.8)]
    above = vv.Spherical(a=shell, b=vv.PointMass(mass=0.1, position=(1.0, 0.4, 0.02)), at=(1.0, 0.4, 0.02))
    push = vv.Force(on=shell, at=(1.0, 0.8, 0.0), force=(0.5, 1.0, 3.0))
    return [shell, body, *joints, above, above.b, push, vv.Gravity()]


def flying() -> Components:
    return panel(velocity=swaying, angular_velocity=(0.3, 0.6, 1.0))


CASES: dict[str, Callable[[], Components]] = {
    "free": flying,
    "clamped": clamped,
    "symmetric": mirrored,
    "hinged": hinged,
}


def run(parts: Components, scheme: vv.Scheme, newton: vv.Newton) -> vv.System:
    system = vv.System(parts, newton=newton)
    for _ in vv.march(system, until=STEPS * STEP, step=STEP, scheme=scheme):
        pass
    return system


FLOATING = ("free", "hinged")
UNDER = [(c, s) for c in CASES for s in SCHEMES if not (c in FLOATING and isinstance(s, vv.Static))]


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(("case", "scheme"), UNDER, ids=str)
def test_solution_is_that_with_multipliers(
    case: str, solver: str, scheme: vv.Scheme, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Unknowns, the multipliers that have left among them, agree to round-off under every scheme."""
    found = run(CASES[case](), scheme, SOLVERS[solver])
    assert found.core.n_lengths > 0
    monkeypatch.setattr(Reductions, "eliminate_director", lambda *_: None)
    whole = run(CASES[case](), scheme, SOLVERS[solver])
    assert whole.core.n_lengths == 0
    apart, moves = np.abs(whole.x - found.x), whole.order > 0
    assert apart[moves].max() < 1e-11
    assert apart[~moves].max() < 1e-8 * np.abs(whole.x[~moves]).max()


@pytest.mark.parametrize("case", CASES)
def test_what_is_left_of_the_equations(case: str) -> None:
    """Each director that moves leaves one component less, and no multiplier of its length."""
    system = vv.System(CASES[case]())
    (shell,) = (c for c in system.components if isinstance(c, vv.Shell))
    fixed = np.concatenate([f.fixed for f in system.model.fields])
    directors = fixed[shell.director_unknowns(np.arange(shell.grid.n_nodes)) + np.arange(3)]
    free = (~directors).sum(axis=1)
    assert system.core.n_lengths == np.sum(free >= 1)


def test_solids_and_shells_choose_factors() -> None:
    """Multigrid knows no directors, so that nothing is chosen that needs it."""
    system = vv.System([plate(), vv.Gravity()], newton=vv.Newton(linear=vv.Automatic()))
    assert "multigrid" not in system.linear_explanation


def test_iterations_do_not_grow_as_shells_grow_thin() -> None:
    """A pinched cylinder of R/t from 100 to 1000, under loads that bend it alike."""
    counts = []
    for thickness in (1.0, 0.3, 0.1):
        angle = vv.RectangleMesh(size=(100.0, np.pi / 2), counts=(8, 8)).build()
        y, a = angle.points.T
        points = np.stack([100 * np.sin(a), y, 100 * np.cos(a)], axis=1)
        mesh = vv.Mesh(points, angle.cells, face_sets=angle.face_sets)
        section = vv.HomogeneousSection(thickness=thickness, young=3e4, poisson=0.3)
        tube = vv.Shell(mesh=mesh, section=section)
        planes = [
            vv.SymmetryPlane(solid=tube, nodes=nodes, normal=normal)
            for nodes, normal in (("x1", (0, 1, 0)), ("y0", (1, 0, 0)), ("y1", (0, 0, 1)))
        ]
        ends = vv.Fixed(solid=tube, nodes="x0", directions=(True, False, True))
        pinch = vv.Force(on=tube, at=(0, 100, 100), force=(0, 0, -60 * thickness**3), times="t")
        system = vv.System([tube, ends, *planes, pinch])
        steps = vv.march(system, until=1.0, step=0.25, scheme=vv.Static())
        counts.append(sum(report.iterations for report in steps))
    assert max(counts[1:]) <= counts[0], counts
