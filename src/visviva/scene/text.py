"""Scene files as plain data with the line of every key."""

from __future__ import annotations

import datetime
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from visviva.base.errors import InputError
from visviva.scene import yaml12
from visviva.scene.yaml12 import Key

MAX_SIZE = 1 << 22
"""Bytes of a scene file."""


@dataclass
class Document:
    """The data of a file, and where in the file it stands."""

    file: Path
    data: Any
    lines: Mapping[Key, int] = field(default_factory=dict)

    def error(self, key: Key, message: str) -> InputError:
        """An error that names file, line and key."""
        known = key
        while known and known not in self.lines:
            known = known[:-1]
        place = f"{self.file}:{self.lines[known]}" if known else str(self.file)
        return InputError(f"{place}: {'.'.join(map(str, key)) + ': ' if key else ''}{message}")


def parse(file: str | Path) -> Document:
    """Read a YAML or TOML file.

    Raises
    ------
    InputError
        If it cannot be read or contradicts the rules of its notation.
    """
    path = Path(file)
    text = read(path)
    return parse_toml(path, text) if path.suffix == ".toml" else parse_yaml(path, text)


def read(path: Path) -> str:
    """The text of a file that is not too long to be a scene."""
    try:
        if not path.is_file():
            raise FileNotFoundError
        if path.stat().st_size > MAX_SIZE:
            raise InputError(
                f"{path}: is larger than {MAX_SIZE >> 20} MiB: keep meshes in files of their own"
            )
        return path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise InputError(f"{path}: there is no such file") from None
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: cannot be read ({error.reason} at byte {error.start})") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from None


def parse_yaml(path: Path, text: str) -> Document:
    """Read YAML; no key may occur twice."""
    document = Document(path, None)
    try:
        data, document.lines = yaml12.load(text)
    except yaml12.Unreadable as error:
        place = ".".join(map(str, error.key)) + ": " if error.key else ""
        raise InputError(f"{path}:{error.line or 1}: {place}{error.message}") from None
    document.data = {} if data is None else data
    return document


def parse_toml(path: Path, text: str) -> Document:
    """Read TOML; lines are not known."""
    import tomllib

    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: {error}") from None
    except RecursionError:
        raise InputError(f"{path}: it is nested too deeply") from None
    except ValueError as error:  # from numbers that are too long, for one
        raise InputError(f"{path}: {error}") from None
    document = Document(path, data)
    refuse_odd(document, (), data)
    return document


def refuse_odd(document: Document, key: Key, data: Any) -> None:
    """Refuse dates and what is too deep, too long or too large."""
    if len(key) > yaml12.MAX_DEPTH:
        raise document.error(key[:3], f"it is nested more than {yaml12.MAX_DEPTH} deep")
    if isinstance(data, str) and ("\0" in data or len(data) > yaml12.MAX_SCALAR):
        raise document.error(key, "a text is too long or holds the character NUL")
    if isinstance(data, int) and abs(data) > 1e308:
        raise document.error(key, "a number is too large")
    if isinstance(data, datetime.date | datetime.time):
        raise document.error(key, f"a date or time, {data}, means nothing here")
    if not isinstance(data, dict | list):
        return
    for name, item in data.items() if isinstance(data, dict) else enumerate(data):
        if isinstance(name, str) and len(name) > yaml12.MAX_KEY:
            raise document.error(key, f"the key {name[:20]}... has {len(name)} characters")
        refuse_odd(document, (*key, name), item)
