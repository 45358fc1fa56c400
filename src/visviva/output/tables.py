"""Time series as CSV: the ledger and the probes."""

from __future__ import annotations

import io
import os
import zlib
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Self

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.output.labels import with_unit, without_unit
from visviva.output.safe_files import replacing, reporting, settle, write_at

LOAD = "load_parameter"
"""The clock of statics, in files."""


class Table:
    """Rows of numbers written to a CSV file one by one, in full precision.

    Every row reaches the file as one whole, so a process killed at any moment leaves complete rows
    and at most one torn last line, which `read_table` and `reopen` leave out.

    Parameters
    ----------
    path
        File to create; an existing one is replaced.
    columns
        Names of the columns; the first is ``time``, or ``load_parameter``, which is read as ``time`` again. A mapping
        gives each its unit, which stands behind it in the file.

    Attributes
    ----------
    path : Path
    columns : tuple of str
    checksum : int
        Of all that the file holds.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "probes.csv"
    >>> with Table(path, ["time", "angle"]) as table:
    ...     table.append([0.0, 0.1])
    ...     table.append([0.5, 1 / 3])
    >>> read_table(path)["angle"].tolist()
    [0.1, 0.3333333333333333]
    """

    path: Path
    columns: tuple[str, ...]
    _descriptor: int
    _end: int
    _last_time: float | None
    checksum: int

    def __init__(self, path: str | Path, columns: Sequence[str] | Mapping[str, str]) -> None:
        self.path = Path(path).absolute()  # results read it later, maybe from another working directory
        self.columns = _clocked(columns)
        _check_columns(self.columns)
        header = _header(columns).encode()
        with reporting(self.path), replacing(self.path) as temporary:
            temporary.write_bytes(header)
        self._open(rows_end=len(header), last_time=None, checksum=zlib.crc32(header))

    @classmethod
    def reopen(cls, path: str | Path, columns: Sequence[str], rows: int, checksum: int) -> Self:
        """Continue an existing table after its first `rows` rows, which must be those that were written.

        Raises
        ------
        InputError
            If the file is no table, holds other columns, or other rows.
        """
        table = cls.__new__(cls)
        table.path, table.columns = Path(path).absolute(), _clocked(columns)
        text = _complete_lines(table.path)
        if _names(text) != list(table.columns):
            raise InputError(f"{path}: holds other columns than {list(columns)}; resume with the same probes")
        lines = text.splitlines(keepends=True)
        kept = b"".join(lines[: rows + 1])
        if len(lines) < rows + 1 or zlib.crc32(kept) != checksum:
            raise InputError(
                f"{path}: is damaged (its first {rows} rows are not those of the run); put back a copy, or start anew"
            )
        with reporting(table.path):
            os.truncate(table.path, len(kept))
        last = float(lines[rows].split(b",", 1)[0]) if rows else None
        table._open(len(kept), last, checksum)
        return table

    @classmethod
    def written(cls, path: str | Path, columns: Sequence[str], extent: tuple[int, int]) -> Self:
        """The tables of a run in another process, opened for reading."""
        table = cls.__new__(cls)
        table.path, table.columns = Path(path).absolute(), _clocked(columns)
        (table._end, table.checksum), table._last_time, table._descriptor = extent, None, -1
        return table

    @property
    def extent(self) -> tuple[int, int]:
        """Number of bytes, and their checksum."""
        return self._end, self.checksum

    def append(self, row: Sequence[float] | NDArray[np.float64]) -> None:
        """Write one row, values in the order of the columns.

        Raises
        ------
        InputError
            If the number of values differs from the number of columns.
        RunError
            If the file cannot be written; the rows before stay intact.
        """
        values = [float(value) for value in row]
        if len(values) != len(self.columns):
            raise InputError(f"{self.path}: a row of {len(values)} values for {len(self.columns)} columns")
        line = (",".join(map(repr, values)) + "\n").encode()
        with reporting(self.path, self._last_time):
            try:
                write_at(self._descriptor, line, self._end)
            except OSError:
                os.ftruncate(self._descriptor, self._end)
                raise
        self._end += len(line)
        self._last_time = values[0]
        self.checksum = zlib.crc32(line, self.checksum)

    def read(self) -> NDArray[np.float64]:
        """The rows that were written (n, columns).

        Raises
        ------
        InputError
            If the file is gone, or another run has written there since.
        """
        text = _complete_lines(self.path)[: self._end]
        if zlib.crc32(text) != self.checksum:
            raise InputError(
                f"{self.path}: holds the rows of another run by now, and not those of this result; give every run a "
                "directory of its own"
            )
        return _values(self.path, text, len(self.columns))

    def sync(self) -> None:
        """Make sure that what is written outlives a loss of power."""
        with reporting(self.path, self._last_time):
            settle(self.path, self._descriptor)

    def close(self) -> None:
        """Close the file; closing twice is harmless."""
        if self._descriptor >= 0:
            os.close(self._descriptor)
            self._descriptor = -1

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _open(self, rows_end: int, last_time: float | None, checksum: int) -> None:
        self._end, self._last_time, self.checksum = rows_end, last_time, checksum
        with reporting(self.path):
            self._descriptor = os.open(self.path, os.O_WRONLY)


