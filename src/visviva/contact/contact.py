"""Unilateral contact of two surfaces."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva import _core
from visviva.body.solid import Solid
from visviva.component import Attachable, Component, settings
from visviva.contact.surface import skin, surface_of
from visviva.errors import InputError
from visviva.mesh.faces import Faces
from visviva.values import Number

if TYPE_CHECKING:
    from visviva.model import Model

Array = NDArray[np.float64]


@dataclass(config=settings, eq=False, kw_only=True)
class Contact(Component):
    """Two surfaces that may touch but not penetrate.

    Parameters
    ----------
    first, second : Solid, RigidBody or Ground with a shape
        What touches. Gaps belong to the vertices of the first surface, which should be the finer one.
    first_faces, second_faces : str or Faces
        Which part of the surface, by the name of a set of faces; 'all' for the whole boundary.
    formulation : {'mortar', 'node-to-segment'}
        'mortar': the gap is averaged over the segments that facets of both surfaces have in common.
        'node-to-segment': the distance of vertices of the first surface to the closest points of the second one's
        facets, edges and vertices; simpler and quicker, but constant pressure is not transferred exactly.
    enforcement : {'multipliers', 'penalty'}
        'multipliers': gaps are not negative, pressures are unknowns, with an active set. 'penalty': pressures are
        `stiffness` times penetration, a potential.
    stiffness : float
        Pressure per penetration; of the penalty, or of the augmentation of multipliers, where it changes no result.
        By default that of a layer of elements, ten times that for a penalty.
    impact : {'dissipative', 'conserving'}
        With multipliers in dynamics: 'dissipative' closes gaps exactly, which takes the energy of impact of the
        surface's nodes; 'conserving' lets a gap close freely within the step in which it does and only then holds
        it, so that energy is exact.
    reach : float
        Facets farther apart than this are no candidates; by default the size of the largest facet.

    Notes
    -----
    Linear and angular momentum are exact with every scheme; with `EnergyMomentum` the work of contact is that of the
    change of the gaps: nothing while contact persists, never a gain. See :doc:`/theory/contact`.

    Examples
    --------
    A block that falls onto another one and bounces off:

    >>> import visviva as vv
    >>> rubber = vv.NeoHooke(young=100.0, poisson=0.3)
    >>> lower = vv.Solid(mesh=vv.BoxMesh(size=(2, 2, 1), counts=(2, 2, 1)), material=rubber, density=1.0)
    >>> mesh = vv.BoxMesh(size=(1, 1, 1), counts=(3, 3, 1)).build().moved((0.5, 0.5, 1.02))
    >>> upper = vv.Solid(mesh=mesh, material=rubber, density=1.0, velocity=(0, 0, -1))
    >>> contact = vv.Contact(first=upper, first_faces="z0", second=lower, second_faces="z1", impact="conserving")
    >>> result = vv.simulate(vv.System([lower, upper, contact]), until=0.2, step=0.01)
    >>> result.assert_conserved("energy", "momentum_z", "angular_x", tolerance=1e-9)
    """

    first: Attachable
    second: Attachable
    first_faces: str | Faces = "all"
    second_faces: str | Faces = "all"
    formulation: Literal["mortar", "node-to-segment"] = "mortar"
    enforcement: Literal["multipliers", "penalty"] = "multipliers"
    stiffness: Number | None = None
    impact: Literal["dissipative", "conserving"] = "dissipative"
    reach: Number | None = None

    def __post_init__(self) -> None:
        for name in ("stiffness", "reach"):
            value = getattr(self, name)
            if value is not None and not value > 0:
                raise InputError(f"{self.label}: {name} = {value:g} is not positive")

    def declare(self, model: Model) -> None:
        model.index(self.first), model.index(self.second)
        self._surface = surface_of(self.first, self.first_faces, self.label)
        self._opposite = surface_of(self.second, self.second_faces, self.label)
        if self._surface.dimension != self._opposite.dimension:
            raise InputError(f"{self.label}: {self.first.label} and {self.second.label} differ in dimension")
        n = len(self._surface.forms)
        if self.enforcement == "multipliers":
            self.pressure = model.field(self, "pressure", np.zeros(n), order=0, stage=1, definite=False)

    def contribute(self, model: Model) -> None:
        multipliers = self.enforcement == "multipliers"
        unknowns = np.array(self.pressure.unknowns if multipliers else [], dtype=np.int32)
        reach = self.reach or max(self._surface.size, self._opposite.size)
        stiffness = (self.stiffness or self._default_stiffness(reach)) / self._surface.areas
        conserving = self.impact == "conserving"
        gaps = self._gaps(reach)
        self.term = _core.ContactTerm(gaps, reach, unknowns, stiffness, conserving)
        self.term.name = self.label
        work = model.account(self, "contact", "dissipation")
        energy = -1 if multipliers else model.account(self, "contact", "potential")
        self.term.book_contact(work, energy)
        model.batch(self.term)

    def _gaps(self, reach: float) -> _core.Gaps:
        pair = skin(self._surface, self._opposite)
        if self.formulation == "mortar":
            return _core.mortar(pair, reach)
        return _core.node_to_segment(pair, self._surface.areas, 0.0, reach)

    def _default_stiffness(self, size: float) -> float:
        moduli = []
        for body in (self.first, self.second):
            if isinstance(body, Solid):
                lam, mu = body.material.lame
                moduli.append(3 * mu if not np.isfinite(lam) else mu * (3 * lam + 2 * mu) / (lam + mu))
        if not moduli:
            raise InputError(
                f"{self.label}: between rigid bodies nothing says how stiff contact should be; give its stiffness"
            )
        return min(moduli) / size * (1.0 if self.enforcement == "multipliers" else 10.0)

    # --- results -------------------------------------------------------------------------------------------
    @property
    def pressures(self) -> Array:
        """Pressures (n,) at the vertices of the first surface in the last step."""
        values: Array = self.term.pressures
        return values

    @property
    def gaps(self) -> Array:
        """Mean gaps (n,) near the vertices of the first surface at the end of the last step; nan where none."""
        areas = self.term.areas
        gaps: Array = np.where(areas > 0, self.term.gaps / np.where(areas > 0, areas, 1.0), np.nan)
        return gaps
