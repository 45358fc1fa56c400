"""What memory is free for factors: of groups of processes with limits, and of addresses."""

from __future__ import annotations

import math
import resource
import subprocess
import sys
from pathlib import Path

import pytest

from visviva import _core

GB = 10**9


def group(path: Path, limit: str, used: int, files: int = 0, version: int = 2) -> None:
    """A control group as the kernel shows it."""
    names = (
        ("memory.max", "memory.current")
        if version == 2
        else ("memory.limit_in_bytes", "memory.usage_in_bytes")
    )
    path.mkdir(parents=True, exist_ok=True)
    for name, value in zip(names, (limit, str(used)), strict=True):
        (path / name).write_text(value + "\n")
    total = "" if version == 2 else "total_"
    (path / "memory.stat").write_text(f"anon 7\n{total}inactive_file {files}\n{total}active_file 0\nslab 3\n")


def left(tmp_path: Path, lines: str) -> float:
    (tmp_path / "cgroup").write_text(lines)
    return _core.left_in_groups(str(tmp_path / "cgroup"), str(tmp_path / "fs"))


def test_the_job_of_a_queue_is_limited_by_a_group_around_it(tmp_path: Path) -> None:
    """As Slurm makes them: the limit is that of the job, the process is in one of its steps."""
    root = tmp_path / "fs"
    group(root / "slurm/job_7", str(8 * GB), 3 * GB, files=GB)
    group(root / "slurm/job_7/step_0", "max", 2 * GB)
    assert left(tmp_path, "0::/slurm/job_7/step_0\n") == 6 * GB  # files that are kept give way
    group(root / "slurm/job_7/step_0", str(4 * GB), 2 * GB)
    assert left(tmp_path, "0::/slurm/job_7/step_0\n") == 2 * GB
    group(root, str(5 * GB), 4 * GB)  # of a container, which sees its own group as the root
    assert left(tmp_path, "0::/slurm/job_7/step_0\n") == GB
    assert left(tmp_path, "0::/\n") == GB


def test_groups_of_the_first_version(tmp_path: Path) -> None:
    root = tmp_path / "fs/memory"
    group(root / "slurm/job_7", str(8 * GB), 5 * GB, version=1, files=GB)
    group(root, str(2**63 - 4096), 9 * GB, version=1)  # so it says that there is no limit
    lines = "3:cpu,cpuacct:/\n11:memory:/slurm/job_7\n1:name=systemd:/a\n"
    assert left(tmp_path, lines) == 4 * GB


@pytest.mark.parametrize("lines", ["", "0::/nowhere\n", "0::\n", "nothing\n", "4:cpu:/x\n"])
def test_without_limits_nothing_is_limited(lines: str, tmp_path: Path) -> None:
    assert left(tmp_path, lines) == math.inf


def test_a_group_that_is_full_leaves_nothing(tmp_path: Path) -> None:
    group(tmp_path / "fs/job", str(GB), 2 * GB)
    assert left(tmp_path, "0::/job\n") == 1.0


def test_addresses_may_be_limited() -> None:
    """By `ulimit -v`: what is left is less than the limit by what the process has already."""
    limit = 4 * 2**30
    code = "from visviva import _core; print(_core.available_memory())"
    done = subprocess.run(
        [sys.executable, "-c", code],
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)),
        capture_output=True,
        text=True,
        check=True,
    )
    assert 0 < float(done.stdout) < limit
