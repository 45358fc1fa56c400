"""One thread at a time works on a system: others are refused, and leave no trace."""

from __future__ import annotations

from collections.abc import Callable
from threading import Thread

import pytest

import visviva as vv
from visviva.system.memory import undisturbed


def falling() -> vv.System:
    ball = vv.PointMass(mass=1.0, velocity=(1, 0, 2), name="ball")
    return vv.System([ball, vv.Gravity()])


def look(system: vv.System) -> None:
    with undisturbed(system):
        pass


OTHERS: dict[str, Callable[[vv.System], object]] = {
    "run": lambda s: vv.simulate(s, until=2.0, step=0.1),
    "statics": lambda s: vv.quasi_static(s, until=2.0, step=0.1),
    "march": lambda s: list(vv.march(s, until=2.0, step=0.1)),
    "step": lambda s: s.step(0.1),
    "look": look,
}


def elsewhere(work: Callable[[], object]) -> list[Exception]:
    """What work raises in a thread of its own."""
    raised: list[Exception] = []

    def tried() -> None:
        try:
            work()
        except Exception as error:
            raised.append(error)

    thread = Thread(target=tried)
    thread.start()
    thread.join()
    return raised


@pytest.mark.parametrize("other", OTHERS)
def test_a_second_thread_is_refused_and_leaves_no_trace(other: str) -> None:
    system, left_alone = falling(), falling()
    errors: list[Exception] = []

    def disturb(system: vv.System) -> None:
        look(system)  # the thread itself may
        errors.extend(elsewhere(lambda: OTHERS[other](system)))

    vv.simulate(system, until=1.0, step=0.1, observe=disturb)
    vv.simulate(left_alone, until=1.0, step=0.1)
    assert len(errors) == 10
    assert all(isinstance(e, vv.InputError) and "another thread works on it" in str(e) for e in errors)
    assert system.x.tobytes() == left_alone.x.tobytes()
    assert system.time == 1.0


def test_threads_may_work_on_a_system_after_each_other_and_on_copies() -> None:
    system = falling()

    def on_a_copy(system: vv.System) -> None:
        assert not elsewhere(lambda: vv.simulate(system.copy(), until=9.0, step=1.0))

    vv.simulate(system, until=1.0, step=0.5, observe=on_a_copy)
    assert not elsewhere(lambda: vv.simulate(system, until=2.0, step=0.5))

    def fail(system: vv.System) -> None:
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        vv.simulate(system, until=3.0, step=0.5, observe=fail)
    assert not elsewhere(lambda: system.step(0.5))
