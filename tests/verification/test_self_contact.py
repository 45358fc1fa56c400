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


def touch_and_part(system: vv.System, contact: vv.Contact, thickness: float) -> vv.Result:
    """March until the parts have hit each other and gone apart, and not through each other."""
    touches, depths = [], []

    def observe(_: vv.System) -> None:
        touches.append(bool(contact.pressures.max() > 0))
        depths.append(-float(np.nan_to_num(contact.gaps, nan=1.0).min()))

    result = vv.simulate(system, until=1.0, step=0.01, observe=observe)
    assert 10 < sum(touches) < 60
    assert not touches[-1]
    assert max(depths) < 0.1 * thickness
    return result


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_clasp_closes_and_opens(friction: float) -> None:
    """Its ends hit each other and part again; momenta and energy, with the work of friction, are exact, and the ends do
    not pass through each other."""
    rubbing: dict[str, Any] = {"friction": friction, "tangential": "penalty"} if friction else {}
    system, contact = clasp(**rubbing)
    result = touch_and_part(system, contact, 0.25)
    result.assert_conserved("energy", "momentum_x", "momentum_y", "angular_z", tolerance=1e-11)
    if friction:
        assert np.diff(result.ledger["work_friction"]).max() <= 1e-12 * result.ledger["total"][0]
        assert result.ledger["work_friction"][-1] < 0


def hairpin() -> vv.Mesh:
    """Two legs along x, a half circle between them; the face y1 lies inside."""
    unit = vv.BoxMesh(size=(1, 1, 1), counts=(24, 1, 3)).build()
    s, inwards, across = unit.points.T
    radius = 0.3 - 0.15 * inwards
    along = s * (4 + 0.3 * np.pi)
    bent = np.clip((along - 2) / 0.3, 0, np.pi)
    x = np.clip(2 - along, 0, None) + np.clip(along - 2 - 0.3 * np.pi, 0, None) - radius * np.sin(bent)
    points = np.column_stack([x, radius * np.cos(bent), 0.5 * across])
    return vv.Mesh(points, unit.cells, face_sets=unit.face_sets)


def test_hairpin_closes_and_opens_in_space() -> None:
    """Its legs fly towards each other and aside: they hit, slide along each other and part; momenta and energy are
    exact, and the legs do not pass through each other."""
    mesh = hairpin()
    pin = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=100.0, poisson=0.3), density=1.0)
    contact = vv.Contact(first=pin, first_faces="y1", formulation="node-to-segment", enforcement="penalty")
    system = vv.System([pin, contact], vv.Newton(tolerance=1e-13))
    x, y, _ = mesh.points.T
    unknowns = pin.node_unknowns(np.arange(len(x)))
    system.v[unknowns + 1] = -1.0 * np.sign(y) * np.clip(x, 0, None)
    system.v[unknowns + 2] = 0.2 * np.sign(y) * np.clip(x, 0, None)
    result = touch_and_part(system, contact, 0.15)
    momenta = [f"{kind}_{c}" for kind in ("momentum", "angular") for c in "xyz"]
    result.assert_conserved("energy", *momenta, tolerance=1e-11)


def strip(step: float, **options: Any) -> Any:
    """The largest pressure where a U's upper leg was pressed onto the lower one and drawn along it, in statics."""
    unit = vv.RectangleMesh(size=(1, 1), counts=(24, 1)).build()
    s, inwards = unit.points.T
    radius, along = 0.3 - 0.15 * inwards, s * (4 + 0.3 * np.pi)
    bent = np.clip((along - 2) / 0.3, 0, np.pi)
    x = np.clip(2 - along, 0, None) + np.clip(along - 2 - 0.3 * np.pi, 0, None) - radius * np.sin(bent)
    mesh = vv.Mesh(np.column_stack([x, radius * np.cos(bent)]), unit.cells, face_sets=unit.face_sets)
    legs = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=100.0, poisson=0.3), density=1.0)
    contact = vv.Contact(first=legs, formulation="node-to-segment", enforcement="penalty", **options)
    upper, lower = (
        np.flatnonzero((mesh.points[:, 0] > 1.9) & (way * mesh.points[:, 1] > 0)) for way in (1, -1)
    )
    drawn = vv.Prescribed(solid=legs, nodes=upper, motion=("-0.3*t", "-0.42*t", None))
    vv.quasi_static(
        vv.System([legs, contact, drawn, vv.Fixed(solid=legs, nodes=lower)]), until=1.0, step=step
    )
    return contact.pressures.max()


@pytest.mark.parametrize("step", [0.0625, 0.25])
@pytest.mark.parametrize("stiffness", [None, 30.0, 200.0, 1000.0])
def test_a_strip_rubs_on_itself_in_statics(stiffness: float | None, step: float) -> None:
    """The stiffness of the augmentation changes no result, and there is one; a search for descent, which friction does
    not have, shortened increments to a hundredth for ever."""
    assert strip(step, friction=0.3, tangential_stiffness=stiffness) == pytest.approx(3.71667, rel=1e-5)
