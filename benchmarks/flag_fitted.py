"""The flag of Turek & Hron with a body-fitted fluid and small displacements, for solids of any compressibility.

The flow about the flag as it is and about the flag bent by a little gives loads, the loads on the solid alone its
displacement; FSI1 lies where both agree, on a straight line.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from flag_case import CENTRE, END, HEIGHT, LENGTH, RADIUS, THICK, Rows, channel, conditions, flag_mesh
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]

ROOT, BENT = CENTRE[0] + RADIUS, 0.8e-3
NORMALS = {"y0": (0.0, -1.0), "y1": (0.0, 1.0), "x1": (1.0, 0.0)}


def bent(X: Array, tip: float) -> Array:
    """Places (n, 2) moved as a beam under an even load is bent, less beside and after the flag."""
    s = (X[:, 0] - ROOT) / (END - ROOT)
    inside = np.clip(s, 0, 1)
    along = np.where(
        s <= 1, inside**2 * (6 - 4 * inside + inside**2) / 3, np.clip(1 + END - X[:, 0], 0, None)
    )
    beside = np.clip(1 - np.maximum(np.abs(X[:, 1] - CENTRE[1]) - THICK, 0) / 0.15, 0, None)
    return np.column_stack([X[:, 0], X[:, 1] + tip * along * beside])


def fitted(rows: Rows, tip: float) -> vv.Mesh:
    """The channel without the flag's cells, bent."""
    full = channel(rows)
    nodes, centres = full.cells["quad9"], full.centres
    flag = (
        (np.abs(centres[:, 1] - CENTRE[1]) < THICK / 2) & (centres[:, 0] > CENTRE[0]) & (centres[:, 0] < END)
    )
    used, numbers = np.unique(nodes[~flag], return_inverse=True)
    straight = vv.Mesh(full.points[used], {"quad9": numbers.reshape(-1, 9)})
    hair = 1e-6

    def off(X: Array) -> Array:
        return np.asarray(np.abs(np.hypot(*(X[:, :2] - CENTRE).T) - RADIUS))

    for name, on in {
        "x0": lambda X: X[:, 0] < hair,
        "x1": lambda X: X[:, 0] > LENGTH - hair,
        "y0": lambda X: X[:, 1] < hair,
        "y1": lambda X: X[:, 1] > HEIGHT - hair,
        "cylinder": lambda X: off(X) < 1e-4,
        "flag": lambda X: (
            (np.abs(X[:, 1] - CENTRE[1]) < THICK / 2 + hair) & (X[:, 0] > CENTRE[0]) & (X[:, 0] < END + hair)
        ),
    }.items():
        straight = straight.with_faces(name, on)
    return vv.Mesh(bent(straight.points, tip), straight.cells, face_sets=straight.face_sets)


def flow(rows: Rows, tip: float) -> tuple[vv.Fluid, vv.System, Array]:
    """The steady flow, and drag and lift (2,)."""
    water = vv.Fluid(mesh=fitted(rows, tip), density=1000.0, viscosity=1.0)
    around = conditions(water, lambda t: 0.2 * t, ("y0", "y1", "cylinder", "flag"))
    system = vv.System([water, *around], vv.Newton(tolerance=1e-9))
    vv.quasi_static(system, until=1.0, step=0.5)
    forces = [vv.FlowForce(fluid=water, faces=side)(system) for side in ("cylinder", "flag")]
    return water, system, np.sum(forces, axis=0)[:2]


def load(water: vv.Fluid, system: vv.System, tip: float, side: str) -> Callable[[float, Array], Array]:
    """Tractions (n, 3) on a side of the flag by places in it that is not bent; zero away from the surface."""
    normal = np.array(NORMALS[side])

    def traction(t: float, X: Array) -> Array:
        places = bent(X[:, :2], tip) + 1e-6 * normal
        wet = water.location.find(places)[0] >= 0
        places[~wet] = (1.0, CENTRE[1])
        at = water.at(places)
        rates = np.einsum(
            "nkc,nkd->ncd", water.velocities(system.x, system.v)[at.nodes][:, :, :2], at.gradients
        )
        stress = water.viscosity * (rates + np.swapaxes(rates, 1, 2)) - at.pressures(system.x)[
            :, None, None
        ] * np.eye(2)
        return np.pad(t * wet[:, None] * (stress @ normal), ((0, 0), (0, 1)))

    return traction


def displacement(water: vv.Fluid, system: vv.System, tip: float, poisson: float) -> Array:
    """Of the end of the solid alone (2,)."""
    solid = vv.Solid(
        mesh=flag_mesh(28, 2),
        material=vv.SaintVenantKirchhoff(shear=0.5e6, poisson=poisson),
        formulation="mixed" if poisson > 0.45 else "displacement",
    )
    loads = [
        vv.Traction(solid=solid, faces=side, traction=load(water, system, tip, side)) for side in NORMALS
    ]
    alone = vv.System([solid, vv.Fixed(solid=solid, nodes="x0"), *loads], vv.Newton(tolerance=1e-9))
    vv.quasi_static(alone, until=1.0, step=1.0)
    end = int(np.argmin(np.linalg.norm(solid.points[:, :2] - (END, CENTRE[1]), axis=1)))
    return solid.displacements(alone.x)[end, :2]


def together(rows: Rows, ratios: tuple[float, ...]) -> dict[float, tuple[Array, Array]]:
    """By Poisson's ratio: displacement (2,) under the load of the straight flag, and FSI1 (4,) with forces."""
    straight, curved = flow(rows, 0.0), flow(rows, BENT)
    found = {}
    for poisson in ratios:
        u0, u1 = (displacement(*at[:2], tip, poisson) for at, tip in ((straight, 0.0), (curved, BENT)))
        slope = (u1 - u0) / BENT
        tip = u0[1] / (1 - slope[1])
        found[poisson] = (
            u0,
            np.hstack([u0 + slope * tip, straight[2] + (curved[2] - straight[2]) * tip / BENT]),
        )
    return found
