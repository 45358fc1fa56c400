"""Solids that dissipation heats: both laws, the heat of closed forms, and times that shift with temperature."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from catalogue.viscous import SHIFTED

import visviva as vv
from verification.test_thermoelastic import HEAT, RUBBER, distorted

LONG, BRANCH, ETA = 1.0, 2.0, 3.0  # a Zener solid: shear moduli beside and in the branch, its viscosity
TIME = ETA / BRANCH
JUMP = 1e-9  # in which what happens at once is done


@pytest.mark.parametrize("formulation", ["displacement", "enhanced"])
@pytest.mark.parametrize("h", [0.02, 0.1])
def test_both_laws_hold_to_rounding(formulation: Any, h: float) -> None:
    """Isolated, hot and cold, distorted, relaxing: energy and momenta are kept and entropy never falls."""
    body = vv.ThermoviscoelasticSolid(
        mesh=distorted("hex8"),
        material=RUBBER,
        density=1.0,
        heat=HEAT,
        branches=SHIFTED,
        formulation=formulation,
        temperature=lambda X: 20 + 8 * X[:, 0] ** 2,
        angular_velocity=(1, 2, 3),
        velocity=lambda X: X * X,
    )
    system, entropy = vv.System([body], vv.Newton(tolerance=1e-13)), []
    result = vv.simulate(
        system, until=12 * h, step=h, observe=lambda s: entropy.append(body.total_entropy(s.x))
    )
    kept = result.conservation()
    assert kept["energy"] < 3e-14
    assert max(kept[f"angular_{k}"] for k in "xyz") < 1e-13
    assert np.min(np.diff(entropy)) > 0


def bar(motion: str, capacity: float, **options: Any) -> tuple[vv.System, vv.ThermoviscoelasticSolid]:
    """A cube that is pulled along x without inertia, free at its sides and without exchange of heat."""
    given: dict[str, Any] = {"shift": None, "temperature": 300.0, "poisson": 0.4999999, **options}
    body = vv.ThermoviscoelasticSolid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)),
        material=vv.Hencky(shear=LONG, poisson=given["poisson"]),
        heat=vv.Heat(conductivity=1e-9, capacity=capacity, reference=300.0),
        branches=[vv.MaxwellBranch(time=TIME, share=BRANCH / LONG, shift=given["shift"])],
        temperature=given["temperature"],
    )
    sides = [vv.SymmetryPlane(solid=body, nodes=f"{'xyz'[k]}0", normal=np.eye(3)[k]) for k in range(3)]
    end = vv.Prescribed(solid=body, nodes="x1", motion=(motion, None, None))
    return vv.System([body, *sides, end]), body


def jump(system: vv.System) -> None:
    """What is done at once, so fast that nothing relaxes or conducts; at rest afterwards."""
    vv.simulate(system, until=JUMP, step=JUMP / 8, scheme=vv.BackwardEuler())
    system.core.v[:] = 0.0
    system.invalidate()


AT_ONCE = f"(1-cos(pi*min(t/{JUMP!r},1)))/2"


def test_finite_relaxation_heats_by_what_the_branch_held() -> None:
    """1.5 mu_v ln^2 2 = 1.441359 of heat, and 1.441359e-3 K of c = 1000; the ends are of second order in the step."""
    system, body = bar(AT_ONCE, 1000.0)
    jump(system)
    held, warm = body.total_entropy(system.x), body.temperatures(system.x)
    result = vv.simulate(system, until=20.0, step=0.1)
    rise = body.temperatures(system.x) - warm
    assert rise == pytest.approx(1.441359041755e-3, rel=2e-6)
    assert result.ledger.swing("imbalance") < 1e-9
    assert (body.total_entropy(system.x) - held) * 300 == pytest.approx(1.441359041755, rel=1e-5)


def test_cycles_heat_by_the_loss_modulus() -> None:
    """pi E'' per cycle, of a Zener solid at its frequency: E'' = 0.923076923 for moduli of a third."""
    amplitude, omega, cycles, n = 1e-3, 1.0, 3, 100
    system, body = bar(f"{amplitude!r}*sin({omega!r}*t)", 1.0)
    period, warmth = 2 * np.pi / omega, []
    vv.simulate(
        system,
        until=cycles * period,
        step=period / n,
        observe=lambda s: warmth.append(float(body.temperatures(s.x).mean())),
    )
    loss = 3 * BRANCH * (omega * TIME) / (1 + (omega * TIME) ** 2)
    assert loss == pytest.approx(3 * 0.923076923076923, rel=1e-12)
    found = warmth[cycles * n - 1] - warmth[(cycles - 1) * n - 1]
    assert found == pytest.approx(np.pi * loss * amplitude**2, rel=3e-3)


@pytest.mark.parametrize("scheme", [vv.BDF2(), vv.GeneralizedAlpha()])
def test_heat_is_of_second_order_where_forces_balance_at_ends(scheme: vv.Scheme) -> None:
    """Of logarithmic strain a sin(w t), the integral of s^2 / (3 eta) with s' + s / tau = 3 mu_v e' in the branch."""
    amplitude, omega, end = 1e-3, 1.0, 4.0
    z = 3 * BRANCH * amplitude * 1j * omega / (1j * omega + 1 / TIME)  # s = Re(z (e^(i w t) - e^(-t / tau)))
    t = np.linspace(0, end, 4001)
    stress = (z * np.exp(1j * omega * t) - z * np.exp(-t / TIME)).imag
    exact = float(np.trapezoid(stress**2, t)) / (3 * ETA)

    def error(n: int) -> float:
        system, body = bar(f"exp({amplitude!r}*sin({omega!r}*t))-1", 1.0)
        vv.simulate(system, until=end, step=end / n, scheme=scheme)
        return float(body.temperatures(system.x).mean()) - 300.0 - exact

    errors = np.array([error(n) for n in (20, 40, 80)])
    assert np.all(errors[:-1] / errors[1:] > 3.9)
    assert abs(errors[-1]) < 3e-4 * exact


SHIFTS = [
    (vv.WLF(reference=300.0, c1=5.0, c2=80.0), 10 ** (-5 * 20 / 100)),
    (vv.Arrhenius(energy=60e3, reference=300.0), np.exp(60e3 / 8.31446261815324 * (1 / 320 - 1 / 300))),
]


@pytest.mark.parametrize(("shift", "factor"), SHIFTS)
def test_times_shift_with_the_temperature(shift: Any, factor: float) -> None:
    """At 320 K the branch relaxes as at 300 K with times a(320)."""
    rates = []
    for scale, options in ((factor, {"shift": shift, "temperature": 320.0}), (1.0, {})):
        system, body = bar(f"0.01*{AT_ONCE}", 1e3, poisson=0.3, **options)
        jump(system)
        grip, found = vv.SupportForce(solid=body, nodes="x1"), []
        until = 8 * TIME * scale
        vv.simulate(
            system,
            until=until,
            step=until / 60,
            observe=lambda s, grip=grip, found=found: found.append((s.time, grip(s)[0])),
        )
        t, force = np.array(found).T
        early = (t > 0.2 * TIME * scale) & (t < 2 * TIME * scale)
        rates.append(-np.polyfit(t[early], np.log(force[early] - force[-1]), 1)[0])
    assert rates[1] / rates[0] == pytest.approx(factor, rel=1e-4)


def test_bad_input() -> None:
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1))
    with pytest.raises(vv.InputError, match="branches is empty"):
        vv.ThermoviscoelasticSolid(mesh=mesh, material=RUBBER, heat=HEAT, branches=[])
    shifted = vv.prony((0.5,), (1.0,), shift=vv.WLF(reference=300.0))
    with pytest.raises(vv.InputError, match="no temperature by which"):
        vv.ViscoelasticSolid(mesh=mesh, material=RUBBER, branches=shifted)
    with pytest.raises(vv.InputError, match="c2 = -5 is not positive"):
        vv.WLF(reference=300.0, c2=-5.0)
    with pytest.raises(vv.InputError, match="energy = 0 is not positive"):
        vv.Arrhenius(reference=300.0, energy=0.0)
    for bad in ({"time": -1.0}, {"time": 1.0, "share": 0.0}):
        with pytest.raises(vv.InputError, match="is not positive"):
            vv.MaxwellBranch(**bad)
    with pytest.raises(vv.InputError, match="must all be positive"):
        vv.prony((0.5, -0.1), (1.0, 2.0))
