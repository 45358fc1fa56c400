"""Solids that start strained, or away from their reference temperature, start with the pressures of that state."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from visviva.system import algebraic

Array = NDArray[np.float64]

POISSON, MU = 0.3, 40.0
LAM = 2 * MU * POISSON / (1 - 2 * POISSON)
RUBBER = vv.NeoHooke(shear=MU, poisson=POISSON)
WARM = vv.Heat(conductivity=5.0, capacity=3.0, expansion=0.002, reference=300.0)
IN_SPACE = ["hex8", "hex20", "hex27", "tet4", "tet10", "wedge6"]
IN_PLANE = ["quad4", "quad9", "tri3", "tri6"]
HEATED = [("displacement", "hex20"), ("F-bar", "hex8"), ("enhanced", "hex8")]
HEATED += [("mixed", cell) for cell in ("hex8", "hex20", "hex27", "tet10")]
MEMORIES = [vv.BDF2(), vv.GeneralizedAlpha()]


def box(cell: str, n: int = 1) -> Any:
    if cell in IN_SPACE:
        return vv.BoxMesh(size=(1, 1, 1), counts=(n, n, n), cell=cell)
    return vv.RectangleMesh(size=(1, 1), counts=(n, n), cell=cell)


def block(cell: str, kind: type[vv.Solid] = vv.Solid, n: int = 1, **more: Any) -> vv.Solid:
    given = {"formulation": "mixed", "material": RUBBER, "density": 1.0, **more}
    return kind(mesh=box(cell, n), **given)


def heated(cell: str, formulation: str, temperature: Any = 330.0, n: int = 1) -> vv.ThermoelasticSolid:
    more = {"heat": WARM, "temperature": temperature, "formulation": formulation}
    return block(cell, vv.ThermoelasticSolid, n, **more)  # type: ignore[return-value]


def put(body: vv.Solid, system: vv.System, move: Callable[[Array], Array]) -> None:
    """Start with the nodes where `move` takes their places."""
    first = np.asarray(body.node_unknowns(np.arange(len(body.points))))
    components = np.arange(body.dimension)
    system.x[first[:, None] + components] = move(body.points)[:, components]
    system.invalidate()


def dilated(X: Array) -> Array:
    return 1.1 * X


def wavy(X: Array) -> Array:
    return np.asarray(X + 0.03 * np.sin(np.pi * np.roll(X, 1, axis=1)) + 0.02 * X**2)


def dilation(stretches: Sequence[float]) -> tuple[float, Array]:
    """Energy per volume and first Piola-Kirchhoff stresses (3,) of what is stretched along the axes."""
    s = np.array(stretches)
    log = float(np.log(s).sum())
    return MU * (0.5 * float(s @ s - 3) - log) + 0.5 * LAM * log**2, MU * (s - 1 / s) + LAM * log / s


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.BDF2(), vv.Static()], ids=str)
@pytest.mark.parametrize("cell", IN_SPACE + IN_PLANE)
def test_dilated_blocks_start_with_their_energy_stress_and_reactions(cell: str, scheme: vv.Scheme) -> None:
    body = block(cell)
    left, rest = (vv.Fixed(solid=body, nodes=side) for side in ("x0", "x1"))
    system = vv.System([body, left, rest])
    put(body, system, dilated)
    force = vv.SupportForce(solid=body, nodes="x0")
    result = vv.simulate(system, until=1e-9, step=1e-9, scheme=scheme, record={"left": force})
    stretches = [1.1] * body.dimension + [1.0] * (3 - body.dimension)
    energy, P = dilation(stretches)
    assert np.isclose(result.ledger["potential_strain"][0], energy, rtol=1e-12)
    S = body.fields(result.states[0]).second_piola
    assert np.allclose(S, np.diag(P / stretches), atol=1e-11 * P[0])
    assert np.allclose(result.history("left")[0], [-P[0], 0, 0], atol=1e-10 * P[0])


@pytest.mark.parametrize("cell", ["quad4", "quad9", "tri6"])
def test_dilated_rings_start_with_their_energy(cell: str) -> None:
    mesh = vv.RectangleMesh(size=(1, 1), counts=(1, 1), origin=(1, 0), cell=cell)
    ring = vv.Solid(mesh=mesh, material=RUBBER, density=1.0, formulation="mixed", plane="axisymmetric")
    system = vv.System([ring])
    put(ring, system, dilated)
    result = vv.simulate(system, until=1e-9, step=1e-9)
    assert np.isclose(result.ledger["potential_strain"][0], 3 * np.pi * dilation([1.1] * 3)[0], rtol=1e-12)


@pytest.mark.parametrize(("formulation", "cell"), HEATED)
def test_heated_clamped_blocks_start_with_their_stress_and_reaction(formulation: str, cell: str) -> None:
    body = heated(cell, formulation)
    left, rest = (vv.Fixed(solid=body, nodes=side) for side in ("x0", "x1"))
    force = vv.SupportForce(solid=body, nodes="x0")
    result = vv.simulate(vv.System([body, left, rest]), until=1e-9, step=1e-9, record={"left": force})
    push = 3 * (LAM + 2 * MU / 3) * 0.002 * 30.0
    assert np.allclose(result.history("left")[0], [push, 0, 0], atol=1e-10 * push)
    of_face = body.nodal_forces(result.states[0])[body.points[:, 0] == 0.0].sum(axis=0)
    assert np.allclose(np.abs(of_face), [push, 0, 0], atol=1e-10 * push)


def at_end(make: Callable[[], vv.Solid], scheme: vv.Scheme, n: int) -> tuple[Array, Array]:
    """Positions, and what is of order 1, after n steps from a strained start."""
    body = make()
    system = vv.System([body], newton=vv.Newton(tolerance=1e-11))
    put(body, system, wavy)
    vv.simulate(system, until=0.1, step=0.1 / n, scheme=scheme, every=n)
    return system.x[system.order == 2].copy(), system.x[system.order == 1].copy()


BRANCHES = vv.prony((0.5,), (0.1,))
STARTS: dict[str, Callable[[], vv.Solid]] = {
    **{
        cell: (lambda cell=cell: block(cell, n=1 + (cell == "hex8")))
        for cell in ("hex8", "tet4", "tet10", "quad9", "tri6")
    },
    "viscous": lambda: block("tet4", vv.ViscoelasticSolid, branches=BRANCHES),
    "heated": lambda: heated("hex8", "mixed", "320 + 10*x", n=2),
    "heated, displacement": lambda: heated("hex20", "displacement", "320 + 10*x"),
}


@pytest.mark.parametrize("scheme", MEMORIES, ids=str)
@pytest.mark.parametrize("make", STARTS.values(), ids=STARTS)
def test_strained_starts_keep_the_order(make: Callable[[], vv.Solid], scheme: vv.Scheme) -> None:
    coarse, middle, fine = (at_end(make, scheme, n) for n in (40, 80, 160))
    for a, b, c in zip(coarse, middle, fine, strict=True):
        if len(a):
            assert np.log2(np.abs(a - b).max() / np.abs(b - c).max()) > 1.8


@pytest.mark.parametrize("make", STARTS.values(), ids=STARTS)
def test_energy_of_strained_starts_is_kept(make: Callable[[], vv.Solid]) -> None:
    body = make()
    system = vv.System([body])
    put(body, system, wavy)
    result = vv.simulate(system, until=0.05, step=0.0025)
    ledger = result.ledger
    lost = ledger["work_dissipated"] if "work_dissipated" in ledger.names else 0.0
    assert np.ptp(ledger["total"] - lost) < 1e-9 * ledger["total"][0]


@pytest.mark.parametrize("formulation", ["mixed", "enhanced"])
def test_runs_go_on_as_if_they_had_not_stopped(formulation: str) -> None:
    ends = []
    for stops in ((0.05,), (0.025, 0.05)):
        body = block("hex8", formulation=formulation)
        system = vv.System([body])
        put(body, system, wavy)
        for until in stops:
            vv.simulate(system, until=until, step=0.0025, scheme=vv.GeneralizedAlpha())
        ends.append(system.x.copy())
    assert np.array_equal(*ends)


def bent(angle: float) -> Callable[[Array], Array]:
    return lambda X: X + angle * X[:, :1] * X[:, 1:2] * [1.0, 0.0, 0.0]


def enhanced(**more: Any) -> vv.Solid:
    elastic = vv.SaintVenantKirchhoff(young=100.0, poisson=0.3)
    return block("hex8", **{"formulation": "enhanced", "material": elastic, **more})


@pytest.mark.parametrize("damping", [0.0, 1e-9])
def test_enhanced_strains_start_in_balance(damping: float) -> None:
    """Bending of one cell by an angle of 0.02: what is enhanced takes the stress across."""
    body = enhanced(material=vv.SaintVenantKirchhoff(young=100.0, poisson=0.0), stiffness_damping=damping)
    system = vv.System([body])
    put(body, system, bent(0.02))
    start, later = (vv.simulate(system, until=t, step=1e-9).states[0] for t in (1e-9, 2e-9))
    assert np.allclose(start[body._inner.unknowns], later[body._inner.unknowns], atol=1e-12)


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), *MEMORIES], ids=str)
def test_damped_enhanced_strains_move_as_undamped_ones_where_damping_vanishes(scheme: vv.Scheme) -> None:
    """They had rates, and started straight: a tenth too much energy, with modes that swung about balance for ever."""
    runs = []
    for damping in (0.0, 1e-9):
        body = enhanced(stiffness_damping=damping)
        system = vv.System([body])
        put(body, system, bent(0.02))
        result = vv.simulate(system, until=0.1, step=0.01, scheme=scheme)
        runs.append((result.ledger["potential_strain"], np.array(result.states)[:, body._inner.unknowns]))
    for undamped, damped in zip(*runs, strict=True):
        assert np.allclose(damped, undamped, rtol=0, atol=1e-6 * np.abs(undamped).max())


def test_bodies_without_balance_leave_that_of_others(capsys: pytest.CaptureFixture[str]) -> None:
    """Turned inside out, and bent by 0.02: all modes stayed as given, without a word."""
    upset, fine = enhanced(name="upset"), enhanced(name="fine")
    system, alone = vv.System([upset, fine]), vv.System([other := enhanced()])
    put(upset, system, bent(-1.5))
    for body, of in ((fine, system), (other, alone)):
        put(body, of, bent(0.02))
        algebraic.settle(of)
    assert capsys.readouterr().err == (
        "initial state: no balance is found of enhanced of Solid 'upset', which start as given\n"
    )
    assert not system.x[upset._inner.unknowns].any()
    assert alone.x[other._inner.unknowns].any()
    assert np.allclose(system.x[fine._inner.unknowns], alone.x[other._inner.unknowns], rtol=0, atol=1e-15)


def test_unstrained_solids_start_without_pressures() -> None:
    for poisson in (POISSON, 0.5):
        body = block("tet4", material=vv.NeoHooke(shear=MU, poisson=poisson))
        result = vv.simulate(vv.System([body]), until=0.1, step=0.1)
        assert np.abs(np.array(result.states)[:, body._inner.unknowns]).max() < 1e-12
