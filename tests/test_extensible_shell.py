"""Shells whose directors stretch: every material in an even stretch, layers, stresses, what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from catalogue.solids import MATERIALS
from numpy.typing import NDArray

import visviva as vv
from visviva.body.shell_stress import second_piola

Array = NDArray[np.float64]
SIZE = (1.0, 0.8)
FIBRES: Any = ((1.0, 0.6, 0.0), (1.0, -0.6, 0.0))
TISSUE = vv.HolzapfelGasserOgden(shear=10.0, k1=5.0, k2=1.2, bulk=80.0, fibres=FIBRES, dispersion=0.1)


def gel(C: Array) -> Array:
    """A user's energy: neo-Hooke's."""
    J2 = C[0] * (C[1] * C[2] - C[4] ** 2) - C[3] * (C[3] * C[2] - C[4] * C[5])
    J2 = J2 + C[5] * (C[3] * C[4] - C[1] * C[5])
    return np.asarray(0.5 * (C[0] + C[1] + C[2] - 3 - np.log(J2)) + 0.125 * np.log(J2) ** 2)


EVERY = {**MATERIALS, "Holzapfel-Gasser-Ogden": TISSUE, "user": vv.UserMaterial(function=gel)}


def distorted(cell: Any = "quad4") -> vv.Mesh:
    """A rectangle of two by two cells, the middle node moved."""
    flat = vv.RectangleMesh(size=SIZE, counts=(2, 2), cell=cell).build()
    points = np.pad(flat.points, ((0, 0), (0, 1)))
    points[np.all(np.isclose(flat.points, (0.5, 0.4)), axis=1)] += (0.07, -0.05, 0.0)
    return vv.Mesh(points, flat.cells, face_sets=flat.face_sets)


def pulled(body: Any, amount: float, *others: Any) -> vv.System:
    """In equilibrium, longer along x by `amount`."""

    def motion(t: float, X: Array) -> Array:
        return np.outer(amount * t * X[:, 0], (1.0, 0.0, 0.0))

    held = [
        vv.SymmetryPlane(solid=body, nodes=f"{a}0", normal=n) for a, n in (("x", (1, 0, 0)), ("y", (0, 1, 0)))
    ]
    pull = vv.Prescribed(solid=body, nodes="x1", motion=motion, directions=(True, False, False))
    system = vv.System([body, *held, pull, *others])
    vv.quasi_static(system, until=1.0, step=0.25)
    return system


def mixed(flat: vv.Mesh) -> vv.Mesh:
    """The first half of the quadrilaterals, and two triangles for each of the others."""
    quads = np.asarray(flat.cells["quad4"])
    kept, cut = np.split(quads, [len(quads) // 2])
    cells = {"quad4": kept, "tri3": np.concatenate([cut[:, [0, 1, 2]], cut[:, [0, 2, 3]]])}
    sets = {name: flat.nodes(name) for name in flat.face_sets}
    return vv.Mesh(flat.points, cells, node_sets=sets)


def sheet(
    section: Any, amount: float = 0.4, mesh: Any = None, **options: Any
) -> tuple[vv.ExtensibleShell, vv.System]:
    shell = vv.ExtensibleShell(mesh=mesh or distorted(), section=section, first=(1, 0, 0), **options)
    return shell, pulled(shell, amount, vv.Fixed(solid=shell, nodes="all", directions=(False, False, True)))


# --- even stretches: patch tests of every material ------------------------------------------------------------
@pytest.mark.parametrize("name", EVERY)
@pytest.mark.parametrize("cell", ["quad4", "tri3"])
def test_a_sheet_of_every_material_stretches_as_a_solid_does(cell: str, name: str) -> None:
    """Distorted cells, pulled to 1.4 times their length: width and thickness are those of bricks."""
    t = 0.1
    shell, system = sheet(vv.SolidSection(material=EVERY[name], thickness=t), mesh=distorted(cell))
    block = vv.Solid(mesh=vv.BoxMesh(size=(*SIZE, t), counts=(1, 1, 1)), material=EVERY[name])
    bottom = vv.SymmetryPlane(solid=block, nodes="z0", normal=(0, 0, 1))
    there = pulled(block, 0.4, bottom)
    corner = block.displacements(there.x)[np.argmax(block.points.sum(axis=1))]
    width = shell.displacements(system.x)[np.argmax(shell.points.sum(axis=1)), 1]
    assert width == pytest.approx(corner[1], abs=1e-9)
    np.testing.assert_allclose(shell.directors(system.x)[:, 2], 1 + corner[2] / t, atol=1e-9)
    np.testing.assert_allclose(shell.at_points("thickness", system.x), t + corner[2], atol=1e-10)
    np.testing.assert_allclose(
        shell.smoothed(["thickness"], system.x)["thickness"], np.full(9, t + corner[2])
    )
    S = block.fields(there.x).second_piola[0, 0, 0, 0]
    found = shell.resultants(system.x)
    np.testing.assert_allclose(found[..., 0], S * t, rtol=1e-7)
    np.testing.assert_allclose(found[..., 1:], 0, atol=1e-7 * S * t)


@pytest.mark.parametrize("formulation", ["displacement", "mixed"])
def test_meshes_of_quadrilaterals_and_triangles_stretch_evenly(formulation: Any) -> None:
    """As quadrilaterals do, and with resultants of both types."""
    section = vv.SolidSection(material=vv.NeoHooke(young=3.0, poisson=0.45), thickness=0.1)
    (plain, x), (both, y) = (
        (s, of.x)
        for s, of in (
            sheet(section, mesh=m, formulation=formulation) for m in (distorted(), mixed(distorted()))
        )
    )
    np.testing.assert_allclose(both.directors(y.copy()), plain.directors(x), atol=1e-9)
    for found in both.resultants_of_parts(y):
        np.testing.assert_allclose(found, np.broadcast_to(plain.resultants(x)[0, 0], found.shape), atol=1e-9)
    np.testing.assert_allclose(
        both.at_points("thickness", y), plain.at_points("thickness", x)[0, 0], atol=1e-10
    )


@pytest.mark.parametrize(("kinks", "angle"), [("rigid", 2.0), ("hinged", np.pi / 2)])
@pytest.mark.parametrize("formulation", ["displacement", "mixed"])
def test_a_folded_sheet_stretches_evenly(formulation: Any, kinks: Any, angle: float) -> None:
    """Pulled along its fold, both halves get narrower and thinner as a flat one does."""
    rubber = vv.NeoHooke(shear=1.0, poisson=0.4)
    section = vv.SolidSection(material=rubber, thickness=0.1)
    flat, there = sheet(section, formulation=formulation)
    corner = int(np.argmax(flat.points.sum(axis=1)))
    narrow = flat.displacements(there.x)[corner, 1] / SIZE[1]
    thin = flat.directors(there.x)[corner, 2]
    lying = vv.RectangleMesh(size=SIZE, counts=(2, 2)).build()
    x, y = lying.points.T
    c, s = np.cos(angle), np.sin(angle)
    up = vv.Mesh(np.stack([x, c * y, -s * y], axis=1), {"quad4": lying.cells["quad4"][:, ::-1]})
    mesh = vv.Mesh(np.stack([x, y, 0 * x], axis=1), lying.cells).merged(up, weld=1e-9)
    shell = vv.ExtensibleShell(
        mesh=mesh, section=section, formulation=formulation, kinks=kinks, first=(1, 0, 0)
    )
    X = shell.points
    y, z = np.abs(X[:, 1]) < 1e-12, np.abs(X[:, 2]) < 1e-12
    held = [
        vv.SymmetryPlane(solid=shell, nodes=np.flatnonzero(X[:, 0] == 0), normal=(1, 0, 0)),
        vv.Fixed(solid=shell, nodes=np.flatnonzero(y), directions=(False, True, False)),
        vv.Fixed(solid=shell, nodes=np.flatnonzero(z), directions=(False, False, True)),
    ]
    pull = vv.Prescribed(
        solid=shell,
        nodes=np.flatnonzero(X[:, 0] == SIZE[0]),
        motion=lambda t, X: np.outer(0.4 * t * X[:, 0], (1.0, 0.0, 0.0)),
        directions=(True, False, False),
    )
    system = vv.System([shell, *held, pull])
    vv.quasi_static(system, until=1.0, step=0.25)
    u = shell.displacements(system.x)
    np.testing.assert_allclose(u, X * (0.4, narrow, narrow), atol=1e-9)
    np.testing.assert_allclose(shell.at_points("thickness", system.x), 0.1 * thin, atol=1e-10)


@pytest.mark.parametrize("poisson", [0.4999, 0.5])
def test_a_rubber_sheet_keeps_its_volume(poisson: float) -> None:
    """Mixed: at 1.4 times the length, width and thickness shrink by 1.4^-1/2, and mu (1.4^2 - 1/1.4) / 1.4 pulls."""
    rubber = vv.NeoHooke(shear=1.0, poisson=poisson)
    shell, system = sheet(vv.SolidSection(material=rubber, thickness=0.1), formulation="mixed")
    np.testing.assert_allclose(
        shell.directors(system.x)[:, 2], 1.4**-0.5, rtol=3e-4 if poisson < 0.5 else 1e-10
    )
    pull = shell.resultants(system.x)[..., 0] * 1.4  # P = F S
    np.testing.assert_allclose(pull, 0.1 * (1.4 - 1.4**-2), rtol=1e-3 if poisson < 0.5 else 1e-9)


@pytest.mark.parametrize(
    "material",
    [
        vv.NeoHooke(shear=1.0, bulk=20.0, isochoric=True, volumetric="logarithmic"),
        vv.NeoHooke(shear=1.0, bulk=20.0, isochoric=True, volumetric="quadratic"),
        vv.NeoHooke(shear=1.0, bulk=20.0, isochoric=True, volumetric="simo"),
        vv.SaintVenantKirchhoff(young=3.0, poisson=0.45),
        vv.BlatzKo(young=3.0, poisson=0.45),
    ],
    ids=lambda m: f"{type(m).__name__} {getattr(m, 'volumetric', '')}",
)
def test_pressures_stand_for_the_volumetric_energy(material: vv.Material) -> None:
    """In an even stretch the mixed formulation is that of displacements, and so are its stresses."""
    section = vv.SolidSection(material=material, thickness=0.1)
    (mixed, x), (plain, y) = (
        (s, of.x) for s, of in (sheet(section, 0.2, formulation="mixed"), sheet(section, 0.2))
    )
    np.testing.assert_allclose(mixed.green(x)[0], plain.green(y)[0], atol=1e-9)
    np.testing.assert_allclose(mixed.stresses(x)[0], plain.stresses(y)[0], atol=1e-8)
    C = plain.green(y)[0]
    np.testing.assert_allclose(second_piola(material, C, None), plain.stresses(y)[0], atol=1e-12)


# --- layers ---------------------------------------------------------------------------------------------------
def test_angles_turn_the_material() -> None:
    """Fibres turned by the angle of their layer, and a layer that is turned, are one."""
    c, s = np.cos(np.radians(30)), np.sin(np.radians(30))
    turned: Any = tuple((c * a - s * b, s * a + c * b, 0.0) for a, b, _ in FIBRES)
    there = vv.HolzapfelGasserOgden(shear=10.0, k1=5.0, k2=1.2, bulk=80.0, fibres=turned, dispersion=0.1)
    layers = (vv.SolidLayer(material=TISSUE, thickness=0.1, angle=30.0),)
    shell, system = sheet(vv.SolidLaminate(layers=layers))
    other, reference = sheet(vv.SolidSection(material=there, thickness=0.1))
    n = 6 * shell.grid.n_nodes
    np.testing.assert_allclose(system.x[:n], reference.x[:n], atol=1e-10)
    np.testing.assert_allclose(shell.resultants(system.x), other.resultants(reference.x), atol=1e-8)


def test_layers_bend_as_a_laminate_does() -> None:
    """Stiff layers on one side of a soft one, thin, without contraction: the tip of a cantilever as by `Laminate`."""

    def tip(kind: Any, section: Any) -> float:
        shell = kind(mesh=vv.RectangleMesh(size=(10, 1), counts=(8, 1)), section=section)
        load = vv.Traction(solid=shell, faces="x1", traction=(0, 0, 1e-6))
        system = vv.System([shell, vv.Clamped(solid=shell, nodes="x0"), load])
        vv.quasi_static(system, until=1.0, step=1.0)
        return float(shell.displacements(system.x)[shell.nodes("x1"), 2].mean())

    stack = [(1e3, 0.02), (1e2, 0.05), (3e3, 0.01)]
    layers = [
        vv.SolidLayer(material=vv.SaintVenantKirchhoff(young=E, poisson=0.0), thickness=t) for E, t in stack
    ]
    plies = [vv.Ply(young=E, poisson=0.0, thickness=t) for E, t in stack]
    found = tip(vv.ExtensibleShell, vv.SolidLaminate(layers=tuple(layers), offset=0.01))
    assert found == pytest.approx(tip(vv.Shell, vv.Laminate(plies=tuple(plies), offset=0.01)), rel=2e-4)


def test_sections_by_cell() -> None:
    """A bar of two thicknesses stretches by its halves, force over stiffness."""
    flat = vv.RectangleMesh(size=(2, 1), counts=(2, 1))
    steel = vv.SaintVenantKirchhoff(young=1e6, poisson=0.0)
    sections = tuple(vv.SolidSection(material=steel, thickness=t) for t in (0.1, 0.2))
    shell = vv.ExtensibleShell(mesh=flat, section=sections)
    load = vv.Traction(solid=shell, faces="x1", traction=(1.0, 0, 0))
    system = vv.System([shell, vv.Clamped(solid=shell, nodes="x0"), load])
    vv.quasi_static(system, until=1.0, step=1.0)
    found = shell.displacements(system.x)[:, 0]
    np.testing.assert_allclose(np.unique(found.round(9)), (0, 1e-5, 1.5e-5), rtol=1e-4, atol=1e-9)


# --- bad input ------------------------------------------------------------------------------------------------
FLAT = vv.RectangleMesh(size=(1, 1), counts=(1, 1))
RIGID = vv.NeoHooke(shear=1.0, poisson=0.5)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: vv.SolidSection(material=vv.LinearElastic(young=1.0, poisson=0.3), thickness=0.1), "Kirchhoff"),
        (lambda: vv.SolidLaminate(layers=()), "needs a layer"),
        (lambda: shell_of(RIGID), "incompressible, .* use formulation='mixed'"),
        (lambda: shell_of(EVERY["user"], formulation="mixed"), "take 'displacement'"),
        (lambda: shell_of(EVERY["user"], EVERY["Yeoh"]), "stands alone in a shell"),
        (lambda: shell_of(EVERY["Yeoh"], thickness=3.0, mesh=ROUND), "exceeds the radius of curvature in cell"),
        (lambda: vv.SolidSection(material=RIGID, thickness=-1.0), "thickness"),
        (lambda: shell_of(EVERY["Yeoh"], membrane="enhanced"), "is for vv.Shell"),
        (lambda: shell_of(EVERY["Yeoh"], mesh=FLAT.build().quadratic("quad9")), "those of quad9"),
    ],
)  # fmt: skip
def test_refused(make: Any, message: str) -> None:
    with pytest.raises(vv.InputError, match=message):
        make()


def shell_of(*materials: Any, thickness: float = 0.1, mesh: Any = FLAT, **options: Any) -> vv.ExtensibleShell:
    layers = tuple(vv.SolidLayer(material=m, thickness=thickness) for m in materials)
    return vv.ExtensibleShell(mesh=mesh, section=vv.SolidLaminate(layers=layers), **options)


def rounded() -> vv.Mesh:
    flat = vv.RectangleMesh(size=(1, 1.2), counts=(4, 4)).build()
    y, a = flat.points.T
    return vv.Mesh(np.stack([np.sin(a), y, np.cos(a)], axis=1), flat.cells)


ROUND = rounded()


@pytest.mark.parametrize("thickness", [1e-3, 1e-4])
def test_small_load_steps_of_thin_shells_are_found_to_rounding(thickness: float) -> None:
    """A ring under pressure widens by p R^2 / (E t), here by 1e-5 of its radius: increments end at rounding."""
    built = vv.RectangleMesh(size=(1.0, np.pi / 2), counts=(2, 16), cell="quad4").build()
    y, angle = built.points.T
    points = np.stack([np.sin(angle), y, np.cos(angle)], axis=1)
    shell = vv.ExtensibleShell(
        mesh=vv.Mesh(points, built.cells, face_sets=built.face_sets),
        section=vv.SolidSection(material=vv.NeoHooke(young=1e9, poisson=0.3), thickness=thickness),
    )
    held = [("y0", (1, 0, 0)), ("y1", (0, 0, 1)), ("x0", (0, 1, 0))]
    planes = [vv.SymmetryPlane(solid=shell, nodes=nodes, normal=normal) for nodes, normal in held]
    push = vv.Pressure(solid=shell, faces="upper", pressure=f"{1e4 * thickness}*t")
    system = vv.System([shell, *planes, push])
    vv.quasi_static(system, until=1.0, step=1.0)
    moves = shell.displacements(system.x)
    widening = moves[:, 0] * points[:, 0] + moves[:, 2] * points[:, 2]
    assert float(np.abs(widening).mean()) == pytest.approx(1e-5, rel=0.03)
