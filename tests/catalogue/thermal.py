"""Heat: bodies that conduct, solids that deform as well, and what lets heat in."""

from __future__ import annotations

from functools import partial
from typing import Any, Literal

import numpy as np
from flow_parts import stream

import visviva as vv
from catalogue.entry import ALL, ENERGY, IN_PLANE, MOMENTA, NOTHING, Components, Entry

HEAT = vv.Heat(conductivity=0.5, capacity=0.2, expansion=0.005, reference=20.0, moduli_slope=0.02)
WARM = vv.Heat(conductivity=0.5, capacity=50.0, expansion=0.005, reference=20.0)


GENT = vv.Gent(shear=10.0, limit=40.0, bulk=30.0)


def slab(**options: Any) -> vv.ThermalBody:
    mesh = vv.RectangleMesh(size=(1.0, 0.5), counts=(3, 2), cell="quad9")
    given = {"conductivity": (2.0, 1.0, 1.0), "capacity_slope": 0.2, "conductivity_slope": 0.1, **options}
    return vv.ThermalBody(mesh=mesh, temperature=lambda X: 1 + X[:, 0] ** 2, **given)


def plain() -> Components:
    """Without functions of Python."""
    brick = vv.ThermoelasticSolid(
        mesh=vv.BoxMesh(size=(1, 0.8, 0.6), counts=(1, 1, 1)),
        material=vv.NeoHooke(lame_lambda=20.0, shear=10.0),
        density=1.0,
        heat=HEAT,
        temperature=22.0,
        angular_velocity=(0.3, 0.6, 1.0),
    )
    body = vv.ThermalBody(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), conductivity=2.0)
    beam = vv.ThermalBeam(
        mesh=vv.LineMesh(points=[(0, 0, 0), (1, 0.2, 0)], count=2),
        section=vv.RectangleSection(width=0.2, height=0.3, young=100.0, poisson=0.3, density=1.0),
        heat=WARM,
        temperature=22.0,
        slopes=(1.0, 2.0),
    )
    shell = vv.ThermalShell(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(1, 1)),
        section=vv.SolidSection(
            material=vv.NeoHooke(lame_lambda=20.0, shear=10.0), thickness=0.2, density=1.0
        ),
        heat=HEAT,
        difference=2.0,
    )
    creeping = vv.ThermoviscoelasticSolid(
        mesh=vv.BoxMesh(size=(1, 0.8, 0.6), counts=(1, 1, 1)),
        material=vv.NeoHooke(lame_lambda=20.0, shear=10.0),
        density=1.0,
        heat=HEAT,
        branches=vv.prony((0.5,), (0.3,), shift=vv.WLF(reference=20.0, c1=1.0, c2=30.0)),
        angular_velocity=(0.3, 0.6, 1.0),
    )
    return [
        brick,
        body,
        beam,
        shell,
        creeping,
        vv.HeatFlux(body=shell, faces="upper", flux="t"),
        vv.HeatFlux(body=shell, faces="lower", flux=-0.1),
        vv.HeatSource(body=beam, power=0.1),
        vv.PrescribedTemperature(body=beam, nodes="start", value=21.5),
        vv.Convection(body=brick, faces="x1", coefficient=0.2, ambient="23 + t"),
        vv.PrescribedTemperature(body=body, nodes="x0", value="1 + t"),
        vv.HeatSource(body=body, power="1 + 2*t"),
        vv.HeatFlux(body=body, faces="y0", flux="0.5*t"),
        vv.Radiation(body=body, faces="y1", emissivity=0.5, ambient=4.0, zero=-1.0, constant=0.01),
    ]


def warm_box() -> Components:
    """Without functions of Python: a lid stirs what a wall heats."""
    fluid = vv.Fluid(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(2, 2), cell="quad9"), density=1.3, viscosity=0.2
    )
    heat = vv.FluidHeat(fluid=fluid, conductivity=0.1, capacity=2.0, temperature=1.0, expansion=0.3)
    return [
        fluid,
        heat,
        vv.VelocityBoundary(fluid=fluid, faces="y1", velocity=("t**2", 0, 0)),
        *[vv.NoSlip(fluid=fluid, faces=side) for side in ("x0", "x1", "y0")],
        vv.PrescribedTemperature(body=heat, nodes="x0", value="1 + t"),
        vv.Gravity(acceleration=(0.0, -2.0, 0.0)),
    ]


