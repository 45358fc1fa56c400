"""Cook's membrane and patches in plane stress and in the formulations against locking.

Numbers of fixed meshes are those of independent programs (moofeKIT's own tests; p-finite elements for the converged
values), so they hold digit by digit.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]

SOLID_CELLS = ("hex8", "wedge6", "hex20", "hex27", "tet4", "tet10")
COOK = ((0.0, 0.0), (48.0, 44.0), (48.0, 60.0), (0.0, 44.0))


def settled(*components: Any) -> vv.System:
    """The system in equilibrium under the loads of t = 1."""
    system = vv.System(components)
    vv.quasi_static(system, until=1.0, step=1.0)
    return system


def cook(cell: str, n: int, material: vv.Material, load: float = 1.0, **options: Any) -> float:
    """Vertical displacement of (48, 52) under the shear force `load` on the right edge."""
    mesh = vv.QuadrilateralMesh(corners=COOK, counts=(n, n), cell=cell)
    solid = vv.Solid(mesh=mesh, material=material, **options)
    pull = vv.Traction(solid=solid, faces="x1", traction=(0.0, load / 16, 0.0), times="t")
    system = settled(solid, vv.Fixed(solid=solid, nodes="x0"), pull)
    X = solid.points
    right = np.flatnonzero(np.isclose(X[:, 0], 48.0))
    order = right[np.argsort(X[right, 1])]
    middle = np.interp(52.0, X[order, 1], solid.displacements(system.x)[order, 1])
    return float(middle)


# --- plane stress -------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("cell", "n", "expected"),
    [
        ("quad4", 4, 18.29917),
        ("quad4", 8, 22.07918),
        ("quad4", 16, 23.43041),
        ("quad9", 2, 23.28866),
        ("quad9", 4, 23.83975),
        ("quad9", 8, 23.92539),
        ("quad8", 4, 23.7083),
    ],
)
def test_cook_plane_stress(cell: str, n: int, expected: float) -> None:
    material = vv.LinearElastic(young=1.0, poisson=1 / 3)
    tolerance = 6e-6 if cell != "quad8" else 6e-5
    assert cook(cell, n, material, plane="stress") == pytest.approx(expected, abs=tolerance)


def test_saint_venant_in_plane_stress() -> None:
    """moofeKIT's membrane of finite strains: E = 1, traction 1/16, four by four bilinear elements."""
    material = vv.SaintVenantKirchhoff(young=1.0, poisson=1 / 3)
    assert cook("quad4", 4, material, plane="stress") == pytest.approx(13.5356, abs=6e-5)


LATERAL = [
    (0.5, 1.210767391, -0.9353520569),
    (1.5, 0.8801745918, 0.3782801764),
    (3.0, 0.6881110295, 1.093141437),
]


@pytest.mark.parametrize(("stretch", "lateral", "stress"), LATERAL)
def test_homogeneous_plane_stress(stretch: float, lateral: float, stress: float) -> None:
    """A sheet pulled in its plane is a bar: both lateral stretches and the force in closed form."""
    sheet = vv.Solid(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(1, 1)),
        material=vv.NeoHooke(young=1.0, poisson=0.3),
        plane="stress",
    )
    system = settled(
        sheet,
        vv.SymmetryPlane(solid=sheet, nodes="x0", normal=(1, 0, 0)),
        vv.SymmetryPlane(solid=sheet, nodes="y0", normal=(0, 1, 0)),
        vv.Prescribed(
            solid=sheet, nodes="x1", motion=(f"t*{stretch - 1}", None, None), directions=(True, False, False)
        ),
    )
    fields = sheet.fields(system.x)
    assert fields.F[0, :, 1, 1] == pytest.approx(lateral, abs=1e-9)
    assert fields.F[0, :, 2, 2] == pytest.approx(lateral, abs=1e-9)
    assert fields.first_piola[0, :, 0, 0] == pytest.approx(stress, abs=1e-9)
    assert fields.cauchy[0, :, 2, 2] == pytest.approx(0.0, abs=1e-14)


