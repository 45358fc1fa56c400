"""Paths through limit points: a truss of two springs in closed form, a shallow arch, an inflated sphere."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import visviva as vv
from verification.shell_cases import corner, part_of_cylinder
from verification.solids import Array, displacement
from visviva.examples import snap_roof

DATA = Path(__file__).parents[1] / "data"

# --- von Mises truss ----------------------------------------------------------------------------------------
HALF, RISE, STIFFNESS = 1.0, 0.4, 100.0
LENGTH = float(np.hypot(HALF, RISE))


def truss() -> tuple[vv.System, vv.PointMass]:
    """Two springs from (-1, 0) and (1, 0) meet at (0, 0.4); a force t pulls down."""
    ground, tip = vv.Ground(), vv.PointMass(mass=1.0, position=(0, RISE, 0))
    springs = [
        vv.Spring(a=ground.point((x, 0, 0)), b=tip.point(), stiffness=STIFFNESS, free_length=LENGTH)
        for x in (-HALF, HALF)
    ]
    guide = vv.PointOnLine(a=ground.frame(axes=((0, 0, 1), (1, 0, 0), (0, 1, 0))), b=tip.point())
    pull = vv.Force(on=tip.point(), force=(0, -1, 0), times="t")
    return vv.System([ground, tip, *springs, guide, pull]), tip


def truss_load(y: Array) -> Array:
    """Force at the height y: 2 k (l0/l - 1) y."""
    return np.asarray(2 * STIFFNESS * (LENGTH / np.hypot(HALF, y) - 1) * y)


@pytest.mark.parametrize("weight", [0.0, 0.1])
def test_von_mises_truss(weight: float) -> None:
    """Every point of the path lies on the closed form, over both limit points and beyond."""
    system, tip = truss()
    limit = float(np.sqrt((LENGTH * HALF**2) ** (2 / 3) - HALF**2))  # dF/dy = 0
    top = float(truss_load(np.array(limit)))
    result = vv.arc_length(
        system,
        step=0.05 * top,
        steps=400,
        scheme=vv.ArcLength(load_weight=weight, longest=1.0),
        stop=lambda s: s.value(tip.point().position)[1] < -1.3 * RISE,
    )
    y, load = result.history(tip.point().position)[:, 1], np.array(result.times)
    np.testing.assert_allclose(load, truss_load(y), atol=1e-8 * top)
    inside = np.abs(y) <= RISE
    assert load[inside].max() == pytest.approx(top, rel=0.02)
    assert load[inside].min() == pytest.approx(-top, rel=0.02)
    assert y[-1] < -1.3 * RISE
    assert np.all(np.diff(y) < 0)


def test_load_steps_stop_at_the_limit_point() -> None:
    """Without arc length the last equilibrium lies before the limit point or, after a jump, on the far branch."""
    system, tip = truss()
    top = float(truss_load(np.array(np.sqrt((LENGTH * HALF**2) ** (2 / 3) - HALF**2))))
    try:
        vv.quasi_static(system, until=1.2 * top, step=0.1 * top)
    except vv.RunError:
        assert system.time <= top
    else:
        assert system.value(tip.point().position)[1] < -RISE


# --- deep arch ----------------------------------------------------------------------------------------------
RADIUS, EI = 100.0, 1e6


def arch(n: int) -> tuple[vv.Solid, int, vv.System]:
    """An arch of 215 degrees and thickness 1, clamped and hinged, pushed down at its crown."""
    flat = vv.RectangleMesh(size=(1, 1), counts=(n, 1), cell="quad9").build()
    half = np.radians(215 / 2)
    angle, r = np.pi / 2 + half - 2 * half * flat.points[:, 0], RADIUS - 0.5 + flat.points[:, 1]
    mesh = vv.Mesh(
        np.column_stack([r * np.cos(angle), r * np.sin(angle)]), flat.cells, face_sets=flat.face_sets
    )
    solid = vv.Solid(mesh=mesh, material=vv.SaintVenantKirchhoff(young=12 * EI, poisson=0.0))
    places = np.array([[np.cos(np.pi / 2 - half), np.sin(np.pi / 2 - half), 0], [0, 1, 0]]) * RADIUS
    hinge, crown = (int(np.argmin(np.linalg.norm(solid.points - p, axis=1))) for p in places)
    parts = [
        vv.Fixed(solid=solid, nodes="x0"),
        vv.Fixed(solid=solid, nodes=[hinge]),
        vv.Force(on=solid, at=places[1], force=(0, -1, 0), times="t"),
    ]
    return solid, crown, vv.System([solid, *parts])


def test_deep_arch_buckles() -> None:
    """DaDeppo & Schmidt (1975): inextensible, limit load 8.97 E I / R^2, crown down by 1.14 R and aside by 0.61 R."""
    solid, crown, system = arch(160)
    result = vv.arc_length(
        system,
        step=60.0,
        scheme=vv.ArcLength(longest=3.0),
        stop=lambda s: solid.displacements(s.x)[crown, 1] < -1.16 * RADIUS,
    )
    load = np.array(result.times)
    peak = int(np.argmax(load))
    assert 0 < peak < len(load) - 1
    assert load[peak] == pytest.approx(8.97 * EI / RADIUS**2, rel=5e-3)
    assert solid.displacements(result.states[peak])[crown, :2] == pytest.approx([61.0, -114.0], abs=0.7)


def test_path_does_not_turn_back() -> None:
    """From too long a first step the iteration would find the part of the path that it came along."""
    solid, crown, system = arch(80)
    result = vv.arc_length(system, step=100.0, steps=12, scheme=vv.ArcLength(longest=1.0))
    down = [solid.displacements(x)[crown, 1] for x in result.states]
    assert np.all(np.diff(down) < 0)
    assert np.all(np.diff(result.times) > 0)


# --- inflated sphere ----------------------------------------------------------------------------------------
def test_sphere_of_rubber_gives_way() -> None:
    """Incompressible neo-Hooke, radii 1 and 2: limit pressure 0.8164236 mu at the inner stretch 1.82815."""
    flat = vv.RectangleMesh(size=(1, 1), counts=(8, 4), cell="quad9").build()
    r, phi = 1 + flat.points[:, 0], np.pi / 2 * flat.points[:, 1]
    places = np.column_stack([r * np.cos(phi), r * np.sin(phi)])
    places[np.abs(places) < 1e-14] = 0.0
    mesh = vv.Mesh(places, flat.cells, face_sets=flat.face_sets)
    rubber = vv.NeoHooke(shear=1.0, bulk=1000.0, isochoric=True)
    solid = vv.Solid(mesh=mesh, material=rubber, plane="axisymmetric")
    planes = [
        vv.SymmetryPlane(solid=solid, nodes=s, normal=n) for s, n in (("y0", (0, 1, 0)), ("y1", (1, 0, 0)))
    ]
    system = vv.System([solid, *planes, vv.Pressure(solid=solid, faces="x0", pressure="t")])
    stretch = [1.0]

    def far(s: vv.System) -> bool:
        stretch.append(1 + float(displacement(s, solid, (1, 0))[0]))
        return stretch[-1] > 2.4

    pressure = np.array(vv.arc_length(system, step=0.2, scheme=vv.ArcLength(longest=2.0), stop=far).times)
    peak = int(np.argmax(pressure))
    assert pressure[-1] < 0.95 * pressure[peak]
    near = slice(peak - 2, peak + 3)
    curve = np.polynomial.Polynomial.fit(stretch[near], pressure[near], 4)
    fine = np.linspace(stretch[peak - 1], stretch[peak + 1], 2001)
    assert curve(fine).max() == pytest.approx(0.8164236, rel=2e-3)
    assert fine[np.argmax(curve(fine))] == pytest.approx(1.82815, rel=3e-3)


# --- hinged roof --------------------------------------------------------------------------------------------
@pytest.mark.parametrize(("case", "plies"), [("a", "isotropic"), ("b", "0/90/0"), ("c", "90/0/90")])
def test_hinged_roof(case: str, plies: snap_roof.Plies) -> None:
    """The whole path beyond both limit loads: Sze, Liu & Lo (2004), 3.8; 2 % of the load here, 1 % with 16 x 16."""
    study = snap_roof.study(8, plies)
    result = vv.simulate(study.system, until=study.until, step=study.step, scheme=study.scheme)
    snap_roof.check(result)
    (deflection,) = study.probes.values()
    table = np.genfromtxt(DATA / f"sze2004_3_8{case}_hinged_roof.csv", delimiter=",", comments="#")
    table = table[np.isfinite(table[:, 0])]
    height = result.history(deflection.of.point_at(deflection.at).position)[:, 2]
    down = height[0] - height
    assert np.all(np.diff(down) > 0)
    inside = table[:, 0] < 1.0
    found = np.interp(table[inside, 1], down, result.times)
    np.testing.assert_allclose(found, table[inside, 0], atol=0.02)


def test_half_cylinder_of_plies_folds_over() -> None:
    """Down by 180 of a radius of 101.6: Sze, Liu & Lo (2004), 3.7, plies 0/90/0; 1 % of the full load."""
    mesh = part_of_cylinder(101.6, 304.8, np.pi / 2, 24)
    elastic = {"thickness": 1.0, "young": 2068.5, "across": 517.125, "poisson": 0.3, "shear": 795.6}
    plies = tuple(vv.Ply(angle=angle, **elastic) for angle in (0, 90, 0))
    shell = vv.Shell(mesh=mesh, section=vv.Laminate(plies=plies), first=(0, 1, 0))
    sides = [
        vv.SymmetryPlane(solid=shell, nodes=np.setdiff1d(shell.nodes(edge), shell.nodes("x0")), normal=normal)
        for edge, normal in (("y0", (1, 0, 0)), ("y1", (0, 0, 1)))
    ]
    top = corner(shell, "x1", "y0")
    load = vv.Force(on=shell.point(shell.points[top]), force=(0, 0, -1000.0), times="t")
    system = vv.System([shell, vv.Clamped(solid=shell, nodes="x0"), *sides, load])
    result = vv.arc_length(system, step=0.02, until=0.5, scheme=vv.ArcLength(longest=1.5))
    down = [-shell.displacements(x)[top, 2] for x in result.states]
    assert np.all(np.diff(down) > 0)
    table = ((0.1, 37.92), (0.15, 93.433), (0.2, 141.562), (0.3, 162.896), (0.5, 180.68))
    for share, deflection in table:
        assert np.interp(deflection, down, result.times) == pytest.approx(share, abs=0.01)
