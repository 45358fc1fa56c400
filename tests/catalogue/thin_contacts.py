"""Contact, ties and couplings of beams and shells."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

import visviva as vv
from catalogue.entry import ALL, ENERGY, IN_PLANE, MOMENTA, NOTHING, Components, Entry

RUBBER = vv.NeoHooke(young=200.0, poisson=0.3)
ROD = vv.TubeSection(radius=0.05, young=2e3, poisson=0.3, density=10.0)
SHEET = vv.HomogeneousSection(thickness=0.05, young=2e3, poisson=0.3, density=10.0)
STIFF_ROD = vv.TubeSection(radius=0.05, young=9e3, poisson=0.3, density=10.0)
STIFF_SHEET = vv.HomogeneousSection(thickness=0.05, young=2e4, poisson=0.3, density=10.0)
THROWN = (0.2, 0.1, -1.0)
PENALTY: dict[str, Any] = {"enforcement": "penalty"}
ELASTIC: dict[str, Any] = {**PENALTY, "friction": 0.3, "tangential": "penalty"}


def rod(*points: Any, count: int = 3, velocity: Any = THROWN, **options: Any) -> vv.Beam:
    given = {"section": ROD, "velocity": velocity, **options}
    return vv.Beam(mesh=vv.LineMesh(points=points, count=count), **given)


def sheet(z: float, velocity: Any = THROWN, section: Any = SHEET) -> vv.Shell:
    """A bent sheet that leans over."""
    flat = vv.RectangleMesh(size=(1.0, 0.8), counts=(2, 2)).build()
    x, y = flat.points.T
    points = [(a, b, z + 0.05 * a + 0.04 * a * b) for a, b in zip(x, y, strict=True)]
    return vv.Shell(mesh=vv.Mesh(points, flat.cells), section=section, velocity=velocity)


def block(size: float = 1.2, at: float = -0.3) -> vv.Solid:
    mesh = vv.BoxMesh(size=(size, size, 0.3), counts=(2, 2, 1), origin=(0.47 - size / 2, 0.37 - size / 2, at))
    return vv.Solid(mesh=mesh, material=RUBBER, density=5.0)


def sheet_on_block(**options: Any) -> Components:
    upper, lower = sheet(0.03, section=STIFF_SHEET), block()
    contact = vv.Contact(first=upper, second=lower, first_faces="lower", second_faces="z1", **options)
    return [lower, upper, contact]


def block_on_sheet(**options: Any) -> Components:
    upper, lower = block(0.5, 0.06), sheet(-0.04, velocity=(0.0, 0.0, 1.0))
    contact = vv.Contact(first=upper, second=lower, first_faces="z0", second_faces="upper", **options)
    return [lower, upper, contact]


def sheets(**options: Any) -> Components:
    upper, lower = sheet(0.06), sheet(0.0, velocity=(0.0, 0.0, 0.0))
    contact = vv.Contact(first=upper, second=lower, first_faces="lower", second_faces="upper", **options)
    return [lower, upper, contact]


def roof_on_block(kinks: Any, **options: Any) -> Components:
    """A folded sheet whose fold falls on a block."""
    flat = vv.RectangleMesh(size=(1.0, 0.8), counts=(4, 2)).build()
    x, y = flat.points.T
    points = np.column_stack([x, y, np.abs(x - 0.5) + 0.05 + 0.02 * y])
    upper = vv.Shell(mesh=vv.Mesh(points, flat.cells), section=SHEET, velocity=THROWN, kinks=kinks)
    lower = block()
    contact = vv.Contact(first=upper, second=lower, first_faces="lower", second_faces="z1", **options)
    return [lower, upper, contact]


def clip() -> Components:
    """A bent sheet whose legs are thrown together."""
    flat = vv.RectangleMesh(size=(1.8, 0.4), counts=(18, 1)).build()
    s = flat.points[:, 0] - 0.9
    turn = np.clip(s / 0.15, -np.pi / 2, np.pi / 2)
    leg = np.maximum(np.abs(s) - 0.15 * np.pi / 2, 0.0)
    points = np.column_stack([0.15 * np.cos(turn) - leg, flat.points[:, 1], 0.15 * np.sin(turn)])
    mesh = vv.Mesh(points, flat.cells)

    def closing(X: Any) -> Any:
        return 2.0 * X[:, [2]] * X[:, [0]] * (0, 0, 1)

    shell = vv.Shell(mesh=mesh, section=SHEET, velocity=closing)
    return [shell, vv.Contact(first=shell, first_faces="upper", formulation="node-to-segment", **PENALTY)]


def rod_on(other: Any, height: float = 0.06, section: Any = ROD, **options: Any) -> Components:
    bar = rod((0.0, 0.1, height), (1.0, 0.2, height + 0.05), section=section)
    part = other()
    return [part, bar, vv.Contact(first=bar, second=part, **options)]


def ball() -> vv.RigidBody:
    return vv.RigidBody(shape=vv.Sphere(radius=0.2), density=10.0, position=(0.5, 0.16, -0.2))


def rods(crossed: bool = True, **options: Any) -> Components:
    lower = rod((0.5, -0.5, 0), (0.45, 0.6, 0)) if crossed else rod((0.1, 0.02, 0), (1.2, 0.0, 0))
    lower.velocity = (0.0, 0.0, 0.0)
    upper = rod((0.0, 0.0, 0.11), (1.0, 0.1, 0.13))
    return [lower, upper, vv.Contact(first=upper, second=lower, **(PENALTY | options))]


def strips(**options: Any) -> Components:
    """A strip of a plane system that is thrown at another one."""
    section = vv.RectangleSection(width=1.0, height=0.05, young=2e3, density=10.0)
    lower = vv.PlaneBeam(
        mesh=vv.LineMesh(points=[(0, 0, 0), (1, 0, 0)], count=4, cell="line3"), section=section
    )
    across = vv.LineMesh(points=[(0.1, 0.07, 0), (0.8, 0.1, 0)], count=3, cell="line3")
    upper = vv.PlaneBeam(mesh=across, section=section, velocity=(0.2, -1.0, 0.0))
    return [lower, upper, vv.Contact(first=upper, first_faces="right", second=lower, **options)]


def hairpin() -> Components:
    """A bent strip of a plane system whose legs are thrown together."""
    s = np.linspace(-0.9, 0.9, 19)
    turn = np.clip(s / 0.15, -np.pi / 2, np.pi / 2)
    leg = np.maximum(np.abs(s) - 0.15 * np.pi / 2, 0.0)
    points = np.column_stack([0.15 * np.cos(turn) - leg, 0.15 * np.sin(turn), 0 * s])
    section = vv.RectangleSection(width=1.0, height=0.05, young=2e3, density=10.0)
    mesh = vv.Mesh(points, {"line2": [(i, i + 1) for i in range(18)]})
    strip = vv.PlaneBeam(
        mesh=mesh, section=section, velocity=lambda X: 2.0 * X[:, [1]] * X[:, [0]] * (0, 1, 0)
    )
    return [strip, vv.Contact(first=strip, first_faces="left", formulation="node-to-segment", **PENALTY)]


def coil(**options: Any) -> Components:
    """A helix that is pressed together."""
    mesh = vv.ArcMesh(radius=0.3, angle=8.8, rise=0.19, count=12)
    bar = vv.Beam(mesh=mesh, section=ROD, velocity=lambda X: -6.0 * X * (0, 0, 1))
    return [bar, vv.Contact(first=bar, **(PENALTY | options))]


def tied() -> Components:
    """A flying sheet with another one at its edge and a block under it."""
    section = vv.HomogeneousSection(thickness=0.05, young=2e3, poisson=0.3, density=10.0)
    one, two = (
        vv.Shell(
            mesh=vv.RectangleMesh(size=(0.5, 0.8), counts=(2, n), origin=(x, 0)),
            section=section,
            velocity=lambda X: 0.5 * X[:, [1, 0, 0]] * (0, 0, 1),
            angular_velocity=(0.3, 0.2, 0.1),
        )
        for x, n in ((0.0, 2), (0.5, 3))
    )
    mesh = vv.BoxMesh(size=(0.5, 0.8, 0.2), counts=(2, 2, 1), origin=(0, 0, -0.225))
    below = vv.Solid(mesh=mesh, material=RUBBER, density=5.0)
    edge = vv.Tie(first=two, first_faces="x0", second=one, second_faces="x1")
    glue = vv.Tie(first=below, first_faces="z1", second=one, second_faces="lower")
    return [one, two, below, edge, glue]


def hinged(coupling: Any) -> Components:
    """A body on a hinge at the edge of a sheet."""
    flat = vv.Shell(
        mesh=vv.RectangleMesh(size=(1.0, 0.8), counts=(2, 2)), section=SHEET, angular_velocity=(0.3, 0.5, 0.2)
    )
    edge = coupling(solid=flat, faces="x0")
    body = vv.RigidBody(shape=vv.Box(size=(0.4, 0.8, 0.1)), density=3.0, position=(-0.2, 0.4, 0.0))
    return [flat, edge, body, vv.Revolute(a=body, b=edge, at=(0, 0.4, 0), axis=(0, 1, 0))]


THIN_CONTACTS = [
    *(
        Entry(f"contact, {name}, {kind}", partial(make, **options), what, h=0.005, steps=40)
        for name, make in {"shell on solid": sheet_on_block, "solid on shell": block_on_sheet}.items()
        for kind, options, what in (
            ("penalty", PENALTY, ALL),
            ("conserving", {"impact": "conserving"}, ALL),
            ("node-to-segment", {**PENALTY, "formulation": "node-to-segment"}, ALL),
            ("rubbing", ELASTIC, MOMENTA),
        )
    ),
    *(
        Entry(
            f"contact, folded shell on solid, {kinks}",
            partial(roof_on_block, kinks, **PENALTY),
            ALL,
            0.005,
            40,
        )
        for kinks in ("rigid", "hinged")
    ),
    Entry(
        "contact, folded shell, conserving",
        partial(roof_on_block, "rigid", impact="conserving"),
        ALL,
        0.0025,
        40,
    ),
    Entry("contact, shell on shell", partial(sheets, **PENALTY), ALL, h=0.01, steps=20),
    Entry("contact, shell with itself", clip, ALL, 0.01, 80),
    Entry("contact, beam on plane", partial(rod_on, vv.Plane, **PENALTY), ENERGY, h=0.01, steps=20),
    Entry(
        "contact, beam on plane, rubbing",
        partial(rod_on, vv.Plane, tangential_stiffness=2e3, **ELASTIC),
        NOTHING,
        h=0.0025,
        steps=60,
    ),
    Entry("contact, beam on solid", partial(rod_on, block, second_faces="z1", **PENALTY), ALL, 0.01, 20),
    Entry(
        "contact, beam on solid, conserving",
        partial(rod_on, block, second_faces="z1", impact="conserving"),
        ALL,
        0.01,
        20,
    ),
    Entry(
        "contact, beam on solid, rubbing",
        partial(rod_on, block, second_faces="z1", **ELASTIC),
        MOMENTA,
        0.01,
        20,
    ),
    Entry(
        "contact, beam on ball, rubbing",
        partial(rod_on, ball, section=STIFF_ROD, **ELASTIC),
        MOMENTA,
        0.01,
        20,
    ),
    Entry(
        "contact, beam on shell",
        partial(rod_on, partial(sheet, 0.0, (0, 0, 0)), 0.13, second_faces="upper", **PENALTY),
        ALL,
        0.01,
        20,
    ),
    Entry("contact, beams that cross", rods, ALL, 0.01, 20),
    Entry("contact, beams side by side", partial(rods, crossed=False), ALL, 0.01, 20),
    Entry("contact, plane beams", partial(strips, **PENALTY), IN_PLANE, 0.005, 40),
    Entry("contact, plane beams, conserving", partial(strips, impact="conserving"), IN_PLANE, 0.005, 40),
    Entry("contact, plane beam with itself", hairpin, IN_PLANE, 0.01, 80),
    Entry("contact, beam with itself", coil, ALL, 0.01, 20),
    Entry("contact, beams that cross, rubbing", partial(rods, **ELASTIC), MOMENTA, 0.00125, 80),
    Entry(
        "contact, beams side by side, rubbing", partial(rods, crossed=False, **ELASTIC), MOMENTA, 0.0005, 120
    ),
    Entry("shells tied", tied, ALL, 0.005, 40),
    Entry("shell on a hinge, rigid edge", partial(hinged, vv.RigidCoupling), ALL, 0.005, 40),
    Entry("shell on a hinge, distributed", partial(hinged, vv.DistributedCoupling), ALL, 0.005, 40),
]
