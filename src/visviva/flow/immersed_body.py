"""Rigid bodies that move with the fluid around them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.body.inertia import MassProperties
from visviva.body.rigid import RigidBody, mass_matrix
from visviva.body.shape import AnyShape
from visviva.component.component import Component, settings
from visviva.component.momentum import NOWHERE
from visviva.flow.carried import Carried
from visviva.flow.marks import marks
from visviva.flow.overlap import inside_body, refuse_covering
from visviva.model.form import Vector

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]

USUAL = 1.5
"""Spacing from which on motions of bodies do not depend on it by much, in Taylor-Hood elements."""
LEAST_BOX, LEAST_SIMPLEX = 1.1, 1.3
"""Marks closer than this, in edges of cells, are refused in Taylor-Hood elements: some make the tangent singular."""
CLOSE_BOX, CLOSE_SIMPLEX = 1.0, 1.2
"""Hardly any fluid passes between marks so close in stabilised elements; the latter is for other quadrilaterals too."""


@dataclass(config=settings, eq=False, kw_only=True)
class ImmersedBody(Carried):
    """A rigid body within a fluid, which sticks to its surface and moves with it inside.

    Parameters
    ----------
    body : RigidBody
        With a shape. It starts with the velocities of the fluid; joints, springs, drives and loads act upon it as on
        any other.
    fluid : Fluid
        It also fills the place of the body. A plane fluid of thickness 1 needs a shape of length 1 along z, a prism.
    spacing : float
        Distance between the marks of the body that follow the fluid, in edges of the smallest cells around it (half
        edges of quadratic ones).
    damping, sealing, over_walls, leaves
        See `Immersed`.

    Raises
    ------
    InputError
        If the body has no shape, lies partly outside of the fluid, covers its boundary, or does not fit into a plane
        fluid; or for marks too close.
    RunError
        If it leaves the fluid later, see `Immersed`.

    Notes
    -----
    Marks `X` on the surface and inside follow ``x1 - x0 = h I v_m`` (34), where ``x = phi + X_i d_i`` is linear in the
    body's unknowns; the multipliers, forces between fluid and body, act on either by the transpose. Body and fluid
    balance momenta and energy exactly. In the middle of a step rigid motions are exact at the marks: with
    ``x1 - x0 = w x (x0 + x1) / 2`` for directors that stay orthonormal, they are velocities without strain.

    Marks closer than the nodes of the velocity ask for more than these can do: in Taylor-Hood elements spacings below
    1.1 (quadrilaterals, hexahedra) or 1.3 (triangles, tetrahedra) are refused. The check
    remarks on those below 1.5: a disc of three cells in radius that a torque spins turned by 63 % too slowly at 1.2, by
    5 % at 1.5. The body takes away the inertia and weight of the fluid it displaces.

    Between marks viscosity alone holds the fluid: where it is small or the start is sudden, fluid passes through the
    body and circulates inside, however fine the cells and short the steps, and a light body accelerates much too fast.
    Take ``spacing=1`` there, in stabilised quadrilaterals, and try shorter steps too: stabilisation lets fluid through
    by an amount of the first order in the step. Drag in steady flow is nearer with 1.5, as closer marks drag more.
    The audit of a run is wrong where the fluid inside lacks more than 7 percent of its momentum.

    Examples
    --------
    >>> import visviva as vv
    >>> box = vv.RectangleMesh(size=(1, 1), counts=(8, 8), cell="quad9")
    >>> water = vv.Fluid(mesh=box, density=1.0, viscosity=0.1)
    >>> log = vv.RigidBody(shape=vv.Cylinder(radius=0.2, length=1.0), density=1.5, position=(0.5, 0.6, 0.0))
    >>> walls, wet = vv.NoSlip(fluid=water, faces="all"), vv.ImmersedBody(body=log, fluid=water)
    >>> system = vv.System([water, walls, log, wet, vv.Gravity(acceleration=(0, -1, 0))])
    >>> round(wet.total_mass / 0.04, 6)
    -3.141593
    """

    outside_axes = NOWHERE

    body: RigidBody
    spacing: float = USUAL

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0.1 <= self.spacing <= 10.0:
            raise InputError(f"{self.label}: spacing = {self.spacing} is not a number from 0.1 to 10")
        least = self._least_spacing()
        if self.spacing < least:
            raise InputError(
                f"{self.label}: marks with a spacing of {self.spacing:g} ask for more than the velocities of "
                f"{self.fluid.label} can do, and leave its pressures inside of {self.body.label} undetermined; take at "
                f"least {least:g} with its elements, 1.5 is usual, and finer cells for more detail"
            )
        if self.body.shape is None:
            raise InputError(f"{self.label}: {self.body.label} has no shape; give it one")
        self.shape: AnyShape = self.body.shape
        if np.any(self.body.velocity) or np.any(self.body.angular_velocity):
            raise InputError(
                f"{self.label}: {self.body.label} starts with the velocity of {self.fluid.label}; leave out its own"
            )
        if self.fluid.dimension == 2:
            self._check_plane()

    def _least_spacing(self) -> float:
        """From where on pressures of Taylor-Hood elements are determined in trials; stabilised ones always are."""
        if self.fluid.is_stabilised:
            return 0.1
        return LEAST_SIMPLEX if self._has_simplices else LEAST_BOX

    @property
    def _has_simplices(self) -> bool:
        return next(iter(self.fluid.grid.cells)).startswith(("tri", "tet"))

    @property
    def closer(self) -> str:
        """The cure where fluid passes between its marks."""
        enough = CLOSE_SIMPLEX if self._has_simplices else CLOSE_BOX
        if not self.fluid.is_stabilised:
            enough = USUAL if self._has_simplices else CLOSE_SIMPLEX
        return f"take spacing={enough:g}" if self.spacing > enough else "take shorter steps or finer cells"

    def _check_plane(self) -> None:
        z = self.shape.surface()[0][:, 2]
        if abs(np.ptp(z) - 1.0) > 1e-9:
            raise InputError(
                f"{self.label}: the shape of {self.body.label} is {np.ptp(z):.6g} long along its z axis and must have "
                "the length 1 of a plane fluid"
            )
        if abs(abs(self.body.rotation[2, 2]) - 1.0) > 1e-9:
            raise InputError(
                f"{self.label}: the third director of {self.body.label} must be normal to the plane of "
                f"{self.fluid.label}"
            )

    def remarks(self) -> list[str]:
        """Remark on marks that are nearly too close."""
        if self.fluid.is_stabilised or self.spacing >= USUAL:
            return []
        return [
            f"{self.label}: marks with a spacing of {self.spacing:g} ask for nearly more than velocities of "
            f"{self.fluid.label} can do, and drag too much: a disc in trials turned by 63 % too slowly at 1.2, "
            f"by 5 % at {USUAL}; take that or more, and finer cells for more detail"
        ]

    # --- part in the system ---------------------------------------------------------------------------------
    @property
    def carried(self) -> Component:
        return self.body

    def _places(self) -> Array:
        return np.asarray((self.body.position + self.marks @ self.body.rotation.T)[:, : self.fluid.dimension])

    def declare(self, model: Model) -> None:
        super().declare(model)
        d = self.fluid.dimension
        self.body.is_flat = d == 2
        where = self.body.position[:d], self.body.rotation[:d]
        outline = where[0] + self.shape.surface()[0] @ where[1].T
        cells = self._located(outline).cells
        if not self.over_walls:
            walls = self.fluid.wall_places(self.body.position[:d])
            covered = inside_body(self.body, *self.shape.surface(), walls)
            refuse_covering(self.label, self.body, self.fluid, covered)
        edge = float(np.min(self.fluid.grid.volumes[cells]) ** (1 / d)) / (
            1 if self.fluid.is_stabilised else 2
        )
        self.distance = self.spacing * edge
        self.marks = marks(self.shape, self.distance, plane=d == 2)
        self.force = model.multipliers(self, "force", d * len(self.marks), instantaneous=False)

    def contribute(self, model: Model) -> None:
        n, d = len(self.marks), self.fluid.dimension
        self._start(model)
        vectors = np.tile(self._vectors, (n, 1))
        weights = np.hstack([np.ones((n, 1)), self.marks])[:, : d + 1]
        self._follow(model, vectors, weights, self.force.start + d * np.arange(n))
        self._displace(model)

    def _start(self, model: Model) -> None:
        """The rigid motion that is closest to that of the fluid at the marks."""
        d, motion, R = self.fluid.dimension, self.body.motion, self.body.rotation
        arms = self.marks @ R.T
        turns = np.stack([np.cross(axis, arms) for axis in np.eye(3)[-1 if d == 2 else 0 :]], axis=-1)[:, :d]
        A = np.concatenate([np.broadcast_to(np.eye(d), (len(arms), d, d)), turns], axis=2)
        wanted = self._velocities(self._located((self.body.position + arms)[:, :d]), self.fluid.flow.values)
        fit = np.linalg.lstsq(A.reshape(-1, A.shape[2]), wanted.ravel(), rcond=None)[0]
        velocity, turning = np.pad(fit[:d], (0, 3 - d)), fit[d:] if d == 3 else np.array([0.0, 0.0, fit[2]])
        motion.rates[:] = np.concatenate([velocity, *np.cross(turning, R.T)])
        model.refresh(motion)

    @property
    def _vectors(self) -> NDArray[np.int32]:
        """First unknowns of the origin and those directors that move in the fluid's space."""
        return np.asarray(self.body.motion.start + 3 * np.arange(self.fluid.dimension + 1), dtype=np.int32)

    # --- the fluid that is not there --------------------------------------------------------------------------
    @property
    def _displaced(self) -> MassProperties:
        return self.shape.inertia(self.fluid.density)

    def _displace(self, model: Model) -> None:
        d = self.fluid.dimension
        mass = -mass_matrix(self._displaced)[: d + 1, : d + 1]
        self._take_away(model, self._vectors[None], mass[None], np.arange(d + 1) == 0, self._wet)

    def _wet(self) -> Array | None:
        """The part of it (1,) that displaces fluid: that of its marks that are within."""
        return None if self._within is None else np.array([np.mean(self._within)])

    def point_name(self, k: int) -> str:
        return f"mark {k} of {self.body.label}"

    def weigh(self, model: Model, acceleration: Array) -> None:
        if self.leaves:
            self._gravity = self._gravity + np.asarray(acceleration)[: self.fluid.dimension]
            return
        super().weigh(model, acceleration)

    def weights(self) -> list[tuple[float, Vector]]:
        mass, centre, _ = self._displaced
        return [(-mass, self.body.place(centre))]

    # --- results ----------------------------------------------------------------------------------------------
    def forces(self, x: Array) -> Array:
        """Forces (n, 3) of the fluid on the marks at the unknowns `x` of the system.

        Of the midpoint schemes they are those of the middle of the last step.
        """
        return self._forces(self.force, x)

    def places(self, x: Array) -> Array:
        """Positions (n, 3) of the marks at the unknowns `x` of the system."""
        return np.array([self.body.place(X).value(x) for X in self.marks])
