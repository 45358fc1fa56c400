"""Checks, modes, buckling and branches of small systems; the first process prints what was found.

python tests/processes/looks.py
mpiexec -n 2 python tests/processes/looks.py
"""

from __future__ import annotations

import json
import warnings
from typing import Any

import alike
from test_redundant_couplings import welded

import visviva as vv
from visviva.base.world import world

CHECKED = ("hinged", "tied", "warm", "colliding", "resting", "bouncing", "led", "flowing", "carrying")


def checked(name: str, steps: int) -> list[Any]:
    """Freedoms and redundant constraints after some steps; tangents are those of differences."""
    make, scheme = alike.CASES[name]
    system = vv.System(make())
    if steps:
        vv.simulate(system, until=steps * alike.STEP, step=alike.STEP, scheme=scheme)
    report = system.check()
    assert report.tangent is not None
    assert report.tangent.error < 1e-5, f"{name}: {report.tangent}"
    return [report.degrees_of_freedom, [str(r) for r in report.redundant]]


def column() -> vv.System:
    """A slender block that is pressed from above."""
    mesh = vv.BoxMesh(size=(0.1, 0.12, 1.0), counts=(2, 2, 8), cell="hex20")
    solid = vv.Solid(
        mesh=mesh, material=vv.SaintVenantKirchhoff(young=1e3, poisson=0.3), name="column", density=1.0
    )
    press = vv.Traction(solid=solid, faces="z1", traction=(0, 0, -1.0), times="t")
    return vv.System([solid, vv.Fixed(solid=solid, nodes="z0"), press])


def pressed_down() -> list[Any]:
    """From where on it is unstable, and the first loads: how far later steps go follows from iterations."""
    result = vv.arc_length(column(), step=1.0, steps=4)
    return [str(result.stability), *(float(t) for t in result.times[:4])]


def welded_twice(**options: Any) -> list[Any]:
    """Steps, those that failed, and where a body is that is held by more constraints than it needs."""
    system = welded(times=2, counts=(2, 1, 2))
    result = vv.simulate(system, until=0.1, step=0.01, **options)
    body = next(c for c in system.components if isinstance(c, vv.RigidBody))
    place = body.point().position.value(system.x)
    return [result.statistics.steps, result.statistics.rejected, *(float(x) for x in place)]


def main() -> None:
    """Print."""
    warnings.simplefilter("ignore")
    found: dict[str, Any] = {f"{name} {n}": checked(name, n) for name in CHECKED for n in (0, 3)}
    found["modes"] = [float(f) for f in vv.modes(column(), 4).frequencies]
    found["buckling"] = [float(f) for f in vv.buckling(column(), 2).factors]
    found["arc length"] = pressed_down()
    found["welded twice"] = welded_twice()
    found["with rates of their own"] = welded_twice(scheme=vv.GeneralizedAlpha())
    found["in steps of any length"] = welded_twice(adaptive=vv.Adaptive(tolerance=1e-4))
    if world().rank == 0:
        print(json.dumps(found))


if __name__ == "__main__":
    main()
