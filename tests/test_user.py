"""Components of the user in Python: equal rights to those of the package, and errors that name them."""

import gc
import math
import weakref
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import visviva as vv
from visviva.model.form import dot
from visviva.model.term import Stencils

EXACT = vv.Newton(tolerance=1e-15)
"""What is tested here is the discretisation, not where the iteration stops."""


def momenta(result):
    return max(v for k, v in result.conservation().items() if "momentum" in k or "angular" in k)


def body(name, position, spin):
    return vv.RigidBody(
        mass=2.0, inertia=(1.0, 1.5, 2.0), name=name, position=position, velocity=(0.1, 0.2, -0.3),
        angular_velocity=spin,
    )  # fmt: skip


def two_bodies():
    return body("a", (1, 0, 0), (1, 2, 3)), body("b", (-1, 0.5, 0), (-2, 0, 1))


def run(components, until=1.0, step=0.02, scheme=None):
    return vv.simulate(vv.System(components, EXACT), until=until, step=step, scheme=scheme, project=True)


# --- equal rights: the same result as the package's own component -------------------------------------------


def pendulum(attach):
    """A ball on a spring, a rod or the like, which `attach` makes from ground and ball."""
    ground, ball = vv.Ground(), vv.PointMass(mass=1.5, position=(1.1, 0, 0), velocity=(0, 1, 0.5))
    return run([ground, ball, vv.Gravity(), attach(ground, ball)])


@pytest.mark.parametrize(
    ("own", "users"),
    [
        (
            lambda a, b: vv.Spring(a=a, b=b, stiffness=80.0, free_length=1.0),
            lambda a, b: vv.Potential(
                of=[vv.SquaredDistance(a=a, b=b)], energy=lambda e: 40 * (np.sqrt(e[0]) - 1) ** 2
            ),
        ),
        (
            lambda a, b: vv.Distance(a=a.point(), b=b.point()),
            lambda a, b: vv.Constraint(of=[vv.SquaredDistance(a=a, b=b)], function=lambda e: e[0] - 1.21),
        ),
        (
            lambda a, b: vv.Force(on=b, force=(3.0, 0, 1.0), times="cos(4*t)"),
            lambda a, b: vv.GeneralizedForce(
                of=[b], force=lambda t, x, v: np.cos(4 * t) * np.array([3.0, 0, 1.0])
            ),
        ),
        (
            lambda a, b: vv.Damper(a=a, b=b, damping=0.7),
            lambda a, b: vv.GeneralizedForce(
                of=[vv.SquaredDistance(a=a, b=b)], force=lambda t, e, rate: -0.7 * rate / (4 * e)
            ),
        ),
    ],
    ids=["potential", "constraint", "force", "damper"],
)
def test_user_component_gives_the_same_motion_as_the_package_s_own(own, users):
    ours, theirs = pendulum(own), pendulum(users)
    n = ours.system.n_coordinates
    assert np.abs(np.array(ours.states)[:, :n] - np.array(theirs.states)[:, :n]).max() < 1e-11
    assert theirs.conservation()["energy"] < 1e-12
    works = [sum(r.ledger[f"work_{k}"][-1] for k in r.ledger.works) for r in (ours, theirs)]
    assert works[0] == pytest.approx(works[1], abs=1e-11)


def test_user_term_with_and_without_tangent():
    class Drag(vv.Term):
        kind = "drag"

        def residual(self, s):
            return 0.4 * np.abs(s.rate) * s.rate

    class DragWithTangent(Drag):
        def tangent(self, s):
            first, _ = self.rate_factors(s.step)
            return (0.8 * np.abs(s.rate) * first)[:, :, None] * np.eye(s.rate.shape[1])

    ends = []
    for kind in (Drag, DragWithTangent):
        ball = vv.PointMass(mass=1.0, velocity=(2, 1, 0))
        result = run([ball, vv.UserTerm(term=kind(), on=[ball])])
        assert result.conservation()["energy"] < 1e-12
        assert result.ledger["work_drag"][-1] < -0.1
        ends.append(result.states[-1])
    assert np.abs(ends[0] - ends[1]).max() < 1e-12
    # v' = -0.4 v^2 by component
    assert result.rates[-1][:2] == pytest.approx([2 / (1 + 0.8), 1 / 1.4], abs=1e-4)


