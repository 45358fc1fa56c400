"""A user's Python file as a model: the function `study` in it, called like those of the examples."""

from __future__ import annotations

import sys
import traceback
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

from visviva.base.errors import InputError, VisvivaError

EXAMPLE = "def study(...) that returns a vv.Study"


def load(file: str | Path) -> ModuleType:
    """Execute a file; what it imports from its own folder is found.

    Raises
    ------
    InputError
        If there is no such file, it fails, or has no function ``study``.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "model.py"
    >>> _ = path.write_text("x = 1")
    >>> load(path)
    Traceback (most recent call last):
    visviva.base.errors.InputError: model.py: has no function study: write def study(...) that returns a vv.Study
    """
    path = Path(file)
    if not path.is_file():
        raise InputError(f"{path}: there is no such file")
    folder, name = str(path.parent.resolve()), path.stem.replace("-", "_")
    spec = spec_from_file_location(f"visviva_model_{name}", path)
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses and functions of the file look their module up
    sys.path.insert(0, folder)
    try:
        spec.loader.exec_module(module)
    except VisvivaError:
        raise
    except Exception as error:
        raise InputError(f"{path.name}{line_of(error, path)}: {type(error).__name__}: {error}") from error
    finally:
        sys.path.remove(folder)
    if not callable(getattr(module, "study", None)):
        raise InputError(f"{path.name}: has no function study: write {EXAMPLE}")
    return module


def line_of(error: Exception, path: Path) -> str:
    """Line of the file where it went wrong, as ``:12``."""
    if isinstance(error, SyntaxError) and error.lineno:
        return f":{error.lineno}"
    lines = [
        f.lineno for f in traceback.extract_tb(error.__traceback__) if Path(f.filename).name == path.name
    ]
    return f":{lines[-1]}" if lines else ""
