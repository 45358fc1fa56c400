"""What shells are given: sections that vary and lie beside the mesh, moments, and what is refused or said."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest

import visviva as vv
from visviva.mesh.faces import Faces

SHEET = vv.HomogeneousSection(thickness=0.1, young=1e4, density=2.0)
SQUARE = vv.RectangleMesh(size=(1, 1), counts=(2, 2))
POINTS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2, 0, 0), (2, 1, 0), (1, 0, 0), (1, 1, 0), (1, 0.5, 0)]


def sheet(**options: Any) -> vv.Shell:
    return vv.Shell(**{"mesh": SQUARE, "section": SHEET} | options)


def edge_of(owner: int) -> Faces:
    """The end of its first cell, as one of another."""
    nodes = sheet().faces("x1").cells["line2"][:1]
    return Faces({"line2": nodes}, {"line2": np.array([owner])})


def pipe(radius: float) -> vv.Mesh:
    """A quarter of it."""
    flat = vv.RectangleMesh(size=(1, np.pi / 2), counts=(2, 12)).build()
    y, a = flat.points.T
    return vv.Mesh(np.stack([radius * np.sin(a), y, radius * np.cos(a)], axis=1), flat.cells)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: sheet(mesh=pipe(0.09)), r"exceeds the radius of curvature in cell \d+, 0.1 against 0.09"),
        (lambda: sheet(mesh=vv.RectangleMesh(size=(1, 1), counts=(1, 1), cell="quad8")), "needs tri3, tri6"),
        (lambda: sheet(kinks="welded"), "kinks"),
        (lambda: vv.EdgeMoment(shell=sheet(), edges="x1", moment=(0, 0, 1)), "has a part 1 along the director at node"),
        (lambda: vv.EdgeMoment(shell=sheet(), edges="x1", moment=(0, 1, 1e-3)), "has a part 0.001 along the director"),
        (lambda: vv.EdgeMoment(shell=sheet(), edges="x1", moment=(0, 0, 0)), "moment is zero"),
        (lambda: vv.EdgeMoment(shell=sheet(), edges=edge_of(2), moment=(0, 1, 0)), "is not of the cell that owns it"),
        (lambda: vv.EdgeMoment(shell=sheet(), edges=edge_of(9), moment=(0, 1, 0)), "is not of the cell that owns it"),
        (lambda: vv.EdgeMoment(shell=sheet(), edges="upper", moment=(0, 1, 0)), "are no edges but sides"),
        (lambda: vv.System([s := sheet(), vv.Torque(on=s, torque=(0, 0, 1))]), "spread moments over a patch"),
        (lambda: vv.Ply(thickness=0.0, young=1.0), "thickness"),
        (lambda: vv.Ply(thickness=1.0, young=1.0, angle=np.nan), "angle"),
        (lambda: sheet(section=(SHEET, SHEET)), "2 sections for 4 cells"),
        (
            lambda: sheet(mesh=vv.Mesh(POINTS, {"quad4": [(0, 1, 2, 3)], "tri3": [(1, 2, 4)]})),
            "upper sides on different sides",
        ),
        (lambda: sheet(mesh=vv.Mesh(POINTS, {"tri3": [(0, 1, 4)]})), "has no area at a corner"),
    ],
)  # fmt: skip
def test_refused(make: Any, message: str) -> None:
    with pytest.raises(vv.InputError, match=message):
        make()


def test_results_of_mixed_cells_come_type_by_type() -> None:
    shell = sheet(mesh=vv.Mesh(POINTS[:6], {"quad4": [(0, 1, 2, 3)], "tri3": [(1, 4, 2)]}))
    system = vv.System([shell])
    assert [r.shape for r in shell.resultants_of_parts(system.x)] == [(1, 4, 8), (1, 3, 8)]
    assert shell.smoothed(["bending_moment"], system.x)["bending_moment"].shape == (6, 3)
    with pytest.raises(vv.InputError, match="its cells are of 2 types"):
        shell.strains(system.x)


@pytest.mark.parametrize(
    "cells",
    [[(0, 1, 2, 3), (6, 4, 5, 7)], [(0, 1, 2, 3), (1, 4, 5, 8)]],
    ids=["nodes on nodes", "node on an edge"],
)
def test_edges_that_do_not_meet_are_refused(cells: Any) -> None:
    """Unless the shell shall be slit there: then both sides are free of each other."""
    mesh = vv.Mesh(POINTS, {"quad4": cells})
    with pytest.raises(vv.InputError, match=r"edges of its mesh do not meet.*slits='open'"):
        sheet(mesh=mesh)
    assert sheet(mesh=mesh, slits="open").grid.n_nodes == len(POINTS)


def test_edges_that_meet_are_not_refused() -> None:
    """Nor is anything said of fine grids and curved ones."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sheet(mesh=vv.Mesh(POINTS, {"quad4": [(0, 1, 2, 3), (1, 4, 5, 2)]}))
        sheet(mesh=pipe(1.0))
        sheet(mesh=vv.RectangleMesh(size=(1, 1), counts=(7, 5), cell="tri6"))


# --- sections -----------------------------------------------------------------------------------------------
def test_thickness_may_vary() -> None:
    """A strip that gets thinner bends as the integral of P x^2 / E I."""
    n = 64
    heights = 0.1 * (1.5 - (np.arange(n) + 0.5) / n)
    sections = tuple(vv.HomogeneousSection(thickness=float(h), young=1e6) for h in heights)
    shell = vv.Shell(mesh=vv.RectangleMesh(size=(10, 1), counts=(n, 1)), section=sections)
    load = vv.Traction(solid=shell, faces="x1", traction=(0, 0, 1e-5))
    system = vv.System([shell, vv.Clamped(solid=shell, nodes="x0"), load])
    vv.quasi_static(system, until=1.0, step=1.0)
    x = np.linspace(0, 10, 100001)
    bending = 1e-5 * (10 - x) ** 2 / (1e6 * (0.1 * (1.5 - x / 10)) ** 3 / 12)
    found = shell.displacements(system.x)[shell.nodes("x1"), 2].mean()
    assert found == pytest.approx(np.trapezoid(bending, x), rel=2e-3)


