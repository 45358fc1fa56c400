"""Contact of beams and shells against closed forms, and what it refuses."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import visviva as vv
from visviva.examples import rope_on_drum

E, RADIUS, LENGTH = 1e6, 0.02, 1.0
ROD = vv.TubeSection(radius=RADIUS, young=E)
SHEET = vv.HomogeneousSection(thickness=0.02, young=E, density=1.0)
BENDING = E * np.pi * RADIUS**4 / 4


def rod(start: Any, end: Any, count: int = 10, section: Any = ROD) -> vv.Beam:
    return vv.Beam(mesh=vv.LineMesh(points=[start, end], count=count), section=section)


def sheet(z: float = 0.0, counts: tuple[int, int] = (8, 2)) -> vv.Shell:
    flat = vv.RectangleMesh(size=(LENGTH, 0.2), counts=counts).build()
    points = np.pad(flat.points, ((0, 0), (0, 1)), constant_values=z)
    return vv.Shell(mesh=vv.Mesh(points, flat.cells, face_sets=flat.face_sets), section=SHEET)


def block(**options: Any) -> vv.Solid:
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1))
    return vv.Solid(mesh=mesh, material=vv.NeoHooke(young=E, poisson=0.3), density=1.0, **options)


def test_cantilevers_that_cross_share_the_load() -> None:
    """At their tips: the upper one carries what the lower one does, as both have the same compliance."""
    lower = rod((0, -LENGTH, 0), (0, 0, 0))
    upper = rod((-LENGTH, 0, 2 * RADIUS), (0, 0, 2 * RADIUS))
    contact = vv.Contact(first=upper, second=lower, enforcement="penalty")
    load = 1e-4
    push = vv.Force(on=upper, at=(0, 0, 2 * RADIUS), force=(0, 0, -load), times="t")
    held = [vv.Clamped(solid=b, nodes="start") for b in (lower, upper)]
    system = vv.System([lower, upper, contact, push, *held])
    vv.quasi_static(system, until=1.0, step=1.0)
    assert contact.forces[:, 2].sum() == pytest.approx(load / 2, rel=2e-3)
    tip = lower.displacements(system.x)[-1, 2]
    assert tip == pytest.approx(-load / 2 * LENGTH**3 / (3 * BENDING), rel=5e-3)


def test_cantilevers_that_lie_on_each_other_share_the_load() -> None:
    """Of a uniform load half goes on as a uniform line of force, but at the clamped ends where nothing bends yet."""
    lower, upper = (rod((0, 0, z), (LENGTH, 0, z), 20) for z in (0.0, 2 * RADIUS))
    contact = vv.Contact(first=upper, second=lower, enforcement="penalty", stiffness=3e8)
    load = 1e-4
    push = vv.LineLoad(beam=upper, force=(0, 0, -load), times="t")
    held = [vv.Clamped(solid=b, nodes="start") for b in (lower, upper)]
    system = vv.System([lower, upper, contact, push, *held])
    vv.quasi_static(system, until=1.0, step=1.0)
    tips = [b.displacements(system.x)[-1, 2] for b in (lower, upper)]
    assert tips == pytest.approx([-load / 2 * LENGTH**4 / (8 * BENDING)] * 2, rel=1e-2)


@pytest.mark.parametrize("formulation", ["mortar", "node-to-segment"])
@pytest.mark.parametrize("enforcement", ["multipliers", "penalty"])
def test_sheets_that_lie_on_each_other_share_the_load(formulation: str, enforcement: str) -> None:
    """Two clamped strips, of which the upper one is pressed: each carries half, and pressures are half as large."""
    lower, upper = sheet(0.0), sheet(0.02 + 1e-8)  # where both are clamped they do not touch
    contact: Any = vv.Contact(
        first=upper,
        first_faces="lower",
        second=lower,
        second_faces="upper",
        formulation=formulation,  # type: ignore[arg-type]
        enforcement=enforcement,  # type: ignore[arg-type]
    )
    load = 1e-3
    push = vv.Pressure(solid=upper, faces="upper", pressure=f"{load}*t")
    held = [vv.Clamped(solid=b, nodes="x0") for b in (lower, upper)]
    system = vv.System([lower, upper, contact, push, *held])
    vv.quasi_static(system, until=1.0, step=1.0)
    bending = E * 0.02**3 / 12
    tips = [b.displacements(system.x)[b.nodes("x1"), 2].mean() for b in (lower, upper)]
    assert tips == pytest.approx([-load / 2 * LENGTH**4 / (8 * bending)] * 2, rel=2e-2)


@pytest.mark.parametrize("enforcement", ["multipliers", "penalty"])
def test_an_angle_stands_as_its_two_plates_do(enforcement: Any) -> None:
    """A folded sheet on a block, its lower plate under a pressure: what it stands on takes all of it, evenly."""
    points = [(x, y, 0.01) for x in (0.2, 0.4, 0.6, 0.8) for y in (0.25, 0.5, 0.75)]
    points += [(0.8, y, 0.01 + z) for z in (0.15, 0.3) for y in (0.25, 0.5, 0.75)]
    cells = [[3 * i + j, 3 * i + 3 + j, 3 * i + 4 + j, 3 * i + 1 + j] for i in range(5) for j in range(2)]
    angle = vv.Shell(
        mesh=vv.Mesh(points, {"quad4": cells}),
        section=vv.HomogeneousSection(thickness=0.02, young=E),
        kinks="rigid",
    )
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(6, 6, 6), origin=(0, 0, -1))
    bed = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=E, poisson=0.0))
    contact = vv.Contact(
        first=angle,
        first_faces="lower",
        second=bed,
        second_faces="z1",
        initial="press",
        enforcement=enforcement,
    )
    flat = np.abs(angle.faces("upper").centres(angle.points)[:, 2] - 0.01) < 1e-9
    p, upper = 10.0, angle.faces("upper").where(flat)
    push = vv.Pressure(solid=angle, faces=upper, pressure=f"{p}*t", follower=False)
    held = [
        vv.Fixed(solid=bed, nodes="z0"),
        vv.Fixed(solid=angle, nodes="all", directions=(True, True, False)),
    ]
    system = vv.System([bed, angle, contact, push, *held])
    vv.quasi_static(system, until=1.0, step=0.5)
    total = vv.ContactForce(contact=contact)(system)
    assert abs(total[2]) == pytest.approx(p * 0.6 * 0.5, rel=1e-6)
    foot = vv.SupportForce(solid=bed, nodes="z0")(system)
    assert foot[2] == pytest.approx(p * 0.6 * 0.5, rel=1e-6)


def test_a_folded_sheet_touches_where_its_smooth_plates_do() -> None:
    """A ball that falls on a plate of it bounces as from that plate alone, clamped where the fold is."""

    def heights(folded: bool) -> np.ndarray:
        points = [(x, y, 0.0) for x in np.linspace(0, 1, 7) for y in (0.0, 0.2, 0.4)]
        if folded:
            points += [(1.0, y, z) for z in (0.2, 0.4) for y in (0.0, 0.2, 0.4)]
        rows = len(points) // 3 - 1
        cells = [
            [3 * i + j, 3 * i + 3 + j, 3 * i + 4 + j, 3 * i + 1 + j] for i in range(rows) for j in range(2)
        ]
        plate = vv.Shell(
            mesh=vv.Mesh(points, {"quad4": cells}), section=SHEET, kinks="rigid" if folded else "refused"
        )
        ball = vv.RigidBody(
            shape=vv.Sphere(radius=0.05), density=50.0, position=(0.4, 0.21, 0.08), velocity=(0, 0, -0.3)
        )
        contact = vv.Contact(
            first=plate, first_faces="upper", second=ball, enforcement="penalty", stiffness=1e7
        )
        clamp = vv.Clamped(solid=plate, nodes=np.arange(18, len(points)))
        system = vv.System([plate, ball, contact, clamp])
        result = vv.simulate(system, until=0.15, step=0.001)
        return np.array([x[ball.motion.start + 2] for x in result.states])

    found, alone = heights(True), heights(False)
    assert alone.min() < 0.07
    np.testing.assert_allclose(found, alone, atol=1e-9)


def folded() -> vv.Shell:
    """Two plates at a right angle."""
    points = [(0, 0, 1), (0, 1, 1), (1, 0, 1), (1, 1, 1), (1, 0, 2), (1, 1, 2)]
    mesh = vv.Mesh(points, {"quad4": [(0, 2, 3, 1), (2, 4, 5, 3)]})
    return vv.Shell(mesh=mesh, section=SHEET, kinks="rigid")


def test_a_rod_that_rolls() -> None:
    """Pushed at its middle by a force, it rolls by the acceleration 2/3 F/m of a full cylinder."""
    section = vv.TubeSection(radius=RADIUS, young=E, density=1000.0)
    bar = rod((0, 0, RADIUS), (0.2, 0, RADIUS), 2, section=section)
    floor = vv.Plane()
    contact = vv.Contact(
        first=bar, second=floor, enforcement="penalty", friction=0.5, initial="press", tangential="penalty"
    )
    along = 0.5
    system = vv.System([bar, floor, contact, vv.Gravity(acceleration=(0, along, -9.81))])
    vv.simulate(system, until=0.2, step=0.002)
    speed = bar.velocities(system.x, system.v)[:, 1].mean()
    assert speed == pytest.approx(2 / 3 * along * 0.2, rel=1e-2)


def test_a_rod_slides_along_another() -> None:
    """Thrown along its axis on a rod that is held, it is braked by mu g, and does not roll."""
    section = vv.TubeSection(radius=RADIUS, young=1e9, density=1000.0)
    top = 2 * RADIUS * (1 - 1e-9)
    line = vv.LineMesh(points=[(0, 0, top), (LENGTH, 0, top)], count=4)
    bar = vv.Beam(mesh=line, section=section, velocity=(1.0, 0.0, 0.0))
    rail = rod((-0.5, 0, 0), (1.5, 0, 0), 2)
    contact = vv.Contact(
        first=bar,
        second=rail,
        enforcement="penalty",
        stiffness=1e8,
        friction=0.2,
        tangential="penalty",
        initial="press",
    )
    system = vv.System([bar, rail, contact, vv.Clamped(solid=rail, nodes="all"), vv.Gravity()])
    speed = []
    for until in (0.05, 0.2):
        vv.simulate(system, until=until, step=0.005, scheme=vv.BackwardEuler())
        speed.append(bar.velocities(system.x, system.v)[:, 0].mean())
    assert (speed[0] - speed[1]) / 0.15 == pytest.approx(0.2 * 9.81, rel=0.01)
    assert abs(bar.velocities(system.x, system.v)[:, 1]).max() < 1e-6


@pytest.mark.parametrize("other", ["plane", "bar"])
def test_a_bar_pressed_in_its_middle_sinks_in_as_on_an_elastic_bed(other: str) -> None:
    """Of free ends on a bed of stiffness k per length (Hetenyi 1946): a penalty s on a width 2 r is k = 2 r s."""
    half, length, a = (2 * RADIUS if other == "bar" else RADIUS), 0.3, 2.4
    stretch = E * np.pi * RADIUS**2
    stiffness = (1e3 * stretch, 1e3 * stretch, stretch, BENDING, BENDING, BENDING)
    mesh = vv.LineMesh(points=[(0, 0, half), (length, 0, half)], count=20, cell="line3")
    bar = vv.Beam(mesh=mesh, section=vv.GivenSection(stiffness=stiffness, outside=RADIUS))
    below: Any = vv.Plane() if other == "plane" else rod((-0.1, 0, 0), (length + 0.1, 0, 0), 4)
    held = [] if other == "plane" else [vv.Clamped(solid=below, nodes="all")]
    k = 4 * BENDING * (a / length) ** 4  # so that all of it stays in contact
    contact = vv.Contact(
        first=bar, second=below, enforcement="penalty", stiffness=k / (2 * RADIUS), initial="press"
    )
    force = 1e-3 * k * length * RADIUS
    push = vv.Force(on=bar.point((length / 2, 0, half)), force=(0, 0, -force), times="t")
    centre = int(np.argmin(np.abs(bar.points[:, 0] - length / 2)))
    guides = [
        vv.SymmetryPlane(solid=bar, nodes="all", normal=(0, 1, 0)),
        vv.Fixed(solid=bar, nodes=[centre], directions=(True, False, False)),
    ]
    system = vv.System([bar, below, *held, contact, push, *guides])
    vv.quasi_static(system, until=1.0, step=1.0)
    deep = np.sinh(a) + np.sin(a)
    middle = force * a / length / (2 * k) * (np.cosh(a) + np.cos(a) + 2) / deep
    ends = 2 * force * a / length / k * np.cosh(a / 2) * np.cos(a / 2) / deep
    w = -bar.displacements(system.x)[:, 2]
    assert w[centre] == pytest.approx(middle, rel=0.01)
    assert w[bar.nodes("end")] == pytest.approx(ends, rel=0.02)
    assert contact.forces[:, 2].sum() == pytest.approx(force, rel=1e-6)


def test_a_beam_is_peeled_off_the_ground() -> None:
    """The length a that half its weight q a lifts at the tip rises by q a^4 / (24 E I); the rest lies on the ground."""
    radius, bending, count = 0.01, 1e3, 40
    section = vv.TubeSection(radius=radius, young=4 * bending / np.pi / radius**4)
    beam = rod((0, 0, radius), (4, 0, radius), count, section)
    plane = vv.Plane()
    parts = [
        vv.Contact(first=beam, second=plane),
        vv.LineLoad(beam=beam, force=(0, 0, -1), times="min(1, 4*t)"),
        vv.SymmetryPlane(solid=beam, nodes="all", normal=(0, 1, 0)),
        vv.Fixed(solid=beam, nodes="start", directions=(True, False, False)),
        vv.Force(on=beam.point((4, 0, radius)), force=(0, 0, 1), times="max(0, (t-.25)/.75)"),
    ]
    system = vv.System([beam, plane, *parts])
    result = vv.quasi_static(system, until=1.0, step=0.25)
    assert result.statistics.rejected == 0
    assert beam.displacements(system.x)[-1, 2] == pytest.approx(2**4 / 24 / bending, rel=1 / count**2 * 5)


@pytest.mark.parametrize("friction", [0.0, 0.2])
@pytest.mark.parametrize("scheme", [vv.BackwardEuler(), vv.EnergyMomentum()], ids=["euler", "conserving"])
def test_a_rod_slides_across_two_others(friction: float, scheme: Any) -> None:
    """Thrown along its axis over two rails, it is braked by mu times what they push with, whatever it passes on."""
    r = 0.01
    section = vv.TubeSection(radius=r, young=1e9, density=1000.0)
    top = 2 * r * (1 - 1e-9)
    line = vv.LineMesh(points=[(0, -0.4, top), (0, 0.4, top)], count=8)
    bar = vv.Beam(mesh=line, section=section, velocity=(0.0, 1.0, 0.0))
    rails = [rod((-0.2, y, 0), (0.2, y, 0), 4, section=section) for y in (-0.2, 0.2)]
    options: Any = {"friction": friction, "tangential": "penalty"} if friction else {}
    pressed: Any = {"enforcement": "penalty", "stiffness": 1e8, "initial": "press"}
    contacts = [vv.Contact(first=bar, second=rail, **pressed, **options) for rail in rails]
    held = [vv.Clamped(solid=rail, nodes="all") for rail in rails]
    system = vv.System([bar, *rails, *contacts, *held, vv.Gravity()])
    speed = []
    for until in (0.05, 0.2):
        vv.simulate(system, until=until, step=0.001, scheme=scheme)
        speed.append(bar.velocities(system.x, system.v).mean(axis=0))
    gained = speed[1] - speed[0]
    assert -gained[1] == pytest.approx(friction * (9.81 * 0.15 + gained[2]), rel=0.03, abs=0.01 * 9.81 * 0.15)


def test_rope_on_a_drum_holds_eulers_ratio() -> None:
    study = rope_on_drum.study()
    result = vv.simulate(study.system, until=2.0, step=0.1, scheme=vv.BackwardEuler())
    assert rope_on_drum.ratio(result) == pytest.approx(np.exp(0.3 * np.pi), rel=0.01)


BAR = vv.RectangleSection(width=0.1, height=0.1, young=E)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: (rod((0, 0, 1), (1, 0, 1), section=BAR), vv.Plane(), {}), "only round bars"),
        (lambda: (rod((0, 0, 1), (1, 0, 1)), vv.Plane(), {"first_faces": "start"}), "touched all along"),
        (lambda: (rod((0, 0, 1), (1, 0, 1)), vv.Plane(), {"formulation": "mortar"}), "points of its middle"),
        (
            lambda: (rod((0, 0, 1), (1, 0, 1)), rod((0, 0, 0), (1, 0, 0)), {}),
            "kept apart by enforcement='penalty'",
        ),
        (lambda: (block(), rod((0, 0, 2), (1, 0, 2)), {}), "exchange first and second"),
        (lambda: (sheet(1.0), vv.Plane(), {"condensed": True}), "condensed=True is for nodes of solids"),
        (
            lambda: (sheet(1.0), vv.Plane(), {"initial": "resolve"}),
            "initial='resolve' is for nodes of solids",
        ),
        (
            lambda: (folded(), None, {"formulation": "node-to-segment", "enforcement": "penalty"}),
            "across its kink at node 2",
        ),
        (lambda: (sheet(1.0), vv.Plane(), {"first_faces": "top"}), "top"),
        (lambda: (sheet(0.005), vv.Plane(), {"first_faces": "lower"}), "overlap by 0.005"),
    ],
)
def test_bad_input_is_refused(make: Callable[[], tuple[Any, Any, dict[str, Any]]], message: str) -> None:
    def begin() -> None:
        first, second, options = make()
        bodies = [body for body in (first, second) if body is not None]
        system = vv.System([*bodies, vv.Contact(first=first, second=second, **options)])
        vv.simulate(system, until=1.0, step=1.0)

    with pytest.raises(vv.InputError, match=message):
        begin()
