"""Heat across surfaces whose meshes do not match: patch tests, jumps, both laws, a channel with a wall."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]
CELLS = ["quad4", "tri3", "quad9", "tri6", "quad8", "hex8", "tet4", "hex20", "tet10", "hex27"]


def block(cell: str, first: bool, bent: float = 0.0) -> vv.Mesh:
    """One of two blocks that meet in x = 1, or in an oblique plane."""
    counts = (2, 3, 3) if first else (2, 2, 2)
    linear = {
        "quad9": "quad4",
        "quad8": "quad4",
        "tri6": "tri3",
        "hex20": "hex8",
        "hex27": "hex8",
        "tet10": "tet4",
    }
    plain = linear.get(cell, cell)
    shape: Any = vv.BoxMesh if plain in ("hex8", "tet4") else vv.RectangleMesh
    d = 3 if shape is vv.BoxMesh else 2
    origin = (0.0 if first else 1.0, 0.0, 0.0)[:d]
    mesh = shape(size=(1, 1, 1)[:d], counts=counts[:d], cell=plain, origin=origin).build()
    X = mesh.points.copy()
    X[:, 0] += bent * (1 - np.abs(X[:, 0] - 1)) * X[:, 1]
    moved = vv.Mesh(X, mesh.cells, face_sets=mesh.face_sets)
    return moved if cell == plain else moved.quadratic(cell)


def blocks(cell: str, other: str, **options: Any) -> tuple[vv.ThermalBody, vv.ThermalBody]:
    return (
        vv.ThermalBody(mesh=block(cell, True, 0.3), conductivity=2.0, **options),
        vv.ThermalBody(mesh=block(other, False, 0.3), conductivity=2.0, **options),
    )


@pytest.mark.parametrize(
    ("cell", "other"), [(c, c) for c in CELLS] + [("quad9", "tri3"), ("tri6", "quad4"), ("hex27", "tet4")]
)
def test_linear_temperatures_pass_through(cell: str, other: str) -> None:
    """Patch test: heat that flows along x does so across an oblique interface between other meshes as well."""

    def linear(t: float, X: Array) -> Array:
        return 1 + 3 * X[:, 0]

    first, second = blocks(cell, other)
    tie = vv.HeatTie(first=first, first_faces="x1", second=second, second_faces="x0")
    held = [
        vv.PrescribedTemperature(body=first, nodes="x0", value=linear),
        vv.PrescribedTemperature(body=second, nodes="x1", value=linear),
    ]
    system = vv.System([first, second, tie, *held])
    vv.quasi_static(system, until=1.0, step=1.0)
    for body in (first, second):
        assert body.temperatures(system.x) == pytest.approx(linear(0.0, body.points), abs=1e-11)


@pytest.mark.parametrize("exchanged", [False, True])
@pytest.mark.parametrize("counts", [(3, 2), (1, 5)])
def test_each_surface_is_held_in_another_place(counts: tuple[int, int], exchanged: bool) -> None:
    """Half of the one and half of the other at what a linear field has there: so are all, to second order."""
    deviation = []
    for n in (4, 8, 16):
        bodies = [
            vv.ThermalBody(
                mesh=vv.RectangleMesh(size=(1, 1), counts=(2 * n, n * counts[k]), origin=(k, 0)),
                conductivity=2.0,
            )
            for k in range(2)
        ]
        held = [
            vv.PrescribedTemperature(body=bodies[0], nodes="x0", value=1.0),
            vv.PrescribedTemperature(body=bodies[1], nodes="x1", value=7.0),
        ]
        for body, lower in zip(bodies, (True, False), strict=True):
            x, y = body.points[:, 0], body.points[:, 1]
            at = (np.abs(x - 1) < 1e-9) & ((y < 0.49) if lower else (y > 0.51))
            held.append(vv.PrescribedTemperature(body=body, nodes=np.flatnonzero(at), value=4.0))
        sides = [(bodies[0], "x1"), (bodies[1], "x0")]
        (first, its), (second, other) = sides[::-1] if exchanged else sides
        tie = vv.HeatTie(first=first, first_faces=its, second=second, second_faces=other)
        system = vv.System([*bodies, tie, *held])
        vv.quasi_static(system, until=1.0, step=1.0)
        missed = [body.temperatures(system.x) - 1 - 3 * body.points[:, 0] for body in bodies]
        deviation.append(np.sqrt(np.mean(np.concatenate(missed) ** 2)))
    assert deviation[0] < 0.0025
    assert min(deviation[0] / deviation[1], deviation[1] / deviation[2]) > 3.5


@pytest.mark.parametrize("cell", ["quad4", "tri6", "hex8", "hex20"])
def test_a_conductance_leaves_a_jump(cell: str) -> None:
    """Two bars in series with the resistances 1/2 + 1/4 + 1/2 between 20 and 0: 16, then 8 and 4 beside the gap."""
    first, second = (vv.ThermalBody(mesh=block(cell, k), conductivity=2.0) for k in (True, False))
    tie = vv.HeatTie(first=first, first_faces="x1", second=second, second_faces="x0", conductance=4.0)
    held = [
        vv.PrescribedTemperature(body=first, nodes="x0", value=20.0),
        vv.PrescribedTemperature(body=second, nodes="x1", value=0.0),
    ]
    system = vv.System([first, second, tie, *held])
    vv.quasi_static(system, until=1.0, step=1.0)
    flow = 20.0 / (0.5 + 0.25 + 0.5)
    assert first.temperatures(system.x)[first.nodes("x1")] == pytest.approx(20 - flow / 2, abs=1e-10)
    assert second.temperatures(system.x)[second.nodes("x0")] == pytest.approx(flow / 2, abs=1e-10)
    assert vv.HeatFlow(body=first, nodes="x0")(system) == pytest.approx(flow, rel=1e-10)


@pytest.mark.parametrize(
    ("cell", "other"),
    [("tet4", "tet4"), ("hex20", "hex20"), ("hex27", "hex8"), ("tet4", "body")],
)
def test_a_conductance_leaves_a_jump_between_solids_too(cell: str, other: str) -> None:
    """The same in series at absolute temperatures: pairs of faces share unlike numbers of points, and heat is divided
    by the temperature at each."""

    def solid(mesh: vv.Mesh) -> vv.ThermoelasticSolid:
        heat = vv.Heat(conductivity=2.0, capacity=1.0, reference=300.0)
        return vv.ThermoelasticSolid(mesh=mesh, material=vv.NeoHooke(young=1e3, poisson=0.3), heat=heat)

    first, second = solid(block(cell, True)), solid(block(cell if other == "body" else other, False))
    if other == "body":
        second = vv.ThermalBody(mesh=second.grid, conductivity=2.0, temperature=300.0)
    tie = vv.HeatTie(first=first, first_faces="x1", second=second, second_faces="x0", conductance=4.0)
    solids = [body for body in (first, second) if isinstance(body, vv.ThermoelasticSolid)]
    held = [
        vv.PrescribedTemperature(body=first, nodes="x0", value=320.0),
        vv.PrescribedTemperature(body=second, nodes="x1", value=300.0),
        *(vv.Fixed(solid=body, nodes="all") for body in solids),
    ]
    system = vv.System([first, second, tie, *held])
    vv.quasi_static(system, until=1.0, step=1.0)
    flow = 20.0 / (0.5 + 0.25 + 0.5)
    assert first.temperatures(system.x)[first.nodes("x1")] == pytest.approx(320 - flow / 2, abs=1e-6)
    assert second.temperatures(system.x)[second.nodes("x0")] == pytest.approx(300 + flow / 2, abs=1e-6)


@pytest.mark.parametrize("conductance", [None, 3.0])
def test_insulated_bodies_exchange_what_they_have(conductance: float | None) -> None:
    """In time: the heat of both together stays as it is to rounding, and they end at the mean."""
    first, second = blocks("quad9", "tri3")
    second = vv.ThermalBody(mesh=second.grid, conductivity=2.0, temperature=10.0)
    tie = vv.HeatTie(first=first, first_faces="x1", second=second, second_faces="x0", conductance=conductance)
    system = vv.System([first, second, tie])
    heat = vv.simulate(system, until=5.0, step=0.05, scheme=vv.BDF2()).ledger["potential_stored"]
    assert np.ptp(heat) < 1e-13 * heat[0]
    assert first.temperatures(system.x) == pytest.approx(heat[0] / 2, abs=1e-3)
    assert second.temperatures(system.x) == pytest.approx(heat[0] / 2, abs=1e-3)


def rings(
    conductivity: float, **options: Any
) -> tuple[vv.ThermoelasticSolid, vv.ThermoelasticSolid, vv.HeatTie]:
    """A hot core and a cold ring about it, with other numbers of cells along the circle."""
    heat = vv.Heat(
        conductivity=conductivity, capacity=0.2, expansion=0.002, reference=20.0, moduli_slope=0.02
    )
    common: Any = {
        "material": vv.NeoHooke(lame_lambda=20.0, shear=10.0),
        "density": 1.0,
        "heat": heat,
        "angular_velocity": (0.3, 0.2, 1.0),
    }
    inner = vv.HollowCylinderMesh(inner_radius=0.4, outer_radius=0.8, height=0.5, counts=(1, 12, 1))
    outer = vv.HollowCylinderMesh(inner_radius=0.8, outer_radius=1.2, height=0.5, counts=(1, 9, 1))
    core = vv.ThermoelasticSolid(mesh=inner, temperature=lambda X: 26 + 2 * X[:, 0], **common)
    ring = vv.ThermoelasticSolid(mesh=outer, temperature=20.0, **common)
    tie = vv.HeatTie(first=core, first_faces="outer", second=ring, second_faces="inner", reach=0.1, **options)
    return core, ring, tie


@pytest.mark.parametrize("conductance", [None, 0.5])
def test_a_hot_turning_curved_tie_makes_neither_energy_nor_entropy(conductance: float | None) -> None:
    """Energy and momenta to rounding; entropy never falls."""
    core, ring, tie = rings(0.3, conductance=conductance)
    mechanical = vv.Tie(
        first=core, first_faces="outer", second=ring, second_faces="inner", reach=0.1, multipliers="standard"
    )
    system = vv.System([core, ring, tie, mechanical], vv.Newton(tolerance=1e-13))
    entropy: list[float] = []
    result = vv.simulate(
        system,
        until=0.5,
        step=0.05,
        observe=lambda s: entropy.append(core.total_entropy(s.x) + ring.total_entropy(s.x)),
    )
    kept = result.conservation()
    assert kept["energy"] < 1e-11
    assert max(kept[f"angular_{k}"] for k in "xyz") < 1e-11
    assert np.min(np.diff(entropy)) > 0
    assert core.temperatures(system.x).mean() < 25


def test_the_bond_itself_makes_no_entropy() -> None:
    """What arises in bodies that hardly conduct goes down with their conductivity, and the bond's share is nothing."""
    made = []
    for conductivity in (1e-6, 2e-6):
        core, ring, tie = rings(conductivity)
        system = vv.System([core, ring, tie], vv.Newton(tolerance=1e-13))
        start = core.total_entropy(system.x) + ring.total_entropy(system.x)
        vv.simulate(system, until=0.05, step=0.05)
        made.append(core.total_entropy(system.x) + ring.total_entropy(system.x) - start)
    assert made[0] == pytest.approx(made[1] / 2, rel=0.02)


