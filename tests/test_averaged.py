"""Unknowns that are means over a step: the forces that are told of an instant are those of that instant."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv

SHEAR, BULK, STRAIN = 1e6, 5e7, 1e-3


def pressed(kind: type[vv.ThermoelasticSolid], cell: Any, **more: Any) -> tuple[vv.System, Any]:
    """A cube between walls without friction, whose end is moved as in the time one."""
    solid = kind(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(2, 1, 1), cell=cell),
        material=vv.NeoHooke(shear=SHEAR, bulk=BULK),
        formulation="mixed",
        density=1e-3,
        heat=vv.Heat(conductivity=1.0, capacity=1e12, reference=300.0),
        **more,
    )
    walls = [vv.SymmetryPlane(solid=solid, nodes="all", normal=n) for n in ((0, 1, 0), (0, 0, 1))]
    end = vv.Prescribed(solid=solid, nodes="x1", motion=(f"-{STRAIN}*t", None, None))
    return vv.System([solid, *walls, vv.Fixed(solid=solid, nodes="x0"), end]), solid


@pytest.mark.parametrize("step", [1.0, 0.25])
@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.Midpoint(), vv.BackwardEuler()], ids=repr)
@pytest.mark.parametrize("cell", ["hex8", "hex27", "tet10"])
def test_supports_carry_what_the_present_strain_asks(cell: Any, scheme: vv.Scheme, step: float) -> None:
    """In mixed elements with heat they told the pressure of half a step before: a half of this force in one step."""
    system, solid = pressed(vv.ThermoelasticSolid, cell)
    vv.simulate(system, until=1.0, step=step, scheme=scheme)
    carried = vv.SupportForce(solid=solid, nodes="x1")(system)[0]
    cut = vv.SectionForce(solid=solid, point=(0.4, 0, 0), normal=(1, 0, 0))(system)[0]
    modulus = BULK + 4 / 3 * SHEAR  # of confined compression
    assert carried == pytest.approx(-modulus * STRAIN, rel=2e-3)  # strains are finite
    assert cut == pytest.approx(carried, rel=1e-6)


def test_branches_do_not_hide_the_pressure() -> None:
    system, solid = pressed(
        vv.ThermoviscoelasticSolid, "hex8", branches=[vv.MaxwellBranch(share=0.5, time=10.0)]
    )
    vv.simulate(system, until=1.0, step=0.25)
    found = vv.SupportForce(solid=solid, nodes="x1")(system)[0]
    stiff = 1.5 * SHEAR  # of the branch nearly all is left; it is one of shear
    assert np.sign(found) == -1
    assert -found == pytest.approx((BULK + 4 / 3 * stiff) * STRAIN, rel=5e-3)


def turned_cube() -> tuple[vv.Mesh, Any]:
    """Turned by an eighth about z, and the rotation."""
    c = np.sqrt(0.5)
    Q = np.array([[c, -c, 0], [c, c, 0], [0, 0, 1]])
    box = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2)).build()
    return vv.Mesh(box.points @ Q.T, box.cells, face_sets=box.face_sets), Q


@pytest.mark.parametrize("with_servo", [False, True])
def test_forces_of_constraints_follow_the_settled_pressure(with_servo: bool) -> None:
    """They were found before it, and so from that of half a step before; beside a servo nothing was settled."""
    mesh, Q = turned_cube()
    solid = vv.ThermoelasticSolid(
        mesh=mesh,
        material=vv.NeoHooke(shear=SHEAR, bulk=BULK),
        formulation="mixed",
        density=1e-3,
        heat=vv.Heat(conductivity=1.0, capacity=1e12, reference=300.0),
    )
    sides = (("x0", 0), ("x1", 0), ("y0", 1), ("y1", 1))
    parts: list[vv.Component] = [
        solid,
        *(vv.SymmetryPlane(solid=solid, nodes=side, normal=Q[:, k]) for side, k in sides),
        vv.Fixed(solid=solid, nodes="z0", directions=(False, False, True)),
        vv.Prescribed(solid=solid, nodes="z1", motion=(None, None, f"-{STRAIN}*t**2")),
    ]
    if with_servo:
        ground, load = vv.Ground(), vv.RigidBody(mass=1.0, inertia=(1, 1, 1), position=(10, 0, 0))
        rail = vv.Prismatic(a=ground, b=load, at=(10, 0, 0), axis=(1, 0, 0))
        parts += [ground, load, rail, vv.Servo(output=[rail], follows=["t**3"], actuators=[rail])]
    system = vv.System(parts)
    vv.simulate(system, until=1.0, step=0.2)
    found = vv.SupportForce(solid=solid, nodes="x1")(system) @ Q[:, 0]
    assert found == pytest.approx(-(BULK - 2 / 3 * SHEAR) * STRAIN, rel=1e-3)  # strains are finite


def test_reactions_beside_a_servo_are_those_of_the_instant() -> None:
    """They were means of the last step: -12.6, -15.3 for -18 in steps of .1 and .05."""
    ground, arm = vv.Ground(), vv.RigidBody(mass=2.0, inertia=(1, 1, 2), position=(1, 0, 0))
    axle = vv.Revolute(a=ground, b=arm, at=(0, 0, 0), axis=(0, 0, 1))
    servo = vv.Servo(output=[axle], follows=["t**3"], actuators=[axle])
    system = vv.System([ground, arm, axle, servo])
    vv.simulate(system, until=1.0, step=0.1)
    outward, onward = np.array([np.cos(1), np.sin(1), 0]), np.array([-np.sin(1), np.cos(1), 0])
    force = vv.ReactionForce(joint=axle)(system)
    assert (force @ outward, force @ onward) == pytest.approx((-2 * 3**2, 2 * 6), rel=1e-9)
