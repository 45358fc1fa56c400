"""Discrete systems with heat: springs, stores, exchange; against ordinary differential equations and closed forms."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv


def pendulum(conductance: float) -> tuple[vv.System, list[vv.PointMass], list[vv.ThermalSpring]]:
    """Romero's double pendulum with numbers of the benchmark."""
    ground = vv.Ground()
    masses = [
        vv.PointMass(mass=1.0, position=(1.1, 0, 0), velocity=(0, 4, 0)),
        vv.PointMass(mass=2.0, position=(2.7, 0.3, 0), velocity=(-2, 3, 0)),
    ]
    common: dict[str, Any] = {"law": "logarithmic", "expansion": 1e-3, "reference": 300.0}
    springs = [
        vv.ThermalSpring(
            a=ground, b=masses[0], stiffness=1e3, capacity=3.0, free_length=1.0, temperature=380.0, **common
        ),
        vv.ThermalSpring(
            a=masses[0],
            b=masses[1],
            stiffness=1e4,
            capacity=5.0,
            free_length=1.5,
            temperature=298.0,
            **common,
        ),
    ]
    parts: list[Any] = [ground, *masses, *springs]
    if conductance:
        parts.append(vv.HeatExchange(a=springs[0], b=springs[1], conductance=conductance))
    return vv.System(parts, vv.Newton(tolerance=1e-13)), masses, springs


TABLE = [  # conductance, q1, q2, entropy, temperatures at t = 1
    (0.0, (0.25068171122, 1.18225097473), (-0.31639901393, 2.55982980153), 1.58917869215,
     (368.265744167, 355.832283293)),
    (10.0, (0.16193432496, 1.15942040194), (-0.38242597437, 2.59228907055), 1.65402515567,
     (335.317880079, 362.507987655)),
]  # fmt: skip


@pytest.mark.parametrize(("conductance", "q1", "q2", "entropy", "temperatures"), TABLE)
def test_double_pendulum(conductance: float, q1: Any, q2: Any, entropy: float, temperatures: Any) -> None:
    """Energy to rounding, entropy never falls, and second order towards the table (DOP853 at 2e-14)."""
    errors = []
    for h in (5e-4, 2.5e-4):
        system, masses, springs = pendulum(conductance)
        total = [sum(s.entropy_at(system.x) for s in springs)]
        result = vv.simulate(
            system,
            until=1.0,
            step=h,
            every=10000,
            observe=lambda s, total=total, springs=springs: total.append(
                sum(spring.entropy_at(s.x) for spring in springs)
            ),
        )
        assert result.ledger.first("total") == pytest.approx(563.04744021012, rel=1e-13)
        assert total[0] == pytest.approx(1.58917869215, rel=1e-11)
        assert result.conservation()["energy"] < 2e-12
        assert np.min(np.diff(total)) > -1e-14
        found = [form.value(system.x) for m in masses for form in list(m.place(np.zeros(3)))[:2]]
        found += [s.temperature_at(system.x) / 300 for s in springs]
        exact = [*q1, *q2, *(T / 300 for T in temperatures)]
        errors.append(np.abs(np.array(found) - exact).max())
        assert total[-1] == pytest.approx(entropy, abs=3e-5)
    assert errors[1] < 6e-4
    assert 3.7 < errors[0] / errors[1] < 4.3


def wheel(damping: float = 0.0) -> list[Any]:
    """A rim of masses on spokes about a heavy hub, spinning, one half hot; springs exchange heat with neighbours."""
    n, parts = 8, []
    hub = vv.PointMass(mass=5.0)
    rim = []
    for k in range(n):
        a = 2 * np.pi * k / n
        place, speed = np.array([np.cos(a), np.sin(a), 0]), 3 * np.array([-np.sin(a), np.cos(a), 0.05 * k])
        rim.append(vv.PointMass(mass=1.0, position=place, velocity=speed))
    common: dict[str, Any] = {"stiffness": 200.0, "capacity": 2.0, "expansion": 2e-4, "damping": damping}
    spokes = [
        vv.ThermalSpring(a=hub, b=m, temperature=400.0 if k < n / 2 else 290.0, **common)
        for k, m in enumerate(rim)
    ]
    arcs = [vv.ThermalSpring(a=rim[k], b=rim[(k + 1) % n], temperature=300.0, **common) for k in range(n)]
    for k in range(n):
        parts.append(vv.HeatExchange(a=spokes[k], b=arcs[k], conductance=0.5))
        parts.append(vv.HeatExchange(a=arcs[k], b=spokes[(k + 1) % n], conductance=0.5))
    return [hub, *rim, *spokes, *arcs, *parts]


