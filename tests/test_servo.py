"""Servo constraints: inverse dynamics of an arm in closed form, the rotary crane by differential flatness."""

import numpy as np
import pytest
from reference import crane_servo

import visviva as vv
from visviva.examples import crane_servo as crane_servo_example
from visviva.examples import flexible_crane

X, Z = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)
ALONG = ((0.0, 1.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
ACROSS = ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))
CONTROLS = ("bridge_torque", "trolley_force", "winch_torque")
GRAVITY = 9.81


# --- fully actuated: a two-link arm whose tip follows a path ------------------------------------------------

L1, L2, M1, M2, J1, J2 = 1.0, 0.8, 2.0, 1.5, 0.2, 0.1


def tip(t):
    """Path, velocity and acceleration: from rest to rest along a curve, four times differentiable."""
    s, ds, dds = (
        float(crane_servo.SHAPE.deriv(k)(t)) if k else float(crane_servo.SHAPE(t)) for k in range(3)
    )
    path = np.array([1.2 - 0.5 * s, 0.6 + 0.3 * np.sin(2 * s)])
    by_s = np.array([-0.5, 0.6 * np.cos(2 * s)])
    by_ss = np.array([0.0, -1.2 * np.sin(2 * s)])
    return path, by_s * ds, by_s * dds + by_ss * ds**2


def arm_torques(t):
    """Joint angles (relative) and torques by Lagrange's equations of the arm."""
    p, v, a = tip(t)
    c2 = (p @ p - L1**2 - L2**2) / (2 * L1 * L2)
    b = -np.arccos(c2)
    th1 = np.arctan2(p[1], p[0]) - np.arctan2(L2 * np.sin(b), L1 + L2 * np.cos(b))
    th = np.array([th1, th1 + b])  # absolute angles
    e = np.array([[np.cos(q), np.sin(q)] for q in th])
    n = np.array([[-np.sin(q), np.cos(q)] for q in th])
    jac = np.column_stack([L1 * n[0], L2 * n[1]])
    dq = np.linalg.solve(jac, v)
    ddq = np.linalg.solve(jac, a + L1 * e[0] * dq[0] ** 2 + L2 * e[1] * dq[1] ** 2)
    coupling = M2 * L1 * L2 / 2
    mass = np.array(
        [
            [J1 + M1 * L1**2 / 4 + M2 * L1**2, coupling * np.cos(b)],
            [coupling * np.cos(b), J2 + M2 * L2**2 / 4],
        ]
    )
    gyro = coupling * np.sin(th[0] - th[1]) * np.array([dq[1] ** 2, -(dq[0] ** 2)])
    weight = GRAVITY * np.array([(M1 / 2 + M2) * L1 * np.cos(th[0]), M2 * L2 / 2 * np.cos(th[1])])
    absolute = mass @ ddq + gyro + weight
    return np.array([th[0], b]), np.array([absolute.sum(), absolute[1]])


def turned(angle):
    c, s = np.cos(angle), np.sin(angle)
    return ((c, -s, 0.0), (s, c, 0.0), (0.0, 0.0, 1.0))


def arm():
    (q1, b), _ = arm_torques(0.0)
    e1, e2 = (np.array([np.cos(q), np.sin(q), 0.0]) for q in (q1, q1 + b))
    ground = vv.Ground()
    upper = vv.RigidBody(mass=M1, inertia=(0.1, 0.1, J1), position=L1 / 2 * e1, rotation=turned(q1))
    fore = vv.RigidBody(
        mass=M2, inertia=(0.1, 0.1, J2), position=L1 * e1 + L2 / 2 * e2, rotation=turned(q1 + b)
    )
    shoulder = vv.Revolute(a=ground, b=upper, at=(0, 0, 0), axis=Z, first=X)
    elbow = vv.Revolute(a=upper, b=fore, at=L1 * e1, axis=Z, first=e1)
    end = fore.point((L2 / 2, 0, 0))
    servo = vv.Servo(
        output=[vv.Position(of=end, direction=(1, 0, 0)), vv.Position(of=end, direction=(0, 1, 0))],
        follows=[lambda t: tip(t)[0][0], lambda t: tip(t)[0][1]],
        actuators=[shoulder, elbow],
        name="hand",
    )
    parts = [ground, upper, fore, shoulder, elbow, servo, vv.Gravity(acceleration=(0, -GRAVITY, 0))]
    return vv.System(parts, vv.Newton(tolerance=1e-15)), servo, end


def arm_errors(scheme, h, shift):
    system, servo, end = arm()
    inputs, path = [], []
    for _ in vv.march(system, until=1.0, step=h, scheme=scheme):
        exact = arm_torques(system.time - shift * h)[1]
        inputs.append(np.abs(servo.inputs(system) - exact).max())
        path.append(np.abs(system.value(end.position)[:2] - tip(system.time)[0]).max())
    return max(inputs), max(path)