def read_table(path: str | Path) -> dict[str, NDArray[np.float64]]:
    """Read a table written by `Table`: one array per column, a torn last line left out.

    Returns
    -------
    dict of str to (n,) array

    Raises
    ------
    InputError
        If the file is missing or is no such table.
    """
    text = _complete_lines(Path(path))
    names = _names(text)
    if names[0] != "time":
        raise InputError(f"{path}: is no table of visviva, or damaged (its first column is not 'time')")
    values = _values(Path(path), text, len(names))
    return {name: values[:, column].copy() for column, name in enumerate(names)}


def _values(path: Path, text: bytes, n_columns: int) -> NDArray[np.float64]:
    """Rows (n, n_columns) below the header."""
    if text.count(b"\n") < 2:
        return np.empty((0, n_columns))
    try:
        values = np.loadtxt(io.BytesIO(text), delimiter=",", skiprows=1, ndmin=2)
    except ValueError as error:
        raise InputError(f"{path}: not a table of numbers ({error})") from error
    if values.shape[1] != n_columns:
        raise InputError(f"{path}: {values.shape[1]} values per row under {n_columns} column names")
    return values


def _complete_lines(path: Path) -> bytes:
    try:
        text = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from error
    return text[: text.rfind(b"\n") + 1]


def _names(text: bytes) -> list[str]:
    """Names of the columns, without their units; the first is ``time``, whatever that is."""
    header = text.split(b"\n", 1)[0].decode(errors="replace")
    return list(_clocked([without_unit(name) for name in header.split(",")]))


def _clocked(columns: Iterable[str]) -> tuple[str, ...]:
    """Names of columns in which the first is ``time``, whatever that is."""
    names = tuple(columns)
    return ("time", *names[1:]) if names and names[0] == LOAD else names


def _header(columns: Sequence[str] | Mapping[str, str]) -> str:
    named = [with_unit(*item) for item in columns.items()] if isinstance(columns, Mapping) else columns
    return ",".join(named) + "\n"


def _check_columns(columns: Sequence[str]) -> None:
    if not columns or columns[0] != "time":
        raise InputError(f"the first column of a table is 'time', not {columns[:1]}")
    if len(set(columns)) < len(columns):
        raise InputError(f"column names occur twice: {sorted({c for c in columns if columns.count(c) > 1})}")
    for name in columns:
        if not name or any(mark in name for mark in ',"\n\r'):
            raise InputError(
                f"column name {name!r}: must not be empty or contain commas, quotes or line breaks"
            )
