"""Random mechanisms, trees and loops: what holds for all of them whatever data, place, units and solver."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from reference.integrate import axis_rotation

import visviva as vv
from verification.measure import Array, fresh
from visviva.examples import crane, four_bar, triple_pendulum

KINDS = (
    "spherical",
    "revolute",
    "universal",
    "prismatic",
    "cylindrical",
    "planar",
    "rigid",
    "screw",
    "distance",
)
few = settings(max_examples=25, deadline=None, derandomize=True)


@dataclass(frozen=True)
class Mechanism:
    """A tree of bodies on joints, the first on the ground or free, with springs or distance rods as loops.

    `length` and `mass` scale all data: changes of units; `rotation` and `shift` move the whole.
    """

    seed: int
    kinds: tuple[str, ...]
    loops: int
    grounded: bool
    rotation: Array
    shift: Array
    length: float = 1.0
    mass: float = 1.0

    def place(self, x: Any) -> Array:
        return self.length * (self.rotation @ np.asarray(x) + self.shift)

    def components(self) -> list[Any]:
        rng = np.random.default_rng(self.seed)
        spin, drift = rng.normal(size=3), rng.normal(size=3) * (not self.grounded)
        ground = vv.Ground()
        start = np.zeros(3)
        bodies: list[Any] = []
        for _ in self.kinds:
            bodies.append(self._body(rng, start, spin, drift))
            start = start + 0.5 * rng.normal(size=3)
        joints: list[Any] = []
        for k, kind in enumerate(self.kinds):
            parent: Any = bodies[int(rng.integers(k))] if k else ground
            at, axis = rng.normal(size=3), rng.normal(size=3)
            if k == 0 and self.grounded:
                at = np.zeros(3)  # the initial motion turns about this point
                kind = "spherical"
            if k or self.grounded:
                joints.append(self._joint(kind, parent, bodies[k], at, axis))
        for _ in range(self.loops if len(bodies) > 1 else 0):
            joints.append(self._loop(rng, bodies))
        ends = rng.normal(size=(2, 3))
        stiff = {"stiffness": 20.0 * self.mass, "free_length": 0.7 * self.length}
        spring = vv.Spring(
            a=bodies[0].point(self.length * ends[0]), b=bodies[-1].point(self.length * ends[1]), **stiff
        )
        loads: list[Any] = [spring] if len(bodies) > 1 else []
        if self.grounded:
            loads.append(vv.Gravity(acceleration=self.length * (self.rotation @ [0, 0, -9.81])))
        return [ground, *bodies, *joints, *loads]

    def _body(self, rng: np.random.Generator, start: Array, spin: Array, drift: Array) -> vv.RigidBody:
        sides = rng.uniform(0.2, 1.5, 3)
        mass = 10 ** rng.uniform(-1, 1)
        J = mass / 12 * (np.sum(sides**2) - sides**2)
        R = axis_rotation(rng.normal(size=3), rng.uniform(0, 3))
        velocity = np.cross(spin, start) + drift
        return vv.RigidBody(
            mass=self.mass * mass,
            inertia=self.mass * self.length**2 * J,
            centre=self.length * 0.2 * rng.normal(size=3),
            position=self.place(start),
            rotation=self.rotation @ R,
            velocity=self.length * (self.rotation @ velocity),
            angular_velocity=self.rotation @ spin,
        )

    def _joint(self, kind: str, a: Any, b: Any, at: Array, axis: Array) -> Any:
        where = {"at": self.place(at)}
        if kind == "distance":
            return vv.Distance(a=a.point_at(self.place(at)), b=b.point_at(self.place(at + axis)))
        if kind == "spherical":
            return vv.Spherical(a=a, b=b, **where)
        first = self.rotation @ np.cross(axis, [0.3, -0.7, 0.2])
        where |= {"axis": self.rotation @ axis, "first": first}
        if kind == "screw":
            return vv.Screw(a=a, b=b, pitch=0.4 * self.length, **where)
        return getattr(vv, kind.capitalize())(a=a, b=b, **where)

    def _loop(self, rng: np.random.Generator, bodies: list[Any]) -> Any:
        i, j = rng.choice(len(bodies), 2, replace=False)
        ends = rng.normal(size=(2, 3))
        return vv.Distance(a=bodies[i].point(self.length * ends[0]), b=bodies[j].point(self.length * ends[1]))


@st.composite
def mechanisms(draw: Any) -> Mechanism:
    n = draw(st.integers(2, 6))
    kinds = tuple(draw(st.sampled_from(KINDS)) for _ in range(n))
    loops, grounded = draw(st.integers(0, 1)), draw(st.booleans())
    return Mechanism(draw(st.integers(0, 10**6)), kinds, loops, grounded, np.eye(3), np.zeros(3))


steps = st.sampled_from([0.002, 0.005, 0.01])


def run(mechanism: Mechanism, h: float, n: int = 20, **options: Any) -> tuple[vv.Result, Array]:
    """The result and the places of the bodies' origins in units of length, seen from the moved observer."""
    system = vv.System(mechanism.components(), vv.Newton(**options))
    result = vv.simulate(system, until=n * h, step=h)
    origins = [c.point().position.value(system.x) for c in system.components if isinstance(c, vv.RigidBody)]
    return result, (np.array(origins) / mechanism.length - mechanism.shift) @ mechanism.rotation


