"""Physics at points against closed forms, laws of thermodynamics, and orders of convergence."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from instances import points
from numpy.typing import NDArray

import visviva as vv
from visviva.base.errors import InputError
from visviva.model.callback import Function
from visviva.model.field import Field
from visviva.model.history import Evolving
from visviva.model.model import Model
from visviva.model.points import Group, PhysicsKind, add_points

Array = NDArray[np.float64]


def run(block: object, until: float, step: float, **options: object) -> tuple[vv.System, vv.Result]:
    """To round-off."""
    system = vv.System([block], vv.Newton(tolerance=1e-14))
    return system, vv.simulate(system, until=until, step=step, **options)


def at_nodes(system: vv.System, field: Field) -> Array:
    return np.array(system.x[field.start : field.start + field.size])


class Held(points.Block):
    """A regular bar whose nodes stay where the gradient F puts them."""

    def straighten(self, F: object = None) -> None:
        mesh = vv.BoxMesh(size=(1.0, 0.3, 0.2), counts=self.counts).build()
        self.X = np.array(mesh.points)
        self.F = np.eye(3) if F is None else np.asarray(F)

    def hold(self, model: Model) -> None:
        model.hold(self.motion, np.arange(self.motion.size), (self.X @ self.F.T).ravel())


class HeatBar(points.Thermoelastic, Held):
    def declare(self, model: Model) -> None:
        self.straighten()
        points.Thermoelastic.declare(self, model)
        self.hold(model)
        wave = 1e-3 * np.cos(np.pi * self.X[:, 0])
        self.temperature.values[:] = self.reference * (1 + wave)
        self.entropy.values[:] = self.capacity * np.log1p(wave)
        model.refresh(self.temperature)
        model.refresh(self.entropy)


def test_heat_spreads_as_fourier_says() -> None:
    """A cosine of temperature in a held bar decays with k pi^2 / (c L^2)."""
    bar = HeatBar(counts=(24, 1, 1), speed=0.0)
    system, _ = run(bar, 0.1, 0.002)
    rate = bar.conductivity * np.pi**2 / bar.capacity
    s = at_nodes(system, bar.entropy)
    wave = np.expm1(s / bar.capacity)
    exact = 1e-3 * np.exp(-rate * 0.1) * np.cos(np.pi * bar.X[:, 0])
    assert np.abs(wave - exact).max() <= 0.01 * np.abs(exact).max()


@pytest.mark.parametrize("h", [0.01, 0.05, 0.2])
def test_entropy_never_falls(h: float) -> None:
    """And energy is kept to round-off, with temperatures that differ from place to place, in distorted elements."""
    block = points.Thermoelastic(counts=(2, 2, 2), warm=0.5, speed=0.1)
    sums: list[float] = []
    system, result = run(
        block,
        20 * h,
        h,
        observe=lambda s: sums.append(block.integral(at_nodes(s, block.entropy))),
    )
    total = result.ledger["total"]
    temperature = at_nodes(system, block.temperature)
    assert np.abs(total - total[0]).max() <= 1e-12 * result.ledger.energy_scale
    assert np.ptp(temperature) > 1e-4 * temperature.mean()
    assert all(later > before for before, later in pairwise(sums))


class Stretched(points.Viscoelastic, Held):
    def declare(self, model: Model) -> None:
        self.straighten(np.diag([1.002, 1.0, 1.0]))
        points.Viscoelastic.declare(self, model)
        self.hold(model)


def test_maxwell_branch_relaxes() -> None:
    """Under a small held stretch the energy falls as 1 - exp(-2 t / tau), tau = 2 eta / mu_v, step by step."""
    bar = Stretched(counts=(2, 1, 1), speed=0.0)
    _, result = run(bar, 0.5, 0.005)
    stored = result.ledger["potential_stored"]
    strain, volume, mu, tau = 0.002, 0.06, 8.0, 2 * bar.viscosity / 8.0
    exact = mu * strain**2 * volume * (1 - np.exp(-2 * result.ledger["time"] / tau))
    assert stored[0] - stored == pytest.approx(exact, rel=0.01, abs=1e-3 * exact[-1])
    assert np.all(np.diff(stored) < 0)


def test_internal_variables_dissipate_at_every_step() -> None:
    """Even with steps that are long beside the time of relaxation."""
    _, result = run(points.Viscoelastic(viscosity=0.05, speed=0.5), 1.0, 0.05)
    lost = -result.ledger["work_dissipated"]
    assert np.all(np.diff(lost) > 0)
    assert result.conservation()["energy"] <= 1e-12


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.Midpoint(), vv.GeneralizedAlpha(0.8), vv.BDF2()])
@pytest.mark.parametrize("kind", [points.Viscoelastic, points.Thermoelastic, points.Separating])
def test_order(kind: type[points.Block], scheme: vv.Scheme) -> None:
    """Second in time with histories and several fields; first of internal variables where steps have no middle."""

    def state(n: int) -> Array:
        block = kind(counts=(1, 1, 1), speed=0.1)
        until = 0.05 if kind is points.Thermoelastic else 0.4
        system, _ = run(block, until, until / n, scheme=scheme)
        field = block.concentration if kind is points.Separating else block.motion
        return at_nodes(system, field)

    # A first step of contents that goes to its end takes the order up to 2 only with many steps.
    many = 8 if kind is points.Separating and isinstance(scheme, vv.BDF2 | vv.GeneralizedAlpha) else 1
    fine = state(many * 256)
    coarse, finer = (np.abs(state(many * n) - fine).max() for n in (16, 32))
    least = 0.85 if kind is points.Viscoelastic and isinstance(scheme, vv.BDF2 | vv.GeneralizedAlpha) else 1.8
    assert np.log2(coarse / finer) >= least


def test_history_of_the_user() -> None:
    """A material of Python with internal variables moves like the core's, but for their other rule in time."""

    def end(kind: type[points.Block], n: int) -> tuple[Array, float]:
        block = kind(counts=(1, 1, 1))
        system, result = run(block, 0.4, 0.4 / n)
        assert np.all(np.diff(result.ledger["work_dissipated"]) <= 0)
        assert result.conservation()["energy"] <= 1e-10
        return at_nodes(system, block.motion), result.ledger["total"][-1]

    apart = []
    for n in (40, 80):
        (x, energy), (y, other) = end(points.Viscoelastic, n), end(points.UserViscoelastic, n)
        apart.append(max(np.abs(x - y).max(), abs(energy - other)))
    assert apart[1] <= 1e-4
    assert np.log2(apart[0] / apart[1]) == pytest.approx(2.0, abs=0.3)


