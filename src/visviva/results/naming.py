"""Names within the files of a run: clocks, fields and columns with their units."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from visviva.base.unit_labels import BASE, DERIVED, Units
from visviva.load.gravity import Gravity
from visviva.measure.names import FIELDS, PARTS, SINGLE, quantity_of, spoken
from visviva.output.labels import Labels
from visviva.output.tables import LOAD

if TYPE_CHECKING:
    from visviva.scheme.schemes import Scheme
    from visviva.system.system import System

T = TypeVar("T")
LABELLED = (*BASE, *DERIVED, "stress", "energy", "power", "entropy", "angle")


def clock_of(scheme: Scheme) -> str:
    """Clock of a run: seconds, load factors, or the count of states on a path through limit points."""
    if not scheme.has_growing_time:
        return "state"
    return "time" if scheme.has_inertia else "load parameter"


def with_clock(columns: Mapping[str, T], scheme: Scheme) -> dict[str, T]:
    """Columns for files, where ``time`` is called by what it is."""
    called = "time" if scheme.has_inertia else LOAD
    return {called if name == "time" else name: value for name, value in columns.items()}


def labels_of(
    units: Units,
    scheme: Scheme,
    title: str = "",
    fields: Iterable[str] = FIELDS,
    columns: Mapping[str, str] | None = None,
    up: tuple[float, float, float] | None = None,
) -> Labels:
    """Labels of what a run writes.

    Examples
    --------
    >>> import visviva as vv
    >>> labels_of(Units.of("N-mm-t"), vv.Static()).axis("time")
    'load parameter'
    >>> labels_of(Units.of("N-mm-t"), vv.EnergyMomentum()).field("von_mises")
    'von Mises stress [MPa]'
    """
    of_quantities = {quantity: units[quantity] for quantity in LABELLED if units[quantity]}
    named = [*fields, *SINGLE]
    return Labels(
        title,
        clock_of(scheme),
        of_quantities,
        dict(columns or {}),
        {name: spoken(name) for name in named},
        {name: unit for name in named if (unit := units[quantity_of(name)])},
        {name: PARTS[name] for name in named if name in PARTS},
        up,
    )


def up_of(system: System) -> tuple[float, float, float] | None:
    """Upward direction of a system: against its gravity, if there is some.

    Examples
    --------
    >>> import visviva as vv
    >>> up_of(vv.System([vv.PointMass(mass=1.0), vv.Gravity(acceleration=(0, -9.81, 0))]))
    (0.0, 1.0, 0.0)
    """
    weights = [c.acceleration for c in system.components if isinstance(c, Gravity)]
    pull = np.sum(weights, axis=0) if weights else np.zeros(3)
    size = float(np.linalg.norm(pull))
    x, y, z = (-pull / size + 0.0).tolist() if size > 0 else (0.0, 0.0, 1.0)
    return (x, y, z) if size > 0 else None


def ledger_units(names: Iterable[str], units: Units, scheme: Scheme) -> dict[str, str]:
    """Columns of a ledger with their units."""
    found = {
        name: units[ledger_quantity(name)] if name != "time" or scheme.has_inertia else "" for name in names
    }
    return with_clock(found, scheme)


def ledger_quantity(name: str) -> str:
    """Quantity of a column of a ledger."""
    if name == "time":
        return "time"
    if name.startswith("momentum_"):
        return "momentum"
    if name.startswith("angular_"):
        return "angular_momentum"
    if name.startswith("entropy") or name == "defect_entropy":
        return "entropy"
    return "" if name.startswith("defect_") else "energy"