# --- conservation for any function of invariant measures ----------------------------------------------------


def test_potential_of_invariants_conserves_everything():
    a, b = two_bodies()
    measures = [
        vv.SquaredDistance(a=a, b=b),
        vv.DirectorProduct(a=a, b=b, i=1, j=3),
        vv.Offset(a=a, to=b, i=2),
    ]
    glue = vv.Potential(
        of=measures,
        energy=lambda e: 3 * e[0] ** 1.5 + e[0] * np.sin(2 * e[1]) + 5 * e[2] ** 2 * e[1],
        kind="glue",
    )
    result = run([a, b, glue], until=2.0)
    assert result.conservation()["energy"] < 1e-12
    assert momenta(result) < 1e-12
    assert np.ptp(result.ledger["potential_glue"]) > 1.0


def test_potential_without_complex_numbers_conserves_too():
    def table(e):  # refuses complex numbers
        return np.interp(
            np.sqrt(e[0]), [0.0, 1.0, 3.0, 9.0], [0.0, 0.0, 8.0, 80.0]
        )  # refuses complex numbers

    a, b = vv.PointMass(mass=1.0), vv.PointMass(mass=2.0, position=(2, 0, 0), velocity=(0, 1, 0))
    result = run([a, b, vv.Potential(of=[vv.SquaredDistance(a=a, b=b)], energy=table)], step=0.01)
    assert result.conservation()["energy"] < 1e-8
    assert momenta(result) < 1e-12


def test_constraint_of_products_of_directors_conserves_everything():
    a, b = two_bodies()
    # a constant-velocity coupling: the axes may tilt, their twist may not
    same_twist = vv.Constraint(
        of=[vv.DirectorProduct(a=a, b=b, i=1, j=2), vv.DirectorProduct(a=a, b=b, i=2, j=1)],
        function=lambda e: e[0] - e[1],
    )
    ball = vv.Spherical(a=a, b=b, at=(0, 0, 0))
    result = run([a, b, ball, same_twist], until=2.0)
    figures = result.conservation()
    assert figures["energy"] < 1e-12
    assert momenta(result) < 1e-12
    assert figures["constraints"] < 1e-13


def test_measures_made_by_a_function_of_the_user():
    a, b = two_bodies()
    bend = vv.Potential(
        of=[lambda: dot(a.directors[2], b.directors[2])], energy=lambda e: 9 * (1 - e[0]) ** 2
    )
    result = run([a, b, bend])
    assert result.conservation()["energy"] < 1e-12
    assert momenta(result) < 1e-12


def test_joint_coordinates_are_measures():
    ground, wheel = vv.Ground(), vv.RigidBody(mass=1.0, inertia=(1, 1, 2), angular_velocity=(0, 0, 1.0))
    axle = vv.Revolute(a=ground, b=wheel, at=(0, 0, 0))
    clock = vv.Potential(of=[axle], energy=lambda e: -5 * np.cos(e[0]))
    motor = vv.GeneralizedForce(
        of=[vv.JointCoordinate(joint=axle)], force=lambda t, e, rate: 0.3 * np.sin(e) - rate
    )
    result = run([ground, wheel, axle, clock, motor])
    assert result.conservation()["energy"] < 1e-12
    assert result.ledger["work_user force"][-1] < -0.1


# --- errors -------------------------------------------------------------------------------------------------

BAD = {
    "raises": (lambda e: {}["nothing"], "raised KeyError: 'nothing'"),
    "nan": (lambda e: e[0] * np.nan, "returned .nan."),
    "shape": (lambda e: np.zeros((3, 3, 3)), "shape"),
}


def later(good, bad, calls=40):
    """A function that turns bad after some calls."""
    count = [0]

    def function(*arguments):
        count[0] += 1
        return (good if count[0] < calls else bad)(*arguments)

    return function


