"""Small systems stepped by one process, and again by several from the same states; the first prints the differences.

python tests/processes/alike.py reference FILE
mpiexec -n 3 python tests/processes/alike.py FILE
"""

from __future__ import annotations

import json
import pickle
import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import starts

import visviva as vv
from visviva.base.world import world

RUBBER = vv.NeoHooke(young=100.0, poisson=0.3)
SOFT = vv.NeoHooke(shear=10.0, poisson=0.4999)


def block(counts: tuple[int, ...] = (4, 3, 3), **options: Any) -> vv.Solid:
    kind: Any = vv.BoxMesh if len(counts) == 3 else vv.RectangleMesh
    default = "hex8" if len(counts) == 3 else "quad4"
    mesh = kind(size=(1.0, 0.8, 0.7)[: len(counts)], counts=counts, cell=options.pop("cell", default))
    chosen = {"mesh": mesh, "material": RUBBER, "density": 1.0, "name": "block", **options}
    return vv.Solid(**chosen)


def flying(**options: Any) -> list[Any]:
    return [block(velocity=(1.0, 0.5, 0.0), angular_velocity=(0.0, 1.0, 3.0), **options)]


def hanging(**options: Any) -> list[Any]:
    solid = block(**options)
    pull = vv.Traction(solid=solid, faces="x1", traction=(0.0, 2.0, 0.0), times="sin(3*t)")
    down = vv.Gravity(acceleration=(0.0, -9.81, 0.0))
    return [solid, vv.Fixed(solid=solid, nodes="x0"), down, pull]


def pressed(**options: Any) -> list[Any]:
    solid = block(**options)
    press = vv.Pressure(solid=solid, faces="x1", pressure="5*t")
    return [solid, vv.Fixed(solid=solid, nodes="x0"), press]


def moved(**options: Any) -> list[Any]:
    solid = block(**options)
    lead = vv.Prescribed(solid=solid, nodes="x1", motion=("0.1*t", "0.05*t", None))
    return [solid, vv.Fixed(solid=solid, nodes="x0"), lead]


def hinged() -> list[Any]:
    solid, ground = block(), vv.Ground()
    body = vv.RigidBody(mass=2.0, inertia=(1, 1, 1), position=(1.5, 0.4, 0.35))
    held = vv.RigidCoupling(solid=solid, faces="x1")
    joint = vv.Rigid(a=held, b=body, at=(1.2, 0.4, 0.35))
    hinge = vv.Revolute(a=ground, b=body, at=(2.0, 0.4, 0.35), axis=(0, 1, 0))
    return [solid, body, ground, held, joint, hinge, vv.Gravity()]


def tied() -> list[Any]:
    left = block()
    mesh = vv.BoxMesh(size=(0.5, 0.8, 0.7), counts=(2, 2, 2), origin=(1.0, 0.0, 0.0))
    right = vv.Solid(mesh=mesh, material=RUBBER, density=1.0, name="right")
    tie = vv.Tie(first=left, first_faces="x1", second=right, second_faces="x0")
    pull = vv.Traction(solid=right, faces="x1", traction=(0.0, 0.0, 2.0), times="t")
    return [left, right, tie, vv.Fixed(solid=left, nodes="x0"), pull]


def driven() -> list[Any]:
    """A force along the stroke of a joint, whose multiplier is there after one iteration."""
    solid, body, ground = block(), vv.RigidBody(mass=2.0, inertia=(1, 1, 1), position=(3, 0, 0)), vv.Ground()
    slide = vv.Prismatic(a=ground, b=body, at=(3, 0, 0), axis=(1, 0, 0))
    force, held = vv.JointForce(joint=slide, force=2.0), vv.Fixed(solid=solid, nodes="x0")
    return [solid, held, body, ground, slide, force, vv.Gravity()]


def with_beam() -> list[Any]:
    """A block that hangs on a beam."""
    solid = block()
    section = vv.RectangleSection(width=0.2, height=0.3, young=2e3, density=1.0)
    beam = vv.Beam(mesh=vv.LineMesh(points=[(1.0, 0.4, 0.35), (3.0, 0.4, 0.35)], count=4), section=section)
    held = vv.RigidCoupling(solid=solid, faces="x1")
    joint = vv.Rigid(a=held, b=beam, at=(1.0, 0.4, 0.35))
    return [solid, beam, held, joint, vv.Clamped(solid=beam, nodes="end"), vv.Gravity()]


