"""The audit's verdicts: conserved, dissipated by the scheme, not meant to be conserved, wrong."""

from __future__ import annotations

from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import visviva as vv
from visviva.component.momentum import NOWHERE
from visviva.model.term import Stencils, Term
from visviva.results.audit import energy_verdict, judgements
from visviva.results.outside import outside
from visviva.study.run import run

STEEL = vv.LinearElastic(young=100.0, poisson=0.0)


def swing(scheme: vv.Scheme | None = None, *more: Any, step: float = 0.02) -> vv.Result:
    """A ball on a stretched spring that whirls about the origin."""
    ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(1, 0, 0), velocity=(0, 3, 0))
    spring = vv.Spring(a=ground.point(), b=ball.point(), stiffness=40.0, free_length=0.8)
    return vv.simulate(vv.System([ground, ball, spring, *more]), until=2.0, step=step, scheme=scheme)


class Leak(Term):
    """A pull on a ball that the ledger is told nothing of."""

    def residual(self, s: Stencils) -> Any:
        return np.full_like(s.x1, -0.5)

    def work(self, s: Stencils) -> Any:
        return np.zeros(len(s.x1))


def leaking() -> vv.Result:
    ball = vv.PointMass(mass=1.0, position=(1, 0, 0))
    return vv.simulate(vv.System([ball, vv.UserTerm(term=Leak(), on=[ball])]), until=1.0, step=0.1)


def test_energy_verdicts() -> None:
    assert energy_verdict(swing()) == "conserved"
    assert energy_verdict(swing(vv.BackwardEuler())) == "dissipated by the scheme"
    assert energy_verdict(swing(vv.BDF2())) == "dissipated by the scheme"
    assert energy_verdict(swing(vv.GeneralizedAlpha(0.5))) == "dissipated by the scheme"
    assert energy_verdict(swing(vv.Midpoint())).startswith("not meant to be conserved")
    assert energy_verdict(leaking()).startswith("WRONG")


def test_what_a_mixture_loses_beyond_its_sums_is_the_schemes() -> None:
    """Before a wall wets, rates are the largest there are: what they dissipate by a step's end is less than is lost."""
    for scheme in (vv.BDF2(), vv.GeneralizedAlpha()):
        left = []
        for step in (0.005, 0.00125):
            mixture = vv.CahnHilliard(
                mesh=vv.RectangleMesh(size=(1, 1), counts=(8, 8)),
                free_energy=vv.DoubleWell(barrier=1.0),
                mobility=1.0,
                gradient_energy=0.05,
                concentration=0.5,
            )
            wall = vv.Wetting(body=mixture, faces="x0", angle=60.0)
            result = vv.simulate(vv.System([mixture, wall]), until=0.02, step=step, scheme=scheme)
            assert energy_verdict(result) == "dissipated by the scheme"
            left.append(result.ledger.imbalance())
        assert 0.1 < left[1] < left[0]


def test_a_mixture_excuses_no_gain_of_others() -> None:
    """Beside one that hardly changes, a ball that gains energy under a scheme that is to dissipate is wrong."""
    mixture = vv.CahnHilliard(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(2, 2)),
        free_energy=vv.DoubleWell(barrier=1e-3),
        gradient_energy=1e-3,
        concentration=lambda X: 0.5 + 0.01 * X[:, 0],
    )
    ball = vv.PointMass(mass=1.0, position=(1, 0, 0))
    system = vv.System([ball, vv.UserTerm(term=Leak(), on=[ball]), mixture])
    verdict = energy_verdict(vv.simulate(system, until=1.0, step=0.1, scheme=vv.BDF2()))
    assert verdict.startswith("WRONG, as this scheme is to dissipate energy")


@pytest.mark.parametrize("beside", ["mixture", "heat"])
def test_a_solid_that_cracks_excuses_no_gain_of_others(beside: str) -> None:
    """What it stores has the name of what a mixture stores, and is larger than what the ball gains."""
    if beside == "heat":
        spreading: Any = vv.HeatStore(capacity=1e-3, temperature=300.0)
    else:
        spreading = vv.CahnHilliard(
            mesh=vv.RectangleMesh(size=(1, 1), counts=(2, 2)),
            free_energy=vv.DoubleWell(barrier=1e-3),
            gradient_energy=1e-3,
            concentration=lambda X: 0.5 + 0.01 * X[:, 0],
        )
    cracks = vv.FracturingSolid(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(2, 2)),
        material=vv.SaintVenantKirchhoff(young=1000.0, poisson=0.0),
        density=100.0,
        toughness=40.0,
        length=1.0,
        velocity=lambda X: 0.5 * X * [1.0, 0.0, 0.0],
    )
    ball = vv.PointMass(mass=1.0, position=(1, 0, 0))
    leaks = vv.UserTerm(term=Leak(), on=[ball])
    verdicts, parts = [], [cracks, ball, spreading]
    for system in (vv.System(deepcopy(parts)), vv.System([*parts, leaks])):
        result = vv.simulate(system, until=1.0, step=0.01, scheme=vv.BDF2())
        verdicts.append(energy_verdict(result))
    gained, stored = result.ledger.greatest("imbalance"), result.ledger.swing("potential_stored")
    assert 0.1 < gained < 0.9 * stored
    assert not verdicts[0].startswith("WRONG")
    assert verdicts[1].startswith("WRONG, as this scheme is to dissipate energy")


