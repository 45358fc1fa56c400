"""Ledger and states of a run stream to its files: memory does not grow with the steps."""

from __future__ import annotations

import gc
import tracemalloc
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from interrupting import after_rows, run_until

import visviva as vv
from visviva.base.errors import InputError
from visviva.examples import pendulum
from visviva.output.states import StateFile
from visviva.study.recorder import Recorder
from visviva.study.run import run


def test_memory_stays_while_steps_are_taken(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Python's memory after 100 and after 400 steps differs by less than 100 bytes per step; it did by a thousand."""
    write, taken = Recorder.write, dict[int, int]()

    def writing(recorder: Recorder, step: int, row: Any) -> None:
        write(recorder, step, row)
        if step in (100, 400):
            gc.collect()
            taken[step] = tracemalloc.get_traced_memory()[0]

    monkeypatch.setattr(Recorder, "write", writing)
    tracemalloc.start()
    try:
        result = run(pendulum.study(until=0.4, step=0.001), tmp_path, pictures=False, every=1)
    finally:
        tracemalloc.stop()
    assert len(result.states) == 401
    assert taken[400] - taken[100] < 100 * 300


def test_a_run_and_a_simulation_tell_the_same(tmp_path: Path) -> None:
    """What is read from the files is what is kept in memory, to the bit, also of a run that was resumed."""
    study = pendulum.study(until=0.3, step=0.01)
    kept = vv.simulate(study.system, until=study.until, step=study.step, scheme=study.scheme)
    run_until(after_rows(12), pendulum.study(until=0.3, step=0.01), tmp_path)
    again = pendulum.study(until=0.3, step=0.01)
    read = run(again, tmp_path, resume=True, pictures=False)
    assert list(read.times) == list(kept.times)
    for one, other in ((read.states, kept.states), (read.rates, kept.rates)):
        np.testing.assert_array_equal(np.array(one), np.array(other))
        np.testing.assert_array_equal(one[-3:], other[-3:])
    np.testing.assert_array_equal(read.ledger.table, kept.ledger.table)
    assert read.conservation() == kept.conservation()
    name = "position" if "position" in again.probes else next(iter(again.probes))
    found, expected = read.history(again.probes[name]), kept.history(study.probes[name])
    np.testing.assert_array_equal(np.shape(found), np.shape(expected))
    with pytest.raises(IndexError):
        read.states[len(read.times)]
    table = np.load(tmp_path / "states.npy")
    np.testing.assert_array_equal(table[:, 0], kept.times)
    np.testing.assert_array_equal(table[:, 1 : 1 + len(kept.states[0])], np.array(kept.states))


def test_figures_of_the_whole_run_need_no_table(tmp_path: Path) -> None:
    """With rows written every seventh step alone, and resumed, the audit is that of all steps."""
    study = pendulum.study(until=0.3, step=0.01)
    kept = vv.simulate(study.system, until=study.until, step=study.step, scheme=study.scheme)
    run_until(after_rows(3), pendulum.study(until=0.3, step=0.01), tmp_path, every=7)
    read = run(pendulum.study(until=0.3, step=0.01), tmp_path, resume=True, pictures=False)
    assert len(read.ledger["time"]) == 6
    assert read.conservation() == kept.conservation()
    table = kept.ledger.table
    np.testing.assert_array_equal(
        read.ledger.span, [table[0], table[-1], table.min(axis=0), table.max(axis=0)]
    )


def test_a_file_of_states_is_cut_back_and_goes_on(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    rows = [(0.1 * k, rng.normal(size=4), rng.normal(size=4), [rng.normal(size=(2, 3))]) for k in range(9)]
    file = StateFile(tmp_path / "s.npy", 4, [(2, 3)])
    checksums = []
    for row in rows:
        file.append(*row)
        checksums.append(file.checksum)
    again = StateFile.reopen(tmp_path / "s.npy", 4, [(2, 3)], 5, checksums[4])
    assert len(again.times) == 5
    for row in rows[5:]:
        again.append(*row)
    assert again.checksum == checksums[-1]
    np.testing.assert_array_equal([r[0] for r in again.records], [row[3][0] for row in rows])
    np.testing.assert_array_equal(np.array(again.rates), [row[2] for row in rows])
    with pytest.raises(ValueError, match="read-only"):  # as those in memory: nobody changes what was
        again.states[0][0] = 7.0
    for n, checksum in ((6, checksums[4]), (10, checksums[8])):
        with pytest.raises(InputError, match=r"s\.npy: is damaged"):
            StateFile.reopen(tmp_path / "s.npy", 4, [(2, 3)], n, checksum)
    with pytest.raises(InputError, match="a state of 12 numbers among such of 15"):
        again.append(1.0, np.zeros(4), np.zeros(4), [np.zeros(3)])
