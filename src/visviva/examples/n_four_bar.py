"""N-four-bar mechanism of the IFToMM benchmark library (A02): parallel cranks joined by rods.

Twice per turn all rods lie on one line: there the mechanism has more freedoms and other branches meet. A
faithful solution stays on the parallelogram branch, where the exact motion is an elliptic function.
"""

from __future__ import annotations

import numpy as np

import visviva as vv
from visviva.examples.four_bar import Z, rod


def study(
    loops: int = 2, speed: float = 1.0, gravity: float = 9.81, until: float = 10.0, step: float = 0.01
) -> vv.Study:
    """`loops` + 1 unit cranks start upright, their tops with `speed` along x; gravity along -y."""
    up, across, tip = np.array([0.0, 1, 0]), np.array([1.0, 0, 0]), np.array([speed, 0.0, 0.0])
    feet = [k * across for k in range(loops + 1)]
    ground = vv.Ground()
    cranks = [rod(foot, foot + up, -speed, tip / 2, f"crank {k}") for k, foot in enumerate(feet)]
    rods = [rod(foot + up, foot + up + across, 0.0, tip, f"rod {k}") for k, foot in enumerate(feet[:-1])]
    hinges = [vv.Revolute(a=ground, b=c, at=foot, axis=Z) for c, foot in zip(cranks, feet, strict=True)]
    for k, link in enumerate(rods):
        hinges.append(vv.Revolute(a=cranks[k], b=link, at=feet[k] + up, axis=Z))
        hinges.append(vv.Revolute(a=cranks[k + 1], b=link, at=feet[k + 1] + up, axis=Z))
    system = vv.System([ground, *cranks, *rods, *hinges, vv.Gravity(acceleration=(0, -gravity, 0))])
    probes = {
        f"B{k}": vv.Position(of=c, at=foot + up) for k, (c, foot) in enumerate(zip(cranks, feet, strict=True))
    }
    title = f"{loops} parallel four-bars (IFToMM A02)"
    return vv.Study(system, until, step, probes=probes, trails=("B0",), units="SI", title=title)


def check(result: vv.Result) -> None:
    """Energy, closure, and the branch: the tops of first and last crank stay `loops` apart along x."""
    result.assert_conserved("energy", "constraints")
    x = result.states[-1]
    cranks = [c for c in result.system.components if isinstance(c, vv.RigidBody) and "crank" in str(c.name)]
    first, last = cranks[0], cranks[-1]
    gap = last.point((0.5, 0, 0)).position.value(x) - first.point((0.5, 0, 0)).position.value(x)
    assert abs(gap[1]) < 1e-6
