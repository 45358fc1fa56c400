"""Shells whose directors stretch: balloons past their limit, rubber that bends, thin ones, free flight."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]
LIMIT = 7 ** (1 / 6)
"""Stretch at which the pressure of a thin neo-Hookean balloon is largest, of 1/l - 1/l^7."""


def octant(n: int, cell: str = "quad4") -> vv.Mesh:
    """An eighth of the unit sphere: three squares of a cube of n by n cells, or halves of them."""
    s = np.tan(np.linspace(0, np.pi / 4, n + 1))
    numbers: dict[tuple[float, ...], int] = {}
    cells = []
    for axis in range(3):
        grid = np.empty((n + 1, n + 1), dtype=int)
        for i, j in np.ndindex(grid.shape):
            p = np.roll([1.0, s[i], s[j]], axis)
            grid[i, j] = numbers.setdefault(tuple((p / np.linalg.norm(p)).round(12) + 0.0), len(numbers))
        cells += [
            (grid[i, j], grid[i + 1, j], grid[i + 1, j + 1], grid[i, j + 1])
            for i in range(n)
            for j in range(n)
        ]
    points = np.array(list(numbers))
    sets = {f"{name}0": np.flatnonzero(points[:, k] == 0) for k, name in enumerate("xyz")}
    quads = np.array(cells)
    halves = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return vv.Mesh(points, {cell: quads if cell == "quad4" else halves}, node_sets=sets)


def blown(n: int, material: vv.Material, until: float, by: str = "arc", cell: str = "quad4") -> Array:
    """Stretches and pressures (k, 2) times radius over twice the thickness, to a stretch, or by loads to one."""
    t = 1e-3
    section = vv.SolidSection(material=material, thickness=t)
    shell = vv.ExtensibleShell(mesh=octant(n, cell), section=section, formulation="mixed")
    planes = [
        vv.SymmetryPlane(solid=shell, nodes=f"{name}0", normal=np.eye(3)[k]) for k, name in enumerate("xyz")
    ]
    inner = vv.Pressure(solid=shell, faces="lower", pressure=lambda load: 2 * t * load)
    system = vv.System([shell, *planes, inner])

    def stretch(x: Array) -> float:
        return float(np.linalg.norm(shell.positions(x), axis=1).mean())

    if by == "load":
        result = vv.quasi_static(system, until=until, step=0.2)
    else:
        result = vv.arc_length(system, step=0.1, steps=60, stop=lambda at: stretch(at.x) > until)
    return np.array([(stretch(x), load) for x, load in zip(result.states, result.times, strict=True)])


# --- balloons -------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("elastic", [{"bulk": 1e4, "isochoric": True}, {"poisson": 0.5}], ids=str)
@pytest.mark.parametrize("cell", ["quad4", "tri3"])
def test_a_rubber_balloon_past_its_limit(cell: str, elastic: Any) -> None:
    """Neo-Hooke, K/mu = 1e4 and incompressible: mu (1/l - 1/l^7), largest at l = 7^(1/6). Second order."""
    error = []
    for n in (2, 4):
        path = blown(n, vv.NeoHooke(shear=1.0, **elastic), until=2.0, cell=cell)
        stretch, load = path[1:].T
        error.append(np.abs(load / (1 / stretch - stretch**-7) - 1).max())
        top = np.argmax(load)
        assert stretch[top - 1] < LIMIT < stretch[top + 1]
    assert load[top] == pytest.approx(1 / LIMIT - LIMIT**-7, rel=0.01)
    assert error[1] < 0.01
    assert np.log2(error[0] / error[1]) > (1.8 if cell == "quad4" else 1.75)


def test_a_balloon_of_two_constants() -> None:
    """Mooney: (mu1 + mu2 l^2) (1/l - 1/l^7)."""
    path = blown(4, vv.MooneyRivlin(c10=0.4, c01=0.1, bulk=1e4, isochoric=True), until=2.0)
    stretch, load = path[1:].T
    np.testing.assert_allclose(load, (0.8 + 0.2 * stretch**2) * (1 / stretch - stretch**-7), rtol=0.01)


def test_a_bladder_of_tissue() -> None:
    """Fibres in all directions, dispersion 1/3: E = (I1 - 3) / 3, twice; it stiffens and has no limit."""
    mu, k1, k2 = 1.0, 2.0, 1.5
    tissue = vv.HolzapfelGasserOgden(
        shear=mu, k1=k1, k2=k2, bulk=1e4, fibres=((1, 0, 0), (0, 1, 0)), dispersion=1 / 3
    )
    path = blown(4, tissue, until=1.6, by="load")
    stretch, load = path[1:].T
    E = (2 * stretch**2 + stretch**-4 - 3) / 3
    slope = mu / 2 + 2 * k1 / 3 * E * np.exp(k2 * E**2)  # of the energy by I1
    np.testing.assert_allclose(load, 2 * slope * (1 / stretch - stretch**-7), rtol=0.012)
    assert np.all(np.diff(load) > 0)


# --- bending --------------------------------------------------------------------------------------------------
def strip(
    section: Any, counts: tuple[int, int] = (16, 1), cell: Any = "quad4", **options: Any
) -> vv.ExtensibleShell:
    mesh = vv.RectangleMesh(size=(10, 1), counts=counts, cell=cell)
    return vv.ExtensibleShell(mesh=mesh, section=section, **options)


def tip(shell: vv.Shell, force: float, *others: Any, step: float = 1.0) -> Array:
    """How far the end moves under a force across per length."""
    load = vv.Traction(solid=shell, faces="x1", traction=(0, 0, force), times="t")
    system = vv.System([shell, vv.Clamped(solid=shell, nodes="x0"), load, *others])
    vv.quasi_static(system, until=1.0, step=step)
    return np.asarray(shell.displacements(system.x)[shell.nodes("x1")].mean(axis=0))


@pytest.mark.parametrize(
    ("poisson", "formulation"), [(0.3, "displacement"), (0.4999, "displacement"), (0.4999, "mixed"), (0.5, "mixed")]
)  # fmt: skip
@pytest.mark.parametrize("cell", ["quad4", "tri3"])
def test_bending_does_not_lock(cell: str, poisson: float, formulation: Any) -> None:
    """Without strain across the strip: F L^3 / (3 E I) (1 - nu^2). Without enhanced strains it would bend by
    (1 - 2 nu) / (1 - nu)^2 of that, nothing for rubber."""
    rubber = vv.NeoHooke(young=1.2e6, poisson=poisson)
    shell = strip(vv.SolidSection(material=rubber, thickness=0.05), cell=cell, formulation=formulation)
    sides = [vv.SymmetryPlane(solid=shell, nodes=side, normal=(0, 1, 0)) for side in ("y0", "y1")]
    found = tip(shell, 1e-4, *sides)[2]
    assert found == pytest.approx(1e-4 * 1e3 / (3 * 1.2e6 * 0.05**3 / 12) * (1 - poisson**2), rel=2e-3)


def test_the_elastica() -> None:
    """Sze, Liu & Lo (2004), 3.1: of second order, as with directors of unit length."""
    steel = vv.SaintVenantKirchhoff(young=1.2e6, poisson=0.0)
    error = []
    for n in (8, 16):
        u = tip(strip(vv.SolidSection(material=steel, thickness=0.1), (n, 1)), 4.0, step=0.2)
        error.append(float(np.hypot(u[0] + 3.2894, u[2] - 6.6996)))
    assert np.log2(error[0] / error[1]) > 1.7
    assert error[1] < 0.007


def test_a_thick_strip_of_rubber_bends_as_bricks_do() -> None:
    """A twentieth as thick as long, far bent, against quadratic cells with pressures."""
    rubber = vv.MooneyRivlin(c10=40.0, c01=10.0, bulk=1e5, isochoric=True)
    shell = strip(vv.SolidSection(material=rubber, thickness=0.5, points=3), (20, 1), formulation="mixed")
    sides = [vv.SymmetryPlane(solid=shell, nodes=side, normal=(0, 1, 0)) for side in ("y0", "y1")]
    found = tip(shell, 0.08, *sides, step=0.25)
    block = vv.Solid(
        mesh=vv.RectangleMesh(size=(10, 0.5), counts=(80, 2), cell="quad9"),
        material=rubber,
        formulation="mixed",
    )
    load = vv.Traction(solid=block, faces="x1", traction=(0, 0.16, 0), times="t")
    system = vv.System([block, vv.Fixed(solid=block, nodes="x0"), load])
    vv.quasi_static(system, until=1.0, step=0.25)
    u = block.displacements(system.x)[block.nodes("x1")].mean(axis=0)
    np.testing.assert_allclose(found[[0, 2]], u[:2], rtol=0.01)


def hemisphere(
    kind: Any, section: Any, n: int, force: float, step: float, **options: Any
) -> tuple[float, int]:
    """How far it is pulled out at its rim, MacNeal & Harder's, and the iterations it took."""
    flat = vv.RectangleMesh(size=(np.pi / 2, np.radians(72)), counts=(n, n)).build()
    a, b = flat.points.T
    points = 10.0 * np.stack([np.cos(b) * np.cos(a), np.cos(b) * np.sin(a), np.sin(b)], axis=1)
    shell = kind(mesh=vv.Mesh(points, flat.cells, face_sets=flat.face_sets), section=section, **options)
    x, y = (int(np.argmax(points[:, k])) for k in range(2))
    loads = [
        vv.Force(on=shell.point(points[k]), force=f, times="t")
        for k, f in ((x, (force, 0, 0)), (y, (0, -force, 0)))
    ]
    planes = [
        vv.SymmetryPlane(solid=shell, nodes=edge, normal=normal)
        for edge, normal in (("x0", (0, 1, 0)), ("x1", (1, 0, 0)))
    ]
    held = vv.Fixed(solid=shell, nodes=[x], directions=(False, False, True))
    system = vv.System([shell, *planes, held, *loads])
    result = vv.quasi_static(system, until=1.0, step=step)
    return float(shell.displacements(system.x)[x, 0]), result.statistics.iterations


