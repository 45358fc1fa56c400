"""Sections of shells whose directors stretch: materials in space across the thickness, and mass."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, FiniteFloat
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.body.section import Density, Length, Section
from visviva.body.shell_section import CONFIG, Layer, ShellInertia
from visviva.material.material import Material

Array = NDArray[np.float64]
Count = Annotated[int, Field(ge=1, le=9)]


class Through(NamedTuple):
    """Quadrature points across a section, from below: one for each row.

    Attributes
    ----------
    heights, weights : array, (k,)
        Above the mesh; the weights are lengths.
    layers : tuple of SolidLayer
        That the points lie in.
    """

    heights: Array
    weights: Array
    layers: tuple[SolidLayer, ...]


@dataclass(frozen=True, config=CONFIG, kw_only=True)
class SolidLayer(Layer):
    """A layer of one material in space, whose directions are those of the section: 1 and 2 along it, 3 across.

    Parameters
    ----------
    material : Material
        Any that is frame-indifferent.
    thickness : float
    density : float
        Mass per volume.
    angle : float
        From direction 1 of the shell to that of the material, about the director, in degrees.
    points : int
        Of Gauss's quadrature across the layer.
    """

    material: Material
    thickness: Length
    density: Density = 0.0
    angle: FiniteFloat = 0.0
    points: Count = 2

    def __post_init__(self) -> None:
        if self.material.small:
            raise InputError(
                f"SolidLayer: {type(self.material).__name__} is for small rotations, and shells turn; take "
                "SaintVenantKirchhoff with the same constants"
            )


class SolidSectionBase(Section):
    """Interface of the section of a shell whose directors stretch."""

    layers: tuple[SolidLayer, ...]
    offset: FiniteFloat

    @property
    def thickness_of_all(self) -> float:
        """Of all layers together."""
        return sum(layer.thickness for layer in self.layers)

    @property
    def heights(self) -> tuple[float, float]:
        """Of the lower and the upper face."""
        half = self.thickness_of_all / 2
        return self.offset - half, self.offset + half

    def inertia(self) -> ShellInertia:
        """Mass per area and its moments."""
        total, low = np.zeros(3), self.heights[0]
        for layer in self.layers:
            top = low + layer.thickness
            total += layer.density * np.array([top - low, (top**2 - low**2) / 2, (top**3 - low**3) / 3])
            low = top
        return ShellInertia(*total.tolist())

    def through(self) -> Through:
        """Its quadrature points."""
        heights, weights, layers, low = [], [], [], self.heights[0]
        for layer in self.layers:
            xi, w = np.polynomial.legendre.leggauss(layer.points)
            heights += (low + 0.5 * layer.thickness * (1 + xi)).tolist()
            weights += (0.5 * layer.thickness * w).tolist()
            layers += [layer] * layer.points
            low += layer.thickness
        return Through(np.array(heights), np.array(weights), tuple(layers))


@dataclass(frozen=True, config=CONFIG, kw_only=True)
class SolidSection(SolidSectionBase):
    """One material in space, with its full energy across the thickness.

    Parameters
    ----------
    material : Material
        Any that is frame-indifferent; its directions are 1 and 2 of the shell, and 3 across it.
    thickness : float
    density : float
        Mass per volume.
    offset : float
        Height of the middle above the mesh.
    points : int
        Of Gauss's quadrature across the thickness.

    Examples
    --------
    >>> import visviva as vv
    >>> rubber = vv.SolidSection(material=vv.NeoHooke(shear=1.0, bulk=1e4, isochoric=True), thickness=0.02)
    >>> rubber.heights
    (-0.01, 0.01)
    """

    material: Material
    thickness: Length
    density: Density = 0.0
    offset: FiniteFloat = 0.0
    points: Count = 2

    def __post_init__(self) -> None:
        _ = self.layers  # refuses the material

    @property
    def layers(self) -> tuple[SolidLayer, ...]:  # type: ignore[override]
        return (
            SolidLayer(
                material=self.material, thickness=self.thickness, density=self.density, points=self.points
            ),
        )


@dataclass(frozen=True, config=CONFIG, kw_only=True)
class SolidLaminate(SolidSectionBase):
    """Layers of materials in space from the lower to the upper face.

    Parameters
    ----------
    layers : sequence of SolidLayer
    offset : float
        Height of the middle above the mesh.

    Examples
    --------
    >>> import visviva as vv
    >>> skin = vv.SolidLayer(material=vv.NeoHooke(young=1e3, poisson=0.3), thickness=0.1)
    >>> core = vv.SolidLayer(material=vv.NeoHooke(young=1.0, poisson=0.3), thickness=0.8)
    >>> vv.SolidLaminate(layers=(skin, core, skin)).heights
    (-0.5, 0.5)
    """

    layers: tuple[SolidLayer, ...]
    offset: FiniteFloat = 0.0

    def __post_init__(self) -> None:
        if not self.layers:
            raise InputError("SolidLaminate: it needs a layer at least")
