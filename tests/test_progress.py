"""Progress bars: what they show on a terminal, and that they are silent elsewhere."""

from __future__ import annotations

import io
import sys

import pytest

import visviva as vv
from visviva.study import progress
from visviva.study.progress import counting_bar, progress_bar


class Terminal(io.StringIO):
    """A stream that calls itself a terminal."""

    def isatty(self) -> bool:
        return True


def on_terminal(monkeypatch: pytest.MonkeyPatch) -> Terminal:
    """What stands for the terminal; no fixture, after which pytest would set its own stream again."""
    stream = Terminal()
    monkeypatch.setattr(sys, "stderr", stream)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "200")
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setattr(progress, "INTERVAL", 0.0)
    return stream


def falling() -> tuple[vv.Study, vv.Result]:
    system = vv.System([vv.PointMass(mass=2.0, velocity=(3, 0, 0)), vv.Gravity()])
    study = vv.Study(system, until=0.5, step=0.1, title="fall")
    return study, vv.simulate(system, until=0.1, step=0.1)


def test_a_bar_tells_time_and_energy_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """The error is relative to the largest energy so far: 9 J at the start."""
    study, result = falling()
    terminal = on_terminal(monkeypatch)
    names, rows = result.ledger.names, [0.0 * result.ledger.table[0] for _ in range(2)]
    rows[0][names.index("kinetic")] = 9.0
    rows[1][[names.index("time"), names.index("kinetic"), names.index("imbalance")]] = 0.25, 4.5, -1.8e-8
    with progress_bar(study, result.ledger) as show:
        for row in rows:
            show(row)
    shown = terminal.getvalue()
    assert "fall" in shown
    assert "t = 0.25 of 0.5 s" in shown
    assert "energy error 2.0e-09" in shown


def test_a_bar_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = on_terminal(monkeypatch)
    with counting_bar("frames") as show:
        show(3, 4)
    assert "frames" in terminal.getvalue()
    assert "75%" in terminal.getvalue()


@pytest.mark.parametrize("wanted", [True, False])
def test_nothing_is_shown_without_a_terminal_or_the_wish(
    wanted: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    terminal = on_terminal(monkeypatch)
    if wanted:
        monkeypatch.setattr(terminal, "isatty", lambda: False)
    study, result = falling()
    with progress_bar(study, result.ledger, wanted) as show:
        show(result.ledger.table[0])
    assert terminal.getvalue() == ""
