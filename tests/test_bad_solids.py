"""Bad input of solids is refused with name, value and cure; what goes wrong in a step says where."""

from __future__ import annotations

import warnings
from functools import partial
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]

MATERIAL = vv.NeoHooke(young=100.0, poisson=0.3)
BOX = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2))


def block(**options: Any) -> vv.Solid:
    return vv.Solid(**({"mesh": BOX, "material": MATERIAL, "density": 1.0, "name": "block"} | options))


# --- elements turned inside out -------------------------------------------------------------------------------
def test_inverted_elements_in_the_mesh() -> None:
    mesh = BOX.build()
    points = mesh.points.copy()
    points[np.argmin(np.abs(points - 0.5).max(axis=1))] = (0.9, 0.9, 1.3)  # the middle of all
    with pytest.raises(
        vv.InputError, match=r"Solid 'block': .*hex8 .*inverted.*cell \d+.*at \(.*Mesh the place anew"
    ):
        block(mesh=vv.Mesh(points, mesh.cells))


def squeezed() -> vv.System:
    """A lid that goes through the floor."""
    solid = block()
    lid = vv.Prescribed(solid=solid, nodes="z1", motion=(None, None, "-1.5*smoothstep(t)"))
    return vv.System([solid, vv.Fixed(solid=solid, nodes="z0"), lid])


NAMED = r"element \d of Solid 'block' near \(.*\) is (inverted|nearly flat) \(det F = .*\)"


@pytest.mark.parametrize(
    ("run", "error", "advice"),
    [
        (vv.simulate, vv.StepFailure, "Try a smaller step"),
        (
            partial(vv.quasi_static, scheme=vv.Static(unstable=True)),
            vv.NoEquilibrium,
            "mesh the place finer.*last equilibrium",
        ),
    ],
)
def test_steps_that_invert_elements_are_cut_and_name_them(run: Any, error: Any, advice: str) -> None:
    system = squeezed()
    with pytest.raises(error, match=rf"{NAMED}.*{advice}"):
        run(system, until=1.0, step=0.1)
    assert system.stepper.rejected > 5
    assert 0.3 < system.time < 0.7
    assert system.components[0].fields(system.x).J.min() > 0  # the last accepted state


def test_a_step_that_is_too_long_is_cut_and_goes_on() -> None:
    """A block thrown at a soft wall of springs: long steps would turn its elements inside out."""
    solid = block(velocity=lambda X: -8.0 * X[:, [2]] * ((0.0, 0.0, 1.0),))
    system = vv.System([solid, vv.Fixed(solid=solid, nodes="z0")])
    result = vv.simulate(system, until=0.6, step=0.2)
    assert result.statistics.rejected > 0
    assert system.time == pytest.approx(0.6)
    assert solid.fields(system.x).J.min() > 0
    assert result.conservation()["energy"] < 1e-9


# --- materials ------------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("constants", "words"),
    [
        ({"young": 1.0, "poisson": 0.7}, r"poisson = 0.7"),
        ({"young": 1.0, "poisson": -1.0}, r"poisson = -1 is outside -1 ... 0.5"),
        ({"young": -2.0, "poisson": 0.3}, r"shear modulus -0.769231.*'young': -2.0.*must be positive"),
        ({"shear": 1.0, "bulk": -1.0}, r"bulk modulus -1.*must be positive"),
        ({"young": 10.0, "bulk": 1.0}, r"shear modulus.*must be positive"),
        ({"young": float("nan"), "poisson": 0.3}, r"young.*finite.*nan"),
        ({"young": 1.0}, r"exactly two of young, poisson.*given are \['young'\]"),
    ],
)
@pytest.mark.parametrize("kind", [vv.LinearElastic, vv.SaintVenantKirchhoff, vv.NeoHooke])
def test_elastic_constants_outside_their_range(kind: Any, constants: dict[str, float], words: str) -> None:
    with pytest.raises(vv.InputError, match=rf"{kind.__name__}: .*{words}"):
        kind(**constants)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (
            lambda: vv.MooneyRivlin(c10=-1.0, c01=0.2, bulk=1.0),
            r"MooneyRivlin: c10 \+ c01 = -0.8 is not positive",
        ),
        (lambda: vv.Yeoh(c1=-1.0, c2=0.0, c3=0.0, bulk=1.0), r"Yeoh: .*c1.*-1"),
        (lambda: vv.Gent(shear=1.0, limit=-3.0, bulk=1.0), r"Gent: .*limit.*-3"),
        (lambda: vv.Ogden(mu=(1.0,), alpha=(-2.0,), bulk=1.0), r"Ogden: .*not positive"),
    ],
)
def test_rubber_outside_its_range(make: Any, words: str) -> None:
    with pytest.raises(vv.InputError, match=words):
        make()


