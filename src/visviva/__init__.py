"""visviva: energy-momentum conserving mechanics of bodies, joints and forces as one system."""

import os
from typing import Any

import lazy_loader

if "OMP_WAIT_POLICY" not in os.environ:  # read as soon as the core is loaded
    # Where other programs share the cores, a thread that spins keeps those from running that it waits for. So many
    # rounds are what GNU's OpenMP takes where there are more threads than cores.
    os.environ.setdefault("GOMP_SPINCOUNT", "1000")

_found, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

if any(name in os.environ for name in ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS")):
    from visviva.base import processes as _processes

    if _processes.n_told() > 1:
        from visviva.base.world import fail_for_all as _fail

        _processes.mark()
        _fail()

__version__ = "0.2.0"

RENAMED = {"HeatLink": "HeatExchange"}
"""Public names that were others."""


def __getattr__(name: str) -> Any:
    """A public name, or an error that tells the nearest one."""
    if name in __all__ or name.startswith("__"):
        return _found(name)
    from visviva.base.errors import nearest

    if name in RENAMED:
        raise AttributeError(f"visviva.{name} is visviva.{RENAMED[name]} now")
    close = nearest(name, __all__)
    told = close if "did you mean" in close else "; help(visviva) lists what there is"
    raise AttributeError(f"visviva has no {name!r}{told}")
