"""What sections and options of beams do beside quadratic energy: damping, energies of the user, rigid strains, heat."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]
ROD = {"radius": 0.1, "young": 1e4, "poisson": 0.25, "density": 2.0}
C = np.array([200.0, 180, 300, 5, 4, 3])
SOFT = vv.GivenSection(stiffness=C, mass=1.0, moments=(0.03, 0.02, 0.0))


def bar(count: int = 4, cell: str = "line2", length: float = 2.0, **options: Any) -> vv.Beam:
    mesh = vv.LineMesh(points=[(0, 0, 0), (length, 0, 0)], count=count, cell=cell)
    return vv.Beam(mesh=mesh, **{"section": SOFT} | options)


def clamped(beam: vv.Beam, *others: Any) -> vv.System:
    return vv.System([beam, vv.Clamped(solid=beam, nodes="start"), *others])


# --- damping ------------------------------------------------------------------------------------------------
def test_a_damped_bar_swings_out_with_the_ratio_of_its_retardation() -> None:
    """Along its axis: ratio omega tau / 2, so that the amplitude falls by exp(-pi omega tau) a period."""
    section = vv.TubeSection(**ROD, retardation=2e-4)
    speed = np.sqrt(1e4 / 2.0)
    omega = np.pi / 2 * speed / 2.0
    beam = bar(8, "line3", section=section, velocity=lambda X: 0.01 * np.sin(np.pi / 4 * X) * (1, 0, 0))
    period = 2 * np.pi / omega
    result = vv.simulate(clamped(beam), until=4 * period, step=period / 200)
    ends = np.array([beam.displacements(x)[-1, 0] for x in result.states])
    highest = [ends[200 * k : 200 * k + 200].max() for k in range(4)]
    ratios = np.array(highest[1:]) / np.array(highest[:-1])
    np.testing.assert_allclose(ratios, np.exp(-np.pi * omega * 2e-4), rtol=2e-3)


def damped(scheme: vv.Scheme) -> vv.Result:
    section = vv.GivenSection(stiffness=C, damping=0.1 * C, mass=1.0, moments=(0.03, 0.02, 0.0))
    beam = bar(section=section, velocity=lambda X: 0.3 * X[:, :1] * (0.2, 1, 0.5), angular_velocity=(1, 0, 0))
    return vv.simulate(vv.System([beam]), until=1.0, step=0.02, scheme=scheme)


@pytest.mark.parametrize(
    "scheme", [vv.EnergyMomentum(), vv.GeneralizedAlpha(rho=0.5), vv.BDF2(), vv.Midpoint()], ids=str
)
def test_damping_never_gives_energy(scheme: vv.Scheme) -> None:
    assert np.diff(damped(scheme).ledger["work_dissipated"]).max() <= 0


def test_damping_is_booked_exactly_and_leaves_momenta() -> None:
    result = damped(vv.EnergyMomentum())
    assert result.ledger["total"][-1] < 0.99 * result.ledger["total"][0]
    result.assert_conserved("momentum_y", "angular_x", "angular_z", tolerance=1e-10)
    assert abs(result.ledger["imbalance"]).max() < 1e-11 * result.ledger.energy_scale


def test_a_damped_rotation_loses_nothing() -> None:
    """Strains do not change as it turns rigidly, nor do their rates."""
    section = vv.GivenSection(stiffness=1e3 * C, damping=C, mass=1.0, moments=(0.03, 0.02, 0.0))
    spins = [(0.0, 0.0, 1e-3), (2.0, 0, 0)]
    for spin in spins:
        beam = bar(section=section, angular_velocity=spin)
        ledger = vv.simulate(vv.System([beam]), until=2.0, step=0.02).ledger
        assert abs(ledger["work_dissipated"][-1]) < 1e-6 * ledger["kinetic"][0]


# --- energies of the user -----------------------------------------------------------------------------------
def test_a_quadratic_energy_is_that_of_its_stiffness() -> None:
    ends = []
    for section in (SOFT, vv.UserSection(section=SOFT, energy=lambda e: 0.5 * (C @ (e * e)))):
        beam = bar(section=section)
        pull = vv.Force(on=beam.point((2, 0, 0)), force=(1.0, 2.0, 3.0), times="t")
        system = clamped(beam, pull)
        vv.quasi_static(system, until=1.0, step=0.25)
        ends.append((beam.positions(system.x), beam.resultants(system.x)))
    np.testing.assert_allclose(ends[1][0], ends[0][0], atol=1e-9)
    np.testing.assert_allclose(ends[1][1], ends[0][1], atol=1e-7)


def test_a_rope_that_stiffens() -> None:
    """N = EA e (1 + 100 e^2) pulled by a force, and the resultants that go with it; dynamics conserves energy."""

    def stiff(e: Array) -> Any:
        return 0.5 * (C @ (e * e)) + 0.5 * C[2] * 50.0 * e[2] ** 4

    section = vv.UserSection(section=SOFT, energy=stiff)
    beam = bar(section=section)
    system = clamped(beam, vv.Force(on=beam.point((2, 0, 0)), force=(20.0, 0, 0), times="t"))
    vv.quasi_static(system, until=1.0, step=0.25)
    (e,) = np.roots([100.0 * C[2], 0, C[2], -20.0])[np.isreal(np.roots([100.0 * C[2], 0, C[2], -20.0]))].real
    np.testing.assert_allclose(beam.strains(system.x)[..., 2], e, rtol=1e-9)
    np.testing.assert_allclose(beam.resultants(system.x)[..., 2], 20.0, rtol=1e-9)
    flying = bar(section=section, velocity=lambda X: X[:, :1] * (2.0, 1.0, 0))
    vv.simulate(vv.System([flying]), until=0.5, step=0.02).assert_conserved(
        "energy", "angular_z", tolerance=1e-9
    )


# --- rigid strains ------------------------------------------------------------------------------------------
def test_rigid_beams_have_the_forces_of_the_load_as_resultants() -> None:
    """Euler & Bernoulli's deflection P L^3 / 3 EI, and shear and normal forces by the multipliers."""
    section = vv.TubeSection(**ROD)
    for cell, rtol in (("line2", 5e-3), ("line3", 1e-5)):
        beam = bar(8, cell, section=section, rigid=("shear", "stretch"), first=(0, 1, 0))
        system = clamped(beam, vv.Force(on=beam.point((2, 0, 0)), force=(2e-6, 1e-6, 3e-6)))
        vv.quasi_static(system, until=1.0, step=1.0)
        deflection = 8 / 3 / section.stiffness_matrix()[3, 3]
        np.testing.assert_allclose(
            beam.displacements(system.x)[-1, 1:], deflection * np.array([1e-6, 3e-6]), rtol=rtol
        )
        found = beam.resultants(system.x)[..., :3]
        np.testing.assert_allclose(found, np.broadcast_to((1e-6, 3e-6, 2e-6), found.shape), rtol=1e-4)
        assert abs(beam.strains(system.x)[..., :3]).max() < 1e-14


