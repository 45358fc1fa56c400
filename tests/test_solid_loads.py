"""What acts on solids and holds them, against resultants, closed forms, works and other formulations."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from catalogue.rigid import turned
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]

SIZE = (1.0, 0.8, 0.6)
CELLS = ("tet4", "tet10", "hex8", "hex20", "hex27", "wedge6")
SOFT = vv.NeoHooke(young=60.0, poisson=0.3)
FAINT = vv.NeoHooke(young=1e-6, poisson=0.3)
"""Leaves the loads alone to be seen."""


def brick(cell: str = "hex8", counts: tuple[int, int, int] = (2, 2, 2), **options: Any) -> vv.Solid:
    given = {"material": SOFT, "density": 1.3} | options
    return vv.Solid(mesh=vv.BoxMesh(size=SIZE, counts=counts, cell=cell), **given)


def forces(solid: vv.Solid, *loads: Any, x: Array | None = None, time: float = 0.0) -> Array:
    """Forces (n, 3) of loads on the nodes at positions `x` (n, d), the elements' own taken away."""
    system = vv.System([solid, *loads])
    if x is not None:
        system.x[: x.size] = x.ravel()
        system.invalidate()
    residual = system.residual(vv.Static().step(time, 0.0))
    return -solid.carriers.vectors(residual) - solid.nodal_forces(system.x)


def bent(solid: vv.Solid, size: float = 0.05) -> Array:
    """Positions (n, d) of the nodes, pushed about at random."""
    return solid.grid.points + size * np.random.default_rng(4).standard_normal(solid.grid.points.shape)


def moment(x: Array, f: Array) -> Array:
    return np.cross(x, f).sum(axis=0)


# --- dead loads: resultants -----------------------------------------------------------------------------------
@pytest.mark.parametrize("cell", CELLS)
def test_traction_has_its_resultant_and_moment(cell: str) -> None:
    block, t = brick(cell, material=FAINT), np.array([2.0, -1.0, 0.5])
    f = forces(block, vv.Traction(solid=block, faces="x1", traction=t, times=lambda t: 1 + t), time=2.0)
    area, centre = SIZE[1] * SIZE[2], np.array([SIZE[0], SIZE[1] / 2, SIZE[2] / 2])
    assert f.sum(axis=0) == pytest.approx(3 * area * t, rel=1e-13)
    assert moment(block.points, f) == pytest.approx(np.cross(centre, 3 * area * t), rel=1e-13)
    assert np.abs(f[block.points[:, 0] < SIZE[0] - 1e-9]).max() < 1e-20


@pytest.mark.parametrize("cell", CELLS)
def test_traction_of_place_is_integrated_exactly(cell: str) -> None:
    """``f_z = (1 + t) y`` on z = c, and its moment, which is one degree higher."""
    a, b, _ = SIZE
    block = brick(cell)

    def traction(t: float, X: Array) -> Array:
        return (1 + t) * X[:, [1]] * np.array([[0.0, 0.0, 1.0]])

    f = forces(block, vv.Traction(solid=block, faces="z1", traction=traction), time=0.5)
    assert f[:, 2].sum() == pytest.approx(1.5 * a * b**2 / 2, rel=1e-13)
    assert moment(block.points, f)[0] == pytest.approx(1.5 * a * b**3 / 3, rel=1e-13)


@pytest.mark.parametrize("cell", CELLS)
def test_body_force_has_its_resultant(cell: str) -> None:
    """Centrifugal forces ``w^2 (x, y, 0)``: resultant, and the moment about y."""
    a, b, c = SIZE
    block = brick(cell)
    f = forces(block, vv.BodyForce(solid=block, force=lambda t, X: 4.0 * X * (1, 1, 0)))
    assert f.sum(axis=0) == pytest.approx([2 * a**2 * b * c, 2 * a * b**2 * c, 0.0], rel=1e-13)
    assert moment(block.points, f)[1] == pytest.approx(4 * a**2 / 2 * b * c**2 / 2, rel=1e-13)


def test_body_force_of_the_weight_is_gravity() -> None:
    """Another formulation: the potential of gravity by the mass matrix."""
    moved = []
    for weight in (
        lambda b: vv.Gravity(acceleration=(0, 1, -9)),
        lambda b: vv.BodyForce(solid=b, force=(0, 1.3, -9 * 1.3)),
    ):
        block = brick("tet10", (1, 1, 1))
        system = vv.System([block, vv.Fixed(solid=block, nodes="x0"), weight(block)])
        vv.simulate(system, until=0.2, step=0.02)
        moved.append(system.x.copy())
    assert np.abs(moved[0] - moved[1]).max() < 1e-12
    assert np.abs(moved[0] - system.model.initial[0]).max() > 1e-2


