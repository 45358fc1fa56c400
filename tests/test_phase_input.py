"""Phase fields that are refused, and runs that leave their domain."""

from __future__ import annotations

import copy
import re
from typing import Any

import numpy as np
import pytest

import visviva as vv

SQUARE = vv.RectangleMesh(size=(4, 4), counts=(8, 8))


def body(**options: Any) -> vv.CahnHilliard:
    given = {
        "mesh": SQUARE,
        "free_energy": vv.DoubleWell(barrier=1.0),
        "gradient_energy": 2.0,
        "concentration": 0.5,
        "name": "alloy",
        **options,
    }
    return vv.CahnHilliard(**given)


def arrhenius(**options: Any) -> vv.ArrheniusMobility:
    return vv.ArrheniusMobility(**{"base": 2.0, "activation": 50e3, "temperature": 300.0, **options})


@pytest.mark.parametrize(
    ("mesh", "spacing"),
    [
        (vv.RectangleMesh(size=(4, 1), counts=(4, 2), cell="tri3"), 1.0),
        (vv.RectangleMesh(size=(4, 1), counts=(4, 2), cell="tri6"), 0.5),
        (vv.RectangleMesh(size=(4, 1), counts=(4, 2)), 1.0),
        (vv.BoxMesh(size=(4, 1, 1), counts=(4, 2, 2)), 1.0),
        (vv.BoxMesh(size=(1, 1, 1), counts=(4, 4, 4), cell="tet4"), 0.25 * np.sqrt(2)),
    ],
)
def test_nodes_are_as_far_apart_as_a_grid_has_them(mesh: Any, spacing: float) -> None:
    """Diagonals of a grid cut into triangles are not counted, one of three of tetrahedra is."""
    assert body(mesh=mesh, gradient_energy=100.0).space.spacing == pytest.approx(spacing, rel=1e-12)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: body(mobility=-2.0), "CahnHilliard 'alloy': mobility = -2 is not positive"),
        (lambda: body(gradient_energy=-1.0), "CahnHilliard 'alloy': gradient_energy = -1.0 is not positive"),
        (
            lambda: body(gradient_energy=[1.0, 1.0, -2.0]),
            "gradient_energy = [1.0, 1.0, -2.0] is not positive",
        ),
        (lambda: body(gradient_energy=5e-324), "a gradient_energy of 0.125 at least"),
        (lambda: body(gradient_energy=0.01), "an interface is 0.283 wide, the distance of its nodes 0.5"),
        (lambda: body(concentration=lambda X: X), "its concentration has shape (81, 3)"),
        (
            lambda: body(free_energy=vv.FloryHuggins(chi=3.0), concentration=lambda X: X[:, 0]),
            "its concentration is 0 at (0, 0, 0), outside of the logarithms of FloryHuggins, which hold",
        ),
        (lambda: body(periodic=[("x0", "y1")]), "do not meet those of 'y1'"),
        (lambda: body(periodic=[("x0", "x0")]), "is no pair of two sets of faces"),
        (lambda: body(periodic=[("x0", "x9")]), "no set of faces 'x9'"),
        (lambda: body(thickness=0.0), "thickness = 0 is not positive"),
        (lambda: arrhenius(temperature=-3.0), "temperature = -3 is not positive"),
        (lambda: arrhenius(activation=-1.0), "activation = -1 is negative"),
        (lambda: arrhenius(base=-1.0), "ArrheniusMobility: mobility = -1 is not positive"),
        (lambda: arrhenius(activation=5e7), "nothing moves at temperature = 300"),
        (
            lambda: body(
                free_energy=vv.UserFreeEnergy(function=lambda c: np.where(c > 0.5, c**2, np.nan)),
                concentration=lambda X: 0.4 + 0.2 * (X[:, 0] > 0),
            ),
            "CahnHilliard 'alloy': UserFreeEnergy: it returned [nan] at the strains [0.4]; it starts between 0.4 and "
            "0.6: let it have values there and in between, or take vv.FloryHuggins",
        ),
        (lambda: vv.DegenerateMobility(scale=-1.0), "scale = -1 is not positive"),
        (lambda: vv.UserMobility(function=lambda c: c - 0.5), "it is -0.5 at c = 0; it must not be negative"),
        (lambda: vv.UserMobility(function=lambda c: np.abs(c - 0.5)), "a polynomial of degree 7 off by"),
        (lambda: vv.Wetting(body=body(), faces="y0"), "give either an angle or an energy"),
        (lambda: vv.Wetting(body=body(), faces="y0", angle=200.0), "angle = 200 is not between 0 and 180"),
        (
            lambda: vv.Wetting(body=body(free_energy=vv.FloryHuggins(chi=1.0)), faces="y0", angle=20.0),
            "has no two phases",
        ),
        (lambda: vv.Wetting(body=body(), faces="y0", energy=vv.FloryHuggins(chi=1.0)), "is a polynomial"),
        (
            lambda: vv.PrescribedConcentration(body=body(), nodes="z0", value=1.0),
            "no set of nodes or faces 'z0'",
        ),
    ],
)
def test_refusals(make: Any, words: str) -> None:
    with pytest.raises(vv.InputError, match=re.escape(words)):
        make()


