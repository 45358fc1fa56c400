"""Unilateral contact of two surfaces."""

from __future__ import annotations

from itertools import takewhile
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva import _core
from visviva.base.errors import InputError
from visviva.component.announcements import Facing
from visviva.component.component import Component, settings
from visviva.component.momentum import NOWHERE
from visviva.component.point import Attachable
from visviva.component.values import Number
from visviva.contact.bars import is_bar
from visviva.contact.contact_check import (
    DEEP,
    check_bars,
    check_multipliers,
    check_numbers,
    check_restitution,
    check_schemes,
    check_second,
    check_sides,
    check_stiffness,
    refuse_overlap,
)
from visviva.contact.contact_fields import record
from visviva.contact.contact_layer import Layer
from visviva.contact.contact_pair import FRAME, GapFunctions, Pair
from visviva.contact.contact_remarks import conducted, remarks_of
from visviva.contact.contact_surface import Surface, mesh_bodies, positions
from visviva.contact.contact_trouble import unsettled, without_tangent
from visviva.contact.doubles import refuse_doubles
from visviva.contact.edges import cover, edges_of, lie_beside
from visviva.contact.narrow import refuse_narrow
from visviva.contact.resolve import resolve, side_of
from visviva.contact.sinking import watch
from visviva.contact.unseen import refuse_hidden, refuse_unseen
from visviva.mesh.faces import Faces
from visviva.model.field import Role

if TYPE_CHECKING:
    from visviva.model.model import Model
    from visviva.model.state import State
    from visviva.scheme.schemes import Scheme

Array = NDArray[np.float64]


