"""Mechanics and heat in turn: the solution, the laws and the bits of all at once."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp
from catalogue.thermal import brick, plain
from numpy.typing import NDArray

import visviva as vv
from visviva import _core
from visviva.linear.choice import Choice, Direct, Problem
from visviva.linear.staggered import Halves

Array = NDArray[np.float64]
IN_TURN = vv.Newton(linear=vv.Staggered())


def halves(A: sp.csr_array, is_heat: NDArray[np.int32]) -> Choice:
    """Factors of both halves of a matrix, and of all of it should turns not converge."""
    parts = [Problem(n=int(np.sum(is_heat == k)), n_entries=A.nnz) for k in (0, 1)]
    whole = Problem(n=A.shape[0], n_entries=A.nnz)
    return vv.Staggered(tolerance=1e-13, heat=Direct()).choose_in_turn(whole, Halves(*parts, is_heat))


@pytest.mark.parametrize(("coupling", "turns"), [(0.0, True), (0.5, True), (3.0, False)])
def test_turns_solve_the_equations(coupling: float, turns: bool) -> None:
    rng, n = np.random.default_rng(1), 60
    A = sp.random_array((n, n), density=0.1, rng=rng).toarray()
    is_heat = rng.integers(0, 2, n).astype(np.int32)
    across = is_heat[:, None] != is_heat
    A = A + 6 * np.eye(n)
    A[across] *= coupling
    A = sp.csr_array(A)
    row, col = A.indptr.astype(np.int64), A.indices.astype(np.int32)
    empty = np.zeros(0, np.int32)
    solver = _core.Linear(
        list(halves(A, is_heat).in_order), row, col, empty, np.zeros(0), np.zeros(n, np.int32)
    )
    b, x = rng.normal(size=n), np.zeros(n)
    assert solver.factor(A.data)
    assert solver.solve(b, x)
    assert np.abs(A @ x - b).max() < 1e-11
    assert ("in turn" in solver.name) == turns


def joined() -> list[Any]:
    """A rubber with enhanced strains on a hinge, warmed through a tie and held warm elsewhere."""
    rubber = brick(formulation="enhanced")
    end = vv.RigidCoupling(solid=rubber, faces="x0")
    mesh = vv.BoxMesh(size=(0.5, 1.0, 1.0), counts=(1, 2, 2), origin=(1.0, -0.1, -0.2))
    stove = vv.ThermalBody(mesh=mesh, conductivity=2.0, temperature=30.0)
    return [
        rubber,
        end,
        vv.Revolute(a=vv.Ground(), b=end, at=(0.0, 0.4, 0.3), axis=(0, 0, 1)),
        stove,
        vv.HeatTie(first=rubber, second=stove, first_faces="x1", second_faces="x0"),
        vv.PrescribedTemperature(body=rubber, nodes="y1", value="20 + t"),
        vv.Gravity(acceleration=(0, -3.0, 0)),
    ]


CASES: dict[str, Callable[[], list[Any]]] = {
    "free": lambda: [brick()],
    "all that has temperatures": plain,
    "joined": joined,
    "quadratic": lambda: [brick("hex20")],
}


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.BDF2()], ids=["energy-momentum", "BDF2"])
@pytest.mark.parametrize("name", CASES)
def test_steps_are_those_of_all_at_once(name: str, scheme: vv.Scheme) -> None:
    at_once, in_turn = vv.System(CASES[name]()), vv.System(CASES[name](), IN_TURN)
    results = [
        vv.simulate(system, until=0.3, step=0.03, scheme=scheme, project=True)
        for system in (at_once, in_turn)
    ]
    assert "in turn" in in_turn.core.solver
    scale = np.abs(at_once.x).max()
    assert np.abs(at_once.x - in_turn.x).max() < 1e-10 * scale
    assert results[0].statistics.steps == results[1].statistics.steps


def test_statics_are_those_of_all_at_once() -> None:
    """Coupling number 1.25: turns contract by a half and get there all the same."""
    found = []
    for newton in (None, IN_TURN):
        heat = vv.Heat(conductivity=1.0, capacity=1e3, expansion=3e-3)
        mesh = vv.BoxMesh(size=(1, 1, 1), counts=(3, 3, 3))
        body = vv.ThermoelasticSolid(
            mesh=mesh, material=vv.NeoHooke(young=1e5, poisson=0.3), density=1.0, heat=heat
        )
        held = [
            vv.Fixed(solid=body, nodes="x0"),
            vv.PrescribedTemperature(body=body, nodes="x0", value=293.15),
        ]
        system = vv.System([body, *held, vv.HeatFlux(body=body, faces="x1", flux=20.0)], newton)
        vv.quasi_static(system, until=1.0, step=0.5)
        found.append(system.x.copy())
    assert "in turn" in system.core.solver
    assert not system.core.linear_message
    assert np.abs(found[0] - found[1]).max() < 1e-9 * np.abs(found[0]).max()


def test_memory_decides_every_bit() -> None:
    """A system that is told another's state and memory goes on to the last bit, also where factors have taken over."""
    strong = vv.Heat(conductivity=0.5, capacity=0.05, expansion=0.03, reference=20.0)
    for heat in (None, strong):
        more = {"heat": heat} if heat else {}
        one, other = (vv.System([brick(**more)], IN_TURN) for _ in range(2))
        for system in (one, other):
            system.step(0.03)
        for _ in range(3):
            one.step(0.03)
        for name in "xvaw":
            getattr(other.core, name)[:] = getattr(one.core, name)
        other.time = one.time
        other.core.restore(one.core.memory())
        for system in (one, other):
            system.step(0.03)
        assert np.array_equal(one.x, other.x)
        assert ("in turn" in one.core.solver) == (heat is None)


def test_nothing_to_solve_in_turn_is_refused() -> None:
    ball = vv.PointMass(mass=1.0)
    with pytest.raises(vv.InputError, match="Staggered: nothing here both deforms and has temperatures"):
        vv.System([ball], IN_TURN)


def test_laws_hold() -> None:
    system = vv.System([brick()], IN_TURN)
    ledger = vv.simulate(system, until=3.0, step=0.03).ledger
    energy, entropy = ledger["total"], ledger["entropy"]
    assert np.abs(energy - energy[0]).max() < 1e-12 * abs(energy[0])
    assert np.diff(entropy).min() > 0
