"""Double pendulum: two point masses on massless bars, both horizontal at rest; chaotic after 5 s."""

from __future__ import annotations

import visviva as vv


def study(
    mass: float = 1.0, length: float = 1.0, gravity: float = 9.81, until: float = 5.0, step: float = 0.005
) -> vv.Study:
    """Two equal bobs on equal bars along +x, gravity along -y."""
    ground = vv.Ground()
    inner = vv.PointMass(mass=mass, position=(length, 0, 0), name="inner")
    outer = vv.PointMass(mass=mass, position=(2 * length, 0, 0), name="outer")
    bars = [
        vv.Distance(a=ground.point(), b=inner.point(), name="inner bar"),
        vv.Distance(a=inner.point(), b=outer.point(), name="outer bar"),
    ]
    system = vv.System([ground, inner, outer, *bars, vv.Gravity(acceleration=(0, -gravity, 0))])
    probes = {
        "inner": vv.Position(of=inner),
        "outer": vv.Position(of=outer),
        "inner_bar_force": vv.ReactionForce(joint=bars[0]),
    }
    return vv.Study(
        system, until, step, probes=probes, trails=("outer",), units="SI", title="Double pendulum"
    )


def check(result: vv.Result) -> None:
    """Energy and the lengths of the bars."""
    result.assert_conserved("energy", "constraints")
