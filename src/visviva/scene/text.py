"""Scene files as plain data with the line of every key."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from visviva.errors import InputError

Key = tuple[str | int, ...]


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
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise InputError(f"{path}: there is no such file") from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read ({error})") from None
    return parse_toml(path, text) if path.suffix == ".toml" else parse_yaml(path, text)


def parse_toml(path: Path, text: str) -> Document:
    """Read TOML; lines are not known."""
    import tomllib

    try:
        return Document(path, tomllib.loads(text))
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: {error}") from None


def parse_yaml(path: Path, text: str) -> Document:
    """Read YAML; numbers such as 1e-3 are numbers, and no key may occur twice."""
    import yaml

    class Loader(yaml.SafeLoader):
        pass

    number = re.compile(r"^[-+]?(\d+\.?\d*|\.\d+)[eE][-+]?\d+$")
    Loader.add_implicit_resolver("tag:yaml.org,2002:float", number, list("-+.0123456789"))
    document = Document(path, None, lines := {})
    loader = Loader(text)

    def build(node: Any, key: Key) -> Any:
        lines[key] = node.start_mark.line + 1
        if isinstance(node, yaml.SequenceNode):
            return [build(item, (*key, k)) for k, item in enumerate(node.value)]
        if not isinstance(node, yaml.MappingNode):
            return loader.construct_object(node)
        data: dict[Any, Any] = {}
        for key_node, value_node in node.value:
            name = str(loader.construct_object(key_node))
            twice = name in data
            lines[(*key, name)] = key_node.start_mark.line + 1
            if twice:
                raise document.error((*key, name), f"the key {name!r} occurs twice")
            data[name] = build(value_node, (*key, name))
            lines[(*key, name)] = key_node.start_mark.line + 1
        return data

    try:
        node = loader.get_single_node()
        document.data = {} if node is None else build(node, ())
    except yaml.YAMLError as error:
        raise InputError(f"{path}: {' '.join(str(error).split())}") from None
    except RecursionError:
        raise InputError(f"{path}: is nested too deeply or contains itself") from None
    lines.pop((), None)
    return document
