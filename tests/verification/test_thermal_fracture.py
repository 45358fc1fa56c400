"""Solids that crack and conduct heat: free and held expansion, conduction, Kelvin's heat of straining, both laws."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv

YOUNG, TOUGHNESS, LENGTH, EXPANSION = 1.0, 3e-10, 0.5, 1e-6
GREEN = vv.SaintVenantKirchhoff(young=YOUNG, poisson=0.3)
HEAT = vv.Heat(conductivity=1.0, capacity=1.0, expansion=EXPANSION, reference=300.0)


def bar(**options: Any) -> vv.ThermalFracturingSolid:
    given: dict[str, Any] = {
        "mesh": vv.BoxMesh(size=(1, 0.5, 0.5), counts=(2, 1, 1)),
        "material": GREEN,
        "heat": HEAT,
        "toughness": TOUGHNESS,
        "length": LENGTH,
        "name": "bar",
        **options,
    }
    return vv.ThermalFracturingSolid(**given)


def cooled(solid: vv.ThermalFracturingSolid, value: str, *supports: vv.Component) -> vv.System:
    """A bar on planes of symmetry whose nodes have temperatures."""
    planes = [
        vv.SymmetryPlane(solid=solid, nodes=nodes, normal=normal)
        for nodes, normal in (("x0", (1, 0, 0)), ("y0", (0, 1, 0)), ("z0", (0, 0, 1)))
    ]
    given = vv.PrescribedTemperature(body=solid, nodes="all", value=value)
    return vv.System([solid, *planes, *supports, given])


@pytest.mark.parametrize("rise", [100, -100])
def test_what_expands_freely_does_not_crack(rise: float) -> None:
    solid = bar()
    system = cooled(solid, f"300 + {rise}*t")
    vv.quasi_static(system, until=1.0, step=0.5, scheme=vv.Static())
    assert solid.damages(system.x).max() < 1e-12
    assert solid.crack_energy(system.x) < 1e-12 * TOUGHNESS
    stretch = solid.positions(system.x)[:, :3] - (1 + rise * EXPANSION) * solid.points
    assert np.abs(stretch).max() < 1e-12


def test_a_bar_that_is_held_cracks_at_the_closed_form_strain() -> None:
    """AT1: nothing until alpha dT = sqrt(3 Gc / 8 l E), in a step of a hundredth of that."""
    critical = np.sqrt(3 * TOUGHNESS / (8 * LENGTH * YOUNG))
    solid = bar(model="AT1")
    drop = float(critical / EXPANSION)
    held = vv.Fixed(solid=solid, nodes="x1", directions=(True, False, False))
    system = cooled(solid, f"300 - {drop!r}*t", held)
    found = []
    for _ in vv.march(system, until=1.1, step=0.01, scheme=vv.Static(unstable=True)):
        found.append((system.time, solid.damages(system.x).max()))
    t, d = np.array(found).T
    assert d[t < 0.9951].max() < 1e-12
    assert d[t > 1.0051].min() > 1e-3


def test_damage_of_a_cooled_bar_that_is_held() -> None:
    """AT2: d = E e^2 / (E e^2 + Gc / l) of e = alpha dT."""
    solid = bar()
    held = vv.Fixed(solid=solid, nodes="x1", directions=(True, False, False))
    system = cooled(solid, "300 - 40*t", held)
    for _ in vv.march(system, until=1.0, step=0.1, scheme=vv.Static(unstable=True)):
        drive = YOUNG * (40 * system.time * EXPANSION) ** 2
        assert solid.damages(system.x) == pytest.approx(drive / (drive + TOUGHNESS / LENGTH), rel=2e-4)
    assert solid.damages(system.x).min() > 0.5


def conducting(kind: type[vv.ThermoelasticSolid], mesh: Any, **options: Any) -> tuple[Any, np.ndarray]:
    heat = vv.Heat(conductivity=2.0, capacity=3.0, reference=300.0)
    body = kind(
        mesh=mesh,
        material=GREEN,
        density=1e-3,
        heat=heat,
        temperature=lambda X: 320 + 40 * np.cos(np.pi * X[:, 0]),
        **options,
    )
    system = vv.System([body, vv.Fixed(solid=body, nodes="all")])
    vv.simulate(system, until=0.1, step=0.01)
    return body, body.temperatures(system.x)


def test_heat_flows_as_where_nothing_cracks() -> None:
    """As in a `ThermoelasticSolid`, to rounding, in the plane too; a cosine decays as exp(-pi^2 k t / c)."""
    box = vv.BoxMesh(size=(1, 0.1, 0.1), counts=(16, 1, 1))
    crack: dict[str, Any] = {"toughness": 1.0, "length": 0.5}
    body, known = conducting(vv.ThermoelasticSolid, box)
    _, found = conducting(vv.ThermalFracturingSolid, box, **crack)
    np.testing.assert_allclose(found, known, rtol=1e-12)
    flat = vv.RectangleMesh(size=(1, 0.1), counts=(16, 1))
    plate, found = conducting(vv.ThermalFracturingSolid, flat, **crack)
    row, other = (np.argsort(b.points[b.nodes("y0"), 0]) for b in (plate, body))
    in_plane, in_space = found[plate.nodes("y0")[row]], known[body.nodes("y0")[other]].reshape(17, 2)[:, 0]
    np.testing.assert_allclose(in_plane, in_space, rtol=1e-12)
    decay = np.exp(-(np.pi**2) * 2.0 / 3.0 * 0.1)
    assert np.ptp(known) == pytest.approx(80 * decay, rel=0.01)


@pytest.mark.parametrize("share", [1.0, 0.25])
def test_a_crack_lets_a_share_of_the_heat_through(share: float) -> None:
    """Through a bar that is damaged evenly: dT = q L / k (share + (1 - share) (1 - d)^2)."""
    solid = bar(damage=0.4, cracked_conductivity=share, heat=vv.Heat(conductivity=2.0, capacity=1.0))
    cold = vv.PrescribedTemperature(body=solid, nodes="x0", value=290)
    heated = vv.HeatFlux(body=solid, faces="x1", flux=5.0)
    system = vv.System([solid, vv.Fixed(solid=solid, nodes="all"), cold, heated])
    vv.quasi_static(system, until=1.0, step=1.0, scheme=vv.Static())
    left = share + (1 - share) * 0.6**2
    rise = solid.temperatures(system.x)[solid.nodes("x1")] - 290
    assert rise == pytest.approx(5.0 / (2.0 * left), rel=1e-4)


def test_straining_cools_as_kelvin_says() -> None:
    """dT = -3 K alpha T tr(e) / c where no heat flows in; the core's temperature is that of Python."""
    heat = vv.Heat(conductivity=1.0, capacity=1.0, expansion=1e-4, reference=300.0)
    solid = bar(heat=heat, density=1e-6, toughness=1.0)
    moved = vv.Prescribed(solid=solid, nodes="all", motion=lambda t, X: 1e-6 * t * X)
    system = vv.System([solid, moved])
    vv.simulate(system, until=1.0, step=1.0, scheme=vv.BackwardEuler())
    cooling = 3 * (YOUNG / (3 * (1 - 0.6))) * 1e-4 * 300 * 3e-6
    found = solid.temperatures(system.x)
    assert found - 300 == pytest.approx(-cooling, rel=1e-4)
    np.testing.assert_allclose(system.x[solid.algorithmic.unknowns], found, rtol=1e-12)


