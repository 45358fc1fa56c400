"""Waves and natural frequencies of bars and beams of solid elements against closed forms."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv
from verification.measure import orders
from verification.solids import displacement

E, RHO, LENGTH, FORCE, AREA = 210e9, 7850.0, 1.0, 1e3, 1e-4
SPEED = np.sqrt(E / RHO)
STRETCHED = vv.LinearElastic(young=E, poisson=0.0)


def bar(cell: str, n: int, clamped: bool = True, lumped: bool = False) -> tuple[vv.Solid, list[vv.Fixed]]:
    """A bar 1 x 0.01 x 0.01 that can only stretch, held at one end or free."""
    mesh = vv.BoxMesh(size=(LENGTH, 0.01, 0.01), counts=(n, 1, 1), cell=cell)
    solid = vv.Solid(mesh=mesh, material=STRETCHED, density=RHO, lumped=lumped)
    held = [vv.Fixed(solid=solid, nodes="all", directions=(False, True, True))]
    if clamped:
        held.append(vv.Fixed(solid=solid, nodes="x0", directions=(True, False, False)))
    return solid, held


@pytest.mark.parametrize("lumped", [False, True])
def test_frequencies_of_linear_elements_to_the_digit(lumped: bool) -> None:
    """On elements of length h, w^2 = 6 c^2/h^2 (1 - cos kh)/(2 + cos kh), lumped 2 c^2/h^2 (1 - cos kh)."""
    n = 20
    solid, held = bar("hex8", n, lumped=lumped)
    found = vv.modes(vv.System([solid, *held]), n=8).squared
    k = np.pi * (np.arange(8) + 0.5) / LENGTH
    cosine = np.cos(k * LENGTH / n)
    factor = 2 * (1 - cosine) if lumped else 6 * (1 - cosine) / (2 + cosine)
    distinct = found[:: len(found) // 8] if len(found) > 8 else found
    assert distinct[0] == pytest.approx((SPEED * n / LENGTH) ** 2 * factor[0], rel=1e-9)
    for exact in (SPEED * n / LENGTH) ** 2 * factor[:4]:
        assert np.abs(found / exact - 1).min() < 1e-8


@pytest.mark.parametrize(("cell", "order"), [("hex8", 2), ("hex20", 4), ("tet10", 4), ("hex27", 4)])
def test_frequencies_converge(cell: str, order: int) -> None:
    """Clamped and free: f = (2 j - 1) c / 4 L."""
    errors = []
    for n in (2, 4, 8):
        solid, held = bar(cell, n)
        errors.append(vv.modes(vv.System([solid, *held]), n=1).frequencies[0] / (SPEED / 4) - 1)
    assert orders(errors)[-1] == pytest.approx(order, abs=0.2)
    assert errors[-1] > 0, "consistent masses give frequencies from above"


def test_free_bar_has_free_motions() -> None:
    """Six of them in space, then the first bending modes, twice."""
    mesh = vv.BoxMesh(size=(1, 0.1, 0.1), counts=(10, 1, 1), cell="hex20")
    found = vv.modes(vv.System([vv.Solid(mesh=mesh, material=STRETCHED, density=RHO)]), n=8).frequencies
    assert np.abs(found[:6]).max() < 1e-2
    assert found[6] == pytest.approx(found[7], rel=1e-6)


def timoshenko(j: int, depth: float) -> float:
    """Frequency of bending mode `j` of a simply supported square beam of length 1 with nu = 0, kappa = 5/6."""
    p, r2, G = j * np.pi / LENGTH, depth**2 / 12, E / 2
    shear = 5 / 6 * G
    coefficients = [RHO**2 * r2 / shear, -RHO * (1 + r2 * p**2 * (1 + E / shear)), E * r2 * p**4]
    return float(np.sqrt(np.roots(coefficients).min()) / (2 * np.pi))


def test_bending_frequencies_of_a_beam() -> None:
    """End faces move along the beam only; every frequency twice. Two cells over the depth carry most of the shear."""
    mesh = vv.BoxMesh(size=(1, 0.1, 0.1), counts=(16, 2, 2), cell="hex20")
    solid = vv.Solid(mesh=mesh, material=STRETCHED, density=RHO)
    held = [vv.Fixed(solid=solid, nodes=s, directions=(False, True, True)) for s in ("x0", "x1")]
    found = vv.modes(vv.System([solid, *held]), n=12).frequencies
    for j in (1, 2, 3):
        exact = timoshenko(j, 0.1)
        near = found[np.argsort(np.abs(found - exact))[:2]]
        assert near == pytest.approx(exact, rel=2e-3)


def test_end_load_sends_a_wave() -> None:
    """A sudden force on the free end: u(L, t) rises to 2 F L / E A and falls in triangles of period 4 L / c."""
    n = 100
    solid, held = bar("hex8", n)
    pull = vv.Traction(solid=solid, faces="x1", traction=(FORCE / AREA, 0, 0))
    system = vv.System([solid, *held, pull])
    period, steps = 4 * LENGTH / SPEED, 400
    seen = [0.0]
    result = vv.simulate(
        system,
        until=2 * period,
        step=period / steps,
        every=10**9,
        observe=lambda s: seen.append(displacement(s, solid, (LENGTH, 0, 0))[0]),
    )
    t = np.arange(len(seen)) / steps
    exact = 2 * FORCE * LENGTH / (E * AREA) * (1 - np.abs(1 - 2 * (t % 1.0)))
    assert np.abs(seen - exact).max() < 0.015 * 9.5238095e-5
    assert np.sqrt(np.mean((seen - exact) ** 2)) < 0.004 * 9.5238095e-5
    assert result.conservation()["energy"] < 1e-11


def test_standing_wave_in_a_free_bar() -> None:
    """u = a cos(pi x / L) cos(w t): second order in time towards the frequency of the elements, energy kept."""
    n = 20
    solid, held = bar("hex8", n, clamped=False)
    mode = vv.modes(vv.System([solid, *held]), n=2)
    omega = float(mode.angular[1])
    periods, errors = 2, []
    for steps in (20, 40):
        solid, held = bar("hex8", n, clamped=False)
        system = vv.System([solid, *held], vv.Newton(tolerance=1e-14))
        u0 = 1e-4 * np.cos(np.pi * solid.points[:, 0] / LENGTH)
        system.x[solid.node_unknowns(np.arange(solid.grid.n_nodes))] += u0
        system.invalidate()
        end = periods * 2 * np.pi / omega * 1.125
        vv.simulate(system, until=end, step=end / (steps * periods), every=10**9)
        u = solid.displacements(system.x)[:, 0]
        errors.append(np.abs(u - u0 * np.cos(omega * end)).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.1)


@pytest.mark.parametrize("formulation", ["displacement", "enhanced"])
@pytest.mark.parametrize("share", [-1.5, -0.5, 1.0, 4.0])
def test_prestressed_beam(share: float, formulation: Any) -> None:
    """A beam under an axial force of some Euler loads: ``w^2 = w0^2 (1 + N / N_E)``, unstable beyond the Euler load."""
    slender, E = 0.02, 1000.0
    cell = "quad4" if formulation == "enhanced" else "quad9"
    mesh = vv.RectangleMesh(size=(1.0, slender), counts=(24 if cell == "quad9" else 60, 2), cell=cell)
    beam = vv.Solid(
        mesh=mesh,
        material=vv.SaintVenantKirchhoff(young=E, poisson=0.0),
        density=1.0,
        formulation=formulation,
    )
    euler = np.pi**2 * E * slender**3 / 12
    ends = [np.argmin(np.linalg.norm(beam.points - [x, slender / 2, 0], axis=1)) for x in (0.0, 1.0)]
    parts = [
        beam,
        vv.SymmetryPlane(solid=beam, nodes=[ends[0]], normal=(1, 0, 0)),
        vv.Fixed(solid=beam, nodes=ends, directions=(False, True, True)),
        vv.Traction(solid=beam, faces="x1", traction=(share * euler / slender, 0, 0), times="t"),
    ]
    system = vv.System(parts)
    w0 = vv.modes(system, n=1).squared[0]
    vv.quasi_static(system, until=1.0, step=1.0, scheme=vv.Static(unstable=share < -1))
    w1 = vv.modes(system, n=1).squared[0]
    assert w1 / w0 == pytest.approx(1 + share, abs=0.01)


def test_mesh_without_mass_has_no_modes() -> None:
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1))
    with pytest.raises(vv.InputError, match="without mass"):
        vv.modes(vv.System([vv.Solid(mesh=mesh, material=STRETCHED)]))