@pytest.mark.parametrize("conductance", [None, 0.5])
def test_a_tie_that_was_turned_conducts_the_same(conductance: float | None) -> None:
    """Rigidly turned about an oblique axis before the start: the same temperatures after ten steps."""
    found = []
    for angle in (0.0, 1.1):
        core, ring, tie = rings(0.3, conductance=conductance)
        axis = np.array([1.0, 2.0, 2.0]) / 3
        K = np.cross(np.eye(3), axis)
        R = np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K
        system = vv.System([core, ring, tie], vv.Newton(tolerance=1e-13))
        for body in (core, ring):
            first = int(body.node_unknowns(np.array([0]))[0])
            own = slice(first, first + 3 * body.grid.n_nodes)
            for values in (system.core.x, system.core.v):
                values[own] = (np.array(values[own]).reshape(-1, 3) @ R.T).ravel()
        system.invalidate()
        vv.simulate(system, until=0.3, step=0.03)
        found.append(np.concatenate([core.temperatures(system.x), ring.temperatures(system.x)]))
    assert np.abs(found[0] - found[1]).max() < 1e-9
    assert np.ptp(found[0]) > 0.3


def test_a_body_that_stands_still_beside_a_solid_that_moves() -> None:
    """Heat of the one is energy of the other: their sum stays as it is."""
    for conductance in (None, 0.5):
        core, _, _ = rings(0.3)
        outer = vv.HollowCylinderMesh(inner_radius=0.8, outer_radius=1.2, height=0.5, counts=(1, 9, 1))
        ring = vv.ThermalBody(mesh=outer, conductivity=0.5, temperature=20.0, capacity=0.2)
        tie = vv.HeatTie(first=core, first_faces="outer", second=ring, second_faces="inner", reach=0.1,
                         conductance=conductance)  # fmt: skip
        system = vv.System([core, ring, tie], vv.Newton(tolerance=1e-13))
        result = vv.simulate(system, until=0.5, step=0.05)
        assert result.conservation()["energy"] < 1e-11
        assert core.temperatures(system.x).mean() < 25


