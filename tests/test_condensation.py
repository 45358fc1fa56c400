"""Unknowns of single elements leave the equations before they are solved, and nothing else changes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from catalogue.solids import flying
from numpy.typing import NDArray
from solid_parts import block

import visviva as vv
from visviva.model.field import Field
from visviva.system.problem import problem_of

Array = NDArray[np.float64]

SHAPES: dict[str, dict[str, Any]] = {
    "enhanced hex8": {"cell": "hex8", "counts": (2, 2, 1), "formulation": "enhanced"},
    "enhanced quad4": {"cell": "quad4", "counts": (3, 2), "formulation": "enhanced"},
    "enhanced, plane stress": {
        "cell": "quad4",
        "counts": (2, 2),
        "formulation": "enhanced",
        "plane": "stress",
    },
    "pressures of hex27": {"cell": "hex27", "counts": (1, 1, 2), "formulation": "mixed"},
    "pressures of quad9": {"cell": "quad9", "counts": (2, 2), "formulation": "mixed"},
}
SCHEMES = [
    vv.EnergyMomentum(),
    vv.Midpoint(),
    vv.VariationalMidpoint(),
    vv.BackwardEuler(),
    vv.GeneralizedAlpha(rho=0.8),
]
each_shape = pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES.keys())


@pytest.fixture
def uncondensed(monkeypatch: pytest.MonkeyPatch) -> Callable[[], Any]:
    """Once called, systems made from then on solve for all their unknowns."""

    def begin() -> None:
        monkeypatch.setattr(Field, "is_local", property(lambda f: False))
        none = property(lambda system: np.full(system.model.n_unknowns, -1, dtype=np.int32))
        monkeypatch.setattr(vv.System, "local", none)

    return begin


def held(shape: dict[str, Any]) -> list[Any]:
    """The solid on a wall, pulled and bent at its other end as time grows."""
    (solid,) = flying(**shape)
    assert isinstance(solid, vv.Solid)
    X = solid.grid.points
    left = np.argsort(X[:, 0])[: len(X) // 3]
    end = solid.points[np.argmax(X[:, 0])]
    pull = vv.Force(on=solid.point(end), force=(10.0, 20.0, 0.0), times="t")
    return [solid, vv.Fixed(solid=solid, nodes=left), pull]


def dynamics(shape: dict[str, Any], scheme: vv.Scheme) -> Array:
    system = vv.System(flying(**shape))
    result = vv.simulate(system, until=0.5, step=0.05, scheme=scheme)
    return np.array([*result.states, system.v])


@each_shape
@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda s: type(s).__name__)
def test_same_motion(shape: dict[str, Any], scheme: vv.Scheme, uncondensed: Callable[[], Any]) -> None:
    one = dynamics(shape, scheme)
    uncondensed()
    other = dynamics(shape, scheme)
    assert np.abs(one - other).max() < 2e-11 * np.abs(other).max()


@each_shape
@pytest.mark.parametrize("run", [vv.quasi_static, vv.arc_length], ids=lambda f: f.__name__)
def test_same_equilibria(shape: dict[str, Any], run: Any, uncondensed: Callable[[], Any]) -> None:
    def states() -> Array:
        return np.array(run(vv.System(held(shape)), until=1.0, step=0.5).states)

    one = states()
    uncondensed()
    other = states()
    assert np.abs(one - other).max() < 1e-11 * np.abs(other).max()


@each_shape
def test_same_modes(shape: dict[str, Any], uncondensed: Callable[[], Any]) -> None:
    def squared() -> Array:
        system = vv.System(held(shape))
        vv.quasi_static(system, until=1.0, step=0.5)
        system.v[:] = 0.0
        return vv.modes(system, 6).squared

    one = squared()
    uncondensed()
    other = squared()
    assert one == pytest.approx(other, rel=1e-9)


@each_shape
def test_what_is_solved_for(shape: dict[str, Any], uncondensed: Callable[[], Any]) -> None:
    system = vv.System(held(shape))
    assert system.core.n_equations < len(system.free_unknowns)
    assert "condensed" in system.core.solver
    system.choose_linear(inertia=False)
    assert problem_of(system).is_definite
    uncondensed()
    whole = vv.System(held(shape))
    assert whole.core.n_equations >= len(whole.free_unknowns)
    assert "condensed" not in whole.core.solver


@each_shape
@pytest.mark.parametrize("linear", [vv.Direct(), vv.Direct(library="eigen"), vv.Iterative(tolerance=1e-12)])
def test_every_solver(shape: dict[str, Any], linear: Any) -> None:
    expected = np.array(vv.quasi_static(vv.System(held(shape)), until=1.0, step=1.0).states)
    system = vv.System(held(shape), vv.Newton(linear=linear))
    states = np.array(vv.quasi_static(system, until=1.0, step=1.0).states)
    assert np.abs(states - expected).max() < 1e-9 * np.abs(expected).max()


def test_pressures_of_stiff_materials_stay() -> None:
    """Without its pressures a nearly incompressible material would cost the equations its digits."""
    for poisson, kept in ((0.4999, False), (0.4999999, True), (0.5, True)):
        material = vv.NeoHooke(shear=20.0, poisson=poisson)
        system = vv.System(held(SHAPES["pressures of quad9"] | {"material": material}))
        assert (system.core.n_equations >= len(system.free_unknowns)) == kept


def test_beside_rigid_bodies() -> None:
    """A body on a face of an enhanced solid: constraints stay among the equations."""

    def run(null_space: bool | None) -> Array:
        solid = block("quad4", (1, 1), formulation="enhanced")
        frame = vv.RigidCoupling(solid=solid, faces="x1")
        body = vv.PointMass(mass=0.7, position=(1.6, 0.2, 0.0), velocity=(0.0, 0.5, 0.0))
        rod = vv.Distance(a=frame.point(), b=body.point())
        system = vv.System([solid, frame, body, rod], vv.Newton(null_space=null_space))
        assert ("condensed" in system.core.solver) == (not null_space)
        return np.array(vv.simulate(system, until=0.5, step=0.05, project=True).states)

    one, other = run(None), run(True)
    assert np.abs(one - other).max() < 1e-10 * np.abs(other).max()