PLANES: dict[str, Any] = {
    "strain": {"plane": "strain", "thickness": 0.3},
    "axisymmetric": {"plane": "axisymmetric"},
}


@pytest.mark.parametrize("plane", ["strain", "axisymmetric"])
def test_loads_on_plane_solids(plane: Any) -> None:
    """Forces of the thickness, or of the whole revolution."""
    mesh = vv.RectangleMesh(size=(1.0, 0.8), counts=(2, 2), cell="quad8").build().moved((0.5, 0.0))
    plate = vv.Solid(mesh=mesh, material=SOFT, **PLANES[plane])
    area = 0.3 * 1.0 if plane == "strain" else np.pi * (1.5**2 - 0.5**2)
    volume = 0.8 * area
    up = (0.0, 2.0, 0.0)
    assert forces(plate, vv.Traction(solid=plate, faces="y1", traction=up))[:, 1].sum() == pytest.approx(
        2 * area
    )
    plate = vv.Solid(mesh=mesh, material=SOFT, **PLANES[plane])
    assert forces(plate, vv.BodyForce(solid=plate, force=up))[:, 1].sum() == pytest.approx(2 * volume)
    for follower in (True, False):
        plate = vv.Solid(mesh=mesh, material=SOFT, **PLANES[plane])
        push = vv.Pressure(solid=plate, faces="y1", pressure=2.0, follower=follower)
        assert forces(plate, push)[:, 1].sum() == pytest.approx(-2 * area)


def test_work_of_a_dead_traction() -> None:
    """The ledger's work is force times the mean displacement of the face, by Simpson's rule on its nodes."""
    block = brick("hex20", (1, 1, 1))
    pull = vv.Traction(solid=block, faces="x1", traction=(3.0, 1.0, 0.0))
    system = vv.System([block, vv.Fixed(solid=block, nodes="x0"), pull])
    result = vv.simulate(system, until=0.5, step=0.02)
    u, face = block.displacements(system.x), block.nodes("x1")
    X = block.points[face]
    middle = (np.isclose(X[:, 1], SIZE[1] / 2) | np.isclose(X[:, 2], SIZE[2] / 2)).astype(float)
    mean = (middle / 3 - (1 - middle) / 12) @ u[face]  # of the serendipity functions of a square
    assert result.ledger["work_traction"][-1] == pytest.approx(
        SIZE[1] * SIZE[2] * (mean @ (3, 1, 0)), rel=1e-12
    )


# --- pressure -------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("cell", CELLS)
def test_pressure_follows_rotation_and_stretch_or_does_not(cell: str) -> None:
    p, R, stretch = 2.5, turned(3), np.diag([1.0, 1.2, 0.9])
    F = R @ stretch
    block = brick(cell, material=FAINT)
    x = block.points @ F.T
    area = SIZE[1] * SIZE[2]
    dead = forces(block, vv.Pressure(solid=block, faces="x1", pressure=p, follower=False), x=x)
    assert dead.sum(axis=0) == pytest.approx([-p * area, 0, 0], rel=1e-12)
    block = brick(cell, material=FAINT)
    with_it = forces(block, vv.Pressure(solid=block, faces="x1", pressure=p), x=x)
    normal = R @ (1.0, 0.0, 0.0)
    centre = F @ (SIZE[0], SIZE[1] / 2, SIZE[2] / 2)
    assert with_it.sum(axis=0) == pytest.approx(-p * area * 1.2 * 0.9 * normal, rel=1e-12)
    assert moment(x, with_it) == pytest.approx(np.cross(centre, -p * area * 1.2 * 0.9 * normal), rel=1e-11)


@pytest.mark.parametrize("cell", CELLS)
def test_pressure_all_around_has_no_resultant(cell: str) -> None:
    block = brick(cell, material=FAINT)
    x = bent(block)
    f = forces(block, vv.Pressure(solid=block, faces="all", pressure=2.0), x=x)
    assert np.abs(f).max() > 0.01
    assert np.abs(f.sum(axis=0)).max() < 1e-14 * np.abs(f).sum()
    assert np.abs(moment(x, f)).max() < 1e-13 * np.abs(f).sum()