@pytest.mark.parametrize("kind", [points.Viscoelastic, points.UserViscoelastic])
def test_memory_decides_every_bit_of_histories(kind: type[points.Block]) -> None:
    """A system that is told another's state and memory takes the same next steps to the last bit."""
    one, other = (vv.System([kind()]) for _ in range(2))
    for _ in vv.march(one, until=0.2, step=0.02):
        pass
    next(vv.march(other, until=0.1, step=0.02))
    for name in "xvaw":
        getattr(other.core, name)[:] = getattr(one.core, name)
    other.time = one.time
    other.core.restore(one.core.memory())
    for _ in range(3):
        for system in (one, other):
            system.step(0.02)
        assert np.array_equal(one.x, other.x)
    histories = [system.components[0].term.history() for system in (one, other)]
    assert np.abs(histories[0]).max() > 1e-4
    assert np.array_equal(*histories)


class Bar(points.Separating):
    def declare(self, model: Model) -> None:
        mesh = vv.BoxMesh(size=(4.0, 0.1, 0.1), counts=self.counts).build()
        self.X = np.array(mesh.points)
        points.Separating.declare(self, model)
        self.concentration.values[:] = np.where(self.X[:, 0] < 2.0, 0.02, 0.98)
        model.refresh(self.concentration)


