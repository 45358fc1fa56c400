"""What is immersed passes the periodic faces of a fluid as if these were nowhere."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from visviva.base.errors import InputError

Array = NDArray[np.float64]

PERIOD, SPEED = 2.0, 1.0
SOFT: dict[str, Any] = {"material": vv.NeoHooke(young=20.0, poisson=0.3), "density": 1.5}


def shear(X: Array) -> Array:
    """Along x, twice as fast above as below, with a disturbance."""
    return np.asarray(SPEED * (1 + X[:, 1:2]) * [1.0, 0.0, 0.0])


def floating(kind: str, at: float) -> vv.Solid | vv.RigidBody:
    """A body around (at, 0.5)."""
    if kind == "rigid":
        box = vv.Box(size=(0.4, 0.25, 1.0))
        return vv.RigidBody(shape=box, density=1.5, position=(at, 0.45, 0.0))
    size, counts = ((0.4, 0.25), (4, 3)) if kind == "soft" else ((0.02, 0.6), (1, 8))
    origin = (at - size[0] / 2, 0.45 - size[1] / 2)
    return vv.Solid(mesh=vv.RectangleMesh(size=size, counts=counts, origin=origin), **SOFT)


def channel(kind: str, cell: str, at: float, sealing: float = 1.0) -> tuple[vv.System, Any]:
    """A body in a channel without ends between walls that move."""
    mesh = vv.RectangleMesh(size=(PERIOD, 1.0), counts=(12, 6), cell=cell)
    fluid = vv.Fluid(
        mesh=mesh,
        density=1.0,
        viscosity=0.05,
        velocity=shear,
        periodic=(("x0", "x1"),),
        body_force=(0.3, 0.0, 0.0),
    )
    walls = [
        vv.VelocityBoundary(fluid=fluid, faces=f"y{k}", velocity=(SPEED * (1 + k), 0.0, 0.0)) for k in (0, 1)
    ]
    body = floating(kind, at)
    more: Any = {"fluid": fluid, "sealing": sealing}
    wet = vv.ImmersedBody(body=body, **more) if kind == "rigid" else vv.Immersed(solid=body, **more)
    return vv.System([fluid, *walls, body, wet], vv.Newton(tolerance=1e-12)), body


def places(body: Any, x: Array) -> Array:
    """Of nodes, or of the tips of directors."""
    if isinstance(body, vv.Solid):
        return np.asarray(body.positions(x))
    return np.array([body.place(X).value(x) for X in np.eye(3)])


@pytest.mark.parametrize("kind", ["soft", "thin", "rigid"])
@pytest.mark.parametrize("cell", ["quad4", "quad9"])
def test_bodies_pass_periodic_faces_as_they_pass_the_middle(kind: str, cell: str) -> None:
    """The same discrete system, moved by half a period of whole cells: what the one body does in the middle the other
    does across the face, and on for more than a period."""
    ends = []
    for start in (0.0, PERIOD / 2):  # which lies across the face at the start, and passes it again
        system, body = channel(kind, cell, start, 1.0 if cell == "quad9" or kind != "thin" else 10.0)
        result = vv.simulate(system, until=1.8, step=0.05)
        scale = result.ledger["total"][0]
        assert np.abs(result.ledger["imbalance"]).max() < 1e-11 * scale
        ends.append(places(body, system.x) - [start, 0.0, 0.0])
    assert ends[0][:, 0].min() > PERIOD
    assert np.allclose(*ends, rtol=0, atol=1e-8)


def test_a_fluid_is_read_at_images() -> None:
    mesh = vv.RectangleMesh(size=(2.0, 1.0), counts=(4, 2))
    fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=1.0, velocity=shear, periodic=(("x0", "x1"),))
    system = vv.System([fluid, *(vv.NoSlip(fluid=fluid, faces=side) for side in ("y0", "y1"))])
    inside, beyond = (fluid.at([(x, 0.3)]).velocities(system.x) for x in (0.4, 8.4))
    assert np.allclose(inside, beyond, rtol=0, atol=1e-14)
    with pytest.raises(InputError, match="lies outside of its mesh"):
        fluid.at([(8.4, 1.3)])


def test_a_slanted_mesh_continues_along_its_faces() -> None:
    """Beside faces across which the mesh continues obliquely, images are found among the neighbours."""
    mesh = vv.RectangleMesh(size=(1.0, 1.0), counts=(4, 4), cell="quad4").build()
    slanted = vv.Mesh(mesh.points + mesh.points[:, 1:] * [0.7, 0.0], mesh.cells, face_sets=mesh.face_sets)
    fluid = vv.Fluid(mesh=slanted, density=1.0, viscosity=1.0, periodic=(("x0", "x1"), ("y0", "y1")))
    X = np.random.default_rng(0).uniform(-3.0, 3.0, (200, 2))
    cells, _ = fluid.find(X)
    assert np.all(cells >= 0)
    turns = (fluid.at(X).of_nodes(slanted.points) - X) @ np.linalg.inv([[1.0, 0.0], [0.7, 1.0]])
    assert np.allclose(turns, np.round(turns), rtol=0, atol=1e-9)


def test_a_wall_beyond_a_periodic_face_is_not_covered_unseen() -> None:
    """A body that reaches across the face onto an obstacle at the other end of the mesh."""
    whole = vv.RectangleMesh(size=(1, 1), counts=(10, 10)).build()
    away = np.abs(whole.points[whole.cells["quad4"]].mean(axis=1) - [0.15, 0.45]).max(axis=1) > 0.01
    bare = vv.Mesh(whole.points, {"quad4": whole.cells["quad4"][away]}).without_orphans()
    around = bare.boundary()
    middle = bare.points[around.cells["line2"]].mean(axis=1)
    sides = {"x0": middle[:, 0] < 0.01, "x1": middle[:, 0] > 0.99}
    named = {name: around.where(where) for name, where in sides.items()}
    mesh = vv.Mesh(bare.points, bare.cells, face_sets=named)
    fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=1.0, periodic=(("x0", "x1"),))
    walls = vv.NoSlip(fluid=fluid, faces=around.where(~(sides["x0"] | sides["x1"])))
    block = vv.Solid(mesh=vv.RectangleMesh(size=(0.37, 0.35), counts=(3, 3), origin=(0.93, 0.28)), **SOFT)
    with pytest.raises(InputError, match=r"covers the boundary of Fluid 'fluid-1', at \[1\.1, 0\.4\]"):
        vv.System([fluid, walls, block, vv.Immersed(solid=block, fluid=fluid)])