TABLE = vv.Heat(
    conductivity=0.5,
    conductivity_slope=0.01,
    capacity=[(18.0, 0.15), (21.0, 0.2), (22.0, 0.4)],
    expansion=0.005,
    reference=20.0,
    moduli_slope=0.02,
)


def free_energy(C: Any, T: Any) -> Any:
    """Neo-Hookean rubber whose expansion and capacity depend on the temperature."""
    J2 = C[0] * (C[1] * C[2] - C[4] ** 2) - C[3] * (C[3] * C[2] - C[4] * C[5])
    J2 = J2 + C[5] * (C[3] * C[4] - C[1] * C[5])
    W = 5.0 * (C[0] + C[1] + C[2] - 3 - np.log(J2)) + 2.5 * np.log(J2) ** 2
    return W * T / 20 - 0.15 * (T - 20) * np.log(J2) - 0.2 * (T - 20) ** 2 / 20 * (1 + 0.1 * (T - 20) / 20)


def held_slab() -> Components:
    body = slab()
    return [body, vv.PrescribedTemperature(body=body, nodes="x0", value=0.5)]


def heated() -> Components:
    body = slab(capacity=[(0.5, 0.8), (1.2, 1.0), (1.6, 2.0)], capacity_slope=0.0)
    return [
        body,
        vv.PrescribedTemperature(body=body, nodes="x0", value="1 + 0.3*sin(5*t)"),
        vv.Convection(body=body, faces="x1", coefficient=2.0, ambient="3 + t"),
        vv.Radiation(body=body, faces="y1", emissivity=0.5, ambient=4.0, constant=0.01),
        vv.HeatSource(body=body, power=lambda t, X: t + X[:, 0]),
        vv.HeatFlux(body=body, faces="y0", flux="0.5*t"),
    ]


def brick(cell: str = "hex8", material: Any = None, **options: Any) -> vv.ThermoelasticSolid:
    mesh = vv.BoxMesh(size=(1, 0.8, 0.6), counts=(2, 1, 1), cell=cell)
    return vv.ThermoelasticSolid(
        mesh=mesh,
        material=material or vv.NeoHooke(lame_lambda=20.0, shear=10.0),
        density=1.0,
        temperature=lambda X: 20 + 3 * X[:, 0] ** 2,
        angular_velocity=(0.3, 0.6, 1.0),
        **{"heat": HEAT, **options},
    )


def sheet(cell: str = "quad4", plane: Any = "strain", **options: Any) -> vv.ThermoelasticSolid:
    return vv.ThermoelasticSolid(
        mesh=vv.RectangleMesh(size=(1, 0.8), counts=(2, 1), cell=cell, origin=(0.2, 0)),
        material=vv.NeoHooke(lame_lambda=20.0, shear=10.0),
        density=1.0,
        plane=plane,
        temperature=lambda X: 20 + 3 * X[:, 0] ** 2,
        velocity=lambda X: 0.5 * X[:, [1, 0, 2]],
        **{"heat": HEAT, **options},
    )


def users_brick() -> vv.ThermoelasticSolid:
    return vv.ThermoelasticSolid(
        mesh=vv.BoxMesh(size=(1, 0.8, 0.6), counts=(1, 1, 1)),
        heat=vv.UserHeat(function=free_energy, conductivity=0.5, reference=20.0),
        density=1.0,
        temperature=lambda X: 20 + 3 * X[:, 0] ** 2,
        angular_velocity=(0.3, 0.6, 1.0),
    )


def heated_brick() -> Components:
    body = brick()
    return [
        body,
        vv.PrescribedTemperature(body=body, nodes="x0", value="20 + 0.3*sin(5*t)"),
        vv.Convection(body=body, faces="x1", coefficient=0.2, ambient="23 + t"),
        vv.Radiation(body=body, faces="y1", emissivity=0.5, ambient=24.0, constant=1e-6),
        vv.HeatFlux(body=body, faces="y0", flux="0.5*t"),
    ]


def warm_stream(cell: str, **options: Any) -> Components:
    """Through a channel, lifted and heated by viscosity, past a source and a wall that exchanges heat."""
    dimension = 3 if cell in ("hex8", "tet4", "hex27", "tet10") else 2
    fluid, *conditions = stream(cell)
    given = {"conductivity": 0.05, "capacity": 2.0, "viscous_heating": True, "capturing": 0.3, **options}
    heat = vv.FluidHeat(fluid=fluid, temperature=lambda X: 1 + X[:, 0] * X[:, 1], **given)
    return [
        fluid,
        heat,
        *conditions,
        vv.PrescribedTemperature(body=heat, nodes="x0", value="1 + 0.3*sin(5*t)"),
        vv.Convection(body=heat, faces="y1", coefficient=0.2, ambient="3 + t"),
        vv.HeatSource(body=heat, power=lambda t, X: t + X[:, 0]),
        vv.Gravity(acceleration=(0.5, -2.0, 0.0) if dimension == 2 else (0.5, -2.0, 0.3)),
    ]


