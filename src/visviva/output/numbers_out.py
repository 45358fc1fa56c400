"""Columns of numbers as tables of pandas and as CSV."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.base.world import by_first
from visviva.output.tables import Table

Array = NDArray[np.float64]


def dataframe(columns: Mapping[str, Array]) -> Any:
    """A table of pandas whose index is the first column, the times.

    Raises
    ------
    InputError
        If pandas is not installed.
    """
    try:
        import pandas  # type: ignore[import-untyped, unused-ignore]
    except ImportError as error:
        raise InputError(
            "a DataFrame needs: pip install 'visviva[tables]' (pandas); to_csv does not"
        ) from error
    return pandas.DataFrame(dict(columns)).set_index(next(iter(columns)))


def write_table(path: str | Path, columns: Mapping[str, tuple[Array, str]]) -> Path:
    """Write columns with their units as CSV, which all processes have; returns the path.

    Examples
    --------
    >>> import tempfile
    >>> file = write_table(tempfile.mkdtemp() + "/a.csv", {"time": (np.zeros(1), "s"), "x": (np.ones(1), "mm")})
    >>> file.read_text().splitlines()
    ['time [s],x [mm]', '0.0,1.0']
    """

    def write() -> None:
        with Table(path, {name: unit for name, (_, unit) in columns.items()}) as table:
            for row in zip(*(values for values, _ in columns.values()), strict=True):
                table.append(row)

    by_first(f"write {path}", write)
    return Path(path)
