"""Solids that repeat in space: patch of a distorted cell, momenta, refusals."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import visviva as vv

ALL_SIDES = (("x0", "x1"), ("y0", "y1"), ("z0", "z1"))
GRADIENT = np.array([(0.1, 0.2, 0.0), (0.0, -0.05, 0.1), (0.05, 0.0, 0.02)])


def cell(kind: str = "hex8", **options: Any) -> vv.Solid:
    mesh = vv.BoxMesh(size=(1, 0.9, 1.1), counts=(2, 2, 2), cell=kind).build()  # type: ignore[arg-type]
    rng, points = np.random.default_rng(3), mesh.points.copy()
    inside = np.all((points > 0.01) & (points < np.array([0.99, 0.89, 1.09])), axis=1)
    points[inside] += 0.05 * rng.uniform(-1, 1, points[inside].shape)
    given = {"material": vv.NeoHooke(young=10.0, poisson=0.3), **options}
    return vv.Solid(mesh=replace(mesh, points=points), **given)


@pytest.mark.parametrize("kind", ["hex8", "tet4"])
def test_a_uniform_cell_deforms_alike(kind: str) -> None:
    body = cell(kind)
    sides = vv.PeriodicFaces(solid=body, pairs=ALL_SIDES, strain=GRADIENT, times="t")
    system = vv.System([body, sides, vv.Fixed(solid=body, nodes=np.array([0]))])
    vv.quasi_static(system, until=1.0, step=0.5)
    np.testing.assert_allclose(body.displacements(system.x), body.points @ GRADIENT.T, atol=1e-9)


def test_a_cell_that_swings_keeps_energy_and_momentum() -> None:
    body = cell(density=1.0, velocity=lambda X: np.sin(2 * np.pi * X / [1, 0.9, 1.1]) * 0.2)
    system = vv.System([body, vv.PeriodicFaces(solid=body, pairs=ALL_SIDES)])
    figures = vv.simulate(system, until=1.0, step=0.02).conservation()
    assert figures["energy"] < 1e-10
    assert max(figures[f"momentum_{c}"] for c in "xyz") < 1e-11


@pytest.mark.parametrize(
    ("pairs", "words"),
    [
        ((("x0", "y1"),), "do not meet those of 'y1'"),
        ((), "pairs is empty"),
        ((("x0", "x0"),), "is no pair of two sets"),
    ],
)
def test_refusals(pairs: Any, words: str) -> None:
    with pytest.raises(vv.InputError, match=re.escape(words)):
        vv.PeriodicFaces(solid=cell(), pairs=pairs)
