"""Drawn points of a study."""

from __future__ import annotations

from visviva.measure.measures import Position
from visviva.model.form import Vector
from visviva.results.drawing import Drawing
from visviva.study.study import Probe, Study


def draw(study: Study) -> Drawing:
    """Drawn components of a study: its system, and its trails where no component has their name.

    Raises
    ------
    InputError
        For fields that the system has not, or that pictures cannot show.
    """
    places = {name: place_of(study.probes[name]) for name in study.trails if name in study.probes}
    spots = {name: place for name, place in places.items() if place is not None}
    drawing = Drawing(study.system, spots, study.stored)
    study.pictures.refuse_unshown(drawing.stored)
    return drawing


def place_of(probe: Probe) -> Vector | None:
    """The point that a probe records, if it does."""
    if isinstance(probe, Position) and probe.direction is None:
        return probe.place
    return probe if isinstance(probe, Vector) else None