# --- patches ------------------------------------------------------------------------------------------------
def distorted(cell: str) -> vv.Mesh:
    """A patch of distorted cells within a box: nodes inside are off their regular places."""
    source: Any = vv.BoxMesh(size=(2, 2, 2), counts=(2, 2, 2), cell=cell) if cell in SOLID_CELLS else None
    source = source or vv.RectangleMesh(size=(3, 2), counts=(3, 2), cell=cell)
    mesh = source.build()
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    bubble = np.prod((mesh.points - low) * (high - mesh.points), axis=1)
    X = mesh.points + 0.2 * bubble[:, None] / bubble.max() * np.array([0.7, -1.0, 0.5])[: mesh.dimension]
    return vv.Mesh(X, mesh.cells)


GRADIENT = np.array([[1.2, 0.3, 0.1], [-0.1, 0.9, 0.2], [0.05, -0.2, 1.1]])
PATCHES = [
    *[("F-bar", c, p) for c, p in (("quad4", "strain"), ("hex8", "strain"))],
    *[("enhanced", c, p) for c, p in (("quad4", "strain"), ("quad4", "stress"), ("hex8", "strain"))],
    *[("mixed", c, "strain") for c in ("quad9", "hex27", "hex20", "tri6", "tet10", "tri3", "tet4")],
    *[("mixed", c, "strain") for c in ("quad4", "hex8", "wedge6")],
]


@pytest.mark.parametrize(("formulation", "cell", "plane"), PATCHES)
def test_patch_of_finite_strain(formulation: Any, cell: str, plane: Any) -> None:
    """Boundary nodes moved by a constant F: every point has that F, and the stress of the material's law."""
    material = vv.NeoHooke(young=10.0, poisson=0.4, isochoric=True, volumetric="logarithmic")
    solid = vv.Solid(mesh=distorted(cell), material=material, formulation=formulation, plane=plane)
    d = solid.dimension
    F = np.eye(3)
    F[:d, :d] = GRADIENT[:d, :d]
    boundary = solid.faces("all").nodes
    moved = vv.Prescribed(
        solid=solid,
        nodes=boundary,
        motion=lambda t, X: t * X @ (F - np.eye(3)).T,
        directions=[True] * d + [False] * (3 - d),
    )
    system = settled(solid, moved)
    shown = solid.fields(system.x)
    assert np.abs(shown.F[..., :d, :d] - F[:d, :d]).max() < 1e-10
    C = (shown.F[0, 0].T @ shown.F[0, 0])[[0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]]
    _, S, _ = material.respond(C[None])
    full = S[0][[[0, 3, 5], [3, 1, 4], [5, 4, 2]]]
    assert np.abs(shown.second_piola - full).max() < 1e-9
    assert (
        np.abs(solid.nodal_forces(system.x)[np.setdiff1d(np.arange(solid.grid.n_nodes), boundary)]).max()
        < 1e-9
    )


# --- Cook's membrane ----------------------------------------------------------------------------------------
def test_enhanced_strains_in_plane_stress() -> None:
    """moofeKIT's EAS-4, four by four."""
    material = vv.LinearElastic(young=1.0, poisson=1 / 3)
    tip = cook("quad4", 4, material, plane="stress", formulation="enhanced")
    assert tip == pytest.approx(23.0164, abs=6e-5)


def test_constant_pressures() -> None:
    """Bilinear displacements, four by four in plane strain: moofeKIT's mean dilatation."""
    tip = cook("quad4", 4, vv.LinearElastic(young=1.0, poisson=1 / 3), formulation="mixed")
    assert tip == pytest.approx(17.7377, abs=6e-5)


def cook_3d(cell: str, **options: Any) -> float:
    """moofeKIT's membrane with four by one by four cells: displacement of (48, 4, 60) along z."""
    unit = vv.BoxMesh(size=(1, 1, 1), counts=(4, 1, 4), cell=cell).build()
    x, y, z = unit.points.T
    X = np.column_stack([48 * x, 4 * y, (1 - z) * 44 * x + z * (44 + 16 * x)])
    mesh = vv.Mesh(X, unit.cells, face_sets=unit.face_sets)
    solid = vv.Solid(mesh=mesh, material=vv.LinearElastic(young=2261.0, poisson=0.4955), **options)
    pull = vv.Traction(solid=solid, faces="x1", traction=(0.0, 0.0, 100.0), times="t")
    system = settled(solid, vv.Fixed(solid=solid, nodes="x0"), pull)
    tip = np.argmin(np.linalg.norm(solid.points - [48.0, 4.0, 60.0], axis=1))
    return float(solid.displacements(system.x)[tip, 2])


