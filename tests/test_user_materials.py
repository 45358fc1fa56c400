"""Energies in Python in every element: the same neo-Hooke of the package, and one whose answers are known."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]
SHEAR, LAMBDA = 38.0, 60.0


def log_of_volume(C: Array) -> Array:
    det = C[0] * (C[1] * C[2] - C[4] ** 2) - C[3] * (C[3] * C[2] - C[4] * C[5])
    return np.asarray(0.5 * np.log(det + C[5] * (C[3] * C[4] - C[1] * C[5])))


def without_volume(C: Array) -> Array:
    return np.asarray(SHEAR / 2 * (C[0] + C[1] + C[2] - 3 - 2 * log_of_volume(C)))


def rubber(C: Array) -> Array:
    return np.asarray(without_volume(C) + LAMBDA / 2 * log_of_volume(C) ** 2)


OWN = vv.NeoHooke(shear=SHEAR, lame_lambda=LAMBDA)
CASES = [
    ("hex8", {"formulation": "mixed"}),
    ("tet10", {"formulation": "mixed"}),
    ("quad9", {"formulation": "mixed"}),
    ("tri3", {"formulation": "mixed"}),
    ("hex8", {"formulation": "F-bar"}),
    ("quad4", {"formulation": "F-bar"}),
    ("quad4", {"formulation": "F-bar", "plane": "axisymmetric"}),
    ("hex8", {"formulation": "F-bar", "thermal_strain": 0.02}),
    ("quad4", {"plane": "stress"}),
    ("quad4", {"plane": "stress", "formulation": "enhanced", "thermal_strain": 0.02}),
]


def bent(material: vv.Material, cell: str, options: dict[str, Any]) -> list[Any]:
    """A console, held at one end and pulled aside at the other."""
    if cell[:3] in ("qua", "tri"):
        mesh: Any = vv.RectangleMesh(size=(2, 1), counts=(2, 1), origin=(1, 0), cell=cell)
        traction = (5.0, 3.0, 0.0)
    else:
        mesh, traction = vv.BoxMesh(size=(2, 1, 1), counts=(2, 1, 1), cell=cell), (5.0, 3.0, 4.0)
    solid = vv.Solid(mesh=mesh, material=material, density=1.0, **options)
    load = vv.Traction(solid=solid, faces="x1", traction=traction, times="min(t, 1)")
    return [solid, vv.Fixed(solid=solid, nodes="x0"), load]


@pytest.mark.parametrize(("cell", "options"), CASES)
def test_the_same_as_the_package_s_own(cell: str, options: dict[str, Any]) -> None:
    found = []
    for material in (OWN, vv.UserMaterial(function=rubber)):
        solid, *others = bent(material, cell, options)
        system = vv.System([solid, *others])
        vv.quasi_static(system, until=1.0, step=0.5)
        f = solid.fields(system.x)
        assert np.abs(solid.displacements(system.x)).max() > 0.1
        found.append([solid.positions(system.x), f.F, f.cauchy, f.energy, solid.nodal("von_mises", system.x)])
    for own, users in zip(*found, strict=True):
        assert users == pytest.approx(own, abs=1e-7 * np.abs(own).max())


@pytest.mark.parametrize("plane", ["strain", "stress"])
def test_cells_of_two_types_share_an_energy(plane: Any) -> None:
    """Pulled without a mesh's error: all stretches are equal, and so are those of the package's own."""
    points = np.array([(0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1)], dtype=float)
    mesh = vv.Mesh(points, {"quad4": np.array([[0, 1, 4, 3]]), "tri3": np.array([[1, 2, 5], [1, 5, 4]])})
    found = []
    for material in (OWN, vv.UserMaterial(function=rubber)):
        solid = vv.Solid(mesh=mesh, material=material, plane=plane)
        pulled = vv.Prescribed(solid=solid, nodes=[2, 5], motion=("0.2 * t", None, None))
        held = [
            vv.Fixed(solid=solid, nodes=[0, 3], directions=(True, False, False)),
            vv.Fixed(solid=solid, nodes=[0]),
        ]
        system = vv.System([solid, pulled, *held])
        vv.quasi_static(system, until=1.0, step=0.5)
        found.append(np.concatenate([solid.fields(system.x, cell).F[:, 0] for cell in mesh.cells]))
    own, users = found
    assert np.allclose(own, own[0], rtol=0, atol=1e-8)
    assert np.allclose(users, own, rtol=0, atol=1e-8)


@pytest.mark.parametrize(("cell", "options"), [CASES[0], CASES[5], CASES[7]])
def test_the_same_motion(cell: str, options: dict[str, Any]) -> None:
    """Discrete gradients count pairs of shears once, those of the package twice: they differ to second order."""
    ends = []
    for material in (OWN, vv.UserMaterial(function=rubber)):
        parts = bent(material, cell, options)
        system = vv.System(parts)
        vv.simulate(system, until=0.3, step=0.05, scheme=vv.Midpoint())
        ends.append(parts[0].positions(system.x))
    assert ends[1] == pytest.approx(ends[0], abs=1e-8)


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.Static()], ids=lambda s: type(s).__name__)
@pytest.mark.parametrize(("cell", "options"), CASES)
def test_tangents(cell: str, options: dict[str, Any], scheme: vv.Scheme) -> None:
    """Second derivatives are differences of first ones: their error is that of the step, not of rounding."""
    system, rng = (
        vv.System(bent(vv.UserMaterial(function=rubber), cell, options)[:1]),
        np.random.default_rng(3),
    )
    core, step = system.core, scheme.step(0.3, 0.05)
    core.x[:] += 0.03 * rng.standard_normal(len(core.x))
    trial = 0.03 * rng.standard_normal(len(core.x))
    core.dx[:] = trial
    system.invalidate()
    K, d = system.tangent(step)[1], 1e-5 * rng.standard_normal(len(core.x))
    core.dx[:] = trial + d
    change = system.residual(step)
    core.dx[:] = trial - d
    change = (change - system.residual(step)) / 2
    assert np.abs(K @ d - change).max() < 1e-5 * np.abs(change).max()


@pytest.mark.parametrize("volumetric", ["logarithmic", "quadratic", "simo"])
def test_a_volumetric_energy_beside_the_function(volumetric: Any) -> None:
    """Named, it is that of the package: in elements of displacements, and taken over by pressures."""
    own = vv.NeoHooke(shear=SHEAR, lame_lambda=LAMBDA, volumetric=volumetric)
    mine = vv.UserMaterial(function=without_volume, bulk=LAMBDA, volumetric=volumetric)
    assert mine.lame == pytest.approx(own.lame)
    C = np.array([[1.3, 0.9, 1.1, 0.1, -0.2, 0.05]])
    for users, package in zip(mine.respond(C), own.respond(C), strict=True):
        assert users == pytest.approx(package, rel=1e-7)
    for formulation in ("displacement", "mixed"):
        ends = []
        for material in (own, mine):
            solid, *others = bent(material, "quad9", {"formulation": formulation})
            system = vv.System([solid, *others])
            vv.quasi_static(system, until=1.0, step=0.5)
            ends.append(solid.positions(system.x))
        assert ends[1] == pytest.approx(ends[0], abs=1e-8)


def test_an_incompressible_energy() -> None:
    mine = vv.UserMaterial(function=without_volume, bulk=np.inf)
    with pytest.raises(vv.InputError, match=r"incompressible.*use formulation='mixed'"):
        bent(mine, "quad9", {})
    ends = []
    for material in (vv.NeoHooke(shear=SHEAR, poisson=0.5), mine):
        solid, *others = bent(material, "quad9", {"formulation": "mixed"})
        system = vv.System([solid, *others])
        vv.quasi_static(system, until=1.0, step=0.5)
        ends.append(solid.positions(system.x))
        J = solid.fields(system.x).J
        assert np.sum(solid.volumes[0] * np.log(J)) == pytest.approx(0.0, abs=1e-12)
    assert ends[1] == pytest.approx(ends[0], abs=1e-8)


def test_a_negative_bulk_modulus_is_refused() -> None:
    with pytest.raises(vv.InputError, match=r"UserMaterial: bulk = -1 is not positive"):
        vv.UserMaterial(function=rubber, bulk=-1.0)


def test_an_energy_that_nothing_locks_needs_no_pressures() -> None:
    """Its lambda of small strains is not positive: a pressure cannot stand for it."""
    with pytest.raises(vv.InputError, match="which a pressure cannot stand for"):
        bent(vv.UserMaterial(function=without_volume), "quad9", {"formulation": "mixed"})


# --- Blatz and Ko -------------------------------------------------------------------------------------------
@pytest.mark.parametrize("poisson", [0.3, 0.463, 0.49])
@pytest.mark.parametrize("stretch", [0.8, 1.01, 2.0])
def test_blatz_ko_under_uniaxial_stress(poisson: float, stretch: float) -> None:
    """``P = mu (s - s^-(1 + beta) l^-(2 beta))``, ``l^(2 + 2 beta) = s^-beta`` across, ``beta = 2 nu/(1 - 2 nu)``."""
    foam = vv.BlatzKo(shear=2.0, poisson=poisson)
    solid = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), material=foam, formulation="mixed")
    planes = [
        vv.SymmetryPlane(solid=solid, nodes=side, normal=n)
        for side, n in (("x0", (1, 0, 0)), ("y0", (0, 1, 0)), ("z0", (0, 0, 1)))
    ]
    pull = vv.Prescribed(solid=solid, nodes="x1", motion=(f"{stretch - 1}*t", None, None))
    system = vv.System([solid, *planes, pull])
    # one brick with one pressure does not resist its hourglass patterns at twice its length
    vv.quasi_static(system, until=1.0, step=0.25, scheme=vv.Static(unstable=True))
    beta = 2 * poisson / (1 - 2 * poisson)
    lateral = stretch ** (-beta / (2 + 2 * beta))
    force = 2.0 * (stretch - stretch ** -(1 + beta) * lateral ** (-2 * beta))
    assert vv.SupportForce(solid=solid, nodes="x1")(system)[0] == pytest.approx(force, rel=1e-8)
    assert solid.positions(system.x).max(axis=0) == pytest.approx([stretch, lateral, lateral], rel=1e-9)
    energy = 1.0 * (stretch**2 + 2 * lateral**2 - 3) + 2.0 / beta * ((stretch * lateral**2) ** -beta - 1)
    assert np.sum(solid.volumes[0] * solid.fields(system.x).energy) == pytest.approx(energy, rel=1e-6)


def test_blatz_ko_does_not_lock() -> None:
    """Cook's membrane at nu = 0.49: one pressure per quad4 gives what quad9 do, displacements do not."""

    def tip(cell: str, n: int, formulation: Any) -> float:
        mesh = vv.QuadrilateralMesh(corners=((0, 0), (48, 44), (48, 60), (0, 44)), counts=(n, n), cell=cell)
        solid = vv.Solid(mesh=mesh, material=vv.BlatzKo(young=250.0, poisson=0.49), formulation=formulation)
        load = vv.Traction(solid=solid, faces="x1", traction=(0, 20 / 16, 0), times="t")
        system = vv.System([solid, vv.Fixed(solid=solid, nodes="x0"), load])
        vv.quasi_static(system, until=1.0, step=0.25)
        return float(solid.displacements(system.x)[solid.nodes("x1"), 1].max())

    fine = tip("quad9", 8, "mixed")
    assert tip("quad9", 4, "mixed") == pytest.approx(fine, rel=0.015)
    assert tip("quad4", 16, "mixed") == pytest.approx(fine, rel=0.02)
    assert tip("quad4", 16, "displacement") < 0.85 * fine


