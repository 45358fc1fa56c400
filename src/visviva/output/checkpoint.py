"""The restart state: records of named and versioned parts, arrays and numbers stored bit for bit."""

from __future__ import annotations

import io
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.output.safe_files import replacing, reporting

FORMAT = "visviva state 7"
HEAD = 512  # bytes before the HDF5 file, which HDF5 leaves to its user: layout and checksum


@dataclass(frozen=True)
class Record:
    """Restart record of one part of a run.

    Attributes
    ----------
    name : str
        Of the part.
    version : int
        Of the layout of what follows.
    arrays : mapping of str to array
        Any numeric type and shape; a slash in a name makes a group.
    values : mapping
        Numbers and texts by name.
    """

    name: str
    version: int
    arrays: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    values: Mapping[str, float | str] = field(default_factory=dict)


class Records:
    """The records of a state file, taken one by one by the parts that wrote them.

    Parameters
    ----------
    path
        The file, for messages too.

    Raises
    ------
    InputError
        If the file is missing, damaged, or of another program or layout.
    """

    def __init__(self, path: str | Path) -> None:
        self.path, self._left = Path(path), load_state(path)

    @classmethod
    def of(cls, records: Iterable[Record], told: str = "a copy") -> Self:
        """Records that are in no file."""
        made = cls.__new__(cls)
        made.path, made._left = Path(told), {record.name: record for record in records}
        return made

    def take(self, name: str, version: int) -> Record:
        """The record of a part; refused if it is missing or of another version."""
        record = self.take_if_any(name, version)
        if record is None:
            raise InputError(f"{self.path}: has no record {name!r}; start the run anew in another directory")
        return record

    def take_if_any(self, name: str, version: int) -> Record | None:
        """The same of a part that may have had nothing to remember."""
        record = self._left.pop(name, None)
        if record is not None and record.version != version:
            raise InputError(
                f"{self.path}: its record {name!r} has version {record.version}, this version of visviva reads "
                f"{version}; resume with the version that wrote it, or start the run anew in another directory"
            )
        return record

    def take_all(self, start: str) -> list[Record]:
        """All whose names start so, in the order in which they were written."""
        return [self._left.pop(name) for name in list(self._left) if name.startswith(start)]

    def refuse_rest(self) -> None:
        """Refuse what nobody has taken: the run would go on without it."""
        if self._left:
            record = next(iter(self._left.values()))
            raise InputError(
                f"{self.path}: its record {record.name!r} (version {record.version}) is unknown to this version of "
                "visviva and this system; resume with the version that wrote it, or start the run anew in another "
                "directory"
            )


def save_state(path: str | Path, records: Iterable[Record]) -> None:
    """Write the state to one HDF5 file, replacing an older one only when the new one is complete.

    Parameters
    ----------
    path
        File to write.
    records
        With names of their own.

    Raises
    ------
    RunError
        If the file cannot be written; the older state is then still there.

    Examples
    --------
    >>> import tempfile, numpy
    >>> path = tempfile.mkdtemp() + "/state.h5"
    >>> save_state(path, [Record("ball", 1, {"q": numpy.array([0.1, 0.2])}, {"time": 0.5})])
    >>> ball = load_state(path)["ball"]
    >>> ball.version, ball.arrays["q"].tolist(), ball.values["time"]
    (1, [0.1, 0.2], 0.5)
    """
    image = _image(records)
    with reporting(Path(path)), replacing(Path(path)) as temporary:
        temporary.write_bytes(image)


def load_state(path: str | Path) -> dict[str, Record]:
    """Read what `save_state` wrote, by name.

    Raises
    ------
    InputError
        If the file is missing, damaged, or of another program or layout.
    """
    import h5py

    path = Path(path)
    try:
        image = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: is not a readable state file ({error.strerror})") from error
    _check(path, image)
    with h5py.File(io.BytesIO(image), "r") as file:
        return {name: _read(name, group) for name, group in file.items()}


def _read(name: str, group: Any) -> Record:
    arrays: dict[str, NDArray[Any]] = {}
    group["arrays"].visititems(
        lambda name, item: arrays.__setitem__(name, item[()]) if hasattr(item, "shape") else None
    )
    values = {key: _plain(value) for key, value in group["values"].attrs.items()}
    return Record(name, int(group.attrs["version"]), arrays, values)


def _image(records: Iterable[Record]) -> memoryview:
    """Compose the file in memory: a full disk then shows as one failed write of plain bytes."""
    import h5py

    memory = io.BytesIO()
    with h5py.File(memory, "w", track_order=True, userblock_size=HEAD) as file:
        for record in records:
            group = file.create_group(record.name)
            group.attrs["version"] = record.version
            arrays = group.create_group("arrays")
            for name, array in record.arrays.items():
                arrays.create_dataset(name, data=np.asarray(array))
            group.create_group("values").attrs.update(record.values)
    image = memory.getbuffer()
    head = f"{FORMAT}\n{sha256(image[HEAD:]).hexdigest()}\n".encode()
    image[: len(head)] = head
    return image


def _check(path: Path, image: bytes) -> None:
    """Refuse what is no state, one of another layout, or a damaged one."""
    lines = image[:HEAD].split(b"\n")
    if lines[0] == FORMAT.encode():
        if lines[1] != sha256(memoryview(image)[HEAD:]).hexdigest().encode():
            raise InputError(
                f"{path}: is damaged (its checksum does not fit); put back a copy, or start the run anew"
            )
    elif other := re.search(rb"visviva state \d+", image):
        raise InputError(
            f"{path}: has layout {other[0].decode()!r}, this version reads {FORMAT!r}; start the run anew"
        )
    else:
        raise InputError(
            f"{path}: is not a readable state file (it was not written by visviva, or is damaged)"
        )


def _plain(value: Any) -> float | str:
    plain: float | str = value.item() if isinstance(value, np.generic) else value
    return plain