@pytest.mark.parametrize("rigid", [("shear",), ("stretch",), ("shear", "stretch")])
def test_rigid_strains_are_the_limit_of_stiff_ones(rigid: tuple[str, ...]) -> None:
    """In large bending and twisting, at second order in one by the stiffness."""
    ends = []
    for factor in (0.0, 1e4, 1e6):
        scale = np.ones(6)
        scale[:2] = factor if "shear" in rigid and factor else 1.0
        scale[2] = factor if "stretch" in rigid and factor else 1.0
        section = vv.GivenSection(stiffness=C * scale, mass=1.0, moments=(0.03, 0.02, 0.0))
        beam = bar(section=section, rigid=() if factor else rigid)
        system = clamped(beam, vv.Force(on=beam.point((2, 0, 0)), force=(1.0, 2.0, 3.0), times="t"))
        vv.quasi_static(system, until=1.0, step=0.25)
        ends.append(beam.positions(system.x)[-1])
    distances = [float(np.linalg.norm(end - ends[0])) for end in ends[1:]]
    assert distances[1] < 1e-6
    assert distances[0] / distances[1] == pytest.approx(100, rel=0.1)


# --- heat ---------------------------------------------------------------------------------------------------
def test_a_heated_beam_curls_into_a_circle_without_force() -> None:
    """Of the radius that its own curvature gives, at the order of the cells."""
    error = []
    for count in (2, 4, 8):
        beam = bar(count, "line3", first=(0, 1, 0))
        heat = vv.ThermalStrain(beam=beam, extension=0.1, curvature=(1.0, 0.0), times="t")
        system = clamped(beam, heat)
        vv.quasi_static(system, until=1.0, step=0.125)
        assert abs(beam.resultants(system.x)).max() < 1e-8
        end = beam.positions(system.x)[-1]
        # about d1 = e2: from e1 towards e3 x ... the radius is 1.1 / 1.0, the angle 2
        expected = 1.1 * np.array([np.sin(2.0), 0.0, -(1 - np.cos(2.0))])
        error.append(float(np.linalg.norm(end - expected)))
    assert np.log2(error[1] / error[2]) > 3.7
    assert error[2] < 1e-4


