"""Linear buckling against the constants of stability theory: beams, frames, plates, solids, joints, contact."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import visviva as vv
from visviva.analysis.buckling import real_pairs

STIFF = 1e7
"""Of a beam of unit length and bending stiffness against shear and stretch, as not to matter."""


def line(*points: Any, count: int = 8) -> vv.LineMesh:
    return vv.LineMesh(points=list(points), count=count, cell="line3")


def factors(components: list[Any], n: int) -> np.ndarray:
    return vv.buckling(vv.System(components), n).factors


# --- columns ------------------------------------------------------------------------------------------------
def column(count: int = 16, stretch: float = STIFF, shear: float = STIFF) -> vv.Beam:
    section = vv.GivenSection(stiffness=(shear, shear, stretch, 1.0, 1.0, 1.0))
    return vv.Beam(mesh=line((0, 0, 0), (0, 0, 1), count=count), section=section, first=(1, 0, 0))


def pressed(beam: vv.Beam, times: Any = "t") -> vv.Force:
    return vv.Force(on=beam.point((0, 0, 1)), force=(0, 0, -1), times=times)


def test_column_clamped_below() -> None:
    beam = column()
    found = vv.buckling(vv.System([beam, vv.Clamped(solid=beam, nodes="start"), pressed(beam)]), 4)
    exact = np.pi**2 / 4 * np.array([1, 1, 9, 9])
    np.testing.assert_allclose(found.factors, exact, rtol=3e-4)
    shape = found.shape(beam, "node").reshape(4, -1, 12)[0]
    across = np.linalg.norm(shape[:, :2], axis=1)
    np.testing.assert_allclose(
        across / across[-1], 1 - np.cos(np.pi / 2 * np.linspace(0, 1, len(across))), atol=1e-4
    )
    assert "Beam 'beam-1'" in str(found)


def test_column_on_a_hinge_and_between_guides() -> None:
    """Hinged about y: pinned at both ends in one plane, clamped below in the other."""
    beam, ground = column(), vv.Ground()
    across = ((0, 0, 1), (1, 0, 0), (0, 1, 0))
    hinge = vv.Revolute(a=ground.frame(axes=across), b=beam.frame(0.0, axes=across))
    top = vv.Fixed(solid=beam, nodes="end", directions=(True, True, False))
    found = factors([ground, beam, hinge, top, pressed(beam)], 3)
    root = brentq(lambda a: np.tan(a) - a, 4.0, 4.6)
    np.testing.assert_allclose(found, [np.pi**2, root**2, 4 * np.pi**2], rtol=1e-3)


def test_column_between_clamps() -> None:
    beam, ground = column(), vv.Ground()
    slide = vv.Prismatic(a=ground, b=beam.frame(1.0), at=(0, 0, 1), axis=(0, 0, 1))
    found = factors([ground, beam, vv.Clamped(solid=beam, nodes="start"), slide, pressed(beam)], 2)
    np.testing.assert_allclose(found, 4 * np.pi**2, rtol=1e-3)


def test_column_converges_with_the_fourth_power_of_its_elements() -> None:
    error = []
    for count in (4, 8, 16):
        beam = column(count)
        found = factors([beam, vv.Clamped(solid=beam, nodes="start"), pressed(beam)], 3)
        error.append(found[2] / (9 * np.pi**2 / 4) - 1)
    assert np.log2(error[1] / error[2]) == pytest.approx(4, abs=0.2)
    assert error[2] < 1e-4


def test_factors_come_closer_from_close_by() -> None:
    """A column that shortens and shears much: P (1 + P / GA - P / EA) = pi^2 / 4 for Reissner's rod."""
    beam = column(16, stretch=60.0, shear=150.0)
    system = vv.System([beam, vv.Clamped(solid=beam, nodes="start"), pressed(beam)])
    exact = brentq(lambda p: p * (1 + p / 150 - p / 60) - np.pi**2 / 4, 1, 4)
    far = vv.buckling(system, 1).factors[0]
    vv.quasi_static(system, until=2.5314, step=0.63285)
    near = vv.buckling(system, 1).factors[0]
    assert near == pytest.approx(exact, rel=5e-6)
    assert abs(far - exact) > 0.1
    system.x[system.field(beam, "node").start + 12 * 8] += 0.1
    with pytest.raises(vv.InputError, match="no equilibrium"):
        vv.buckling(system)


