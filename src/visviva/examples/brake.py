"""Disc brake: a disc that turns on a hinge, and two pads that are pressed against it, rub, and heat.

Disc and pads are solids that deform and conduct heat. The disc's bore is rigid and turns about the axle; the pads are
guided, so that they can only move towards the disc. What friction takes from the motion becomes heat, half of it in the
disc and half in the pads, and flows into both of them: the hot ring on the disc. Energy closes to rounding, entropy
grows.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import visviva as vv

INNER, OUTER, THICK = 0.05, 0.15, 0.02
PADS = ((0.085, 0.145), np.pi / 5, 0.012)  # radii, angle, thickness
FRICTION, COLD = 0.4, 293.15
DISC = vv.Heat(conductivity=400.0, capacity=4e4, expansion=1.2e-5, reference=COLD)
PAD = vv.Heat(conductivity=20.0, capacity=4e4, expansion=1e-5, reference=COLD)
"""Heat capacities are a hundredth of those of steel and of linings, so that a short brake shows something."""


def disc(counts: tuple[int, int, int], speed: float) -> list[Any]:
    """The disc with its bore and axle, turning."""
    mesh = vv.HollowCylinderMesh(inner_radius=INNER, outer_radius=OUTER, height=THICK, counts=counts)
    steel = vv.NeoHooke(young=2e9, poisson=0.3)
    body = vv.ThermoelasticSolid(
        mesh=mesh, material=steel, density=7800.0, heat=DISC, angular_velocity=(0, 0, speed), name="disc"
    )
    ground = vv.Ground()
    bore = vv.RigidCoupling(solid=body, faces="inner", name="bore")
    axle = vv.Revolute(a=ground, b=bore, at=(0, 0, THICK / 2), axis=(0, 0, 1), name="axle")
    return [body, ground, bore, axle]


def pad(body: Any, side: int, counts: tuple[int, int, int], force: float) -> list[Any]:
    """A pad above (1) or below (-1) the disc, its guide, the pressure on its back, and its contact."""
    (inside, outside), angle, thick = PADS
    sector = vv.HollowCylinderMesh(
        inner_radius=inside, outer_radius=outside, height=thick, counts=counts, angle=angle
    ).build()
    low = THICK if side > 0 else -thick
    lining = vv.ThermoelasticSolid(
        mesh=sector.moved((0, 0, low)),
        material=vv.NeoHooke(young=2e8, poisson=0.25),
        density=2500.0,
        heat=PAD,
        name="upper pad" if side > 0 else "lower pad",
    )
    front, back = ("bottom", "top") if side > 0 else ("top", "bottom")
    area = angle / 2 * (outside**2 - inside**2)
    guide = vv.Fixed(solid=lining, nodes=back, directions=(True, True, False))
    push = vv.Pressure(solid=lining, faces=back, pressure=f"{force / area}*smoothstep(t/0.01)")
    contact = vv.Contact(
        first=lining,
        first_faces=front,
        second=body,
        second_faces="top" if side > 0 else "bottom",
        enforcement="penalty",
        friction=FRICTION,
        tangential="penalty",
        name=f"{lining.name} contact",
    )
    heat = vv.HeatContact(contact=contact, conductance=[(0.0, 0.0), (1e6, 2e4)], name=f"{lining.name} heat")
    return [lining, guide, push, contact, heat]


def study(
    speed: float = 40.0, force: float = 2000.0, fine: int = 1, until: float = 0.028, step: float = 1e-3
) -> vv.Study:
    """Starts with an angular `speed`; each pad is pressed on by a `force`."""
    parts = disc((2 * fine, 20 * fine, 1), speed)
    pads = [pad(parts[0], side, (2 * fine, 3 * fine, 2), force) for side in (1, -1)]
    solids = [parts[0], pads[0][0], pads[1][0]]
    probes: dict[str, Any] = {
        "rim_velocity": vv.Velocity(of=solids[0], at=(OUTER, 0, THICK)),
        "hottest_of_disc": lambda s: float(solids[0].temperatures(s.x).max()),
        "hottest_of_pads": lambda s: float(max(p.temperatures(s.x).max() for p in solids[1:])),
        "entropy": lambda s: sum(p.total_entropy(s.x) for p in solids),
    }
    return vv.Study(
        vv.System([*parts, *pads[0], *pads[1]]),
        until,
        step,
        probes=probes,
        fields=("temperature",),
        title="Disc brake",
        notes=__doc__,
    )


def check(result: vv.Result) -> None:
    """Energy closes, all that friction takes is heat, and the disc is slower and warmer."""
    ledger = result.ledger
    start = ledger.first("kinetic")
    result.assert_conserved("energy", tolerance=1e-9)
    rubbed, heat = ledger["work_friction"], ledger["heat_friction"]
    assert np.abs(rubbed + heat).max() < 1e-9 * start, "friction and its heat differ"
    assert heat[-1] > 0.05 * start, f"friction took {heat[-1] / start:.3f} of the kinetic energy"