def lines(result: vv.Result) -> dict[str, str]:
    """Verdicts of the audit by what they are about."""
    return {judged.what: judged.verdict for judged in judgements(result)}


def test_momentum_verdicts(capsys: pytest.CaptureFixture[str]) -> None:
    """The spring on the ground turns the momentum of the ball but not its moment about the origin."""
    said = lines(swing())
    assert said["linear momentum"].startswith(
        "conserved along z; not meant to be along x, y: from outside acts Spring"
    )
    assert said["angular momentum"] == "conserved"


class Pull(Term):
    """A pull on the first of two balls that the second is told nothing of, and that does what its ledger says."""

    def residual(self, s: Stencils) -> Any:
        found = np.zeros_like(s.x1)
        found[:, 0] = -0.5
        return found

    def energy(self, s: Stencils) -> Any:
        return -0.5 * s.x1[:, 0]


def test_momentum_that_is_lost_is_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    """If nothing acts from outside; an own term may do so, and is named."""
    a, b = vv.PointMass(mass=1.0, position=(1, 0, 0)), vv.PointMass(mass=1.0, position=(0, 1, 0))
    pull = vv.UserTerm(term=Pull(), on=[a, b], name="pull")
    result = vv.simulate(vv.System([a, b, pull]), until=1.0, step=0.1)
    assert "from outside acts UserTerm 'pull'" in lines(result)["linear momentum"]
    monkeypatch.setattr(vv.UserTerm, "outside_axes", NOWHERE)
    assert lines(result)["linear momentum"].startswith("WRONG along x, as nothing acts from outside")


def shown(result: vv.Result) -> dict[str, str]:
    """Figures of the audit by what they are about."""
    return {judged.what: judged.figures for judged in judgements(result)}


def test_weight_excuses_its_own_axis_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """A pull along x that has no reaction is wrong under a weight along z; the figures of the fall are shown."""
    monkeypatch.setattr(vv.UserTerm, "outside_axes", NOWHERE)
    a, b = vv.PointMass(mass=1.0, position=(1, 0, 0)), vv.PointMass(mass=1.0, position=(0, 1, 0))
    pull = vv.UserTerm(term=Pull(), on=[a, b])
    result = vv.simulate(vv.System([a, b, pull, vv.Gravity()]), until=1.0, step=0.1)
    said = lines(result)["linear momentum"]
    assert said.startswith("WRONG along x, as nothing acts from outside")
    assert "conserved along y; not meant to be along z: from outside acts Gravity" in said
    falls = result.ledger.drift("momentum_z")
    assert falls > 0.5
    assert f"z {falls:.1e}" in shown(result)["linear momentum"]


@pytest.mark.parametrize(
    ("load", "linear", "angular"),
    [
        (lambda c: vv.Force(on=c.point_at((1, 0, 0)), force=(0, 3, 0)), "y", "xz"),
        (lambda c: vv.Force(on=c, force=lambda t, x, v: np.array([1.0, 2, 3])), "xyz", "xyz"),
        (lambda c: vv.Torque(on=vv.DistributedCoupling(solid=c, faces="x1"), torque=(0, 0, 2)), "", "z"),
        (lambda c: vv.BodyForce(solid=c, force=(1, 0, 1)), "xz", "xyz"),
        (lambda c: vv.Traction(solid=c, faces="x1", traction=(1, 0, 0)), "x", "yz"),
        (lambda c: vv.SymmetryPlane(solid=c, nodes="z0", normal=(0, 0, 2)), "z", "xy"),
        (lambda c: vv.Fixed(solid=c, nodes="z0", directions=(True, False, True)), "xz", "xyz"),
        (lambda c: vv.Prescribed(solid=c, nodes="z0", motion=(None, "t", None)), "y", "xz"),
        (lambda c: vv.PeriodicFaces(solid=c, pairs=[("x0", "x1")]), "", "yz"),
        (lambda c: vv.RotatingFrame(angular_velocity=(0, 0, 2)), "xy", "xyz"),
        (lambda c: vv.Gravity(acceleration=(0, -9.81, 6e-16)), "y", "xz"),
    ],
)
def test_loads_say_along_which_axes_they_act(load: Any, linear: str, angular: str) -> None:
    """Momentum changes along these, and these alone: the ledger of a run of a block that starts bent agrees."""
    start = {"velocity": lambda X: (X[:, 1:2] + 0.5 * X[:, 2:3]) * [1.0, 0, 0], "density": 2.0}
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2))
    block = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1e3, poisson=0.3), **start)
    acting = load(block)
    assert acting.outside_axes == (linear, angular)
    parts = [block, acting, *([acting.on] if isinstance(acting, vv.Torque) else [])]
    result = vv.simulate(vv.System(parts), until=0.1, step=0.02, project=True)
    for kind, axes in (("momentum", linear), ("angular", angular)):
        changes = {c: result.ledger.drift(f"{kind}_{c}") for c in "xyz"}
        assert all(changes[c] > 1e-4 if c in axes else changes[c] < 1e-9 for c in "xyz"), changes


