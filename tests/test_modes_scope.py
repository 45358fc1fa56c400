"""What `modes` supports, against closed forms, supports and ties; and what it refuses by name."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.linalg as sla
import scipy.sparse as sp
from catalogue import CATALOGUE, Entry

import visviva as vv
from visviva.analysis.eigenmodes import balance
from visviva.analysis.factors import factored
from visviva.scheme.schemes import load_step
from visviva.system.instant import Instant, instant

STEEL = vv.NeoHooke(young=1e3, poisson=0.3)
ELASTIC: dict[str, Any] = {"enforcement": "penalty", "tangential": "penalty"}


# --- contact of rigid bodies --------------------------------------------------------------------------------
def box_on_plane(
    friction: float = 0.5, tilt: float = 0.0, gravity: float = 9.81, at: float = 0.5
) -> vv.System:
    """A cube of mass 1 on springs of 1000 under its corners, across and along the plane."""
    box = vv.RigidBody(shape=vv.Box(size=(1, 1, 1)), density=1.0, position=(0, 0, at))
    plane = vv.Plane()
    contact = vv.Contact(
        first=box, second=plane, stiffness=1e3, friction=friction, tangential_stiffness=1e3, **ELASTIC
    )
    weight = vv.Gravity(acceleration=(gravity * np.sin(tilt), 0, -gravity * np.cos(tilt)))
    return vv.System([box, plane, contact, weight])


def test_sticking_box_slides_rocks_and_twists_on_its_springs() -> None:
    system = box_on_plane()
    vv.equilibrium(system)
    k, h = 1e3, 0.5  # stiffness, lever of the corners
    slide_and_rock = [[4 * k, 4 * k * h], [4 * k * h, 4 * k * h**2 + k - 9.81 * h]]
    pair = sla.eigvalsh(slide_and_rock, np.diag([1, 1 / 6]))
    exact = np.sort([*pair, *pair, 4 * k, 2 * k * 6])
    assert vv.modes(system).squared == pytest.approx(exact, rel=1e-9)


def test_four_corners_hold_a_box_as_a_plane_does() -> None:
    """One of them is redundant; left are two ways along the plane and the turn across it, on springs."""
    ground, plane = vv.Ground(), vv.Plane()
    box = vv.RigidBody(shape=vv.Box(size=(1, 1, 1)), density=1.0, position=(0, 0, 0.5))
    hold = vv.Bushing(a=ground, b=box, at=(0, 0, 0.5), stiffness=(5, 7, 1), rotational_stiffness=(1, 1, 3))
    contact = vv.Contact(first=box, second=plane, stiffness=1e3)
    system = vv.System([ground, box, plane, hold, vv.Gravity(), contact])
    vv.equilibrium(system)
    assert vv.modes(system, n=3).squared == pytest.approx([5, 7, 18], rel=1e-6)


@pytest.mark.parametrize("contact", [{**ELASTIC, "stiffness": 1e8}, {"stiffness": 1e8}])
def test_masses_of_an_instant_contain_no_contact(contact: dict[str, Any]) -> None:
    def mass(*more: vv.Component, box: vv.RigidBody) -> np.ndarray:
        system = vv.System([box, *more])
        system.residual(instant(0.0, theta=1.0))  # chooses the active set
        return Instant(system).M.toarray()

    box, plane = vv.RigidBody(shape=vv.Box(size=(1, 1, 1)), density=1.0, position=(0, 0, 0.4)), vv.Plane()
    touching = vv.Contact(first=box, second=plane, friction=0.5, initial="press", **contact)
    alone = vv.RigidBody(shape=vv.Box(size=(1, 1, 1)), density=1.0, position=(0, 0, 0.4))
    assert mass(touching, plane, box=box) == pytest.approx(mass(box=alone), rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("tilt", [0.4, 0.45])
def test_friction_at_its_limit_is_refused(tilt: float) -> None:
    system = box_on_plane(tilt=tilt)
    vv.equilibrium(system)
    with pytest.raises(vv.InputError, match=r"Contact 'contact-1': friction is at Coulomb's limit at 2 of"):
        vv.modes(system)


def test_what_touches_without_pressure_is_refused() -> None:
    with pytest.raises(vv.InputError, match=r"Contact 'contact-1': it touches without pressure at 4 of"):
        vv.modes(box_on_plane(gravity=0.0))


def test_open_contact_counts_as_none() -> None:
    assert vv.modes(box_on_plane(gravity=0.0, at=0.6)).squared.tolist() == [0.0] * 6


# --- contact of solids --------------------------------------------------------------------------------------
def block(counts: tuple[int, int], up: float = 0.0, name: str = "block") -> vv.Solid:
    mesh = vv.RectangleMesh(size=(2, 1), counts=counts).build().moved((0, up))
    return vv.Solid(mesh=mesh, material=STEEL, density=1.0, name=name)


def squares(*components: vv.Component) -> np.ndarray:
    system = vv.System([*components, vv.Gravity(acceleration=(0, -1, 0))])
    vv.quasi_static(system, until=1.0, step=1.0)
    return vv.modes(system, 5).squared


SIZES = [(4, 2), (30, 15)]


@pytest.mark.parametrize("counts", SIZES)
def test_closed_contact_with_a_plane_is_a_support(counts: tuple[int, int]) -> None:
    loose, held, plane = block(counts), block(counts), vv.Plane(normal=(0, 1, 0))
    guide = vv.Fixed(solid=loose, nodes="y0", directions=(True, False, False))
    contact = vv.Contact(first=loose, first_faces="y0", second=plane)
    exact = squares(held, vv.Fixed(solid=held, nodes="y0"))
    assert squares(loose, guide, plane, contact) == pytest.approx(exact, rel=1e-8)


def test_sticking_penalty_is_nearly_a_support() -> None:
    loose, held, plane = block((4, 2)), block((4, 2)), vv.Plane(normal=(0, 1, 0))
    contact = vv.Contact(
        first=loose,
        first_faces="y0",
        second=plane,
        friction=5.0,
        stiffness=1e8,
        tangential_stiffness=1e8,
        **ELASTIC,
    )
    exact = squares(held, vv.Fixed(solid=held, nodes="y0"))
    assert squares(loose, plane, contact) == pytest.approx(exact, rel=1e-4)


def stacked(counts: tuple[int, int], **options: Any) -> np.ndarray:
    """A block on another one; without friction it is guided along."""
    lower, upper = block(counts, name="lower"), block(counts, 1.0, name="upper")
    sides: dict[str, Any] = {"first": upper, "first_faces": "y0", "second": lower, "second_faces": "y1"}
    parts = [lower, upper, vv.Fixed(solid=lower, nodes="y0")]
    if not options:
        return squares(*parts, vv.Tie(**sides))
    if "friction" not in options:
        parts.append(vv.Fixed(solid=upper, nodes="y0", directions=(True, False, False)))
    return squares(*parts, vv.Contact(**sides, **options))


@pytest.mark.parametrize("counts", [(4, 2), (20, 10)])
def test_closed_mortar_contact_is_that_of_a_stiff_penalty(counts: tuple[int, int]) -> None:
    penalty = stacked(counts, enforcement="penalty", stiffness=1e7)
    assert stacked(counts, multipliers="standard") == pytest.approx(penalty, rel=2e-4)
    for condensed in (False, True):
        assert stacked(counts, multipliers="dual", condensed=condensed) == pytest.approx(penalty, rel=2e-4)


def test_sticking_mortar_contact_is_a_tie() -> None:
    stiff: dict[str, Any] = {"stiffness": 1e7, "tangential_stiffness": 1e7, **ELASTIC}
    assert stacked((4, 2), friction=0.5, **stiff) == pytest.approx(stacked((4, 2)), rel=1e-4)


def test_tractions_that_make_the_stiffness_unsymmetric_are_refused() -> None:
    with pytest.raises(
        vv.InputError, match=r"position.* of Solid .* is not symmetric .*tie the surfaces instead"
    ):
        stacked((4, 2), friction=0.5)


# --- incompressible solids ----------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("cell", "counts"), [("tri3", (10, 3)), ("tri3", (40, 8)), ("tet4", (4, 2, 2)), ("wedge6", (4, 2, 2))]
)
def test_stabilised_pressures_are_those_of_the_nearly_incompressible(
    cell: str, counts: tuple[int, ...]
) -> None:
    def beam(poisson: float) -> np.ndarray:
        kind, size = (vv.RectangleMesh, (5, 1)) if len(counts) == 2 else (vv.BoxMesh, (3, 1, 1))
        solid = vv.Solid(
            mesh=kind(size=size, counts=counts, cell=cell),
            material=vv.NeoHooke(young=1e4, poisson=poisson),
            density=1.0,
            formulation="mixed",
        )
        return vv.modes(vv.System([solid, vv.Fixed(solid=solid, nodes="x0")]), 6).squared

    assert beam(0.5) == pytest.approx(beam(0.499999), rel=1e-5)


# --- what is refused ----------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", ["stream, quad9", "immersed, quad4", "immersed body, quad4", "heat bar"])
def test_first_order_in_time_is_refused(name: str) -> None:
    system = next(entry for entry in CATALOGUE if entry.name == name).system()
    with pytest.raises(
        vv.InputError, match=r"(velocity of Fluid|temperature of Bar) .* of first order in time"
    ):
        vv.modes(system)


@pytest.mark.parametrize("counts", [(2, 2, 2), (7, 7, 7)])
def test_motion_without_mass_is_refused(counts: tuple[int, ...]) -> None:
    solid = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=counts), material=STEEL, density=0.0, name="foam")
    with pytest.raises(vv.InputError, match=r"position.* of Solid 'foam' moves without mass"):
        vv.modes(vv.System([solid, vv.Fixed(solid=solid, nodes="x0")]))


def test_singular_equations_name_what_is_loose() -> None:
    system = vv.System([vv.PointMass(mass=1.0, name="ball")])
    with pytest.raises(vv.InputError, match=r"nothing determines position\[1\] of PointMass 'ball'"):
        factored(sp.diags_array([1.0, 0.0, 2.0]).tocsr(), 0, system, np.arange(3))


# --- the catalogue ------------------------------------------------------------------------------------------
def differences(system: vv.System, step: Any) -> np.ndarray:
    """Tangent (n, n) over the free unknowns by differences of fourth order of the residual."""
    dx, unknowns, columns = system.core.dx, system.free_unknowns, []
    for u in unknowns:
        d, ends = 1e-6 * max(1.0, abs(system.x[u])), []
        for k in (2, 1, -1, -2):
            dx[u] = k * d
            ends.append(system.residual(step)[unknowns])
        dx[u] = 0.0
        columns.append((8 * (ends[1] - ends[2]) - ends[0] + ends[3]) / (12 * d))
    return np.array(columns).T


def by_differences(system: vv.System) -> tuple[np.ndarray, float]:
    """Eigenvalues where all that is without mass is in equilibrium, but damages, which do not swing back, are constant;
    complex where the tangent is not symmetric, and how far it is from that."""
    moves = system.order[system.free_unknowns] > 0
    damages = [u for growing in system.model.growing for u in growing.field.unknowns]
    order, n = np.argsort(~moves, kind="stable"), int(moves.sum())
    order = order[~np.isin(system.free_unknowns[order], damages)]
    A = differences(system, load_step(system.time, 0.0))[np.ix_(order, order)]
    factor = 2.0**30
    masses = [differences(system, instant(system.time, leading=sign * factor)) for sign in (1, -1)]
    M = ((masses[0] - masses[1]) / (2 * factor))[np.ix_(order[:n], order[:n])]
    N, left = settled(A, n), settled(A.T, n)
    lack = float(np.abs(A - A.T).max() / (np.abs(A).max() or 1.0))
    if lack > 1e-5:
        return np.sort_complex(sla.eigvals(left.T @ A @ N, left[:n].T @ M @ N[:n])), lack
    return sla.eigvalsh(N.T @ (A + A.T) @ N / 2, N[:n].T @ M @ N[:n]), lack


def settled(A: np.ndarray, n: int) -> np.ndarray:
    """Basis of the motions that leave the equations after the first n fulfilled."""
    N = np.eye(len(A))
    if n < len(A):
        N = sla.null_space(A[n:] / np.abs(A[n:]).max(axis=1, keepdims=True), rcond=1e-8)
    _, length, V = np.linalg.svd(N[:n], full_matrices=False)
    return np.asarray(N @ V[length > 1e-7].T)


APART = (
    "rotating frame",
    "damage points",
)  # gyroscopic, see test_spinning.py; with a kink where nothing changes


@pytest.mark.parametrize(
    "entry", [e for e in CATALOGUE[::6] if not e.name.endswith(APART)], ids=lambda entry: entry.name
)
def test_modes_of_the_catalogue_are_those_of_dense_matrices_or_refused(entry: Entry) -> None:
    """Off the start, where contacts and fibres have kinks; there forces need not balance."""
    system = entry.system()
    moves = (system.order > 0) & ~np.concatenate([f.fixed for f in system.model.fields])
    scale = np.where(system.scale > 0, system.scale, 1.0)[moves]
    system.x[moves] += 1e-3 * np.random.default_rng(3).standard_normal(int(moves.sum())) * scale
    system.invalidate()
    if np.any(system.order == 1):
        with pytest.raises(vv.InputError, match="first order in time"):
            vv.modes(system)
        return
    refusal, squared = "", np.zeros(0)
    try:
        squared = vv.modes(
            system, len(system.x), tolerance=1e300
        ).squared  # with the multipliers of the state
    except vv.InputError as error:
        refusal = str(error)
    if len(system.free_unknowns) > 150:
        return
    at = Instant(system)
    at.factor()
    balance(system, at, 1e300)  # the multipliers that modes go by, which they leave as they are
    exact, lack = by_differences(system)
    assert not refusal
    largest = max(float(np.abs(exact).max(initial=0.0)), 1e-3)
    if lack > 1e-5:  # loads that follow: conjugate pairs are given once
        apart = np.abs(exact[:, None] - np.stack([squared, np.conj(squared)], axis=-1).ravel())
        assert apart.min(axis=1).max() < 1e-6 * largest
        return
    assert np.sort(squared) == pytest.approx(np.sort(exact), rel=1e-6, abs=1e-6 * largest)  # some grow


@pytest.mark.parametrize("size", [1e-2, 1e-3, 1e-4])
def test_small_bodies_beside_heavy_ones_are_not_massless(size: float) -> None:
    """A cube on a bushing turns at sqrt(6 k / (density size^5)): kilograms say nothing about moments of inertia."""
    ground, heavy = vv.Ground(), vv.PointMass(mass=10.0, position=(1, 0, 0))
    cube = vv.RigidBody(shape=vv.Box(size=(size,) * 3), density=1e3)
    bushing = vv.Bushing(a=ground, b=cube, at=(0, 0, 0), stiffness=(5, 5, 5), rotational_stiffness=(1, 1, 1))
    spring = vv.Spring(a=ground.point((2, 0, 0)), b=heavy, stiffness=10.0, free_length=1.0)
    frequencies = vv.modes(vv.System([ground, heavy, cube, bushing, spring]), n=9).frequencies
    turning, swinging = np.sqrt(6 / (1e3 * size**5)), np.sqrt(5 / (1e3 * size**3))
    assert frequencies[6:] == pytest.approx(np.full(3, turning / (2 * np.pi)), rel=1e-7)
    assert frequencies[3:6] == pytest.approx(np.full(3, swinging / (2 * np.pi)), rel=1e-6)
