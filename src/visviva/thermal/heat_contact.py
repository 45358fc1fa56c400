"""Heat across surfaces in contact, and heat of friction."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva import _core
from visviva.base.errors import InputError, RunError, named
from visviva.component.announcements import Conducting
from visviva.component.component import Component, settings
from visviva.component.momentum import NOWHERE
from visviva.component.values import Curve, Number
from visviva.contact.contact import Contact
from visviva.model.entropies import PRODUCED, SUPPLIED
from visviva.thermal.carrier import HeatCarrier

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]
SLOPE_STEP = 1e-6
"""By which slopes of conductances are found, of the highest pressure."""


@dataclass(config=settings, eq=False, kw_only=True)
class HeatContact(Component):
    """Heat that passes between two surfaces where they are in contact, and heat of their friction.

    Parameters
    ----------
    contact : Contact
        Of solids that carry heat, by mortar or, if it rubs, by vertices.
    conductance : float, table, or function, optional
        Heat per time, area and difference of temperatures of surfaces that touch: a number, rows of pressures that grow
        and conductances, or a function of pressures (n,) with values (n,). Where the surfaces are apart nothing passes.
    share : float, optional
        Of the heat of friction, between 0 and 1, that the first surface of the contact takes; the second takes the
        rest. Where not given: half, and all of it in the body with temperatures where the other has none. What a given
        share brings to a body without temperatures is lost.

    Notes
    -----
    What leaves the one enters the other: energy is exact, and the entropy produced, ``q (1 / T2 - 1 / T1)``, is never
    negative, with the mean temperatures of both sides at every vertex of the first. All that friction takes, by the
    ledger's column of it, becomes heat, booked as heat of "friction". See :doc:`/theory/heat`.

    A conductance that is there as soon as surfaces touch leaves no state where the heat that passes parts them, as of a
    hot body that shrinks when it cools: touching they part, apart they touch (Barber 1978). One that grows from zero
    with the pressure has a state always.

    Examples
    --------
    >>> import visviva as vv
    >>> steel = vv.Heat(conductivity=1.0, capacity=1.0)
    >>> common = {"material": vv.NeoHooke(young=1e3, poisson=0.3), "heat": steel, "density": 1.0}
    >>> lower = vv.ThermoelasticSolid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 1)), **common)
    >>> mesh = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1), origin=(0, 0, 1))
    >>> upper = vv.ThermoelasticSolid(mesh=mesh, temperature=400.0, **common)
    >>> contact = vv.Contact(first=lower, first_faces="z1", second=upper, second_faces="z0")
    >>> heat = vv.HeatContact(contact=contact, conductance=[(0, 0), (10, 5)])
    >>> system = vv.System([lower, upper, contact, heat])
    """

    outside_axes = NOWHERE

    contact: Contact
    conductance: Curve | None = None
    share: Number | None = None

    contributes_last = True

    def __post_init__(self) -> None:
        if self.share is not None and not 0 <= self.share <= 1:
            raise InputError(f"{self.label}: share = {self.share:g} is not between 0 and 1")
        first, second = self.contact.first, self.contact.second
        carriers = [isinstance(body, HeatCarrier) for body in (first, second)]
        labels = " and ".join(body.label for body in (first, second) if body is not None)
        if not any(carriers) or second is None:
            raise InputError(
                f"{self.label}: {self.contact.label} is between {labels}, "
                + ("which carries no heat" if second is None else "of which none carries heat")
                + "; make solids there vv.ThermoelasticSolid"
            )
        if not all(carriers) and self._share_of_first(carriers) == (0 if carriers[0] else 1):
            raise InputError(
                f"{self.label}: share = {self.share:g} brings all heat of friction to "
                f"{(second if carriers[0] else first).label}, which has no temperatures; leave it out"
            )
        thin = [body.label for body in (first, second) if isinstance(body, HeatCarrier) and body.is_thin]
        if thin:
            raise InputError(
                f"{self.label}: contact brings no heat into {' and '.join(thin)}, whose temperatures are those of a "
                "middle; make it of vv.ThermoelasticSolid, or tie it by vv.HeatTie"
            )
        if self.conductance is None and self.contact.friction == 0:
            raise InputError(
                f"{self.label}: {self.contact.label} has no friction, so that nothing passes without a conductance"
            )
        if self.conductance is None:
            return
        if not all(carriers):
            raise InputError(f"{self.label}: {labels} do not both carry heat, so that none can be conducted")
        if not self.contact.is_mortar and self.contact.friction == 0:
            raise InputError(
                f"{self.label}: {self.contact.label} by vertices conducts where it rubs alone; give it "
                "formulation='mortar', or friction"
            )
        if len(thick := {body.thickness for body in (first, second) if isinstance(body, HeatCarrier)}) > 1:
            raise InputError(f"{self.label}: {labels} differ in thickness")
        self._thickness = float(*thick)
        least = np.min(self._values(np.linspace(0.0, 1.0, 5)))
        if isinstance(self.conductance, np.ndarray):
            least = self.conductance[:, 1].min()
        if least < 0 or (isinstance(self.conductance, float) and least == 0):
            raise InputError(f"{self.label}: a conductance of {least:g} is not positive")

    def _share_of_first(self, carries: list[bool]) -> float:
        """Share of the first surface, of bodies that carry heat or not."""
        if self.share is not None:
            return self.share
        return 0.5 if all(carries) else float(carries[0])

    def _values(self, pressure: Array) -> Array:
        """Conductances (n,) of pressures (n,)."""
        given = self.conductance
        if isinstance(given, np.ndarray):
            return np.asarray(np.interp(pressure, given[:, 0], given[:, 1]))
        with named(f"{self.label}: its conductance"):
            found = np.asarray(given(pressure) if callable(given) else given, dtype=float)
        if found.shape not in ((), pressure.shape) or not np.isfinite(found).all():
            raise RunError(
                f"{self.label}: its conductance has shape {found.shape} for {len(pressure)} pressures, or is not finite"
            )
        return np.broadcast_to(found, pressure.shape)

    def _conduct(self, pressure: Array, values: Array, slopes: Array) -> None:
        """Write conductances and their slopes for the core, whose areas of plane bodies are lengths."""
        pressure = pressure / self._thickness
        values[:] = self._thickness * self._values(pressure)
        d = SLOPE_STEP * np.max(pressure, initial=0.0)
        if d > 0 and not isinstance(self.conductance, float):
            above, below = pressure + d, np.maximum(pressure - d, 0.0)
            slopes[:] = (self._values(above) - self._values(below)) / (above - below)

    # --- part in the system --------------------------------------------------------------------------------
    def announce(self, model: Model) -> None:
        first, second = self.contact.first, self.contact.second
        if self.conductance is not None and second is not None:
            model.announce(first, Conducting((first, second)))
        model.announce(self.contact, self)

    def declare(self, model: Model) -> None:
        model.index(self.contact)
        if len(model.announced(self.contact, HeatContact)) > 1:
            raise InputError(f"{self.label}: {self.contact.label} has another vv.HeatContact already")

    def contribute(self, model: Model) -> None:
        bodies = (self.contact.first, self.contact.second)
        balance: list[Array] = []
        temperature: list[Array] = []
        for body, forms in zip(bodies, self.contact.forms, strict=True):
            unknowns = np.array([u for form in forms for u, _ in form], dtype=np.int64)
            for found, numbers in zip((balance, temperature), warmth_of(body, unknowns), strict=True):
                found.append(numbers)
        carries = [isinstance(body, HeatCarrier) for body in bodies]
        entropy = [isinstance(body, HeatCarrier) and body.balances_entropy for body in bodies]
        self.term = _core.ContactHeat(
            self.contact.term,
            np.concatenate(balance).astype(np.int32),
            np.concatenate(temperature).astype(np.int32),
            np.array(carries, dtype=np.int32),
            np.array(entropy, dtype=np.int32),
            self._share_of_first(carries),
        )
        self.term.name = self.label
        if self.conductance is not None:
            self._function = self._conduct  # which the core calls, and does not keep alive
            self.term.set_conductance(self._function)
        self.term.book_heat(model.account(self, "friction", "heat"))
        if any(entropy):
            inner = all(e or not c for e, c in zip(entropy, carries, strict=True))
            self.term.entropy_account = model.account(self, "contact", PRODUCED if inner else SUPPLIED)
        model.batch(self.term)

    def trouble(self, x: Array) -> str:
        parting = self.conductance is not None and self.contact.trouble(x)
        if not parting or self._values(np.zeros(1))[0] == 0:
            return ""
        return (
            f"{self.label} conducts as soon as surfaces touch: if the heat that passes parts them, there is no state; "
            "let its conductance grow from zero with the pressure, as [(0, 0), (p, h)]"
        )

    # --- results -------------------------------------------------------------------------------------------
    @property
    def heat(self) -> Array:
        """Heat (n,) per time into the first surface at its vertices in the last step, that of friction included."""
        heat: Array = np.array(self.term.conducted).reshape(-1, len(self.contact.places)).sum(axis=0)
        return heat


def warmth_of(body: Any, unknowns: NDArray[np.int64]) -> tuple[Array, Array]:
    """Unknowns (n,) of balance and temperature of the nodes whose positions begin at these; -1 without heat."""
    if not isinstance(body, HeatCarrier):
        none = np.full(len(unknowns), -1)
        return none, none
    nodes = np.arange(body.grid.n_nodes)
    of: Any = body
    first = np.asarray(of.node_unknowns(nodes))
    order = np.argsort(first)
    node = order[np.searchsorted(first[order], unknowns)]
    return np.asarray(body.balance_unknowns(node)), np.asarray(body.temperature_unknowns(node))