def users(kind, ground, ball, bad):
    """A component of each kind whose function turns bad during the run."""
    distance = [vv.SquaredDistance(a=ground, b=ball)]
    name = "culprit"
    if kind == "potential":
        return vv.Potential(of=distance, energy=later(lambda e: 9 * e[0], bad), name=name)
    if kind == "constraint":
        return vv.Constraint(of=distance, function=later(lambda e: e[0] - 1, bad), name=name)
    if kind == "spring":
        return vv.Spring(a=ground, b=ball, energy=later(lambda l: l**2, lambda l: bad(l[None])), name=name)
    if kind == "force":
        return vv.Force(on=ball, force=later(lambda t, x, v: -x, lambda t, x, v: bad(x)), name=name)

    class Own(vv.Term):
        residual = staticmethod(later(lambda s: 3 * s.x, lambda s: bad(s.x.T)))

    return vv.UserTerm(term=Own(), on=[ball], name=name)


@pytest.mark.parametrize("fault", BAD)
@pytest.mark.parametrize("kind", ["potential", "constraint", "spring", "force", "term"])
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_faulty_function_is_named_and_the_last_state_stays(kind, fault):
    bad, words = BAD[fault]
    ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(1, 0, 0), velocity=(0, 1, 0))
    system = vv.System([ground, ball, users(kind, ground, ball, bad)])
    states = []
    with pytest.raises(vv.RunError) as caught:  # noqa: PT012
        for _ in range(100):
            system.step(0.01)
            states.append((system.time, system.x.copy(), system.v.copy()))
    assert "'culprit'" in str(caught.value)
    if kind != "term" and not (fault == "nan" and kind == "force"):
        assert caught.match(words)
    if states:
        time, x, v = states[-1]
        assert system.time == time
        assert np.array_equal(system.x, x)
        assert np.array_equal(system.v, v)
    assert not np.any(system.core.dx)


def test_run_continues_after_an_error_that_was_mended():
    broken = [False]

    def energy(e):
        if broken[0]:
            raise ValueError("out of order")
        return 20 * e[0]

    def make():
        ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(1, 0, 0), velocity=(0, 1, 0))
        return vv.System(
            [ground, ball, vv.Potential(of=[vv.SquaredDistance(a=ground, b=ball)], energy=energy)]
        )

    interrupted, whole = make(), make()
    for k in range(20):
        if k == 7:
            broken[0] = True
            with pytest.raises(vv.RunError, match="out of order"):
                interrupted.step(0.01)
            broken[0] = False
        interrupted.step(0.01)
        whole.step(0.01)
    assert np.abs(interrupted.x - whole.x).max() < 1e-13


def test_error_in_the_ledger_leaves_the_accepted_state():
    class Faulty(vv.Term):
        kind = "faulty"

        def residual(self, s):
            return 0.1 * s.rate

        def work(self, s):
            raise ZeroDivisionError("no work today")

    ball = vv.PointMass(mass=1.0, velocity=(1, 0, 0))
    system = vv.System([ball, vv.UserTerm(term=Faulty(), on=[ball], name="culprit")])
    with pytest.raises(vv.RunError, match=r"'culprit'.*no work today"):
        system.step(0.1)
    assert system.time == 0
    assert system.x[:3].tolist() == [0, 0, 0]
    assert system.v[:3].tolist() == [1, 0, 0]


def test_interrupt_inside_a_function_leaves_the_system_usable():
    interrupt = [True]

    def force(t, x, v):
        if interrupt.pop() if interrupt else False:
            raise KeyboardInterrupt
        return -x

    ball = vv.PointMass(mass=1.0, position=(1, 0, 0))
    system = vv.System([ball, vv.Force(on=ball, force=force)])
    with pytest.raises(KeyboardInterrupt):
        system.step(0.1)
    system.step(0.1)
    assert system.time == pytest.approx(0.1)


def test_system_is_released_though_a_function_knows_it():
    def make():
        ball, seen = vv.PointMass(mass=1.0, position=(1, 0, 0)), {}
        system = vv.System([ball, vv.Force(on=ball, force=lambda t, x, v: -x * len(seen))])
        seen["system"] = system
        system.step(0.1)
        return weakref.ref(system)

    gone = make()
    gc.collect()
    assert gone() is None


