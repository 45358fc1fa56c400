"""The two tori of the paper, coarse: conservation through impact."""

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
