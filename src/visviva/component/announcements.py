"""Announcements that components make about each other before any makes its fields, see `Model.announce`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from visviva.component.component import Component
from visviva.component.meshed import Meshed
from visviva.mesh.faces import Faces
from visviva.mesh.periodic import numbering

if TYPE_CHECKING:
    from visviva.model.model import Model


@dataclass(frozen=True, eq=False)
class Holding:
    """Nodes of a body that do not move freely: supports and rigid couplings announce it about the body.

    Attributes
    ----------
    by : Component
        What holds them.
    nodes : array of int, (k,)
    directions : array of bool, (3,), or None
        Components of their positions that stay as they are; None where that is not so simple.
    """

    by: Component
    nodes: NDArray[np.int64]
    directions: NDArray[np.bool_] | None


@dataclass(frozen=True, eq=False)
class Facing:
    """Faces of a body, or the name of their set, that something acts on as if they bounded it."""

    by: Component
    faces: Faces | str


@dataclass(frozen=True, eq=False)
class Repeating:
    """Pairs of sets of faces of a body that are taken for the same."""

    pairs: Sequence[tuple[str, str]]


@dataclass(frozen=True, eq=False)
class Given:
    """Values that a field of a body is held at from the start, of whatever size they are."""

    values: NDArray[np.float64]


def shared_numbers(model: Model, body: Meshed) -> NDArray[np.int64]:
    """Numbers (n,) of the nodes of a body in fields beside positions: those that stand for each other have one."""
    pairs = [pair for sides in model.announced(body, Repeating) for pair in sides.pairs]
    return numbering(body.grid, pairs, body.label)[0]


@dataclass(frozen=True, eq=False)
class Clamping:
    """Nodes (k,) of a body that neither move nor turn."""

    nodes: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Guiding:
    """Nodes (k,) of a body whose directors follow others, and are as long as these make them."""

    nodes: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Conducting:
    """Announcement of a conductor of heat between two bodies, made about the first.

    Attributes
    ----------
    bodies : (Component, Component)
    """

    bodies: tuple[Component, Component]

    def joins(self, *others: Component | None) -> bool:
        """True if it is between these two bodies."""
        return {id(body) for body in self.bodies} == {id(body) for body in others}


@dataclass(frozen=True, eq=False)
class Asking:
    """Announcement about a joint that its `coordinate`, 'angle' or 'stroke', is to be one of the system."""

    coordinate: str


class Straining(Component):
    """Announcement of strains given to a beam, as by heat, made about the beam."""

    def strain(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Shear along d1 and d2, extension, curvatures, twist (6,) at the unknowns `x` of the system."""
        raise NotImplementedError


@runtime_checkable
class Unbooked(Protocol):
    """A component that may change energies by what is in no account of the ledger."""

    @property
    def unbooked(self) -> str:
        """Why it does, in words behind its label; empty if it does not."""
        ...


class Wetting(Component):
    """Announcement of the immersion of a body in a fluid, made about the body.

    Attributes
    ----------
    fluid : Component
    """

    fluid: Component

    @property
    def carried(self) -> Component:
        """The body."""
        raise NotImplementedError

    @property
    def is_thin(self) -> bool:
        """Whether the body is thinner than the cells of the fluid around it."""
        return False

    @property
    def displaced_fluid(self) -> list[tuple[NDArray[np.int32], NDArray[np.float64]]]:
        """Fluid in the body's place: unknowns (m, k, d) of vectors, and negative masses (m, k, k) between them."""
        return []

    def announce(self, model: Model) -> None:
        model.announce(self.carried, self)


@dataclass(frozen=True, eq=False)
class SharedOut:
    """A term of the core that has some of the elements of its component: other processes have the rest."""

    term: Any
