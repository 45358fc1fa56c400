"""Plots of the ledger and the probes over time."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.output.labels import Labels
from visviva.output.safe_files import called, replacing, reporting
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
    "svg.hashsalt": "visviva",
}


FORMATS = (".png", ".pdf", ".svg")
MOST_ROWS = 8
"""Panels below each other before probes begin a further column."""


def energy_plot(
    ledger: str | Path | Columns,
    file: str | Path,
    *,
    energies: Sequence[str] | None = None,
    error: str = "imbalance",
    labels: Labels | None = None,
    title: str = "",
) -> None:
    """Plot energies by kind, and the error of the balance on a logarithmic scale.

    Parameters
    ----------
    ledger
        A ``ledger.csv``, or its columns by name, (n,) each with ``time`` among them.
    file
        File to write: ``*.png``, ``*.pdf`` or ``*.svg``.
    energies
        Columns for the upper panel; if not given, ``kinetic``, all whose names begin with
        ``potential``, and ``total``, which is drawn as the sum of the others.
    error
        Column with the closing error of the balance since the start; the panel shows its magnitude over
        the largest magnitude of the plotted energies. Left out where there is no such column.
    labels
        Units of energies and times, as far as they are known.
    title
        Above the plot.

    Raises
    ------
    InputError
        If a column is missing, a file is no table, or the format is another one.
    RunError
        If the picture cannot be written.
    """
    columns, known = _columns(ledger), labels or Labels()
    names = list(energies) if energies is not None else [name for name in columns if _is_energy(name)]
    _require(columns, ["time", *names])
    heights = [3.0] + [1.8] * (error in columns)
    with drawn(file, heights, title or known.title) as panels:
        _draw_energies(panels[0], columns, names, known)
        if error in columns:
            _draw_error(panels[1], columns, names, error)
        panels[-1].set_xlabel(known.abscissa)


def probes_plot(
    probes: str | Path | Columns,
    file: str | Path,
    *,
    shown: Sequence[str] | None = None,
    labels: Labels | None = None,
    title: str = "",
) -> None:
    """Plot probes over time, all of them: a panel each, with the components of a vector together.

    Parameters
    ----------
    probes
        A ``probes.csv``, or columns by name, (n,) each with ``time`` among them.
    file
        File to write: ``*.png``, ``*.pdf`` or ``*.svg``.
    shown
        Names of columns, if only some shall be shown.
    labels
        Units of the columns, as far as they are known.
    title
        Above the plot.

    Raises
    ------
    InputError
        If a column is missing, a file is no table, or the format is another one.
    RunError
        If the picture cannot be written.
    """
    series, known = _columns(probes), labels or Labels()
    names = [name for name in series if name != "time"] if shown is None else list(shown)
    _require(series, ["time", *names])
    groups = grouped(names)
    across = -(-len(groups) // MOST_ROWS) or 1
    rows = -(-len(groups) // across) or 1
    with drawn(file, [1.5] * rows, title or known.title, across) as panels:
        for panel, (stem, columns) in zip(panels, groups.items(), strict=False):
            _draw_probe(panel, series, stem, columns, known)
        for panel in panels[len(groups) :]:
            panel.set_visible(False)
        for panel in panels[max(len(groups) - across, 0) : len(groups)]:
            panel.set_xlabel(known.abscissa)
            panel.tick_params(labelbottom=True)


def overview(
    ledger: Columns, probes: Columns, file: str | Path, *, labels: Labels | None = None, title: str = ""
) -> None:
    """Plot energies, the error of their balance, and all probes below each other; see `energy_plot`, `probes_plot`."""
    known = labels or Labels()
    names = [name for name in ledger if _is_energy(name)]
    groups = grouped(name for name in probes if name != "time")
    with drawn(file, [3.0, 1.8, *[1.5] * len(groups)], title or known.title) as panels:
        _draw_energies(panels[0], ledger, names, known)
        _draw_error(panels[1], ledger, names, "imbalance")
        for panel, (stem, columns) in zip(panels[2:], groups.items(), strict=True):
            _draw_probe(panel, probes, stem, columns, known)
        panels[-1].set_xlabel(known.abscissa)


def grouped(names: Iterable[str]) -> dict[str, list[str]]:
    """Columns by the names of their probes, told by endings such as x, xy and numbers.

    Examples
    --------
    >>> grouped(["angle", "load_x", "load_y", "load_z", "stress_xx"])
    {'angle': ['angle'], 'load': ['load_x', 'load_y', 'load_z'], 'stress': ['stress_xx']}
    """
    found: dict[str, list[str]] = {}
    for name in names:
        stem, _, end = name.rpartition("_")
        is_part = bool(stem) and (end.isdigit() or (0 < len(end) <= 2 and set(end) <= set("xyz")))
        found.setdefault(stem if is_part else name, []).append(name)
    return found


@contextmanager
def drawn(file: str | Path, heights: Sequence[float], title: str, across: int = 1) -> Iterator[list[Any]]:
    """Panels below each other, and side by side where there are many, that are written when they are filled.

    The figure is one of its own: no global state of matplotlib is read or changed beyond this.
    """
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    path = called(file, "plots", *FORMATS)
    settings: Any = {
        key: value for key, value in matplotlib.rcParamsDefault.items() if key != "backend"
    } | STYLE
    with matplotlib.rc_context(settings):
        size = (8.5 if across == 1 else 6.0 * across, sum(heights) + 0.9)
        figure = Figure(figsize=size, layout="constrained", dpi=200)
        FigureCanvasAgg(figure)
        panels: list[Any] = list(
            figure.subplots(len(heights), across, sharex=True, squeeze=False, height_ratios=heights).ravel()
        )
        yield panels
        figure.align_ylabels(panels)
        if title:
            figure.suptitle(title, color=INK, x=0.02, ha="left", fontsize=12)
        kind = path.suffix.lower()[1:]
        metadata = {"Software": "visviva"} if kind == "png" else {"Creator": "visviva", DATE[kind]: None}
        with reporting(path), replacing(path) as temporary:
            figure.savefig(str(temporary), format=kind, metadata=metadata)


DATE = {"pdf": "CreationDate", "svg": "Date"}
"""Metadata that would make files of equal plots differ."""


def _draw_probe(panel: Any, series: Columns, stem: str, names: Sequence[str], labels: Labels) -> None:
    for k, name in enumerate(names):
        end = name.removeprefix(stem).lstrip("_")
        panel.plot(series["time"], series[name], color=PALETTE[k % len(PALETTE)], label=end or None)
    units = {labels.columns.get(name, "") for name in names}
    unit = units.pop() if len(units) == 1 else ""
    panel.set_ylabel(f"{_spoken(stem)}\n[{unit}]" if unit else _spoken(stem))
    if len(names) > 1:
        panel.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0, fontsize=8)


def _draw_energies(panel: Any, columns: Columns, names: Sequence[str], labels: Labels) -> None:
    colors = iter(PALETTE * (1 + len(names) // len(PALETTE)))
    for name in names:
        sum_of_all = name == "total"
        look = {"color": INK, "linewidth": 2.2} if sum_of_all else {"color": next(colors)}
        panel.plot(columns["time"], columns[name], label=_spoken(name), **look)
    panel.set_ylabel(labels.axis("energy"))
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
