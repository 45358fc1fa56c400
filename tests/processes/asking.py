"""Functions of the user that ask the other processes, in every argument that takes a function; run by several.

Each case makes the parts of systems, of which one function is passed through `asked`. Prints what all come to, where
some of the processes ask.
"""

from __future__ import annotations

import dataclasses
import json
import typing
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
from pydantic import ConfigDict, TypeAdapter
from pydantic.dataclasses import dataclass

import visviva as vv
from visviva.base.world import world
from visviva.component.component import Component, settings

Asking = Callable[[Callable[..., Any]], Callable[..., Any]]
Parts = list[Any]
RUBBER = vv.NeoHooke(young=100.0, poisson=0.3)
HEAT = vv.Heat(conductivity=2.0, capacity=3.0, expansion=1e-3, reference=300.0)
ROD = vv.GivenSection(stiffness=(1e3, 1e3, 1e3, 50, 50, 50), mass=1.0, moments=(0.1, 0.1, 0.0))
BAR = vv.BoxMesh(size=(2, 1, 1), counts=(2, 1, 1))
SHEET = vv.RectangleMesh(size=(2, 1), counts=(2, 1))
LINE = vv.LineMesh(points=[(0, 0, 0), (1, 0, 0)], count=2)
TUBE = vv.TubeSection(radius=0.1, young=1e3, density=1.0)
PLATE = vv.SolidSection(material=RUBBER, thickness=0.1, density=1.0)
ZERO: Callable[..., Any] = lambda *given: 0.0  # noqa: E731
NONE: Callable[..., Any] = lambda *given: np.zeros_like(given[-1])  # noqa: E731


def warm(*given: Any) -> Any:
    return np.full(len(given[-1]), 310.0)


# --- bodies with one function, or something that acts on them by one ------------------------------------------
def ball(make: Callable[[Any], Any]) -> Parts:
    body = vv.RigidBody(mass=1.0, inertia=(1, 1, 2))
    return [body, make(body)]


def hinge(make: Callable[[Any], Any]) -> Parts:
    ground, wheel = vv.Ground(), vv.RigidBody(mass=1.0, inertia=(1, 1, 2))
    axle = vv.Revolute(a=ground, b=wheel, at=(0, 0, 0), axis=(0, 0, 1))
    return [ground, wheel, axle, make(axle)]


def spring(kind: Any, **given: Any) -> Parts:
    ground, mass = vv.Ground(), vv.PointMass(mass=1.0, position=(1.1, 0, 0), velocity=(0.1, 0, 0))
    return [ground, mass, kind(a=ground, b=mass, **given)]


def solid(
    make: Callable[[Any], Any] | None = None, kind: Any = vv.Solid, mesh: Any = BAR, **given: Any
) -> Parts:
    body = kind(**{"mesh": mesh, "material": RUBBER, "density": 1.0} | given)
    return [body, vv.Fixed(solid=body, nodes="x0"), *([make(body)] if make else [])]


def beam(make: Callable[[Any], Any] | None = None, kind: Any = vv.Beam, **given: Any) -> Parts:
    body = kind(**{"mesh": LINE, "section": ROD} | given)
    return [body, vv.Clamped(solid=body, nodes="start"), *([make(body)] if make else [])]


def shell(make: Callable[[Any], Any] | None = None, kind: Any = vv.Shell, **given: Any) -> Parts:
    section = vv.HomogeneousSection(thickness=0.1, young=1e3, density=1.0)
    body = kind(**{"mesh": SHEET, "section": section} | given)
    return [body, vv.Clamped(solid=body, nodes="x0"), *([make(body)] if make else [])]


