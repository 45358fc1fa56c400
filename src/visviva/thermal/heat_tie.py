"""Heat across surfaces that touch though their meshes do not match."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from functools import cached_property
from itertools import product
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

MOSTLY = 0.5
"""Nodes that see those with multipliers with more than this part of their weight need none themselves."""

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(config=settings, eq=False, kw_only=True)
class HeatTie(Component):
    """Heat that passes between two surfaces which touch, in the reference configuration: solids, bodies, fluids.

    Parameters
    ----------
    first, second : ThermalBody, ThermoelasticSolid, ThermalShell or FluidHeat
        The first surface should be the finer one. Its nodes have the multipliers, unless temperatures are prescribed at
        more of them than of the second one's; where they are prescribed, those of the other one have them.
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
        If the surfaces do not touch, or both have prescribed temperatures all over and no conductance.

    Notes
    -----
    What leaves the one enters the other, exactly. Between solids that deform a multiplier is a flow of entropy at
    the one temperature of both: neither energy nor entropy arises, however the tie moves. A conductance produces the
    entropy ``q (1 / T2 - 1 / T1)``, never a negative one. Bodies are held together by `Tie`. Nodes whose
    temperature is prescribed have no multiplier. Without a conductance temperatures that jump across it
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
            modes = [body.heat_modes(body.faces(chosen)) for body, chosen in sides]
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
        self._given = Bearing((self.first, self.second), skins, modes, self.reach)
        pair = self._given.pair
        if not self._given.tied.any():
            raise InputError(
                f"{self.label}: the surfaces of {self.first.label} and {self.second.label} do not touch: their nearest "
                f"nodes are {pair.distance():.3g} apart, and nothing beyond {pair.reach:.3g} exchanges "
                "heat. Choose the faces that face each other, or give a larger reach"
            )

    def announce(self, model: Model) -> None:
        for body, faces in ((self.first, self.first_faces), (self.second, self.second_faces)):
            model.announce(body, self)
            model.announce(body, Facing(self, faces))
        model.announce(self.first, Conducting((self.first, self.second)))

    def declare(self, model: Model) -> None:
        model.index(self.first), model.index(self.second)
        if self.conductance is not None:
            return
        self._bonds = self._chosen(model)
        ties = [t for body in (self.first, self.second) for t in model.announced(body, HeatTie)]
        for tie in dict.fromkeys(ties):
            if tie is not self and tie.conductance is None:
                self._refuse_shared(tie, tie._chosen(model))
        n = sum(len(bond.chosen) for bond in self._bonds)
        if not n:
            raise InputError(
                f"{self.label}: temperatures are prescribed at all nodes of both surfaces, so that nothing is left to "
                "tie: leave it out, give it a conductance, or prescribe those of one surface"
            )
        self._heat = model.multipliers(self, "heat", n, instantaneous=False)

    def _numbered(self) -> list[tuple[Bond, NDArray[np.int32]]]:
        """Every bond and the numbers of its multipliers."""
        ends = np.cumsum([len(bond.chosen) for bond in self._bonds])
        numbers = np.split(np.asarray(self._heat.unknowns, dtype=np.int32), ends[:-1])
        return list(zip(self._bonds, numbers, strict=True))

    def _chosen(self, model: Model) -> list[Bond]:
        """Which nodes bear the multipliers: those of the other side where temperatures of the one are prescribed.

        Those of both that mostly see each other would be redundant: beside held nodes a part of a cell is left out.
        """
        if not self._given.held(model).any():
            return [Bond(self._given, np.flatnonzero(self._given.tied))]
        sides = [(bearing, bearing.held(model)) for bearing in (self._given, self._given.exchanged)]
        (main, held), (other, its) = sorted(sides, key=lambda s: (s[1].sum(), -s[0].tied.sum()))
        bond = Bond(main, np.flatnonzero(main.tied & ~held))
        seen = abs(other.rows[:, len(other.tied) :])
        bound = seen[:, bond.chosen].sum(axis=1) > MOSTLY * seen.sum(axis=1)
        return [bond, Bond(other, np.flatnonzero(other.tied & ~its & ~bound))]

    def _refuse_shared(self, tie: HeatTie, its: list[Bond]) -> None:
        for own, other in product(self._bonds, its):
            body = own.of.bodies[0]
            shared = np.intersect1d(own.nodes, other.nodes)
            if other.of.bodies[0] is body and len(shared):
                place = ", ".join(f"{c:.4g}" for c in body.points[shared[0]])
                raise InputError(
                    f"{self.label} and {tie.label} both tie node {shared[0]} of {body.label} at ({place}): "
                    "exchange first and second of one of them, or give it a conductance"
                )

    def contribute(self, model: Model) -> None:
        if self.conductance is not None:
            self._exchange(model, self.conductance)
            return
        for bond, numbers in self._numbered():
            if len(numbers):
                self._bond(model, bond, numbers)

    def _bond(self, model: Model, bond: Bond, numbers: NDArray[np.int32]) -> None:
        own = bond.of
        rows = (self.first.thickness * own.rows[bond.chosen]).tocsr()
        n = len(own.nodes[0])
        parts = [padded(rows[:, :n]), padded(rows[:, n:])]
        nodes = [np.where(c >= 0, of[c], -1) for (c, _), of in zip(parts, own.nodes, strict=True)]
        model.term(self, HeatBond(own.bodies, numbers, nodes, own.modes, [w for _, w in parts]))

    def _exchange(self, model: Model, conductance: float) -> None:
        of = self._given
        for nodes, N, size in of.pair.shared_points():
            own = [all_nodes[n] for all_nodes, n in zip(of.nodes, nodes, strict=True)]
            area = self.first.thickness * size
            model.term(self, HeatExchange(of.bodies, own, of.modes, N, area, conductance))

    # --- results -------------------------------------------------------------------------------------------
    def heat(self, x: Array) -> float:
        """Heat per time that passes from the first to the second, in the last step, of ties without conductance.

        Of two solids that deform it is the entropy per time.

        Raises
        ------
        InputError
            If it has a conductance.
        """
        if self.conductance is not None:
            raise InputError(f"{self.label}: heat is that of ties without a conductance")
        passed = 0.0
        for bond, numbers in self._numbered():
            own = bond.of
            rows = self.first.thickness * own.rows[bond.chosen][:, : len(own.nodes[0])]
            leaving = float(np.sum(rows.T @ x[numbers]))
            passed += leaving if own.bodies[0] is self.first else -leaving
        return passed


