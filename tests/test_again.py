"""Systems run again: reset to the beginning, and copies, go the same way to the last bit."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np
import pytest
from catalogue import CATALOGUE
from catalogue.entry import Entry

import visviva as vv
from visviva.component.component import Composed
from visviva.system.steps import accept, solved


def states(system: vv.System, until: float, step: float) -> np.ndarray:
    return np.array(vv.simulate(system, until=until, step=step, project=True).states)


WITHOUT_MATERIAL = [entry for entry in CATALOGUE if entry.name == "thermoelastic brick, user's"]


@pytest.mark.parametrize("entry", [*CATALOGUE[::6], *WITHOUT_MATERIAL], ids=lambda e: e.name)
def test_reset_and_copies(entry: Entry) -> None:
    system, h = entry.system(), entry.h
    system.reset()  # runs fit its start with the length of their step
    first = states(system, 3 * h, h)
    twin = system.copy()
    assert twin.time == system.time
    on, other = states(system, 5 * h, h), states(twin, 5 * h, h)
    np.testing.assert_array_equal(other, on)
    system.reset()
    assert system.time == 0
    np.testing.assert_array_equal(states(system, 3 * h, h), first)


def test_a_cell_runs_twice() -> None:
    """What notebooks do: the same cell again goes on from now, or from the beginning."""
    ball = vv.PointMass(mass=1.0, velocity=(1, 0, 0), name="ball")
    system = vv.System([ball])
    place = vv.Position(of=ball)
    for _ in range(2):
        result = vv.simulate(system, until=1.0, step=0.1, start="beginning")
        assert result.history(place)[-1, 0] == pytest.approx(1.0)
    vv.simulate(system, until=2.0, step=0.1)
    assert place(system)[0] == pytest.approx(2.0)
    with pytest.raises(vv.InputError, match=r"not after the present time 2.*start='beginning'"):
        vv.simulate(system, until=1.0, step=0.1)
    with pytest.raises(vv.InputError, match="start is 'now' or 'beginning', not 'begining'"):
        vv.simulate(system, until=1.0, step=0.1, start="begining")


def test_changed_arguments_take_effect() -> None:
    ball = vv.PointMass(mass=1.0, velocity=(1, 0, 0))
    system = vv.System([ball])
    ball.velocity = np.array([3.0, 0.0, 0.0])
    vv.simulate(system, until=1.0, step=0.5, start="beginning")
    assert system.x[0] == pytest.approx(3.0)


def test_components_by_name() -> None:
    ball = vv.PointMass(mass=1.0, name="ball")
    system = vv.System([ball])
    assert system["ball"] is ball
    assert system.copy()["ball"] is not ball
    with pytest.raises(vv.InputError, match="no component 'bal'; did you mean 'ball'"):
        system["bal"]


def test_arguments_set_in_a_system_wait_for_a_reset() -> None:
    ball = vv.PointMass(mass=1.0, velocity=(1, 0, 0), name="ball")
    system = vv.System([ball, vv.Force(on=ball, force=(1, 0, 0))])
    ball.mass = 10.0
    asked = (
        lambda: vv.simulate(system, until=1.0, step=0.1),
        lambda: system.step(0.1),
        lambda: system.check(),
        lambda: system.copy(),
        lambda: next(iter(vv.march(system, until=1.0, step=0.1))),
    )
    for ask in asked:
        with pytest.raises(vv.InputError, match=r"'ball': mass changed since the system was made.*reset"):
            ask()
    vv.simulate(system, until=1.0, step=0.1, start="beginning")
    assert system.x[0] == pytest.approx(1.05)


def test_arguments_of_plain_subclasses_wait_too() -> None:
    class Heavy(vv.PointMass):
        pass

    ball = Heavy(mass=1.0)
    system = vv.System([ball])
    ball.velocity = np.array([5.0, 0.0, 0.0])
    with pytest.raises(vv.InputError, match="velocity changed since the system was made"):
        vv.simulate(system, until=1.0, step=0.1)


def test_arguments_that_are_set_are_validated() -> None:
    ball = vv.PointMass(mass=1.0, name="ball")
    with pytest.raises(vv.InputError, match="mass -3 is not positive"):
        ball.mass = -3.0
    assert ball.mass == 1.0
    ball.mass = 2  # type: ignore[assignment]
    assert isinstance(ball.mass, float)
    body = vv.RigidBody(shape=vv.Box(size=(1, 1, 1)), density=2.0)
    body.density = 4.0
    assert body.mass_properties().mass == pytest.approx(4.0)
    with pytest.raises(vv.InputError):
        body.density = -1.0


# --- what is worked out of arguments is worked out anew --------------------------------------------------------
@pytest.mark.parametrize("entry", CATALOGUE, ids=lambda e: e.name)
def test_arguments_stay_as_they_were_given(entry: Entry, monkeypatch: pytest.MonkeyPatch) -> None:
    """Composition completes what was not given, but elsewhere: else a reset would take it for the user's choice."""
    given: dict[int, dict[str, object]] = {}
    usual = Composed.__call__

    def noting(cls: type, *args: object, **kwargs: object) -> object:
        made = usual(cls, *args, **kwargs)
        given[id(made)] = kwargs
        return made

    monkeypatch.setattr(Composed, "__call__", noting)
    system = vv.System(entry.build())
    for c in system.components:
        left = [
            f for f in fields(c) if f.init and f.name != "name" and f.name not in given.get(id(c), (f.name,))
        ]
        for f in left:
            if f.default is None or isinstance(f.default, bool):
                assert getattr(c, f.name) is f.default, (c.label, f.name)


