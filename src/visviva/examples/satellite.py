"""Satellite that unfolds its panels: a rigid hub, and two shells on hinges whose springs latch.

The panels lie folded along the hub's sides. Torsion springs open them; where they stand straight a catch holds them, a
narrow well of the spring's energy, and a stop keeps them from turning further. What is left of their motion shakes the
panels, whose bending the hub feels, until the hinges' dampers have taken it. Nothing acts from outside: the centre of
mass rests and angular momentum is what it was at first.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import visviva as vv

HUB, WIDTH, OPEN = 1.0, 0.9, np.pi / 2
SPRING, CATCH, NARROW, STOP, DAMPING = 1.5, 4.0, 0.15, 2500.0, 2.0
"""Torque per angle of the springs, depth (J) and width of the catch, stop by the angle cubed, damping of hinges."""


def latch(e: Any) -> Any:
    """Energy of a hinge's spring with its catch and its stop, by the angle."""
    beyond = e[0] - OPEN
    stop = np.where(np.real(beyond) > 0, STOP * beyond**3, 0.0)
    return 0.5 * SPRING * beyond**2 + stop - CATCH * np.exp(-((beyond / NARROW) ** 2))


def panel(side: int, length: float, count: int, spin: float) -> vv.Shell:
    """Folded beside the hub, upwards from its hinge; `side` is -1 or 1."""
    flat = vv.RectangleMesh(
        size=(length, WIDTH), counts=(count, max(2, round(count * WIDTH / length)))
    ).build()
    s, y = flat.points.T
    points = np.stack([np.full_like(s, side * (HUB / 2 + 0.1)), y - WIDTH / 2, s - HUB / 2], axis=1)
    section = vv.HomogeneousSection(thickness=0.012, young=1.5e9, poisson=0.3, density=250.0)
    mesh = vv.Mesh(points, flat.cells, face_sets=flat.face_sets)
    name = "right" if side > 0 else "left"
    return vv.Shell(
        mesh=mesh,
        section=section,
        velocity=np.cross((0, 0, spin), points.mean(axis=0)),
        angular_velocity=(0, 0, spin),
        name=name,
    )


def wing(hub: vv.RigidBody, side: int, length: float, count: int, spin: float) -> list[Any]:
    """A panel with the yoke that carries it, its hinge, and what acts there."""
    shell = panel(side, length, count, spin)
    root = np.array([side * (HUB / 2 + 0.1), 0.0, -HUB / 2])
    yoke = vv.RigidBody(
        shape=vv.Box(size=(0.06, WIDTH, 0.06)),
        mass=1.5,
        position=root,
        angular_velocity=(0, 0, spin),
        velocity=np.cross((0, 0, spin), root),
        name=f"{shell.name}_yoke",
    )
    corners = root + np.array([(0, -WIDTH / 2, 0), (0, WIDTH / 2, 0), (0, 0, length / count)])
    bolts = [
        vv.Spherical(a=yoke, b=shell, at=at, name=f"{shell.name}_bolt_{k}") for k, at in enumerate(corners)
    ]
    hinge = vv.Revolute(
        a=hub, b=yoke, at=root, axis=(0, side, 0), first=(1, 0, 0), angle=True, name=f"{shell.name}_hinge"
    )
    spring = vv.Potential(
        of=[vv.JointCoordinate(joint=hinge)], energy=latch, kind="latch", name=f"{shell.name}_latch"
    )
    damper = vv.JointDamper(joint=hinge, damping=DAMPING, name=f"{shell.name}_damper")
    return [shell, yoke, *bolts, hinge, spring, damper]


def study(
    length: float = 1.4, count: int = 6, spin: float = 0.3, until: float = 6.0, step: float = 0.02
) -> vv.Study:
    """Panels of a `length` with `count` elements along it, on a hub that turns with `spin` about its vertical axis."""
    hub = vv.RigidBody(
        shape=vv.Box(size=(HUB, HUB, HUB)),
        mass=120.0,
        position=(0, 0, 0),
        angular_velocity=(0, 0, spin),
        name="hub",
    )
    wings = [wing(hub, side, length, count, spin) for side in (1, -1)]
    hinges = [c for parts in wings for c in parts if isinstance(c, vv.Revolute)]
    right = wings[0][0]
    assert isinstance(right, vv.Shell)
    tip = (HUB / 2 + 0.1, WIDTH / 2, length - HUB / 2)
    probes = {
        "right_angle": vv.JointCoordinate(joint=hinges[0]),
        "left_angle": vv.JointCoordinate(joint=hinges[1]),
        "tip": vv.Position(of=right, at=tip),
    }
    system = vv.System([hub, *wings[0], *wings[1]])
    return vv.Study(
        system,
        until,
        step,
        vv.EnergyMomentum(),
        probes,
        trails=("tip",),
        units="SI",
        title="Satellite that unfolds its panels",
        notes=__doc__,
    )


def check(result: vv.Result) -> None:
    """Energy and what the dampers took add up, momenta stay, and the catches hold the panels in the end."""
    result.assert_conserved("energy", "momentum_x", "momentum_y", "momentum_z", "angular_z", tolerance=1e-8)
    hinges = [c for c in result.system.components if isinstance(c, vv.Revolute)]
    for hinge in hinges:
        angle = result.history(hinge.coordinate("angle"))
        assert abs(angle[0]) < 1e-9, f"{hinge.label} starts open by {angle[0]}"
        if result.times[-1] >= 6.0 - 1e-9:
            late = angle[result.times > result.times[-1] - 1.0]
            assert np.abs(late - OPEN).max() < NARROW, f"{hinge.label} ends at {late[-1]}"
