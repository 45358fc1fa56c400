"""Strains, stresses and forces that Python tells of cells, against those of the core's terms of solids."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from visviva.body.element import geometry, solid_rule
from visviva.body.solid_fields import summed
from visviva.body.stressed_cells import StressedCells
from visviva.mesh.cells import CELLS

Array = NDArray[np.float64]
BOX = vv.BoxMesh(size=(1, 1, 1), counts=(2, 1, 1), cell="hex20")
SQUARE = vv.RectangleMesh(size=(1, 1), counts=(2, 1), origin=(0.5, 0), cell="quad8")


@pytest.mark.parametrize("plane", ["", "strain", "axisymmetric"])
def test_python_tells_what_the_core_does(plane: Any) -> None:
    material = vv.NeoHooke(young=5.0, poisson=0.3)
    given: dict[str, Any] = {"mesh": SQUARE, "plane": plane} if plane else {"mesh": BOX}
    solid = vv.Solid(material=material, formulation="displacement", density=1.0, **given)
    system = vv.System([solid])
    x = system.x + 0.05 * np.random.default_rng(4).standard_normal(len(system.x))
    ((cell, nodes),) = solid.grid.cells.items()
    rule = solid_rule(solid.grid.points, nodes, cell)
    g = geometry(solid.grid.points, nodes, cell, rule=rule, axisymmetric=plane == "axisymmetric")

    def respond(x: Array, of: Any, C: Array) -> tuple[Array, Array]:
        W, S, _ = material.respond(C.reshape(-1, 6))
        return S.reshape(C.shape), W.reshape(C.shape[:2])

    def vectors(x: Array, some: slice) -> Array:
        return np.asarray(solid.positions(x)[nodes[some]])

    cells = StressedCells(nodes, g.gradients, g.volume, CELLS[cell].N(rule.points), vectors, respond, g.hoop)
    rows, expected = cells.fields(x, 0, len(nodes)), solid.fields(x)
    np.testing.assert_allclose(rows[..., :9].reshape(expected.F.shape), expected.F, atol=1e-13)
    S = rows[..., 9:15][..., [[0, 3, 5], [3, 1, 4], [5, 4, 2]]]
    np.testing.assert_allclose(S, expected.second_piola, atol=1e-12)
    np.testing.assert_allclose(rows[..., 15], expected.energy, atol=1e-13)
    np.testing.assert_array_equal(cells.fields(x, 1, 2), rows[1:2])
    forces = summed(solid.grid, [(nodes, cells.forces(x))], None)
    np.testing.assert_allclose(forces, solid.nodal_forces(x), atol=1e-12)
    assert np.abs(forces).max() > 0.1
