"""What only grows starts in balance, and steps that ask for balance in the middle may not end far from it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.typing import NDArray

import visviva as vv
from visviva.analysis import march
from visviva.base import world
from visviva.system import growing, steps
from visviva.system.growing import change_to_balance

Array = NDArray[np.float64]
GREEN = vv.SaintVenantKirchhoff(young=1.0, poisson=0.0)
SQUARE = vv.RectangleMesh(size=(1, 1), counts=(2, 2))
MIDDLE = [vv.EnergyMomentum(), vv.Midpoint()]
EVERY = [*MIDDLE, vv.BackwardEuler(), vv.BDF2(), vv.GeneralizedAlpha()]


def squeezed(toughness: float) -> vv.FracturingSolid:
    """Free strains of -0.1 that are hindered: ``d = 2 W / (2 W + Gc / l)``, see `balanced`."""
    return vv.FracturingSolid(
        mesh=SQUARE, material=GREEN, density=1e-3, toughness=toughness, length=1.0, free_strain=-0.1
    )


def cooled(toughness: float) -> vv.ThermalFracturingSolid:
    heat = vv.Heat(conductivity=1.0, capacity=10.0, expansion=1e-3, reference=400.0)
    return vv.ThermalFracturingSolid(
        mesh=SQUARE,
        material=GREEN,
        density=1e-3,
        toughness=toughness,
        length=1.0,
        heat=heat,
        temperature=300.0,
    )


def balanced(toughness: float) -> float:
    W = 0.9**3 * 1.5 * (0.5 * (1 / 0.9**2 - 1)) ** 2
    return 2 * W / (2 * W + toughness)


@pytest.mark.parametrize("scheme", EVERY, ids=str)
@pytest.mark.parametrize("make", [squeezed, cooled])
@pytest.mark.parametrize("toughness", [0.2, 0.1, 0.05])
def test_damage_starts_in_balance(make: Any, toughness: float, scheme: vv.Scheme) -> None:
    """Forces that balance in the middle of the first step took it twice as far (0.4625 for 0.2313), at any step."""
    body = make(toughness)
    result = vv.simulate(
        vv.System([body, vv.Fixed(solid=body, nodes="all")]), until=0.02, step=0.01, scheme=scheme
    )
    for x in result.states:
        assert body.damages(x) == pytest.approx(balanced(toughness), rel=1e-6)
    total = result.ledger["total"]
    assert np.ptp(total) < 1e-8 * result.ledger.energy_scale
    (told,) = result.ledger.moves
    assert told == f"damage of {body.label} by {balanced(toughness):.3g}"
    assert told in str(result.audit())


def test_a_crack_that_is_given_has_its_profile_from_the_start() -> None:
    """AT1's ``(1 - x / 2 l)^2`` over cells of l / 8: the toughness, and what its parabola takes in straight ones."""
    solid = vv.FracturingSolid(
        mesh=vv.RectangleMesh(size=(1, 0.2), counts=(80, 2)),
        material=GREEN,
        density=1.0,
        toughness=1e-6,
        length=0.1,
        model="AT1",
        damage=lambda X: 1.0 * (np.abs(X[:, 0] - 0.5) < 1e-9),
    )
    result = vv.simulate(vv.System([solid]), until=0.02, step=0.01)
    for x in result.states:
        assert solid.crack_energy(x) / (0.2 * 1e-6) == pytest.approx(1 + 1 / 32 / 64, abs=1e-9)