@dataclasses.dataclass(frozen=True, eq=False)
class Bearing:
    """Two surfaces of a tie, of which the nodes of the first bear the multipliers.

    Attributes
    ----------
    bodies, skins, modes : of both
        What they are of, their faces, and what the temperatures of a node count for there.
    reach : float, optional
    """

    bodies: tuple[HeatCarrier, HeatCarrier]
    skins: Sequence[Any]
    modes: Sequence[Array]
    reach: float | None

    @cached_property
    def pair(self) -> MortarSurfaces:
        """The integrals."""
        first, second = zip(self.bodies, self.skins, strict=True)
        return MortarSurfaces(first, second, self.reach)

    @cached_property
    def nodes(self) -> tuple[Ints, Ints]:
        """Of both surfaces, in their bodies."""
        return self.skins[0].used, self.skins[1].used

    @cached_property
    def tied(self) -> NDArray[np.bool_]:
        """Which nodes of the first one touch the second."""
        tied: NDArray[np.bool_] = self.pair.share > THIN
        return tied

    @cached_property
    def rows(self) -> Any:
        """Constraints of the tied nodes by the temperatures of both surfaces."""
        return with_neighbours(self.pair.standard(), self.pair.first.facets, self.tied, self.pair.share > 0)

    @cached_property
    def exchanged(self) -> Bearing:
        """The same with the multipliers on the other side."""
        return Bearing((self.bodies[1], self.bodies[0]), self.skins[::-1], self.modes[::-1], self.reach)

    def held(self, model: Model) -> NDArray[np.bool_]:
        """Which of the tied nodes have a temperature that is prescribed."""
        held = np.zeros(len(self.tied), dtype=bool)
        for given in model.announced(self.bodies[0], PrescribedTemperature):
            held |= np.isin(self.nodes[0], given.chosen)
        return held & self.tied


@dataclasses.dataclass(frozen=True, eq=False)
class Bond:
    """Nodes of the first surface `of` a bearing, by their places there, that bear multipliers."""

    of: Bearing
    chosen: Ints

    @property
    def nodes(self) -> Ints:
        """In the body."""
        return self.of.nodes[0][self.chosen]


def padded(rows: Any) -> tuple[Ints, Array]:
    """Columns (m, r), -1 behind the last, and values (m, r) of a sparse array."""
    rows = rows.tocsr()
    count = np.diff(rows.indptr)
    columns = np.full((len(count), max(int(count.max(initial=0)), 1)), -1)
    values = np.zeros(columns.shape)
    there = np.arange(columns.shape[1]) < count[:, None]
    columns[there], values[there] = rows.indices, rows.data
    return columns, values
