"""Heat across surfaces that touch though their meshes do not match."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.component.announcements import Conducting, Facing
from visviva.component.component import Component, settings
from visviva.component.momentum import NOWHERE
from visviva.component.values import FaceSet, Number
from visviva.contact.tie_integrals import MortarSurfaces
from visviva.contact.tying import THIN, with_neighbours
from visviva.mesh.cells import CELLS
from visviva.mesh.periodic import refuse_periodic
from visviva.thermal.boundaries import PrescribedTemperature
from visviva.thermal.carrier import HeatCarrier
from visviva.thermal.exchange import HeatBond, HeatExchange

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(config=settings, eq=False, kw_only=True)
class HeatTie(Component):
    """Heat that passes between two surfaces which touch, in the reference configuration: solids, bodies, fluids.

    Parameters
    ----------
    first, second : ThermalBody, ThermoelasticSolid, ThermalShell or FluidHeat
        The first surface should be the finer one.
    first_faces, second_faces : str or Faces
        Which part of the surface; 'all' for the whole boundary. Of a shell the sides 'upper' or 'lower', which are as
        warm as they are themselves, or edges, at the mean through the thickness.
    conductance : float, optional
        Heat per time, area and difference of temperatures. By default temperatures are the same, by a multiplier at
        every node of the first surface, the heat that passes there.
    reach : float
        Surfaces farther apart than this exchange nothing; by default a tenth of the largest facet.

    Raises
    ------
    InputError
        If the surfaces do not touch.

    Notes
    -----
    What leaves the one enters the other, exactly. Between solids that deform a multiplier is a flow of entropy at
    the one temperature of both: neither energy nor entropy arises, however the tie moves. A conductance produces the
    entropy ``q (1 / T2 - 1 / T1)``, never a negative one. Bodies are held together by `Tie`. Nodes of the first
    surface whose temperature is prescribed have no multiplier. Without a conductance temperatures that jump across it
    are evened out as a system is composed, by heat. See :doc:`/theory/heat`.

    Examples
    --------
    >>> import visviva as vv
    >>> left = vv.ThermalBody(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(3, 3, 3)), conductivity=2.0)
    >>> right = vv.ThermalBody(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2), origin=(1, 0, 0)), conductivity=2.0)
    >>> tie = vv.HeatTie(first=left, first_faces="x1", second=right, second_faces="x0", conductance=1.0)
    >>> hot = vv.PrescribedTemperature(body=left, nodes="x0", value=20.0)
    >>> cold = vv.PrescribedTemperature(body=right, nodes="x1", value=0.0)
    >>> system = vv.System([left, right, tie, hot, cold])
    >>> _ = vv.quasi_static(system, until=1.0, step=1.0)
    >>> float(vv.TemperatureAt(body=left, at=(1, 0.4, 0.3))(system).round(9))
    15.0
    """

    outside_axes = NOWHERE

    first: HeatCarrier
    second: HeatCarrier
    first_faces: FaceSet = "all"
    second_faces: FaceSet = "all"
    conductance: Number | None = None
    reach: Number | None = None

    def __post_init__(self) -> None:
        if self.first is self.second:
            raise InputError(
                f"{self.label}: first and second are the same {self.first.label}; give two bodies"
            )
        if self.conductance is not None and not self.conductance > 0:
            raise InputError(f"{self.label}: conductance = {self.conductance:g} is not positive")
        if self.reach is not None and not self.reach > 0:
            raise InputError(f"{self.label}: reach = {self.reach:g} is not positive")
        for what in ("dimension", "axisymmetric", "thickness"):
            if getattr(self.first, what) != getattr(self.second, what):
                raise InputError(f"{self.label}: {self.first.label} and {self.second.label} differ in {what}")
        sides = ((self.first, self.first_faces), (self.second, self.second_faces))
        try:
            for body, chosen in sides:
                refuse_periodic("its surfaces", body, body.periodic, body.faces(chosen))
            skins = [body.heat_skin(chosen) for body, chosen in sides]
            self._modes = [body.heat_modes(body.faces(chosen)) for body, chosen in sides]
        except InputError as error:
            raise InputError(f"{self.label}: {error}") from None
        edges = any(
            CELLS[kind].dimension < self.first.dimension - 1 for skin in skins for kind in skin.faces.cells
        )
        if edges and self.conductance is not None:
            raise InputError(
                f"{self.label}: edges of {self.first.label} have no area that a conductance could be of; leave it out, "
                "which ties temperatures, or give vv.HeatExchange the conductance of the whole edge"
            )
        self._nodes = skins[0].used, skins[1].used
        self._pair = MortarSurfaces((self.first, skins[0]), (self.second, skins[1]), self.reach)
        share = self._pair.share
        self._tied = share > THIN
        if not self._tied.any():
            raise InputError(
                f"{self.label}: the surfaces of {self.first.label} and {self.second.label} do not touch: their nearest "
                f"nodes are {self._pair.distance():.3g} apart, and nothing beyond {self._pair.reach:.3g} exchanges "
                "heat. Choose the faces that face each other, or give a larger reach"
            )
        self._rows = with_neighbours(self._pair.standard(), self._pair.first.facets, self._tied, share > 0)

    def announce(self, model: Model) -> None:
        for body, faces in ((self.first, self.first_faces), (self.second, self.second_faces)):
            model.announce(body, self)
            model.announce(body, Facing(self, faces))
        model.announce(self.first, Conducting((self.first, self.second)))

    def declare(self, model: Model) -> None:
        model.index(self.first), model.index(self.second)
        if self.conductance is not None:
            return
        held = np.zeros(len(self._tied), dtype=bool)
        for given in model.announced(self.first, PrescribedTemperature):
            held |= np.isin(self._nodes[0], given.chosen)
        for tie in model.announced(self.first, HeatTie):
            if tie is not self and tie.first is self.first and tie.conductance is None:
                self._refuse_shared(tie)
        self._bonds = np.flatnonzero(self._tied & ~held)
        self._heat = model.multipliers(self, "heat", len(self._bonds), instantaneous=False)

    def _refuse_shared(self, tie: HeatTie) -> None:
        shared = np.intersect1d(self._nodes[0][self._tied], tie._nodes[0][tie._tied])
        if len(shared):
            place = ", ".join(f"{c:.4g}" for c in self.first.points[shared[0]])
            raise InputError(
                f"{self.label} and {tie.label} both tie node {shared[0]} of {self.first.label} at ({place}): exchange "
                "first and second of one of them, or give it a conductance"
            )

    def contribute(self, model: Model) -> None:
        if self.conductance is not None:
            self._exchange(model, self.conductance)
        elif len(self._bonds):
            self._bond(model)

    def _bond(self, model: Model) -> None:
        rows = (self.first.thickness * self._rows[self._bonds]).tocsr()
        n = len(self._nodes[0])
        parts = [padded(rows[:, :n]), padded(rows[:, n:])]
        nodes = [np.where(c >= 0, of[c], -1) for (c, _), of in zip(parts, self._nodes, strict=True)]
        numbers = np.asarray(self._heat.unknowns, dtype=np.int32)
        model.term(
            self, HeatBond((self.first, self.second), numbers, nodes, self._modes, [w for _, w in parts])
        )

    def _exchange(self, model: Model, conductance: float) -> None:
        for nodes, N, size in self._pair.shared_points():
            own = [of[n] for of, n in zip(self._nodes, nodes, strict=True)]
            area = self.first.thickness * size
            model.term(self, HeatExchange((self.first, self.second), own, self._modes, N, area, conductance))

    # --- results -------------------------------------------------------------------------------------------
    def heat(self, x: Array) -> float:
        """Heat per time that passes from the first to the second, in the last step, of ties without conductance.

        Of two solids that deform it is the entropy per time.
        """
        own = self.first.thickness * self._rows[self._bonds][:, : len(self._nodes[0])]
        return float(np.sum(own.T @ x[self._heat.unknowns]))


def padded(rows: Any) -> tuple[Ints, Array]:
    """Columns (m, r), -1 behind the last, and values (m, r) of a sparse array."""
    rows = rows.tocsr()
    count = np.diff(rows.indptr)
    columns = np.full((len(count), max(int(count.max(initial=0)), 1)), -1)
    values = np.zeros(columns.shape)
    there = np.arange(columns.shape[1]) < count[:, None]
    columns[there], values[there] = rows.indices, rows.data
    return columns, values
