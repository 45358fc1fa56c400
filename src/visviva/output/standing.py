"""A stored motion as pictures show it: what is up stands up, and displacements may be magnified."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from visviva.output.pictures import Camera, refuse_camera
from visviva.output.surface import Surface
from visviva.output.trajectory import Trajectory

Array = NDArray[np.float64]
FLAT = 1e-3
"""Part of its size up to which a model is flat: it is seen from above, and what is up in it needs no turn."""


class Standing(Trajectory):
    """A trajectory whose third axis is what labels say is up.

    Parameters
    ----------
    path
        A ``trajectory.vtkhdf``.
    deform
        Factor of displacements, of what has some.
    """

    def __init__(self, path: str | Path, deform: float = 1.0) -> None:
        super().__init__(path)
        self._deform = deform if "displacement" in self.fields else 1.0
        self._turn = np.eye(3)
        up = self.labels.up
        if up is not None and not is_flat(self.cloud(2)):
            self._turn = turn_to_up(np.array(up))
        self.surfaces = tuple(self._turned(surface) for surface in self.surfaces)

    def _turned(self, surface: Surface) -> Surface:
        return Surface(surface.name, self.turned(surface.points), list(surface.cells), surface.types)

    def points(self, step: int) -> list[Array]:
        points = super().points(step)
        if self._deform != 1.0:
            moved = self.field("displacement", step)
            more = (np.nan_to_num(u) * (self._deform - 1.0) for u in moved)
            points = [p + u for p, u in zip(points, more, strict=True)]
        return [self.turned(p) for p in points]

    def turned(self, vectors: Array) -> Array:
        """Vectors (..., 3) of the model as they stand in pictures."""
        turn: Array = getattr(self, "_turn", np.eye(3))
        return vectors @ turn.T

    def camera(self, camera: Camera | str | None) -> Camera | str | None:
        """A camera that is given in the coordinates of the model, or by its name.

        Raises
        ------
        InputError
            If there is no such name, or it sees nothing.
        """
        refuse_camera(camera)
        if camera is None or isinstance(camera, str):
            return camera
        eye, target, up = (tuple(self._turn @ np.asarray(v, float)) for v in camera)
        return eye, target, up


def is_flat(cloud: Array) -> bool:
    """Whether points (n, 3) lie in a plane across the third axis."""
    size = np.ptp(cloud, axis=0)
    return bool(size[2] <= FLAT * np.linalg.norm(size))


def turn_to_up(up: Array) -> Array:
    """The least rotation (3, 3) that takes a direction to the third axis.

    Examples
    --------
    >>> turn_to_up(np.array([0.0, 2.0, 0.0])).round(9).tolist()
    [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]
    """
    up = up / np.linalg.norm(up)
    axis, cosine = np.cross(up, (0.0, 0.0, 1.0)), float(up[2])
    if cosine < -1 + 1e-9:
        return np.diag([1.0, -1.0, -1.0])
    K = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    turned: Array = np.eye(3) + K + K @ K / (1 + cosine)
    return np.where(abs(turned) < 1e-15, 0.0, turned)
