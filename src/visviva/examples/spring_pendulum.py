"""Spring pendulum: a unit mass on a stiff spring turning about a fixed point, without gravity.

The energy-momentum scheme keeps H = 2.5 and the angular momentum 2.2; the midpoint rule loses the energy.
"""

from __future__ import annotations

import visviva as vv


def study(
    stiffness: float = 100.0,
    rest: float = 1.0,
    stretch: float = 0.1,
    speed: float = 2.0,
    until: float = 10.0,
    step: float = 0.01,
) -> vv.Study:
    """Starts stretched by `stretch` along x with `speed` along y."""
    ground = vv.Ground()
    bob = vv.PointMass(mass=1.0, position=(rest + stretch, 0, 0), velocity=(0, speed, 0), name="bob")
    spring = vv.Spring(a=ground.point(), b=bob.point(), stiffness=stiffness, free_length=rest, name="coil")
    system = vv.System([ground, bob, spring])
    probes = {"bob": vv.Position(of=bob)}
    return vv.Study(system, until, step, probes=probes, trails=("bob",), units="SI", title="Spring pendulum")


def check(result: vv.Result) -> None:
    """Energy and angular momentum."""
    result.assert_conserved("energy", "angular_z")
