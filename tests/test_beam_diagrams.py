"""Diagrams of section forces: how large they are, and on which side of the line they stand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv

LENGTH = 2.0
SECTION = vv.TubeSection(radius=0.1, young=2e11, poisson=0.25, density=2.0)
AXES = np.linalg.qr(np.array([[1.0, 2.0, 0.5], [0.3, -1.0, 2.0], [-2.0, 0.4, 1.0]]))[0]


def loaded(kind: type[vv.Beam], along: Any, force: Any, **options: Any) -> tuple[vv.System, vv.Beam]:
    """A beam that is held at its start, with a small force at its end."""
    mesh = vv.LineMesh(points=[(0, 0, 0), tuple(LENGTH * np.asarray(along))], count=4, cell="line3")
    beam = kind(mesh=mesh, section=SECTION, **options)
    tip = vv.Force(on=beam.point(LENGTH * np.asarray(along)), force=tuple(force))
    system = vv.System([beam, vv.Clamped(solid=beam, nodes="start"), tip])
    vv.quasi_static(system, until=1.0, step=1.0)
    return system, beam


def diagrams(beam: vv.Beam, system: vv.System, *names: str) -> np.ndarray:
    """Their sum (n, 3) at the points that are drawn."""
    found = beam.drawn_fields([f"diagram_{name}" for name in names], system.x)
    return sum(found.values())


def test_moments_stand_on_the_side_in_tension() -> None:
    """Whatever directors the section has: fibres away from where the force goes are stretched, by (L - s) F."""
    along, *aside = AXES.T
    force = 30.0 * aside[0] - 20.0 * aside[1]
    system, beam = loaded(vv.Beam, along, force)
    s = beam.drawn().points @ along
    moment = diagrams(beam, system, "bending_1", "bending_2")
    np.testing.assert_allclose(moment, -np.outer(LENGTH - s, force), atol=1e-4 * LENGTH * 36)
    shear = diagrams(beam, system, "shear_1", "shear_2")
    np.testing.assert_allclose(shear, np.tile(force, (len(s), 1)), atol=1e-4 * 36)


def test_normal_force_and_torsion() -> None:
    along = AXES[:, 0]
    system, beam = loaded(vv.Beam, along, 50.0 * along)
    normal = diagrams(beam, system, "normal")
    np.testing.assert_allclose(np.linalg.norm(normal, axis=1), 50.0, rtol=1e-6)
    assert np.abs(normal @ along).max() < 1e-9
    assert np.abs(diagrams(beam, system, "torsion", "bending_1", "shear_1")).max() < 1e-6


def test_what_rounding_makes_of_forces_is_no_diagram() -> None:
    """Of a beam that turns without a force, and of a moment that a bent beam does not have."""
    mesh = vv.LineMesh(points=[(0, 0, 0), (2, 1, 0.5)], count=20)
    beam = vv.Beam(mesh=mesh, section=SECTION)
    system, own = vv.System([beam]), beam.motion.unknowns
    system.x[own] = (system.x[own].reshape(-1, 3) @ (np.linalg.det(AXES) * AXES).T).ravel()
    assert np.abs(beam.resultants(system.x)).max() > 0
    assert not diagrams(beam, system, "normal", "shear_1", "bending_2", "torsion").any()
    system, beam = loaded(vv.Beam, (1.0, 0.0, 0.0), (0.0, 0.0, 30.0))
    assert not diagrams(beam, system, "torsion").any()
    assert diagrams(beam, system, "bending_1", "bending_2").any()


def test_beams_in_the_plane() -> None:
    along, aside = np.array([0.6, 0.8, 0.0]), np.array([0.8, -0.6, 0.0])
    system, beam = loaded(vv.PlaneBeam, along, 30.0 * aside)
    s = beam.drawn().points @ along
    moment = diagrams(beam, system, "bending_1", "bending_2")
    np.testing.assert_allclose(moment, -np.outer(LENGTH - s, 30.0 * aside), atol=1e-4 * 60)


@pytest.mark.parametrize("name", ["diagram_bending_1", "diagram_shear_2"])
def test_fields_at_nodes_are_means_of_cells(name: str) -> None:
    along, *aside = AXES.T
    system, beam = loaded(vv.Beam, along, 30.0 * aside[0])
    assert beam.nodal(name, system.x).shape == (beam.grid.n_nodes, 3)
