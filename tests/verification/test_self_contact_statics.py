"""A body that touches itself in statics, by multipliers and with friction."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from slots import along_slot, slotted_block

import visviva as vv

N = 16
OPENING = 1e-3
RUBBER = vv.NeoHooke(young=100.0, poisson=0.3)


def slotted(opening: float = OPENING, shift: float = 0.0) -> vv.Mesh:
    """A block of 2 by 1 with a slot at half its height, as wide as a lens, by x from 0.5 to 1.5; or without one."""
    if opening == 0:
        return vv.RectangleMesh(size=(2, 1), counts=(N, N // 2)).build()
    height = 0.5 * opening * np.sin(np.pi * along_slot(N))
    return slotted_block(N, np.outer(height, [0, -1]), np.outer(height, [2 * shift / opening * 2 / N, 1]))


def pressed(mesh: vv.Mesh, step: float = 0.0625, **options: Any) -> tuple[vv.Result, vv.Solid, Any]:
    """The block pressed by 0.03 and then sheared by 0.05."""
    block = vv.Solid(mesh=mesh, material=RUBBER, density=1.0)
    contact = vv.Contact(first=block, first_faces="slot", **options) if options else None
    y = mesh.points[:, 1]
    top = vv.Prescribed(
        solid=block,
        nodes=np.flatnonzero(y > 1 - 1e-9),
        motion=("max(0.1*t-0.05, 0)", "-min(0.06*t, 0.03)", None),
    )
    parts = [block, top, vv.Fixed(solid=block, nodes=np.flatnonzero(y < 1e-9))]
    system = vv.System([*parts, contact] if contact else parts)
    return vv.quasi_static(system, until=1.0, step=step), block, contact


def moved(result: vv.Result, block: vv.Solid, n: int) -> Any:
    """Displacements (n, 2) of the first nodes at the end, those that both meshes have."""
    unknowns = block.node_unknowns(np.arange(n))
    x = result.states[-1]
    return np.column_stack([x[unknowns], x[unknowns + 1]]) - block.mesh.points[:n]


@pytest.mark.parametrize("shift", [0.0, 0.3])
def test_a_slot_that_sticks_is_no_slot(shift: float) -> None:
    """Closed, without slipping, the block moves as one that has none: nodes lie on nodes, or between them."""
    whole, block, _ = pressed(slotted(opening=0))
    wanted = moved(whole, block, len(block.mesh.points))
    result, body, contact = pressed(slotted(shift=shift), friction=5.0)
    assert not contact.slipping.any()
    found = moved(result, body, len(wanted))
    assert np.abs(found - wanted).max() < (1.5 * OPENING if shift == 0 else 3 * OPENING)


@pytest.mark.parametrize("tangential", ["multipliers", "penalty"])
@pytest.mark.parametrize("shift", [0.0, 0.3])
@pytest.mark.parametrize("friction", [0.1, 0.3, 0.5])
def test_a_slot_slips(friction: float, shift: float, tangential: Any) -> None:
    """Coulomb's law holds at each vertex, forces are in equilibrium, and what slips loses what the loads bring."""
    mesh = slotted(shift=shift)
    result, _, contact = pressed(mesh, friction=friction, tangential=tangential)
    carries = contact.pressures > 0
    assert carries.sum() == N // 2 - 1  # those of one side alone
    assert np.abs(contact.gaps[carries]).max() < 1e-12
    assert contact.slipping[carries].all()
    tractions = contact.tractions[carries]
    sizes = np.linalg.norm(tractions, axis=1)
    np.testing.assert_allclose(sizes, friction * contact.pressures[carries], rtol=1e-10)
    assert np.abs(contact.forces.sum(axis=0)).max() < 1e-12
    upper = contact.places[carries, 1] > 0.5
    assert (upper == upper[0]).all()
    assert (tractions[:, 0] * np.where(upper, -1, 1) > 0).all()  # the roof is drawn along x, and held back
    rounding = 1e-15 if tangential == "multipliers" else 1e-10  # elastic slips turn with their load
    assert np.diff(result.ledger["work_friction"]).max() <= rounding
    finer = pressed(mesh, step=0.03125, friction=friction, tangential=tangential)
    np.testing.assert_allclose(contact.pressures, finer[2].pressures, rtol=0.02, atol=1e-12)
    first, second = (np.abs(r.ledger["imbalance"]).max() for r in (result, finer[0]))
    assert second < 0.35 * first
    assert second < 0.02 * abs(finer[0].ledger["work_friction"][-1])


