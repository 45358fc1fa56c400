"""What materials and terms remember: in the forces of the last step, in restarts, over long steps."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from instances.points import Block, Damaged, UserViscoelastic, Viscoelastic
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import visviva as vv
from visviva.model.model import Model
from visviva.model.term import Stencils, Term
from visviva.study.run import run

Array = NDArray[np.float64]


def pulled(kind: type[Block], stretch: float = 0.3, **given: Any) -> Any:
    """One brick without distortion, all of whose nodes are moved: a homogeneous stretch to `stretched`."""

    class Pulled(kind):  # type: ignore[misc, valid-type]
        def declare(self, model: Model) -> None:
            self.X = np.array(vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)).build().points)
            kind.declare(self, model)
            X, every = self.X, np.arange(self.motion.size)
            U = X * (stretched(stretch, 1.0) - 1)
            model.prescribe(self, self.motion, every, lambda t: (X + t * U).ravel(), lambda t, h: U.ravel())

    return Pulled(counts=(1, 1, 1), speed=0.0, **given)


def at_points(block: Any) -> Array:
    """Internal variables (n, points) of the only element, which has the first of eight lanes."""
    return np.array(block.term.history())[:, ::8]


def stretched(stretch: float, t: float) -> Array:
    """Stretches along the axes."""
    return 1 + t * stretch * np.array([1.0, -0.4, -0.4])


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.BDF2(), vv.Static()])
@pytest.mark.parametrize("kind", [Viscoelastic, UserViscoelastic])
def test_holding_forces_do_the_work_of_the_step(kind: type[Block], scheme: vv.Scheme) -> None:
    """Forces that hold nodes, times how far these went, are the work booked: by those in the middle or at both ends."""
    block = pulled(kind, density=1e-9)
    system = vv.System([block])
    vv.simulate(system, until=0.8, step=0.2, scheme=scheme)
    before, x0 = system.holding_forces(), system.x.copy()
    known = np.array(block.term.history())
    result = vv.simulate(system, until=1.0, step=0.2, scheme=scheme)
    after, moved = system.holding_forces(), system.x - x0
    assert np.array_equal(system.holding_forces(), after)
    assert np.abs(block.term.history() - known).max() > 1e-3
    force = after if isinstance(scheme, vv.EnergyMomentum) else 0.5 * (before + after)
    work = result.ledger["work_prescribed motion"][-1]
    assert force @ moved == pytest.approx(work, rel=1e-9)


class Maxwell(Term):
    """A spring and a dashpot in series between x of two nodes, by implicit Euler."""

    kind = "maxwell"
    stiffness, relaxation = 50.0, 0.3

    def __init__(self, unknowns: list[int], length: float) -> None:
        super().__init__()
        self.ends, self.length, self.history["inner"] = unknowns, length, np.zeros(1)

    def inner(self, s: Stencils) -> Array:
        part = s.step.h / self.relaxation if s.step.has_length else 0.0
        return np.asarray((self.history["inner"] + part * self.stretch(s)) / (1 + part))

    def stretch(self, s: Stencils) -> Array:
        i, j = self.ends
        return np.asarray(s.x1[:, j] - s.x1[:, i] - self.length)

    def residual(self, s: Stencils) -> Array:
        r = np.zeros_like(s.x1)
        self.trial["inner"] = self.inner(s)
        r[:, self.ends[1]] = self.stiffness * (self.stretch(s) - self.trial["inner"])
        r[:, self.ends[0]] = -r[:, self.ends[1]]
        return r

    def accept(self, s: Stencils) -> None:
        self.history["inner"] = self.inner(s)


def test_support_forces_hold_a_term_with_a_history() -> None:
    """The solid's own force and that of the dashpot, by the history that the last step ended with."""
    mesh = vv.RectangleMesh(size=(1, 1), counts=(1, 1))
    solid = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=10.0, poisson=0.3), density=1e-6)
    low = solid.points[:, 1] == 0
    left, right = (int(np.flatnonzero(low & (solid.points[:, 0] == x))[0]) for x in (0, 1))
    term = Maxwell([2 * left, 2 * right], 1.0)
    moved = vv.Prescribed(solid=solid, nodes="x1", motion=("0.3*t", 0, None))
    parts = [solid, vv.Fixed(solid=solid, nodes="x0"), moved, vv.UserTerm(term=term, on=[solid])]
    system = vv.System(parts)
    vv.simulate(system, until=0.9, step=0.1, scheme=vv.Static())
    held = vv.SupportForce(solid=solid, nodes="x1")(system)[0]
    inner = term.history["inner"].item()
    own = solid.nodal_forces(system.x)[solid.points[:, 0] == 1].sum(axis=0)[0]
    assert inner > 0.1
    assert held == pytest.approx(-own + 50.0 * (0.27 - inner), rel=1e-12)
    assert term.history["inner"].item() == inner