def test_kink_between_phases() -> None:
    """At rest it has the energy sqrt(2 barrier kappa) / 6 per area, and logistic shape.

    By a scheme that damps: conservative ones let stiff waves swing on when steps grow long.
    """
    bar = Bar(counts=(160, 1, 1), gradient=0.02)
    steps = iter(np.geomspace(1e-4, 5.0, 60))
    system = vv.System([bar], vv.Newton(tolerance=1e-12))
    for h in steps:
        result = vv.simulate(system, until=system.time + h, step=h, scheme=vv.BackwardEuler())
    energy = result.ledger["potential_stored"][-1] / 0.01
    c, x = at_nodes(system, bar.concentration), bar.X[:, 0]
    width = np.sqrt(bar.gradient / (2 * bar.barrier))
    middle = np.interp(0.5, np.sort(c), x[np.argsort(c)])
    exact = 1 / (1 + np.exp(-(x - middle) / width))
    assert energy == pytest.approx(np.sqrt(2 * bar.barrier * bar.gradient) / 6, rel=0.01)
    assert np.abs(c - exact).max() <= 0.02


@pytest.mark.parametrize("h", [1e-3, 0.1, 10.0])
def test_separation_loses_energy_and_no_mass(h: float) -> None:
    block = points.Separating(counts=(4, 2, 2), gradient=0.1)
    masses: list[float] = []
    _, result = run(
        block, 15 * h, h, observe=lambda s: masses.append(block.integral(at_nodes(s, block.concentration)))
    )
    assert np.all(np.diff(result.ledger["total"]) <= 1e-14 * result.ledger["total"][0])
    assert np.ptp(masses) <= 1e-13 * abs(masses[0])


class Torn(points.Damaged, Held):
    """Stretched once, then let go."""

    def declare(self, model: Model) -> None:
        self.straighten()
        points.Damaged.declare(self, model)
        model.prescribe(
            self,
            self.motion,
            np.arange(self.motion.size),
            lambda t: self.placed(t).ravel(),
            lambda t, step: np.zeros(self.motion.size),
        )

    def placed(self, t: float) -> Array:
        return self.X * (1 + 0.1 * min(t, 2 - t), 1, 1)


def test_damage_under_a_stretch_and_after_it() -> None:
    """Uniform: d = 2 W / (2 W + toughness / length); none of it heals but for what the penalty lets pass."""
    torn = Torn(counts=(2, 1, 1), speed=0.0)
    system = vv.System([torn])
    most = 0.0
    for k in range(1, 21):
        vv.quasi_static(system, until=0.1 * k, step=0.1)
        d = at_nodes(system, torn.damage)
        if k == 10:
            C = 1.1**2 - 1
            log_j = np.log(1.1)
            W = 0.5 * 10.0 * (C - 2 * log_j) + 0.5 * 20.0 * log_j**2
            assert d == pytest.approx(2 * W / (2 * W + 0.5 / 0.3), rel=1e-6)
            most = d.min()
    assert most > 0.05
    assert d.min() >= 0.99 * most


def test_cantilever_beam_under_a_dead_force() -> None:
    """Reissner's beam of length 2, height .5 and width .1: computed from the exact rod."""
    exact = np.array([-0.15097114424, 0.71056859785])
    E, nu, h, b = 2.07e3, 0.3, 0.5, 0.1
    G = 10 * (1 + nu) / (12 + 11 * nu) * E / (2 * (1 + nu))
    A, I = b * h, b * h**3 / 12
    errors = []
    for n in (8, 16):
        beam = points.DirectorBeam(
            n=n,
            length=2.0,
            stiffness=(G * A, G * A, E * A, E * I, E * I, G * I),
            clamped=True,
            spin=(0, 0, 0),
            force=(0.0, 5.0 * h**3, 0.0),
            line_density=0.0,
            inertia=(0.0, 0.0),
        )
        system = vv.System([beam])
        vv.quasi_static(system, until=1.0, step=0.5)
        tip = at_nodes(system, beam.nodes).reshape(-1, 4, 3)[-1, 0]
        errors.append(np.abs(tip[:2] - (2.0, 0.0) - exact).max())
    assert errors[1] <= 3e-3
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)


