"""Meshes that do not match, tied by mortar integrals."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from visviva.mesh.cells import CELLS

Array = NDArray[np.float64]
Multipliers = Literal["dual", "standard"]

KINDS: tuple[Multipliers, ...] = ("dual", "standard")
RUBBER = vv.NeoHooke(young=10.0, poisson=0.3)
SPACE = ("hex8", "tet4", "wedge6", "hex20", "hex27", "tet10")
PLANE = ("quad4", "tri3", "tri6", "quad8", "quad9")


def pair(
    cell: str,
    multipliers: Multipliers = "dual",
    other: str | None = None,
    bend: float = 0.0,
    counts: tuple[tuple[int, ...], tuple[int, ...]] = ((3, 2, 1), (2, 3, 1)),
    **options: Any,
) -> tuple[vv.Solid, vv.Solid, vv.Tie]:
    """Two blocks on top of each other along the last axis, the lower one first, with meshes that do not match."""
    d = CELLS[cell].dimension
    parts = []
    for low, high, n, kind in ((0.0, 0.6, counts[0], cell), (0.6, 1.0, counts[1], other or cell)):
        size = [*[1.0] * (d - 1), high - low]
        origin = [*[0.0] * (d - 1), low]
        shape: Any = vv.BoxMesh if d == 3 else vv.RectangleMesh
        mesh = shape(size=size, counts=[*n[: d - 1], n[2]], cell=kind, origin=origin).build()
        X = mesh.points.copy()
        share = X[:, -1] / 0.6 if low == 0.0 else (1.0 - X[:, -1]) / 0.4
        X[:, -1] += bend * share * np.sin(2.0 * X[:, 0] + 0.3)
        mesh = vv.Mesh(X, mesh.cells, node_sets=mesh.node_sets, face_sets=mesh.face_sets)
        parts.append(vv.Solid(mesh=mesh, material=RUBBER, **options))
    axis = "xyz"[d - 1]
    tie = vv.Tie(
        first=parts[0],
        first_faces=f"{axis}1",
        second=parts[1],
        second_faces=f"{axis}0",
        multipliers=multipliers,
    )
    return parts[0], parts[1], tie


def flat(F: Array, d: int) -> Array:
    G = np.array(F)
    if d == 2:
        G[2], G[:, 2] = (0, 0, 1), (0, 0, 1)
    return G


def stretched(first: vv.Solid, second: vv.Solid, tie: vv.Tie, F: Array) -> tuple[vv.System, float]:
    """Both in equilibrium under the tractions of a homogeneous deformation; how far nodes are from it."""
    d = first.dimension
    vv.System([second])
    P = second.fields((second.points @ F.T)[:, :d].ravel()).first_piola[0, 0]
    del second._system  # type: ignore[attr-defined]
    top = 1.0
    held = []
    corners = {3: [(0, 0, top), (1, 0, top), (0, 1, top)], 2: [(0, top, 0), (1, top, 0)]}[d]
    directions = {3: [(1, 1, 1), (0, 1, 1), (0, 0, 1)], 2: [(1, 1, 0), (0, 1, 0)]}[d]
    for place, which in zip(corners, directions, strict=True):
        X = second.points
        node = int(np.argmin(np.linalg.norm(X - place, axis=1)))
        held.append(
            vv.Prescribed(
                solid=second,
                nodes=[node],
                motion=lambda t, X: t * X @ (F - np.eye(3)).T,
                directions=tuple(bool(w) for w in which),
            )
        )
    loads = []
    for solid in (first, second):
        for axis, name in enumerate("xyz"[:d]):
            for side, sign in ((f"{name}0", -1.0), (f"{name}1", 1.0)):
                if (solid is first and side == f"{'xyz'[d - 1]}1") or (
                    solid is second and side == f"{'xyz'[d - 1]}0"
                ):
                    continue
                normal = sign * np.eye(3)[axis]
                loads.append(vv.Traction(solid=solid, faces=side, traction=P @ normal, times="t"))
    system = vv.System([first, second, tie, *held, *loads])
    vv.quasi_static(system, until=1.0, step=0.5)
    error = max(float(np.abs(s.positions(system.x) - s.points @ F.T).max()) for s in (first, second))
    return system, error


STRETCH = np.array([[1.15, 0.05, 0.05], [0.0, 1.1, 0.05], [0.0, 0.0, 1.2]])


@pytest.mark.parametrize("multipliers", KINDS)
@pytest.mark.parametrize("cell", [*SPACE, *PLANE])
def test_homogeneous_stress_passes_through(cell: str, multipliers: Multipliers) -> None:
    """The patch test in large deformations, with forces on all sides and supports for rigid motions alone."""
    small = {"counts": ((3, 1, 1), (2, 2, 1))} if cell in ("hex20", "hex27", "tet10") else {}
    first, second, tie = pair(cell, multipliers, **small)
    F = flat(STRETCH, first.dimension)
    system, error = stretched(first, second, tie, F)
    assert error < 1e-11
    d = first.dimension
    P = first.fields(system.x).first_piola[0, 0]
    np.testing.assert_allclose(tie.forces(system.x).sum(axis=0)[:d], P[:d, d - 1], atol=1e-10)


@pytest.mark.parametrize("multipliers", KINDS)
@pytest.mark.parametrize(("cell", "other"), [("hex8", "tet4"), ("tet10", "hex8"), ("quad9", "tri3")])
def test_patches_of_different_cells(cell: str, other: str, multipliers: Multipliers) -> None:
    first, second, tie = pair(cell, multipliers, other)
    assert stretched(first, second, tie, flat(STRETCH, first.dimension))[1] < 1e-11


@pytest.mark.parametrize("multipliers", KINDS)
@pytest.mark.parametrize("cell", ["hex8", "tet4", "hex27", "quad4", "quad9"])
def test_curved_surfaces_take_homogeneous_deformations(cell: str, multipliers: Multipliers) -> None:
    """Differently faceted: after nodes have been moved the tie holds for every linear field to round-off."""
    first, second, tie = pair(cell, multipliers, bend=0.08)
    d = first.dimension
    before = first.points
    system = vv.System([first, second, tie])
    assert 1e-4 < tie.moved < 0.03
    assert np.linalg.norm(first.points - before, axis=1).max() == pytest.approx(tie.moved, rel=1e-12)
    F = 3.0 * flat(np.random.default_rng(1).standard_normal((3, 3)), d)
    for solid in (first, second):
        at = solid.node_unknowns(np.arange(solid.grid.n_nodes))[:, None] + np.arange(d)
        system.x[at] = (solid.points @ F.T + [0.7, -0.3, 0.0])[:, :d]
    residual = system.residual(vv.Static().step(0.0, 0.0))[system.field(tie, "tie").unknowns]
    assert np.abs(residual).max() < 1e-13


def test_matching_curved_surfaces_pass_the_patch_test() -> None:
    first, second, tie = pair("hex8", bend=0.08, counts=((2, 2, 1), (2, 2, 2)))
    _, error = stretched(first, second, tie, STRETCH)
    assert error < 1e-11
    assert tie.moved == 0.0


@pytest.mark.parametrize("multipliers", KINDS)
@pytest.mark.parametrize("cell", ["hex8", "tet4", "quad4"])
def test_rigid_motion_costs_nothing(cell: str, multipliers: Multipliers) -> None:
    """A tied pair with curved surfaces is turned by 100 degrees and moved: no force, no energy."""
    first, second, tie = pair(cell, multipliers, bend=0.08)
    d, c, s = first.dimension, np.cos(1.75), np.sin(1.75)
    R = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    if d == 3:
        R = R @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    system = vv.System([first, second, tie])
    for solid in (first, second):
        at = solid.node_unknowns(np.arange(solid.grid.n_nodes))[:, None] + np.arange(d)
        system.x[at] = (solid.points @ R.T + [5.0, -3.0, 2.0])[:, :d]
    system.invalidate()
    assert np.abs(system.residual(vv.Static().step(0.0, 0.0))).max() < 1e-13
    assert np.abs(first.nodal_forces(system.x)).max() < 1e-13


@pytest.mark.parametrize(
    ("cell", "multipliers"), [("hex8", "dual"), ("quad4", "dual"), ("quad4", "standard")]
)
def test_free_pair_spins_for_thousands_of_steps(cell: str, multipliers: Multipliers) -> None:
    """Momenta stay for 3000 steps, and energy up to 1e-15 a step, which is what untied solids lose to rounding."""
    counts = ((2, 2, 1), (1, 1, 1))
    first, second, tie = pair(cell, multipliers, bend=0.05, counts=counts, density=1.0)
    middle = np.array([0.5, 0.5, 0.0 if cell == "quad4" else 0.5])

    def velocity(X: Array) -> Array:
        turning = np.cross((0.5, -0.3, 1.0) if cell == "hex8" else (0.0, 0.0, 1.0), X - middle)
        swinging = 0.3 * np.sin(4 * (X - middle)[:, ::-1])
        return np.asarray(turning + swinging * [1, 1, cell == "hex8"])

    first.velocity = second.velocity = velocity
    result = vv.simulate(vv.System([first, second, tie]), until=150.0, step=0.05)
    columns = ["momentum_x", "momentum_y", "angular_z"]
    if cell == "hex8":
        columns += ["momentum_z", "angular_x", "angular_y"]
    assert len(result.ledger["time"]) > 3000
    result.assert_conserved(*columns, tolerance=1e-12)
    result.assert_conserved("energy", tolerance=3000 * 1e-15)


# --- against meshes in one piece ----------------------------------------------------------------------------
def tip(halves: tuple[tuple[int, ...], ...], multipliers: Multipliers = "dual") -> tuple[float, vv.System]:
    """Deflection of a cantilever of length 4 under a load on its end; one mesh, or two halves tied."""
    steel = vv.SaintVenantKirchhoff(young=1000.0, poisson=0.3)
    parts: list[Any] = []
    for k, counts in enumerate(halves):
        length = 4.0 / len(halves)
        mesh = vv.BoxMesh(size=(length, 1, 1), counts=counts, origin=(k * length, 0, 0), cell="hex20")
        parts.append(vv.Solid(mesh=mesh, material=steel))
    solids = list(parts)
    if len(solids) == 2:
        parts.append(
            vv.Tie(
                first=solids[1],
                first_faces="x0",
                second=solids[0],
                second_faces="x1",
                multipliers=multipliers,
            )
        )
    parts.append(vv.Fixed(solid=solids[0], nodes="x0"))
    parts.append(vv.Traction(solid=solids[-1], faces="x1", traction=(0, 0, -3.0), times="t"))
    system = vv.System(parts)
    vv.quasi_static(system, until=1.0, step=0.5)
    return float(system.value(solids[-1].point((4, 0.5, 0.5)).position)[2]) - 0.5, system


@pytest.mark.parametrize("multipliers", KINDS)
def test_cantilever_tied_in_the_middle(multipliers: Multipliers) -> None:
    whole, _ = tip(((8, 2, 2),))
    matching, _ = tip(((4, 2, 2), (4, 2, 2)), multipliers)
    assert matching == pytest.approx(whole, rel=1e-10)
    other, _ = tip(((4, 2, 2), (4, 3, 3)), multipliers)
    assert other == pytest.approx(whole, rel=2e-3)


@pytest.mark.parametrize("multipliers", KINDS)
@pytest.mark.parametrize("hung", ["first", "second"])
def test_joint_on_a_tied_node(multipliers: Multipliers, hung: str) -> None:
    """A beam that hangs from a ball joint at a corner of the tied surfaces swings as one mesh does, nodes match."""
    corner, far, swung = (1.0, 1.0, 0.5), (2.0, 0.0, 0.0), []
    for halves in (1, 2):
        parts: list[Any] = [
            vv.Solid(
                mesh=vv.BoxMesh(size=(2 / halves, 1, 0.5), counts=(4 // halves, 2, 1), origin=(x, 0, 0)),
                material=RUBBER,
                density=0.1,
            )
            for x in range(halves)
        ]
        solids = list(parts)
        if halves == 2:
            tie = vv.Tie(
                first=solids[0],
                first_faces="x1",
                second=solids[1],
                second_faces="x0",
                multipliers=multipliers,
            )
            parts.append(tie)
        held = solids[-1] if hung == "second" else solids[0]
        ground = vv.Ground()
        parts += [ground, vv.Spherical(a=ground, b=held, at=corner), vv.Gravity()]
        system = vv.System(parts)
        result = vv.simulate(system, until=0.6, step=0.02)
        result.assert_conserved("energy", tolerance=1e-10)
        assert system.value(held.point(corner).position) == pytest.approx(corner, abs=1e-11)
        swung.append(system.value(solids[-1].point(far).position))
    assert np.linalg.norm(swung[0] - far) > 0.5
    assert swung[1] == pytest.approx(swung[0], abs=1e-8)


def ring(n: int, multipliers: Multipliers, cell: str = "quad4") -> tuple[float, float]:
    """Errors of displacement and hoop stress of a thick ring under pressure, tied at the middle radius (Lame).

    A quarter between planes of symmetry; the outer part has fewer elements around than the inner one.
    """
    a, m, b, p = 1.0, 1.5, 2.0, 1.0
    steel = vv.LinearElastic(young=100.0, poisson=0.3)
    parts: list[Any] = []
    for low, high, around in ((a, m, 3 * n), (m, b, 2 * n)):
        mesh = vv.RectangleMesh(
            size=(high - low, 0.5 * np.pi), counts=(n, around), cell=cell, origin=(low, 0)
        )
        grid = mesh.build()
        r, t = grid.points.T
        X = np.column_stack([r * np.cos(t), r * np.sin(t)])
        X[np.abs(X) < 1e-14] = 0.0
        parts.append(vv.Solid(mesh=vv.Mesh(X, grid.cells, face_sets=grid.face_sets), material=steel))
    inner, outer = parts
    for solid in (inner, outer):
        parts.append(vv.SymmetryPlane(solid=solid, nodes="y0", normal=(0, 1, 0)))
        parts.append(vv.SymmetryPlane(solid=solid, nodes="y1", normal=(1, 0, 0)))
    parts.append(
        vv.Tie(first=inner, first_faces="x1", second=outer, second_faces="x0", multipliers=multipliers)
    )
    parts.append(vv.Pressure(solid=inner, faces="x0", pressure=p, follower=False))
    system = vv.System(parts)
    vv.quasi_static(system, until=1.0, step=1.0)
    k, E, nu = p * a**2 / (b**2 - a**2), 100.0, 0.3
    square = count = worst = 0.0
    for solid in (inner, outer):
        X = solid.points[:, :2]
        r = np.linalg.norm(X, axis=1)
        radial = (1 + nu) / E * k * ((1 - 2 * nu) * r + b**2 / r)
        u = solid.displacements(system.x)[:, :2]
        square += float(((u - (radial / r)[:, None] * X) ** 2).sum())
        count += len(X)
        worst = max(worst, float(np.abs(u - (radial / r)[:, None] * X).max()))
    return float(np.sqrt(square / count)), worst


@pytest.mark.parametrize("multipliers", KINDS)
def test_order_of_convergence(multipliers: Multipliers) -> None:
    """Second order in displacements, as without a tie, though the surfaces are curved and faceted differently."""
    errors = np.array([ring(n, multipliers) for n in (2, 4, 8)])
    rates = np.log2(errors[:-1] / errors[1:])
    assert (rates[-1] > 1.85).all(), rates


def bent(components: list[Any]) -> vv.System:
    system = vv.System(components)
    vv.quasi_static(system, until=1.0, step=0.5)
    return system


def test_half_a_model_is_the_whole_one() -> None:
    """A plane of symmetry across the tied surface: the halves of a symmetric pair give the same, to round-off."""
    displacements = []
    for n in (1, 2):  # halves
        parts = []
        for low, high, around in ((0.0, 0.6, 3), (0.6, 1.0, 2)):
            mesh = vv.BoxMesh(
                size=(0.5 * n, 1, high - low), counts=(around * n, around + 1, 2), origin=(0, 0, low)
            )
            grid = mesh.build().moved((-0.5 * (n - 1), 0, 0))
            parts.append(vv.Solid(mesh=grid, material=RUBBER))
        first, second = parts
        tie = vv.Tie(first=first, first_faces="z1", second=second, second_faces="z0")
        held: list[Any] = [vv.Fixed(solid=first, nodes="z0"), tie]
        if n == 1:
            held += [vv.SymmetryPlane(solid=s, nodes="x0", normal=(1, 0, 0)) for s in parts]
        load = vv.Traction(solid=second, faces="z1", traction=(0, 1.0, -1.0), times="t")
        system = bent([first, second, *held, load])
        u = second.displacements(system.x)
        order = np.lexsort(np.round(second.points, 9).T)
        displacements.append(u[order][second.points[order, 0] >= 0])
    assert np.abs(displacements[0]).max() > 0.05
    np.testing.assert_allclose(displacements[0], displacements[1], atol=1e-12)


def three(multipliers: Multipliers) -> list[Any]:
    """A foot under two blocks side by side, all tied: nodes where two ties meet."""
    foot = vv.Solid(mesh=vv.BoxMesh(size=(2, 1, 1), counts=(4, 2, 1)), material=RUBBER)
    left = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(3, 3, 2), origin=(0, 0, 1)), material=RUBBER)
    right = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1), origin=(1, 0, 1)), material=RUBBER)
    return [
        foot, left, right,
        vv.Tie(first=left, first_faces="z0", second=foot, second_faces="z1", multipliers=multipliers),
        vv.Tie(first=foot, first_faces="z1", second=right, second_faces="z0", multipliers=multipliers),
        vv.Fixed(solid=foot, nodes="z0"),
        vv.Traction(solid=right, faces="z1", traction=(0.5, 0, -0.5), times="t"),
    ]  # fmt: skip


def test_chains_of_ties() -> None:
    """Nodes that follow nodes that follow others: what cannot be eliminated stays among the equations."""
    system = bent(three("dual"))
    assert 0 < system.core.n_eliminated < system.n_constraints
    other = bent(three("standard"))
    assert np.abs(system.components[1].displacements(system.x)).max() > 0.02
    foot, again = system.components[0], other.components[0]
    np.testing.assert_allclose(foot.displacements(system.x), again.displacements(other.x), atol=0.01)


@pytest.mark.parametrize("build", [lambda: three("dual"), lambda: [*pair("quad8", bend=0.05)]])
def test_elimination_changes_nothing(build: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """With and without the nodes of the first surfaces among the equations, multipliers included."""
    states = []
    for eliminated in (True, False):
        if not eliminated:
            monkeypatch.setattr(vv.model.reductions.Reductions, "eliminate", lambda *_: None)
        parts = build()
        if not any(isinstance(c, vv.Fixed) for c in parts):
            parts += [
                vv.Fixed(solid=parts[1], nodes="y1"),
                vv.Traction(solid=parts[0], faces="y0", traction=(0.5, -0.5, 0), times="t"),
            ]
        system = bent(parts)
        assert (system.core.n_eliminated > 0) is eliminated
        states.append(system.x.copy())
    np.testing.assert_allclose(states[0], states[1], atol=1e-10)


def test_loads_on_partly_covered_facets() -> None:
    """The second surface covers facets of the first one partly, some by 2 per cent: constant stress on it is exact."""
    for multipliers in KINDS:
        parts = [
            vv.Solid(mesh=vv.BoxMesh(size=size, counts=counts, origin=origin), material=RUBBER)
            for size, counts, origin in (
                ((2.0, 1.5, 1.0), (8, 6, 1), (-0.25, 0.0, 0.0)),
                ((1.255, 1.0, 1.0), (3, 2, 1), (0.0, 0.1, 1.0)),
            )
        ]
        tie = vv.Tie(
            first=parts[0], first_faces="z1", second=parts[1], second_faces="z0", multipliers=multipliers
        )
        n = len(tie._nodes)
        weights = tie._rows.sum(axis=0)
        exact = np.zeros(parts[1].grid.n_nodes)
        for face in parts[1].faces("z0").cells["quad4"]:
            exact[face] += 1.255 / 3 / 2 / 4
        np.testing.assert_allclose(-weights[n:], exact[tie._others], atol=1e-15)
        np.testing.assert_allclose(tie._rows.sum(axis=1), 0.0, atol=1e-16)
        X = np.vstack([parts[0].points[tie._nodes], parts[1].points[tie._others]])
        assert np.abs(tie._rows @ X).max() < 1e-15


# --- refused ------------------------------------------------------------------------------------------------
def test_surfaces_that_do_not_touch() -> None:
    first = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2)), material=RUBBER, name="a")
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2), origin=(0, 0, 1.25))
    second = vv.Solid(mesh=mesh, material=RUBBER, name="b")
    with pytest.raises(vv.InputError, match=r"'a' and Solid 'b' do not touch.*0\.25 apart.*larger reach"):
        vv.Tie(first=first, first_faces="z1", second=second, second_faces="z0")
    with pytest.raises(vv.InputError, match="do not touch"):  # sides that look the same way
        vv.Tie(first=first, first_faces="z1", second=second, second_faces="z1", reach=2.0)
    tie = vv.Tie(first=first, first_faces="z1", second=second, second_faces="z0", reach=0.3)
    vv.System([first, second, tie])
    assert tie.moved == pytest.approx(0.25)


def test_nodes_that_something_else_holds() -> None:
    def refused(conflict: Any, match: str) -> None:
        first, second, tie = pair("hex8")
        parts = conflict(first, second)
        with pytest.raises(vv.InputError, match=match):
            vv.System([first, second, tie, *parts])

    edge = r"Tie 'tie-1' lets \d+ nodes of Solid 'solid-1' follow Solid 'solid-2' that {}.* holds as well.*exchange"
    refused(lambda a, b: [vv.Fixed(solid=a, nodes="x0")], edge.format("Fixed"))
    refused(
        lambda a, b: [vv.Fixed(solid=a, nodes="x0", directions=(k == 0, k == 1, k == 2)) for k in range(3)],
        edge.format("Fixed"),
    )
    refused(
        lambda a, b: [vv.Prescribed(solid=a, nodes="x0", motion=("t", None, None))], edge.format("Prescribed")
    )
    refused(
        lambda a, b: [vv.SymmetryPlane(solid=a, nodes="x0", normal=(1, 1, 0))], edge.format("SymmetryPlane")
    )
    refused(lambda a, b: [vv.RigidCoupling(solid=a, faces="z1")], edge.format("RigidCoupling"))
    refused(
        lambda a, b: [vv.Tie(first=a, first_faces="z1", second=b, second_faces="z0")],
        edge.format("Tie 'tie-2'"),
    )


def test_other_bad_input() -> None:
    first, second, _ = pair("hex8")
    plate = pair("quad4")[0]
    with pytest.raises(vv.InputError, match="same Solid"):
        vv.Tie(first=first, second=first)
    with pytest.raises(vv.InputError, match="differ in dimension"):
        vv.Tie(first=first, second=plate)
    with pytest.raises(vv.InputError, match=r"no set.*'top'"):
        vv.Tie(first=first, first_faces="top", second=second)
    with pytest.raises(vv.InputError, match="reach = -1 is not positive"):
        vv.Tie(first=first, second=second, reach=-1.0)
    empty = first.faces("z1").where(np.zeros(first.faces("z1").n_faces, dtype=bool))
    with pytest.raises(vv.InputError, match=r"Tie: Solid.*is empty"):
        vv.Tie(first=first, first_faces=empty, second=second)


def test_surfaces_that_fit_badly() -> None:
    first, second, tie = pair("quad4", bend=0.4, counts=((6, 6, 1), (1, 1, 1)))
    with pytest.raises(vv.InputError, match=r"would have to move by 0\.\d+ .* more than the reach"):
        vv.System([first, second, tie])