@dataclass(config=settings, eq=False, kw_only=True)
class Contact(Component):
    """Two surfaces that may touch but not penetrate.

    Parameters
    ----------
    first : Solid, Shell, Beam, RigidBody or PointMass
        Gaps belong to the vertices of this surface, which should be the finer one: facets of a rigid body that are
        larger than all of `second` are refused.
    second : Solid, Shell, Beam, RigidBody, Plane or Obstacle, optional
        What it touches; if left out the first surface touches itself, by vertices, with a penalty or, in statics,
        multipliers.
    first_faces, second_faces : str or Faces
        Which part of the surface, by the name of a set of faces, of rigid bodies of a face of their shape, of shells
        'upper' or 'lower', or an edge for the rim there, of a `PlaneBeam` 'left', 'right' or 'ends'; 'all' for the
        whole boundary, of shells both sides and rim.
    formulation : {'mortar', 'node-to-segment'}, optional
        By default 'node-to-segment' where `first` is a ball or a point, for which it is exact, where it touches itself,
        and between rigid bodies, of which the check says it, else 'mortar'.
        'mortar': the gap is averaged over the segments that facets of both surfaces have in common.
        'node-to-segment': the distance of vertices of the first surface to the closest points of the second one's
        facets, edges and vertices; simpler and quicker, but constant pressure is not transferred exactly. Then rigid
        shapes are exact: balls touch by their centre, capsules by the centres of their ends, others by vertices; balls,
        capsules, cylinders and boxes are touched where they are. Planes and obstacles are always touched like this.
        As `first`, cylinders and cones are the vertices of polygons of 32 corners: see the notes.
    enforcement : {'multipliers', 'penalty'}
        'multipliers': gaps are not negative, pressures are unknowns, with an active set. 'penalty': pressures are
        `stiffness` times penetration, a potential.
    multipliers : {'standard', 'dual'}
        Of mortar contact: 'standard' ones have the shape functions of the first surface; 'dual' ones see each its own
        vertex alone where surfaces meet. Without friction.
    condensed : bool
        Multipliers leave the equations before these are solved, each by the momentum of its own node, and its gap takes
        the place of the momentum along the normal. They stay unknowns, and nothing else changes. The first surface
        must be that of a solid, mortar multipliers dual ones, and there is no friction.
    stiffness : float
        Pressure per penetration; of the penalty, or of the augmentation of multipliers, where it changes no result.
        By default that of a layer of elements, ten times that for a penalty. Force instead of pressure at the points
        of rigid bodies, by default that of a facet of the layer. Between rigid bodies alone there is no such layer, and
        it has to be given, with multipliers too, where it serves statics alone: about the weight over the penetration
        that one would call none.
        Areas of plane solids are lengths of their edges, whatever their thickness: pressures, also those of
        `pressures` and probes, are forces per length.
    damping : float
        With a penalty in dynamics: pressure per rate of penetration. Impacts then lose energy at a rate that is chosen,
        booked as work of contact: of a body of mass m on a spring k alone, the share of velocity that is left follows
        from damping / 2 sqrt(k m). Needs the scheme `EnergyMomentum`.
    impact : {'dissipative', 'conserving'}
        With multipliers in dynamics. Of solids: 'dissipative' closes gaps exactly, which takes the energy of impact of
        the surface's nodes, less with finer meshes; 'conserving' lets a gap close freely within the step in which it
        does and only then holds it, so that energy is exact. Of rigid bodies and points: 'dissipative' is restitution
        0, 'conserving' 1.
    restitution : float
        Of a rigid body or point as `first`, with multipliers in dynamics: the share, 0 to 1, of the normal velocity
        that an impact leaves, by default as `impact` says. What it takes is booked as work of contact. Gaps close
        freely within the step in which they do, so that bodies may overlap by one and a half step's approach.
    friction : float
        Coulomb's coefficient: tractions are at most this times the pressure. Balls roll on what they rub.
    tangential : {'multipliers', 'penalty'}
        Below Coulomb's limit, 'multipliers': nothing slips, tractions are unknowns; 'penalty': tractions are
        `tangential_stiffness` times an elastic slip, which is kept from step to step; its vibrations are damped, and
        what sticks is of first order in the step, but for `GeneralizedAlpha` and `BDF2`.
    tangential_stiffness : float
        Traction per slip; of the penalty, or of the augmentation of multipliers, where it changes no result. By
        default that of a layer of elements, ten times that for a penalty.
    initial : {'touch', 'press', 'resolve'}
        'touch': surfaces that overlap at the start are refused; whatever is given, so are those that lie deeper in the
        other body than contact sees, by `reach` or half of the thicknesses. 'press': the overlap of a press fit, which
        contact pushes out; in dynamics that adds energy, in the ledger's share of contact; rigid bodies are pushed out
        in the first step, with the velocity that this takes, beside what impacts leave; of curved surfaces the overlap
        is that of the flat facets between nodes, so that pressures scatter where unlike meshes sag by as much as they
        overlap (refine, or let the meshes match). 'resolve': nodes of solids are moved
        apart, by the smallest move weighted by mass, and are free of stress in their new places; `moved` says how far.
    reach : float
        Facets farther apart than this are no candidates; by default the size of the largest facet. Whatever it is,
        facets do not see each other through their own bodies.

    Notes
    -----
    Linear and angular momentum are exact with every scheme; with `EnergyMomentum` the work of contact is that of the
    change of the gaps: nothing while contact persists, never a gain. Friction takes energy and never gives any, booked
    as its own work. Schemes that remember accelerations (`GeneralizedAlpha`, `BDF2`) would gain energy in impacts by
    multipliers, and are refused. See :doc:`/theory/contact`.

    Between rigid bodies the vertices of `first` touch, and where both touch by their whole surfaces also edges that
    cross and corners of `second` in faces of `first`: those as sharp as 30 degrees and convex; steps in which
    more of them meet than are held (8 of boxes, 24 of others, 64 by a penalty) are refused.
    `forces` have their share, `pressures` are those of vertices. By mortar means over the facets of `first` touch,
    which corners of what does not lie flat pass by. Edges and corners of `second` against what is round are not seen.
    Steps in which bodies sink into each other beside their gaps, by a hundredth of their least width, fail and say so:
    exchange `first` and `second`.

    A cylinder or cone that is `first` touches by its vertices: 32 on each rim and one in the middle of each flat face.
    So it rolls as a polygon, by a small impact at each vertex, after which it may hop: with n corners and restitution
    0 each leaves (1 + 2 cos(2 pi / n)) / 3 of the spin, so that by 32 a quarter of it is gone after 4.4 rad. On its
    flat face it presses and rubs, by ``formulation="node-to-segment"`` and on a `Plane`, along the rim: spinning there
    friction has the torque 32/33 mu M g R, not the 2/3 mu M g R of an even pressure. By mortar, friction feels the
    mean slip near each vertex, and has 0.50 mu M g R; with two rings of vertices 0.64, with four 0.66. A box, too, has
    0.62 of its own; the check says how much it is. Balls and capsules roll exactly. For more vertices, also within the
    flat faces, give the shape as a `SurfaceMesh`; ``Cylinder(...).surface(128)`` are points and triangles with finer
    rims.

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

    outside_axes = NOWHERE

    first: Attachable
    second: Component | None = None
    first_faces: str | Faces = "all"
    second_faces: str | Faces = "all"
    formulation: Literal["mortar", "node-to-segment"] | None = None
    enforcement: Literal["multipliers", "penalty"] = "multipliers"
    multipliers: Literal["standard", "dual"] = "standard"
    condensed: bool = False
    stiffness: Number | None = None
    damping: Number = 0.0
    impact: Literal["dissipative", "conserving"] = "dissipative"
    restitution: Number | None = None
    friction: Number = 0.0
    tangential: Literal["multipliers", "penalty"] = "multipliers"
    tangential_stiffness: Number | None = None
    initial: Literal["touch", "press", "resolve"] = "touch"
    reach: Number | None = None

    def __post_init__(self) -> None:
        check_bars(self)
        check_second(self)
        self.is_mortar = self._is_mortar()
        if self.second is None and self.is_mortar:
            raise InputError(
                f"{self.label}: without second a surface touches itself, by formulation='node-to-segment'; for "
                "mortar contact give parts that meet as first_faces and second_faces, both of the same body"
            )
        check_multipliers(self)
        check_restitution(self)
        check_numbers(self)

    def announce(self, model: Model) -> None:
        for body in dict.fromkeys((self.first, self.second)):  # others of the same surfaces are refused
            if body is not None:
                model.announce(body, self)
        model.announce(self.first, Facing(self, self.first_faces))
        if self.second is not None:
            model.announce(self.second, Facing(self, self.second_faces))

    def _is_mortar(self) -> bool:
        """Vertices are exact for balls and points; means over the large facets of rigid bodies let corners sink."""
        if self.formulation is not None:
            return self.formulation == "mortar"
        if self.second is None:
            return False
        feelers = self.first.feelers()
        is_ball = feelers is not None and len(feelers[0]) == 1
        is_rigid = not mesh_bodies(self.first, self.second)
        return not (((is_ball or is_rigid) and self.multipliers == "standard") or is_bar(self.first))

    def declare(self, model: Model) -> None:
        model.index(self.first)
        if self.second is not None:
            model.index(self.second)
        check_sides(self)
        refuse_doubles(self, model)
        self.conducts = conducted(model, self.first, self.second)
        self._started = False
        self._find_surface(splits=self.initial != "resolve")  # nodes are moved by one gap each
        self.moved = 0.0  # how far a node was moved at most so that nothing overlaps
        if self.initial == "resolve":
            gaps = self._gaps(model.length)
            sides = [side_of(self._surface, self.first, self.first_faces)]
            if gaps.opposite is not None:
                sides.append(side_of(gaps.opposite, self.second, self.second_faces))
            self.moved = resolve(self.label, sides, model, gaps.core, gaps.size)
            self._find_surface()
        n = len(self._surface.forms)
        if self.enforcement == "multipliers":
            self.pressure = model.field(self, "pressure", np.zeros(n), role=Role.CONTACT_PRESSURE, stage=1)
        if self.friction > 0 and self.tangential == "multipliers":
            zeros = np.zeros((n, self._surface.dimension - 1))
            self.traction = model.field(self, "traction", zeros, role=Role.CONTACT_PRESSURE, stage=1)
        self._edges = edges_of(self)
        if self._edges:
            self._edges.declare(model)

    @property
    def _pair(self) -> Pair:
        faces, mortar, dual = self.second_faces, self.is_mortar, self.multipliers == "dual"
        fine, rubs = self.enforcement == "penalty", self.friction > 0
        return Pair(self.label, self.first, self.second, faces, mortar, dual, rubs, self.reach, fine)

    def _find_surface(self, splits: bool = True) -> None:
        self._surface, self._radius = self._pair.first_surface(self.first_faces, splits)

    def _gaps(self, length: float) -> GapFunctions:
        return self._pair.gap_functions(self._surface, self._radius, length)

    def contribute(self, model: Model) -> None:
        multipliers, sticks = self.enforcement == "multipliers", self.tangential == "multipliers"
        rubs = self.friction > 0
        gaps = self._gaps(model.length)
        self.size, self._facing, self._turns, self._reach = gaps.size, gaps.opposite, gaps.turns, gaps.reach
        self._width = self._find_width()
        spans = float(np.ptp(self.places, axis=0).max())
        alone = spans or self._radius or model.length  # of points that have no facets
        self.extent = self.size or alone  # by which overlaps at the start are judged
        self._share = self._surface.size or alone  # by which gaps are told from rounding
        normal = self._stiffness()
        tangential = self._tangential_stiffness() if rubs else 0.0
        layer = self._layer
        along = self.traction.unknowns[:: self._surface.dimension - 1] if rubs and sticks else []
        self.term = _core.ContactTerm(
            gaps.core,
            gaps.reach,
            np.array(self.pressure.unknowns if multipliers else [], dtype=np.int32),
            normal / self._surface.areas,
            self._surface.areas,
            self.impact == "conserving",
            self._pair.is_rigid,
            self._share_left,
            self._share,
            self.initial == "press",
            self.friction,
            np.array(along, dtype=np.int32),
            tangential / self._surface.areas,
            layer.inertia / self._surface.areas,
            layer.rigid_inertia / self._surface.areas,
            self.damping / self._surface.areas if self.damping > 0 else np.zeros(0),
        )
        self.term.name = self.label
        watch(self, self.term)
        work = model.account(self, "contact", "dissipation")
        energy = -1 if multipliers else model.account(self, "contact", "potential")
        self.term.book_contact(work, energy)
        if rubs:
            work = model.account(self, "friction", "dissipation")
            energy = -1 if sticks else model.account(self, "friction", "potential")
            self.term.book_friction(work, energy)
        if self._edges:  # are evaluated first
            self._edges.contribute(model, (normal, tangential), layer, gaps.reach, self._share_left)
            self.term.stand_beside(self._edges.term)
        model.batch(self.term)
        lie_beside(self, self._before(model))
        cover(self, self._before(model), model)
        if self.condensed:
            self._condense(model)

    def _before(self, model: Model) -> list[Contact]:
        """Contacts of the same bodies that come before this one in the system."""
        bodies = dict.fromkeys(body for body in (self.first, self.second) if body is not None)
        about = [
            takewhile(lambda other: other is not self, model.announced(body, Contact)) for body in bodies
        ]
        return list({id(other): other for others in about for other in others}.values())

    @property
    def _share_left(self) -> float:
        """Share of the velocity of approach that an impact of rigid bodies leaves."""
        if self.restitution is None:
            return 1.0 if self.impact == "conserving" else 0.0
        return float(self.restitution)

    def _condense(self, model: Model) -> None:
        (body,) = mesh_bodies(self.first)
        nodes = body.node_unknowns(body.faces(self.first_faces).nodes)
        for pressure, node in zip(self.pressure.unknowns, nodes, strict=True):
            model.reductions.condense_multiplier(int(pressure), int(node), self._surface.dimension)

    def start(self, state: State, scheme: Scheme) -> None:
        check_schemes(self, scheme)
        if self._started:
            return
        self._started = True
        if not state.is_given:
            return
        state.core.find_neighbours()
        state.evaluate_ledger()
        if self.initial != "press":
            refuse_overlap(self, positions(self._surface, state.x))
            if self._edges:
                self._edges.refuse_overlap(DEEP * self.extent)
        refuse_unseen(self, self._reach, state.x)
        refuse_narrow(self, state.x)
        seen = np.append(-np.nan_to_num(self.gaps), self._edges.depths if self._edges else 0.0)
        if seen.max() <= DEEP * self.extent:
            refuse_hidden(self, DEEP * self.extent, state.x)

    @property
    def _layer(self) -> Layer:
        bodies = [body for body in (self.first, self.second) if body is not None]
        return Layer(self.label, bodies, self._surface, self._width)

    def _find_width(self) -> float:
        """Largest diameter of a facet of what deforms: those of rigid bodies say nothing of how stiff it is."""
        sides = ((self.first, self._surface), (self.second, self._facing))
        widths = [side.size for body, side in sides if side is not None and mesh_bodies(body)]
        return self.size if is_bar(self.second or self.first) else max(widths, default=0.0) or self.size

    def _stiffness(self) -> float:
        """Stiffness of the normal contact."""
        layer, factor = self._layer, 1.0 if self.enforcement == "multipliers" else 10.0
        if self.stiffness is None:
            return factor * layer.stiffness
        if self.enforcement == "penalty" and layer.moduli:
            check_stiffness(self.label, self.stiffness, layer.stiffness, 10 * layer.stiffness)
        return float(self.stiffness)

    def _tangential_stiffness(self) -> float:
        """Stiffness along the surface; between rigid bodies that across it unless it is given."""
        if self.tangential_stiffness:
            return float(self.tangential_stiffness)
        if self._layer.moduli:
            return self._layer.stiffness * (1.0 if self.tangential == "multipliers" else 10.0)
        return self._stiffness()

    @property
    def forms(self) -> tuple[list[Any], list[Any]]:
        """Vertices of both surfaces as first unknowns of vectors with weights, once it is part of a system."""
        return self._surface.forms, [] if self._facing is None else self._facing.forms

    # --- results -------------------------------------------------------------------------------------------
    @property
    def opposite(self) -> Surface | None:
        """The second surface, if it is one of facets."""
        return self._facing if self._facing is not None and len(self._facing.facets) else None

    @property
    def places(self) -> Array:
        """Reference positions (n, 3) of the vertices of the first surface, in own coordinates of a rigid body.

        By mortar those at sharp edges of rigid bodies, and of solids that rub, are one for each side: see `source`.
        """
        return self._gathered(self._surface.places, np.max)

    @property
    def source(self) -> NDArray[np.int64] | None:
        """At which node or corner each vertex of the first surface is, if several are at sharp edges."""
        return self._surface.source

    @property
    def pressures(self) -> Array:
        """Pressures (n,) at the vertices of the first surface in the last step.

        Where facets lean together over a point or ball of a rigid body, the sum of what each presses by multipliers.
        Where more than three vertices of a rigid body press on what is rigid by multipliers, only their sum and its
        torque are determined; they are linear in the place, the least in the mean of squares over the area. How
        `tractions` of what sticks share theirs follows from the motion before.
        """
        return self._gathered(self.term.pressures)

    @property
    def tractions(self) -> Array:
        """Tractions of friction (n, 3) on the first surface at its vertices in the last step."""
        return self._gathered(self.term.tractions.reshape(-1, 3))

    @property
    def slipping(self) -> NDArray[np.bool_]:
        """Whether each vertex (n,) of the first surface slipped in the last step."""
        slips: NDArray[np.bool_] = self._surface.gathered(np.array(self.term.slips, dtype=bool), np.any)
        return slips

    @property
    def gaps(self) -> Array:
        """Mean gaps (n,) near the vertices of the first surface at the end of the last step; nan where none."""
        areas = self.term.areas
        gaps = np.where(areas > 0, self.term.gaps / np.where(areas > 0, areas, 1.0), np.nan)
        return self._gathered(gaps, np.fmin.reduce)

    @property
    def costs(self) -> dict[str, float]:
        """CPU seconds so far: search for neighbours, integrals over segments, forces and tangents made of them."""
        return dict(zip(("search", "segments", "forces"), self.term.costs, strict=True))

    @property
    def forces(self) -> Array:
        """Forces (n, 3) on the vertices of the first surface in the last step; the second feels the opposite."""
        n = len(self._surface.forms)
        if not len(self.term.forces):
            return self._gathered(np.zeros((n, 3)))
        rubbed = self.term.friction_forces.reshape(-1, 3)
        forces: Array = self.term.forces.reshape(-1, 3)[:n] + rubbed[:n]
        if is_bar(self.first) and len(self._turns):
            forces += rubbed[self._turns[:, None] + np.arange(FRAME)].sum(axis=1)
        elif len(self._turns):  # friction acts on the vertices of one frame for all
            begin = int(self._turns[0])
            tractions = self.term.tractions.reshape(-1, 3)
            rest = rubbed[begin : begin + FRAME].sum(axis=0) - tractions.sum(axis=0)
            forces += tractions + rest / n  # the rest balances torques and is of the order of the gap
        gathered = self._gathered(forces)
        if self._edges:
            self._edges.add_to(gathered)
        return gathered

    def _gathered(self, values: Array, how: Any = np.sum) -> Array:
        """Of each vertex (n, ...) of the first surface what `values` (k n, ...) of its gaps come to.

        A point or ball of a rigid body has several, by multipliers: one with each facet that leans over it.
        """
        gathered: Array = self._surface.gathered(values, how)
        return gathered

    def record(self, x: Array) -> Array:
        return record(self, x)

    @property
    def touches(self) -> bool:
        return True

    @property
    def rubs(self) -> bool:
        return self.friction > 0

    @property
    def collides(self) -> bool:
        return self.enforcement == "multipliers" and self._pair.is_rigid

    @property
    def overlaps(self) -> Array:
        depths = np.maximum(0.0, -np.nan_to_num(self.gaps)) if self.collides else np.zeros(0)
        return np.append(depths, self._edges.depths) if self.collides and self._edges else depths

    def remarks(self) -> list[str]:
        return remarks_of(self, self._surface)

    def unfit_for_modes(self) -> str:
        found = without_tangent(self.pressures, self.gaps, self.tractions, self.friction, self._share)
        return found or (self._edges.without_tangent(self._share) if self._edges else "")

    def trouble(self, x: Array) -> str:
        what = unsettled(self.term, self._surface, self.friction, x)
        if not what and self._edges and self._edges.term.unsettled:
            what = "still opens and closes, or sticks and slips, where edges cross or corners touch faces"
        return f"{self.label} {what}" if what else ""
