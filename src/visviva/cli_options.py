"""The options of the command line: their types and what ``--help`` says of them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Parameter

from visviva.base.deadline import seconds_of


def whole(_: Any, tokens: Sequence[Any]) -> int:
    """A whole number; Cyclopts rounds others."""
    return int(tokens[0].value)


def file_path(_: Any, tokens: Sequence[Any]) -> Path:
    """A path; an empty text would be the present directory."""
    if not tokens[0].value.strip():
        raise ValueError("the path is empty")
    return Path(tokens[0].value)


Model = Annotated[
    str,
    Parameter(
        help="Name of an example (see `visviva examples`), a scene file (*.yaml, *.toml), or a Python file with a "
        "function study."
    ),
]
Trust = Annotated[
    bool,
    Parameter(negative="", help="Run the meshing scripts that a scene names; they can run any command."),
]
Outside = Annotated[
    bool, Parameter(negative="", help="Read files that a scene names also outside of its folder.")
]
Directory = Annotated[Path, Parameter(help="Directory of a run.")]
Field = Annotated[
    str | None,
    Parameter(
        help="Field that colours, or '' for none; if none is given velocity of what flows, else damage, concentration, "
        "order, von_mises or temperature."
    ),
]
Format = Annotated[
    Literal["pvd", "blocks"],
    Parameter(
        help="pvd: a *.pvd with a *.vtu per component and moment, in which the parts of tensors have names; blocks: "
        "one *.vtkhdf."
    ),
]
ExportFile = Annotated[
    Path | None,
    Parameter(help="File to write; trajectory.pvd or blocks.vtkhdf in the directory if not given."),
]
Outline = Annotated[bool, Parameter(negative="", help="Show the start as a shade.")]
Range = Annotated[
    str | None,
    Parameter(name="--range", help="Values at the ends of the colour bar, e.g. 0,250; round ones else."),
]
Cmap = Annotated[str, Parameter(help="Colour map of matplotlib.")]
Deform = Annotated[float, Parameter(help="Factor of displacements.")]
Vectors = Annotated[
    str,
    Parameter(
        help="Field drawn as arrows, such as velocity or heat_flux; of cauchy lines along principal stresses."
    ),
]
Diagram = Annotated[
    str,
    Parameter(
        help="Force or moment drawn along beams: shear_1, shear_2, normal, bending_1, bending_2, torsion; the study "
        "stores it by fields=['diagram_bending_1']."
    ),
]
CameraText = Annotated[
    str | None,
    Parameter(
        name="--camera",
        help="front, back, left, right, top, bottom, iso; or eye, target and up as nine numbers x,y,z,x,y,z,x,y,z.",
    ),
]
SizeText = Annotated[str | None, Parameter(name="--size", help="Width and height in pixels, e.g. 1920x1080.")]
Settings = Annotated[
    list[str],
    Parameter(name="--set", negative="", help="key=value: a parameter of the example or scene; may repeat."),
]


Out = Annotated[
    Path | None, Parameter(converter=file_path, help="Directory for the files; runs/NAME if not given.")
]
Until = Annotated[float | None, Parameter(help="End time.")]
Step = Annotated[float | None, Parameter(help="Step length.")]
SchemeText = Annotated[
    str | None, Parameter(help="Time integration, e.g. Midpoint or GeneralizedAlpha(rho=0.8).")
]
Tolerance = Annotated[
    float | None, Parameter(help="Choose step sizes by this error per step; the step given is the first.")
]
Project = Annotated[
    bool, Parameter(negative="", help="Accept an initial state that is moved far to fit the constraints.")
]
Resume = Annotated[bool, Parameter(negative="", help="Continue the run in the directory.")]
Force = Annotated[
    bool, Parameter(negative="", help="With --resume: go on although something was changed on purpose.")
]
Every = Annotated[
    int | None,
    Parameter(
        converter=whole,
        help="Write tables and trajectory every so many steps; by default as fine as is useful.",
    ),
]
Saving = Annotated[float, Parameter(help="Seconds between saves of the state.")]
Threads = Annotated[
    int | None,
    Parameter(
        converter=whole, help="Threads, as many as cores may be used if not given; results are the same bits."
    ),
]
PetscOptions = Annotated[
    str | None,
    Parameter(
        name="--petsc",
        allow_leading_hyphen=True,
        help="Solve by PETSc (visviva-petsc), with these of its options: --petsc '-ksp_view -ksp_rtol 1e-8', or ''.",
    ),
]
TimeGiven = Annotated[
    float | None,
    Parameter(
        name="--time-limit",
        converter=lambda _, tokens: seconds_of(tokens[0].value),
        help="HH:MM:SS from now on (or MM:SS, D-HH:MM:SS): stop in time with the state saved, exit code 75.",
    ),
]
Profiled = Annotated[
    bool, Parameter(name="--profile", negative="", help="Print where the time went, by phase.")
]
Fields = Annotated[
    str | None,
    Parameter(help="Fields of meshes for the trajectory, e.g. von_mises,pressure; '' for none."),
]
Compress = Annotated[
    bool, Parameter(name="--compress", negative="", help="Compress the trajectory when it is complete.")
]
Overwrite = Annotated[
    bool, Parameter(negative="", help="Delete the files of an earlier run in the directory.")
]
NoMovie = Annotated[bool, Parameter(negative="", help="Make no movie, also if the study wants one.")]
NoPictures = Annotated[
    bool, Parameter(negative="", help="Draw nothing; visviva plot and picture do it later.")
]
NoLock = Annotated[bool, Parameter(negative="", help="Write also where the file system knows no locks.")]
