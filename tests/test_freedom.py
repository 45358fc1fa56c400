"""Bodies that nothing holds are refused by statics, with their free motions in words."""

from __future__ import annotations

import re
import tracemalloc
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import visviva as vv
from visviva.system.freedom import refuse_free

MATERIAL = vv.NeoHooke(young=100.0, poisson=0.3)
ALL = "translation along x, y, z; rotation about x, y, z"


def block(name: str = "block", at: tuple[float, ...] = (0.0, 0.0, 0.0), **options: Any) -> vv.Solid:
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2)).build().moved(at)
    return vv.Solid(mesh=mesh, material=MATERIAL, name=name, **options)


def slide(solid: vv.Solid, nodes: Any, *axes: int) -> vv.Fixed:
    return vv.Fixed(solid=solid, nodes=nodes, directions=tuple(k in axes for k in range(3)))


HELD: list[tuple[Callable[[vv.Solid], list[Any]], str]] = [
    (lambda b: [], ALL),
    (
        lambda b: [vv.SymmetryPlane(solid=b, nodes="z0", normal=(0, 0, 1))],
        "translation along x, y; rotation about z",
    ),
    (lambda b: [slide(b, "z0", 1, 2)], "translation along x"),
    (lambda b: [slide(b, [0], 0, 1, 2)], r"rotation about the axis .*; rotation about the axis .*"),
    (lambda b: [slide(b, [0, 2], 0, 1, 2)], "rotation about the axis through (0.5, 0, 0) along (1, 0, 0)"),
    (
        lambda b: [vv.Prescribed(solid=b, nodes="y1", motion=("0.1*t", None, None))],
        "translation along y, z; rotation about x; rotation about the axis through (0.5, 1, 0.5) along (0, 0, 1)",
    ),
    (
        lambda b: [vv.SymmetryPlane(solid=b, nodes="x0", normal=(1, 1, 0)), slide(b, "z0", 2)],
        "translation along (0.7071, -0.7071, 0)",
    ),
    (
        lambda b: [vv.ElasticFoundation(solid=b, faces="z0", normal=1e-4)],
        "translation along x, y; rotation about z",
    ),
]


@pytest.mark.parametrize("density", [0.0, 1.0])
@pytest.mark.parametrize(("supports", "words"), HELD)
def test_free_motions_of_a_solid(supports: Any, words: str, density: float) -> None:
    solid = block(density=density)
    system = vv.System(
        [solid, *supports(solid), vv.Force(on=solid, at=(1, 1, 1), force=(1, 1, 1), times="t")]
    )
    pattern = words if ".*" in words else re.escape(words)
    with pytest.raises(vv.InputError, match=rf"nothing holds Solid 'block' \({pattern}\): .*vv.Fixed"):
        vv.quasi_static(system, until=1.0, step=1.0)
    with pytest.raises(vv.InputError, match=rf"nothing holds Solid 'block' \({pattern}\)"):
        vv.arc_length(system, step=1.0, steps=1)


def test_soft_springs_hold() -> None:
    """A billionth of the block's stiffness is enough to make it well posed."""
    solid, ground = block(), vv.Ground()
    end = vv.RigidCoupling(solid=solid, faces="z0")
    stiffness = {"stiffness": (1e-7,) * 3, "rotational_stiffness": (1e-7,) * 3}
    soft = vv.Bushing(a=ground, b=end, at=(0.5, 0.5, 0), **stiffness)
    refuse_free(vv.System([solid, ground, end, soft]))


def test_plane_solids_have_three_motions() -> None:
    mesh = vv.RectangleMesh(size=(1, 1), counts=(2, 2))
    plate = vv.Solid(mesh=mesh, material=MATERIAL, name="plate")
    with pytest.raises(vv.InputError, match=re.escape("(translation along x, y; rotation about z)")):
        refuse_free(vv.System([plate]))
    ring = vv.Solid(mesh=mesh.build().moved((1, 0)), material=MATERIAL, plane="axisymmetric", name="ring")
    with pytest.raises(vv.InputError, match=re.escape("Solid 'ring' (translation along y):")):
        refuse_free(vv.System([ring]))


@pytest.mark.parametrize("kind", [vv.RigidCoupling, vv.DistributedCoupling])
def test_joined_bodies_move_together(kind: Any) -> None:
    """A body hinged to a solid that slides: the slide of both, and the turn of the body on its hinge."""
    solid = block(density=1.0)
    end = kind(solid=solid, faces="x1")
    arm = vv.RigidBody(mass=1.0, inertia=(1, 1, 1), position=(2, 0.5, 0.5), name="arm")
    hinge = vv.Revolute(a=end, b=arm, at=(1.5, 0.5, 0.5), axis=(0, 0, 1), angle=True)
    system = vv.System([solid, end, arm, hinge, slide(solid, "x0", 1, 2), slide(solid, "x1", 1, 2)])
    arm_moves = "translation along x; rotation about the axis through (1.5, 0.5, 0.5) along (0, 0, 1)"
    with pytest.raises(vv.InputError) as caught:
        refuse_free(system)
    assert "Solid 'block' (translation along x)" in str(caught.value)
    assert f"RigidBody 'arm' ({arm_moves})" in str(caught.value)
    assert "Coupling" not in str(caught.value)


