"""The restart state: arrays and numbers stored bit for bit."""

from __future__ import annotations

import io
import re
from collections.abc import Mapping
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.output.safe_files import replacing, reporting

FORMAT = "visviva state 6"
HEAD = 512  # bytes before the HDF5 file, which HDF5 leaves to its user: layout and checksum


def save_state(
    path: str | Path, arrays: Mapping[str, NDArray[Any]], attributes: Mapping[str, float | str]
) -> None:
    """Write the state to one HDF5 file, replacing an older one only when the new one is complete.

    Parameters
    ----------
    path
        File to write.
    arrays
        Arrays by name, any numeric type and shape; a slash in a name makes a group.
    attributes
        Numbers and texts by name.

    Raises
    ------
    RunError
        If the file cannot be written; the older state is then still there.

    Examples
    --------
    >>> import tempfile, numpy
    >>> path = tempfile.mkdtemp() + "/state.h5"
    >>> save_state(path, {"q": numpy.array([0.1, 0.2])}, {"time": 0.5, "scheme": "EnergyMomentum"})
    >>> arrays, attributes = load_state(path)
    >>> arrays["q"].tolist(), attributes["time"]
    ([0.1, 0.2], 0.5)
    """
    image = _image(arrays, attributes)
    with reporting(Path(path)), replacing(Path(path)) as temporary:
        temporary.write_bytes(image)


def load_state(path: str | Path) -> tuple[dict[str, NDArray[Any]], dict[str, float | str]]:
    """Read what `save_state` wrote.

    Returns
    -------
    arrays : dict of str to array
    attributes : dict of str to number or text

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
        arrays: dict[str, NDArray[Any]] = {}
        file["arrays"].visititems(
            lambda name, item: arrays.__setitem__(name, item[()]) if hasattr(item, "shape") else None
        )
        attributes = {name: _plain(value) for name, value in file["attributes"].attrs.items()}
    return arrays, attributes


def _image(arrays: Mapping[str, NDArray[Any]], attributes: Mapping[str, float | str]) -> memoryview:
    """Compose the file in memory: a full disk then shows as one failed write of plain bytes."""
    import h5py

    memory = io.BytesIO()
    with h5py.File(memory, "w", track_order=True, userblock_size=HEAD) as file:
        group = file.create_group("arrays")
        for name, array in arrays.items():
            group.create_dataset(name, data=np.asarray(array))
        file.create_group("attributes").attrs.update(attributes)
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
