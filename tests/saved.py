"""What state files hold."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from visviva.output import load_state


def saved_arrays(directory: Path) -> dict[str, np.ndarray[Any, Any]]:
    """All arrays of a run's state, by record and name."""
    records = load_state(directory / "state.h5").values()
    return {f"{r.name}/{name}": array for r in records for name, array in r.arrays.items()}
