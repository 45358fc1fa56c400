"""Wind turbine that is started by a torque: tower and blades are beams, hub and nacelle rigid bodies on a hinge.

The blades are described as composite ones are: by the six by six stiffnesses and the inertia of their sections, which
fall off towards the tips, with mass centres off the axis and with pretwist. Figures are those of a machine of some
100 m of diameter, round ones.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import visviva as vv

TOWER, BLADE, HUB = 80.0, 48.0, 1.5


def blade_section(share: float) -> vv.GivenSection:
    """Of a blade at a share of its length: chord along d1; extension is coupled with flap, as the webs are off axis."""
    slim = 1.0 - 0.9 * share
    C = np.diag([3e8, 2e8, 8e9, 6e9 * slim**2, 9e9 * slim**2, 2e9 * slim**2]) * slim
    C[2, 3] = C[3, 2] = 0.05 * np.sqrt(C[2, 2] * C[3, 3])
    mass, chord, thickness = 600.0 * slim, 3.2 * slim + 0.3, 0.6 * slim + 0.1
    moments = (mass * chord**2 / 16, mass * thickness**2 / 16, 0.0)
    at = 2 * np.pi * np.arange(16) / 16
    outline = np.stack([0.5 * chord * np.cos(at), 0.5 * thickness * np.sin(at)], axis=1)
    return vv.GivenSection(
        stiffness=C, mass=mass, centre=(0.06 * chord, 0.0), moments=moments, outline=outline
    )


def blade(angle: float, count: int, pretwist: float) -> vv.Beam:
    """From the hub outwards in the plane of the rotor, which is that of y and z."""
    out = np.array([0.0, np.sin(angle), np.cos(angle)])
    along = np.cross((1.0, 0, 0), out)

    def chord(X: Any) -> Any:
        turn = pretwist * (1 - ((X - (0, 0, TOWER)) @ out - HUB) / BLADE)
        return np.cos(turn)[:, None] * along + np.sin(turn)[:, None] * np.array([1.0, 0, 0])

    centre = np.array([4.0, 0.0, TOWER])
    mesh = vv.LineMesh(points=[centre + HUB * out, centre + (HUB + BLADE) * out], count=count)
    sections = tuple(blade_section((k + 0.5) / count) for k in range(count))
    return vv.Beam(mesh=mesh, section=sections, first=chord, name=f"blade_{np.degrees(angle):.0f}")


def study(
    count: int = 10, torque: float = 4e6, until: float = 12.0, step: float = 0.02, pretwist: float = 0.2
) -> vv.Study:
    """`count` elements in each blade and in the tower; the torque comes up within two seconds."""
    wall = vv.TubeSection(radius=2.0, thickness=0.03, young=210e9, poisson=0.3, density=8500.0)
    tower = vv.Beam(
        mesh=vv.LineMesh(points=[(0, 0, 0), (0, 0, TOWER)], count=count), section=wall, name="tower"
    )
    nacelle = vv.RigidBody(
        shape=vv.Box(size=(10, 4, 4)), mass=1.5e5, position=(-1.0, 0, TOWER), name="nacelle"
    )
    hub = vv.RigidBody(shape=vv.Sphere(radius=HUB), mass=3e4, position=(4.0, 0, TOWER), name="hub")
    blades = [blade(k * 2 * np.pi / 3, count, pretwist) for k in range(3)]
    clamp = vv.Clamped(solid=tower, nodes="start", name="clamp")
    seat = vv.Rigid(a=tower, b=nacelle, at=(0, 0, TOWER), name="seat")
    shaft = vv.Revolute(a=nacelle, b=hub, at=(4, 0, TOWER), axis=(1, 0, 0), angle=True, name="shaft")
    roots = [vv.Rigid(a=hub, b=b, at=b.points[0], name=f"root_{b.name}") for b in blades]
    drive = vv.JointForce(joint=shaft, force=f"{torque} * smoothstep(t / 2)", name="wind")
    system = vv.System([tower, clamp, nacelle, seat, hub, shaft, *blades, *roots, drive, vv.Gravity()])
    probes = {
        "angle": vv.JointCoordinate(joint=shaft),
        "tip": vv.Position(of=blades[0], at=blades[0].points[-1]),
        "head": vv.Position(of=tower, at=(0, 0, TOWER)),
    }
    return vv.Study(
        system,
        until,
        step,
        vv.EnergyMomentum(),
        probes,
        trails=("tip",),
        units="SI",
        title="Wind turbine",
        notes=__doc__,
    )


def check(result: vv.Result) -> None:
    """The work of the torque is all in motion, strain and height; the head sways by less than a metre."""
    result.assert_conserved("energy")
    (tower,) = (c for c in result.system.components if isinstance(c, vv.Beam) and c.name == "tower")
    head = result.history(tower.point((0, 0, TOWER)).position)
    sway = np.abs(head[:, :2] - head[0, :2]).max()
    assert sway < 1.0, f"the tower's head sways by {sway}"
