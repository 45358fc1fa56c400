"""Natural convection: a square box with a hot and a cold wall, after de Vahl Davis (1983).

Warm air rises at the left wall and sinks at the right one. Lengths are those of the box, times those of the diffusion
of heat; the Prandtl number is 0.71. The difference of temperatures grows from zero to one. What flows through, by what
would without motion, is the Nusselt number: 1.1178, 2.2448, 4.5216, 8.8252 at the Rayleigh numbers 10^3 to 10^6,
converged; de Vahl Davis' own 8.800 is 0.3 percent low.
"""

from __future__ import annotations

import numpy as np

import visviva as vv

CONVERGED = {1e3: 1.1178, 1e4: 2.2448, 1e5: 4.5216, 1e6: 8.8252}
"""Nusselt numbers by Rayleigh numbers."""
PRANDTL = 0.71


def study(rayleigh: float = 1e5, count: int = 16, step: float | None = None) -> vv.Study:
    """A unit square of `count` quadratic cells along each side, finer at the walls."""
    grid = vv.RectangleMesh(size=(1, 1), counts=(count, count)).build()
    s = grid.points
    graded = vv.Mesh(s - 0.12 * np.sin(2 * np.pi * s), grid.cells, face_sets=grid.face_sets)
    speed = np.sqrt(rayleigh)
    air = vv.Fluid(mesh=graded, density=1.0, viscosity=PRANDTL, elements="Q2Q1", speed=speed, name="air")
    heat = vv.FluidHeat(
        fluid=air, conductivity=1.0, capacity=1.0, expansion=PRANDTL, reference=0.0, name="heat"
    )
    hot = vv.PrescribedTemperature(body=heat, nodes="x0", value="0.5*t", name="hot wall")
    cold = vv.PrescribedTemperature(body=heat, nodes="x1", value="-0.5*t", name="cold wall")
    weight = vv.Gravity(acceleration=(0, -rayleigh, 0))
    system = vv.System([air, heat, hot, cold, vv.NoSlip(fluid=air, faces="all", name="walls"), weight])
    probes = {
        "nusselt_hot": vv.HeatFlow(body=heat, nodes="x0"),
        "nusselt_cold": vv.HeatFlow(body=heat, nodes="x1"),
        "centre": vv.TemperatureAt(body=heat, at=(0.5, 0.5, 0)),
    }
    return vv.Study(
        system,
        1.0,
        step or min(0.25, 2e4 / rayleigh),
        vv.Static(),
        probes,
        fields=("temperature", "speed"),
        title=f"Natural convection at the Rayleigh number {rayleigh:g}",
        notes=__doc__,
    )


def heat_of(result: vv.Result) -> vv.FluidHeat:
    """The temperatures of its air."""
    return next(c for c in result.system.components if isinstance(c, vv.FluidHeat))


def check(result: vv.Result) -> None:
    """The Nusselt number to 0.2 percent, where there is a reference; what comes in goes out."""
    hot, cold = (vv.HeatFlow(body=heat_of(result), nodes=side)(result.system) for side in ("x0", "x1"))
    assert abs(hot + cold) < 1e-9 * abs(hot), f"{hot} and {cold}"
    (weight,) = (c for c in result.system.components if isinstance(c, vv.Gravity))
    rayleigh = -float(weight.acceleration[1])
    if result.times[-1] == 1.0 and rayleigh in CONVERGED:
        assert abs(hot / CONVERGED[rayleigh] - 1) < 2e-3, f"Nusselt number {hot}"