def test_the_usual_formulation_of_contact_follows_its_bodies() -> None:
    mesh = vv.BoxMesh(size=(4, 4, 1), counts=(1, 1, 1), origin=(-2, -2, -1))
    ground = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1e3, poisson=0.3), density=1.0, name="table")
    ball = vv.RigidBody(shape=vv.Sphere(radius=0.5), density=1.0, position=(0, 0, 0.6), name="ball")
    contact = vv.Contact(first=ball, second=ground, stiffness=1e4, initial="press")
    system = vv.System([contact, ground, ball])
    assert not contact.is_mortar
    ball.shape = vv.Box(size=(1, 1, 1))
    system.reset()
    assert contact.formulation is None
    assert contact.is_mortar


def test_a_drive_follows_its_joint() -> None:
    ground = vv.Ground()
    wheel = vv.RigidBody(mass=1.0, inertia=(1, 1, 1), name="wheel")
    slide = vv.RigidBody(mass=1.0, inertia=(1, 1, 1), name="slide")
    hinge, rail = vv.Revolute(a=ground, b=wheel, at=(0, 0, 0)), vv.Prismatic(a=ground, b=slide, at=(0, 0, 0))
    push = vv.JointForce(joint=rail, force=1.0)
    system = vv.System([push, hinge, rail, ground, wheel, slide])
    assert (push.coordinate, rail.stroke, system.n_coordinates) == (None, False, 25)
    push.joint = hinge
    system.reset()
    vv.simulate(system, until=1.0, step=0.1)
    assert hinge.coordinate("angle").value(system.x) == pytest.approx(0.5, rel=1e-3)
    with pytest.raises(vv.InputError, match="has no coordinate 'stroke'"):
        rail.coordinate("stroke")


def test_a_rod_is_as_long_as_its_ends_are_apart_after_a_reset() -> None:
    ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(1, 0, 0))
    rod = vv.Distance(a=ground.point(), b=ball.point())
    system = vv.System([rod, ground, ball])
    ball.position = np.array([0.0, 3.0, 0.0])
    vv.simulate(system, until=0.1, step=0.1, start="beginning")
    assert rod.length is None
    np.testing.assert_allclose(system.x[:3], [0, 3, 0], atol=1e-14)


def slab(counts: tuple[int, int, int]) -> vv.BoxMesh:
    return vv.BoxMesh(size=(1, 1, 1), counts=counts)


@pytest.mark.parametrize("when", ["before", "after"])
def test_supports_and_probes_follow_the_mesh(when: str) -> None:
    """The face z0 has other nodes then, and the place of the probe is in another cell, though they are made before."""

    def made(mesh: vv.BoxMesh) -> tuple[vv.Solid, vv.Fixed, vv.Traction, vv.FieldAt]:
        block = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=100.0, poisson=0.3), density=1.0, name="block")
        support = vv.Fixed(solid=block, nodes="z0")
        return block, support, vv.Traction(solid=block, faces="z1", traction=(0, 0, 1)), stress_of(block)

    def stress_of(block: vv.Solid) -> vv.FieldAt:
        return vv.FieldAt(solid=block, field="von_mises", at=(0.3, 0.4, 0.1))

    def told(block: vv.Solid, probe: vv.FieldAt, system: vv.System) -> tuple[np.ndarray, np.ndarray]:
        vv.simulate(system, until=0.2, step=0.1)
        return system.x.copy(), np.asarray(probe(system))

    block, support, pull, probe = made(slab((2, 1, 1)))
    if when == "before":
        block.mesh = slab((3, 2, 2))
        system = vv.System([support, pull, block])
    else:
        system = vv.System([support, pull, block])
        block.mesh = slab((3, 2, 2))
        system.reset()
    x, stress = told(block, probe, system)
    block, support, pull, probe = made(slab((3, 2, 2)))
    x_new, stress_new = told(block, probe, vv.System([support, pull, block]))
    np.testing.assert_array_equal(x, x_new)
    np.testing.assert_array_equal(stress, stress_new)


