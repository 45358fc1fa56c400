"""What solids with heat do not take, and what to say of strong couplings of heat and strains."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.body import formulation as forms
from visviva.mesh.cells import CELLS
from visviva.thermal.heat import Heat, HeatLaw

if TYPE_CHECKING:
    from visviva.material.material import Material
    from visviva.thermal.thermoelastic_solid import ThermoelasticSolid

Array = NDArray[np.float64]

SPRINGING = 0.02
"""Part of the difference from the reference by which temperatures are told to change where free strains spring open."""
LOCKING, SWINGING = 1.0, 20.0
"""Couplings of heat and strains from which on linear cells lock (``benchmarks/held_heat.py``), and steps swing."""


def brick(solid: ThermoelasticSolid) -> str:
    """The cell that formulations against locking are for."""
    return forms.BRICKS[solid.grid.dimension - 2]


def refuse_others(solid: ThermoelasticSolid) -> None:
    """Refuse what a solid takes that one with heat does not.

    Raises
    ------
    InputError
    """
    if solid.plane == "stress" and solid.heat.energy() is not None:
        raise InputError(
            f"{solid.label}: plane = 'stress' is not for {type(solid.heat).__name__}; take 'strain', or one layer of "
            "cells in space"
        )
    if solid.formulation == "mixed" and solid.heat.energy() is not None:
        raise InputError(
            f"{solid.label}: formulation = {solid.formulation!r} is not for {type(solid.heat).__name__}; take "
            f"'F-bar' or 'enhanced' with {brick(solid)}, or 'displacement' with cells of second order"
        )
    if solid.formulation == "mixed":
        refuse_pressures(solid)
    if solid.body_material.small or (solid.body_material.energy is not None and solid.heat.energy() is None):
        raise InputError(
            f"{solid.label}: {type(solid.body_material).__name__} is no material of finite strains of the core; for "
            "small strains take vv.SaintVenantKirchhoff, for an energy of your own vv.UserHeat"
        )
    if isinstance(solid.heat, Heat):
        refuse_heat(solid, solid.heat)


def refuse_pressures(solid: ThermoelasticSolid) -> None:
    """Refuse mixed elements whose pressures would oscillate, or have no bulk modulus.

    Raises
    ------
    InputError
    """
    equal = [cell for cell in solid.grid.cells if cell in forms.STABILISED]
    if equal:
        raise InputError(
            f"{solid.label}: pressures of {', '.join(equal)} would oscillate beside temperatures; take cells of "
            f"second order with formulation='mixed', or {brick(solid)}"
        )
    if not np.isfinite(solid.body_material.lame[0]):
        raise InputError(
            f"{solid.label}: pressures and heat need a material whose volume changes; take a Poisson's ratio below "
            "0.5, 0.4999 say"
        )


def refuse_heat(solid: ThermoelasticSolid, heat: Heat) -> None:
    """Refuse expansion of what is incompressible, and temperatures beyond where slopes of `heat` have a meaning.

    Raises
    ------
    InputError
    """
    if heat.expansion and not np.isfinite(solid.body_material.lame[0]):
        raise InputError(
            f"{solid.label}: an incompressible material cannot expand; make its bulk modulus finite"
        )
    if beyond := heat.beyond_slopes(solid.start_temperatures):
        raise InputError(f"{solid.label}: {beyond}")


def bulk(material: Material) -> float:
    """9 K of a material."""
    lam, mu = material.lame
    return 9 * lam + 6 * mu


def strained_at_the_start(label: str, heat: HeatLaw, modulus: float, T: Array) -> list[str]:
    """A remark on a body that begins in the shape of its mesh, far from the temperature at which that has no stress.

    What it may spring open by, at constant entropy, takes ``p / (1 + p) (T - T0)`` of its temperature, where
    ``p = modulus expansion^2 T / c`` and the modulus is 9 K of what expands in all directions, and E of a rod.
    """
    if not isinstance(heat, Heat):
        return []
    nearest = float(np.clip(heat.reference, T.min(), T.max()))
    part = modulus * heat.expansion**2 * nearest / float(heat.stores.at(np.array([nearest]))[0])
    change = part / (1 + part) * (nearest - heat.reference)
    if part < SPRINGING or not change:
        return []
    return [
        f"{label}: is at {nearest:.6g} K or farther from the reference {heat.reference:.6g} K of its heat, at which "
        "the shape of its mesh has no stress: it begins with stress, and where nothing holds it springs open at once, "
        f"which changes its temperature by {-change:.3g} K and leaves it swinging; give vv.Heat(reference=...) the "
        "temperature at which it has this shape, or warm it by what happens in the run"
    ]


def coupling_remarks(solid: ThermoelasticSolid) -> list[str]:
    """Where heat and strains couple so strongly that linear cells lock, or steps swing."""
    if not isinstance(solid.heat, Heat):
        return []
    found = strained_at_the_start(
        solid.label, solid.heat, bulk(solid.body_material), solid.start_temperatures
    )
    number = solid.heat.coupling_number(solid.body_material, float(solid.start_temperatures.mean()))
    said = f"{solid.label}: heat and strains couple by T beta^2 / (M c) = {number:.2g} (beta = 3 K expansion)"
    linear = any(CELLS[kind].n_nodes == CELLS[kind].n_corners for kind in solid.grid.cells)
    thins = solid.plane == "stress"  # so that its volume changes freely
    if number >= LOCKING and linear and solid.formulation == "displacement" and not thins:
        found.append(
            f"{said}, so that it hardly changes its volume without heat, and linear cells lock: take "
            f"formulation='enhanced', 'F-bar' or 'mixed' with {brick(solid)}, or cells of second order"
        )
    if number >= SWINGING:
        found.append(
            f"{said}: where temperatures change by some per cent, steps of schemes that damp nothing swing or "
            "fail; take BDF2() or BackwardEuler()"
        )
    return found
