"""Rope on a drum: half a turn of rope holds a load, of which friction leaves the part exp(-mu pi) at the other end.

The rope is a beam with hardly any stiffness against bending, in contact with an exact cylinder. Its load grows to 1
within the first second; then the drum turns slowly under the rope, which slips everywhere. Euler (1769): T1 / T2 is
exp(0.3 pi) = 2.566. That the rope is thick (friction acts at the drum's surface) and stiff takes less than one per
cent.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import visviva as vv

FRICTION, RADIUS, TAIL = 0.3, 1.0, 0.3


def study(
    count: int = 60, rope: float = 0.004, bending: float = 1e-3, until: float = 2.0, step: float = 0.1
) -> vv.Study:
    """A rope of radius `rope` with `count` elements over half a turn."""
    angle = np.pi / count
    around = (RADIUS + rope) / np.cos(angle / 2) * (1 + 1e-9)  # the middles of chords touch the drum
    turn = np.linspace(np.pi + angle / 2, -angle / 2, count + 2)
    arc = around * np.column_stack([np.cos(turn), 0 * turn, np.sin(turn)])
    down = np.linspace(0, TAIL, int(np.ceil(TAIL / (around * angle))) + 1)[1:, None] * (0.0, 0.0, -1.0)
    points = np.concatenate([(arc[0] + down)[::-1], arc, arc[-1] + down])
    n = len(points)
    cells = np.column_stack([np.arange(n - 1), np.arange(1, n)])
    mesh = vv.Mesh(points, {"line2": cells}, node_sets={"load": np.array([0]), "held": np.array([n - 1])})
    section = vv.GivenSection(
        stiffness=(2e3, 2e3, 2e3, bending, bending, bending),
        mass=0.1,
        moments=(0.025 * rope**2, 0.025 * rope**2, 0.0),
        outside=rope,
    )
    line = vv.Beam(mesh=mesh, section=section, first=(0, 1, 0), name="rope")
    ground = vv.Ground()
    within = vv.Cylinder(radius=0.98 * RADIUS, length=0.5)
    wheel = vv.RigidBody(shape=within, mass=1.0, rotation=((1, 0, 0), (0, 0, 1), (0, -1, 0)), name="wheel")
    axle = vv.Revolute(a=ground, b=wheel, at=(0, 0, 0), axis=(0, 1, 0), name="axle")
    motor = vv.Motor(joint=axle, motion="0.1*max(0, t - 1)", name="motor")
    drum = vv.Obstacle(shape=vv.Cylinder(radius=RADIUS, length=0.5), axis=(0, 1, 0), on=wheel, name="drum")
    contact = vv.Contact(
        first=line,
        second=drum,
        enforcement="penalty",
        stiffness=1e6,
        friction=FRICTION,
        tangential="penalty",
        tangential_stiffness=1e5,
        name="contact",
    )
    load = vv.Force(on=line, at=points[0], force=(0, 0, -1), times="min(t, 1)", name="load")
    held = vv.Clamped(solid=line, nodes="held")
    return vv.Study(
        vv.System([ground, wheel, axle, motor, line, drum, contact, load, held]),
        until,
        step,
        vv.BackwardEuler(),
        {
            "at_load": vv.Resultants(beam=line, at=0.01),
            "behind": vv.Resultants(beam=line, at=np.pi * around + TAIL),
        },
        title="Rope on a drum",
        notes=__doc__,
    )


def ratio(result: vv.Result) -> float:
    """Of the tensions at both ends."""
    system = result.system
    rope: Any = next(c for c in system.components if c.name == "rope")
    tension = rope.resultants(system.x)[:, 0, 2]
    return float(tension[0] / tension[-1])


def check(result: vv.Result) -> None:
    """The drum slips under all of the rope, by Euler's ratio within one per cent."""
    if result.system.time < 2.0 - 1e-9:
        return
    found, exact = ratio(result), np.exp(FRICTION * np.pi)
    assert abs(found / exact - 1) < 0.01, f"the ratio of tensions is {found:.4f} and not {exact:.4f}"
