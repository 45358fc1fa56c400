"""Repair a Linux wheel: `python packaging/repair_wheel.py WHEEL FOLDER [OPTIONS OF AUDITWHEEL]`.

auditwheel puts the OpenMP runtime into the wheel under a name of its own, which nothing else asks for: a process
that also loads oneMKL's layer for GNU, or another extension that needs `libgomp.so.1`, would hold a second one, with
threads of its own. Under its own name the loader takes the runtime that is there already, whoever loaded it first.
"""

from __future__ import annotations

import hashlib
import re
import subprocess
import sys
import tempfile
import zipfile
from base64 import urlsafe_b64encode
from pathlib import Path

SHARED = "libgomp.so.1"


def patch(*arguments: str | Path) -> str:
    return subprocess.run(["patchelf", *arguments], check=True, capture_output=True, text=True).stdout


def share_runtime(root: Path) -> None:
    """Give the grafted OpenMP runtime of an unpacked wheel its own name back, in all that needs it."""
    for runtime in root.glob("*.libs/libgomp-*.so*"):
        for library in root.rglob("*.so*"):
            if runtime.name in patch("--print-needed", library).split():
                patch("--replace-needed", runtime.name, SHARED, library)
        patch("--set-soname", SHARED, runtime)
        runtime.rename(runtime.with_name(SHARED))


def record(root: Path) -> str:
    """List of a wheel's files with their digests, as the standard on wheels wants it."""
    lines = []
    for file in sorted(f for f in root.rglob("*") if f.is_file()):
        digest = urlsafe_b64encode(hashlib.sha256(file.read_bytes()).digest()).rstrip(b"=").decode()
        entry = f"sha256={digest},{file.stat().st_size}"
        name = file.relative_to(root).as_posix()
        lines.append(f"{name},{',' if name.endswith('.dist-info/RECORD') else entry}")
    return "\n".join(lines) + "\n"


def repair(wheel: Path, folder: Path, options: list[str]) -> Path:
    """Repaired wheel in `folder`."""
    with tempfile.TemporaryDirectory() as scratch:
        grafted, root = Path(scratch, "grafted"), Path(scratch, "root")
        subprocess.run(["auditwheel", "repair", *options, "-w", grafted, wheel], check=True)
        (made,) = grafted.glob("*.whl")
        with zipfile.ZipFile(made) as file:
            file.extractall(root)
        share_runtime(root)
        (listing,) = root.glob("*.dist-info/RECORD")
        listing.write_text(record(root))
        folder.mkdir(parents=True, exist_ok=True)
        with zipfile.ZipFile(folder / made.name, "w", zipfile.ZIP_DEFLATED) as file:
            for line in listing.read_text().splitlines():
                name = re.sub(",[^,]*,[^,]*$", "", line)
                file.write(root / name, name)
    return folder / made.name


if __name__ == "__main__":
    print(repair(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3:]))