def water(make: Callable[[Any], Any] | None = None, **given: Any) -> Parts:
    body = vv.Fluid(
        mesh=vv.RectangleMesh(size=(2, 1), counts=(2, 2)), density=1.0, viscosity=1.0, speed=1.0, **given
    )
    part = make(body) if make else vv.NoSlip(fluid=body, faces="x0")
    if not isinstance(part, vv.Outlet | vv.FluidTraction | vv.VelocityBoundary | vv.NoSlip):
        part = part, vv.NoSlip(fluid=body, faces="x0")
    walls = [vv.NoSlip(fluid=body, faces=side) for side in ("y0", "y1")]
    return [body, *walls, vv.Outlet(fluid=body, faces="x1"), *(part if isinstance(part, tuple) else [part])]


def store(make: Callable[[Any], Any] | None = None, **given: Any) -> Parts:
    body = vv.ThermalBody(**{"mesh": BAR, "conductivity": 1.0, "temperature": 300.0} | given)
    return [body, *([make(body)] if make else [])]


def heated(make: Callable[[Any], Any] | None = None, **given: Any) -> Parts:
    return solid(make, vv.ThermoelasticSolid, **{"heat": HEAT, "temperature": 310.0} | given)


def both(kind: Any, ask: Asking, argument: str, **given: Any) -> Iterator[Parts]:
    """Heat that comes into a body that conducts it alone, and into one that deforms."""
    for make in (store, heated):
        yield make(lambda body: kind(body=body, **{argument: ask(warm)}, **given))


def mixture(make: Callable[[Any], Any] | None = None, kind: Any = vv.CahnHilliard, **given: Any) -> Parts:
    usual = {
        "mesh": SHEET,
        "gradient_energy": 10.0,
        "mobility": 1.0,
        "free_energy": vv.DoubleWell(barrier=1.0),
    }
    body = kind(**usual | {"concentration": 0.4} | given)
    return [body, *([make(body)] if make else [])]


def touching(ask: Asking) -> Parts:
    lower, upper = (
        vv.ThermoelasticSolid(
            mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1), origin=(0, 0, z)),
            material=RUBBER,
            heat=HEAT,
            density=1.0,
            temperature=temperature,
        )
        for z, temperature in ((0.0, 300.0), (1.0, 310.0))
    )
    contact = vv.Contact(first=lower, first_faces="z1", second=upper, second_faces="z0")
    heat = vv.HeatContact(contact=contact, conductance=ask(lambda p: 1.0 + 0 * p))
    return [lower, upper, vv.Fixed(solid=lower, nodes="z0"), contact, heat]


def servo(path: Any) -> Parts:
    ground, arm = vv.Ground(), vv.RigidBody(mass=2.0, inertia=(1, 1, 1), position=(1, 0, 0))
    axle = vv.Revolute(a=ground, b=arm, at=(0, 0, 0), axis=(0, 0, 1))
    height = vv.Position(of=arm, direction=(0, 1, 0))
    return [ground, arm, axle, vv.Servo(output=[height], follows=[path], actuators=[axle])]


def prescribed(ask: Asking) -> Iterator[Parts]:
    yield solid(lambda on: vv.Prescribed(solid=on, nodes="x1", motion=ask(lambda t, X: 0.1 * t * t + 0 * X)))
    yield solid(
        lambda on: vv.Prescribed(solid=on, nodes="x1", motion=(ask(lambda t: 0.1 * t * t), None, None))
    )


def periodic(times: Any) -> Parts:
    body = vv.Solid(mesh=BAR, material=RUBBER, density=1.0)
    sides = vv.PeriodicFaces(solid=body, pairs=[("x0", "x1")], strain=(0.1, 0.0, 0.0), times=times)
    return [body, sides, vv.Fixed(solid=body, nodes=np.array([0]))]


def materials(function: Any) -> Iterator[Parts]:
    material = vv.UserMaterial(function=function)
    yield solid(material=material)
    yield solid(material=material, formulation="F-bar")
    yield solid(material=material, mesh=SHEET, plane="stress")


def cracking(**given: Any) -> Parts:
    return solid(**{"kind": vv.FracturingSolid, "mesh": SHEET, "toughness": 1.0, "length": 1.0} | given)


