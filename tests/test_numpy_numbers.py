"""Numbers of numpy are taken wherever those of Python are, and mean the same."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from visviva.base.told import Teller
from visviva.study.run import run

Kind = Callable[[float], Any]


def hung() -> vv.System:
    """A ball on a spring and a guide, pulled down more and more."""
    ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(0, 0, -1))
    spring = vv.Spring(a=ground.point(), b=ball.point(), stiffness=100.0)
    guide = vv.PointOnLine(a=ground, b=ball.point(), at=(0, 0, -1), axis=(0, 0, 1))
    return vv.System([ground, ball, spring, guide, vv.Force(on=ball, force=(0, 0, -20), times="t")])


def of_run(number: Kind, count: Kind, folder: Path) -> NDArray[np.float64]:
    """A run that is resumed."""
    often: Any = {"every": count(1), "save_every": number(0), "frames_per_second": number(50)}
    run(vv.Study(hung(), number(1), number(1)), folder, pictures=False, **often)
    later = vv.Study(hung(), 2, 1)
    later.until, later.step = number(3), number(1)
    return run(later, folder, resume=True, pictures=False, **often).times


def of_study(number: Kind, count: Kind, folder: Path) -> NDArray[np.float64]:
    study = vv.Study(hung(), number(3), number(1))
    return vv.simulate(study.system, until=study.until, step=study.step, every=count(1)).times


CALLS: dict[str, Callable[[Kind, Kind, Path], NDArray[np.float64]]] = {
    "run": of_run,
    "Study": of_study,
    "simulate": lambda x, n, _: vv.simulate(hung(), until=x(3), step=x(1), every=n(1)).times,
    "quasi_static": lambda x, n, _: vv.quasi_static(hung(), until=x(3), step=x(1), every=n(1)).times,
    "arc_length": lambda x, n, _: vv.arc_length(hung(), until=x(9), step=x(1), steps=n(3)).times,
    "equilibrium": lambda x, n, _: vv.equilibrium(hung(), until=x(3), steps=n(3), most=n(99)).times,
}


@pytest.mark.parametrize("count", [np.int64, np.uint8], ids=["int64", "uint8"])
@pytest.mark.parametrize("number", [np.float64, np.float32, np.int64], ids=["float64", "float32", "int64"])
@pytest.mark.parametrize("name", CALLS)
def test_times_and_counts(name: str, number: Kind, count: Kind, tmp_path: Path) -> None:
    call = CALLS[name]
    np.testing.assert_array_equal(
        call(number, count, tmp_path / "theirs"), call(float, int, tmp_path / "ours")
    )


def test_numbers_of_few_digits_count_like_others() -> None:
    """A tenth in half of the digits is another number; steps of it are counted in all digits."""
    step = np.float32(0.1)
    found = vv.simulate(hung(), until=np.float32(1.0), step=step).times
    np.testing.assert_array_equal(found, vv.simulate(hung(), until=1.0, step=float(step)).times)
    assert len(found) == 11


def test_constants_of_time() -> None:
    assert vv.TimeFunction(np.float64(2.5))(1.0) == vv.TimeFunction(np.int64(2))(0.0) + 0.5 == 2.5


def test_they_are_told_alike() -> None:
    """A run may be resumed with the same number of the other kind."""
    tell = Teller({}).text
    for theirs, ours in (
        (np.float64(2.5), 2.5),
        (np.float32(2.5), 2.5),
        (np.int64(3), 3),
        (np.bool_(True), True),
    ):
        assert tell(theirs) == tell(ours)
