"""One writer per directory, runs that never began, signals, and disks that fill."""

from __future__ import annotations

import errno
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from interrupting import at, run_until

import visviva as vv
from visviva.cli import main
from visviva.examples import pendulum
from visviva.output import RunDirectory, load_state, read_table
from visviva.study.recorder import Recorder
from visviva.study.run import run


def study(until: float = 0.2, step: float = 0.01) -> vv.Study:
    return pendulum.study(until=until, step=step)


def test_the_second_writer_is_refused(tmp_path: Path) -> None:
    """While one run writes, another one that resumes or begins there is refused, and says who is writing."""
    seen = []

    def second(recorder: Recorder) -> bool:
        if recorder.rows == 5:
            for resume in (False, True):
                with pytest.raises(vv.InputError, match=f"is being written by process {os.getpid()} on "):
                    run(study(), tmp_path, resume=resume, pictures=False)
            seen.append(True)
        return recorder.rows == 10

    run_until(second, study(), tmp_path)
    assert seen == [True]
    run(study(), tmp_path, resume=True, pictures=False)
    assert len(read_table(tmp_path / "ledger.csv")["time"]) == 21


def test_file_systems_without_locks_are_for_those_who_mean_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def flock(*_: int) -> None:
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    monkeypatch.setattr("fcntl.flock", flock)
    command = ["run", "pendulum", "--until", "0.02", "--out", str(tmp_path)]
    assert main(command) == 2
    assert re.search(r"knows no locks \(No locks .*lock=False \(--no-lock\)", capsys.readouterr().err)
    assert not list(tmp_path.glob("*.csv"))
    assert main([*command, "--no-lock"]) == 0
    assert run(study(0.04), tmp_path, resume=True, lock=False, pictures=False).statistics.steps == 4


WRITER = """
import sys, time
from visviva.examples import pendulum
from visviva.study.recorder import Recorder
from visviva.study.run import run
write = Recorder.write_row
def slowly(self, row):
    write(self, row)
    time.sleep(0.02)
Recorder.write_row = slowly
run(pendulum.study(until=5.0, step=0.01), sys.argv[1], save_every=0.0, pictures=False)
"""


@pytest.fixture
def writer(tmp_path: Path) -> Any:
    """A process that writes a run into `tmp_path`, with more than one state saved."""
    with subprocess.Popen([sys.executable, "-c", WRITER, str(tmp_path)], stderr=subprocess.PIPE) as process:
        deadline = time.monotonic() + 60
        ledger = tmp_path / "ledger.csv"
        while time.monotonic() < deadline and not (ledger.exists() and ledger.read_bytes().count(b"\n") > 5):
            time.sleep(0.01)
        yield process
        process.kill()


def test_a_killed_writer_leaves_no_lock(writer: Any, tmp_path: Path) -> None:
    with pytest.raises(vv.InputError, match=f"is being written by process {writer.pid} on "):
        run(study(5.0), tmp_path, resume=True, pictures=False)
    writer.kill()
    writer.wait()
    reached = float(load_state(tmp_path / "state.h5")["stepper"].values["time"])
    run(study(reached + 0.05), tmp_path, resume=True, pictures=False)


def test_termination_saves_as_ctrl_c_does(writer: Any, tmp_path: Path) -> None:
    writer.send_signal(signal.SIGTERM)
    _, err = writer.communicate(timeout=60)
    assert b"KeyboardInterrupt" in err
    reached = float(load_state(tmp_path / "state.h5")["stepper"].values["time"])
    assert read_table(tmp_path / "ledger.csv")["time"][-1] == reached > 0


