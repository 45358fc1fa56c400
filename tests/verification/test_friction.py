"""Friction: sliding, sticking and rolling against formulas, momenta and energy, and indifference to the observer."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from catalogue.rigid import turned
from rubbing import GRAVITY, contact_of, slope, thrown

import visviva as vv

LAWS: list[dict[str, Any]] = [
    {"enforcement": e, "tangential": t}
    for e in ("multipliers", "penalty")
    for t in ("multipliers", "penalty")
]


def named(law: dict[str, Any]) -> str:
    return f"{law['enforcement']}-{law['tangential']}"


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("dimension", [2, 3])
def test_block_slides_down_a_slope(dimension: int, size: float) -> None:
    """Acceleration g (sin - mu cos) = 2.356287 at 30 degrees with mu = 0.3."""
    parts = slope(dimension, size, speed=0.1, friction=0.3)
    unit = np.sqrt(size)
    result = vv.simulate(vv.System(parts), until=0.4 * unit, step=0.01 * unit)
    time, momentum = result.ledger["time"], result.ledger["momentum_x"]
    mass = 0.5 * size**dimension
    acceleration = (momentum[-1] - momentum[20]) / (time[-1] - time[20]) / mass
    assert contact_of(parts).slipping.all()
    assert acceleration == pytest.approx(2.356287, rel=2e-5)
    result.assert_conserved("energy", tolerance=1e-11)
    work = result.ledger["work_friction"]
    assert np.diff(work).max() < 0


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("dimension", [2, 3])
def test_block_sticks_to_a_slope(dimension: int, size: float) -> None:
    """With mu = 0.6 > tan 30 degrees it does not creep."""
    parts = slope(dimension, size, friction=0.6)
    unit = np.sqrt(size)
    system, block = vv.System(parts), parts[0]
    assert isinstance(block, vv.Solid)
    touching = block.faces("z0" if dimension == 3 else "y0").nodes
    vv.simulate(system, until=0.3 * unit, step=0.01 * unit)
    before = block.positions(system.x)[touching]
    vv.simulate(system, until=1.3 * unit, step=0.01 * unit)
    assert not contact_of(parts).slipping.any()
    assert np.abs(block.positions(system.x)[touching] - before).max() < 1e-13 * size


@pytest.mark.parametrize("law", LAWS, ids=named)
@pytest.mark.parametrize("dimension", [2, 3])
def test_pressed_and_dragged(dimension: int, law: dict[str, Any]) -> None:
    """The tangential force of a sliding block is mu times the normal one."""
    parts = slope(dimension, speed=1.0, friction=0.3, **law)
    vv.simulate(vv.System(parts), until=0.1, step=0.01)
    contact = contact_of(parts)
    t, p = contact.tractions, contact.pressures
    assert contact.slipping.any()
    assert np.linalg.norm(t, axis=1) == pytest.approx(0.3 * p, rel=1e-8, abs=1e-8 * p.max())
    assert (t[:, 0] <= 1e-8 * p.max()).all()


@pytest.mark.parametrize("law", LAWS, ids=named)
@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("friction", [0.1, 1.0])
def test_free_bodies_keep_their_momenta_and_lose_energy(
    dimension: int, friction: float, law: dict[str, Any]
) -> None:
    parts = thrown(dimension, friction=friction, **law)
    system = vv.System(parts, vv.Newton(tolerance=1e-13))
    result = vv.simulate(system, until=0.4, step=0.01)
    ledger = result.ledger
    momenta = ["momentum_x", "momentum_y", "angular_z"]
    if dimension == 3:
        momenta += ["momentum_z", "angular_x", "angular_y"]
    result.assert_conserved("energy", *momenta, tolerance=1e-11)
    scale = ledger["total"][0]
    assert np.diff(ledger["work_friction"]).max() <= 1e-12 * scale
    assert ledger["work_friction"][-1] < -1e-3 * scale
    if law["tangential"] == "penalty":
        assert ledger["potential_friction"].max() > 1e-6 * scale
        assert ledger["potential_friction"][-1] == pytest.approx(0, abs=1e-15)


@pytest.mark.parametrize("law", LAWS, ids=named)
@pytest.mark.parametrize("dimension", [2, 3])
def test_force_of_contact_is_the_change_of_momentum(dimension: int, law: dict[str, Any]) -> None:
    """Over a step, or the parts it was cut into, of the only force on the body, with its friction."""
    parts = thrown(dimension, friction=0.4, **law)
    body, contact = parts[0], contact_of(parts)
    assert isinstance(body, vv.Solid)
    system, sideways = vv.System(parts), 0.0
    before, start = body.nodal_mass @ body.velocities(system.x, system.v), 0.0
    for _ in vv.march(system, until=0.12, step=0.01):
        momentum = body.nodal_mass @ body.velocities(system.x, system.v)
        force = vv.ContactForce(contact=contact)(system)
        change = (momentum - before) / (system.time - start)
        assert np.abs(change - force).max() < 1e-9 * max(1.0, np.abs(force).max())
        sideways = max(sideways, abs(force[0]))
        before, start = momentum, system.time
    assert sideways > 0.1


@pytest.mark.parametrize("law", LAWS, ids=named)
def test_all_observers_see_the_same_friction(law: dict[str, Any]) -> None:
    R = turned(3)

    def places(turn: Any) -> Any:
        parts = thrown(3, turn, **law)
        system = vv.System(parts, vv.Newton(tolerance=1e-14))
        result = vv.simulate(system, until=0.15, step=0.01)
        assert result.ledger["work_friction"][-1] < -1e-3
        return np.vstack([p.positions(system.x) for p in parts if isinstance(p, vv.Solid)])

    assert np.abs(places(np.eye(3)) @ R.T - places(R)).max() < 1e-10


@pytest.mark.parametrize("law", LAWS, ids=named)
@pytest.mark.parametrize("friction", [0.1, 0.4])
@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.BackwardEuler()], ids=str)
def test_tangent_where_much_sticks_or_slips(law: dict[str, Any], friction: float, scheme: vv.Scheme) -> None:
    """Differences of the residual, at every fifth unknown, about a state pressed together."""
    parts = thrown(3, friction=friction, **law)
    system, rng, contact = vv.System(parts), np.random.default_rng(0), contact_of(parts)
    core, n = system.core, system.x.size
    core.x[:] += 0.02 * rng.standard_normal(n)
    for name, low, high in (("pressure", 5, 10), ("traction", -3, 3)):
        if field := getattr(contact, name, None):
            core.x[field.start :][: field.size] = rng.uniform(low, high, field.size)
    upper = parts[0]
    assert isinstance(upper, vv.Solid)
    core.x[upper.node_unknowns(np.arange(upper.grid.n_nodes)) + 2] -= 0.05
    trial = 0.02 * rng.standard_normal(n)
    step = scheme.step(0.0, 0.1)
    system.invalidate()
    core.dx[:] = trial
    K = system.tangent(step)[1].toarray()
    assert contact.pressures.all()

    def residual(unknown: int, change: float) -> Any:
        core.dx[:] = trial
        core.dx[unknown] += change
        return system.residual(step)[free]

    free = system.free_unknowns
    for column in range(0, len(free), 5):
        u = int(free[column])
        difference = (residual(u, 1e-6) - residual(u, -1e-6)) / 2e-6
        assert np.abs(K[:, column] - difference).max() < 1e-8 * np.abs(K).max()


def test_multipliers_are_the_limit_of_elastic_slip() -> None:
    """A block that sticks to a slope: the difference shrinks like 1 / stiffness."""

    def top(**options: Any) -> float:
        parts = slope(2, friction=5.0, **options)
        system, block = vv.System(parts), parts[0]
        assert isinstance(block, vv.Solid)
        vv.simulate(system, until=0.05, step=0.01)
        return float(block.positions(system.x)[:, 0].max())

    exact = top()
    far, near = (abs(top(tangential="penalty", tangential_stiffness=k) - exact) for k in (1e5, 1e6))
    assert far / near == pytest.approx(10, rel=0.1)


@pytest.mark.parametrize("tangential", ["multipliers", "penalty"])
def test_bad_coefficient_is_refused(tangential: Any) -> None:
    with pytest.raises(vv.InputError, match=r"friction = -0\.1 is negative; give a coefficient >= 0"):
        thrown(friction=-0.1, tangential=tangential)


def test_gravity_is_that_of_the_slope() -> None:
    angle = np.radians(30)
    assert GRAVITY * (np.sin(angle) - 0.3 * np.cos(angle)) == pytest.approx(2.356287, abs=1e-6)


@pytest.mark.parametrize(
    ("scheme", "order"),
    [
        (vv.EnergyMomentum(), 1),
        (vv.Midpoint(), 1),
        (vv.GeneralizedAlpha(), 2),
        (vv.BDF2(), 2),
        (vv.BackwardEuler(), 1),
    ],
    ids=str,
)
def test_orders_of_a_point_that_swings_by_its_elastic_slip(scheme: vv.Scheme, order: int) -> None:
    """It sticks: ``x = v / w sin(w t)`` with ``w^2 = c / m``. Midpoint rules take the traction of a step's end."""

    def error(n: int) -> float:
        point, plane = vv.PointMass(mass=1.0, velocity=(0.1, 0, 0)), vv.Plane(normal=(0, 0, 1), at=(0, 0, 0))
        contact = vv.Contact(
            first=point, second=plane, enforcement="penalty", stiffness=1e3, friction=10.0,
            tangential="penalty", tangential_stiffness=9.0, initial="press",
        )  # fmt: skip
        point.position = np.array([0, 0, -0.01])  # where the plane carries its weight of 10
        system = vv.System([point, plane, contact, vv.Gravity(acceleration=(0, 0, -10))])
        vv.simulate(system, until=1.0, step=1 / n, scheme=scheme)
        return abs(float(point.point().position.value(system.x)[0]) - 0.1 / 3 * np.sin(3.0))

    errors = np.array([error(n) for n in (100, 200, 400)])
    assert np.log2(errors[:-1] / errors[1:]) == pytest.approx(order, abs=0.15)


@pytest.mark.parametrize("enforcement", ["penalty", "multipliers"])
@pytest.mark.parametrize("count", [1, 16])
def test_elastic_slip_goes_on_from_facet_to_facet(enforcement: Any, count: int) -> None:
    """A point slides on a stiff plate: what its friction takes and its slip stores is in the books, on any mesh."""
    plate = vv.Solid(
        mesh=vv.BoxMesh(size=(1, 1, 0.2), counts=(count, 1, 1), origin=(-0.5, -0.5, -0.2)),
        material=vv.NeoHooke(young=1e7, poisson=0.3),
        density=1.0,
    )
    point = vv.PointMass(mass=1.0, position=(-0.33, 0.02, 0), velocity=(1, 0, 0))
    rubbing: Any = {"friction": 0.2, "tangential": "penalty", "tangential_stiffness": 200.0}
    contact = vv.Contact(first=point, second=plate, second_faces="z1", enforcement=enforcement, **rubbing)
    parts = [plate, vv.Fixed(solid=plate, nodes="z0"), point, vv.Gravity(), contact]
    result = vv.simulate(vv.System(parts), until=0.3, step=0.0025)
    assert result.conservation()["energy"] < 1e-10
    assert result.ledger.last("work_friction") < -0.25
