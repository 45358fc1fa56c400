"""Plots of the ledger and the probes over time."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.output.safe_files import replacing, reporting
from visviva.output.tables import read_table
from visviva.output.view import INK, PALETTE

Columns = Mapping[str, NDArray[np.float64]]

STYLE: dict[str, Any] = {
    "font.size": 10,
    "axes.edgecolor": "#8a97a3",
    "axes.labelcolor": INK,
    "axes.grid": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.color": "#e3e8ed",
    "xtick.color": INK,
    "ytick.color": INK,
    "lines.linewidth": 1.6,
    "legend.frameon": False,
}


def energy_plot(
    ledger: str | Path | Columns,
    png: str | Path,
    *,
    energies: Sequence[str] | None = None,
    error: str = "imbalance",
    probes: str | Path | Columns | None = None,
    shown: Sequence[str] | None = None,
    units: Mapping[str, str] | None = None,
    title: str = "",
) -> None:
    """Plot energies by kind, the error of the balance on a logarithmic scale, and probes if wanted.

    Parameters
    ----------
    ledger
        A ``ledger.csv``, or its columns by name, (n,) each with ``time`` among them.
    png
        File to write.
    energies
        Columns for the upper panel, in J; if not given, ``kinetic``, all whose names begin with
        ``potential``, and ``total``, which is drawn as the sum of the others.
    error
        Column with the closing error of the balance since the start, in J; the panel shows its magnitude over
        the largest magnitude of the plotted energies. Left out where there is no such column.
    probes
        A ``probes.csv`` or columns for further panels.
    shown
        Names of the probes to be shown, a panel each; all, at most six, if not given.
    units
        Unit of each probe, by name.
    title
        Above the plot.

    Raises
    ------
    InputError
        If a column is missing or a file is no table.
    RunError
        If the picture cannot be written.
    """
    columns = _columns(ledger)
    names = list(energies) if energies is not None else [name for name in columns if _is_energy(name)]
    _require(columns, ["time", *names])
    series = _columns(probes) if probes is not None else {}
    wanted = list(shown) if shown is not None else [name for name in series if name != "time"][:6]
    _require(series, wanted)
    _render(columns, names, error, series, wanted, units or {}, title, Path(png))


def _render(
    columns: Columns,
    names: Sequence[str],
    error: str,
    series: Columns,
    shown: Sequence[str],
    units: Mapping[str, str],
    title: str,
    png: Path,
) -> None:
    """Draw on a figure of its own: no global state of matplotlib is read or changed beyond this call."""
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    has_error = error in columns
    heights = [3.0] + [1.8] * has_error + [1.3] * len(shown)
    settings: Any = {
        key: value for key, value in matplotlib.rcParamsDefault.items() if key != "backend"
    } | STYLE
    with matplotlib.rc_context(settings):
        figure = Figure(figsize=(8.5, sum(heights) + 0.9), layout="constrained", dpi=200)
        canvas: Any = FigureCanvasAgg(figure)
        panels: list[Any] = list(
            figure.subplots(len(heights), 1, sharex=True, squeeze=False, height_ratios=heights)[:, 0]
        )
        _draw_energies(panels[0], columns, names)
        if has_error:
            _draw_error(panels[1], columns, names, error)
        for k, (panel, name) in enumerate(zip(panels[1 + has_error :], shown, strict=True)):
            panel.plot(series["time"], series[name], color=PALETTE[k % len(PALETTE)])
            panel.set_ylabel(f"{_spoken(name)}\n[{units[name]}]" if name in units else _spoken(name))
        panels[-1].set_xlabel("time [s]")
        figure.align_ylabels(panels)
        if title:
            figure.suptitle(title, color=INK, x=0.02, ha="left", fontsize=12)
        with reporting(png), replacing(png) as temporary:
            canvas.print_png(str(temporary), metadata={"Software": "visviva"})


def _draw_energies(panel: Any, columns: Columns, names: Sequence[str]) -> None:
    colors = iter(PALETTE * (1 + len(names) // len(PALETTE)))
    for name in names:
        sum_of_all = name == "total"
        look = {"color": INK, "linewidth": 2.2} if sum_of_all else {"color": next(colors)}
        panel.plot(columns["time"], columns[name], label=_spoken(name), **look)
    panel.set_ylabel("energy [J]")
    panel.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0)


def _draw_error(panel: Any, columns: Columns, names: Sequence[str], error: str) -> None:
    """Draw the error where it is not zero; a logarithmic scale has no place for an exact balance."""
    scale = max((float(np.nanmax(np.abs(columns[name]), initial=0.0)) for name in names), default=0.0) or 1.0
    relative = np.abs(columns[error]) / scale
    shown = np.isfinite(relative) & (relative > 0)
    panel.set_yscale("log")
    panel.grid(True)
    panel.plot(
        columns["time"][shown], relative[shown], color=PALETTE[3], marker=".", markersize=2.5, linewidth=0.6
    )
    if shown.any():
        low, high = relative[shown].min(), relative[shown].max()
        panel.set_ylim(max(low, 1e-18) / 3, high * 3)
    else:
        panel.text(0.5, 0.5, "exactly zero", transform=panel.transAxes, ha="center", color=INK)
    panel.axhline(np.finfo(float).eps, color="#8a97a3", linewidth=0.8, linestyle="--")
    panel.set_ylabel("balance error\n/ largest energy")


def _columns(table: str | Path | Columns) -> Columns:
    return table if isinstance(table, Mapping) else read_table(table)


def _require(columns: Columns, names: Iterable[str]) -> None:
    for name in names:
        if name not in columns:
            raise InputError(f"no column is called {name!r}; there are {', '.join(columns) or 'none'}")


def _is_energy(name: str) -> bool:
    return name in ("kinetic", "total") or name.startswith("potential")


def _spoken(name: str) -> str:
    return name.replace("_", " ")
