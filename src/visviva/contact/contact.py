"""Unilateral contact of two surfaces."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva import _core
from visviva.base.errors import InputError
from visviva.body.rigid import RigidBody
from visviva.component.component import Component, settings
from visviva.component.point import Attachable
from visviva.component.values import Number
from visviva.contact.contact_check import (
    check_multipliers,
    check_restitution,
    check_schemes,
    check_sides,
    check_stiffness,
    refuse_overlap,
)
from visviva.contact.contact_fields import record
from visviva.contact.contact_surface import Surface, mesh_bodies, points_of, positions, skin, surface_of
from visviva.contact.doubles import refuse_doubles
from visviva.contact.obstacle import frame_surface
from visviva.contact.resolve import resolve, side_of
from visviva.mesh.faces import Faces
from visviva.model.field import Role

if TYPE_CHECKING:
    from visviva.body.shape import Outline
    from visviva.component.point import Frame
    from visviva.model.model import Model
    from visviva.model.state import State
    from visviva.scheme.schemes import Scheme

Array = NDArray[np.float64]

AT_ONCE = 1 / 32
"""Part of a layer's mass that answers to the traction of one vertex: less than the share of a node, as consistent
masses let one node move more easily than all together (by 3.5 across the surface and 1.7 along each direction), and
nodes at edges and corners more easily still."""
AT_LIMIT = 1e-6
"""Tractions that miss Coulomb's limit by no more than this part of it have reached it by slipping."""
FRAME = 4
"""Vertices of a frame."""
TOUCHING = 1e-9
"""Gaps below this part of the size of the first surface's facets are neither open nor closed without pressure."""


