"""YAML by the core schema of YAML 1.2, in bounds: nothing large is built before its size is known.

Only true and false are Booleans; there are no dates, no sexagesimal numbers, no octal ones but ``0o17``, no underscores
in numbers. Keys are texts as they stand. Aliases are copies.
"""

from __future__ import annotations

import copy
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, NoReturn

import yaml

from visviva.base.errors import InputError

Key = tuple[str | int, ...]
Place = tuple[Key, int]
"""Key and line."""

MAX_DEPTH = 50  # of lists and mappings in each other
MAX_ALIASED = 10_000  # values that aliases stand for
MAX_KEY = 200  # characters
MAX_SCALAR = 100_000
MAX_NUMBER = 100

INT = re.compile(r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+")
FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
NAMED: dict[str, Any] = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL")),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
    **{sign + inf: math.inf for sign in ("", "+") for inf in (".inf", ".Inf", ".INF")},
    **{"-" + inf: -math.inf for inf in (".inf", ".Inf", ".INF")},
    **dict.fromkeys((".nan", ".NaN", ".NAN"), math.nan),
}
TAGS: dict[str, tuple[type, ...]] = {
    "int": (int,), "float": (int, float), "bool": (bool,), "null": (type(None),)
}  # fmt: skip
FORBIDDEN = re.compile("[^\t\n\r\x20-\x7e\x85\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


class Unreadable(InputError):
    """Error of an unreadable text, with the line and the key if they are known."""

    def __init__(self, message: str, line: int | None = None, key: Key = ()) -> None:
        super().__init__(message)
        self.message, self.line, self.key = message, line, key


def number(text: str) -> int | float | None:
    """The number that a text means in the core schema; None if it means none.

    Examples
    --------
    >>> [number(text) for text in ("12", "0o17", "0x1F", "1e-3", ".5", "1_000", "12:30")]
    [12, 15, 31, 0.001, 0.5, None, None]
    """
    if FLOAT.fullmatch(text) or INT.fullmatch(text):
        if len(text) > MAX_NUMBER:
            raise Unreadable(f"the number {text[:20]}... has {len(text)} characters, more than {MAX_NUMBER}")
        found = (
            int(text, 0 if text[1:2] in "ox" and text[1:2] else 10) if INT.fullmatch(text) else float(text)
        )
        if math.isinf(found) or abs(found) > 1e308:
            raise Unreadable(f"the number {text} is too large")
        return found
    return None


def plain(text: str) -> Any:
    """Value of a scalar without quotes and tag: null, a Boolean, a number, or the text itself."""
    if text in NAMED:
        return NAMED[text]
    found = number(text)
    return text if found is None else found


def tagged(tag: str, text: str) -> Any:
    """Value of a scalar with a tag."""
    kind = tag.removeprefix("tag:yaml.org,2002:")
    if tag == "!" or kind == "str":
        return text
    if kind not in TAGS:
        raise Unreadable(f"the tag {shown_tag(tag)} means nothing here: leave it out")
    found: Any = plain(text)
    if not isinstance(found, TAGS[kind]) or (isinstance(found, bool) and kind != "bool"):
        raise Unreadable(f"{text[:40]!r} is no {kind}, as its tag says")
    return float(text) if kind == "float" else found


def shown_tag(tag: str) -> str:
    """A tag as it is written, short."""
    return tag.replace("tag:yaml.org,2002:", "!!")[:60]


@dataclass
class Builder:
    """Builds plain data from the events of a parser, with the line of every key."""

    events: Iterator[Any]
    lines: dict[Key, int] = field(default_factory=dict)
    anchors: dict[str, tuple[Any, int]] = field(default_factory=dict)  # values, and of how many parts
    aliased: int = 0

    def document(self) -> Any:
        """The data of the one document in the text."""
        next(self.events)  # the stream starts
        event = next(self.events)
        if isinstance(event, yaml.StreamEndEvent):
            return None
        data, _ = self.node((), next(self.events))
        next(self.events)  # the document ends
        if not isinstance(event := next(self.events), yaml.StreamEndEvent):
            raise Unreadable("it holds more than one document", line(event))
        return data

    def node(self, key: Key, event: Any) -> tuple[Any, int]:
        """A value, and of how many parts it is."""
        self.lines.setdefault(key, line(event))
        if len(key) > MAX_DEPTH:
            refuse(event, key[:3], f"it is nested more than {MAX_DEPTH} deep")
        if isinstance(event, yaml.AliasEvent):
            return self.alias(key, event)
        if isinstance(event, yaml.ScalarEvent):
            made = scalar(key, event), 1
        else:
            if event.tag not in (None, "!", "tag:yaml.org,2002:map", "tag:yaml.org,2002:seq"):
                refuse(event, key, f"the tag {shown_tag(event.tag)} means nothing here: leave it out")
            made = (self.mapping if isinstance(event, yaml.MappingStartEvent) else self.sequence)(key)
        if event.anchor is not None:
            self.anchors[event.anchor] = made
        return made

    def alias(self, key: Key, event: Any) -> tuple[Any, int]:
        """A copy of what an alias stands for; the line of what is in it is that of the alias."""
        if event.anchor not in self.anchors:
            refuse(event, key, f"the alias *{event.anchor[:60]} contains itself or names no anchor before it")
        value, size = self.anchors[event.anchor]
        self.aliased += size
        if self.aliased > MAX_ALIASED:
            refuse(event, key, f"its aliases stand for more than {MAX_ALIASED} values: write them out")
        return copy.deepcopy(value), size

    def sequence(self, key: Key) -> tuple[list[Any], int]:
        """A list."""
        items: list[Any] = []
        size = 1
        while not isinstance(event := next(self.events), yaml.SequenceEndEvent):
            item, parts = self.node((*key, len(items)), event)
            items.append(item)
            size += parts
        return items, size

    def mapping(self, key: Key) -> tuple[dict[str, Any], int]:
        """A mapping from texts."""
        data: dict[str, Any] = {}
        size = 1
        while not isinstance(event := next(self.events), yaml.MappingEndEvent):
            if not isinstance(event, yaml.ScalarEvent):
                refuse(event, key, "a key is a text, not a list, mapping or alias")
            name = text_of(key, event)
            if len(name) > MAX_KEY:
                refuse(event, key, f"the key {name[:20]}... has {len(name)} characters, more than {MAX_KEY}")
            if name in data:
                refuse(event, (*key, name), f"the key {name!r} occurs twice")
            self.lines[(*key, name)] = line(event)
            data[name], parts = self.node((*key, name), next(self.events))
            size += parts
        return data, size


def scalar(key: Key, event: Any) -> Any:
    """The value of a scalar."""
    text = text_of(key, event)
    try:
        if event.tag is not None:
            return tagged(event.tag, text)
        return plain(text) if event.implicit[0] else text
    except Unreadable as error:
        refuse(event, key, error.message)


def text_of(key: Key, event: Any) -> str:
    """The text of a scalar."""
    text: str = event.value
    if len(text) > MAX_SCALAR:
        refuse(event, key, f"a text of {len(text)} characters is too long: {MAX_SCALAR} are allowed")
    if "\0" in text:
        refuse(event, key, "a text must not hold the character NUL")
    return text


def line(event: Any) -> int:
    """Line of an event, counted from 1."""
    return int(event.start_mark.line) + 1


def refuse(event: Any, key: Key, message: str) -> NoReturn:
    """Raise what names line and key."""
    raise Unreadable(message, line(event), key)


def load(text: str) -> tuple[Any, dict[Key, int]]:
    """Plain data of a text in YAML, and the lines of its keys.

    Raises
    ------
    Unreadable
        If it is not YAML, or beyond what is allowed.

    Examples
    --------
    >>> load("on: [yes, 1e-3, 012, 2001-12-14, true]")[0]
    {'on': ['yes', 0.001, 12, '2001-12-14', True]}
    """
    found = FORBIDDEN.search(text)
    if found is not None:
        where = text.count("\n", 0, found.start()) + 1
        raise Unreadable(f"the character {found[0]!a} is not allowed in YAML", where)
    builder = Builder(yaml.parse(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader)))
    try:
        return builder.document(), builder.lines
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        told = " ".join(f"{error.context or ''} {error.problem or ''}".split())
        if "maximum nesting depth" in told:  # newer parsers have a limit of their own
            told = f"it is nested more than {MAX_DEPTH} deep"
        raise Unreadable(told, mark.line + 1 if mark else None) from None
    except yaml.YAMLError as error:
        raise Unreadable(" ".join(str(error).split())) from None
