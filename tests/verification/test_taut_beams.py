"""Beams that are pulled far beyond what their bending carries: ropes swing as strings and stand straight."""

from __future__ import annotations

import numpy as np
import pytest

import visviva as vv

STRETCH, MASS, LENGTH, CELLS = 1e4, 0.1, 2.0, 20
TENSION = 98.1


def rope(kind: type[vv.Beam], cell: str, ratio: float) -> vv.Beam:
    """A rope of 20 cells, of which the tension is N Le^2 / EI = `ratio` beside its bending."""
    bending = TENSION * (LENGTH / CELLS) ** 2 / ratio
    section = vv.GivenSection(
        stiffness=(STRETCH, STRETCH, STRETCH, *[bending] * 3), mass=MASS, moments=(1e-8, 1e-8, 0)
    )
    mesh = vv.LineMesh(points=[(0, 0, 0), (LENGTH, 0, 0)], count=CELLS, cell=cell)  # type: ignore[arg-type]
    return kind(mesh=mesh, section=section)


@pytest.mark.parametrize("cell", ["line2", "line3", "line4"])
@pytest.mark.parametrize("kind", [vv.Beam, vv.PlaneBeam])
def test_a_taut_rope_has_the_frequencies_of_a_string(kind: type[vv.Beam], cell: str) -> None:
    """``f_n = n / (2 L) sqrt(N / m)``, hinged at both ends and cooled so that it pulls by N.

    Directors that are shorter between nodes made the force along the line bend it: from N Le^2 / EI of 4, 24 and 70 in
    cells of two, three and four nodes straight ropes were unstable.
    """
    beam = rope(kind, cell, 1000.0)
    pulled = vv.ThermalStrain(beam=beam, extension=-TENSION / STRETCH, times="t")
    ends = [vv.Fixed(solid=beam, nodes=end) for end in ("start", "end")]
    system = vv.System([beam, pulled, *ends])
    vv.equilibrium(system, until=1.0, steps=1)
    np.testing.assert_allclose(beam.resultants(system.x)[..., 2], TENSION, rtol=1e-9)
    found = vv.modes(system, 4)
    assert found.stable
    swinging = found.frequencies[found.frequencies > 1.0]  # without its turning about itself
    assert swinging[0] == pytest.approx(np.sqrt(TENSION / MASS) / (2 * LENGTH), rel=3e-3)


def test_a_rope_that_is_pulled_by_its_end_stands_straight() -> None:
    """It lengthens by N L / EA; statics called it unstable in 24 directions."""
    beam = rope(vv.Beam, "line3", 100.0)
    pull = vv.Force(on=beam.point((LENGTH, 0, 0)), force=(TENSION, 0, 0), times="t")
    system = vv.System([beam, vv.Clamped(solid=beam, nodes="start"), pull])
    vv.quasi_static(system, until=1.0, step=1.0)
    moved = beam.displacements(system.x)
    assert moved[:, 0].max() == pytest.approx(TENSION * LENGTH / STRETCH, rel=1e-9)
    np.testing.assert_allclose(moved[:, 1:], 0.0, atol=1e-12)
