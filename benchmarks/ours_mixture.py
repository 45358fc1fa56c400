"""visviva's side of the comparison of mixtures: midpoint steps, linear triangles."""

from __future__ import annotations

from mixture_case import MixtureCase, main
from ours_solids import marched, whole_iteration
from record import Record

import visviva as vv


def run(case: MixtureCase, variant: str) -> Record:
    """March the case."""
    body = vv.CahnHilliard(
        mesh=vv.RectangleMesh(size=(1.0, 1.0), counts=(case.n, case.n), cell="tri3"),
        free_energy=vv.DoubleWell(barrier=case.barrier, low=0.0, high=1.0),
        gradient_energy=case.gradient_energy,
        mobility=case.mobility,
        concentration=lambda X: case.start(X[:, 0], X[:, 1]),
    )
    system = vv.System([body], vv.Newton(tolerance=case.tolerance))
    scheme = vv.Midpoint()
    record = marched(system, scheme, case.step, case.steps)
    record.note(float(body.values(system.x).std()))
    whole_iteration(record, system, scheme.step(system.time, case.step))
    return record


if __name__ == "__main__":
    main(run, ("own",))