def volume_work(plane: Any, scheme: vv.Scheme, step: float) -> tuple[float, float]:
    """Work of a constant pressure by the ledger, and ``-p (V1 - V0)`` from the elements' Jacobians."""
    if plane is None:
        block = brick("hex8", (1, 2, 1), angular_velocity=(1.0, -0.5, 0.8))
    else:
        mesh = vv.RectangleMesh(size=(1.0, 0.8), counts=(2, 1), cell="quad4").build().moved((0.5, 0.0))
        block = vv.Solid(mesh=mesh, material=SOFT, density=1.3, **PLANES[plane])
    system = vv.System([block, vv.Pressure(solid=block, faces="all", pressure=9.0)])

    def volume() -> float:
        return float(
            np.concatenate([v.ravel() for v in block.volumes]) @ block.at_points("J", system.x)[:, 0]
        )

    before = volume()
    result = vv.simulate(system, until=0.1, step=step, scheme=scheme)
    assert abs(volume() - before) > 0.01 * before
    return float(result.ledger["work_pressure"][-1]), -9.0 * (volume() - before)


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.Midpoint()], ids=str)
def test_work_of_a_constant_pressure_is_that_of_the_area_in_the_plane(scheme: vv.Scheme) -> None:
    work, expected = volume_work("strain", scheme, 0.05)
    assert work == pytest.approx(expected, rel=1e-11)


@pytest.mark.parametrize("plane", [None, "axisymmetric"])
def test_work_of_a_constant_pressure_is_that_of_the_volume_to_second_order(plane: Any) -> None:
    """Volumes are cubic; what keeps the momenta of a body under pressure cannot be exact here as well."""
    errors = []
    for step in (1 / 640, 1 / 1280, 1 / 2560):
        work, expected = volume_work(plane, vv.EnergyMomentum(), step)
        errors.append(abs(work / expected - 1))
    assert errors[0] < 1e-5
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx(2, abs=0.1)


def test_pressure_in_a_thick_tube() -> None:
    """Lame's tube in plane strain: the radial displacement inside; finite strains are 1e-4 of it."""
    a, b, p, E, nu = 1.0, 2.0, 1e-3, 10.0, 0.3
    tube = vv.RectangleMesh(size=(b - a, 0.5), counts=(12, 1), cell="quad8").build().moved((a, 0.0))
    ring = vv.Solid(mesh=tube, material=vv.SaintVenantKirchhoff(young=E, poisson=nu), plane="axisymmetric")
    held = vv.Fixed(solid=ring, nodes="all", directions=(False, True, False))
    system = vv.System([ring, held, vv.Pressure(solid=ring, faces="x0", pressure=lambda t: p * t)])
    vv.quasi_static(system, until=1.0, step=1.0)
    expected = (1 + nu) * p * a**2 / (E * (b**2 - a**2)) * ((1 - 2 * nu) * a + b**2 / a)  # Lame, plane strain
    u = ring.displacements(system.x)[ring.nodes("x0"), 0]
    assert u == pytest.approx(expected, rel=1e-3)


# --- foundation -----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("cell", CELLS)
def test_foundation_energy_and_resultant(cell: str) -> None:
    """A rigid shift by u: ``(k_n u_n^2 + k_t u_t^2) A / 2``, and the force that belongs to it."""
    u, area = np.array([0.02, -0.03, 0.05]), SIZE[0] * SIZE[1]
    block = brick(cell)
    bed = vv.ElasticFoundation(solid=block, faces="z0", normal=30.0, tangential=12.0)
    f = forces(block, bed, x=block.points + u)
    assert f.sum(axis=0) == pytest.approx(-area * np.array([12, 12, 30]) * u, rel=1e-11)
    system = vv.System(
        [block := brick(cell), vv.ElasticFoundation(solid=block, faces="z0", normal=30.0, tangential=12.0)]
    )
    system.x[:] = (block.points + u).ravel()
    system.invalidate()
    system.evaluate_ledger()
    expected = 0.5 * area * (12 * u[0] ** 2 + 12 * u[1] ** 2 + 30 * u[2] ** 2)
    assert system.core.energy.sum() == pytest.approx(expected, rel=1e-9)