@pytest.mark.parametrize(
    ("scheme", "shift", "order"),
    [(vv.EnergyMomentum(), 0.5, 2), (vv.Midpoint(), 0.5, 2), (vv.GeneralizedAlpha(rho=0), 0, 2),
     (vv.BackwardEuler(), 0, 1)],
    ids=lambda value: str(value),
)  # fmt: skip
def test_arm_finds_the_torques_of_inverse_dynamics(scheme, shift, order):
    inputs, path = np.array([arm_errors(scheme, h, shift) for h in (0.02, 0.01, 0.005)]).T
    assert path.max() < 1e-12
    assert np.log2(inputs[1] / inputs[2]) == pytest.approx(order, abs=0.2), inputs
    assert inputs[2] < {1: 1.0, 2: 0.05}[order]  # of torques up to 50


def test_arm_books_the_work_of_its_motors():
    system, _, _ = arm()
    result = vv.simulate(system, until=1.0, step=0.01)
    assert result.conservation()["energy"] < 1e-12
    assert np.abs(result.ledger["work_servo"]).max() > 1.0


def test_variational_midpoint_keeps_the_rates_on_the_path():
    system, _, _ = arm()
    result = vv.simulate(system, until=0.2, step=0.01, scheme=vv.VariationalMidpoint())
    assert result.ledger.size("defect_velocity") < 1e-10


# --- underactuated: the rotary crane ------------------------------------------------------------------------


def crane():
    there, length = (1.5, 0.0, 0.0), 1.2
    ground = vv.Ground()
    girder = vv.RigidBody(mass=100, euler=(8.3, 208.3, 8.3), rotation=ALONG)
    trolley = vv.RigidBody(mass=50, euler=(1.0417,) * 3, position=there)
    drum = vv.RigidBody(mass=3, euler=(0.01, 0.01, 0.25), rotation=ACROSS, position=there)
    load = vv.PointMass(mass=10, position=(1.5, 0.0, -length))
    slewing = vv.Revolute(a=ground, b=girder, at=(0, 0, 0), axis=Z, first=X)
    rail = vv.Prismatic(a=girder.frame_at((0, 0, 0), X), b=trolley.frame_at(there, X))
    axle = vv.Revolute(a=trolley, b=drum, at=there, axis=(0, 1, 0))
    rope = vv.RopeOverWinch(
        a=drum.point(), b=load, at=(1.5, 0, -length), winch=axle, radius=0.1, length=length
    )
    joints = [slewing, rail, axle]
    follows = [lambda t, k=k: crane_servo.load_path(t)[k] for k in range(3)]
    servo = vv.Servo(output=[load], follows=follows, actuators=joints, name="crane driver")
    system = vv.System([ground, girder, trolley, drum, load, *joints, rope, servo, vv.Gravity()])
    return system, servo, joints, load


def steer(h, scheme, until=5.0):
    """Errors (n, 3) of inputs and of coordinates at all times, and those times."""
    system, servo, joints, load = crane()
    times, inputs, coordinates = [], [], []
    for _ in vv.march(system, until=until, step=h, scheme=scheme):
        times.append(system.time)
        inputs.append(servo.inputs(system))
        coordinates.append([system.value(j.coordinate()) for j in joints])
        assert np.abs(system.value(load.point().position) - crane_servo.load_path(system.time)).max() < 1e-12
    exact = crane_servo.solution(times)
    columns = (
        np.column_stack([exact[c] for c in CONTROLS]),
        np.column_stack([exact[c] for c in ("alpha", "u", "theta")]),
    )
    return np.array(times), np.abs(np.array(inputs) - columns[0]), np.abs(np.array(coordinates) - columns[1])


def test_crane_has_the_paper_s_counts():
    system, *_ = crane()
    assert (system.n_coordinates, system.n_constraints) == (42, 37 + 3)


def test_crane_converges_to_the_exact_controls_with_order_two():
    errors = []
    for h in (0.05, 0.025, 0.0125):
        times, inputs, coordinates = steer(h, vv.GeneralizedAlpha(rho=0))
        settled = times > 1.0  # the path's fifth derivative jumps at the start
        errors.append(np.concatenate([inputs[settled].max(axis=0), coordinates.max(axis=0)]))
    orders = np.log2(errors[1] / errors[2])
    assert np.all(np.abs(orders - 2) < 0.2), orders
    assert np.all(errors[2] < [0.2, 0.04, 2e-4, 3e-5, 2e-5, 3e-5]), errors[2]