class Drag(vv.Term):
    def __init__(self, ask: Asking) -> None:
        super().__init__()
        self.given = ask(lambda s: 0.5 * s.rate)

    def residual(self, s: Any) -> Any:
        return self.given(s)


@dataclass(config=settings, eq=False, kw_only=True)
class Own(Component):
    """A component that brings a term of its own, as plugins do."""

    body: vv.RigidBody
    term: Drag

    def contribute(self, model: Any) -> None:
        position = next(f for f in model.fields if f.component is self.body)
        self.term.unknowns = np.array([position.unknowns], dtype=np.int32)
        self.term.order = np.full(position.size, position.order, dtype=np.int32)
        model.term(self, self.term)


def user_energy(C: Any) -> Any:
    a, b, c, d, e, f = C
    grown = np.log(a * (b * c - e**2) - d * (d * c - e * f) + f * (d * e - b * f))
    return 19.0 * (a + b + c - 3 - grown) + 7.5 * grown**2


def user_heat(C: Any, T: Any) -> Any:
    return user_energy(C) + 2.0 * (T - 300 - T * np.log(T / 300))


def stiff(e: Any) -> Any:
    return 0.5 * (ROD.stiffness_matrix().diagonal() @ e**2)


CASES: dict[str, Callable[[Asking], Parts | Iterator[Parts]]] = {
    # loads and drives on bodies that the first process computes
    "Force.force": lambda ask: ball(lambda on: vv.Force(on=on, force=ask(lambda t, x, v: (1, 0, 0)))),
    "Force.times": lambda ask: ball(lambda on: vv.Force(on=on, force=(1, 0, 0), times=ask(ZERO))),
    "FollowerForce.times": lambda ask: ball(
        lambda on: vv.FollowerForce(on=on, force=(1, 0, 0), times=ask(ZERO))
    ),
    "Torque.times": lambda ask: ball(lambda on: vv.Torque(on=on, torque=(1, 0, 0), times=ask(ZERO))),
    "FollowerTorque.times": lambda ask: ball(
        lambda on: vv.FollowerTorque(on=on, torque=(1, 0, 0), times=ask(ZERO))
    ),
    "SemitangentialTorque.times": lambda ask: ball(
        lambda on: vv.SemitangentialTorque(on=on, torque=(1, 0, 0), times=ask(ZERO))
    ),
    "TorquePair.times": lambda ask: [
        one := vv.RigidBody(mass=1.0, inertia=(1, 1, 2)),
        other := vv.RigidBody(mass=1.0, inertia=(1, 1, 2), position=(1, 0, 0)),
        vv.TorquePair(a=one, b=other, torque=(0, 0, 1), times=ask(ZERO)),
    ],
    "Motor.motion": lambda ask: hinge(lambda axle: vv.Motor(joint=axle, motion=ask(lambda t: t * t))),
    "JointForce.force": lambda ask: hinge(lambda axle: vv.JointForce(joint=axle, force=ask(ZERO))),
    "Servo.follows": lambda ask: servo(ask(lambda t: np.sin(t * t))),
    "RotatingFrame.times": lambda ask: [
        *solid(),
        vv.RotatingFrame(angular_velocity=(0, 0, 1), times=ask(ZERO)),
    ],
    "Spring.energy": lambda ask: spring(vv.Spring, energy=ask(lambda e: (e - 1) ** 2)),
    "Spring.force": lambda ask: spring(vv.Spring, force=ask(lambda e, rate: rate)),
    "ThermalSpring.energy": lambda ask: spring(
        vv.ThermalSpring, energy=ask(lambda e, T: (e - 1) ** 2 - 0.01 * T * T)
    ),
    # components of the user
    "GeneralizedForce.force": lambda ask: ball(
        lambda on: vv.GeneralizedForce(of=[on.point()], force=ask(lambda t, e, rate: 0 * e))
    ),
    "Potential.energy": lambda ask: ball(
        lambda on: vv.Potential(of=[on.point()], energy=ask(lambda e: e[0] ** 2))
    ),
    "Constraint.function": lambda ask: ball(
        lambda on: vv.Constraint(of=[on.point()], function=ask(lambda e: e[0]))
    ),
    "a UserTerm": lambda ask: ball(lambda on: vv.UserTerm(term=Drag(ask), on=[on])),
    "a term of an own component": lambda ask: ball(lambda on: Own(body=on, term=Drag(ask))),
    # solids, which are shared out
    "MeshBody.velocity": lambda ask: solid(velocity=ask(NONE)),
    "Solid.thermal_strain": lambda ask: solid(thermal_strain=ask(lambda X: np.zeros(len(X)))),
    "UserMaterial.function": lambda ask: materials(ask(user_energy)),
    "BodyForce.force": lambda ask: solid(lambda on: vv.BodyForce(solid=on, force=ask(NONE))),
    "BodyForce.times": lambda ask: solid(lambda on: vv.BodyForce(solid=on, force=(1, 0, 0), times=ask(ZERO))),
    "Traction.traction": lambda ask: solid(lambda on: vv.Traction(solid=on, faces="x1", traction=ask(NONE))),
    "Traction.times": lambda ask: solid(
        lambda on: vv.Traction(solid=on, faces="x1", traction=(1, 0, 0), times=ask(ZERO))
    ),
    "Pressure.pressure": lambda ask: solid(lambda on: vv.Pressure(solid=on, faces="x1", pressure=ask(ZERO))),
    "Prescribed.motion": lambda ask: prescribed(ask),
    "PeriodicFaces.times": lambda ask: periodic(ask(ZERO)),
    # beams and shells
    "Beam.first": lambda ask: beam(first=ask(lambda X: (0.0, 1.0, 0.0) + 0 * X)),
    "Beam.velocity": lambda ask: beam(velocity=ask(NONE)),
    "UserSection.energy": lambda ask: beam(section=vv.UserSection(section=ROD, energy=ask(stiff))),
    "LineLoad.force": lambda ask: beam(lambda on: vv.LineLoad(beam=on, force=ask(NONE))),
    "LineLoad.times": lambda ask: beam(lambda on: vv.LineLoad(beam=on, force=(0, 0, 1), times=ask(ZERO))),
    "ThermalStrain.times": lambda ask: beam(
        lambda on: vv.ThermalStrain(beam=on, extension=1e-3, times=ask(ZERO))
    ),
    "ThermalBeam.slopes": lambda ask: beam(
        kind=vv.ThermalBeam, section=TUBE, heat=HEAT, slopes=ask(lambda X: np.zeros((len(X), 2)))
    ),
    "Shell.first": lambda ask: shell(first=ask(lambda X: (1.0, 0.0, 0.0) + 0 * X)),
    "Shell.velocity": lambda ask: shell(velocity=ask(NONE)),
    "EdgeMoment.times": lambda ask: shell(
        lambda on: vv.EdgeMoment(shell=on, edges="x1", moment=(0, 1, 0), times=ask(ZERO))
    ),
    "ThermalShell.difference": lambda ask: shell(
        kind=vv.ThermalShell, section=PLATE, heat=HEAT, difference=ask(lambda X: np.zeros(len(X)))
    ),
    # fluids
    "Fluid.velocity": lambda ask: water(velocity=ask(NONE)),
    "Fluid.body_force": lambda ask: water(body_force=ask(NONE)),
    "VelocityBoundary.velocity": lambda ask: water(
        lambda on: vv.VelocityBoundary(fluid=on, faces="x0", velocity=ask(NONE))
    ),
    "Outlet.pressure": lambda ask: water(lambda on: vv.Outlet(fluid=on, faces="x0", pressure=ask(ZERO))),
    "FluidTraction.traction": lambda ask: water(
        lambda on: vv.FluidTraction(fluid=on, faces="x0", traction=ask(NONE))
    ),
    "FluidHeat.temperature": lambda ask: water(
        lambda on: vv.FluidHeat(fluid=on, conductivity=1.0, capacity=1.0, temperature=ask(warm))
    ),
    # heat
    "ThermalBody.temperature": lambda ask: store(temperature=ask(warm)),
    "ThermoelasticSolid.temperature": lambda ask: heated(temperature=ask(warm)),
    "ThermalBeam.temperature": lambda ask: beam(
        kind=vv.ThermalBeam, section=TUBE, heat=HEAT, temperature=ask(warm)
    ),
    "ThermalShell.temperature": lambda ask: shell(
        kind=vv.ThermalShell, section=PLATE, heat=HEAT, temperature=ask(warm)
    ),
    "HeatSource.power": lambda ask: both(vv.HeatSource, ask, "power"),
    "HeatFlux.flux": lambda ask: both(vv.HeatFlux, ask, "flux", faces="x1"),
    "Convection.ambient": lambda ask: both(vv.Convection, ask, "ambient", faces="x1", coefficient=1.0),
    "Radiation.ambient": lambda ask: both(vv.Radiation, ask, "ambient", faces="x1", emissivity=0.5),
    "PrescribedTemperature.value": lambda ask: both(vv.PrescribedTemperature, ask, "value", nodes="x1"),
    "HeatExchange.ambient": lambda ask: [
        cup := vv.HeatStore(capacity=8.0, temperature=310.0),
        vv.HeatExchange(a=cup, conductance=1.0, ambient=ask(lambda t: 300.0)),
    ],
    "UserHeat.function": lambda ask: heated(
        material=None, heat=vv.UserHeat(function=ask(user_heat), conductivity=1.0, reference=300.0)
    ),
    "HeatContact.conductance": touching,
    # mixtures and cracks
    "CahnHilliard.concentration": lambda ask: mixture(concentration=ask(lambda X: 0.4 + 0 * X[:, 0])),
    "AllenCahn.order": lambda ask: [
        vv.AllenCahn(
            mesh=SHEET,
            free_energy=vv.DoubleWell(barrier=1.0),
            gradient_energy=10.0,
            order=ask(lambda X: 0.4 + 0 * X[:, 0]),
        )
    ],
    "UserFreeEnergy.function": lambda ask: mixture(
        free_energy=vv.UserFreeEnergy(function=ask(lambda c: c**2 * (1 - c) ** 2))
    ),
    "UserMobility.function": lambda ask: mixture(
        mobility=vv.UserMobility(function=ask(lambda c: np.exp(-c)))
    ),
    "RegularSolution.temperature": lambda ask: mixture(
        free_energy=vv.RegularSolution(temperature=ask(lambda t: 300.0 + t), gas_constant=0.01)
    ),
    "RegularSolution.excess": lambda ask: mixture(
        free_energy=vv.RegularSolution(
            temperature="300 + t", excess=[ask(lambda T: 0.01 * T)], gas_constant=0.01
        )
    ),
    "ArrheniusMobility.temperature": lambda ask: mixture(
        mobility=vv.ArrheniusMobility(base=1.0, activation=10.0, temperature=ask(lambda t: 300.0 + t))
    ),
    "PrescribedConcentration.value": lambda ask: mixture(
        lambda on: vv.PrescribedConcentration(body=on, nodes="x1", value=ask(lambda t, X: 0.4 + 0 * X[:, 0]))
    ),
    "ConcentrationSource.rate": lambda ask: mixture(
        lambda on: vv.ConcentrationSource(body=on, rate=ask(lambda t, X: 0 * X[:, 0]))
    ),
    "MixtureSolid.concentration": lambda ask: mixture(
        kind=vv.MixtureSolid, material=RUBBER, density=1.0, concentration=ask(lambda X: 0.4 + 0 * X[:, 0])
    ),
    "FracturingSolid.damage": lambda ask: cracking(damage=ask(lambda X: 0 * X[:, 0])),
    "FracturingSolid.free_strain": lambda ask: cracking(free_strain=ask(lambda t, X: 0 * X[:, 0])),
    "ThermalFracturingSolid.temperature": lambda ask: cracking(
        kind=vv.ThermalFracturingSolid, heat=HEAT, temperature=ask(warm)
    ),
}


