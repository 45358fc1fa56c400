"""Pages of the gallery that are kept from earlier builds, by what they were made of.

A page is made of the modules that its run has loaded, the core, the scripts that make it and the versions of what draws
and computes. It is kept in ``~/.cache/visviva/gallery`` (or below ``XDG_CACHE_HOME``) under the hash of all that;
nothing is lost with that folder but time.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import sys
import tempfile
from collections.abc import Iterable
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import visviva

HERE = Path(__file__).resolve().parent
CACHE = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "visviva" / "gallery"
PACKAGE = Path(visviva.__file__).parent
SCRIPTS = ("make_gallery.py", "kept.py")
PACKAGES = ("numpy", "scipy", "h5py", "matplotlib", "pyvista", "vtk")
MOST = 4  # of each page, so that branches do not displace each other's
MODULES = "modules.json"


def loaded() -> list[str]:
    """The modules of the package that this process has loaded, as paths in it."""
    files = [
        getattr(module, "__file__", None)
        for name, module in sys.modules.items()
        if name.startswith("visviva")
    ]
    return sorted(str(Path(f).relative_to(PACKAGE)) for f in files if f and f.endswith(".py"))


def key(modules: Iterable[str]) -> str:
    """The hash of what a page is made of."""
    core = (p for part in ("visviva", "bind") for p in (HERE.parent / "cpp" / part).rglob("*.?pp"))
    sources = [*sorted(core), HERE.parent / "CMakeLists.txt", *(HERE / name for name in SCRIPTS)]
    found = hashlib.sha256(f"{sys.version} {[installed(name) for name in PACKAGES]}".encode())
    for file in [*sources, PACKAGE / "__init__.pyi", *(PACKAGE / name for name in modules)]:
        found.update(f"{file.name} ".encode() + (file.read_bytes() if file.exists() else b"is gone"))
    return found.hexdigest()


def installed(package: str) -> str:
    """Version of a package, if it is there."""
    try:
        return version(package)
    except PackageNotFoundError:
        return ""


def fetch(page: str, into: Path) -> bool:
    """Copy what is kept of a page, if it is made of what is there now."""
    for folder in (CACHE / page).glob("*"):
        listed = folder / MODULES
        if listed.exists() and key(json.loads(listed.read_text())) == folder.name:
            folder.touch()
            shutil.copytree(folder, into, dirs_exist_ok=True, ignore=shutil.ignore_patterns(MODULES))
            return True
    return False


def keep(page: str, files: Iterable[Path]) -> None:
    """Keep the files of a page that this process has made."""
    modules = loaded()
    (CACHE / page).mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=CACHE) as scratch:
        new = Path(scratch) / "new"
        new.mkdir()
        for file in files:
            shutil.copy(file, new)
        (new / MODULES).write_text(json.dumps(modules))
        if not (target := CACHE / page / key(modules)).exists():
            new.rename(target)
    newest = sorted((CACHE / page).glob("*"), key=lambda folder: folder.stat().st_mtime, reverse=True)
    for folder in newest[MOST:]:
        shutil.rmtree(folder, ignore_errors=True)
