"""Steps entries of the catalogue over a core that was built with sanitizers, and looks for leaks of the core.

    cmake -S . -B build/sanitized -G Ninja -DVISVIVA_SANITIZE=ON -DVISVIVA_PORTABLE=OFF
    cmake --build build/sanitized --target _core
    python tests/sanitized.py build/sanitized [EVERY]

Takes each EVERY-th entry (12 if not given) through two steps of two schemes with a restart between, in a process under
the sanitizers of addresses, undefined behaviour and leaks. What Python itself keeps until its end does not count.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).parent
STEPS = "--steps"


def step_entries(every: int) -> None:
    """What the process under the sanitizers does."""
    from catalogue import CATALOGUE

    import visviva as vv

    def restart(system: vv.System) -> None:
        system.core.restore(system.core.memory())

    chosen = CATALOGUE[::every]
    for entry in chosen:
        for scheme in (vv.EnergyMomentum(), vv.BackwardEuler()):
            system = entry.system()
            vv.simulate(system, until=2 * entry.h, step=entry.h, scheme=scheme, observe=restart)
            system.tangent(scheme.step(system.time, entry.h))
    print(f"{len(chosen)} of {len(CATALOGUE)} entries of the catalogue stepped under sanitizers")


def library(name: str) -> str:
    """Path of a run-time library of the compiler."""
    command = ["gcc", f"-print-file-name={name}"]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


def package(build: Path, into: Path) -> None:
    """The package of this checkout around the core of a build."""
    (core,) = build.glob("_core.*.so")
    shutil.copytree(HERE.parent / "src" / "visviva", into, ignore=shutil.ignore_patterns("_core.*"))
    shutil.copy(core, into)


def environment(scratch: Path) -> dict[str, str]:
    """Errors end the process, undefined behaviour by a trap; leaks are only reported, since Python has its own."""
    log, python = f"log_path={scratch / 'log'}", f"{scratch}{os.pathsep}{HERE}"
    options = {
        "ASAN_OPTIONS": f"detect_leaks=1:handle_sigill=1:malloc_context_size=60:fast_unwind_on_malloc=0:{log}",
        "LSAN_OPTIONS": "exitcode=0",
        "LD_PRELOAD": f"{library('libasan.so')} {library('libubsan.so')}",
    }
    return {**os.environ, **options, "PYTHONPATH": python, "PYTHONMALLOC": "malloc"}


def main(build: Path, every: int) -> int:
    with tempfile.TemporaryDirectory() as directory:
        scratch = Path(directory)
        package(build, scratch / "visviva")
        command = [sys.executable, __file__, STEPS, str(every)]
        failed = subprocess.run(command, env=environment(scratch), check=False).returncode != 0
        reports = [part for log in scratch.glob("log.*") for part in log.read_text().split("\n\n")]
    ours = [part for part in reports if "visviva/_core" in part and (failed or "leak of" in part)]
    print(*ours, sep="\n\n")
    return int(failed or bool(ours))


if __name__ == "__main__":
    every = int(sys.argv[2]) if len(sys.argv) > 2 else 12
    if sys.argv[1] == STEPS:
        step_entries(every)
    else:
        sys.exit(main(Path(sys.argv[1]), every))
