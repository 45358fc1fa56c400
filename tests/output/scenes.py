"""Surfaces that move in a known way, and readers of what is written about them."""

import numpy as np
import pytest

from visviva.output import Surface, TrajectoryWriter, stage

BOX = Surface(
    "box ä",
    [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)],
    [[[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6]], [[0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]],
)
ROPE = Surface("rope", [[0, 0, 0], [0, 0, -2], [1, 0, -3]], [[0, 1], [1, 2]])
MARK = Surface("mark", [[0, 0, 1]], [[0]])
PENTAGON = Surface(
    "pentagon", [[np.cos(a), np.sin(a), 3] for a in 0.4 * np.pi * np.arange(5)], [[0, 1, 2, 3, 4]]
)
SCENE = (BOX, ROPE, MARK, PENTAGON)


def moved(t):
    """Current points of the scene at time t: turned, stretched and shifted."""
    c, s = np.cos(t), np.sin(t)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1 + 0.1 * t]])
    return [surface.points @ turn.T + [t / 3, 0, 0] for surface in SCENE]


def write(path, times, **options):
    with TrajectoryWriter(path, SCENE, **options) as writer:
        for t in times:
            writer.append(t, moved(t))


def read_by_vtk(path):
    """Times and grids of all steps, as VTK's own reader sees them."""
    pyvista = pytest.importorskip("pyvista")
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as pipeline
    from vtkmodules.vtkIOHDF import vtkHDFReader

    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(pipeline.TIME_STEPS())
    grids = []
    for step in range(reader.GetNumberOfSteps()):
        reader.SetStep(step)
        reader.Update()
        grids.append(pyvista.wrap(reader.GetOutputDataObject(0)).copy())
    return times, grids


def read_image(path):
    from matplotlib.image import imread

    return imread(path)[..., :3]


def drawers():
    return [True, False] if stage.can_render() else [False]
