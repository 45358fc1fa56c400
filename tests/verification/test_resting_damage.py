"""Small motions and stability of solids that crack, whose damages rest: those of solids that never do."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from visviva.scheme.schemes import load_step
from visviva.system.stability import count_falling

Array = NDArray[np.float64]

YOUNG = 1000.0
ELASTIC = {"toughness": 1e3, "length": 1.0, "model": "AT1"}
"""Of a strength of 612, a hundred times what acts here."""


def made(elastic: bool, young: float = YOUNG, poisson: float = 0.25, **given: Any) -> vv.Solid:
    given = {"material": vv.SaintVenantKirchhoff(young=young, poisson=poisson), "density": 1.0, **given}
    if not elastic:
        return vv.FracturingSolid(**given)
    names = ("toughness", "length", "model", "split", "irreversibility")
    return vv.Solid(**{name: value for name, value in given.items() if name not in names})


def cantilever(elastic: bool) -> tuple[vv.Solid, vv.System]:
    solid = made(elastic, mesh=vv.RectangleMesh(size=(4, 1), counts=(12, 3)), **ELASTIC)
    parts = [solid, vv.Fixed(solid=solid, nodes="x0"), vv.Gravity(acceleration=(0, -0.5, 0))]
    return solid, vv.System(parts)


def blade(elastic: bool) -> vv.System:
    mesh = vv.BoxMesh(size=(4, 0.4, 0.4), counts=(3, 1, 1), cell="hex27")
    solid = made(elastic, mesh=mesh, **ELASTIC)
    frame = vv.RotatingFrame(angular_velocity=(0, 0, 1.0), times="t")
    system = vv.System([solid, vv.Fixed(solid=solid, nodes="x0"), frame])
    vv.quasi_static(system, until=1.0, step=0.5)
    return system


def bar(stress: Any, elastic: bool = False, **given: Any) -> tuple[vv.Solid, vv.System]:
    """Free to narrow, pulled at its end by a stress that is a function of time."""
    solid = made(elastic, mesh=vv.BoxMesh(size=(4, 1, 1), counts=(8, 1, 1)), **given)
    sides = [
        vv.SymmetryPlane(solid=solid, nodes=f"{axis}0", normal=normal)
        for axis, normal in zip("xyz", np.eye(3).tolist(), strict=True)
    ]
    pull = vv.Traction(solid=solid, faces="x1", traction=(1, 0, 0), times=stress)
    return solid, vv.System([solid, *sides, pull])


def column(elastic: bool, **given: Any) -> vv.System:
    mesh = vv.RectangleMesh(size=(10, 0.5), counts=(10, 1), cell="quad9")
    solid = made(elastic, mesh=mesh, **{"toughness": 1.0, "length": 10.0, **given})
    press = vv.Traction(solid=solid, faces="x1", traction=(-0.2, 0, 0), times="t")
    return vv.System([solid, vv.Fixed(solid=solid, nodes="x0"), press])


def test_a_cantilever_below_its_strength_vibrates_and_rests_as_a_solid() -> None:
    found = []
    for elastic in (False, True):
        solid, system = cantilever(elastic)
        vv.quasi_static(system, until=1.0, step=1.0)
        modes = vv.modes(system, 3)
        _, other = cantilever(elastic)
        vv.equilibrium(other)  # which finds it stable, as statics do
        assert solid.displacements(other.x) == pytest.approx(solid.displacements(system.x), abs=1e-9)
        assert modes.stable
        assert vv.modes(other, 3).angular == pytest.approx(modes.angular, rel=1e-6)
        found.append(modes.angular)
    assert found[0] == pytest.approx(found[1], rel=1e-9)


def test_a_blade_that_spins_vibrates_as_a_solid() -> None:
    cracking, elastic = (vv.modes(blade(kind), 2) for kind in (False, True))
    assert cracking.stable
    assert cracking.angular == pytest.approx(elastic.angular, rel=1e-8)


@pytest.mark.parametrize("part", [0.25, 0.9])
def test_a_bar_below_its_strength_vibrates_as_a_solid(part: float) -> None:
    """Its strength is sqrt(3 E Gc / 8 l)."""
    stress = part * np.sqrt(3 * YOUNG / 80)
    found = []
    for elastic in (False, True):
        _, system = bar(lambda t: stress * t, elastic, toughness=1.0, length=10.0, model="AT1")
        vv.quasi_static(system, until=1.0, step=0.5)
        found.append(vv.modes(system, 3).angular)
    assert found[0] == pytest.approx(found[1], rel=1e-9)


@pytest.mark.parametrize("irreversibility", ["active set", "history"])
@pytest.mark.parametrize("back", [0.0, 0.6])
def test_a_damaged_bar_vibrates_with_the_stiffness_that_is_left(back: float, irreversibility: Any) -> None:
    """Loaded, and unloaded: as a solid of the modulus (1 - d)^2 E under the same load."""
    given = {"toughness": 1.0, "length": 10.0, "irreversibility": irreversibility}
    solid, system = bar(lambda t: 3 * min(t, 2 - t), **given)
    vv.quasi_static(system, until=1.0, step=0.25)
    if back:
        vv.quasi_static(system, until=1 + back, step=0.3)
    d = solid.damages(system.x)
    assert d.min() > 0.1
    assert np.ptp(d) < 1e-9
    _, weak = bar(lambda t: 3 * (1 - back) * t, True, young=(1 - d[0]) ** 2 * YOUNG)
    vv.quasi_static(weak, until=1.0, step=0.5)
    assert vv.modes(system, 3).angular == pytest.approx(vv.modes(weak, 3).angular, rel=1e-5)


def test_a_damaged_bar_has_the_frequency_of_its_closed_form() -> None:
    """(pi / 2 L) sqrt(g E / rho), at strains of some 1e-5, of cells whose error is (k h)^2 / 24."""
    solid, system = bar(lambda t: 3e-2 * min(t, 2 - t), poisson=0.0, toughness=1e-4, length=10.0)
    vv.quasi_static(system, until=1.5, step=0.25)
    g = (1 - solid.damages(system.x).mean()) ** 2
    assert g < 0.9
    closed = np.pi / 8 * np.sqrt(g * YOUNG)
    cells = 1 + (np.pi / 8 * 0.5) ** 2 / 24
    assert vv.modes(system, 1).angular[0] == pytest.approx(closed * cells, rel=1e-4)


def test_columns_that_do_not_crack_yet_buckle_as_solids() -> None:
    found = []
    for elastic in (False, True):
        system = column(elastic, model="AT1")
        vv.quasi_static(system, until=1.0, step=0.5)
        found.append(vv.buckling(system, 2).factors)
    assert found[0] == pytest.approx(found[1], rel=1e-6)


def test_columns_that_soften_as_they_are_pressed_are_refused() -> None:
    system = column(False, model="AT2")
    assert vv.buckling(system, 1).factors == pytest.approx(vv.buckling(column(True), 1).factors, rel=1e-9)
    vv.quasi_static(system, until=1.0, step=0.5)
    with pytest.raises(
        vv.InputError, match=r"damage of FracturingSolid '.*' grows with the loads, at .* nodes"
    ):
        vv.buckling(system, 1)
    with pytest.raises(vv.InputError, match=r"damage of FracturingSolid '.*' follows a history field"):
        vv.buckling(column(False, irreversibility="history"), 1)


@pytest.mark.parametrize("model", ["AT1", "AT2"])
def test_stability_is_the_same_by_both_counts(model: Any) -> None:
    """A bar that is stretched, below its peak and beyond, where damage that localises sets energy free."""
    mesh = vv.RectangleMesh(size=(4, 0.25), counts=(16, 1))
    solid = made(False, poisson=0.0, mesh=mesh, toughness=1e-4, length=0.5, model=model)
    parts = [
        vv.Fixed(solid=solid, nodes="x0", directions=(True, False, False)),
        vv.Fixed(solid=solid, nodes=[0]),
        vv.Prescribed(solid=solid, nodes="x1", motion=("2e-3 * t", None, None)),
    ]
    system, seen = vv.System([solid, *parts]), []
    for k in range(1, 7):
        vv.quasi_static(system, until=0.25 * k, step=0.25, scheme=vv.Static(unstable=True))
        found = count_falling(system, load_step(system.time, 0.0))
        assert found == system.stepper.stability.falling
        seen.append(found)
    assert seen[0] == 0
    assert max(seen) > 0


def test_damage_out_of_balance_is_refused() -> None:
    """Clamped, and strained by nothing but heat: damage is to balance 2 W (1 - d) = Gc d / l."""
    mesh = vv.RectangleMesh(size=(1, 1), counts=(2, 2))
    solid = made(False, mesh=mesh, toughness=1.0, length=1.0, free_strain=-0.02)
    edge = np.flatnonzero(np.abs(solid.points[:, :2] - 0.5).max(axis=1) > 0.49)
    system = vv.System([solid, vv.Fixed(solid=solid, nodes=edge.tolist())])
    stretch = 0.98
    energy = 4.5 * YOUNG / 1.5 * (0.5 * (stretch**-2 - 1)) ** 2 * stretch**3
    closed = 2 * energy / (2 * energy + 1)
    with pytest.raises(vv.InputError, match=f"no equilibrium: damage of .* would grow by {closed:.3g}"):
        vv.modes(system, 1)
    vv.equilibrium(system)
    assert solid.damages(system.x) == pytest.approx(closed, rel=1e-5)
    assert vv.modes(system, 1).stable