@pytest.mark.parametrize("cold", [300.0, 550.0, 580.0])
def test_a_quenched_plate_needs_no_short_steps(cold: float) -> None:
    """Where it is as hot as at the start the entropy vanishes: rounding of energies swung temperatures there."""
    plate = vv.ThermalFracturingSolid(
        mesh=vv.RectangleMesh(size=(0.01, 0.01), counts=(10, 10)),
        material=vv.SaintVenantKirchhoff(young=340e9, poisson=0.22),
        heat=vv.Heat(conductivity=20.0, capacity=3.5e6, expansion=8e-6, reference=600.0),
        toughness=42.0,
        length=2e-3,
        density=3900.0,
        temperature=600.0,
    )
    system = vv.System([plate, vv.PrescribedTemperature(body=plate, nodes="y0", value=cold)])
    result = vv.simulate(system, until=1e-7, step=1e-8)
    assert result.statistics.rejected == 0
    assert result.conservation()["energy"] < 1e-10
    assert 0.2 < plate.damages(system.x).max() < 1.05


def test_a_start_far_from_the_reference_all_over_is_told() -> None:
    """By the damage of an even free strain, d = 2 W / (2 W + Gc / l); a part of it at the reference is none of that."""
    strain, E = 100 * EXPANSION, YOUNG / (1 - 2 * 0.3)
    W = (1 + strain) ** 3 * 1.5 * E * (0.5 * (1 / (1 + strain) ** 2 - 1)) ** 2
    told = 2 * W / (2 * W + TOUGHNESS / LENGTH)
    (remark,) = [r for r in bar(temperature=400.0).remarks() if "reference" in r]
    assert "reference 300 K of its heat" in remark
    assert f"that damages it by {told:.2g} all over" in remark
    assert not [r for r in bar(temperature=lambda X: 300 + 100 * X[:, 0]).remarks() if "reference" in r]


