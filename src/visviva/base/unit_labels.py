"""Units as labels: how quantities are called in plots, tables and pictures. No number is ever multiplied by one."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from visviva.base.errors import InputError, nearest

FORCES = {"N": 1.0, "kN": 1e3, "MN": 1e6, "mN": 1e-3, "uN": 1e-6, "µN": 1e-6, "nN": 1e-9}
LENGTHS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "km": 1e3, "um": 1e-6, "µm": 1e-6, "nm": 1e-9}
MASSES = {"kg": 1.0, "t": 1e3, "g": 1e-3, "mg": 1e-6, "ug": 1e-9, "µg": 1e-9, "ng": 1e-12}
TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9}
STRESSES = {1.0: "Pa", 1e3: "kPa", 1e6: "MPa", 1e9: "GPa"}
ENERGIES = {1.0: "J", 1e-3: "mJ", 1e3: "kJ", 1e6: "MJ", 1e-6: "µJ", 1e-9: "nJ", 1e-12: "pJ"}
POWERS = {1.0: "W", 1e-3: "mW", 1e3: "kW", 1e6: "MW", 1e-6: "µW"}
NAMED = {"SI": "N-m-kg-s"}

DERIVED: dict[str, tuple[str, ...]] = {
    "area": ("length2",),
    "volume": ("length3",),
    "density": ("mass", "/length3"),
    "velocity": ("length", "/time"),
    "acceleration": ("length", "/time2"),
    "momentum": ("mass", "length", "/time"),
    "angular_momentum": ("mass", "length2", "/time"),
    "moment": ("force", "length"),
    "angular_velocity": ("rad", "/time"),
    "rate": ("1", "/time"),
    "flow_rate": ("length3", "/time"),
    "line_force": ("force", "/length"),
    "temperature": ("temperature",),
}
"""Quantities by powers of those that are chosen."""

BASE = ("force", "length", "mass", "time", "temperature")
QUANTITIES = (*BASE, *DERIVED, "stress", "energy", "power", "energy_density", "entropy", "heat_flux", "angle")
POWER = {"2": "²", "3": "³"}


@dataclass(frozen=True)
class Units:
    """Names of units by quantity; labels alone, whatever numbers a model is written in.

    Parameters
    ----------
    names : mapping of str to str
        Given names by quantity, or by the name of a probe.

    Examples
    --------
    >>> units = Units.of("N-mm-t")
    >>> units["stress"], units["energy"], units["time"], units["density"]
    ('MPa', 'mJ', 's', 't/mm³')
    >>> Units.of({"length": "in", "stress": "psi"})["stress"]
    'psi'
    >>> Units.of(None)["energy"]
    ''
    """

    names: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def of(cls, given: Any) -> Units:
        """Units from a text such as 'SI', 'N-mm-t' (force-length-mass, and the time if need be), or names by quantity.

        Raises
        ------
        InputError
            If a name is not known, or the four do not fit each other.
        """
        if given is None:
            return cls()
        if isinstance(given, Units):
            return given
        if isinstance(given, str):
            return cls(consistent(given))
        if not isinstance(given, Mapping) or not all(isinstance(v, str) for v in given.values()):
            raise InputError(f"units: a text such as 'N-mm-t', or names by quantity, not {given!r}")
        return cls({"temperature": "K", **given} if "temperature" in given else dict(given))

    def refuse_unknown(self, others: Any = ()) -> None:
        """Refuse names of quantities that there are not, `others` apart."""
        for name in self.names:
            if name not in QUANTITIES and name not in others:
                known = [*QUANTITIES, *others]
                raise InputError(f"units: there is no quantity or probe {name!r}{nearest(name, known)}")

    def __bool__(self) -> bool:
        return bool(self.names)

    def __getitem__(self, quantity: str) -> str:
        """Name of the unit of a quantity; nothing where it is not known."""
        if quantity in self.names:
            return self.names[quantity]
        if quantity == "angle":
            return "rad" if self.names else ""
        if quantity in DERIVED:
            return self._composed(DERIVED[quantity])
        if quantity == "stress":
            return self._nice(STRESSES, ("force", "/length2"))
        if quantity == "energy":
            return self._nice(ENERGIES, ("force", "length"))
        if quantity == "power":
            return self._nice(POWERS, ("force", "length", "/time"))
        if quantity == "entropy" and self["energy"] and self["temperature"]:
            return f"{self['energy']}/{self['temperature']}"
        if quantity == "heat_flux" and self["power"]:
            return f"{self['power']}/{self['area']}"
        return f"{self['energy']}/{self['volume']}" if quantity == "energy_density" and self["energy"] else ""

    def _composed(self, parts: tuple[str, ...]) -> str:
        over, under = list[str](), list[str]()
        for part in parts:
            plain = part.lstrip("/")
            base, power = (plain[:-1], POWER[plain[-1]]) if plain[-1] in POWER else (plain, "")
            name = base if base in ("rad", "1") else self.names.get(base, "")
            if not name:
                return ""
            (under if part.startswith("/") else over).append(name + power)
        below = " ".join(under)
        return " ".join(over) + (f"/{f'({below})' if len(under) > 1 else below}" if under else "")

    def _nice(self, known: Mapping[float, str], parts: tuple[str, ...]) -> str:
        """The name of a multiple of Pa, J or W, if it is one, else the composed name."""
        composed = self._composed(parts)
        try:
            factor = math.prod(self._factor(part) for part in parts)
        except KeyError:
            return composed
        close = [name for size, name in known.items() if math.isclose(size, factor, rel_tol=1e-6)]
        return close[0] if close else composed

    def _factor(self, part: str) -> float:
        plain = part.lstrip("/")
        base, power = (plain[:-1], int(plain[-1])) if plain[-1] in POWER else (plain, 1)
        table = {"force": FORCES, "length": LENGTHS, "time": TIMES}[base]
        size: float = table[self.names[base]] ** power
        return 1 / size if part.startswith("/") else size


def consistent(text: str) -> dict[str, str]:
    """Names of force, length, mass and time from a text such as 'N-mm-t'; the time follows from the others.

    Raises
    ------
    InputError
        If a name is not known, or force is not mass times length by squared time.
    """
    parts = NAMED.get(text, text).split("-")
    if len(parts) not in (3, 4):
        raise InputError(
            f"units {text!r}: write force-length-mass, such as 'N-mm-t', or 'SI', or names by quantity"
        )
    tables = (("force", FORCES), ("length", LENGTHS), ("mass", MASSES), ("time", TIMES))
    for (what, table), name in zip(tables, parts, strict=False):
        if name not in table:
            raise InputError(f"units {text!r}: {name!r} is no {what}{nearest(name, table)}")
    force, length, mass = (table[name] for (_, table), name in zip(tables, parts[:3], strict=False))
    time = math.sqrt(mass * length / force)
    fitting = [name for name, size in TIMES.items() if math.isclose(size, time, rel_tol=1e-6)]
    if not fitting or (len(parts) == 4 and parts[3] not in fitting):
        raise InputError(
            f"units {text!r}: do not fit each other: force = mass x length / time² asks for a time of {time:.3g} s"
        )
    names = [name.replace("u", "µ") if name[0] == "u" else name for name in (*parts[:3], fitting[0])]
    return dict(zip(BASE, [*names, "K"], strict=True))