def test_foundation_under_a_column() -> None:
    """Bed and column in series, without lateral contraction: ``u = p / k + p h / E`` at the top."""
    column = vv.Solid(
        mesh=vv.BoxMesh(size=SIZE, counts=(1, 1, 2)), material=vv.LinearElastic(young=50.0, poisson=0.0)
    )
    bed = vv.ElasticFoundation(solid=column, faces="z0", normal=20.0, tangential=5.0)
    system = vv.System([column, bed, vv.Traction(solid=column, faces="z1", traction=(0, 0, -3), times="t")])
    vv.quasi_static(system, until=1.0, step=0.5)
    u = column.displacements(system.x)[:, 2]
    assert u[column.nodes("z0")] == pytest.approx(-3 / 20, rel=1e-9)
    assert u[column.nodes("z1")] == pytest.approx(-3 / 20 - 3 * SIZE[2] / 50, rel=1e-9)


def test_foundation_damping_slows_as_the_midpoint_rule_has_it() -> None:
    """On all faces of a single brick a shift stays one: ``m v' = -c A v``."""
    block = brick(counts=(1, 1, 1), velocity=(0.4, 0.0, 0.0))
    bed = vv.ElasticFoundation(solid=block, faces="all", damping=0.9)
    system = vv.System([block, bed])
    result = vv.simulate(system, until=0.5, step=0.05)
    a, b, c = SIZE
    rate = 0.9 * 2 * (a * b + b * c + c * a) / block.mass
    v = 0.4 * ((1 - 0.025 * rate) / (1 + 0.025 * rate)) ** 10
    assert block.velocities(system.x, system.v)[:, 0] == pytest.approx(v, rel=1e-9)
    lost = result.ledger["work_damper"][-1]
    assert lost == pytest.approx(result.ledger["total"][-1] - 0.5 * block.mass * 0.16, rel=1e-10)


# --- forces at points -----------------------------------------------------------------------------------------
def test_force_on_a_node_is_there_alone() -> None:
    block = brick(material=FAINT)
    k = int(np.argmax(block.points.sum(axis=1)))
    f = forces(block, vv.Force(on=block, at=SIZE, force=(1, 2, 3)))
    assert f[k] == pytest.approx([1, 2, 3], rel=1e-14)
    assert np.abs(np.delete(f, k, axis=0)).max() < 1e-20


@pytest.mark.parametrize("cell", CELLS)
def test_force_inside_has_its_resultant_and_moment(cell: str) -> None:
    block, place, force = (
        brick(cell, material=FAINT),
        np.array([0.37, 0.21, 0.44]),
        np.array([1.0, 2.0, -3.0]),
    )
    f = forces(block, vv.Force(on=block.point(place), force=force))
    assert f.sum(axis=0) == pytest.approx(force, rel=1e-13)
    assert moment(block.points, f) == pytest.approx(np.cross(place, force), rel=1e-12)


# --- prescribed motion and supports ---------------------------------------------------------------------------
def shear(t: float, X: Array) -> Array:
    return t * X @ np.array([[0.05, 0.02, 0.0], [0.1, -0.04, 0.03], [0.0, 0.05, 0.06]])


@pytest.mark.parametrize("cell", ["tet10", "hex8", "hex20"])
def test_prescribed_homogeneous_deformation_reaches_the_inside(cell: str) -> None:
    block = brick(cell, (2, 2, 2))
    outside = np.unique(np.concatenate([block.nodes(f"{axis}{end}") for axis in "xyz" for end in "01"]))
    system = vv.System([block, vv.Prescribed(solid=block, nodes=outside, motion=shear)])
    vv.quasi_static(system, until=1.0, step=0.5)
    assert len(outside) < len(block.points)
    assert np.abs(block.displacements(system.x) - shear(1.0, block.points)).max() < 1e-12


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.Midpoint()], ids=str)
def test_work_of_prescribed_motion_is_force_times_way(scheme: vv.Scheme) -> None:
    """Summed step by step from the mean forces of the steps on the nodes."""
    block = brick(counts=(2, 1, 1))
    motion = (lambda t: 0.2 * np.sin(4 * t), None, "0.1*t**2")
    moved = vv.Prescribed(solid=block, nodes="x0", motion=motion)
    system = vv.System([block, moved])
    work, last = 0.0, np.zeros(3)

    def watch(system: vv.System) -> None:
        nonlocal work, last
        now = np.array([0.2 * np.sin(4 * system.time), 0.0, 0.1 * system.time**2])
        held = block.carriers.vectors(system.holding_forces())[block.nodes("x0")].sum(axis=0)
        work, last = work + held @ (now - last), now

    result = vv.simulate(system, until=0.6, step=0.02, scheme=scheme, observe=watch)
    assert abs(work) > 0.1
    assert result.ledger["work_prescribed motion"][-1] == pytest.approx(work, rel=1e-12)
    if scheme == vv.EnergyMomentum():
        assert result.ledger.imbalance() < 1e-10


