"""Errors that nobody handles end all processes, with one message; so does a process that leaves others waiting."""

from __future__ import annotations

import atexit
import os
import sys
from types import TracebackType
from typing import TYPE_CHECKING, Any, NoReturn

if TYPE_CHECKING:
    from visviva_petsc.world import World

PATIENCE = 5.0
"""Seconds until a process that fails believes that others go on; longer where all have met long ago."""


def end_all_together(world: World) -> None:
    """Have every error that nobody handles end all processes, and every end that others wait for."""
    before = sys.excepthook

    def end(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        together = world.meets()
        if not together:
            print(f"process {world.rank} of {world.size}:", file=sys.stderr)
        if not together or world.rank == 0:
            before(kind, error, trace)
        if not together:
            world.abort(1)

    def leave() -> None:
        if (left := world.leave()) is not None:
            other, what = left
            print(
                f"process {world.rank} of {world.size} has come to its end, and process {other} waits for it, to {what}"
                ": all have to call what evaluates elements (steps, checks, fields, histories, pictures, files of "
                "results), and none may leave alone",
                file=sys.stderr,
            )
            world.abort(1)

    def end_alone() -> None:
        """What was forked is none of them: it leaves as it likes, but for MPI, which would wait for the others."""
        told = []

        def exit_with(status: Any = None) -> NoReturn:
            told.append(status)
            raise SystemExit(status)

        def end_with_error(
            kind: type[BaseException], error: BaseException, trace: TracebackType | None
        ) -> None:
            told.append(1)
            before(kind, error, trace)

        def end() -> None:
            sys.stdout.flush()
            status = told[-1] if told else 0
            os._exit(status if isinstance(status, int) else status is not None)

        sys.exit, sys.excepthook = exit_with, end_with_error
        atexit.unregister(leave)
        atexit.register(end)

    sys.excepthook = end
    atexit.register(leave)
    os.register_at_fork(after_in_child=end_alone)
