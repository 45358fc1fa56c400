"""Errors that nobody handles end all processes, with one message."""

from __future__ import annotations

import sys
from types import TracebackType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from visviva_petsc.world import World

PATIENCE = 5.0
"""Seconds until a process that fails believes that others go on; longer where all have met long ago."""


def end_all_together(world: World) -> None:
    """Have every error that nobody handles end all processes."""
    before = sys.excepthook

    def end(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        together = world.meets()
        if not together:
            print(f"process {world.rank} of {world.size}:", file=sys.stderr)
        if not together or world.rank == 0:
            before(kind, error, trace)
        if not together:
            world.abort(1)

    sys.excepthook = end