@pytest.mark.parametrize("damping", [0.0, 2.0])
@pytest.mark.parametrize("h", [0.01, 0.1])
def test_rotating_wheel_of_springs(damping: float, h: float) -> None:
    """Both laws and the momenta, with and without dampers, at steps of a fiftieth and a fifth of the period."""
    parts = wheel(damping)
    system, total = vv.System(parts, vv.Newton(tolerance=1e-13)), []
    springs = [p for p in parts if isinstance(p, vv.ThermalSpring)]
    result = vv.simulate(
        system, until=40 * h, step=h, observe=lambda s: total.append(sum(p.entropy_at(s.x) for p in springs))
    )
    kept = result.conservation()
    assert kept["energy"] < 3e-12
    assert max(kept[f"angular_{k}"] for k in "xyz") < 1e-12
    assert max(kept[f"momentum_{k}"] for k in "xyz") < 1e-12
    assert np.min(np.diff(total)) > 0


def test_a_damper_heats_by_what_motion_loses() -> None:
    ball = vv.PointMass(mass=2.0, position=(1.2, 0, 0), velocity=(1.5, 0, 0))
    ground = vv.Ground()
    spring = vv.ThermalSpring(a=ground, b=ball, stiffness=50.0, damping=4.0, free_length=1.0, capacity=10.0)
    system = vv.System([ground, ball, spring])
    vv.simulate(system, until=20.0, step=0.05)
    held = 0.5 * 2.0 * 1.5**2 + 0.5 * 50.0 * 0.2**2
    assert spring.temperature_at(system.x) - 293.15 == pytest.approx(held / 10.0, rel=1e-9)


def test_stores_level_out_as_exponentials_do() -> None:
    """exp(-K (1/c_a + 1/c_b) t), and the entropy of the closed form at the end."""
    hot, cold = vv.HeatStore(capacity=2.0, temperature=400.0), vv.HeatStore(capacity=6.0, temperature=300.0)
    system = vv.System([hot, cold, vv.HeatExchange(a=hot, b=cold, conductance=3.0)])
    start = hot.entropy_at(system.x) + cold.entropy_at(system.x)
    found = []
    result = vv.simulate(
        system,
        until=2.0,
        step=0.005,
        observe=lambda s: found.append(hot.temperature_at(s.x) - cold.temperature_at(s.x)),
    )
    assert result.ledger.swing("total") < 1e-13 * 2.0 * 400
    assert found[199] == pytest.approx(100 * np.exp(-2.0), rel=3e-5)
    gained = hot.entropy_at(system.x) + cold.entropy_at(system.x) - start
    ends = hot.temperature_at(system.x), cold.temperature_at(system.x)
    assert gained == pytest.approx(2 * np.log(ends[0] / 400) + 6 * np.log(ends[1] / 300), rel=1e-12)
    assert gained > 0