def test_a_beam_heated_between_walls_presses_them() -> None:
    """By EA e, and nothing moves."""
    beam = bar()
    heat = vv.ThermalStrain(beam=beam, extension=0.01, times="t")
    system = clamped(beam, vv.Clamped(solid=beam, nodes="end"), heat)
    vv.quasi_static(system, until=1.0, step=1.0)
    np.testing.assert_allclose(beam.resultants(system.x)[..., 2], -3.0, rtol=1e-9)
    assert abs(beam.displacements(system.x)).max() < 1e-12
    np.testing.assert_allclose(vv.SupportForce(solid=beam, nodes="end")(system), (-3.0, 0, 0), rtol=1e-9)


def test_heat_in_motion_is_booked() -> None:
    """What the forces of heat do is all that energy changes by; momenta stay."""
    beam = bar(velocity=(0.1, 0.2, 0.3))
    heat = vv.ThermalStrain(beam=beam, extension=0.05, curvature=(0.3, 0.1), times="sin(5*t)")
    result = vv.simulate(vv.System([beam, heat]), until=2.0, step=0.01)
    assert np.ptp(result.ledger["total"]) > 0.1
    assert abs(result.ledger["imbalance"]).max() < 1e-11 * result.ledger.energy_scale
    result.assert_conserved("momentum_x", "angular_z", tolerance=1e-10)


# --- refused ------------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: vv.GivenSection(stiffness=C, damping=-C), "gives energy"),
        (lambda: vv.GivenSection(stiffness=C, damping=np.eye(5)), "damping"),
        (lambda: vv.TubeSection(**ROD, retardation=-1.0), "retardation"),
        (lambda: vv.UserSection(section=SOFT, energy=lambda e: e[0]), "not positive"),
        (
            lambda: vv.UserSection(section=SOFT, energy=lambda e: 0.5 * (C @ (e * e)) + e[2]),
            "without strains",
        ),
        (lambda: vv.UserSection(section=SOFT, energy=lambda e: e), "shape"),
        (lambda: bar(rigid=("twist",)), "rigid"),
        (lambda: vv.ThermalStrain(beam=bar()), "neither extension nor curvature"),
        (lambda: vv.ThermalStrain(beam=bar(), extension=-1.5), "no length"),
        (lambda: vv.ThermalStrain(beam=bar(rigid=("stretch",)), extension=0.1), "cannot stretch"),
        (
            lambda: vv.ThermalStrain(
                beam=bar(section=vv.UserSection(section=SOFT, energy=lambda e: 0.5 * (C @ (e * e)))),
                extension=0.1,
            ),
            "subtract the strains",
        ),
    ],
)
def test_refused(make: Any, message: str) -> None:
    with pytest.raises(vv.InputError, match=message):
        make()