def with_shell() -> list[Any]:
    """A block beside a shell that swings."""
    section = vv.HomogeneousSection(thickness=0.1, young=1e3, density=1.0)
    shell = vv.Shell(mesh=vv.RectangleMesh(size=(1, 1), counts=(4, 3)), section=section)
    return [*hanging(), shell, vv.Clamped(solid=shell, nodes="x0")]


def conducting() -> list[Any]:
    """Heat alone: given temperatures, a flux, convection to a place that warms up, a source."""
    mesh = vv.BoxMesh(size=(1, 0.8, 0.7), counts=(4, 3, 3))
    body = vv.ThermalBody(
        mesh=mesh,
        conductivity=2.0,
        capacity=1.5,
        temperature=lambda X: 300 + 50 * X[:, 1],
        capacity_slope=1e-3,
    )
    return [
        body,
        vv.PrescribedTemperature(body=body, nodes="x0", value="300 + 20*sin(5*t)"),
        vv.HeatFlux(body=body, faces="y1", flux=40.0),
        vv.Convection(body=body, faces="x1", coefficient=5.0, ambient="320 + 10*t"),
        vv.HeatSource(body=body, power=30.0),
    ]


def warm() -> list[Any]:
    """A block that heat strains, one end held and kept at a temperature, another cooled, beside one without heat."""
    steel = vv.Heat(conductivity=2.0, capacity=3.0, expansion=1e-3, reference=300.0)
    mesh = vv.BoxMesh(size=(1, 0.8, 0.7), counts=(3, 2, 2))
    solid = vv.ThermoelasticSolid(
        mesh=mesh,
        material=RUBBER,
        density=1.0,
        heat=steel,
        temperature=lambda X: 300 + 20 * X[:, 1],
        name="warm",
    )
    return [
        solid,
        vv.Fixed(solid=solid, nodes="x0"),
        vv.PrescribedTemperature(body=solid, nodes="x0", value="310 + 10*t"),
        vv.Convection(body=solid, faces="x1", coefficient=5.0, ambient=280.0),
        *hanging(),
    ]


def cracking() -> list[Any]:
    """Damage that grows, rests where it is pressed and never heals, beside a block."""
    mesh = vv.BoxMesh(size=(1, 0.8, 0.6), counts=(3, 2, 2))
    solid = vv.FracturingSolid(
        mesh=mesh,
        material=vv.SaintVenantKirchhoff(young=100.0, poisson=0.2),
        density=1.0,
        toughness=0.5,
        length=0.5,
        model="AT1",
        split="spectral",
        name="cracking",
    )
    pull = vv.Prescribed(solid=solid, nodes="x1", motion=("0.2*sin(5*t)", None, None))
    return [solid, vv.Fixed(solid=solid, nodes="x0"), pull, *hanging()]


def colliding(**options: Any) -> list[Any]:
    """A block that flies into a finer one, on a slant."""
    mesh = vv.BoxMesh(size=(0.5, 0.9, 0.8), counts=(2, 4, 4), origin=(1.01, -0.05, -0.03))
    other = vv.Solid(mesh=mesh, material=RUBBER, density=1.0, velocity=(-0.6, 0.2, 0.0), name="other")
    chosen = {"first": other, "first_faces": "x0", "second_faces": "x1", **options}
    solid = block(angular_velocity=(0.0, 0.0, 0.5))
    return [solid, other, vv.Contact(second=solid, **chosen)]


def resting() -> list[Any]:
    """A block on another one that is held, pressed down in statics: contact alone carries it."""
    below, mesh = block(), vv.BoxMesh(size=(0.6, 0.4, 0.5), counts=(3, 2, 2), origin=(0.2, 0.8, 0.1))
    above = vv.Solid(mesh=mesh, material=RUBBER, density=1.0, name="above")
    contact = vv.Contact(first=above, first_faces="y0", second=below, second_faces="y1", friction=0.4)
    push = vv.Traction(solid=above, faces="y1", traction=(0.5, -2.0, 0.0), times="t")
    return [below, above, contact, vv.Fixed(solid=below, nodes="y0"), push]


