"""Ctrl-C and termination between steps instead of anywhere."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

STOPPING = (signal.SIGINT, signal.SIGTERM)


@contextmanager
def deferred_interrupt() -> Iterator[Callable[[], int]]:
    """Note Ctrl-C and termination instead of ending at once; the function given tells the signal, 0 for none.

    A second one raises `KeyboardInterrupt` at once. Outside the main thread, where Python delivers no signals,
    nothing changes; nor for signals that a program around Python handles, since Python could not give them back.
    """
    if threading.current_thread() is not threading.main_thread():
        yield lambda: 0
        return
    noted: list[int] = []

    def note(number: int, _: object) -> None:
        if noted:
            raise KeyboardInterrupt(number)
        noted.append(number)

    earlier = {number: handler for number in STOPPING if (handler := signal.getsignal(number)) is not None}
    for number in earlier:
        signal.signal(number, note)
    try:
        yield lambda: noted[0] if noted else 0
    finally:
        for number, handler in earlier.items():
            signal.signal(number, handler)


def exit_code(interrupt: KeyboardInterrupt) -> int:
    """Exit status that a shell expects after a signal: 130 after Ctrl-C, 143 after termination."""
    return 128 + (interrupt.args[0] if interrupt.args else signal.SIGINT)
