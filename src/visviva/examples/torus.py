"""Hollow torus of Hesch & Betsch (2012), section 4.2, in free flight: 8024 bricks, energy and momenta to round-off.

Radii 52 and 100, wall 4.5, neo-Hooke with E = 2250 and Poisson's ratio 0.3, density 0.1, thrown with (30, 0, 23), as in
the paper, which does not say which neo-Hooke: here W = mu/2 (tr C - 3 - 2 ln J) + lambda/2 (ln J)^2. So that the flight
strains the torus, it also turns, and its ring is thrown into an oval.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import visviva as vv


def study(
    counts: tuple[int, int, int] = (118, 34, 2),
    spin: float = 0.8,
    oval: float = 80.0,
    until: float = 0.25,
    step: float = 0.01,
) -> vv.Study:
    """Turning with `spin` rad/s about its axis; the ring grows along x and shrinks along y with the speed `oval`."""
    radius = 76.0

    def thrown(X: np.ndarray) -> np.ndarray:
        along, nothing = X[:, 0] / radius, np.zeros(len(X))
        turning = spin * np.column_stack([-X[:, 1], X[:, 0], nothing])
        growing = oval * np.column_stack([along, -X[:, 1] / radius, nothing])
        return np.array([30.0, 0.0, 23.0]) + turning + growing

    mesh = vv.HollowTorusMesh(major_radius=radius, outer_minor_radius=24.0, wall=4.5, counts=counts)
    rubber = vv.NeoHooke(young=2250.0, poisson=0.3)
    torus = vv.Solid(mesh=mesh, material=rubber, density=0.1, velocity=thrown, name="torus")
    probes: dict[str, Any] = {
        "mean_position": vv.CentreOfMass(of=torus),
        "size": lambda s: np.ptp(torus.positions(s.x), axis=0),
    }
    return vv.Study(
        vv.System([torus]), until, step, probes=probes, title="Hollow torus in free flight", notes=__doc__
    )


def check(result: vv.Result) -> None:
    """Energy and both momenta, each in all directions; the centre flies straight on."""
    momenta = [f"{kind}_{axis}" for kind in ("momentum", "angular") for axis in "xyz"]
    result.assert_conserved("energy", *momenta)
    (torus,) = (c for c in result.system.components if isinstance(c, vv.Solid))
    centres = [torus.nodal_mass @ torus.positions(x) / torus.mass for x in result.states]
    flight = np.outer(np.subtract(result.times, result.times[0]), (30.0, 0.0, 23.0))
    assert np.allclose(np.array(centres) - centres[0], flight, rtol=0, atol=1e-7), "the centre left its line"