@pytest.mark.parametrize(
    ("cell", "formulation", "expected"),
    [("hex8", "displacement", 5.8617), ("hex27", "displacement", 16.3295), ("hex8", "enhanced", 15.4177)],
)
def test_cook_3d(cell: str, formulation: str, expected: float) -> None:
    assert cook_3d(cell, formulation=formulation) == pytest.approx(expected, abs=6e-5)


@pytest.mark.parametrize(
    ("cell", "formulation", "n", "error"),
    [
        ("quad4", "F-bar", 16, 0.015),
        ("quad4", "enhanced", 16, 0.015),
        ("quad4", "mixed", 16, 0.021),
        ("quad9", "mixed", 8, 0.005),
        ("tri6", "mixed", 16, 0.01),
        ("tri3", "mixed", 32, 0.03),
    ],
)
@pytest.mark.parametrize(("young", "exact"), [(240.565, 7.6952), (250.0, 7.4048)])
def test_cook_nearly_incompressible(
    cell: str, formulation: str, n: int, error: float, young: float, exact: float
) -> None:
    """Plane strain, nu = 0.4999: values by p-finite elements, of which quad4 of displacements has a third (n = 16).

    Two corners of the membrane are singular, so that errors fall little faster than linearly.
    """
    material = vv.LinearElastic(young=young, poisson=0.4999)
    coarse, fine = (
        abs(cook(cell, k, material, 100.0, formulation=formulation) / exact - 1) for k in (n // 2, n)
    )
    assert fine < error
    assert fine < 0.5 * coarse


def test_cook_nearly_incompressible_in_the_limit() -> None:
    """Extrapolated from three meshes of pressures linear in each quad9, 7.6952 is met to 0.03 %."""
    material = vv.LinearElastic(young=240.565, poisson=0.4999)
    a, b, c = (cook("quad9", n, material, 100.0, formulation="mixed") for n in (8, 16, 32))
    assert c - (c - b) ** 2 / ((c - b) - (b - a)) == pytest.approx(7.6952, rel=3e-4)


def test_wedges_with_pressures_do_not_lock() -> None:
    """A strip of 16 x 4 x 1 cells bent in its plane: within 15 % of quadratic hexahedra.

    With one pressure in each wedge it was as stiff as without pressures, by a factor of 13.
    """

    def bent(cell: str, formulation: Any, nu: float = 0.4999) -> float:
        mesh = vv.BoxMesh(size=(16, 4, 1), counts=(16, 4, 1), cell=cell)
        material = vv.LinearElastic(young=1.0, poisson=nu)
        solid = vv.Solid(mesh=mesh, material=material, formulation=formulation)
        pull = vv.Traction(solid=solid, faces="x1", traction=(0.0, 1e-4, 0.0), times="t")
        system = settled(solid, vv.Fixed(solid=solid, nodes="x0"), pull)
        return float(solid.displacements(system.x)[solid.nodes("x1"), 1].mean())

    exact = bent("hex20", "mixed")
    assert bent("wedge6", "displacement") < 0.1 * exact
    assert bent("wedge6", "mixed") == pytest.approx(exact, rel=0.15)
    assert bent("wedge6", "mixed", nu=0.5) == pytest.approx(bent("hex20", "mixed", nu=0.5), rel=0.15)


# --- incompressible -----------------------------------------------------------------------------------------
@pytest.mark.parametrize(("cell", "n", "error"), [("quad9", 4, 2e-5), ("tri6", 8, 2e-5), ("tri3", 16, 6e-3)])
def test_inflated_tube(cell: str, n: int, error: float) -> None:
    """An incompressible neo-Hookean tube of radii 1 and 2 in plane strain, blown up to 1.6 inside: closed form."""
    wall = vv.RectangleMesh(size=(1.0, 1.0 / n), counts=(n, 1), cell=cell).build()
    tube = vv.Solid(
        mesh=wall.moved((1.0, 0.0)),
        material=vv.NeoHooke(shear=1.0, poisson=0.5),
        plane="axisymmetric",
        formulation="mixed",
    )
    ends = vv.SymmetryPlane(solid=tube, nodes="all", normal=(0, 1, 0))
    load = vv.Pressure(solid=tube, faces="x0", pressure="0.4697514859*t")
    system = vv.System([tube, ends, load])
    vv.quasi_static(system, until=1.0, step=0.25)
    inner = tube.nodes("x0")
    assert tube.positions(system.x)[inner, 0] == pytest.approx(1.6, abs=error)
    assert np.sum(tube.volumes[0] * np.log(tube.fields(system.x).J)) == pytest.approx(0.0, abs=1e-12)


# --- what is refused, what else must work -------------------------------------------------------------------
RUBBER = vv.NeoHooke(shear=1.0, poisson=0.5)
SOFT = vv.NeoHooke(shear=1.0, poisson=0.4)


@pytest.mark.parametrize(
    ("cell", "options", "cure"),
    [
        ("quad9", {"material": RUBBER}, "use formulation='mixed'"),
        ("quad4", {"material": RUBBER, "formulation": "F-bar"}, "use formulation='mixed'"),
        ("tri6", {"material": SOFT, "formulation": "F-bar"}, "formulation='mixed', or convert the mesh"),
        ("quad8", {"material": SOFT, "formulation": "mixed"}, "formulation='displacement', or convert"),
        ("quad4", {"material": RUBBER, "formulation": "mixed"}, "alternate.*make the mesh with cell='quad9'"),
        (
            "quad9",
            {"material": vv.NeoHooke(young=1.0, poisson=0.0), "formulation": "mixed"},
            "energy is 0.*take formulation='displacement'",
        ),
        ("quad4", {"material": SOFT, "formulation": "F-bar", "plane": "stress"}, "no volume locks"),
        ("hex8", {"material": SOFT, "plane": "stress"}, "is for plane meshes"),
    ],
)
def test_refused_combinations(cell: str, options: dict[str, Any], cure: str) -> None:
    with pytest.raises(vv.InputError, match=cure):
        vv.Solid(mesh=distorted(cell), **options)


def test_refused_materials() -> None:
    with pytest.raises(vv.InputError, match="outside -1"):
        vv.NeoHooke(shear=1.0, poisson=0.51)


@pytest.mark.parametrize(
    ("formulation", "cell"), [("F-bar", "hex8"), ("enhanced", "hex8"), ("mixed", "tet10")]
)
def test_static_tangents_are_symmetric(formulation: Any, cell: str) -> None:
    system = vv.System([vv.Solid(mesh=distorted(cell), material=SOFT, formulation=formulation)])
    system.core.dx[: len(system.x)] = 0.02 * np.random.default_rng(1).standard_normal(len(system.x))
    K = system.tangent(vv.Static().step(0.0, 1.0))[1]
    assert abs(K - K.T).max() < 1e-13 * abs(K).max()


@pytest.mark.parametrize(
    ("cell", "formulation", "error"),
    [("quad4", "enhanced", 0.01), ("quad9", "mixed", 0.002), ("tri6", "mixed", 0.01)],
)
def test_modes_with_inner_unknowns(cell: str, formulation: Any, error: float) -> None:
    """The first bending frequency of a slender cantilever in plane stress or strain, Euler and Bernoulli."""
    plane: Any = "stress" if formulation == "enhanced" else "strain"
    poisson = 0.3
    beam = vv.Solid(
        mesh=vv.RectangleMesh(size=(20.0, 0.5), counts=(40, 1), cell=cell),
        material=vv.SaintVenantKirchhoff(young=1e4, poisson=poisson),
        density=1.0,
        plane=plane,
        formulation=formulation,
    )
    found = vv.modes(vv.System([beam, vv.Fixed(solid=beam, nodes="x0")]), 1).angular[0]
    stiffness = 1e4 if plane == "stress" else 1e4 / (1 - poisson**2)
    exact = 1.8751040687**2 * np.sqrt(stiffness * 0.5**2 / 12) / 20.0**2
    assert found == pytest.approx(exact, rel=error)