def test_a_channel_with_a_wall_that_conducts() -> None:
    """Couette flow heated by viscosity between a wall of a solid, cold outside, and a plate: closed form.

    The fluid's heat mu (U / H)^2 y leaves through the wall: k_s (T_w - T_0) / D = mu U^2 / H, and in the fluid
    T = T_w + mu U^2 / k (y / H - y^2 / 2 H^2), as its upper side is insulated.
    """
    mesh = vv.RectangleMesh(size=(0.5, 1.0), counts=(3, 4), cell="quad9")
    fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=0.5, periodic=(("x0", "x1"),), dry=True)
    heat = vv.FluidHeat(fluid=fluid, conductivity=0.25, capacity=1.0, viscous_heating=True)
    wall = vv.ThermalBody(
        mesh=vv.RectangleMesh(size=(0.5, 0.2), counts=(2, 2), origin=(0, -0.2)), conductivity=0.4
    )
    system = vv.System([
        fluid, heat, wall,
        vv.VelocityBoundary(fluid=fluid, faces="y1", velocity=("2*t", 0, 0)),
        vv.NoSlip(fluid=fluid, faces="y0"),
        vv.HeatTie(first=heat, first_faces="y0", second=wall, second_faces="y1"),
        vv.PrescribedTemperature(body=wall, nodes="y0", value=1.0),
    ])  # fmt: skip
    vv.quasi_static(system, until=1.0, step=1.0)
    y, flow = heat.points[:, 1], 0.5 * 2.0**2
    at_wall = 1.0 + flow * 0.2 / 0.4
    assert wall.temperatures(system.x)[wall.nodes("y1")] == pytest.approx(at_wall, abs=1e-10)
    assert heat.temperatures(system.x) == pytest.approx(at_wall + flow / 0.25 * (y - y**2 / 2), abs=1e-10)


