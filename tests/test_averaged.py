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