def both_laws(material: vv.NeoHooke, capacity: float, expansion: float) -> list[dict[str, Any]]:
    """What a `ThermoelasticSolid` takes for a law of the core, and for the same one in Python."""
    T0, (lame, mu) = 300.0, material.lame
    coupling = 3 * (lame + 2 * mu / 3) * expansion

    def free(C: Any, T: Any) -> Any:
        J2 = C[0] * (C[1] * C[2] - C[4] ** 2) - C[3] * (C[3] * C[2] - C[4] * C[5])
        J2 = J2 + C[5] * (C[3] * C[4] - C[1] * C[5])
        ln_j = 0.5 * np.log(J2)
        strains = mu / 2 * (C[0] + C[1] + C[2] - 3 - 2 * ln_j) + lame / 2 * ln_j**2
        return strains - coupling * (T - T0) * ln_j + capacity * (T - T0 - T * np.log(T / T0))

    core = vv.Heat(conductivity=2.0, capacity=capacity, expansion=expansion, reference=T0)
    return [
        {"material": material, "heat": core},
        {"heat": vv.UserHeat(function=free, conductivity=2.0, reference=T0)},
    ]


@pytest.mark.parametrize("speed", [1e-3, 1e-4, 1e-5])
def test_user_heat_moves_by_small_strains_as_heat_does(speed: float) -> None:
    """Differences of its energy, of which heat is the larger part, would drown in rounding."""
    ends = []
    for given in both_laws(vv.NeoHooke(young=10.0, poisson=0.3), 5.0, 5e-3):
        bar: Any = vv.ThermoelasticSolid(
            mesh=vv.BoxMesh(size=(1, 0.1, 0.1), counts=(2, 1, 1)),
            density=1.0,
            velocity=lambda X: speed * np.sin(np.pi * X[:, :1]) * [1.0, 0.0, 0.0],
            **given,
        )
        system = vv.System([bar, vv.Fixed(solid=bar, nodes="x0"), vv.Fixed(solid=bar, nodes="x1")])
        result = vv.simulate(system, until=0.2, step=0.02)
        assert len(result.times) == 11
        ends.append([*bar.displacements(system.x)[:, 0], *(bar.temperatures(system.x) - 300.0)])
    assert np.array(ends[1]) / speed == pytest.approx(np.array(ends[0]) / speed, abs=1e-5)