def test_handlers_of_a_program_around_python_stay(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Python knows handlers that C has installed as None, and cannot install that."""
    install, handlers = signal.signal, dict[int, object]({signal.SIGTERM: None})

    def installing(number: int, handler: Any) -> object:
        if handler is None:
            raise TypeError("signal handler must be signal.SIG_IGN, signal.SIG_DFL, or a callable object")
        earlier = handlers.get(number, signal.getsignal(number))
        handlers[number] = handler
        return earlier if number == signal.SIGTERM else install(number, handler)

    known = signal.getsignal
    monkeypatch.setattr(signal, "signal", installing)
    monkeypatch.setattr(signal, "getsignal", lambda n: handlers[n] if n == signal.SIGTERM else known(n))
    interrupt = known(signal.SIGINT)
    assert run(study(), tmp_path, pictures=False).statistics.steps == 20
    assert handlers[signal.SIGTERM] is None
    assert known(signal.SIGINT) is interrupt


def test_the_command_line_ends_with_143_on_termination(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "visviva", "run", "pendulum", "--until", "500", "--out", str(tmp_path)]
    with subprocess.Popen(
        [*command, "--every", "3"], stderr=subprocess.PIPE, stdout=subprocess.PIPE
    ) as process:
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline and not (tmp_path / "state.h5").exists():
            time.sleep(0.01)
        time.sleep(0.1)
        process.terminate()
        _, err = process.communicate(timeout=60)
    assert process.returncode == 143
    assert b"--resume" in err
    times = read_table(tmp_path / "ledger.csv")["time"]
    assert times[:3] == pytest.approx([0.0, 3 * times[1] / 3, 2 * times[1]])


def test_a_run_killed_before_its_first_state_can_be_repeated(tmp_path: Path, monkeypatch: Any) -> None:
    def killed(self: Recorder) -> None:
        raise SystemExit

    with monkeypatch.context() as patch:
        patch.setattr(Recorder, "save", killed)
        with pytest.raises(SystemExit):
            run(study(), tmp_path, pictures=False)
    assert (tmp_path / "ledger.csv").exists()
    with pytest.raises(vv.InputError, match="never saved a state"):
        run(study(), tmp_path, resume=True, pictures=False)
    assert run(study(), tmp_path, pictures=False).statistics.steps == 20
    assert not (tmp_path / ".starting").exists()


def full(*_: Any) -> None:
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def test_a_disk_full_at_the_start_can_be_repeated(tmp_path: Path, monkeypatch: Any) -> None:
    with monkeypatch.context() as patch:
        patch.setattr(os, "pwrite", full)
        with pytest.raises(vv.RunError, match="No space left on device"):
            run(study(), tmp_path, pictures=False)
    assert run(study(), tmp_path, pictures=False).statistics.steps == 20


@pytest.mark.parametrize("which", ["ledger.csv", "probes.csv", "trajectory.vtkhdf", "state.h5"])
def test_a_full_disk_tells_the_time_that_can_be_resumed(which: str, tmp_path: Path, monkeypatch: Any) -> None:
    """Whatever file is hit first, the message tells the state's time, and the run goes on from there to the bit."""
    run(study(), tmp_path / "whole", pictures=False)
    save_times: list[float] = []
    real_save = Recorder.save

    def save(recorder: Recorder) -> None:
        if len(save_times) == 3:
            fill(recorder)
        real_save(recorder)
        recorder._cost = 0.0  # so that every step is saved
        save_times.append(recorder.study.system.time)

    def fill(recorder: Recorder) -> None:
        if which == "state.h5":
            monkeypatch.setattr(os, "replace", full)
            return
        file = {"ledger.csv": recorder.ledger, "probes.csv": recorder.probes}.get(which, recorder.trajectory)
        assert file is not None
        number, real = file._descriptor, os.pwrite
        monkeypatch.setattr(os, "pwrite", lambda d, *a: full() if d == number else real(d, *a))

    with monkeypatch.context() as patch:
        patch.setattr(Recorder, "save", save)
        with pytest.raises(vv.RunError, match=rf"{which}.*No space left on device") as error:
            run(study(), tmp_path / "split", pictures=False, save_every=0.0)
        assert str(error.value).endswith(f"the run can be resumed from t = {save_times[-1]!r}")
    monkeypatch.undo()
    assert load_state(tmp_path / "split" / "state.h5")["stepper"].values["time"] == save_times[-1] > 0
    run(study(), tmp_path / "split", resume=True, pictures=False)
    for table in ("ledger.csv", "probes.csv"):
        assert (tmp_path / "whole" / table).read_bytes() == (tmp_path / "split" / table).read_bytes()


def test_ends_that_make_no_sense_are_refused(tmp_path: Path) -> None:
    run(study(), tmp_path / "run", pictures=False)
    for until, why in (
        (float("nan"), "not a finite"),
        (float("inf"), "not a finite"),
        (0.1, "before t = 0.2"),
    ):
        with pytest.raises(vv.InputError, match=why):
            run(study(until), tmp_path / "run", resume=True, pictures=False)
    for options in ({"every": 0}, {"every": 2.5}, {"save_every": -1.0}, {"save_every": float("nan")}):
        with pytest.raises(vv.InputError, match="every = "):
            run(study(), tmp_path / "new", pictures=False, **options)
    assert not (tmp_path / "new").exists()


def test_every_so_many_steps(tmp_path: Path) -> None:
    result = run(study(), tmp_path / "run", pictures=False, every=6)
    times = [0.0, 0.06, 0.12, 0.18, 0.2]
    assert result.times == pytest.approx(times)
    assert read_table(tmp_path / "run" / "probes.csv")["time"] == pytest.approx(times)
    run_until(at(0.1), study(), tmp_path / "split", every=6)
    run(study(), tmp_path / "split", resume=True, pictures=False)
    for table in ("ledger.csv", "probes.csv"):
        assert (tmp_path / "run" / table).read_bytes() == (tmp_path / "split" / table).read_bytes()


def test_foreign_files_are_not_overwritten(tmp_path: Path) -> None:
    (tmp_path / "picture.png").write_text("mine")
    with pytest.raises(vv.InputError, match=r"picture.png is there already, and is of no run"):
        run(study(), tmp_path, pictures=False)
    assert (tmp_path / "picture.png").read_text() == "mine"
    assert RunDirectory(tmp_path).earlier == ()


def lose(how: str, folder: Path) -> None:
    """What may happen to a directory while a run writes in it."""
    if how == "emptied":
        for file in folder.iterdir():
            file.unlink()
    elif how == "moved":
        folder.rename(folder.with_name("elsewhere"))
    else:
        (folder / how).rename(folder / "old")
        (folder / how).write_bytes((folder / "old").read_bytes())


@pytest.mark.parametrize(
    "how", ["emptied", "moved", "ledger.csv", "probes.csv", "states.npy", "trajectory.vtkhdf"]
)
def test_files_that_are_lost_during_a_run_are_told(how: str, tmp_path: Path) -> None:
    """Not called done, and no state is left that goes with nothing."""
    ball, calls = vv.PointMass(mass=1.0, velocity=(1, 0, 0)), 0

    def place(system: vv.System) -> float:
        nonlocal calls
        calls += 1
        if calls == 6:
            lose(how, tmp_path / "run")
        return 0.0

    with pytest.raises(vv.RunError, match=r"was moved, removed or replaced while the run wrote it"):
        run(vv.Study(vv.System([ball]), 0.1, 0.01, probes={"x": place}), tmp_path / "run", pictures=False)
    assert not (tmp_path / "run" / "summary.json").exists()
    if how in ("emptied", "moved"):
        assert not (tmp_path / "run" / "state.h5").exists()
