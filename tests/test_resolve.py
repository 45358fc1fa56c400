"""Surfaces that overlap at the start and are moved apart: by the smallest move, without stress."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from contact_parts import RUBBER, bricks, contact_of, plates

import visviva as vv

DEEP = 0.02


def layers(
    densities: tuple[float, float], counts: tuple[int, int] = (2, 2), **options: Any
) -> tuple[vv.Solid, vv.Solid, vv.Contact]:
    """A layer that lies by `DEEP` inside the one below."""
    upper, lower = (
        vv.Solid(
            mesh=vv.BoxMesh(size=(1, 1, 1), counts=(n, n, 1), origin=(0, 0, z)),
            material=RUBBER,
            density=density,
        )
        for n, z, density in zip(counts, (1 - DEEP, 0.0), densities, strict=True)
    )
    contact = vv.Contact(
        first=upper, second=lower, first_faces="z0", second_faces="z1", initial="resolve", **options
    )
    return upper, lower, contact


@pytest.mark.parametrize(
    "options", [{}, {"formulation": "node-to-segment"}, {"enforcement": "penalty"}], ids=str
)
def test_flat_faces_share_the_overlap_by_their_masses(options: dict[str, Any]) -> None:
    """The heavier gives way by a quarter, the lighter by three quarters; nothing is stressed."""
    upper, lower, contact = parts = layers((1.0, 3.0), **options)
    system = vv.System(list(parts))
    assert upper.points[upper.nodes("z0"), 2] == pytest.approx(1 - DEEP / 4, abs=1e-10)
    assert lower.points[lower.nodes("z1"), 2] == pytest.approx(1 - DEEP / 4, abs=1e-10)
    assert contact.moved == pytest.approx(0.75 * DEEP, abs=1e-10)
    assert np.all(upper.points[upper.nodes("z1"), 2] == 2 - DEEP)
    result = vv.simulate(system, until=0.02, step=0.01)
    assert result.ledger["potential_strain"].max() < 1e-20
    assert upper.nodal_mass.sum() == pytest.approx(1 - 0.75 * DEEP, rel=1e-10)


@pytest.mark.parametrize("build", [bricks, plates])
@pytest.mark.parametrize("options", [{}, {"formulation": "node-to-segment"}], ids=str)
def test_meshes_that_do_not_match(build: Any, options: dict[str, Any]) -> None:
    """No gap is negative, some vanish, and bodies that moved at rest keep their momenta."""
    parts = build(gap=-0.005, initial="resolve", **options)
    contact = contact_of(parts)
    system = vv.System(parts)
    assert 0.01 < contact.moved < 0.03
    result = vv.simulate(system, until=0.01, step=0.01)
    assert np.nanmin(result.records[0][0][:, 1]) > -1e-8
    assert np.nanmin(np.abs(result.records[0][0][:, 1])) < 1e-8
    assert result.ledger["potential_strain"][0] == pytest.approx(0, abs=1e-18)


def test_held_nodes_stay_and_planes_too() -> None:
    """The whole way is that of what is free: of the upper layer, and of a brick on a plane."""
    upper, lower, contact = parts = layers((1.0, 1.0), counts=(3, 2))
    vv.System([*parts, vv.Fixed(solid=lower, nodes="z1")])
    assert contact.moved == pytest.approx(DEEP, rel=1e-9)
    assert upper.points[upper.nodes("z0"), 2] == pytest.approx(1, abs=1e-9)
    brick, _, _ = layers((1.0, 1.0))
    floor = vv.Plane(at=(0, 0, 1))
    touch = vv.Contact(first=brick, first_faces="z0", second=floor, initial="resolve")
    vv.System([brick, floor, touch])
    assert touch.moved == pytest.approx(DEEP, rel=1e-9)


def test_what_cannot_give_way_is_refused() -> None:
    upper, lower, _ = parts = layers((1.0, 1.0))
    held = [vv.Fixed(solid=lower, nodes="z1"), vv.Fixed(solid=upper, nodes="z0")]
    with pytest.raises(
        vv.InputError, match=r"near \(.*, 0.98\) cannot be resolved .*; move one of the bodies, or free"
    ):
        vv.System([*parts, *held])


def test_nothing_moves_where_nothing_overlaps() -> None:
    parts = bricks(gap=0.01, initial="resolve")
    before = parts[0].grid.points.copy()  # type: ignore[attr-defined]
    vv.System(parts)
    assert contact_of(parts).moved == 0
    assert np.array_equal(parts[0].grid.points, before)  # type: ignore[attr-defined]