def test_damping_of_masses_acts_from_outside() -> None:
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2))
    material = vv.NeoHooke(young=1e3, poisson=0.3)
    block = vv.Solid(mesh=mesh, material=material, density=1.0, mass_damping=0.5, velocity=(1, 0, 0))
    result = vv.simulate(vv.System([block]), until=0.2, step=0.02)
    assert lines(result)["linear momentum"].endswith(
        "not meant to be along x: from outside acts Solid 'solid-1'"
    )
    left = result.ledger["momentum_x"][-1] / result.ledger["momentum_x"][0]
    assert left == pytest.approx(np.exp(-0.5 * 0.2), rel=1e-4)


def test_periodic_fluids() -> None:
    """Forces act along their axes, what leaves and comes in again turns about no point, convection is not exact."""
    around = {"periodic": (("x0", "x1"), ("y0", "y1")), "density": 1.0, "viscosity": 0.01, "elements": "Q2Q1"}

    def wave(X: Any) -> Any:
        return np.column_stack(
            [1 + np.sin(2 * np.pi * X[:, 1]), np.sin(2 * np.pi * X[:, 0]), np.zeros(len(X))]
        )

    def said(**more: Any) -> dict[str, str]:
        mesh = vv.RectangleMesh(size=(1, 1), counts=(4, 4))
        fluid = vv.Fluid(mesh=mesh, velocity=wave, **around, **more)
        return lines(vv.simulate(vv.System([fluid]), until=0.2, step=0.02))

    pushed = said(body_force=(1, 0, 0))
    assert "not meant to be along x: from outside acts Fluid" in pushed["linear momentum"]
    assert "not meant to be along z: from outside acts Fluid" in pushed["angular momentum"]
    assert "not meant to be exact along x: convection" in said()["linear momentum"]
    assert said(convection=False)["linear momentum"] == "conserved"


def test_heat_excuses_no_momentum() -> None:
    """Heat that comes from outside brings no momentum."""
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1))
    wall = vv.ThermalBody(mesh=mesh, conductivity=1.0, temperature=300.0)
    other = vv.ThermalBody(mesh=mesh, conductivity=1.0, temperature=300.0)
    heat = [
        vv.HeatFlux(body=wall, faces="x0", flux=5.0),
        vv.Convection(body=wall, faces="x1", coefficient=1.0, ambient=250.0),
        vv.PrescribedTemperature(body=other, nodes="x1", value=300.0),
        vv.HeatExchange(a=wall, faces_a="y0", b=other, faces_b="y1", conductance=1.0),
    ]
    assert outside(vv.System([wall, other, *heat])) == []


@pytest.mark.parametrize("scheme", [vv.GeneralizedAlpha(), vv.BDF2()])
def test_heat_is_not_called_damped_motion(scheme: vv.Scheme) -> None:
    """What schemes that dissipate miss of exchanged heat falls with the step, with either sign."""
    warm, cold = vv.HeatStore(capacity=1.0, temperature=300.0), vv.HeatStore(capacity=2.0, temperature=350.0)
    system = vv.System([warm, cold, vv.HeatExchange(a=warm, b=cold, conductance=5.0)])
    assert energy_verdict(vv.simulate(system, until=0.2, step=0.02, scheme=scheme)).startswith(
        "not meant to be"
    )


