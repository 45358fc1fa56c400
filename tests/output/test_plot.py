"""Plots: all probes, in panels of their own, with the units that are known; as pictures and as drawings with lines."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import visviva as vv
from visviva.output.labels import Labels
from visviva.output.plot import energy_plot, grouped, probes_plot

T = np.linspace(0, 1e-3, 20)
LEDGER = {"time": T, "kinetic": T, "total": T, "imbalance": 1e-12 * T}
LABELS = Labels(
    title="Crane",
    units={"time": "s", "energy": "mJ"},
    columns={"angle": "rad", "load_x": "mm", "load_y": "mm"},
)


def text_of(file: Path) -> str:
    """What a drawing says."""
    return file.read_text(encoding="utf-8")


def svg(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Texts stay texts in drawings."""
    from visviva.output import plot

    monkeypatch.setitem(plot.STYLE, "svg.fonttype", "none")


def test_every_probe_has_its_panel(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    svg(tmp_path, monkeypatch)
    names = [f"probe{k}" for k in range(11)]
    probes_plot({"time": T} | dict.fromkeys(names, T), tmp_path / "p.svg", labels=LABELS)
    said = text_of(tmp_path / "p.svg")
    assert all(f">{name}<" in said for name in names)
    assert said.count(">time [s]<") == 2  # below the lowest panels of both columns


def test_units_stand_at_the_axes_or_nowhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    svg(tmp_path, monkeypatch)
    energy_plot(LEDGER, tmp_path / "e.svg", labels=LABELS)
    said = text_of(tmp_path / "e.svg")
    assert ">energy [mJ]<" in said
    assert ">time [s]<" in said
    assert ">Crane<" in said
    energy_plot(LEDGER, tmp_path / "plain.svg")
    assert ">energy<" in text_of(tmp_path / "plain.svg")
    assert "[" not in "".join(
        line for line in text_of(tmp_path / "plain.svg").splitlines() if "<text" in line
    )
    energy_plot(LEDGER, tmp_path / "static.svg", labels=Labels(clock="load parameter", units={"time": "s"}))
    assert ">load parameter<" in text_of(tmp_path / "static.svg")
    probes = {"time": T, "angle": T, "load_x": T, "load_y": -T}
    probes_plot(probes, tmp_path / "p.svg", labels=LABELS)
    assert all(
        f">{word}<" in text_of(tmp_path / "p.svg") for word in ("angle", "[rad]", "load", "[mm]", "x", "y")
    )


def test_equal_plots_are_equal_files(tmp_path: Path) -> None:
    for kind in ("png", "pdf", "svg"):
        for name in ("a", "b"):
            energy_plot(LEDGER, tmp_path / f"{name}.{kind}", labels=LABELS)
        assert (tmp_path / f"a.{kind}").read_bytes() == (tmp_path / f"b.{kind}").read_bytes()
    with pytest.raises(vv.InputError, match=r"\.png, \.pdf, \.svg"):
        energy_plot(LEDGER, tmp_path / "a.bmp")


def test_components_share_a_panel() -> None:
    names = ["load_x", "load_y", "load_z", "tip_force", "stress_xx", "stress_xy", "a_12"]
    assert list(grouped(names)) == ["load", "tip_force", "stress", "a"]