def close(a: Array, b: Array, tolerance: float) -> None:
    assert np.abs(a - b).max() <= tolerance * max(1.0, np.abs(a).max())


@few
@given(mechanisms(), steps)
def test_conservation(mechanism: Mechanism, h: float) -> None:
    result, _ = run(mechanism, h)
    names = ["energy", "constraints"]
    if not mechanism.grounded:
        names += [f"{kind}_{c}" for kind in ("momentum", "angular") for c in "xyz"]
    result.assert_conserved(*names, tolerance=1e-9)


@few
@given(mechanisms(), steps)
def test_solvers_agree(mechanism: Mechanism, h: float) -> None:
    """Null space or saddle point, kept or new tangents: the same steps up to the growth of round-off."""
    result, here = run(mechanism, h, tolerance=1e-16)
    for options in ({"null_space": False}, {"null_space": True}, {"keep_factor": 0.0}):
        other, there = run(mechanism, h, tolerance=1e-16, **options)
        assume(result.statistics.rejected == other.statistics.rejected == 0)  # halved steps are other steps
        close(here, there, 1e-9)


@few
@given(mechanisms(), steps, st.integers(0, 10**6))
def test_objectivity(mechanism: Mechanism, h: float, seed: int) -> None:
    """Turned and shifted as a whole, it moves turned and shifted."""
    rng = np.random.default_rng(seed)
    R, shift = axis_rotation(rng.normal(size=3), rng.uniform(0, 3)), rng.normal(size=3)
    result, here = run(mechanism, h, tolerance=1e-16)
    other, there = run(replace(mechanism, rotation=R, shift=shift), h, tolerance=1e-16)
    assume(result.statistics.rejected == other.statistics.rejected == 0)
    close(here, there, 1e-9)


@few
@given(mechanisms(), steps, st.sampled_from([1e-3, 1e3]), st.sampled_from([1e-3, 1.0, 1e3]))
def test_units(mechanism: Mechanism, h: float, length: float, mass: float) -> None:
    """Kilometres or millimetres, grams or tonnes: the same motion, so no tolerance in the code has a unit."""
    result, here = run(mechanism, h, tolerance=1e-16)
    other, there = run(replace(mechanism, length=length, mass=mass), h, tolerance=1e-16)
    assume(result.statistics.rejected == other.statistics.rejected == 0)
    close(here, there, 1e-9)
    other.assert_conserved("energy")
    defect = other.ledger["defect_position"].max()  # of directors, lengths, or squared lengths
    assert defect < 1e-10 * max(1.0, length, length**2)


@pytest.mark.parametrize("example", [crane, four_bar, triple_pendulum], ids=["crane", "four_bar", "triple"])
def test_full_newton_changes_nothing(example: Any) -> None:
    ends, h = [], 0.01
    for keep in (0.0, vv.Newton().keep_factor):
        components = example.study(step=h).system.components
        system = fresh(components, vv.Newton(keep_factor=keep, tolerance=1e-16))
        vv.simulate(system, until=1.0, step=h)
        ends.append(system.x[system.order == 2])
    close(ends[0], ends[1], 1e-9)