@pytest.mark.parametrize(
    ("scheme", "step", "rings"),
    [
        (vv.EnergyMomentum(), 0.02, True),
        (vv.BackwardEuler(), 0.02, False),
        (vv.EnergyMomentum(), 2e-4, False),
    ],
)
def test_heat_that_rings_is_wrong(scheme: vv.Scheme, step: float, rings: bool) -> None:
    """A slab cooled at once: below its surface -0.57 and 0.64 where the series has 0.1 and 0.07."""
    bar = vv.RectangleMesh(size=(1, 0.1), counts=(40, 1))
    slab = vv.ThermalBody(mesh=bar, conductivity=1.0, capacity=1.0, density=1.0, temperature=1.0)
    cold = [vv.PrescribedTemperature(body=slab, nodes=end, value=0.0) for end in ("x0", "x1")]
    result = vv.simulate(vv.System([slab, *cold]), until=10 * step, step=step, scheme=scheme)
    below = result.history(vv.TemperatureAt(body=slab, at=(0.025, 0, 0)))
    assert bool(min(below) < -0.1) is rings
    assert lines(result).get("changes", "").startswith("WRONG") is rings


def air(wall: Any, steps: int, scheme: vv.Scheme) -> tuple[vv.Result, Any]:
    """Air of 300 K between walls 1 apart, one of which is warmed, and its temperatures beside that wall."""
    body = vv.ThermalBody(
        mesh=vv.RectangleMesh(size=(1, 0.1), counts=(40, 1)), conductivity=1.0, temperature=300.0
    )
    walls = [vv.PrescribedTemperature(body=body, nodes=x, value=T) for x, T in (("x0", wall), ("x1", 300.0))]
    result = vv.simulate(vv.System([body, *walls]), until=0.02 * steps, step=0.02, scheme=scheme)
    return result, np.array(result.history(vv.TemperatureAt(body=body, at=(0.025, 0, 0))))


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.Midpoint()], ids=repr)
@pytest.mark.parametrize("steps", [3, 4, 5])
def test_heat_that_rings_in_a_few_steps_is_wrong(steps: int, scheme: vv.Scheme) -> None:
    """Nothing gets warmer than a wall of 400 K, and what lies beside it does not cool."""
    result, beside = air(400.0, steps, scheme)
    assert beside.max() > 450
    assert np.diff(beside).min() < -90
    assert lines(result)["changes"].startswith("WRONG")


@pytest.mark.parametrize("steps", [6, 12])
@pytest.mark.parametrize(("step", "rings"), [(0.5, True), (0.05, False)])
def test_quenches_that_ring_are_wrong(step: float, rings: bool, steps: int) -> None:
    """Steel of 850 C in water: steps take back less than half of the one before, and are off by a tenth of the drop."""

    def surface(step: float, steps: int, scheme: vv.Scheme) -> Any:
        plate = vv.ThermalBody(
            mesh=vv.RectangleMesh(size=(0.02, 0.002), counts=(20, 1)),
            conductivity=45.0,
            capacity=480.0,
            density=7800.0,
            temperature=850.0,
        )
        water = vv.Convection(body=plate, faces="x0", coefficient=5000.0, ambient=20.0)
        result = vv.simulate(vv.System([plate, water]), until=steps * step, step=step, scheme=scheme)
        return result, np.array(result.history(vv.TemperatureAt(body=plate, at=(0, 0, 0))))

    result, found = surface(step, steps, vv.EnergyMomentum())
    fine = surface(step / 20, 20 * steps, vv.BDF2())[1][::20]
    assert bool(np.abs(found - fine).max() > 0.1 * (850 - fine.min())) is rings
    assert lines(result).get("changes", "").startswith("WRONG") is rings


@pytest.mark.parametrize("wall", ["300 + 100*min(t/0.2, 1)", "300 + 50*sin(10*t)"])
def test_walls_that_warm_over_some_steps_do_not_ring(wall: str) -> None:
    """Where they hold after that, what lies beside them wavers by a thousandth of what they warmed by."""
    result, beside = air(wall, 40, vv.EnergyMomentum())
    assert beside == pytest.approx(air(wall, 40, vv.BackwardEuler())[1], abs=1.0)
    assert "changes" not in lines(result)


@pytest.mark.parametrize("scheme", [vv.BackwardEuler(), vv.BDF2()], ids=repr)
def test_what_follows_a_wall_that_changes_with_each_step_does_not_ring(scheme: vv.Scheme) -> None:
    """Beside a wall whose temperature is measured once in a step: these rules bring in no swings of their own."""
    result, beside = air("300 + 50*sin(3.14159265*t/0.02 + 1.57079633)", 9, scheme)
    assert np.all(beside[1:] * np.array([-1.0, 1.0] * 4 + [-1.0]) > 300 * np.array([-1.0, 1.0] * 4 + [-1.0]))
    assert "changes" not in lines(result)


