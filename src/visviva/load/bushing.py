"""Bushings: elastic and damped connections of two frames in six directions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.component.component import Component, settings
from visviva.component.momentum import NOWHERE
from visviva.component.point import Attachable, Attached, Frame
from visviva.component.values import Vector3
from visviva.model.form import Strain, dot
from visviva.model.law import quadratic, viscous

if TYPE_CHECKING:
    from visviva.model.model import Model


@dataclass(config=settings, eq=False, kw_only=True)
class Bushing(Component):
    """Linear springs and dampers in three directions and about three axes of a frame on `a`.

    Strains are ``d_i . p`` with the directors of `a` and the vector ``p`` from `a` to `b`, and the rotation
    measures ``(d_k^a . d_j^b - d_j^a . d_k^b) / 2``, the sine of the angle for a rotation about one axis.
    Each has its own energy ``stiffness/2 (e - e_initial)^2`` and is quadratic in the unknowns, so energy and
    momenta are conserved exactly at any deformation. As a sine, a rotation measure has its largest torque at
    90 degrees: a bushing is for moderate angles.

    Parameters
    ----------
    a, b : component or Frame
        What it connects; for a component, `at`, `axis` and `first` say where, in the initial configuration.
    at : array (3,)
        Place of both frames at the start (length); needed unless `a` and `b` are frames.
    axis, first : array (3,)
        What their third directors are along at the start, and the first ones close to; z, and chosen if not given.
    stiffness, damping : array (3,)
        Force per displacement and per velocity along the three directors of `a`.
    rotational_stiffness, rotational_damping : array (3,)
        Torque per angle and per angular velocity about them.

    Examples
    --------
    >>> import visviva as vv
    >>> ground = vv.Ground()
    >>> body = vv.RigidBody(mass=1.0, inertia=(1, 1, 1))
    >>> rubber = vv.Bushing(a=ground, b=body, at=(0, 0, 0), stiffness=(1e3, 1e3, 1e4), damping=(1, 1, 1),
    ...                     rotational_stiffness=(10, 10, 50))
    >>> system = vv.System([ground, body, rubber])
    """

    outside_axes = NOWHERE

    a: Attached
    b: Attached
    at: Vector3 | None = None
    axis: Vector3 = (0.0, 0.0, 1.0)
    first: Vector3 | None = None
    stiffness: Vector3 = (0.0, 0.0, 0.0)
    damping: Vector3 = (0.0, 0.0, 0.0)
    rotational_stiffness: Vector3 = (0.0, 0.0, 0.0)
    rotational_damping: Vector3 = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        for what in ("stiffness", "damping", "rotational_stiffness", "rotational_damping"):
            if np.any(getattr(self, what) < 0):
                raise InputError(f"{self.label}: {what} {getattr(self, what).tolist()} has a negative entry")
        A, B = self._frame(self.a), self._frame(self.b)
        if A.component is B.component:
            raise InputError(f"{self.label} connects {A.component.label} with itself")

    def _frame(self, side: Any) -> Frame:
        if isinstance(side, Frame):
            return side
        if not isinstance(side, Attachable):
            raise InputError(f"{self.label} connects components or frames, not {side!r}")
        if self.at is None:
            raise InputError(f"{self.label}: say where with at=(x, y, z), or give two frames")
        return side.frame_at(self.at, self.axis, self.first)

    def strains(self) -> list[Strain]:
        """Three displacements and three rotation measures of `b` in the directors of `a`."""
        A, B = self._frame(self.a), self._frame(self.b)
        p, d, e = B.position - A.position, A.directors, B.directors
        turns = [0.5 * (dot(d[k], e[j]) - dot(d[j], e[k])) for j, k in ((1, 2), (2, 0), (0, 1))]
        return [*(dot(direction, p) for direction in d), *turns]

    def contribute(self, model: Model) -> None:
        x, _ = model.initial
        stiffness = np.concatenate([self.stiffness, self.rotational_stiffness])
        damping = np.concatenate([self.damping, self.rotational_damping])
        for e, k, c in zip(self.strains(), stiffness, damping, strict=True):
            if k:
                model.potential(self, "bushing", e, quadratic(float(k), e.value(x)))
            if c:
                model.dissipate(self, "damper", e, viscous(float(c)))
