"""Starts in which temperatures that are tied jump: heat passes across the tie before the first step."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from visviva.system.memory import undisturbed

Array = NDArray[np.float64]
SCHEMES = [vv.EnergyMomentum(), vv.Midpoint(), vv.BackwardEuler(), vv.BDF2(), vv.GeneralizedAlpha()]
COLD, HOT = 300.0, 350.0


def bar(kind: str, second: bool, n: int = 4, length: float = 1.0, **more: Any) -> Any:
    """Insulated, from 0 to its length at 300 K, or from there on at 350 K; what deforms is held."""
    given = {"conductivity": 1.0, "capacity": 1.0, "reference": COLD, **more}
    across = given.pop("across", 1)
    cell = given.pop("cell", "hex8")
    origin = (length if second else 0.0, 0.0, 0.0)
    mesh = vv.BoxMesh(size=(length, 0.1, 0.1), counts=(n, across, across), origin=origin, cell=cell)
    temperature = given.pop("temperature", HOT if second else COLD)
    if kind == "body":
        return vv.ThermalBody(mesh=mesh, temperature=temperature, **given)
    formulation = given.pop("formulation", "displacement")
    return vv.ThermoelasticSolid(
        mesh=mesh,
        material=vv.NeoHooke(young=1e3, poisson=0.3),
        heat=vv.Heat(**given),
        temperature=temperature,
        formulation=formulation,
    )


def joined(first: Any, second: Any, *more: Any, tied: bool = True) -> vv.System:
    tie = vv.HeatTie(first=first, first_faces="x1", second=second, second_faces="x0")
    held = [vv.Fixed(solid=b, nodes="all") for b in (first, second) if b.balances_entropy]
    return vv.System([first, second, *([tie] if tied else []), *held, *more])


def before_and_after(*pairs: tuple[Any, Any]) -> tuple[vv.System, vv.System]:
    """Of two pairs of the same bodies the first beside each other, the second tied."""
    return joined(*pairs[0], tied=False), joined(*pairs[1])


def faces(system: vv.System, first: Any, second: Any) -> tuple[Array, Array]:
    return first.temperatures(system.x)[first.nodes("x1")], second.temperatures(system.x)[second.nodes("x0")]


def energy(system: vv.System) -> float:
    with undisturbed(system):
        system.evaluate_ledger()
        return float(system.core.energy.sum())


def entropy(system: vv.System) -> float:
    return sum(body.total_entropy(system.x) for body in system.components[:2])


@pytest.mark.parametrize("scheme", SCHEMES, ids=repr)
@pytest.mark.parametrize("capacity", [1.0, 3.0])
def test_bodies_that_touch_end_at_the_mean_by_their_capacities(capacity: float, scheme: vv.Scheme) -> None:
    first, second = bar("body", False), bar("body", True, capacity=capacity)
    system = joined(first, second)
    vv.simulate(system, until=40.0, step=0.1, scheme=scheme)
    mean = (COLD + capacity * HOT) / (1 + capacity)
    for body in (first, second):
        assert body.temperatures(system.x) == pytest.approx(mean, rel=1e-6 / mean)


@pytest.mark.parametrize("capacity", [1.0, 3.0])
def test_solids_keep_their_energy_and_do_not_alternate(capacity: float) -> None:
    """They ended at 350.4 and 300.4 in turn."""
    first, second = bar("solid", False), bar("solid", True, capacity=capacity)
    system, made, seen, jumps = joined(first, second), [], [], []

    def look(s: vv.System) -> None:
        left, right = faces(s, first, second)
        jumps.append(float(np.abs(left - right).max()))
        made.append(entropy(s))

    result = vv.simulate(system, until=20.0, step=0.02, observe=look)
    mean, most = (COLD + capacity * HOT) / (1 + capacity), {1.0: 2e-3, 3.0: 1e-3 * (HOT - COLD)}[capacity]
    assert max(jumps) < most
    for body in (first, second):
        assert body.temperatures(system.x) == pytest.approx(mean, abs=most)
        seen.append((body.temperatures(system.x)[body.grid.cells["hex8"]].mean(), body.heat.capacity))
    assert sum(T * c for T, c in seen) / (1 + capacity) == pytest.approx(mean, rel=1e-12)
    assert np.min(np.diff(made)) > -1e-12
    assert np.abs(result.ledger["imbalance"]).max() < 1e-12


@pytest.mark.parametrize("conductivity", [1e-3, 0.1, 10.0, 1e3, 1e5])
def test_they_are_as_warm_as_slow_and_fast_conduction_leaves_them(conductivity: float) -> None:
    """By the series of two insulated bars: from next to nothing to all at once, where layers at the tie turned over."""
    first, second = (bar("solid", k, n=20, conductivity=conductivity) for k in (False, True))
    system = joined(first, second)
    vv.simulate(system, until=0.1, step=0.01)
    means = [b.temperatures(system.x)[b.grid.cells["hex8"]].mean() for b in (first, second)]
    n = np.arange(1, 4001, 2)
    left = 8 / np.pi**2 * np.sum(np.exp(-conductivity * 0.1 * (n * np.pi / 2) ** 2) / n**2)
    layer = 0.02 * (HOT - COLD)  # what the cells at the tie take at once
    assert means[1] - means[0] == pytest.approx((HOT - COLD) * left, abs=layer)
    assert np.mean(means) == pytest.approx(325.0, rel=1e-12)


def off_the_mean(scheme: vv.Scheme, until: float, step: float) -> float:
    first, second = bar("solid", False), bar("solid", True)
    system = joined(first, second)
    vv.simulate(system, until=until, step=step, scheme=scheme)
    means = [b.temperatures(system.x)[b.grid.cells["hex8"]].mean() for b in (first, second)]
    return float(abs(np.mean(means) - 325.0))


@pytest.mark.parametrize("scheme", SCHEMES[1:], ids=repr)
@pytest.mark.parametrize("step", [0.02, 0.01, 0.005])
def test_schemes_come_to_the_mean(step: float, scheme: vv.Scheme) -> None:
    """They came to 324.93, short of it by what an engine gains, however short the steps."""
    assert off_the_mean(scheme, 1.0, step) < 0.01


@pytest.mark.parametrize("scheme", [vv.Midpoint(), vv.BDF2(), vv.GeneralizedAlpha()], ids=repr)
def test_what_is_missing_goes_down_with_their_order(scheme: vv.Scheme) -> None:
    """Of steps that resolve how cells at the tie even out."""
    off = [off_the_mean(scheme, 0.1, step) for step in (0.001, 0.0005, 0.00025)]
    assert np.log2(off[1] / off[2]) == pytest.approx(scheme.order, abs=0.15)


def test_backward_euler_keeps_energy_at_rest() -> None:
    """With entropy alone it came to 324.98."""
    assert off_the_mean(vv.BackwardEuler(), 1.0, 0.02) < 1e-10


@pytest.mark.parametrize("formulation", ["displacement", "F-bar", "mixed"])
def test_the_start_keeps_energy_and_makes_entropy(formulation: str) -> None:
    """Nodes that do not match, unlike capacities, coupled with strains."""
    common: Any = {"formulation": formulation, "expansion": 1e-3}
    apart, tied = before_and_after(
        *(
            (bar("solid", False, across=3, **common), bar("solid", True, across=2, capacity=3.0, **common))
            for _ in "12"
        )
    )
    assert abs(energy(tied) - energy(apart)) < 1e-14
    left, right = faces(tied, *tied.components[:2])
    assert left == pytest.approx(left[0], abs=1e-9)
    assert right == pytest.approx(left[0], abs=1e-9)
    assert COLD + 25 < left[0] < HOT
    assert entropy(tied) > entropy(apart)


@pytest.mark.parametrize("kinds", [("body", "solid"), ("solid", "body"), ("body", "body")])
def test_heat_and_entropy_meet(kinds: tuple[str, str]) -> None:
    apart, tied = before_and_after(*([bar(kind, k == 1) for k, kind in enumerate(kinds)] for _ in "12"))
    assert abs(energy(tied) - energy(apart)) < 1e-14
    left, right = faces(tied, *tied.components[:2])
    assert left == pytest.approx(right, abs=1e-9)
    assert left == pytest.approx(325.0, abs=0.2)


@pytest.mark.parametrize("kinds", [("body", "body"), ("solid", "solid"), ("body", "solid")])
def test_latent_heat_is_passed_as_well(kinds: tuple[str, str]) -> None:
    """Tables of capacity with a hump between both temperatures."""
    table = [(300.0, 1.0), (310.0, 1.0), (312.0, 30.0), (314.0, 1.0), (400.0, 1.0)]
    apart, tied = before_and_after(
        *([bar(kind, k == 1, capacity=table) for k, kind in enumerate(kinds)] for _ in "12")
    )
    assert abs(energy(tied) - energy(apart)) < 1e-13
    left, right = faces(tied, *tied.components[:2])
    assert left == pytest.approx(right, abs=1e-9)


def test_temperatures_that_are_held_take_the_other_side_along() -> None:
    first, second = bar("solid", False), bar("solid", True)
    system = joined(first, second, vv.PrescribedTemperature(body=second, nodes="x0", value=HOT))
    for side in faces(system, first, second):
        assert side == pytest.approx(HOT, abs=1e-9)


@pytest.mark.parametrize("kind", ["body", "solid"])
@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.BDF2()], ids=repr)
@pytest.mark.parametrize("held", ["x1", "all"])
@pytest.mark.parametrize("across", [(3, 2), (2, 3)])
def test_a_held_first_surface_warms_the_second(
    across: tuple[int, int], held: str, scheme: vv.Scheme, kind: str
) -> None:
    """Nothing passed, without a word: its nodes have the multipliers. As by the series of a bar held at an end."""
    first, second = (
        bar(kind, k, across=n, temperature=COLD, n=8) for k, n in zip((False, True), across, strict=True)
    )
    hot = vv.PrescribedTemperature(body=first, nodes=held, value=HOT)
    system = joined(first, second, hot)
    result = vv.simulate(system, until=0.5, step=0.01, scheme=scheme)
    n = np.arange(1, 400, 2) * np.pi / 2
    mean = HOT - (HOT - COLD) * 2 * np.sum(np.exp(-0.5 * n**2) / n**2)
    found = second.temperatures(system.x)
    assert found[second.nodes("x0")] == pytest.approx(HOT, abs=0.05)
    assert found[second.grid.cells["hex8"]].mean() == pytest.approx(mean, abs=0.3)
    tie = next(c for c in system.components if isinstance(c, vv.HeatTie))
    assert tie.heat(system.x) > 0
    stored = result.ledger["total"][-1] - result.ledger["total"][0]
    assert result.ledger["heat_supply"][-1] == pytest.approx(stored, rel=0.02)


@pytest.mark.parametrize("kind", ["body", "solid"])
def test_half_spaces_meet_at_the_temperature_of_their_effusivities(kind: str) -> None:
    """``(b1 T1 + b2 T2) / (b1 + b2)`` with b = sqrt(k c), as long as nothing has come to the far ends."""
    first = bar(kind, False, n=60, conductivity=1.0, capacity=1.0)
    second = bar(kind, True, n=60, conductivity=4.0, capacity=9.0)
    system = joined(first, second)
    vv.simulate(system, until=0.02, step=0.0005)
    expected = (1 * COLD + 6 * HOT) / 7
    for side in faces(system, first, second):
        assert side == pytest.approx(expected, abs=0.02 * (HOT - COLD))


def test_shells_that_are_tied_at_edges() -> None:
    """Both ends at the mean, energy as it was."""
    shells = []
    for k in range(2):
        grid = vv.RectangleMesh(size=(1, 0.5), counts=(3, 2), origin=(k, 0)).build()
        X = np.column_stack([grid.points[:, :2], np.zeros(len(grid.points))])
        shells.append(
            vv.ThermalShell(
                mesh=vv.Mesh(X, grid.cells, face_sets=grid.face_sets),
                section=vv.SolidSection(
                    material=vv.NeoHooke(young=1e4, poisson=0.0), thickness=0.1, density=1.0
                ),
                heat=vv.Heat(conductivity=1.0, capacity=1.0, reference=COLD),
                temperature=HOT if k else COLD,
            )
        )
    system = joined(*shells)
    result = vv.simulate(system, until=20.0, step=0.05)
    for shell in shells:
        assert shell.temperatures(system.x) == pytest.approx(325.0, abs=5e-3)
    assert np.abs(result.ledger["imbalance"]).max() < 1e-12


def test_it_is_told_and_done_once(capsys: pytest.CaptureFixture[str]) -> None:
    """In the report, the ledger and by word; a run that goes on is the same to the bit as one without a pause."""
    ends = []
    for times in ((0.2,), (0.1, 0.2)):
        first, second = bar("solid", False), bar("solid", True)
        system = joined(first, second)
        results = [vv.simulate(system, until=until, step=0.02) for until in times]
        assert system.report is not None
        assert len(system.report.moves) == 2
        assert system.report.moves[0].startswith(f"temperature of {first.label} by 24.")
        assert "made consistent" in str(results[0].audit())
        ends.append(system.x.copy())
    assert np.array_equal(*ends)
    assert capsys.readouterr().err.count("initial state made consistent") == 2


def test_what_fits_is_left_as_it_is() -> None:
    first, second = (bar("solid", k, temperature=lambda X: 300 + 10 * X[:, 0]) for k in (False, True))
    system = joined(first, second)
    apart = joined(
        *(bar("solid", k, temperature=lambda X: 300 + 10 * X[:, 0]) for k in (False, True)), tied=False
    )
    found, given = (s.components[1].temperatures(s.x) for s in (system, apart))
    assert found == pytest.approx(given, abs=1e-9)
    vv.simulate(system, until=0.1, step=0.1)
    assert system.report is not None
    assert not system.report.moves


@pytest.mark.parametrize(
    ("given", "capacity", "mean"),
    [((-10.0, -10.0), 1.0, -10.0), ((-30.0, 10.0), 3.0, 0.0), ((-25.0, 25.0), 1.0, 0.0)],
)
def test_degrees_about_zero_are_temperatures_like_others(
    given: tuple[float, float], capacity: float, mean: float
) -> None:
    """Even bodies ended in a division by zero, and ties that meet at zero were refused."""
    first = bar("body", False, across=3, temperature=given[0])
    second = bar("body", True, across=2, temperature=given[1], capacity=capacity)
    system = joined(first, second)
    vv.simulate(system, until=20.0, step=0.1)
    for body in (first, second):
        assert body.temperatures(system.x) == pytest.approx(mean, abs=1e-3)