@pytest.mark.parametrize("kind", [Viscoelastic, UserViscoelastic])
def test_resumed_with_another_step_materials_remember(kind: type[Block], tmp_path: Path) -> None:
    """Only what is remembered of the last step starts anew: the state goes on as in a run without a break."""

    def study(until: float, h: float) -> tuple[Any, vv.Study]:
        block: Any = kind(speed=1.0, name="block")
        return block, vv.Study(vv.System([block]), until=until, step=h)

    block, first = study(0.2, 0.02)
    run(first, tmp_path / "run", progress=False, pictures=False)
    resumed, second = study(0.22, 0.01)
    run(second, tmp_path / "run", resume=True, force=True, progress=False, pictures=False)
    vv.simulate(first.system, until=0.22, step=0.01)
    assert np.abs(block.term.history()).max() > 5e-3
    assert np.abs(resumed.term.history() - block.term.history()).max() <= 1e-12
    assert np.abs(second.system.x - first.system.x).max() <= 1e-12


def test_other_histories_are_refused_on_resuming(tmp_path: Path) -> None:
    class Forgetful(Viscoelastic):
        remembers = True

        def contribute(self, model: Model) -> None:
            if self.remembers:
                super().contribute(model)

    def study(until: float) -> vv.Study:
        return vv.Study(vv.System([Forgetful(name="b")]), until=until, step=0.02)

    run(study(0.02), tmp_path / "run", progress=False, pictures=False)
    Forgetful.remembers = False
    other = study(0.04)
    with pytest.raises(vv.InputError, match="internal variables"):
        run(other, tmp_path / "run", resume=True, force=True, progress=False, pictures=False)


def test_resumed_at_its_end_a_run_shows_the_same_forces(tmp_path: Path) -> None:
    def study() -> tuple[vv.Solid, vv.Study]:
        mesh = vv.RectangleMesh(size=(1, 0.2), counts=(8, 2))
        solid = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1e3, poisson=0.3), density=1.0)
        parts = [solid, vv.Fixed(solid=solid, nodes="x0"), vv.Gravity(acceleration=(0, -9.81, 0))]
        return solid, vv.Study(vv.System(parts), until=0.1, step=0.01)

    shown = []
    for resume in (False, True, True):
        solid, of = study()
        run(of, tmp_path / "run", resume=resume, progress=False, pictures=False)
        shown.append(vv.SupportForce(solid=solid, nodes="x0")(of.system))
    assert np.array_equal(shown[1], shown[0])
    assert np.array_equal(shown[2], shown[0])
    of.system.x[0] += 1e-3
    of.system.invalidate()
    assert not np.array_equal(vv.SupportForce(solid=solid, nodes="x0")(of.system), shown[0])


def test_a_history_of_plain_numbers_is_refused_by_name() -> None:
    class Count(Term):
        kind = "count"

        def __init__(self) -> None:
            super().__init__()
            self.history["steps"] = 0.0  # type: ignore[assignment]

        def residual(self, s: Stencils) -> Array:
            return 0.0 * s.x

    ball = vv.PointMass(mass=1.0)
    system = vv.System([ball, vv.UserTerm(term=Count(), on=[ball], name="counter")])
    with pytest.raises(vv.RunError, match=r"counter.*history\['steps'\] = 0\.0 is no array"):
        vv.simulate(system, until=0.1, step=0.05)


def end_of_stage(base: Array, c: Array, part: float) -> Array:
    """Principal values of A by A - base = part (A - A C A): positive roots of quadratics."""
    return (part - 1 + np.sqrt((part - 1) ** 2 + 4 * part * c * base)) / (2 * part * c)


def ends_of_steps(stretch: float, n: int, part: float, in_stages: bool) -> Array:
    """Principal values of A after n steps of backward Euler, or of two stages of it (Alexander 1977).

    `part` is the step by the time 2 eta / mu_v.
    """
    a = np.ones(3)
    g = 1 - np.sqrt(0.5)
    for k in range(n):
        start, c = (stretched(stretch, t / n) ** 2 for t in (k, k + 1))
        if in_stages:
            first = end_of_stage(a, start + g * (c - start), g * part)
            a = end_of_stage(a + (1 - g) / g * (first - a), c, g * part)
        else:
            a = end_of_stage(a, c, part)
    return a


@pytest.mark.parametrize("scheme", [vv.BackwardEuler(), vv.Static()], ids=lambda s: type(s).__name__)
@pytest.mark.parametrize(
    ("stretch", "n", "steps_long"), [(0.05, 4, 50.0), (1.5, 4, 50.0), (2.0, 2, 1e4), (-0.6, 3, 50.0)]
)
def test_internal_variables_of_long_steps(
    stretch: float, n: int, steps_long: float, scheme: vv.Scheme
) -> None:
    """Steps of many times of relaxation end where the rule says, at every point, positive definite."""
    block = pulled(Viscoelastic, stretch, viscosity=8.0 / 2 / n / steps_long)
    vv.simulate(vv.System([block]), until=1.0, step=1.0 / n, scheme=scheme)
    found = at_points(block)
    exact = ends_of_steps(stretch, n, steps_long, isinstance(scheme, vv.Static))
    assert np.abs(found[:3] + 1 - exact[:, None]).max() <= 1e-13 * exact.max()
    assert np.abs(found[3:]).max() <= 1e-13


