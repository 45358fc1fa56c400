"""Mixtures and order parameters, and what happens to them at walls."""

from __future__ import annotations

from typing import Any

import numpy as np

import visviva as vv
from catalogue.entry import MOMENTA, NOTHING, PLANE_MOMENTA, Components, Entry

WELL = vv.DoubleWell(barrier=4.0)
CHAINS = vv.FloryHuggins(chi=2.5, lengths=(1.0, 2.0))
HEATED = vv.RegularSolution(temperature="300 + 40*sin(3*t)", excess=(7e3, -1e3), volume=2500.0)
DIFFUSION = vv.ArrheniusMobility(base=0.9, activation=3e3, temperature="300 + 40*sin(3*t)")
KISTER = vv.RegularSolution(temperature=300.0, excess=(7e3, -1e3), volume=2500.0)


def wave(X: Any) -> Any:
    return 0.5 + 0.2 * np.cos(7 * X[:, 0] + 3 * X[:, 1]) * np.cos(5 * X[:, 1] + 2 * X[:, 2])


def mixture(cell: str = "quad4", **options: Any) -> vv.CahnHilliard:
    if cell in ("hex8", "tet10", "tet4", "hex20", "wedge6"):
        mesh: Any = vv.BoxMesh(size=(1, 0.8, 0.6), counts=(2, 2, 1), cell=cell)
    else:
        mesh = vv.RectangleMesh(size=(1, 0.8), counts=(3, 2), cell=cell)
    given = {"free_energy": WELL, "gradient_energy": 2.0, "mobility": 0.3, "concentration": wave, **options}
    return vv.CahnHilliard(mesh=mesh, **given)


def splines(**options: Any) -> vv.CahnHilliard:
    box = vv.SplineBox(size=(1, 0.8), counts=(4, 4), degree=2)
    return vv.CahnHilliard(
        mesh=box,
        free_energy=WELL,
        gradient_energy=2.0,
        mobility=0.3,
        concentration=wave,
        periodic=[("x0", "x1")],
        **options,
    )


def order(**options: Any) -> vv.AllenCahn:
    mesh = vv.RectangleMesh(size=(1, 0.8), counts=(3, 2), cell="tri6")
    given = {"free_energy": WELL, "gradient_energy": 2.0, "mobility": 3.0, "order": wave, **options}
    return vv.AllenCahn(mesh=mesh, **given)


def walled() -> Components:
    body = mixture("quad9", mobility=vv.DegenerateMobility(scale=0.4))
    return [
        body,
        vv.Wetting(body=body, faces="y0", angle=60.0),
        vv.PrescribedConcentration(
            body=body, nodes="x0", value=lambda t, X: 0.5 + 0.2 * np.sin(3 * t) + 0 * X[:, 0]
        ),
        vv.ConcentrationSource(body=body, rate=lambda t, X: 0.1 * t + X[:, 0]),
    ]


def plain() -> Components:
    """Without functions of Python."""
    body = mixture(concentration=0.4, periodic=[["y0", "y1"]])
    field = order(order=0.2, free_energy=vv.PolynomialEnergy(coefficients=(1.0, 0.5, -2.0, 0.0, 1.0)))
    other = order(order=0.3)
    chains = mixture(concentration=0.6, free_energy=CHAINS, mobility=vv.DegenerateMobility(scale=0.4))
    return [
        body,
        field,
        chains,
        mixture(concentration=0.3, free_energy=KISTER),
        vv.Wetting(body=body, faces="x0", angle=60.0),
        vv.PrescribedConcentration(body=body, nodes="x1", value="0.5 + 0.1*t"),
        vv.ConcentrationSource(body=field, rate="0.1*t"),
        other,
        vv.Exclusion(bodies=[field, other], strength=0.4),
    ]


def walled_order() -> Components:
    body = order(conserved=True)
    return [
        body,
        vv.Wetting(body=body, faces="y0", energy=vv.PolynomialEnergy(coefficients=(0.0, 0.3, -0.5, 0.2))),
        vv.ConcentrationSource(body=body, rate=lambda t, X: 0.1 * t + X[:, 0]),
    ]


