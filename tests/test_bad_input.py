"""What is refused at once, with the component's name and what is wrong: bodies, joints, and numbers that are none."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from catalogue import CATALOGUE
from solid_parts import block
from test_language import MORE, NEEDS_CODE

import visviva as vv
from visviva.analysis.adaptive import Adaptive
from visviva.component.component import Component
from visviva.scene import language, read_scene
from visviva.study.run import run

UNIT: dict[str, Any] = {"mass": 1.0, "inertia": (1.0, 1.0, 1.0), "name": "arm"}
BENT, LEFT = [[1, 0.1, 0], [0, 1, 0], [0, 0, 1]], [[1, 0, 0], [0, 1, 0], [0, 0, -1]]


def arm(**changes: Any) -> vv.RigidBody:
    return vv.RigidBody(**(UNIT | changes))


def twice(kind: Callable[..., Any], **more: Any) -> Any:
    body = arm()
    return kind(a=body.point(), b=body, at=(0, 0, 0), name="link", **more)


GROUND, BALL = vv.Ground(), vv.PointMass(mass=1.0)


def rod(**changes: Any) -> vv.Distance:
    return vv.Distance(**({"a": GROUND, "b": arm(), "at": (0, 0, 0), "name": "rod"} | changes))


def hinge() -> vv.Revolute:
    return vv.Revolute(a=GROUND, b=arm(name=None), at=(0, 0, 0))


def hinges() -> dict[str, vv.Revolute]:
    return {"a": hinge(), "b": hinge()}


def pinion(radius: float) -> vv.RackAndPinion:
    rail = vv.Prismatic(a=GROUND, b=arm(), at=(0, 0, 0))
    return vv.RackAndPinion(a=hinge(), b=rail, radius=radius, name="rack")


def rope(**changes: Any) -> vv.RopeOverWinch:
    given = {"a": GROUND.point(), "b": BALL, "winch": hinge(), "radius": 0.1, "length": 1.0, "name": "rope"}
    return vv.RopeOverWinch(**(given | {"at": (0, 0, 0)} | changes))


REFUSED: dict[str, tuple[Callable[[], Any], str]] = {
    "no mass": (lambda: arm(mass=0.0), "RigidBody 'arm'.*mass 0 is not positive"),
    "negative mass": (lambda: arm(mass=-2.0), "RigidBody 'arm'.*mass -2 is not positive"),
    "point without mass": (lambda: vv.PointMass(mass=0.0, name="bob"), "PointMass 'bob'.*mass 0 is not positive"),
    "negative point mass": (lambda: vv.PointMass(mass=-1.0, name="bob"), "PointMass 'bob'.*mass -1"),
    "negative density": (
        lambda: vv.RigidBody(shape=vv.Sphere(radius=1.0), density=-1.0, name="arm"), "RigidBody 'arm'.*density"
    ),
    "triangle inequality": (lambda: arm(inertia=(1.0, 1.0, 2.5)), "RigidBody 'arm'.*triangle"),
    "triangle inequality in a frame": (
        lambda: arm(inertia=[[1.75, 0.75, 0], [0.75, 1.75, 0], [0, 0, 1.0]]), "RigidBody 'arm'.*triangle"
    ),
    "inertia not symmetric": (lambda: arm(inertia=[[1, 0.2, 0], [0, 1, 0], [0, 0, 1]]), "symmetric"),
    "negative inertia": (lambda: arm(inertia=(-1.0, 1.0, 1.0)), "RigidBody 'arm'"),
    "negative Euler value": (
        lambda: vv.RigidBody(mass=1.0, euler=(1.0, -1.0, 1.0), name="arm"), "RigidBody 'arm'.*"
    ),
    "directors not orthonormal": (lambda: arm(rotation=BENT), "RigidBody 'arm'.*orthonormal"),
    "left-handed directors": (lambda: arm(rotation=LEFT), "RigidBody 'arm'.*left-handed"),
    "frame not orthonormal": (lambda: arm().frame(axes=BENT), "'arm'.*not right-handed and orthonormal"),
    "left-handed frame": (lambda: arm().frame(axes=LEFT), "'arm'.*not right-handed and orthonormal"),
    "axis without direction": (lambda: arm().frame_at((0, 0, 0), (0, 0, 0)), "an axis needs three finite numbers"),
    "rod of no length": (lambda: rod(length=0.0), r"Distance 'rod': length 0 is not positive; a Spherical joint"),
    "rod of negative length": (lambda: rod(length=-1.0), r"Distance 'rod': length -1 is not positive"),
    "rod of no initial length": (
        lambda: vv.System([ball := vv.PointMass(mass=1.0), GROUND, rod(b=ball)]), r"Distance 'rod': length 0"
    ),
    "screw without pitch": (lambda: vv.Screw(a=GROUND, b=arm(), at=(0, 0, 0), pitch=0.0), "pitch 0 .*Revolute"),
    "gear without ratio": (lambda: vv.Gear(**hinges(), ratio=0.0, name="g"), "Gear 'g': ratio 0 .*different from zero"),
    "gear of a number": (lambda: vv.Gear(a=1.5, b=hinge(), ratio=1.0), "Gear: a: .*Joint, not 1.5"),
    "pinion without radius": (lambda: pinion(0.0), "RackAndPinion 'rack': radius 0 is not positive"),
    "pinion of negative radius": (lambda: pinion(-1.0), "RackAndPinion 'rack': radius -1 .*turn the axis"),
    "winch without radius": (lambda: rope(radius=0.0), "RopeOverWinch 'rope': radius 0 is not positive"),
    "winch of negative radius": (lambda: rope(radius=-1.0), "RopeOverWinch 'rope': radius -1 .*turn the winch's axis"),
    "winch that is none": (lambda: rope(winch=3), "RopeOverWinch 'rope': winch: .*Joint, not 3"),
    "negative free length": (
        lambda: vv.Spring(a=GROUND, b=arm(), stiffness=1.0, free_length=-1.0, name="s"),
        "Spring 's': free_length -1 is negative.*force=",
    ),
    "negative free length of a damper": (
        lambda: vv.Damper(a=GROUND, b=arm(), damping=1.0, free_length=-1.0), "Damper: free_length -1"
    ),
    "density beside inertia": (lambda: arm(density=-1.0), "RigidBody 'arm': density means nothing beside inertia"),
    "centre beside a shape": (
        lambda: vv.RigidBody(shape=vv.Sphere(radius=1.0), density=1.0, centre=(1, 0, 0)), "centre means nothing"
    ),
    "no constraint": (
        lambda: vv.Constraint(of=[BALL], function=lambda x: [x[0]], n=0, name="c"), "Constraint 'c': n = 0 constraints"
    ),
    "bounds in the wrong order": (lambda: Adaptive(min_step=1.0, max_step=0.1), "Adaptive: min_step = 1.0 is longer"),
    **{
        f"{kind.__name__} with itself": (lambda kind=kind: twice(kind), "'link'.*'arm' with itself")  # type: ignore[misc]
        for kind in (vv.Spherical, vv.Revolute, vv.Prismatic, vv.Cylindrical, vv.Planar, vv.Universal, vv.Rigid,
                     vv.PointOnLine, vv.PointOnPlane, vv.Distance)
    },
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_bad_bodies_and_joints_are_refused(name: str) -> None:
    make, message = REFUSED[name]
    with pytest.raises(vv.InputError, match=message):
        make()


@pytest.mark.parametrize(
    ("until", "step"),
    [(1.0, 0.0), (1.0, -0.1), (0.0, 0.1), (-1.0, 0.1), (np.nan, 0.1), (1.0, np.inf), (np.inf, 0.1)],
)
def test_bad_times_of_a_run_are_refused_before_its_directory_is_made(
    until: float, step: float, tmp_path: Any
) -> None:
    told = r"step = .* is not a positive number|is not after the start at 0|until = .* is not a finite number"
    with pytest.raises(vv.InputError, match=told):
        run(vv.Study(vv.System([arm()]), until=until, step=step), tmp_path / "out")
    assert not (tmp_path / "out").exists()


# --- what systems, studies and marches are given ------------------------------------------------------------
def ball() -> vv.PointMass:
    return vv.PointMass(mass=1.0, position=(1, 0, 0), name="ball")


def study(**changes: Any) -> vv.Study:
    return vv.Study(**({"system": vv.System([ball()]), "until": 1.0, "step": 0.1} | changes))


def coupled() -> Any:
    return vv.RigidCoupling(solid=block(), faces="x1")


ELSEWHERE: dict[str, tuple[Callable[[], Any], str]] = {
    "no list": (lambda: vv.System(3), "System: components is a list of components, not 3"),
    "text": (lambda: vv.System("ball"), "System: components is a list"),
    "no component": (lambda: vv.System([3]), "a system is composed of components, not of 3"),
    "newton": (lambda: vv.System([ball()], newton=1e-9), "System: newton is Newton"),
    "newton later": (lambda: setattr(vv.System([ball()]), "newton", "fast"), "System: newton is Newton"),
    "words of a system": (lambda: vv.System([ball()], newtn=3), "System: newtn: there is no such argument.*'newton'"),
    "nothing": (lambda: vv.System(), "System: components: this argument is needed"),
    "step by a text": (lambda: step("x"), "System.step: h = 'x' is not a positive number"),
    "no step": (lambda: step(0), "System.step: h = 0 is not a positive number"),
    "step by a name": (lambda: step(0.1, "Midpoint"), "System.step: scheme is a scheme such as .*, not 'Midpoint'"),
    "step by a class": (lambda: step(0.1, vv.Midpoint), "System.step: scheme is a scheme such as"),
    "time": (lambda: setattr(vv.System([ball()]), "time", "x"), "System: time = 'x' is not a finite number"),
    "field of": (lambda: vv.System([ball()]).field("ball", "position"), "System.field: component is .*not 'ball'"),
    "field": (lambda: (s := vv.System([ball()])).field(s.components[0], 3), "PointMass 'ball' has no field 3"),
    "value": (lambda: vv.System([ball()]).value(3), "System.value: what is a form, vector or strain .*, not 3"),
    "value of a measure": (
        lambda: vv.System([b := ball()]).value(vv.Position(of=b)), r"System.value: .*\(call measures with the system\)"
    ),
    "history": (lambda: vv.equilibrium(hung()).history(3), "Result.history: what is a form.*not 3"),
    "scene": (lambda: read_scene(3), "read_scene: file is the path of a scene file, not 3"),
    "changes of a scene": (lambda: read_scene("a.yaml", ["until"]), "read_scene: changes is a mapping"),
    "end beyond floats": (lambda: study(until=10**400), r"Study: until = 10+\.\.\.0+ is not a finite number"),
    "step beyond floats": (lambda: step(10**400), r"System.step: h = 10+\.\.\.0+ is not a positive number"),
    "words of a study": (lambda: study(stp=0.1), "Study: stp: there is no such argument; did you mean 'step'"),
    "no end": (lambda: vv.Study(vv.System([ball()])), "Study: until: this argument is needed"),
    "twice": (lambda: vv.Study(vv.System([ball()]), 1.0, 0.1, until=2.0), "Study: until: .* given twice"),
    "words of a mesh": (lambda: vv.Mesh([(0, 0)], {}, nodesets={}), "Mesh: nodesets: there is .*'node_sets'"),
    "no cells": (lambda: vv.Mesh([(0, 0)]), "Mesh: cells: this argument is needed"),
    "too much of a mesh": (lambda: vv.Mesh(1, 2, 3, 4, 5, 6), "Mesh takes 5 arguments without a name, not 6"),
    "words of faces": (lambda: vv.Faces(cells={}, owner={}), "Faces: owner: there is no such.*'owners'"),
    "rho twice": (lambda: vv.GeneralizedAlpha(0.8, rho=0.9), "GeneralizedAlpha: rho: .* given twice"),
    "joint": (
        lambda: vv.System([ball(), vv.Spherical(a=GROUND, b=arm().point(), at=(0, 0, 0), name="j")]),
        "Spherical 'j': b is RigidBody 'arm', which is not in the system: add it",
    ),
    "support": (
        lambda: vv.System([ball(), vv.Fixed(solid=block(), nodes="x0")]), "Fixed.*: solid is Solid.*not in the system"
    ),
    "coupling": (lambda: vv.System([ball(), coupled()]), "RigidCoupling.*solid is Solid.*not in the system"),
    "spring of a joint": (
        lambda: vv.System([arm(), vv.JointSpring(joint=hinge(), stiffness=1.0)]), "joint is Revolute.*not in the system"
    ),
    "measure": (
        lambda: vv.System([ball(), vv.Potential(of=[vv.SquaredDistance(a=GROUND, b=arm())], energy=lambda e: e[0])]),
        "Potential.*of is RigidBody 'arm', which is not in the system",
    ),
    "probe": (lambda: study(probes={"p": vv.Position(of=arm())}), "Study: probes: p is RigidBody 'arm'"),
    "probes": (lambda: study(probes=3), "Study: probes is a mapping from names to probes, not 3"),
    "trails": (lambda: study(trails=("p",)), "Study: trails name 'p', which is no probe"),
    "scheme": (lambda: study(scheme="Midpoint"), "Study: scheme is a scheme such as .*not 'Midpoint'"),
    "adaptive": (lambda: study(adaptive=1e-6), "Study: adaptive is vv.Adaptive"),
    "step": (lambda: study(step="0.1"), "Study: step = '0.1' is not a positive number"),
    "until": (lambda: study(until=None), "Study: until = None is not a finite number"),
    "march": (lambda: march(step="0.1"), "march: step = '0.1' is not a positive number"),
    "march to a text": (lambda: march(until="1"), "march: until = '1' is not a number"),
    "march by a text": (lambda: march(scheme="Midpoint"), "march: scheme is a scheme such as"),
    "steps too small": (lambda: march(step=1e-300), r"step = 1e-300 is too small: 1e\+300 steps"),
    "tolerance": (lambda: vv.Newton(tolerance="small"), "Newton: tolerance: .*valid number, not 'small'"),
    "tolerance of none": (lambda: vv.Newton(tolerance=0.0), "Newton: tolerance = 0.0 is not a number from"),
    "iterations": (lambda: vv.Newton(max_iterations=2.5), "Newton: max_iterations: .*integer"),
    "Newton's solver": (lambda: vv.Newton(linear="direct"), "Newton: linear: .*LinearOptions"),
    "Newton's words": (lambda: vv.Newton(tol=1e-9), "Newton: tol: there is no such argument.*'tolerance'"),
    "rho": (lambda: vv.GeneralizedAlpha(rho="high"), "GeneralizedAlpha: rho: .*valid number, not 'high'"),
    "rho by place": (lambda: vv.GeneralizedAlpha(None), "GeneralizedAlpha: rho: .*number"),
    "one too many": (lambda: vv.Sphere(1.0, 2.0), "Sphere takes 1 argument without a name, not 2"),
    "too many": (lambda: vv.Midpoint(1), "Midpoint takes no arguments without a name, not 1"),
    "statics": (lambda: vv.Static(tolerance=-1.0), "Static: tolerance = -1.0 is not a number from"),
    "arc": (lambda: vv.ArcLength(most=0), "ArcLength: most = 0 is not a number from 1"),
    "adaptive steps": (lambda: Adaptive(tolerance="fine"), "Adaptive: tolerance: .*valid number, not 'fine'"),
    "library": (lambda: vv.Direct(library="mumps"), "Direct: library: .*'pardiso'"),
    "memory": (lambda: vv.Direct(memory_limit=-1.0), "Direct: memory_limit = -1.0 is not a number from 0"),
    "threads": (lambda: vv.use_threads(0), "use_threads: n = 0 is not a whole number that is at least 1"),
    "many threads": (lambda: vv.use_threads(10**6), "use_threads: n = 1000000 are more than 4096"),
    "Krylov": (lambda: vv.Iterative(tolerance=float("nan")), "Iterative: tolerance = nan is not a number"),
    "automatic": (lambda: vv.Automatic(tolerance=float("nan")), "Automatic: tolerance = nan is not a number"),
    "simulate": (lambda: vv.simulate(3, until=1.0, step=0.1), "simulate: system is a vv.System, not 3"),
    "every": (lambda: simulate(every=0), "simulate: every = 0 is not a whole number that is at least 1"),
    "part of a step": (lambda: simulate(every=1.5), "simulate: every = 1.5 is not a whole number"),
    "observe": (lambda: simulate(observe=3), "simulate: observe is a function"),
    "arc without loads": (lambda: arc(), "vv.arc_length: nothing moves with the load parameter: let a load grow"),
    "points of an arc": (lambda: arc(steps=0), "arc_length: steps = 0 is not a whole number"),
    "frames": (lambda: run(study(), "nowhere", frames_per_second=0), "run: frames_per_second = 0 is not a positive"),
    "saving": (lambda: run(study(), "nowhere", save_every="5 s"), "run: save_every = '5 s' is not a number"),
    "rows": (lambda: run(study(), "nowhere", every=1.5), "run: every = 1.5 is not a whole number"),
    "load steps": (lambda: vv.quasi_static(3, until=1.0, step=0.1), "system is a vv.System"),
    "equilibrium": (lambda: vv.equilibrium(vv.System([ball()]), steps="x"), "equilibrium: steps = 'x'"),
    "rest": (lambda: vv.equilibrium(vv.System([ball()]), most=0), "equilibrium: most = 0"),
    "modes": (lambda: vv.modes(vv.System([ball()]), 1.5), "modes: n = 1.5 is not a whole number"),
    "modes of": (lambda: vv.modes(3), "modes: system is a vv.System"),
    "reaction": (lambda: vv.reaction(vv.System([ball()]), hinge()), "reaction: Revolute is not in the system"),
    "place": (lambda: arm().point((1, 2)), "RigidBody 'arm': X is 3 finite numbers"),
    "place in space": (lambda: arm().point_at((1, 2, np.nan)), "RigidBody 'arm': x is 3 finite numbers"),
    "axes": (lambda: arm().frame(axes="x"), "RigidBody 'arm': axes is 3 rows of 3 finite numbers"),
    "axis": (lambda: arm().frame_at((0, 0, 0), axis="z"), "a direction is 3 numbers, not 'z'"),
    "mesh moved": (lambda: CUBE.moved((1, 2)), "Mesh: by is 3 finite numbers"),
    "mesh turned": (lambda: CUBE.rotated(1.0, axis=(0, 0, 0)), "give an angle and a direction"),
    "mesh scaled": (lambda: CUBE.scaled("x"), "not an array of numbers: 'x'"),
    "mesh merged": (lambda: CUBE.merged(3), "Mesh: other is a mesh, not 3"),
    "faces of a mesh": (lambda: CUBE.with_faces("a", 3.5), "faces are given as Faces or by a function"),
    "faces": (lambda: vv.Faces({"quad4": [[0, 1, 2]]}, {"quad4": [0]}), "Faces: faces 'quad4' of shape"),
    "folder": (lambda: CUBE.write("/no/folder/x.inp"), "there is no folder /no/folder"),
    "a scheme's name": (lambda: simulate(scheme="Midpoint"), "scheme is a scheme such as vv.EnergyMomentum"),
    "a scheme's class": (lambda: march(scheme=vv.Midpoint), "scheme is a scheme such as vv.EnergyMomentum"),
    "plane beams in a frame": (
        lambda: vv.System([PLANE_BEAM, vv.RotatingFrame(angular_velocity=(0, 0, 1))]), "no positions in space",
    ),
    "an edge under pressure": (
        lambda: vv.System([SHELL, vv.Pressure(solid=SHELL, faces="x1", pressure=1.0)]), "have no side that a pressure",
    ),
    "splines in a flow": (
        lambda: vv.Immersed(
            solid=vv.SplineSolid(mesh=vv.SplineBox(size=(1, 1), counts=(2, 2)), material=RUBBER, density=1.0),
            fluid=vv.Fluid(mesh=vv.RectangleMesh(size=(4, 4), counts=(4, 4)), density=1.0, viscosity=1.0),
        ), "is on splines, which no fluid carries yet",
    ),
    "faces near a place of the plane": (
        lambda: CUBE.boundary().near(CUBE.points, (0, 1), within=0.1), r"Faces.near: place is 3 finite.*\(0, 1\)",
    ),
    "faces near no place": (lambda: CUBE.boundary().near(CUBE.points, "x0", within=0.1), "place is 3 .*not 'x0'"),
    "faces that look nowhere": (lambda: CUBE.boundary().facing(CUBE.points, (0, 0, 0)), "has no length"),
    "fractions in words": (lambda: vv.prony("abc", (1.0,)), "prony: fractions is a row of finite numbers"),
    "endless times": (lambda: vv.prony((0.5,), (np.inf,)), "prony: times is a row of finite numbers"),
    "an output that cannot move": (
        lambda: vv.System([
            GROUND, b := arm(), h := vv.Revolute(a=GROUND, b=b, at=(0, 0, 0)),
            vv.Servo(output=[vv.Position(of=GROUND, direction=(1, 0, 0))], follows=["t"], actuators=[h]),
        ]), "cannot move",
    ),
}  # fmt: skip
CUBE = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)).build()
RUBBER = vv.NeoHooke(young=1.0, poisson=0.3)
PLANE_BEAM = vv.PlaneBeam(
    mesh=vv.LineMesh(points=[(0, 0, 0), (1, 0, 0)], count=2),
    section=vv.RectangleSection(width=1.0, height=0.1, young=1.0, density=1.0),
)
SHELL = vv.Shell(
    mesh=vv.RectangleMesh(size=(1, 1), counts=(2, 2)), section=vv.HomogeneousSection(thickness=0.1, young=1.0)
)


def simulate(**changes: Any) -> None:
    vv.simulate(vv.System([ball()]), **({"until": 1.0, "step": 0.1} | changes))


def step(*arguments: Any) -> None:
    vv.System([ball()]).step(*arguments)


def hung() -> vv.System:
    spring = vv.Spring(a=GROUND, b=(end := ball()), stiffness=1.0)
    return vv.System([end, spring, vv.PointOnLine(a=GROUND, b=end, at=(1, 0, 0), axis=(1, 0, 0))])


def arc(**options: Any) -> None:
    vv.arc_length(hung(), step=0.1, **options)


def march(**changes: Any) -> None:
    for _ in vv.march(vv.System([ball()]), **({"until": 1.0, "step": 0.1} | changes)):
        pass


@pytest.mark.parametrize("name", ELSEWHERE)
def test_what_does_not_fit_a_system_or_run_is_refused(name: str) -> None:
    make, message = ELSEWHERE[name]
    with pytest.raises(vv.InputError, match=message):
        make()


def test_the_ground_need_not_be_in_the_system() -> None:
    assert vv.System([body := arm(), vv.Revolute(a=GROUND, b=body, at=(0, 0, 0))]).n_constraints == 11


# --- numbers that are none ----------------------------------------------------------------------------------
def composed() -> dict[str, Any]:
    """One object of every public class that takes numbers, by its name."""
    found: dict[str, Any] = {}

    def collect(thing: Any) -> None:
        if dataclasses.is_dataclass(thing) and not isinstance(thing, type):
            if type(thing).__name__ in found and not isinstance(thing, vv.Solid):
                return
            found.setdefault(type(thing).__name__, thing)
            for f in dataclasses.fields(thing):
                if f.init:
                    collect(getattr(thing, f.name))
        elif isinstance(thing, list | tuple):
            for part in thing:
                collect(part)

    collect([vv.Newton(), Adaptive(tolerance=1e-6), *MORE_VALUES])
    for entry in [*CATALOGUE, *MORE]:
        collect(entry.build())
    return found


AXIS = (1.0, 0.0, 0.0)
MORE_VALUES: list[Any] = [
    vv.Sphere(radius=1.0), vv.Box(size=(1, 2, 3)), vv.Cylinder(radius=1.0, length=2.0),
    vv.Capsule(radius=1.0, length=2.0), vv.Cone(radius=1.0, height=2.0),
    vv.CylinderMesh(radius=1.0, height=1.0, counts=(1, 1, 1)), vv.SphereMesh(radius=1.0, counts=(1, 1)),
    vv.HollowCylinderMesh(inner_radius=1.0, outer_radius=2.0, height=1.0, counts=(1, 8, 1)),
    vv.HollowTorusMesh(), vv.GeneralizedAlpha(rho=0.8),
    vv.Displacement(of=BALL, direction=AXIS), vv.Velocity(of=BALL, direction=AXIS),
    vv.Distance(a=BALL.point(), b=arm().point(), length=1.0),
    vv.Contact(first=arm(shape=vv.Box(size=(1, 1, 1))), second=arm(shape=vv.Box(size=(1, 1, 1))), stiffness=1.0),
    vv.Position(of=BALL, at=(0, 0, 0), direction=AXIS), vv.Direction(of=arm(), axis=AXIS),
    vv.Tie(first=block(), second=block(at=1.0), first_faces="x1", second_faces="x0", reach=0.1),
]  # fmt: skip


def numbers(thing: Any) -> Iterator[tuple[str, Any]]:
    """Arguments that hold numbers, with the first of them replaced by none."""
    for f in dataclasses.fields(thing):
        value = getattr(thing, f.name)
        if not f.init or isinstance(value, bool | int):
            continue
        if isinstance(value, float):
            yield f.name, float("nan")
        elif isinstance(value, np.ndarray) and value.dtype == float and value.size:
            spoiled = value.copy()
            spoiled.flat[0] = np.nan
            yield f.name, spoiled
        elif isinstance(value, tuple) and value and all(isinstance(v, float) for v in value):
            yield f.name, (float("nan"), *value[1:])


FOUND = composed()
CASES = [(name, key) for name in sorted(FOUND) if hasattr(vv, name) for key, _ in numbers(FOUND[name])]


MADE = [
    (name, f.name)
    for name, thing in sorted(FOUND.items())
    for f in dataclasses.fields(thing)
    if hasattr(vv, name) and f.init and isinstance(getattr(thing, f.name), Component | vv.Material | vv.Mesh)
]


@pytest.mark.parametrize(("name", "key"), MADE, ids=lambda text: text)
def test_no_component_material_or_mesh_is_made_of_a_mapping(name: str, key: str) -> None:
    """Of ``{}`` bases were made, past their constructors: a Contact of such, or NotImplementedError."""
    thing = FOUND[name]
    given = {f.name: getattr(thing, f.name) for f in dataclasses.fields(thing) if f.init}
    with pytest.raises(vv.InputError, match=rf"{name}.*: {key}: .*not \{{\}}"):
        type(thing)(**{**given, key: {}})


@pytest.mark.parametrize(("name", "key"), CASES, ids=lambda text: text)
def test_nothing_takes_numbers_that_are_none(name: str, key: str) -> None:
    thing = FOUND[name]
    given = {f.name: getattr(thing, f.name) for f in dataclasses.fields(thing) if f.init}
    spoiled = dict(numbers(thing))[key]
    with pytest.raises(ValueError, match=r"finite|nan|positive|number|range|between|greater|less"):
        type(thing)(**(given | {key: spoiled}))


def test_every_component_with_numbers_was_tried() -> None:
    tried = {name for name, _ in CASES}
    without = {n for n, c in language.components().items() if not {"float", "Number", "Vector3"} & words(c)}
    without |= {"Ground", "HeatTie"}  # whose only number is optional, see test_heat_ties
    assert set(language.components()) - without - NEEDS_CODE <= tried


def words(cls: type[Any]) -> set[str]:
    """Names of types in the annotations of the arguments."""
    return {
        w for f in dataclasses.fields(cls) for w in str(f.type).replace("|", " ").replace("[", " ").split()
    }
