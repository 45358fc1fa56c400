"""Streams that come in warmer than the reference: constant temperatures stay so, and heat balances."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from visviva.body.mesh_points import face_points

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))
from warm_stream import parabola, widening

Array = NDArray[np.float64]


def stream(cell: str, across: int, reference: float | None = None) -> tuple[vv.FluidHeat, list[Any]]:
    """Through the channel at a Reynolds number of 60, at 300 in the beginning."""
    fluid = vv.Fluid(mesh=widening(cell, across), density=1.0, viscosity=1 / 60)
    heat = vv.FluidHeat(fluid=fluid, conductivity=5e-3, capacity=1.0, temperature=300.0, reference=reference)
    return heat, [
        fluid,
        heat,
        vv.VelocityBoundary(fluid=fluid, faces="x0", velocity=parabola),
        *[vv.NoSlip(fluid=fluid, faces=side) for side in ("y0", "y1")],
        vv.Outlet(fluid=fluid, faces="x1"),
    ]


@pytest.mark.parametrize(("cell", "across"), [("quad9", 4), ("tri6", 4)])
@pytest.mark.parametrize("reference", [None, 0.0])
def test_constant_temperatures_stay_constant(cell: str, across: int, reference: float | None) -> None:
    """What comes in at 400 leaves at 400 wherever walls let nothing through."""
    heat, parts = stream(cell, across, reference)
    system = vv.System([*parts, vv.PrescribedTemperature(body=heat, nodes="x0", value=400.0)])
    vv.quasi_static(system, until=1.0, step=1.0)
    assert heat.temperatures(system.x) == pytest.approx(np.full(len(heat.points), 400.0), abs=1e-6)


def test_heat_of_a_wall_is_what_the_stream_carries_out() -> None:
    """Integrated over inlet and outlet at the points of their faces, to the tolerance of the solver."""
    heat, parts = stream("quad9", 4)
    held = [("x0", 400.0), ("y1", 450.0)]
    nodes = {side: heat.nodes(side) for side, _ in held}
    nodes["x0"] = np.setdiff1d(nodes["x0"], nodes["y1"])
    given = [vv.PrescribedTemperature(body=heat, nodes=nodes[side], value=value) for side, value in held]
    system = vv.System([*parts, *given])
    vv.quasi_static(system, until=1.0, step=1.0)
    T, v = heat.temperatures(system.x), heat.fluid.velocities(system.x, system.v)
    (p,) = face_points(heat.fluid.grid, heat.fluid.faces("x1"))
    through = np.einsum("mqi,mqi->mq", np.einsum("qk,mki->mqi", p.N, v[p.nodes]), p.normal)
    leaves = float(np.sum(p.size * through * ((T[p.nodes] - 300.0) @ p.N.T)))
    came = sum(vv.HeatFlow(body=heat, nodes=some)(system) for some in nodes.values())
    assert leaves > 101
    assert came == pytest.approx(leaves, rel=1e-9)


@pytest.mark.parametrize("reference", [350.0, 0.0])
def test_a_layered_stream_stays_within_its_range(reference: float) -> None:
    """Cold below, warm above, as it comes in: between 300 and 400 but for a percent, by any reference."""

    def layers(X: Array) -> Array:
        return 350 + 50 * np.tanh((X[:, 1] - 0.5) / 0.15)

    heat, parts = stream("quad9", 4, reference)
    inflow = vv.PrescribedTemperature(body=heat, nodes="x0", value=lambda t, X: layers(X))
    system = vv.System([*parts, inflow])
    vv.quasi_static(system, until=1.0, step=1.0)
    T = heat.temperatures(system.x)
    assert T.min() > 299
    assert T.max() < 401


@pytest.mark.parametrize(
    ("cell", "reference", "said"), [("quad4", 300.0, True), ("quad4", 400.0, False), ("quad9", 300.0, False)]
)
def test_the_check_tells_of_inflow_away_from_the_reference(cell: str, reference: float, said: bool) -> None:
    """On elements of equal order alone, and of walls that are held never."""
    heat, parts = stream(cell, 4, reference)
    wall = np.setdiff1d(heat.nodes("y1"), heat.nodes("x0"))
    held = [
        vv.PrescribedTemperature(body=heat, nodes=some, value=value)
        for some, value in (("x0", 400.0), (wall, 500.0))
    ]
    words = f"fluid comes in at 400, and the reference is {reference:g}"
    assert (words in str(vv.System([*parts, *held]).check())) is said