@pytest.mark.parametrize("kind", [vv.LinearElastic, vv.SaintVenantKirchhoff, vv.NeoHooke])
def test_incompressible_materials_need_pressures(kind: Any) -> None:
    with pytest.raises(
        vv.InputError, match=r"Solid 'block': its material is incompressible.*formulation='mixed'"
    ):
        block(material=kind(young=1.0, poisson=0.5))


@pytest.mark.parametrize("name", ["density", "mass_damping", "stiffness_damping"])
def test_negative_parameters_of_a_solid(name: str) -> None:
    with pytest.raises(vv.InputError, match=rf"Solid 'block': {name} = -1 is negative"):
        block(**{name: -1.0})


# --- energies in Python ---------------------------------------------------------------------------------------
def sound(C: Array) -> Array:
    energy: Array = (C[0] - 1) ** 2 + (C[1] - 1) ** 2 + (C[2] - 1) ** 2 + C[3] ** 2 + C[4] ** 2 + C[5] ** 2
    return energy


@pytest.mark.parametrize(
    ("energy", "words"),
    [
        (lambda C: np.log(C[0] - 5), r"returned \[nan\] at the strains \[1.0, 1.0, 1.0, 0.0, 0.0, 0.0\]"),
        (lambda C: C, r"returned shape \(6, 1\).*expected \(1,\)"),
        (lambda C: C[7], r"raised IndexError: index 7"),
        (
            lambda C: sound(C) + abs(C[0] - 1),
            r"kink near C = \[1.0000.*uniaxial.*jumps by about.*round it off",
        ),
        (lambda C: sound(C) + 0.01 * abs(C[0] - 1.137), r"kink near C = \[1.13[67]"),
        (lambda C: sound(C) + abs(C[3] + 0.1), r"kink near C = .*shear"),
    ],
)
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_energies_that_cannot_be_used(energy: Any, words: str) -> None:
    with pytest.raises(vv.InputError, match=rf"UserMaterial, its energy: it .*{words}"):
        vv.UserMaterial(function=energy)


def test_an_energy_with_a_stress_at_rest_is_warned_of() -> None:
    with pytest.warns(UserWarning, match=r"stress at rest is \[0.2, 0.0, 0.0, 0.0, 0.0, 0.3\].*prestressed"):
        vv.UserMaterial(function=lambda C: sound(C) + 0.1 * C[0] + 0.3 * C[5])


@pytest.mark.parametrize(
    "energy",
    [
        sound,
        lambda C: sound(C) + np.maximum(C[0] - 1, 0) ** 2,  # fibres that bear tension alone
        lambda C: sound(C) + np.exp(30 * (C[0] - 1) ** 2),
        lambda C: sound(C) + np.where(np.real(C[0]) < 1.2, 0.0, np.nan),  # not defined everywhere
    ],
)
def test_energies_that_can_be_used(energy: Any) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        vv.UserMaterial(function=energy)


def test_an_energy_that_fails_later_says_at_which_strains() -> None:
    def energy(C: Array) -> Array:
        return np.where(np.real(C[2]) > 0.9, sound(C), np.nan)

    solid = block(material=vv.UserMaterial(function=energy))
    load = vv.Traction(solid=solid, faces="z1", traction=(0, 0, -3.0), times="t")
    system = vv.System([solid, vv.Fixed(solid=solid, nodes="z0"), load])
    with pytest.raises(
        vv.RunError, match=r"Solid 'block': energy of its material: it returned \[nan\] at the strains"
    ):
        vv.simulate(system, until=1.0, step=0.05)


# --- meshes and sets ------------------------------------------------------------------------------------------
CORNERS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]


