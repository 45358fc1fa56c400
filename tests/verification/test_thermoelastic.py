"""Solids that deform and conduct heat: both laws of thermodynamics, and closed forms."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import visviva as vv
from visviva.thermal.capacity import capacity_of

RUBBER = vv.NeoHooke(lame_lambda=20.0, shear=10.0)
HEAT = vv.Heat(conductivity=0.5, capacity=0.2, expansion=0.005, reference=20.0, moduli_slope=0.02)


def distorted(cell: str, counts: tuple[int, int, int] = (2, 2, 2)) -> vv.Mesh:
    """A brick whose inner and outer nodes are moved about."""
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=counts, cell=cell).build()
    X = np.array(mesh.points)
    bent = X + 0.05 * np.sin(2.0 * X[:, [1, 2, 0]] + X[:, [2, 0, 1]])
    return vv.Mesh(bent, mesh.cells, face_sets=mesh.face_sets)


def flying(cell: str = "hex8", heat: vv.Heat = HEAT, material: Any = RUBBER) -> vv.ThermoelasticSolid:
    return vv.ThermoelasticSolid(
        mesh=distorted(cell),
        material=material,
        density=1.0,
        heat=heat,
        temperature=lambda X: 20 + 8 * X[:, 0] ** 2,
        angular_velocity=(1, 2, 3),
    )


@pytest.mark.parametrize("cell", ["hex8", "tet10", "hex20"])
@pytest.mark.parametrize("h", [0.01, 0.05, 0.2])
def test_both_laws_hold_to_rounding(cell: str, h: float) -> None:
    """Isolated, hot and cold, distorted: energy and momenta are kept and entropy never falls, at any step."""
    body, entropy = flying(cell), []
    system = vv.System([body], vv.Newton(tolerance=1e-13))
    result = vv.simulate(
        system, until=12 * h, step=h, observe=lambda s: entropy.append(body.total_entropy(s.x))
    )
    kept = result.conservation()
    assert kept["energy"] < 1e-12
    assert max(kept[f"angular_{k}"] for k in "xyz") < 1e-12
    assert np.min(np.diff(entropy)) > 0
    assert np.ptp(body.temperatures(system.x)) < 8


MATERIALS = [
    vv.SaintVenantKirchhoff(young=30.0, poisson=0.3),
    vv.MooneyRivlin(c10=5.0, c01=1.0, bulk=50.0),
    vv.Gent(shear=10.0, limit=40.0, bulk=50.0),
]


@pytest.mark.parametrize("material", MATERIALS)
def test_laws_hold_for_materials(material: Any) -> None:
    body, entropy = flying(material=material), []
    system = vv.System([body], vv.Newton(tolerance=1e-13))
    result = vv.simulate(
        system, until=0.5, step=0.05, observe=lambda s: entropy.append(body.total_entropy(s.x))
    )
    assert result.conservation()["energy"] < 1e-12
    assert np.min(np.diff(entropy)) > 0


def pulled(material: Any, heat: vv.Heat, stretch: float) -> tuple[vv.ThermoelasticSolid, vv.System]:
    """A cube that is pulled without inertia, free at its sides and without exchange of heat."""
    cube = vv.ThermoelasticSolid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), material=material, heat=heat
    )
    sides = [vv.SymmetryPlane(solid=cube, nodes=f"{'xyz'[k]}0", normal=np.eye(3)[k]) for k in range(3)]
    end = vv.Prescribed(solid=cube, nodes="x1", motion=(f"{stretch - 1}*t", None, None))
    system = vv.System([cube, *sides, end])
    vv.simulate(system, until=1.0, step=0.05, scheme=vv.BackwardEuler())
    return cube, system


GOUGH_JOULE = [
    (0.8, 0.0155559683, -305016.184787),
    (1.5, 0.0648219805, 422315.584940),
    (2.0, 0.2223064712, 700530.835851),
]


@pytest.mark.parametrize(("stretch", "rise", "stress"), GOUGH_JOULE)
def test_gough_joule(stretch: float, rise: float, stress: float) -> None:
    """A rubber band that is stretched fast warms; closed form of an incompressible one."""
    rubber = vv.NeoHooke(shear=0.4e6, lame_lambda=0.4e10)
    heat = vv.Heat(conductivity=1e-9, capacity=1.8e6, reference=293.15, moduli_slope=1 / 293.15)
    cube, system = pulled(rubber, heat, stretch)
    assert cube.temperatures(system.x) - 293.15 == pytest.approx(rise, rel=2e-3)
    held = cube.fields(system.x).first_piola[0, 0, 0, 0]
    assert held == pytest.approx(stress, rel=1e-3)


@pytest.mark.parametrize("isochoric", [False, True])
def test_rubber_that_expands_cools_before_it_warms(isochoric: bool) -> None:
    """Cooling turns into warming where ``3 K a ln J - W / T0`` does, of a rubber that is all but incompressible.

    Tension gives ``K ln J``: ``mu (1 - 1 / l)``, so that ``l^3 = 1 + 3 a T0``, and ``mu (l^2 - 1 / l) / 3`` where the
    energy of shape is apart, so that ``a T0 (2 l + 1 / l^2) = l - 1 / l^2``.
    """
    a, room, temperatures = 2.2e-4, 293.15, []
    rubber = vv.NeoHooke(shear=0.4e6, bulk=0.4e9, isochoric=isochoric)
    heat = vv.Heat(conductivity=1e-9, capacity=1.8e6, reference=room, expansion=a, moduli_slope=1 / room)
    cube = vv.ThermoelasticSolid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), material=rubber, heat=heat
    )
    sides = [vv.SymmetryPlane(solid=cube, nodes=f"{'xyz'[k]}0", normal=np.eye(3)[k]) for k in range(3)]
    end = vv.Prescribed(solid=cube, nodes="x1", motion=("0.15*t", None, None))
    vv.simulate(
        vv.System([cube, *sides, end]),
        until=1.0,
        step=0.05,
        scheme=vv.BackwardEuler(),
        observe=lambda s: temperatures.append(cube.temperatures(s.x).mean() - room),
    )
    least = int(np.argmin(temperatures))
    near = np.arange(least - 2, least + 3)
    fit = np.polynomial.Polynomial.fit(1 + 0.0075 * (near + 1), np.array(temperatures)[near], 3)
    turn = min(fit.deriv().roots(), key=lambda l: abs(l - 1.065)).real
    exact = (
        brentq(lambda l: a * room * (2 * l + l**-2) - (l - l**-2), 1.01, 1.3)
        if isochoric
        else np.cbrt(1 + 3 * a * room)
    )
    assert turn == pytest.approx(exact, abs=2e-4)
    assert temperatures[0] < 0 < temperatures[-1]


def test_kelvin_cooling() -> None:
    """Steel in tension cools: -alpha T0 sigma / (rho c_p), and is a little stiffer than at constant temperature."""
    alpha, T0, young, sigma, rho_cp = 1.2e-5, 293.15, 210e9, 100e6, 7850 * 460.0
    bulk = young / 3 / (1 - 0.6)
    rho_cv = rho_cp - 9 * alpha**2 * bulk * T0
    steel = vv.SaintVenantKirchhoff(young=young, poisson=0.3)
    heat = vv.Heat(conductivity=1e-9, capacity=rho_cv, expansion=alpha, reference=T0)
    adiabatic = 1 / (1 - young * alpha**2 * T0 / rho_cp)
    strain = sigma / (young * adiabatic)
    cube, system = pulled(steel, heat, 1 + strain)
    assert cube.temperatures(system.x) - T0 == pytest.approx(-0.097402812, rel=2e-3)
    held = cube.fields(system.x).first_piola[0, 0, 0, 0]
    assert held == pytest.approx(sigma, rel=2e-3)


COUPLED = [  # bc, epsilon, place, time, temperature, stress
    ("robin", 0.05, 1.0, 0.75, 0.107975471, -0.150818217),
    ("robin", 0.5, 1.0, 0.75, 0.0928191888, -0.127325959),
    ("robin", 0.5, 0.5, 1.25, 0.228073191, -0.00829914689),
    ("step", 0.5, 0.5, 1.25, 0.693807669, 0.0526709095),
]


@pytest.mark.parametrize(("bc", "epsilon", "place", "time", "temperature", "stress"), COUPLED)
def test_danilovskaya(
    bc: str, epsilon: float, place: float, time: float, temperature: float, stress: float
) -> None:
    """A half-space whose surface is heated, fully coupled; small enough to be linear."""
    n, length, small = 90, 3.6, 1e-5
    lam, mu = 0.4, 0.3
    beta = np.sqrt(epsilon)
    heat = vv.Heat(
        conductivity=1.0, capacity=1.0, expansion=beta / (3 * lam + 2 * mu), reference=1.0, in_space=False
    )
    mesh = vv.BoxMesh(size=(length, 0.1, 0.1), counts=(n, 1, 1))
    material = vv.SaintVenantKirchhoff(lame_lambda=lam, shear=mu)
    bar = vv.ThermoelasticSolid(mesh=mesh, material=material, density=1.0, heat=heat)
    parts: list[Any] = [vv.Fixed(solid=bar, nodes="all", directions=(False, True, True))]
    parts.append(vv.Fixed(solid=bar, nodes="x1", directions=(True, False, False)))
    if bc == "step":
        parts.append(vv.PrescribedTemperature(body=bar, nodes="x0", value=1 + small))
    else:
        parts.append(vv.Convection(body=bar, faces="x0", coefficient=0.5, ambient=1 + small))
    system = vv.System([bar, *parts])
    vv.simulate(system, until=time, step=0.025)
    found = float(vv.TemperatureAt(body=bar, at=(place, 0, 0))(system)) - 1
    assert found / small == pytest.approx(temperature, rel=6e-3)
    sigma = vv.FieldAt(solid=bar, field="second_piola", at=(place, 0.05, 0.05))(system)[0]
    assert sigma / (beta * small) == pytest.approx(stress, abs=6e-3)


def test_heat_through_boundaries_is_booked() -> None:
    """Everything that lets heat in at once: the balance closes to rounding."""
    body = flying()
    parts = [
        vv.PrescribedTemperature(body=body, nodes="x0", value="22 + sin(3*t)"),
        vv.Convection(body=body, faces="x1", coefficient=0.3, ambient=30.0),
        vv.Radiation(body=body, faces="y0", emissivity=0.5, ambient=25.0, constant=1e-6),
        vv.HeatFlux(body=body, faces="z0", flux="0.2*t"),
        vv.HeatSource(body=body, power=lambda t, X: 0.1 * X[:, 0]),
    ]
    system = vv.System([body, *parts], vv.Newton(tolerance=1e-13))
    result = vv.simulate(system, until=1.0, step=0.05)
    assert result.ledger.imbalance() < 1e-12
    assert body.temperatures(system.x)[body.nodes("x0")].mean() == pytest.approx(22 + np.sin(3.0), abs=0.2)


def test_prescribed_temperatures_are_shown_where_they_are_held() -> None:
    """At nodes of coarse cells, strained by what holds them: the projection from points gave 318.35."""
    steel = vv.Heat(conductivity=50.0, capacity=3.6e6, expansion=1e-4)
    body = vv.ThermoelasticSolid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2)),
        material=vv.NeoHooke(young=210e9, poisson=0.3),
        density=7850.0,
        heat=steel,
        temperature=300.0,
    )
    held = [vv.Fixed(solid=body, nodes=side) for side in ("x0", "x1")]
    system = vv.System([body, *held, vv.PrescribedTemperature(body=body, nodes="x0", value=320.0)])
    vv.simulate(system, until=800.0, step=400.0, scheme=vv.BackwardEuler())
    assert body.temperatures(system.x)[body.nodes("x0")] == pytest.approx(320.0, abs=1e-6)


def clamped_bar(coupling: float, n: int, cell: str = "hex8") -> tuple[vv.ThermoelasticSolid, list[Any]]:
    """A bar between walls that moves along alone; `coupling` is ``T0 beta^2 / (M c)``, M the modulus of its strain."""
    lam, mu, T0, c = 3e4, 2e4, 300.0, 1.0
    beta = np.sqrt(coupling * (lam + 2 * mu) * c / T0)
    heat = vv.Heat(
        conductivity=1.0, capacity=c, expansion=beta / (3 * lam + 2 * mu), reference=T0, in_space=False
    )
    mesh = vv.BoxMesh(size=(1, 0.1, 0.1), counts=(n, 1, 1), cell=cell)
    bar = vv.ThermoelasticSolid(
        mesh=mesh, material=vv.SaintVenantKirchhoff(lame_lambda=lam, shear=mu), heat=heat
    )
    walls = [vv.Fixed(solid=bar, nodes=end) for end in ("x0", "x1")]
    return bar, [*walls, vv.Fixed(solid=bar, nodes="all", directions=(False, True, True))]


COUPLINGS = [0.0, 0.02, 1.0, 5.0, 50.0]


@pytest.mark.parametrize("coupling", COUPLINGS)
@pytest.mark.parametrize("cell", ["hex8", "hex20"])
def test_a_clamped_bar_warms_by_its_effective_capacity(coupling: float, cell: str) -> None:
    """Ends of opposite temperatures about the mean: diffusion with ``c (1 + T0 beta^2 / (M c))``, by its series."""
    rise, late = 1e-3, 0.05
    bar, parts = clamped_bar(coupling, 40 if cell == "hex8" else 10, cell)
    held = [
        vv.PrescribedTemperature(body=bar, nodes=n, value=300 + side * rise)
        for n, side in (("x0", 1), ("x1", -1))
    ]
    system = vv.System([bar, *parts, *held])
    until = late * (1 + coupling)
    vv.simulate(system, until=until, step=until / 100, scheme=vv.BDF2())
    x = bar.points[:, 0]
    k = np.arange(1, 60)
    decay = np.exp(-((2 * np.pi * k) ** 2) * late) / k
    exact = 1 - 2 * x - 2 / np.pi * (np.sin(2 * np.pi * np.outer(x, k)) @ decay)
    np.testing.assert_allclose((bar.temperatures(system.x) - 300) / rise, exact, atol=1e-2)
    conducts = system.x[bar.algorithmic.start + np.arange(bar.grid.n_nodes)]
    np.testing.assert_allclose((conducts - 300) / rise, exact, atol=1e-2)


@pytest.mark.parametrize(
    ("coupling", "cell", "formulation", "words"),
    [
        (0.02, "hex8", "displacement", ()),
        (5.0, "hex8", "displacement", ("= 5 ", "take formulation='enhanced'")),
        (5.0, "hex20", "displacement", ()),
        (50.0, "hex8", "enhanced", ("= 50 ", "take BDF2() or BackwardEuler()")),
    ],
)
def test_strong_coupling_is_told_with_its_number(
    coupling: float, cell: str, formulation: Any, words: tuple[str, ...]
) -> None:
    bar, parts = clamped_bar(coupling, 4, cell)
    bar.formulation = formulation
    said = vv.System([bar, *parts]).check().remarks
    assert len(said) == bool(words)
    assert all(word in said[0] for word in words)


def test_the_cure_of_strong_coupling_goes_on() -> None:
    """Where walls warm by 10 K at a coupling of 50, and the energy-momentum scheme swings until a step fails."""
    bar, parts = clamped_bar(50.0, 10, "hex20")
    held = [
        vv.PrescribedTemperature(body=bar, nodes=n, value=f"300 + {side} * min(t / 0.51, 1)")
        for n, side in (("x0", 10), ("x1", -10))
    ]
    system = vv.System([bar, *parts, *held])
    vv.simulate(system, until=2.55, step=0.051, scheme=vv.BDF2())
    assert bar.temperatures(system.x)[bar.nodes("x0")] == pytest.approx(310.0, abs=1e-9)


@pytest.mark.parametrize("coupling", COUPLINGS[:-1])
@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.Midpoint(), vv.BackwardEuler()])
def test_the_temperature_that_conducts_is_the_held_one_however_strains_couple(
    coupling: float, scheme: Any
) -> None:
    """Steady, it is linear between what is held, whatever the coupling."""
    bar, parts = clamped_bar(coupling, 20)
    slow = 1 + coupling
    held = [
        vv.PrescribedTemperature(body=bar, nodes=n, value=f"300 + {rise} * min(t / {0.2 * slow}, 1)")
        for n, rise in (("x0", 10), ("x1", -10))
    ]
    system = vv.System([bar, *parts, *held])
    vv.simulate(system, until=0.8 * slow, step=0.01 * slow, scheme=scheme)
    conducts = system.x[bar.algorithmic.start + np.arange(bar.grid.n_nodes)]
    exact = 310 - 20 * bar.points[:, 0]
    np.testing.assert_allclose(conducts, exact, atol=1e-4)
    np.testing.assert_allclose(bar.temperatures(system.x), exact, atol=1e-2)
    ends = np.concatenate([bar.nodes("x0"), bar.nodes("x1")])
    np.testing.assert_allclose(bar.temperatures(system.x)[ends], exact[ends], atol=1e-6)


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.BackwardEuler()])
def test_temperatures_held_where_strains_are_singular_are_those_that_conduct(scheme: Any) -> None:
    """At the edges of the clamped faces of a cube of strong coupling, where those of 320 conducted as ones of 314."""
    for n in (2, 4):
        body = vv.ThermoelasticSolid(
            mesh=vv.BoxMesh(size=(1, 1, 1), counts=(n, n, n)),
            material=vv.NeoHooke(young=210e9, poisson=0.3),
            heat=vv.Heat(conductivity=50.0, capacity=3.6e6, expansion=5.3e-4, reference=300.0),
        )
        walls = [vv.Fixed(solid=body, nodes=side) for side in ("x0", "x1")]
        held = vv.PrescribedTemperature(body=body, nodes="x0", value="300 + 20 * min(t / 400, 1)")
        system = vv.System([body, *walls, held])
        result = vv.simulate(system, until=1200.0, step=100.0, scheme=scheme)
        nodes = body.nodes("x0")
        assert system.x[body.algorithmic.start + nodes] == pytest.approx(320.0, abs=1e-3)
        assert body.temperatures(system.x)[nodes] == pytest.approx(320.0, abs=1e-3)
        assert result.ledger.imbalance() < 1e-9 or isinstance(scheme, vv.BackwardEuler)


def test_conduction_turns_with_the_body() -> None:
    """A bar that spins conducts like one that rests."""
    ends = []
    for spin in (0.0, 3.0):
        mesh = vv.BoxMesh(size=(1, 0.2, 0.2), counts=(6, 1, 1))
        stiff = vv.NeoHooke(young=1e4, poisson=0.0)
        heat = vv.Heat(conductivity=0.1, capacity=1.0, reference=300.0)
        bar = vv.ThermoelasticSolid(
            mesh=mesh,
            material=stiff,
            density=1.0,
            heat=heat,
            temperature=lambda X: 300 + 50 * X[:, 0],
            angular_velocity=(0, 0, spin),
        )
        system = vv.System([bar])
        vv.simulate(system, until=1.0, step=0.02)
        ends.append(bar.temperatures(system.x))
    np.testing.assert_allclose(ends[1], ends[0], atol=1e-3)


def ideal(C: Any, T: Any) -> Any:
    return 0.5 * (C[0] + C[1] + C[2] - 3) + T - 20 - T * np.log(T / 20)


def rubber(C: Any, T: Any) -> Any:
    J2 = C[0] * (C[1] * C[2] - C[4] ** 2) - C[3] * (C[3] * C[2] - C[4] * C[5])
    log = np.log(J2 + C[5] * (C[3] * C[4] - C[1] * C[5]))
    return ideal(C, T) - 0.5 * log + 2 * log**2


BAD: list[tuple[dict[str, Any], str]] = [
    ({"temperature": -3.0}, "absolute zero"),
    (
        {"formulation": "mixed", "material": None, "heat": vv.UserHeat(function=rubber, conductivity=1.0)},
        "'mixed' is not for UserHeat; take 'F-bar' or 'enhanced' with hex8",
    ),
    (
        {"formulation": "mixed", "mesh": vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1), cell="tet4")},
        "pressures of tet4 would oscillate beside temperatures; take cells of second order",
    ),
    (
        {
            "formulation": "mixed",
            "mesh": vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1), cell="hex27"),
            "material": vv.NeoHooke(shear=1.0, poisson=0.5),
            "heat": vv.Heat(conductivity=1.0, capacity=1.0),
        },
        "pressures and heat need a material whose volume changes",
    ),
    ({"material": vv.LinearElastic(young=1.0, poisson=0.3)}, "no material of finite strains"),
    (
        {
            "mesh": vv.RectangleMesh(size=(1, 1), counts=(1, 1)),
            "plane": "stress",
            "material": None,
            "heat": vv.UserHeat(function=ideal, conductivity=1.0),
        },
        "plane = 'stress' is not for UserHeat; take 'strain'",
    ),
    ({"thermal_strain": 0.1}, "thermal_strain"),
]


@pytest.mark.parametrize(("change", "message"), BAD)
def test_bad_input(change: dict[str, Any], message: str) -> None:
    given = {"mesh": vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), "material": RUBBER, "heat": HEAT}
    with pytest.raises(vv.InputError, match=message):
        vv.ThermoelasticSolid(**{**given, **change})
    with pytest.raises(vv.InputError, match="capacity"):
        vv.Heat(conductivity=1.0, capacity=-1.0)


TABLE = "temperatures .* of its table of capacity do not increase"
ROOM = {"conductivity": 1.0, "reference": 20.0}


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: vv.Heat(conductivity=1.0, capacity=[(20.0, 1.0), (10.0, 2.0)]), TABLE),
        (lambda: vv.Heat(conductivity=1.0, capacity=[(20.0, 1.0), (20.0, 2.0)]), TABLE),
        (
            lambda: vv.Heat(conductivity=1.0, capacity=[(20.0, 1.0), (30.0, 0.0)]),
            "has 0, which is not positive",
        ),
        (
            lambda: warm(vv.Heat(**ROOM, capacity=1.0, capacity_slope=-0.5)),
            "capacity_slope = -0.5 leaves nothing",
        ),
        (
            lambda: warm(vv.Heat(**ROOM, capacity=1.0, moduli_slope=-0.5)),
            "moduli_slope = -0.5 leaves nothing",
        ),
        (
            lambda: warm(vv.Heat(**ROOM, capacity=1.0, conductivity_slope=-0.5)),
            "conductivity_slope = -0.5 leaves nothing",
        ),
        (
            lambda: own(lambda C, T: C[0] + C[1] + C[2] + 0.2 * T * T),
            "-T d2psi/dT2 of its function is -8 at rest",
        ),
        (lambda: own(lambda C, T: (C[0] + C[1] + C[2]) * T), "of its function is -0 at rest"),
    ],
)
def test_heat_without_positive_capacity_moduli_or_conductivity_is_refused(make: Any, message: str) -> None:
    with pytest.raises(vv.InputError, match=message):
        make()


def warm(heat: vv.Heat) -> vv.ThermoelasticSolid:
    """A cube ten degrees above the reference of its heat."""
    cube = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1))
    return vv.ThermoelasticSolid(mesh=cube, material=RUBBER, heat=heat, temperature=30.0)


def own(function: Any) -> vv.ThermoelasticSolid:
    cube = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1))
    heat = vv.UserHeat(function=function, conductivity=0.5, reference=20.0)
    return vv.ThermoelasticSolid(mesh=cube, density=1.0, heat=heat)


def test_contact_and_ties_say_that_they_are_insulated() -> None:
    one, two = (
        vv.ThermoelasticSolid(
            mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1), origin=(k, 0, 0)), material=RUBBER, heat=HEAT
        )
        for k in range(2)
    )
    tie = vv.Tie(first=one, first_faces="x1", second=two, second_faces="x0")
    assert any("no heat passes" in line for line in vv.System([one, two, tie]).check().remarks)


def test_a_failing_step_is_told_as_one() -> None:
    """States of a trial that are wild do not hide which step failed."""
    body = flying(heat=vv.Heat(conductivity=1e5, capacity=0.2, expansion=0.5, reference=20.0))
    with pytest.raises(vv.StepFailure):
        vv.System([body]).step(50.0)


@pytest.mark.parametrize("uneven", [0.0, 20.0, 100.0])
@pytest.mark.parametrize("analysis", ["equilibrium", "quasi_static"])
def test_statics_of_what_a_weak_exchange_holds_end_at_its_temperature(uneven: float, analysis: str) -> None:
    """That of the surroundings everywhere, however uneven it was at the start."""
    body = vv.ThermoelasticSolid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2)),
        material=vv.NeoHooke(young=1e6, poisson=0.3),
        heat=vv.Heat(conductivity=50.0, capacity=3.6e3, expansion=1e-4, reference=300.0),
        temperature=lambda X: 300 + uneven * X[:, 0],
    )
    weak = vv.HeatExchange(a=body, faces_a="x1", ambient=310.0, conductance=1e-3)
    system = vv.System([body, vv.Fixed(solid=body, nodes="x0"), weak])
    if analysis == "equilibrium":
        vv.equilibrium(system)
    else:
        vv.quasi_static(system, until=1.0, step=0.5)
    assert body.temperatures(system.x) == pytest.approx(310.0, abs=1e-6)


def test_steps_that_a_hump_of_capacity_fails_are_told_what_finds_a_way_over_it() -> None:
    """Latent heat over a kelvin, 2000 times the capacity: chilled within a fifth of a step, and then as it says.

    BDF2 gets over it with fixed steps, too: Newton's method went to and fro across it.
    """

    def chilled() -> vv.System:
        table = [(173.0, 1.0), (270.5, 1.0), (271.0, 2000.0), (271.5, 1.0), (373.0, 1.0)]
        bar = vv.ThermoelasticSolid(
            mesh=vv.BoxMesh(size=(1, 0.3, 0.3), counts=(8, 1, 1)),
            material=vv.NeoHooke(young=1e3, poisson=0.3),
            density=1e-3,
            heat=vv.Heat(conductivity=1.0, capacity=table, expansion=1e-4, reference=293.0),
        )
        cold = vv.PrescribedTemperature(body=bar, nodes="x0", value="293 - 50 * min(t / 0.1, 1)")
        return vv.System([bar, vv.Fixed(solid=bar, nodes="x0"), cold])

    words = r"capacity of .* is 2e\+03 times as much about 271: .* adaptive=vv.Adaptive\(tolerance=1e-3\)"
    with pytest.raises(vv.StepFailure, match=words):
        vv.simulate(chilled(), until=50.0, step=0.5, scheme=vv.BackwardEuler())
    assert vv.simulate(chilled(), until=5.0, step=0.5, scheme=vv.BDF2()).times[-1] == 5.0
    result = vv.simulate(
        chilled(), until=5.0, step=0.02, scheme=vv.BDF2(), adaptive=vv.Adaptive(tolerance=1e-3)
    )
    assert result.times[-1] == 5.0


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.BackwardEuler()])
def test_latent_heat_of_a_held_solid(scheme: vv.Scheme) -> None:
    """200 over 4 K: far above they cost no step, on them it loses what a lump does, c T' = 243 - T."""
    table = [(173.0, 1.0), (269.0, 1.0), (271.0, 101.0), (273.0, 1.0), (373.0, 1.0)]
    body = vv.ThermoelasticSolid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)),
        material=vv.NeoHooke(young=1.0, poisson=0.3),
        density=1e-3,
        heat=vv.Heat(conductivity=100.0, capacity=table, expansion=0.0, reference=293.0),
        temperature=293.0,
    )
    cold = vv.Convection(body=body, faces="all", coefficient=1 / 6, ambient=243.0)
    system = vv.System([body, vv.Fixed(solid=body, nodes="all"), cold])
    result = vv.simulate(system, until=0.2, step=0.02, scheme=scheme)
    order = 4e-3 if scheme.order == 1 else 2e-5  # of T
    assert len(result.times) == 11
    assert body.temperatures(system.x).mean() == pytest.approx(243 + 50 * np.exp(-0.2), rel=order)
    vv.simulate(system, until=6.0, step=0.05, scheme=scheme)
    T = np.linspace(293.0, body.temperatures(system.x).mean(), 200001)
    c = np.interp(T, *np.transpose(table))
    assert float(np.trapezoid(-c / (T - 243.0), T)) == pytest.approx(
        6.0, abs=0.1 if scheme.order == 1 else 0.01
    )


