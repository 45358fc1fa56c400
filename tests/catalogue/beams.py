"""Beams and shells: elements, shapes, sections, joints."""

from __future__ import annotations

from typing import Any

import numpy as np

import visviva as vv
from catalogue.entry import ALL, ENERGY, IN_PLANE, MOMENTA, NOTHING, Components, Entry
from visviva.mesh.faces import Faces

SQUARE = vv.GivenSection(stiffness=(200, 180, 300, 5, 4, 3), mass=1.0, moments=(0.03, 0.02, 0.0))
C = np.diag([200.0, 180, 300, 5, 4, 3])
C[2, 3] = C[3, 2] = 8.0
C[0, 5] = C[5, 0] = 4.0
VISCOUS = vv.GivenSection(
    stiffness=C, damping=0.02 * C, mass=1.0, centre=(0.05, -0.03), moments=(0.03, 0.02, 0.004)
)
BLADE = vv.GivenSection(stiffness=C, mass=1.0, centre=(0.05, -0.03), moments=(0.03, 0.02, 0.004))
HELIX = {"radius": 1.0, "angle": 2.0, "rise": 0.5}
CORNER = vv.Mesh([(0, 0, 0), (1, 0, 0), (1, 1, 0), (2, 0, 0.3)], {"line2": [(0, 1), (1, 2), (1, 3)]})


def swaying(x: Any) -> Any:
    return 0.4 * np.sin(2.0 * x[:, ::-1] + 1.0)


def flying(mesh: Any, section: vv.CrossSection = SQUARE, **options: Any) -> Components:
    """A beam that tumbles freely and swings."""
    moving = {"velocity": swaying, "angular_velocity": (0.3, 0.6, 1.0)}
    return [vv.Beam(mesh=mesh, section=section, **moving, **options)]


def stiffening(e: Any) -> Any:
    """Energy of what stiffens as it is stretched and bent."""
    return 0.5 * (C.diagonal() @ (e * e)) * (1 + 4 * e[2] ** 2 + 0.2 * e[3] * e[3])


def twisted() -> Components:
    """A clamped beam turned at its end."""
    beam, clamp = held(vv.Clamped, count=6)
    return [beam, clamp, vv.SemitangentialTorque(on=beam.frame(2.0), torque=(0.5, 1.0, 0.3))]


def heated() -> Components:
    """A clamped beam that curls and grows as it is heated."""
    beam, clamp = held(vv.Clamped)
    return [beam, clamp, vv.ThermalStrain(beam=beam, extension=0.05, curvature=(0.1, 0.2), times="sin(3*t)")]


def panel(**options: Any) -> Components:
    """A twisted panel of unsymmetric plies that tumbles and swings."""
    flat = vv.RectangleMesh(size=(1.0, 0.8), counts=(2, 2)).build()
    x, y = flat.points.T
    mesh = vv.Mesh(np.stack([x, y, 0.2 * x * x + 0.1 * x * y], axis=1), flat.cells, face_sets=flat.face_sets)
    plies = tuple(
        vv.Ply(thickness=0.02, young=2e3, across=500.0, poisson=0.3, shear=400.0, angle=angle, density=10.0)
        for angle in (0, 30, 90)
    )
    section = vv.Laminate(plies=plies, offset=0.01)
    return [vv.Shell(mesh=mesh, section=section, first=(1, 0, 0), **options)]


def sheet_of(cell: Any, **options: Any) -> Components:
    """A curved sheet of some type of cells that tumbles and swings."""
    flat = vv.RectangleMesh(size=(1.0, 0.8), counts=(2, 1), cell=cell).build()
    x, y = flat.points.T
    mesh = vv.Mesh(np.stack([x, y, 0.2 * x * x + 0.1 * x * y], axis=1), flat.cells, face_sets=flat.face_sets)
    section = vv.HomogeneousSection(thickness=0.05, young=2e3, poisson=0.3, density=10.0, offset=0.01)
    moving = {"velocity": swaying, "angular_velocity": (0.3, 0.6, 1.0)}
    return [vv.Shell(mesh=mesh, section=section, **(moving | options))]