@pytest.mark.parametrize("model", ["AT1", "AT2"])
def test_a_profile_over_hundreds_of_cells_is_found(model: Any) -> None:
    """AT1's over 2 l = 400 of them cost 1.5 Gc when the search ended after 200 layers; AT2's has no end to find."""
    n = 1000
    solid = vv.FracturingSolid(
        mesh=vv.RectangleMesh(size=(1, 2 / n), counts=(n, 2)),
        material=GREEN,
        density=1.0,
        toughness=1e-6,
        length=200 / n,
        model=model,
        damage=lambda X: 1.0 * (np.abs(X[:, 0] - 0.5) < 1e-9),
    )
    system = vv.System([solid])
    growing.bring_into_balance(system)
    expected = 1.0 if model == "AT1" else np.tanh(0.5 / 0.2)  # of exponentials that end at both sides
    assert solid.crack_energy(system.x) / (1e-6 * 2 / n) == pytest.approx(expected, abs=1e-5)


def test_balances_that_are_not_found_are_told_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    system = jumping(-0.1)
    monkeypatch.setattr(growing, "MOST", 0)
    with pytest.raises(
        vv.RunError, match=r"^damage of FracturingSolid.*: no balance is found in 0 choices .*damage="
    ):
        growing.bring_into_balance(vv.System([squeezed(0.1)]))
    monkeypatch.setattr(march, "bring_into_balance", lambda system: None)
    with pytest.raises(
        vv.StepFailure, match=r"damage of .*'plate': no balance is found .* at the end of the"
    ):
        vv.simulate(system, until=0.1, step=0.02)


