"""Small pieces of HTML that notebooks show: tables and lines over time."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

import numpy as np
from numpy.typing import ArrayLike


def table(rows: Iterable[Sequence[object]], head: Sequence[object] = (), title: str = "") -> str:
    """A table of texts; everything but what is HTML already (see `Markup`) is escaped.

    Examples
    --------
    >>> table([("a", 1)], title="<x>")
    '<table><caption>&lt;x&gt;</caption><tr><td>a</td><td>1</td></tr></table>'
    """
    caption = f"<caption>{escape(title)}</caption>" if title else ""
    top = f"<tr>{''.join(f'<th>{cell(item)}</th>' for item in head)}</tr>" if head else ""
    body = "".join(f"<tr>{''.join(f'<td>{cell(item)}</td>' for item in row)}</tr>" for row in rows)
    return f"<table>{caption}{top}{body}</table>"


class Markup(str):
    """Text that is HTML already."""


def cell(item: object) -> str:
    """Text of a cell."""
    return str(item) if isinstance(item, Markup) else escape(str(item))


def sparkline(values: ArrayLike, width: int = 160, height: int = 28, points: int = 200) -> Markup:
    """A line through values, as a drawing that needs nothing else.

    Examples
    --------
    >>> sparkline([0.0, 1.0])[:40]
    '<svg width="160" height="28" viewBox="0 '
    """
    y = np.asarray(values, dtype=float)
    y = y[np.linspace(0, len(y) - 1, min(len(y), points)).round().astype(int)] if len(y) else y
    known = np.isfinite(y)
    if known.sum() < 2:
        return Markup("")
    low, high = y[known].min(), y[known].max()
    level = (y - low) / (high - low) if high > low else np.full_like(y, 0.5)
    x = np.linspace(2, width - 2, len(y))
    path = " ".join(
        f"{a:.1f},{height - 3 - b * (height - 6):.1f}" for a, b in zip(x[known], level[known], strict=True)
    )
    line = f'<polyline points="{path}" fill="none" stroke="#4c78a8" stroke-width="1.4"/>'
    return Markup(f'<svg width="{width}" height="{height}" viewBox="0 0 {width} {height}">{line}</svg>')
