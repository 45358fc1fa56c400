"""Contact: what it refuses, what it reports, and that nothing depends on units, threads and restarts."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from contact_parts import PYRAMID, RUBBER, bricks, contact_of, plates, pushed, rigid_on_brick
from numpy.typing import NDArray
from saved import saved_arrays

import visviva as vv
from visviva.base.errors import InputError
from visviva.component.component import Component
from visviva.contact.resolve import linearised
from visviva.mesh.faces import Faces
from visviva.scene import read_scene, write_scene
from visviva.study.run import run

Array = NDArray[np.float64]

KINDS: list[dict[str, Any]] = [{}, {"impact": "conserving"}, {"enforcement": "penalty"}]


def ran(components: list[Component], steps: int = 5, h: float = 0.01) -> vv.Result:
    return vv.simulate(vv.System(components), until=steps * h, step=h)


# --- bad input ----------------------------------------------------------------------------------------------
def side(**options: Any) -> vv.Solid:
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1))
    return vv.Solid(mesh=mesh, material=RUBBER, density=1.0, **options)


def pair(**options: Any) -> list[Component]:
    a, b = side(), side()
    more = {"first_faces": "z0", "second_faces": "z1"} | options
    return [a, b, vv.Contact(first=a, second=b, **more)]


def inward() -> list[Component]:
    a = side()
    faces = a.grid.faces("z0")
    turned = Faces({"quad4": faces.cells["quad4"][:, ::-1]}, faces.owners)
    b = side()
    return [a, b, vv.Contact(first=a, second=b, first_faces=turned, second_faces="z1")]


def with_itself() -> list[Component]:
    a = side()
    return [a, vv.Contact(first=a, second=a, first_faces="z0", second_faces="x1")]


def two_bodies(**options: Any) -> list[Component]:
    a, b = (vv.RigidBody(shape=vv.Box(size=(1, 1, 1)), density=1.0, position=(0, 0, z)) for z in (0, 1.1))
    return [a, b, vv.Contact(first=a, second=b, **options)]


def ball_on_plate(shape: Any, **options: Any) -> list[Component]:
    """In an order in which the ball, or what else is small, falls between the vertices of the plate."""
    plate = vv.RigidBody(shape=vv.Box(size=(2, 2, 0.05)), density=1.0, name="plate")
    ball = vv.RigidBody(shape=shape, density=1.0, position=(0, 0, 0.2), name="ball")
    return [plate, ball, vv.Contact(first=plate, second=ball, stiffness=1e6, **options)]


def against(second: Component, **options: Any) -> list[Component]:
    a = side()
    return [a, second, vv.Contact(first=a, second=second, **options)]  # type: ignore[arg-type]


BAD: dict[str, tuple[Callable[[], list[Component]], str]] = {
    "unknown faces": (partial(pair, first_faces="z00"), "no set of faces 'z00'.*z0"),
    "empty faces": (partial(pair, first_faces=Faces({}, {})), "the set of faces .* is empty"),
    "faces that look inwards": (inward, r"near \(0.5, 0.5, 0\) looks into the solid; reverse its nodes"),
    "a surface with itself": (
        with_itself,
        "both surfaces are of Solid .* and share node .* touch each other with first_faces='all'",
    ),
    "rigid bodies without stiffness": (two_bodies, "nothing says how stiff contact should be"),
    "faces of a rigid body": (
        partial(two_bodies, stiffness=1.0, first_faces="top"),
        "no face 'top', but 'z0', 'z1', 'y0', 'y1', 'x0', 'x1'; 'all' is its whole surface",
    ),
    "a body without shape": (
        lambda: against(vv.RigidBody(mass=1.0, inertia=(1, 1, 1))),
        "has no surface; give it a shape",
    ),
    "a penalty too soft": (
        partial(pair, enforcement="penalty", stiffness=1e-5),
        r"stiffness = 1e-05 of the penalty is 1e-07 times.*; about 7.1e\+02 is right",
    ),
    "a penalty too stiff": (
        partial(pair, enforcement="penalty", stiffness=1e12),
        "swamps the bodies' stiffness",
    ),
    "negative damping": (partial(pair, enforcement="penalty", damping=-1.0), "damping = -1 is negative"),
    "damping of multipliers": (partial(pair, damping=1.0), "damping needs enforcement='penalty'"),
    "dual multipliers of a penalty": (
        partial(pair, enforcement="penalty", multipliers="dual"),
        "multipliers='dual' needs enforcement='multipliers'",
    ),
    "condensing a penalty": (
        partial(pair, enforcement="penalty", condensed=True),
        "condensed=True needs enforcement='multipliers'",
    ),
    "dual multipliers with friction": (
        partial(pair, multipliers="dual", friction=0.3),
        "multipliers='dual' is for contact without friction.*leave out friction = 0.3",
    ),
    "dual multipliers of vertices": (
        partial(pair, multipliers="dual", formulation="node-to-segment"),
        "vertices have one each.*condensed as they are",
    ),
    "dual multipliers on a shape": (
        lambda: against(vv.Plane(at=(0, 0, 0), normal=(0, 0, 1)), first_faces="z0", multipliers="dual"),
        "vertices have one each.*condensed as they are",
    ),
    "condensing standard multipliers": (
        partial(pair, condensed=True),
        "standard multipliers .* cannot be condensed; give multipliers='dual'",
    ),
    "condensing at a rigid body": (
        partial(two_bodies, stiffness=1.0, formulation="node-to-segment", condensed=True),
        "condensed=True needs nodes of a solid on the first surface",
    ),
    "a ball between vertices": (
        partial(ball_on_plate, vv.Sphere(radius=0.05)),
        "'plate' has facets of up to 2.83, larger than all of RigidBody 'ball', .*; exchange first and second",
    ),
    "a cube between vertices": (
        partial(ball_on_plate, vv.Box(size=(0.1, 0.1, 0.1)), second_faces="z0"),
        "exchange first and second, or give RigidBody 'plate' finer facets",
    ),
    "negative stiffness": (partial(pair, stiffness=-1.0), "stiffness = -1 is not positive"),
    "another dimension": (
        lambda: against(vv.Solid(mesh=vv.RectangleMesh(size=(1, 1), counts=(1, 1)), material=RUBBER)),
        "differ in dimension",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_refused_with_its_cure(name: str) -> None:
    build, message = BAD[name]
    with pytest.raises(InputError, match=message):
        vv.System(build())


@pytest.mark.parametrize("massless", ["first", "second", "both"])
def test_solids_without_mass_that_nothing_holds_are_refused_in_time(massless: str) -> None:
    """Contact would throw them at any speed; what a support holds may be without mass."""
    masses = {"first": (0.0, 1.0), "second": (1.0, 0.0), "both": (0.0, 0.0)}[massless]
    meshes = [vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1), origin=(0, 0, z)) for z in (1.001, 0.0)]
    a, b = (vv.Solid(mesh=m, material=RUBBER, density=d) for m, d in zip(meshes, masses, strict=True))
    contact = vv.Contact(first=a, second=b, first_faces="z0", second_faces="z1")
    with pytest.raises(
        InputError, match=r"Solid '.*' \(translation along x, y, z.*no mass.*give it a density"
    ):
        ran([a, b, contact])
    weightless = [s for s in (a, b) if s.density == 0]
    ran([a, b, contact, *(vv.Fixed(solid=s, nodes="z1") for s in weightless)], steps=1)


@pytest.mark.parametrize("build", [bricks, plates])
@pytest.mark.parametrize("options", KINDS, ids=str)
def test_overlap_at_the_start_is_refused_with_depth_and_place(
    build: Callable[..., list[Component]], options: dict[str, Any]
) -> None:
    with pytest.raises(InputError, match=r"overlap by 0.1 near \(.*\) at the start; .*initial='press'"):
        ran(build(gap=0.1 / -4, **options))


def test_rounding_of_meshes_is_no_overlap() -> None:
    ran(bricks(gap=-1e-9), steps=1)


def test_press_fit_starts_with_overlap() -> None:
    """Two confined layers that overlap by 0.1 in statics share it by their compliance: the pressure is uniaxial."""
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)).build()
    lower, upper = (
        vv.Solid(mesh=m, material=vv.LinearElastic(young=100.0, poisson=0.0))
        for m in (mesh, mesh.moved((0, 0, 0.9)))
    )
    contact = vv.Contact(first=upper, second=lower, first_faces="z0", second_faces="z1", initial="press")
    holds = [vv.Fixed(solid=s, nodes="all", directions=(1, 1, 0)) for s in (lower, upper)]
    holds += [vv.Fixed(solid=lower, nodes="z0"), vv.Fixed(solid=upper, nodes="z1")]
    system = vv.System([lower, upper, contact, *holds])
    vv.quasi_static(system, until=1.0, step=1.0)
    assert vv.ContactForce(contact=contact)(system) == pytest.approx([0, 0, 100.0 * 0.1 / 2], abs=1e-9)
    assert vv.ContactArea(contact=contact)(system) == pytest.approx(1.0)


# --- probes -------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("options", KINDS, ids=str)
def test_contact_force_is_the_change_of_momentum(options: dict[str, Any]) -> None:
    """Over a step, of the only force on the body; and its area lies between none and that of the face."""
    parts = bricks(**options)
    body, contact = parts[0], contact_of(parts)
    assert isinstance(body, vv.Solid)
    system = vv.System(parts)
    assert vv.ContactForce(contact=contact)(system).tolist() == [0, 0, 0]
    largest = 0.0
    for _ in range(4):
        before = body.nodal_mass @ body.velocities(system.x, system.v)
        vv.simulate(system, until=system.time + 0.01, step=0.01)
        change = body.nodal_mass @ body.velocities(system.x, system.v) - before
        force = vv.ContactForce(contact=contact)(system)
        assert np.abs(change / 0.01 - force).max() < 1e-9 * max(1.0, np.abs(force).max())
        assert 0 <= vv.ContactArea(contact=contact)(system) <= 16 * 1.1
        largest = max(largest, float(force[2]))
    assert largest > 1


# --- nothing depends on --------------------------------------------------------------------------------------
UNITS: list[dict[str, Any]] = [
    *KINDS,
    {"formulation": "node-to-segment", "impact": "conserving"},
    {"formulation": "node-to-segment", "enforcement": "penalty"},
    {"friction": 0.3},
    {"formulation": "node-to-segment", "friction": 0.3, "enforcement": "penalty", "tangential": "penalty"},
]


@pytest.mark.parametrize("options", UNITS, ids=str)
def test_units_of_length_change_nothing(options: dict[str, Any]) -> None:
    """The same impact in metres and in millimetres: also the search and the penalty are without scale."""
    ends = []
    for scale in (1.0, 1000.0):
        parts = bricks(scale=scale, **options)
        system = vv.System(parts)
        result = vv.simulate(system, until=0.05, step=0.01)
        ends.append((system.x[: system.n_coordinates] / scale, result.statistics.iterations))
    assert np.abs(ends[0][0] - ends[1][0]).max() < 1e-12
    assert ends[0][1] == ends[1][1]


RUN = """
import hashlib, sys
sys.path.insert(0, {tests!r})
import visviva as vv
from contact_parts import bricks
system = vv.System(bricks("tet4"))
vv.simulate(system, until=0.04, step=0.01)
print(hashlib.sha256(system.x.tobytes() + system.v.tobytes() + system.core.energy.tobytes()).hexdigest())
"""


def test_bits_do_not_depend_on_threads() -> None:
    def bits(threads: int) -> str:
        environment = {**os.environ, "OMP_NUM_THREADS": str(threads)}
        command = [sys.executable, "-c", RUN.format(tests=str(Path(__file__).parent))]
        return subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout

    assert bits(1) == bits(2)


def study(build: Callable[..., list[Component]], until: float, **options: Any) -> vv.Study:
    parts = build(**options)
    contact = contact_of(parts)
    probes = {"force": vv.ContactForce(contact=contact), "area": vv.ContactArea(contact=contact)}
    return vv.Study(vv.System(parts), until, 0.01, probes=probes)


RESTARTS: dict[str, Callable[[float], vv.Study]] = {
    "bricks": partial(study, bricks),
    "plates": partial(study, plates, impact="conserving"),
    "condensed": partial(study, bricks, multipliers="dual", condensed=True),
    "rigid": partial(study, partial(rigid_on_brick, vv.SurfaceMesh(**PYRAMID), 0.02), enforcement="penalty"),
}


@pytest.mark.parametrize("name", RESTARTS)
def test_resumed_during_contact_bit_by_bit(name: str, tmp_path: Path) -> None:
    whole = RESTARTS[name](0.08)
    run(whole, tmp_path / "whole", pictures=False)
    part = RESTARTS[name](0.02 if name == "rigid" else 0.01)
    run(part, tmp_path / "split", pictures=False)
    assert contact_of(part.system.components).pressures.max() > 0
    run(RESTARTS[name](0.08), tmp_path / "split", resume=True, pictures=False)
    for table in ("ledger.csv", "probes.csv"):
        assert (tmp_path / "whole" / table).read_bytes() == (tmp_path / "split" / table).read_bytes()
    states = [saved_arrays(tmp_path / part) for part in ("whole", "split")]
    assert states[0].keys() == states[1].keys()
    assert all(states[0][k].tobytes() == states[1][k].tobytes() for k in states[0])


def test_scene_file_round_trip(tmp_path: Path) -> None:
    a, b = (
        vv.Solid(
            mesh=vv.RectangleMesh(size=(1, 1), counts=(n, 1), origin=(0, y)),
            material=RUBBER,
            density=1.0,
            velocity=v,
        )
        for n, y, v in ((2, 1.0, (0, -1, 0)), (3, 0.0, (0, 0, 0)))
    )
    contact = vv.Contact(
        first=a,
        second=b,
        first_faces="y0",
        second_faces="y1",
        impact="conserving",
        initial="press",
        reach=0.4,
    )
    probes: dict[str, Any] = {
        "force": vv.ContactForce(contact=contact),
        "area": vv.ContactArea(contact=contact),
    }
    here = vv.Study(vv.System([a, b, contact]), 0.05, 0.01, probes=probes)
    write_scene(here, tmp_path / "scene.yaml")
    there = read_scene(tmp_path / "scene.yaml")
    for s in (here, there):
        vv.simulate(s.system, until=0.05, step=0.01)
    assert here.system.x.tobytes() == there.system.x.tobytes()
    assert there.probes["force"](there.system).tolist() == here.probes["force"](here.system).tolist()


def test_axisymmetric_and_plane_solids_do_not_mix() -> None:
    mesh = vv.RectangleMesh(size=(1, 1), counts=(1, 1))
    low, high = (
        vv.Solid(mesh=mesh.build().moved((0, y)), material=RUBBER, plane=plane)
        for y, plane in ((0, "axisymmetric"), (1, "strain"))
    )
    with pytest.raises(InputError, match="is axisymmetric"):
        vv.System([low, high, vv.Contact(first=high, second=low, first_faces="y0", second_faces="y1")])


def test_amended_tangents_lead_where_new_ones_do() -> None:
    """Where the active set alone changes, the tangent is kept but for rows and columns of multipliers."""
    ends, tangents = [], []
    for keep_factor in (0.3, 0.0):
        components = bricks(gap=0.01)
        system = vv.System(components, vv.Newton(keep_factor=keep_factor))
        result = vv.simulate(system, until=0.2, step=0.01)
        assert contact_of(components).costs["segments"] > 0
        ends.append(result.states[-1])
        tangents.append(result.statistics.factorizations)
    assert np.allclose(*ends, rtol=0, atol=1e-9)
    assert tangents[0] < 0.6 * tangents[1]


def test_run_draws_moments_and_movie_of_a_study(tmp_path: Path) -> None:
    system = vv.System(bricks(gap=0.01))
    study = vv.Study(system, until=0.04, step=0.01, moments=(0.02, 9.0), movie=True)
    with pytest.warns(UserWarning, match=r"no picture at 9: the motion ends at 0\.04"):
        run(study, tmp_path / "bricks", progress=False)
    files = {file.name for file in (tmp_path / "bricks").iterdir()}
    assert "picture-0.02.png" in files
    assert "picture-9.png" not in files
    assert files & {"movie.mp4", "movie.gif"}


def test_multigrid_beside_pressures_finds_what_factors_find() -> None:
    options = (
        vv.Iterative(preconditioner="augmented", tolerance=1e-6, max_iterations=60),
        vv.Direct(library="eigen"),
    )
    found = []
    for linear in options:
        system, over = pushed(4, vv.Newton(linear=linear))
        vv.quasi_static(system, until=1.0, step=0.5, scheme=vv.Static(tolerance=1e-9))
        found.append(over.displacements(system.x))
    assert np.abs(found[0]).max() > 0.05
    assert found[0] == pytest.approx(found[1], abs=1e-9)


# --- edges of facets ----------------------------------------------------------------------------------------
ALONG: list[list[tuple[float, float, float]]] = [
    [(7.461, -5.191, 1.047), (7.142, 6e-7, 0.887), (5.649, -6e-6, 5.049), (5.517, -5.140, 5.071)],
    [(5.572, 7e-6, 5.374), (6.806, -2e-6, 0.211), (6.861, -4.391, 0.198), (5.950, -4.412, 5.409)],
]
"""Corners of two facets of the tori that look at each other, with edges that lie along each other at y = 0."""


def test_a_corner_that_an_edge_cuts_off_turns_no_force() -> None:
    """Integrals over facets that are not flat are not exact, so triangles must not become others at once."""
    sides = []
    for corners in np.array(ALONG):
        normal = np.cross(corners[2] - corners[0], corners[3] - corners[1])
        points = np.vstack([corners - 2 * normal / np.linalg.norm(normal), corners])
        sides.append(vv.Solid(mesh=vv.Mesh(points, {"hex8": np.arange(8)[None]}), material=RUBBER))
    contact = vv.Contact(first=sides[0], second=sides[1], initial="press")
    vv.System([*sides, contact])
    gaps = contact._gaps(1.0).core
    assert contact.opposite is not None
    places = np.vstack([contact.places, contact.opposite.places])
    passes = int(np.argmin(np.abs(contact.places - ALONG[0][2]).sum(axis=1)))

    def gradient(shift: float) -> Array:
        X = places.copy()
        X[passes, 1] += shift
        matrix: Array = linearised(gaps, X)[1].toarray()
        return matrix

    found = [gradient(shift) for shift in np.linspace(-1e-5, 1e-5, 21)]
    jump = max(np.abs(b - a).max() for a, b in pairwise(found))
    assert jump < 5e-5 * np.abs(found[0]).max()


def aligned(n: int, other: int) -> tuple[list[vv.Solid], vv.Contact, vv.System]:
    """A block pressed onto one of the same outline: borders and middle lines of both meshes lie along each other."""
    below = vv.BoxMesh(size=(1, 1, 0.5), counts=(other, other, 1)).build()
    above = vv.BoxMesh(size=(1, 1, 0.5), counts=(n, n, 1)).build().moved((0, 0, 0.5))
    under, over = (vv.Solid(mesh=m, material=vv.NeoHooke(young=1000.0, poisson=0.3)) for m in (below, above))
    contact = vv.Contact(first=over, first_faces="z0", second=under, second_faces="z1")
    hold = vv.Fixed(solid=under, nodes="z0")
    press = vv.Prescribed(solid=over, nodes="z1", motion=("0", "0", "-0.05 * t"))
    return [under, over], contact, vv.System([under, over, hold, press, contact])


@pytest.mark.parametrize(("n", "other"), [(6, 6), (6, 7), (6, 8)])
def test_blocks_of_equal_outlines_take_few_iterations(n: int, other: int) -> None:
    solids, contact, system = aligned(n, other)
    steps = list(vv.march(system, until=1.0, step=0.2, scheme=vv.Static(tolerance=1e-8)))
    assert len(steps) == 5
    assert max(step.iterations for step in steps) <= 4
    assert np.count_nonzero(contact.pressures) >= len(contact.pressures) - 4  # all but corners
    middle = [s.displacements(system.x)[np.all(np.abs(s.points[:, :2] - 0.5) < 1e-9, axis=1)] for s in solids]
    assert max(np.abs(u[:, :2]).max() for u in middle if len(u)) < 1e-12  # what is symmetric stays so


def test_edges_along_each_other_do_not_amplify_rounding() -> None:
    """Gradients of the gaps hardly change where meshes shift by less than a billionth against each other."""
    _, contact, _ = aligned(3, 3)
    gaps = contact._gaps(1.0).core
    assert contact.opposite is not None
    X = np.vstack([contact.places, contact.opposite.places])
    x, y = X[:, 0] - 0.5, X[:, 1] - 0.5
    X = X + np.column_stack(
        [x * (0.01 + 0.003 * y**2), y * (0.01 + 0.004 * x**2), 0.003 * x**2 + 0.002 * y**2]
    )
    shift = np.random.default_rng(0).standard_normal(X.shape) * [1, 1, 0]
    found = [
        linearised(gaps, X + s * shift)[1].toarray() for s in (-1e-9, -1e-10, -1e-12, 0, 1e-12, 1e-10, 1e-9)
    ]
    assert max(np.abs(b - a).max() for a, b in pairwise(found)) < 1e-8 * np.abs(found[0]).max()


def test_statics_that_stops_in_contact_says_how_to_go_on() -> None:
    """One iteration is not enough to find which vertices touch."""
    system, _ = pushed(2)
    with pytest.raises(vv.NoEquilibrium, match=r"If it snaps here, .* vv.arc_length, .* vv.simulate"):
        vv.quasi_static(system, until=1.0, step=0.5, scheme=vv.Static(max_iterations=1, halvings=0))


@pytest.mark.parametrize("n", [4, 2])
def test_edges_along_each_other_do_not_keep_steps_from_converging(n: int) -> None:
    """Gaps jump by 1e-8 of a facet where edges of both meshes lie along each other, and increments then alternate
    at some 1e-9: steps failed, however short."""
    above = vv.BoxMesh(size=(1, 1, 0.5), counts=(4, 4, 1))
    below = vv.BoxMesh(size=(1, 1, 0.5), counts=(n, n, 1), origin=(0, 0, -0.5))
    one, two = (vv.Solid(mesh=m, material=RUBBER, density=1.0) for m in (above, below))
    drawn = vv.Prescribed(solid=one, nodes="z1", motion=("0.05*t", "0", "-0.1*t"))
    contact = vv.Contact(first=one, second=two, first_faces="z0", second_faces="z1")
    system = vv.System([one, two, vv.Fixed(solid=two, nodes="z0"), drawn, contact])
    result = vv.simulate(system, until=0.7, step=0.05)
    assert contact.gaps[contact.pressures > 0] == pytest.approx(0.0, abs=1e-8)
    result.assert_conserved("energy", tolerance=1e-9)


def test_a_vertex_that_has_left_an_edge_carries_nothing() -> None:
    """It stayed closed where the set of closed gaps went round, and what it had seen was read beyond its end."""
    soft = vv.NeoHooke(young=2485835.7696260028, poisson=0.3)
    under = vv.RectangleMesh(size=(1, 0.3), counts=(3, 2), origin=(-0.5, -0.3))
    base = vv.Solid(mesh=under, material=soft, density=1e3)
    over = vv.RectangleMesh(size=(1, 0.1), counts=(2, 1), origin=(-0.05, 0.001))
    block = vv.Solid(mesh=over, material=soft, density=1e3, velocity=(1.20426713, -0.21803442, 0))
    contact = vv.Contact(first=block, second=base, friction=0.2, formulation="mortar")
    hold, gravity = vv.Fixed(solid=base, nodes="y0"), vv.Gravity(acceleration=(0, -10, 0))
    result = vv.simulate(vv.System([base, block, contact, hold, gravity]), until=0.14, step=0.002)
    energy = result.ledger["total"]
    assert np.all(np.diff(energy) < 1e-9 * np.ptp(energy))