def test_a_bolt_conducts_as_its_place_and_faces_say() -> None:
    """Two insulated bodies that conduct well: the difference of their temperatures falls by exp(-C (1/c1 + 1/c2) t)."""
    first, second = (
        vv.ThermalBody(mesh=block("hex8", k), conductivity=1e6, temperature=10.0 * k, capacity=2.0 + k)
        for k in (True, False)
    )
    bolt = vv.HeatExchange(a=first, at_a=(0.9, 0.4, 0.4), b=second, faces_b="x0", conductance=0.7)
    system = vv.System([first, second, bolt])
    vv.simulate(system, until=1.0, step=0.01)
    left, right = (body.temperatures(system.x) for body in (first, second))
    assert left.mean() - right.mean() == pytest.approx(10 * np.exp(-0.7 * (1 / 3 + 1 / 2)), rel=1e-4)
    assert 3 * left.mean() + 2 * right.mean() == pytest.approx(30.0, rel=1e-6)


@pytest.mark.parametrize("conductance", [0.3, None])
def test_shells_that_are_tied_even_out(conductance: float | None) -> None:
    """``100 exp(-2 h t / c d)`` of two that are even within, and at once without a resistance; energy is kept."""
    grid = vv.RectangleMesh(size=(1, 1), counts=(2, 2)).build()
    even = vv.Heat(conductivity=1e4, capacity=2.0, reference=300.0)
    shells = []
    for k in range(2):
        X = np.column_stack([grid.points[:, :2], np.full(len(grid.points), 0.1 * k)])
        shells.append(
            vv.ThermalShell(
                mesh=vv.Mesh(X, grid.cells, face_sets=grid.face_sets),
                section=vv.SolidSection(
                    material=vv.NeoHooke(young=1e4, poisson=0.0), thickness=0.1, density=1.0
                ),
                heat=even,
                temperature=300.0 + 100 * k,
            )
        )
    lower, upper = shells
    tie = vv.HeatTie(
        first=lower,
        first_faces="upper",
        second=upper,
        second_faces="lower",
        conductance=conductance,
        reach=0.2,
    )
    system = vv.System([*shells, tie, *[vv.Fixed(solid=s, nodes="all") for s in shells]])
    result = vv.simulate(system, until=0.2, step=0.01)
    jump = upper.temperatures(system.x).mean() - lower.temperatures(system.x).mean()
    left = 0.0 if conductance is None else 100 * np.exp(-2 * 0.3 * 0.2 / (2.0 * 0.1))
    assert np.mean([s.temperatures(system.x) for s in shells]) == pytest.approx(350.0, abs=1e-9)
    assert jump == pytest.approx(left, rel=1e-4, abs=0.05 if conductance is None else 0.0)
    assert np.abs(result.ledger["imbalance"]).max() < 1e-12 * 2.0 * 0.1 * 400