class Plate(points.DirectorShell):
    def declare(self, model: Model) -> None:
        points.DirectorShell.declare(self, model)
        held = np.flatnonzero(self.X[:, 0] == 0)
        model.hold(self.nodes, (6 * held[:, None] + np.arange(6)).ravel())

    def contribute(self, model: Model) -> None:
        points.DirectorShell.contribute(self, model)
        ends = np.flatnonzero(np.isclose(self.X[:, 0], self.size[0]))
        share = np.where(np.isin(ends, (ends.min(), ends.max())), 0.5, 1.0) / (len(ends) - 1)
        force = np.zeros((len(ends), 3))
        force[:, 2] = 1e-5 * share
        model.dead_forces(self, "tip", self.nodes.start + 6 * ends, force)


@pytest.mark.parametrize("thickness", [0.1, 0.001])
def test_cantilever_plate_does_not_lock(thickness: float) -> None:
    """A strip without Poisson's ratio bends as a beam does, F L^3 / 3 EI + F L / kGA, thick and thin."""
    plate = Plate(
        size=(1.0, 0.2),
        counts=(16, 2),
        thickness=thickness,
        poisson=0.0,
        spin=0.0,
        density=0.0,
        young=1e3 * (0.1 / thickness) ** 3,
    )
    system = vv.System([plate])
    vv.quasi_static(system, until=1.0, step=1.0)
    tip = at_nodes(system, plate.nodes).reshape(-1, 2, 3)[:, 0, 2].max()
    E, I, A = plate.young, 0.2 * thickness**3 / 12, 0.2 * thickness
    exact = 1e-5 / (3 * E * I) + 1e-5 / (5 / 6 * A * E / 2)
    assert tip == pytest.approx(exact, rel=2e-3)


def spoilt(**changes: Any) -> Any:
    """A separating block that hands over something else."""

    class Spoilt(points.Separating):
        def contribute(self, model: Model) -> None:
            groups = [
                Group(f.start + self.cells, np.ones((8, 8, 4))) for f in (self.concentration, self.potential)
            ]
            given = {"volume": np.ones((len(self.cells), 8)), "parameters": [4.0, 0.1, 1.0], **changes}
            if "group" in given:
                groups[1] = replace(groups[1], **given.pop("group"))
            add_points(model, self, PhysicsKind.CAHN_HILLIARD, groups, **given)

    return Spoilt()


@pytest.mark.parametrize(
    ("changes", "named"),
    [
        ({"parameters": [4.0, 0.1]}, "parameters"),
        ({"parameters": [4.0, np.nan, 1.0]}, "parameters"),
        ({"volume": np.ones((3, 8))}, "group 0"),
        ({"volume": np.ones(8)}, "volume"),
        ({"volume": -np.ones((2, 8))}, "volume"),
        ({"group": {"unknowns": np.full((2, 8), 10000)}}, "beyond"),
        ({"reference": np.zeros(4)}, r"reference needs finite strains \(2, 8, 8\)"),
        ({"reference": np.zeros((8, 8))}, "reference"),
        ({"reference": np.full((2, 8, 8), np.nan)}, "reference"),
        ({"group": {"unknowns": np.full((2, 8), 0.5)}}, "whole numbers"),
        ({"group": {"weights": np.ones((8, 7, 4))}}, "weights"),
        ({"group": {"weights": np.full((8, 8, 4), np.inf)}}, "finite"),
        ({"group": {"weights": np.ones((8, 8, 3))}}, "columns"),
        ({"group": {"mass": np.ones((2, 5))}}, "mass"),
        ({"energy": lambda e: e[0]}, "Function"),
        ({"energy": Function(lambda e: e[0], 3, 1, "three")}, "3 strains"),
        ({"energy": Evolving(lambda e, h: e[0], lambda *a: a[2], 4, 1, "one")}, "internal variables"),
    ],
)
def test_what_does_not_fit_is_refused(changes: dict[str, Any], named: str) -> None:
    with pytest.raises(InputError, match=named):
        vv.System([spoilt(**changes)])


