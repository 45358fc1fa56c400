"""Solids that crack."""

from __future__ import annotations

from typing import Any

import numpy as np

import visviva as vv
from catalogue.entry import ALL, ENERGY, IN_PLANE, MOMENTA, NOTHING, PLANE_MOMENTA, Components, Entry

GREEN = vv.SaintVenantKirchhoff(young=30.0, poisson=0.3)
HENCKY = vv.Hencky(young=30.0, poisson=0.3)
RUBBER = vv.NeoHooke(young=30.0, poisson=0.3, isochoric=True)


def brick(
    material: Any, split: Any, cell: str = "hex8", model: Any = "AT2", **options: Any
) -> vv.FracturingSolid:
    return vv.FracturingSolid(
        mesh=vv.BoxMesh(size=(1, 0.8, 0.6), counts=(2, 1, 1), cell=cell),
        material=material,
        density=1.0,
        toughness=0.5,
        length=1.0,
        model=model,
        split=split,
        residual=1e-3,
        angular_velocity=(0.3, 0.6, 1.0),
        velocity=lambda X: X * X,
        **options,
    )


def remembering() -> Components:
    return [brick(GREEN, "spectral", model="AT1", irreversibility="history")]


def plate(
    material: Any, split: Any, plane: Any = "strain", cell: str = "quad4", **options: Any
) -> vv.FracturingSolid:
    given = {"damage": lambda X: 0.4 * (X[:, 0] > 1), **options}
    return vv.FracturingSolid(
        mesh=vv.RectangleMesh(size=(1, 0.8), counts=(3, 2), cell=cell, origin=(0.2, 0)),
        material=material,
        density=1.0,
        toughness=0.5,
        length=0.5,
        split=split,
        plane=plane,
        velocity=lambda X: X * X,
        **given,
    )


def pulled() -> Components:
    """Without functions of Python."""
    mesh = vv.RectangleMesh(size=(1, 0.8), counts=(3, 2))
    body = vv.FracturingSolid(
        mesh=mesh, material=GREEN, density=1.0, toughness=0.5, length=0.5, model="AT1", split="spectral"
    )
    pull = vv.Prescribed(solid=body, nodes="x1", motion=("0.2*sin(5*t)", None, None))
    return [body, vv.Fixed(solid=body, nodes="x0"), pull]


def cooled(plane: Any = None) -> Components:
    mesh: Any = vv.BoxMesh(size=(1, 0.8, 0.6), counts=(2, 1, 1))
    if plane:
        mesh = vv.RectangleMesh(size=(1, 0.8), counts=(3, 2), origin=(0.2, 0))
    body = vv.FracturingSolid(
        mesh=mesh,
        material=HENCKY,
        density=1.0,
        toughness=0.5,
        length=1.0,
        split="spectral",
        plane=plane or "strain",
        free_strain=lambda t, X: -0.2 * t * (1 + X[:, 0]),
    )
    return [body]


def warm(plane: Any = None, **options: Any) -> Components:
    mesh: Any = vv.BoxMesh(size=(1, 0.8, 0.6), counts=(2, 1, 1))
    if plane:
        mesh = vv.RectangleMesh(size=(1, 0.8), counts=(3, 2), origin=(0.2, 0))
    body = vv.ThermalFracturingSolid(
        mesh=mesh,
        density=1.0,
        toughness=0.5,
        length=1.0,
        plane=plane or "strain",
        heat=vv.Heat(conductivity=0.3, capacity=0.2, expansion=2e-3, reference=300.0, capacity_slope=1e-3),
        cracked_conductivity=0.2,
        **options,
    )
    return [body]


def flying(plane: Any = None, **options: Any) -> Components:
    return warm(plane, temperature=lambda X: 300 + 10 * X[:, 0], velocity=lambda X: X * X, **options)


def repeating() -> Components:
    """Damages, entropies and temperatures of two sides are one, and the crack is at them."""
    (body,) = warm("strain", material=GREEN, damage=lambda X: 0.4 * (np.abs(X[:, 0] - 0.7) > 0.4))
    assert isinstance(body, vv.ThermalFracturingSolid)
    sides = vv.PeriodicFaces(solid=body, pairs=[("x0", "x1")], strain=(0.1, 0, 0), times="sin(4*t)")
    hot = vv.PrescribedTemperature(body=body, nodes="x0", value="300 - 200*t")
    return [body, sides, hot]


def warmed() -> Components:
    """Without functions of Python."""
    (body,) = warm("strain", material=GREEN, model="AT1", split="spectral")
    assert isinstance(body, vv.ThermalFracturingSolid)
    hot = vv.PrescribedTemperature(body=body, nodes="x0", value="300 - 200*t")
    return [body, vv.Fixed(solid=body, nodes="x1"), hot]


FRACTURE = [
    Entry("cracking brick, warm", lambda: flying(material=GREEN, split="spectral"), ALL, steps=20),
    Entry(
        "cracking plate, warm",
        lambda: flying("strain", material=HENCKY, split="volumetric"),
        IN_PLANE,
        steps=20,
    ),
    Entry("cracking ring, warm", lambda: flying("axisymmetric", material=GREEN), ENERGY, steps=20),
    Entry("cracking plate, warmed", warmed, NOTHING, steps=20),
    Entry("cracking cell that repeats, warmed", repeating, NOTHING, steps=20),
    Entry("cracking brick, cooled", cooled, MOMENTA, steps=20),
    Entry("cracking plate, cooled", lambda: cooled("strain"), PLANE_MOMENTA, steps=20),
    Entry("cracking ring, cooled", lambda: cooled("axisymmetric"), NOTHING, steps=20),
    Entry("cracking brick", lambda: [brick(vv.NeoHooke(young=30.0, poisson=0.3), "none")], ALL, steps=40),
    Entry("cracking brick, AT1", lambda: [brick(GREEN, "none", "hex27", "AT1")], ALL, steps=20),
    Entry("cracking brick, volume of Hencky", lambda: [brick(HENCKY, "volumetric")], ALL, steps=20),
    Entry("cracking brick, volume of rubber", lambda: [brick(RUBBER, "volumetric")], ALL, steps=20),
    Entry("cracking brick, Green's strains", lambda: [brick(GREEN, "spectral")], ALL, steps=20),
    Entry(
        "cracking brick, logarithmic strains", lambda: [brick(HENCKY, "spectral", "wedge6")], ALL, steps=20
    ),
    Entry("cracking plate", lambda: [plate(GREEN, "spectral")], IN_PLANE, steps=40),
    Entry("cracking plate, trace", lambda: [plate(GREEN, "volumetric", cell="tri6")], IN_PLANE, steps=20),
    Entry("cracking ring", lambda: [plate(HENCKY, "spectral", "axisymmetric")], ENERGY, steps=20),
    Entry("cracking plate, pulled", pulled, NOTHING, steps=30),
    Entry("cracking brick, history field", remembering, MOMENTA, steps=20, balances=False),
    Entry(
        "cracking plate, history field",
        lambda: [plate(GREEN, "spectral", damage=0.0, irreversibility="history")],
        PLANE_MOMENTA,
        steps=40,
        balances=False,
    ),
    Entry(
        "cracking ring, history field",
        lambda: [plate(HENCKY, "volumetric", "axisymmetric", damage=0.0, irreversibility="history")],
        NOTHING,
        steps=20,
        balances=False,
    ),
]
