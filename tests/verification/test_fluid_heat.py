"""Heat that fluids carry: closed forms, orders, balances, de Vahl Davis' cavity."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from visviva.body.mesh_points import face_points
from visviva.examples.convection import CONVERGED, heat_of, study
from visviva.examples.cylinder import channel

Array = NDArray[np.float64]


def steady(*parts: Any, step: float = 1.0) -> vv.System:
    system = vv.System(list(parts))
    vv.quasi_static(system, until=1.0, step=step)
    return system


def plug(mesh: vv.Mesh, **options: Any) -> tuple[vv.FluidHeat, list[Any]]:
    """A stream that moves with the speed 1 along x."""
    fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=0.1, velocity=(1, 0, 0))
    heat = vv.FluidHeat(fluid=fluid, capacity=1.0, **options)
    return heat, [
        fluid,
        heat,
        vv.VelocityBoundary(fluid=fluid, faces="x0", velocity=(1, 0, 0)),
        vv.Outlet(fluid=fluid, faces="x1"),
        *[vv.FreeSlip(fluid=fluid, faces=side) for side in ("y0", "y1")],
    ]


def strip(n: int, cell: str) -> vv.Mesh:
    return vv.RectangleMesh(size=(1, 0.2), counts=(n, max(2, n // 5)), cell=cell).build()


@pytest.mark.parametrize(("cell", "order"), [("quad4", 2), ("tri3", 2), ("quad9", 3), ("tri6", 3)])
def test_advection_and_diffusion_in_a_steady_stream(cell: str, order: int) -> None:
    """(exp(P x) - 1) / (exp(P) - 1) at the Peclet number P = 10, with the order of the elements."""
    errors = []
    for n in (16, 32):
        heat, parts = plug(strip(n, cell), conductivity=0.1)
        ends = [vv.PrescribedTemperature(body=heat, nodes=f"x{k}", value=float(k)) for k in (0, 1)]
        system = steady(*parts, *ends)
        exact = np.expm1(10 * heat.points[:, 0]) / np.expm1(10.0)
        errors.append(float(np.sqrt(np.mean((heat.temperatures(system.x) - exact) ** 2))))
    assert np.log2(errors[0] / errors[1]) > order - 0.3
    assert errors[1] < (3e-3 if order == 2 else 5e-5)


def test_upwinding_leaves_no_wiggles_at_a_layer_within_a_cell() -> None:
    """At a Peclet number of the cells of 50; without SUPG every other node is off by half."""
    least = {}
    for stabilised in (True, False):
        heat, parts = plug(strip(10, "quad4"), conductivity=1e-3, stabilised=stabilised)
        ends = [vv.PrescribedTemperature(body=heat, nodes=f"x{k}", value=float(k)) for k in (0, 1)]
        least[stabilised] = float(heat.temperatures(steady(*parts, *ends).x).min())
    assert least[True] > -0.02
    assert least[False] < -0.5


def oblique(capturing: float) -> Array:
    """Temperatures of a front that is carried across a square at an angle (Brooks & Hughes 1982)."""
    mesh = vv.RectangleMesh(size=(1, 1), counts=(16, 16)).build()
    fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=0.1, velocity=(1, 0.5, 0))
    heat = vv.FluidHeat(fluid=fluid, capacity=1.0, conductivity=1e-6, capturing=capturing)
    moved = [
        vv.VelocityBoundary(fluid=fluid, faces=side, velocity=(1, 0.5, 0)) for side in ("x0", "y0", "y1")
    ]
    X = heat.points
    inflow = np.flatnonzero((X[:, 0] == 0) | (X[:, 1] == 0))
    given = vv.PrescribedTemperature(
        body=heat, nodes=inflow, value=lambda t, X: t * ((X[:, 0] == 0) & (X[:, 1] > 0.2))
    )
    parts = [fluid, heat, *moved, vv.Outlet(fluid=fluid, faces="x1"), given]
    return heat.temperatures(steady(*parts).x)


def test_capturing_takes_overshoots_off_a_front() -> None:
    plain, captured = oblique(0.0), oblique(1.0)
    assert plain.max() > 1.04
    assert captured.max() - 1 < 0.3 * (plain.max() - 1)
    assert -captured.min() < 0.3 * -plain.min()


def wave(n: int, steps: int, cell: str, scheme: vv.Scheme) -> float:
    """Error of a cosine that a periodic stream carries along while it decays."""
    mesh = vv.RectangleMesh(size=(1, 0.2), counts=(n, 2), cell=cell)
    fluid = vv.Fluid(
        mesh=mesh, density=1.0, viscosity=0.1, velocity=(1, 0, 0), periodic=(("x0", "x1"), ("y0", "y1"))
    )
    X = fluid.points[:, 0]
    w = 2 * np.pi
    heat = vv.FluidHeat(
        fluid=fluid, conductivity=0.02, capacity=1.0, temperature=lambda X: np.cos(w * X[:, 0])
    )
    system = vv.System([fluid, heat])
    vv.simulate(system, until=0.5, step=0.5 / steps, scheme=scheme)
    exact = np.exp(-0.02 * w**2 * 0.5) * np.cos(w * (X - 0.5))
    return float(np.sqrt(np.mean((heat.temperatures(system.x) - exact) ** 2)))


@pytest.mark.parametrize(
    ("scheme", "order"), [(vv.EnergyMomentum(), 2), (vv.BDF2(), 2), (vv.BackwardEuler(), 1)]
)
def test_order_in_time(scheme: vv.Scheme, order: int) -> None:
    errors = [wave(16, steps, "quad9", scheme) for steps in (16, 32)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.25)


def test_heat_of_a_cylinder_leaves_by_the_outlet() -> None:
    """To the tolerance of the solver, on a coarse mesh; what leaves is integrated over the outlet."""
    fluid = vv.Fluid(mesh=channel(2), density=1.0, viscosity=1e-3)
    heat = vv.FluidHeat(fluid=fluid, conductivity=2e-3, capacity=1.0, reference=20.0, temperature=20.0)
    inflow = vv.VelocityBoundary(
        fluid=fluid,
        faces="x0",
        velocity=lambda t, X: 1.2 * X[:, 1:2] * (0.41 - X[:, 1:2]) / 0.41**2 * [1, 0, 0],
    )
    system = steady(
        fluid, heat, inflow, vv.Outlet(fluid=fluid, faces="x1"),
        *[vv.NoSlip(fluid=fluid, faces=side) for side in ("y0", "y1", "cylinder")],
        vv.PrescribedTemperature(body=heat, nodes="cylinder", value=50.0),
        vv.PrescribedTemperature(body=heat, nodes="x0", value=20.0),
    )  # fmt: skip
    T, v = heat.temperatures(system.x), fluid.velocities(system.x, system.v)
    (p,) = face_points(fluid.grid, fluid.faces("x1"))
    through = np.einsum("mqi,mqi->mq", np.einsum("qk,mki->mqi", p.N, v[p.nodes]), p.normal)
    leaves = float(np.sum(p.size * through * ((T[p.nodes] - 20.0) @ p.N.T)))
    wall, inlet = (vv.HeatFlow(body=heat, nodes=nodes)(system) for nodes in ("cylinder", "x0"))
    assert wall > 0.1
    assert wall + inlet == pytest.approx(leaves, rel=1e-10)
    assert abs(inlet) < 1e-4 * wall


def test_viscous_heating_between_plates() -> None:
    """Couette flow of the Brinkman number mu U^2 / k = 2: half of that times y (1 - y), and all of it flows out."""
    mesh = vv.RectangleMesh(size=(0.5, 1), counts=(2, 4), cell="quad9")
    fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=0.5, periodic=(("x0", "x1"),))
    heat = vv.FluidHeat(fluid=fluid, conductivity=0.25, capacity=1.0, viscous_heating=True)
    lid = vv.VelocityBoundary(fluid=fluid, faces="y1", velocity=("t", 0, 0))
    held = [vv.PrescribedTemperature(body=heat, nodes=side, value=0.0) for side in ("y0", "y1")]
    system = steady(fluid, heat, lid, vv.NoSlip(fluid=fluid, faces="y0"), *held)
    y = heat.points[:, 1]
    assert heat.temperatures(system.x) == pytest.approx(y * (1 - y), abs=1e-12)
    flows = [vv.HeatFlow(body=heat, nodes=side)(system) for side in ("y0", "y1")]
    assert flows == pytest.approx([-0.125, -0.125], rel=1e-10)


@pytest.mark.parametrize("cell", ["quad9", "quad4", "tri3"])
def test_a_stirred_insulated_box_keeps_all_energy(cell: str) -> None:
    """What viscosity takes becomes heat; the ledger of motion and heat closes, buoyancy in a column of its own."""
    mesh = vv.RectangleMesh(size=(1, 1), counts=(4, 4), cell=cell)

    def eddy(X: Array) -> Array:
        x, y = np.pi * X[:, 0], np.pi * X[:, 1]
        v = [np.sin(x) ** 2 * np.sin(2 * y), -np.sin(2 * x) * np.sin(y) ** 2, 0 * x]
        return np.stack(v, axis=1)

    for expansion in (0.0, 0.3):
        fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=0.05, velocity=eddy)
        heat = vv.FluidHeat(
            fluid=fluid, conductivity=0.02, capacity=1.0, viscous_heating=True, expansion=expansion,
            temperature=lambda X: X[:, 0], reference=0.0,
        )  # fmt: skip
        system = vv.System(
            [fluid, heat, vv.NoSlip(fluid=fluid, faces="all"), vv.Gravity(acceleration=(0, -3, 0))]
        )
        result = vv.simulate(system, until=1.0, step=0.05)
        ledger = result.ledger
        total = ledger["kinetic"] + ledger["potential_stored"]
        lifted = ledger["work_buoyancy"] if expansion else 0.0 * total
        if cell != "quad9":  # what is not free of divergence at points is weighed, too
            lifted = lifted + ledger["work_stabilisation"] + ledger["work_body force"]
        assert result.conservation()["energy"] < 1e-11
        assert ledger["kinetic"][0] - ledger["kinetic"][-1] > 0.02
        assert np.abs(total - total[0] - lifted).max() < 1e-11
        assert expansion == 0 or np.abs(ledger["work_buoyancy"]).max() > 0.01


@pytest.mark.parametrize(("rayleigh", "count"), [(1e3, 10), (1e4, 12), (1e5, 16)])
def test_the_cavity_of_de_vahl_davis(rayleigh: float, count: int) -> None:
    """Within 0.2 percent of converged values; what the hot wall gives the cold one takes."""
    cavity = study(rayleigh=rayleigh, count=count)
    result = vv.simulate(cavity.system, until=cavity.until, step=cavity.step, scheme=cavity.scheme)
    hot, cold = (vv.HeatFlow(body=heat_of(result), nodes=side)(result.system) for side in ("x0", "x1"))
    assert hot == pytest.approx(CONVERGED[rayleigh], rel=2e-3)
    assert hot + cold == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("cell", ["quad4", "tri3"])
def test_the_cavity_on_elements_of_equal_order(cell: str) -> None:
    """Of second order in the mesh: the stabilisation knows of what lifts."""
    errors = []
    for n in (20, 40):
        grid = vv.RectangleMesh(size=(1, 1), counts=(n, n), cell=cell).build()
        graded = vv.Mesh(
            grid.points - 0.12 * np.sin(2 * np.pi * grid.points), grid.cells, face_sets=grid.face_sets
        )
        air = vv.Fluid(mesh=graded, density=1.0, viscosity=0.71, speed=100.0)
        heat = vv.FluidHeat(fluid=air, conductivity=1.0, capacity=1.0, expansion=0.71, reference=0.0)
        parts = [vv.PrescribedTemperature(body=heat, nodes=f"x{k}", value=f"{0.5 - k}*t") for k in (0, 1)]
        walls, weight = vv.NoSlip(fluid=air, faces="all"), vv.Gravity(acceleration=(0, -1e4, 0))
        system = vv.System([air, heat, *parts, walls, weight])
        vv.simulate(system, until=1.0, step=0.25, scheme=vv.Static())
        errors.append(abs(vv.HeatFlow(body=heat, nodes="x0")(system) / CONVERGED[1e4] - 1))
    assert errors[1] < 6e-4
    assert errors[0] / errors[1] > 3


def test_layers_of_air_rest_on_elements_of_equal_order() -> None:
    """Heated from above: linear temperature, quadratic pressure, and no flow; without what lifts, PSPG makes some."""
    n = 8
    air = vv.Fluid(mesh=vv.RectangleMesh(size=(1, 1), counts=(n, n)), density=1.0, viscosity=0.71, speed=1.0)
    heat = vv.FluidHeat(fluid=air, conductivity=1.0, capacity=1.0, expansion=0.71, reference=0.0)
    parts = [vv.PrescribedTemperature(body=heat, nodes=f"y{k}", value=f"{k}*t") for k in (0, 1)]
    walls, weight = vv.NoSlip(fluid=air, faces="all"), vv.Gravity(acceleration=(0, -100, 0))
    system = vv.System([air, heat, *parts, walls, weight])
    vv.simulate(system, until=1.0, step=1.0, scheme=vv.Static())
    p, y = air.pressures(system.x), air.points[:, 1]
    assert p == pytest.approx(-100 * y + 50 + 71 * (y**2 / 2 - 1 / 6), abs=71 / n**2)
    assert np.abs(system.x[air.flow.start : air.flow.start + air.flow.size]).max() < 1e-12


MESH = vv.RectangleMesh(size=(1, 1), counts=(2, 2), cell="quad9")
AIR = vv.Fluid(mesh=MESH, density=1.0, viscosity=1.0, name="air")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"conductivity": -1.0}, "conductivity = -1 is not positive"),
        ({"capacity": 0.0}, "capacity = 0 is not positive"),
        ({"capturing": 2.0}, "capturing = 2 is not between 0 and 1"),
        ({"temperature": lambda X: X[:, 0] * np.nan}, "its temperature is not finite everywhere"),
    ],
)
def test_refusals(options: dict[str, Any], words: str) -> None:
    with pytest.raises(vv.InputError, match=words):
        vv.FluidHeat(**{"fluid": AIR, "conductivity": 1.0, "capacity": 1.0, "name": "warmth", **options})


def test_what_does_not_go_together_is_refused() -> None:
    two = [vv.FluidHeat(fluid=AIR, conductivity=1.0, capacity=1.0) for _ in range(2)]
    with pytest.raises(vv.InputError, match="air' has temperatures already"):
        vv.System([AIR, *two, vv.NoSlip(fluid=AIR, faces="all")])
    held = [vv.PrescribedTemperature(body=two[0], nodes=n, value=1.0) for n in ("x0", "y0")]
    with pytest.raises(vv.InputError, match="take its node out of one of them"):
        vv.System([AIR, two[0], *held, vv.NoSlip(fluid=AIR, faces="all")])
