"""Flows with exact solutions: profiles to round-off, orders of convergence in space and time, decay of energy."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from visviva.flow.boundary_faces import flow_faces

Array = NDArray[np.float64]


def errors(fluid: vv.Fluid, x: Array, exact: Any) -> tuple[float, float]:
    """L2 errors of velocity and pressure (less its mean), against a function of positions (n, 3)."""
    v, total, size, parts = fluid.by_node(x), 0.0, 0.0, []
    for batch in fluid.batches:
        volume = batch.geometry()[1].ravel()
        d = fluid.dimension
        X = np.pad(batch.places.reshape(-1, d), ((0, 0), (0, 3 - d)))
        u, p = exact(X)
        found = np.einsum("qk,mki->mqi", batch.N, v[batch.nodes]).reshape(-1, 3)
        total += volume @ np.sum((found - u) ** 2, axis=1)
        unknown = x[fluid.pressure_unknowns(batch.cell)] @ batch.M.T
        parts.append((volume, unknown.ravel() - p))
        size += volume.sum()
    mean = sum(w @ e for w, e in parts) / size
    return float(np.sqrt(total)), float(np.sqrt(sum(w @ (e - mean) ** 2 for w, e in parts)))


# --- Poiseuille ---------------------------------------------------------------------------------------------
def channel(cell: str, **options: Any) -> tuple[vv.System, vv.Fluid]:
    """A plane channel with a parabolic inflow and an outlet."""
    mesh = vv.RectangleMesh(size=(3.0, 1.0), counts=(6, 3), cell=cell)
    fluid = vv.Fluid(mesh=mesh, density=2.0, viscosity=0.05, **options)
    inlet = vv.VelocityBoundary(fluid=fluid, faces="x0", velocity=parabola)
    walls = [vv.NoSlip(fluid=fluid, faces=side) for side in ("y0", "y1")]
    return vv.System([fluid, inlet, *walls, vv.Outlet(fluid=fluid, faces="x1", pressure=0.3)]), fluid


def walls_of(fluid: vv.Fluid) -> Array:
    return np.union1d(fluid.grid.nodes("y0"), fluid.grid.nodes("y1"))


def parabola(t: float, X: Array) -> Array:
    return 4 * X[:, 1:2] * (1 - X[:, 1:2]) * np.array([1.0, 0.0, 0.0])


@pytest.mark.parametrize("cell", ["quad9", "tri6"])
def test_poiseuille_is_exact(cell: str) -> None:
    """Velocity quadratic, pressure linear: both are in the space of the elements, and the outlet does not disturb."""
    system, fluid = channel(cell)
    vv.quasi_static(system, until=1.0, step=1.0)
    exact = parabola(0.0, fluid.points)
    assert np.abs(fluid.velocities(system.x, system.v) - exact).max() < 1e-12
    pressure = 0.3 + 8 * 0.05 * (3.0 - fluid.points[:, 0])
    assert np.abs(fluid.pressures(system.x) - pressure).max() < 1e-11
    # pressure and drag of the walls, and half the inlet's momentum flux, which the skew-symmetric form puts there
    held = sum(vv.FlowForce(fluid=fluid, faces=side)(system)[0] for side in ("x0", "y0", "y1"))
    corners = fluid.node_unknowns(np.intersect1d(fluid.grid.nodes("x0"), walls_of(fluid)))
    held += system.holding_forces()[corners].sum()  # counted twice
    assert held == pytest.approx(-0.3 - 2.0 * 4 / 15, rel=1e-12)
    assert vv.FlowRate(fluid=fluid, faces="x1")(system) == pytest.approx(2 / 3, rel=1e-12)


@pytest.mark.parametrize("cell", ["hex27", "tet10"])
def test_flow_between_plates_in_space_is_exact(cell: str) -> None:
    mesh = vv.BoxMesh(size=(2.0, 1.0, 1.0), counts=(2, 2, 1), cell=cell)
    fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=0.1)
    conditions = [
        vv.VelocityBoundary(fluid=fluid, faces="x0", velocity=parabola),
        *[vv.NoSlip(fluid=fluid, faces=side) for side in ("y0", "y1")],
        *[vv.FreeSlip(fluid=fluid, faces=side) for side in ("z0", "z1")],
        vv.Outlet(fluid=fluid, faces="x1"),
    ]
    system = vv.System([fluid, *conditions])
    vv.quasi_static(system, until=1.0, step=1.0)
    assert np.abs(fluid.velocities(system.x, system.v) - parabola(0.0, fluid.points)).max() < 1e-12
    assert np.abs(fluid.pressures(system.x) - 0.8 * (2.0 - fluid.points[:, 0])).max() < 1e-11


ALL_CELLS = ("quad4", "tri3", "quad9", "tri6", "hex8", "tet4", "hex27", "tet10")


def brick(cell: str, n: int) -> vv.Mesh:
    """A box of n cells along and across, of the height 1."""
    if cell.startswith(("quad", "tri")):
        return vv.RectangleMesh(size=(1.5, 1.0), counts=(n, n), cell=cell).build()
    return vv.BoxMesh(size=(1.5, 1.0, 0.5), counts=(n, n, max(1, n // 4)), cell=cell).build()


@pytest.mark.parametrize("cell", ALL_CELLS)
def test_shear_by_a_traction_is_exact(cell: str) -> None:
    """Linear velocities without pressure are in the space of all elements: stabilisation leaves them alone."""
    fluid = vv.Fluid(mesh=brick(cell, 2), density=2.0, viscosity=0.5)
    ends = [
        vv.VelocityBoundary(fluid=fluid, faces=side, velocity=lambda t, X: 3 * X[:, 1:2] * [1, 0, 0])
        for side in ("x0", "x1")
    ]
    slip = [vv.FreeSlip(fluid=fluid, faces=side) for side in fluid.grid.face_sets if side.startswith("z")]
    drawn = vv.FluidTraction(fluid=fluid, faces="y1", traction=(1.5, 0.0, 0.0))
    system = vv.System([fluid, *ends, *slip, drawn, vv.NoSlip(fluid=fluid, faces="y0")])
    vv.quasi_static(system, until=1.0, step=1.0)
    assert np.abs(fluid.velocities(system.x, system.v) - 3 * fluid.points[:, 1:2] * [1, 0, 0]).max() < 1e-10
    assert np.abs(fluid.pressures(system.x)).max() < 1e-10
    assert vv.Divergence(fluid=fluid)(system) < 1e-10
    curl = vv.FlowField(fluid=fluid, field="vorticity", at=(0.3, 0.4, 0.2))(system)
    assert np.allclose(curl, -3.0 if fluid.dimension == 2 else (0, 0, -3), rtol=0, atol=1e-9)


@pytest.mark.parametrize("cell", ["quad4", "tri3"])
def test_divergence_and_vorticity_of_a_given_field(cell: str) -> None:
    fluid = vv.Fluid(
        mesh=brick(cell, 3),
        density=1.0,
        viscosity=1.0,
        velocity=lambda X: X * [2, -0.5, 0] + X[:, 1::-1] @ [[4, 0, 0], [0, 1, 0]],
    )
    system = vv.System([fluid, vv.FluidTraction(fluid=fluid, faces="all", traction=(0, 0, 0))])
    assert vv.Divergence(fluid=fluid)(system) == pytest.approx(1.5, rel=1e-12)
    curl = vv.FlowField(fluid=fluid, field="vorticity", at=(0.7, 0.3, 0))(system)
    assert curl == pytest.approx(1 - 4, rel=1e-12)


@pytest.mark.parametrize("cell", ["hex8", "tet4"])
def test_stabilised_elements_converge_in_space(cell: str) -> None:
    """Plane Poiseuille flow between plates: the same orders as in the plane, between 1.5 and 2."""
    found = []
    for n in (6, 12):
        fluid = vv.Fluid(mesh=brick(cell, n), density=1.0, viscosity=0.1)
        conditions = [
            vv.VelocityBoundary(fluid=fluid, faces="x0", velocity=parabola),
            *[vv.NoSlip(fluid=fluid, faces=side) for side in ("y0", "y1")],
            *[vv.FreeSlip(fluid=fluid, faces=side) for side in ("z0", "z1")],
            vv.Outlet(fluid=fluid, faces="x1"),
        ]
        system = vv.System([fluid, *conditions])
        vv.quasi_static(system, until=1.0, step=1.0)
        found.append(errors(fluid, system.x, lambda X: (parabola(0.0, X), 0.8 * (1.5 - X[:, 0]))))
    observed = np.log2(np.array(found[0]) / found[1])
    assert np.all(observed > 1.5), f"orders {observed}"


def test_a_column_at_rest_carries_its_weight() -> None:
    """Hydrostatics: no velocity, linear pressure; stabilised elements see the weight in their residual."""
    for cell in ("quad4", "tri3", "quad9"):
        fluid = vv.Fluid(
            mesh=vv.RectangleMesh(size=(1, 2), counts=(3, 4), cell=cell), density=3.0, viscosity=0.1
        )
        system = vv.System([fluid, vv.NoSlip(fluid=fluid, faces="all"), vv.Gravity(acceleration=(0, -5, 0))])
        vv.quasi_static(system, until=1.0, step=1.0)
        assert np.abs(fluid.velocities(system.x, system.v)).max() < 1e-12
        assert np.abs(fluid.pressures(system.x) - 15.0 * (1.0 - fluid.points[:, 1])).max() < 1e-11


# --- Kovasznay 1948 -----------------------------------------------------------------------------------------
RATE = 20 - np.sqrt(400 + 4 * np.pi**2)


def kovasznay(X: Array) -> tuple[Array, Array]:
    """Velocity (n, 3) and pressure (n,) behind a grid at the Reynolds number 40."""
    x, y = X[:, 0], 2 * np.pi * X[:, 1]
    u, v = 1 - np.exp(RATE * x) * np.cos(y), RATE / (2 * np.pi) * np.exp(RATE * x) * np.sin(y)
    return np.stack([u, v, 0 * x], axis=1), 0.5 * (1 - np.exp(2 * RATE * x))


def behind_a_grid(cell: str, n: int) -> tuple[float, float]:
    """Errors of velocity and pressure on n rows of cells."""
    mesh = vv.RectangleMesh(size=(1.5, 2.0), counts=(3 * n // 4, n), origin=(-0.5, -0.5), cell=cell)
    fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=1 / 40)
    around = vv.VelocityBoundary(fluid=fluid, faces="all", velocity=lambda t, X: kovasznay(X)[0])
    system = vv.System([fluid, around])
    vv.quasi_static(system, until=1.0, step=1.0)
    return errors(fluid, system.x, kovasznay)


@pytest.mark.parametrize(
    ("cell", "orders"), [("quad9", (3, 2)), ("tri6", (3, 2)), ("quad4", (1.6, 1.5)), ("tri3", (1.6, 1.5))]
)
def test_kovasznay_converges(cell: str, orders: tuple[float, float]) -> None:
    """Quadratic velocities with h^3, linear pressures with h^2; stabilised pairs between 1.5 and 2."""
    coarse, fine = behind_a_grid(cell, 16), behind_a_grid(cell, 32)
    observed = np.log2(np.array(coarse) / fine)
    assert np.all(observed > np.array(orders) - 0.1), f"orders {observed}"


# --- Taylor & Green 1937 ------------------------------------------------------------------------------------
TURN: Any = (("x0", "x1"), ("y0", "y1"))


def eddies(t: float, nu: float) -> Any:
    def exact(X: Array) -> tuple[Array, Array]:
        x, y, f = X[:, 0], X[:, 1], np.exp(-2 * nu * t)
        v = f * np.stack([np.cos(x) * np.sin(y), -np.sin(x) * np.cos(y), 0 * x], axis=1)
        return v, -0.25 * f * f * (np.cos(2 * x) + np.cos(2 * y))

    return exact


def decaying(cell: str, n: int, nu: float) -> tuple[vv.System, vv.Fluid]:
    mesh = vv.RectangleMesh(size=(2 * np.pi, 2 * np.pi), counts=(n, n), cell=cell)
    start = eddies(0.0, nu)
    fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=nu, velocity=lambda X: start(X)[0], periodic=TURN)
    return vv.System([fluid]), fluid


@pytest.mark.parametrize("cell", ["quad9", "tri6"])
def test_taylor_green_converges_in_space(cell: str) -> None:
    """Velocities with h^3, pressures with h^2, both at the end of the step."""
    found = []
    for n in (6, 12):
        system, fluid = decaying(cell, n, 0.1)
        vv.simulate(system, until=0.5, step=0.025, scheme=vv.Midpoint())
        found.append(errors(fluid, system.x, eddies(0.5, 0.1)))
    assert np.all(np.log2(np.array(found[0]) / found[1]) > (2.8, 1.8))


@pytest.mark.parametrize(
    ("scheme", "order", "steps"),
    [
        (vv.Midpoint(), 2, 5),
        (vv.BackwardEuler(), 1, 5),
        (vv.GeneralizedAlpha(0.8), 2, 5),
        (vv.BDF2(), 2, 40),  # before, the error of its start takes some of the others away
    ],
    ids=str,
)
def test_taylor_green_converges_in_time(scheme: vv.Scheme, order: int, steps: int) -> None:
    """Against the same mesh with tiny steps."""

    def end(steps: int, scheme: vv.Scheme) -> Array:
        system, fluid = decaying("quad9", 4, 0.4)
        vv.simulate(system, until=1.0, step=1.0 / steps, scheme=scheme)
        return fluid.velocities(system.x, system.v)

    exact = end(320, vv.Midpoint())
    coarse, fine = (np.abs(end(n, scheme) - exact).max() for n in (steps, 2 * steps))
    assert np.log2(coarse / fine) == pytest.approx(order, abs=0.15)


@pytest.mark.parametrize("scheme", [vv.Midpoint(), vv.BDF2()], ids=str)
def test_stabilised_elements_are_of_first_order_in_time_and_the_check_says_so(scheme: vv.Scheme) -> None:
    """Their stabilisation depends on the step; that of quadratic velocities has none, and nothing to say."""

    def end(steps: int) -> Array:
        system, fluid = decaying("quad4", 6, 0.4)
        vv.simulate(system, until=1.0, step=1.0 / steps, scheme=scheme)
        assert system.report is not None
        assert "first order in the step" in str(system.report)
        return fluid.velocities(system.x, system.v)

    ends = [end(n) for n in (20, 40, 80)]
    order = np.log2(np.abs(ends[0] - ends[1]).max() / np.abs(ends[1] - ends[2]).max())
    assert 0.6 < order < 1.4
    assert decaying("quad9", 4, 0.4)[0].check(repair=False).remarks == []


@pytest.mark.parametrize("scheme", [vv.Midpoint(), vv.EnergyMomentum(), vv.GeneralizedAlpha(0.8)], ids=str)
def test_pressures_belong_to_the_end_of_the_step(scheme: vv.Scheme) -> None:
    """Fields, probes and kept states converge with h^2 on those of BDF2, also where steps change their length."""

    def end(steps: int, scheme: vv.Scheme) -> Array:
        system, fluid = decaying("quad9", 4, 0.4)
        for until, h in ((0.5, 1.0 / steps), (1.0, 0.7 / steps), (1.2, 1.0 / steps)):
            result = vv.simulate(system, until=until, step=h, scheme=scheme)
        probe = vv.FlowField(fluid=fluid, field="pressure", at=(0.0, 0.0, 0.0))(system)
        fields = fluid.smoothed(["pressure"], result.states[-1])["pressure"]
        assert np.array_equal(fields, fluid.pressures(system.x))
        assert probe == pytest.approx(fields[0], abs=1e-14)
        return fields

    exact = end(320, vv.BDF2())
    coarse, fine = (np.abs(end(n, scheme) - exact).max() for n in (10, 40))
    assert np.log2(coarse / fine) / 2 > 1.9


@pytest.mark.parametrize("scheme", [vv.Midpoint(), vv.EnergyMomentum(), vv.BDF2()], ids=str)
def test_pressures_of_two_types_of_cells_belong_to_the_end_of_the_step(scheme: vv.Scheme) -> None:
    """Water at rest under a force that grows: 10 t x; where quadrangles met triangles it was that of later."""
    left = vv.RectangleMesh(size=(1, 1), counts=(4, 4)).build()
    right = vv.RectangleMesh(size=(1, 1), counts=(4, 4), cell="tri3", origin=(1, 0)).build()
    points, number = np.unique(np.vstack([left.points, right.points]).round(9), axis=0, return_inverse=True)
    nodes = number.ravel()[left.cells["quad4"]], number.ravel()[len(left.points) + right.cells["tri3"]]
    water = vv.Fluid(
        mesh=vv.Mesh(points=points, cells={"quad4": nodes[0], "tri3": nodes[1]}),
        density=1.0,
        viscosity=1.0,
        body_force=("10*t", 0, 0),
        speed=1.0,
    )
    system = vv.System([water, vv.NoSlip(fluid=water, faces="all")])
    vv.simulate(system, until=1.0, step=0.1, scheme=scheme)
    p = water.pressures(system.x)
    assert p - p[0] == pytest.approx(10 * points[:, 0], abs=1e-9)


@pytest.mark.parametrize("cell", ["quad9", "tri6"])
def test_without_viscosity_nearly_all_energy_stays(cell: str) -> None:
    """On a coarse mesh at a Reynolds number of 1e8 energy neither grows nor decays but by viscosity."""
    system, _ = decaying(cell, 4, 1e-8)
    result = vv.simulate(system, until=5.0, step=0.25)
    kinetic = result.ledger["kinetic"]
    lost = kinetic[0] - kinetic
    assert np.all(np.diff(lost) > 0)
    assert lost[-1] < 1e-5
    assert lost == pytest.approx(-result.ledger["work_viscosity"], abs=1e-12)


def test_energy_of_eddies_decays_as_it_should() -> None:
    system, _ = decaying("quad9", 24, 0.01)
    result = vv.simulate(system, until=1.0, step=0.1)
    assert result.ledger["kinetic"][-1] == pytest.approx(9.48261167717795, rel=2e-4)


# --- open boundaries ----------------------------------------------------------------------------------------
def test_tractions_that_drive_a_channel_are_those_of_cauchy() -> None:
    """Poiseuille flow between exact tractions on both ends is in the space of the elements."""
    fluid = vv.Fluid(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(4, 4), cell="quad9"), density=1.0, viscosity=0.05
    )

    def stress(side: float, pressure: float) -> Any:
        return lambda t, X: np.stack(
            [pressure + 0 * X[:, 1], side * 0.2 * (1 - 2 * X[:, 1]), 0 * X[:, 1]], axis=1
        )

    ends = [
        vv.FluidTraction(fluid=fluid, faces="x0", traction=stress(-1, 0.4)),
        vv.FluidTraction(fluid=fluid, faces="x1", traction=stress(1, 0.0)),
    ]
    system = vv.System([fluid, *ends, *(vv.NoSlip(fluid=fluid, faces=side) for side in ("y0", "y1"))])
    vv.quasi_static(system, until=1.0, step=1.0)
    assert vv.FlowRate(fluid=fluid, faces="x1")(system) == pytest.approx(2 / 3, rel=1e-9)


@pytest.mark.parametrize("cell", ["quad9", "tri6"])
def test_backflow_brings_no_energy(cell: str) -> None:
    """Eddies on a box that is open all around, hardly viscous: half of its boundary sucks, and energy only falls."""
    mesh = vv.RectangleMesh(size=(2.0, 2.0), counts=(6, 6), cell=cell, origin=(0.5, 0.7))
    start = eddies(0.0, 0.0)
    fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=1e-6, velocity=lambda X: 5.0 * start(X)[0])
    system = vv.System(
        [fluid, vv.FluidTraction(fluid=fluid, faces="all", traction=(0, 0, 0), directional=True)]
    )
    into = [vv.FlowRate(fluid=fluid, faces=side)(system) for side in ("x0", "x1", "y0", "y1")]
    assert min(into) < -0.5
    result = vv.simulate(system, until=1.0, step=0.05)
    assert np.all(np.diff(result.ledger["kinetic"]) < 0)
    assert np.all(np.diff(result.ledger["work_outflow"]) <= 0)
    middle = (fluid.by_node(result.states[-2]) + fluid.by_node(result.states[-1])) / 2
    taken = 0.0
    for p in flow_faces(fluid.grid, fluid.grid.boundary()):
        v = np.einsum("mqk,mki->mqi", p.N, middle[p.nodes])[:, :, :2]
        leaving = np.maximum(np.sum(v * p.normal, axis=2), 0.0)
        taken += 0.5 * np.sum(leaving * np.sum(v**2, axis=2))
    assert np.diff(result.ledger["work_outflow"])[-1] == pytest.approx(-0.05 * taken, rel=1e-10)
    assert result.ledger.imbalance() < 1e-10


# --- Stokes flow --------------------------------------------------------------------------------------------
def creeping(X: Array) -> tuple[Array, Array]:
    """Velocity (n, 3) and pressure (n,) of Bercovier & Engelman (1979) in the unit square, at rest at its walls."""
    x, y = X[:, 0], X[:, 1]

    def shape(s: Array, t: Array) -> Array:
        return -256 * s**2 * (s - 1) ** 2 * t * (t - 1) * (2 * t - 1)

    return np.stack([shape(x, y), -shape(y, x), 0 * x], axis=1), (x - 0.5) * (y - 0.5)


def pushing(t: float, X: Array) -> Array:
    """Body force of that flow at the viscosity 1: less the Laplacian of the velocity, and the pressure's gradient."""
    x, y = X[:, 0], X[:, 1]

    def laplacian(s: Array, t: Array) -> Array:
        a, b = s**2 * (s - 1) ** 2, t * (t - 1) * (2 * t - 1)
        return -256 * ((12 * s**2 - 12 * s + 2) * b + a * (12 * t - 6))

    return np.stack([y - 0.5 - laplacian(x, y), x - 0.5 + laplacian(y, x), 0 * x], axis=1)


