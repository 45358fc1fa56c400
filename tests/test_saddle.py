"""Iterations with exact constraints as preconditioner against a direct solver, in the midst of contact."""

from __future__ import annotations

import numpy as np
from contact_parts import RUBBER, bricks

import visviva as vv
from visviva.examples import tori


def check_against_direct(system: vv.System, scheme: vv.EnergyMomentum, h: float) -> None:
    """The increment of one linear system, by both."""
    (contact,) = (c for c in system.components if isinstance(c, vv.Contact))
    assert contact.pressures.max() > 0
    step, solutions = scheme.step(system.time, h), []
    for options in (
        vv.Iterative(method="gmres", preconditioner="saddle", tolerance=1e-12),
        vv.Direct(library="eigen"),
    ):
        system.newton = vv.Newton(linear=options)
        residual, increment = np.zeros((2, len(system.x)))
        system.core.dx[:] = np.where(system.order == 2, h * system.v, 0.0)
        assert system.core.linearise(step, system.signals(step), residual)
        assert system.core.linear_solve(step, residual, increment)
        solutions.append(increment)
    assert np.abs(solutions[1]).max() > 1e-3
    assert np.allclose(*solutions, rtol=0, atol=1e-8 * np.abs(solutions[1]).max())


def test_tori() -> None:
    study = tori.study(mesh="coarse", step=0.05)
    vv.simulate(study.system, until=1.15, step=0.05)
    check_against_direct(study.system, vv.EnergyMomentum(), 0.05)


def test_contact_beside_a_tie() -> None:
    """Unknowns that a tie eliminates and pressures of contact in one system."""
    upper, lower, contact = bricks(scale=1.0)
    mesh = vv.BoxMesh(size=(1, 1, 0.5), counts=(2, 2, 1), origin=(0, 0, 0.5))
    top = vv.Solid(mesh=mesh, material=RUBBER, density=1.0, velocity=(0.3, 0.1, -2.0))
    tie = vv.Tie(first=top, first_faces="z0", second=upper, second_faces="z1")
    system = vv.System([upper, lower, top, contact, tie])
    vv.simulate(system, until=0.05, step=0.01)
    check_against_direct(system, vv.EnergyMomentum(), 0.01)


def test_first_touch_within_a_short_step() -> None:
    """Nothing but a gap is left of the residual when a block that flies meets another one; the forces that close it in
    a short step are a million times as large as what they close, and the solver finds them all the same."""
    upper = vv.BoxMesh(size=(1, 1, 0.5), counts=(4, 4, 2)).build().moved((0, 0, 0.502))
    lower = vv.BoxMesh(size=(1.3, 1.3, 0.5), counts=(5, 5, 2), origin=(-0.16, -0.14, 0)).build()
    falls = vv.Solid(mesh=upper, material=RUBBER, density=1.0, velocity=(0.5, 0, -2))
    waits = vv.Solid(mesh=lower, material=RUBBER, density=1.0)
    contact = vv.Contact(first=falls, first_faces="z0", second=waits, second_faces="z1")
    system = vv.System([falls, waits, vv.Fixed(solid=waits, nodes="z0"), contact])
    system.newton = vv.Newton(
        linear=vv.Iterative(method="gmres", preconditioner="saddle", tolerance=1e-3, max_iterations=40)
    )
    vv.simulate(system, until=0.0015, step=5e-4)
    assert contact.pressures.max() > 0
    assert system.stepper.rejected == 0
