"""Heat across contact and of friction: the jump between two bars, both laws, a sliding block, refusals."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from visviva.examples import brake, tori_thermal

Array = NDArray[np.float64]
STIFF = vv.NeoHooke(young=100.0, poisson=0.0)


def solid(counts: tuple[int, int, int], height: float = 0.0, **options: Any) -> vv.ThermoelasticSolid:
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=counts, origin=(0, 0, height))
    given: dict[str, Any] = {
        "material": STIFF,
        "heat": vv.Heat(conductivity=2.0, capacity=1.0, reference=300.0, in_space=False),
        "temperature": 300.0,
        **options,
    }
    return vv.ThermoelasticSolid(mesh=mesh, **given)


LAWS: list[Any] = [3.0, [(0.0, 0.0), (5.0, 2.0), (20.0, 4.0)], lambda p: 0.4 * p**0.95]


@pytest.mark.parametrize("enforcement", ["multipliers", "penalty"])
@pytest.mark.parametrize("law", LAWS, ids=["constant", "table", "function"])
def test_two_bars_have_a_jump(law: Any, enforcement: Any) -> None:
    """Resistances 1/2, 1/h(p) and 1/2 in series between 301 and 300, p the pressure of the contact."""
    lower, upper = solid((3, 2, 1)), solid((2, 2, 1), 1.0)
    contact = vv.Contact(
        first=lower, first_faces="z1", second=upper, second_faces="z0", enforcement=enforcement
    )
    heat = vv.HeatContact(contact=contact, conductance=law)
    held = [
        vv.Fixed(solid=lower, nodes="z0"),
        vv.Prescribed(solid=upper, nodes="z1", motion=(0, 0, "-0.1*t")),
        vv.PrescribedTemperature(body=lower, nodes="z0", value="300 + t"),
        vv.PrescribedTemperature(body=upper, nodes="z1", value=300.0),
    ]
    system = vv.System([lower, upper, contact, heat, *held])
    vv.quasi_static(system, until=1.0, step=0.25)
    p = float(contact.pressures[0])
    assert p > 4
    even, near = (1e-8, 2e-5) if enforcement == "multipliers" else (0.011, 5e-3)
    assert contact.pressures == pytest.approx(p, rel=even)
    h = np.interp(p, *np.transpose(law)) if isinstance(law, list) else law(p) if callable(law) else law
    flow = 1 / (0.5 + 1 / h + 0.5)
    assert heat.heat.sum() == pytest.approx(-flow, rel=near)
    for body, side, expected in ((lower, "z1", 301 - flow / 2), (upper, "z0", 300 + flow / 2)):
        found = system.x[body.temperature_unknowns(body.nodes(side))]
        assert found == pytest.approx(expected, abs=10 * near)


@pytest.mark.parametrize("law", LAWS, ids=["constant", "table", "function"])
def test_plane_bars_conduct_by_their_thickness(law: Any) -> None:
    """As bars in space of that depth do; contact, whose areas of plane bodies are lengths, has forces by length."""
    bars = [
        vv.ThermoelasticSolid(
            mesh=vv.RectangleMesh(size=(1, 1), counts=(n, 1), origin=(0, y)),
            material=STIFF,
            heat=vv.Heat(conductivity=2.0, capacity=1.0, reference=300.0, in_space=False),
            temperature=300.0,
            thickness=0.25,
        )
        for n, y in ((3, 0.0), (2, 1.0))
    ]
    contact = vv.Contact(first=bars[0], first_faces="y1", second=bars[1], second_faces="y0")
    heat = vv.HeatContact(contact=contact, conductance=law)
    held = [
        vv.Fixed(solid=bars[0], nodes="y0"),
        vv.Prescribed(solid=bars[1], nodes="y1", motion=(0, "-0.1*t", None)),
        vv.PrescribedTemperature(body=bars[0], nodes="y0", value="300 + t"),
        vv.PrescribedTemperature(body=bars[1], nodes="y1", value=300.0),
    ]
    vv.quasi_static(vv.System([*bars, contact, heat, *held]), until=1.0, step=0.25)
    p = float(contact.pressures[0]) / 0.25
    assert p > 4
    h = np.interp(p, *np.transpose(law)) if isinstance(law, list) else law(p) if callable(law) else law
    assert heat.heat.sum() == pytest.approx(-0.25 / (0.5 + 1 / h + 0.5), rel=2e-5)


def test_plane_bodies_in_contact_are_equally_thick() -> None:
    bars = [
        vv.ThermoelasticSolid(
            mesh=vv.RectangleMesh(size=(1, 1), counts=(1, 1), origin=(0, y)),
            material=STIFF,
            heat=vv.Heat(conductivity=2.0, capacity=1.0),
            temperature=300.0,
            thickness=t,
        )
        for y, t in ((0.0, 1.0), (1.0, 0.5))
    ]
    contact = vv.Contact(first=bars[0], first_faces="y1", second=bars[1], second_faces="y0")
    with pytest.raises(vv.InputError, match=r"HeatContact: .* differ in thickness"):
        vv.HeatContact(contact=contact, conductance=1.0)


def slide(**options: Any) -> list[Any]:
    """A block that is thrown along another one, pressed on by its weight: both, contact, gravity, support."""
    table = vv.BoxMesh(size=(3, 1, 0.5), counts=(6, 2, 1))
    warm = vv.Heat(conductivity=0.05, capacity=0.01, expansion=1e-4, reference=300.0)
    common: Any = {"material": vv.NeoHooke(young=200.0, poisson=0.3), "density": 1.0, "heat": warm}
    lower = vv.ThermoelasticSolid(mesh=table, temperature=300.0, **common)
    block = vv.BoxMesh(size=(1, 0.7, 0.5), counts=(3, 1, 1), origin=(0.2, 0.1, 0.5))
    upper = vv.ThermoelasticSolid(mesh=block, temperature=320.0, velocity=(1.5, 0.2, 0), **common)
    contact = vv.Contact(
        first=upper, first_faces="z0", second=lower, second_faces="z1",
        **{"friction": 0.3, "enforcement": "penalty", "tangential": "penalty", **options},
    )  # fmt: skip
    return [lower, upper, contact, vv.Gravity(acceleration=(0, 0, -5)), vv.Fixed(solid=lower, nodes="z0")]


RUBS: list[Any] = [
    {},
    {"enforcement": "multipliers", "tangential": "multipliers"},
    {"formulation": "node-to-segment"},
]


@pytest.mark.parametrize("options", RUBS, ids=["penalty", "multipliers", "by vertices"])
@pytest.mark.parametrize("share", [0.0, 0.3])
def test_a_sliding_block_turns_its_motion_into_heat(options: dict[str, Any], share: float) -> None:
    """All that friction takes is heat, step by step and to rounding; entropy never falls."""
    parts = slide(**options)
    lower, upper = parts[:2]
    heat = vv.HeatContact(contact=parts[2], share=share, conductance=0.02)
    system = vv.System([*parts, heat], vv.Newton(tolerance=1e-13))
    entropy: list[float] = []
    result = vv.simulate(
        system,
        until=0.3,
        step=0.01,
        observe=lambda s: entropy.append(lower.total_entropy(s.x) + upper.total_entropy(s.x)),
    )
    ledger = result.ledger
    rubbed = -ledger["work_friction"]
    assert rubbed[-1] > 0.02
    assert np.all(np.diff(rubbed) > -1e-14)
    assert np.abs(ledger["heat_friction"] - rubbed).max() < 1e-13
    assert result.conservation()["energy"] < (1e-9 if "tangential" in options else 1e-12)
    assert np.min(np.diff(entropy)) > 0


@pytest.mark.parametrize("scheme", [vv.GeneralizedAlpha(), vv.BDF2(), vv.BackwardEuler()])
@pytest.mark.parametrize("kind", ["solid", "ball"])
def test_schemes_that_balance_ends_book_the_heat_that_friction_takes(scheme: Any, kind: str) -> None:
    """Half of the work at both ends of a step in both columns, and the elastic part of the slip from its ends."""
    _, result = ride(kind, scheme, **PENALTY)
    rubbed = -result.ledger["work_friction"]
    assert rubbed[-1] > 0.01
    assert result.ledger["heat_friction"] == pytest.approx(rubbed, abs=1e-9 * rubbed[-1])


@pytest.mark.parametrize("scheme", [vv.GeneralizedAlpha(), vv.BDF2()])
def test_temperatures_get_the_booked_heat_to_second_order(scheme: Any) -> None:
    """Internal energy against the heat of a friction that grows: elastic slip, of first order, is next to none."""
    missing = []
    for step in (2e-3, 1e-3):
        heat = vv.Heat(conductivity=5.0, capacity=2e3, reference=300.0)
        neo = vv.NeoHooke(young=1e5, poisson=0.3)
        mesh = vv.BoxMesh(size=(0.4, 0.4, 0.2), counts=(3, 3, 1), origin=(-0.2, -0.2, -0.2))
        lower = vv.ThermoelasticSolid(mesh=mesh, material=neo, density=1e3, heat=heat, temperature=300.0)
        slab = vv.BoxMesh(size=(0.26, 0.04, 0.04), counts=(4, 1, 1), origin=(-0.13, 0, 0))
        upper = vv.Solid(mesh=slab, material=neo, density=1200.0, velocity=(1.0, 0, 0))
        stiff: dict[str, Any] = {**PENALTY, "tangential_stiffness": 1e9}
        contact = vv.Contact(
            first=upper, first_faces="z0", second=lower, second_faces="z1", friction=0.3, **stiff
        )
        rubbing = vv.HeatContact(contact=contact)
        push = vv.Pressure(solid=upper, faces="z1", pressure="4e5 * t * t")
        held = vv.Fixed(solid=lower, nodes="z0")
        system = vv.System([lower, upper, held, contact, rubbing, push], vv.Newton(tolerance=1e-12))
        ledger = vv.simulate(system, until=0.04, step=step, scheme=scheme).ledger
        assert ledger["heat_friction"][-1] == pytest.approx(0.023, rel=0.01)
        missing.append(abs(ledger["imbalance"][-1]))
    assert missing[1] < 2e-4 * 0.023
    assert missing[0] / missing[1] == pytest.approx(4, rel=0.1)


def test_the_share_decides_who_gets_the_heat() -> None:
    """Without conduction: what the block takes is its share of what friction takes."""
    gained = []
    for share in (0.0, 0.25, 1.0):
        parts = slide()
        lower, upper = parts[:2]
        for body in (lower, upper):
            body.heat = vv.Heat(conductivity=1e-9, capacity=10.0, reference=300.0)
        heat = vv.HeatContact(contact=parts[2], share=share)
        system = vv.System([*parts, heat])
        start = upper.total_entropy(system.x)
        vv.simulate(system, until=0.1, step=0.01)
        gained.append(upper.total_entropy(system.x) - start)
    assert gained[0] == pytest.approx(0.0, abs=1e-9)
    assert gained[1] == pytest.approx(gained[2] / 4, rel=0.02)


def test_heat_of_friction_on_a_plane_without_temperatures() -> None:
    """The plane's share is lost: the ledger books what the block gets alone, and its balance closes."""
    parts = slide()
    block = parts[1]
    plane = vv.Plane(at=(0, 0, 0.5), normal=(0, 0, 1))
    contact = vv.Contact(
        first=block, first_faces="z0", second=plane, friction=0.3, enforcement="penalty", tangential="penalty"
    )
    heat = vv.HeatContact(contact=contact, share=0.7)
    system = vv.System([block, plane, contact, heat, parts[3]])
    result = vv.simulate(system, until=0.2, step=0.01)
    rubbed = -result.ledger["work_friction"]
    assert rubbed[-1] > 0.01
    assert result.ledger["heat_friction"] == pytest.approx(0.7 * rubbed, abs=1e-13)
    assert result.conservation()["energy"] < 1e-11