def test_user_components_say_what_is_wrong():
    ball = vv.PointMass(mass=1.0)
    with pytest.raises(ValueError, match="list of measures"):
        vv.Potential(of=ball, energy=lambda e: e)
    with pytest.raises(ValueError, match="Python function"):
        vv.Potential(of=[ball], energy=3)
    with pytest.raises(ValueError, match="at least one is needed"):
        vv.System([ball, vv.Constraint(of=[ball], function=lambda e: e, n=0)])
    with pytest.raises(vv.InputError, match="no coordinates"):
        vv.System([ball, vv.UserTerm(term=vv.Term(), on=[vv.Ground()])])


class Ballast(vv.Term):
    """More of the mass that a body has, as a term in Python: ``M q''`` with the mass matrix of the body."""

    kind, stores = "ballast", "kinetic"

    def __init__(self, mass):
        super().__init__()
        self.M = np.kron(mass, np.eye(3))

    def residual(self, s):
        return s.second_rate @ self.M

    def energy(self, s):
        return 0.5 * np.einsum("ni,ij,nj->n", s.v1, self.M, s.v1)


def test_momenta_of_terms_in_python_are_booked():
    """A body with its mass once more as a term has twice the momenta, about the same motion."""

    def books(double):
        spin = {"angular_velocity": (0.3, 2.0, -0.5), "velocity": (1.0, 0.2, 0.1), "position": (0.5, 1, 2)}
        body = vv.RigidBody(shape=vv.Box(size=(1, 2, 3)), density=0.7, **spin)
        more = [vv.UserTerm(term=Ballast(body.mass_matrix()), on=[body])] if double else []
        return vv.simulate(vv.System([body, *more]), until=1.0, step=0.02).ledger

    once, twice = books(False), books(True)
    for name in ("momentum_x", "momentum_z", "angular_x", "angular_y", "angular_z"):
        assert np.abs(once[name][0]) > 0.1
        assert twice[name] == pytest.approx(2 * once[name], rel=1e-10)
        assert twice.drift(name) < 1e-12


@pytest.mark.parametrize("start", [1.5, 0.99])
def test_a_bumper_in_absolute_values_pushes_back_wherever_it_starts(start: float) -> None:
    """Whether it takes complex numbers is not told where it is zero: springs slack at first lost their force."""
    ends = []
    for energy in (
        lambda length: 0.5e4 * np.minimum(length - 1.0, 0.0) ** 2,
        lambda length: np.where(length < 1.0, 0.5e4 * abs(length - 1.0) ** 2, 0.0),
    ):
        ground = vv.Ground()
        ball = vv.PointMass(mass=1.0, position=(start, 0, 0), velocity=(-1, 0, 0))
        system = vv.System([ground, ball, vv.Spring(a=ground.point(), b=ball.point(), energy=energy)])
        vv.simulate(system, until=1.0, step=0.001).assert_conserved("energy", tolerance=1e-9)
        ends.append([system.x[0], system.v[0]])
    assert ends[1] == pytest.approx(ends[0], rel=1e-9)
    assert ends[1][1] > 0.9


class Barrier(vv.Term):
    """Pushes what comes down to x = -1 back up; there is nothing below."""

    def residual(self, s: Stencils) -> Any:
        found = np.zeros_like(s.x)
        with np.errstate(all="ignore"):
            found[:, 0] = -1 / np.sqrt(1 + s.x[:, 0])
        return found


def test_steps_that_go_where_a_term_has_no_value_are_halved() -> None:
    """The first step would go through the barrier; halved, the run is that of halves, of second order."""
    ends = []
    for step in (2.0, 1.0, 1 / 8, 1 / 256):
        ball = vv.PointMass(mass=1.0, velocity=(-1.2, 0, 0))
        system = vv.System([ball, vv.UserTerm(term=Barrier(), on=[ball])])
        result = vv.simulate(system, until=2.0, step=step)
        assert result.statistics.rejected == (step == 2.0)
        ends.append(system.x[0])
    exact = solve_ivp(lambda t, y: (y[1], (1 + y[0]) ** -0.5), (0, 2), (0, -1.2), rtol=1e-12, atol=1e-12).y[
        0, -1
    ]
    assert ends[0] == pytest.approx(ends[1], rel=1e-12)
    assert (ends[2] - exact) / (ends[3] - exact) == pytest.approx(32**2, rel=0.1)