def pulled_steadily(stretch: float, time: float) -> Array:
    """Principal values of A at t = 1 by time A' = A - A C A, integrated closely."""
    lagging = solve_ivp(
        lambda t, a: (a - a * a * stretched(stretch, t) ** 2) / time,
        (0, 1),
        np.ones(3),
        method="Radau",
        rtol=1e-10,
        atol=1e-12,
    )
    return np.asarray(lagging.y[:, -1])


DAMPING = (vv.BackwardEuler(), vv.BDF2(), vv.Static())


@pytest.mark.parametrize(
    "scheme", [vv.EnergyMomentum(), vv.Midpoint(), *DAMPING], ids=lambda s: type(s).__name__
)
def test_long_steps_keep_the_books(scheme: vv.Scheme) -> None:
    """Stretched to the double in steps of fifty times of relaxation: all points agree, near where A is."""
    block = pulled(Viscoelastic, 1.0, viscosity=8.0 / 2 / 10 / 50.0)
    result = vv.simulate(vv.System([block]), until=1.0, step=0.1, scheme=scheme)
    a = at_points(block)[:3] + 1
    assert np.ptp(a, axis=1).max() <= 1e-12 * a.max()
    near = 0.0003 if scheme in DAMPING else 0.0125
    assert a.mean(axis=1) == pytest.approx(pulled_steadily(1.0, 0.1 / 50), rel=near)
    assert np.all(np.diff(result.ledger["work_dissipated"]) < 0)
    if isinstance(scheme, vv.EnergyMomentum):
        assert result.conservation()["energy"] <= 1e-12


def test_steps_without_an_end_of_internal_variables_fail_by_name() -> None:
    block = pulled(Viscoelastic, 4.0, viscosity=0.002, name="branch")
    with pytest.raises(
        vv.RunError, match="'branch': internal variables at a point of its element 0 find no end"
    ):
        vv.simulate(vv.System([block]), until=1.0, step=0.25)


@pytest.mark.parametrize("scheme", [vv.BDF2(), vv.GeneralizedAlpha(0.8)])
def test_growing_damage_does_not_heal_in_the_books(scheme: vv.Scheme) -> None:
    """The books go the path of a step back too, where all that grew would heal: the balance is of second order."""

    def books(n: int) -> tuple[float, float]:
        result = vv.simulate(
            vv.System([Damaged(speed=1.0)], vv.Newton(tolerance=1e-14)),
            until=0.2,
            step=0.2 / n,
            scheme=scheme,
        )
        lost = result.ledger["work_dissipated"]
        assert np.diff(lost).max() <= 0
        return float(-lost[-1]), float(np.abs(result.ledger["imbalance"]).max())

    (lost, coarse), (_, fine) = books(10), books(40)
    assert lost <= 1e-4
    assert np.log(coarse / fine) / np.log(4) >= 1.7


def test_static_damage_that_grows_loses_nothing_to_healing() -> None:
    block = pulled(Damaged, 0.15)
    result = vv.simulate(vv.System([block]), until=1.0, step=0.1, scheme=vv.Static())
    damage = result.system.x[block.damage.start :][: block.damage.size]
    assert damage.max() > 0.05
    assert np.abs(result.ledger["work_dissipated"]).max() == 0.0
    assert np.abs(result.ledger["work_release"]).max() <= 1e-12


@pytest.mark.parametrize("scheme", [vv.BDF2(), vv.GeneralizedAlpha(0.8), vv.EnergyMomentum()])
def test_books_go_backwards_without_length(scheme: vv.Scheme) -> None:
    """What evolves by `has_length` alone books the work that the body gains, also by schemes that book paths."""

    class Held(Maxwell):
        seen: set[tuple[bool, bool]]

        def stretch(self, s: Stencils) -> Array:
            self.seen.add((s.step.h < 0, s.step.has_length))
            return np.asarray(s.x[:, 0] - self.length if s.step.has_length else s.x1[:, 0] - self.length)

        def residual(self, s: Stencils) -> Array:
            r = np.zeros_like(s.x1)
            r[:, 0] = self.stiffness * (self.stretch(s) - self.inner(s))
            return r

    def gap(h: float) -> float:
        term = Held([0, 0], 1.0)
        term.seen = set()
        ball = vv.PointMass(mass=1.0, position=(1.2, 0, 0))
        system = vv.System([ball, vv.UserTerm(term=term, on=[ball])])
        ledger = vv.simulate(system, until=1.0, step=h, scheme=scheme).ledger
        assert (True, True) not in term.seen
        assert ((True, False) in term.seen) == (not isinstance(scheme, vv.EnergyMomentum))
        return float(np.abs(ledger["kinetic"] - ledger["work_maxwell"]).max())

    assert gap(0.0125) <= max(0.35 * gap(0.025), 1e-13)  # energy-momentum: to round-off
