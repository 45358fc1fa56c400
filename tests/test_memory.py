"""What is remembered beside the state: failures, functions that raise, and looks at any moment keep the last one."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import contact_parts
import numpy as np
import pytest
from immersed_parts import carried, thin
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import visviva as vv
from visviva.analysis.march import prepare
from visviva.component.component import Component
from visviva.system.memory import undisturbed

Array = NDArray[np.float64]
GRAVITY = 9.81


class Told(Exception):
    """What functions of the tests raise."""


def pendulum() -> list[Component]:
    """A rod that falls from the horizontal."""
    ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(1, 0, 0), name="ball")
    return [ground, ball, vv.Distance(a=ground.point(), b=ball.point()), vv.Gravity()]


def fallen(times: Any) -> Array:
    """Where it is then, by the angle's equation."""
    found = solve_ivp(
        lambda _, y: [y[1], GRAVITY * np.cos(y[0])], (0, times[-1]), [0, 0], "DOP853", times, rtol=1e-12
    )
    return np.array([np.cos(found.y[0]), 0 * found.y[0], -np.sin(found.y[0])]).T


def at_rest() -> list[Component]:
    mesh = vv.RectangleMesh(size=(1, 1), counts=(2, 2), cell="quad9")
    water = vv.Fluid(mesh=mesh, density=1.0, viscosity=0.1)
    return [water, vv.VelocityBoundary(fluid=water, faces="all", velocity=(0, 0, 0))]


def test_adaptive_steps_beside_a_flow_keep_the_first_increment() -> None:
    """Rates are projected in Python there; what that asks of the equations is not asked amid a step."""
    system = vv.System([*pendulum(), *at_rest()])
    rule = vv.Adaptive(tolerance=1e-5)
    result = vv.simulate(system, until=0.3, step=0.01, scheme=vv.GeneralizedAlpha(), adaptive=rule)
    ball = system.components[1].point().position  # type: ignore[attr-defined]
    places = np.array([ball.value(x) for x in result.states])
    assert np.abs(places - fallen(np.array(result.times))).max() < 1e-3
    assert np.abs(places[1] - fallen(np.array(result.times[:2]))[1]).max() < 1e-6


def hopping() -> list[Component]:
    return list(contact_parts.bricks(gap=0.01))


@pytest.mark.parametrize("make", [pendulum, hopping, carried, thin])
def test_looks_amid_a_step(make: Callable[[], list[Component]]) -> None:
    """An increment that is solved for waits while the system is looked at, and is accepted afterwards."""
    states = []
    for looks in (False, True):
        system, scheme = vv.System(make()), vv.EnergyMomentum()
        prepare(system, scheme)
        for k in range(6):
            attempt = system.attempt(scheme.step(system.time, 0.01))
            if looks and k in (2, 4):
                with undisturbed(system):
                    system.check()
            system.accept(attempt, scheme)
        states.append(np.concatenate([system.x, system.v, system.core.energy, system.core.work]))
    np.testing.assert_array_equal(*states)


@pytest.mark.parametrize("look", [vv.System.check, lambda system: None])
def test_an_edited_state_is_refused_after_looks(look: Callable[[vv.System], object]) -> None:
    system = vv.System(pendulum())
    vv.simulate(system, until=0.2, step=0.01)
    system.x[:3] = (1.3, 0, 0)
    look(system)
    system.invalidate()
    assert system.stepper.is_edited
    with pytest.raises(vv.InputError, match="does not fit"):
        vv.simulate(system, until=0.4, step=0.01)


def in_a_lid_driven_box(**options: Any) -> list[Component]:
    """A soft block below a lid."""
    mesh = vv.RectangleMesh(size=(1, 1), counts=(8, 8), cell="quad4")
    water = vv.Fluid(mesh=mesh, density=1.0, viscosity=0.01)
    lid = vv.VelocityBoundary(
        fluid=water, faces="y1", velocity=lambda t, X: X[:, :1] * (1 - X[:, :1]) * [4.0, 0, 0]
    )
    walls = [vv.NoSlip(fluid=water, faces=f) for f in ("x0", "x1", "y0")]
    patch = vv.RectangleMesh(size=(0.2, 0.2), counts=(3, 3), origin=(0.4, 0.78))
    soft = vv.Solid(mesh=patch, material=vv.NeoHooke(young=10.0, poisson=0.3), density=5.0)
    return [water, lid, *walls, soft, vv.Immersed(solid=soft, fluid=water, **options)]


def fail(system: vv.System) -> None:
    """A step that is too long for the iterations that it may take."""
    newton = system.newton
    system.newton = vv.Newton(max_iterations=1)
    with pytest.raises(vv.StepFailure):
        system.step(0.1)
    system.newton = newton


