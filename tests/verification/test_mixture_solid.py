"""Mixtures that strain: growth of waves with misfit (Cahn 1961), free swelling, drift in stress, refusals."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

import visviva as vv

PFHUB = vv.DoubleWell(barrier=5.0, low=0.3, high=0.7)


def solid(mesh: Any, **options: Any) -> vv.MixtureSolid:
    given = {
        "material": vv.SaintVenantKirchhoff(young=20.0, poisson=0.3),
        "free_energy": PFHUB,
        "gradient_energy": 2.0,
        "mobility": 5.0,
        "concentration": 0.5,
        "reference": 0.5,
        **options,
    }
    return vv.MixtureSolid(mesh=mesh, **given)


@pytest.mark.parametrize("cell", ["quad9", "hex20"])
def test_growth_with_misfit(cell: str) -> None:
    """``R = -M k^2 (f'' + 2 eta^2 E / (1 - nu) + kappa k^2)``, of waves that strain along themselves alone."""
    k, eta, E, nu, end, h = 0.35, 0.06, 20.0, 0.3, 1.0, 0.02
    length, n = np.pi / k, 12
    mesh: Any = (
        vv.RectangleMesh(size=(length, length / n), counts=(n, 1), cell=cell)
        if cell == "quad9"
        else vv.BoxMesh(size=(length, length / n, length / n), counts=(n, 1, 1), cell=cell)
    )
    body = solid(mesh, eigenstrain=eta, concentration=lambda X: 0.5 + 1e-5 * np.cos(k * X[:, 0]))
    across = vv.Prescribed(solid=body, nodes="all", motion=(None, 0.0, 0.0 if cell == "hex20" else None))
    held = [vv.Prescribed(solid=body, nodes="x0", motion=(0.0, None, None))]
    held.append(vv.Prescribed(solid=body, nodes="x1", motion=(0.0, None, None)))
    system = vv.System([body, across, *held])
    vv.simulate(system, until=end, step=h)
    rate = -5 * k**2 * (-0.8 + 2 * eta**2 * E / (1 - nu) + 2 * k**2)
    assert np.log((body.values(system.x)[0] - 0.5) / 1e-5) / end == pytest.approx(rate, rel=1e-3)


@pytest.mark.parametrize("along", [(1, 0), (1, 1)])
def test_growth_in_a_cell_that_repeats(along: tuple[int, int]) -> None:
    """The same rate along and across the cell, whose sides move alike; alone, those of concentrations tear it."""
    side, eta, E, nu = 16.0, 0.08, 100.0, 0.3
    k = 2 * np.pi / side * np.array([*along, 0.0])
    body = solid(
        vv.RectangleMesh(size=(side, side), counts=(8, 8), cell="quad9"),
        material=vv.SaintVenantKirchhoff(young=E, poisson=nu),
        eigenstrain=eta,
        concentration=lambda X: 0.5 + 1e-4 * np.cos(X @ k),
        periodic=[("x0", "x1"), ("y0", "y1")],
        name="cell",
    )
    corner = vv.Fixed(solid=body, nodes=[0])
    for torn in ([], [("y1", "y0")]):
        sides = [vv.PeriodicFaces(solid=body, pairs=torn)] if torn else []
        words = r"^MixtureSolid 'cell': periodic has \('x0', 'x1'\), whose concentrations are one, while positions"
        with pytest.raises(vv.InputError, match=words):
            vv.System([body, corner, *sides])
    system = vv.System([body, corner, vv.PeriodicFaces(solid=body, pairs=[("x1", "x0"), ("y0", "y1")])])
    wave = np.cos(body.points @ k)
    result = vv.simulate(system, until=0.05, step=0.0025, scheme=vv.BackwardEuler())
    size = [(body.values(x) - 0.5) @ wave for x in (result.states[4], result.states[-1])]
    rate = -5 * (k @ k) * (-0.8 + 2 * eta**2 * E / (1 - nu) + 2 * (k @ k))
    assert np.log(size[1] / size[0]) / 0.04 == pytest.approx(rate, rel=5e-3)


def test_free_swelling() -> None:
    """A uniform composition off the reference strains a free body without stress."""
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2))
    body = solid(mesh, eigenstrain=(0.1, 0.2, -0.3), concentration=0.6, gradient_energy=4.0)
    F = np.diag([1.01, 1.02, 0.97])
    C = np.array([[*(np.diag(F) ** 2), 0.0, 0.0, 0.0]])
    W, S = body.respond(C, np.array([0.6]))
    assert abs(W[0]) < 1e-15
    assert np.abs(S).max() < 1e-13


def test_dynamics_and_diffusion_close_one_balance() -> None:
    """In finite strain, with moduli that depend on the composition."""
    rng = np.random.default_rng(4)
    body = solid(
        vv.RectangleMesh(size=(10, 10), counts=(8, 8)),
        material=vv.NeoHooke(young=20.0, poisson=0.3),
        density=0.2,
        eigenstrain=0.3,
        moduli=(0.8, 0.5),
        concentration=lambda X: 0.5 + 0.05 * rng.standard_normal(len(X)),
        velocity=lambda X: 0.02 * X,
    )
    system = vv.System([body])
    mass = body.integral(system.x)
    result = vv.simulate(system, until=10.0, step=0.25)
    figures = result.conservation()
    assert figures["energy"] < 1e-10
    assert max(figures["momentum_x"], figures["momentum_y"], figures["angular_z"]) < 1e-11
    assert body.integral(system.x) == pytest.approx(mass, rel=1e-13)
    assert np.all(np.diff(result.ledger["total"]) < 0)


@pytest.mark.parametrize("density", [0.0, 1.0])
def test_no_unit_decides_where_a_step_ends(density: float) -> None:
    """In metres, megapascals, kilometres: concentration and gradient are weighed against nothing."""

    def after(length: float, pressure: float, time: float) -> np.ndarray:
        side = 16 * length
        body = solid(
            vv.RectangleMesh(size=(side, side), counts=(8, 8)),
            material=vv.NeoHooke(young=100 * pressure, poisson=0.3),
            free_energy=vv.DoubleWell(barrier=5.0 * pressure, low=0.3, high=0.7),
            gradient_energy=2 * pressure * length**2,
            mobility=5 * length**2 / (pressure * time),
            density=density * pressure * (time / length) ** 2,
            concentration=lambda X: (
                0.5 + 0.05 * np.cos(0.5 * X[:, 0] / length) * np.cos(0.3 * X[:, 1] / length)
            ),
            eigenstrain=0.05,
        )
        system = vv.System([body, vv.Fixed(solid=body, nodes="x0")])
        result = vv.simulate(system, until=2 * time, step=0.5 * time)
        assert result.conservation()["energy"] < 1e-10
        assert np.all(np.diff(result.ledger["total"]) < 0)
        return body.values(system.x)

    expected = after(1.0, 1.0, 1.0)
    for units in ((1e-6, 1e6, 1.0), (1e3, 1e-6, 1e3), (1e-9, 1e9, 1e-3)):
        assert after(*units) == pytest.approx(expected, abs=1e-9)


def test_stress_drives_diffusion() -> None:
    """A bent beam whose large component strains: that goes to where it is stretched."""
    mesh = vv.RectangleMesh(size=(8, 2), counts=(16, 4), cell="quad9")
    well = vv.PolynomialEnergy(coefficients=(0.0, 0.0, 1.0), centre=0.5)
    body = solid(mesh, free_energy=well, eigenstrain=0.2, gradient_energy=0.01)
    clamp = vv.Fixed(solid=body, nodes="x0")
    load = vv.Traction(solid=body, faces="x1", traction=(0.0, -0.02, 0.0))
    system = vv.System([body, clamp, load])
    vv.simulate(system, until=20.0, step=0.5, scheme=vv.BackwardEuler())
    c, X = body.values(system.x), body.points
    middle = np.abs(X[:, 0] - 4.0) < 1e-9
    top, bottom = c[middle & (X[:, 1] > 1.99)], c[middle & (X[:, 1] < 0.01)]
    assert top[0] - 0.5 == pytest.approx(0.5 - bottom[0], rel=0.05)
    # 2 (c - 1/2) = eta tr sigma, of which sigma_z = nu sigma_x - E eta (c - 1/2), and sigma_x = M y / I
    stress = 0.02 * 2 * 4 * 1.0 / (8 / 12)
    assert top[0] - 0.5 == pytest.approx(0.2 * 1.3 * stress / (2 + 20 * 0.2**2), rel=0.03)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"eigenstrain": -20.0, "concentration": 0.6}, "a concentration of 0.6 leaves lengths of -1 times"),
        ({"moduli": (-20.0,), "concentration": 0.6}, "a concentration of 0.6 leaves a stiffness of -1 times"),
        ({"moduli": (1.0, 1.0, 1.0, 1.0)}, "moduli has 4 coefficients, 3 are known"),
        ({"plane": "stress"}, "plane = 'stress'"),
        ({"free_energy": vv.UserFreeEnergy(function=lambda c: c * c)}, "needs a free energy of the core"),
        ({"material": vv.LinearElastic(young=1.0, poisson=0.3)}, "take vv.SaintVenantKirchhoff"),
        ({"gradient_energy": 0.01}, "less than two cells resolve it"),
        ({"mobility": -1.0}, "mobility = -1 is not positive"),
    ],
)
def test_refusals(options: Any, words: str) -> None:
    with pytest.raises(vv.InputError, match=re.escape(words)):
        solid(vv.RectangleMesh(size=(4, 4), counts=(4, 4)), **options)


CUBE: dict[str, Any] = {"size": (1, 1, 1), "counts": (2, 2, 2)}
STEPS: list[tuple[vv.Scheme, vv.Adaptive | None]] = [
    (vv.EnergyMomentum(), None),
    (vv.EnergyMomentum(), vv.Adaptive(tolerance=1e-3)),
    (vv.Midpoint(), None),
    (vv.BDF2(), None),
    (vv.GeneralizedAlpha(), None),
]


@pytest.mark.parametrize("splines", [False, True])
@pytest.mark.parametrize(("scheme", "adaptive"), STEPS)
def test_no_step_ends_where_no_stiffness_is_left(scheme: vv.Scheme, adaptive: Any, splines: bool) -> None:
    """Of concentrations that grow at an even rate it is lost at t = 1/2."""
    given: dict[str, Any] = {
        "material": vv.SaintVenantKirchhoff(young=1000.0, poisson=0.25),
        "free_energy": vv.PolynomialEnergy(coefficients=(0.0, 0.0, 5.0), centre=0.5),
        "concentration": 0.55,
        "reference": 0.5,
        "gradient_energy": 1.0,
        "eigenstrain": 0.01,
        "moduli": (-10.0,),
        "name": "foam",
    }
    body = (
        vv.SplineMixtureSolid(mesh=vv.SplineBox(**CUBE, degree=2), **given)
        if splines
        else vv.MixtureSolid(mesh=vv.BoxMesh(**CUBE), **given)
    )
    normals = np.eye(3)
    held = [vv.SymmetryPlane(solid=body, nodes=f"{'xyz'[k]}0", normal=normals[k]) for k in range(3)]
    system = vv.System([body, *held, vv.ConcentrationSource(body=body, rate=0.1)])
    with pytest.raises(
        vv.StepFailure, match=r"MixtureSolid 'foam' near \(0.*a concentration of 0.6.*by moduli = "
    ):
        vv.simulate(system, until=1.0, step=0.1, scheme=scheme, adaptive=adaptive)
    reached = body.values(system.x)
    assert reached == pytest.approx(0.55 + 0.1 * system.time, abs=1e-9)
    assert 0.599 < reached.max() < 0.6


def test_no_step_ends_where_no_length_is_left() -> None:
    body = solid(vv.BoxMesh(**CUBE), gradient_energy=4.0, eigenstrain=(0.0, -10.0, 0.0), name="foam")
    system = vv.System([body])
    x = system.x.copy()
    x[body.phase.unknowns] = 0.599
    assert body.invalid(x) == ""
    x[body.phase.unknowns[-1]] = 0.7
    words = r"^element 7 of MixtureSolid 'foam' near \(0.*leaves lengths of -0.* by eigenstrain = \(0.0, -10.0, 0.0\)"
    assert re.match(words, body.invalid(x))


def test_statics_ends_where_nothing_is_left() -> None:
    body = solid(vv.BoxMesh(**CUBE), gradient_energy=4.0, moduli=(-10.0,), name="foam")
    held = vv.PrescribedConcentration(body=body, nodes="x0", value="0.5 + 0.02 * t")
    system = vv.System([body, vv.Fixed(solid=body, nodes="x0"), held])
    with pytest.raises(
        vv.RunError, match=r"element \d of MixtureSolid 'foam' near .* leaves a stiffness of -"
    ):
        vv.quasi_static(system, until=10.0, step=1.0)
    assert 4.9 < system.time < 5.0


def test_phases_near_the_ends_of_logarithms_are_remarked_on_with_a_cure_that_is_one() -> None:
    """Corners are no points of quadrature here, whatever the cells: nodes go beyond on those without middle nodes."""
    mesh = vv.RectangleMesh(size=(6, 6), counts=(12, 12))
    start: dict[str, Any] = {"gradient_energy": 6.0, "name": "gel"}

    def remarks(energy: Any) -> str:
        body = solid(mesh, free_energy=energy, **start)
        return str(vv.System([body, vv.Fixed(solid=body, nodes="x0")]).check())

    deep = remarks(vv.FloryHuggins(chi=7.0))
    assert "MixtureSolid 'gel': its phases are of 0.00" in deep
    assert "nodes may go beyond, and steps stay short; take a free energy whose phases are less pure" in deep
    assert "cells without nodes" not in deep
    for cure in (vv.FloryHuggins(chi=2.5), vv.DoubleWell(barrier=5.0, low=0.01, high=0.99)):
        assert "logarithms" not in remarks(cure)


def test_what_is_refused_of_the_mixture_names_the_solid() -> None:
    mesh = vv.RectangleMesh(size=(6, 6), counts=(12, 12))
    for name, label in (("gel", "MixtureSolid 'gel': "), (None, "MixtureSolid: ")):
        with pytest.raises(vv.InputError, match=f"^{label}an interface is"):
            solid(mesh, gradient_energy=1e-6, name=name)


def resting(**options: Any) -> tuple[vv.MixtureSolid, vv.System]:
    """A quarter of a round particle with misfit, without mass, that comes to rest."""
    body = solid(
        vv.RectangleMesh(size=(6, 6), counts=(8, 8)),
        free_energy=vv.DoubleWell(barrier=4.0),
        mobility=1.0,
        concentration=lambda X: 0.5 + 0.45 * np.tanh(3 - np.hypot(X[:, 0], X[:, 1])),
        eigenstrain=0.05,
        material=vv.SaintVenantKirchhoff(young=50.0, poisson=0.3),
        **options,
    )
    held = [vv.Prescribed(solid=body, nodes="x0", motion=(0, None, None))]
    held.append(vv.Prescribed(solid=body, nodes="y0", motion=(None, 0, None)))
    return body, vv.System([body, *held])


def test_steps_of_what_has_no_mass_grow_as_it_comes_to_rest() -> None:
    """As those of a scheme whose rates do not alternate; of positions they did for ever, and steps never grew."""
    steps = []
    for scheme in (vv.BDF2(), vv.EnergyMomentum()):
        rule = vv.Adaptive(tolerance=1e-3, max_step=5.0)
        result = vv.simulate(resting()[1], until=20.0, step=0.1, scheme=scheme, adaptive=rule)
        steps.append(len(result.times) - 1)
    assert steps[1] < 1.3 * steps[0]


def test_velocities_without_mass() -> None:
    """A wave grows as ``exp(R t)``, and so do displacements: their rates are R of them in the middle of each step."""
    k, eta, E, nu = 0.35, 0.06, 20.0, 0.3
    mesh = vv.RectangleMesh(size=(np.pi / k, 1.0), counts=(8, 1), cell="quad9")
    body = solid(mesh, eigenstrain=eta, concentration=lambda X: 0.5 + 1e-5 * np.cos(k * X[:, 0]))
    across = vv.Prescribed(solid=body, nodes="all", motion=(None, 0.0, None))
    held = [vv.Prescribed(solid=body, nodes=side, motion=(0.0, None, None)) for side in ("x0", "x1")]
    result = vv.simulate(vv.System([body, across, *held]), until=0.4, step=0.05)
    rate = -5 * k**2 * (-0.8 + 2 * eta**2 * E / (1 - nu) + 2 * k**2)
    u = np.array([body.displacements(x)[:, 0] for x in result.states])
    v = np.array([body.velocities(x, v)[:, 0] for x, v in zip(result.states, result.rates, strict=True)])[1:]
    np.testing.assert_allclose(v, rate * (u[1:] + u[:-1]) / 2, atol=0.01 * abs(rate * u).max())
