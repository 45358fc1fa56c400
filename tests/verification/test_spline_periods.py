"""Periodic cells on splines: affine motions, shifts, eigenstrains beside quadratic cells, momenta."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from verification.test_spline_patches import half

Array = NDArray[np.float64]
ALL = (("x0", "x1"), ("y0", "y1"), ("z0", "z1"))
GRADIENT = np.array([(0.1, 0.2, 0.0), (0.0, -0.05, 0.1), (0.05, 0.0, 0.02)])
SOFT = vv.NeoHooke(young=10.0, poisson=0.3)
SIZE = np.array([1.0, 0.9, 1.1])


def box(degree: int, counts: tuple[int, ...] = (4, 4, 4), dimension: int = 3) -> vv.SplineBox:
    return vv.SplineBox(size=tuple(SIZE[:dimension]), counts=counts[:dimension], degree=degree)


def heavier(patch: vv.SplinePatch) -> vv.SplinePatch:
    """A rational one of the same places."""
    weights = np.ones(patch.control.shape[:-1])
    weights[1:-1, 1:-1] = 1.3
    return replace(patch, weights=weights, control=patch.control)


CELLS: dict[str, tuple[Any, tuple[tuple[str, str], ...]]] = {
    **{f"degree {p}": (box(p), ALL) for p in (1, 2, 3)},
    "plane": (box(4, (5, 6), 2), ALL[:2]),
    "rational": (heavier(box(2, dimension=2).parts()[0]), ALL[:2]),
    "joined": (
        vv.SplinePatches(patches=(half(3, 2, 0.0), half(3, 2, 1.0))),
        (("0.x0", "1.x1"), ("0.y0", "0.y1"), ("1.y0", "1.y1")),
    ),
}


@pytest.mark.parametrize("name", CELLS)
def test_a_uniform_cell_deforms_alike(name: str) -> None:
    mesh, pairs = CELLS[name]
    body = vv.SplineSolid(mesh=mesh, material=SOFT)
    d, G = body.dimension, GRADIENT.copy()
    G[d:], G[:, d:] = 0, 0
    sides = vv.PeriodicFaces(solid=body, pairs=pairs, strain=G, times="t")
    system = vv.System([body, sides, vv.Fixed(solid=body, nodes=[0])])
    vv.quasi_static(system, until=1.0, step=0.5)
    by_quadrature = 1e-6 if name == "rational" else 1e-9
    np.testing.assert_allclose(body.displacements(system.x), body.points @ G.T, atol=by_quadrature)


def smooth(p: int, n: int, pairs: tuple[tuple[str, str], ...], *more: Any, **options: Any) -> vv.System:
    """A cell whose splines go on beyond these sides, with what acts on it, held at a point."""
    size, counts = tuple(SIZE[: len(pairs)]), (n, *(p + 1,) * (len(pairs) - 1))
    body = vv.SplineSolid(
        mesh=vv.SplineBox(size=size, counts=counts, degree=p),
        **{"material": SOFT, "periodic": pairs, **options},
    )
    ground = vv.Ground()
    return vv.System([body, ground, vv.Spherical(a=ground, b=body, at=(0, 0, 0)), *(f(body) for f in more)])


def sides(pairs: tuple[tuple[str, str], ...], G: Any) -> Any:
    return lambda body: vv.PeriodicFaces(solid=body, pairs=pairs, strain=G, times="t")


@pytest.mark.parametrize(("p", "dimension"), [(1, 2), (2, 2), (3, 2), (4, 2), (2, 3)])
def test_a_smooth_uniform_cell_deforms_alike(p: int, dimension: int) -> None:
    G = GRADIENT.copy()
    G[dimension:], G[:, dimension:] = 0, 0
    system = smooth(p, p + 1, ALL[:dimension], sides(ALL[:dimension], G))
    vv.quasi_static(system, until=1.0, step=0.5)
    body = system.components[0]
    np.testing.assert_allclose(body.displacements(system.x), body.points @ G.T, atol=1e-9)


def waved(p: int, n: int, shift: float, pairs: Any = ALL[:2]) -> tuple[Array, Array, Array]:
    """Places, displacements along x, and what they are, of a bar pulled by a wave of forces, which is their wave."""
    k = 2 * np.pi / SIZE[0]
    wave = lambda x: 1e-2 * np.sin(k * x + shift)  # noqa: E731

    def pull(body: Any) -> vv.BodyForce:
        return vv.BodyForce(solid=body, force=lambda t, X: 10.0 * wave(X[:, :1]) * [1, 0, 0])

    steel = vv.LinearElastic(young=10.0, poisson=0.0)
    system = smooth(p, n, ALL[:2], sides(ALL[:2], (0.01, 0, 0)), pull, material=steel, periodic=pairs)
    vv.quasi_static(system, until=1.0, step=1.0)
    body = system.components[0]
    x = body.points[:, 0]
    return x, body.displacements(system.x)[:, 0], 0.01 * x + (wave(x) - wave(0.0)) / k**2


@pytest.mark.parametrize("p", [2, 3, 4])
def test_waves_that_go_on_beyond_smooth_sides_have_the_order_of_splines(p: int) -> None:
    errors = [np.abs(u - exact).max() for _, u, exact in (waved(p, n, 0.7) for n in (6, 12))]
    assert errors[0] < 1e-5
    assert np.log2(errors[0] / errors[1]) > p + 0.9


@pytest.mark.parametrize("p", [2, 3, 4])
def test_smooth_sides_are_places_as_others(p: int) -> None:
    """A wave of forces moved by one span moves what it does by one span, to rounding; with places alone it does not."""
    n, off = 6, []
    for pairs in (ALL[:2], ()):
        found = []
        for shift in (0.7, 0.7 - 2 * np.pi / n):
            x, u, _ = waved(p, n, shift, pairs)
            _, once = np.unique(x.round(9), return_index=True)
            found.append((u - 0.01 * x)[once][:-1])
        moved = np.roll(found[0], len(found[0]) // n)
        off.append(np.ptp(moved - found[1]) / np.ptp(found[0]))
    assert off[0] < 1e-9
    assert off[1] > 1e-6


def test_a_smooth_cell_that_swings_keeps_energy_and_momentum() -> None:
    body = vv.SplineSolid(
        mesh=box(2, dimension=2),
        material=SOFT,
        density=1.0,
        periodic=ALL[:2],
        velocity=lambda X: np.sin(2 * np.pi * X[:, :1] / SIZE[0]) * [0.5, 0.3, 0] + [0.2, 0, 0],
    )
    system = vv.System([body, vv.PeriodicFaces(solid=body, pairs=ALL[:2])])
    result = vv.simulate(system, until=0.5, step=0.02)
    assert result.conservation()["energy"] < 1e-11
    momenta = np.array([result.ledger[f"momentum_{c}"] for c in "xy"])
    assert np.ptp(momenta, axis=1).max() < 1e-11 * np.abs(momenta).max()
    assert np.ptp(result.ledger["kinetic"]) > 0.1 * result.ledger["kinetic"].max()


def test_refusals_of_smooth_sides() -> None:
    body = vv.SplineSolid(mesh=box(2, dimension=2), material=SOFT, periodic=ALL[:1])
    with pytest.raises(
        vv.InputError, match=r"SplineSolid.*periodic = \('x0', 'x1'\) joins nothing by itself"
    ):
        vv.System([body])
    with pytest.raises(vv.InputError, match=r"SplineSolid.*nothing says that it is smooth across the ends"):
        vv.SplineSolid(mesh=box(2, dimension=2).parts()[0], material=SOFT, periodic=ALL[:1])
    body = vv.SplineSolid(mesh=box(2, dimension=2), material=SOFT, periodic=ALL[:1])
    parts = [body, vv.PeriodicFaces(solid=body, pairs=ALL[:1]), vv.Fixed(solid=body, nodes=[0])]
    with pytest.raises(vv.InputError, match="attach a point to it"):
        vv.System(parts)


def swollen(mesh: Any, shift: Array, solid: Any = vv.SplineSolid, **options: Any) -> vv.Solid:
    """A cell with a round inclusion that grows, smoothly, its centre moved by a shift."""

    def strain(X: Array) -> Array:
        waves = np.cos(2 * np.pi * (X - shift) / SIZE)[:, : 2 if np.ptp(X[:, 2]) == 0 else 3]
        return np.asarray(0.05 * np.exp(2 * (waves.mean(axis=1) - 1)))

    return solid(mesh=mesh, material=SOFT, thermal_strain=strain, **options)


def sheared(body: vv.Solid) -> tuple[float, float]:
    """Energy of a cell without and with shear."""
    d = body.dimension
    G = np.zeros((3, 3))
    G[0, 1] = 0.2
    sides = vv.PeriodicFaces(solid=body, pairs=ALL[:d], strain=G, times="t")
    system = vv.System([body, sides, vv.Fixed(solid=body, nodes=[0])])
    energy = vv.quasi_static(system, until=1.0, step=0.5).ledger["potential_strain"]
    return float(energy[0]), float(energy[-1])


def test_shifts_change_less_on_finer_cells() -> None:
    """Sides are continuous, not smooth: an inclusion that they cut differs from one inside as cells are coarse."""
    off = []
    for n in (6, 12):
        found = [
            sheared(swollen(box(3, (n, n), 2), shift))[1] for shift in (0 * SIZE, SIZE * [0.5, 1 / 3, 0])
        ]
        off.append(abs(found[0] / found[1] - 1))
    assert off[0] < 1e-3
    assert np.log2(off[0] / off[1]) > 4


def test_an_inclusion_is_that_of_quadratic_cells() -> None:
    shift = SIZE * [0.1, 0.2, 0.3]
    cells = sheared(swollen(vv.BoxMesh(size=tuple(SIZE), counts=(5, 5, 5), cell="hex27"), shift, vv.Solid))
    errors = [abs(sheared(swollen(box(2, (n, n, n)), shift))[1] / cells[1] - 1) for n in (3, 5)]
    assert errors[1] < 2e-4
    assert errors[1] < errors[0] / 8


def alloy(solid: Any, mesh: Any, shift: Array, **options: Any) -> Any:
    return solid(
        mesh=mesh,
        material=SOFT,
        free_energy=vv.DoubleWell(barrier=5.0, low=0.3, high=0.7),
        gradient_energy=0.4,
        mobility=0.1,
        reference=0.5,
        moduli=(0.8, 0.5),
        eigenstrain=0.1,
        concentration=lambda X: (
            0.5
            + 0.15
            * np.cos(2 * np.pi * (X - shift) / SIZE)[:, : 2 if np.ptp(X[:, 2]) == 0 else 3].mean(axis=1)
        ),
        **options,
    )


def relaxed(body: Any) -> tuple[float, float]:
    """Elastic energy and mass of a sheared cell of two phases, one stiffer than the other."""
    G = np.zeros((3, 3))
    G[0, 1] = 0.1
    sides = vv.PeriodicFaces(solid=body, pairs=ALL[: body.dimension], strain=G, times="t/0.06")
    system = vv.System([body, sides, vv.Fixed(solid=body, nodes=[0])])
    vv.simulate(system, until=0.06, step=0.02, scheme=vv.BackwardEuler())
    return body.elastic_energy(system.x), body.integral(system.x)


@pytest.mark.parametrize(("degree", "dimension"), [(2, 2), (3, 2), (2, 3)])
def test_two_phases_are_those_of_quadratic_cells_wherever_they_are(degree: int, dimension: int) -> None:
    counts, pairs, size = (6, 5, 5)[:dimension], ALL[:dimension], tuple(SIZE[:dimension])
    mesh: Any = vv.BoxMesh if dimension == 3 else vv.RectangleMesh
    fine, cell = ((5, 5, 5), "hex27") if dimension == 3 else ((12, 12), "quad9")
    cells = mesh(size=size, counts=fine, cell=cell)
    plain = relaxed(alloy(vv.MixtureSolid, cells, 0 * SIZE, periodic=pairs))
    for shift in (0 * SIZE, SIZE * np.array([3 / 6, 2 / 5, 1 / 5]) * (np.arange(3) < dimension)):
        found = relaxed(alloy(vv.SplineMixtureSolid, box(degree, counts, dimension), shift, periodic=pairs))
        np.testing.assert_allclose(found, plain, rtol=2e-3)


def test_a_cell_that_swings_keeps_energy_and_momentum() -> None:
    body = vv.SplineSolid(
        mesh=box(3), material=SOFT, density=1.0, velocity=lambda X: np.sin(2 * np.pi * X / SIZE) * 0.2
    )
    system = vv.System([body, vv.PeriodicFaces(solid=body, pairs=ALL)])
    figures = vv.simulate(system, until=0.4, step=0.02, project=True).conservation()
    assert figures["energy"] < 1e-10
    assert max(figures[f"momentum_{c}"] for c in "xyz") < 1e-11


def test_plates_may_hold_edges_of_both_sides() -> None:
    """Simple shear between plates: ``F = 1 + g e1 e2``."""
    body = vv.SplineSolid(mesh=box(2), material=vv.SaintVenantKirchhoff(young=10.0, poisson=0.25))
    g = 0.3
    plates = [
        vv.Fixed(solid=body, nodes="y0"),
        vv.Prescribed(solid=body, nodes="y1", motion=(f"{0.9 * g}*t", "0", "0")),
    ]
    sides = vv.PeriodicFaces(solid=body, pairs=(ALL[0], ALL[2]))
    result = vv.quasi_static(vv.System([body, *plates, sides]), until=1.0, step=0.5)
    E = 0.5 * np.array([[0, g, 0], [g, g**2, 0], [0, 0, 0]])
    density = 4.0 * (np.trace(E) ** 2 / 2 + np.tensordot(E, E))  # both constants of Lame are 4
    assert result.ledger["potential_strain"][-1] == pytest.approx(0.99 * density, rel=1e-9)


def uneven() -> vv.SplinePatch:
    """Weights and control points of one side differ from those of the other, nodes of its corners do not."""
    patch = box(2, dimension=2).parts()[0]
    weights = np.ones(patch.control.shape[:-1])
    weights[-1, 3] = 1.2
    return replace(patch, weights=weights)


@pytest.mark.parametrize(
    ("mesh", "pairs", "words"),
    [
        (uneven(), ALL[:2], "do not meet those of 'x1'"),
        (box(2), (("x0", "y1"),), "do not meet those of 'y1'"),
    ],
)
def test_refusals(mesh: Any, pairs: Any, words: str) -> None:
    with pytest.raises(vv.InputError, match=re.escape(words)):
        vv.PeriodicFaces(solid=vv.SplineSolid(mesh=mesh, material=SOFT), pairs=pairs)


def test_strain_between_plates_that_stay_is_refused() -> None:
    body = vv.SplineSolid(mesh=box(2), material=SOFT)
    sides = vv.PeriodicFaces(solid=body, pairs=ALL[:1], strain=(0.1, 0, 0), times="t")
    with pytest.raises(vv.InputError, match="hold those of one side alone"):
        vv.System([body, sides, vv.Fixed(solid=body, nodes="y0")])