def test_ringing_is_found_over_resumes(tmp_path: Path) -> None:
    """What rings little beside the first change, which was before, does not; what rings, does after as well."""
    for wall, is_wrong in (("300 + 100*min(t/0.2, 1)", False), ("300 + 100*step(t - 0.29)", True)):
        for until in (0.28, 0.8):
            body = vv.ThermalBody(
                mesh=vv.RectangleMesh(size=(1, 0.1), counts=(40, 1)), conductivity=1.0, temperature=300.0
            )
            held = vv.PrescribedTemperature(body=body, nodes="x0", value=wall)
            study = vv.Study(vv.System([body, held]), until=until, step=0.02)
            result = run(study, tmp_path / str(is_wrong), resume=until > 0.5, pictures=False)
        assert bool(result.statistics.swings) == is_wrong


def test_rounding_of_heat_does_not_ring() -> None:
    bar = vv.RectangleMesh(size=(1, 0.1), counts=(40, 1))
    slab = vv.ThermalBody(
        mesh=bar, conductivity=1.0, capacity=1.0, density=1.0, temperature=lambda X: 300 + 7 * X[:, 0]
    )
    ends = [vv.PrescribedTemperature(body=slab, nodes=f"x{k}", value=300.0 + 7 * k) for k in (0, 1)]
    assert "changes" not in lines(vv.simulate(vv.System([slab, *ends]), until=0.4, step=0.02))


def test_rounding_at_rest_is_not_called_wrong() -> None:
    """Of a shell that hangs on nothing: energies of rounding alone."""
    mesh = vv.RectangleMesh(size=(1, 1), counts=(2, 2))
    section = vv.SolidSection(material=vv.NeoHooke(young=1e4, poisson=0.3), thickness=0.05, density=10.0)
    heat = vv.Heat(conductivity=1.0, capacity=10.0, expansion=1e-3, reference=300.0)
    shell = vv.ThermalShell(mesh=mesh, section=section, heat=heat, temperature=300.0)
    result = vv.simulate(vv.System([shell]), until=0.03, step=0.01)
    assert not any(judged.is_wrong for judged in judgements(result))


@pytest.mark.parametrize(
    ("scheme", "verdict"), [(vv.BDF2(), "not meant"), (vv.GeneralizedAlpha(), "fulfilled")], ids=str
)
def test_rates_of_servos_are_as_exact_as_the_scheme(scheme: vv.Scheme, verdict: str) -> None:
    ground, arm = vv.Ground(), vv.RigidBody(mass=1.0, inertia=(1, 1, 1), position=(1, 0, 0))
    axle = vv.Revolute(a=ground, b=arm, at=(0, 0, 0), axis=(0, 0, 1))
    servo = vv.Servo(output=[axle], follows=["t**3"], actuators=[axle])
    system = vv.System([ground, arm, axle, servo])
    said = lines(vv.simulate(system, until=0.2, step=0.02, scheme=scheme))["their rates"]
    assert said.startswith(verdict)


def test_angular_momentum_of_schemes_that_lose_it() -> None:
    a, b = (vv.PointMass(mass=1.0, position=(x, 0, 0), velocity=(0, x, 0)) for x in (1.0, -1.0))
    free = [a, b, vv.Spring(a=a, b=b, stiffness=30.0, free_length=1.5)]
    result = vv.simulate(vv.System(free), until=1.0, step=0.01, scheme=vv.BackwardEuler())
    assert lines(result)["linear momentum"] == "conserved"
    assert lines(result)["angular momentum"].endswith(
        "this scheme does not conserve it, see how it falls with the step"
    )


def test_no_line_reads_like_a_failure(capsys: pytest.CaptureFixture[str]) -> None:
    """What is not meant to be conserved says why; every line has a verdict; units are said."""
    ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(1, 0, 0))
    rod = vv.Spherical(
        a=ground, b=vv.RigidBody(mass=1.0, inertia=(1, 1, 1), position=(1, 0, 0)), at=(0, 0, 0)
    )
    system = vv.System([ground, ball, rod.b, rod, vv.Gravity()], units="SI")
    result = vv.simulate(system, until=1.0, step=0.01)
    assert result.conservation()["constraint rates"] > 1e-6
    text = result.audit()
    assert "WRONG" not in text
    for line in text.splitlines():
        if "not meant to be" in line and "momentum" in line:
            assert "from outside act" in line
    assert "their rates: not meant to be exact" in text
    assert "to t = 1 s with" in text
    assert str(judgements(result)[0]).endswith(" J: conserved")
    assert "total energy 0 J -> 0 J" in text
    verdicts = ("conserved", "fulfilled", "not meant to be", "dissipated")
    assert all(judged.verdict.startswith(verdicts) for judged in judgements(result))