def star(kinks: Any) -> Components:
    """Three panels that meet in a line, of quadrilaterals and triangles."""
    points = [
        (0, 0, 0),
        (0, 0, 1),
        *((x, y, z) for x, y in ((1, 0), (-0.6, 0.8), (-0.5, -0.9)) for z in (0, 1)),
    ]
    cells = {"quad4": [(0, 2, 3, 1), (0, 4, 5, 1)], "tri3": [(0, 6, 7), (0, 7, 1)]}
    section = vv.HomogeneousSection(thickness=0.05, young=2e3, poisson=0.3, density=10.0)
    moving = {"velocity": swaying, "angular_velocity": (0.3, 0.6, 1.0)}
    return [vv.Shell(mesh=vv.Mesh(points, cells), section=section, kinks=kinks, **moving)]


def bent_sheet() -> Components:
    """A hanging sheet with a moment at its end."""
    section = vv.HomogeneousSection(thickness=0.05, young=2e3, poisson=0.3, density=10.0)
    shell = vv.Shell(mesh=vv.RectangleMesh(size=(1.0, 0.8), counts=(2, 1), cell="quad9"), section=section)
    edge = vv.Clamped(solid=shell, nodes="x0")
    return [shell, edge, vv.EdgeMoment(shell=shell, edges="x1", moment=(0.003, -0.01, 0.0), times="sin(3*t)")]


def hinged_moment() -> Components:
    """Three hinged panels, one of them bent at the hinge alone."""
    shell = star("hinged")[0]
    edge = Faces({"line2": np.array([[1, 0]])}, {"line2": np.array([1])})
    return [shell, vv.EdgeMoment(shell=shell, edges=edge, moment=(0.0, 0.0, 0.01), times="sin(3*t)")]


TISSUE = vv.HolzapfelGasserOgden(
    shear=300.0, k1=200.0, k2=1.5, bulk=3e3, fibres=((1, 0.6, 0), (1, -0.6, 0)), dispersion=0.1
)
GEL = vv.NeoHooke(shear=400.0, bulk=4e4, isochoric=True)


def stretching(section: Any, **options: Any) -> Components:
    """The panel with directors that stretch."""
    shell = panel()[0]
    motion: Any = {"velocity": swaying, "angular_velocity": (0.3, 0.6, 1.0)}
    options.setdefault("mesh", shell.mesh)
    return [vv.ExtensibleShell(section=section, first=(1, 0, 0), **motion, **options)]


def tissue() -> Any:
    """Of a tissue on a gel, above the mesh."""
    layers = [(TISSUE, 0.03, 20.0), (GEL, 0.04, 0.0)]
    made = [vv.SolidLayer(material=m, thickness=t, angle=a, density=10.0) for m, t, a in layers]
    return vv.SolidLaminate(layers=tuple(made), offset=0.01)


def ballooned(bulk: float) -> Components:
    """A rubber panel of a pressure in each cell."""
    rubber = vv.MooneyRivlin(c10=150.0, c01=50.0, bulk=bulk, isochoric=True)
    section = vv.SolidSection(material=rubber, thickness=0.06, density=10.0)
    return stretching(section, formulation="mixed")


def stretched_star(kinks: Any) -> Components:
    """The three panels, of tissue on a gel."""
    return stretching(tissue(), mesh=star(kinks)[0].mesh, kinks=kinks)


def bent_tissue() -> Components:
    """Layers of tissue that hang at an edge, with a moment at the other."""
    shell = vv.ExtensibleShell(mesh=vv.RectangleMesh(size=(1.0, 0.8), counts=(2, 2)), section=tissue())
    edge = vv.Clamped(solid=shell, nodes="x0")
    return [shell, edge, vv.EdgeMoment(shell=shell, edges="x1", moment=(0.003, -0.01, 0.0), times="sin(3*t)")]


def blown_tissue(middle: bool) -> Components:
    """Layers of tissue that hang at an edge and are blown at."""
    shell = vv.ExtensibleShell(mesh=vv.RectangleMesh(size=(1.0, 0.8), counts=(2, 2)), section=tissue())
    edge = vv.Clamped(solid=shell, nodes="x0")
    blow = vv.Pressure(solid=shell, faces="upper", pressure="0.5*sin(3*t)", middle=middle)
    return [shell, edge, vv.Gravity(), blow]


def folded() -> Components:
    """A folded sheet with pressures and tractions on its sides."""
    section = vv.HomogeneousSection(thickness=0.05, young=2e3, poisson=0.3, density=10.0)
    places = [(0, 0, 0), (0.6, 0, 0), (0.6, 0, 0.5), (0, 0.4, 0), (0.6, 0.4, 0), (0.6, 0.4, 0.5)]
    mesh = vv.Mesh(places, {"quad4": [(0, 1, 4, 3), (1, 2, 5, 4)]})
    shell = vv.Shell(mesh=mesh, section=section, kinks="rigid")
    return [
        shell,
        vv.Clamped(solid=shell, nodes=[0, 3]),
        vv.Pressure(solid=shell, faces="lower", pressure="0.5*sin(3*t)"),
        vv.Pressure(solid=shell, faces="upper", pressure="0.3*cos(2*t)", follower=False),
        vv.Traction(solid=shell, faces="upper", traction=lambda t, X: 0.2 * t * X),
    ]