def walk(system: vv.System) -> None:
    """Evaluations at other states by what is no look, which goes on from there."""
    system.core.dx[:] = 1e-3
    system.residual(vv.EnergyMomentum().step(system.time, 0.3))
    system.core.dx[:] = 0.0


LOOKS = {"check": vv.System.check, "failure": fail, "residual": walk}


@pytest.mark.parametrize("look", LOOKS)
@pytest.mark.parametrize("sealing", [1.0, 10.0])
def test_forces_of_the_last_step_stay(look: str, sealing: float) -> None:
    """What is immersed belongs to its place in the last step, whatever was evaluated since then."""
    system = vv.System(in_a_lid_driven_box(sealing=sealing))
    force = vv.FlowForce(fluid=system.components[0], faces="y1")  # type: ignore[arg-type]
    read: list[Array] = []
    vv.simulate(system, until=0.3, step=0.01, observe=lambda s: read.append(force(s)))
    LOOKS[look](system)
    np.testing.assert_array_equal(force(system), read[-1])


def test_contact_shows_the_last_step_after_one_that_fails() -> None:
    system = vv.System(hopping())
    contact = next(c for c in system.components if isinstance(c, vv.Contact))
    vv.simulate(system, until=0.05, step=0.01)
    shown = [np.array(u) for u in (contact.pressures, contact.forces, contact.gaps)]
    assert np.any(shown[0] > 0)
    fail(system)
    for u, before in zip((contact.pressures, contact.forces, contact.gaps), shown, strict=True):
        np.testing.assert_array_equal(u, before)


def hung(times: Any, force: tuple[float, float, float] = (0, 0, -20)) -> list[Component]:
    """A ball of 2 kg on a spring of 100 N/m along a line, pulled down."""
    ground, ball = vv.Ground(), vv.PointMass(mass=2.0, position=(0, 0, -1))
    spring = vv.Spring(a=ground.point(), b=ball.point(), stiffness=100.0)
    line = ground.frame(axes=((1, 0, 0), (0, 1, 0), (0, 0, 1)))
    pull = vv.Force(on=ball.point(), force=force, times=times)
    return [ground, ball, spring, vv.PointOnLine(a=line, b=ball.point()), pull]


def raising(error: type[BaseException]) -> Callable[[float], float]:
    def times(t: float) -> float:
        if t >= 0.6:
            raise error
        return t

    return times


STATICS = {"load steps": (vv.quasi_static, {"until": 1.0}), "arc length": (vv.arc_length, {})}


@pytest.mark.parametrize("error", [Told, KeyboardInterrupt])
@pytest.mark.parametrize("way", STATICS)
def test_statics_that_is_broken_off_keeps_its_equilibrium(way: str, error: type[BaseException]) -> None:
    """Whose frequency is that of the spring."""
    system, (follow, options) = vv.System(hung(raising(error))), STATICS[way]
    with pytest.raises((error, vv.RunError)):
        follow(system, step=0.25, **options)  # type: ignore[operator]
    assert 0 < system.time < 0.6
    assert not system.core.dx.any()
    assert system.x[2] == pytest.approx(-1 - 0.2 * system.time, abs=1e-12)
    assert vv.modes(system).frequencies[0] == pytest.approx(np.sqrt(50.0) / (2 * np.pi), rel=1e-9)


def test_statics_keeps_the_equilibrium_before_an_unstable_one() -> None:
    """A block upside down on a soft turning spring: 3 N at 1 m overcome 1 N m at a third of the load."""
    ground, block = vv.Ground(), vv.RigidBody(mass=1.0, inertia=(1, 1, 1), position=(0, 0, 1))
    hold = vv.Bushing(a=ground, b=block, at=(0, 0, 0), stiffness=(1e3,) * 3, rotational_stiffness=(1, 1.5, 2))
    push = vv.Force(on=block.point(), force=(0, 0, -3), times="t")
    system = vv.System([ground, block, hold, push])
    with pytest.raises(vv.RunError, match="unstable"):
        vv.quasi_static(system, until=1.0, step=0.25)
    assert system.time == 0.25
    assert system.x[2] == pytest.approx(1 - 0.75e-3, abs=1e-9)
    assert min(abs(vv.modes(system).frequencies - np.sqrt(1e3) / (2 * np.pi))) < 1e-6


class Loud:
    """A force that falls silent or raises."""

    def __init__(self) -> None:
        self.raises = False

    def __call__(self, *_: Any) -> Array:
        if self.raises:
            raise Told
        return np.array([0.0, 0.0, -1.0])


def vectors(system: vv.System) -> Array:
    core = system.core
    return np.concatenate([core.x, core.dx, core.v, core.a, core.w, [system.time]])


