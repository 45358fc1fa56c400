"""Iterative solvers of flows find what factors find."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from flow_parts import enclosed, stream
from numpy.typing import NDArray

import visviva as vv

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
    """Flows in space from 15,000 equations on by GMRES, then factors; in the plane and smaller ones by factors."""

    def said(n: int, per_row: int) -> str:
        known = vv.linear.choice.Problem(n=n, n_entries=n * per_row, n_multipliers=n // 20, has_flow=True)
        return vv.Automatic().choose(known).explanation

    assert "GMRES to 0.001, preconditioner commutator; should it not converge, " in said(20_000, 150)
    assert "GMRES" not in said(10_000, 150)
    assert "GMRES" not in said(200_000, 40)


def test_factors_of_a_flow_that_do_not_fit_are_refused_before_they_are_made() -> None:
    if vv.linear.choice.missing_pardiso():
        pytest.skip("factors of Eigen are not estimated")
    system = vv.System(stream("hex27"), vv.Newton(linear=vv.Direct(library="pardiso", memory_limit=1e4)))
    with pytest.raises(
        vv.InputError, match=r"equations needs about .* GB, and 1e-05 GB are available.*Iterative"
    ):
        vv.simulate(system, until=0.1, step=0.1)