def rider(kind: str) -> Any:
    """A body without temperatures just above z = 0, that goes along x."""
    goes: dict[str, Any] = {"velocity": (1.0, 0, 0)}
    place = (-0.05, 0.01, 0.0505)
    if kind == "ball":
        return vv.RigidBody(shape=vv.Sphere(radius=0.05), density=2000.0, position=place, **goes)
    if kind == "box":
        return vv.RigidBody(
            shape=vv.Box(size=(0.1, 0.1, 0.1)),
            density=2000.0,
            position=place,
            angular_velocity=(3, 2, 0),
            **goes,
        )
    if kind == "point":
        return vv.PointMass(mass=2.0, position=(-0.05, 0.01, 0.0005), **goes)
    if kind == "beam":
        section = vv.TubeSection(radius=0.02, young=1e6, density=1200.0)
        line = vv.LineMesh(points=[(-0.13, 0.01, 0.0205), (0.13, 0.012, 0.0207)], count=4)
        return vv.Beam(mesh=line, section=section, **goes)
    block = vv.BoxMesh(size=(0.26, 0.04, 0.04), counts=(4, 1, 1), origin=(-0.13, 0, 0.0005))
    return vv.Solid(mesh=block, material=vv.NeoHooke(young=1e5, poisson=0.3), density=1200.0, **goes)


