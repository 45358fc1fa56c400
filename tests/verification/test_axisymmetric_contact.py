"""Contact of bodies of revolution against closed solutions."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import visviva as vv

OVERLAP = 1e-6
KINDS: list[dict[str, Any]] = [{}, {"enforcement": "penalty", "stiffness": 1e8}]


def ring(inner: float, outer: float, counts: tuple[int, int], material: Any) -> vv.Solid:
    """A tube of length 1."""
    mesh = vv.RectangleMesh(size=(outer - inner, 1.0), counts=counts, origin=(inner, 0.0))
    return vv.Solid(mesh=mesh, material=material, density=1.0, plane="axisymmetric")


@pytest.mark.parametrize("formulation", ["mortar", "node-to-segment"])
@pytest.mark.parametrize("inner", [0.0, 0.5])
def test_patch(inner: float, formulation: Any) -> None:
    """Uniform pressure passes from a cylinder or tube to another mesh: exactly with mortar."""
    steel = vv.LinearElastic(young=1e3, poisson=0.3)
    solids = [
        vv.Solid(
            mesh=vv.RectangleMesh(size=(1.0, 1.0), counts=(n, 2), origin=(inner, y)),
            material=steel,
            plane="axisymmetric",
        )
        for n, y in ((3, 1.0), (2, 0.0))
    ]
    upper, lower = solids
    contact = vv.Contact(
        first=upper, first_faces="y0", second=lower, second_faces="y1", formulation=formulation
    )
    system = vv.System(
        [
            *solids,
            contact,
            vv.SymmetryPlane(solid=lower, nodes="y0", normal=(0, 1, 0)),
            vv.Traction(solid=upper, faces="y1", traction=(0, -10.0, 0), times="t"),
            *(vv.Fixed(solid=s, nodes="x0", directions=(1, 0, 0)) for s in solids if inner == 0),
        ]
    )
    vv.quasi_static(system, until=1.0, step=1.0)
    area, force = np.pi * ((inner + 1) ** 2 - inner**2), vv.ContactForce(contact=contact)(system)[1]
    assert force == pytest.approx(10 * area, rel=1e-9)
    seen = vv.ContactArea(contact=contact)(system)
    if formulation == "mortar":
        wider = (1 + 0.3 * 10 / 1e3) ** 2  # the faces under the pressure
        assert seen == pytest.approx(wider * area, rel=1e-12)
        assert contact.pressures == pytest.approx(10.0 / wider, rel=1e-9)
        assert upper.nodal("cauchy", system.x)[:, 1] == pytest.approx(-10.0, rel=1e-9)
    else:
        assert seen == pytest.approx(area, rel=1e-12)
        assert contact.pressures == pytest.approx(10.0, rel=0.3)


def press_fit(n: int, **options: Any) -> float:
    """Pressure between tubes of radii 1, 2 and 2, 3 that overlap, without strain along the axis."""
    steel = vv.LinearElastic(young=1e3, poisson=0.3)
    inside, outside = ring(1.0, 2.0, (n, 2), steel), ring(2.0 - OVERLAP, 3.0 - OVERLAP, (n, 3), steel)
    contact = vv.Contact(
        first=inside, first_faces="x1", second=outside, second_faces="x0", initial="press", **options
    )
    holds = [vv.Fixed(solid=s, nodes="all", directions=(0, 1, 0)) for s in (inside, outside)]
    system = vv.System([inside, outside, contact, *holds])
    vv.quasi_static(system, until=1.0, step=1.0)
    assert np.ptp(contact.pressures) < 1e-3 * contact.pressures.max()
    return float(contact.pressures.mean())


@pytest.mark.parametrize("options", KINDS, ids=str)
def test_press_fit_of_tubes(options: dict[str, Any]) -> None:
    """Lame: delta = p b (1 + nu) / E [(a^2 + (1 - 2 nu) b^2) / (b^2 - a^2) + (c^2 + (1 - 2 nu) b^2) / (c^2 - b^2)]."""
    E, nu, a, b, c = 1e3, 0.3, 1.0, 2.0, 3.0
    inward = ((1 - 2 * nu) * b**2 + a**2) / (b**2 - a**2)
    outward = ((1 - 2 * nu) * b**2 + c**2) / (c**2 - b**2)
    exact = OVERLAP / (b * (1 + nu) / E * (inward + outward))
    errors = [abs(press_fit(n, **options) / exact - 1) for n in (4, 8, 16)]
    assert errors[-1] < 3e-4
    assert all(coarse / fine > 3.0 for coarse, fine in pairwise(errors))
