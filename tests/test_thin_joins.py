"""Shells joined to shells, solids, beams and bodies: cantilevers of two parts are those of one."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv

E, T, LENGTH, PULL = 1e6, 0.1, 4.0, 1e-3
SHEET = vv.HomogeneousSection(thickness=T, young=E, density=1.0)
STRIP = vv.RectangleSection(width=1.0, height=T, young=E)
STEEL = vv.LinearElastic(young=E, poisson=0.0)
DEFLECTION = -PULL * LENGTH**3 / (3 * E * T**3 / 12)


def sheet(
    start: float, end: float, counts: tuple[int, int] = (8, 3), z: float = 0.0, **options: Any
) -> vv.Shell:
    flat = vv.RectangleMesh(size=(end - start, 1.0), counts=counts, origin=(start, 0)).build()
    points = np.pad(flat.points, ((0, 0), (0, 1)), constant_values=z)
    return vv.Shell(mesh=vv.Mesh(points, flat.cells, face_sets=flat.face_sets), section=SHEET, **options)


def bar(start: float) -> vv.Solid:
    mesh = vv.BoxMesh(size=(2, 1, T), counts=(16, 3, 1), origin=(start, 0, -T / 2), cell="hex20")
    return vv.Solid(mesh=mesh, material=STEEL)


@pytest.mark.parametrize("multipliers", ["dual", "standard"])
def test_shells_tied_at_their_edges(multipliers: Any) -> None:
    one, two = sheet(0, 2), sheet(2, 4, (8, 4))
    tie = vv.Tie(first=one, first_faces="x1", second=two, second_faces="x0", multipliers=multipliers)
    system = vv.System([one, two, tie, vv.Clamped(solid=one, nodes="x0"), tip(two)])
    vv.quasi_static(system, until=1.0, step=1.0)
    assert two.displacements(system.x)[two.nodes("x1"), 2].mean() == pytest.approx(DEFLECTION, rel=2e-3)


def tip(shell: vv.Shell) -> vv.Traction:
    return vv.Traction(solid=shell, faces="x1", traction=(0, 0, -PULL))


@pytest.mark.parametrize("shell_first", [True, False])
def test_a_shell_tied_to_a_solid(shell_first: bool) -> None:
    solid, shell = bar(0.0), sheet(2, 4, (8, 4))
    sides: Any = {"first": shell, "first_faces": "x0", "second": solid, "second_faces": "x1"}
    if not shell_first:
        sides = {"first": solid, "first_faces": "x1", "second": shell, "second_faces": "x0"}
    system = vv.System([solid, shell, vv.Tie(**sides), vv.Fixed(solid=solid, nodes="x0"), tip(shell)])
    vv.quasi_static(system, until=1.0, step=1.0)
    assert shell.displacements(system.x)[shell.nodes("x1"), 2].mean() == pytest.approx(DEFLECTION, rel=2e-3)


def glued(upper: Any, faces: str, force: float) -> float:
    """Deflection of what is tied onto a bar that is held at one end."""
    mesh = vv.BoxMesh(size=(LENGTH, 1, T), counts=(20, 2, 1), origin=(0, 0, -T), cell="hex20")
    solid = vv.Solid(mesh=mesh, material=STEEL)
    tie = vv.Tie(first=upper, first_faces=faces, second=solid, second_faces="z1")
    push = vv.Traction(solid=upper, faces="x1", traction=(0, 0, -force))
    system = vv.System([solid, upper, tie, push, vv.Fixed(solid=solid, nodes="x0")])
    vv.quasi_static(system, until=1.0, step=1.0)
    return float(upper.displacements(system.x)[upper.nodes("x1"), 2].mean())


def test_a_shell_glued_onto_a_solid_bends_as_a_solid_there() -> None:
    """Solids give way across their thickness where the glue ends, by some of the two per cent between them."""
    mesh = vv.BoxMesh(size=(LENGTH, 1, T), counts=(40, 2, 2), cell="hex20")
    thick = glued(vv.Solid(mesh=mesh, material=STEEL), "z0", PULL / T)
    assert glued(sheet(0.0, LENGTH, (40, 3), T / 2), "lower", PULL) == pytest.approx(thick, rel=0.03)


@pytest.mark.parametrize("coupling", [vv.RigidCoupling, vv.DistributedCoupling])
def test_a_beam_on_the_edge_of_a_shell(coupling: Any) -> None:
    shell = sheet(0, 2)
    line = vv.LineMesh(points=[(2, 0.5, 0), (4, 0.5, 0)], count=8)
    beam = vv.Beam(mesh=line, section=STRIP, first=(0, 1, 0))
    edge = coupling(solid=shell, faces="x1")
    joint = vv.Rigid(a=edge, b=beam, at=(2, 0.5, 0))
    push = vv.Force(on=beam, at=(4, 0.5, 0), force=(0, 0, -PULL))
    system = vv.System([shell, beam, edge, joint, push, vv.Clamped(solid=shell, nodes="x0")])
    vv.quasi_static(system, until=1.0, step=1.0)
    assert beam.displacements(system.x)[-1, 2] == pytest.approx(DEFLECTION, rel=2e-3)


@pytest.mark.parametrize("make", [lambda: bar(0.0), lambda: sheet(0, 2)], ids=["solid", "shell"])
def test_a_beam_that_stands_out_of_a_solid_or_a_shell(make: Any) -> None:
    """A post on the end of a cantilever leans by P h^3 / 3 E I + P h^2 L / E I, and is lifted by P h L^2 / 2 E I."""
    foot, height, length = make(), 2.0, 2.0
    post = vv.Beam(
        mesh=vv.LineMesh(points=[(length, 0.5, 0), (length, 0.5, height)], count=8),
        section=STRIP,
        first=(0, 1, 0),
    )
    end = vv.RigidCoupling(solid=foot, faces="x1")
    joint = vv.Rigid(a=end, b=post, at=(length, 0.5, 0))
    push = vv.Force(on=post, at=(length, 0.5, height), force=(-PULL, 0, 0))
    hold = vv.Fixed if isinstance(foot, vv.Solid) else vv.Clamped
    system = vv.System([foot, post, end, joint, push, hold(solid=foot, nodes="x0")])
    vv.quasi_static(system, until=1.0, step=1.0)
    u, bending = post.displacements(system.x), E * T**3 / 12
    aside = PULL * (height**3 / 3 + height**2 * length) / bending
    assert u[-1, 0] == pytest.approx(-aside, rel=5e-3)
    assert u[0, 2] == pytest.approx(PULL * height * length**2 / 2 / bending, rel=5e-3)


def test_bad_input_is_refused() -> None:
    beam = vv.Beam(mesh=vv.LineMesh(points=[(0, 0, 0), (1, 0, 0)], count=2), section=STRIP)
    with pytest.raises(vv.InputError, match=r"is a line; join it by vv\.Rigid"):
        vv.Tie(first=sheet(0, 1), second=beam)
    with pytest.raises(vv.InputError, match=r"join it by beam\.frame"):
        vv.RigidCoupling(solid=beam, faces="all")
    with pytest.raises(vv.InputError, match="do not touch"):
        vv.Tie(first=sheet(0, 1), first_faces="x1", second=sheet(2, 3), second_faces="x0")
    upper, lower = sheet(0, 1, z=T + 0.004), sheet(0, 1)
    tie = vv.Tie(first=upper, first_faces="lower", second=lower, second_faces="upper")
    with pytest.raises(vv.InputError, match=r"do not fit by 0\.004"):
        vv.System([upper, lower, tie])