def ride(kind: str, scheme: Any = None, step: float = 1e-3, until: float = 0.03, **options: Any) -> Any:
    """That body pressed on a warm block over which it rubs: the block and the result."""
    heat = vv.Heat(conductivity=5.0, capacity=2e3, reference=300.0)
    mesh = vv.BoxMesh(size=(0.4, 0.4, 0.2), counts=(3, 3, 1), origin=(-0.2, -0.2, -0.2))
    block = vv.ThermoelasticSolid(
        mesh=mesh, material=vv.NeoHooke(young=1e5, poisson=0.3), density=1e3, heat=heat, temperature=300.0
    )
    upper = rider(kind)
    contact = vv.Contact(first=upper, second=block, second_faces="z1", friction=0.3, **options)
    system = vv.System(
        [
            block,
            upper,
            vv.Fixed(solid=block, nodes="z0"),
            contact,
            vv.HeatContact(contact=contact),
            vv.Gravity(acceleration=(0, 0, -50.0)),
        ],
        vv.Newton(tolerance=1e-12),
    )
    return block, vv.simulate(system, until=until, step=step, scheme=scheme or vv.EnergyMomentum())


BY_VERTICES: dict[str, Any] = {"formulation": "node-to-segment"}
PENALTY: dict[str, Any] = {"enforcement": "penalty", "tangential": "penalty"}
MULTIPLIERS: dict[str, Any] = {"enforcement": "multipliers", "tangential": "multipliers"}