@pytest.mark.parametrize(
    ("points", "cells", "words"),
    [
        (CORNERS, {"tetra": [(0, 1, 2, 3)]}, r"no cell type 'tetra'; did you mean 'tet4'"),
        (
            CORNERS,
            {"tet4": [(0, 1, 2, 3)], "tri3": [(0, 1, 2)]},
            r"Solid 'block': the mesh mixes cells.*tri3 \(2D\)",
        ),
        (
            CORNERS[:3],
            {"tri3": [(0, 1, 2)]},
            r"Solid 'block': .*tri3 of dimension 2 in 3 dim.*points \(n, 2\)",
        ),
        ([(0, 0), (1, 0)], {"line2": [(0, 1)]}, r"Solid 'block': .*line2 of dimension 1"),
        (CORNERS, {"tet4": [(0, 1, 2, 9)]}, r"node 9|9"),
    ],
)
def test_cells_that_make_no_solid(points: Any, cells: Any, words: str) -> None:
    with pytest.raises(vv.InputError, match=words):
        block(mesh=vv.Mesh(points, cells))


@pytest.mark.parametrize(
    ("make", "label"),
    [
        (lambda b, s: vv.Fixed(solid=b, nodes=s), "Fixed"),
        (lambda b, s: vv.Prescribed(solid=b, nodes=s, motion=(0, 0, 0)), "Prescribed"),
        (lambda b, s: vv.SymmetryPlane(solid=b, nodes=s, normal=(1, 0, 0)), "SymmetryPlane"),
        (lambda b, s: vv.Traction(solid=b, faces=s, traction=(1, 0, 0)), "Traction"),
        (lambda b, s: vv.Pressure(solid=b, faces=s, pressure=1.0), "Pressure"),
        (lambda b, s: vv.ElasticFoundation(solid=b, faces=s, normal=1.0), "ElasticFoundation"),
        (lambda b, s: vv.RigidCoupling(solid=b, faces=s), "RigidCoupling"),
        (lambda b, s: vv.DistributedCoupling(solid=b, faces=s), "DistributedCoupling"),
    ],
)
def test_unknown_sets_give_the_nearest(make: Any, label: str) -> None:
    mesh = BOX.build().with_faces("wall", lambda X: X[:, 0] < 1e-9)
    solid = block(mesh=mesh)
    with pytest.raises(
        vv.InputError, match=rf"{label}: the mesh has no set .* 'walls'; did you mean 'wall'\?"
    ):
        make(solid, "walls")


def test_numbers_of_nodes_that_do_not_exist() -> None:
    with pytest.raises(vv.InputError, match=r"Fixed: Solid 'block': there is no node 27"):
        vv.Fixed(solid=block(), nodes=[3, 27])


# --- memory ---------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("run", [vv.simulate, vv.quasi_static])
def test_factors_that_do_not_fit_are_refused_before_they_are_made(run: Any) -> None:
    solid = block(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(6, 6, 6)))
    load = vv.Traction(solid=solid, faces="z1", traction=(0, 0, 1), times="t")
    parts = [solid, vv.Fixed(solid=solid, nodes="z0"), load]
    system = vv.System(parts, vv.Newton(linear=vv.Direct(memory_limit=1e5)))
    with pytest.raises(vv.InputError, match=r"tangent of \d+ equations needs about .* GB.*Iterative"):
        run(system, until=1.0, step=0.5)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: vv.MaxwellBranch(time=-1.0), "MaxwellBranch: time = -1 is not positive"),
        (lambda: vv.MaxwellBranch(time=1.0, share=0.0), "MaxwellBranch: share = 0 is not positive"),
        (lambda: vv.MaxwellBranch(time=np.inf), "MaxwellBranch: time: input should be a finite number"),
        (lambda: vv.prony((0.5, 0.5), (1.0, 2.0)), "sum 1 leaves nothing for long times"),
        (lambda: vv.prony((0.5, -0.1), (1.0, 2.0)), "must all be positive"),
        (lambda: vv.prony((0.5,), (1.0, 2.0)), "1 fractions and 2 times"),
        (lambda: relaxing(branches=[]), "ViscoelasticSolid 'block': branches is empty"),
        (
            lambda: relaxing(formulation="enhanced"),
            "formulation = 'enhanced' has strains that branches do not see",
        ),
        (lambda: relaxing(thermal_strain=0.1), "ViscoelasticSolid 'block': takes no thermal_strain"),
        (
            lambda: relaxing(material=vv.LinearElastic(young=1.0, poisson=0.3)),
            "ViscoelasticSolid 'block': a MaxwellBranch has no spring of LinearElastic; give spring=vv.NeoHooke",
        ),
    ],
)
def test_branches_outside_their_range(make: Any, words: str) -> None:
    with pytest.raises(vv.InputError, match=words):
        make()


