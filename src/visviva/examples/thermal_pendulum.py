"""Thermoelastic double pendulum of Romero (2009): two masses on springs that warm when squeezed, one of them hot.

The springs exchange heat with each other. The energy-momentum scheme keeps energy and angular momentum to round-off,
and the entropy of both springs together never falls, at any step.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import visviva as vv


def study(
    hot: float = 380.0,
    cold: float = 298.0,
    conductance: float = 10.0,
    until: float = 5.0,
    step: float = 0.005,
    scheme: vv.Scheme | None = None,
) -> vv.Study:
    """The first spring is `hot`; `conductance` is heat per time and difference between the springs."""
    ground = vv.Ground()
    near = vv.PointMass(mass=1.0, position=(1.1, 0, 0), velocity=(0, 4, 0), name="near")
    far = vv.PointMass(mass=2.0, position=(2.7, 0.3, 0), velocity=(-2, 3, 0), name="far")
    common: dict[str, Any] = {"law": "logarithmic", "expansion": 1e-3, "reference": 300.0}
    first = vv.ThermalSpring(
        a=ground,
        b=near,
        stiffness=1e3,
        capacity=3.0,
        free_length=1.0,
        temperature=hot,
        name="first",
        **common,
    )
    second = vv.ThermalSpring(
        a=near,
        b=far,
        stiffness=1e4,
        capacity=5.0,
        free_length=1.5,
        temperature=cold,
        name="second",
        **common,
    )
    link = vv.HeatExchange(a=first, b=second, conductance=conductance, name="link")
    system = vv.System([ground, near, far, first, second, link])
    probes: dict[str, Any] = {
        "temperature": lambda s: np.array([first.temperature_at(s.x), second.temperature_at(s.x)]),
        "entropy": lambda s: first.entropy_at(s.x) + second.entropy_at(s.x),
        "near": vv.Position(of=near),
        "far": vv.Position(of=far),
    }
    return vv.Study(
        system,
        until,
        step,
        scheme=scheme or vv.EnergyMomentum(),
        probes=probes,
        trails=("near", "far"),
        title="Thermoelastic double pendulum",
        notes=__doc__,
    )


def check(result: vv.Result) -> None:
    """Both laws, and the angular momentum."""
    result.assert_conserved("energy", "angular_z")
    springs = [c for c in result.system.components if isinstance(c, vv.ThermalSpring)]
    entropy = np.array([sum(s.entropy_at(x) for s in springs) for x in result.states])
    assert np.min(np.diff(entropy)) >= -1e-12 * np.abs(entropy).max(), "entropy fell"