def test_leaving_the_logarithms() -> None:
    """A source that fills a mixture up: the step fails with the place, and the state before it stays."""
    mixture = body(free_energy=vv.FloryHuggins(chi=1.0), concentration=0.9)
    system = vv.System([mixture, vv.ConcentrationSource(body=mixture, rate=1.0)])
    with pytest.raises(vv.RunError, match="alloy") as error:
        vv.simulate(system, until=1.0, step=0.03)
    assert "leaves the domain" in str(error.value) or "outside of the logarithms" in str(error.value)
    assert mixture.values(system.x).max() < 1
    assert 0.09 <= system.time < 0.1


def test_iterations_come_back_from_outside() -> None:
    """Quenches press compositions towards the ends; Newton's iterates would go beyond them."""
    rng = np.random.default_rng(1)
    mixture = body(
        free_energy=vv.FloryHuggins(chi=3.5), concentration=lambda X: 0.5 + 0.05 * rng.standard_normal(len(X))
    )
    system = vv.System([mixture])
    result = vv.simulate(system, until=6.0, step=0.2)
    assert np.all(np.diff(result.ledger["potential_stored"]) < 0)
    c = mixture.values(system.x)
    assert 0 < c.min() < 0.1 < 0.9 < c.max() < 1


@pytest.mark.parametrize(("cell", "told"), [("quad4", False), ("quad9", True)])
def test_deep_quenches_are_told_where_nodes_may_leave(cell: str, told: bool) -> None:
    mesh = vv.RectangleMesh(size=(4, 4), counts=(8, 8), cell=cell)
    remarks = body(mesh=mesh, free_energy=vv.FloryHuggins(chi=7.0), gradient_energy=6.0).remarks()
    assert bool(remarks) == told
    assert all("take a mesh of cells without nodes between their corners" in r for r in remarks)


@pytest.mark.parametrize("corner", [0.4999, 0.496])
def test_corners_that_are_nearly_straight_are_no_points_of_quadrature(corner: float) -> None:
    """Energies without logarithms do not need them; neither do triangles."""
    points = np.array([(0.0, 0.0), (1.0, 0.0), (1 - corner, 1 - corner), (0.0, 1.0)])
    quad = vv.Mesh(points, {"quad4": np.array([[0, 1, 2, 3]])})
    halves = vv.Mesh(points, {"tri3": np.array([[0, 1, 2], [0, 2, 3]])})
    given: dict[str, Any] = {"gradient_energy": 20.0, "concentration": 0.5, "name": "blend"}
    with pytest.raises(
        vv.InputError, match=r"'blend': the mesh has a quad4 whose corner at \[0.5.* nearly straight"
    ):
        vv.CahnHilliard(mesh=quad, free_energy=vv.FloryHuggins(chi=3.0), **given)
    vv.CahnHilliard(mesh=quad, free_energy=vv.DoubleWell(barrier=5.0), **given)
    vv.CahnHilliard(mesh=halves, free_energy=vv.FloryHuggins(chi=3.0), **given)