QUESTIONS: dict[str, Callable[[vv.System], object]] = {
    "forces": vv.System.holding_forces,
    "check": vv.System.check,
    "step": lambda system: system.step(0.1, vv.GeneralizedAlpha()),
    "accelerations": lambda system: later(system),
}


def later(system: vv.System) -> None:
    from visviva.system.consistency import accelerations_later

    accelerations_later(system, np.ones(len(system.x)), 0.1)


@pytest.mark.parametrize("question", QUESTIONS)
def test_functions_that_raise_leave_the_state(question: str) -> None:
    force, ball = Loud(), vv.PointMass(mass=1.0, velocity=(1, 0, 0))
    system = vv.System([ball, vv.GeneralizedForce(of=[ball], force=force)])
    vv.simulate(system, until=0.5, step=0.1, scheme=vv.GeneralizedAlpha())
    before, force.raises = vectors(system), True
    with pytest.raises((Told, vv.RunError)):
        QUESTIONS[question](system)
    np.testing.assert_array_equal(vectors(system), before)
    force.raises = False
    vv.simulate(system, until=1.0, step=0.1, scheme=vv.GeneralizedAlpha())
    assert system.x[2] == pytest.approx(-0.5, abs=1e-12)


class Counting(vv.model.term.Term):
    """A spring that counts the steps it has accepted, and may refuse one."""

    refuses = False

    def __init__(self, unknowns: NDArray[np.int32]) -> None:
        super().__init__()
        self.unknowns, self.order = unknowns.reshape(1, 3), np.full(3, 2, dtype=np.int32)
        self.history["steps"] = np.zeros(1)

    def residual(self, s: Any) -> Array:
        return 10.0 * np.asarray(s.x)

    def accept(self, s: Any) -> None:
        self.history["steps"] += 1
        if self.refuses:
            raise Told


class Counter(Component):
    ball: vv.PointMass

    def contribute(self, model: Any) -> None:
        self.term = Counting(np.array(self.ball._field.unknowns, dtype=np.int32))
        model.term(self, self.term)


def test_all_terms_accept_a_step_or_none() -> None:
    ball = vv.PointMass(mass=1.0, position=(1, 0, 0))
    counters = [Counter() for _ in range(3)]
    for counter in counters:
        counter.ball = ball
    system = vv.System([ball, *counters])
    vv.simulate(system, until=0.5, step=0.1)
    before, counters[1].term.refuses = vectors(system), True
    with pytest.raises(Told):
        system.step(0.1)
    np.testing.assert_array_equal(vectors(system), before)
    assert [float(c.term.history["steps"][0]) for c in counters] == [5, 5, 5]
    counters[1].term.refuses = False
    system.step(0.1)
    assert [float(c.term.history["steps"][0]) for c in counters] == [6, 6, 6]


@pytest.mark.parametrize("calls", range(1, 40, 3))
def test_checks_that_are_broken_off_leave_what_was_given(calls: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Or what fits, if that was found before."""
    left = [calls]

    def residual(self: Counting, s: Any) -> Array:
        left[0] -= 1
        if left[0] == 0:
            raise Told
        return 10.0 * np.asarray(s.x)

    monkeypatch.setattr(Counting, "residual", residual)
    counter = Counter()
    ground, counter.ball = vv.Ground(), vv.PointMass(mass=1.0, position=(1, 0, 0))
    system = vv.System([ground, counter.ball, vv.Distance(a=ground.point(), b=counter.ball.point()), counter])
    system.x[:3] = given = (1.2, 0.3, -0.1)
    system.invalidate()
    with pytest.raises(Told):
        system.check()
    assert np.array_equal(system.x[:3], given) or np.linalg.norm(system.x[:3]) == pytest.approx(1, abs=1e-14)


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.GeneralizedAlpha(), vv.BDF2()])
def test_an_edited_state_goes_on_as_one_given_so(scheme: vv.Scheme) -> None:
    """Accelerations and earlier rates were those of the state before."""

    def swing(x: tuple[float, ...]) -> vv.System:
        ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=x)
        return vv.System([ground, ball, vv.Spring(a=ground, b=ball, stiffness=40.0, free_length=0.5)])

    edited, fresh = swing((1.0, 0.0, 0.0)), swing((1.2, 0.0, 0.0))
    vv.simulate(edited, until=0.5, step=0.01, scheme=scheme)
    for system in (edited, fresh):
        system.x[:3], system.v[:3] = (1.2, 0.0, 0.0), (0.0, 0.3, 0.0)
        system.invalidate()
        vv.simulate(system, until=system.time + 0.5, step=0.01, scheme=scheme)
    assert edited.x == pytest.approx(fresh.x, abs=1e-12)