@pytest.mark.parametrize("formulation", ["displacement", "mixed"])
def test_a_pinched_hemisphere_of_rubber(formulation: Any) -> None:
    """K/mu = 1e4, against directors of unit length with Poisson's ratio 0.49995: no locking."""
    E = 6.825e7
    rubber = vv.NeoHooke(shear=E / 3, bulk=1e4 * E / 3, isochoric=True)
    section = vv.SolidSection(material=rubber, thickness=0.04)
    expected, _ = hemisphere(
        vv.Shell, vv.HomogeneousSection(thickness=0.04, young=E, poisson=0.49995), 8, 1e-3, 1.0
    )
    found, _ = hemisphere(vv.ExtensibleShell, section, 8, 1e-3, 1.0, formulation=formulation)
    assert found == pytest.approx(expected, rel=0.01)


def test_iterations_do_not_grow_with_thinness() -> None:
    """Radius over thickness 100 to 1000, far bent: no more than 1.3 times those of directors of unit length."""
    E, more = 6.825e7, []
    for t in (0.1, 0.01):
        force = 200 * (t / 0.04) ** 3
        steel = vv.SaintVenantKirchhoff(young=E, poisson=0.3)
        far, found = hemisphere(
            vv.ExtensibleShell, vv.SolidSection(material=steel, thickness=t), 8, force, 0.1
        )
        other, few = hemisphere(
            vv.Shell, vv.HomogeneousSection(thickness=t, young=E, poisson=0.3), 8, force, 0.1
        )
        assert far == pytest.approx(other, rel=0.01)
        more.append(found / few)
    assert max(more) < 1.3