# --- loads that have kinks, end soon, or begin with no slope ------------------------------------------------
RAMPS = [
    (1.0, [(0.0, 0.0), (9.0, 9.0)]),
    (1.0, "max(0, t)"),
    (1.0, lambda t: max(t, 0.0)),
    (10.0, [(0.0, 0.0), (1e-1, 1.0)]),
    (1e4, [(0.0, 0.0), (1e-4, 1.0)]),
    (1e4, "min(t / 1e-4, 1)"),
]


@pytest.mark.parametrize(("rate", "times"), RAMPS)
def test_column_under_a_ramp(rate: float, times: Any) -> None:
    beam = column()
    found = factors([beam, vv.Clamped(solid=beam, nodes="start"), pressed(beam, times)], 1)
    np.testing.assert_allclose(found * rate, np.pi**2 / 4, rtol=3e-4)


def test_load_that_grows_faster_from_now_on() -> None:
    beam = column()
    force = pressed(beam, [(0.0, 0.0), (1.0, 1.0), (2.0, 5.0)])
    system = vv.System([beam, vv.Clamped(solid=beam, nodes="start"), force])
    vv.quasi_static(system, until=1.0, step=0.5)
    assert vv.buckling(system, 1).factors[0] == pytest.approx(1 + (np.pi**2 / 4 - 1) / 4, rel=3e-4)


@pytest.mark.parametrize("times", ["t", "max(0, t)", [(0.0, 0.0), (2.0, 2.0)], [(0.0, 0.0), (1e-5, 1e-5)]])
def test_heated_column_between_clamps(times: Any) -> None:
    """The thrust EA alpha t reaches 4 pi^2 EI, less by shear."""
    beam = column(stretch=1e5)
    ends = [vv.Clamped(solid=beam, nodes=end) for end in ("start", "end")]
    found = factors([beam, *ends, vv.ThermalStrain(beam=beam, extension=1e-3, times=times)], 1)
    np.testing.assert_allclose(found, 4 * np.pi**2 / 100, rtol=1e-3)


def test_ring_under_pressure() -> None:
    """A narrow ring, free to bend across: 3 E I / R^3 where the pressure follows; its tangent changes with the load."""
    error = []
    for n, times in ((32, "t"), (64, [(0.0, 0.0), (9.0, 9.0)])):
        a = np.linspace(0, 2 * np.pi, n, endpoint=False)
        below = np.column_stack([np.cos(a), np.sin(a), 0 * a])
        cells = [[i, (i + 1) % n, n + (i + 1) % n, n + i] for i in range(n)]
        mesh = vv.Mesh(np.vstack([below, below + np.array([0, 0, 0.02])]), {"quad4": cells})
        section = vv.HomogeneousSection(thickness=0.01, young=1e6, poisson=POISSON)
        ring = vv.Shell(mesh=mesh, section=section)
        x, y = ring.grid.points[:, :2].T
        held = [
            vv.Fixed(solid=ring, nodes="all", directions=(False, False, True)),
            vv.Fixed(solid=ring, nodes=np.flatnonzero(np.abs(y) < 1e-9), directions=(False, True, False)),
            vv.Fixed(solid=ring, nodes=np.flatnonzero(np.abs(x) < 1e-9), directions=(True, False, False)),
        ]
        pressure = vv.Pressure(solid=ring, faces="upper", pressure=times, middle=True)
        error.append(factors([ring, *held, pressure], 1)[0] / (3 * 1e6 * 0.01**3 / 12) - 1)
    assert abs(error[1]) < 0.3 * abs(error[0]) < 0.03


@pytest.mark.parametrize("times", ["t**2", "t**3", "t**1.5", "1 - cos(t)", [(0.0, 1.0), (1.0, 1.0)]])
def test_load_that_begins_with_no_slope_is_refused(times: Any) -> None:
    beam = column()
    clamp = vv.Clamped(solid=beam, nodes="start")
    with pytest.raises(vv.InputError, match=r"no load grows.*quasi_static"):
        factors([beam, clamp, pressed(beam, times)], 1)