@pytest.mark.parametrize(
    ("cell", "orders"), [("quad9", (3, 2)), ("tri6", (3, 2)), ("quad4", (1.95, 1.6)), ("tri3", (1.95, 1.6))]
)
def test_stokes_flow_converges(cell: str, orders: tuple[float, float]) -> None:
    """In a fluid so dense that convection, were there any, would blow it up; the equations are linear."""
    found = []
    for n in (12, 24) if orders[0] == 3 else (24, 48):
        mesh = vv.RectangleMesh(size=(1, 1), counts=(n, n), cell=cell)
        fluid = vv.Fluid(mesh=mesh, density=1e6, viscosity=1.0, body_force=pushing, convection=False)
        system = vv.System([fluid, vv.NoSlip(fluid=fluid, faces="all")])
        result = vv.quasi_static(system, until=1.0, step=1.0)
        assert result.statistics.iterations <= 2  # of which the second only finds that nothing is left
        found.append(errors(fluid, system.x, creeping))
    assert np.all(np.log2(np.array(found[0]) / found[1]) > np.array(orders) - 0.15)


@pytest.mark.parametrize("cell", ["quad9", "tri6", "quad4"])
def test_unsteady_stokes_flow_is_linear(cell: str) -> None:
    """Eddies that decay with exp(-2 nu t) without a pressure; one factorisation serves all steps, and what is twice as
    large at the start is twice as large at the end."""
    nu, ends = 0.1, []
    for size in (1.0, 2.0):
        mesh = vv.RectangleMesh(size=(2 * np.pi, 2 * np.pi), counts=(16, 16), cell=cell)
        start = eddies(0.0, nu)
        moving: Any = {"velocity": lambda X, a=size, f=start: a * f(X)[0], "periodic": TURN}
        fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=nu, convection=False, **moving)
        system = vv.System([fluid])
        result = vv.simulate(system, until=1.0, step=0.05, scheme=vv.Midpoint())
        assert result.statistics.factorizations == 1
        assert np.abs(fluid.pressures(system.x)).max() < 0.01
        ends.append(fluid.velocities(system.x, system.v))
        exact = size * eddies(1.0, nu)(fluid.points)[0]
        assert np.abs(ends[-1] - exact).max() < 0.01 * size * (1 if cell != "quad4" else 2)
        assert result.ledger.imbalance() < 1e-12
    assert np.allclose(2 * ends[0], ends[1], rtol=0, atol=1e-9)