@pytest.mark.parametrize("temperature", [300.0, 301.0])
@pytest.mark.parametrize("capacity", [2e3, 2e6])
@pytest.mark.parametrize("size", [1.0, 0.01])
def test_user_heat_in_si_units_from_its_reference_temperature_on(
    size: float, capacity: float, temperature: float
) -> None:
    """Its strains, C - I and entropy, vanish there; what the function adds up and rounds does not."""
    ends = []
    for given in both_laws(vv.NeoHooke(young=1e9, poisson=0.3), capacity, 1e-5):
        mesh = vv.BoxMesh(size=(size, size, size), counts=(2, 1, 1))
        block: Any = vv.ThermoelasticSolid(mesh=mesh, density=1000.0, temperature=temperature, **given)
        pull = vv.Traction(solid=block, faces="x1", traction=(1e5, 0, 0))
        system = vv.System([block, vv.Fixed(solid=block, nodes="x0"), pull])
        result = vv.simulate(system, until=5e-3 * size, step=1e-3 * size)
        assert result.statistics.rejected == 0
        ends.append([*block.displacements(system.x)[:, 0] / size, *(block.temperatures(system.x) / 300 - 1)])
    assert np.array(ends[1]) == pytest.approx(np.array(ends[0]), abs=1e-8)


def test_energies_that_hinge_on_other_points_are_refused() -> None:
    """Two processes had another deformation than one, as each asks for its own points."""

    def energy(C: Any) -> Any:
        return (1 + 0.5 * np.real(C[0]).max()) * rubber(C)

    def late(C: Any) -> Any:
        return (0.5 if (np.real(C[0]) > 1.2).any() else 1.0) * rubber(C)

    def partly(C: Any) -> Any:
        return energy(C) + 0 * np.log(C[0] - 0.9)  # not defined where it is compressed

    with np.errstate(invalid="ignore"):
        for function in (energy, late, partly):
            refused(function)


def refused(energy: Any) -> None:
    with pytest.raises(
        vv.InputError, match=r"among other points and .* alone; let it hinge on the C of its own"
    ):
        vv.UserMaterial(function=energy)
