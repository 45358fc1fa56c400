"""Unstable equilibria are refused, at the loads that theory tells; those who mean them say so."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp

import visviva as vv
from visviva.analysis.load_steps import Equilibrium, Unstable
from visviva.scheme.schemes import load_step
from visviva.study.run import run
from visviva.system.scaling import asymmetry
from visviva.system.stability import Stability

LENGTH, WIDTH, YOUNG = 10.0, 0.5, 1000.0
EULER = np.pi**2 * YOUNG * WIDTH**4 / 12 / (4 * LENGTH**2)


def column(factor: float, *more: Any, **options: Any) -> vv.System:
    """A square cantilever under its own axis, loaded up to so many times Euler's load; it stays straight."""
    mesh = vv.BoxMesh(size=(WIDTH, WIDTH, LENGTH), counts=(1, 1, 8), cell="hex20")
    material = options.pop("material", vv.SaintVenantKirchhoff(young=YOUNG, poisson=0.0))
    solid = vv.Solid(mesh=mesh, material=material, density=1.0, **options)
    push = vv.Traction(solid=solid, faces="z1", traction=(0, 0, -factor * EULER / WIDTH**2), times="t")
    return vv.System([solid, vv.Fixed(solid=solid, nodes="z0"), push, *more])


@pytest.mark.parametrize(
    "options", [{}, {"formulation": "mixed", "material": vv.NeoHooke(young=YOUNG, poisson=0.3)}]
)
def test_straight_columns_beyond_eulers_load(options: dict[str, Any]) -> None:
    assert "equilibria: stable" in vv.quasi_static(column(0.9, **options), until=1.0, step=0.5).audit()
    system = column(3.0, **options)
    with pytest.raises(Unstable, match=r"load parameter 0.4 is unstable: energy falls in 2 directions"):
        vv.quasi_static(system, until=1.0, step=0.2)
    assert system.time == pytest.approx(0.2)  # the last stable one stays


def pressed(formulation: Any) -> vv.System:
    """A block in a box, which cannot buckle: all its sides slide, and one of them presses it together."""
    mesh = vv.RectangleMesh(size=(1, 1), counts=(4, 4))
    rubber = vv.NeoHooke(young=1.0, poisson=0.45)
    block = vv.Solid(mesh=mesh, material=rubber, density=1.0, formulation=formulation, name="block")
    walls = [
        vv.Fixed(solid=block, nodes=side, directions=(side[0] == "x", side[0] == "y", True))
        for side in ("x0", "x1", "y0")
    ]
    return vv.System(
        [block, *walls, vv.Prescribed(solid=block, nodes="y1", motion=(None, lambda t: -t, None))]
    )


def test_elements_that_may_give_way_are_named() -> None:
    """Hourglasses of enhanced strains are no buckling, and the message does not say that they must be."""
    assert "equilibria: stable" in vv.quasi_static(pressed("displacement"), until=0.3, step=0.05).audit()
    with pytest.raises(
        Unstable, match=r"or elements do, which in Solid 'block' \(enhanced\) may give way under strong"
    ):
        vv.quasi_static(pressed("enhanced"), until=0.3, step=0.05)
    with pytest.raises(Unstable) as refused:
        vv.quasi_static(column(1.5), until=1.0, step=0.5)
    assert "elements" not in str(refused.value)


def test_those_who_mean_it() -> None:
    result = vv.quasi_static(column(1.5), until=1.0, step=0.5, scheme=vv.Static(unstable=True))
    told = "equilibria: unstable from the load parameter 1 on, in 1 load steps, with one limit point or bifurcation"
    assert told in result.audit()


def upright(load: float) -> vv.System:
    """A rigid body on a hinge, held upright by a spring across at its top: stable up to the load 50 * 2."""
    ground, arm = vv.Ground(), vv.RigidBody(mass=1.0, inertia=(1, 1, 1), position=(0, 0, 2))
    hinge = vv.Revolute(a=ground, b=arm, at=(0, 0, 0), axis=(0, 1, 0))
    hold = vv.Bushing(a=ground, b=arm, at=(0, 0, 2), stiffness=(50, 0, 0), rotational_stiffness=(0, 0, 0))
    push = vv.Force(on=arm, force=(0, 0, -load), times="t")
    return vv.System([ground, arm, hinge, hold, push])


def test_constraints_are_not_counted() -> None:
    """Multipliers bring negative eigenvalues of their own."""
    assert "equilibria: stable" in vv.quasi_static(upright(99.0), until=1.0, step=0.5).audit()
    with pytest.raises(Unstable, match="energy falls in one direction"):
        vv.quasi_static(upright(101.0), until=1.0, step=0.5)