def clamped_panel() -> Components:
    """A plate that hangs at an edge and is blown at."""
    section = vv.HomogeneousSection(thickness=0.05, young=1e5, poisson=0.3, density=10.0)
    shell = vv.Shell(mesh=vv.RectangleMesh(size=(1.0, 0.8), counts=(2, 2)), section=section)
    edge = vv.Clamped(solid=shell, nodes="x0")
    return [shell, edge, vv.Gravity(), vv.Pressure(solid=shell, faces="upper", pressure="0.5*sin(3*t)")]


def held(support: Any, count: int = 3) -> Components:
    beam = vv.Beam(mesh=vv.ArcMesh(count=count, **HELIX), section=BLADE, velocity=(0.0, 0.4, 0.3))
    return [beam, support(solid=beam, nodes="start")]


def loaded() -> Components:
    """A clamped beam with a line load that turns along and moments."""
    beam, clamp = held(vv.Clamped)
    return [
        beam,
        clamp,
        vv.LineLoad(beam=beam, force=(0.3, 0.2, 0.1), moment=(0.02, 0.01, 0.03), follower=True),
    ]


def bent(count: int) -> vv.Mesh:
    """Three straight parts of so many cells each."""
    corners = np.array([(0, 0, 0), (0.8, 0.3, 0), (1.5, 0, 0), (1.5, -1, 0)])
    at = np.linspace(0, 3, 3 * count + 1)
    points = np.stack([np.interp(at, range(4), c) for c in corners.T], axis=1)
    return vv.Mesh(points, {"line2": [(k, k + 1) for k in range(3 * count)]})


BENT = bent(1)
FLAT_BLADE = vv.GivenSection(
    stiffness=np.diag([30.0, 300.0, 500.0, 4.0, 6.0, 2.0])
    + np.diag([0.0, 20.0, -5.0, 0.0, 0.0], 1)
    + np.diag([0.0, 20.0, -5.0, 0.0, 0.0], -1),
    mass=1.5,
    centre=(0.0, 0.05),
    moments=(0.02, 0.03, 0.0),
)
"""Strains in the plane couple with each other alone."""


def flat(mesh: Any = BENT, **options: Any) -> Components:
    """A beam of a plane system in free flight."""
    motion: Any = {"velocity": (0.3, -0.2, 0), "angular_velocity": (0, 0, 1.5)}
    return [vv.PlaneBeam(mesh=mesh, section=FLAT_BLADE, kinks="rigid", **motion, **options)]


def flat_pendulum() -> Components:
    """A beam of a plane system on a hinge, with another at each corner, and loads that follow."""
    beam, ground = vv.PlaneBeam(mesh=bent(5), section=FLAT_BLADE, kinks="hinged"), vv.Ground()
    return [
        ground,
        beam,
        vv.Revolute(a=ground, b=beam, at=(0, 0, 0), axis=(0, 0, 1)),
        vv.LineLoad(beam=beam, force=(0, 0.2, 0.1), moment=(0.1, 0, 0), follower=True),
        vv.Gravity(acceleration=(0, -9.81, 0)),
    ]


def jointed() -> Components:
    """A rigid body on a hinge in the middle of a cell of a beam that hangs on a ball joint."""
    beam = vv.Beam(mesh=vv.LineMesh(points=[(0, 0, 0), (2, 0, 0)], count=7), section=BLADE)
    body = vv.RigidBody(shape=vv.Box(size=(0.4, 0.2, 0.6)), density=5.0, position=(1.0, 0, -0.3))
    hinge = vv.Revolute(a=beam, b=body, at=(1.0, 0, 0), axis=(1, 0, 0))
    ground = vv.Ground()
    ball = vv.Spherical(a=ground, b=beam, at=(0, 0, 0))
    return [ground, beam, body, hinge, ball, vv.Gravity(acceleration=(0, 0, -9.81))]