def test_a_chain_to_the_ground_is_held() -> None:
    solid, ground = block(), vv.Ground()
    end = vv.RigidCoupling(solid=solid, faces="x0")
    system = vv.System([solid, ground, end, vv.Rigid(a=ground, b=end, at=(0, 0.5, 0.5))])
    refuse_free(system)
    u = vv.quasi_static(system, until=1.0, step=1.0)
    assert np.abs(u.states[-1] - u.states[0]).max() < 1e-14


@pytest.mark.parametrize("start", [vv.quasi_static, vv.simulate, vv.equilibrium, vv.System.check])
def test_an_incompressible_solid_held_throughout(start: Callable[..., Any]) -> None:
    """Its pressures are any; it was called a motion that joints do not allow, by 1.8e-16, or went on in statics."""
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1), cell="hex27")
    rubber = vv.NeoHooke(young=10.0, poisson=0.5)
    block = vv.Solid(mesh=mesh, material=rubber, density=1.0, formulation="mixed", name="block")
    motion = (lambda t: 0.01 * t, lambda t: 0.0 * t, lambda t: 0.0 * t)
    system = vv.System([block, vv.Prescribed(solid=block, nodes="all", motion=motion)])
    options = {} if start is vv.System.check else {"until": 1.0}
    if start in (vv.quasi_static, vv.simulate):
        options["step"] = 0.5
    with pytest.raises(
        vv.InputError, match=r"'block': all of its position .*nothing tells its pressure.*0\.4999"
    ):
        start(system, **options)


# --- heat that nothing holds --------------------------------------------------------------------------------
WARM = vv.Heat(conductivity=1.0, capacity=1.0, expansion=1e-3)
CUBE = vv.BoxMesh(size=(1, 1, 1), counts=(2, 1, 1))


def graded(X: Any) -> Any:
    return 300 + 20 * X[:, 0]


def warm_cube(name: str = "cube") -> Any:
    rubber = vv.NeoHooke(young=1e3, poisson=0.3)
    return vv.ThermoelasticSolid(
        mesh=CUBE, material=rubber, density=1.0, heat=WARM, temperature=graded, name=name
    )


def expanding(cube: Any) -> list[vv.Fixed]:
    return [slide(cube, f"{c}0", k) for k, c in enumerate("xyz")]


def warm_beam() -> Any:
    section = vv.RectangleSection(width=0.1, height=0.1, young=1e4, density=1.0)
    mesh = vv.LineMesh(points=[(0, 0, 0), (1, 0, 0)], count=2)
    return vv.ThermalBeam(mesh=mesh, section=section, heat=WARM, temperature=graded, name="beam")


def warm_shell() -> Any:
    mesh, rubber = vv.RectangleMesh(size=(1, 1), counts=(2, 2)), vv.NeoHooke(young=1e3, poisson=0.3)
    section = vv.SolidSection(material=rubber, thickness=0.1, density=1.0)
    return vv.ThermalShell(mesh=mesh, section=section, heat=WARM, name="shell")


def stiff_body() -> Any:
    return vv.ThermalBody(
        mesh=CUBE, density=1.0, conductivity=1.0, capacity=1.0, temperature=graded, name="body"
    )


MADE: dict[str, Callable[[], list[Any]]] = {
    "solid": lambda: [c := warm_cube(), *expanding(c)],
    "heated solid": lambda: [
        c := warm_cube(),
        *expanding(c),
        vv.HeatFlux(body=c, faces="x1", flux=1.0),
    ],
    "beam": lambda: [b := warm_beam(), vv.Clamped(solid=b, nodes="start")],
    "shell": lambda: [s := warm_shell(), vv.Clamped(solid=s, nodes="x0")],
    "stores": lambda: [
        a := vv.HeatStore(capacity=1.0, temperature=300.0, name="a"),
        b := vv.HeatStore(capacity=1.0, temperature=350.0, name="b"),
        vv.HeatExchange(a=a, b=b, conductance=1e-3),
    ],
    "body and solid": lambda: [
        b := stiff_body(),
        c := warm_cube(),
        *expanding(c),
        vv.HeatExchange(a=b, b=c, faces_a="x1", faces_b="x0", conductance=1.0),
    ],
}
NAMED = {
    "solid": "ThermoelasticSolid 'cube':",
    "heated solid": "ThermoelasticSolid 'cube':",
    "beam": "ThermalBeam 'beam':",
    "shell": "ThermalShell 'shell':",
    "stores": "HeatStore 'a' and HeatStore 'b':",
    "body and solid": "ThermalBody 'body' and ThermoelasticSolid 'cube':",
}