class NearAlone(vv.Term):
    """Nothing but books that have no value, or raise, after steps of more than a third."""

    def __init__(self, beyond: Callable[[], float]) -> None:
        super().__init__()
        self.beyond = beyond

    def residual(self, s: Stencils) -> Any:
        return np.zeros_like(s.x)

    def energy(self, s: Stencils) -> Any:
        return np.array(
            [
                self.beyond() if abs(x1 - x0) > 1 / 3 else 0.0
                for x0, x1 in zip(s.x0[:, 0], s.x1[:, 0], strict=True)
            ]
        )


@pytest.mark.parametrize("adaptive", [None, vv.Adaptive()])
@pytest.mark.parametrize(
    "beyond", [lambda: math.nan, lambda: math.sqrt(-1), lambda: 1 / 0, lambda: math.exp(1e9)]
)
@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.GeneralizedAlpha()])
def test_steps_whose_end_has_no_energy_are_halved(adaptive: Any, beyond: Any, scheme: Any) -> None:
    """A ball on a straight line goes on as if there were no books, also where they project its rates."""
    ground, ball = vv.Ground(), vv.PointMass(mass=1.0, velocity=(-1.2, 0, 0))
    line = vv.PointOnLine(a=ground.frame(axes=((0, 0, 1), (0, 1, 0), (-1, 0, 0))), b=ball.point())
    term = vv.UserTerm(term=NearAlone(beyond), on=[ball])
    system = vv.System([ground, ball, line, term])
    result = vv.simulate(system, until=2.0, step=1.0, scheme=scheme, adaptive=adaptive)
    assert result.statistics.rejected > 1
    assert system.x[:3] == pytest.approx([-2.4, 0, 0], abs=1e-12)


@pytest.mark.parametrize("adaptive", [None, vv.Adaptive()])
def test_energies_that_raise_beyond_their_range_are_tried_with_shorter_steps(adaptive: Any) -> None:
    """``math.log`` raises where numpy's gives nan: a ball bounces off the barrier alike, as the exact one does."""

    def exact() -> float:
        ode = solve_ivp(lambda t, y: (y[1], 1 / y[0]), (0, 1), (1, -3), rtol=1e-11, atol=1e-11)
        return float(ode.y[0, -1])

    ends = []
    for log in (lambda e: np.log(e[0]), lambda e: np.array([math.log(x.real) for x in e[0]])):
        ball = vv.PointMass(mass=1.0, position=(1, 0, 0), velocity=(-3, 0, 0))
        system = vv.System([ball, vv.Potential(of=[ball], energy=lambda e, log=log: -log(e))])
        with np.errstate(invalid="ignore"):
            result = vv.simulate(system, until=1.0, step=0.5, adaptive=adaptive)
        ends.append(system.x[0])
    assert result.statistics.rejected > 0
    assert ends == [pytest.approx(exact(), rel=0.01 if adaptive else 0.2)] * 2
    assert ends[1] == pytest.approx(ends[0], rel=1e-9)


def test_what_raises_at_the_start_is_not_tried_again() -> None:
    ball = vv.PointMass(mass=1.0, position=(-1, 0, 0))
    system = vv.System([ball, vv.Potential(of=[ball], energy=lambda e: [math.log(x.real) for x in e[0]])])
    with pytest.raises(vv.RunError, match="raised ValueError: ") as found:
        vv.simulate(system, until=1.0, step=0.5)
    assert not isinstance(found.value, vv.StepFailure)
    assert system.stepper.rejected == 0


def test_terms_without_value_are_named_when_no_step_helps() -> None:
    class Later(vv.Term):
        def residual(self, s: Stencils) -> Any:
            return np.full_like(s.x, np.inf if s.step.te > 0 else 0.0)

    ball = vv.PointMass(mass=1.0)
    system = vv.System([ball, vv.UserTerm(term=Later(), on=[ball], name="later")])
    with pytest.raises(vv.StepFailure, match="UserTerm 'later': its residual is not finite") as found:
        vv.simulate(system, until=1.0, step=0.5)
    assert "increments" not in str(found.value)
    assert system.time == 0
