"""Bodies whose cells turn inside out: all kinds of solids refuse them, as `Solid` does."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import visviva as vv
from visviva.body.inverted import determinants

GIVEN: dict[str, Any] = {
    "mesh": vv.RectangleMesh(size=(1, 1), counts=(4, 4)),
    "material": vv.SaintVenantKirchhoff(young=2000.0, poisson=0.3),
    "density": 1.0,
    "velocity": (0, -20.0, 0),
}
KINDS: dict[str, Callable[[], Any]] = {
    "solid": lambda: vv.Solid(**GIVEN),
    "cracks": lambda: vv.FracturingSolid(**GIVEN, toughness=1e6, length=0.5, model="AT1"),
    "mixture": lambda: vv.MixtureSolid(
        **GIVEN,
        free_energy=vv.PolynomialEnergy(coefficients=(0, 0, 1.0)),
        gradient_energy=0.1,
        concentration=0.5,
        eigenstrain=0.0,
        reference=0.5,
    ),
    "heat": lambda: vv.ThermoelasticSolid(
        **GIVEN, heat=vv.Heat(conductivity=1.0, capacity=1.0), temperature=300.0
    ),
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.BackwardEuler()], ids=str)
def test_what_is_thrown_so_fast_that_cells_turn_inside_out_is_refused(kind: str, scheme: vv.Scheme) -> None:
    """With cracks, heat or concentrations it went on with a determinant of -1, and the audit said "conserved"."""
    body, plane = KINDS[kind](), vv.Plane(at=(0, -0.5, 0), normal=(0, 1, 0))
    system = vv.System([body, plane, vv.Contact(first=body, first_faces="y0", second=plane)])
    with pytest.raises(vv.StepFailure, match=r"element \d+ of .* is inverted"):
        vv.simulate(system, until=0.075, step=0.004, scheme=scheme)


def test_broken_cells_may_turn() -> None:
    """Where all of a cell is cracked nothing holds it, and no body is there."""
    body = vv.FracturingSolid(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(4, 4)),
        material=vv.SaintVenantKirchhoff(young=1.0, poisson=0.3),
        toughness=1e6,
        length=0.5,
        damage=lambda X: (np.abs(X[:, 1] - 0.5) < 0.2).astype(float),
    )
    system = vv.System([body])
    x = system.x.copy()
    flat = body.positions(x)
    for height, told in ((0.5, ""), (0.25, "is inverted")):
        nodes = np.flatnonzero(np.abs(flat[:, 1] - height) < 1e-9)
        x[body.node_unknowns(nodes) + 1] -= 0.3
        assert told in body.invalid(x)
        assert bool(told) == bool(body.invalid(x))


@pytest.mark.parametrize("n", [2, 3])
def test_determinants(n: int) -> None:
    F = np.random.default_rng(n).normal(size=(5, 4, n, n))
    assert determinants(F) == pytest.approx(np.linalg.det(F))