def test_constraints_that_do_not_hold_are_wrong() -> None:
    result = swing()
    assert "constraints" not in lines(result)
    ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(1, 0, 0))
    rod = vv.Distance(a=ground.point(), b=ball.point())
    held = vv.simulate(vv.System([ground, ball, rod, vv.Gravity()]), until=0.1, step=0.01)
    assert lines(held)["constraints"] == "fulfilled"
    held.ledger.span[3, held.ledger.column("defect_position")] = 1e-3
    assert lines(held)["constraints"].startswith("WRONG")


def squeezed(plane: str) -> vv.System:
    mesh = vv.RectangleMesh(size=(1, 2), counts=(2, 2), origin=(1, 0))
    solid = vv.Solid(mesh=mesh, material=STEEL, density=1.0, plane=plane, velocity=(1.0, 0.5, 0.0))
    return vv.System([solid])


def test_only_momenta_that_there_are() -> None:
    """What moves away from an axis all around has no momentum; a plane body turns about one axis alone."""
    ring = vv.simulate(squeezed("axisymmetric"), until=0.1, step=0.01)
    found = [line for line in ring.audit().splitlines() if "momentum" in line]
    assert len(found) == 1
    assert " y " in found[0]
    assert " x " not in found[0]
    assert np.abs(ring.ledger["momentum_x"]).max() == 0
    assert ring.ledger["momentum_y"][0] == pytest.approx(0.5 * np.pi * (2**2 - 1) * 2)
    plate = vv.simulate(squeezed("strain"), until=0.1, step=0.01)
    found = [line for line in plate.audit().splitlines() if "momentum" in line]
    assert len(found) == 2
    assert " z " not in found[0]
    assert " x " not in found[1]


def test_heat_in_a_revolution_takes_no_axes_from_what_moves() -> None:
    mesh = vv.RectangleMesh(size=(1, 1), counts=(1, 1))
    heated = vv.ThermalBody(mesh=mesh, conductivity=1.0, capacity=1.0, axisymmetric=True)
    ball = vv.PointMass(mass=1.0, velocity=(1, 0, 0))
    result = vv.simulate(vv.System([heated, ball]), until=0.1, step=0.01)
    found = [line for line in result.audit().splitlines() if "momentum" in line]
    assert len(found) == 2
    assert all(axis in line for line in found for axis in "xyz")


@pytest.mark.parametrize("run", [vv.quasi_static, vv.equilibrium])
def test_statics_has_no_kinetic_energy(run: Any) -> None:
    """Prescribed nodes move with the load parameter, and bodies may have velocities from elsewhere."""
    mesh = vv.BoxMesh(size=(2, 1, 1), counts=(2, 1, 1))
    solid = vv.Solid(mesh=mesh, material=STEEL, density=7.0, velocity=(1, 0, 0))
    held = vv.Fixed(solid=solid, nodes="x0")
    pull = vv.Prescribed(solid=solid, nodes="x1", motion=("0.1*t", "0*t", "0*t"))
    options = {"steps": 2} if run is vv.equilibrium else {"step": 0.5}
    result = run(vv.System([solid, held, pull]), until=1.0, **options)
    assert np.abs(result.ledger["kinetic"]).max() == 0
    if run is vv.quasi_static:
        assert result.ledger["potential_strain"][-1] == pytest.approx(0.5 * 100 * 0.05**2 * 2)
        assert result.ledger.imbalance() < 1e-12
        assert "momentum" not in result.audit()
        assert energy_verdict(result) == "conserved"


class Damper(Term):
    """A spring and a damper to the origin in one term: what it stores, and what it loses."""

    c, k = 2.0, 30.0

    def residual(self, s: Stencils) -> Any:
        return self.k * s.x + self.c * s.rate

    def energy(self, s: Stencils) -> Any:
        return 0.5 * self.k * (s.x1**2).sum(axis=1)

    def work(self, s: Stencils) -> Any:
        return -self.c * np.einsum("ij,ij->i", s.rate, s.x1 - s.x0)


def test_terms_book_both_energy_and_work() -> None:
    ball = vv.PointMass(mass=1.0, position=(1, 0, 0))
    result = vv.simulate(vv.System([ball, vv.UserTerm(term=Damper(), on=[ball])]), until=1.0, step=0.01)
    assert result.ledger["work_user"][-1] < -5
    assert result.ledger["total"][-1] == pytest.approx(15 + result.ledger["work_user"][-1])
    assert result.ledger.imbalance() < 1e-12


