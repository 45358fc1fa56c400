"""Names and units of fields and of the components of probes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from visviva.base.unit_labels import QUANTITIES, Units
from visviva.component.meshed import Meshed

if TYPE_CHECKING:
    from visviva.system.system import System

USUAL = ("von_mises", "pressure", "cauchy", "energy")
"""Fields of solids that trajectories hold unless others are chosen."""
LEADING = ("temperature", "concentration", "order", "damage")
"""And of what has them."""
FIELDS: dict[str, tuple[str, str]] = {
    "displacement": ("displacement", "length"),
    "velocity": ("velocity", "velocity"),
    "speed": ("speed", "velocity"),
    "pressure": ("pressure", "stress"),
    "vorticity": ("vorticity", "rate"),
    "stream_function": ("stream function", ""),
    "wall_shear": ("wall shear stress", "stress"),
    "velocity_gradient": ("velocity gradient", "rate"),
    "stress": ("stress", "stress"),
    "von_mises": ("von Mises stress", "stress"),
    "cauchy": ("Cauchy stress", "stress"),
    "second_piola": ("second Piola-Kirchhoff stress", "stress"),
    "first_piola": ("first Piola-Kirchhoff stress", "stress"),
    "principal_stresses": ("principal stresses", "stress"),
    "green": ("Green's strain", ""),
    "stretches": ("principal stretches", ""),
    "J": ("ratio of volumes", ""),
    "energy": ("strain energy per volume", "energy_density"),
    "thickness": ("thickness", "length"),
    "section_force": ("force in the section", "force"),
    "section_moment": ("moment in the section", "moment"),
    "diagram_shear_1": ("shear force 1", "force"),
    "diagram_shear_2": ("shear force 2", "force"),
    "diagram_normal": ("normal force", "force"),
    "diagram_bending_1": ("bending moment 1", "moment"),
    "diagram_bending_2": ("bending moment 2", "moment"),
    "diagram_torsion": ("torsion moment", "moment"),
    "membrane_force": ("membrane force", "line_force"),
    "bending_moment": ("bending moment", "force"),
    "shear_force": ("shear force", "line_force"),
    "contact_pressure": ("contact pressure", "stress"),
    "contact_gap": ("gap", "length"),
    "contact_state": ("state of contact", ""),
    "contact_traction": ("contact traction", "stress"),
    "temperature": ("temperature", "temperature"),
    "heat_flux": ("heat flux", "heat_flux"),
    "shape": ("shape", ""),
}
"""Human names of fields, and their quantities."""

SYMMETRIC = ("xx", "yy", "zz", "xy", "yz", "zx")
FULL = tuple(a + b for a in "xyz" for b in "xyz")
PARTS: dict[str, tuple[str, ...]] = {
    "cauchy": SYMMETRIC,
    "stress": SYMMETRIC,
    "second_piola": SYMMETRIC,
    "green": SYMMETRIC,
    "first_piola": FULL,
    "velocity_gradient": FULL,
    "principal_stresses": ("1", "2", "3"),
    "stretches": ("1", "2", "3"),
    "section_force": ("shear_1", "shear_2", "normal"),
    "section_moment": ("bending_1", "bending_2", "torsion"),
    "membrane_force": ("11", "22", "12"),
    "bending_moment": ("11", "22", "12"),
    "shear_force": ("1", "2"),
}
"""Components of fields that are no vectors."""
SINGLE = {f"{field}_{part}": (field, k) for field, parts in PARTS.items() for k, part in enumerate(parts)}
"""Components as fields of their own, such as ``cauchy_xx``: the field and the number of the component."""
SINGLE |= {
    f"{field}_{part[::-1]}": (field, k)
    for field, parts in PARTS.items()
    if parts is SYMMETRIC
    for k, part in enumerate(parts)
}


def quantity_of(field: str) -> str:
    """Quantity of a field; nothing if it is not known."""
    return FIELDS.get(SINGLE.get(field, (field, 0))[0], ("", ""))[1]


def spoken(field: str) -> str:
    """Human name of a field.

    Examples
    --------
    >>> spoken("cauchy_xx"), quantity_of("cauchy_xx")
    ('Cauchy stress xx', 'stress')
    """
    if field in SINGLE:
        of, k = SINGLE[field]
        return f"{spoken(of)} {PARTS[of][k].replace('_', ' ')}"
    return FIELDS.get(field, (field.replace("_", " "), ""))[0]


def parts_of(field: str, width: int) -> tuple[str, ...]:
    """Names of the components of a field; none for scalars."""
    known = PARTS.get(field, ())
    return known if len(known) == width else ()


def columns_of(name: str, probe: Any, value: Any) -> list[str]:
    """Columns of a probe with this present value: ``load_x``, ``load_y``, ``load_z``, or by names of its own.

    Examples
    --------
    >>> columns_of("load", None, [1.0, 2.0, 3.0]), columns_of("angle", None, 0.5)
    (['load_x', 'load_y', 'load_z'], ['angle'])
    """
    size = np.size(value)
    if size == 1:
        return [name]
    parts = tuple(getattr(probe, "parts", ()))
    ends = parts if len(parts) == size else tuple("xyz") if size == 3 else tuple(map(str, range(size)))
    return [f"{name}_{end}" for end in ends]


def units_of(name: str, probe: Any, value: Any, units: Units) -> list[str]:
    """Units of the columns of a probe: the one given by its name, or those of its quantities."""
    size = np.size(value)
    if name in units.names and name not in QUANTITIES:
        return size * [units.names[name]]
    each = getattr(probe, "quantities", None) or size * (getattr(probe, "quantity", ""),)
    return [units[quantity] if isinstance(quantity, str) and quantity else "" for quantity in each]


def usual_fields(system: System) -> tuple[str, ...]:
    """Fields that trajectories of a system hold unless others are chosen."""
    meshed = [c for c in system.components if isinstance(c, Meshed)]
    return (*USUAL, *(name for name in LEADING if any(name in c.widths() for c in meshed)))
