"""What solids and rigid bodies have in common when a fluid carries them: balance, restart, and what is refused."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from immersed_parts import body, box, carried, flap, immersed, part, patch

import visviva as vv
from visviva.errors import InputError, RunError
from visviva.run import run


@pytest.mark.parametrize("build", [carried, body, flap])
def test_energy_balances_with_less_stabilisation_around(build: Any) -> None:
    result = vv.simulate(vv.System(build(sealing=100.0)), until=0.4, step=0.02)
    assert np.abs(result.ledger["imbalance"]).max() < 1e-12 * result.ledger["total"][0]
    assert np.abs(result.ledger["work_stabilisation"]).max() > 1e-6 * result.ledger["total"][0]


@pytest.mark.parametrize(("build", "n"), [(carried, 3), (body, 4)])
def test_energy_of_a_closed_cube_balances(build: Any, n: int) -> None:
    result = vv.simulate(vv.System(build("hex8", n)), until=0.1, step=0.02)
    assert np.abs(result.ledger["imbalance"]).max() < 1e-12 * result.ledger["total"][0]


@pytest.mark.parametrize("build", [carried, flap, partial(carried, sealing=100.0)])
def test_resumed_bit_by_bit(build: Any, tmp_path: Path) -> None:
    def study(until: float) -> vv.Study:
        return vv.Study(vv.System(build()), until, 0.02)

    run(study(0.4), tmp_path / "whole", progress=False)
    run(study(0.2), tmp_path / "split", progress=False)
    run(study(0.4), tmp_path / "split", resume=True, progress=False)
    ledgers = [(tmp_path / name / "ledger.csv").read_text() for name in ("whole", "split")]
    assert ledgers[0] == ledgers[1]


def twice(parts: list[Any], kind: type[Any]) -> vv.System:
    return vv.System([*parts, immersed(part(parts, kind), part(parts, vv.Fluid))])


BAD: dict[str, tuple[Callable[[], Any], str]] = {
    "damping beyond the end": (lambda: carried(damping=0.6), "damping = 0.6 is not a number from 0 to 0.5"),
    "negative damping": (lambda: body(damping=-1.0), "damping = -1.0 is not a number from 0 to 0.5"),
    "sealing below one": (lambda: carried(sealing=0.5), "sealing = 0.5 is not a number from 1"),
    "nothing to seal": (
        lambda: carried("quad9", sealing=10.0),
        "sealing = 10 is for stabilised elements; leave",
    ),
    "solid twice": (lambda: twice(carried(), vv.Solid), "immersed twice"),
    "rigid body twice": (lambda: twice(body(), vv.RigidBody), "immersed twice"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input(name: str) -> None:
    build, message = BAD[name]
    with pytest.raises(InputError, match=message):
        build()


@pytest.mark.parametrize(
    ("n", "name", "build", "last"),
    [
        (4, "Solid 'solid-1'", lambda: patch(density=1.0), 0.25),
        (6, "RigidBody 'rigidbody-1'", lambda: part(body(density=1.0), vv.RigidBody), 0.3),
    ],
)
def test_leaving_the_fluid_ends_the_run_with_body_place_and_time(
    n: int, name: str, build: Any, last: float
) -> None:
    fluid, floating = box("quad4", n, velocity=(1.0, 0.0, 0.0)), build()
    around = vv.VelocityBoundary(fluid=fluid, faces="all", velocity=(1.0, 0.0, 0.0))
    system = vv.System([fluid, around, floating, immersed(floating, fluid)])
    with pytest.raises(RunError, match=name + r" lies outside of Fluid 'fluid-1' at \(1.*from t = 0\.[12]"):
        vv.simulate(system, until=1.0, step=0.05)
    assert 0.1 < system.time < last
    if isinstance(floating, vv.Solid):
        assert floating.positions(system.x)[:, 0].max() < 1.0 + 1e-12