def test_work_of_prescribed_motion_is_a_sum_over_steps() -> None:
    """A clamp that is swung to and fro feeds the body: what schemes miss of that work is no energy from nowhere."""
    mesh = vv.RectangleMesh(size=(1, 0.2), counts=(4, 1))
    solid = vv.Solid(mesh=mesh, material=STEEL, density=1.0)
    shake = vv.Prescribed(solid=solid, nodes="x0", motion=(None, "0.2*sin(9*t)", None))
    held = vv.Fixed(solid=solid, nodes="x0", directions=(True, False, False))
    idle = vv.Force(on=vv.PointMass(mass=1.0, position=(3, 0, 0)), force=(0, 0, 0), times="t")
    parts = [solid, shake, held, idle, idle.on]
    result = vv.simulate(vv.System(parts), until=1.0, step=0.02, scheme=vv.BDF2())
    assert result.ledger.greatest("imbalance") > 0
    assert result.ledger.works == ["force", "prescribed motion"]
    assert ": work of prescribed motion is a sum over steps" in energy_verdict(result)


def test_fluids_that_rest_conserve() -> None:
    """Water in a closed box under gravity: what it gains by rounding is nothing beside what its weight could do."""
    water = vv.Fluid(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(4, 4), cell="quad9"), density=1000.0, viscosity=1e-3
    )
    weight = vv.Gravity(acceleration=(0, -9.81, 0))
    system = vv.System([water, vv.NoSlip(fluid=water, faces="all"), weight])
    result = vv.simulate(system, until=0.5, step=0.05)
    assert energy_verdict(result).startswith("conserved")


def test_fluids_in_small_units() -> None:
    """In micrometres speeds are large: a flow from rest is the same if it is said what is large."""

    def end(length: float, **given: Any) -> Any:
        mesh = vv.RectangleMesh(size=(2 * length, length), counts=(4, 3), cell="quad9")
        water = vv.Fluid(mesh=mesh, density=1 / length**3, viscosity=0.1 / length, **given)
        inlet = vv.VelocityBoundary(fluid=water, faces="x0", velocity=(f"{length}*t", 0, 0))
        walls = [vv.FreeSlip(fluid=water, faces=side) for side in ("y0", "y1")]
        system = vv.System([water, inlet, *walls, vv.Outlet(fluid=water, faces="x1")])
        result = vv.simulate(system, until=0.4, step=0.1)
        return water.velocities(system.x, system.v) / length, result.statistics.rejected

    with pytest.raises(vv.InputError, match="speed = -1 is not positive"):
        end(1.0, speed=-1.0)
    (large, _), (small, rejected) = end(1.0), end(1e6, speed=1e6)
    assert rejected == 0
    assert abs(large - small).max() < 1e-10


def test_snaps_in_statics_are_called_so() -> None:
    """A shallow arch of two bars has no equilibrium beside its limit point: load steps fail there or jump past it."""
    found = []
    for step in (0.03, 0.05, 0.06, 0.1, 0.3, 0.5, 1.0, 2.0):
        ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(0, 0, 0.2))
        bars = [vv.Spring(a=ground.point((x, 0, 0)), b=ball.point(), stiffness=100.0) for x in (-1, 1)]
        guide = vv.PointOnLine(a=ground.frame(axes=((1, 0, 0), (0, 1, 0), (0, 0, 1))), b=ball.point())
        push = vv.Force(on=ball.point(), force=(0, 0, -1), times="t")
        system = vv.System([ground, ball, *bars, guide, push])
        try:
            result = vv.quasi_static(system, until=2.0, step=step)
        except vv.NoEquilibrium:
            continue
        assert system.x[2] < -0.1
        found.append("snapped" in energy_verdict(result))
    assert found
    assert all(found)


def test_fluids_without_periods_are_judged() -> None:
    water = vv.Fluid(mesh=vv.RectangleMesh(size=(2, 1), counts=(4, 2)), density=1.0, viscosity=0.1)
    inflow = vv.VelocityBoundary(fluid=water, faces="x0", velocity=("t", 0, 0))
    system = vv.System(
        [
            water,
            inflow,
            *(vv.NoSlip(fluid=water, faces=f) for f in ("y0", "y1")),
            vv.Outlet(fluid=water, faces="x1"),
        ]
    )
    assert "linear momentum" in vv.simulate(system, until=0.2, step=0.1).audit()


