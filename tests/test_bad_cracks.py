"""Solids that crack refuse what cannot be meant, with values and cures."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv

STEEL = vv.SaintVenantKirchhoff(young=210.0, poisson=0.3)
GOOD: dict[str, Any] = {
    "mesh": vv.RectangleMesh(size=(1, 1), counts=(10, 10)),
    "material": STEEL,
    "toughness": 1e-3,
    "length": 0.2,
    "name": "plate",
}


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"length": 0.05}, r"length = 0.05 is below the size of its smallest cell, 0.1;.*0.025 or finer"),
        ({"length": 0.0}, "length = 0 is not positive"),
        ({"toughness": -1.0}, "toughness = -1 is not positive"),
        ({"residual": 0.0}, "residual = 0 must lie between 0 and 1: without any stiffness"),
        ({"residual": 1.0}, "residual = 1 must lie between 0 and 1"),
        ({"damage": 1.5}, "a damage of 1.5 is outside 0 ... 1"),
        ({"damage": lambda X: -X[:, 0]}, "a damage of -1 is outside 0 ... 1"),
        ({"damage": lambda X: np.full(len(X), np.nan)}, "a damage of nan is outside 0 ... 1"),
        ({"damage": lambda X: np.zeros(3)}, r"gave shape \(3,\)"),
        (
            {"material": vv.LinearElastic(young=1.0, poisson=0.3)},
            "no material of finite strains.*SaintVenantKirchhoff",
        ),
        ({"material": vv.UserMaterial(function=lambda C: C[0])}, "no material of finite strains of the core"),
        (
            {"split": "spectral", "material": vv.NeoHooke(young=1.0, poisson=0.3)},
            "split = 'spectral' does not know NeoHooke",
        ),
        (
            {"split": "volumetric", "material": vv.NeoHooke(young=1.0, poisson=0.3)},
            "or one of isochoric=True",
        ),
        ({"thermal_strain": 0.1}, "strains of heat are its free_strain"),
        ({"plane": "stress"}, "plane = 'stress' does not crack yet"),
        ({"formulation": "F-bar"}, "formulation = 'F-bar' does not crack yet"),
        ({"stiffness_damping": 0.1}, "takes no"),
        ({"model": "AT3"}, "model"),
        (
            {"irreversibility": "history", "damage": 0.5},
            "would heal a damage of 0.5 at the start.*Mesh.opened",
        ),
        ({"irreversibility": "history", "free_strain": 0.01}, "'history' knows no free_strain yet"),
    ],
)
def test_what_is_refused(options: dict[str, Any], message: str) -> None:
    with pytest.raises(vv.InputError, match=message) as found:
        vv.FracturingSolid(**{**GOOD, **options})
    assert "plate" in str(found.value) or "model" in options


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"free_strain": 0.01}, r"takes no free_strain; heat strains it, by vv.Heat\(expansion="),
        ({"irreversibility": "history"}, "'history' knows no heat yet"),
        ({"lumped": True, "density": 1.0}, "takes no lumped masses"),
        ({"cracked_conductivity": 0.0}, "cracked_conductivity = 0 is no share"),
        ({"cracked_conductivity": 1.5}, "cracked_conductivity = 1.5 is no share"),
        ({"heat": vv.Heat(conductivity=1.0, capacity=1.0, moduli_slope=1e-3)}, "moduli_slope = 0.001"),
        ({"temperature": -1.0}, "not above absolute zero"),
        ({"plane": "stress"}, "plane = 'stress' does not crack yet"),
        (
            {
                "material": None,
                "heat": vv.UserHeat(function=lambda C, T: 3.0 * (T - T * np.log(T)), conductivity=1.0),
            },
            "material",
        ),
    ],
)
def test_what_is_refused_where_heat_flows(options: dict[str, Any], message: str) -> None:
    heat = vv.Heat(conductivity=1.0, capacity=1.0)
    with pytest.raises(vv.InputError, match=message):
        vv.ThermalFracturingSolid(**{**GOOD, "heat": heat, **options})


def test_going_to_and_fro_is_refused_where_heat_hides_the_energy_of_cracks() -> None:
    heat = vv.Heat(conductivity=1.0, capacity=1.0)
    solid = vv.ThermalFracturingSolid(**{**GOOD, "heat": heat})
    system = vv.System([solid, vv.Fixed(solid=solid, nodes="y0")])
    with pytest.raises(vv.InputError, match="'plate' holds heat, beside which"):
        vv.quasi_static(system, until=1.0, step=0.5, scheme=vv.AlternateMinimization())


@pytest.mark.parametrize("strain", [lambda t, X: 0.0, lambda t, X: np.full(len(X), -2.0)])
def test_free_strains_are_those_of_the_nodes(strain: Any) -> None:
    solid = vv.FracturingSolid(**{**GOOD, "free_strain": strain})
    with pytest.raises(vv.InputError, match="free_strain gave shape"):
        vv.System([solid])


@pytest.mark.parametrize(("model", "share"), [("AT1", 25), ("AT2", 33)])
def test_coarse_cells_are_told_before_the_first_step(model: str, share: int) -> None:
    """Between one length and half of it they add to the toughness, ``3 h / 8 l`` or ``h / 2 l``, as the check says."""
    coarse = vv.FracturingSolid(**{**GOOD, "length": 0.15, "model": model})
    told = str(vv.System([coarse]).check())
    assert "larger than half the length 0.15" in told
    assert f"costs {share} % more" in told
    fine = vv.FracturingSolid(**GOOD)
    assert not fine.remarks()


@pytest.mark.parametrize(
    "scheme", [vv.AlternateMinimization(), vv.CrackControl(growth=1.0)], ids=["to and fro", "crack control"]
)
def test_schemes_of_cracks_want_something_that_cracks(scheme: vv.Static) -> None:
    solid = vv.Solid(mesh=GOOD["mesh"], material=STEEL)
    system = vv.System([solid, vv.Fixed(solid=solid, nodes="x0")])
    with pytest.raises(vv.InputError, match="nothing here has damage"):
        vv.quasi_static(system, until=1.0, step=0.5, scheme=scheme)


@pytest.mark.parametrize("until", [-1e-3, 0.0])
def test_paths_of_cracks_do_not_end_before_they_begin(until: float) -> None:
    """One state came back without a word."""
    solid = vv.FracturingSolid(**GOOD)
    pulled = vv.Prescribed(solid=solid, nodes="x1", motion=("t", None, None))
    system = vv.System([solid, vv.Fixed(solid=solid, nodes="x0"), pulled])
    for analysis in (vv.quasi_static, vv.arc_length):
        with pytest.raises(vv.InputError, match="is not after the present load parameter 0"):
            analysis(system, until=until, step=1e-3, scheme=vv.CrackControl(growth=1.0))


@pytest.mark.parametrize(
    ("scheme", "message"),
    [
        (lambda: vv.CrackControl(), "growth"),
        (lambda: vv.CrackControl(growth=-1.0), "growth"),
        (lambda: vv.CrackControl(growth=1.0, branch=0.1), "branch goes with vv.ArcLength"),
        (lambda: vv.AlternateMinimization(energy_tolerance=0.0), "energy_tolerance"),
        (lambda: vv.AlternateMinimization(rounds=0), "rounds"),
    ],
)
def test_options_of_schemes(scheme: Any, message: str) -> None:
    with pytest.raises(vv.InputError, match=message):
        scheme()


def test_a_tip_needs_a_direction_and_a_level() -> None:
    solid = vv.FracturingSolid(**GOOD)
    with pytest.raises(vv.InputError, match="no direction"):
        vv.CrackTip(solid=solid, along=(0, 0, 0))
    with pytest.raises(vv.InputError, match="level = 1 is not between"):
        vv.CrackTip(solid=solid, along=(1, 0, 0), level=1.0)


def test_a_jump_that_newtons_method_does_not_get_over_is_told_with_its_cures() -> None:
    solid = vv.FracturingSolid(**{**GOOD, "toughness": 1e-6, "model": "AT1"})
    held = vv.Fixed(solid=solid, nodes="y0")
    moved = vv.Prescribed(solid=solid, nodes="y1", motion=(0, "0.01*t", None))
    system = vv.System([solid, held, moved])
    with pytest.raises(vv.NoEquilibrium, match=r"vv\.arc_length"):
        vv.quasi_static(system, until=1.0, step=0.1, scheme=vv.Static(unstable=True, halvings=2))


def test_cells_that_are_coarser_elsewhere_are_told() -> None:
    """A bar with fine cells at one end broke at its thin place, by cells of two lengths: 1.36 for a section of .7."""
    mesh = vv.RectangleMesh(size=(4.0, 1.0), counts=(30, 10), grading=(4.0, 1.0))
    told = vv.FracturingSolid(**{**GOOD, "mesh": mesh, "length": 0.25}).remarks()
    assert len(told) == 1
    assert "some of its cells are up to" in told[0]


@pytest.mark.parametrize(("wide", "told"), [(0.01, True), (0.06, False)])
def test_cracks_that_are_lines_of_nodes_are_told(wide: float, told: bool) -> None:
    """They carry: a plate that is so cracked to its middle is stiffer than one with a slit, .574 of the whole one."""
    counts = (20, 20) if told else (20, 21)
    mesh = vv.RectangleMesh(size=(1.0, 1.0), counts=counts)

    def pulled(**options: Any) -> tuple[float, vv.FracturingSolid]:
        given = {"material": vv.SaintVenantKirchhoff(young=1e3, poisson=0.0), "toughness": 1e3, "length": 0.1}
        solid = vv.FracturingSolid(mesh=mesh, model="AT2", **{**given, **options})
        bottom = vv.Fixed(solid=solid, nodes="y0")
        top = vv.Prescribed(solid=solid, nodes="y1", motion=(None, "1e-5 * t", None))
        system = vv.System([solid, bottom, top])
        vv.quasi_static(system, until=1.0, step=1.0, scheme=vv.AlternateMinimization())
        return float(np.sum(solid.nodal_forces(system.x)[solid.nodes("y1"), 1])), solid

    whole, _ = pulled()
    cracked, solid = pulled(damage=lambda X: 1.0 * ((abs(X[:, 1] - 0.5) < wide) & (X[:, 0] < 0.501)))
    assert any("broken at the start in no cell" in remark for remark in solid.remarks()) == told
    assert cracked / whole == pytest.approx(0.67 if told else 0.5, abs=0.05)
