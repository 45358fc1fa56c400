"""The two blocks in visviva: mortar, multipliers."""

from __future__ import annotations

import numpy as np
from contact_case import Block, ContactCase, main
from record import Record

import visviva as vv
from visviva.analysis.march import prepare


def mesh(block: Block) -> vv.Mesh:
    """The case's block with its sets of faces and nodes."""
    built = vv.BoxMesh(size=block.size, counts=block.counts, origin=block.origin).build()
    assert np.allclose(np.sort(built.points, axis=0), np.sort(block.points, axis=0))
    return built


def run(case: ContactCase, variant: str) -> Record:
    """March the case."""
    rubber = vv.NeoHooke(young=case.young, poisson=case.poisson)
    lower, upper = (vv.Solid(mesh=mesh(b), material=rubber) for b in (case.lower, case.upper))
    motion = tuple(f"{u} * t" for u in case.motion)
    supports = [vv.Fixed(solid=lower, nodes="z0"), vv.Prescribed(solid=upper, nodes="z1", motion=motion)]
    contact = vv.Contact(first=upper, first_faces="z0", second=lower, second_faces="z1")
    system, scheme = vv.System([lower, upper, *supports, contact]), vv.Static(tolerance=case.tolerance)
    record = Record()
    prepare(system, scheme)
    marching = vv.march(system, until=1.0, step=1 / case.steps, scheme=scheme)
    for _ in range(case.steps):
        with record.timed("cpu"):
            report = next(marching)
        record.iterations += report.iterations
        record.steps += 1
    face = upper.mesh.points[:, 2] == case.upper.origin[2]
    record.note(float(upper.displacements(system.x)[face, 2].mean()))
    return record


if __name__ == "__main__":
    main(run, ("mortar",))