def tied(*kinds: str, conductance: float | None = None) -> Components:
    """Two bodies that stand still, or deform, beside each other with other meshes."""
    parts: Components = []
    for number, kind in enumerate(kinds):
        mesh = vv.BoxMesh(size=(1, 1, 1), counts=(1, 2 - number, 1), origin=(number, 0, 0))
        if kind == "body":
            parts.append(vv.ThermalBody(mesh=mesh, conductivity=2.0, temperature=20.0 + number))
        else:
            material = vv.NeoHooke(lame_lambda=20.0, shear=10.0)
            solid = vv.ThermoelasticSolid(
                mesh=mesh, material=material, density=1.0, heat=HEAT, temperature=21.0 - number
            )
            parts.append(solid)
    first, second = parts
    tie = vv.HeatTie(first=first, first_faces="x1", second=second, second_faces="x0", conductance=conductance)
    return [first, second, tie, vv.HeatFlux(body=first, faces="x0", flux="3 + t")]


def linked() -> Components:
    """A bolt between a solid that deforms and a body that does not, a coupling between two solids."""
    first, body, _, flux = tied("solid", "body")
    other = vv.ThermoelasticSolid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1), origin=(0, 3, 0)),
        material=vv.NeoHooke(lame_lambda=20.0, shear=10.0),
        density=1.0,
        heat=HEAT,
        temperature=22.0,
        angular_velocity=(0.1, 0.4, 0.2),
    )
    bolt = vv.HeatExchange(a=first, at_a=(1, 0.3, 0.4), b=body, faces_b="x0", conductance=0.3)
    strap = vv.HeatExchange(a=first, faces_a="y1", b=other, faces_b="y0", conductance=0.2)
    return [first, body, other, flux, bolt, strap]


def faced_shells() -> Components:
    """Heat through the sides of two shells: from a rigid body, from one to the other, and to what is around."""
    grid = vv.RectangleMesh(size=(1, 1), counts=(1, 1)).build()
    shells = [
        vv.ThermalShell(
            mesh=vv.Mesh(
                np.column_stack([grid.points[:, :2], np.full(4, z)]), grid.cells, face_sets=grid.face_sets
            ),
            section=vv.SolidSection(
                material=vv.NeoHooke(lame_lambda=20.0, shear=10.0), thickness=0.2, density=1.0, points=points
            ),
            profile=profile,
            heat=HEAT,
            temperature=20.0 + 10 * z,
            difference=2.0,
            angular_velocity=(0.1, 0.4, 0.2),
        )
        for z, profile, points in ((0.0, "linear", 2), (0.2, "quadratic", 3))
    ]
    wall = vv.ThermalBody(
        mesh=vv.BoxMesh(size=(1, 1, 0.5), counts=(1, 1, 1), origin=(0, 0, -0.5)),
        conductivity=1.0,
        capacity=2.0,
        temperature=25.0,
    )
    lower, upper = shells
    return [
        wall,
        *shells,
        vv.HeatTie(first=lower, first_faces="lower", second=wall, second_faces="z1"),
        vv.HeatTie(
            first=lower,
            first_faces="upper",
            second=upper,
            second_faces="lower",
            conductance=0.5,
            reach=0.3,
        ),
        vv.HeatExchange(a=lower, faces_a="upper", b=upper, faces_b="upper", conductance=0.3),
        vv.HeatExchange(a=upper, faces_a="upper", ambient="20 + t", conductance=0.4),
    ]


def bathed() -> Components:
    """A warm cube in a fluid that flows through a box."""
    fluid = vv.Fluid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2)), density=1.0, viscosity=0.5)
    heat = vv.FluidHeat(fluid=fluid, conductivity=0.1, capacity=1.0, temperature=20.0, expansion=0.05)
    mesh = vv.BoxMesh(size=(0.3, 0.3, 0.3), counts=(1, 1, 1), origin=(0.3, 0.35, 0.4))
    material = vv.NeoHooke(lame_lambda=20.0, shear=10.0)
    cube = vv.ThermoelasticSolid(mesh=mesh, material=material, density=2.0, heat=HEAT, temperature=23.0)
    immersed = vv.Immersed(solid=cube, fluid=fluid)
    cooling = vv.ImmersedHeat(immersed=immersed, heat=heat, conductance=0.5)
    down = vv.Gravity(acceleration=(0.3, -1.0, 0.2))
    return [fluid, heat, cube, immersed, cooling, vv.NoSlip(fluid=fluid, faces="all"), down]


