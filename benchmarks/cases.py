"""The mechanisms that every code in the comparison runs: plain numpy data, independent of all of them.

Positions are those of the centres of mass; inertia tensors are about them, in the body's own axes; rotation
matrices map body axes to global ones; joints are given where they are at the start, in global axes.
All quantities are in SI units and gravity points down the third axis.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from enum import Enum

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
GROUND = -1
GRAVITY = 9.81
ROD_RADIUS = 0.05


class Kind(Enum):
    """The joints in use; the axis is fixed to the first body, the position to both."""

    SPHERICAL = "spherical"
    REVOLUTE = "revolute"
    PRISMATIC = "prismatic"
    POINT_ON_LINE = "point on line"
    DISTANCE = "distance"


@dataclass(frozen=True)
class Joint:
    """A joint between bodies `first` and `second`; `end` is the second body's point of a distance joint."""

    kind: Kind
    first: int
    second: int
    position: Array
    axis: Array = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    end: Array | None = None


@dataclass(frozen=True)
class State:
    """Positions (n, 3), rotations (n, 3, 3), velocities (n, 3) and global angular velocities (n, 3)."""

    positions: Array
    rotations: Array
    velocities: Array
    angular_velocities: Array


@dataclass(frozen=True)
class Case:
    """Masses (n,), inertia tensors (n, 3, 3; all zero marks a point mass), the start and the joints.

    `steps` of size `step` are what a measurement takes; `turns_freely` says that the forces and the ground's
    reactions have no moment about the global third axis, so that this angular momentum is constant.
    """

    name: str
    masses: Array
    inertias: Array
    start: State
    joints: tuple[Joint, ...]
    step: float
    steps: int
    turns_freely: bool

    @property
    def is_point(self) -> NDArray[np.bool_]:
        return np.asarray(~self.inertias.any(axis=(1, 2)))


def rod_inertia(mass: float, length: float, radius: float = ROD_RADIUS) -> Array:
    """Inertia tensor of a solid cylinder along its first axis."""
    transverse = mass * (length**2 / 12 + radius**2 / 4)
    return np.diag([mass * radius**2 / 2, transverse, transverse])


def rod_frame(direction: Array, side: Array) -> Array:
    """Rotation matrix with its first axis along the rod and its third one in the plane of rod and `side`."""
    first = direction / np.linalg.norm(direction)
    second = np.cross(side, first)
    second /= np.linalg.norm(second)
    return np.column_stack([first, second, np.cross(first, second)])


def rods(ends: Array, angular_velocities: Array, side: Array) -> tuple[Array, Array, State]:
    """Rods of unit mass between consecutive `ends` (n + 1, 3), the first of which is at rest."""
    links = np.diff(ends, axis=0)
    end_velocities = np.vstack([np.zeros(3), np.cumsum(np.cross(angular_velocities, links), axis=0)])
    frames = np.stack([rod_frame(link, side) for link in links])
    inertias = np.stack([rod_inertia(1.0, float(np.linalg.norm(link))) for link in links])
    centres = (ends[:-1] + ends[1:]) / 2
    velocities = (end_velocities[:-1] + end_velocities[1:]) / 2
    return np.ones(len(links)), inertias, State(centres, frames, velocities, angular_velocities)


def zigzag_directions(n: int) -> Array:
    """Unit vectors (n, 3): azimuth 30, -30 in turn; 30, 45, 60 degrees below the horizontal in turn."""
    link = np.arange(n)
    azimuth = np.radians(30.0) * (-1.0) ** link
    descent = np.radians(30.0 + 15.0 * (link % 3))
    return np.column_stack(
        [np.cos(descent) * np.cos(azimuth), np.cos(descent) * np.sin(azimuth), -np.sin(descent)]
    )


def chain_axes(directions: Array) -> Array:
    """Hinge axes (n, 3): the vertical at the ground, then the normal of the plane of both links."""
    axes = np.vstack([[0.0, 0.0, 1.0], np.cross(directions[:-1], directions[1:])])
    return np.asarray(axes / np.linalg.norm(axes, axis=1, keepdims=True))