def test_spin_that_begins_from_rest_is_refused_and_found_from_a_state_where_it_grows() -> None:
    """A shaft clamped at one end about its own axis: K - t^2 M, along the tangent from t = 1 on."""
    section = vv.GivenSection(stiffness=(1e5, 1e5, 1e5, 1, 1, 1), mass=1.0, moments=(1e-7, 1e-7, 0))
    shaft = vv.Beam(mesh=line((0, 0, 0), (0, 0, 1)), section=section)
    frame = vv.RotatingFrame(angular_velocity=(0, 0, 1), times="t")
    system = vv.System([shaft, vv.Clamped(solid=shaft, nodes="start"), frame])
    with pytest.raises(vv.InputError, match="no load grows"):
        vv.buckling(system)
    vv.quasi_static(system, until=1.0, step=1.0)
    assert vv.buckling(system, 1).factors[0] == pytest.approx(1 + (1.8751041**4 - 1) / 2, rel=1e-3)


# --- lateral buckling ---------------------------------------------------------------------------------------
def test_right_angle_frame() -> None:
    """Outward and inward: 1.0875178 and -0.6804274 for the exact rod."""
    length, width, thick, young, shear = 240.0, 30.0, 0.6, 71240.0, 71240.0 / 2.62
    k = 32
    s = np.linspace(0, length, k + 1)
    points = [(x, 0.0, 0.0) for x in s] + [(length, -y, 0.0) for y in s[1:]]
    cells = [(2 * i, 2 * i + 2, 2 * i + 1) for i in range(k)]
    mesh = vv.Mesh(points, {"line3": cells}, node_sets={"foot": [0]})
    area, weak = width * thick, width * thick**3 / 12
    strong, torsion = thick * width**3 / 12, width * thick**3 / 3
    stiffness = (
        1e3 * young * area,
        1e3 * young * area,
        young * area,
        young * strong,
        young * weak,
        shear * torsion,
    )
    frame = vv.Beam(mesh=mesh, section=vv.GivenSection(stiffness=stiffness), first=(0, 0, 1), kinks="rigid")
    tip = vv.Force(on=frame.point((length, -length, 0)), force=(1, 0, 0), times="t")
    system = vv.System([frame, vv.Clamped(solid=frame, nodes="foot"), tip])
    exact = [-0.6804274, 1.0875178]
    np.testing.assert_allclose(
        vv.buckling(system, 2).factors, exact, rtol=1e-3
    )  # bends by 1 / 2500 of its stiffness
    vv.quasi_static(system, until=1.0, step=0.5)
    assert vv.buckling(system, 1).factors[0] == pytest.approx(exact[1], rel=2e-5)


STRIP = vv.GivenSection(stiffness=(1e8, 1e8, 1e8, 1e6, 2.0, 0.5))
"""Bending about d1 does not matter; sqrt(E I G J) = 1."""


def test_lateral_buckling_of_a_strip() -> None:
    strip = vv.Beam(mesh=line((0, 0, 0), (1, 0, 0)), section=STRIP, first=(0, 1, 0))
    tip = vv.Force(on=strip.point((1, 0, 0)), force=(0, 0, -1), times="t")
    found = factors([strip, vv.Clamped(solid=strip, nodes="start"), tip], 2)
    np.testing.assert_allclose(np.sort(found), [-4.012599343578901, 4.012599343578901], rtol=1e-4)


def on_forks(strip: vv.Beam) -> list[Any]:
    """Supports at both ends of a strip along x, which may turn but not twist."""
    ground = vv.Ground()
    upright = [
        vv.PointOnPlane(
            a=ground.frame((x, 0, 0), axes=((1, 0, 0), (0, 0, 1), (0, -1, 0))), b=strip.point((x, 0, 1))
        )
        for x in (0, 1)
    ]
    guided = vv.Fixed(solid=strip, nodes="end", directions=(False, True, True))
    return [ground, strip, vv.Fixed(solid=strip, nodes="start"), guided, *upright]


def test_lateral_buckling_under_uniform_moment() -> None:
    """Ends that do not twist, under couples of dead forces."""
    strip = vv.Beam(mesh=line((0, 0, 0), (1, 0, 0)), section=STRIP, first=(0, 1, 0))
    couples = [
        vv.Force(on=strip.point((x, 0, z)), force=(sign, 0, 0), times="t")
        for x, z, sign in ((0, 0.5, -1), (0, -0.5, 1), (1, 0.5, 1), (1, -0.5, -1))
    ]
    found = factors([*on_forks(strip), *couples], 2)
    np.testing.assert_allclose(np.abs(found), np.pi, rtol=3e-4)


