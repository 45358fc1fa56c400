"""Energy, angular momentum and constraint defects of a state, evaluated here for all codes alike.

`python audit.py` checks that every case starts consistently.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from cases import GRAVITY, GROUND, SIZES, Array, Case, Joint, Kind, State, build


def kinetic(case: Case, state: State) -> float:
    """Kinetic energy in joules."""
    local = np.einsum("nji,nj->ni", state.rotations, state.angular_velocities)
    turning = np.einsum("ni,nij,nj->", local, case.inertias, local)
    return float(0.5 * (case.masses @ (state.velocities**2).sum(axis=1) + turning))


def energy(case: Case, state: State) -> float:
    """Kinetic and gravitational energy in joules; the latter is zero at height zero."""
    return kinetic(case, state) + float(GRAVITY * case.masses @ state.positions[:, 2])


def vertical_momentum(case: Case, state: State) -> float:
    """Angular momentum about the global third axis."""
    orbital = np.cross(state.positions, state.velocities)[:, 2] @ case.masses
    local = np.einsum("nji,nj->ni", state.rotations, state.angular_velocities)
    spin = np.einsum("nij,njk,nk->ni", state.rotations, case.inertias, local)[:, 2].sum()
    return float(orbital + spin)


class Body:
    """One body of a state, or the ground, with the points and directions that were attached at the start."""

    def __init__(self, case: Case, state: State, index: int) -> None:
        if index == GROUND:
            self.turn, self.centre, self.start = np.eye(3), np.zeros(3), np.zeros(3)
            self.velocity, self.spin = np.zeros(3), np.zeros(3)
            return
        self.turn = state.rotations[index] @ case.start.rotations[index].T
        self.centre, self.start = state.positions[index], case.start.positions[index]
        self.velocity, self.spin = state.velocities[index], state.angular_velocities[index]

    def point(self, initial: Array) -> tuple[Array, Array]:
        """Position and velocity of the point that was at `initial`."""
        arm = self.turn @ (initial - self.start)
        return self.centre + arm, self.velocity + np.cross(self.spin, arm)

    def direction(self, initial: Array) -> tuple[Array, Array]:
        """Direction that was `initial`, and its rate."""
        now = self.turn @ initial
        return now, np.cross(self.spin, now)


def normals(axis: Array) -> Array:
    """Two unit vectors normal to each other and to the axis."""
    return np.asarray(np.linalg.svd(axis[None, :])[2][1:])


def gap(a: Body, b: Body, joint: Joint) -> tuple[Array, Array]:
    """Relative position and velocity of the bodies' points."""
    pa, va = a.point(joint.position)
    pb, vb = b.point(joint.position if joint.end is None else joint.end)
    return pb - pa, vb - va


def slide(a: Body, b: Body, joint: Joint) -> tuple[Array, Array]:
    """Motion of the second body's point off the first one's axis."""
    across = [a.direction(normal) for normal in normals(joint.axis)]
    apart, rate = gap(a, b, joint)
    return np.array([d @ apart for d, _ in across]), np.array([d @ rate + r @ apart for d, r in across])


def tilt(a: Body, b: Body, joint: Joint) -> tuple[Array, Array]:
    """Inclination between the two bodies' axes."""
    across = [a.direction(normal) for normal in normals(joint.axis)]
    axis, turning = b.direction(joint.axis)
    return np.array([d @ axis for d, _ in across]), np.array([d @ turning + r @ axis for d, r in across])


def twist(a: Body, b: Body, joint: Joint) -> tuple[Array, Array]:
    """Rotation about the axis."""
    one, other = normals(joint.axis)
    (da, ra), (db, rb) = a.direction(one), b.direction(other)
    return np.array([da @ db]), np.array([ra @ db + da @ rb])


def stretch(a: Body, b: Body, joint: Joint) -> tuple[Array, Array]:
    """Change of the distance between the bodies' points."""
    assert joint.end is not None
    length = np.linalg.norm(joint.end - joint.position)
    apart, rate = gap(a, b, joint)
    return np.array([np.linalg.norm(apart) - length]), np.array([apart @ rate / length])


Constraint = Callable[[Body, Body, Joint], tuple[Array, Array]]
CONSTRAINTS: dict[Kind, tuple[Constraint, ...]] = {
    Kind.SPHERICAL: (gap,),
    Kind.REVOLUTE: (gap, tilt),
    Kind.PRISMATIC: (slide, tilt, twist),
    Kind.POINT_ON_LINE: (slide,),
    Kind.DISTANCE: (stretch,),
}


def joint_defects(case: Case, state: State, joint: Joint) -> tuple[float, float]:
    """Greatest defect of the joint's constraints at position and at velocity level."""
    a, b = Body(case, state, joint.first), Body(case, state, joint.second)
    parts = [constraint(a, b, joint) for constraint in CONSTRAINTS[joint.kind]]
    return max(float(np.abs(p).max()) for p, _ in parts), max(float(np.abs(v).max()) for _, v in parts)


def defects(case: Case, state: State) -> tuple[float, float]:
    """Greatest constraint defect at position and at velocity level."""
    pairs = [joint_defects(case, state, joint) for joint in case.joints]
    return max(p for p, _ in pairs), max(v for _, v in pairs)


def main() -> None:
    """Print energies and defects of every case at the start."""
    for name, sizes in SIZES.items():
        for n in sizes:
            case = build(name, n)
            frames = np.einsum("nji,njk->nik", case.start.rotations, case.start.rotations) - np.eye(3)
            position, velocity = defects(case, case.start)
            print(
                f"{name:16s} {n:5d}  T {kinetic(case, case.start):.10g}  E {energy(case, case.start):.10g}  "
                f"Lz {vertical_momentum(case, case.start):.10g}  position defect {position:.1e}  "
                f"velocity defect {velocity:.1e}  frames {np.abs(frames).max():.1e}"
            )


if __name__ == "__main__":
    main()