BEAMS = [
    Entry("beam, line2", lambda: flying(vv.LineMesh(points=[(0, 0, 0), (2, 1, 0)], count=3)), ALL, steps=100),
    Entry(
        "beam, line3, helix",
        lambda: flying(vv.ArcMesh(count=2, cell="line3", **HELIX), BLADE),
        ALL,
        steps=100,
    ),
    Entry("beam, line4", lambda: flying(vv.ArcMesh(count=1, cell="line4", **HELIX), BLADE), ALL, steps=100),
    Entry("beam, damped", lambda: flying(vv.ArcMesh(count=3, **HELIX), VISCOUS), MOMENTA, steps=100),
    Entry(
        "beam, energy of the user",
        lambda: flying(
            vv.LineMesh(points=[(0, 0, 0), (2, 1, 0)], count=2),
            vv.UserSection(energy=stiffening, section=SQUARE),
        ),
        ALL,
        steps=30,
        analytic=False,
    ),
    Entry(
        "beam, rigid in shear and stretch",
        lambda: flying(vv.ArcMesh(count=3, **HELIX), BLADE, rigid=("shear", "stretch")),
        ALL,
        steps=100,
    ),
    Entry("beam, heated", heated, NOTHING, steps=100),
    Entry("beam with a branch", lambda: flying(CORNER, BLADE, kinks="rigid"), ALL, steps=100),
    Entry("beam with a semitangential torque", twisted, NOTHING, steps=100),
    Entry("beam with hinges", lambda: flying(CORNER, BLADE, kinks="hinged"), ALL, steps=100),
    Entry("beam, clamped", lambda: held(vv.Clamped), ENERGY, steps=100),
    Entry("beam, fixed", lambda: held(vv.Fixed), ENERGY, steps=100),
    Entry("beam with a line load", loaded, NOTHING, steps=100),
    Entry("shell", lambda: panel(velocity=swaying, angular_velocity=(0.3, 0.6, 1.0)), ALL, steps=60),
    *(
        Entry(f"shell, {cell}", lambda cell=cell: sheet_of(cell), ALL, steps=60)
        for cell in ("quad9", "tri3", "tri6")
    ),
    Entry(
        "shell of enhanced membrane",
        lambda: panel(velocity=swaying, angular_velocity=(0.3, 0.6, 1.0), membrane="enhanced"),
        ALL,
        steps=60,
    ),
    Entry("shell of three panels, rigid", lambda: star("rigid"), ALL, steps=60),
    Entry("shell of three panels, hinged", lambda: star("hinged"), ALL, steps=60),
    Entry("shell with a moment at its edge", bent_sheet, NOTHING, h=0.01, steps=60),
    Entry("shell with a moment at a hinge", hinged_moment, NOTHING, h=0.01, steps=60),
    Entry("shell of tissue with a moment at its edge", bent_tissue, NOTHING, h=0.01, steps=60),
    Entry("shell under pressure", clamped_panel, NOTHING, h=0.01, steps=60),
    Entry("shell that stretches across", lambda: stretching(tissue()), ALL, steps=60),
    Entry(
        "shell that stretches across, triangles",
        lambda: stretching(tissue(), mesh=sheet_of("tri3")[0].mesh),
        ALL,
        h=0.01,
        steps=60,
    ),
    Entry(
        "shell of three panels that stretch across, rigid",
        lambda: stretched_star("rigid"),
        ALL,
        h=0.005,
        steps=60,
    ),
    Entry(
        "shell of three panels that stretch across, hinged",
        lambda: stretched_star("hinged"),
        ALL,
        h=0.005,
        steps=60,
    ),
    Entry("shell of tissue under pressure", lambda: blown_tissue(True), NOTHING, h=0.01, steps=60),
    Entry(
        "shell of tissue under pressure at a side", lambda: blown_tissue(False), NOTHING, h=0.005, steps=60
    ),
    Entry("folded shell under loads on its sides", folded, NOTHING, h=0.01, steps=60),
    Entry("shell of rubber", lambda: ballooned(2e4), ALL, steps=60),
    Entry(
        "plane beam", lambda: flat(vv.LineMesh(points=[(0, 0, 0), (2, 1, 0)], count=3)), IN_PLANE, steps=100
    ),
    Entry("plane beam with a corner", flat, IN_PLANE, steps=100),
    Entry("plane beam, rigid in shear", lambda: flat(rigid=("shear",)), IN_PLANE, steps=100),
    Entry("plane beam on hinges", flat_pendulum, NOTHING, h=0.01, steps=100),
    Entry("beam with joints", jointed, ENERGY, h=0.005, steps=200),
]
