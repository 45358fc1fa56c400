"""How the files of a run call what they hold: clocks, fields and columns with their units."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from visviva.base.unit_labels import BASE, DERIVED, Units
from visviva.measure.names import FIELDS, quantity_of, spoken
from visviva.output.labels import Labels

if TYPE_CHECKING:
    from visviva.scheme.schemes import Scheme

LABELLED = (*BASE, *DERIVED, "stress", "energy", "power", "angle")


def clock_of(scheme: Scheme) -> str:
    """What the times of a run are: load steps are no seconds, and paths through limit points count their states."""
    if not scheme.has_growing_time:
        return "state"
    return "time" if scheme.has_inertia else "load parameter"


def labels_of(
    units: Units,
    scheme: Scheme,
    title: str = "",
    fields: Iterable[str] = FIELDS,
    columns: Mapping[str, str] | None = None,
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
    named = list(fields)
    return Labels(
        title,
        clock_of(scheme),
        of_quantities,
        dict(columns or {}),
        {name: spoken(name) for name in named},
        {name: unit for name in named if (unit := units[quantity_of(name)])},
    )


def ledger_units(names: Iterable[str], units: Units, scheme: Scheme) -> dict[str, str]:
    """Columns of a ledger with their units."""
    return {
        name: units[ledger_quantity(name)] if name != "time" or scheme.has_inertia else "" for name in names
    }


def ledger_quantity(name: str) -> str:
    """Quantity of a column of a ledger."""
    if name == "time":
        return "time"
    if name.startswith("momentum_"):
        return "momentum"
    if name.startswith("angular_"):
        return "angular_momentum"
    return "" if name.startswith("defect_") else "energy"
