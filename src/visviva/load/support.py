"""Supports of solids: nodes that are held, slide in a plane, or move as prescribed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.differences import forward_rate
from visviva.base.errors import InputError, RunError
from visviva.body.director_body import DirectorBody
from visviva.body.mesh_body import MeshBody
from visviva.component.announcements import Clamping, Holding
from visviva.component.component import Component, settings
from visviva.component.momentum import Axes, axes_along, by_forces
from visviva.component.point import unit, vector
from visviva.component.values import Motion, Nodes, Vector3
from visviva.load.force import guarded
from visviva.load.periodic_faces import PeriodicFaces
from visviva.mesh.periodic import refuse_apart
from visviva.model.form import Vector

if TYPE_CHECKING:
    from visviva.model.model import Model
    from visviva.model.state import State

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Directions = tuple[bool, bool, bool]
EVERY: Directions = (True, True, True)


@dataclass(config=settings, eq=False, kw_only=True)
class Support(Component):
    """Base of supports of nodes of a body on a mesh.

    Parameters
    ----------
    solid : Solid
    nodes : str or array of int
        Name of a set of nodes or faces, 'all', or numbers of nodes.
    """

    solid: MeshBody
    nodes: Nodes

    def __post_init__(self) -> None:
        try:
            self._chosen = self.solid.nodes(self.nodes)
        except InputError as error:
            raise InputError(f"{self.label}: {error}") from None

    def _numbers(self, model: Model, directions: Any) -> Ints:
        """Numbers in the solid's field of these components of the nodes, node by node."""
        model.index(self.solid)
        first = self._carriers - self.solid.motion.start
        return (first[:, None] + np.flatnonzero(directions[: self.solid.dimension])).ravel()

    @property
    def _carriers(self) -> NDArray[np.int32]:
        """First unknowns (k,) of what the nodes are held by."""
        carriers = self.solid.carriers
        return carriers.unknowns(carriers.held(self._chosen))

    def _holds(self) -> NDArray[np.bool_] | None:
        """See `Holding.directions`."""
        return None

    def announce(self, model: Model) -> None:
        model.announce(self.solid, Holding(self, self._chosen, self._holds()))

    def _refuse_nothing(self, directions: Any) -> None:
        if not any(directions[: self.solid.dimension]):
            raise InputError(f"{self.label}: none of the directions {tuple(directions)} can be held")


@dataclass(config=settings, eq=False, kw_only=True)
class Fixed(Support):
    """Nodes that keep their reference positions, in all `directions` x, y, z or some.

    Parameters
    ----------
    solid : Solid
    nodes : str or int array
        Name of a set of nodes or faces, 'all', or numbers.
    directions : (3,) of bool

    Examples
    --------
    >>> import visviva as vv
    >>> mesh = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2))
    >>> block = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1e3, poisson=0.3))
    >>> vv.System([block, vv.Fixed(solid=block, nodes="z0")]).n_coordinates
    54
    """

    directions: Directions = EVERY

    @property
    def outside_axes(self) -> Axes:
        return by_forces(axes_along(self.directions))

    def __post_init__(self) -> None:
        super().__post_init__()
        self._refuse_nothing(self.directions)

    def _holds(self) -> NDArray[np.bool_] | None:
        return np.array(self.directions)

    def contribute(self, model: Model) -> None:
        model.hold(self.solid.motion, self._numbers(model, self.directions))


