"""Functions of places are asked of a part of the points at once, in types of cells and in processes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]
MESHES = {
    "cells": vv.RectangleMesh(size=(1, 1), counts=(3, 2)),
    "spline": vv.SplineBox(size=(1.0, 1.0), counts=(3, 2), degree=2),
}


def solid(mesh: str, strain: Callable[[Array], Array]) -> vv.Component:
    kind = vv.SplineSolid if mesh == "spline" else vv.Solid
    material = vv.SaintVenantKirchhoff(young=1.0, poisson=0.2)
    return kind(mesh=MESHES[mesh], material=material, thermal_strain=strain, name="plate")


@pytest.mark.parametrize("mesh", MESHES)
@pytest.mark.parametrize(
    "strain",
    [
        lambda X: 0.04 * X[:, 0] / X[:, 0].max(),
        lambda X: 0.01 * (X[:, 1] - X[:, 1].mean()),
        lambda X: 0.01 * np.random.default_rng(1).random(len(X)),
        lambda X: np.linspace(0.0, 0.01, len(X)),
    ],
    ids=["max", "mean", "random", "numbers"],
)
def test_strains_of_heat_that_hinge_on_other_points_are_refused(
    mesh: str, strain: Callable[[Array], Array]
) -> None:
    """Two processes had other strains than one."""
    with pytest.raises(vv.InputError, match=r"'plate': its thermal_strain at .* of this point alone"):
        vv.System([solid(mesh, strain)])


@pytest.mark.parametrize("mesh", MESHES)
@pytest.mark.parametrize(
    "strain",
    [
        lambda X: 0.04 * X[:, 0],
        lambda X: np.where(X[:, 1] > 0.5, 0.01, 0.0),
        lambda X: 1e-12 * np.sin(X[:, 0]),
        lambda X: np.zeros(len(X)),
        lambda X: 0.01 * X[:, : 1 if np.ptp(X[:, 1]) == 0 else 2].mean(axis=1),
    ],
    ids=["slope", "jump", "small", "none", "plane"],
)
def test_those_of_their_own_point_alone_are_taken(mesh: str, strain: Callable[[Array], Array]) -> None:
    vv.System([solid(mesh, strain)])
