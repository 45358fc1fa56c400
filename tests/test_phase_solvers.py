"""The iterative solver of mixtures finds what factors find, in as many iterations on any mesh and for any step."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv

pytest.importorskip("pyamg")
Array = NDArray[np.float64]


def alloy(mesh: Any, **options: Any) -> vv.CahnHilliard:
    given = {
        "free_energy": vv.DoubleWell(barrier=5.0, low=0.3, high=0.7),
        "gradient_energy": 2.0,
        "mobility": 5.0,
        "concentration": lambda X: 0.5 + 0.1 * np.cos(0.4 * X[:, 0]) * np.cos(0.3 * X[:, 1] + X[:, 2]),
        **options,
    }
    return vv.CahnHilliard(mesh=mesh, **given)


def end(body: vv.CahnHilliard, linear: Any, step: float, newton: float = 1e-11) -> Array:
    system = vv.System([body], vv.Newton(tolerance=newton, linear=linear))
    vv.simulate(system, until=2 * step, step=step)
    return system.x.copy()


def by_gmres(tolerance: float, most: int) -> vv.Iterative:
    return vv.Iterative(
        method="gmres", preconditioner="mixture", tolerance=tolerance, max_iterations=most, restart=most
    )


@pytest.mark.parametrize(
    ("cell", "options"),
    [
        ("hex8", {"periodic": [("x0", "x1"), ("z0", "z1")]}),
        ("tet10", {}),
        ("hex8", {"mobility": vv.DegenerateMobility(scale=5.0, low=0.1, high=0.9)}),
        ("hex8", {"free_energy": vv.FloryHuggins(chi=3.0, scale=0.2)}),
    ],
    ids=["periodic", "quadratic", "degenerate", "lumped"],
)
def test_gmres_finds_what_factors_find(cell: str, options: dict[str, Any]) -> None:
    n = 3 if cell == "tet10" else 6
    body = alloy(vv.BoxMesh(size=(6, 6, 6), counts=(n, n, n), cell=cell), **options)
    expected = end(body, vv.Direct(library="eigen"), 0.2)
    found = end(body, by_gmres(1e-9, 100), 0.2)
    assert np.abs(found - expected).max() < 1e-8


@pytest.mark.parametrize("n", [6, 12, 18])
@pytest.mark.parametrize("step", [1e-3, 0.1, 20.0])
def test_iterations_do_not_depend_on_mesh_and_step(n: int, step: float) -> None:
    """To six digits within 16, or the step fails: by a polynomial in short steps, by multigrid in long ones."""
    body = alloy(vv.BoxMesh(size=(12, 12, 12), counts=(n, n, n)), gradient_energy=16.0)
    end(body, by_gmres(1e-6, 16), step, newton=1e-7)


@pytest.mark.parametrize("unit", [1e-13, 1e13])
@pytest.mark.parametrize("step", [1e-3, 20.0])
def test_iterations_do_not_depend_on_units(unit: float, step: float) -> None:
    """Volumes of 1e-39 are nothing in single precision, those of 1e39 too much."""
    body = alloy(
        vv.BoxMesh(size=(12 * unit,) * 3, counts=(6, 6, 6)),
        gradient_energy=16.0 * unit**2,
        mobility=5.0 * unit**2,
        concentration=lambda X: 0.5 + 0.1 * np.cos(0.4 * X[:, 0] / unit) * np.cos(0.3 * X[:, 1] / unit),
    )
    end(body, by_gmres(1e-6, 16), step, newton=1e-7)


def test_what_is_no_mixture_is_refused() -> None:
    solid = vv.Solid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(3, 3, 3)),
        material=vv.NeoHooke(young=1.0, poisson=0.3),
        density=1.0,
    )
    system = vv.System([solid, vv.Gravity()], vv.Newton(linear=by_gmres(1e-6, 25)))
    with pytest.raises(vv.RunError, match="these are no contents with as many potentials"):
        vv.simulate(system, until=0.1, step=0.1)


def test_choice_by_size_and_dimension() -> None:
    """Mixtures in space from 15,000 equations on by GMRES, then factors; in the plane and smaller ones by factors."""

    def said(n: int, per_row: int) -> str:
        known = vv.linear.choice.Problem(n=n, n_entries=n * per_row, separates=True, has_inertia=True)
        return vv.Automatic().choose(known).explanation

    assert "GMRES to 0.01, preconditioner mixture; should it not converge, " in said(20_000, 54)
    assert "GMRES" not in said(10_000, 54)
    assert "GMRES" not in said(200_000, 18)