LAME, YIELD = (20.0, 10.0), 0.2
WEIGHTS = np.array([1.0, 1, 1, 2, 2, 2])[:, None]


def plastic_energy(c: Array, p: Array) -> Array:
    """Of small elastic strains E - p."""
    E = 0.5 * c - p
    return 0.5 * LAME[0] * E[:3].sum(axis=0) ** 2 + LAME[1] * (WEIGHTS * E * E).sum(axis=0)


def plastic_update(e0: Array, e1: Array, p0: Array, h: float) -> Array:
    """Radial return of von Mises' plasticity, at no rate."""
    assert h > 0
    s = 0.5 * e1 - p0
    s[:3] -= s[:3].mean(axis=0)
    s = 2 * LAME[1] * s
    size = np.sqrt((WEIGHTS * s * s).sum(axis=0))
    beyond = np.maximum(size - np.sqrt(2 / 3) * YIELD, 0)
    return np.asarray(p0 + beyond / (2 * LAME[1]) / np.where(size > 0, size, 1) * s)


class Plastic(Held):
    """Stretched to a Green strain of 0.1 and back."""

    def declare(self, model: Model) -> None:
        self.straighten()
        self.motion = self.move(model)
        still = np.zeros(self.motion.size)
        model.prescribe(
            self, self.motion, np.arange(len(still)), lambda t: self.placed(t).ravel(), lambda t, h: still
        )

    def placed(self, t: float) -> Array:
        return self.X * (np.sqrt(1 + 0.2 * min(t, 2 - t)), 1, 1)

    def contribute(self, model: Model) -> None:
        law = Evolving(plastic_energy, plastic_update, 6, 6, "plastic")
        fields = [(self.motion, "g")]
        self.build(model, PhysicsKind.VISCOELASTIC, fields, [0.0, 0, 0, 1], energy=law, start=[0.0] * 6)


@pytest.mark.parametrize("scheme", [vv.Static(), vv.BDF2(), vv.EnergyMomentum()])
def test_plastic_work(scheme: vv.Scheme) -> None:
    """There and back: 2/3 yield stress times plastic strain, booked whole under every scheme."""
    system = vv.System([Plastic(counts=(2, 1, 1), speed=0.0)])
    result = vv.simulate(system, until=2.0, step=0.01, scheme=scheme)
    exact = 2 / 3 * YIELD * (0.2 - 3 * YIELD / (2 * LAME[1])) * 0.06
    assert -result.ledger["work_dissipated"][-1] == pytest.approx(exact, rel=0.01)


def test_books_of_a_second_run_start_where_the_first_ended() -> None:
    """Rate-independent histories lose nothing where no time passes."""
    system = vv.System([Plastic(counts=(2, 1, 1), speed=0.0)])
    first, second = (vv.simulate(system, until=t, step=0.05, scheme=vv.Midpoint()) for t in (0.8, 1.5))
    assert second.ledger["total"][0] == pytest.approx(first.ledger["total"][-1], rel=1e-12)
    assert second.ledger["work_dissipated"][0] == 0.0


@pytest.mark.parametrize(("behind", "fits"), [(0, True), (1, False), (2, False)])
def test_nodes_end_with_the_model(behind: int, fits: bool) -> None:
    """The first unknown of a node of three stands three before the end of the model, or earlier."""

    class Last(points.Separating):
        def contribute(self, model: Model) -> None:
            last = np.full((1, 8), model.n_unknowns - 3 + behind)
            add_points(
                model,
                self,
                PhysicsKind.VISCOELASTIC,
                [Group(last, np.ones((1, 8, 3)))],
                np.ones((1, 1)),
                [1.0] * 4,
            )

    if fits:
        vv.System([Last()])
        return
    with pytest.raises(InputError, match="beyond"):
        vv.System([Last()])
