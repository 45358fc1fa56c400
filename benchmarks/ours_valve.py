"""visviva's side of the comparison of valves: the paper's case, its flaps immersed in a mesh of squares that stays."""

from __future__ import annotations

from flow_case import main
from record import Record
from valve_case import ValveCase

import visviva as vv
from visviva.analysis.march import prepare
from visviva.examples import valve


def run(case: ValveCase, variant: str) -> Record:
    """March the case, which the example states with the same numbers."""
    study, scheme, record = (
        valve.study(mesh=(case.n, case.n // 4), step=case.step),
        vv.EnergyMomentum(),
        Record(),
    )
    system = study.system
    prepare(system, scheme)
    for _ in range(case.steps):
        with record.timed("cpu"):
            report = system.step(case.step, scheme)
        record.steps += 1
        record.iterations += report.iterations
        record.tangents += report.factorizations
    record.unknowns = system.core.n_equations
    record.note(float(study.probes["lower_tip"](system)[0]))  # type: ignore[operator]
    return record


if __name__ == "__main__":
    main(run, ("immersed",), ValveCase)
