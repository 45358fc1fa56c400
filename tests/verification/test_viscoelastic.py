"""Maxwell branches: relaxation, creep and harmonic moduli in closed form, and the balance of energy."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv

LONG, BRANCH, ETA = (
    1.0,
    2.0,
    3.0,
)  # a Zener solid: moduli of the spring beside and in the branch, its viscosity
TIME = ETA / BRANCH
JUMP = 1e-9  # in which what happens at once is done


def bar(material: vv.Material, *loads: Any, **options: Any) -> tuple[vv.System, vv.ViscoelasticSolid]:
    """A cube in one direction, its sides free, with what pulls at x = 1."""
    body = vv.ViscoelasticSolid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)),
        material=material,
        formulation="mixed",
        branches=[vv.MaxwellBranch(time=TIME, share=BRANCH / LONG, **options)],
    )
    axes = {"x0": (1, 0, 0), "y0": (0, 1, 0), "z0": (0, 0, 1)}
    sides = [vv.SymmetryPlane(solid=body, nodes=n, normal=a) for n, a in axes.items()]
    return vv.System([body, *sides, *(load(body) for load in loads)]), body


def pulled(motion: str) -> Any:
    return lambda body: vv.Prescribed(solid=body, nodes="x1", motion=(motion, None, None), name="grip")


def stretched(material: vv.Material, stretch: float, end: float, h: float, **options: Any) -> vv.Result:
    """Stretched at once, held while it relaxes."""
    at_once = f"{stretch - 1!r}*(1-cos(pi*min(t/{JUMP!r},1)))/2"
    system, _ = bar(material, pulled(at_once), **options)
    vv.quasi_static(system, until=JUMP, step=JUMP / 4)
    return vv.simulate(system, until=end, step=h)


def test_large_stretches_relax_as_logarithms_do() -> None:
    """Hencky's energy: exponential in time, at any stretch; all of the branch's energy is dissipated, 1.441359."""
    material = vv.Hencky(shear=LONG, poisson=0.4999999)
    found = []
    for h in (0.2, 0.1):
        result = stretched(material, 2.0, 15.0, h)
        t, stored = result.ledger["time"], result.ledger["potential_stored"]
        exact = 1.5 * BRANCH * np.log(2) ** 2 * np.exp(-2 * t / TIME)
        found.append(np.abs(stored - exact).max())
        assert result.ledger["work_dissipated"][-1] == pytest.approx(-1.441359041755, rel=1e-6)
        assert np.abs(result.ledger["imbalance"]).max() < 1e-13
    assert found[0] < 0.01
    assert 3.7 < found[0] / found[1] < 4.3


def test_the_force_on_the_grip_falls_by_the_table() -> None:
    """3 (mu + mu_v exp(-t / tau)) ln 2 at t = 0.5, 1, 2, 5."""
    table = {0.5: 5.0594114879227, 1.0: 4.214683312731742, 2.0: 3.1757112202113547, 5.0: 2.227805509127609}
    material, h, found = vv.Hencky(shear=LONG, poisson=0.4999999), 0.02, {}
    at_once = f"1-0.5*(1+cos(pi*min(t/{JUMP!r},1)))"
    system, body = bar(material, pulled(at_once))
    vv.quasi_static(system, until=JUMP, step=JUMP / 4)
    grip = vv.SupportForce(solid=body, nodes="x1")

    def watch(s: vv.System) -> None:  # where the table is read
        if any(abs(s.time - t) < 1.5 * h for t in table):
            found[s.time] = grip(s)[0] * 2.0

    vv.simulate(system, until=5.02, step=h, observe=watch)
    times = np.array(sorted(found))
    stress = np.array([found[t] for t in times])
    for t, exact in table.items():
        assert np.interp(t, times, stress) == pytest.approx(exact, rel=1e-4)


RUBBER = vv.NeoHooke(young=LONG, poisson=0.4999999)  # of Young's modulus LONG, the branch of BRANCH
TINY = 1e-6


def test_it_creeps_as_a_zener_solid_does() -> None:
    """Compliance 1/3, 0.4034, 0.4662, 0.5725, 0.7805 at t = 0, 0.5, 1, 2, 5 under a stress applied at once."""
    table = {0.5: 0.403440455457, 1.0: 0.466175064722, 2.0: 0.572546407713, 5.0: 0.780538008128}
    at_once = f"{TINY!r}*(1-cos(pi*min(t/{JUMP!r},1)))/2"
    system, body = bar(RUBBER, lambda b: vv.Traction(solid=b, faces="x1", traction=(1, 0, 0), times=at_once))
    vv.quasi_static(system, until=JUMP, step=JUMP / 4)
    end = body.nodes("x1")[0]

    def compliance(s: vv.System) -> float:
        return float(body.positions(s.x)[end, 0] - 1) / TINY

    assert compliance(system) == pytest.approx(1 / 3, rel=1e-5)
    found = {}
    vv.simulate(
        system, until=5.0, step=0.05, observe=lambda s: found.update({round(s.time, 3): compliance(s)})
    )
    for t, exact in table.items():
        assert found[t] == pytest.approx(exact, rel=2e-5)


@pytest.mark.parametrize(
    ("omega", "storage", "loss"),
    [
        (0.1, 1.0440097799511, 0.293398533007),
        (1.0, 2.38461538461538, 0.923076923076923),
        (10.0, 2.99115044, 0.132743363),
    ],
)
def test_harmonic_moduli_are_those_of_a_zener_solid(omega: float, storage: float, loss: float) -> None:
    period = 2 * np.pi / omega
    h, cycles = period / 50, 8 if omega * TIME > 5 else 3
    system, body = bar(RUBBER, pulled(f"{TINY!r}*sin({omega!r}*t)"))
    grip, t, force = vv.SupportForce(solid=body, nodes="x1"), [], []

    def watch(s: vv.System) -> None:
        if s.time > (cycles - 1) * period + h / 2:  # the last one
            t.append(s.time), force.append(grip(s)[0] / TINY)

    vv.simulate(system, until=cycles * period, step=h, observe=watch)
    assert len(t) == 50
    phase, sigma = omega * np.array(t), np.array(force)
    real, imaginary = 2 * np.mean(sigma * np.sin(phase)), 2 * np.mean(sigma * np.cos(phase))
    assert real == pytest.approx(storage, rel=1e-3)
    assert imaginary == pytest.approx(loss, rel=5e-3)


@pytest.mark.parametrize("scheme", [None, vv.BDF2(), vv.GeneralizedAlpha(), vv.GeneralizedAlpha(rho=0.5)])
def test_creep_is_of_second_order_where_forces_balance_at_ends(scheme: vv.Scheme | None) -> None:
    """A bar under swinging load, Zener's model with a branch as stiff as the material: errors fall by squares."""
    K, mu, relaxation, load, omega = 1 / 3, 0.5, 0.3, 1e-8, 3.0
    retardation = relaxation * (mu + mu) / mu
    swing = np.exp(1j * omega)
    late = (swing - np.exp(-1 / retardation)) / (1 + 1j * omega * retardation)
    now, more = 1 / (9 * K) + relaxation / retardation / (3 * mu), (1 - relaxation / retardation) / (3 * mu)
    exact = load * (now * swing + more * late).imag

    def end(n: int) -> float:
        block = vv.ViscoelasticSolid(
            mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)),
            material=vv.SaintVenantKirchhoff(young=1.0, poisson=0.0),
            branches=vv.prony((0.5,), (relaxation,)),
        )
        planes = [
            vv.SymmetryPlane(solid=block, nodes=f"{c}0", normal=n)
            for c, n in zip("xyz", np.eye(3), strict=True)
        ]
        pull = vv.Traction(solid=block, faces="z1", traction=(0, 0, load), times=f"sin({omega!r}*t)")
        system = vv.System([block, *planes, pull])
        if scheme is None:
            vv.quasi_static(system, until=1.0, step=1 / n)
        else:
            vv.simulate(system, until=1.0, step=1 / n, scheme=scheme)
        return float(block.displacements(system.x)[:, 2].max())

    errors = np.array([end(n) - exact for n in (8, 16, 32)])
    assert errors[:-1] / errors[1:] == pytest.approx(4.0, rel=0.02)
    assert abs(errors[-1]) < 5e-4 * exact


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.Midpoint(), vv.BDF2(), vv.GeneralizedAlpha()])
def test_steps_far_beyond_the_time_of_relaxation(scheme: vv.Scheme) -> None:
    """Of 100 of it, after a stretch: what balances at ends of steps has the force without branches, the rest rings."""
    forces: list[list[float]] = []
    rubber = vv.NeoHooke(shear=1.0, bulk=10.0)
    for branches in ((), vv.prony((0.5,), (0.01,))):
        common: dict[str, Any] = {
            "mesh": vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)),
            "material": rubber,
            "density": 0.0,
        }
        cube = vv.ViscoelasticSolid(**common, branches=branches) if branches else vv.Solid(**common)
        sides = [vv.SymmetryPlane(solid=cube, nodes=f"{'xyz'[k]}0", normal=np.eye(3)[k]) for k in range(3)]
        pull = vv.Prescribed(solid=cube, nodes="x1", motion=("0.1 * min(t / 2, 1)", None, None))
        grip, found = vv.SupportForce(solid=cube, nodes="x1"), list[float]()
        own = scheme if branches else vv.BackwardEuler()
        vv.simulate(
            vv.System([cube, *sides, pull]), until=12.0, step=1.0, scheme=own,
            observe=lambda s, g=grip, f=found: f.append(float(g(s)[0])),
        )  # fmt: skip
        forces.append(found)
    plain, relaxed = np.array(forces)[:, 4:]
    off = relaxed / plain - 1
    if isinstance(scheme, vv.EnergyMomentum | vv.Midpoint):
        assert np.all(off[1:] / off[:-1] < -0.9)  # it hardly dies
        assert 2e-3 < np.abs(off).max() < 1e-2
    else:
        assert np.abs(off).max() < 1e-4
