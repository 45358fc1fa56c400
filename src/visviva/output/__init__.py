"""Files and pictures of a run; independent of physics, everything here takes plain arrays."""

from visviva.output.checkpoint import Record, load_state, save_state
from visviva.output.directory import RunDirectory
from visviva.output.surface import Surface
from visviva.output.tables import Table, read_table
from visviva.output.trajectory import Trajectory
from visviva.output.vtkhdf import TrajectoryWriter

__all__ = [
    "Record",
    "RunDirectory",
    "Surface",
    "Table",
    "Trajectory",
    "TrajectoryWriter",
    "load_state",
    "read_table",
    "save_state",
]