def test_symmetry_planes_stand_for_the_other_half() -> None:
    """An eighth of a brick pulled along x moves as the whole does."""

    def pulled(lower: float, counts: int) -> tuple[vv.Solid, list[Any]]:
        mesh = vv.BoxMesh(size=(1 - lower,) * 3, counts=(counts,) * 3).build().moved((lower,) * 3)
        block = vv.Solid(mesh=mesh, material=SOFT)
        return block, [
            vv.Traction(solid=block, faces="x1", traction=lambda t, X: t * 8 * X[:, [1]] ** 2 * ((1, 0, 0),))
        ]

    eighth, pull = pulled(0.0, 2)
    planes = [
        vv.SymmetryPlane(solid=eighth, nodes=f"{a}0", normal=n) for a, n in zip("xyz", np.eye(3), strict=True)
    ]
    part = vv.System([eighth, *planes, *pull])
    vv.quasi_static(part, until=1.0, step=0.5)

    whole, pull = pulled(-1.0, 4)
    back = vv.Traction(solid=whole, faces="x0", traction=lambda t, X: t * 8 * X[:, [1]] ** 2 * ((-1, 0, 0),))
    middle = np.flatnonzero(np.abs(whole.points).max(axis=1) < 1e-9)
    on = [(np.abs(whole.points[:, k]) < 1e-9) for k in range(3)]
    axis = np.flatnonzero(on[1] & on[2] & (whole.points[:, 0] > 0.9))
    holds = [
        vv.Fixed(solid=whole, nodes=middle),
        vv.Fixed(solid=whole, nodes=axis, directions=(False, True, True)),
        vv.Fixed(
            solid=whole,
            nodes=np.flatnonzero(on[0] & on[2] & (whole.points[:, 1] > 0.9)),
            directions=(False, False, True),
        ),
    ]
    system = vv.System([whole, *holds, *pull, back])
    vv.quasi_static(system, until=1.0, step=0.5)
    u = {tuple(X.round(9)): d for X, d in zip(whole.points, whole.displacements(system.x), strict=True)}
    expected = np.array([u[tuple(X.round(9))] for X in eighth.points])
    assert np.abs(expected).max() > 0.05
    assert np.abs(eighth.displacements(part.x) - expected).max() < 1e-9


def test_oblique_symmetry_plane_is_a_turned_one() -> None:
    """Held by multipliers instead of fixed unknowns, everything is the same in a turned view."""
    moved = []
    for angle in (0.0, 0.6):
        R = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
        block = vv.Solid(
            mesh=vv.BoxMesh(size=SIZE, counts=(1, 2, 1)).build().moved((0.5, 0.1, 0.0)).rotated(angle),
            material=SOFT,
        )
        planes = [
            vv.SymmetryPlane(solid=block, nodes="x0", normal=R @ (1, 0, 0)),
            vv.Fixed(solid=block, nodes="z0", directions=(False, False, True)),
        ]
        planes.append(vv.ElasticFoundation(solid=block, faces="y0", normal=10.0, tangential=10.0))
        pull = vv.Traction(solid=block, faces="x1", traction=R @ (5.0, 2.0, 0.0), times="t")
        system = vv.System([block, *planes, pull])
        vv.quasi_static(system, until=1.0, step=0.5)
        moved.append(block.displacements(system.x) @ R)
    assert np.abs(moved[0]).max() > 0.05
    assert np.abs(moved[0] - moved[1]).max() < 1e-9


# --- damping --------------------------------------------------------------------------------------------------
def test_mass_damping_slows_as_the_midpoint_rule_has_it() -> None:
    block = brick(velocity=(0.4, -0.3, 0.2), mass_damping=0.7)
    system = vv.System([block])
    result = vv.simulate(system, until=0.5, step=0.05)
    factor = ((1 - 0.7 * 0.025) / (1 + 0.7 * 0.025)) ** 10
    expected = factor * np.array([0.4, -0.3, 0.2])
    assert np.abs(block.velocities(system.x, system.v) - expected).max() < 1e-12
    before = 0.5 * block.mass * (0.4**2 + 0.3**2 + 0.2**2)
    assert result.ledger["work_damping"][-1] == pytest.approx(before * (factor**2 - 1), rel=1e-11)


