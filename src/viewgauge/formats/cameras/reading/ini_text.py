"""INI files as sections of keys and values, as stereo cameras bring them."""

from __future__ import annotations

import re

from ...files.problems import Problems

__all__ = ["ini_sections", "is_ini"]

_HEADER = re.compile(r"^\s*\[([^\[\]\n,]+)\]\s*$")
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")


def is_ini(text: str) -> bool:
    """Whether the first line with content is the header of a section."""
    lines = (line.strip() for line in text.splitlines())
    first = next((line for line in lines if line and line[0] not in "#;"), "")
    return _HEADER.match(first) is not None


def ini_sections(text: str, problems: Problems) -> dict[str, dict[str, object]]:
    """Keys and values by section; numbers as numbers."""
    found: dict[str, dict[str, object]] = {}
    here: dict[str, object] | None = None
    for number, line in enumerate(text.splitlines(), start=1):
        stripped = re.split(r"\s[#;]", line, maxsplit=1)[0].strip()
        if not stripped or stripped[0] in "#;":
            continue
        header = _HEADER.match(stripped)
        if header is not None:
            name = header[1].strip()
            if name in found:
                problems.add((name,), "the section is there twice", line=number, hint="remove one")
            here = found.setdefault(name, {})
            continue
        key, sign, value = (
            (part.strip() for part in re.split(r"([=:])", stripped, maxsplit=1))
            if re.search(r"[=:]", stripped)
            else (stripped, "", "")
        )
        if here is None or not sign or not key:
            problems.add((), "not a line of an INI file", line=number, got=stripped[:80], expected="key = value")
            return found
        if key in here:
            problems.add((*found, key), "the key is there twice", line=number, hint="remove one")
        here[key] = _value(value)
    return found


def _value(text: str) -> object:
    plain = text.strip().strip('"').strip()
    return float(plain) if _NUMBER.fullmatch(plain) else plain
