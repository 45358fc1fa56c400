"""The kept states of a run as one file of rows, appended one by one and read one by one."""

from __future__ import annotations

import math
import os
import weakref
import zlib
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Generic, Self, TypeVar, overload

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.output.safe_files import replacing, reporting, settle, write_at

Array = NDArray[np.float64]
T = TypeVar("T")
Extent = tuple[int, int]
HEAD = 128
MAGIC = b"\x93NUMPY\x01\x00"


class StateFile:
    """Times, unknowns, rates and records of contacts in a file of numpy (``numpy.load`` reads it at any time).

    A row is appended first, then the header counts it in one write, so that a process may die at any moment.
    Memory does not grow with the rows: `times`, `states`, `rates` and `records` read from the file. Once it is
    closed they open it for as long as they read, and refuse it if its rows are no longer those written here.

    A row has the time, unknowns, rates and records. Of contacts nan stands for what is
    not there: gaps where nothing is near and of the second surface, everything at nodes within a body.

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
    _closing: weakref.finalize[..., StateFile]
    _known: tuple[int, ...]

    def __init__(self, path: str | Path, n: int, shapes: Sequence[tuple[int, ...]] = ()) -> None:
        self._describe(path, n, shapes)
        with reporting(self.path):
            with replacing(self.path) as temporary:
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
            if not kept._holds_rows(kept._descriptor):
                kept.close()
                raise InputError(f"{path}: is damaged (its first {count} states are not those of the run)")
        except OSError as error:
            raise InputError(f"{path}: cannot be read ({error.strerror})") from error
        with reporting(kept.path):
            os.ftruncate(kept._descriptor, HEAD + count * kept.n_bytes)
            write_at(kept._descriptor, kept._head(count), 0)
        return kept

    @classmethod
    def written(cls, path: str | Path, n: int, shapes: Sequence[tuple[int, ...]], extent: Extent) -> Self:
        """The file of states of a run in another process, opened for reading."""
        kept = cls.__new__(cls)
        kept._describe(path, n, shapes)
        (kept.count, kept.checksum), kept._known = extent, ()
        kept._closing = weakref.finalize(kept, int)
        kept._closing.detach()
        return kept

    @property
    def extent(self) -> Extent:
        """Number of the rows, and their checksum."""
        return self.count, self.checksum

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
        """Records of contacts at these times."""
        return Column(self, self._records_of)

    def row(self, k: int) -> Array:
        """All numbers of a state, to be read.

        Raises
        ------
        InputError
            If the file is gone, or another run has written there since.
        """
        with self._reading() as descriptor:
            data = self._bytes(descriptor, k)
        if len(data) < self.n_bytes:
            raise self._lost()
        return np.frombuffer(data, dtype=np.float64)

    def sync(self) -> None:
        """Make sure that what is written outlives a loss of power."""
        with reporting(self.path):
            settle(self.path, self._descriptor)

    def close(self) -> None:
        """Close the file; no more rows are appended, and reading opens it. Closing twice is harmless."""
        if self._closing.alive:
            self._known = _identity(self._descriptor)
            self._closing()

    def _describe(self, path: str | Path, n: int, shapes: Sequence[tuple[int, ...]]) -> None:
        self.path = Path(path).absolute()  # it is opened again later, maybe from another working directory
        self._n, self._shapes = n, [tuple(shape) for shape in shapes]
        self.n_bytes = 8 * (1 + 2 * n + sum(map(math.prod, self._shapes)))

    def _open(self, count: int, checksum: int) -> None:
        self.count, self.checksum = count, checksum
        self._descriptor = os.open(self.path, os.O_RDWR)
        self._closing = weakref.finalize(self, os.close, self._descriptor)

    @contextmanager
    def _reading(self) -> Iterator[int]:
        """The descriptor that rows are read from: that of the writer, or one for this moment."""
        if self._closing.alive:
            yield self._descriptor
            return
        try:
            descriptor = os.open(self.path, os.O_RDONLY)
        except OSError as error:
            raise InputError(
                f"{self.path}: cannot be read ({error.strerror}); the result's states were there, run it again"
            ) from error
        try:
            self._refuse_other(descriptor)
            yield descriptor
        finally:
            os.close(descriptor)

    def _refuse_other(self, descriptor: int) -> None:
        """Refuse a file with other rows; who has touched it may have added some, as a run that was resumed."""
        identity = _identity(descriptor)
        if identity != self._known:
            if not self._holds_rows(descriptor):
                raise self._lost()
            self._known = identity

    def _lost(self) -> InputError:
        return InputError(
            f"{self.path}: holds the states of another run by now, and not those of this result; give every run a "
            "directory of its own"
        )

    def _bytes(self, descriptor: int, k: int) -> bytes:
        return os.pread(descriptor, self.n_bytes, HEAD + k * self.n_bytes)

    def _holds_rows(self, descriptor: int) -> bool:
        found = 0
        for k in range(self.count):
            found = zlib.crc32(self._bytes(descriptor, k), found)
        whole = os.fstat(descriptor).st_size >= HEAD + self.count * self.n_bytes
        return whole and found == self.checksum

    def _head(self, count: int) -> bytes:
        shape = f"({count}, {self.n_bytes // 8})"
        text = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}".ljust(HEAD - 11) + "\n"
        return MAGIC + (HEAD - 10).to_bytes(2, "little") + text.encode()

    def _records_of(self, row: Array) -> list[Array]:
        ends = np.cumsum([1 + 2 * self._n, *map(math.prod, self._shapes)])
        return [row[a:b].reshape(s) for a, b, s in zip(ends, ends[1:], self._shapes, strict=False)]


def _identity(descriptor: int) -> tuple[int, ...]:
    """Mark of a file that changes as soon as it is written to or replaced."""
    status = os.fstat(descriptor)
    return status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns


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