@pytest.mark.parametrize("kind", ["box", "splines", "surface"])
def test_thickness_is_for_planes(kind: str) -> None:
    meshes: dict[str, Any] = {
        "box": vv.BoxMesh(size=(4, 4, 4), counts=(8, 8, 8)),
        "splines": vv.SplineBox(size=(4, 4, 4), counts=(8, 8, 8), degree=2),
        "surface": vv.SphereMesh(radius=2.0, counts=(3, 2)).build().surface("outer"),
    }
    given: dict[str, Any] = {"mesh": meshes[kind], "free_energy": vv.DoubleWell(barrier=1.0)}
    for made, quantity in ((vv.CahnHilliard, {"concentration": 0.5}), (vv.AllenCahn, {"order": 0.5})):
        made(**given, gradient_energy=2.0, **quantity)
        with pytest.raises(vv.InputError, match="thickness is for plane meshes; leave it out"):
            made(**given, gradient_energy=2.0, thickness=3.0, **quantity)


@pytest.mark.parametrize("density", [0.0, 1.0])
def test_statics_needs_to_know_how_much_there_is(density: float) -> None:
    """Load steps have no rates that keep the amount, and equilibria lost it; where it is held somewhere they serve."""

    def alloy() -> vv.MixtureSolid:
        return vv.MixtureSolid(
            mesh=vv.RectangleMesh(size=(8, 8), counts=(4, 4)),
            material=vv.SaintVenantKirchhoff(young=100.0, poisson=0.3),
            density=density,
            free_energy=vv.DoubleWell(barrier=5.0, low=0.3, high=0.7),
            gradient_energy=20.0,
            concentration=0.5,
            eigenstrain=0.05,
            reference=0.5,
        )

    mixture = body(name="blend", gradient_energy=20.0)
    for analysis in (lambda s: vv.quasi_static(s, until=1.0, step=1.0), vv.equilibrium):
        solid = alloy()
        with pytest.raises(
            vv.InputError, match=r"MixtureSolid.*: nothing holds how much concentration there is"
        ):
            analysis(vv.System([solid, vv.Fixed(solid=solid, nodes="x0")]))
        with pytest.raises(vv.InputError, match="CahnHilliard 'blend': nothing holds how much"):
            analysis(vv.System([copy.deepcopy(mixture)]))
        kept = vv.AllenCahn(
            mesh=vv.RectangleMesh(size=(8, 2), counts=(16, 4)),
            free_energy=vv.DoubleWell(barrier=1.0),
            gradient_energy=1.0,
            order=0.4,
            conserved=True,
        )
        with pytest.raises(vv.InputError, match=r"AllenCahn.*order is conserved by its rates.* vv\.simulate"):
            analysis(vv.System([kept]))
        blend = copy.deepcopy(mixture)
        system = vv.System([blend, vv.PrescribedConcentration(body=blend, nodes="x0", value=0.7)])
        analysis(system)
        assert np.ptp(blend.potentials(system.x)) < 1e-12


@pytest.mark.parametrize("later", [False, True])
def test_concentrations_that_contradict_each_other_at_an_edge_are_refused(later: bool) -> None:
    """As unlike temperatures are; those that agree are held, whichever comes first."""

    def system(second: Any) -> vv.System:
        alloy = body(free_energy=vv.PolynomialEnergy(coefficients=(0, 0, 0.5)))
        left = vv.PrescribedConcentration(body=alloy, nodes="x0", value=0.3, name="left")
        below = vv.PrescribedConcentration(body=alloy, nodes="y0", value=second, name="below")
        return vv.System([alloy, left, below])

    held = system(lambda t, X: 0.3 + 0.1 * X[:, 0])
    vv.simulate(held, until=0.2, step=0.1)
    assert held.components[0].values(held.x)[0] == pytest.approx(0.3, rel=1e-12)
    words = "hold the same place of CahnHilliard 'alloy', at concentrations of "
    if later:
        with pytest.raises(vv.RunError, match=words + ".* at t = 0.1: give both the same"):
            vv.simulate(system("0.3 + 3*t"), until=0.2, step=0.1)
    else:
        with pytest.raises(vv.InputError, match=words + "0.3 and 0.6 at t = 0: give both the same"):
            system(0.6)


