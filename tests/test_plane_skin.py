"""Contact of beams in the plane against closed forms and beams in space."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv

E, HEIGHT, LENGTH = 1e6, 0.02, 1.0
STRIP = vv.RectangleSection(width=1.0, height=HEIGHT, young=E, density=1.0)
BENDING = E * HEIGHT**3 / 12


def strip(y: float, count: int = 10, cell: Any = "line2", **options: Any) -> vv.PlaneBeam:
    mesh = vv.LineMesh(points=[(0, y, 0), (LENGTH, y, 0)], count=count, cell=cell)
    return vv.PlaneBeam(mesh=mesh, section=STRIP, **options)


@pytest.mark.parametrize("cell", ["line2", "line3", "line4"])
@pytest.mark.parametrize("formulation", ["mortar", "node-to-segment"])
@pytest.mark.parametrize("enforcement", ["multipliers", "penalty"])
def test_strips_that_lie_on_each_other_share_the_load(cell: str, formulation: Any, enforcement: Any) -> None:
    """Of the load on the upper one each carries half, but at the clamped ends, which do not touch."""
    lower, upper = strip(0.0, cell=cell), strip(HEIGHT + 1e-7, cell=cell)
    sides = {"first": upper, "first_faces": "right", "second": lower, "second_faces": "left"}
    contact: Any = vv.Contact(**sides, formulation=formulation, enforcement=enforcement)
    load = 0.1
    push = vv.LineLoad(beam=upper, force=(0, -load, 0), times="t")
    held = [vv.Clamped(solid=b, nodes="start") for b in (lower, upper)]
    system = vv.System([lower, upper, contact, push, *held])
    vv.quasi_static(system, until=1.0, step=0.5)
    tips = [b.displacements(system.x)[b.nodes("end"), 1][0] for b in (lower, upper)]
    assert tips == pytest.approx([-load / 2 * LENGTH**4 / (8 * BENDING)] * 2, rel=1e-3)


def horseshoe(angle: float, count: int, cell: str) -> vv.PlaneBeam:
    """An arc of radius 0.5 that begins at 30 degrees."""
    k = 2 if cell == "line3" else 1
    at = np.pi / 6 + np.linspace(0, angle, k * count + 1)
    i = k * np.arange(count)
    cells = np.column_stack([i, i + k] if k == 1 else [i, i + 2, i + 1])
    mesh = vv.Mesh(np.column_stack([0.5 * np.cos(at), 0.5 * np.sin(at), 0 * at]), {cell: cells})
    return vv.PlaneBeam(mesh=mesh, section=STRIP)


@pytest.mark.parametrize("cell", ["line2", "line3"])
def test_tips_of_a_horseshoe_close_as_on_a_mirror(cell: str) -> None:
    """It touches itself by the corners of its ends, as half of it does the plane of symmetry."""
    tip = 0.5 * np.array([np.cos(np.pi / 6), np.sin(np.pi / 6), 0.0])

    def pressed(angle: float, count: int, floor: bool) -> tuple[float, float]:
        beam = horseshoe(angle, count, cell)
        ends = tip * [1, -1, 1]
        pulls = [vv.Force(on=beam.point(tip), force=(0, -2.0, 0), times="t")]
        last = beam.grid.n_nodes - 1
        clamped = [last] if floor else [last * 2 // 5, last * 3 // 5]
        held = vv.Clamped(solid=beam, nodes=clamped)
        if floor:
            other = vv.Plane(normal=(0, 1, 0))
            contact = vv.Contact(first=beam, first_faces="ends", second=other, enforcement="penalty")
            parts = [beam, other, contact, held, *pulls]
        else:
            contact = vv.Contact(first=beam, enforcement="penalty", formulation="node-to-segment")
            pulls.append(vv.Force(on=beam.point(ends), force=(0, 2.0, 0), times="t"))
            parts = [beam, contact, held, *pulls]
        system = vv.System(parts)
        vv.quasi_static(system, until=1.0, step=0.05)
        up = contact.forces[:, 1]
        return float(up[up > 0].sum()), float(beam.positions(system.x)[0, 0])

    whole, half = pressed(np.deg2rad(300), 50, False), pressed(np.deg2rad(120), 20, True)
    assert half[0] > 0.1
    assert whole == pytest.approx(half, rel=2e-3)


@pytest.mark.parametrize("enforcement", ["multipliers", "penalty"])
def test_a_strip_that_slides_is_braked(enforcement: Any) -> None:
    beam, floor = strip(HEIGHT / 2, 6, velocity=(2.0, 0, 0)), vv.Plane(normal=(0, 1, 0))
    rubbing: Any = {"friction": 0.3, "enforcement": enforcement, "tangential": enforcement}
    contact = vv.Contact(first=beam, first_faces="right", second=floor, **rubbing)
    system = vv.System([beam, floor, contact, vv.Gravity(acceleration=(0, -9.81, 0))])
    vv.simulate(system, until=0.2, step=0.002, scheme=vv.BackwardEuler())
    assert beam.positions(system.v)[:, 0] == pytest.approx(2 - 0.3 * 9.81 * 0.2, abs=1e-9)


@pytest.mark.parametrize("formulation", ["mortar", "node-to-segment"])
@pytest.mark.parametrize("beam_first", [True, False])
def test_a_strip_lies_on_a_solid(formulation: Any, beam_first: bool) -> None:
    """As on an elastic bed of springs, Winkler's, that is a layer whose sides are held: E' over its height.

    A strip that bends little presses evenly, and sinks in by p H / E'.
    """
    beam = vv.PlaneBeam(
        mesh=vv.LineMesh(points=[(0, 0, 0), (LENGTH, 0, 0)], count=12),
        section=vv.RectangleSection(width=1.0, height=HEIGHT, young=1e9),
    )
    mesh = vv.RectangleMesh(size=(LENGTH, 0.5), counts=(10, 5), origin=(0, -0.5 - HEIGHT / 2))
    bed = vv.Solid(mesh=mesh, material=vv.SaintVenantKirchhoff(young=1e4, poisson=0.0))
    sides = (beam, "right"), (bed, "y1")
    (first, faces), (second, others) = sides if beam_first else sides[::-1]
    contact = vv.Contact(
        first=first,
        first_faces=faces,
        second=second,
        second_faces=others,
        formulation=formulation,
        enforcement="penalty",
        stiffness=1e8,
        initial="press",
    )
    push = vv.LineLoad(beam=beam, force=(0, -1.0, 0), times="t")
    guide = vv.Fixed(solid=beam, nodes="start", directions=(True, False, False))
    system = vv.System([bed, beam, contact, push, guide, vv.Fixed(solid=bed, nodes="y0")])
    vv.quasi_static(system, until=1.0, step=1.0)
    assert beam.displacements(system.x)[:, 1] == pytest.approx(-1.0 * 0.5 / 1e4, rel=2e-3)
    assert abs(vv.ContactForce(contact=contact)(system)[1]) == pytest.approx(LENGTH, rel=1e-6)


def test_it_bounces_as_a_beam_in_space() -> None:
    """A round bar of the same radius that a symmetry plane holds: the point of the middle touches, not the side.

    A bar that lands flat and far from its ends does both alike.
    """
    section = vv.TubeSection(radius=0.01, young=E, density=1.0)
    paths = []
    for kind in (vv.PlaneBeam, vv.Beam):
        mesh = vv.LineMesh(points=[(0, 0.02, 0), (LENGTH, 0.02, 0)], count=4)
        options: Any = {} if kind is vv.PlaneBeam else {"first": (0, 0, 1)}
        bar = kind(mesh=mesh, section=section, velocity=(0, -1.0, 0), **options)
        floor = vv.Plane(normal=(0, 1, 0))
        faces = "right" if kind is vv.PlaneBeam else "all"
        contact = vv.Contact(
            first=bar,
            first_faces=faces,
            second=floor,
            enforcement="penalty",
            stiffness=1e3 if kind is vv.PlaneBeam else 1e3 / 0.02,
            formulation="node-to-segment",
        )
        held = [] if kind is vv.PlaneBeam else [vv.SymmetryPlane(solid=bar, nodes="all", normal=(0, 0, 1))]
        system = vv.System([bar, floor, contact, *held])
        vv.simulate(system, until=0.02, step=1e-4)
        paths.append(bar.positions(system.x)[:, 1])
    np.testing.assert_allclose(*paths, atol=1e-9)


CORNER = vv.Mesh([(0, 0, 0), (1, 0, 0), (1, 1, 0)], {"line2": [(0, 1), (1, 2)]})


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"first": strip(0.0), "first_faces": "upper"}, "'left' and 'right'"),
        (
            {
                "first": vv.PlaneBeam(
                    mesh=vv.LineMesh(points=[(0, 0, 0), (1, 0, 0)], count=2),
                    section=vv.GivenSection(stiffness=[1.0] * 6),
                )
            },
            "give it an outline",
        ),
        ({"first": vv.PlaneBeam(mesh=CORNER, section=STRIP, kinks="rigid")}, "across its kink at node"),
        ({"first": strip(0.0), "initial": "resolve"}, "move one of the bodies"),
    ],
)
def test_refused(options: Any, message: str) -> None:
    own = vv.Contact(enforcement="penalty", formulation="node-to-segment", **options)
    with pytest.raises(vv.InputError, match=message):
        vv.System([options["first"], own])