def test_crane_converges_with_backward_euler_with_order_one():
    errors = []
    for h in (0.05, 0.025):
        _, inputs, coordinates = steer(h, vv.BackwardEuler())
        errors.append(np.concatenate([inputs.max(axis=0), coordinates.max(axis=0)]))
    assert np.all(np.abs(np.log2(errors[0] / errors[1]) - 1) < 0.3), errors


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.Midpoint(), vv.VariationalMidpoint()], ids=str)
def test_crane_refuses_schemes_whose_inputs_oscillate(scheme):
    system, *_ = crane()
    with pytest.raises(vv.InputError, match=r"crane driver.*GeneralizedAlpha\(rho=0\)"):
        vv.simulate(system, until=1.0, step=0.1, scheme=scheme)


def test_crane_balances_energy_under_energy_momentum_though_its_inputs_oscillate():
    system, _, joints, _ = crane()
    next(vv.march(system, until=0.0125, step=0.0125, scheme=vv.GeneralizedAlpha(rho=0)))
    system.evaluate_ledger()
    energy = system.core.energy.sum()
    work = 0.0
    for _ in range(100):
        system.step(0.0125, vv.EnergyMomentum())
        work += system.core.work.sum()
    assert system.core.energy.sum() - energy == pytest.approx(work, abs=1e-9)
    angle = system.value(joints[0].coordinate())
    assert angle == pytest.approx(crane_servo.solution([system.time])["alpha"][0], abs=1e-4)


def test_servo_says_what_is_wrong():
    ground, ball = vv.Ground(), vv.PointMass(mass=1.0)
    with pytest.raises(vv.InputError, match="3 outputs need 3 functions of time to follow, not 1"):
        vv.System([ground, ball, vv.Servo(output=[ball], follows=[0], actuators=[ball])])
    ground, ball, rod = vv.Ground(), vv.PointMass(mass=1.0), vv.RigidBody(mass=1.0, inertia=(1, 1, 1))
    slide = vv.PointOnLine(a=ground, b=rod, at=(0, 0, 0))
    with pytest.raises(vv.InputError, match="3 outputs need 3 actuators, not 1"):
        vv.System([ground, ball, rod, slide, vv.Servo(output=[ball], follows=[0, 0, 0], actuators=[slide])])
    with pytest.raises(ValueError, match="needs a list"):
        vv.Servo(output=[], follows=[], actuators=[])
    with pytest.raises(ValueError, match="not on 7"):
        vv.Servo(output=[7], follows=[0], actuators=[ball])


def test_crane_example_is_the_same_crane():
    study = crane_servo_example.study(step=0.0125)
    for _ in vv.march(study.system, until=2.5, step=0.0125, scheme=study.scheme):
        pass
    exact = crane_servo.solution(np.array([0.0, 2.5]))
    inputs = study.probes["inputs"](study.system)
    assert np.all(np.abs(inputs - [exact[c][-1] for c in CONTROLS]) < [0.2, 0.04, 2e-4])


def forwards(h):
    """How far the load is from its path when a flexible girder gets, as functions of time, what a servo found."""
    study = flexible_crane.study(count=4, until=4.0, step=h, servo=True)
    servo = next(c for c in study.system.components if isinstance(c, vv.Servo))
    load = next(c for c in study.system.components if isinstance(c, vv.PointMass))
    times, inputs, path = [0.0], [servo.inputs(study.system)], [study.system.value(load.point().position)]
    for _ in vv.march(study.system, until=4.0, step=h, scheme=study.scheme):
        times.append(study.system.time)
        inputs.append(servo.inputs(study.system))
        path.append(study.system.value(load.point().position))
    given = np.array([inputs[1], *inputs[1:]])  # those of the start are not known before the first step
    bodies, (slewing, seat, axle, rope) = flexible_crane.crane(4, 5.0, 1.2)
    forces = [
        vv.JointForce(joint=joint, force=lambda t, k=k: float(np.interp(t, times, given[:, k])))
        for k, joint in enumerate((slewing, axle))
    ]
    system = vv.System([*bodies.values(), slewing, seat, axle, rope, *forces, vv.Gravity()])
    apart = 0.0
    for _ in vv.march(system, until=4.0, step=h, scheme=study.scheme):
        wanted = [np.interp(system.time, times, component) for component in np.transpose(path)]
        apart = max(apart, np.abs(system.value(bodies["load"].point().position) - wanted).max())
    return apart


def test_a_flexible_girder_follows_its_path_by_feed_forward():
    """The inputs alone lead its load along a way of six metres, the better the finer their table."""
    coarse, fine = forwards(0.01), forwards(0.005)
    assert coarse < 0.01
    assert fine < coarse / 3