STEEL = [(293.0, 440.0), (873.0, 760.0), (973.0, 1008.0), (1008.0, 5000.0), (1060.0, 780.0), (1173.0, 650.0)]


@pytest.mark.parametrize(
    "table",
    [
        STEEL,
        [(272, 2e6), (273, 3e8), (274, 4.2e6)],
        [(269, 1), (271, 101), (273, 1)],
        [(290, 1), (310, 1e4), (330, 1)],
    ],
)
@pytest.mark.parametrize("zero", [250.0, 293.0, 1000.0])
def test_temperatures_of_tables_are_found_from_entropies(table: Any, zero: float) -> None:
    """Newton's method went to and fro across humps, and gave the last of its temperatures for the one sought."""
    capacity, T = capacity_of("table", table, 0.0, zero), np.linspace(200.0, 1300.0, 20001)
    np.testing.assert_allclose(capacity.temperature(capacity.entropy(T)), T, rtol=1e-11)


@pytest.mark.parametrize("T", [996.0, 998.0, 1009.42, 1013.42, 1022.0, 1030.0, 1050.0])
def test_an_insulated_solid_of_steel_keeps_its_temperature(T: float) -> None:
    body = vv.ThermoelasticSolid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)),
        material=vv.SaintVenantKirchhoff(young=2e5, poisson=0.3),
        heat=vv.Heat(conductivity=30.0, capacity=STEEL, reference=293.0),
        density=7850.0,
        temperature=T,
    )
    system = vv.System([body, vv.Prescribed(solid=body, nodes="all", motion=(0, 0, 0))])
    assert body.temperatures(system.x) == pytest.approx(T, rel=1e-12)
    vv.simulate(system, until=1.0, step=0.5)
    assert body.temperatures(system.x) == pytest.approx(T, rel=1e-9)