@pytest.mark.parametrize("enforced", [PENALTY, MULTIPLIERS], ids=["penalty", "multipliers"])
@pytest.mark.parametrize(
    ("kind", "options"),
    [
        ("ball", {}),
        ("box", {}),
        ("point", {}),
        ("beam", {}),
        ("solid", {"formulation": "mortar"}),
        ("solid", BY_VERTICES),
    ],
    ids=["ball", "box", "point", "beam", "mortar", "vertices"],
)
def test_all_heat_goes_into_the_body_with_temperatures(kind: str, options: Any, enforced: Any) -> None:
    """Whatever rubs on it, first or not: all that friction takes is heat of the one body that has temperatures."""
    _, result = ride(kind, **options, **enforced)
    rubbed = -result.ledger["work_friction"]
    assert rubbed[-1] > 0.01
    assert result.ledger["heat_friction"] == pytest.approx(rubbed, abs=1e-9 * rubbed[-1])


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.Midpoint()])
@pytest.mark.parametrize("enforcement", ["multipliers", "penalty"])
def test_two_lumps_even_out_by_the_exponential(scheme: Any, enforcement: Any) -> None:
    """``100 exp(-2 h t / c l)`` of two slabs that are even within, of second order by either scheme."""
    good = vv.Heat(conductivity=1e6, capacity=2.0, reference=300.0, in_space=False)
    errors = []
    for step in (0.02, 0.01):
        lower = solid((2, 2, 1), heat=good, density=1.0)
        upper = solid((3, 3, 1), 1.0, heat=good, density=1.0, temperature=400.0)
        contact = vv.Contact(
            first=upper, first_faces="z0", second=lower, second_faces="z1", enforcement=enforcement
        )
        heat = vv.HeatContact(contact=contact, conductance=6.0)
        held = [
            vv.Fixed(solid=lower, nodes="z0"),
            vv.Prescribed(solid=upper, nodes="z1", motion=(0, 0, -0.001)),
        ]
        system = vv.System([lower, upper, contact, heat, *held])
        vv.simulate(system, until=0.2, step=step, scheme=scheme)
        jump = upper.temperatures(system.x).mean() - lower.temperatures(system.x).mean()
        errors.append(abs(jump - 100 * np.exp(-2 * 6.0 * 0.2 / 2.0)))
    assert errors[1] < 0.012  # (6 h)^2 / 12 of 1.2 times 30
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)


@pytest.mark.parametrize("law", [50.0, [(0.0, 0.0), (5.0, 50.0)]], ids=["at once", "growing"])
def test_heat_that_parts_surfaces_needs_a_conductance_that_grows(law: Any) -> None:
    """A hot column that touches by its expansion shrinks as it cools: touching it parts, apart it touches (Barber)."""
    wide = vv.Heat(conductivity=2.0, capacity=1.0, expansion=1e-3, reference=300.0, in_space=False)
    lower, upper = solid((1, 1, 1)), solid((1, 1, 1), 1.08, heat=wide)
    contact = vv.Contact(
        first=lower, first_faces="z1", second=upper, second_faces="z0", enforcement="penalty"
    )
    heat = vv.HeatContact(contact=contact, conductance=law)
    held = [
        vv.Fixed(solid=lower, nodes="z0"),
        vv.Fixed(solid=upper, nodes="z1"),
        vv.PrescribedTemperature(body=lower, nodes="z0", value=300.0),
        vv.PrescribedTemperature(body=upper, nodes="z1", value="300 + 100 * min(t, 1)"),
    ]
    system = vv.System([lower, upper, contact, heat, *held])
    if isinstance(law, float):
        with pytest.raises(vv.StepFailure, match="let its conductance grow from zero with the pressure"):
            vv.simulate(system, until=4.0, step=0.1, scheme=vv.BackwardEuler())
        return
    vv.simulate(system, until=4.0, step=0.1, scheme=vv.BackwardEuler())
    pressure = float(contact.pressures.mean())
    assert 0.1 < pressure < 0.2
    assert heat.heat.sum() == pytest.approx(100 / (0.5 + 1 / (10 * pressure) + 0.5), rel=1e-3)