def test_little_friction_is_none() -> None:
    """Pressures come to those without friction as the coefficient vanishes."""
    mesh = slotted()
    smooth, slight, slighter = (pressed(mesh, friction=f)[2].pressures for f in (0.0, 1e-3, 1e-4))
    one, two = (np.abs(p - smooth).max() for p in (slight, slighter))
    assert two < 0.11 * one < 1e-3 * smooth.max()


def folded(n: int, **options: Any) -> Any:
    """Force of the upper leg of a U that is pressed onto the lower one and drawn along it, on that."""
    unit = vv.RectangleMesh(size=(1, 1), counts=(n, n // 24)).build()
    s, inwards = unit.points.T
    radius, along = 0.3 - 0.15 * inwards, s * (4.5 + 0.3 * np.pi)
    bent = np.clip((along - 2) / 0.3, 0, np.pi)
    x = np.clip(2 - along, 0, None) + np.clip(along - 2 - 0.3 * np.pi, 0, None) - radius * np.sin(bent)
    mesh = vv.Mesh(np.column_stack([x, radius * np.cos(bent)]), unit.cells, face_sets=unit.face_sets)
    inner = mesh.faces("y1")
    off, height = inner.centres(mesh.points).T
    halves = [inner.where((off > 0.15) & (way * height > 0)) for way in (1, -1)]
    legs = vv.Solid(mesh=mesh, material=RUBBER, density=1.0)
    sides = {"first_faces": halves[0], "second": legs, "second_faces": halves[1]}
    contact = vv.Contact(first=legs, **(options or sides), friction=0.3)
    x, y = mesh.points.T
    drawn = vv.Prescribed(
        solid=legs,
        nodes=np.flatnonzero((x > 0.99) & (y > 0.29)),
        motion=("-max(0.3*t-0.15, 0)", "-min(0.64*t, 0.32)", None),
    )
    held = vv.Fixed(solid=legs, nodes=np.flatnonzero((x > -1e-9) & (y < -0.29)))
    vv.quasi_static(vv.System([legs, contact, drawn, held]), until=1.0, step=0.0625)
    upper = contact.places[:, 1] > 0
    return contact.forces[upper].sum(axis=0)[:2] if upper.any() else -contact.forces.sum(axis=0)[:2]


def test_a_folded_strip_rubs_by_multipliers() -> None:
    """By its whole inner side against itself, and by mortar between its halves: the same force, the more so on finer
    meshes."""
    by_mortar = [folded(n) for n in (24, 48)]
    apart = [
        np.linalg.norm(folded(n, first_faces="y1") - f) / np.linalg.norm(f)
        for n, f in zip((24, 48), by_mortar, strict=True)
    ]
    assert apart[1] < 0.8 * apart[0] < 0.02


def test_mortar_asks_for_the_parts_that_meet() -> None:
    block = vv.Solid(mesh=slotted(), material=RUBBER, density=1.0)
    with pytest.raises(vv.InputError, match="give parts that meet as first_faces and second_faces"):
        vv.Contact(first=block, first_faces="slot", formulation="mortar")


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_steps_of_dynamics_ask_for_a_penalty(friction: float) -> None:
    block = vv.Solid(mesh=slotted(), material=RUBBER, density=1.0)
    contact = vv.Contact(first=block, first_faces="slot", friction=friction)
    with pytest.raises(vv.InputError, match=r"itself by multipliers in statics alone; .*'penalty'"):
        vv.simulate(vv.System([block, contact]), until=0.1, step=0.1)


def test_multipliers_of_self_contact_are_not_condensed() -> None:
    block = vv.Solid(mesh=slotted(), material=RUBBER, density=1.0)
    with pytest.raises(vv.InputError, match="condensed=True is for two surfaces"):
        vv.Contact(first=block, first_faces="slot", condensed=True)


@pytest.mark.parametrize("friction", [0.1, 0.3])
def test_a_folded_strip_of_bricks(friction: float) -> None:
    """In space, pressed and drawn aside: Coulomb's law at each vertex, equilibrium, and one side alone that carries."""
    unit = vv.BoxMesh(size=(1, 1, 1), counts=(24, 1, 2)).build()
    s, inwards, across = unit.points.T
    radius, along = 0.3 - 0.15 * inwards, s * (4 + 0.3 * np.pi)
    bent = np.clip((along - 2) / 0.3, 0, np.pi)
    x = np.clip(2 - along, 0, None) + np.clip(along - 2 - 0.3 * np.pi, 0, None) - radius * np.sin(bent)
    points = np.column_stack([x, radius * np.cos(bent), 0.5 * across])
    mesh = vv.Mesh(points, unit.cells, face_sets=unit.face_sets)
    strip = vv.Solid(mesh=mesh, material=RUBBER, density=1.0)
    contact = vv.Contact(first=strip, first_faces="y1", friction=friction)
    x, y, _ = mesh.points.T
    drawn = vv.Prescribed(
        solid=strip,
        nodes=np.flatnonzero((x > 0.99) & (y > 0.29)),
        motion=("max(0.2*t-0.1, 0)", "-min(0.64*t, 0.32)", "max(0.1*t-0.05, 0)"),
    )
    held = vv.Fixed(solid=strip, nodes=np.flatnonzero((x > -1e-9) & (y < -0.29)))
    vv.quasi_static(vv.System([strip, contact, drawn, held]), until=1.0, step=0.125)
    carries = contact.pressures > 0
    assert carries.sum() > 8
    upper = contact.places[carries, 1] > 0
    assert (upper == upper[0]).all()
    tractions = contact.tractions[carries]
    np.testing.assert_allclose(
        np.linalg.norm(tractions, axis=1), friction * contact.pressures[carries], rtol=1e-10
    )
    assert (tractions[:, [0, 2]] * np.where(upper, -1, 1)[:, None] > 0).all()
    assert np.abs(contact.forces.sum(axis=0)).max() < 1e-12


@pytest.mark.parametrize("upside_down", [False, True])
@pytest.mark.parametrize("fine_first", [False, True])
def test_the_finer_of_two_parts_holds_the_other(fine_first: bool, upside_down: bool) -> None:
    """A clasp with a bump, narrower than the facets of the leg opposite, does not pass between their vertices."""
    coarse, fine, bend = np.linspace(0.4, 0.0, 2), np.linspace(0.0, 0.4, 21), np.linspace(0, np.pi, 9)
    middle = [(x, -1.0, 0.0) for x in coarse] + [(x, 1.0, np.exp(-(((x - 0.2) / 0.05) ** 2))) for x in fine]
    arc = [(-0.2 * np.sin(a), -np.cos(a)) for a in bend[1:-1]]
    rows = []
    for depth in (0.1, 0.0):  # outside and inside
        r = 0.1 + depth
        legs = [(x, side * (r - (0.06 * bump if depth == 0 else 0.0))) for x, side, bump in middle]
        turn = [(x * r / 0.2, y * r) for x, y in arc]
        rows.append([*legs[:2], *turn, *legs[2:]])
    outer, inner = np.array(rows)[:, :: -1 if fine_first else 1]
    n = len(outer)
    i = np.arange(n - 1)
    points = np.vstack([outer, inner]) * ((1, -1) if upside_down else (1, 1))
    cells = np.column_stack([i, i + 1, n + i + 1, n + i])
    clasp = vv.Solid(
        mesh=vv.Mesh(points, {"quad4": cells if upside_down != fine_first else cells[:, ::-1]}),
        material=RUBBER,
    )
    sign = -1 if upside_down else 1
    tip = np.flatnonzero((np.abs(points[:, 1] - sign * 0.2) < 1e-9) & (points[:, 0] >= 0))
    foot = np.flatnonzero((np.abs(points[:, 1] + sign * 0.2) < 1e-9) & (points[:, 0] >= 0))
    push = vv.Prescribed(solid=clasp, nodes=tip, motion=(0, f"{-sign * 0.18} * t", None))
    contact = vv.Contact(first=clasp, friction=0.3)
    system = vv.System([clasp, push, vv.Fixed(solid=clasp, nodes=foot), contact])
    x = vv.quasi_static(system, until=1.0, step=0.1).states[-1]
    unknowns = clasp.node_unknowns(np.arange(2 * n))
    found = np.column_stack([x[unknowns], x[unknowns + 1]])[n:] * (1, sign)
    found = found[:: -1 if fine_first else 1]
    leg = found[:2][np.argsort(found[:2, 0])]
    above = found[-21:, 1] - np.interp(found[-21:, 0], *leg.T)
    assert (contact.pressures > 0).sum() >= 2
    assert above.min() > -1e-9