def sunk() -> Components:
    """A warm rigid box in a fluid."""
    fluid = vv.Fluid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2)), density=1.0, viscosity=0.5)
    heat = vv.FluidHeat(fluid=fluid, conductivity=0.1, capacity=1.0, temperature=20.0, expansion=0.05)
    shape = vv.Box(size=(0.3, 0.35, 0.4))
    box = vv.RigidBody(shape=shape, density=2.0, position=(0.45, 0.5, 0.55))
    wet, store = (
        vv.ImmersedBody(body=box, fluid=fluid),
        vv.HeatStore(capacity=4.0, temperature=23.0, reference=20.0),
    )
    cooling = vv.ImmersedHeat(immersed=wet, heat=heat, conductance=0.5, store=store)
    down = vv.Gravity(acceleration=(0.3, -1.0, 0.2))
    return [fluid, heat, box, wet, store, cooling, vv.NoSlip(fluid=fluid, faces="all"), down]


def thin_sunk(kind: str) -> Components:
    """A warm shell or beam in a fluid."""
    fluid = vv.Fluid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2)), density=1.0, viscosity=0.5)
    heat = vv.FluidHeat(fluid=fluid, conductivity=0.1, capacity=1.0, temperature=20.0)
    body: Any
    if kind == "shell":
        grid = vv.RectangleMesh(size=(0.5, 0.4), counts=(1, 1), origin=(0.2, 0.3)).build()
        X = np.column_stack([grid.points[:, :2], 0.4 + 0.2 * grid.points[:, 0]])
        section = vv.SolidSection(
            material=vv.NeoHooke(lame_lambda=20.0, shear=10.0), thickness=0.1, density=2.0
        )
        mesh = vv.Mesh(X, grid.cells, face_sets=grid.face_sets)
        body = vv.ThermalShell(mesh=mesh, section=section, heat=HEAT, temperature=23.0)
    else:
        strip = vv.RectangleSection(width=0.2, height=0.5, young=10.0, density=2.0)
        mesh = vv.LineMesh(points=[(0.2, 0.4, 0.5), (0.8, 0.5, 0.6)], count=2, cell=kind)
        plain = vv.Heat(conductivity=0.5, capacity=2.0, expansion=0.005, reference=20.0)
        body = vv.ThermalBeam(mesh=mesh, section=strip, heat=plain, temperature=23.0)
    wet = vv.ImmersedThin(body=body, fluid=fluid, displaced=0.1)
    cooling = vv.ImmersedHeat(immersed=wet, heat=heat, conductance=0.5)
    down = vv.Gravity(acceleration=(0.3, -1.0, 0.2))
    return [fluid, heat, body, wet, cooling, vv.NoSlip(fluid=fluid, faces="all"), down]


def ball_rubs(**options: Any) -> Components:
    """A rigid ball that rubs and turns on a warm solid, which takes all heat."""
    block = vv.ThermoelasticSolid(
        mesh=vv.BoxMesh(size=(1, 1, 0.5), counts=(1, 1, 1)),
        material=vv.NeoHooke(lame_lambda=20.0, shear=10.0),
        density=1.0,
        heat=HEAT,
        temperature=22.0,
    )
    ball = vv.RigidBody(
        shape=vv.Sphere(radius=0.2),
        density=2.0,
        position=(0.4, 0.45, 0.699),
        velocity=(0.5, 0.1, -0.3),
        angular_velocity=(0.3, 0.6, 1.0),
    )
    given: Any = {"initial": "press", "enforcement": "penalty", "friction": 0.3, **options}
    contact = vv.Contact(first=ball, second=block, second_faces="z1", **given)
    return [block, ball, contact, vv.HeatContact(contact=contact)]


