"""The linear obstacle course of shells and benchmarks with large rotations, with any type of cells."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

import visviva as vv
from visviva.mesh.faces import Faces

Array = NDArray[np.float64]
SAINT_VENANT = 0.22868
"""Torsion constant of a rectangle of 2 : 1 by width and thickness cubed."""


def sheet(thickness: float, young: float, poisson: float = 0.0, **options: Any) -> vv.HomogeneousSection:
    return vv.HomogeneousSection(thickness=thickness, young=young, poisson=poisson, **options)


def stretching(thickness: float, young: float, poisson: float = 0.0, **options: Any) -> vv.SolidSection:
    """The same for directors that stretch."""
    material = vv.SaintVenantKirchhoff(young=young, poisson=poisson)
    return vv.SolidSection(material=material, thickness=thickness, **options)


def bent(size: tuple[float, float], counts: tuple[int, int], to: Any, cell: str = "quad4") -> vv.Mesh:
    """A rectangle whose points (n, 2) are taken to space; `counts` of nodes between nodes, whatever the cells."""
    order = 2 if cell in ("quad9", "tri6") else 1
    flat = vv.RectangleMesh(size=size, counts=tuple(n // order for n in counts), cell=cell).build()
    return vv.Mesh(to(*flat.points.T), flat.cells, face_sets=flat.face_sets)


def part_of_cylinder(radius: float, length: float, angle: float, n: int, cell: str = "quad4") -> vv.Mesh:
    """Axis y; the angle counts from the top."""
    return bent(
        (length, angle),
        (n, n),
        lambda y, a: np.stack([radius * np.sin(a), y, radius * np.cos(a)], axis=1),
        cell,
    )


def corner(shell: vv.Shell, *edges: str) -> int:
    """The node that edges have in common."""
    first, *others = (shell.nodes(edge) for edge in edges)
    (node,) = (k for k in first if all(k in other for other in others))
    return int(node)


def symmetric(shell: vv.Shell, **planes: str) -> list[Any]:
    """Planes of symmetry by the axis that they are normal to."""
    normal = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}
    return [vv.SymmetryPlane(solid=shell, nodes=edge, normal=normal[axis]) for axis, edge in planes.items()]


def linear(shell: vv.Shell, *others: Any) -> vv.System:
    """In equilibrium with a load that is small."""
    system = vv.System([shell, *others])
    vv.quasi_static(system, until=1.0, step=1.0)
    return system


# --- the linear obstacle course: what is found, by its reference ------------------------------------------------
def scordelis_lo(n: int, cell: str, **options: Any) -> float:
    """A roof under its weight; deep shells 0.3006, MacNeal & Harder 0.3024."""
    shell = vv.Shell(
        mesh=part_of_cylinder(25.0, 25.0, np.radians(40), n, cell), section=sheet(0.25, 4.32e8), **options
    )
    diaphragm = vv.Fixed(solid=shell, nodes="x0", directions=(True, False, True))
    weight = vv.Traction(solid=shell, faces="upper", traction=(0, 0, -90e-4), middle=True)
    system = linear(shell, diaphragm, *symmetric(shell, y="x1", x="y0"), weight)
    return -1e4 * float(shell.displacements(system.x)[corner(shell, "x1", "y1"), 2]) / 0.3024


def pinched_cylinder(n: int, cell: str, **options: Any) -> float:
    """An eighth of it, between diaphragms: 1.82488e-5 (Lindberg et al. 1969)."""
    mesh = part_of_cylinder(300.0, 300.0, np.pi / 2, n, cell)
    shell = vv.Shell(mesh=mesh, section=sheet(3.0, 3e6, 0.3), **options)
    diaphragm = vv.Fixed(solid=shell, nodes="x0", directions=(True, False, True))
    top = corner(shell, "x1", "y0")
    pinch = vv.Force(on=shell.point(shell.points[top]), force=(0, 0, -0.25))
    system = linear(shell, diaphragm, *symmetric(shell, y="x1", x="y0", z="y1"), pinch)
    return -float(shell.displacements(system.x)[top, 2]) / 1.82488e-5


def hemisphere(n: int, cell: str, **options: Any) -> float:
    """With a hole, pulled and pushed at its rim, it bends without stretching: 0.0940 (MacNeal & Harder)."""
    shell, others, (pulled, _) = pinched_hemisphere(n, cell, 1e-3, **options)
    system = linear(shell, *others)
    return 1e3 * float(shell.displacements(system.x)[pulled, 0]) / 0.0940


def pinched_hemisphere(
    n: int, cell: str, force: float, **options: Any
) -> tuple[vv.Shell, list[Any], tuple[int, int]]:
    """A quarter of a hemisphere with a hole, what acts on it, and the nodes that are pulled and pushed."""

    def to(a: Array, b: Array) -> Array:
        return 10.0 * np.stack([np.cos(b) * np.cos(a), np.cos(b) * np.sin(a), np.sin(b)], axis=1)

    mesh = bent((np.pi / 2, np.radians(72)), (n, n), to, cell)
    shell = vv.Shell(mesh=mesh, section=sheet(0.04, 6.825e7, 0.3), **options)
    pulled, pushed = corner(shell, "x0", "y0"), corner(shell, "x1", "y0")
    others = [
        *symmetric(shell, y="x0", x="x1"),
        vv.Fixed(solid=shell, nodes=[pulled], directions=(False, False, True)),
        vv.Force(on=shell.point(shell.points[pulled]), force=(force, 0, 0), times="t"),
        vv.Force(on=shell.point(shell.points[pushed]), force=(0, -force, 0), times="t"),
    ]
    return shell, others, (pulled, pushed)


def twisted(n: int, cell: str, axis: int, thickness: float = 0.32, **options: Any) -> float:
    """A cantilever twisted by 90 degrees, n by n / 6 nodes, loaded along y or z at its end (Zupan & Saje)."""
    thick = thickness > 0.1
    load, expected = (
        (1e-3, {2: 5.424534868469e-3, 1: 1.753248285256e-3}) if thick else (1e-9, {2: 5.256e-3, 1: 1.294e-3})
    )
    scale = 1.0 if thick else 1e-6

    def to(x: Array, y: Array) -> Array:
        a = np.pi / 2 * x / 12
        return np.stack([x, (y - 0.55) * np.cos(a), (y - 0.55) * np.sin(a)], axis=1)

    across = max(2, n // 6)
    shell = vv.Shell(
        mesh=bent((12.0, 1.1), (n, across), to, cell), section=sheet(thickness, 29e6, 0.22), **options
    )
    force = np.zeros(3)
    force[axis] = load
    pull = vv.Force(on=shell.point((12.0, 0.0, 0.0)), force=tuple(force))
    system = linear(shell, vv.Clamped(solid=shell, nodes="x0"), pull)
    found = system.value(shell.point((12.0, 0.0, 0.0)).position)[axis]
    return float(found) / load * scale / expected[axis]


def raasch(n: int, cell: str, **options: Any) -> float:
    """A hook of two arcs, clamped, sheared at its end along its width: 5.022012648672."""
    radii, angles = (14.0, 46.0), (np.radians(60), np.radians(150))
    lengths = [r * a for r, a in zip(radii, angles, strict=True)]

    def to(s: Array, y: Array) -> Array:
        first = np.minimum(s, lengths[0]) / radii[0]
        x1, z1 = radii[0] * np.sin(first), radii[0] * (np.cos(first) - 1)
        along = np.maximum(s - lengths[0], 0.0) / radii[1]
        a = angles[0]
        x2 = radii[1] * (np.sin(a) - np.sin(a - along))
        z2 = -radii[1] * (np.cos(a - along) - np.cos(a))
        return np.stack([x1 + x2, y, z1 + z2], axis=1)

    share = lengths[0] / sum(lengths)

    def spaced(s: Array, y: Array) -> Array:
        """A third of the cells on the first arc."""
        t = s / sum(lengths)
        inner = np.where(t < 0.25, t / 0.25 * share, share + (t - 0.25) / 0.75 * (1 - share))
        return to(inner * sum(lengths), y)

    mesh = bent((sum(lengths), 20.0), (n, max(2, n // 4)), spaced, cell)
    shell = vv.Shell(mesh=mesh, section=sheet(2.0, 3300.0, 0.35), **options)
    shear = vv.Traction(solid=shell, faces="x1", traction=(0, 1e-3 / 20, 0))
    system = linear(shell, vv.Clamped(solid=shell, nodes="x0"), shear)
    end = shell.nodes("x1")
    return 1e3 * float(shell.displacements(system.x)[end, 1].mean()) / 5.022012648672


def curved_cantilever(n: int, cell: str, axis: int, across: int = 2, **options: Any) -> float:
    """A quarter of a flat ring, n nodes along and two across, loaded in its plane or across it (MacNeal)."""

    def to(a: Array, r: Array) -> Array:
        return np.stack([(4.12 + r) * np.sin(a), (4.12 + r) * np.cos(a), 0 * a], axis=1)

    mesh = bent((np.pi / 2, 0.2), (n, across), to, cell)
    shell = vv.Shell(mesh=mesh, section=sheet(0.1, 1e7, 0.25), **options)
    force = np.zeros(3)
    force[axis] = 1e-3
    tip = (4.22, 0.0, 0.0)
    system = linear(
        shell, vv.Clamped(solid=shell, nodes="x0"), vv.Force(on=shell.point(tip), force=tuple(force))
    )
    found = system.value(shell.point(tip).position)[axis] - tip[axis]
    return 1e3 * float(found) / {0: 0.08734, 2: 0.5022}[axis]


def straight_cantilever(n: int, cell: str, axis: int, **options: Any) -> float:
    """A strip of 6 x 0.2 x 0.1, n nodes along and a cell across, by what a slender beam gives (MacNeal & Harder)."""
    across = 2 if cell in ("quad9", "tri6") else 1
    mesh = bent((6.0, 0.2), (n, across), lambda x, y: np.stack([x, y, 0 * x], axis=1), cell)
    shell = vv.Shell(mesh=mesh, section=sheet(0.1, 1e7, 0.3), **options)
    force = np.zeros(3)
    force[axis] = 1e-4
    pull = vv.Traction(solid=shell, faces="x1", traction=tuple(force / 0.2))
    system = linear(shell, vv.Clamped(solid=shell, nodes="x0"), pull)
    found = shell.displacements(system.x)[shell.nodes("x1"), axis].mean()
    return 1e4 * float(found) / {0: 3e-5, 1: 0.1081, 2: 0.4321}[axis]


def twisted_cantilever(n: int, cell: str, **options: Any) -> float:
    """The same strip, n nodes along and across, under a moment about its axis, by Saint-Venant's T L / G J.

    J is 0.22868 w t^3 (Timoshenko & Goodier 1970), and the twist for a moment of 1 is 0.03411. MacNeal & Harder
    give 0.03208, 6 % less. A shell with a shear factor of 5/6 has t^3 / 3 (w - 2 tanh(k w / 2) / k) with
    k = 10^(1/2) / t, 0.2 % less than Saint-Venant, once cells across are smaller than the thickness.
    """
    mesh = bent((6.0, 0.2), (n, n), lambda x, y: np.stack([x, y - 0.1, 0 * x], axis=1), cell)
    shell = vv.Shell(mesh=mesh, section=sheet(0.1, 1e7, 0.3), **options)
    end = vv.DistributedCoupling(solid=shell, faces="x1")
    moment = 1e-4
    load = vv.Torque(on=end, torque=(moment, 0, 0), times="t")
    system = linear(shell, vv.Clamped(solid=shell, nodes="x0"), end, load)
    edge = shell.nodes("x1")
    y, up = shell.points[edge, 1], shell.displacements(system.x)[edge, 2]
    stiffness = 1e7 / 2.6 * SAINT_VENANT * 0.2 * 0.1**3
    return float((y @ up) / (y @ y) * stiffness / (moment * 6.0))


def closed_hemisphere(n: int, cell: str, **options: Any) -> float:
    """A quarter of it as three patches of n / 2 cells, pulled and pushed at its rim: 0.0924."""
    corners = np.eye(3)
    middle, m = np.ones(3), n // 2
    points, cells = [], []
    s, t = (g.ravel() for g in np.meshgrid(*[np.linspace(0, 1, m + 1)] * 2, indexing="ij"))
    for k in range(3):
        a, b, c = corners[k], corners[k] + corners[(k + 1) % 3], corners[k] + corners[k - 1]
        a, b, c, d = (v / np.linalg.norm(v) for v in (a, b, c, middle))
        w = np.stack([(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t], axis=1)
        first = k * (m + 1) ** 2 + np.arange((m + 1) ** 2).reshape(m + 1, m + 1)
        points.append(w @ [a, b, c, d])
        cells.append(np.stack([first[:-1, :-1], first[1:, :-1], first[1:, 1:], first[:-1, 1:]], axis=-1))
    places = np.concatenate(points)
    _, keep, new = np.unique(np.round(places, 9), axis=0, return_index=True, return_inverse=True)
    mesh = vv.Mesh(places[keep], {"quad4": new.ravel()[np.concatenate(cells).reshape(-1, 4)]})
    mesh = mesh.quadratic(cell) if cell == "quad9" else mesh
    on_sphere = 10.0 * mesh.points / np.linalg.norm(mesh.points, axis=1)[:, None]
    on_sphere[np.abs(on_sphere) < 1e-9] = 0.0
    shell = vv.Shell(mesh=vv.Mesh(on_sphere, mesh.cells), section=sheet(0.04, 6.825e7, 0.3), **options)
    pulled, pushed, pole = (int(np.argmax(shell.points[:, k])) for k in range(3))
    planes = [
        vv.SymmetryPlane(solid=shell, nodes=np.flatnonzero(shell.points[:, k] == 0), normal=tuple(corners[k]))
        for k in range(2)
    ]
    system = linear(
        shell,
        *planes,
        vv.Fixed(solid=shell, nodes=[pole], directions=(False, False, True)),
        vv.Force(on=shell.point(shell.points[pulled]), force=(1e-3, 0, 0)),
        vv.Force(on=shell.point(shell.points[pushed]), force=(0, -1e-3, 0)),
    )
    return 1e3 * float(shell.displacements(system.x)[pulled, 0]) / 0.0924


def z_section(n: int, cell: str, **options: Any) -> float:
    """A Z section of flanges of 1 and a web of 2, twisted at its end: -108 MPa at a flange (NAFEMS LE5)."""

    def to(x: Array, s: Array) -> Array:
        y = np.where(s < 1, s - 1, np.where(s > 3, s - 3, 0.0))
        return np.stack([x, y, np.clip(s - 2, -1, 1)], axis=1)

    shell = vv.Shell(
        mesh=bent((10.0, 4.0), (2 * n, n), to, cell),
        section=sheet(0.1, 210e9, 0.3),
        kinks="rigid",
        first=(1, 0, 0),
        **options,
    )
    end = shell.faces("x1")
    loads = []
    for side in (-1.0, 1.0):
        ((kind, nodes),) = end.cells.items()
        there = np.all(np.abs(shell.points[nodes][..., 2] - side) < 1e-6, axis=1)
        flange = Faces({kind: nodes[there]}, {kind: end.owners[kind][there]})
        loads.append(vv.Traction(solid=shell, faces=flange, traction=(0, side * 60.0, 0)))
    system = linear(shell, vv.Clamped(solid=shell, nodes="x0"), *loads)
    return stress_at_flange(shell, system) * 1e4 / -108e6


def stress_at_flange(shell: vv.Shell, system: vv.System) -> float:
    """Along the flange above, at its edge a quarter along, from the linear stress of the points near it."""
    (part,) = shell.parts
    X = np.einsum("qk,mkc->mqc", part.N, shell.points[part.cells]).reshape(-1, 3)
    stress = shell.resultants(system.x)[..., 0].ravel() / 0.1
    near = (X[:, 2] > 1 - 1e-9) & (np.abs(X[:, 0] - 2.5) < 1.26)
    x, y = X[near, 0] - 2.5, X[near, 1] - 1.0
    return float(np.linalg.lstsq(np.stack([1 + 0 * x, x, y, x * y], axis=1), stress[near], rcond=None)[0][0])


def hypar(n: int, cell: str, thickness: float, **options: Any) -> float:
    """A clamped hyperbolic paraboloid under its weight: the energy of half of it (Bathe et al. 2000)."""

    def to(x: Array, y: Array) -> Array:
        return np.stack([x - 0.5, y, (x - 0.5) ** 2 - y**2], axis=1)

    mesh = bent((1.0, 0.5), (2 * n, n), to, cell)
    shell = vv.Shell(mesh=mesh, section=sheet(thickness, 2e11, 0.3), **options)
    scale = {1e-2: 1e-3, 1e-3: 1e-4, 1e-4: 1e-6}[thickness]
    load = 8000.0 * thickness * scale
    weight = vv.Traction(solid=shell, faces="upper", traction=(0, 0, -load), middle=True)
    system = linear(shell, vv.Clamped(solid=shell, nodes="x0"), *symmetric(shell, y="y0"), weight)
    energy = 2 * weighed(shell, system, load) / scale**2
    return energy / {1e-2: 1.6790e-3, 1e-3: 1.1013e-2, 1e-4: 8.9867e-2}[thickness]


def weighed(shell: vv.Shell, system: vv.System, weight: float) -> float:
    """Half the work of a weight per area: the strain energy."""
    total = 0.0
    for points in shell.face_points(shell.faces("upper")):
        u = shell.displacements(system.x)[points.nodes][..., 2]
        total -= 0.5 * weight * float(np.einsum("mq,qk,mk->", points.size, points.N, u))
    return total


CASES: dict[str, tuple[Callable[..., float], dict[str, Any]]] = {
    "Scordelis-Lo roof": (scordelis_lo, {}),
    "pinched cylinder": (pinched_cylinder, {}),
    "hemisphere with a hole": (hemisphere, {}),
    "closed hemisphere": (closed_hemisphere, {}),
    "twisted beam, in its plane": (twisted, {"axis": 2}),
    "twisted beam, across": (twisted, {"axis": 1}),
    "thin twisted beam, in its plane": (twisted, {"axis": 2, "thickness": 0.0032}),
    "thin twisted beam, across": (twisted, {"axis": 1, "thickness": 0.0032}),
    "Raasch's hook": (raasch, {}),
    "curved cantilever, in its plane": (curved_cantilever, {"axis": 0}),
    "curved cantilever, across": (curved_cantilever, {"axis": 2}),
    "straight cantilever, along": (straight_cantilever, {"axis": 0}),
    "straight cantilever, in its plane": (straight_cantilever, {"axis": 1}),
    "straight cantilever, across": (straight_cantilever, {"axis": 2}),
    "straight cantilever, twist": (twisted_cantilever, {}),
    "Z section, stress": (z_section, {}),
    "hypar, 1/100": (hypar, {"thickness": 1e-2}),
    "hypar, 1/1000": (hypar, {"thickness": 1e-3}),
    "hypar, 1/10000": (hypar, {"thickness": 1e-4}),
}
