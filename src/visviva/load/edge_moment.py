"""Moments along the edges of shells."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.base.timefunction import OfTime
from visviva.body.shell import Shell
from visviva.component.component import Component, settings
from visviva.component.momentum import ABOUT_ANY, Axes
from visviva.component.values import Vector3
from visviva.mesh.faces import Faces
from visviva.model.form import Vector
from visviva.model.law import Law, LawKind

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]
ROUNDING = 1e-6
"""Of a moment: a smaller part along directors is what coordinates in files are rounded by."""


@dataclass(config=settings, eq=False, kw_only=True)
class EdgeMoment(Component):
    """Moment per reference length of edges of a shell, about an axis fixed in space.

    Parameters
    ----------
    shell : Shell
    edges : str or Faces
        Name of a set of edges, 'all' for the whole border, or as given.
    moment : (3,)
        Across the directors of the reference: nothing of a shell resists what is along them.
    times : number, expression, table or callable
        Factor as a function of time, see `TimeFunction`.

    Notes
    -----
    It acts on the directors of the cells that the edges belong to, by forces ``moment x d / (d . d)``: angular
    momentum changes by what of the moment is across the directors, also where they stretch. Where they have turned
    towards the axis, the part along them does nothing. Such a moment has no potential; its work is booked as
    "edge moment". While it is across all directors its tangent is symmetric, so that statics tell what is unstable.

    Examples
    --------
    >>> import visviva as vv
    >>> sheet = vv.HomogeneousSection(thickness=0.1, young=1.2e6)
    >>> shell = vv.Shell(mesh=vv.RectangleMesh(size=(12, 1), counts=(16, 1)), section=sheet)
    >>> bend = EdgeMoment(shell=shell, edges="x1", moment=(0, -1e-3, 0))
    >>> system = vv.System([shell, vv.Clamped(solid=shell, nodes="x0"), bend])
    >>> _ = vv.quasi_static(system, until=1.0, step=1.0)
    >>> round(float(shell.displacements(system.x)[shell.nodes("x1"), 2].mean() / (1e-3 * 12**2 / 200)), 3)
    1.0
    """

    shell: Shell
    edges: str | Faces
    moment: Vector3
    times: OfTime | None = None

    @property
    def outside_axes(self) -> Axes:
        return ABOUT_ANY

    def __post_init__(self) -> None:
        faces = self.shell.faces(self.edges)
        points = list(self.shell.face_points(faces))
        if any(p.dN.shape[2] != 1 for p in points):
            raise InputError(f"{self.label}: {self.edges!r} are no edges but sides; give edges of the shell")
        if not np.any(self.moment):
            raise InputError(f"{self.label}: moment is zero")
        directors = self.shell.every_director
        share = np.zeros(len(directors))
        for p, kind in zip(points, faces.cells, strict=True):
            turns = self.shell.turns_of_edges(p.nodes, faces.owners[kind])
            if np.any(turns < 0):
                edge = p.nodes[np.argmax(np.any(turns < 0, axis=1))].tolist()
                raise InputError(
                    f"{self.label}: the edge {edge} is not of the cell that owns it; give its owner"
                )
            np.add.at(share, turns, p.size @ p.N)
        self._turns = np.flatnonzero(share)
        self._share = share[self._turns]
        self._refuse_along(directors[self._turns] @ self.moment)

    def _refuse_along(self, along: Array) -> None:
        """Refuse parts (k,) of the moment along its directors."""
        worst = int(np.argmax(np.abs(along)))
        if abs(along[worst]) <= ROUNDING * np.linalg.norm(self.moment):
            return
        at = self.shell.node_of_turn(int(self._turns[worst]))
        raise InputError(
            f"{self.label}: moment = {self.moment.tolist()} has a part {along[worst]:.3g} along the director at node "
            f"{at}, which nothing of {self.shell.label} resists; leave that part out, or spread it over a patch by "
            "vv.DistributedCoupling"
        )

    def contribute(self, model: Model) -> None:
        model.index(self.shell)
        first = self.shell.turn_unknowns(self._turns).tolist()
        for u, share in zip(first, self._share.tolist(), strict=True):
            moment = Vector.constant(share * self.moment)
            model.act(self, "edge moment", [*Vector.of(u), *moment], Law(LawKind.COUPLE), self.times)