def test_a_turning_link_keeps_energy_and_makes_entropy() -> None:
    core, ring, _ = rings(0.3)
    strap = vv.HeatExchange(a=core, faces_a="top", b=ring, faces_b="bottom", conductance=0.4)
    system = vv.System([core, ring, strap], vv.Newton(tolerance=1e-13))
    entropy: list[float] = []
    result = vv.simulate(
        system, until=0.5, step=0.05,
        observe=lambda s: entropy.append(core.total_entropy(s.x) + ring.total_entropy(s.x)),
    )  # fmt: skip
    assert result.conservation()["energy"] < 1e-12
    assert np.min(np.diff(entropy)) > 0


def test_refusals_of_links() -> None:
    first, second = blocks("quad4", "quad4")
    given: dict[str, Any] = {
        "a": first, "b": second, "at_a": (0.5, 0.5, 0), "faces_b": "x0", "conductance": 1.0
    }  # fmt: skip
    cases: list[tuple[dict[str, Any], str]] = [
        ({"conductance": -1.0}, "conductance = -1 is negative"),
        ({"b": first}, "exchanges heat of .* with itself"),
        ({"at_a": None}, "say where on .* by one of nodes_a, at_a and faces_a"),
        ({"at_b": (1, 1, 0)}, "say where on .* by one of nodes_b, at_b and faces_b"),
        ({"at_a": (9, 9, 0)}, "lies in none of its elements"),
        ({"faces_b": "x7"}, "x7"),
        ({"b": vv.HeatStore(capacity=1.0)}, "faces_b is for bodies with nodes"),
    ]
    for options, words in cases:
        with pytest.raises(vv.InputError, match=words):
            vv.HeatExchange(**{**given, **options})


def test_a_tie_that_conducts_is_not_said_to_insulate() -> None:
    core, ring, tie = rings(0.3)
    held = vv.Tie(first=core, first_faces="outer", second=ring, second_faces="inner", reach=0.1)
    assert any("no heat passes" in line for line in vv.System([core, ring, held]).check().remarks)
    assert not any("no heat passes" in line for line in vv.System([core, ring, held, tie]).check().remarks)


def test_refusals() -> None:
    first, second = blocks("quad4", "quad4")
    far = vv.ThermalBody(mesh=vv.RectangleMesh(size=(1, 1), counts=(2, 2), origin=(5, 0)), conductivity=1.0)
    plate = vv.ThermalBody(mesh=block("quad4", False), conductivity=1.0, thickness=0.1)
    space = vv.ThermalBody(mesh=block("hex8", False), conductivity=1.0)
    cases: list[tuple[dict[str, Any], str]] = [
        ({"conductance": -1.0}, "conductance = -1 is not positive"),
        ({"reach": 0.0}, "reach = 0 is not positive"),
        ({"second": first}, "first and second are the same"),
        ({"second": far}, r"do not touch: their nearest nodes are 3\.7"),
        ({"second": plate}, "differ in thickness"),
        ({"second": space}, "differ in dimension"),
        ({"first_faces": "x7"}, "x7"),
    ]
    for options, words in cases:
        given: dict[str, Any] = {"first": first, "first_faces": "x1", "second": second, "second_faces": "x0"}
        with pytest.raises(vv.InputError, match=words):
            vv.HeatTie(**{**given, **options})
    twice = [vv.HeatTie(first=first, first_faces="x1", second=second, second_faces="x0") for _ in range(2)]
    with pytest.raises(vv.InputError, match="both tie node"):
        vv.System([first, second, *twice])


def test_surfaces_that_are_held_all_over_leave_nothing_to_tie() -> None:
    """Which heat passes between two surfaces whose temperatures are both given, no equation tells."""
    first, second = blocks("quad4", "quad4")
    held = [
        vv.PrescribedTemperature(body=first, nodes="x1", value=20.0),
        vv.PrescribedTemperature(body=second, nodes="x0", value=0.0),
    ]
    sides: dict[str, Any] = {"first": first, "first_faces": "x1", "second": second, "second_faces": "x0"}
    with pytest.raises(vv.InputError, match="nothing is left to tie: leave it out, give it a conductance"):
        vv.System([first, second, vv.HeatTie(**sides), *held])
    vv.System([first, second, vv.HeatTie(**sides, conductance=1.0), *held])