# --- adaptive steps -----------------------------------------------------------------------------------------
def test_adaptive_steps_follow_a_flow_that_starts() -> None:
    """A channel under a force from rest on: short steps first, long ones later, the series of the profile all along."""
    mesh = vv.RectangleMesh(size=(0.25, 1.0), counts=(1, 16), cell="quad9")
    fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=1.0, body_force=(1, 0, 0), periodic=(("x0", "x1"),))
    system = vv.System([fluid, *(vv.NoSlip(fluid=fluid, faces=side) for side in ("y0", "y1"))])
    rule, lengths, worst = vv.Adaptive(tolerance=1e-4), [], 0.0
    y, n = fluid.points[:, 1], np.arange(1, 200, 2)[:, None] * np.pi
    marching = vv.march(system, until=1.0, step=1e-3, scheme=vv.Midpoint(), adaptive=rule)
    for _ in marching:
        lengths.append(system.last_step)
        exact = 0.5 * y * (1 - y) - np.sum(4 / n**3 * np.sin(n * y) * np.exp(-(n**2) * system.time), axis=0)
        worst = max(worst, float(np.abs(fluid.velocities(system.x, system.v)[:, 0] - exact).max()))
    assert worst < 2e-3 * 0.125
    assert max(lengths) > 10 * min(lengths)
    assert len(lengths) < 100
    assert system.time == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("rho", [0.0, 0.9])
