"""Tangents of solids, every material, scheme and cell type, against differences of their residuals."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]


def logarithmic(C: Array) -> Array:
    """A neo-Hookean energy as a user would write it."""
    det = C[0] * (C[1] * C[2] - C[4] ** 2) - C[3] * (C[3] * C[2] - C[4] * C[5])
    det = det + C[5] * (C[3] * C[4] - C[1] * C[5])
    log_j = 0.5 * np.log(det)
    energy: Array = 19.0 * (C[0] + C[1] + C[2] - 3 - 2 * log_j) + 30 * log_j * log_j
    return energy


FIBRES = ((1, 0.5, 0.2), (1, -0.5, 0))
MATERIALS: dict[str, Callable[[], vv.Material]] = {
    "linear": lambda: vv.LinearElastic(young=100.0, poisson=0.3),
    "saint_venant": lambda: vv.SaintVenantKirchhoff(young=100.0, poisson=0.3),
    "neo_hooke": lambda: vv.NeoHooke(young=100.0, poisson=0.3),
    "neo_hooke_simo": lambda: vv.NeoHooke(young=100.0, poisson=0.3, volumetric="simo"),
    "neo_hooke_isochoric": lambda: vv.NeoHooke(young=100.0, poisson=0.3, isochoric=True),
    "mooney": lambda: vv.MooneyRivlin(c10=10.0, c01=5.0, bulk=50.0),
    "mooney_isochoric": lambda: vv.MooneyRivlin(c10=10.0, c01=5.0, bulk=50.0, isochoric=True),
    "yeoh": lambda: vv.Yeoh(c1=10.0, c2=2.0, c3=1.0, bulk=100.0),
    "gent": lambda: vv.Gent(shear=20.0, limit=30.0, bulk=80.0),
    "ogden": lambda: vv.Ogden(mu=(10.0, -4.0), alpha=(2.0, -1.5), bulk=60.0),
    "ogden_coupled": lambda: vv.Ogden(mu=(10.0, -4.0), alpha=(2.0, -1.5), bulk=60.0, isochoric=False),
    "holzapfel": lambda: vv.HolzapfelGasserOgden(
        shear=10.0, k1=5.0, k2=1.2, bulk=80.0, fibres=FIBRES, dispersion=0.1
    ),
    "blatz_ko": lambda: vv.BlatzKo(young=100.0, poisson=0.3),
    "user": lambda: vv.UserMaterial(function=logarithmic),
}
SCHEMES = [vv.EnergyMomentum(), vv.Midpoint(), vv.BackwardEuler(), vv.GeneralizedAlpha(0.8), vv.Static()]
SOLID_CELLS = ["tet4", "tet10", "hex8", "hex20", "hex27", "wedge6"]
PLANE_CELLS = ["tri3", "tri6", "quad4", "quad8", "quad9"]


def solid(
    material: vv.Material,
    cell: str,
    damping: float,
    plane: str | None,
    counts: tuple[int, ...],
    formulation: Any = "displacement",
) -> Any:
    """A brick or a rectangle of cells of size 1, apart from the axis if it is axisymmetric."""
    if plane is None:
        mesh: Any = vv.BoxMesh(size=counts, counts=counts, cell=cell)
    else:
        mesh = vv.RectangleMesh(size=counts[:2], counts=counts[:2], cell=cell)
    if plane == "axisymmetric":
        mesh = mesh.build().moved((1.0, 0.0))
    return vv.Solid(
        mesh=mesh,
        material=material,
        density=2.0,
        mass_damping=damping,
        stiffness_damping=0.1 * damping,
        plane=plane or "strain",
        formulation=formulation,
    )


def shaken(part: Any) -> vv.System:
    """A system of it in a random state, with a random increment and history."""
    system, rng = vv.System([part]), np.random.default_rng(3)
    core, n = system.core, system.core.x.size
    core.x[:] += 0.03 * rng.standard_normal(n)
    core.dx[:] = 0.03 * rng.standard_normal(n)
    core.v[:] = rng.standard_normal(n)
    system.invalidate()
    return system


def defect(system: vv.System, scheme: vv.Scheme) -> float:
    """Of the tangent along three random directions, relative to what it gives."""
    core, step, rng = system.core, scheme.step(0.3, 0.05), np.random.default_rng(7)
    trial = np.array(core.dx)

    def residual(d: Array) -> Array:
        core.dx[:] = trial + d
        return np.array(system.residual(step))

    worst = 0.0
    _, K = system.tangent(step)
    for d in 2e-5 * rng.standard_normal((3, len(trial))):
        near, far = residual(d) - residual(-d), residual(2 * d) - residual(-2 * d)
        expected = (8 * near - far) / 12
        core.dx[:] = trial
        worst = max(worst, float(np.abs(K @ d - expected).max() / np.abs(expected).max()))
    return worst


@pytest.mark.parametrize("counts", [(1, 1, 1), (3, 3, 1)], ids=["one", "nine"])
@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda s: type(s).__name__)
@pytest.mark.parametrize("name", MATERIALS)
def test_every_material_under_every_scheme(name: str, scheme: vv.Scheme, counts: tuple[int, ...]) -> None:
    material = MATERIALS[name]()
    for damping in (0.0, 0.3):
        error = defect(shaken(solid(material, "hex8", damping, None, counts)), scheme)
        assert error < 1e-9


@pytest.mark.parametrize("cell", [*SOLID_CELLS, *PLANE_CELLS])
@pytest.mark.parametrize("name", MATERIALS)
def test_every_material_in_every_cell(name: str, cell: str) -> None:
    """Under every scheme; what a material and a cell do together depends on neither damping nor neighbours."""
    plane = "strain" if cell in PLANE_CELLS else None
    for scheme in SCHEMES:
        assert defect(shaken(solid(MATERIALS[name](), cell, 0.0, plane, (1, 1, 1))), scheme) < 1e-9


@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda s: type(s).__name__)
@pytest.mark.parametrize("name", MATERIALS)
def test_every_material_with_enhanced_strains(name: str, scheme: vv.Scheme) -> None:
    assert defect(shaken(solid(MATERIALS[name](), "hex8", 0.3, None, (1, 1, 1), "enhanced")), scheme) < 1e-9


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.Static()], ids=lambda s: type(s).__name__)
@pytest.mark.parametrize("cell", SOLID_CELLS)
@pytest.mark.parametrize("name", ["neo_hooke", "mooney_isochoric"])
def test_every_solid_cell(name: str, cell: str, scheme: vv.Scheme) -> None:
    for counts in ((1, 1, 1), (2, 1, 2)):
        assert defect(shaken(solid(MATERIALS[name](), cell, 0.3, None, counts)), scheme) < 1e-9
        assert defect(shaken(solid(MATERIALS[name](), cell, 0.0, None, counts)), scheme) < 1e-9


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.Static()], ids=lambda s: type(s).__name__)
@pytest.mark.parametrize("plane", ["strain", "stress", "axisymmetric"])
@pytest.mark.parametrize("cell", PLANE_CELLS)
@pytest.mark.parametrize("name", ["neo_hooke", "yeoh"])
def test_every_plane_cell(name: str, cell: str, plane: str, scheme: vv.Scheme) -> None:
    assert defect(shaken(solid(MATERIALS[name](), cell, 0.0, plane, (3, 3, 1))), scheme) < 1e-9
    assert defect(shaken(solid(MATERIALS[name](), cell, 0.3, plane, (3, 3, 1))), scheme) < 1e-9


@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda s: type(s).__name__)
@pytest.mark.parametrize("name", [n for n in MATERIALS if n != "user"])
def test_every_material_in_plane_stress(name: str, scheme: vv.Scheme) -> None:
    for damping in (0.0, 0.3):
        assert defect(shaken(solid(MATERIALS[name](), "quad4", damping, "stress", (3, 3, 1))), scheme) < 1e-9


@pytest.mark.parametrize("material", MATERIALS)
def test_step_that_hardly_begins(material: str) -> None:
    """Where the strain changes by rounding alone, the tangent is the midpoint rule's, turned bodies included."""
    system = shaken(solid(MATERIALS[material](), "hex8", 0.0, None, (4, 4, 2)))
    x = system.core.x.reshape(-1, 3)
    angle = 0.7
    x[:] = (
        x @ np.array([[np.cos(angle), np.sin(angle), 0], [-np.sin(angle), np.cos(angle), 0], [0, 0, 1]]) + 3.0
    )
    for size in (0.0, 1e-15, 1e-13, 1e-12, 1e-11, 1e-10, 1e-9):
        system.core.dx[:] = size * np.random.default_rng(5).standard_normal(len(system.x))
        K = system.tangent(vv.EnergyMomentum().step(0.3, 0.05))[1].toarray()
        expected = system.tangent(vv.Midpoint().step(0.3, 0.05))[1].toarray()
        assert np.abs(K - expected).max() <= 1e-6 * np.abs(expected).max(), size


