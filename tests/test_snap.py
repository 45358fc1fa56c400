"""A hook that snaps in behind a ridge: where statics stops, what it offers, and that steps of dynamics get there."""

from __future__ import annotations

import numpy as np
import pytest
from contact_parts import contact_of
from numpy.typing import NDArray

import visviva as vv
from visviva.base.errors import VisvivaError

Array = NDArray[np.float64]

WAY, SOFT, HIGH, FLOOR = 0.45, 2.0, -0.04, -0.09
"""How far the hook is pushed, the crest of the ridge, and the floor behind it, which presses the hook by 0.01."""


def hook(*before: float) -> vv.Solid:
    """A cantilever with a nose below its tip, whose front is a ramp."""
    x = np.linspace(0.0, 1.0, 9)
    beam = [(a, b) for a in x for b in (0.0, 0.05)]
    quads = [(2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1) for k in range(8)]
    points = np.array([*beam, (0.875, -0.1), (0.94, -0.1)]) + before
    mesh = vv.Mesh(points, {"quad4": np.array([*quads, (18, 19, 16, 14)])})
    nose = mesh.with_faces(
        "nose", lambda X: (X[:, 1] < -0.09) | (X[:, 0] - before[0] > 0.99) & (X[:, 1] < 1e-9)
    )
    nose = nose.with_faces("root", lambda X: X[:, 0] < before[0] + 1e-9)
    return vv.Solid(
        mesh=nose, material=vv.NeoHooke(young=1e4, poisson=0.3), density=1.0, formulation="enhanced"
    )


def ridge() -> vv.Solid:
    """A ramp, a crest with a vertical back, and a floor."""
    x = np.array([1.0, 1.1, 1.2, 1.25, 1.3])
    low, middle = np.full(5, -0.3), np.array([-0.2, -0.17, -0.12, -0.1, FLOOR])
    top = np.array([-0.14, -0.1, -0.06, HIGH, HIGH])
    columns = np.stack([low, middle, top], axis=1)
    points = [(a, b) for a, c in zip(x, columns, strict=True) for b in c]
    floor = [(a, b) for a in (1.4, 1.5) for b in (-0.3, FLOOR)]
    quads = [(3 * k + r, 3 * k + 3 + r, 3 * k + 4 + r, 3 * k + 1 + r) for k in range(4) for r in (0, 1)]
    quads += [(12, 15, 16, 13), (15, 17, 18, 16)]
    mesh = vv.Mesh(np.array([*points, *floor]), {"quad4": np.array(quads)})
    upper = mesh.with_faces("top", lambda X: X[:, 1] > -0.15)
    return vv.Solid(mesh=upper, material=vv.NeoHooke(young=1e4, poisson=0.3), density=1.0)


def pushed(damping: float = 0.0) -> tuple[vv.Solid, vv.System]:
    """The hook before the ridge, pushed by a soft spring whose other end goes over it as time goes from 0 to 1."""
    body, wall, ground = hook(0.0, 0.0), ridge(), vv.Ground()
    root = vv.RigidCoupling(solid=body, faces="root")
    slide = vv.Prismatic(a=ground, b=root, at=(0.0, 0.025, 0.0), axis=(1, 0, 0))
    back = vv.Spring(a=ground, b=root, at_a=(-2.0, 0.025, 0.0), stiffness=SOFT, damping=damping)
    ahead = vv.Force(on=root, force=(SOFT * WAY, 0, 0), times="min(t, 1)")
    contact = vv.Contact(first=body, first_faces="nose", second=wall, second_faces="top")
    parts = [ground, body, wall, vv.Fixed(solid=wall, nodes="all"), root, slide, back, ahead, contact]
    return body, vv.System(parts)


def closed() -> Array:
    """Positions (n, 3) of the hook behind the ridge, where the whole ridge came from below."""
    body, wall = hook(WAY, 0.0), ridge()
    root = vv.Prescribed(solid=body, nodes="root", motion=("0", "0", None))
    risen = vv.Prescribed(solid=wall, nodes="all", motion=("0", "0.02*(t-1)", None))
    contact = vv.Contact(first=body, first_faces="nose", second=wall, second_faces="top")
    system = vv.System([body, wall, root, risen, contact])
    vv.quasi_static(system, until=1.0, step=0.5)
    assert contact.pressures.max() > 0
    return body.positions(system.x)


def test_statics_stops_at_the_snap_and_dynamics_takes_it() -> None:
    body, system = pushed()
    with pytest.raises(VisvivaError, match=r"vv.arc_length, or\s+take the snap in steps of dynamics"):
        vv.quasi_static(system, until=1.0, step=0.1, scheme=vv.Static(halvings=6))
    assert 0.85 < system.time < 0.96  # the nose is about to leave the crest
    body, system = pushed(damping=0.5)
    vv.simulate(system, until=4.0, step=0.02, scheme=vv.BackwardEuler())
    assert contact_of(system.components).pressures.max() > 0
    np.testing.assert_allclose(body.positions(system.x), closed(), atol=1e-6)