def test_the_first_process_alone_tells_of_moves(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    second = world.Alone()
    second.rank = 1
    monkeypatch.setattr(world, "_joined", [second])
    growing.bring_into_balance(vv.System([squeezed(0.1)]))
    assert capsys.readouterr().err == ""


def test_what_is_in_balance_or_goes_by_history_is_left_alone(capsys: pytest.CaptureFixture[str]) -> None:
    body = vv.FracturingSolid(mesh=SQUARE, material=GREEN, density=1.0, toughness=1.0, length=1.0, damage=0.3)
    start = vv.simulate(vv.System([body]), until=0.01, step=0.01).states[0]
    assert (body.damages(start) == 0.3).all()
    other = vv.FracturingSolid(
        mesh=SQUARE,
        material=GREEN,
        density=1.0,
        toughness=0.01,
        length=1.0,
        irreversibility="history",
        velocity=lambda X: X,
    )
    vv.simulate(vv.System([other]), until=0.01, step=0.01)
    assert capsys.readouterr().err == ""


def pulled(model: Any) -> vv.System:
    body = vv.FracturingSolid(
        mesh=SQUARE, material=GREEN, density=1e-6, toughness=1e-4, length=1.0, model=model
    )
    pull = vv.Prescribed(solid=body, nodes="all", motion=lambda t, X: 0.2 * t * X * [1, 0, 0])
    return vv.System([body, pull])


@pytest.mark.parametrize("scheme", MIDDLE, ids=str)
@pytest.mark.parametrize("step", [0.5, 0.1, 0.01])
@pytest.mark.parametrize("model", ["AT1", "AT2"])
def test_long_steps_do_not_leave_damage_behind(model: Any, step: float, scheme: vv.Scheme) -> None:
    """AT1 rested in a step that began below its threshold, however far above it ended; no later step was short enough.

    In the end ``d = 1 - 3 Gc / 16 l W`` (AT1) or ``2 W / (2 W + Gc / l)`` (AT2), less the residual stiffness.
    """
    system = pulled(model)
    vv.simulate(system, until=1.0, step=step, scheme=scheme)
    W = 0.5 * (0.5 * (1.2**2 - 1)) ** 2
    expected = 1 - 3e-4 / 16 / W if model == "AT1" else 2 * W / (2 * W + 1e-4)
    assert system.components[0].damages(system.x) == pytest.approx(expected, abs=0.025)


def jumping(strain: float) -> vv.System:
    """AT1 whose free strain jumps at t = 0.05."""
    body = vv.FracturingSolid(
        mesh=SQUARE,
        material=GREEN,
        density=1e-3,
        toughness=0.02,
        length=1.0,
        model="AT1",
        free_strain=lambda t, X: np.full(len(X), strain if t > 0.05 else 0.0),
        name="plate",
    )
    return vv.System([body, vv.Fixed(solid=body, nodes="all")])


@pytest.mark.parametrize("step", [0.02, 0.002])
@pytest.mark.parametrize("scheme", MIDDLE, ids=str)
@pytest.mark.parametrize("pace", [None, vv.Adaptive()], ids=["even", "adaptive"])
def test_a_jump_in_time_is_refused_with_its_cure(pace: Any, scheme: vv.Scheme, step: float) -> None:
    system = jumping(-0.1)
    with pytest.raises(
        vv.StepFailure, match=r"damage\[\d\] of .*'plate' .* its balance.*jumps in time.*BackwardEuler"
    ):
        vv.simulate(system, until=0.1, step=step, scheme=scheme, adaptive=pace)
    assert system.components[0].damages(system.x).max() == 0


@pytest.mark.parametrize("scheme", [vv.BackwardEuler(), vv.GeneralizedAlpha(), vv.BDF2()], ids=str)
def test_schemes_that_balance_at_the_end_follow_a_jump(scheme: vv.Scheme) -> None:
    system = jumping(-0.1)
    vv.simulate(system, until=0.1, step=0.01, scheme=scheme)
    W = 0.9**3 * 1.5 * (0.5 * (1 / 0.9**2 - 1)) ** 2
    assert system.components[0].damages(system.x) == pytest.approx(1 - 3 * 0.02 / 16 / W, rel=1e-5)


def test_looking_at_the_balance_disturbs_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """A brick that cracks at a wall goes on to the bit as if steps were not looked at."""
    ends = []
    for looks in (True, False):
        if not looks:
            monkeypatch.setattr(steps, "refuse_imbalance", lambda system, step: None)
        solid = vv.FracturingSolid(
            mesh=vv.RectangleMesh(size=(1, 0.5), counts=(8, 4)),
            material=vv.SaintVenantKirchhoff(young=1.0, poisson=0.2),
            density=1.0,
            toughness=2e-5,
            length=0.2,
            split="spectral",
            velocity=(-0.02, 0.0, 0.0),
        )
        wall = vv.Plane(at=(-0.005, 0, 0), normal=(1, 0, 0))
        system = vv.System([solid, wall, vv.Contact(first=solid, first_faces="x0", second=wall)])
        vv.simulate(system, until=1.0, step=0.02)
        assert solid.damages(system.x).max() > 0.1
        ends.append(system.x.tobytes() + system.v.tobytes())
    assert ends[0] == ends[1]


def test_steps_near_balance_need_no_tangent(monkeypatch: pytest.MonkeyPatch) -> None:
    """One more of them in every step took a sixth to a quarter of its time."""
    monkeypatch.setattr(march, "bring_into_balance", lambda system: None)
    monkeypatch.setattr(growing, "equations", None)
    system = pulled("AT2")
    vv.simulate(system, until=0.1, step=0.002)
    assert system.components[0].damages(system.x).max() > 0.7


@pytest.mark.parametrize("off", [0.03, 0.06, 0.12])
@pytest.mark.parametrize(
    "mesh", [SQUARE, vv.BoxMesh(size=(1, 1, 1), counts=(3, 3, 3))], ids=["plane", "space"]
)
@pytest.mark.parametrize("model", ["AT1", "AT2"])
def test_what_residuals_let_pass_is_near_balance(model: Any, mesh: Any, off: float) -> None:
    """Damages beside their balance under strains that vary wildly from cell to cell, by the change to balance."""
    random, passed = np.random.default_rng(5), 0
    for toughness in np.logspace(-5, -1, 9):
        body = vv.FracturingSolid(
            mesh=mesh, material=GREEN, density=1.0, toughness=toughness, length=1.0, model=model
        )
        system = vv.System([body])
        at = system.field(body, "damage").unknowns
        moving = system.field(body, "position").unknowns
        system.x[moving] += 0.05 * random.standard_normal(len(moving))
        r, K, _ = growing.equations(system, at)
        system.x[at] += change_to_balance(K, r, np.zeros(len(at)), 1e-13) - off * random.random(len(at))
        if growing._is_near_balance(system, SimpleNamespace(t1=0.0), at):
            r, K, _ = growing.equations(system, at)
            passed += 1
            assert change_to_balance(K, r, np.zeros(len(at)), 1e-13).max() < growing.SHORT
    assert passed > 0 or off > growing.SHORT / 2


@pytest.mark.parametrize("seed", range(5))
def test_balance_with_room(seed: int) -> None:
    """Conditions of Karush, Kuhn and Tucker, for matrices of the kind that are no mass or stiffness."""
    random = np.random.default_rng(seed)
    n = 30
    B = random.standard_normal((n, n))
    K = sp.csr_array(B @ B.T / n + 0.1 * np.eye(n))
    r, room = random.standard_normal(n), np.maximum(random.standard_normal(n), 0.0)
    z = change_to_balance(K, r, room, 1e-13)
    pressed = r + K @ z
    assert (z >= -room).all()
    assert (pressed > -1e-9).all()
    assert np.abs(pressed * (z + room)).max() < 1e-9


def test_choices_that_come_back_end_in_balance() -> None:
    """A smooth load on 13 graded nodes of a line whose masses couple neighbours by the wrong sign: choices cycle."""
    n, length = 12, 0.72
    full = np.zeros((n + 1, n + 1))
    for e, h in enumerate(np.diff(np.linspace(0, 1, n + 1) ** 2)):
        full[e : e + 2, e : e + 2] += h / 6 / length * (np.ones((2, 2)) + np.eye(2))
        full[e : e + 2, e : e + 2] += length / h * (2 * np.eye(2) - 1)
    K = sp.csr_array(full)
    weight, x = np.asarray(K.sum(axis=1)).ravel(), np.arange(n + 1) / (n + 1)
    for r in (
        weight * (0.3 - 2 * np.exp(-(((x - 0.3) / 0.02) ** 2))),
        weight * np.where(abs(x - 0.5) < 0.05, -1, 0.2),
    ):
        for room in (np.zeros(n + 1), np.full(n + 1, 0.01), np.random.default_rng(1).uniform(0, 0.3, n + 1)):
            for z in (change_to_balance(K, r, room, 1e-13), growing._descend(K, r, room, 0 * r)):
                pressed = r + K @ z
                assert (z >= -room).all()
                assert (pressed > -1e-9 * abs(r).max()).all()
                assert np.abs(pressed * (z + room)).max() < 1e-9 * abs(r).max()


@pytest.mark.parametrize("model", ["AT1", "AT2"])
def test_cracks_at_rest_stay_in_balance(model: Any) -> None:
    """Without loads, on quadratic cells: rounding let damages move and rest by turns, and steps were refused."""
    body = vv.FracturingSolid(
        mesh=vv.RectangleMesh(size=(1, 0.5), counts=(12, 8), cell="tri6"),
        material=vv.SaintVenantKirchhoff(young=1.0, poisson=0.2),
        density=1e-2,
        toughness=2e-3,
        length=0.15,
        model=model,
        damage=lambda X: 1.0 * ((np.abs(X[:, 0] - 0.5) < 1e-9) & (X[:, 1] < 0.15)),
    )
    system = vv.System([body, vv.Fixed(solid=body, nodes="x0")])
    start, *later = vv.simulate(system, until=0.04, step=0.02).states
    assert all(np.abs(x - start).max() < 1e-6 for x in later)


def test_equations_that_are_not_solved_are_told_as_such() -> None:
    K = sp.csr_array(np.full((3, 3), np.nan))
    with pytest.raises(growing.Lost, match="its 3 equations are not solved by conjugate gradients in 1000"):
        change_to_balance(K, -np.ones(3), np.zeros(3), 1e-13)