def test_lateral_buckling_under_a_load_in_the_middle() -> None:
    strip = vv.Beam(mesh=line((0, 0, 0), (1, 0, 0), count=16), section=STRIP, first=(0, 1, 0))
    load = vv.Force(on=strip.point((0.5, 0, 0)), force=(0, 0, -1), times="t")
    np.testing.assert_allclose(np.abs(factors([*on_forks(strip), load], 2)), 16.9361321504659, rtol=3e-4)


# --- plates and solids --------------------------------------------------------------------------------------
THICK, POISSON = 0.005, 0.3
PLATE = np.pi**2 / (12 * (1 - POISSON**2)) * THICK**2
"""Times the constant k it is the critical stress of a plate of unit width, by Young's modulus."""


def plate(count: int) -> tuple[vv.Shell, vv.Fixed]:
    mesh = vv.RectangleMesh(size=(1, 1), counts=(count, count))
    sheet = vv.Shell(mesh=mesh, section=vv.HomogeneousSection(thickness=THICK, young=1.0, poisson=POISSON))
    x, y = sheet.grid.points[:, :2].T
    rim = np.flatnonzero((x * (1 - x) * y * (1 - y)) < 1e-9)
    return sheet, vv.Fixed(solid=sheet, nodes=rim, directions=(False, False, True))


def test_plate_in_compression() -> None:
    """Simply supported at all edges, k = 4; the edges come together by t."""
    error = []
    for count in (8, 16):
        sheet, rim = plate(count)
        left = vv.Fixed(solid=sheet, nodes="x0", directions=(True, False, False))
        corner = vv.Fixed(solid=sheet, nodes="y0", directions=(False, True, False))
        push = vv.Prescribed(solid=sheet, nodes="x1", motion=("-t", None, None))
        (found,) = factors([sheet, rim, left, corner, push], 1)
        error.append(found / (4 * PLATE) - 1)
    assert 0 < error[1] < 0.3 * error[0] < 0.02


def squeezed(count: int, n: int) -> np.ndarray:
    """Factors of a simply supported plate whose edges all come together by t, beside `PLATE`."""
    sheet, rim = plate(count)
    left = vv.Fixed(solid=sheet, nodes="x0", directions=(True, False, False))
    front = vv.Fixed(solid=sheet, nodes="y0", directions=(False, True, False))
    push = vv.Prescribed(solid=sheet, nodes="x1", motion=("-t", None, None))
    shove = vv.Prescribed(solid=sheet, nodes="y1", motion=(None, "-t", None))
    return factors([sheet, rim, left, front, push, shove], n) / (PLATE * (1 - POISSON))


@pytest.mark.parametrize("missed", [None, 1, 2, 4])
def test_double_factors_of_a_square_plate(missed: int | None, monkeypatch: pytest.MonkeyPatch) -> None:
    """Under equal compression k = i^2 + j^2, so that most stand twice; also where Krylov's space leaves one out."""
    import scipy.sparse.linalg as spl

    eigs = spl.eigs

    def forgetful(*args: Any, k: int, **options: Any) -> Any:
        values, z = eigs(*args, k=k, **options)
        left = np.argsort(-np.abs(values))
        left = left if missed is None or k < 10 else np.delete(left, missed)
        return values[left], z[:, left]

    monkeypatch.setattr(spl, "eigs", forgetful)
    found = squeezed(16, 6)
    np.testing.assert_allclose(found, [2, 5, 5, 8, 10, 10], rtol=0.06)
    np.testing.assert_allclose(found[[1, 4]], found[[2, 5]], rtol=1e-6)


def test_pairs_of_rounding_are_two_vectors() -> None:
    """Rounding makes a conjugate pair of a double eigenvalue: its plane is that of both parts, and is kept."""
    A = np.array([[2.0, 1e-12, 0.0], [-1e-12, 2.0, 0.0], [0.0, 0.0, 1.0]])
    values, vectors = np.linalg.eig(A)
    assert np.iscomplexobj(values)
    found = real_pairs(values, vectors)[1]
    assert np.linalg.matrix_rank(found) == 3
    np.testing.assert_allclose(A @ found, found * values.real, atol=1e-11)