def test_equilibrium_on_a_summit() -> None:
    """A ball on a rod straight above its hinge rests there, until somebody breathes."""

    def system() -> vv.System:
        ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(0, 0, 2))
        rod = vv.Distance(a=ground.point(), b=ball.point())
        return vv.System([ground, ball, rod, vv.Gravity(acceleration=(0, 0, -10))])

    with pytest.raises(Unstable, match=r"energy falls in 2 directions.*equilibrium\(\.\.\., unstable=True\)"):
        vv.equilibrium(system())
    assert "unstable" in vv.equilibrium(system(), unstable=True).audit()


@pytest.mark.parametrize("apart", [0.4, 1.3, 1.7, 2.3, 3.0])
@pytest.mark.parametrize("bond", ["spring", "distance", "positions"])
def test_a_free_molecule_of_two_finds_its_length(bond: str, apart: float) -> None:
    """Nothing resists its motions as a whole: what rounding and differences make of that is no instability."""
    a, b = vv.PointMass(mass=1.0), vv.PointMass(mass=1.0, position=(apart, 0.2, 0))
    bonds: dict[str, vv.Component] = {
        "spring": vv.Spring(a=a.point(), b=b.point(), stiffness=10.0, free_length=1.0),
        "distance": vv.Potential(of=[vv.SquaredDistance(a=a, b=b)], energy=lambda e: (e[0] - 1) ** 2),
        "positions": vv.Potential(
            of=[a, b],
            energy=lambda x: ((x[3] - x[0]) ** 2 + (x[4] - x[1]) ** 2 + (x[5] - x[2]) ** 2 - 1) ** 2,
        ),
    }
    system = vv.System([a, b, bonds[bond]])
    vv.equilibrium(system)
    assert np.linalg.norm(system.x[3:6] - system.x[:3]) == pytest.approx(1.0, abs=1e-12)


def test_a_molecule_of_three_in_line_is_unstable() -> None:
    """Bonds too long for what its ends are drawn to fold it, to either side."""
    balls = [vv.PointMass(mass=1.0, position=(k, 0, 0)) for k in range(3)]
    springs = [
        vv.Spring(a=balls[k].point(), b=balls[k + 1].point(), stiffness=10.0, free_length=1.1)
        for k in range(2)
    ]
    ends = vv.Spring(a=balls[0].point(), b=balls[2].point(), stiffness=10.0, free_length=1.5)
    with pytest.raises(vv.RunError, match="the equilibrium found is unstable: energy falls in 2 directions"):
        vv.equilibrium(vv.System([*balls, *springs, ends]))


def test_arcs_go_through_unstable_equilibria() -> None:
    """A shallow arch of two bars loses its stability at the limit point, and has it again below."""
    ground, tip = vv.Ground(), vv.PointMass(mass=1.0, position=(0.0, 0.0, 0.3))
    bars = [
        vv.Spring(a=ground.point((x, 0, 0)), b=tip.point(), stiffness=20.0, free_length=np.hypot(1.0, 0.3))
        for x in (-1.0, 1.0)
    ]
    slide = vv.PointOnLine(a=ground, b=tip.point(), at=(0, 0, 0.3), axis=(0, 0, 1))
    push = vv.Force(on=tip, force=(0.0, 0.0, -1.0), times="t")
    result = vv.arc_length(vv.System([ground, tip, *bars, slide, push]), step=0.02, until=0.6, steps=400)
    falling = int(np.sum(np.diff(result.times) < 0))
    assert falling > 5
    assert abs(result.system.stepper.stability.unstable - falling) <= 1
    assert "equilibria: unstable from" in result.audit()


def test_what_cannot_be_told() -> None:
    """Friction makes tangents unsymmetric: their signs tell nothing, and the audit says so."""
    brick = {"material": vv.LinearElastic(young=100.0, poisson=0.0), "density": 1.0}
    low = vv.Solid(mesh=vv.BoxMesh(size=(2, 1, 1), counts=(1, 1, 1)), **brick)
    high = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1), origin=(0.5, 0, 1)), **brick)
    contact = vv.Contact(first=high, first_faces="z0", second=low, second_faces="z1", friction=0.1)
    motion = (lambda t: 0.4 * t, lambda t: 0.0 * t, lambda t: -0.02 - 0.0 * t)
    push = vv.Prescribed(solid=high, nodes="z1", motion=motion)
    parts = [low, high, contact, push, vv.Fixed(solid=low, nodes="z0")]
    result = vv.quasi_static(vv.System(parts), until=1.0, step=0.25)
    assert "equilibria: stability not checked" in result.audit()


