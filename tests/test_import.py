"""What `import visviva` loads."""

from __future__ import annotations

import subprocess
import sys

HEAVY = {"scipy", "pyvista", "vtk", "vtkmodules", "matplotlib", "h5py", "meshio", "trimesh", "imageio"}
OF_FILES_AND_COMMAND_LINE = {"yaml", "rich", "cyclopts"}


def test_only_numpy_and_pydantic_are_loaded_at_once() -> None:
    code = "import sys, visviva; print(*{name.split('.')[0] for name in sys.modules})"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert not (HEAVY | OF_FILES_AND_COMMAND_LINE) & set(loaded.split())


def test_classes_are_prepared_when_they_are_first_used() -> None:
    code = "import visviva as vv; print(vv.Revolute.__pydantic_complete__, vv.Box.__pydantic_complete__)"
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert told.split() == ["False", "False"]


def test_signatures_are_told_before_the_first_use() -> None:
    code = "import inspect, visviva as vv; print(inspect.signature(vv.Gravity), inspect.signature(vv.Sphere))"
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert "acceleration" in told
    assert "radius" in told