ROOMS = ("body", "contact", "flow", "joint", "load", "material", "phase", "thermal", "user")


def taking_functions() -> Iterator[tuple[str, str]]:
    """Classes of visviva, as far up as there is the argument, and arguments that take functions."""
    for cls in (getattr(vv, name) for name in dir(vv)):
        if (
            not isinstance(cls, type)
            or not dataclasses.is_dataclass(cls)
            or cls.__module__.split(".")[1] not in ROOMS
        ):
            continue
        hints = typing.get_type_hints(cls, include_extras=True)
        for field in dataclasses.fields(cls):
            if field.init and takes(hints[field.name], ZERO) and not takes(hints[field.name], object()):
                owner = next(
                    c
                    for c in reversed(cls.__mro__)
                    if field.name in vars(c).get("__annotations__", ()) and dataclasses.is_dataclass(c)
                )
                yield owner.__name__, field.name


def takes(hint: Any, value: Any) -> bool:
    """Whether an argument takes a value, or a list of such ones."""
    for given in (value, [value]):
        try:
            TypeAdapter(hint, config=ConfigDict(arbitrary_types_allowed=True)).validate_python(given)
        except Exception:
            continue
        return True
    return False


# --- who asks when --------------------------------------------------------------------------------------------
class Due:
    ranks: tuple[int, ...] = ()
    now = False


