"""Solids on patches of splines: the unknowns are the places of control points."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva import _core
from visviva.base.errors import InputError
from visviva.body.on_splines import OnSplines
from visviva.body.solid_term import Elements, own_energy
from visviva.body.space import Table
from visviva.component.announcements import Repeating
from visviva.component.component import settings
from visviva.component.values import Pairs
from visviva.mesh.spline import SplineSource
from visviva.model.callback import callback_of

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(config=settings, eq=False, kw_only=True)
class SplineSolid(OnSplines):
    """A solid on splines, whose stresses are as smooth as they are.

    Takes the arguments of `Solid` with ``formulation="displacement"``, in space or in a plane, and

    Parameters
    ----------
    mesh : SplineBox, SplinePatch or SplinePatches
    periodic : sequence of (str, str)
        Opposite sides of a `SplineBox` that `PeriodicFaces` of the same pairs, which is needed besides, joins with all
        derivatives that splines have; without this, places alone. Nodes there cannot be held: a joint at a point can.

    Notes
    -----
    Nodes and faces, which sets name and pictures show, are those of a fine mesh of plain cells (`grid`); they move
    with the control points, which are the unknowns. Supports hold the control points that nodes depend on: whole sides
    and their corners can be held. What acts on every node by a multiplier is refused: rigid couplings, contact and ties
    where it comes first (take penalties, or the other body as first), oblique planes. Loads are integrated over the
    knot spans of the patches themselves. Fields at nodes are the best splines through the values at quadrature points,
    by least squares.

    Examples
    --------
    >>> import visviva as vv
    >>> block = vv.SplineSolid(
    ...     mesh=vv.SplineBox(size=(2, 1), counts=(4, 2), degree=3), material=vv.NeoHooke(young=1e3, poisson=0.3)
    ... )
    >>> vv.System([block, vv.Fixed(solid=block, nodes="x0")]).n_coordinates
    60
    """

    mesh: SplineSource
    periodic: Pairs = ()

    @property
    def _smooth_pairs(self) -> Pairs:
        return self.periodic

    def declare(self, model: Model) -> None:
        super().declare(model)
        joined = [set(pair) for sides in model.announced(self, Repeating) for pair in sides.pairs]
        for pair in self.periodic:
            if set(pair) not in joined:
                raise InputError(
                    f"{self.label}: periodic = {pair} joins nothing by itself: add vv.PeriodicFaces(solid=..., "
                    "pairs=...) of this pair, or leave it out"
                )

    def contribute(self, model: Model) -> None:
        self._starts_stress = self.tangent == "start"
        self._energy = own_energy(
            self.label, self.material, self.formulation, in_plane=True, across_free=self.plane == "stress"
        )
        self._callback = callback_of(self._energy) if self._energy else None
        self._elements, first = [], 0
        for table in self._tables:
            self._elements.append(self._made(model, table, first))
            model.batch(self._elements[-1].term)
            first += len(table.numbers)

    def _made(self, model: Model, table: Table, first: int) -> Elements:
        n, (cell,) = len(table.numbers), self.grid.cells
        term = _core.SolidTerm(
            int(self.material.kind),
            self.material.small,
            self.carriers.unknowns(table.numbers),
            np.ascontiguousarray(table.gradients[..., : self.dimension]),
            table.size,
            self.material.parameters(n),
            None,
            self._packed_masses(table) if self.density > 0 else None,
            self._damping(n),
        )
        term.name = self.label
        thermal = self._free_strains_at(table.X) if self._is_heated else None
        self._complete(term, cell, table.numbers, thermal)
        numbers = first + np.arange(n)
        term.book_solid(*self._open_accounts(model), model.index(self), numbers.astype(np.int32))
        return Elements(
            cell=cell, nodes=table.numbers, numbers=numbers, thermal=thermal, term=term, volume=table.size
        )
