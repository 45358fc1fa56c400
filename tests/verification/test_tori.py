"""The two tori of the paper, coarse: conservation through impact, and its linear solver against a direct one."""

from __future__ import annotations

import numpy as np

import visviva as vv
from visviva.examples import tori


def contact_of(study: vv.Study) -> vv.Contact:
    (contact,) = (c for c in study.system.components if isinstance(c, vv.Contact))
    return contact


def test_full_mesh_is_that_of_the_paper() -> None:
    system = tori.study().system
    assert system.n_coordinates == 72216
    assert sum(c.grid.n_cells for c in system.components if isinstance(c, vv.Solid)) == 16048


def test_coarse_tori_conserve_through_impact() -> None:
    """Momenta to round-off; "dissipative" impact loses energy, and the ledger says that contact took it."""
    study = tori.study(mesh="coarse", until=1.4, step=0.02)
    result = vv.simulate(study.system, until=study.until, step=study.step, scheme=study.scheme)
    tori.check(result)
    total, lost = result.ledger["total"], result.ledger["work_contact"]
    assert total[-1] < total[0] * (1 - 1e-5)
    assert np.allclose(total - total[0], lost, rtol=0, atol=1e-9 * total[0])


def test_saddle_preconditioner_gives_the_solution_of_a_direct_solver() -> None:
    """One linear system in the midst of contact."""
    study = tori.study(mesh="coarse", step=0.05)
    system, contact = study.system, contact_of(study)
    vv.simulate(system, until=1.15, step=0.05)
    assert contact.pressures.max() > 0
    step, solutions = study.scheme.step(system.time, 0.05), []
    for options in (
        vv.Iterative(method="gmres", preconditioner="saddle", tolerance=1e-12),
        vv.Direct(library="eigen"),
    ):
        system.newton = vv.Newton(linear=options)
        system.choose_linear()
        residual, increment = np.zeros((2, len(system.x)))
        system.core.dx[:] = np.where(system.order == 2, 0.05 * system.v, 0.0)
        assert system.core.linearise(step, system.signals(step), residual)
        assert system.core.linear_solve(step, residual, increment)
        solutions.append(increment)
    assert np.abs(solutions[1]).max() > 1
    assert np.allclose(*solutions, rtol=0, atol=1e-8 * np.abs(solutions[1]).max())