def is_due() -> bool:
    return Due.now and world().rank in Due.ranks


def asked(function: Callable[..., Any]) -> Callable[..., Any]:
    """The same function, in which processes ask the others when it is due."""

    def call(*given: Any) -> Any:
        if is_due():
            world().largest(1.0)
        return function(*given)

    return call


def systems(name: str) -> Iterator[vv.System]:
    made = CASES[name](asked)
    for parts in made if isinstance(made, Iterator) else [made]:
        yield vv.System(parts)


def ends(name: str, ranks: tuple[int, ...]) -> list[float]:
    """Where the systems of a case end, by the sums of their unknowns, while these processes ask in steps."""
    Due.ranks, Due.now = ranks, False
    found = []
    for system in systems(name):
        Due.now = True
        march = vv.quasi_static if name == "RotatingFrame.times" else vv.simulate
        march(system, until=0.1, step=0.05)
        Due.now = False
        found.append(float(np.abs(system.x).sum()))
    return found


def starts(name: str) -> str:
    """What comes of the systems, while the second process asks as they are made."""
    Due.ranks, Due.now = (1,), True
    return f"{len([*systems(name)])} made"


def come_to(do: Callable[[], Any]) -> Any:
    """What all processes come to; where one fails alone, its error and that of the others, which then differ."""
    try:
        found = do()
    except Exception as error:
        found = f"{type(error).__name__}: {error}"
    Due.ranks = ()
    try:
        those = world().together(found)
    except vv.InputError:
        those = world().together(found)
    return those[0] if all(other == those[0] for other in those) else "; ".join(map(str, those))


def tell(case: str, who: str, found: Any) -> None:
    if world().rank == 0:
        print(json.dumps([case, who, found]), flush=True)


if __name__ == "__main__":
    for case in CASES:
        for ranks in ((), (0, 1), (1,)):
            tell(case, f"{ranks} in steps", come_to(partial(ends, case, ranks)))
    for case in CASES:  # after all that march: who fails alone has made other systems
        tell(case, "at the start", come_to(partial(starts, case)))
