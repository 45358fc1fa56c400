"""Interface of bodies that carry heat, for boundary conditions and exchange."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visviva.base.errors import InputError, RunError
from visviva.body.mesh_points import FacePoints, Points
from visviva.body.touching import Skin
from visviva.component.component import Component
from visviva.component.limited import Limited
from visviva.component.momentum import NOWHERE, Axes
from visviva.mesh.faces import Faces
from visviva.mesh.mesh import Mesh
from visviva.mesh.periodic import refuse_apart
from visviva.model.field import FAINT, Field
from visviva.model.term import Stencils, Term
from visviva.thermal.celsius import taken_for_kelvin

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
CURE = "which is not above absolute zero: no more heat can be taken out there; take smaller steps, or a finer mesh"
"""What a step is told that leads there."""
Law = Callable[[float, Array, Array], tuple[Array, Array]]
"""Heat (m, q) per time and size that flows in and its derivative by the temperature, of time, place and temperature."""


EVEN = 1e-6
"""Temperatures whose differences are this part of them are uniform but for what an earlier run has left."""


def large_change(start: Array, zero: float = 0.0) -> float:
    """A large change of temperatures (n,): their differences, else what they are above a zero, else 1.

    What an earlier run has left is uniform but for rounding, and no step is known to that.
    """
    least = EVEN * float(np.abs(start).max())
    sizes = float(np.ptp(start)), float(np.abs(start - zero).max())
    return next((size for size in sizes if size > least), 1.0)


def known_part(start: Array, scale: float) -> float:
    """Part of a scale that changes of temperatures (n,) are known to reach: their differences, little if uniform."""
    return min(1.0, max(float(np.ptp(start)), FAINT * float(np.abs(start).max())) / scale)


@dataclass(frozen=True, eq=False)
class GivenTemperatures:
    """Temperatures of nodes as functions of time.

    Attributes
    ----------
    nodes : array of int (k,)
    values : callable
        Temperatures (k,) at a time.
    rates : callable
        Their rates (k,) just after a time, given the length of steps, 0 if that is not known.
    kinks : sequence of float
        Times at which the rates may jump.
    """

    nodes: Ints
    values: Callable[[float], Array]
    rates: Callable[[float, float], Array]
    kinks: Sequence[float]

    def shared(self, label: str, number: Ints) -> GivenTemperatures:
        """Of numbers (k,) that nodes share, in place of nodes, by the `number` (n,) of each; `label` is whose."""
        numbers, once, inverse = np.unique(number[self.nodes], return_index=True, return_inverse=True)

        def values(time: float) -> Array:
            found = self.values(time)
            refuse_apart(label, "temperature", inverse, found, time)
            return found[once]

        def rates(time: float, step: float) -> Array:
            return self.rates(time, step)[once]

        try:
            values(0.0)
        except RunError as error:
            raise InputError(str(error)) from error
        return GivenTemperatures(numbers, values, rates, self.kinks)


@dataclass(frozen=True, eq=False)
class HeatPort:
    """Port through which heat goes in and out: unknowns whose mean, by `weights`, has the temperature there.

    Attributes
    ----------
    contents, temperatures : int array (k,)
        The entropies whose balance takes the heat, and the temperatures of the step; the same unknowns where heat
        itself is balanced, as in a `ThermalBody`.
    weights : array (k,)
        Their sum is one, but for what differs through the thickness of a shell.
    """

    contents: Ints
    temperatures: Ints
    weights: Array

    @property
    def balances_heat(self) -> bool:
        return bool(np.array_equal(self.contents, self.temperatures))


class HeatCarrier(Limited):
    """Base of bodies with temperatures at the nodes of a mesh.

    Attributes
    ----------
    start_temperatures : array (n,)
        Of the nodes.
    """

    grid: Mesh
    start_temperatures: Array
    carries_heat = True
    balances_entropy = False  # or heat, in the unknowns of order 1
    periodic: Sequence[tuple[str, str]] = ()  # faces beyond which it goes on

    @property
    def outside_axes(self) -> Axes:
        return NOWHERE

    def remarks(self) -> list[str]:
        said = taken_for_kelvin(self.label, "the lowest one at the start", self.start_temperatures)
        return [*super().remarks(), *(said if self.balances_entropy else [])]

    def invalid(self, x: Array) -> str:
        """Where temperatures count from absolute zero, those of the step at or below it."""
        found = self._below_zero(x) if self.balances_entropy else ""
        return found or super().invalid(x)

    def _below_zero(self, x: Array) -> str:
        T = self.temperatures_across(x).min(axis=1)
        k = int(np.argmin(T))
        if T[k] > 0:
            return ""
        where = (
            f"near ({', '.join(f'{c:.4g}' for c in self.points[k])}) " if len(T) == len(self.points) else ""
        )
        return f"node {k} of {self.label} {where}has a temperature of {T[k]:.4g} K in the step, {CURE}"

    def profiles(self) -> Array:
        """What each unknown (modes,) of the temperature of a node counts for at places (k, modes) across there."""
        return np.eye(1, self.warmth[1].node)

    def temperatures_across(self, x: Array) -> Array:
        """Those (n, k) of the balances of nodes at the places across there that `profiles` counts for."""
        own, profiles = self.warmth[1], self.profiles()
        at_nodes: Array = x[own.start : own.start + own.size].reshape(-1, profiles.shape[1])
        return at_nodes @ profiles.T

    @property
    def warmth(self) -> tuple[Field, Field]:
        """What is balanced, and the temperatures."""
        return self.entropy, self.algorithmic  # type: ignore[attr-defined]

    @property
    @abstractmethod
    def points(self) -> Array:
        """Reference positions (n, 3) of the nodes."""

    @property
    @abstractmethod
    def dimension(self) -> int:
        """Of space: 2 or 3."""

    @property
    @abstractmethod
    def thickness(self) -> float:
        """Of a plane body."""

    @property
    @abstractmethod
    def axisymmetric(self) -> bool:
        """Whether a plane mesh stands for a revolution."""

    @abstractmethod
    def nodes(self, chosen: str | Faces | ArrayLike) -> Ints:
        """Nodes (k,) by the name of a set of nodes or faces, 'all', `Faces`, or their numbers."""

    @abstractmethod
    def faces(self, chosen: str | Faces) -> Faces:
        """Faces by the name of their set, 'all' for the whole boundary, or as given."""

    @abstractmethod
    def cell_points(self) -> Iterator[Points]:
        """Quadrature points of the cells, type by type."""

    @abstractmethod
    def face_points(self, faces: Faces) -> Iterator[FacePoints]:
        """Quadrature points of faces, type by type."""

    def heated_points(self, faces: Faces) -> Iterator[FacePoints]:
        """Quadrature points of faces for heat that comes in from outside, where the material ends."""
        return self.face_points(faces)

    def source_points(self) -> Iterator[Points]:
        """Quadrature points for heat that arises within, per volume; of a beam per length."""
        return self.cell_points()

    @abstractmethod
    def temperature_unknowns(self, nodes: Ints) -> NDArray[np.int32]:
        """The unknown of the temperature of each node at which heat passes in a step."""

    def balance_unknowns(self, nodes: Ints) -> NDArray[np.int32]:
        """The unknown of each node whose equation balances heat, or entropy."""
        return self.temperature_unknowns(nodes)

    def heat_skin(self, chosen: str | Faces) -> Skin:
        """Faces through which heat passes.

        Raises
        ------
        InputError
            If there are none of that name.
        """
        import scipy.sparse as sp

        n, faces = len(self.points), self.faces(chosen)
        every = np.arange(n)
        eye = sp.eye_array(n, format="csr")
        return Skin(
            lambda: self.temperature_unknowns(every), eye, self.points, every, faces, faces, self.dimension
        )

    @abstractmethod
    def temperatures(self, x: Array) -> Array:
        """Temperatures (n,) of the nodes at the unknowns `x` of the system."""

    @abstractmethod
    def hold_temperatures(self, model: Model, owner: Component, given: GivenTemperatures) -> None:
        """Let nodes have temperatures as functions of time say, and book the heat that this takes."""

    @abstractmethod
    def take_heat(self, model: Model, owner: Component, kind: str, points: Points, law: Law) -> None:
        """Let heat flow in at quadrature points, booked as `kind`."""

    def heat_modes(self, faces: Faces) -> Array:
        """What each unknown (modes,) of the temperature of a node counts for at faces; a shell has several.

        They follow each other.
        """
        return np.ones(1)

    def heat_port(self, nodes: Ints, weights: Array, modes: Array | None = None) -> HeatPort:
        """Port for heat that nodes (k,) share by weights (k,), which add up to one, at faces of these `modes`."""
        given = np.ones(1) if modes is None else modes
        further, share = np.arange(len(given))[:, None], np.outer(given, weights).ravel()
        contents, temperatures = (
            (of.astype(np.int64) + further).ravel()
            for of in (self.balance_unknowns(nodes), self.temperature_unknowns(nodes))
        )
        return HeatPort(contents, temperatures, share)


def absolute_zero(body: HeatCarrier) -> float:
    """The least temperature on the scale of a body, as far as that is known: minus infinity where it is not."""
    return 0.0 if body.balances_entropy else -np.inf


class HeatInput(Term):
    """Heat that flows in at quadrature points of cells or faces by a law of time, place and temperature."""

    brings = "heat"

    def __init__(self, kind: str, unknowns: NDArray[np.int32], points: Points, law: Law) -> None:
        super().__init__()
        self.kind, self.unknowns, self.order = kind, unknowns, np.ones(unknowns.shape[1], dtype=np.int32)
        self.points, self.law = points, law

    def taken(self, s: Stencils) -> tuple[Array, Array]:
        """Heat (m, q) per time and size, and its derivative by the temperature."""
        return self.law(s.step.te, self.points.X, self.at_points(s))

    def at_points(self, s: Stencils) -> Array:
        """Temperatures (m, q)."""
        return np.asarray(s.x @ self.points.N.T)

    def residual(self, s: Stencils) -> Array:
        p = self.points
        return np.asarray(-np.einsum("mq,mq,qk->mk", p.size, self.taken(s)[0], p.N))

    def tangent(self, s: Stencils) -> Array:
        p = self.points
        slope = -s.step.theta * p.size * self.taken(s)[1]
        return np.asarray(np.einsum("mq,qk,ql->mkl", slope, p.N, p.N))

    def work(self, s: Stencils) -> Array:
        """Heat (n,) that came in over the step."""
        return np.asarray(s.step.h * (self.points.size * self.taken(s)[0]).sum(axis=1))


class EntropyInput(HeatInput):
    """The same where the entropy is what is balanced: heat by the temperature at which it comes in.

    The unknowns are the entropies of the nodes and then their temperatures, which act as they are at the end of a
    step.
    """

    def __init__(self, kind: str, unknowns: NDArray[np.int32], points: Points, law: Law) -> None:
        super().__init__(kind, unknowns, points, law)
        self.half = unknowns.shape[1] // 2
        self.order[self.half :] = 0

    def at_points(self, s: Stencils) -> Array:
        return np.asarray(s.x1[:, self.half :] @ self.points.N.T)

    def residual(self, s: Stencils) -> Array:
        p, found = self.points, np.zeros_like(s.x1)
        found[:, : self.half] = -np.einsum("mq,mq,qk->mk", p.size, self.taken(s)[0] / self.at_points(s), p.N)
        return found

    def tangent(self, s: Stencils) -> Array:
        p, T = self.points, self.at_points(s)
        heat, slope = self.taken(s)
        found = np.zeros((*s.x1.shape, s.x1.shape[1]))
        by_temperature = -p.size * (slope / T - heat / T**2)
        found[:, : self.half, self.half :] = np.einsum("mq,qk,ql->mkl", by_temperature, p.N, p.N)
        return found


class EntropySupply(Term):
    """Entropy that is supplied to nodes at their temperature, per time; something else says how much.

    The unknowns of a node are its entropy, its temperature, and its supply of entropy per time.
    """

    kind = "supply"
    brings = "heat"

    def __init__(self, unknowns: NDArray[np.int32]) -> None:
        super().__init__()
        self.unknowns, self.order = unknowns, np.array([1, 0, 0], dtype=np.int32)

    def residual(self, s: Stencils) -> Array:
        found = np.zeros_like(s.x1)
        found[:, 0] = -s.x1[:, 2]
        return found

    def tangent(self, s: Stencils) -> Array:
        K = np.zeros((3, 3))
        K[0, 2] = -1.0
        return np.broadcast_to(K, (len(s.x1), 3, 3))

    def work(self, s: Stencils) -> Array:
        """Heat (n,) that was supplied over the step."""
        return np.asarray(s.step.h * s.x1[:, 1] * s.x1[:, 2])