def test_bodies_exchange_heat_with_stores_and_springs() -> None:
    """A motor's heat goes into a solid at some nodes, a resting body and the room: what is booked is what came in."""
    block = vv.ThermoelasticSolid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(2, 1, 1)),
        material=vv.NeoHooke(lame_lambda=20.0, shear=10.0),
        density=1.0,
        heat=vv.Heat(conductivity=0.5, capacity=0.2, expansion=0.005, reference=20.0),
        temperature=22.0,
    )
    still = vv.ThermalBody(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(2, 1, 1)), conductivity=1.0, temperature=18.0
    )
    motor = vv.HeatStore(capacity=0.5, temperature=40.0, reference=20.0)
    links: list[Any] = [
        vv.HeatExchange(a=motor, b=block, nodes_b="x0", conductance=0.2),
        vv.HeatExchange(a=still, nodes_a="x1", b=block, nodes_b="x1", conductance=0.3),
        vv.HeatExchange(a=still, nodes_a="x0", conductance=0.1, ambient="20 + 5*sin(t)"),
    ]
    system = vv.System([block, still, motor, *links], vv.Newton(tolerance=1e-13))
    assert system.check().tangent.error < 1e-6
    result = vv.simulate(system, until=2.0, step=0.1)
    assert result.ledger.imbalance() < 1e-12
    assert abs(result.ledger.last("heat_exchange")) > 1e-3
    assert motor.temperature_at(system.x) < 40


def test_an_energy_of_the_user_is_that_of_the_package() -> None:
    def free(length: Any, T: Any) -> Any:
        g = np.log(length / 1.5)
        return 0.5 * 1e2 * g**2 - 0.1 * (T - 300) * g + 3.0 * (T - 300 - T * np.log(T / 300))

    ends = []
    for given in (
        {"energy": free},
        {"stiffness": 1e2, "expansion": 1e-3, "capacity": 3.0, "law": "logarithmic"},
    ):
        ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(1.7, 0, 0), velocity=(0, 2, 1))
        spring = vv.ThermalSpring(
            a=ground, b=ball, free_length=1.5, reference=300.0, temperature=350.0, **given
        )
        system = vv.System([ground, ball, spring])
        result = vv.simulate(system, until=0.5, step=0.02)
        assert result.conservation()["energy"] < 1e-10
        ends.append([*system.x[:3], spring.temperature_at(system.x)])
    assert ends[0] == pytest.approx(ends[1], rel=1e-8)


def spring(**change: Any) -> vv.ThermalSpring:
    given = {"a": vv.Ground(), "b": vv.PointMass(mass=1.0, position=(1, 0, 0)), "capacity": 1.0, **change}
    return vv.ThermalSpring(**given)


BAD = [
    (lambda: spring(capacity=-1.0), "capacity = -1 is not positive"),
    (lambda: spring(temperature=-20.0), "not above absolute zero"),
    (lambda: spring(stiffness=-2.0), "stiffness = -2 is negative"),
    (lambda: spring(damping=-2.0), "damping = -2 is negative"),
    (lambda: spring(free_length=0.0), "free_length = 0 is not positive"),
    (lambda: spring(moduli_slope=-0.01, temperature=400.0), "leaves no stiffness at 400"),
    (lambda: spring(energy=lambda l, T: l), "energy stands for stiffness"),
    (lambda: vv.HeatStore(capacity=0.0), "capacity = 0 is not positive"),
    (lambda: vv.HeatStore(capacity=1.0, temperature=0.0), "not above absolute zero"),
    (lambda: vv.HeatExchange(a=vv.HeatStore(capacity=1.0), conductance=1.0), "either b or the ambient"),
    (lambda: vv.HeatExchange(a=spring(), b=spring(), conductance=-1.0), "conductance = -1 is negative"),
    (lambda: vv.HeatExchange(a=vv.Ground(), conductance=1.0, ambient=3.0), "holds no heat"),
]


@pytest.mark.parametrize(("make", "message"), BAD)
def test_bad_input(make: Any, message: str) -> None:
    with pytest.raises(vv.InputError, match=message):
        make()


def test_bodies_need_nodes_and_points_need_to_move() -> None:
    body = vv.ThermalBody(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), conductivity=1.0)
    with pytest.raises(vv.InputError, match=r"say where on .* by one of nodes_a"):
        vv.HeatExchange(a=body, conductance=1.0, ambient=3.0)
    ground = vv.Ground()
    fixed = vv.ThermalSpring(a=ground, b=ground.point((1, 0, 0)), capacity=1.0)
    with pytest.raises(vv.InputError, match="neither of its points can move"):
        vv.System([ground, fixed])