@pytest.mark.parametrize("slope", ["moduli_slope", "conductivity_slope"])
@pytest.mark.parametrize("thin", [False, True])
def test_no_step_ends_where_slopes_leave_nothing(slope: str, thin: bool) -> None:
    """Heated evenly from 300 K by 10 K per time: what falls by a tenth per kelvin is lost at t = 1."""
    heat = vv.Heat(conductivity=1.0, capacity=1.0, reference=300.0, **{slope: -0.1})
    rubber = vv.NeoHooke(young=100.0, poisson=0.3)
    body: Any
    if thin:
        section = vv.SolidSection(material=rubber, thickness=0.1, density=1.0)
        plate = vv.RectangleMesh(size=(1, 1), counts=(2, 2))
        body = vv.ThermalShell(name="hot", mesh=plate, section=section, heat=heat)
    else:
        mesh = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1))
        body = vv.ThermoelasticSolid(name="hot", mesh=mesh, material=rubber, density=1.0, heat=heat)
    system = vv.System([body, vv.HeatSource(body=body, power=10.0)])
    with pytest.raises(
        vv.StepFailure, match=f"'hot': {slope} = -0.1 leaves nothing positive at a temp.* of 310"
    ):
        vv.simulate(system, until=2.0, step=0.1)
    assert system.time == pytest.approx(1.0, abs=0.01)
    assert body.temperatures(system.x) == pytest.approx(310.0, abs=0.1)