def touching(conductance: Any = 2.0, **options: Any) -> Components:
    """Two solids, one hot, that touch and slide on each other."""
    solids = [
        vv.ThermoelasticSolid(
            mesh=vv.BoxMesh(size=(1.2, 1, 0.5), counts=(2 - k, 1, 1), origin=(0.1 * k, 0, 0.499 * k)),
            material=vv.NeoHooke(lame_lambda=20.0, shear=10.0),
            density=1.0,
            heat=HEAT,
            temperature=20.0 + 2 * k,
            velocity=(0.5 * k, 0.1 * k, -0.3 * k),
        )
        for k in range(2)
    ]
    given: Any = {"initial": "press", "enforcement": "penalty", **options}
    contact = vv.Contact(first=solids[0], first_faces="z1", second=solids[1], second_faces="z0", **given)
    heat = vv.HeatContact(contact=contact, conductance=conductance, share=0.3)
    return [*solids, contact, heat]


GROWING = [(0.0, 0.0), (1e4, 1e4)]
RUBS: Any = {"friction": 0.3, "tangential": "penalty"}


def beam(cell: str) -> Components:
    return [
        vv.ThermalBeam(
            mesh=vv.LineMesh(points=[(0, 0, 0), (1, 0.2, 0)], count=2, cell=cell),
            section=vv.RectangleSection(width=0.2, height=0.3, young=100.0, poisson=0.3, density=1.0),
            heat=WARM,
            temperature=lambda X: 20 + 3 * X[:, 0] ** 2,
            slopes=(5.0, -8.0),
            angular_velocity=(0.3, 0.6, 1.0),
        )
    ]


def shell(profile: Literal["linear", "quadratic"] = "linear", points: int = 2) -> Components:
    material = vv.NeoHooke(lame_lambda=20.0, shear=10.0)
    return [
        vv.ThermalShell(
            mesh=vv.RectangleMesh(size=(1, 1), counts=(2, 1)),
            section=vv.SolidSection(material=material, thickness=0.2, density=1.0, points=points),
            profile=profile,
            heat=HEAT,
            temperature=lambda X: 20 + 3 * X[:, 0] ** 2,
            difference=lambda X: 2 + X[:, 1],
            angular_velocity=(0.3, 0.6, 1.0),
        )
    ]


def springs() -> Components:
    """Between a rigid body, the ground and balls, with dampers, exchange of heat and a motor."""
    ground, box = vv.Ground(), vv.RigidBody(mass=1.0, inertia=(0.1, 0.2, 0.15), angular_velocity=(1, 2, 3))
    ball = vv.PointMass(mass=0.5, position=(1.2, 0.3, 0), velocity=(0, 1, 0))
    common: dict[str, Any] = {"stiffness": 20.0, "expansion": 0.002, "reference": 20.0, "moduli_slope": 0.01}
    first = vv.ThermalSpring(
        a=ground.point((0, 0, 1)),
        b=box.point((0.2, 0.1, 0)),
        capacity=0.3,
        temperature=23.0,
        damping=0.5,
        **common,
    )
    second = vv.ThermalSpring(
        a=box.point((-0.1, 0.2, 0.1)), b=ball, capacity=0.2, law="logarithmic", free_length=1.0, **common
    )
    motor = vv.HeatStore(capacity=0.4, temperature=25.0, reference=20.0, body=box)
    links = [
        vv.HeatExchange(a=first, b=second, conductance=0.1),
        vv.HeatExchange(a=motor, b=first, conductance=0.2),
    ]
    return [ground, box, ball, first, second, motor, *links]


def exchanging() -> Components:
    block, still = (
        brick(),
        vv.ThermalBody(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), conductivity=1.0, temperature=18.0),
    )
    return [
        block,
        still,
        vv.HeatExchange(a=still, nodes_a="x1", b=block, nodes_b="x0", conductance=0.3),
        vv.HeatExchange(a=block, nodes_a="x1", conductance=0.2, ambient="20 + t"),
    ]