@pytest.mark.parametrize("power", [1e3, 1e7])
def test_what_rings_is_found_beside_what_grows_smoothly(power: float) -> None:
    """A rod whose end is heated at once, beside a body that is heated by much more, up to 1e6 K a step."""
    rod, block = (
        vv.ThermalBody(
            mesh=vv.BoxMesh(size=size, counts=counts, origin=at), conductivity=1.0, temperature=300.0
        )
        for size, counts, at in (((1, 0.2, 0.2), (20, 1, 1), (0, 0, 0)), ((1, 1, 1), (4, 4, 4), (3, 0, 0)))
    )
    system = vv.System(
        [
            rod,
            block,
            vv.PrescribedTemperature(body=rod, nodes="x0", value=400.0),
            vv.HeatSource(body=block, power=power),
        ]
    )
    assert vv.simulate(system, until=1.0, step=0.1).statistics.swings > 6


@pytest.mark.parametrize("heating", [10, 1000])
def test_a_flow_that_rings_is_found_beside_heat(heating: float) -> None:
    """A lid set off at once: steps 2 of the 0.01 that the finest cell takes; the wall's heat changes no velocity."""
    water = vv.Fluid(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(6, 6)), density=1.0, viscosity=0.1, elements="Q1Q1"
    )
    lid = vv.VelocityBoundary(fluid=water, faces="y1", velocity=(1.0, 0, 0))
    walls = [vv.NoSlip(fluid=water, faces=side) for side in ("x0", "x1", "y0")]
    heat = vv.FluidHeat(fluid=water, conductivity=1.0, capacity=1.0)
    wall = vv.PrescribedTemperature(body=heat, nodes="x0", value=f"{heating}*t")
    result = vv.simulate(
        vv.System([water, lid, *walls, heat, wall]), until=40.0, step=2.0, scheme=vv.Midpoint()
    )
    assert lines(result)["changes"].startswith("WRONG")


def test_rounding_of_water_at_rest_does_not_ring() -> None:
    """Its weight is balanced by pressure, up to rounding."""
    water = vv.Fluid(mesh=vv.RectangleMesh(size=(1, 1), counts=(6, 6)), density=1000.0, viscosity=1.0)
    walls = [vv.NoSlip(fluid=water, faces=side) for side in ("x0", "x1", "y0", "y1")]
    system = vv.System([water, *walls, vv.Gravity(acceleration=(0, -9.81, 0))])
    result = vv.simulate(system, until=300.0, step=10.0, scheme=vv.Midpoint())
    assert abs(water.velocities(system.x, system.v)).max() < 1e-11
    assert "changes" not in lines(result)


def test_rounding_of_strong_forces_is_no_momentum() -> None:
    """A block at rest in SI that is cooled: stresses of 1e8 Pa over seconds, of which rounding leaves 1e-14 N s."""
    block = vv.ThermoelasticSolid(
        mesh=vv.BoxMesh(size=(0.01, 0.01, 0.01), counts=(4, 1, 1)),
        material=vv.NeoHooke(young=3e9, poisson=0.35),
        density=1180.0,
        heat=vv.Heat(conductivity=0.2, capacity=1.8e6, expansion=7e-5, reference=300.0),
    )
    bath = vv.Convection(body=block, faces="x0", coefficient=1000.0, ambient=77.0)
    result = vv.simulate(vv.System([block, bath]), until=2.0, step=1.0)
    kept = [j for j in judgements(result) if "momentum" in j.what]
    assert [j.verdict for j in kept] == ["conserved"] * 2


def test_rounding_of_energies_that_hardly_change_is_no_gain() -> None:
    """Of a strip of two phases: energies of 0.004 change by 1e-20, the balance by rounding, by 8e-18."""
    strip = vv.MixtureSolid(
        mesh=vv.RectangleMesh(size=(20, 1), counts=(40, 12), cell="quad9"),
        material=vv.SaintVenantKirchhoff(young=1.0, poisson=0.0),
        free_energy=vv.DoubleWell(barrier=1e-3),
        gradient_energy=1.8e-4,
        mobility=1e-12,
        concentration=lambda X: 0.5 + 0.5 * np.tanh((X[:, 1] - 0.5) / 0.15),
        eigenstrain=1e-4,
    )
    p = strip.grid.points
    middle, below = (int(np.argmin(np.linalg.norm(p[:, :2] - [10, y], axis=1))) for y in (0.5, 0.0))
    held = [
        vv.Fixed(solid=strip, nodes=[middle]),
        vv.Prescribed(solid=strip, nodes=[below], motion=(0, None, None)),
    ]
    result = vv.simulate(vv.System([strip, *held]), until=1e-3, step=5e-4, scheme=vv.BackwardEuler())
    assert 0 < result.ledger.size("imbalance") < 1e-14 * result.ledger.size("total")
    assert energy_verdict(result) == "conserved"
