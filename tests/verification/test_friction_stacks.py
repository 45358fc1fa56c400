"""Stacks of blocks that rub on each other: they slide by Coulomb's law, never gain energy, and need no retries."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from rubbing import GRAVITY

import visviva as vv
from visviva.component.component import Component
from visviva.system.newton import StepFailure

STIFF = vv.NeoHooke(young=1e6, poisson=0.3)
DENSITY, HEIGHT = 1000.0, 0.5


def stack(
    n: int, friction: float, angle: float, shifted: bool, counts: tuple[int, int, int], formulation: str
) -> list[Component]:
    """Blocks of 1 x 1 x 0.5 on each other, on a held base that is inclined; their outlines equal or not."""
    base = vv.Solid(
        mesh=vv.BoxMesh(size=(3, 3, 0.5), counts=(3, 3, 1), origin=(-1, -1, -0.5)),
        material=STIFF,
        density=DENSITY,
    )
    parts: list[Component] = [base, vv.Fixed(solid=base, nodes="all")]
    below = base
    for k in range(n):
        x, y = (0.13 * k, 0.07 * k) if shifted else (0.0, 0.0)
        mesh = vv.BoxMesh(size=(1, 1, HEIGHT), counts=counts, origin=(x, y, HEIGHT * k))
        block = vv.Solid(mesh=mesh, material=STIFF, density=DENSITY)
        faces = {"first_faces": "z0", "second_faces": "z1"}
        contact = vv.Contact(first=block, second=below, **faces, formulation=formulation, friction=friction)
        parts += [block, contact]
        below = block
    down = GRAVITY * np.array([np.sin(angle), 0, -np.cos(angle)])
    return [*parts, vv.Gravity(acceleration=down)]


def falls(result: vv.Result) -> bool:
    """Whether energy never rises by more than rounding."""
    total = result.ledger["total"]
    return bool(np.diff(total).max() < 1e-12 * np.abs(total).max() + 1e-9)


CASES = list(itertools.product(("mortar", "node-to-segment"), (False, True), (0.15, 0.25, 0.35)))


@pytest.mark.parametrize(("formulation", "shifted", "friction"), CASES)
def test_two_blocks_slide_down_a_slope(formulation: str, shifted: bool, friction: float) -> None:
    """At 20 degrees what the base rubs is at most mu times what it carries, in every step.

    With what it carries from the momentum across the slope, that down the slope grows at least by m g t (sin - mu cos)
    less mu times the growth across.
    """
    angle = np.radians(20)
    system = vv.System(stack(2, friction, angle, shifted, (2, 2, 1), formulation))
    result = vv.simulate(system, until=0.032, step=0.002)
    time, along, across = (result.ledger[k] for k in ("time", "momentum_x", "momentum_z"))
    assert falls(result)
    assert result.statistics.rejected == 0
    assert result.statistics.iterations < 12 * result.statistics.steps
    driving = 2 * DENSITY * HEIGHT * GRAVITY * (np.sin(angle) - friction * np.cos(angle))
    free = along + friction * across
    assert (np.diff(free) > driving * np.diff(time) - 1e-6).all()


def test_a_short_step_finds_the_direction_of_tiny_slips() -> None:
    """Both blocks slide as one, so that what is between them rubs just at Coulomb's limit and slips by 1e-12."""
    system = vv.System(stack(2, 0.25, np.radians(20), True, (2, 2, 1), "mortar"))
    result = vv.simulate(system, until=0.05, step=0.001)
    assert result.statistics.rejected == 0
    assert falls(result)


@pytest.mark.parametrize("formulation", ["mortar", "node-to-segment"])
@pytest.mark.parametrize(("n", "degrees", "counts"), [(4, 20.0, (2, 2, 1)), (10, 0.0, (1, 1, 1))])
def test_tall_stacks_stand_and_slide(
    n: int, degrees: float, counts: tuple[int, int, int], formulation: str
) -> None:
    """A stack of four on a slope, and a tower of ten, which settle under their weight without a gain of energy."""
    system = vv.System(stack(n, 0.3, np.radians(degrees), False, counts, formulation))
    assert falls(vv.simulate(system, until=0.02, step=0.0025))


@pytest.mark.parametrize(("formulation", "most"), [("mortar", 0.02), ("node-to-segment", 0.17)])
def test_blocks_that_hang_over_a_border(formulation: str, most: float) -> None:
    """The way down a slope is Coulomb's. With vertices it is not yet: where the last one on the base has passed what
    the block weighs upon, those beyond the border hold it up, on a rounding whose normals lean."""
    angle, friction, rubber, errors = np.radians(20), 0.15, vv.NeoHooke(young=1e7, poisson=0.3), []
    for cells, below, shift in ((2, 1, 0.13), (4, 3, 0.13), (4, 3, 0.3), (4, 3, -0.3)):
        places = ((below, below, 1), (0, 0, -HEIGHT)), ((cells, cells, cells // 2), (shift, 0, 0))
        base, block = (
            vv.Solid(
                mesh=vv.BoxMesh(size=(1, 1, HEIGHT), counts=counts, origin=origin),
                material=rubber,
                density=DENSITY,
            )
            for counts, origin in places
        )
        faces = {"first_faces": "z0", "second_faces": "z1"}
        contact = vv.Contact(first=block, second=base, **faces, formulation=formulation, friction=friction)
        down = GRAVITY * np.array([np.sin(angle), 0, -np.cos(angle)])
        system = vv.System(
            [base, vv.Fixed(solid=base, nodes="all"), block, contact, vv.Gravity(acceleration=down)]
        )
        start = block.positions(system.x).mean(axis=0)
        vv.simulate(system, until=0.3, step=0.005)
        way = (block.positions(system.x).mean(axis=0) - start)[0]
        coulomb = 0.5 * GRAVITY * (np.sin(angle) - friction * np.cos(angle)) * 0.3**2
        errors.append(abs(way / coulomb - 1))
    print(formulation, errors)
    assert max(errors) < most


def test_a_failed_step_names_the_contact_and_its_vertices() -> None:
    parts = stack(1, 0.25, np.radians(20), False, (2, 2, 1), "mortar")
    system = vv.System(parts, vv.Newton(max_iterations=2))
    message = r"Contact '.*' still opens and closes, or sticks and slips, at \d vertices, such as near \("
    with pytest.raises(StepFailure, match=message):
        system.step(0.002, vv.EnergyMomentum())
