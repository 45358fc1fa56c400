"""Work of drives and loads under schemes that balance forces at the end of a step: of second order in its length."""

import math

import numpy as np
import pytest

import visviva as vv
from visviva.results.audit import energy_verdict

W = 2 * math.pi
AMPLITUDE = 0.3
INERTIA = 2.0  # about the hinge


def swung(step, scheme, what, flow=False):
    """A body swung about a hinge as 0.3 sin(w t), by a motor or by the torque or force that this takes."""
    speed = AMPLITUDE * W
    ground = vv.Ground()
    body = vv.RigidBody(
        mass=1.0,
        inertia=(1, 1, 1),
        position=(1, 0, 0),
        velocity=(0, speed, 0),
        angular_velocity=(0, 0, speed),
    )
    hinge = vv.Revolute(a=ground, b=body, at=(0, 0, 0), axis=(0, 0, 1))
    torque = -INERTIA * AMPLITUDE * W**2
    parts = {
        "motor": lambda: vv.Motor(joint=hinge, motion=f"{AMPLITUDE}*sin({W!r}*t)"),
        "torque": lambda: vv.JointForce(joint=hinge, force=f"{torque!r}*sin({W!r}*t)"),
        "function": lambda: vv.Force(on=body.point(), force=lambda t, x, v: (0, torque * math.sin(W * t), 0)),
        "damper": lambda: vv.JointDamper(joint=hinge, damping=2.0),
    }
    beside = []
    if flow:  # then rates are projected outside of the core
        water = vv.Fluid(
            mesh=vv.RectangleMesh(size=(1, 1), counts=(1, 1), cell="quad9"), density=1.0, viscosity=1.0
        )
        beside = [water, vv.NoSlip(fluid=water, faces="all")]
    system = vv.System([ground, body, hinge, parts[what](), *beside])
    return vv.simulate(system, until=0.5, step=step, scheme=scheme, project=True)


@pytest.mark.parametrize("what", ["motor", "torque", "function", "damper"])
@pytest.mark.parametrize("scheme", [vv.GeneralizedAlpha(), vv.GeneralizedAlpha(rho=0.5), vv.BDF2()], ids=str)
def test_booked_work_is_of_second_order(scheme, what):
    results = [swung(h, scheme, what) for h in (0.01, 0.005)]
    coarse, fine = (np.abs(r.ledger["imbalance"]).max() for r in results)
    assert fine < 0.01 * results[0].ledger.energy_scale
    assert coarse / fine > 3.5
    assert not energy_verdict(results[0]).startswith("WRONG")


@pytest.mark.parametrize("flow", [False, True])
def test_work_of_a_motor_is_the_kinetic_energy_it_takes(flow):
    """From full speed to rest in a quarter of a period, exact for the motion itself."""
    result = swung(0.005, vv.GeneralizedAlpha(), "motor", flow=flow)
    ledger = result.ledger
    quarter = len(ledger["time"]) // 2
    kinetic = 0.5 * INERTIA * (AMPLITUDE * W) ** 2
    assert ledger["work_drive"][quarter] == pytest.approx(-kinetic, rel=1e-3)