def test_the_stream_function_follows_the_mesh() -> None:
    """Psi of a uniform flow is as high as the channel is wide."""
    water = vv.Fluid(mesh=channel(1.0), density=1.0, viscosity=1.0, velocity=(3, 0, 0))
    system = vv.System([vv.FluidTraction(fluid=water, faces="all", traction=(0, 0, 0)), water])
    flow, psi = (
        vv.FlowRate(fluid=water, faces="x1"),
        vv.FlowField(fluid=water, field="stream_function", at=(1, 0.9, 0)),
    )
    assert (flow(system), psi(system)) == pytest.approx((3.0, 2.7))
    water.mesh = channel(2.0)
    system.reset()
    assert np.ptp(water.smoothed(["stream_function"], system.x)["stream_function"]) == pytest.approx(6.0)
    assert (flow(system), psi(system)) == pytest.approx((6.0, 2.7))


def channel(width: float) -> vv.RectangleMesh:
    return vv.RectangleMesh(size=(2, width), counts=(2, 2))


def test_copies_know_the_forces_of_the_last_step() -> None:
    block = vv.Solid(
        mesh=vv.BoxMesh(size=(2, 1, 1), counts=(2, 1, 1)),
        material=vv.NeoHooke(young=1e4, poisson=0.3),
        density=1.0,
        name="block",
    )
    system = vv.System([block, vv.Fixed(solid=block, nodes="x0"), vv.Gravity()])
    vv.simulate(system, until=0.05, step=0.01)
    twin = system.copy()
    expected = vv.SupportForce(solid=block, nodes="x0")(system)
    assert vv.SupportForce(solid=twin["block"], nodes="x0")(twin) == pytest.approx(expected, rel=1e-12)


def test_steps_without_rates_at_their_end_have_failed() -> None:
    """What a beam without mass welds to a body has no rates under schemes that project them: no step converged."""
    section = vv.RectangleSection(width=0.1, height=0.1, young=1e6, poisson=0.3)
    beam = vv.Beam(mesh=vv.LineMesh(points=((0, 0, 0), (1, 0, 0)), count=4), section=section)
    ball = vv.RigidBody(mass=1.0, inertia=(0.01, 0.01, 0.01), position=(1, 0, 0))
    weld = vv.Rigid(a=ball, b=beam, at=(1, 0, 0))
    system = vv.System([beam, vv.Clamped(solid=beam, nodes=[0]), ball, weld, vv.Gravity()])
    with pytest.raises(vv.StepFailure, match=r"no rates satisfy the constraints.*or take EnergyMomentum\(\)"):
        vv.simulate(system, until=1.0, step=0.01, scheme=vv.GeneralizedAlpha(rho=0.8))
    rod = vv.RigidBody(mass=1.0, inertia=(0, 0.1, 0.1), position=(1, 0, 0))
    hinge = vv.Revolute(a=vv.Ground(), b=rod, at=(0, 0, 0), axis=(0, 1, 0))
    system = vv.System([hinge.a, rod, hinge, vv.Gravity()])
    with pytest.raises(vv.VisvivaError):
        vv.simulate(system, until=0.1, step=0.01, scheme=vv.GeneralizedAlpha(rho=0.8))


def test_errors_of_functions_of_the_user_are_no_failures_of_steps() -> None:
    """A RuntimeError in `accept` passed for a step that has no rates at its end."""

    class Broken(vv.model.term.Term):
        def residual(self, s: Any) -> Any:
            return 10.0 * s.x

        def accept(self, s: Any) -> None:
            raise RuntimeError("of the user")

    class Breaks(vv.PointMass):
        def contribute(self, model: Any) -> None:
            super().contribute(model)
            model.term(self, broken)

    ball, broken = Breaks(mass=1.0, position=(1, 0, 0)), Broken()
    broken.unknowns, broken.order = np.arange(3, dtype=np.int32).reshape(1, 3), np.full(3, 2, dtype=np.int32)
    system = vv.System([ball])
    attempt = solved(system, vv.EnergyMomentum().step(0.0, 0.01))
    with pytest.raises(RuntimeError, match=r"^of the user$"):
        accept(system, attempt, vv.EnergyMomentum())
    assert (system.time, system.x[0]) == (0, 1)


def test_immersed_bodies_may_stand_before_their_fluid() -> None:
    water = vv.Fluid(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(6, 6), cell="quad9"), density=1.0, viscosity=1.0
    )
    body = vv.RigidBody(shape=vv.Cylinder(radius=0.2, length=1.0), density=1.0, position=(0.5, 0.5, 0))
    wet, walls = vv.ImmersedBody(body=body, fluid=water), vv.NoSlip(fluid=water, faces="all")
    vv.System([wet, body, walls, water])
