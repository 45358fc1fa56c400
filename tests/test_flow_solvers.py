"""Iterative solvers of flows find what factors find."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from flow_parts import enclosed, stream
from immersed_parts import carried
from numpy.typing import NDArray

import visviva as vv
from visviva.analysis.march import prepare
from visviva.system.problem import problem_of

Array = NDArray[np.float64]
FACTORS = vv.Direct(library="eigen")


def end(parts: list[Any], linear: Any, scheme: vv.Scheme) -> Array:
    system = vv.System(parts, vv.Newton(tolerance=1e-11, linear=linear, keep_factor=0.0))
    if isinstance(scheme, vv.Static):
        vv.quasi_static(system, until=1.0, step=0.5, scheme=scheme)
    else:
        vv.simulate(system, until=0.2, step=0.05, scheme=scheme)
    return system.x.copy()


@pytest.mark.parametrize("scheme", [vv.Midpoint(), vv.Static()], ids=str)
@pytest.mark.parametrize("preconditioner", ["saddle", "incomplete", "commutator"])
@pytest.mark.parametrize(
    ("make", "cell"), [(stream, "quad9"), (enclosed, "quad9"), (stream, "hex27"), (stream, "tri3")]
)
def test_gmres_finds_what_factors_find(make: Any, cell: str, preconditioner: Any, scheme: vv.Scheme) -> None:
    """Drag, lift and pressures too: all unknowns are compared."""
    gmres = vv.Iterative(method="gmres", preconditioner=preconditioner, tolerance=1e-8)
    expected, found = (end(make(cell), linear, scheme) for linear in (FACTORS, gmres))
    assert np.abs(found - expected).max() < 1e-7 * np.abs(expected).max()


def test_choice_by_size_and_dimension() -> None:
    """Flows in space from 6,000 equations on by GMRES, then factors; in the plane and smaller ones by factors."""

    def said(n: int, per_row: int) -> str:
        known = vv.linear.choice.Problem(n=n, n_entries=n * per_row, n_multipliers=n // 20, has_flow=True)
        return vv.Automatic().choose(known).explanation

    assert "GMRES to 0.001, preconditioner commutator; should it not converge, " in said(7_000, 150)
    assert "GMRES" not in said(5_000, 150)
    assert "GMRES" not in said(200_000, 40)


def test_factors_of_a_flow_that_do_not_fit_are_refused_before_they_are_made() -> None:
    if vv.linear.choice.missing_pardiso():
        pytest.skip("factors of Eigen are not estimated")
    system = vv.System(stream("hex27"), vv.Newton(linear=vv.Direct(library="pardiso", memory_limit=1e4)))
    with pytest.raises(
        vv.InputError, match=r"equations needs about .* GB, and 1e-05 GB are available.*Iterative"
    ):
        vv.simulate(system, until=0.1, step=0.1)


def lid_driven(n: int, cell: Any) -> list[Any]:
    """A box of n x n x n cells whose lid moves."""
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(n, n, n), cell=cell)
    fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=0.01, speed=1.0)
    lid = vv.VelocityBoundary(
        fluid=fluid, faces="y1", velocity=lambda t, X: np.sin(np.pi * X[:, :1]) * [1, 0, 0]
    )
    return [fluid, lid, *(vv.NoSlip(fluid=fluid, faces=s) for s in fluid.grid.face_sets if s != "y1")]


def few_iterations(limit: int, tolerance: float = 1e-3) -> vv.Iterative:
    """Those of a flow, which fail beyond the limit."""
    return vv.Iterative(
        method="gmres", preconditioner="commutator", tolerance=tolerance, max_iterations=limit, restart=limit
    )


def step(parts: list[Any], linear: Any, lengths: tuple[float, ...]) -> Array:
    system = vv.System(parts, vv.Newton(tolerance=1e-8, linear=linear))
    prepare(system, vv.Midpoint())
    for h in lengths:
        system.step(h, vv.Midpoint())
    return system.x.copy()


@pytest.mark.skipif(not vv.linear.choice.has_multigrid(), reason="PyAMG makes the aggregates")
def test_multigrid_of_the_pressures_finds_what_factors_find() -> None:
    """From some thousand pressures on a cycle of multigrid stands for their factors."""
    expected = step(lid_driven(13, "hex8"), vv.Direct(), (0.05, 0.05))
    found = step(lid_driven(13, "hex8"), few_iterations(60, 1e-9), (0.05, 0.05))
    assert np.abs(found - expected).max() < 1e-6 * np.abs(expected).max()


@pytest.mark.skipif(not vv.linear.choice.has_multigrid(), reason="PyAMG makes the aggregates")
@pytest.mark.parametrize("n", [13, 20])
def test_iterations_do_not_grow_with_the_mesh(n: int) -> None:
    """Steps in which the lid passes a cell need five iterations, whatever the mesh."""
    step(lid_driven(n, "hex8"), few_iterations(8), (1 / n, 1 / n))


def test_pressures_follow_the_length_of_the_step() -> None:
    """The matrix of the pressures is inverse to the length; that of another one would take many iterations."""
    step(lid_driven(4, "hex8"), few_iterations(8), (1.0, 1e-4, 1e-4))


def test_flows_that_carry_solids_are_solved_as_flows() -> None:
    """The nodes of the solid have left the equations."""
    system = vv.System(carried("hex8"))
    prepare(system, vv.EnergyMomentum())
    assert problem_of(system).has_flow


def test_gmres_finds_what_factors_find_where_a_solid_is_carried() -> None:
    """All unknowns: those of the solid follow from the fluid's."""
    exact = few_iterations(60, 1e-9)
    expected, found = (step(carried("hex8", 6), linear, (0.05, 0.05)) for linear in (vv.Direct(), exact))
    assert np.abs(found - expected).max() < 1e-7 * np.abs(expected).max()
