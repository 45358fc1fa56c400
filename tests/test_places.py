"""Functions of places are asked of a part of the points at once, in types of cells and in processes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial import Delaunay

import visviva as vv
from visviva.base.places import OfPart

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


def mixed() -> vv.Mesh:
    """Quadrangles beside triangles."""
    left = vv.RectangleMesh(size=(1, 1), counts=(2, 2)).build()
    right = vv.RectangleMesh(size=(1, 1), counts=(2, 2), cell="tri3", origin=(1, 0)).build()
    return left.merged(right, weld=1e-9)


def heated(body: vv.ThermalBody, power: Callable[[float, Array], Array]) -> None:
    source = vv.HeatSource(body=body, power=power, name="stove")
    vv.simulate(vv.System([body, source]), until=1.0, step=0.5)


def test_sources_of_heat_that_hinge_on_other_points_are_refused() -> None:
    """Each type of cells had its own mean: twice the heat."""
    body = vv.ThermalBody(mesh=mixed(), conductivity=1.0, capacity=1.0, density=1.0, temperature=300.0)
    for power in (lambda t, X: X[:, 0] - X[:, 0].mean(), lambda t, X: t * X[:, 0] / X[:, 0].max()):
        with pytest.raises(vv.InputError, match=r"'stove': its power at .* of this point alone"):
            heated(body, power)


def test_tractions_that_hinge_on_other_points_are_refused() -> None:
    solid = vv.Solid(mesh=mixed(), material=vv.SaintVenantKirchhoff(young=1.0, poisson=0.2), density=1.0)
    with pytest.raises(
        vv.InputError, match=r"'wind': its traction at .*\] is \[.*, and of this point alone \[[^\[]*\]: it"
    ):
        vv.Traction(
            solid=solid,
            faces="y1",
            traction=lambda t, X: (X - X.mean(axis=0)) * [0, 1e-3, 0] + X * [0, 1, 0],
            name="wind",
        )


def test_functions_may_move_what_they_are_given() -> None:
    """A source that subtracts the centre in place moved the points at every call, and gave next to nothing."""

    def in_place(t: float, X: Array) -> Array:
        X -= [0.5, 0.5, 0.0]
        return np.exp(-np.sum(X**2, axis=1) / 0.1)

    def fresh(t: float, X: Array) -> Array:
        return in_place(t, X.copy())

    ends = []
    for power in (in_place, fresh):
        body = vv.ThermalBody(
            mesh=MESHES["cells"],
            conductivity=1.0,
            capacity=1.0,
            density=1.0,
            temperature=lambda X: in_place(0.0, X),
        )
        system = vv.System([body, vv.HeatSource(body=body, power=power)])
        vv.simulate(system, until=1.0, step=0.25)
        ends.append(body.temperatures(system.x))
    assert ends[0].mean() > 0.1
    assert np.array_equal(*ends)


def test_functions_may_keep_what_they_give() -> None:
    """One that fills an array of its own gave other points' values where it was looked at."""
    own = np.zeros((99, 3))

    def kept(t: float, X: Array) -> Array:
        own[: len(X)] = [1.0 + t, 0.0, 0.0] * X
        return own[: len(X)]

    fluid = vv.Fluid(mesh=MESHES["cells"], density=1.0, viscosity=1.0, body_force=kept)
    X = np.linspace(1.0, 2.0, 30).reshape(10, 3)
    for t in (1.0, 2.0):
        assert fluid.force_at(t, X)[:, 0] == pytest.approx((1 + t) * X[:, 0])
    found = OfPart("stove", "power", lambda t, X: kept(t, X)[:, 0])(0.0, X)
    kept(1.0, X)
    assert found == pytest.approx(X[:, 0])


