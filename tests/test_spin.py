"""Torque that mortar friction has on faces of rigid bodies that spin, by the mean slips at their vertices."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv
from visviva.contact.spin import least_torque

HALF = np.pi / 32
MEAN = 2 / 3 * (1 + np.cos(HALF) * np.arcsinh(np.tan(HALF)) / np.tan(HALF)) / 2
"""Of the distances from the middle of a polygon of 32 corners, by the radius: integrals of powers of the secant."""
DISC = 2 / 3 * (2 + np.cos(2 * HALF)) / 4 / MEAN
SQUARE = np.sqrt(2) / 6 / ((np.sqrt(2) + np.arcsinh(1)) / 6)


def contact_of(shape: vv.Shape, **options: Any) -> tuple[vv.Contact, str]:
    base = vv.RigidBody(shape=vv.Box(size=(1, 1, 0.1)), mass=1.0, position=(0, 0, -0.05))
    body = vv.RigidBody(shape=shape, mass=1.0, position=(0, 0, 0.05))
    contact = vv.Contact(
        first=body, second=base, second_faces="z1", stiffness=1e6, **{"formulation": "mortar", **options}
    )
    return contact, str(vv.System([base, body, contact]).check())


@pytest.mark.parametrize(
    ("shape", "part"), [(vv.Cylinder(radius=0.2, length=0.1), DISC), (vv.Box(size=(0.3, 0.3, 0.1)), SQUARE)]
)
def test_least_torque_is_that_of_the_shares_of_vertices(shape: vv.Shape, part: float) -> None:
    contact, said = contact_of(shape, first_faces="z0", friction=0.3)
    assert least_torque(contact._surface) == pytest.approx(part, rel=1e-4)
    assert f"is braked by {part:.2f} of the torque of its pressure" in said


@pytest.mark.parametrize("options", [{"friction": 0.0}, {"friction": 0.3, "formulation": "node-to-segment"}])
def test_nothing_is_said_of_what_does_not_rub_by_mortar(options: dict[str, Any]) -> None:
    assert "is braked by" not in contact_of(vv.Box(size=(0.3, 0.3, 0.1)), first_faces="z0", **options)[1]


def test_finer_facets_cure_it() -> None:
    """Each triangle of a cylinder as sixteen: four rings on its flat faces."""
    points, triangles = vv.Cylinder(radius=0.2, length=0.1).surface()
    while len(triangles) < 2000:
        points, triangles = halved(points, triangles)
    contact, said = contact_of(vv.SurfaceMesh(points=points, triangles=triangles), friction=0.3)
    assert 0.95 < least_torque(contact._surface) < 1
    assert "is braked by" not in said


def halved(points: Any, triangles: Any) -> tuple[Any, Any]:
    """Each triangle as four, by the middles of its edges."""
    edges = np.sort(np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
    ends, number = np.unique(edges, axis=0, return_inverse=True)
    ab, bc, ca = len(points) + number.reshape(3, -1)
    a, b, c = triangles.T
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return np.concatenate([points, points[ends].mean(axis=1)]), np.concatenate(
        [np.stack(p, axis=1) for p in parts]
    )