@pytest.mark.parametrize("kind", MADE)
def test_temperatures_that_nothing_holds_are_refused(kind: str) -> None:
    with pytest.raises(vv.InputError, match=f"nothing holds the temperature of {NAMED[kind]} a steady state"):
        vv.quasi_static(vv.System(MADE[kind]()), until=1.0, step=1.0)
    vv.simulate(vv.System(MADE[kind]()), until=0.01, step=0.01)


@pytest.mark.parametrize("kind", MADE)
def test_temperatures_that_an_exchange_holds_become_those_around(kind: str) -> None:
    parts = MADE[kind]()
    first = parts[0]
    nodes = {} if kind == "stores" else {"nodes_a": "all"}
    around = vv.HeatExchange(a=first, conductance=1.0, ambient=310.0, **nodes)
    system = vv.System([*[p for p in parts if not isinstance(p, vv.HeatFlux)], around])
    vv.quasi_static(system, until=1.0, step=1.0)
    for body in (p for p in parts if hasattr(p, "temperatures") or hasattr(p, "temperature_at")):
        found = (
            body.temperatures(system.x) if hasattr(body, "temperatures") else body.temperature_at(system.x)
        )
        np.testing.assert_allclose(found, 310.0, rtol=1e-6)


def test_a_held_temperature_is_one_that_is_prescribed() -> None:
    cube = warm_cube()
    held = vv.PrescribedTemperature(body=cube, nodes="x1", value=320.0)
    system = vv.System([cube, *expanding(cube), held])
    vv.quasi_static(system, until=1.0, step=1.0)
    np.testing.assert_allclose(cube.temperatures(system.x), 320.0)


def pulled(times: str | None) -> vv.System:
    """A cube without mass that is pulled, at once or by and by."""
    cube = vv.Solid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), material=vv.NeoHooke(young=10.0, poisson=0.3)
    )
    pull = vv.Traction(solid=cube, faces="x1", traction=(1, 0, 0), times=times)
    return vv.System([cube, vv.Fixed(solid=cube, nodes="x0"), pull])


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.Midpoint(), vv.VariationalMidpoint()])
def test_what_has_no_mass_begins_in_balance(scheme: vv.Scheme) -> None:
    """About a balance in the middle of steps it would be at 0 and at twice its displacement in turn."""
    with pytest.raises(vv.InputError, match="has no density, and is not in balance at the start"):
        vv.simulate(pulled(None), until=0.1, step=0.01, scheme=scheme)
    looked_over = pulled(None)
    looked_over.check()  # which tells, and lets nothing pass
    with pytest.raises(vv.InputError, match="has no density, and is not in balance at the start"):
        vv.simulate(looked_over, until=0.1, step=0.01, scheme=scheme)
    balance = vv.quasi_static(pulled("t"), until=1.0, step=1.0).system.x
    slow = vv.simulate(pulled("t"), until=1.0, step=0.1, scheme=scheme).system.x
    assert slow == pytest.approx(balance, abs=1e-3)
    late = vv.simulate(pulled(None), until=0.1, step=0.01, scheme=vv.BackwardEuler()).system.x
    assert late == pytest.approx(balance, abs=1e-8)


def test_what_has_no_mass_and_swings_later_is_told() -> None:
    result = vv.simulate(pulled("step(t - 0.05)"), until=0.2, step=0.01)
    assert result.statistics.swings > 10


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.BackwardEuler()])
def test_what_is_out_of_balance_turns_freely_all_the_same(scheme: vv.Scheme) -> None:
    """Stress that is not in balance yet turns along with a body, which looks like a resistance."""

    def system(*held: dict[str, Any]) -> vv.System:
        alloy = vv.MixtureSolid(
            mesh=vv.RectangleMesh(size=(16, 16), counts=(8, 8)),
            material=vv.SaintVenantKirchhoff(young=100.0, poisson=0.3),
            free_energy=vv.DoubleWell(barrier=5.0, low=0.3, high=0.7),
            gradient_energy=2.0,
            concentration=lambda X: 0.5 + 0.1 * np.cos(0.4 * X[:, 0]),
            eigenstrain=0.05,
            reference=0.5,
            name="alloy",
        )
        return vv.System([alloy, *(vv.Fixed(solid=alloy, **where) for where in held)])

    pin, roller = {"nodes": [0]}, {"nodes": [8], "directions": (False, True, False)}
    words = r"'alloy' \(rotation about .* \(0, 0, 0\) .* has no mass, and nothing"
    with pytest.raises(vv.InputError, match=words):
        vv.simulate(system(pin), until=0.2, step=0.1, scheme=scheme)
    vv.simulate(system(pin, roller), until=0.2, step=0.1, scheme=scheme)


def test_looks_for_what_is_free_take_little_more_than_a_tangent() -> None:
    """Bytes for each of the unknowns, of which one tangent has 590; copies of motions were kept beside it: 1,090."""
    solid = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(24, 24, 24)), material=MATERIAL)
    system = vv.System([solid, vv.Fixed(solid=solid, nodes="x0")])
    tracemalloc.start()
    refuse_free(system)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < 900 * len(system.x)