@pytest.mark.parametrize("formulation", ["displacement", "enhanced"])
def test_rayleigh_damping_of_a_mode(formulation: Any) -> None:
    """A mode of a linear solid is an oscillator ``q'' + (alpha + beta w^2) q' + w^2 q = 0``, step by step."""
    alpha, beta, h = 0.3, 0.004, 0.03
    made: Callable[..., vv.Solid] = lambda **o: brick(  # noqa: E731
        "hex8",
        (3, 1, 1),
        material=vv.LinearElastic(young=40.0, poisson=0.25),
        formulation=formulation,
        **o,
    )
    still = made()
    modes = vv.modes(vv.System([still, vv.Fixed(solid=still, nodes="x0")]))
    w, shape = float(np.real(modes.angular[1])), modes.shape(still, "position")[1].reshape(-1, 3)
    block = made(mass_damping=alpha, stiffness_damping=beta, velocity=lambda X: 0.01 * shape)
    system = vv.System([block, vv.Fixed(solid=block, nodes="x0")])
    result = vv.simulate(system, until=20 * h, step=h)
    q, p, c = 0.0, 0.01, alpha + beta * w * w
    lost = 0.0
    for _ in range(20):
        rate = (p - h * w * w * q / 2) / (1 + h * c / 2 + h * h * w * w / 4)  # in the middle of the step
        q, p, lost = q + h * rate, 2 * rate - p, lost - h * c * rate**2
    assert np.abs(block.displacements(system.x) - q * shape).max() < 1e-10 * np.abs(shape).max()
    assert result.ledger["work_damping"][-1] == pytest.approx(lost, rel=1e-8)


@pytest.mark.parametrize(
    ("formulation", "cell", "error"),
    [
        ("enhanced", "quad4", 0.005),
        ("mixed", "quad4", 0.005),
        ("mixed", "quad9", 0.005),
        ("mixed", "tri6", 0.005),
        ("F-bar", "quad4", 0.09),
    ],
)
def test_stiffness_damping_locks_no_volume(formulation: Any, cell: str, error: float) -> None:
    """Bending of a nearly incompressible plate loses ``beta w^2 T`` of its energy, in logarithms, in a period T."""
    beta = 0.004

    def plate(**options: Any) -> vv.Solid:
        mesh = vv.RectangleMesh(size=(4, 1), counts=(8, 2), cell=cell)
        material = vv.LinearElastic(young=40.0, poisson=0.4999)
        return vv.Solid(mesh=mesh, material=material, density=1.0, formulation=formulation, **options)

    still = plate()
    mode = vv.modes(vv.System([still, vv.Fixed(solid=still, nodes="x0")]), n=1)
    w, shape = float(np.real(mode.angular[0])), mode.shape(still, "position")[0].reshape(-1, 2)
    solid = plate(stiffness_damping=beta, velocity=lambda X: 0.01 * np.pad(shape, ((0, 0), (0, 1))))
    period = 2 * np.pi / w
    result = vv.simulate(
        vv.System([solid, vv.Fixed(solid=solid, nodes="x0")]), until=period, step=period / 60
    )
    total = result.ledger["total"]
    assert np.log(total[0] / total[-1]) == pytest.approx(beta * w**2 * period, rel=error)


def test_kelvin_voigt_stress_of_a_constant_rate() -> None:
    """Stretch ``F = 1 + r t`` of a bar without contraction: ``P = F E (e + beta e')``, e Green's strain."""
    E, beta, rate, h = 30.0, 0.2, 0.5, 0.1
    material = vv.SaintVenantKirchhoff(young=E, poisson=0.0)
    bar = brick(
        counts=(3, 1, 1), material=material, stiffness_damping=beta, velocity=lambda X: X * (rate, 0, 0)
    )
    ends = [
        vv.Fixed(solid=bar, nodes="x0"),
        vv.Prescribed(solid=bar, nodes="x1", motion=(f"{rate} * {SIZE[0]} * t", None, None)),
    ]
    system = vv.System([bar, *ends])
    vv.simulate(system, until=4 * h, step=h)
    F = 1 + rate * 4 * h
    expected = F * E * ((F**2 - 1) / 2 + beta * F * rate) * SIZE[1] * SIZE[2]
    assert vv.SupportForce(solid=bar, nodes="x1")(system) == pytest.approx(
        [expected, 0, 0], rel=1e-9, abs=1e-9
    )
