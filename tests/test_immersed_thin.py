"""Beams and shells in fluids: their weight in a fluid at rest, and what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv
from visviva.examples import leaf_valve

YOUNG, HEIGHT, LENGTH, HEAVIER, WEIGHT = 2e5, 0.02, 0.5, 1.0, 10.0
DEFLECTION = -1.5 * HEAVIER * WEIGHT * LENGTH**4 / (YOUNG * HEIGHT**2)
"""Of a cantilever under a uniform load of its weight less that of the fluid in its place."""


def beam(young: float = YOUNG, **options: Any) -> vv.Beam:
    section = vv.RectangleSection(width=HEIGHT, height=1.0, young=young, density=1.0 + HEAVIER)
    line = vv.LineMesh(points=[(0, 0.5, 0), (LENGTH, 0.5, 0)], count=8)
    return vv.Beam(mesh=line, section=section, first=(0, 1, 0), **options)


def water(size: Any = (1, 1), counts: Any = (8, 8)) -> list[Any]:
    mesh: Any = vv.RectangleMesh if len(size) == 2 else vv.BoxMesh
    cell = "quad4" if len(size) == 2 else "hex8"
    fluid = vv.Fluid(mesh=mesh(size=size, counts=counts, cell=cell), density=1.0, viscosity=1.0)
    return [fluid, vv.NoSlip(fluid=fluid, faces="all")]


def at_rest(body: Any, fluid: list[Any], displaced: float = HEIGHT) -> vv.System:
    wet = vv.ImmersedThin(body=body, fluid=fluid[0], displaced=displaced)
    clamp = vv.Clamped(solid=body, nodes="start" if body.has_directions else "x0")
    system = vv.System([*fluid, body, clamp, wet, vv.Gravity(acceleration=(0, -WEIGHT, 0))])
    vv.simulate(system, until=200.0, step=10.0, scheme=vv.BackwardEuler())
    return system


def test_a_beam_hangs_in_water_by_its_weight_less_that_of_the_water() -> None:
    body = beam()
    system = at_rest(body, water(counts=(16, 16)))
    assert body.displacements(system.x)[body.nodes("end")[0], 1] == pytest.approx(DEFLECTION, rel=0.02)


def test_a_shell_hangs_in_water_by_its_weight_less_that_of_the_water() -> None:
    flat = vv.RectangleMesh(size=(LENGTH, 0.25), counts=(6, 3)).build()
    points = np.column_stack([flat.points[:, 0], np.full(len(flat.points), 0.5), 0.375 - flat.points[:, 1]])
    section = vv.HomogeneousSection(thickness=HEIGHT, young=YOUNG, density=1.0 + HEAVIER)
    body = vv.Shell(mesh=vv.Mesh(points, flat.cells, face_sets=flat.face_sets), section=section)
    system = at_rest(body, water((1, 1, 0.5), (7, 7, 4)))
    tip = body.displacements(system.x)[body.nodes("x1"), 1].mean()
    assert tip == pytest.approx(DEFLECTION, rel=0.02)


def test_leaflets_of_the_density_of_the_fluid_move_alike_under_generalised_alpha() -> None:
    """They mirror each other, as the mesh does: they lost rates in every step, and energy came from nowhere."""
    system = leaf_valve.study().system
    result = vv.simulate(system, until=0.06, step=0.02, scheme=vv.GeneralizedAlpha())
    shells: Any = [c for c in system.components if isinstance(c, vv.Shell)]
    lower, upper = (b.displacements(system.x)[b.nodes("y1")].mean(axis=0) for b in shells)
    assert lower == pytest.approx(upper * (1, -1, 1), abs=1e-6 * lower[0])
    assert result.ledger["imbalance"].max() < 0.05 * result.ledger["total"].max()


@pytest.mark.parametrize(
    ("body", "options", "message"),
    [
        (lambda: beam(), {"displaced": -1.0}, "displaced = -1 is negative"),
        (lambda: beam(), {"leaves": True}, "leaves=True is for solids"),
        (lambda: beam(velocity=(0, 1, 0)), {}, "leave out its own"),
        (
            lambda: vv.Solid(
                mesh=vv.RectangleMesh(size=(0.2, 0.2), counts=(1, 1), origin=(0.4, 0.4)),
                material=vv.NeoHooke(young=1.0, poisson=0.3),
                density=1.0,
            ),
            {},
            r"is not thin; immerse it by vv\.Immersed",
        ),
        (
            lambda: vv.Shell(
                mesh=vv.RectangleMesh(size=(0.2, 0.2), counts=(1, 1), origin=(0.4, 0.4)),
                section=vv.HomogeneousSection(thickness=0.1, young=1.0),
            ),
            {},
            "a beam with its line at z = 0",
        ),
    ],
)
def test_bad_input_is_refused(body: Any, options: dict[str, Any], message: str) -> None:
    with pytest.raises(vv.InputError, match=message):
        vv.ImmersedThin(body=body(), fluid=water()[0], **{"displaced": HEIGHT, **options})


def test_nodes_that_let_the_fluid_pass_are_refused() -> None:
    fluid, walls = water(counts=(20, 20))
    body = beam()
    wet = vv.ImmersedThin(body=body, fluid=fluid, displaced=HEIGHT)
    vv.System([fluid, walls, body, vv.Clamped(solid=body, nodes="start"), wet])
    fluid, walls = water(counts=(40, 40))
    body = beam()
    wet = vv.ImmersedThin(body=body, fluid=fluid, displaced=HEIGHT)
    with pytest.raises(vv.InputError, match="the fluid would pass between them"):
        vv.System([fluid, walls, body, vv.Clamped(solid=body, nodes="start"), wet])