def relaxing(**options: Any) -> vv.ViscoelasticSolid:
    given = {"branches": vv.prony((0.5,), (1.0,)), "material": vv.NeoHooke(young=1.0, poisson=0.3), **options}
    return vv.ViscoelasticSolid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), name="block", **given)


def test_sections_of_what_relaxes_have_no_force() -> None:
    body = relaxing()
    system = vv.System([body])
    with pytest.raises(vv.InputError, match=r"ViscoelasticSolid 'block': the forces of its branches"):
        body.nodal_forces(system.x)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    "support",
    [
        lambda b: vv.SymmetryPlane(solid=b, nodes="x0", normal=(1, 0, 0)),
        lambda b: vv.Fixed(solid=b, nodes="x0"),
    ],
)
def test_nodes_are_held_and_moved_by_one_support_in_any_order(support: Any, turned: bool) -> None:
    mesh, rubber = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), vv.NeoHooke(young=1.0, poisson=0.3)
    block = vv.Solid(mesh=mesh, material=rubber, density=1.0)
    both = [vv.Prescribed(solid=block, nodes="y1", motion=("0.1*t", None, None), name="lid"), support(block)]
    with pytest.raises(
        vv.InputError, match=r"Prescribed 'lid' prescribes position\[.*holds already; take its node"
    ):
        vv.System([block, *(both[::-1] if turned else both)])


def test_solids_in_space_have_no_thickness() -> None:
    mesh, rubber = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), vv.NeoHooke(young=1.0, poisson=0.3)
    with pytest.raises(vv.InputError, match="Solid 'block': thickness is for plane meshes; leave it out"):
        vv.Solid(mesh=mesh, material=rubber, density=1.0, thickness=3.0, name="block")


@pytest.mark.parametrize(
    ("plane", "acceleration", "message"),
    [
        ("strain", (0, 0, -9.81), r"acts along z, .*\(0, -9.81, 0\)"),
        ("axisymmetric", (1.0, 0, 0), "is axisymmetric about y"),
    ],
)
def test_weights_that_act_on_nothing_are_refused(plane: Any, acceleration: Any, message: str) -> None:
    grid = vv.RectangleMesh(size=(1, 1), counts=(1, 1), origin=(0.5, 0))
    body = vv.Solid(mesh=grid, material=vv.LinearElastic(young=1.0, poisson=0.3), density=1.0, plane=plane)
    with pytest.raises(vv.InputError, match=message):
        vv.System([body, vv.Gravity(acceleration=acceleration)])


def test_the_centre_of_mass_of_a_ring_is_on_its_axis() -> None:
    grid = vv.RectangleMesh(size=(1, 2), counts=(1, 1), origin=(0.5, 0))
    steel = vv.LinearElastic(young=1.0, poisson=0.3)
    body = vv.Solid(mesh=grid, material=steel, density=1.0, plane="axisymmetric")
    assert vv.CentreOfMass(of=body)(vv.System([body])) == pytest.approx([0, 1, 0], abs=1e-12)


@pytest.mark.parametrize("axis", [1, 2])
def test_what_is_axisymmetric_does_not_turn(axis: int) -> None:
    """About z its sections got radial velocities, on the axis as well."""
    grid = vv.RectangleMesh(size=(1, 2), counts=(1, 1))
    steel, turning = vv.LinearElastic(young=1.0, poisson=0.3), np.eye(3)[axis]
    body = vv.Solid(
        mesh=grid, material=steel, density=1.0, plane="axisymmetric", angular_velocity=turning, name="disc"
    )
    with pytest.raises(vv.InputError, match=r"Solid 'disc': what is axisymmetric does not turn.*\[0.0, "):
        vv.System([body])