def test_plate_in_shear() -> None:
    """Simply supported at all edges, k = 9.3247 (Stein & Neff 1947), in the stress G t of a shear strain t."""
    error = []
    for count in (8, 16):
        sheet, edges = plate(count)
        shear = vv.Prescribed(solid=sheet, nodes=edges.nodes, motion=lambda t, X: t * X[:, [1, 2, 2]])
        found = factors([sheet, shear], 2)
        np.testing.assert_allclose(np.abs(found), np.abs(found[0]), rtol=1e-6)
        error.append(abs(found[0]) / (9.3247 * PLATE * 2 * (1 + POISSON)) - 1)
    assert 0 < error[1] < 0.3 * error[0]
    assert error[1] < 0.035


def test_solid_column() -> None:
    """Engesser's column, with shear: 1 / P = 1 / P_Euler + 1 / (5/6 G A)."""
    mesh = vv.BoxMesh(size=(1, 0.8, 12), counts=(1, 1, 8), cell="hex20")
    rod = vv.Solid(mesh=mesh, material=vv.SaintVenantKirchhoff(young=1e3, poisson=0.0))
    foot = vv.Fixed(solid=rod, nodes="z0")
    press = vv.Traction(solid=rod, faces="z1", traction=(0, 0, -1 / 0.8), times="t")
    found = factors([rod, foot, press], 1)
    euler = np.pi**2 / 4 * 1e3 * (0.8**3 / 12) / 144
    assert found[0] == pytest.approx(1 / (1 / euler + 1 / (5 / 6 * 500 * 0.8)), rel=3e-3)


# --- contact, refusals, pictures ----------------------------------------------------------------------------
def test_box_that_a_weight_rocks_over_on_its_contacts() -> None:
    """Four corners on springs k: k = P / 2 + (P + W) / 2, by the weight on top and by the contacts below."""
    ground, plane, k = vv.Ground(), vv.Plane(), 1e3
    box = vv.RigidBody(shape=vv.Box(size=(1, 1, 1)), density=1.0, position=(0, 0, 0.5))
    contact = vv.Contact(first=box, second=plane, stiffness=k, enforcement="penalty")
    hold = vv.Bushing(
        a=ground, b=box, at=(0, 0, 0.5), stiffness=(1e5, 1e5, 0), rotational_stiffness=(0, 0, 1e5)
    )
    press = vv.Force(on=box, at=(0, 0, 1), force=(0, 0, -1), times="t")
    system = vv.System([ground, plane, box, contact, hold, press, vv.Gravity()])
    vv.equilibrium(system)
    assert vv.buckling(system, 1).factors[0] == pytest.approx(k - 9.81 / 2, rel=1e-4)


def test_what_is_refused() -> None:
    beam = column()
    clamp = vv.Clamped(solid=beam, nodes="start")
    with pytest.raises(vv.InputError, match="no load grows"):
        factors([beam, clamp, vv.Force(on=beam.point((0, 0, 1)), force=(0, 0, 0))], 1)
    follower = vv.FollowerForce(on=beam.frame(1.0), force=(0, 0, -1), times="t")
    with pytest.raises(vv.InputError, match="not symmetric"):
        factors([beam, clamp, follower], 1)
    with pytest.raises(vv.InputError, match="nothing holds"):
        factors([beam, pressed(beam)], 1)
    with pytest.raises(vv.InputError, match="n = 0"):
        factors([beam, clamp, pressed(beam)], 0)


def test_modes_are_drawn(tmp_path: Path) -> None:
    beam = column()
    found = vv.buckling(vv.System([beam, vv.Clamped(solid=beam, nodes="start"), pressed(beam)]), 1)
    found.picture(tmp_path / "mode.png")
    assert (tmp_path / "mode.png").stat().st_size > 1000
    with pytest.raises(vv.InputError, match="no shape 3"):
        found.picture(tmp_path / "mode.png", 3)


def test_a_wire_whose_bending_is_rounding_is_told_so() -> None:
    """It was to be held, which it is."""
    wire = vv.Beam(
        mesh=vv.LineMesh(points=[(0, 0, 0), (1, 0, 0)], count=8),
        section=vv.RectangleSection(width=1e-6, height=2e-6, young=2e11, density=7800.0),
        name="wire",
    )
    press = vv.Force(on=wire.point_at((1, 0, 0)), force=(-1e-13, 0, 0), times="t")
    system = vv.System([wire, vv.Clamped(solid=wire, nodes="start"), press])
    with pytest.raises(
        vv.InputError, match=r"of Beam 'wire'; bodies are held as a whole.*make it thicker or shorter"
    ):
        vv.buckling(system, n=1)
