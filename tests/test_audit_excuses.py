"""What an audit excuses, as far as what it names can bring about: energies out of nothing beside it are wrong."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import visviva as vv
from visviva.model.term import Stencils, Term
from visviva.results.audit import energy_verdict
from visviva.study.run import run

WELL = vv.DoubleWell(barrier=1.0)
SQUARE = vv.RectangleMesh(size=(1, 1), counts=(2, 2))
LACKS = "WRONG, as the balance lacks"
STIFF = vv.SaintVenantKirchhoff(young=100.0, poisson=0.2)


class Leak(Term):
    """A force on unknowns of an order that the ledger is told nothing of."""

    def __init__(self, force: float, order: int) -> None:
        super().__init__()
        self.force, self.of = force, order

    def residual(self, s: Stencils) -> Any:
        r = np.zeros_like(s.x1)
        r[:, self.order == self.of] = -self.force
        return r

    def tangent(self, s: Stencils) -> Any:
        return np.zeros((1, s.x1.shape[1], s.x1.shape[1]))

    def work(self, s: Stencils) -> Any:
        return np.zeros(len(s.x1))


class Push(Leak):
    """The same, rising with the load."""

    def residual(self, s: Stencils) -> Any:
        return super().residual(s) * s.step.te


def drawn(share: float) -> list[Any]:
    """A ball on a spring, drawn by 0.5 with a force of 20 at the end, of which this share is not booked."""
    ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(1, 0, 0))
    spring = vv.Spring(a=ground.point(), b=ball.point(), stiffness=40.0, free_length=1.0)
    along = vv.Constraint(of=[ball], function=lambda x: [x[1], x[2]], n=2)
    leak = vv.UserTerm(term=Push(20.0 * share, 2), on=[ball])
    pull = vv.Force(on=ball, force=(20.0 * (1 - share), 0, 0), times="t")
    return [ground, ball, spring, along, leak, pull]


def smooth() -> vv.CahnHilliard:
    mesh = vv.SplineBox(size=(1, 1), counts=(2, 2), degree=2)
    return vv.CahnHilliard(mesh=mesh, form="direct", free_energy=WELL, gradient_energy=1.0, concentration=0.5)


def brittle(**options: Any) -> vv.FracturingSolid:
    return vv.FracturingSolid(mesh=SQUARE, material=STIFF, toughness=1.0, length=1.0, **options)


def resting_history() -> vv.FracturingSolid:
    return brittle(density=1.0, irreversibility="history")


def pulled_history() -> vv.FracturingSolid:
    return brittle(density=1.0, irreversibility="history", velocity=lambda X: 3.0 * X * [1.0, 0.0, 0.0])


def leaking(beside: Callable[[], Any], scheme: vv.Scheme | None = None, force: float = 0.5) -> vv.Result:
    ball = vv.PointMass(mass=1.0, position=(1, 0, 0))
    system = vv.System([beside(), ball, vv.UserTerm(term=Leak(force, 2), on=[ball])])
    return vv.simulate(system, until=1.0, step=0.05, scheme=scheme)


@pytest.mark.parametrize("beside", [smooth, resting_history])
def test_what_rests_excuses_nothing(beside: Callable[[], Any]) -> None:
    assert energy_verdict(leaking(beside)).startswith("WRONG, as this scheme conserves energy")


@pytest.mark.parametrize("scheme", [vv.Midpoint(), vv.GeneralizedAlpha(rho=1.0)], ids=str)
@pytest.mark.parametrize("lost", [False, True])
def test_schemes_that_neither_conserve_nor_damp_excuse_what_sways(scheme: vv.Scheme, lost: bool) -> None:
    """By a thousandth, of a ball that swings on a spring; none of a force that speeds it up, or takes half of all."""
    verdicts = []
    for leak in (0.0, -1.0 if lost else 0.5):
        ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(1, 0, 0))
        spring = vv.Spring(a=ground.point(), b=ball.point(), stiffness=40.0, free_length=0.9)
        parts = [ground, spring] if leak == 0 else [vv.Force(on=ball, force=(2.0, 2.0, 2.0))] if lost else []
        system = vv.System([*parts, ball, vv.UserTerm(term=Leak(leak, 2), on=[ball])])
        verdicts.append(energy_verdict(vv.simulate(system, until=3.0, step=0.02, scheme=scheme)))
    assert not verdicts[0].startswith("WRONG")
    assert verdicts[1].startswith("WRONG, as this scheme neither conserves energy nor damps")


@pytest.mark.parametrize("mean", [300.0, 320.0])
@pytest.mark.parametrize(
    "scheme",
    [vv.EnergyMomentum(), vv.Midpoint(), vv.BackwardEuler(), vv.BDF2(), vv.GeneralizedAlpha(rho=0.5)],
    ids=str,
)
def test_heat_that_evens_out_within_a_shell_is_no_gain(scheme: vv.Scheme, mean: float) -> None:
    """Where it lies about the temperature that energies count from, too: there is hardly any then."""
    shell = vv.ThermalShell(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(1, 1)),
        section=vv.SolidSection(material=vv.NeoHooke(young=1e4, poisson=0.0), thickness=0.1, density=1.0),
        heat=vv.Heat(conductivity=10.0, capacity=2.0, reference=300.0),
        temperature=mean,
        difference=40.0,
    )
    system = vv.System([shell, vv.Fixed(solid=shell, nodes="all")])
    result = vv.simulate(system, until=0.5, step=0.02, scheme=scheme)
    assert shell.face_temperatures(system.x) == pytest.approx(mean, abs=0.04)
    assert not energy_verdict(result).startswith("WRONG")
    evened_out = 0.1 * mean * (20 / mean) ** 2 / 3  # by entropies, of linear temperatures, to second order
    assert result.ledger.energy_scale == pytest.approx(evened_out, rel=0.1)


def test_history_excuses_what_it_may_lose() -> None:
    verdict = energy_verdict(leaking(pulled_history, force=0.0))
    assert "has irreversibility = 'history'" in verdict


def test_rounding_of_what_is_not_loaded_is_excused() -> None:
    """What the history field changes of 2e-17 is all that there is, to 3e-13 of that."""
    mesh = vv.RectangleMesh(size=(1, 1), counts=(3, 3), cell="quad8", origin=(0.2, 0))
    solid = vv.FracturingSolid(
        mesh=mesh,
        material=vv.SaintVenantKirchhoff(young=1.0, poisson=0.2),
        toughness=1.0,
        length=1.0,
        model="AT1",
        plane="strain",
        irreversibility="history",
    )
    result = vv.quasi_static(vv.System([solid, vv.Fixed(solid=solid, nodes="x0")]), until=1.0, step=1.0)
    assert not energy_verdict(result).startswith("WRONG")


def test_stored_strain_of_a_mixture_excuses_no_gain_of_others() -> None:
    """What diffuses loses less than half of what the ball gains, strains of the spin store twenty times that."""

    def spinning() -> vv.MixtureSolid:
        return vv.MixtureSolid(
            mesh=vv.RectangleMesh(size=(4, 4), counts=(4, 4)),
            material=STIFF,
            density=1.0,
            free_energy=WELL,
            gradient_energy=0.6,
            concentration=lambda X: 0.5 + 0.1 * np.cos(np.pi * X[:, 0] / 4),
            eigenstrain=0.01,
            velocity=lambda X: (X - [2.0, 2.0, 0.0])[:, [1, 0, 2]] * [1.0, -1.0, 0.0],
        )

    assert energy_verdict(leaking(spinning, vv.BDF2())).startswith("WRONG, as this scheme is to dissipate")


@pytest.mark.parametrize("scheme", [vv.BackwardEuler(), vv.BDF2(), vv.GeneralizedAlpha()])
def test_contents_out_of_nothing_are_no_excuse_of_themselves(scheme: vv.Scheme) -> None:
    warm = vv.ThermalBody(mesh=SQUARE, conductivity=1.0, capacity=1.0, temperature=300.0)
    filled = vv.CahnHilliard(mesh=SQUARE, free_energy=WELL, gradient_energy=0.5, concentration=0.0)
    for body, force in ((warm, 1.0), (filled, 0.05)):
        system = vv.System([body, vv.UserTerm(term=Leak(force, 1), on=[body])])
        result = vv.simulate(system, until=1.0, step=0.05, scheme=scheme)
        assert energy_verdict(result).startswith("WRONG, as this scheme is to dissipate energy")


def test_entropy_at_rest_excuses_no_work_of_statics() -> None:
    crack = vv.ThermalFracturingSolid(
        mesh=SQUARE,
        material=STIFF,
        toughness=1.0,
        length=1.0,
        heat=vv.Heat(conductivity=1.0, capacity=1.0, expansion=1e-5, reference=300.0),
        temperature=300.0,
    )
    held = [vv.Fixed(solid=crack, nodes="x0"), vv.PrescribedTemperature(body=crack, nodes="x0", value=300.0)]
    result = vv.quasi_static(vv.System([*drawn(1.0), crack, *held]), until=1.0, step=0.1)
    assert energy_verdict(result).startswith(LACKS)


def channel() -> list[Any]:
    """A flow between walls, which brings 0.3 and loses 0.6 in the only load step."""
    flow = vv.Fluid(
        mesh=vv.RectangleMesh(size=(2, 1), counts=(8, 4), cell="tri6"), density=1.0, viscosity=0.01
    )
    enters = vv.VelocityBoundary(
        fluid=flow,
        faces="x0",
        velocity=lambda t, X: X[:, 1:2] * (1 - X[:, 1:2]) * [4, 0, 0] * (1 + 0.5 * np.sin(3 * t)),
    )
    walls = [vv.NoSlip(fluid=flow, faces=y) for y in ("y0", "y1")]
    return [flow, enters, *walls, vv.Outlet(fluid=flow, faces="x1")]


def test_powers_of_steady_flows_are_no_leak_and_excuse_none_of_others() -> None:
    verdicts = []
    for beside in ([], drawn(0.0), drawn(0.05), snapping(100.0, 4000.0)):
        result = vv.quasi_static(vv.System([*channel(), *beside]), until=1.0, step=1.0)
        assert result.ledger.imbalance() > 0.1
        verdicts.append(energy_verdict(result))
    assert all(said.endswith("of steady flows it is powers that balance") for said in verdicts[:2])
    assert verdicts[2].startswith(LACKS)
    assert verdicts[3].startswith("WRONG, if load steps were short")


def snapping(load: float, stiffness: float = 40.0) -> list[Any]:
    """Two springs whose apex snaps through under a dead load."""
    ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(0, 0.3, 0))
    springs = [
        vv.Spring(
            a=ground.point((x, 0, 0)),
            b=ball.point(),
            stiffness=stiffness,
            free_length=float(np.hypot(1, 0.3)),
        )
        for x in (-1.0, 1.0)
    ]
    along = vv.Constraint(of=[ball], function=lambda x: [x[0], x[2]], n=2)
    return [ground, ball, *springs, along, vv.Force(on=ball, force=(0, -load, 0), times="t")]


def test_work_excuses_nothing_of_statics_beside_what_it_is_not_brought_to() -> None:
    def resting() -> list[Any]:
        body = warm()
        return [
            body,
            vv.Fixed(solid=body, nodes="x0"),
            vv.PrescribedTemperature(body=body, nodes="x0", value=300.0),
        ]

    result = vv.quasi_static(vv.System([*drawn(0.28), *resting()]), until=1.0, step=0.1)
    assert result.ledger.swing("work_force") > result.ledger.size("imbalance") > 1.0
    assert energy_verdict(result).startswith(LACKS)
    result = vv.quasi_static(vv.System([*snapping(2.0), *resting()]), until=1.0, step=0.1)
    assert energy_verdict(result).startswith("WRONG, if load steps were short")


def test_work_excuses_no_loss_beside_what_it_is_not_brought_to() -> None:
    """Half of the work of a force goes with another that is not booked."""
    ball = vv.PointMass(mass=1.0, position=(1, 0, 0))
    pushed = [vv.Force(on=ball, force=(2.0, 2.0, 2.0)), vv.UserTerm(term=Leak(-1.0, 2), on=[ball])]
    result = vv.simulate(vv.System([ball, *pushed, smooth()]), until=1.0, step=0.05)
    assert result.ledger.imbalance() == pytest.approx(0.5)
    assert energy_verdict(result).startswith("WRONG, as this scheme conserves energy")


@pytest.mark.parametrize("share", [0.05, 0.28])
@pytest.mark.parametrize("step", [0.1, 0.02])
def test_trapezoids_excuse_no_load_that_is_not_booked(share: float, step: float) -> None:
    """Forces are linear in the way: the sum of works over load steps misses nothing of 5."""
    result = vv.quasi_static(vv.System(drawn(share)), until=1.0, step=step)
    assert result.ledger.last("imbalance") == pytest.approx(5.0 * share)
    assert energy_verdict(result).startswith(LACKS)


def served(ground: vv.Ground) -> list[Any]:
    """A servo that turns an arm against a spring of 3."""
    arm = vv.RigidBody(mass=1.0, inertia=(1, 1, 1), position=(1, 8, 0))
    axle = vv.Revolute(a=ground, b=arm, at=(0, 8, 0), axis=(0, 0, 1), angle=True)
    servo = vv.Servo(output=[axle], follows=["0.3*t**2"], actuators=[axle])
    return [arm, axle, vv.JointSpring(joint=axle, stiffness=3.0), servo]


@pytest.mark.parametrize("heated", [False, True])
def test_what_hangs_together_with_servos_alone_is_not_checked(heated: bool) -> None:
    """A load beside was not booked by 28 %, and beside heat altogether, without a word."""
    verdicts = []
    for share in (0.0, 0.05, 0.28):
        parts = drawn(share)
        parts += served(parts[0])
        if heated:
            wall = vv.ThermalBody(
                mesh=vv.RectangleMesh(size=(1, 1), counts=(1, 1)), conductivity=1.0, temperature=300.0
            )
            parts += [wall, vv.PrescribedTemperature(body=wall, nodes="x0", value=300.0)]
        result = vv.quasi_static(vv.System(parts), until=1.0, step=0.25)
        verdicts.append(energy_verdict(result))
    assert verdicts[0].startswith("NOT CHECKED of what hangs together with servos")
    assert all(said.startswith(LACKS) for said in verdicts[1:])


def test_snaps_beside_servos_are_found() -> None:
    parts = snapping(2.0)
    result = vv.quasi_static(vv.System([*parts, *served(parts[0])]), until=1.0, step=0.1)
    assert energy_verdict(result).startswith("WRONG, if load steps were short")


@pytest.mark.parametrize("share", [0.02, 0.05, 0.25])
def test_work_on_what_is_heated_excuses_nothing_beside(share: float) -> None:
    """A traction does work of 0.3 on it; 0.1 to 1.3 of 5 on the ball are not booked."""
    body = warm()
    held = [
        vv.Fixed(solid=body, nodes="x0"),
        vv.PrescribedTemperature(body=body, nodes="x0", value="300+20*t"),
    ]
    pull = vv.Traction(solid=body, faces="x1", traction=(8, 0, 0), times="t")
    verdicts = []
    for leak in (0.0, share):
        result = vv.quasi_static(
            vv.System([*drawn(leak), *deepcopy([body, *held, pull])]), until=1.0, step=0.1
        )
        verdicts.append(energy_verdict(result))
    assert "heat that bodies give away" in verdicts[0]
    assert verdicts[1].startswith(LACKS)


def swaying(leak: float) -> list[Any]:
    """A square whose side is moved to and fro, by which sums miss a three-hundredth, and a force that is not booked."""
    solid = vv.Solid(mesh=SQUARE, material=STIFF)
    motion = ("0.3*sin(2*t)", "0.2*t", None)
    moved = [vv.Fixed(solid=solid, nodes="x0"), vv.Prescribed(solid=solid, nodes="x1", motion=motion)]
    return [solid, *moved, vv.UserTerm(term=Push(leak, 2), on=[solid])]


@pytest.mark.parametrize("leak", [0.05, -0.05])
def test_leaks_do_not_hide_in_what_sums_miss_whatever_their_sign(leak: float) -> None:
    """They halve the imbalance, or double it."""
    verdicts = []
    for force in (0.0, leak):
        verdicts.append(energy_verdict(vv.quasi_static(vv.System(swaying(force)), until=1.0, step=0.1)))
    assert "is a trapezoidal sum" in verdicts[0]
    assert verdicts[1].startswith(LACKS)


def relaxing(step: float, leak: float, kind: str) -> str:
    """Of a square that is drawn and relaxes, by which it loses a twentieth of the work, or rubs."""
    solid = vv.ViscoelasticSolid(
        mesh=SQUARE, material=STIFF, branches=[vv.MaxwellBranch(time=0.1, share=0.5)]
    )
    pull: Any = vv.Traction(solid=solid, faces="x1", traction=(10, 0, 0), times="t")
    if kind == "moved":
        pull = vv.Prescribed(solid=solid, nodes="x1", motion=("0.2*sin(6*t)", None, None))
    parts = [solid, vv.Fixed(solid=solid, nodes="x0"), pull, vv.UserTerm(term=Push(leak, 2), on=[solid])]
    return energy_verdict(vv.quasi_static(vv.System(parts), until=1.0, step=step))


def test_losses_of_steps_excuse_what_they_waver_by_alone() -> None:
    for kind in ("drawn", "moved"):
        for step in (1.0, 0.25, 0.05):
            assert "WRONG" not in relaxing(step, 0.0, kind)
    assert relaxing(0.05, 0.05, "drawn").startswith(LACKS)


def bent(leak: float) -> list[Any]:
    """A bar that a pressure bends by its width in four load steps, which work misses by a hundredth; and a leak."""
    mesh = vv.RectangleMesh(size=(4, 1), counts=(4, 1), cell="quad8")
    solid = vv.Solid(mesh=mesh, material=vv.SaintVenantKirchhoff(young=50.0, poisson=0.3))
    push = vv.Pressure(solid=solid, faces="y0", pressure="0.3*t")
    return [solid, vv.Fixed(solid=solid, nodes="x0"), push, *drawn(leak)]


def test_trapezoids_of_what_bends_excuse_what_they_miss_alone() -> None:
    verdicts = {}
    for leak in (0.0, 0.05):
        result = vv.quasi_static(vv.System(bent(leak)), until=1.0, step=0.25)
        verdicts[leak] = energy_verdict(result)
        assert result.ledger.imbalance() > 1e-3
    assert "is a trapezoidal sum" in verdicts[0.0]
    assert verdicts[0.05].startswith(LACKS)


def test_what_sums_miss_follows_from_energies() -> None:
    """To a thousandth, in a step, as they are the same path: energies that rise less half of the forces at its ends."""
    result = vv.quasi_static(vv.System(bent(0.0)), until=1.0, step=0.25)
    assert result.ledger.sizes.missed is not None
    assert result.ledger.sizes.missed.span[0, 0] == pytest.approx(result.ledger.last("imbalance"), rel=1e-3)


@pytest.mark.parametrize("changes", [(-6,), (-6, 6), (6,)])
def test_heat_excuses_no_gain_of_others_in_statics(changes: tuple[int, ...]) -> None:
    """A ball on a spring gains 5 out of nothing, bodies beside it 6.6 of heat each, or lose it."""
    heated: list[Any] = []
    for by in changes:
        body = warm()
        held = vv.PrescribedTemperature(body=body, nodes="all", value=f"300 + {by}*t")
        heated += [body, vv.Fixed(solid=body, nodes="x0"), held]
    result = vv.quasi_static(vv.System([*drawn(1.0), *deepcopy(heated)]), until=1.0, step=0.1)
    assert energy_verdict(result).startswith(LACKS)
    result = vv.quasi_static(vv.System([*drawn(0.0), *heated]), until=1.0, step=0.1)
    assert "heat that bodies give away" in energy_verdict(result)


def test_steady_heat_is_no_snap() -> None:
    """Of a body that balances heat, and no entropy."""
    body = vv.ThermalBody(mesh=SQUARE, conductivity=1.0, capacity=1.0, temperature=300.0)
    held = [vv.PrescribedTemperature(body=body, nodes=f"x{k}", value=f"300 + {50 * k}*t") for k in (0, 1)]
    result = vv.quasi_static(vv.System([body, *held]), until=1.0, step=0.1)
    assert result.ledger.imbalance() > 0.5
    assert "heat that bodies give away" in energy_verdict(result)


def warm(**options: Any) -> vv.ThermoelasticSolid:
    heat = vv.Heat(conductivity=1.0, capacity=1.0, expansion=1e-3, reference=300.0)
    return vv.ThermoelasticSolid(mesh=SQUARE, material=STIFF, heat=heat, temperature=300.0, **options)


@pytest.mark.parametrize("sign", [1, -1])
def test_heat_given_away_by_statics_is_no_snap(sign: int) -> None:
    """Pulled or pressed at one temperature: by the heat that is not booked the balance misses all that was stored."""
    body = warm()
    held = vv.PrescribedTemperature(body=body, nodes="all", value=300.0)
    pulled = vv.Prescribed(solid=body, nodes="x1", motion=(f"{sign}*.05*t", 0, None))
    system = vv.System([body, held, vv.Fixed(solid=body, nodes="x0"), pulled])
    result = vv.quasi_static(system, until=1.0, step=0.1)
    assert result.ledger.imbalance() > 0.5
    assert "heat that bodies give away" in energy_verdict(result)


@pytest.mark.parametrize("scheme", [vv.BackwardEuler(), vv.BDF2(), vv.GeneralizedAlpha()])
def test_heat_of_a_body_excuses_no_gain_of_others(scheme: vv.Scheme) -> None:
    def heated() -> list[Any]:
        body = warm(density=1.0)
        return [body, vv.PrescribedTemperature(body=body, nodes="all", value="300 + 10*t")]

    verdicts = []
    for force in (0.0, 1.0):
        ball = vv.PointMass(mass=1.0, position=(1, 0, 0))
        system = vv.System([*heated(), ball, vv.UserTerm(term=Leak(force, 2), on=[ball])])
        verdicts.append(energy_verdict(vv.simulate(system, until=1.0, step=0.05, scheme=scheme)))
    assert not verdicts[0].startswith("WRONG")
    assert verdicts[1].startswith("WRONG, as this scheme is to dissipate energy")


def test_what_a_source_feeds_may_go_by_diffusion_that_is_not_booked() -> None:
    """It stores little of what it gets."""
    body = smooth()
    source = vv.ConcentrationSource(body=body, rate=lambda t, X: 0.5 * np.cos(np.pi * X[:, 0]))
    result = vv.simulate(vv.System([body, source]), until=20.0, step=0.25)
    assert -result.ledger.least("imbalance") > 2 * result.ledger.swing("potential_stored")
    assert "has form = 'direct'" in energy_verdict(result)


@pytest.mark.parametrize("load", [1e-3, 1e-5, 1e-6])
def test_rounding_of_small_strains_is_nothing_that_lacks(load: float) -> None:
    """Energies of these are differences of large numbers, and forces the differences of those."""
    solid = vv.Solid(mesh=SQUARE, material=vv.NeoHooke(young=100.0, poisson=0.4))
    pull = vv.Traction(solid=solid, faces="x1", traction=(load, load, 0), times="t")
    system = vv.System([solid, vv.Fixed(solid=solid, nodes="x0"), pull])
    assert not energy_verdict(vv.quasi_static(system, until=1.0, step=0.5)).startswith("WRONG")


def heated_beside(ground: vv.Ground) -> list[Any]:
    """Steel that is given 1000 of heat."""
    mesh = vv.BoxMesh(size=(0.1, 0.1, 0.1), counts=(1, 1, 1))
    body = vv.ThermalBody(mesh=mesh, conductivity=50.0, capacity=460.0, density=7800.0, temperature=300.0)
    return [body, vv.HeatFlux(body=body, faces="x1", flux=1e5)]


def driven_beside(ground: vv.Ground) -> list[Any]:
    """An arm that a motor gives 176."""
    arm = vv.RigidBody(shape=vv.Box(size=(1, 0.1, 0.1)), density=1000.0, position=(0.5, 3, 0))
    axle = vv.Revolute(a=ground, b=arm, at=(0, 3, 0), axis=(0, 1, 0), angle=True)
    return [arm, axle, vv.Motor(joint=axle, motion="5*t**2")]


@pytest.mark.parametrize("scheme", [vv.BackwardEuler(), vv.BDF2(), vv.GeneralizedAlpha()], ids=str)
@pytest.mark.parametrize("beside", [heated_beside, driven_beside])
def test_what_is_brought_excuses_no_gain_of_what_does_not_hang_together_with_it(
    scheme: vv.Scheme, beside: Callable[[vv.Ground], list[Any]]
) -> None:
    """Of a ball on a spring whose load is booked, or only to seven tenths"""
    for share in (0.0, 0.3):
        parts = drawn(share)
        system = vv.System([*parts, *beside(parts[0])])
        verdict = energy_verdict(vv.simulate(system, until=1.0, step=0.01, scheme=scheme))
        assert verdict.startswith("WRONG") == (share > 0)
        assert ("PointMass 'pointmass-1', " in verdict) == (share > 0)


@pytest.mark.parametrize("share", [0.0, 0.3])
def test_gains_before_a_run_was_resumed_are_known(share: float, tmp_path: Path) -> None:
    """As in one run, to the last bit."""
    spans = []
    for ends in ((1.0,), (0.7, 1.0)):
        directory = tmp_path / str(len(ends))
        for until in ends:
            parts = drawn(share)
            system = vv.System([*parts, *heated_beside(parts[0])])
            study = vv.Study(system, until=until, step=0.05, scheme=vv.BDF2())
            result = run(study, directory, resume=until > ends[0], pictures=False)
        assert energy_verdict(result).startswith("WRONG") == (share > 0)
        assert result.ledger.sizes.groups is not None
        spans.append(result.ledger.sizes.groups.span)
    assert np.array_equal(*spans)


def tied(scheme: vv.Scheme, leak: float, conductance: float, flux: float) -> vv.Result:
    """A ball on a warm spring beside a store and a body that is heated, all of which exchange heat, and a force."""
    ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(1, 0, 0))
    spring = vv.ThermalSpring(a=ground, b=ball, stiffness=40.0, capacity=3.0, free_length=1.0)
    store = vv.HeatStore(capacity=1.0, temperature=350.0)
    mesh = vv.BoxMesh(size=(0.1, 0.1, 0.1), counts=(1, 1, 1))
    body = vv.ThermalBody(mesh=mesh, conductivity=50.0, capacity=460.0, density=7800.0, temperature=300.0)
    heat = [
        vv.HeatExchange(a=spring, b=store, conductance=conductance),
        vv.HeatExchange(a=spring, b=body, nodes_b="x0", conductance=1e-6),
        vv.HeatFlux(body=body, faces="x1", flux=flux),
    ]
    push = vv.UserTerm(term=Leak(leak, 2), on=[ball])
    system = vv.System([ground, ball, spring, store, body, *heat, push])
    return vv.simulate(system, until=1.0, step=0.01, scheme=scheme)


@pytest.mark.parametrize(
    "scheme", [vv.BDF2(), vv.BackwardEuler(), vv.GeneralizedAlpha(), vv.Midpoint()], ids=repr
)
@pytest.mark.parametrize(("conductance", "flux"), [(5.0, 0.0), (1e-6, 1e5)])
def test_heat_hides_no_work_that_is_not_booked_on_what_is_tied_to_it(
    scheme: vv.Scheme, conductance: float, flux: float
) -> None:
    """A ball gains 5 J of a force that is not booked, beside 43 J that its spring gets, or 1000 J of a body."""
    for leak in (0.0, 4.0):
        result = tied(scheme, leak, conductance, flux)
        assert (result.ledger.greatest("imbalance") > 4.9) == (leak > 0)
        assert energy_verdict(result).startswith("WRONG") == (leak > 0)


@pytest.mark.parametrize(
    "scheme", [vv.EnergyMomentum(), vv.BDF2(), vv.BackwardEuler(), vv.Midpoint()], ids=repr
)
def test_heat_hides_no_work_that_is_not_booked_beside_it(scheme: vv.Scheme) -> None:
    """Of 5 J 1.5 were not booked, which are little beside 3e6 J of heat in a body that has nothing to do with it."""
    for share, is_wrong in ((0.0, False), (0.3, True)):
        body = vv.ThermalBody(
            mesh=vv.BoxMesh(size=(0.1, 0.1, 0.1), counts=(1, 1, 1)), conductivity=50.0, capacity=460.0,
            density=7800.0, temperature=300.0,
        )  # fmt: skip
        heat = vv.HeatFlux(body=body, faces="x1", flux=3e8)
        result = vv.simulate(vv.System([*drawn(share), body, heat]), until=1.0, step=0.01, scheme=scheme)
        assert energy_verdict(result).startswith("WRONG, as this scheme is to") == is_wrong


@pytest.mark.parametrize("scheme", [vv.BDF2(), vv.GeneralizedAlpha()], ids=repr)
def test_schemes_of_second_order_may_give_back_what_they_took(scheme: vv.Scheme) -> None:
    """A mass on a spring that hangs: gains and losses both fall with the square of the step."""
    gains = []
    for h in (0.01, 0.005):
        ground, mass = vv.Ground(), vv.PointMass(mass=1.0, position=(1.3, 0, 0))
        spring = vv.Spring(a=ground.point(), b=mass.point(), stiffness=40.0, free_length=1.0)
        system = vv.System([ground, mass, spring, vv.Gravity()])
        result = vv.simulate(system, until=2.0, step=h, scheme=scheme)
        assert energy_verdict(result).startswith("not meant to be conserved by this scheme")
        gains.append(result.ledger.greatest("imbalance"))
    assert np.log2(gains[0] / gains[1]) == pytest.approx(2.0, abs=0.1)