THERMAL = [
    Entry("thermal body, held", held_slab, NOTHING, steps=30),
    Entry("heat without functions", plain, NOTHING, steps=30),
    *[
        Entry(
            f"heat from {a} to {b}{', jump' * bool(c)}", partial(tied, a, b, conductance=c), NOTHING, steps=20
        )
        for a, b in (("body", "body"), ("solid", "solid"), ("body", "solid"))
        for c in (None, 2.0)
    ],
    Entry("warm cube in a fluid", bathed, NOTHING, h=0.02, steps=10),
    Entry("warm rigid box in a fluid", sunk, NOTHING, h=0.02, steps=10),
    *[
        Entry(f"warm {kind} in a fluid", partial(thin_sunk, kind), NOTHING, h=0.02, steps=10)
        for kind in ("shell", "line2", "line3")
    ],
    Entry("heat links", linked, NOTHING, steps=20),
    Entry("heat through sides of shells", faced_shells, NOTHING, h=0.01, steps=20),
    *[
        Entry(f"warm contact, {name}", partial(touching, **options), MOMENTA, h=0.01, steps=20)
        for name, options in (
            ("penalty", {}),
            ("multipliers", {"enforcement": "multipliers"}),
            ("rubbing", RUBS),
            ("sticking", {"enforcement": "multipliers", "friction": 0.3}),
            ("by vertices", {**RUBS, "formulation": "node-to-segment"}),
            ("penalty, by pressure", {"conductance": GROWING}),
            ("rubbing, by pressure", {**RUBS, "conductance": GROWING}),
            (
                "sticking, by pressure",
                {"enforcement": "multipliers", "friction": 0.3, "conductance": GROWING},
            ),
        )
    ],
    *[
        Entry(
            f"ball that rubs on a warm solid, {name}",
            partial(ball_rubs, **options),
            MOMENTA,
            h=0.01,
            steps=20,
        )
        for name, options in (
            ("penalty", {"tangential": "penalty"}),
            ("multipliers", {"enforcement": "multipliers"}),
        )
    ],
    Entry("warm box without functions", warm_box, NOTHING, steps=20),
    Entry("thermal body, heated", heated, NOTHING, steps=30),
    *[
        Entry(f"warm stream, {cell}", partial(warm_stream, cell, **options), NOTHING, h=0.05, steps=20)
        for cell, options in (
            ("quad4", {"expansion": 0.3}),
            ("tri3", {"expansion": 0.3}),
            ("quad9", {"expansion": 0.3}),
            ("tri6", {"expansion": 0.3}),
            ("hex8", {"expansion": 0.3}),
            ("tet10", {"expansion": 0.3}),
        )
    ],
    Entry("thermoelastic brick", lambda: [brick()], ALL, steps=40),
    Entry("thermoelastic brick, tet10", lambda: [brick("tet10")], ALL, steps=20),
    Entry("thermoelastic brick, gent", lambda: [brick(material=GENT)], ALL, steps=30),
    Entry("thermal beam", lambda: beam("line2"), ALL, steps=30),
    Entry("thermal beam, line3", lambda: beam("line3"), ALL, steps=30),
    Entry("thermal shell", shell, ALL, h=0.01, steps=20),
    Entry("thermal shell, quadratic", partial(shell, "quadratic", 3), ALL, h=0.01, steps=20),
    Entry("thermal springs", springs, ENERGY, steps=100),
    Entry("bodies that exchange heat", exchanging, NOTHING, steps=30),
    Entry("thermoelastic brick, table", lambda: [brick(heat=TABLE)], ALL, steps=30),
    Entry("thermoelastic brick, enhanced", lambda: [brick(formulation="enhanced")], ALL, h=0.01, steps=30),
    Entry("thermoelastic brick, F-bar", lambda: [brick(formulation="F-bar")], ALL, h=0.01, steps=30),
    Entry(
        "thermoelastic brick, mixed", lambda: [brick(formulation="mixed", heat=TABLE)], ALL, h=0.01, steps=30
    ),
    Entry("thermoelastic brick, mixed hex27", lambda: [brick("hex27", formulation="mixed")], ALL, steps=10),
    Entry("thermoelastic brick, mixed tet10", lambda: [brick("tet10", formulation="mixed")], ALL, steps=20),
    Entry("thermoelastic brick, user's", lambda: [users_brick()], ALL, steps=10, analytic=False),
    Entry("thermoelastic brick, heated", heated_brick, NOTHING, steps=30),
    *[
        Entry(
            f"thermoelastic sheet, {cell}, {kind}",
            partial(lambda **o: [sheet(**o)], cell=cell, formulation=kind),
            IN_PLANE,
            h=0.01,
            steps=20,
        )
        for cell, kind in (
            ("tri6", "displacement"),
            ("quad4", "enhanced"),
            ("quad4", "F-bar"),
            ("quad9", "mixed"),
        )
    ],
    Entry("thermoelastic sheet, plane stress", lambda: [sheet(plane="stress")], IN_PLANE, h=0.01, steps=20),
    *[
        Entry(
            f"thermoelastic ring, {kind}",
            partial(lambda **o: [sheet("quad4", "axisymmetric", **o)], formulation=kind),
            ENERGY,
            h=0.01,
            steps=20,
        )
        for kind in ("displacement", "F-bar", "mixed")
    ],
]
