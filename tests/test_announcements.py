"""What components tell about each other before any makes its fields; the order in which they are listed is free."""

from __future__ import annotations

from itertools import permutations
from typing import Any

import numpy as np
import pytest
from pydantic.dataclasses import dataclass

import visviva as vv
from visviva.component.announcements import Holding
from visviva.component.component import Component, settings
from visviva.model.model import Model

RUBBER = vv.NeoHooke(young=100.0, poisson=0.3)
DEEP = 0.02
ORDERS = list(permutations(range(4)))[::5]


def layer(bottom: float) -> vv.Solid:
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 1), origin=(0, 0, bottom))
    return vv.Solid(mesh=mesh, material=RUBBER, density=1.0)


def overlapping() -> dict[str, Any]:
    """Two layers of one density: what is free shares the way by halves, beside what is held it goes the whole way."""
    upper, lower = layer(1 - DEEP), layer(0.0)
    sides = {"first": upper, "second": lower, "first_faces": "z0", "second_faces": "z1"}
    return {"upper": upper, "lower": lower, "contact": vv.Contact(initial="resolve", **sides)}


@dataclass(config=settings, eq=False, kw_only=True)
class Clamp(Component):
    """A user's own support, which others learn of by its announcement."""

    solid: vv.Solid
    nodes: str

    def announce(self, model: Model) -> None:
        model.announce(self.solid, Holding(self, self.solid.nodes(self.nodes), None))

    def contribute(self, model: Model) -> None:
        first = self.solid.node_unknowns(self.solid.nodes(self.nodes))
        model.hold(self.solid.motion, (first[:, None] + np.arange(3)).ravel() - self.solid.motion.start)


@pytest.mark.parametrize("kind", [vv.Fixed, Clamp, vv.RigidCoupling], ids=lambda kind: kind.__name__)
@pytest.mark.parametrize("order", ORDERS, ids=str)
def test_what_holds_nodes_is_known_to_contact_wherever_it_stands(kind: Any, order: tuple[int, ...]) -> None:
    parts = overlapping()
    held = {"faces": "z1"} if kind is vv.RigidCoupling else {"nodes": "z1"}
    listed = [*parts.values(), kind(solid=parts["lower"], **held)]
    vv.System([listed[k] for k in order])
    assert parts["contact"].moved == pytest.approx(DEEP, rel=1e-9)
    assert np.all(parts["lower"].points[parts["lower"].nodes("z1"), 2] == 1.0)


def test_what_nothing_holds_gives_way() -> None:
    parts = overlapping()
    vv.System(list(parts.values()))
    assert parts["contact"].moved == pytest.approx(DEEP / 2, abs=1e-10)


@pytest.mark.parametrize("order", ORDERS, ids=str)
def test_ties_leave_planes_of_symmetry_to_their_supports(order: tuple[int, ...]) -> None:
    """Whoever stands first, the tie has no multiplier for the components that the plane holds."""
    left = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2)), material=RUBBER)
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1), origin=(1, 0, 0))
    right = vv.Solid(mesh=mesh, material=RUBBER)
    tie = vv.Tie(first=left, first_faces="x1", second=right, second_faces="x0")
    plane = vv.SymmetryPlane(solid=left, nodes="z0", normal=(0, 0, 1))
    listed = [left, right, tie, plane]
    system = vv.System([listed[k] for k in order])
    (multipliers,) = (f for f in system.model.fields if f.component is tie)
    assert multipliers.size == 3 * 9 - 3  # nodes of the face, less what the plane holds of three of them


@pytest.mark.parametrize("last", [False, True], ids=["gravity first", "gravity last"])
@pytest.mark.parametrize("walls_first", [False, True], ids=["fluid first", "walls first"])
def test_fluids_know_their_weight_and_walls(last: bool, walls_first: bool) -> None:
    """Hydrostatic pressure: density times gravity times depth."""
    mesh = vv.RectangleMesh(size=(1, 1), counts=(2, 2), cell="quad9")
    water = vv.Fluid(mesh=mesh, density=2.0, viscosity=1.0)
    walls: list[Any] = [vv.NoSlip(fluid=water, faces="all")]
    gravity = vv.Gravity(acceleration=(0, -10, 0))
    listed = [*walls, water] if walls_first else [water, *walls]
    system = vv.System([*listed, gravity] if last else [gravity, *listed])
    vv.quasi_static(system, until=1.0, step=1.0)
    p = water.pressures(system.x)
    assert p == pytest.approx(20 * (0.5 - water.points[:, 1]), abs=1e-9)


def test_contacts_of_the_same_surfaces_are_refused_in_any_order() -> None:
    for order in ORDERS:
        parts = overlapping()
        again = vv.Contact(
            first=parts["lower"], first_faces="z1", second=parts["upper"], second_faces="z0", name="again"
        )
        listed = [*parts.values(), again]
        with pytest.raises(vv.InputError, match=r"holds surfaces of .* apart that"):
            vv.System([listed[k] for k in order])


@pytest.mark.parametrize("first", [False, True], ids=["immersed last", "immersed first"])
def test_thin_immersed_solids_know_it(first: bool) -> None:
    flow = vv.Fluid(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(6, 6), cell="quad9"), density=1.0, viscosity=1.0
    )
    mesh = vv.RectangleMesh(size=(0.4, 0.01), counts=(16, 1), cell="quad9").build().moved((0.3, 0.5))
    leaf = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1.0, poisson=0.3), density=2.0)
    around = vv.Immersed(solid=leaf, fluid=flow)
    others = [flow, leaf, vv.NoSlip(fluid=flow, faces="all")]
    vv.System([around, *others] if first else [*others, around])
    assert around.is_thin
    assert any("tangent='exact'" in remark for remark in around.remarks())
