"""Several processes that a launcher started, and that do not know of each other, are refused."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import visviva as vv
from visviva.base import processes
from visviva.examples import pendulum


@pytest.mark.parametrize(
    ("name", "value", "n"),
    [
        ("OMPI_COMM_WORLD_SIZE", "4", 4),
        ("PMI_SIZE", "2", 2),
        ("SLURM_STEP_NUM_TASKS", "3", 3),
        ("PMIX_RANK", "1", 2),
        ("PMIX_RANK", "0", 1),
        ("SLURM_NTASKS", "4", 1),  # of a batch script, which is one process
        ("OMPI_COMM_WORLD_SIZE", "1", 1),
        ("PMI_SIZE", "many", 1),
    ],
)
def test_launchers_say_how_many(name: str, value: str, n: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(name, value)
    assert processes.n_launched() == n
    if n == 1:
        processes.refuse_unaware()
        return
    with pytest.raises(vv.InputError, match=rf"{n} processes were launched \({name} = {value}\).*--threads"):
        processes.refuse_unaware()
    monkeypatch.setattr(processes, "world", n)  # they know of each other
    processes.refuse_unaware()


def test_a_size_tells_more_than_a_rank(monkeypatch: pytest.MonkeyPatch) -> None:
    """One task of srun, started by a process that is itself one of several, has its rank in the environment."""
    monkeypatch.setenv("PMIX_RANK", "3")
    monkeypatch.setenv("SLURM_STEP_NUM_TASKS", "1")
    assert processes.n_launched() == 1
    assert processes.is_first()
    processes.refuse_unaware()


def test_nothing_is_written(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PMI_SIZE", "2")
    with pytest.raises(vv.InputError, match="2 processes were launched"):
        vv.run(pendulum.study(), tmp_path / "run")
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize("rank", [0, 1])
def test_one_of_them_says_so(rank: int, tmp_path: Path) -> None:
    """The first; others a second later, if they were not ended until then: it may be they alone that fail."""
    told = {"OMPI_COMM_WORLD_SIZE": "4", "OMPI_COMM_WORLD_RANK": str(rank)}
    command = [sys.executable, "-m", "visviva", "run", "pendulum", "--out", str(tmp_path / "run")]
    done = subprocess.run(command, env={**os.environ, **told}, capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.count("4 processes were launched") == 1
    assert not (tmp_path / "run").exists()


def test_the_cure_works(tmp_path: Path) -> None:
    """Without the variable that the message names, a run is one for itself."""
    command = ["env", "-u", "PMI_SIZE", sys.executable, "-m", "visviva", "run", "pendulum", "--until", "0.01"]
    environment = {**os.environ, "PMI_SIZE": "2"}
    done = subprocess.run([*command, "--no-pictures", "--out", str(tmp_path / "run")], env=environment)
    assert done.returncode == 0
