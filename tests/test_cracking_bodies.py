"""Cracking bodies beside others, on stretched cells, and what is read of them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv


def pulled(plate: vv.FracturingSolid, motion: str) -> list[Any]:
    """A plate, held below and moved above."""
    held = vv.Fixed(solid=plate, nodes="y0")
    return [plate, held, vv.Prescribed(solid=plate, nodes="y1", motion=(0, motion, None))]


def notched() -> list[Any]:
    """A plate with a notch, pulled at its upper side."""
    mesh = vv.RectangleMesh(size=(1.0, 1.0), counts=(10, 10)).build()
    mesh = mesh.opened(lambda X: (abs(X[:, 1] - 0.5) < 1e-9) & (X[:, 0] < 0.45), lambda X: X[:, 1] > 0.5)
    plate = vv.FracturingSolid(
        mesh=mesh,
        material=vv.SaintVenantKirchhoff(young=1.0, poisson=0.2),
        toughness=1e-6,
        length=0.2,
        model="AT2",
    )
    return pulled(plate, "t")


def strong(stiffness: float) -> list[Any]:
    """A plate far away that holds much energy and does not crack."""
    plate = vv.FracturingSolid(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(2, 2), origin=(5, 0)),
        material=vv.SaintVenantKirchhoff(young=stiffness, poisson=0.2),
        toughness=1e3 * stiffness,
        length=0.6,
        model="AT1",
    )
    return pulled(plate, "10*t")


def test_no_crack_hides_behind_the_energy_of_another_body() -> None:
    """Whether damages are of least energy is judged in every component."""
    found = []
    for beside in ([], strong(1.0), strong(1e6)):
        parts = notched()
        system = vv.System([*parts, *beside])
        vv.quasi_static(system, until=2.5e-3, step=5e-4, scheme=vv.AlternateMinimization(unstable=True))
        found.append(parts[0].crack_energy(system.x) / 1e-6)
    assert found[0] > 0.5
    assert found[1:] == pytest.approx([found[0]] * 2, rel=1e-3)


@pytest.mark.parametrize(
    ("counts", "long"), [((10, 40), None), ((64, 8), 0.125), ((8, 128), 0.125), ((20, 20), None)]
)
def test_stretched_cells_are_told_by_their_length(counts: tuple[int, int], long: float | None) -> None:
    mesh = vv.RectangleMesh(size=(0.25 if counts[0] == 64 else 1.0, 1.0), counts=counts)
    solid = vv.FracturingSolid(
        mesh=mesh,
        material=vv.SaintVenantKirchhoff(young=1.0, poisson=0.0),
        toughness=1e-6,
        length=0.1 if long else 0.2,
        model="AT1",
    )
    remarks = [line for line in solid.remarks() if "longer" in line or "long, are larger" in line]
    assert [f"{long:.3g} long" in line for line in remarks] == ([True] if long else [])


def test_directions_of_crack_tips_have_no_length() -> None:
    solid = vv.FracturingSolid(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(10, 10)),
        material=vv.SaintVenantKirchhoff(young=1.0, poisson=0.3),
        toughness=1.0,
        length=0.2,
        damage=lambda X: 1.0 * ((abs(X[:, 1] - 0.5) < 0.01) & (X[:, 0] < 0.4)),
    )
    system = vv.System([solid])
    tips = [vv.CrackTip(solid=solid, along=(a, 0, 0))(system) for a in (1.0, 1e3, 1e-9, 1e-300)]
    assert np.ptp(tips, axis=0) == pytest.approx(np.zeros(3), abs=1e-12)