# --- dynamics -------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("poisson", [0.45, 0.5])
def test_free_flight(poisson: float) -> None:
    """Energy, momentum and angular momentum of a rubber shell that tumbles and swings, to round-off."""
    flat = vv.RectangleMesh(size=(1, 1.2), counts=(4, 4)).build()
    y, a = flat.points.T
    mesh = vv.Mesh(np.stack([np.sin(a), y, np.cos(a)], axis=1), flat.cells)
    rubber = vv.NeoHooke(young=1e4, poisson=poisson)
    shell = vv.ExtensibleShell(
        mesh=mesh,
        section=vv.SolidSection(material=rubber, thickness=0.05, density=10.0),
        formulation="mixed",
        velocity=lambda X: np.stack([0.3 * np.sin(3 * X[:, 1]), 0 * X[:, 0], 0.5 * X[:, 0]], axis=1),
        angular_velocity=(0.5, 1.0, -0.7),
    )
    ledger = vv.simulate(vv.System([shell]), until=2.0, step=0.01).ledger
    assert np.ptp(ledger["potential_stored"]) > 1e-3 * ledger["total"][0]
    for name in ("total", *(f"{kind}_{axis}" for kind in ("momentum", "angular") for axis in "xyz")):
        assert np.ptp(ledger[name]) < 1e-11 * abs(ledger["total"][0]), name


@pytest.mark.parametrize(("cell", "n"), [("quad4", 12), ("tri3", 32)])
def test_frequencies_of_a_plate(cell: Any, n: int) -> None:
    """Simply supported, w = pi^2 (m^2 + n^2) sqrt(D / m) for side 1: the first three, two of them alike."""
    steel = vv.SaintVenantKirchhoff(young=1e9, poisson=0.3)
    shell = vv.ExtensibleShell(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(n, n), cell=cell),
        section=vv.SolidSection(material=steel, thickness=0.005, density=1e3),
    )
    edges = [vv.Fixed(solid=shell, nodes=edge) for edge in ("x0", "x1", "y0", "y1")]
    found = 2 * np.pi * vv.modes(vv.System([shell, *edges]), 3).frequencies
    unit = np.pi**2 * np.sqrt(1e9 * 0.005**3 / 12 / (1 - 0.09) / 5.0)
    np.testing.assert_allclose(found / unit, (2, 5, 5), rtol=0.03)
