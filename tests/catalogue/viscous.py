"""Solids whose stress relaxes."""

from __future__ import annotations

from typing import Any

import visviva as vv
from catalogue.entry import ALL, ENERGY, IN_PLANE, MOMENTA, NOTHING, PLANE_MOMENTA, Components, Entry

RUBBER = vv.NeoHooke(lame_lambda=20.0, shear=10.0)
BRANCHES = (
    vv.MaxwellBranch(time=0.1, share=1.5),
    vv.MaxwellBranch(time=2.0, spring=vv.Hencky(shear=5.0, bulk=1.0)),
)


def brick(cell: str = "hex8", material: Any = RUBBER, **options: Any) -> vv.ViscoelasticSolid:
    return vv.ViscoelasticSolid(
        mesh=vv.BoxMesh(size=(1, 0.8, 0.6), counts=(2, 1, 1), cell=cell),
        material=material,
        density=1.0,
        branches=BRANCHES,
        angular_velocity=(0.3, 0.6, 1.0),
        velocity=lambda X: X * X,
        **options,
    )


def plate(plane: Any, cell: str = "quad4", **options: Any) -> vv.ViscoelasticSolid:
    return vv.ViscoelasticSolid(
        mesh=vv.RectangleMesh(size=(1, 0.8), counts=(2, 1), cell=cell, origin=(0.2, 0)),
        material=RUBBER,
        density=1.0,
        branches=BRANCHES,
        plane=plane,
        velocity=lambda X: X * X,
        **options,
    )


def held() -> Components:
    """Without functions of Python."""
    mesh = vv.BoxMesh(size=(1, 0.8, 0.6), counts=(2, 1, 1))
    body = vv.ViscoelasticSolid(mesh=mesh, material=RUBBER, density=1.0, branches=BRANCHES)
    pull = vv.Prescribed(solid=body, nodes="x1", motion=("0.2*sin(5*t)", None, None))
    return [body, vv.Fixed(solid=body, nodes="x0"), pull]


HEAT = vv.Heat(conductivity=0.5, capacity=0.2, expansion=0.005, reference=20.0, moduli_slope=0.02)
SHIFTED = (
    vv.MaxwellBranch(time=0.1, share=1.5, shift=vv.Arrhenius(energy=400.0, reference=20.0)),
    vv.MaxwellBranch(
        time=2.0, spring=vv.Hencky(shear=5.0, bulk=1.0), shift=vv.WLF(reference=20.0, c1=1.0, c2=30.0)
    ),
)


def heated(cell: str = "hex8", **options: Any) -> vv.ThermoviscoelasticSolid:
    return vv.ThermoviscoelasticSolid(
        mesh=vv.BoxMesh(size=(1, 0.8, 0.6), counts=(2, 1, 1), cell=cell),
        material=RUBBER,
        density=1.0,
        heat=HEAT,
        temperature=lambda X: 20 + 3 * X[:, 0] ** 2,
        branches=SHIFTED,
        angular_velocity=(0.3, 0.6, 1.0),
        velocity=lambda X: X * X,
        **options,
    )


def sheet(plane: Any) -> vv.ThermoviscoelasticSolid:
    return vv.ThermoviscoelasticSolid(
        mesh=vv.RectangleMesh(size=(1, 0.8), counts=(2, 1), origin=(0.2, 0)),
        material=RUBBER,
        density=1.0,
        plane=plane,
        heat=HEAT,
        temperature=lambda X: 20 + 3 * X[:, 0] ** 2,
        branches=SHIFTED,
        velocity=lambda X: X * X,
    )


VISCOUS = [
    Entry("viscoelastic brick", lambda: [brick()], MOMENTA, steps=40),
    Entry("viscoelastic brick, F-bar", lambda: [brick(formulation="F-bar")], MOMENTA, steps=20),
    Entry(
        "viscoelastic brick, tet10, mixed", lambda: [brick("tet10", formulation="mixed")], MOMENTA, steps=20
    ),
    Entry("viscoelastic brick, pulled", held, NOTHING, steps=30),
    Entry("viscoelastic plate", lambda: [plate("strain")], PLANE_MOMENTA, steps=40),
    Entry("thermoviscoelastic brick", lambda: [heated()], ALL, steps=40),
    Entry("thermoviscoelastic brick, F-bar", lambda: [heated(formulation="F-bar")], ALL, h=0.01, steps=10),
    Entry("thermoviscoelastic brick, mixed", lambda: [heated(formulation="mixed")], ALL, h=0.01, steps=10),
    Entry(
        "thermoviscoelastic brick, enhanced", lambda: [heated(formulation="enhanced")], ALL, h=0.01, steps=20
    ),
    Entry("thermoviscoelastic sheet", lambda: [sheet("strain")], IN_PLANE, h=0.01, steps=20),
    Entry("thermoviscoelastic ring", lambda: [sheet("axisymmetric")], ENERGY, h=0.01, steps=20),
    Entry("viscoelastic ring", lambda: [plate("axisymmetric", "quad9")], NOTHING, steps=20),
]