def test_sections_beside_the_mesh() -> None:
    """Pulled along the mesh, a strip whose middle is above it bends down: w = - N e L^2 / 2 E I."""
    section = vv.HomogeneousSection(thickness=0.1, young=1e6, offset=0.05)
    shell = vv.Shell(mesh=vv.RectangleMesh(size=(10, 1), counts=(20, 1)), section=section)
    load = vv.Traction(solid=shell, faces="x1", traction=(1e-4, 0, 0))
    system = vv.System([shell, vv.Clamped(solid=shell, nodes="x0"), load])
    vv.quasi_static(system, until=1.0, step=1.0)
    found = shell.displacements(system.x)[shell.nodes("x1"), 2]
    bent = 1e-4 * 0.05 * 10**2 / (2 * 1e6 * 0.1**3 / 12)
    np.testing.assert_allclose(np.abs(found), bent, rtol=1e-3)


def test_stresses_of_layers() -> None:
    """Bent to one curvature, a sandwich has stresses E z kappa in each layer; in the faces the largest."""
    plies = tuple(
        vv.Ply(thickness=t, young=young, poisson=0.0) for t, young in ((0.01, 1e6), (0.08, 1e4), (0.01, 2e6))
    )
    shell = vv.Shell(
        mesh=vv.RectangleMesh(size=(1, 0.2), counts=(16, 1)),
        section=vv.Laminate(plies=plies),
        first=(1, 0, 0),
    )
    system = vv.System([shell])
    x, kappa = system.x.copy(), 1e-5
    at = shell.node_unknowns(np.arange(shell.grid.n_nodes))
    along = shell.points[:, 0]
    x[at + 2] = 0.5 * kappa * along**2
    x[at + 3] = -kappa * along
    for layer, (z, young) in enumerate(((-0.05, 1e6), (-0.04, 1e4), (0.04, 2e6))):
        (found,) = shell.layer_stresses(x, layer)
        thick = plies[layer].thickness
        np.testing.assert_allclose(found[..., 0, 0], -young * z * kappa, rtol=1e-3)
        np.testing.assert_allclose(found[..., 1, 0], -young * (z + thick) * kappa, rtol=1e-3)
    assert shell.smoothed(["upper_stress"], x)["upper_stress"][5, 0] == pytest.approx(
        -2e6 * 0.05 * kappa, rel=1e-3
    )
    with pytest.raises(vv.InputError, match="layer 3 is not one of the 3"):
        shell.layer_stresses(x, 3)


# --- moments ------------------------------------------------------------------------------------------------
def test_a_moment_about_the_director_is_spread_over_a_patch() -> None:
    """The patch turns, and the clamped side takes the moment."""
    shell = sheet(mesh=vv.RectangleMesh(size=(2, 1), counts=(8, 4)))
    upper = shell.faces("upper")
    patch = upper.where(np.abs(upper.centres(shell.points)[:, 0] - 1.5) < 0.3)
    frame = vv.DistributedCoupling(solid=shell, faces=patch)
    torque = vv.Torque(on=frame, torque=(0, 0, 1e-3))
    system = vv.System([shell, vv.Clamped(solid=shell, nodes="x0"), frame, torque])
    vv.quasi_static(system, until=1.0, step=1.0)
    reaction = vv.SupportTorque(solid=shell, nodes="x0")(system)
    assert reaction[2] == pytest.approx(-1e-3, rel=1e-6)
    u = shell.displacements(system.x)[shell.nodes("x1"), 1]
    assert u.min() > 0


def test_the_work_of_a_moment_at_an_edge_is_what_a_strip_stores() -> None:
    """Rolled up to half a circle by M, it stores M angle / 2."""
    sheet = vv.HomogeneousSection(thickness=0.1, young=1.2e6)
    shell = vv.Shell(mesh=vv.RectangleMesh(size=(12, 1), counts=(12, 1), cell="quad9"), section=sheet)
    moment = vv.EdgeMoment(shell=shell, edges="x1", moment=(0, -25 * np.pi / 3, 0), times="t")
    system = vv.System([shell, vv.Clamped(solid=shell, nodes="x0"), moment])
    ledger = vv.quasi_static(system, until=1.0, step=0.05).ledger
    assert ledger.last("potential_stored") == pytest.approx(25 * np.pi / 3 * np.pi / 2, rel=2e-3)


def test_edges_have_no_area_for_a_conductance() -> None:
    section = vv.SolidSection(material=vv.NeoHooke(young=1e4, poisson=0.3), thickness=0.02, density=10.0)
    heat = vv.Heat(conductivity=1.0, capacity=10.0, expansion=1e-3, reference=300.0)
    one, two = (
        vv.ThermalShell(
            mesh=vv.QuadrilateralMesh(corners=[(x, 0), (x + 1, 0), (x + 1, 1), (x, 1)], counts=(2, 2)),
            section=section,
            heat=heat,
            temperature=300.0,
        )
        for x in (0.0, 1.0)
    )
    with pytest.raises(vv.InputError, match="have no area that a conductance could be of"):
        vv.HeatTie(first=one, first_faces="x1", second=two, second_faces="x0", conductance=1.0)