@pytest.mark.parametrize("value", ["300+40*t**2", "320-20*cos(pi*t)", [(0, 300), (0.3, 300), (1, 340)]])
def test_held_temperatures_of_statics_may_start_flat(value: Any) -> None:
    """Their increments come all at once, whatever the work along them; the search for less of it had no end.

    They end where a ramp does.
    """
    ends = []
    for given in ("300+40*t", value):
        square = vv.ThermoelasticSolid(
            mesh=vv.RectangleMesh(size=(1, 1), counts=(1, 1)),
            material=vv.NeoHooke(young=1e3, poisson=0.0),
            heat=vv.Heat(conductivity=50.0, capacity=1.0, expansion=1e-4, reference=300.0),
        )
        held = vv.PrescribedTemperature(body=square, nodes="all", value=given)
        system = vv.System([square, vv.Fixed(solid=square, nodes="x0"), held])
        assert vv.quasi_static(system, until=1.0, step=0.25).statistics.rejected == 0
        assert square.temperatures(system.x) == pytest.approx(340.0, rel=1e-12)
        ends.append(square.positions(system.x))
    assert np.abs(ends[1] - ends[0]).max() < 1e-12
    assert ends[0][:, 1].max() > 1.002


def test_a_body_that_begins_far_from_its_reference_is_told_what_it_springs_open_by() -> None:
    """Free steel at 700 K cools by what its sudden expansion takes, without any heat: to first order as it is told."""

    def block(reference: float) -> vv.ThermoelasticSolid:
        return vv.ThermoelasticSolid(
            mesh=vv.BoxMesh(size=(0.02, 0.01, 0.01), counts=(2, 1, 1)),
            material=vv.NeoHooke(young=200e9, poisson=0.3),
            heat=vv.Heat(conductivity=45.0, capacity=3.744e6, expansion=1.2e-5, reference=reference),
            temperature=700.0,
            density=7800.0,
        )

    assert block(700.0).remarks() == []
    free = block(293.15)
    (remark,) = free.remarks()
    told = re.search(r"changes its temperature by (\S+) K", remark)
    assert told
    system = vv.System([free])
    vv.simulate(system, until=1.0, step=0.05, scheme=vv.BackwardEuler())
    assert free.temperatures(system.x).mean() - 700 == pytest.approx(float(told[1]), rel=0.1)