def bouncing() -> list[Any]:
    """A ball that spins and a box fall onto the ground and rub there; another ball falls on a block beside."""
    ball, solid = vv.Sphere(radius=0.5), block()
    turning: Any = {
        "shape": ball,
        "position": (3, 0.55, 0),
        "velocity": (1, -2, 0),
        "angular_velocity": (0, 0, 3),
    }
    spun = vv.RigidBody(density=2.0, **turning)
    box = vv.RigidBody(
        shape=vv.Box(size=(0.4, 0.3, 0.5)), density=5.0, position=(5, 0.2, 0), velocity=(0.5, -2, 0)
    )
    small = vv.RigidBody(mass=0.2, inertia=(4e-3,) * 3, position=(0.5, 1.05, 0.3), velocity=(0.2, -3, 0))
    falling = vv.Obstacle(shape=vv.Sphere(radius=0.2), on=small)
    plane = vv.Plane(at=(0, 0, 0), normal=(0, 1, 0))
    contacts = [
        vv.Contact(first=spun, second=plane, friction=0.3, stiffness=1e3),
        vv.Contact(first=box, second=plane, friction=0.3, restitution=0.5, stiffness=1e3),
        vv.Contact(first=solid, first_faces="y1", second=falling, enforcement="penalty"),
    ]
    weight = vv.Gravity(acceleration=(0, -9.81, 0))
    return [solid, spun, box, small, falling, plane, vv.Fixed(solid=solid, nodes="y0"), *contacts, weight]


def weightless() -> list[Any]:
    """A mass on a block without, whose nodes have rates to keep."""
    solid = block(density=0.0)
    mass = vv.RigidBody(mass=1.0, inertia=(1, 1, 1), position=(1.0, 0.4, 0.35))
    end = vv.RigidCoupling(solid=solid, faces="x1")
    weld = vv.Rigid(a=mass, b=end, at=(1.0, 0.4, 0.35))
    return [solid, end, mass, weld, vv.Fixed(solid=solid, nodes="x0"), vv.Gravity()]


def led() -> list[Any]:
    """An arm that a servo constraint turns, beside a block."""
    ground, arm = vv.Ground(), vv.RigidBody(mass=1.0, inertia=(1.0, 1.0, 2.0), position=(4, 0, 0))
    axle = vv.Revolute(a=ground, b=arm, at=(3, 0, 0), axis=(0, 0, 1))
    height = vv.Position(of=arm, direction=(0, 1, 0))
    servo = vv.Servo(output=[height], follows=["0.5*sin(3*t**2)"], actuators=[axle])
    return [*hanging(), ground, arm, axle, servo]


def pulled() -> list[Any]:
    """Functions of the user: a force that reads the clock, a potential between a block and a ball."""
    solid, ball = block(), vv.PointMass(mass=1.0, position=(2, 0.4, 0.35))
    force = vv.Force(on=ball, force=lambda t, x, v: (np.sin(5 * t), -v[1], x[0]))
    apart = vv.SquaredDistance(a=solid.point((1.0, 0.4, 0.35)), b=ball)
    spring = vv.Potential(of=[apart], energy=lambda e: 5 * (e[0] - 0.5) ** 2)
    return [solid, ball, force, spring, vv.Fixed(solid=solid, nodes="x0"), vv.Gravity()]


def turning() -> list[Any]:
    """A body and a block, seen from a frame that turns."""
    body = vv.RigidBody(mass=2.0, inertia=(1, 1.5, 2), position=(3, 0, 0), angular_velocity=(0, 1, 0.2))
    return [*hanging(), body, vv.RotatingFrame(angular_velocity=(0.3, -0.2, 0.5))]


def flowing(**options: Any) -> list[Any]:
    """Water through a channel, pulled along by a force that changes, and out at the end."""
    mesh = vv.RectangleMesh(size=(2.0, 1.0), counts=(6, 4))
    chosen = {
        "mesh": mesh,
        "density": 1.0,
        "viscosity": 0.05,
        "name": "water",
        "body_force": ("sin(5*t)", "x", 0),
    }
    water = vv.Fluid(**(chosen | options))
    profile = lambda t, X: 5 * t * X[:, 1:2] * (1 - X[:, 1:2]) * [4, 0, 0]  # noqa: E731
    inlet = vv.VelocityBoundary(fluid=water, faces="x0", velocity=profile)
    sides = ("y0", "y1", "z0", "z1")[: 2 * water.dimension - 2]
    walls = [vv.NoSlip(fluid=water, faces=side) for side in sides]
    return [water, inlet, *walls, vv.Outlet(fluid=water, faces="x1")]