FORMULATIONS = [
    *[("F-bar", c, p) for c, p in (("hex8", None), ("quad4", "strain"), ("quad4", "axisymmetric"))],
    *[("enhanced", c, p) for c, p in (("hex8", None), ("quad4", "stress"), ("quad4", "axisymmetric"))],
    *[("mixed", c, None) for c in ("hex8", "wedge6", "hex20", "hex27", "tet10", "tet4")],
    *[("mixed", c, p) for c in ("quad4", "quad9", "tri6", "tri3") for p in ("strain", "axisymmetric")],
]


@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda s: type(s).__name__)
@pytest.mark.parametrize(("formulation", "cell", "plane"), FORMULATIONS)
def test_every_formulation(formulation: str, cell: str, plane: str | None, scheme: vv.Scheme) -> None:
    for damping in (0.0, 0.3):
        part = solid(MATERIALS["mooney_isochoric"](), cell, damping, plane, (1, 1, 1), formulation)
        assert defect(shaken(part), scheme) < 1e-9


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.Static()], ids=lambda s: type(s).__name__)
@pytest.mark.parametrize(("formulation", "cell"), [("F-bar", "hex8"), ("F-bar", "quad4"), ("mixed", "tri6")])
@pytest.mark.parametrize("name", MATERIALS)
def test_every_material_against_locking(name: str, formulation: str, cell: str, scheme: vv.Scheme) -> None:
    plane = None if cell == "hex8" else "strain"
    assert defect(shaken(solid(MATERIALS[name](), cell, 0.3, plane, (1, 1, 1), formulation)), scheme) < 1e-9