def test_what_is_apart_does_not_conduct() -> None:
    lower, upper = solid((1, 1, 1)), solid((1, 1, 1), 1.01, temperature=400.0)
    contact = vv.Contact(first=lower, first_faces="z1", second=upper, second_faces="z0")
    heat = vv.HeatContact(contact=contact, conductance=5.0)
    held = [vv.Fixed(solid=lower, nodes="z0"), vv.Fixed(solid=upper, nodes="z1")]
    for body in (lower, upper):
        body.density = 1.0
    system = vv.System([lower, upper, contact, heat, *held])
    vv.simulate(system, until=0.1, step=0.05)
    assert lower.temperatures(system.x) == pytest.approx(300.0, abs=1e-9)


def test_refusals() -> None:
    lower, upper = solid((1, 1, 1)), solid((1, 1, 1), 1.0)
    cold = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), material=STIFF)
    sides: Any = {"first_faces": "z1", "second_faces": "z0"}
    contact = vv.Contact(first=lower, second=upper, **sides)
    points = vv.Contact(first=lower, second=upper, formulation="node-to-segment", **sides)
    half = vv.Contact(first=cold, second=upper, friction=0.1, **sides)
    none = vv.Contact(first=cold, second=vv.Plane(at=(0, 0, 0), normal=(0, 0, 1)), friction=0.1)
    shell = vv.ThermalShell(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(1, 1)),
        section=vv.SolidSection(material=STIFF, thickness=0.1, density=1.0),
        heat=vv.Heat(conductivity=2.0, capacity=1.0, reference=300.0),
        name="skin",
    )
    on_shell = vv.Contact(first=shell, first_faces="upper", second=upper, second_faces="z0", friction=0.1)
    cases: list[tuple[dict[str, Any], str]] = [
        ({"contact": on_shell, "conductance": 1.0}, "brings no heat into ThermalShell 'skin'"),
        ({"contact": contact}, "has no friction, so that nothing passes without a conductance"),
        ({"contact": contact, "conductance": -1.0}, "a conductance of -1 is not positive"),
        ({"contact": contact, "conductance": 0.0}, "a conductance of 0 is not positive"),
        ({"contact": contact, "conductance": [(0, 1), (1, -2)]}, "a conductance of -2 is not positive"),
        ({"contact": contact, "conductance": [(1, 1), (0, 2)]}, "first numbers of a table's rows must grow"),
        ({"contact": contact, "conductance": [(1, 1, 1)]}, "expected a number, rows of two numbers"),
        ({"contact": contact, "conductance": 1.0, "share": 1.5}, "share = 1.5 is not between 0 and 1"),
        ({"contact": points, "conductance": 1.0}, "by vertices conducts where it rubs alone"),
        (
            {"contact": half, "share": 1.0},
            "share = 1 brings all heat of friction to Solid, which has no temp",
        ),
        ({"contact": half, "conductance": 1.0}, "do not both carry heat"),
        ({"contact": none, "conductance": 1.0}, "of which none carries heat"),
    ]
    for options, words in cases:
        with pytest.raises(vv.InputError, match=words):
            vv.HeatContact(**options)
    with pytest.raises(vv.InputError, match="which is not in the system"):
        vv.System([lower, upper, vv.HeatContact(contact=contact, conductance=1.0)])
    twice = [vv.HeatContact(contact=contact, conductance=1.0) for _ in range(2)]
    with pytest.raises(vv.InputError, match=r"has another .*HeatContact already"):
        vv.System([lower, upper, contact, *twice])


@pytest.mark.parametrize(
    ("example", "given"), [(brake, {"until": 0.01}), (tori_thermal, {"around": 16, "until": 1.1})]
)
def test_examples_pass_their_own_checks(example: Any, given: dict[str, Any]) -> None:
    study = example.study(**given)
    example.check(vv.simulate(study.system, until=study.until, step=study.step))
