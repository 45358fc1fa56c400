"""What a study shows: which points and trails are drawn, and the field that colours them."""

from __future__ import annotations

from visviva.measure.measures import Position
from visviva.model.form import Vector
from visviva.results.drawing import Drawing
from visviva.study.study import Probe, Study


def draw(study: Study) -> Drawing:
    """What is drawn of a study: its system, and its trails where no component has their name."""
    places = {name: place_of(study.probes[name]) for name in study.trails if name in study.probes}
    spots = {name: place for name, place in places.items() if place is not None}
    return Drawing(study.system, spots, study.fields)


def place_of(probe: Probe) -> Vector | None:
    """The point that a probe records, if it does."""
    if isinstance(probe, Position) and probe.direction is None:
        return probe.place
    return probe if isinstance(probe, Vector) else None


def trail_names(study: Study, drawing: Drawing) -> list[str]:
    """Which surfaces leave a trail: those named in the study."""
    return [s.name for s in drawing.surfaces if s.name in study.trails]


def shown_field(study: Study, drawing: Drawing) -> str:
    """The field by which pictures are coloured: the first of the study that there is."""
    return next((name for name in study.fields if name in drawing.stored), "")
