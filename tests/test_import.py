"""What `import visviva` loads."""

from __future__ import annotations

import subprocess
import sys

HEAVY = {"scipy", "pyvista", "vtk", "vtkmodules", "matplotlib", "h5py", "meshio", "trimesh", "imageio"}
OF_FILES_AND_COMMAND_LINE = {"yaml", "rich", "cyclopts"}


def test_nothing_is_loaded_before_it_is_used() -> None:
    """`import visviva` stays far below half a second however much there is."""
    code = "import sys, visviva; print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert [name for name in loaded.split() if name.startswith("visviva")] == ["visviva"]
    assert "numpy" not in loaded.split()


EACH_FIRST = """
import sys, visviva
names = {}
for name in visviva.__all__:
    names.setdefault(getattr(visviva, name).__module__, []).append(name)
for module, listed in names.items():
    assert module.startswith("visviva."), listed
    for loaded in [m for m in sys.modules if m.startswith("visviva") and m != "visviva._core"]:
        del sys.modules[loaded]
    import visviva
    for name in listed:  # the first of them loads what all of them need
        assert getattr(visviva, name).__module__ == module, name
"""


def test_every_public_name_can_be_the_first_one_used() -> None:
    """No module counts on another one having been loaded before it."""
    subprocess.run([sys.executable, "-c", EACH_FIRST], check=True)


def test_all_of_it_loads_numpy_and_pydantic_only() -> None:
    code = """
import sys, visviva
for name in visviva.__all__:
    getattr(visviva, name)
print(*{name.split(chr(46))[0] for name in sys.modules})"""
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
