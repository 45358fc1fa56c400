"""Bodies whose cells turn inside out: all kinds of solids refuse them, as `Solid` does."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import visviva as vv

GIVEN: dict[str, Any] = {
    "mesh": vv.RectangleMesh(size=(1, 1), counts=(4, 4)),
    "material": vv.SaintVenantKirchhoff(young=2000.0, poisson=0.3),
    "density": 1.0,
    "velocity": (0, -20.0, 0),
}
BRANCHES = vv.prony((0.5,), (0.1,))
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


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.BackwardEuler(), vv.BDF2()], ids=str)
def test_creep_does_not_go_on_inside_out(scheme: vv.Scheme) -> None:
    """A cell all of whose nodes are led, its upper side through the lower one at t = 0.5."""
    body = vv.ViscoelasticSolid(
        **{**GIVEN, "mesh": vv.RectangleMesh(size=(1, 1), counts=(1, 1))}, branches=BRANCHES
    )
    led = vv.Prescribed(solid=body, nodes="y1", motion=("0", "-2*t", None))
    system = vv.System([body, vv.Fixed(solid=body, nodes="y0"), led])
    with pytest.raises(vv.StepFailure, match=r"t = 0\.[45].*element 0 of .* is inverted"):
        vv.simulate(system, until=1.0, step=0.1, scheme=scheme)


def mixed(**given: Any) -> dict[str, Any]:
    mixing = {"gradient_energy": 0.1, "concentration": 0.5, "eigenstrain": 0.0, "reference": 0.5}
    return {**given, **mixing, "free_energy": vv.PolynomialEnergy(coefficients=(0, 0, 1.0))}


CRACKS: dict[str, Any] = {"toughness": 1e6, "length": 0.5}
WARM: dict[str, Any] = {"heat": vv.Heat(conductivity=1.0, capacity=1.0), "temperature": 300.0}
STEEL: dict[str, Any] = {"material": GIVEN["material"]}
BOX: dict[str, Any] = {**STEEL, "mesh": vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2))}
RING: dict[str, Any] = {
    **STEEL,
    "mesh": vv.RectangleMesh(size=(1, 1), counts=(2, 2), origin=(1, 0)),
    "plane": "axisymmetric",
}
SPLINES: dict[str, Any] = {**STEEL, "mesh": vv.SplineBox(size=(1, 1), counts=(2, 2), degree=2)}
SHAPES: dict[str, Callable[[], Any]] = {
    "cracks": lambda: vv.FracturingSolid(**BOX, **CRACKS),
    "cracks of revolution": lambda: vv.FracturingSolid(**RING, **CRACKS),
    "warm cracks of revolution": lambda: vv.ThermalFracturingSolid(**RING, **CRACKS, **WARM),
    "mixture": lambda: vv.MixtureSolid(**mixed(**BOX)),
    "mixture on splines": lambda: vv.SplineMixtureSolid(**mixed(**SPLINES)),
    "heat of revolution": lambda: vv.ThermoelasticSolid(**RING, **WARM),
    "enhanced heat": lambda: vv.ThermoelasticSolid(**BOX, **WARM, formulation="enhanced"),
    "warm sheet": lambda: vv.ThermoelasticSolid(**STEEL, **WARM, mesh=GIVEN["mesh"], plane="stress"),
    "warm creep": lambda: vv.ThermoviscoelasticSolid(**BOX, **WARM, branches=BRANCHES),
}


def moved(body: Any, to: Callable[[Any], Any]) -> Any:
    """Unknowns of a system of a body alone whose positions (n, 3) have been moved."""
    x = vv.System([body]).x.copy()
    every = np.arange(len(body.carriers.vectors(x)))
    x[body.carriers.unknowns(every)[:, None] + np.arange(body.dimension)] = to(body.carriers.vectors(x))[
        :, : body.dimension
    ]
    return x


@pytest.mark.parametrize("kind", SHAPES)
def test_what_is_strained_but_not_turned_is_taken(kind: str) -> None:
    """To a fifth of its width, three times its height, and sheared by more than that."""
    F = np.array([[0.2, 0, 0], [4.0, 3.0, 0], [0, 0, 1.0]])
    body = SHAPES[kind]()
    assert body.invalid(moved(body, lambda X: X @ F.T)) == ""


@pytest.mark.parametrize("kind", SHAPES)
def test_what_is_turned_is_told_with_its_ratio_of_volumes(kind: str) -> None:
    """Also what is beyond its axis, where the plane part is right: J = 2 (2 - 5 / r)."""
    body, radial = SHAPES[kind](), "revolution" in kind
    x = moved(body, lambda X: X * [2, 1, 1] - [5, 0, 0] if radial else X * [-2.0, 1, 1])
    if not radial:
        assert "is inverted (det F = -2)" in body.invalid(x)
    else:
        told = float(body.invalid(x).split("= ")[1][:-1])
        assert 2 * (2 - 5 / 1.0) < told < 2 * (2 - 5 / 1.2)
    assert body.trouble(x).startswith(body.invalid(x))


def cracked(broken: Callable[[Any], Any]) -> vv.FracturingSolid:
    return vv.FracturingSolid(**STEEL, mesh=GIVEN["mesh"], **CRACKS, damage=lambda X: broken(X).astype(float))


@pytest.mark.parametrize(
    ("broken", "told"),
    [
        (lambda X: (X[:, 1] > 0.2) & (X[:, 1] < 0.6), False),
        (lambda X: np.abs(X[:, 1] - 0.5) < 0.1, True),
        (lambda X: np.abs(X - [0.5, 0.5, 0]).max(axis=1) < 0.1, True),
    ],
    ids=["cells", "line", "node"],
)
def test_broken_cells_may_turn(broken: Callable[[Any], Any], told: bool) -> None:
    """Where all of a cell is cracked nothing holds it; those beside a line of nodes or at one node still carry."""
    body = cracked(broken)
    x = moved(body, lambda X: np.where((np.abs(X - [0, 0.5, 0]) < 0.01)[:, [1]], X - [0, 0.3, 0], X))
    if told:
        assert "is inverted (det F = -0.2)" in body.invalid(x)
    else:
        assert body.invalid(x) == ""


def test_what_is_no_number_is_told_before_what_is_flat() -> None:
    """Any cell of a later type took its place, however little it was strained: element 4 is nearly flat (det F = 1)."""
    four = vv.RectangleMesh(size=(1, 1), counts=(2, 2)).build()
    three = vv.RectangleMesh(size=(1, 1), counts=(2, 2), origin=(1, 0), cell="tri3").build()
    mesh = four.merged(three, weld=1e-6)
    bodies = vv.Solid(**STEEL, mesh=mesh), vv.FracturingSolid(**STEEL, **CRACKS, mesh=mesh)
    for body, ask in zip(bodies, (bodies[0].trouble, bodies[1].invalid), strict=True):
        found = ask(moved(body, lambda X: np.where((X == 0).all(axis=1)[:, None], np.nan, X)))
        assert found.startswith("element 0 of")
        assert found.endswith("is of no finite volume (det F = nan)")
