"""A body that touches itself."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv

N = 16


def clasp(**options: Any) -> tuple[vv.System, vv.Contact]:
    """A free open ring whose arms fly towards each other."""
    unit = vv.RectangleMesh(size=(1, 1), counts=(N, 1)).build()
    u, inwards = unit.points.T
    angle, radius = np.radians(20 + 320 * u), 1 - 0.25 * inwards
    points = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    mesh = vv.Mesh(points, unit.cells, face_sets=unit.face_sets)
    ring = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=100.0, poisson=0.3), density=1.0)
    contact = vv.Contact(first=ring, formulation="node-to-segment", enforcement="penalty", **options)
    system = vv.System([ring, contact], vv.Newton(tolerance=1e-13))
    x, y = points.T
    system.v[ring.node_unknowns(np.arange(len(x))) + 1] = -4.0 * np.sign(y) * np.clip(x, 0, None)
    return system, contact


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_clasp_closes_and_opens(friction: float) -> None:
    """Its ends hit each other and part again; momenta and energy, with the work of friction, are exact, and the ends do
    not pass through each other."""
    rubbing: dict[str, Any] = {"friction": friction, "tangential": "penalty"} if friction else {}
    system, contact = clasp(**rubbing)
    touches, depths = [], []

    def observe(_: vv.System) -> None:
        touches.append(bool(contact.pressures.max() > 0))
        depths.append(-float(np.nan_to_num(contact.gaps, nan=1.0).min()))

    result = vv.simulate(system, until=1.0, step=0.01, observe=observe)
    assert 10 < sum(touches) < 60
    assert not touches[-1]
    assert max(depths) < 0.1 * 0.25
    result.assert_conserved("energy", "momentum_x", "momentum_y", "angular_z", tolerance=1e-11)
    if friction:
        assert np.diff(result.ledger["work_friction"]).max() <= 1e-12 * result.ledger["total"][0]
        assert result.ledger["work_friction"][-1] < 0
