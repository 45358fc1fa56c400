"""Steps that end where directors of a cell are turned too far against each other are refused."""

from __future__ import annotations

import numpy as np
import pytest

import visviva as vv
from visviva.body.turned_cells import most_turned, turn


def rope(cell: str, bending: float) -> vv.Beam:
    stiffness = (1e4, 1e4, 1e5, bending, bending, bending)
    section = vv.GivenSection(stiffness=stiffness, mass=1.0, moments=(1e-4, 1e-4, 0))
    return vv.Beam(mesh=vv.LineMesh(points=[(0, 0, 0), (1.3, 0, 0)], count=12, cell=cell), section=section)


@pytest.mark.parametrize(("cell", "bending"), [("line2", 1e-2), ("line3", 3e-3), ("line4", 1e-3)])
def test_a_rope_that_curls_within_a_cell_is_refused(cell: str, bending: float) -> None:
    """It kept its energy and grew from 1.3 to 1.5 and more, where interpolated directors vanish."""
    beam = rope(cell, bending)
    system = vv.System([beam, vv.Fixed(solid=beam, nodes="start"), vv.Gravity()])
    with pytest.raises(vv.RunError, match=r"cell \d+ of Beam 'beam-1' turns by .* take more cells"):
        vv.simulate(system, until=0.6, step=0.005)
    assert system.time > 0.1
    stretch = beam.volume(system.x) / 1.3
    assert stretch < 1.001


def test_paths_of_statics_refuse_it_too() -> None:
    """A soft strip of two line3 rolled up beyond the largest moment of its cells, to 160 degrees in each."""
    soft = vv.GivenSection(stiffness=(10, 10, 10, 1e-2, 1e-2, 1e-2))
    beam = vv.Beam(mesh=vv.LineMesh(points=[(0, 0, 0), (1.3, 0, 0)], count=2, cell="line3"), section=soft)
    bend = vv.Torque(on=beam.frame(1.3), torque=(0, -1e-2 * 5.8 / 1.3, 0), times="t")
    system = vv.System([beam, vv.Clamped(solid=beam, nodes="start"), bend])
    with pytest.raises(vv.RunError, match=r"turns by 15\d .* take more cells"):
        vv.arc_length(system, step=0.1, steps=100)


def test_change_of_products() -> None:
    """The mean of two triads at an angle about d1: d2 and d3 are cos(angle / 2) long, d1 is whole."""
    a = np.deg2rad(50.0)
    turned = np.array([[1, 0, 0], [0, np.cos(a), np.sin(a)], [0, -np.sin(a), np.cos(a)]])
    own = np.stack([np.eye(3), turned])[None]
    cell, change = most_turned(np.array([[0.5, 0.5]]), own, np.broadcast_to(np.eye(3), own.shape))
    assert cell == 0
    assert change == pytest.approx(np.sin(a / 2) ** 2)
    assert turn(own[0]) == pytest.approx(50.0)


def test_directors_of_iterations_that_went_astray_are_not_turned() -> None:
    """A message blamed 0 degrees for "1595083943093%"."""
    own = np.stack([np.eye(3), 1e5 * np.eye(3)])[None]
    assert most_turned(np.array([[0.5, 0.5]]), own, np.broadcast_to(np.eye(3), own.shape)) == (0, 0.0)
