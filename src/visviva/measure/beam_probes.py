"""Probes of beams."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.body.beam import Beam
from visviva.component.component import settings
from visviva.component.values import Number
from visviva.measure.measures import Reading

if TYPE_CHECKING:
    from visviva.system.system import System

Array = NDArray[np.float64]


@dataclass(config=settings, frozen=True, kw_only=True)
class Resultants(Reading):
    """Probe: forces and moments (6,) in a section of a beam, at an arc length from the start of its line.

    Shear forces along the directors d1 and d2, normal force, bending moments about d1 and d2, torsion moment; positive
    as the part beyond acts on the part before. They are polynomials through the values at the points of a cell,
    constant for two nodes, and jump between cells by the error of the mesh.

    Parameters
    ----------
    beam : Beam
    at : float
        Arc length in the reference.
    """

    beam: Beam
    at: Number

    @property
    def quantities(self) -> tuple[str, ...]:
        """Of its components."""
        return 3 * ("force",) + 3 * ("moment",)

    @property
    def parts(self) -> tuple[str, ...]:
        return ("shear_1", "shear_2", "normal", "bending_1", "bending_2", "torsion")

    def __post_init__(self) -> None:
        self.beam.at(self.at)

    def __call__(self, system: System) -> Array:
        cell, share = self.beam.line.cell_at(self.at, self.beam.label)
        values = self.beam.resultants(system.x)[cell]
        places = (np.polynomial.legendre.leggauss(len(values))[0] + 1) / 2
        weights = [
            np.prod((share - np.delete(places, k)) / (s - np.delete(places, k))) for k, s in enumerate(places)
        ]
        return np.asarray(weights @ values)