def test_generalised_alpha_starts_with_the_rates_of_the_inflow(rho: float) -> None:
    """An inflow from rest, ``1 - cos(pi t)``: pressures began with its second derivative and swung by 380 about 8."""

    def pressures(scheme: vv.Scheme) -> Array:
        water = vv.Fluid(
            mesh=vv.RectangleMesh(size=(4, 1), counts=(8, 4), cell="quad9"), density=10.0, viscosity=1.0
        )
        profile = ("6*(1 - cos(pi*t))", 0, 0)
        inlet = vv.VelocityBoundary(fluid=water, faces="x0", velocity=profile)
        slip = [vv.FreeSlip(fluid=water, faces=side) for side in ("y0", "y1")]
        system = vv.System([water, inlet, *slip, vv.Outlet(fluid=water, faces="x1")])
        result = vv.simulate(system, until=0.2, step=0.02, scheme=scheme)
        return np.array(result.states)[:, water.pressure.start]

    exact = 10.0 * 4.0 * 6 * np.pi * np.sin(np.pi * np.linspace(0, 0.2, 11))  # density, length, acceleration
    off = np.abs(pressures(vv.GeneralizedAlpha(rho=rho)) - exact)[
        2:
    ]  # what damps most errs most in the first step
    assert off.max() < 0.02 * exact.max()