def chain_spins(axes: Array) -> Array:
    """Angular velocities (n, 3) of a chain that turns about the vertical while every hinge moves at 1 rad/s.

    The hinges' signs change in blocks of six, the period of the zig-zag, so that the links' own motion sums
    to nothing over four blocks. The turning rate falls with the root of n: the energies stay comparable.
    """
    n = len(axes)
    signs = np.array([1.0, -1.0, -1.0, 1.0])[np.arange(n - 1) // 6 % 4]
    rates = np.concatenate([[np.sqrt(GRAVITY / n)], signs])
    return np.cumsum(rates[:, None] * axes, axis=0)


def chain(name: str, kind: Kind, n: int) -> Case:
    """A zig-zag chain of n unit rods, hooked to the origin; both kinds of joints start in the same motion."""
    directions = zigzag_directions(n)
    ends = np.vstack([np.zeros(3), np.cumsum(directions, axis=0)])
    axes = chain_axes(directions)
    masses, inertias, start = rods(ends, chain_spins(axes), np.array([0.0, 0.0, 1.0]))
    joints = tuple(Joint(kind, i - 1, i, ends[i], axes[i]) for i in range(n))
    steps = max(100, min(5000, 50_000 // n))
    return Case(name, masses, inertias, start, joints, 1e-3, steps, turns_freely=True)


def triple_pendulum(name: str) -> Case:
    """Three unit rods on ball joints; the whole turns about the vertical and each rod about its own axis."""
    directions = np.array([[1.0, 0.0, 0.0], [0.0, 0.8, -0.6], [0.6, 0.0, -0.8]])
    ends = np.vstack([np.zeros(3), np.cumsum(directions, axis=0)])
    spin = np.array([0.0, 0.0, 2.0]) + np.array([[10.0], [-5.0], [20.0]]) * directions
    masses, inertias, start = rods(ends, spin, np.array([0.1, 0.2, 1.0]))
    joints = tuple(Joint(Kind.SPHERICAL, i - 1, i, ends[i]) for i in range(3))
    return Case(name, masses, inertias, start, joints, 1e-3, 5000, turns_freely=True)


def four_bar_joint(crank: Array, coupler: float, rocker: float, pivot: Array) -> Array:
    """The upper point at the distances `coupler` from the crank's end and `rocker` from the pivot."""
    line = pivot - crank
    distance = np.linalg.norm(line)
    along = (coupler**2 - rocker**2 + distance**2) / (2 * distance)
    normal = np.array([-line[2], 0.0, line[0]]) / distance
    return np.asarray(crank + along * line / distance + np.sqrt(coupler**2 - along**2) * normal)


def four_bar(name: str) -> Case:
    """Crank 0.5, coupler 1.8, rocker 1.5, ground 2, slender rods of unit mass in the plane of axes 1 and 3.

    The crank stands upright and turns at 5 rad/s. The loop closes by a point on a line, so that no constraint
    is redundant: 18 coordinates, 17 constraints.
    """
    pivot, crank = np.array([2.0, 0.0, 0.0]), np.array([0.0, 0.0, 0.5])
    ends = np.stack([np.zeros(3), crank, four_bar_joint(crank, 1.8, 1.5, pivot), pivot])
    axis = np.array([0.0, -1.0, 0.0])  # a positive rate turns axis 1 towards axis 3
    turned = np.cross(axis, np.diff(ends, axis=0))[:, [0, 2]]
    coupler, rocker = np.linalg.solve(turned[1:].T, -5.0 * turned[0])
    rates = np.outer([5.0, coupler, rocker], axis)
    masses, _, start = rods(ends, rates, axis)
    lengths = np.linalg.norm(np.diff(ends, axis=0), axis=1)
    inertias = np.stack([rod_inertia(1.0, float(length), radius=0.0) for length in lengths])
    inertias[:, 0, 0] = 1e-3  # a rod in plane motion never turns about itself
    joints = (
        *(Joint(Kind.REVOLUTE, i - 1, i, ends[i], axis) for i in range(3)),
        Joint(Kind.POINT_ON_LINE, GROUND, 2, pivot, axis),
    )
    return Case(name, masses, inertias, start, joints, 1e-3, 5000, turns_freely=False)


def from_euler_tensor(*values: float) -> Array:
    """Inertia tensor from principal values of the Euler tensor: about each axis the sum of the other two."""
    return np.diag(sum(values) - np.array(values))


def crane(name: str) -> Case:
    """The rotary crane of Hesch & Betsch (2012) with a rope of constant length 1.2 from the winch's centre.

    Girder along axis 1, winch axis along axis 2; the whole turns at 1.32 rad/s about the vertical.
    """
    at = np.array([1.5, 0.0, 0.0])
    load = at - [0.0, 0.0, 1.2]
    inertias = np.stack(
        [
            from_euler_tensor(208.3, 8.3, 8.3),
            from_euler_tensor(1.0417, 1.0417, 1.0417),
            from_euler_tensor(0.01, 0.25, 0.01),
            np.zeros((3, 3)),
        ]
    )
    positions = np.stack([np.zeros(3), at, at, load])
    spin = np.tile([0.0, 0.0, 1.32], (4, 1))
    velocities = np.cross(spin, positions)
    spin[3] = 0.0  # the load is a point
    start = State(positions, np.tile(np.eye(3), (4, 1, 1)), velocities, spin)
    joints = (
        Joint(Kind.REVOLUTE, GROUND, 0, np.zeros(3), np.array([0.0, 0.0, 1.0])),
        Joint(Kind.PRISMATIC, 0, 1, at, np.array([1.0, 0.0, 0.0])),
        Joint(Kind.REVOLUTE, 1, 2, at, np.array([0.0, 1.0, 0.0])),
        Joint(Kind.DISTANCE, 2, 3, at, end=load),
    )
    masses = np.array([100.0, 50.0, 3.0, 10.0])
    return Case(name, masses, inertias, start, joints, 1e-3, 5000, turns_freely=True)


BUILDERS: dict[str, Callable[[str, int], Case]] = {
    "chain-ball": lambda name, n: chain(name, Kind.SPHERICAL, n),
    "chain-revolute": lambda name, n: chain(name, Kind.REVOLUTE, n),
    "four-bar": lambda name, n: four_bar(name),
    "crane": lambda name, n: crane(name),
    "triple-pendulum": lambda name, n: triple_pendulum(name),
}
SIZES: dict[str, Sequence[int]] = {
    "chain-ball": (10, 100, 1000),
    "chain-revolute": (10, 100, 1000),
    "four-bar": (3,),
    "crane": (4,),
    "triple-pendulum": (3,),
}


def build(name: str, n: int) -> Case:
    """The case of that name; n counts the links of a chain and is ignored by the others.

    Examples
    --------
    >>> build("chain-ball", 10).masses.sum()
    10.0
    """
    return BUILDERS[name](name, n)
