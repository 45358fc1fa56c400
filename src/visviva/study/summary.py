"""Figures of a run, for its summary."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from visviva.base.threads import use_threads
from visviva.results.audit import figures
from visviva.results.result import Result
from visviva.study.study import Study


def steps_of(study: Study) -> dict[str, Any]:
    """Time stepping of a study."""
    return {
        "step": study.step,
        "scheme": str(study.scheme),
        "adaptive": study.adaptive and str(study.adaptive),
    }


def summary(study: Study, result: Result, notes: Mapping[str, Any]) -> dict[str, Any]:
    """Figures of a run, for its summary."""
    import platform

    import scipy

    from visviva import __version__, _core

    system, numbers = study.system, figures(result)
    return {
        "title": study.title,
        **notes,
        "until": study.until,
        **steps_of(study),
        "unknowns": len(system.x),
        **numbers,
        "degrees_of_freedom": system.report and system.report.degrees_of_freedom,
        "initial_state_moved": system.report and system.report.moves,
        "redundant_constraints": system.report and len(system.report.redundant),
        "end_time": system.time,
        "last_step": system.gauges(),
        "solver": system.core.solver,
        "threads": use_threads(),
        "newton": asdict(system.newton),
        "versions": {
            "visviva": __version__,
            "instruction_set": _core.instruction_set(),
            "python": platform.python_version(),
            "numpy": np.__version__,
            "scipy": scipy.__version__,
        },
    }