@pytest.mark.parametrize("model", ["AT1", "AT2"])
def test_energy_and_entropy_of_a_bar_that_breaks(model: Any) -> None:
    """Kinetic, elastic and crack energy and heat are kept to rounding, with momenta; entropy never falls."""
    solid = vv.ThermalFracturingSolid(
        mesh=vv.RectangleMesh(size=(4, 1), counts=(16, 4)),
        material=vv.NeoHooke(young=100.0, poisson=0.3),
        density=1.0,
        toughness=0.02,
        length=0.5,
        model=model,
        heat=vv.Heat(conductivity=0.1, capacity=0.5, expansion=1e-3, reference=300.0),
        temperature=lambda X: 300 + 5 * X[:, 1],
        cracked_conductivity=0.1,
        velocity=lambda X: np.stack([1.1 * (X[:, 0] - 2), 0 * X[:, 0], 0 * X[:, 0]], axis=1),
    )
    result = vv.simulate(vv.System([solid]), until=0.3, step=0.01)
    assert solid.damages(result.states[-1]).max() > 0.95
    total = result.ledger["total"]
    assert np.abs(total - total[0]).max() < 1e-12 * result.ledger.energy_scale
    assert max(result.conservation().values()) < 1e-11
    entropy = [solid.total_entropy(x) for x in result.states]
    assert np.diff(entropy).min() > 0
    steps = zip(result.states, result.states[1:], strict=False)
    assert all((solid.damages(b) >= solid.damages(a)).all() for a, b in steps)


@pytest.mark.parametrize("time", [1.0, 1e4])
def test_energy_is_kept_in_all_units_of_time(time: float) -> None:
    """Where entropies were small numbers the correction that keeps it was left out of theirs: 2e-6."""
    stress = time**-2
    solid = vv.ThermalFracturingSolid(
        mesh=vv.BoxMesh(size=(1, 1, 0.3), counts=(2, 2, 1)),
        material=vv.SaintVenantKirchhoff(young=50 * stress, poisson=0.2),
        density=1.0,
        velocity=lambda X: 0.5 / time * np.c_[X[:, 2], 0 * X[:, 0], X[:, 2] / 0.3 * (1 + X[:, 0])],
        heat=vv.Heat(
            conductivity=0.5 * stress / time, capacity=0.2 * stress, expansion=0.005, reference=20.0
        ),
        temperature=lambda X: 22 + 4 * X[:, 0],
        toughness=0.05 * stress,
        length=0.9,
    )
    system = vv.System([solid], newton=vv.Newton(tolerance=1e-12))
    result = vv.simulate(system, until=0.4 * time, step=0.02 * time)
    assert result.conservation()["energy"] < 1e-13
    assert result.ledger["kinetic"][-1] * time**2 == pytest.approx(0.0273513916245, rel=1e-9)
