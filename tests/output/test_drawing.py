"""What is drawn of a system, and where it is."""

import numpy as np

import visviva as vv
from visviva.results.drawing import Drawing


def test_springs_are_lines_between_their_ends():
    ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(1.5, 0, 0), velocity=(0, 1, 0), name="ball")
    spring = vv.Spring(a=ground.point((0.5, 0, 0)), b=ball, stiffness=3.0, name="spring")
    damper = vv.Damper(a=ground, b=ball, damping=0.1, name="damper")
    system = vv.System([ground, ball, spring, damper])
    drawing = Drawing(system)
    vv.simulate(system, until=0.5, step=0.1)
    found = dict(zip([s.name for s in drawing.surfaces], drawing.points(system.x), strict=True))
    assert found.keys() == {"ball", "spring", "damper"}
    at = ball.point().position.value(system.x)
    np.testing.assert_allclose(found["spring"], [[0.5, 0, 0], at], atol=1e-15)
    np.testing.assert_allclose(found["damper"], [[0, 0, 0], at], atol=1e-15)
