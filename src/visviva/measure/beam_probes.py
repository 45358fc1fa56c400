"""Probes of beams."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.body.beam import Beam
from visviva.component.component import settings
from visviva.component.values import Number, Vector3
from visviva.measure.measures import Reading

if TYPE_CHECKING:
    from visviva.system.system import System

Array = NDArray[np.float64]


@dataclass(config=settings, frozen=True, kw_only=True)
class Resultants(Reading):
    """Probe: forces and moments (6,) in a section of a beam, at an arc length from the start of its line or a position.

    Shear forces along the directors d1 and d2, normal force, bending moments about d1 and d2, torsion moment; positive
    as the part beyond acts on the part before. They are polynomials through the values at the points of a cell,
    constant for two nodes, and jump between cells by the error of the mesh.

    Parameters
    ----------
    beam : Beam
    at : float or (3,)
        Arc length, or position, in the reference: positions alone of lines that are closed or branch. Where cells meet
        it is the one of them that comes first.
    """

    beam: Beam
    at: Number | Vector3

    @property
    def quantities(self) -> tuple[str, ...]:
        """Of its components."""
        return 3 * ("force",) + 3 * ("moment",)

    @property
    def parts(self) -> tuple[str, ...]:
        return ("shear_1", "shear_2", "normal", "bending_1", "bending_2", "torsion")

    def __post_init__(self) -> None:
        self._place()

    def _place(self) -> tuple[int, float]:
        line, label = self.beam.line, self.beam.label
        return (
            line.cell_at(self.at, label)
            if np.ndim(self.at) == 0
            else line.cell_near(np.asarray(self.at), label)
        )

    def __call__(self, system: System) -> Array:
        cell, share = self._place()
        values = self.beam.resultants(system.x)[cell]
        places = (np.polynomial.legendre.leggauss(len(values))[0] + 1) / 2
        weights = [
            np.prod((share - np.delete(places, k)) / (s - np.delete(places, k))) for k, s in enumerate(places)
        ]
        return np.asarray(weights @ values)