def grains() -> Components:
    well = vv.PolynomialEnergy(coefficients=(0.0, 0.0, -0.5, 0.0, 0.25))
    bodies = [order(free_energy=well, order=lambda X, k=k: 0.4 + 0.2 * np.sin(X[:, 0] + k)) for k in range(3)]
    return [*bodies, vv.Exclusion(bodies=bodies, strength=1.5)]


def alloy(mesh: Any, **options: Any) -> vv.MixtureSolid:
    given = {
        "material": vv.NeoHooke(young=20.0, poisson=0.3),
        "density": 1.0,
        "free_energy": WELL,
        "gradient_energy": 2.0,
        "mobility": 0.3,
        "concentration": wave,
        "eigenstrain": (0.2, 0.1, -0.1),
        "reference": 0.4,
        "moduli": (0.5, 0.2, -0.1),
        "velocity": lambda X: 0.3 * X * X,
        **options,
    }
    return vv.MixtureSolid(mesh=mesh, **given)


def spline_alloy() -> Components:
    """Without functions of Python."""
    return [
        vv.SplineMixtureSolid(
            mesh=vv.SplineBox(size=(1, 0.8), counts=(3, 2), degree=2),
            material=vv.NeoHooke(young=20.0, poisson=0.3),
            density=1.0,
            free_energy=WELL,
            gradient_energy=2.0,
            mobility=0.3,
            concentration=0.6,
            eigenstrain=(0.2, 0.1, -0.1),
            reference=0.4,
            velocity=(0.1, 0.0, 0.0),
            angular_velocity=(0.0, 0.0, 2.0),
        )
    ]


def plain_alloy() -> Components:
    """Without functions of Python."""
    mesh = vv.RectangleMesh(size=(1, 0.8), counts=(3, 2))
    body = alloy(mesh, concentration=0.6, velocity=(0.1, 0.0, 0.0), periodic=[["y0", "y1"]])
    wall = vv.Wetting(body=body, faces="x0", angle=60.0)
    sides = vv.PeriodicFaces(solid=body, pairs=[("y0", "y1")])
    return [body, vv.ConcentrationSource(body=body, rate="0.1*t"), wall, sides]


TENSOR = [[2.0, 0.3, 0.0], [0.3, 1.5, 0.1], [0.0, 0.1, 1.0]]
PHASE = [
    Entry("mixture", lambda: [mixture()], NOTHING, steps=40),
    Entry("mixture, periodic", lambda: [mixture("quad8", periodic=[("x0", "x1")])], NOTHING, steps=40),
    Entry("mixture of chains", lambda: [mixture("tri3", free_energy=CHAINS)], NOTHING, steps=40),
    Entry("mixture, Redlich-Kister", lambda: [mixture("tet4", free_energy=KISTER)], NOTHING, steps=20),
    Entry(
        "mixture, heated",
        lambda: [mixture(free_energy=HEATED, mobility=DIFFUSION)],
        NOTHING,
        steps=20,
    ),
    Entry("mixture, anisotropic", lambda: [mixture("hex8", gradient_energy=TENSOR)], NOTHING, steps=40),
    Entry("mixture with walls", walled, NOTHING, steps=40),
    Entry("mixture on splines", lambda: [splines()], NOTHING, steps=40),
    Entry(
        "mixture in a plate",
        lambda: [alloy(vv.RectangleMesh(size=(1, 0.8), counts=(3, 2)))],
        PLANE_MOMENTA,
        steps=40,
    ),
    Entry(
        "mixture in a brick",
        lambda: [alloy(vv.BoxMesh(size=(1, 0.8, 0.6), counts=(2, 1, 1)))],
        MOMENTA,
        steps=40,
    ),
    Entry("mixture on splines in a plate", spline_alloy, PLANE_MOMENTA, steps=20),
    Entry("mixture in a plate, plain", plain_alloy, NOTHING, steps=20),
    Entry("order parameter", lambda: [order()], NOTHING, steps=40),
    Entry("order parameter, conserved, with a wall", walled_order, NOTHING, steps=40),
    Entry("grains", grains, NOTHING, steps=40),
    Entry("mixtures, plain", plain, NOTHING, steps=20),
    Entry(
        "mixture of the user's energy",
        lambda: [mixture(free_energy=vv.UserFreeEnergy(function=lambda c: 4 * c**2 * (1 - c) ** 2))],
        NOTHING,
        steps=20,
        analytic=False,
    ),
]