def carrying() -> list[Any]:
    """A soft block in a cavity whose lid moves."""
    water = vv.Fluid(
        mesh=vv.RectangleMesh(size=(1.0, 1.0), counts=(8, 8)), density=1.0, viscosity=0.1, name="water"
    )
    lid = vv.VelocityBoundary(fluid=water, faces="y1", velocity=("2*t", 0, 0))
    walls = [vv.NoSlip(fluid=water, faces=side) for side in ("x0", "x1", "y0")]
    mesh = vv.RectangleMesh(size=(0.35, 0.35), counts=(4, 4), origin=(0.3, 0.35))
    solid = vv.Solid(mesh=mesh, material=RUBBER, density=2.0, name="soft")
    return [water, lid, *walls, solid, vv.Immersed(solid=solid, fluid=water)]


DYNAMICS, STATICS = vv.EnergyMomentum(), vv.Static()
CASES: dict[str, tuple[Callable[[], list[Any]], vv.Scheme]] = {
    "flying": (flying, DYNAMICS),
    "flying, enhanced": (lambda: flying(formulation="enhanced"), DYNAMICS),
    "flying, F-bar": (lambda: flying(formulation="F-bar"), DYNAMICS),
    "flying, mean dilatation": (lambda: flying(formulation="mixed", material=SOFT), DYNAMICS),
    "flying, tet10": (lambda: flying(counts=(2, 1, 1), cell="tet10"), DYNAMICS),
    "hanging": (hanging, DYNAMICS),
    "hanging, generalised alpha": (hanging, vv.GeneralizedAlpha(0.8)),
    "hanging, variational midpoint": (hanging, vv.VariationalMidpoint()),
    "hanging, plane": (lambda: hanging(counts=(6, 4)), DYNAMICS),
    "hanging, damped": (lambda: hanging(mass_damping=0.1, stiffness_damping=0.01), DYNAMICS),
    "pressed": (pressed, STATICS),
    "pressed, enhanced": (lambda: pressed(formulation="enhanced"), STATICS),
    "pressed, hex27": (lambda: pressed(counts=(2, 1, 1), cell="hex27"), STATICS),
    "moved": (moved, STATICS),
    "hinged": (hinged, DYNAMICS),
    "tied": (tied, STATICS),
    "driven": (driven, DYNAMICS),
    "with a beam": (with_beam, DYNAMICS),
    "with a shell": (with_shell, DYNAMICS),
    "conducting": (conducting, DYNAMICS),
    "warm": (warm, DYNAMICS),
    "cracking": (cracking, vv.GeneralizedAlpha(0.0)),  # steps that balance in their middle are halved here
    "colliding": (colliding, DYNAMICS),
    "colliding, conserving": (lambda: colliding(impact="conserving"), DYNAMICS),
    "colliding, penalty": (lambda: colliding(enforcement="penalty"), DYNAMICS),
    "colliding, rubbing": (lambda: colliding(friction=0.3), DYNAMICS),
    "resting": (resting, STATICS),
    "bouncing": (bouncing, DYNAMICS),
    "weightless": (weightless, vv.BackwardEuler()),
    "weightless, generalised alpha": (weightless, vv.GeneralizedAlpha(0.8)),
    "led": (led, vv.GeneralizedAlpha(0.0)),
    "pulled": (pulled, DYNAMICS),
    "turning": (turning, DYNAMICS),
    "flowing": (lambda: flowing(elements="Q2Q1"), DYNAMICS),
    "flowing, stabilised": (flowing, vv.BDF2()),
    "flowing in space": (lambda: flowing(mesh=vv.BoxMesh(size=(2, 1, 1), counts=(4, 3, 2))), DYNAMICS),
    "carrying": (carrying, DYNAMICS),
    **starts.CASES,
}
STEP, STEPS = 0.05, 4