def test_what_is_given_at_nodes_is_asked_of_all_of_them_at_once() -> None:
    """Profiles over the width of their own side were refused, as if they were asked of a part of it."""

    def profile(t: float, X: Array) -> Array:
        return 0.5 + 0.1 * X[:, 0] / X[:, 0].max()

    warm = vv.ThermalBody(mesh=mixed(), conductivity=1.0, capacity=1.0, density=1.0, temperature=0.5)
    held = vv.PrescribedTemperature(body=warm, nodes="y0", value=profile)
    alloy = vv.CahnHilliard(
        mesh=mixed(),
        free_energy=vv.PolynomialEnergy(coefficients=(0, 0, 1.0)),
        gradient_energy=0.1,
        concentration=0.5,
    )
    soaked = vv.PrescribedConcentration(body=alloy, nodes="y0", value=profile)
    for body, given in ((warm, held), (alloy, soaked)):
        system = vv.System([body, given])
        vv.simulate(system, until=0.2, step=0.1)
        below = body.nodes("y0")
        found = body.temperatures(system.x) if body is warm else alloy.values(system.x)
        assert found[below] == pytest.approx(0.5 + 0.05 * body.points[below, 0])


def test_what_hinges_on_other_points_later_is_refused_then() -> None:
    """It was looked at once, at the start."""
    body = vv.ThermalBody(mesh=mixed(), conductivity=1.0, capacity=1.0, density=1.0, temperature=300.0)
    with pytest.raises(vv.InputError, match=r"'stove': its power at .* of this point alone"):
        heated(body, lambda t, X: X[:, 0] if t < 0.6 else X[:, 0] / X[:, 0].max())


def test_what_is_the_same_everywhere_may_hinge_on_their_number() -> None:
    """Two types of cells gave twice the heat, of which each point had its share."""
    body = vv.ThermalBody(mesh=mixed(), conductivity=1.0, capacity=1.0, density=1.0, temperature=300.0)
    with pytest.raises(vv.InputError, match=r"'stove': its power at .* of this point alone"):
        heated(body, lambda t, X: np.full(len(X), 1.0 / len(X)))


def test_functions_that_fail_of_two_points_are_named() -> None:
    """Those that make triangles of them, say: that ended in what Qhull prints."""

    def in_triangles(t: float, X: Array) -> Array:
        return 1.0 + Delaunay(X[:, :2]).find_simplex(X[:, :2])

    body = vv.ThermalBody(mesh=mixed(), conductivity=1.0, capacity=1.0, density=1.0, temperature=300.0)
    with pytest.raises(vv.InputError, match=r"'stove': its power raised QhullError: .* of two points alone"):
        heated(body, in_triangles)


def test_functions_may_be_asked_of_no_points() -> None:
    """A process may have none."""
    assert OfPart("stove", "power", lambda t, X: X[:, 0])(0.0, np.zeros((0, 3))).shape == (0,)


def test_each_of_two_batches_with_as_many_points_is_looked_at() -> None:
    """The second at the same time was not: of two types of cells with as many points loads were 4 % too large."""
    near = np.column_stack([np.linspace(0.0, 1.0, 50), np.zeros((50, 2))])
    load = OfPart("wall", "load", lambda t, X: np.where(X[:, 0] > 1.5, X[:, 0] / X[:, 0].max(), 0.0))
    assert not load(0.0, near).any()
    with pytest.raises(vv.InputError, match=r"wall: its load at .* of this point alone"):
        load(0.0, near + np.array([2.0, 0, 0]))


def test_forces_on_two_types_of_cells_with_as_many_points_are_looked_at() -> None:
    four = vv.RectangleMesh(size=(1, 1), counts=(3, 1)).build()
    three = vv.RectangleMesh(size=(1, 1), counts=(2, 1), origin=(1, 0), cell="tri3").build()

    def force(t: float, X: Array) -> Array:
        x = X[:, :1]
        return np.where(x > 1, x / max(x.max(), 1e-9), 0.0) * [1.0, 0.0, 0.0]

    plate = vv.Solid(
        mesh=four.merged(three, weld=1e-6), material=vv.NeoHooke(young=1.0, poisson=0.3), density=1.0
    )
    parts = [plate, vv.BodyForce(solid=plate, force=force, name="pull"), vv.Fixed(solid=plate, nodes="x0")]
    with pytest.raises(vv.InputError, match=r"pull'?: its .*force.* at .* of this point alone"):
        vv.simulate(vv.System(parts), until=0.1, step=0.1)
