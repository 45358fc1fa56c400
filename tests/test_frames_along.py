"""Points and frames along components whose directors vary: joints, loads and pictures see those at the point."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from instances.twisted import TwistedBeam, TwistedBody, about_axis

import visviva as vv
from visviva.results.drawing import Drawing

AXIS = (0.0, 0.6, 0.8)
INERTIA: dict[str, Any] = {"mass": 2.0, "inertia": (0.3, 0.5, 0.4), "angular_velocity": (1.0, 2.0, -1.0)}


def swung(body: vv.RigidBody, twist: float) -> vv.Result:
    """Between a hinge in space, a spring at another place, a follower force, and a second body at given axes."""
    ground = vv.Ground()
    place = np.array([0.2, 0.1, 0.7])
    other = vv.RigidBody(mass=1.0, inertia=(0.1, 0.1, 0.2), position=(0.5, 0, 0.4), name="other")
    here = about_axis(-twist * place[2])  # coordinates there of what stands still in the body
    parts = [
        vv.Revolute(a=ground, b=body, at=(0.1, -0.2, 0.5), axis=AXIS, angle=True),
        vv.Universal(a=body.frame(here @ place, (here @ np.eye(3)[:, [1, 2, 0]]).T), b=other.frame()),
        vv.Spring(
            a=body.point(about_axis(-0.3 * twist) @ (0.4, 0, 0.3)),
            b=ground.point((1, 1, 1)),
            stiffness=5.0,
            free_length=0.3,
        ),
        vv.FollowerForce(on=body.frame(here @ place, here.T), force=(0.3, 0.2, 0.1)),
    ]
    system = vv.System([ground, body, other, *parts, vv.Gravity()])
    system.check()
    return vv.simulate(system, until=0.5, step=0.01)


def test_twisted_coordinates_change_nothing() -> None:
    """Frames given in coordinates that turn along a body are those of the same body in plain ones."""
    plain = swung(vv.RigidBody(**INERTIA), 0.0)
    twisted = swung(TwistedBody(twist=1.3, **INERTIA), 1.3)
    assert np.abs(np.array(plain.states) - np.array(twisted.states)).max() < 1e-9
    assert np.abs(np.ptp(np.array(plain.states), axis=0)).max() > 0.02


@pytest.mark.parametrize("s", [0.0, 0.35, 1.0])
def test_frames_of_a_beam_are_those_at_the_point(s: float) -> None:
    beam = TwistedBeam(twist=0.9)
    system = vv.System([beam])
    frame = beam.frame((0.1, 0.2, s))
    between = (1 - s) * np.eye(3) + s * about_axis(0.9)
    found = np.array([system.value(d) for d in frame.directors])
    assert found == pytest.approx(between.T, abs=1e-15)
    assert system.value(frame.position) == pytest.approx(between @ (0.1, 0.2, 0.0) + (0, 0, s), abs=1e-15)
    again = beam.point_at(system.value(frame.position))
    assert pytest.approx(frame.X, abs=1e-14) == again.X


@pytest.mark.parametrize("end", [0.0, 1.0], ids=["near", "far"])
def test_hinges_keep_the_axis_of_their_section(end: float) -> None:
    """The line in the section that was along the axis stays there, and the work of the hinge is nothing."""
    beam, ground = TwistedBeam(twist=0.9), vv.Ground()
    hinge = vv.Revolute(a=ground, b=beam, at=(0, 0, end), axis=(1, 0, 0))
    system = vv.System([ground, beam, hinge])
    system.check()
    result = vv.simulate(system, until=2.0, step=0.01)
    result.assert_conserved("energy", tolerance=1e-9)
    line = about_axis(0.9 * end).T @ (1, 0, 0)  # in the directors of the section
    for x in result.states:
        section = x[beam.motion.unknowns].reshape(2, 4, 3)[int(end)]
        assert line @ section[1:] == pytest.approx((1, 0, 0), abs=1e-9)
        assert section[0] == pytest.approx((0, 0, end), abs=1e-9)
    turned = np.array([x[beam.motion.unknowns].reshape(2, 4, 3)[int(end), 3, 1:] for x in result.states])
    assert np.ptp(turned, axis=0).max() > 0.02


def test_pictures_follow_the_sections() -> None:
    beam, ball = TwistedBeam(twist=0.9), vv.RigidBody(shape=vv.Sphere(radius=0.1), density=1.0)
    system = vv.System([beam, ball])
    vv.simulate(system, until=0.3, step=0.01)
    drawing = Drawing(system)
    sections = system.x[beam.motion.unknowns].reshape(2, 4, 3)
    points = beam.surface()[0]
    s = points[:, 2:]
    expected = (1 - s) * sections[0, 0] + s * sections[1, 0]
    for k in (0, 1):
        expected += points[:, k : k + 1] * ((1 - s) * sections[0, 1 + k] + s * sections[1, 1 + k])
    found = {
        surface.name: part for surface, part in zip(drawing.surfaces, drawing.points(system.x), strict=True)
    }
    assert found[str(beam.name)] == pytest.approx(expected, abs=1e-14)
    moved = np.array(found[str(ball.name)]) - ball.surface()[0]
    assert np.abs(moved).max() < 1e-14  # at rest