@dataclass(config=settings, eq=False, kw_only=True)
class Contact(Component):
    """Two surfaces that may touch but not penetrate.

    Parameters
    ----------
    first : Solid, RigidBody or PointMass
        Gaps belong to the vertices of this surface, which should be the finer one.
    second : Solid, RigidBody, Plane or Obstacle, optional
        What it touches; if left out the first surface touches itself, by vertices and with a penalty.
    first_faces, second_faces : str or Faces
        Which part of the surface, by the name of a set of faces, of rigid bodies of a face of their shape; 'all' for
        the whole boundary.
    formulation : {'mortar', 'node-to-segment'}, optional
        By default 'node-to-segment' where `first` is a ball or a point, for which it is exact, else 'mortar'.
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
        of rigid bodies, by default that of a facet of the layer.
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
        `tangential_stiffness` times an elastic slip, which is kept from step to step.
    tangential_stiffness : float
        Traction per slip; of the penalty, or of the augmentation of multipliers, where it changes no result. By
        default that of a layer of elements, ten times that for a penalty.
    initial : {'touch', 'press', 'resolve'}
        'touch': surfaces that overlap at the start are refused. 'press': the overlap of a press fit, which contact
        pushes out; in dynamics that adds energy, in the ledger's share of contact; rigid bodies are pushed out in the
        first step, with the velocity that this takes, beside what impacts leave. 'resolve': nodes of solids are moved
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

    A cylinder or cone that is `first` touches by its vertices: 32 on each rim and one in the middle of each flat face.
    So it rolls as a polygon, by a small impact at each vertex, after which it may hop; and on its flat face it presses
    and rubs along the rim: spinning there friction has the torque 32/33 mu M g R, not the 2/3 mu M g R of a uniform
    pressure. Balls and capsules roll exactly. For more vertices, also within the flat faces, give the shape as a
    `SurfaceMesh`; ``Cylinder(...).surface(128)`` are points and triangles with finer rims.

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
        if not self.friction >= 0:
            raise InputError(
                f"{self.label}: friction = {self.friction:g} is negative; give a coefficient >= 0"
            )
        if self.second is None and (self.enforcement, self.formulation) != ("penalty", "node-to-segment"):
            raise InputError(
                f"{self.label}: without second a surface touches itself, which needs enforcement='penalty' and "
                "formulation='node-to-segment'"
            )
        if self.formulation is None:
            self.formulation = self._usual_formulation()
        check_multipliers(self)
        check_restitution(self)
        if not self.damping >= 0:
            raise InputError(f"{self.label}: damping = {self.damping:g} is negative: it would add energy")
        if self.damping > 0 and self.enforcement != "penalty":
            raise InputError(f"{self.label}: damping needs enforcement='penalty', not {self.enforcement!r}")
        for name in ("stiffness", "tangential_stiffness", "reach"):
            value = getattr(self, name)
            if value is not None and not value > 0:
                raise InputError(f"{self.label}: {name} = {value:g} is not positive")

    def announce(self, model: Model) -> None:
        for body in dict.fromkeys(
            (self.first, self.second)
        ):  # so that others of the same surfaces are refused
            if body is not None:
                model.announce(body, self)

    def _usual_formulation(self) -> Literal["mortar", "node-to-segment"]:
        """Exact for balls and points; other rigid shapes have edges, which vertices pass by."""
        feelers = self.first.feelers()
        is_exact = feelers is not None and len(feelers[0]) == 1 and self.multipliers == "standard"
        return "node-to-segment" if is_exact else "mortar"

    def declare(self, model: Model) -> None:
        model.index(self.first)
        if self.second is not None:
            model.index(self.second)
        check_sides(self)
        refuse_doubles(self, model)
        self._started = False
        self._facing: Surface | None = None
        self._see()
        self.moved = 0.0  # how far a node was moved at most so that nothing overlaps
        if self.initial == "resolve":
            gaps, size, _ = self._gaps(model.length)
            sides = [side_of(self._surface, self.first, self.first_faces)]
            if self._facing is not None:
                sides.append(side_of(self._facing, self.second, self.second_faces))
            self.moved = resolve(self.label, sides, model, gaps, size)
            self._see()
        n = len(self._surface.forms)
        if self.enforcement == "multipliers":
            self.pressure = model.field(self, "pressure", np.zeros(n), role=Role.CONTACT_PRESSURE, stage=1)
        if self.friction > 0 and self.tangential == "multipliers":
            zeros = np.zeros((n, self._surface.dimension - 1))
            self.traction = model.field(self, "traction", zeros, role=Role.CONTACT_PRESSURE, stage=1)

    def _see(self) -> None:
        """The first surface."""
        if self._by_vertices:
            self._surface, self._radius = points_of(self.first, self.first_faces, self.label)
        else:
            self._surface, self._radius = surface_of(self.first, self.first_faces, self.label), 0.0

    @property
    def _outline(self) -> Outline | None:
        """The second one's exact shape, if that is what counts."""
        by_facets = self.formulation == "mortar" or self.second_faces != "all"
        if self.second is None or (by_facets and self.second.surface() is not None):
            return None
        outline: Outline | None = self.second.outline()
        return outline

    @property
    def _by_vertices(self) -> bool:
        return self.formulation != "mortar" or self._outline is not None

    def contribute(self, model: Model) -> None:
        multipliers, sticks = self.enforcement == "multipliers", self.tangential == "multipliers"
        rubs = self.friction > 0
        gaps, self.size, reach = self._gaps(model.length)
        spans = float(np.ptp(self.places, axis=0).max())
        alone = spans or self._radius or model.length  # of points that have no facets
        self.extent = self.size or alone  # by which overlaps at the start are judged
        self._share = self._surface.size or alone  # by which gaps are told from rounding
        normal = self._stiffness(self.size)
        tangential = self._tangential_stiffness(sticks) if rubs else 0.0
        along = self.traction.unknowns[:: self._surface.dimension - 1] if rubs and sticks else []
        self.term = _core.ContactTerm(
            gaps,
            reach,
            np.array(self.pressure.unknowns if multipliers else [], dtype=np.int32),
            normal / self._surface.areas,
            self._surface.areas,
            self.impact == "conserving",
            self._is_rigid,
            self._share_left,
            self._share,
            self.initial == "press",
            self.friction,
            np.array(along, dtype=np.int32),
            tangential / self._surface.areas,
            self._inertia / self._surface.areas,
            self.damping / self._surface.areas if self.damping > 0 else np.zeros(0),
        )
        self.term.name = self.label
        work = model.account(self, "contact", "dissipation")
        energy = -1 if multipliers else model.account(self, "contact", "potential")
        self.term.book_contact(work, energy)
        if rubs:
            work = model.account(self, "friction", "dissipation")
            energy = -1 if sticks else model.account(self, "friction", "potential")
            self.term.book_friction(work, energy)
        model.batch(self.term)
        if self.condensed:
            self._condense(model)

    @property
    def _is_rigid(self) -> bool:
        """Whether the first surface is that of a rigid body, or a point."""
        return not mesh_bodies(self.first)

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
            model.press(int(pressure), int(node), self._surface.dimension)

    def _gaps(self, length: float) -> tuple[_core.Gaps, float, float]:
        """The gap functions, the size of facets, and how far they see."""
        first, areas, outline = self._surface, self._surface.areas, self._outline
        rubs = self.friction > 0
        if outline is not None:
            core, frame = outline
            self._facing = frame_surface([*self._turning, frame], length)
            pair = self._paired(self._facing)
            half = np.array(core.half)
            gaps = _core.obstacle(pair, areas, self._radius, rubs, core.kind, half, core.radius, length)
            return gaps, first.size, length
        self._facing = None
        if self.second is None:
            reach = self.reach or first.size
            whole = skin(first, None)
            return (
                _core.self_contact(whole, areas, first.behind, reach, rubs, first.places),
                first.size,
                reach,
            )
        if not isinstance(self.second, Attachable):
            raise InputError(f"{self.label}: {self.second.label} has no surface")
        self._facing = opposite = surface_of(self.second, self.second_faces, self.label)
        size = max(first.size, opposite.size)
        reach = self.reach or size
        pair = self._paired(opposite, *(frame_surface([frame], length) for frame in self._turning))
        if self.formulation == "mortar":
            return _core.mortar(pair, reach, first.axisymmetric, self.multipliers == "dual"), size, reach
        axis = length if self._turning else 0.0
        return _core.node_to_segment(pair, areas, first.behind, self._radius, reach, rubs, axis), size, reach

    @property
    def _turning(self) -> list[Frame]:
        """The frame of balls that rub, which their points turn with."""
        if self._radius > 0 and self.friction > 0 and isinstance(self.first, RigidBody):
            return [self.first.frame()]
        return []

    def _paired(self, opposite: Surface, *frames: Surface) -> _core.Skin:
        first = self._surface
        other = self.second.label if self.second else ""
        if first.dimension != opposite.dimension and any(opposite.forms):
            raise InputError(f"{self.label}: {self.first.label} and {other} differ in dimension")
        if not any(form for part in (first, opposite) for form in part.forms):
            raise InputError(f"{self.label}: neither {self.first.label} nor {other} can move")
        pair: _core.Skin = skin(first, opposite, *frames)
        return pair

    def start(self, state: State, scheme: Scheme) -> None:
        check_schemes(self, scheme)
        if self._started or self.initial == "press":
            return
        self._started = True
        if not state.is_given:
            return
        state.core.find_neighbours()
        state.take_stock()
        refuse_overlap(self, positions(self._surface, state.x))

    def _stiffness(self, size: float) -> float:
        """Stiffness of the normal contact."""
        multipliers = self.enforcement == "multipliers"
        if self.stiffness is None:
            return self._default_stiffness(size, multipliers)
        if not multipliers and self._moduli:
            own = self._layer(size)
            check_stiffness(self.label, self.stiffness, own, 10 * own)
        return float(self.stiffness)

    def _tangential_stiffness(self, multipliers: bool) -> float:
        """Stiffness along the surface; between rigid bodies that across it unless it is given."""
        if self.tangential_stiffness or self._moduli:
            return float(self.tangential_stiffness or self._default_stiffness(self.size, multipliers))
        return self._stiffness(self.size)

    @property
    def _inertia(self) -> float:
        """Mass by area that a traction at a vertex moves at once: a part of that of a layer of facets."""
        area, meshes = self._surface.areas.sum(), mesh_bodies(self.first, self.second)
        masses = [body.density * self.size for body in meshes]
        masses += [
            c.total_mass / area for c in (self.first, self.second) if c is not None and c not in meshes
        ]
        return AT_ONCE * min((m for m in masses if m > 0), default=0.0)

    @property
    def _moduli(self) -> list[float]:
        return [body.modulus for body in mesh_bodies(self.first, self.second)]

    def _default_stiffness(self, size: float, multipliers: bool) -> float:
        if not self._moduli:
            raise InputError(
                f"{self.label}: between rigid bodies nothing says how stiff contact should be; give its stiffness"
            )
        return self._layer(size) * (1.0 if multipliers else 10.0)

    def _layer(self, size: float) -> float:
        """Stiffness of a layer of elements, of a facet of it where points of rigid bodies feel forces."""
        return min(self._moduli) / size * (1.0 if len(self._surface.facets) else size**2)

    # --- results -------------------------------------------------------------------------------------------
    @property
    def opposite(self) -> Surface | None:
        """The second surface, if it is one of facets."""
        return self._facing if self._facing is not None and len(self._facing.facets) else None

    @property
    def places(self) -> Array:
        """Reference positions (n, 3) of the vertices of the first surface, in own coordinates of a rigid body."""
        return self._surface.places

    @property
    def pressures(self) -> Array:
        """Pressures (n,) at the vertices of the first surface in the last step."""
        values: Array = self.term.pressures
        return values

    @property
    def tractions(self) -> Array:
        """Tractions of friction (n, 3) on the first surface at its vertices in the last step."""
        values: Array = self.term.tractions.reshape(-1, 3)
        return values

    @property
    def slipping(self) -> NDArray[np.bool_]:
        """Whether each vertex (n,) of the first surface slipped in the last step."""
        slips: NDArray[np.bool_] = np.array(self.term.slips, dtype=bool)
        return slips

    @property
    def gaps(self) -> Array:
        """Mean gaps (n,) near the vertices of the first surface at the end of the last step; nan where none."""
        areas = self.term.areas
        gaps: Array = np.where(areas > 0, self.term.gaps / np.where(areas > 0, areas, 1.0), np.nan)
        return gaps

    @property
    def costs(self) -> dict[str, float]:
        """CPU seconds so far: search for neighbours, integrals over segments, forces and tangents made of them."""
        return dict(zip(("search", "segments", "forces"), self.term.costs, strict=True))

    @property
    def forces(self) -> Array:
        """Forces (n, 3) on the vertices of the first surface in the last step; the second feels the opposite."""
        n = len(self._surface.forms)
        if not len(self.term.forces):
            return np.zeros((n, 3))
        rubbed = self.term.friction_forces.reshape(-1, 3)
        forces: Array = self.term.forces.reshape(-1, 3)[:n] + rubbed[:n]
        if self._turning:  # friction acts on the vertices of their frame, which stand behind those of facets
            begin = n + (len(self.opposite.forms) if self.opposite else 0)
            rest = rubbed[begin : begin + FRAME].sum(axis=0) - self.tractions.sum(axis=0)
            forces += self.tractions + rest / n  # the rest balances torques and is of the order of the gap
        return forces

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
        return self.enforcement == "multipliers" and self._is_rigid

    def unfit_for_modes(self) -> str:
        presses = self.pressures > 0
        touches = ~presses & (np.abs(self.gaps) <= TOUCHING * self._share)
        if touches.any():
            return (
                f"it touches without pressure at {int(touches.sum())} of its vertices, which are neither open nor "
                "closed; press the surfaces together by a load, or move them apart"
            )
        limit = (1 - AT_LIMIT) * self.friction * self.pressures
        slips = presses & (np.linalg.norm(self.tractions, axis=1) >= limit) & (self.friction > 0)
        if slips.any():
            return (
                f"friction is at Coulomb's limit at {int(slips.sum())} of its vertices, which slip or are about to; "
                "raise friction, or leave it out"
            )
        return ""

    def trouble(self, x: Array) -> str:
        vertices = self.term.unsettled
        if not vertices:
            return ""
        places = positions(self._surface, x)[vertices[:3]]
        near = ", ".join("(" + ", ".join(f"{c:.4g}" for c in place) + ")" for place in places)
        what = "opens and closes, or sticks and slips," if self.friction > 0 else "opens and closes"
        return f"{self.label} still {what} at {len(vertices)} vertices, such as near {near}"