@dataclass(config=settings, eq=False, kw_only=True)
class Clamped(Support):
    """Nodes of a beam or shell that neither move nor turn.

    Parameters
    ----------
    solid : Beam or Shell
    nodes : str or int array
        Name of a set of nodes, such as "start" and "end", 'all', or numbers.

    Notes
    -----
    `Fixed` holds positions alone: there a beam can turn as on a ball joint.
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(self.solid, DirectorBody):
            raise InputError(f"{self.label}: {self.solid.label} has no directors to hold; take vv.Fixed")

    def announce(self, model: Model) -> None:
        super().announce(model)
        model.announce(self.solid, Clamping(self._chosen))

    def _holds(self) -> NDArray[np.bool_] | None:
        return np.array(EVERY)


@dataclass(config=settings, eq=False, kw_only=True)
class SymmetryPlane(Support):
    """Nodes that stay in the planes through their reference positions, normal to a direction.

    Directors of beams and shells keep their components along the normal. Planes across an axis cost unknowns instead of
    adding any; others are held by multipliers.

    Parameters
    ----------
    solid : Solid
        Or a beam or shell.
    nodes : str or array of int
        Name of a set of nodes or faces, 'all', or numbers of nodes.
    normal : array (3,)
        Of any length, not zero.

    Examples
    --------
    >>> import visviva as vv
    >>> mesh = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2))
    >>> block = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1e3, poisson=0.3))
    >>> vv.System([block, vv.SymmetryPlane(solid=block, nodes="x0", normal=(1, 0, 0))]).n_coordinates
    72
    """

    normal: Vector3

    @property
    def outside_axes(self) -> Axes:
        return by_forces(axes_along(self._along))

    def reactions(self, state: State) -> tuple[Ints, Array]:
        """Nodes (k,), and the forces (k, 3) of an oblique plane on them; planes across an axis fix unknowns."""
        m = getattr(self, "_multipliers", None)
        if m is None:
            return self._chosen[:0], np.zeros((0, 3))
        force = state.x_with_reactions[m.start : m.start + len(self._chosen), None]
        return self._chosen, -force * self._along

    def __post_init__(self) -> None:
        super().__post_init__()
        n = unit(vector(self.normal))
        if n is None:
            raise InputError(f"{self.label}: the normal {self.normal.tolist()} has no direction")
        if self.solid.dimension == 2 and n[2] != 0:
            raise InputError(f"{self.label}: a plane solid cannot be held along {self.normal.tolist()}")
        self._along = np.array(n)
        if self._holds() is None:
            self.solid.carriers.refuse_each_node(self.label, "take a plane across an axis")

    def _holds(self) -> NDArray[np.bool_] | None:
        axis = np.abs(self._along) > 1e-12
        return axis if axis.sum() == 1 else None

    def announce(self, model: Model) -> None:
        super().announce(model)
        model.announce(self.solid, self)  # for probes of its reactions

    def contribute(self, model: Model) -> None:
        axis = np.abs(self._along) > 1e-12
        numbers = self._numbers(model, axis)
        directors = self._chosen[:0]
        if isinstance(self.solid, DirectorBody):
            directors = self.solid.directors_of(self._chosen)
        if axis.sum() == 1:
            model.hold(self.solid.motion, numbers)
            if isinstance(self.solid, DirectorBody):
                self.solid.hold_directors(model, self._chosen, int(np.argmax(axis)))
            return
        forms = [self.solid.combination([k], [1.0]).along(self._along) for k in self._chosen]
        forms += [Vector.of(int(u)).along(self._along) for u in directors]
        self._multipliers = multipliers = model.multipliers(self, "reaction", len(forms), block=self)
        x, _ = model.initial
        for k, form in enumerate(forms):
            model.constrain(self, multipliers, [form - form.value(x)], first=k)


@dataclass(config=settings, eq=False, kw_only=True)
class Prescribed(Support):
    """Nodes that are moved as functions of time say.

    Parameters
    ----------
    solid : Solid
    nodes : str or int array
        Name of a set of nodes or faces, 'all', or numbers.
    motion : callable, or three of number, expression, table, callable or None
        Displacements from the reference positions: ``f(t, X)`` of time and reference positions (n, 3) with values
        (n, 3), or for x, y and z whatever `TimeFunction` takes, None or "free" where the nodes are free.
    directions : (3,) of bool
        Which components of the motion count; the others are free.

    Notes
    -----
    The ledger books the work of what moves the nodes as "prescribed motion"; with energy-momentum and midpoint
    rules the balance closes to round-off. Nodes start with the rates of the motion. At the points of a
    table, where the rate jumps, so do the velocities of the nodes. Where the rate of an expression or a function jumps
    they swing about the new rate with these rules: round it off, e.g. with ``smoothstep``.

    Examples
    --------
    >>> import visviva as vv
    >>> mesh = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2))
    >>> block = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1e3, poisson=0.0))
    >>> ends = vv.Fixed(solid=block, nodes="z0"), vv.Prescribed(solid=block, nodes="z1", motion=(None, None, "0.1*t"))
    >>> system = vv.System([block, *ends])
    >>> _ = vv.quasi_static(system, until=1.0, step=0.5)
    >>> system.value(block.point((0.5, 0.5, 0.5)).position).round(12).tolist()
    [0.5, 0.5, 0.55]
    """

    motion: Motion
    directions: Directions = EVERY

    @property
    def outside_axes(self) -> Axes:
        return by_forces(axes_along(self._moved))

    def __post_init__(self) -> None:
        super().__post_init__()
        moved = (True,) * 3 if callable(self.motion) else tuple(f is not None for f in self.motion)
        self._moved = np.logical_and(moved, self.directions)
        self._refuse_nothing(self._moved)
        self._function = guarded(self.label, "motion", self.motion) if callable(self.motion) else None
        try:
            start = self._displacements(0.0)
        except RunError as error:
            raise InputError(str(error)) from error
        if not np.isfinite(start).all():
            raise InputError(f"{self.label}: its motion is not finite at t = 0")
        flat = self.solid.dimension == 2
        if flat and ((self._function is None and moved[2]) or np.any(start[:, 2] != 0)):
            raise InputError(f"{self.label}: a plane solid cannot be moved out of its plane")
        self._moved[self.solid.dimension :] = False

    @property
    def _places(self) -> Array:
        return self.solid.points[self._chosen]

    def _displacements(self, time: float) -> Array:
        """Displacements (n, 3) of the nodes."""
        if self._function is None:
            return np.tile([0.0 if f is None else f(time) for f in self.motion], (len(self._chosen), 1))
        X = self._places
        u = np.asarray(self._function(time, X), dtype=float)
        if u.shape != X.shape:
            raise RunError(f"{self.label}: its motion has shape {u.shape} for positions {X.shape}")
        return u

    def _values(self, time: float) -> Array:
        u = self._displacements(time)
        for leaders in self._leaders:
            refuse_apart(self.label, "motion", leaders, u[:, self._moved], time, self._size)
        places = self.solid.carriers.places(self._chosen, self._places + u)
        return places[:, self._moved].ravel()

    def _rates(self, time: float, step: float) -> Array:
        if self._function is not None:
            rates: Array = forward_rate(self._values, time, step)
            return rates
        components = [0.0 if f is None else f.rate_after(time, step) for f in self.motion]
        return np.tile(np.array(components)[self._moved], len(self._carriers))

    def contribute(self, model: Model) -> None:
        numbers = self._numbers(model, self._moved)
        self._size = 1e-6 * float(np.ptp(self.solid.points, axis=0).max())
        self._leaders = [sides.leaders[self._chosen] for sides in model.announced(self.solid, PeriodicFaces)]
        kinks = () if self._function else {t for f in self.motion if f is not None for t in f.kinks}
        try:
            model.prescribe(self, self.solid.motion, numbers, self._values, self._rates, kinks)
        except RunError as error:
            raise InputError(str(error)) from error