@pytest.mark.parametrize("kind", ["shell", "beam"])
def test_thin_bodies_say_so_too(kind: str) -> None:
    heat = vv.Heat(conductivity=45.0, capacity=3.744e6, expansion=3e-5, reference=293.15)
    body: vv.ThermalShell | vv.ThermalBeam
    if kind == "shell":
        section = vv.SolidSection(
            material=vv.NeoHooke(young=200e9, poisson=0.3), thickness=0.01, density=7800.0
        )
        mesh = vv.RectangleMesh(size=(0.1, 0.1), counts=(2, 2))
        body = vv.ThermalShell(mesh=mesh, section=section, heat=heat, temperature=600.0)
    else:
        profile = vv.RectangleSection(width=0.01, height=0.01, young=200e9, density=7800.0)
        line = vv.LineMesh(points=[(0, 0, 0), (0.1, 0, 0)], count=4)
        body = vv.ThermalBeam(mesh=line, section=profile, heat=heat, temperature=600.0)
    (remark,) = body.remarks()
    system = vv.System([body])
    vv.simulate(system, until=1.0, step=0.05, scheme=vv.BackwardEuler())
    told = re.search(r"changes its temperature by (\S+) K", remark)
    assert told
    assert body.temperatures(system.x).mean() - 600 == pytest.approx(float(told[1]), rel=0.12)