def test_what_excludes_each_other_fills_one_volume() -> None:
    """The energy of both would be that of the first one's thickness."""
    grains = [
        vv.AllenCahn(
            mesh=SQUARE,
            free_energy=vv.DoubleWell(barrier=1.0),
            gradient_energy=2.0,
            order=0.5,
            thickness=thickness,
            name=f"grain {thickness:g}",
        )
        for thickness in (1.0, 2.0)
    ]
    with pytest.raises(
        vv.InputError, match=r"'grain 1' has thickness = 1, AllenCahn 'grain 2' 2: .*give both"
    ):
        vv.Exclusion(bodies=grains, strength=1.5)


def test_what_excludes_each_other_is_periodic_alike() -> None:
    """Nodes of one were taken for those of the other, by the order of the bodies."""
    grains = [
        vv.AllenCahn(
            mesh=vv.RectangleMesh(size=(1, 1), counts=(4, 4)),
            free_energy=vv.PolynomialEnergy(coefficients=(0.0, 0.0, -0.5, 0.0, 0.25)),
            gradient_energy=0.5,
            order=0.5,
            periodic=[sides],
        )
        for sides in (("x0", "x1"), ("y0", "y1"))
    ]
    with pytest.raises(vv.InputError, match="not on the same mesh, with the same periodic sides"):
        vv.Exclusion(bodies=grains, strength=1.0)


def test_edges_of_a_surface_in_space_are_no_faces() -> None:
    plate = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2)).build().surface("z1")
    skin = body(mesh=plate)
    with pytest.raises(vv.InputError, match="edges of a surface in space are no faces"):
        vv.System([skin, vv.Wetting(body=skin, faces="all", angle=60.0)])


@pytest.mark.parametrize("other", [{"faces": "y0"}, {"faces": "all"}, {"faces": "y0", "energy": True}])
def test_a_wall_has_one_angle(other: dict[str, Any]) -> None:
    """The energies of both added up: 60 degrees and 120 on all walls met the first at 75."""
    mixture = body()
    energy = vv.PolynomialEnergy(coefficients=(0.0, 0.1)) if other.pop("energy", False) else None
    given: Any = {"energy": energy} if energy else {"angle": 120.0}
    walls = [vv.Wetting(body=mixture, faces="y0", angle=60.0), vv.Wetting(body=mixture, **other, **given)]
    with pytest.raises(
        vv.InputError, match=r"has some of its faces, and the energies of both add up: angle = "
    ):
        vv.System([mixture, *walls])
    vv.System([mixture := body(), *(vv.Wetting(body=mixture, faces=f, angle=60.0) for f in ("y0", "y1"))])


def test_starts_that_differ_between_periodic_faces_are_named() -> None:
    """Nodes there are one: the mean was that of one side alone."""
    sides: Any = [("x0", "x1")]
    slope = body(periodic=sides, concentration=lambda X: 0.4 + 0.2 * X[:, 0] / X[:, 0].max())
    (remark,) = vv.System([slope]).check(repair=False).remarks
    assert "at the start differs by up to 0.2 between nodes of periodic faces" in remark
    wave = body(
        periodic=sides, concentration=lambda X: 0.5 + 0.1 * np.sin(2 * np.pi * X[:, 0] / X[:, 0].max())
    )
    assert vv.System([wave]).check(repair=False).remarks == []


def test_ties_say_that_concentrations_end_there() -> None:
    """Heat has its HeatTie, a concentration nothing."""

    def half(x: float) -> vv.MixtureSolid:
        return vv.MixtureSolid(
            mesh=vv.RectangleMesh(size=(2, 1), counts=(4, 2), origin=(x, 0)),
            material=vv.SaintVenantKirchhoff(young=100.0, poisson=0.3),
            free_energy=vv.PolynomialEnergy(coefficients=(0, 0, 1.0)),
            gradient_energy=0.1,
            concentration=0.5,
            eigenstrain=0.01,
            reference=0.5,
            mobility=1.0,
        )

    a, b = half(0.0), half(2.0)
    tie = vv.Tie(first=a, first_faces="x1", second=b, second_faces="x0")
    for parts in ([a, b, tie], [tie, a, b]):
        (remark,) = vv.System(parts).check(repair=False).remarks
        assert "the concentrations of MixtureSolid" in remark
