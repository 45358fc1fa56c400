"""Short forms of the campaigns that kill runs and that let them run for long."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from campaign import kill, long

from visviva.output import load_state


def test_a_killed_flow_ends_in_the_same_bits() -> None:
    """Mechanisms are killed in ``test_restart.py``."""
    found = kill.outcome("cylinder", 1, np.random.default_rng(5))
    assert found.difference == ""
    assert len(found.saved) == 1


def test_the_campaign_sees_a_difference(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(kill.CASES, "four_bar", {"until": 0.05, "step": 0.01})
    kill.attempt("four_bar", tmp_path / "one")
    kill.attempt("four_bar", tmp_path / "same")
    assert kill.difference(tmp_path / "one", tmp_path / "same") == ""
    monkeypatch.setitem(kill.CASES, "four_bar", {"until": 0.05, "step": 0.01, "gravity": 9.82})
    kill.attempt("four_bar", tmp_path / "other")
    assert kill.difference(tmp_path / "one", tmp_path / "other") == "ledger.csv"
    table = (tmp_path / "one" / "states.npy").read_bytes()
    (tmp_path / "same" / "states.npy").write_bytes(table[:-1] + bytes([table[-1] ^ 1]))
    assert kill.difference(tmp_path / "one", tmp_path / "same") == "states.npy"
    assert load_state(tmp_path / "one" / "state.h5")["statistics"].values["steps"] == 5


def test_memory_of_a_solid_stays() -> None:
    """With the steps of a second; that Python keeps nothing is told by ``output/test_streaming.py``."""
    found = long.outcome("cantilever", 200)
    assert found.steps == 200
    assert found.energy < 1e-9
    assert found.growth < 0.02
