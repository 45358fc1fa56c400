"""The kept states of a run as one file of rows, appended one by one and read one by one."""

from __future__ import annotations

import math
import os
import weakref
import zlib
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Generic, Self, TypeVar, overload

import numpy as np
from numpy.typing import NDArray

from visviva.errors import InputError
from visviva.output.files import replacing, reporting, write_at

Array = NDArray[np.float64]
T = TypeVar("T")
HEAD = 128
MAGIC = b"\x93NUMPY\x01\x00"


class StateFile:
    """Times, unknowns, rates and records of contacts in a file of numpy (``numpy.load`` reads it at any time).

    A row is appended first, then the header counts it in one write, so that a process may die at any moment.
    Memory does not grow with the rows: `times`, `states`, `rates` and `records` read from the file.

    Parameters
    ----------
    path
        File to write; an older one is replaced.
    n : int
        Number of unknowns.
    shapes : sequence of shapes
        Of the records of contacts.

    Attributes
    ----------
    count : int
        Rows so far.
    checksum : int
        Of all rows.

    Examples
    --------
    >>> import tempfile
    >>> kept = StateFile(tempfile.mkdtemp() + "/states.npy", 2)
    >>> for k in range(3):
    ...     kept.append(0.1 * k, [k, 1], [0, 0], [])
    >>> len(kept.times), kept.states[-1].tolist(), np.load(kept.path).shape
    (3, [2.0, 1.0], (3, 5))
    """

    count: int
    checksum: int
    _descriptor: int

    def __init__(self, path: str | Path, n: int, shapes: Sequence[tuple[int, ...]] = ()) -> None:
        self._describe(path, n, shapes)
        with reporting(self.path), replacing(self.path) as temporary:
            temporary.write_bytes(self._head(0))
        self._open(0, 0)

    @classmethod
    def reopen(
        cls, path: str | Path, n: int, shapes: Sequence[tuple[int, ...]], count: int, checksum: int
    ) -> Self:
        """Continue a file after its first `count` rows.

        Raises
        ------
        InputError
            If these are not the rows that were written.
        """
        kept = cls.__new__(cls)
        kept._describe(path, n, shapes)
        try:
            kept._open(count, checksum)
            size = os.fstat(kept._descriptor).st_size
            if size < HEAD + count * kept.n_bytes or kept._sum(count) != checksum:
                raise InputError(f"{path}: is damaged (its first {count} states are not those of the run)")
        except OSError as error:
            raise InputError(f"{path}: cannot be read ({error.strerror})") from error
        with reporting(kept.path):
            os.ftruncate(kept._descriptor, HEAD + count * kept.n_bytes)
            write_at(kept._descriptor, kept._head(count), 0)
        return kept

    def append(self, time: float, x: Array, v: Array, records: Sequence[Array]) -> None:
        """Keep a state.

        Raises
        ------
        RunError
            If the file cannot be written; the rows before stay readable.
        """
        row = np.concatenate([[time], x, v, *(np.ravel(r) for r in records)]).astype(np.float64)
        if row.nbytes != self.n_bytes:
            raise InputError(f"{self.path}: a state of {len(row)} numbers among such of {self.n_bytes // 8}")
        with reporting(self.path):
            write_at(self._descriptor, row.data, HEAD + self.count * self.n_bytes)
            write_at(self._descriptor, self._head(self.count + 1), 0)
        self.count += 1
        self.checksum = zlib.crc32(row.data, self.checksum)

    @property
    def times(self) -> Column[float]:
        """Times of the states."""
        return Column(self, lambda row: float(row[0]))

    @property
    def states(self) -> Column[Array]:
        """Unknowns (n,) at these times."""
        return Column(self, lambda row: row[1 : 1 + self._n])

    @property
    def rates(self) -> Column[Array]:
        """Rates (n,) at these times."""
        return Column(self, lambda row: row[1 + self._n : 1 + 2 * self._n])

    @property
    def records(self) -> Column[list[Array]]:
        """What contacts showed at these times."""
        return Column(self, self._records_of)

    def row(self, k: int) -> Array:
        """All numbers of a state."""
        data = os.pread(self._descriptor, self.n_bytes, HEAD + k * self.n_bytes)
        return np.frombuffer(data, dtype=np.float64).copy()

    def sync(self) -> None:
        """Make sure that what is written outlives a loss of power."""
        with reporting(self.path):
            os.fsync(self._descriptor)

    def _describe(self, path: str | Path, n: int, shapes: Sequence[tuple[int, ...]]) -> None:
        self.path, self._n, self._shapes = Path(path), n, [tuple(shape) for shape in shapes]
        self.n_bytes = 8 * (1 + 2 * n + sum(map(math.prod, self._shapes)))

    def _open(self, count: int, checksum: int) -> None:
        self.count, self.checksum = count, checksum
        self._descriptor = os.open(self.path, os.O_RDWR)
        weakref.finalize(self, os.close, self._descriptor)  # it is read as long as a result lives

    def _head(self, count: int) -> bytes:
        shape = f"({count}, {self.n_bytes // 8})"
        text = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}".ljust(HEAD - 11) + "\n"
        return MAGIC + (HEAD - 10).to_bytes(2, "little") + text.encode()

    def _records_of(self, row: Array) -> list[Array]:
        ends = np.cumsum([1 + 2 * self._n, *map(math.prod, self._shapes)])
        return [row[a:b].reshape(s) for a, b, s in zip(ends, ends[1:], self._shapes, strict=False)]

    def _sum(self, count: int) -> int:
        found = 0
        for k in range(count):
            found = zlib.crc32(self.row(k).data, found)
        return found


class Column(Sequence[T], Generic[T]):
    """One quantity of all rows, read when it is asked for."""

    def __init__(self, file: StateFile, of_row: Callable[[Array], T]) -> None:
        self._file, self._of_row = file, of_row

    def __len__(self) -> int:
        return self._file.count

    @overload
    def __getitem__(self, k: int) -> T: ...
    @overload
    def __getitem__(self, k: slice) -> list[T]: ...
    def __getitem__(self, k: int | slice) -> T | list[T]:
        numbers = range(self._file.count)[k]
        if isinstance(numbers, range):
            return [self._of_row(self._file.row(j)) for j in numbers]
        return self._of_row(self._file.row(numbers))
