"""The text of a STEP file (ISO 10303-21) as records that refer to each other by number.

Tolerant: it knows no schema, skips what it cannot parse, and ignores comments and the contents of strings.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

__all__ = ["Enumeration", "Record", "Ref", "StepText", "decode_string", "not_a_number"]

# Every pattern takes what it has no end for up to the end of the text, so that scanning is linear.
_COMMENT = re.compile(r"('[^']*+(?:'|\Z))|/\*(?s:.*?)(?:\*/|\Z)")
_STATEMENT = re.compile(r"'[^']*+(?:'|\Z)|#(\d+)\s*+=\s*+((?:[^';]++|'[^']*+(?:'|\Z))*+)(;|\Z)")
_TYPE = re.compile(r"(\(?)\s*+([A-Z_][A-Z0-9_]*)", re.IGNORECASE)
_TOKEN = re.compile(
    r"\s*+(?:(?P<string>(?:'[^']*+')++)|\#(?P<ref>\d+)|\.(?P<enum>\w+)\.|(?P<word>[A-Z_][A-Z0-9_]*)"
    r"|(?P<number>[-+]?(?:\d++\.?\d*+|\.\d++)(?:E[-+]?\d++)?)|(?P<binary>\"[0-9A-F]*+\")|(?P<mark>[(),$*]))",
    re.IGNORECASE,
)
_REF = re.compile(r"'[^']*+'|#(\d+)")
_BAD_POINT = re.compile(r"#\d+\s*=\s*CARTESIAN_POINT\s*\(\s*'[^']*'\s*,\s*\([^()]*?(?:nan|inf|#)[^()]*\)\s*\)", re.I)
_ESCAPE = re.compile(
    r"\\\\|\\X2\\([0-9A-Fa-f]*)\\X0\\|\\X4\\([0-9A-Fa-f]*)\\X0\\|\\X\\([0-9A-Fa-f]{2})|\\S\\(.)|\\P([A-I])\\", re.S
)


@dataclass(frozen=True)
class Ref:
    """A reference ``#number`` to another record."""

    number: int


@dataclass(frozen=True)
class Enumeration:
    """An enumeration value ``.NAME.``."""

    name: str


@dataclass(frozen=True)
class Record:
    """One record, or one part of a complex record: its type and its parameters.

    A parameter is a :class:`Ref`, an :class:`Enumeration`, a string, a float, a tuple of parameters, a record
    (a typed value such as ``LENGTH_MEASURE(5.)``), or None for ``$`` and ``*``.
    """

    type: str
    parameters: tuple[object, ...]


@dataclass(frozen=True)
class StepText:
    """All records of a file by number; parsed when asked for.

    Parameters
    ----------
    bodies
        The text behind ``#number=``, in the order of the file.
    """

    bodies: dict[int, str]

    @classmethod
    def scan(cls, text: str) -> StepText:
        """Find the records in a file's text."""
        if "/*" in text:
            text = _COMMENT.sub(lambda found: found[1] or " ", text)
        statements = (found for found in _STATEMENT.finditer(text) if found[3] == ";")
        return cls({int(found[1]): found[2].rstrip() for found in statements})

    @cached_property
    def _by_type(self) -> dict[str, list[int]]:
        numbers: dict[str, list[int]] = defaultdict(list)
        for number, body in self.bodies.items():
            found = _TYPE.match(body)
            if found is None:
                continue
            names = {part.type for part in self.records(number)} if found[1] else {found[2].upper()}
            for name in names:
                numbers[name].append(number)
        return dict(numbers)

    @cached_property
    def positions(self) -> dict[int, int]:
        """1-based position of every record in the file."""
        return {number: position for position, number in enumerate(self.bodies, start=1)}

    def numbers(self, *types: str) -> list[int]:
        """Numbers of the records (complex ones too) of any of these types, ascending."""
        return sorted({number for name in types for number in self._by_type.get(name, ())})

    def records(self, number: int) -> tuple[Record, ...]:
        """The parts of a record: one, or several of a complex record; none where it is missing or unreadable."""
        body = self.bodies.get(number)
        if body is None:
            return ()
        return tuple(part for part in _parse(body) if isinstance(part, Record))

    def part(self, number: int, type_name: str) -> Record | None:
        """The part of a record with this type."""
        return next((part for part in self.records(number) if part.type == type_name), None)

    def parts(self, *types: str) -> Iterator[tuple[int, Record]]:
        """Number and part of every record with one of these types."""
        for number in self.numbers(*types):
            for part in self.records(number):
                if part.type in types:
                    yield number, part

    def type_of(self, number: int) -> str:
        """Type of a record, those of a complex record joined by "+"; empty where it is missing."""
        return "+".join(part.type for part in self.records(number))

    def references(self, number: int) -> tuple[int, ...]:
        """Numbers that a record refers to, in order."""
        return tuple(int(found[1]) for found in _REF.finditer(self.bodies.get(number, "")) if found[1])


def _parse(body: str) -> tuple[object, ...]:
    """Parameters of a body: one record, or the parts of a complex record; empty where it is malformed."""
    stack: list[tuple[str | None, list[object]]] = [(None, [])]
    word: str | None = None
    position = 0
    while position < len(body):
        found = _TOKEN.match(body, position)
        if found is None:
            return ()
        position = found.end()
        if found["word"]:
            word = found["word"].upper()
        elif found["mark"] == "(":
            stack.append((word, []))
            word = None
        elif found["mark"] == ")":
            if len(stack) == 1:
                return ()
            name, items = stack.pop()
            stack[-1][1].append(tuple(items) if name is None else Record(name, tuple(items)))
        elif found["mark"] != ",":
            stack[-1][1].append(_value(found))
    if len(stack) != 1:
        return ()
    items = stack[0][1]
    return items[0] if len(items) == 1 and isinstance(items[0], tuple) else tuple(items)


def _value(found: re.Match[str]) -> object:
    if found["string"] is not None:
        return decode_string(found["string"])
    if found["ref"] is not None:
        return Ref(int(found["ref"]))
    if found["enum"] is not None:
        return Enumeration(found["enum"].upper())
    if found["number"] is not None:
        return float(found["number"])
    return None


def decode_string(text: str) -> str:
    """Text of a quoted string, its escapes resolved (ISO 10303-21, 6.4.3).

    These are ``''`` and ``\\\\`` for one of each, ``\\X2\\...\\X0\\`` and ``\\X4\\...\\X0\\`` for UTF-16 and UTF-32,
    ``\\X\\hh`` for Latin-1, and ``\\S\\c`` for the upper half of a page of ISO 8859, which ``\\PA\\`` to
    ``\\PI\\`` choose.
    """
    page = 1

    def character(found: re.Match[str]) -> str:
        nonlocal page
        for group, digits, encoding in ((1, 4, "utf-16-be"), (2, 8, "utf-32-be"), (3, 2, "latin-1")):
            if found[group] is not None:
                codes = found[group][: len(found[group]) // digits * digits]
                return bytes.fromhex(codes).decode(encoding, "replace")
        if found[4]:
            return bytes([(ord(found[4]) | 0x80) & 0xFF]).decode(f"iso8859-{page}", "replace")
        if found[5]:
            page = ord(found[5]) - ord("A") + 1
            return ""
        return "\\"

    return _ESCAPE.sub(character, text[1:-1].replace("''", "'"))


def not_a_number(text: str) -> str | None:
    """The first point of a file with a coordinate that is no finite number, None where all are."""
    found = _BAD_POINT.search(text)
    return found[0] if found else None