def test_resumed_runs_remember_what_they_found(tmp_path: Path) -> None:
    """The verdict counts the equilibria from before the run was broken off, too."""

    def study(until: float) -> vv.Study:
        return vv.Study(column(1.5), until, 0.25, vv.Static(unstable=True))

    run(study(0.75), tmp_path / "run", pictures=False)
    result = run(study(1.0), tmp_path / "run", resume=True, pictures=False)
    assert result.system.stepper.stability == Stability(
        equilibria=4, unstable=2, first=0.75, falling=2, critical=1
    )


CRITICAL = np.pi**2 * 1e6 * 0.2 * 0.1**3 / 12 / (4 * 2.0**2)


def slender() -> vv.System:
    """A cantilever under its own axis, loaded by Euler's load at t = 1."""
    mesh = vv.BoxMesh(size=(0.1, 0.2, 2.0), counts=(1, 1, 10), cell="hex20")
    solid = vv.Solid(mesh=mesh, material=vv.SaintVenantKirchhoff(young=1e6, poisson=0.0), density=1.0)
    push = vv.Traction(solid=solid, faces="z1", traction=(0, 0, -CRITICAL / 0.02), times="t")
    return vv.System([solid, vv.Fixed(solid=solid, nodes="z0"), push])


@pytest.mark.parametrize("step", [0.1, 0.01, 0.004])
def test_equilibria_next_to_a_critical_load(step: float) -> None:
    """The tangent is nearly singular there: rounding of the forces alone moves the column by more than 1e-13."""
    system = slender()
    result = vv.quasi_static(system, until=0.998, step=step)
    assert system.stepper.rejected == 0
    assert "equilibria: stable" in result.audit()
    x = system.x.reshape(-1, 3)
    assert x[:, 0].min() == pytest.approx(0.0, abs=1e-9)  # poisson=0: it shortens and stays straight
    strain = -CRITICAL / 0.02 / 1e6 * 0.998
    stretch = np.sqrt(1 + 2 * strain)  # E l (l^2 - 1) / 2 = load, to first order of strain
    assert x[:, 2].max() == pytest.approx(2 * stretch, rel=2 * strain**2)


@pytest.mark.parametrize("step", [0.2, 0.01])
def test_beyond_a_critical_load_slender_columns_are_unstable(step: float) -> None:
    system = slender()
    with pytest.raises(Unstable, match="energy falls in one direction"):
        vv.quasi_static(system, until=1.3, step=step)
    assert 0.79 < system.time < 1.0


def test_asymmetry_is_that_of_the_assembled_tangent() -> None:
    """The core's, of the tangent factored last, against the matrix itself; of a load that follows."""
    section = vv.GivenSection(stiffness=(1e3, 1e3, 1e3, 1, 1, 1))
    beam = vv.Beam(mesh=vv.LineMesh(points=[(0, 0, 0), (0, 0, 1)], count=4), section=section)
    follower = vv.FollowerForce(on=beam.frame(1.0), force=(0.3, 0, -1), times="t")
    system = vv.System([beam, vv.Clamped(solid=beam, nodes="start"), follower])
    vv.quasi_static(system, until=1.0, step=1.0)
    equations = Equilibrium(system, vv.Static())
    equations.linearise(system.time)
    exact, _ = asymmetry(system.tangent(load_step(system.time, 0.0))[1])
    assert exact > 1e-5
    assert system.core.asymmetry() == pytest.approx(exact, rel=1e-12)


def test_asymmetry_leaves_the_matrix_as_it_is() -> None:
    K = sp.csr_array((np.array([1.0, 2.0, 3.0]), np.array([1, 0, 1]), np.array([0, 2, 3])), shape=(2, 2))
    assert asymmetry(K)[0] > 0
    assert K.indices.tolist() == [1, 0, 1]


def test_a_heavy_weight_hides_no_fall_beside_it() -> None:
    """What its spring leaves out of balance is more than the weight of the pendulum that stands on its head."""
    ground = vv.Ground()
    heavy = vv.PointMass(mass=1e8, position=(20, 0, 0))
    spring = vv.Spring(a=ground.point((20, 0, 3)), b=heavy.point(), stiffness=1e9, free_length=3.0)
    light = vv.RigidBody(mass=1e-6, inertia=(1e-6, 1e-6, 1e-6), position=(0, 0, 1))
    hinge = vv.Revolute(a=ground, b=light, at=(0, 0, 0), axis=(0, 1, 0))
    with pytest.raises(Unstable, match="falls in one direction"):
        vv.equilibrium(vv.System([ground, heavy, spring, light, hinge, vv.Gravity()]))
