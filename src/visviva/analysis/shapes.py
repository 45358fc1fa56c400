"""Shapes of a system that an analysis finds, with what moves most in them, and pictures."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.arguments import positive
from visviva.base.errors import InputError
from visviva.base.world import by_first
from visviva.system.memory import refuse_recomposed

if TYPE_CHECKING:
    from visviva.component.component import Component
    from visviva.output.pictures import Camera
    from visviva.system.system import System


@dataclass
class Shapes:
    """Directions about one configuration of a system.

    Attributes
    ----------
    system : System
    shapes : array (k, unknowns)
        In the unknowns of the system.
    """

    system: System
    shapes: NDArray[Any]

    def __post_init__(self) -> None:
        self._composition = self.system.composition

    def _refuse_reset(self) -> None:
        refuse_recomposed(type(self).__name__, self.system, self._composition)

    def shape(self, component: Component, name: str) -> NDArray[Any]:
        """Shapes (k, size) in one field of a component."""
        self._refuse_reset()
        f = self.system.field(component, name)
        return self.shapes[:, f.start : f.start + f.size]

    def leader(self, k: int) -> str:
        """The component that moves most in shape `k`, relative to the scales of its unknowns."""
        self._refuse_reset()
        scale = self.system.scale
        moves = np.abs(self.shapes[k]) / np.where(scale > 0, scale, np.inf)
        return self.system.describe(int(np.argmax(moves)))[0]

    def picture(
        self, png: str | Path, k: int = 0, *, amplitude: float = 0.1, camera: Camera | None = None
    ) -> None:
        """Draw the present configuration, moved along shape `k`, into a PNG file.

        Parameters
        ----------
        png : str or Path
        k : int
            Number of the shape, from 0.
        amplitude : float
            How far what moves most is drawn from where it is, relative to the size of all that is drawn.
        camera : Camera
            As for `visviva.output.picture.picture`.

        Raises
        ------
        InputError
            If there is no such shape, or it moves nothing that is drawn.
        """
        from visviva.output.picture import picture
        from visviva.results.drawing import Drawing

        self._refuse_reset()
        positive("picture", "amplitude", amplitude)
        if not 0 <= k < len(self.shapes):
            raise InputError(f"picture: there is no shape {k}; there are {len(self.shapes)}, counted from 0")
        drawing, x = Drawing(self.system), self.system.x
        here = drawing.points(x)
        little = 1e-6 / (float(np.abs(self.shapes[k]).max()) or 1.0)
        near = drawing.points(x + little * self.shapes[k].real)
        apart = max(float(np.linalg.norm(b - a, axis=-1).max()) for a, b in zip(here, near, strict=True))
        size = float(np.linalg.norm(np.ptp(np.concatenate(here), axis=0)))
        if not apart * size:
            raise InputError(f"picture: shape {k} moves nothing that is drawn; look at the shapes themselves")
        far = amplitude * size / apart
        moved = [a + far * (b - a) for a, b in zip(here, near, strict=True)]
        by_first(f"draw {png}", lambda: picture(drawing.surfaces, png, points=moved, camera=camera))