def system_of(name: str) -> vv.System:
    linear = None
    if world().size == 1 and sys.argv[1] != "reference":
        linear = vv.Petsc()
    system = vv.System(CASES[name][0](), newton=vv.Newton(linear=linear))
    if name.startswith(starts.STRAINED):
        starts.strain(system)
    return system


def run(name: str) -> dict[str, Any]:
    """States, books and looks of a run."""
    system = system_of(name)
    result = vv.simulate(system, until=STEP * STEPS, step=STEP, scheme=CASES[name][1])
    looks = [system.holding_forces()[np.concatenate([f.fixed for f in system.model.fields])]]
    for body in system.components:
        if isinstance(body, vv.ThermalBody):
            looks += [body.heat_flux(system.x)]
        if isinstance(body, vv.Solid):
            looks += looks_at(body, system)
        if isinstance(body, vv.Contact):
            looks += [body.forces, body.pressures, np.nan_to_num(body.gaps)]
    return {
        "t": np.array(result.times),
        "x": np.array(result.states),
        "v": np.array(result.kept.rates),
        "ledger": np.array(result.ledger.rows),
        "looks": looks,
        "moving": system.order > 0,
    }


def reference(name: str) -> dict[str, Any]:
    """What others are compared with: a run, and where its steps end."""
    known = run(name)
    return known | {"ends": ends(name, known["t"], known["x"], known["v"])}


def ends(name: str, t: Any, x: Any, v: Any) -> list[Any]:
    """Of steps from given states, without what those before them have left; some steps of a run may be halves."""
    system, scheme = system_of(name), CASES[name][1]
    found = []
    for k in range(len(t) - 1):
        system.x[:] = 0.0
        system.invalidate()  # where the state is that of the last step, too
        system.x[:], system.v[:] = x[k], v[k]
        system.time = t[k]
        system.invalidate()
        for _ in vv.march(system, until=t[k + 1], step=t[k + 1] - t[k], scheme=scheme, project=True):
            pass
        found.append(system.x.copy())
    return found


def looks_at(solid: vv.Solid, system: vv.System) -> list[Any]:
    """What its elements show."""
    return [
        *solid.smoothed(["von_mises", "J"], system.x).values(),
        solid.at_points("pressure", system.x),
        solid.nodal_forces(system.x),
        solid.mean("energy", system.x),
        solid.fields(system.x).F,
    ]


def stepped(name: str, known: dict[str, Any]) -> float:
    """Largest difference after a step from the same state, relative to the step's largest increment."""
    moving, worst = known["moving"], 0.0
    starts = known["x"][:, moving]
    for start, end, found in zip(
        starts, known["ends"], ends(name, known["t"], known["x"], known["v"]), strict=False
    ):
        increment = np.abs(end[moving] - start).max()
        worst = max(worst, float(np.abs(found[moving] - end[moving]).max() / increment))
    return worst


def differences(name: str, known: dict[str, Any]) -> dict[str, float]:
    """From the run of one process."""
    found, moving = run(name), known["moving"]
    way = np.abs(known["x"][-1] - known["x"][0])[moving].max()
    size = np.abs(known["ledger"]).max()
    return {
        "step": stepped(name, known),
        "run": float(np.abs(found["x"][-1] - known["x"][-1])[moving].max() / way),
        "multipliers": float(np.abs(found["x"][-1] - known["x"][-1])[~moving].max(initial=0.0)),
        "ledger": float(np.abs(found["ledger"] - known["ledger"]).max() / size),
        "looks": max(
            float(np.abs(a - b).max() / (np.abs(b).max() or 1.0))
            for a, b in zip(found["looks"], known["looks"], strict=True)
            if b.size
        ),
    }


def largest(here: dict[str, float]) -> dict[str, float]:
    """Of all processes."""
    return {what: world().largest(value) for what, value in here.items()}


def main() -> None:
    """Write the reference, or compare with it."""
    if sys.argv[1] == "reference":
        with open(sys.argv[2], "wb") as file:
            pickle.dump({name: reference(name) for name in CASES}, file)
        return
    with open(sys.argv[1], "rb") as file:
        known = pickle.load(file)
    found = {name: largest(differences(name, known[name])) for name in known}
    if world().rank == 0:
        print(json.dumps({"processes": world().size, "cases": found}))


if __name__ == "__main__":
    main()
