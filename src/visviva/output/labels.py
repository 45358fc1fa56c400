"""Names in pictures, plots and tables: human names and units, noted with the files of a run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields
from typing import Any, Self


@dataclass(frozen=True)
class Labels:
    """Names and units of what files hold.

    Parameters
    ----------
    title : str
        Of the study.
    clock : str
        What the times are: ``time``, ``load parameter`` or ``state``.
    units : mapping of str to str
        Of quantities such as ``time`` and ``energy``, as far as they are known.
    columns : mapping of str to str
        Units of the columns of tables.
    fields : mapping of str to str
        Human names of fields.
    field_units : mapping of str to str
        Their units.
    parts : mapping of str to sequence of str
        Names of the components of fields that are no vectors in space.
    up : tuple of float, optional
        What is up, against gravity.

    Examples
    --------
    >>> labels = Labels(units={"time": "s"}, fields={"von_mises": "von Mises stress"}, field_units={"von_mises": "MPa"})
    >>> labels.axis("time"), labels.field("von_mises"), labels.moment(0.5, 2.0)
    ('time [s]', 'von Mises stress [MPa]', 't = 0.50 s')
    """

    title: str = ""
    clock: str = "time"
    units: Mapping[str, str] = field(default_factory=dict)
    columns: Mapping[str, str] = field(default_factory=dict)
    fields: Mapping[str, str] = field(default_factory=dict)
    field_units: Mapping[str, str] = field(default_factory=dict)
    parts: Mapping[str, Sequence[str]] = field(default_factory=dict)
    up: tuple[float, float, float] | None = None

    @classmethod
    def of(cls, noted: Mapping[str, Any]) -> Self:
        """From what was noted; unknown names are left out."""
        known = {f.name for f in fields(cls)}
        return cls(**{name: value for name, value in noted.items() if name in known})

    def noted(self) -> dict[str, Any]:
        """As plain data."""
        return asdict(self)

    def axis(self, quantity: str, name: str = "") -> str:
        """Text for an axis of a quantity; what the times are for ``time``."""
        spoken = self.clock if quantity == "time" else name or quantity.replace("_", " ")
        return with_unit(spoken, self.unit(quantity))

    @property
    def abscissa(self) -> str:
        """Text for the axis of what tables have for a time: of states on a path their load parameters."""
        return "load parameter" if self.clock == "state" else self.axis("time")

    def unit(self, quantity: str) -> str:
        """Unit of a quantity, nothing where it has none or none is known; load parameters are no seconds."""
        return "" if quantity == "time" and self.clock != "time" else self.units.get(quantity, "")

    def column(self, name: str) -> str:
        """A column of a table with its unit."""
        unit = self.unit("time") if name == "time" else self.columns.get(name, "")
        return with_unit(name, unit)

    def field(self, name: str, *, size_of: bool = False) -> str:
        """A field with its unit; of a vector its size."""
        spoken = self.fields.get(name, name.replace("_", " ")) + (" magnitude" if size_of else "")
        return with_unit(spoken, self.field_units.get(name, ""))

    def valued(self, name: str, value: float) -> str:
        """A field with a value of it, to three digits."""
        spoken = self.fields.get(name, name.replace("_", " "))
        return f"{spoken} = {value:.3g} {self.field_units.get(name, '')}".rstrip()

    def is_list(self, name: str) -> bool:
        """Whether the three components of a field are three numbers and no vector."""
        return len(self.parts.get(name, ())) == 3

    def moment(self, time: float, span: float) -> str:
        """A time for a picture, with digits enough to tell moments of a span apart."""
        digits = places(span)
        if self.clock == "time":
            return f"t = {time:.{digits}f} {self.unit('time')}".rstrip()
        return f"{self.clock} {time:.0f}" if self.clock == "state" else f"{self.clock} {time:.{digits}f}"


def with_unit(name: str, unit: str) -> str:
    """A name with a unit behind it, if there is one."""
    return f"{name} [{unit}]" if unit else name


def without_unit(column: str) -> str:
    """The name of a column without its unit.

    Examples
    --------
    >>> without_unit("load_x [mm]"), without_unit("load_x")
    ('load_x', 'load_x')
    """
    return column.rpartition(" [")[0] if column.endswith("]") and " [" in column else column


def places(span: float) -> int:
    """Decimals that tell about a hundred moments of a span apart, at least 2 and at most 12."""
    digits = 2
    while 10.0**-digits * 50 > abs(span) > 0 and digits < 12:
        digits += 1
    return digits
