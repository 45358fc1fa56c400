"""A closed loop of a rigid body, two beams and a shell, that tumbles and shakes with nothing acting on it."""

from __future__ import annotations

from typing import Any

import numpy as np

import visviva as vv

SPIN = (0.4, 0.9, 0.3)


def closed_loop(count: int = 4) -> vv.System:
    """The beams hang on the body by hinges; ball joints join their ends to corners of the shell."""
    body = vv.RigidBody(
        shape=vv.Box(size=(0.4, 1.2, 0.2)), mass=3.0, position=(0, 0, 0), angular_velocity=SPIN, name="body"
    )
    section = vv.TubeSection(radius=0.04, thickness=0.01, young=2e5, poisson=0.3, density=200.0)
    ends = [(np.array((0.2, y, 0.0)), np.array((1.4, y, 0.0))) for y in (-0.5, 0.5)]
    beams = [
        vv.Beam(
            mesh=vv.LineMesh(points=list(pair), count=count),
            section=section,
            velocity=np.cross(SPIN, np.mean(pair, axis=0)),
            angular_velocity=SPIN,
            name=f"beam_{k}",
        )
        for k, pair in enumerate(ends)
    ]
    flat = vv.RectangleMesh(size=(0.8, 1.0), counts=(count, count)).build()
    mesh = vv.Mesh(
        np.pad(flat.points + np.array((1.4, -0.5)), ((0, 0), (0, 1))),
        flat.cells,
        face_sets=flat.face_sets,
    )
    plate = vv.HomogeneousSection(thickness=0.03, young=1e5, poisson=0.3, density=100.0)

    def swaying(X: Any) -> Any:
        """That of the middle, and across the shell what vanishes at the corners."""
        across = np.array([0, 0, 4.0]) * ((X[:, :1] - 1.4) * (2.2 - X[:, :1]) + 0.3 * (0.25 - X[:, 1:2] ** 2))
        return np.cross(SPIN, mesh.points.mean(axis=0)) + across

    shell = vv.Shell(mesh=mesh, section=plate, velocity=swaying, angular_velocity=SPIN, name="shell")
    hinges = [
        vv.Revolute(a=body, b=beam, at=pair[0], axis=(0, 1, 0))
        for beam, pair in zip(beams, ends, strict=True)
    ]
    balls = [vv.Spherical(a=beam, b=shell, at=pair[1]) for beam, pair in zip(beams, ends, strict=True)]
    return vv.System([body, *beams, shell, *hinges, *balls])


def largest_changes(
    system: vv.System, steps: int, step: float = 0.01, scheme: vv.Scheme | None = None
) -> dict[str, float]:
    """Largest changes of energy and momenta, relative to the sizes of kinetic energy and of momenta."""
    result = vv.simulate(system, until=steps * step, step=step, scheme=scheme or vv.EnergyMomentum())
    ledger = result.ledger
    size = float(np.max(ledger["kinetic"]))
    return {
        name: float(np.ptp(ledger[name]) / size)
        for name in ("total", "momentum_x", "momentum_y", "momentum_z", "angular_x", "angular_y", "angular_z")
    }
