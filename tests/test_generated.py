"""Generated bad input (`campaign.generated`): 150 cases of the thousands, and what would fail a case does."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any

import pytest
from campaign import generated, mutations

import visviva as vv


def test_bad_input_is_refused_in_a_line_whatever_it_is() -> None:
    assert generated.campaign(0, 150) == []


def test_cases_follow_from_their_numbers(tmp_path: Path) -> None:
    first, second = ([mutations.case(Random(n), n, tmp_path).what for n in range(60)] for _ in range(2))
    assert first == second


def raises(error: Exception) -> Callable[[], Any]:
    def call() -> None:
        raise error

    return call


@pytest.mark.parametrize(
    ("case", "fault"),
    [
        (mutations.Case("bad", True, call=lambda: 1), "accepted without a word"),
        (mutations.Case("odd", False, call=lambda: 1), ""),
        (mutations.Case("refused", True, call=raises(vv.InputError("no"))), ""),
        (mutations.Case("bug", False, call=raises(KeyError("x"))), "KeyError"),
        (mutations.Case("endless", True, call=raises(Exception("x"))), "Exception"),
        (mutations.Case("bad line", True, ["examples"]), "accepted without a word"),
        (mutations.Case("good line", False, ["examples"]), ""),
        (mutations.Case("refused line", True, ["rnu"]), ""),
    ],
    ids=lambda value: value.what if isinstance(value, mutations.Case) else None,
)
def test_what_is_wrong_is_a_fault(case: mutations.Case, fault: str, tmp_path: Path) -> None:
    assert generated.outcome(case, tmp_path).startswith(fault)
    assert bool(generated.outcome(case, tmp_path)) == bool(fault)


def test_hangs_and_tracebacks_are_faults(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(generated, "LIMIT", 1)
    slow = mutations.Case("slow", False, call=lambda: time.sleep(5))
    monkeypatch.setattr(mutations, "case", lambda *_: slow)
    assert [fault for _, _, fault in generated.run(range(1))] == ["hangs for more than 1 s"]
    monkeypatch.setattr("visviva.scene.gallery.example_names", raises(KeyError("x")))
    assert generated.outcome(mutations.Case("bug", False, ["examples"]), tmp_path).startswith("unexpected")


def test_a_process_that_dies_is_a_fault(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """What is run in place of Python begins a case and is killed; the next cases are run by another one."""
    script = tmp_path / "python"
    script.write_text('#!/bin/sh\necho "begin $4 a case"\nif [ $4 -lt 2 ]; then kill -9 $$; fi\n')
    os.chmod(script, 0o755)
    monkeypatch.setattr(generated.sys, "executable", str(script))
    assert generated.campaign(0, 9) == [f"{n} a case: the process died with -9" for n in (0, 1)]
