"""Solids that crack: closed forms of bars, irreversibility, splits, energy of dynamic cracks, what goes with them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from catalogue.solids import MATERIALS
from numpy.typing import NDArray

import visviva as vv
from visviva.phase.crack_law import CrackLaw
from visviva.scheme.schemes import load_step
from visviva.study.run import run

Array = NDArray[np.float64]

YOUNG, TOUGHNESS, LENGTH = 210e3, 2.7e-7, 0.015
"""MPa, N/mm, mm. A toughness of 2.7 N/mm strains the bar by 1.7 %; 1e-7 of it keeps to small strains."""
SMALL = np.sqrt(1e-7)


def bar(counts: tuple[int, int] = (2, 1), poisson: float = 0.0, **options: Any) -> vv.FracturingSolid:
    given = {"material": vv.SaintVenantKirchhoff(young=YOUNG, poisson=poisson), **options}
    mesh = vv.RectangleMesh(size=(0.02, 0.01), counts=counts)
    return vv.FracturingSolid(mesh=mesh, toughness=TOUGHNESS, length=LENGTH, **given)


def pull(solid: vv.FracturingSolid, strain: Any) -> vv.System:
    """A bar that is stretched, free to narrow; `strain` is a function of time."""
    return vv.System(
        [
            solid,
            vv.Fixed(solid=solid, nodes="x0", directions=(True, False, False)),
            vv.Fixed(solid=solid, nodes=[0]),
            vv.Prescribed(solid=solid, nodes="x1", motion=(lambda t: 0.02 * strain(t), None, None)),
        ]
    )


def stress(solid: vv.FracturingSolid, x: Array) -> float:
    return float(solid.fields(x).first_piola[..., 0, 0].mean())


@pytest.mark.parametrize(
    "scheme",
    [vv.Static(unstable=True), vv.AlternateMinimization(unstable=True, newton=2)],
    ids=["at once", "to and fro"],
)
@pytest.mark.parametrize(
    ("model", "strength", "strain"),
    [("AT2", 1996.6769268, 0.0169030851), ("AT1", 3764.9701194, 0.0179284291)],
)
def test_strength_of_a_bar_that_damages_evenly(
    model: Any, strength: float, strain: float, scheme: vv.Static
) -> None:
    """9/16 sqrt(E Gc / 3 l) at sqrt(Gc / 3 E l) with AT2, sqrt(3 E Gc / 8 l) with AT1."""
    solid = bar(model=model)
    result = vv.quasi_static(
        pull(solid, lambda t: 2 * strain * SMALL * t), until=0.6, step=0.01, scheme=scheme
    )
    found = [stress(solid, x) for x in result.states]
    peak = int(np.argmax(found))
    assert found[peak] == pytest.approx(strength * SMALL, rel=1e-3)
    assert result.times[peak] == pytest.approx(0.5, abs=0.0101)
    if model == "AT2":
        assert solid.damages(result.states[peak]) == pytest.approx(0.25, abs=0.01)
    else:
        assert np.abs(solid.damages(result.states[peak - 1])).max() == 0


def test_damage_of_a_bar_against_its_closed_form() -> None:
    """E e^2 (1 - d) = Gc d / l: every state, beyond the peak too."""
    solid = bar()
    result = vv.quasi_static(
        pull(solid, lambda t: 0.03 * SMALL * t), until=1.0, step=0.1, scheme=vv.Static(unstable=True)
    )
    for t, x in zip(result.times, result.states, strict=True):
        drive = YOUNG * (0.03 * SMALL * t) ** 2
        assert solid.damages(x) == pytest.approx(drive / (drive + TOUGHNESS / LENGTH), abs=1e-5)


def test_damage_never_heals_and_holds_without_work() -> None:
    """Pulled, let go, pulled again: damage stays, the unloading follows the weakened line, work comes back."""
    solid = bar()
    system = pull(solid, lambda t: 0.0169 * SMALL * np.interp(t, (0, 1, 2, 3), (0, 1, 0, 1.2)))
    result = vv.quasi_static(system, until=3.0, step=0.05, scheme=vv.Static(unstable=True))
    d = np.array([solid.damages(x).max() for x in result.states])
    assert (np.diff(d) >= 0).all()
    t = np.array(result.times)
    resting = (t >= 1) & (t <= 2.8)
    assert np.ptp(d[resting]) < 1e-12
    assert d[-1] > d[resting][-1] + 0.05
    back = (t > 1) & (t < 2)
    weakened = [stress(solid, x) for x in np.array(result.states)[back]]
    soundness = (1 - 1e-6) * (1 - d[back]) ** 2 + 1e-6
    assert weakened == pytest.approx(soundness * YOUNG * 0.0169 * SMALL * (2 - t[back]), rel=1e-4)


@pytest.mark.parametrize("split", ["volumetric", "spectral"])
@pytest.mark.parametrize(
    "material",
    [vv.SaintVenantKirchhoff(young=YOUNG, poisson=0.2), vv.Hencky(young=YOUNG, poisson=0.2)],
    ids=["Green", "Hencky"],
)
def test_what_is_squeezed_from_all_sides_does_not_crack(material: Any, split: Any) -> None:
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1))
    solids = [
        vv.FracturingSolid(mesh=mesh, material=material, toughness=1.0, length=1.0, split=s)
        for s in (split, "none")
    ]
    for solid, cracks in zip(solids, (False, True), strict=True):
        squeezed = vv.Prescribed(solid=solid, nodes="all", motion=lambda t, X: -0.05 * t * X)
        system = vv.System([solid, squeezed])
        vv.quasi_static(system, until=1.0, step=0.5, scheme=vv.Static(unstable=True))
        assert (solid.damages(system.x).max() > 0.1) == cracks
        whole, _, _ = material.respond(np.array([[0.9025] * 3 + [0] * 3]))
        if not cracks:
            assert solid.fields(system.x).energy == pytest.approx(float(whole[0]), rel=1e-9)


PLANE, SPACE = (
    ("tri3", "tri6", "quad4", "quad9", "quad8"),
    ("tet4", "hex8", "hex27", "wedge6", "tet10", "hex20"),
)
TURNED = {
    ("quad8", "strain"),
    ("quad8", "axisymmetric"),
    ("tri6", "axisymmetric"),
    ("tet10", ""),
    ("hex20", ""),
}
"""Cells that have shape functions of a negative integral."""


@pytest.mark.parametrize("model", ["AT1", "AT2"])
@pytest.mark.parametrize(
    ("cell", "plane"),
    [
        *((cell, plane) for cell in PLANE for plane in ("strain", "axisymmetric")),
        *((cell, "") for cell in SPACE),
    ],
)
def test_what_is_not_loaded_does_not_crack(cell: Any, plane: Any, model: Any) -> None:
    """Cells where a shape function has a negative integral would; with the history field they are right."""
    if plane:
        mesh: Any = vv.RectangleMesh(size=(1, 1), counts=(3, 3), cell=cell, origin=(0.2, 0))
    else:
        mesh = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2), cell=cell)
    material = vv.SaintVenantKirchhoff(young=1.0, poisson=0.2)
    given: Any = {"mesh": mesh, "material": material, "toughness": 1.0, "length": 1.0, "model": model}
    given |= {"plane": plane} if plane else {}
    if (cell, plane) in TURNED:
        with pytest.raises(vv.InputError, match=rf"negative integral.*its cells {cell}:.*take .*'history'"):
            vv.FracturingSolid(**given)
        given["irreversibility"] = "history"
    solid = vv.FracturingSolid(**given)
    system = vv.System([solid, vv.Fixed(solid=solid, nodes="x0")])
    vv.quasi_static(system, until=1.0, step=1.0)
    assert np.abs(solid.damages(system.x)).max() < 1e-12
    assert abs(solid.crack_energy(system.x)) < 1e-12


def test_curved_triangles_may_crack_without_load_and_are_refused() -> None:
    """Corners of straight tri6 have the integral zero; bent ones take from it, and heat takes no history field."""
    flat = vv.RectangleMesh(size=(1, 1), counts=(4, 4), cell="tri6").build()
    r, angle = 1 + flat.points[:, 0], 1.5 * flat.points[:, 1]
    bent = vv.Mesh(np.stack([r * np.cos(angle), r * np.sin(angle)], axis=1), flat.cells)
    given: Any = {
        "material": vv.SaintVenantKirchhoff(young=1.0, poisson=0.2),
        "toughness": 1.0,
        "length": 0.5,
    }
    vv.FracturingSolid(mesh=flat, **given)
    heat = vv.Heat(conductivity=1.0, capacity=1.0)
    with pytest.raises(vv.InputError, match=r"cells tri6:.*or tri6 of straight edges$"):
        vv.ThermalFracturingSolid(mesh=bent, heat=heat, **given)


@pytest.mark.parametrize("cell", ["hex8", "hex27", "wedge6"])
@pytest.mark.parametrize("model", ["AT1", "AT2"])
def test_cracks_close_from_the_state_without_stress(model: Any, cell: Any) -> None:
    """Pulled, let go to nothing, pressed: the stiffness jumps where strains change their signs.

    Pressed, lam (e + 2 f) + 2 g mu f = 0 across, and lam (e + 2 f) + 2 mu e = sigma along.
    """
    lam, mu, strain = 80.0, 80.0, 1e-3  # E = 200, Poisson's ratio 1/4
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1), cell=cell)
    solid = vv.FracturingSolid(
        mesh=mesh,
        material=vv.SaintVenantKirchhoff(young=200.0, poisson=0.25),
        toughness=1e-4,
        length=5.0,
        model=model,
        split="spectral",
    )
    planes = [
        vv.SymmetryPlane(solid=solid, nodes=f"{axis}0", normal=normal)
        for axis, normal in zip("xyz", np.eye(3).tolist(), strict=True)
    ]
    table = [[0, 0], [1, strain], [2, 0], [3, -strain]]
    moved = vv.Prescribed(solid=solid, nodes="x1", motion=(table, None, None))
    system = vv.System([solid, *planes, moved])
    vv.quasi_static(system, until=2.0, step=0.1, scheme=vv.AlternateMinimization())
    before = solid.damages(system.x)
    vv.quasi_static(system, until=3.0, step=0.5, scheme=vv.AlternateMinimization(halvings=0))
    assert before.min() > 0.7
    assert solid.damages(system.x) == pytest.approx(before, abs=1e-9)
    g = solid.law.soundness(before.mean())
    f = lam * strain / (2 * (lam + g * mu))
    closed = -(lam * (strain - 2 * f) + 2 * mu * strain)
    assert stress(solid, system.x) == pytest.approx(closed, rel=5e-3)


GREEN, HENCKY = vv.SaintVenantKirchhoff(young=1.0, poisson=0.3), vv.Hencky(young=1.0, poisson=0.3)
OGDEN = vv.Ogden(mu=(0.5, -0.1), alpha=(2.0, -2.0), bulk=1.0)


@pytest.mark.parametrize(
    ("material", "split"),
    [*((m, s) for m in (GREEN, HENCKY) for s in ("none", "volumetric", "spectral")), (OGDEN, "volumetric")],
    ids=lambda given: given if isinstance(given, str) else type(given).__name__,
)
@pytest.mark.parametrize(
    "C",
    [
        (1.1, 1.1, 1.1, 0, 0, 0),
        (1.1, 1.1, 0.85, 0, 0, 0),
        (1.15, 0.9, 0.9, 0, 0, 0),
        (1.05, 0.98, 0.9, 0.03, 0.02, -0.01),
    ],
    ids=["all equal", "two equal", "two equal, squeezed", "apart"],
)
def test_forces_of_the_core_are_the_derivative_of_the_energy(C: Any, split: Any, material: Any) -> None:
    """Also where principal values coincide: the core against differences of an energy in numpy."""
    tensor = np.array(C)[[[0, 3, 5], [3, 1, 4], [5, 4, 2]]]
    values, n = np.linalg.eigh(tensor)
    F = (n * np.sqrt(values)) @ n.T
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1))
    solid = vv.FracturingSolid(
        mesh=mesh, material=material, toughness=0.1, length=1.0, split=split, damage=0.3
    )
    system = vv.System([solid])
    moved = solid.node_unknowns(np.arange(8))[:, None] + np.arange(3)
    system.x[moved] = solid.points @ F.T
    system.invalidate()
    now = load_step(0.0, 0.0)
    residual, K = system.tangent(now)

    def energy(x: Array) -> float:
        return float((solid.volumes[0] * solid.fields(x).energy).sum()) + solid.crack_energy(x)

    direction = np.random.default_rng(1).standard_normal(len(system.x))
    h, x = 1e-5, system.x.copy()
    slope = (energy(x + h * direction) - energy(x - h * direction)) / (2 * h)
    assert residual @ direction == pytest.approx(slope, rel=1e-7, abs=1e-10)
    ends = []
    for sign in (1, -1):
        system.core.dx[:] = sign * h * direction
        r, _ = system.tangent(now)
        ends.append(r)
    system.core.dx[:] = 0
    difference = (ends[0] - ends[1]) / (2 * h)
    assert np.abs(K @ direction - difference).max() < 2e-4 * np.abs(difference).max()


def breaking(**options: Any) -> vv.FracturingSolid:
    """A bar that flies apart."""
    return vv.FracturingSolid(
        mesh=vv.RectangleMesh(size=(4, 1), counts=(16, 4)),
        material=vv.NeoHooke(young=100.0, poisson=0.3),
        density=1.0,
        toughness=0.02,
        length=0.5,
        velocity=lambda X: np.stack([1.1 * (X[:, 0] - 2), 0 * X[:, 0], 0 * X[:, 0]], axis=1),
        **options,
    )


@pytest.mark.parametrize("model", ["AT1", "AT2"])
def test_kinetic_elastic_and_crack_energy_are_kept_while_a_bar_breaks(model: Any) -> None:
    solid = breaking(model=model)
    result = vv.simulate(vv.System([solid]), until=0.3, step=0.01)
    total = result.ledger["total"]
    assert solid.damages(result.states[-1]).max() > 0.98
    assert solid.crack_energy(result.states[-1]) > 0.05
    assert np.abs(total - total[0]).max() < 1e-12 * total[0]
    assert max(result.conservation().values()) < 1e-12
    assert all(
        (solid.damages(b) >= solid.damages(a)).all()
        for a, b in zip(result.states, result.states[1:], strict=False)
    )


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.Midpoint()])
def test_a_body_that_breaks_in_one_step_does_not_heal(scheme: vv.Scheme) -> None:
    """d = 2 W / (2 W + G_c / l); forces that balance in the middle of a step took it from 0 to 1.98, for good."""
    body = vv.FracturingSolid(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(2, 2)),
        material=vv.SaintVenantKirchhoff(young=1.0, poisson=0.0),
        density=1e-6,
        toughness=1e-4,
        length=1.0,
    )
    pull = vv.Prescribed(solid=body, nodes="all", motion=lambda t, X: 0.2 * t * X * [1, 0, 0])
    strain = 0.5 * (1.2**2 - 1)
    system = vv.System([body, pull])
    vv.simulate(system, until=1.0, step=1.0, scheme=scheme)
    assert system.stepper.rejected > 0
    assert body.damages(system.x) == pytest.approx(strain**2 / (strain**2 + 1e-4), abs=0.025)


def test_a_restarted_crack_goes_on_to_the_bit(tmp_path: Path) -> None:
    def study(until: float) -> vv.Study:
        return vv.Study(vv.System([breaking()]), until, 0.01)

    whole, split = study(0.2), study(0.2)
    run(whole, tmp_path / "whole", pictures=False)
    run(study(0.1), tmp_path / "split", pictures=False)
    run(split, tmp_path / "split", pictures=False, resume=True)
    assert whole.system.x.tobytes() == split.system.x.tobytes()
    assert whole.system.v.tobytes() == split.system.v.tobytes()


@pytest.mark.parametrize("name", MATERIALS)
def test_a_volumetric_split_takes_what_is_a_shape_and_a_volume(name: str) -> None:
    """Those whose energy is said to be a part of constant volume and one of the volume; what it leaves is that."""
    material = MATERIALS[name]
    law = CrackLaw("", material, 1.0, 1.0, "AT2", "volumetric", 0.0)
    parted = name.startswith("split ") or name in (
        "Yeoh",
        "Gent",
        "Ogden",
        "Holzapfel-Gasser-Ogden",
        "Hencky",
    )
    if name == "Saint Venant-Kirchhoff":
        return  # whose own split is of the trace of its strains
    if not parted:
        with pytest.raises(vv.InputError, match="isochoric=True"):
            _ = law.number
        return
    squeezed = np.array([[0.8, 0.8, 0.8, 0.0, 0.0, 0.0]])
    assert law.left(squeezed)[0] == pytest.approx(material.respond(squeezed)[0], rel=1e-12)


def test_steps_of_what_cracks_without_mass_grow() -> None:
    """As under a scheme whose rates do not alternate: a bar that is pulled to and fro."""
    steps = []
    for scheme in (vv.BDF2(), vv.EnergyMomentum()):
        body = vv.FracturingSolid(
            mesh=vv.RectangleMesh(size=(1, 1), counts=(4, 4)),
            material=vv.SaintVenantKirchhoff(young=1.0, poisson=0.2),
            toughness=1e-3,
            length=0.4,
        )
        pull = vv.Prescribed(solid=body, nodes="y1", motion=(None, "1e-2*sin(t)", None))
        system = vv.System([body, vv.Fixed(solid=body, nodes="y0"), pull])
        rule = vv.Adaptive(tolerance=1e-4, max_step=0.5)
        result = vv.simulate(system, until=3.0, step=0.05, scheme=scheme, adaptive=rule)
        steps.append(len(result.times) - 1)
    assert steps[1] < 1.5 * steps[0]
