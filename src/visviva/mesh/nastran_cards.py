"""Entries of Nastran's bulk data: lines in small, large and free format, their continuations, included files."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from visviva.base.errors import InputError
from visviva.mesh.source_files import included

BULK = re.compile(r"BEGIN(\s+BULK)?\s*$")
WHOLE = re.compile(r"[+-]?[0-9]+")
REAL = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)(E[+-]?[0-9]+)?")
Line = tuple[str, str]
"""Where it stands, and its text."""


@dataclass
class Card:
    """An entry: where it stands, its name in capitals, and its fields, eight a line."""

    where: str
    name: str
    fields: list[str] = field(default_factory=list)

    def word(self, k: int) -> str:
        """Field k behind the name, from 0 on; those left out are empty."""
        return self.fields[k] if k < len(self.fields) else ""

    def whole(self, k: int, blank: int = 0) -> int:
        """A whole number."""
        if self.word(k) and not WHOLE.fullmatch(self.word(k)):
            raise self.refused(f"has {self.word(k)!r} where a whole number belongs")
        return int(self.word(k) or blank)

    def real(self, k: int) -> float:
        """A number; blanks are zero, and the letter of an exponent may be left out.

        Examples
        --------
        >>> card = Card("line 1", "GRID", ["7.0", ".7E1", "0.7+1", "-70.-1", "7.D0", ""])
        >>> [card.real(k) for k in range(6)]
        [7.0, 7.0, 7.0, -7.0, 7.0, 0.0]
        """
        text = re.sub(r"(?<=[\d.])([+-])", r"E\1", self.word(k).upper().replace("D", "E"))
        if text and not REAL.fullmatch(text):
            raise self.refused(f"has {self.word(k)!r} where a number belongs")
        return float(text or 0.0)

    def refused(self, why: str) -> InputError:
        """The error that tells of it."""
        return InputError(f"{self.where}: {self.name} {' '.join(self.fields[:1])} {why}")


def cards(path: Path, within: Path | None = None) -> Iterator[Card]:
    """Entries of a file in order; included files are entered. Without a line BEGIN BULK all of it is bulk data."""
    now: Card | None = None
    tag = ""
    for where, line in _bulk(list(_lines(path, within))):
        try:
            name, words, mark = split(line)
        except InputError as error:
            raise InputError(f"{where}: {error}") from None
        if name and name[0] not in "+*":
            if now is not None:
                yield now
            now = Card(where, name.rstrip("*").strip().upper())
            if now.name.startswith("BEGIN"):
                raise now.refused("begins another model: write the file with one")
        elif now is None:
            raise InputError(f"{where}: {line.strip()!r} continues nothing")
        elif tag and name.strip("+* ") and tag != name.strip("+* "):
            raise now.refused(
                f"goes on in another line than the next ({where}): write them one behind the other"
            )
        if len(words) == 8 and len(now.fields) % 8 == 4:
            raise now.refused(
                f"has large fields and goes on in a line without * ({where}): begin that with *"
            )
        if len(words) == 8:
            now.fields += [""] * (-len(now.fields) % 8)
        now.fields += words
        tag = mark.strip("+* ")
    if now is not None:
        yield now


def split(line: str) -> tuple[str, list[str], str]:
    """Name, fields (four if they are large, else eight) and mark of continuation of a line.

    Examples
    --------
    >>> split("CQUAD4,1,7,1,2,3,4")
    ('CQUAD4', ['1', '7', '1', '2', '3', '4', '', ''], '')
    >>> split("GRID*   " + f"{1:16}{'':16}{0.5:16}{'2.':>16}" + "+A")
    ('GRID*', ['1', '', '0.5', '2.'], '+A')
    """
    if "," in line:
        name, *words = (word.strip() for word in line.split(","))
        n = 4 if "*" in name else 8
        words += [""] * (n + 1 - len(words))
        if any(words[n + 1 :]) or (words[n] and words[n][0] not in "+*"):
            raise InputError(
                f"the line has more than {n} fields behind its name: go on in the next, behind a comma"
            )
        return name, words[:n], words[n]
    text = line.expandtabs(8).ljust(80)
    width = 16 if "*" in text[:8] else 8
    return text[:8].strip(), [text[k : k + width].strip() for k in range(8, 72, width)], text[72:80].strip()


def _lines(path: Path, within: Path | None, depth: int = 0) -> Iterator[Line]:
    """Lines with data, without remarks."""
    with path.open(encoding="utf-8-sig", errors="replace") as file:
        numbered = enumerate(file, 1)
        for k, raw in numbered:
            line = raw.split("$")[0].rstrip()
            if not line or line.startswith(("//", "#")):
                continue
            where = f"{path.name}, line {k}" if depth else f"line {k}"
            if not line.lstrip().upper().startswith("INCLUDE"):
                yield where, line
                continue
            name = raw.strip()[7:].strip()
            if not name:
                raise InputError(f"{where}: INCLUDE names no file")
            while name[:1] in ("'", '"') and name.count(name[0]) == 1:
                more = next(numbered, None)
                if more is None:
                    raise InputError(f"{where}: INCLUDE has a name without an end")
                name += more[1].strip()
            name = name.split(name[0])[1] if name[:1] in ("'", '"') else name.split("$")[0].strip()
            yield from _lines(included(path.parent / name, path, within, depth + 1), within, depth + 1)


def _bulk(lines: list[Line]) -> Iterable[Line]:
    """What stands between BEGIN BULK and ENDDATA."""
    begin = next((k + 1 for k, (_, line) in enumerate(lines) if BULK.match(line.strip().upper())), 0)
    for where, line in lines[begin:]:
        if line.strip().upper().startswith("ENDDATA"):
            return
        yield where, line
